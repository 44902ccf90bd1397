"""One way a direction can end: on a sphere, on the floor or on a plane, shaded there.

Nothing is multiplied out. A case is a list of stages (a symbol and its definition, in order), the same list once for
a light in general, and guards beside them: symbols that are 1 where a condition holds and 0 elsewhere. Inside a
chamber every guard is constant and the radiance is analytic.
"""

from __future__ import annotations

from dataclasses import dataclass

import sympy as sp

from symrender.expression import intersection, plane, texture
from symrender.expression.formulas.light_terms import blinn_cosine2, half_vector, light_channel, phong_cosine, ray_view
from symrender.expression.formulas.textures import mixed, texture_coordinates, vein
from symrender.expression.symbols import ParameterTable
from symrender.expression.vectors import Vec3, dot, norm2, unit, vec3
from symrender.scene.scene import Scene
from symrender.scene.shape import Sphere
from symrender.scene.texture import Checker, FloorChecker, FloorTexture, Marble, Solid, Stripes

POINT, DIRECTION = vec3("P"), vec3("w")
LIGHT, LIGHT_COLOR = vec3("L"), Vec3(*sp.symbols("c_r c_g c_b", real=True))
BLOCKER, BLOCKER_RADIUS = vec3("B"), sp.Symbol("r_B", real=True)
LIT = sp.Symbol("V", integer=True)
FACING, GLEAMING = sp.Symbol("H_l", integer=True), sp.Symbol("H_h", integer=True)
SIDE = sp.Symbol("S", integer=True)
SHOWN = sp.Symbol("F", integer=True)
_MAX_POLYNOMIAL = 64


@dataclass(frozen=True)
class Stage:
    """``symbol`` stands for ``value``, an expression in earlier symbols."""

    symbol: sp.Symbol
    value: sp.Expr


@dataclass(frozen=True)
class Guard:
    """``symbol`` is 1 where ``condition`` holds, else 0."""

    symbol: sp.Symbol
    condition: sp.Basic


@dataclass(frozen=True)
class Case:
    """What the direction w sees when it meets one shape.

    ``stages`` and ``guards`` lead from P, w and the parameters to the point Q met at distance ``depth``, its normal,
    view direction and albedo; it is met where ``met`` holds. ``light_stages`` and ``light_guards`` go on for one
    light point L of colour c. Radiance is ``ambient`` plus the sum over light points of V times ``light``, V = 1
    where the segment QL meets no ``blocker`` (``blocks``: the condition for one sphere of centre B and radius r_B).
    """

    shape: str
    met: sp.Basic
    depth: sp.Symbol
    stages: tuple[Stage, ...]
    guards: tuple[Guard, ...]
    ambient: tuple[sp.Expr, ...]
    light_stages: tuple[Stage, ...]
    light_guards: tuple[Guard, ...]
    light: tuple[sp.Expr, ...]
    blockers: tuple[tuple[Vec3, sp.Expr], ...]
    blocks: sp.Basic
    behind: sp.Basic
    """Where the shape itself, the floor under it or a plane hides the light."""


class _Stages:
    def __init__(self) -> None:
        self.list: list[Stage] = []

    def let(self, name: str, value: sp.Expr) -> sp.Symbol:
        symbol = sp.Symbol(name, real=True)
        self.list.append(Stage(symbol, value))
        return symbol

    def let_vector(self, name: str, value: Vec3) -> Vec3:
        return Vec3(*(self.let(f"{name}_{axis}", part) for axis, part in zip("xyz", value.parts, strict=True)))


def sphere_case(scene: Scene, table: ParameterTable, j: int) -> Case:
    """The direction meets sphere j from outside."""
    sphere = scene.spheres[j]
    name = f"spheres.{sphere.name}"
    center, radius = table.vector(f"{name}.center"), table.symbols[f"{name}.radius"]
    s = _Stages()
    f = s.let_vector("f", center - POINT)
    b = s.let("b", intersection.approach(f, DIRECTION))
    chord2 = s.let("Delta", intersection.discriminant(f, DIRECTION, radius))
    half_chord = s.let("h", sp.sqrt(chord2))
    depth = s.let("t", intersection.root(b, half_chord, sp.Integer(1)))
    normal = s.let_vector("N", intersection.normal(f, DIRECTION, b, half_chord, sp.Integer(1), radius))
    q = s.let_vector("Q", center + normal * radius)
    factor, guards = _sphere_texture(sphere, table, name, normal)
    albedo = [part * factor for part in table.vector(f"{name}.color", "rgb").parts]
    blockers = tuple(_ball(scene, table, k) for k in range(len(scene.spheres)) if k != j)
    own = norm2(LIGHT - center) < radius**2
    behind = sp.Or(own, _under(scene, q), *_walled_off(scene, table, q))
    met = sp.And(b > 0, chord2 >= 0, depth > 0)
    return _shaded(scene, table, f"sphere {j}", s, guards, met, depth, q, normal, albedo, blockers, behind)


