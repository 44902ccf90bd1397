"""Walls: where the integrand of a lobe stops being smooth, each the zero set of one level.

Levels are the formulas of ``formulas/walls.py`` in the direction w and in what the stages of a case say of it: the hit
point Q and its normal N. With P given they are circles on the sphere of directions, quadratic cones about it, or, of a
shadow on a sphere, a quartic.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import sympy as sp

from symrender.expression.case import BLOCKER, BLOCKER_RADIUS, DIRECTION, LIGHT, POINT, Case, plane_axes
from symrender.expression.formulas import walls as levels
from symrender.expression.plane import height
from symrender.expression.symbols import ParameterTable
from symrender.expression.vectors import Vec3
from symrender.scene.scene import Scene
from symrender.scene.texture import Checker, FloorChecker, FloorTexture, Stripes

LINE = sp.Symbol("i", integer=True)
"""Number of a line of a texture."""


@dataclass(frozen=True)
class Wall:
    """``expression`` = 0, of the given ``kind``, on what is seen of ``shape``: in w, P and symbols of its stages."""

    kind: str
    shape: str
    expression: sp.Expr


def walls(
    scene: Scene, table: ParameterTable, cases: tuple[Case, ...], normal: Vec3, mirror: Vec3, theta_max: sp.Expr
) -> tuple[Wall, ...]:
    """Every wall the lobe of a surface can meet, those of lights once for a light point L in general."""
    found = [
        Wall("horizon", "surface", levels.horizon_level(DIRECTION, normal)),
        Wall("rim", "surface", levels.rim_level(DIRECTION, mirror, sp.cos(theta_max))),
    ]
    for case in cases:
        if case.shape == "floor":
            assert scene.floor is not None
            found += _square_walls(scene.floor.texture, table, "floor", case.shape, _staged(case, "Q").parts[:2])
        elif case.shape.startswith("plane"):
            k = int(case.shape.split()[1])
            place = [stage.symbol for stage in case.stages if stage.symbol.name in ("x", "y")]
            found += _square_walls(scene.planes[k].texture, table, f"planes.{scene.planes[k].name}", case.shape, place)
        else:
            found += _sphere_walls(scene, table, int(case.shape.split()[1]), _staged(case, "N"))
        for k in range(len(scene.planes)):
            if case.shape != f"plane {k}":
                point, _, up = plane_axes(scene, table, k)
                found.append(Wall("cut", case.shape, height(_staged(case, "Q"), point, up)))
        highlight = next(stage.value for stage in case.light_stages if stage.symbol.name == "sigma")
        found.append(Wall("highlight", case.shape, highlight))
        if case.blockers:
            shadow = levels.shadow_level(_staged(case, "Q"), LIGHT, BLOCKER, BLOCKER_RADIUS)
            found.append(Wall("shadow", case.shape, shadow))
    return tuple(found)


def _staged(case: Case, name: str) -> Vec3:
    """The vector of a case's stages that has this name."""
    return Vec3(*(stage.symbol for stage in case.stages if stage.symbol.name in {f"{name}_{axis}" for axis in "xyz"}))


def _sphere_walls(scene: Scene, table: ParameterTable, j: int, normal: Vec3) -> list[Wall]:
    sphere, shape = scene.spheres[j], f"sphere {j}"
    name = f"spheres.{sphere.name}"
    center, radius = table.vector(f"{name}.center"), table.symbols[f"{name}.radius"]
    found = [
        Wall("silhouette", shape, levels.silhouette_level(DIRECTION, center, radius, POINT)),
        Wall("terminator", shape, levels.terminator_level(normal, LIGHT, center, radius)),
    ]
    if isinstance(sphere.texture, Checker | Stripes):
        ku = table.symbols[f"{name}.texture.ku"]
        found.append(Wall("texture", shape, levels.meridian_level(normal, LINE, ku)))
    if isinstance(sphere.texture, Checker):
        kv = table.symbols[f"{name}.texture.kv"]
        found.append(Wall("texture", shape, levels.parallel_level(normal, LINE, kv)))
    return found


def _square_walls(
    kind: FloorTexture, table: ParameterTable, name: str, shape: str, place: Sequence[sp.Expr]
) -> list[Wall]:
    if not isinstance(kind, FloorChecker):
        return []
    cell = table.symbols[f"{name}.texture.cell"]
    offsets = (table.symbols[f"{name}.texture.offset.{axis}"] for axis in "xy")
    lines = (levels.floor_line_level(at, LINE, cell, o) for at, o in zip(place, offsets, strict=True))
    return [Wall("texture", shape, line) for line in lines]
