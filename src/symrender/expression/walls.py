"""Walls: where the integrand of a lobe stops being smooth, each the zero set of one expression in the direction w.

Silhouettes, horizon and rim are circles on the sphere of directions. A plane n.x = k cuts a sphere (C, R) in a circle
that P sees along the quadratic cone |D|^2 (n.w)^2 + 2 q (D.w)(n.w) + q^2 - R^2 (n.w)^2 = 0, D = P - C, q = k - n.P:
terminators and the lines of a sphere's texture are such planes. Lines on the floor are great circles.
"""

from __future__ import annotations

from dataclasses import dataclass

import sympy as sp

from symrender.expression.case import BLOCKER, BLOCKER_RADIUS, DIRECTION, LIGHT, POINT, Case, silhouette
from symrender.expression.symbols import ParameterTable
from symrender.expression.vectors import Vec3, dot, norm2
from symrender.scene.scene import Scene
from symrender.scene.texture import Checker, FloorChecker, Stripes

LINE = sp.Symbol("i", integer=True)
"""Number of a line of a texture."""


@dataclass(frozen=True)
class Wall:
    """``expression`` = 0, of the given ``kind``, on what is seen of ``shape``."""

    kind: str
    shape: str
    expression: sp.Expr


def plane_section(center: Vec3, radius: sp.Expr, n: Vec3, k: sp.Expr) -> sp.Expr:
    """The cone along which P sees the circle that the plane n.x = k cuts from a sphere."""
    offset = POINT - center
    q = k - dot(n, POINT)
    nw = dot(n, DIRECTION)
    return (norm2(offset) - radius**2) * nw**2 + 2 * q * dot(offset, DIRECTION) * nw + q**2


def terminator(center: Vec3, radius: sp.Expr, light: Vec3) -> sp.Expr:
    """Where N.l changes sign on a sphere: the plane (L - C).x = (L - C).C + R^2."""
    n = light - center
    return plane_section(center, radius, n, dot(n, center) + radius**2)


def walls(
    scene: Scene, table: ParameterTable, cases: tuple[Case, ...], normal: Vec3, mirror: Vec3, theta_max: sp.Expr
) -> tuple[Wall, ...]:
    """Every wall the lobe of a surface can meet, those of lights once for a light point L in general."""
    found = [
        Wall("horizon", "surface", dot(DIRECTION, normal)),
        Wall("rim", "surface", dot(DIRECTION, mirror) - sp.cos(theta_max)),
    ]
    for case in cases:
        if case.shape == "floor":
            found += _floor_walls(scene, table)
        else:
            found += _sphere_walls(scene, table, int(case.shape.split()[1]))
        highlight = next(stage.value for stage in case.light_stages if stage.symbol.name == "sigma")
        found.append(Wall("highlight", case.shape, highlight))
        if case.blockers:
            found.append(Wall("shadow", case.shape, _grazing(case)))
    return tuple(found)


def _grazing(case: Case) -> sp.Expr:
    """Discriminant of the shadow segment about a sphere (B, r_B): zero where the light point L just grazes it."""
    q = Vec3(*(stage.symbol for stage in case.stages if stage.symbol.name in ("Q_x", "Q_y", "Q_z")))
    along, across = LIGHT - q, q - BLOCKER
    return dot(across, along) ** 2 - norm2(along) * (norm2(across) - BLOCKER_RADIUS**2)


def _sphere_walls(scene: Scene, table: ParameterTable, j: int) -> list[Wall]:
    sphere, shape = scene.spheres[j], f"sphere {j}"
    name = f"spheres.{sphere.name}"
    center, radius = table.vector(f"{name}.center"), table.symbols[f"{name}.radius"]
    found = [
        Wall("silhouette", shape, silhouette(center - POINT, radius)),
        Wall("terminator", shape, terminator(center, radius, LIGHT)),
    ]
    if isinstance(sphere.texture, Checker | Stripes):
        angle = 2 * sp.pi * LINE / table.symbols[f"{name}.texture.ku"]
        meridian = Vec3(-sp.sin(angle), sp.cos(angle), sp.Integer(0))
        found.append(Wall("texture", shape, plane_section(center, radius, meridian, dot(meridian, center))))
    if isinstance(sphere.texture, Checker):
        up = Vec3(sp.Integer(0), sp.Integer(0), sp.Integer(1))
        height = center.z + radius * sp.cos(sp.pi * LINE / table.symbols[f"{name}.texture.kv"])
        found.append(Wall("texture", shape, plane_section(center, radius, up, height)))
    return found


def _floor_walls(scene: Scene, table: ParameterTable) -> list[Wall]:
    assert scene.floor is not None
    if not isinstance(scene.floor.texture, FloorChecker):
        return []
    cell = table.symbols["floor.texture.cell"]
    lines = []
    for axis, place, along in (("x", POINT.x, DIRECTION.x), ("y", POINT.y, DIRECTION.y)):
        line = table.symbols[f"floor.texture.offset.{axis}"] + LINE * cell
        lines.append(Wall("texture", "floor", (place - line) * DIRECTION.z - POINT.z * along))
    return lines