def floor_case(scene: Scene, table: ParameterTable) -> Case:
    """The direction meets the floor; from below it is black."""
    s = _Stages()
    depth = s.let("t", -POINT.z / DIRECTION.z)
    q = s.let_vector("Q", POINT + DIRECTION * depth)
    normal = Vec3(sp.Integer(0), sp.Integer(0), sp.Integer(1))
    assert scene.floor is not None
    albedo, guards = _squares(scene.floor.texture, table, "floor", q.x, q.y)
    blockers = tuple(_ball(scene, table, k) for k in range(len(scene.spheres)))
    met = sp.Lt(POINT.z * DIRECTION.z, 0)
    guards = (Guard(SHOWN, DIRECTION.z < 0), *guards)
    behind = sp.Or(sp.Le(LIGHT.z, 0), *_walled_off(scene, table, q))
    return _shaded(scene, table, "floor", s, guards, met, depth, q, normal, albedo, blockers, behind)


def plane_stages(scene: Scene, table: ParameterTable) -> list[Stage]:
    """The axes of every plane: unit normal, and the unit directions its texture's y and x run in."""
    s = _Stages()
    for k, wall in enumerate(scene.planes):
        normal, along = (table.vector(f"planes.{wall.name}.{key}") for key in ("normal", "along"))
        up = s.let_vector(f"up_p{k}", plane.upward(normal))
        north = s.let_vector(f"north_p{k}", plane.northward(up, along))
        s.let_vector(f"east_p{k}", plane.eastward(up, north))
    return s.list


def plane_axes(scene: Scene, table: ParameterTable, k: int) -> tuple[Vec3, Vec3, Vec3]:
    """(point, east, up) of plane k, the last two as ``plane_stages`` names them."""
    return table.vector(f"planes.{scene.planes[k].name}.point"), vec3(f"east_p{k}"), vec3(f"up_p{k}")


def plane_case(scene: Scene, table: ParameterTable, k: int) -> Case:
    """The direction meets plane k; from behind it is black."""
    s = _Stages()
    name = f"planes.{scene.planes[k].name}"
    point, east, up = plane_axes(scene, table, k)
    above = s.let("b", plane.height(POINT, point, up))
    fall = dot(DIRECTION, up)
    depth = s.let("t", plane.reach(above, fall))
    q = s.let_vector("Q", POINT + DIRECTION * depth)
    x, y = (s.let(axis, value) for axis, value in zip("xy", plane.coordinates(q, point, east, up), strict=True))
    albedo, guards = _squares(scene.planes[k].texture, table, name, x, y)
    blockers = tuple(_ball(scene, table, j) for j in range(len(scene.spheres)))
    met = sp.Lt(above * fall, 0)
    guards = (Guard(SHOWN, fall < 0), *guards)
    own = sp.Le(plane.height(LIGHT, point, up), 0)
    behind = sp.Or(own, _under(scene, q), *_walled_off(scene, table, q, but=k))
    return _shaded(scene, table, f"plane {k}", s, guards, met, depth, q, up, albedo, blockers, behind)


def _under(scene: Scene, q: Vec3) -> sp.Basic:
    return sp.Lt(q.z * LIGHT.z, 0) if scene.floor is not None else sp.false


def _walled_off(scene: Scene, table: ParameterTable, q: Vec3, but: int = -1) -> list[sp.Basic]:
    """For each plane but one, whether it lies between Q and the light."""
    found = []
    for k in range(len(scene.planes)):
        if k != but:
            point, _, up = plane_axes(scene, table, k)
            found.append(sp.Lt(plane.height(q, point, up) * plane.height(LIGHT, point, up), 0))
    return found


def _squares(
    kind: FloorTexture, table: ParameterTable, name: str, x: sp.Expr, y: sp.Expr
) -> tuple[list[sp.Expr], tuple[Guard, ...]]:
    """Albedo of a floor or plane at (x, y), and the guard it stands on."""
    if not isinstance(kind, FloorChecker):
        return list(table.vector(f"{name}.texture.color", "rgb").parts), ()
    cell = table.symbols[f"{name}.texture.cell"]
    ox, oy = (table.symbols[f"{name}.texture.offset.{axis}"] for axis in "xy")
    number = texture.floor_parity(x, y, cell, ox, oy)
    a, c = (x - ox) / cell, (y - oy) / cell
    tie = sp.Or(sp.Eq(a, sp.floor(a)), sp.Eq(c, sp.floor(c)))
    bright, dark = (table.vector(f"{name}.texture.{tone}", "rgb").parts for tone in ("bright", "dark"))
    albedo = [mixed(d, w, SIDE) for w, d in zip(bright, dark, strict=True)]
    return albedo, (Guard(SIDE, sp.Or(sp.Eq(sp.Mod(number, 2), 0), tie)),)


def _ball(scene: Scene, table: ParameterTable, k: int) -> tuple[Vec3, sp.Expr]:
    name = f"spheres.{scene.spheres[k].name}"
    return table.vector(f"{name}.center"), table.symbols[f"{name}.radius"]


def _sphere_texture(
    sphere: Sphere, table: ParameterTable, name: str, normal: Vec3
) -> tuple[sp.Expr, tuple[Guard, ...]]:
    """Albedo factor and the guard it stands on: a sign of a polynomial wherever the frequencies are whole."""
    kind = sphere.texture
    if isinstance(kind, Solid):
        return sp.Integer(1), ()
    u, v = texture_coordinates(normal)
    ku = table.symbols[f"{name}.texture.ku"]
    if isinstance(kind, Marble):
        return vein(u, v, ku, table.symbols[f"{name}.texture.kv"]), ()
    whole_u = kind.ku % 2 == 0 and kind.ku <= _MAX_POLYNOMIAL
    sign = texture.azimuth_polynomial(normal, int(kind.ku)) if whole_u else texture.wave(u, ku)
    if isinstance(kind, Checker):
        whole_v = kind.kv % 1 == 0 and kind.kv <= _MAX_POLYNOMIAL
        kv = table.symbols[f"{name}.texture.kv"]
        sign *= texture.polar_polynomial(normal, int(kind.kv)) if whole_v else texture.wave(v, kv)
    assert isinstance(kind, Checker | Stripes)
    dark = table.symbols[f"{name}.texture.dark"]
    return mixed(dark, sp.Integer(1), SIDE), (Guard(SIDE, sp.Ge(sign, 0)),)


def _shaded(
    scene: Scene,
    table: ParameterTable,
    shape: str,
    s: _Stages,
    guards: tuple[Guard, ...],
    met: sp.Basic,
    depth: sp.Symbol,
    q: Vec3,
    normal: Vec3,
    albedo: list[sp.Expr],
    blockers: tuple[tuple[Vec3, sp.Expr], ...],
    behind: sp.Basic,
) -> Case:
    rules = scene.shading
    ka, kd, ks, power = (table.symbols[f"shading.{key}"] for key in ("ka", "kd", "ks", "shininess"))
    view = unit(table.vector("camera.eye") - q) if rules.highlight_view == "eye" else ray_view(DIRECTION)
    view = s.let_vector("v", view)
    one = _Stages()
    to_light = one.let_vector("d", LIGHT - q)
    light_dir = one.let_vector("l", unit(to_light))
    cosine = one.let("mu", dot(normal, light_dir))
    if rules.model == "phong":
        sign = one.let("sigma", phong_cosine(cosine, dot(normal, view), dot(light_dir, view)))
        square = sign**2
    else:
        half = one.let_vector("hv", half_vector(light_dir, view))
        sign = one.let("sigma", dot(normal, half))
        square = blinn_cosine2(normal, half)
    gleam = one.let("s", square ** (power / 2))
    gleams = sign > 0 if rules.specular_terminator == "open" else sp.And(sign > 0, cosine > 0)
    light_guards = (Guard(FACING, cosine > 0), Guard(GLEAMING, gleams))
    light = tuple(
        light_channel(c, kd, ks, a, cosine * FACING, gleam * GLEAMING)
        for c, a in zip(LIGHT_COLOR.parts, albedo, strict=True)
    )
    ambient = tuple(ka * table.symbols[f"ambient.{c}"] for c in "rgb")
    if any(guard.symbol == SHOWN for guard in guards):
        light, ambient = (tuple(SHOWN * part for part in parts) for parts in (light, ambient))
    a, b, c = intersection.segment_coefficients(q - BLOCKER, LIGHT - q, BLOCKER_RADIUS)
    blocks = intersection.segment_meets(a, b, c, intersection.power(LIGHT - BLOCKER, BLOCKER_RADIUS))
    parts = (met, depth, tuple(s.list), guards, ambient, tuple(one.list), light_guards, light)
    return Case(shape, *parts, blockers, blocks, behind)
