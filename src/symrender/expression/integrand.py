"""Integrand: the expression of what a surface reflects, to hold, print, differentiate and evaluate.

gloss(P) = (1/W) int_cone f(P, w) g(w) dw with g = cos^n theta, or cos^n theta (w.N) in BRDF units, and f is one of
finitely many analytic expressions, chosen by guards. SymPy holds the expressions; which one counts is decided beside
them.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import sympy as sp

from symrender.errors import OptionError, SceneError
from symrender.expression import case as cases_of
from symrender.expression import tangent
from symrender.expression.case import DIRECTION, LIGHT, LIGHT_COLOR, POINT, Case, Guard, Stage
from symrender.expression.elementary import gleam
from symrender.expression.formulas import lobes
from symrender.expression.formulas.disks import disk_frame, disk_point
from symrender.expression.opaque import plain
from symrender.expression.plane import place as plane_place
from symrender.expression.symbols import ParameterTable, parameter_table
from symrender.expression.vectors import Vec3, dot, unit, vec3
from symrender.expression.walls import Wall, walls
from symrender.scene.light import DiskLight
from symrender.scene.lobe import Lobe
from symrender.scene.nearest import did_you_mean
from symrender.scene.scene import Scene

_GUARD_DIGITS = 10


@dataclass(frozen=True)
class LightPoint:
    """One point a light is replaced by: position, colour share, and how both change with the parameter."""

    position: Vec3
    color: Vec3
    position_tangent: Vec3
    color_tangent: Vec3


_ZERO = Vec3(sp.Integer(0), sp.Integer(0), sp.Integer(0))


@dataclass(frozen=True)
class Integrand:
    """The radiance a lobe direction sees, and the weight it is averaged with.

    ``cases``: the shapes a direction can meet, nearest first counts. ``background``: radiance where none is met.
    ``weight`` g and ``normaliser`` W are those of ``units``: cos^n theta and its integral over the cone in
    ``lobe_average``, cos^n theta (w.N) and 2 pi/(n + 2) in ``brdf_normalised``. ``walls``: where it is not smooth.
    ``parameters``: dotted name to symbol. ``wrt`` names what ``radiance`` is a derivative by, if it is one.
    """

    surface: str
    cases: tuple[Case, ...]
    background: tuple[sp.Expr, ...]
    point: tuple[Stage, ...]
    normal: Vec3
    weight: sp.Expr
    normaliser: sp.Expr
    walls: tuple[Wall, ...]
    light_points: tuple[LightPoint, ...]
    table: ParameterTable
    units: str
    wrt: str | None = None

    @property
    def parameters(self) -> Mapping[str, sp.Symbol]:
        """Dotted names of the scene's real numbers and the symbols that stand for them."""
        return self.table.symbols

    @property
    def radiance(self) -> Mapping[str, tuple[sp.Expr, ...]]:
        """For each shape, (r, g, b) of ambient plus one light point, in the symbols of its stages and guards."""
        return {
            c.shape: tuple(a + cases_of.LIT * one for a, one in zip(c.ambient, c.light, strict=True))
            for c in self.cases
        }

    def diff(self, name: str) -> Integrand:
        """Derivative of the radiance by a dotted parameter at a fixed direction, inside a chamber.

        Guards stay as they are: the motion of the walls is not in it. Raises SceneError for an unknown name.
        """
        if self.wrt is not None:
            raise OptionError(f"diff: the integrand is already a derivative by {self.wrt}")
        symbol = self.table.symbol(name)
        start: tangent.Tangents = {symbol: sp.Integer(1)}
        point = tangent.differentiate(self.point, start)
        moving = tuple(_moved(p, symbol) for p in self.light_points)
        for base, generic in ((LIGHT, "L"), (LIGHT_COLOR, "c")):
            for axis, part in zip("xyz" if generic == "L" else "rgb", base.parts, strict=True):
                start[part] = sp.Symbol(f"d{generic}_{axis}", real=True)
        changed = []
        for c in self.cases:
            tangents = dict(start)
            stages = tangent.differentiate(c.stages, tangents)
            light_stages = tangent.differentiate(c.light_stages, tangents)
            changed.append(
                replace(
                    c,
                    stages=stages,
                    light_stages=light_stages,
                    ambient=tuple(tangent.tangent_of(a, tangents) for a in c.ambient),
                    light=tuple(tangent.tangent_of(a, tangents) for a in c.light),
                )
            )
        background = tuple(tangent.tangent_of(b, start) for b in self.background)
        return replace(self, cases=tuple(changed), background=background, point=point, light_points=moving, wrt=name)

    def evaluate(
        self, point: Sequence[Any], direction: Sequence[Any], *, digits: int = 30
    ) -> tuple[sp.Float, sp.Float, sp.Float]:
        """Radiance (r, g, b) seen along ``direction``, to ``digits`` significant digits.

        ``point``: (x, y) or (x, y, 0) on the floor, (x, y) of a plane's texture, the unit outward normal on a sphere.
        ``direction`` (3,) is
        normalised first; below the horizon nothing is seen. Numbers may be ints, floats, strings such as "0.1" or
        SymPy numbers; a float means exactly the binary number it is.
        """
        if not 1 <= digits <= 1000:
            raise OptionError(f"digits: must be from 1 to 1000, got {digits!r}")
        precision = digits + _GUARD_DIGITS
        names = {symbol: _exact(self.table.values[name], precision) for name, symbol in self.table.symbols.items()}
        given = [_exact(x, precision) for x in point]
        w = [_exact(x, precision) for x in direction]
        kind = self.surface.partition(".")[0]
        if len(given) not in {"floor": (2, 3), "planes": (2,)}.get(kind, (3,)) or len(w) != 3 or not any(w):
            raise OptionError(f"point, direction: got {tuple(point)} and {tuple(direction)}")
        length = sp.sqrt(sum(x * x for x in w)).evalf(precision)
        names |= {s: (x / length).evalf(precision) for s, x in zip(DIRECTION.parts, w, strict=True)}
        names |= dict(zip(_SURFACE.parts, given, strict=False))
        _run(self.point, names, precision)
        zero = sp.Float(0, digits)
        if _value(dot(DIRECTION, self.normal), names, precision) <= 0:
            return zero, zero, zero
        nearest: tuple[Any, Case, dict[sp.Symbol, Any]] | None = None
        for c in self.cases:
            local = dict(names)
            try:
                _run(c.stages, local, precision)
            except _NotReal:
                continue
            if _holds(c.met, local) and (nearest is None or local[c.depth] < nearest[0]):
                nearest = local[c.depth], c, local
        if nearest is None:
            return tuple(sp.Float(_value(b, names, precision), digits) for b in self.background)
        return tuple(sp.Float(x, digits) for x in self._shade(nearest[1], nearest[2], precision))

    def _shade(self, c: Case, names: dict[sp.Symbol, Any], precision: int) -> list[Any]:
        _decide(c.guards, names)
        total = [_value(a, names, precision) for a in c.ambient]
        for p in self.light_points:
            local = dict(names)
            for symbols, value in (
                (LIGHT, p.position),
                (LIGHT_COLOR, p.color),
                (_dotted("dL", "xyz"), p.position_tangent),
                (_dotted("dc", "rgb"), p.color_tangent),
            ):
                for symbol, part in zip(symbols.parts, value.parts, strict=True):
                    local[symbol] = _value(part, names, precision)
            if _holds(c.behind, local) or any(self._blocked(c, ball, local, precision) for ball in c.blockers):
                continue
            _run(c.light_stages, local, precision)
            _decide(c.light_guards, local)
            for k, one in enumerate(c.light):
                total[k] += _value(one, local, precision)
        return total

    def _blocked(self, c: Case, ball: tuple[Vec3, sp.Expr], names: dict[sp.Symbol, Any], precision: int) -> bool:
        local = dict(names)
        for symbol, part in zip(cases_of.BLOCKER.parts, ball[0].parts, strict=True):
            local[symbol] = _value(part, names, precision)
        local[cases_of.BLOCKER_RADIUS] = _value(ball[1], names, precision)
        return _holds(c.blocks, local)

    def __str__(self) -> str:
        title = f"what the lobe of {self.surface} sees" + (f", derivative by {self.wrt}" if self.wrt else "")
        lines = [
            title,
            f"  gloss(P) = (1/W) int f(P, w) g(w) dw over the cone; f = 0 where {dot(DIRECTION, self.normal)} <= 0",
            f"  units: {self.units}",
            f"  g = {self.weight}",
            f"  W = {self.normaliser}",
            *_lines(self.point, "  "),
        ]
        for c in self.cases:
            lines += [f"{c.shape}, met where {c.met}"]
            lines += [*_lines(c.stages, "  "), *_lines(c.guards, "  ")]
            lines += [f"  for each of {len(self.light_points)} light points L of colour c, V = 1 where it is visible:"]
            lines += [*_lines(c.light_stages, "    "), *_lines(c.light_guards, "    ")]
            lines += [f"  f_{channel} = {value}" for channel, value in zip("rgb", self.radiance[c.shape], strict=True)]
        shapes = dict.fromkeys(wall.shape for wall in self.walls)
        met = [f"{shape} ({', '.join(w.kind for w in self.walls if w.shape == shape)})" for shape in shapes]
        return "\n".join([*lines, f"walls: {'; '.join(met)}"])

    def latex(self) -> str:
        """The integral, and every case as aligned definitions."""
        rows = [
            r"\mathrm{gloss}(P) &= \frac{1}{W}\int f(P,w)\,g(w)\,\mathrm{d}w",
            rf"&\quad\text{{in units }}\mathtt{{{self.units.replace('_', chr(92) + '_')}}}",
            rf"g &= {sp.latex(self.weight)}",
            rf"W &= {sp.latex(self.normaliser)}",
            *(rf"{sp.latex(stage.symbol)} &= {sp.latex(stage.value)}" for stage in self.point),
        ]
        for c in self.cases:
            rows.append(rf"\text{{{c.shape}}}&:\quad {sp.latex(c.met)}")
            for stage in (*c.stages, *c.light_stages):
                rows.append(rf"{sp.latex(stage.symbol)} &= {sp.latex(stage.value)}")
            for guard in (*c.guards, *c.light_guards):
                rows.append(rf"{sp.latex(guard.symbol)} &= \left[{sp.latex(guard.condition)}\right]")
            for channel, value in zip("rgb", self.radiance[c.shape], strict=True):
                rows.append(rf"f_{channel} &= {sp.latex(value)}")
        body = " \\\\\n".join(rows)
        return f"\\begin{{align*}}\n{body}\n\\end{{align*}}"

    def _repr_latex_(self) -> str:
        return self.latex()


def expression(scene: Any = "gloss", *, surface: str = "floor", disk_order: int = 2) -> Integrand:
    """Return the integrand of a surface's glossy reflection as an expression.

    Parameters
    ----------
    scene : str, path, mapping or scene
        A scene in units of the series.
    surface : str
        ``"floor"``, ``"spheres.NAME"`` or ``"planes.NAME"``.
    disk_order : int
        K of the K x K points that stand for a disk light.

    Returns
    -------
    Integrand
        It prints, differentiates (``diff``), and evaluates to any number of digits (``evaluate``).

    Raises
    ------
    SceneError
        The surface does not exist or has no lobe.
    Unsupported
        The scene is radiometric.

    Examples
    --------
    >>> import symrender as sr
    >>> held = sr.expression("gloss", surface="floor")
    >>> len(held.evaluate((0.3, -2.2), ("0.05", "0.6", "0.2"), digits=40))
    3
    """
    from symrender.scene.load import load

    loaded = load(scene, "expression")
    found = _lobe(loaded, surface)
    table = parameter_table(loaded)
    eye = table.vector("camera.eye")
    if surface == "floor":
        normal = Vec3(sp.Integer(0), sp.Integer(0), sp.Integer(1))
        place = Vec3(_SURFACE.x, _SURFACE.y, sp.Integer(0))
    elif surface.startswith("planes."):
        names = [f"planes.{plane.name}" for plane in loaded.planes]
        origin, east, normal = cases_of.plane_axes(loaded, table, names.index(surface))
        place = plane_place(_SURFACE.x, _SURFACE.y, origin, east, normal)
    else:
        normal = _SURFACE
        place = table.vector(f"{surface}.center") + normal * table.symbols[f"{surface}.radius"]
    stages = cases_of.plane_stages(loaded, table)
    stages += [Stage(s, x) for s, x in zip(POINT.parts, place.parts, strict=True)]
    stages += [Stage(s, x) for s, x in zip(vec3("D").parts, unit(POINT - eye).parts, strict=True)]
    mirror = lobes.mirror_direction(vec3("D"), normal)
    stages += [Stage(s, x) for s, x in zip(vec3("m").parts, mirror.parts, strict=True)]
    seen = [
        cases_of.sphere_case(loaded, table, j)
        for j, sphere in enumerate(loaded.spheres)
        if surface != f"spheres.{sphere.name}"
    ]
    if surface != "floor" and loaded.floor is not None:
        seen.append(cases_of.floor_case(loaded, table))
    seen += [
        cases_of.plane_case(loaded, table, k)
        for k, plane in enumerate(loaded.planes)
        if surface != f"planes.{plane.name}"
    ]
    exponent, theta_max = (table.symbols[f"{surface}.lobe.{key}"] for key in ("exponent", "theta_max"))
    brdf = loaded.shading.lobe_units == "brdf_normalised"
    toward = sp.DiracDelta(_ANGLE) if found.mirror else gleam(dot(DIRECTION, vec3("m")), exponent)
    whole = lobes.brdf_normaliser(exponent) if brdf else _whole(theta_max, exponent)
    cases = tuple(seen)
    return Integrand(
        surface=surface,
        cases=cases,
        background=tuple(table.symbols[f"background.{c}"] for c in "rgb"),
        point=tuple(stages),
        normal=normal,
        weight=toward * dot(DIRECTION, normal) if brdf else toward,
        normaliser=sp.Integer(1) if brdf and found.mirror else whole,
        walls=walls(loaded, table, cases, normal, vec3("m"), theta_max),
        light_points=_light_points(loaded, table, disk_order),
        table=table,
        units=loaded.shading.lobe_units,
    )


def _whole(theta_max: sp.Expr, exponent: sp.Expr) -> sp.Expr:
    """The normaliser of a cone as one writes it: digits are kept by computing with more of them."""
    return plain(lobes.normaliser(sp.log(sp.cos(theta_max)), exponent))


_SURFACE = vec3("x")
"""The point given: coordinates on the floor or in a plane, the outward normal on a sphere."""
_ANGLE = sp.Symbol("theta", nonnegative=True)


def _lobe(scene: Scene, surface: str) -> Lobe:
    shapes: dict[str, Lobe | None] = {f"spheres.{sphere.name}": sphere.lobe for sphere in scene.spheres}
    shapes |= {f"planes.{plane.name}": plane.lobe for plane in scene.planes}
    if scene.floor is not None:
        shapes["floor"] = scene.floor.lobe
    if surface not in shapes:
        raise SceneError(
            f"surface: must be one of {', '.join(shapes) or 'none'}, got {surface!r}{did_you_mean(surface, shapes)}"
        )
    found = shapes[surface]
    if found is None:
        raise SceneError(f"surface: {surface} has no lobe")
    return found


def _light_points(scene: Scene, table: ParameterTable, order: int) -> tuple[LightPoint, ...]:
    points: list[LightPoint] = []
    for source in scene.lights:
        name = f"lights.{source.name}"
        position, color = table.vector(f"{name}.position"), table.vector(f"{name}.color", "rgb")
        if not isinstance(source, DiskLight) or source.radius == 0:
            points.append(LightPoint(position, color, _ZERO, _ZERO))
            continue
        target = table.vector(f"{name}.target")
        away = [t - p for t, p in zip(source.target, source.position, strict=True)]
        upright = away[1] ** 2 < 0.81 * sum(x * x for x in away)
        up = Vec3(*(sp.Integer(x) for x in ((0, 1, 0) if upright else (1, 0, 0))))
        _, e1, e2 = disk_frame(position, target, up)
        radius, share = table.symbols[f"{name}.radius"], sp.Rational(1, order * order)
        middles = [sp.Rational(2 * k + 1, 2 * order) for k in range(order)]
        for u in middles:
            for v in middles:
                place = disk_point(position, radius, e1, e2, u, v)
                points.append(LightPoint(place, color * share, _ZERO, _ZERO))
    return tuple(points)


def _moved(p: LightPoint, symbol: sp.Symbol) -> LightPoint:
    change = [Vec3(*(sp.diff(part, symbol) for part in v.parts)) for v in (p.position, p.color)]
    return LightPoint(p.position, p.color, *change)


def _lines(entries: Sequence[Stage | Guard], pad: str) -> list[str]:
    """One line each; the three parts of a vector share a line where y and z only repeat x with the axes renamed."""
    lines: list[str] = []
    skip = 0
    for k, entry in enumerate(entries):
        if skip:
            skip -= 1
            continue
        if isinstance(entry, Guard):
            lines.append(f"{pad}{entry.symbol} = 1 where {entry.condition}, else 0")
            continue
        three = [e for e in entries[k : k + 3] if isinstance(e, Stage)]
        alike = len(three) == 3 and all(
            _renamed(one.symbol) == other.symbol and sp.expand(_renamed(one.value) - other.value) == 0
            for one, other in itertools.pairwise(three)
        )
        skip = 2 if alike else 0
        lines.append(f"{pad}{entry.symbol} = {entry.value}" + ("   (y, z alike)" if alike else ""))
    return lines


def _renamed(value: sp.Expr) -> sp.Expr:
    """The expression with the axes renamed, x to y to z to x."""
    turn = {"x": "y", "y": "z", "z": "x"}
    pairs = {s: sp.Symbol(s.name[:-1] + turn[s.name[-1]], real=True) for s in value.free_symbols if s.name[-2:-1] == "_"
             and s.name[-1] in turn}  # fmt: skip
    return value.xreplace(pairs)


class _NotReal(Exception):
    """A square root of a negative number: the line misses the shape."""


def _exact(number: Any, precision: int) -> Any:
    return sp.Float(number, precision) if isinstance(number, str) else sp.sympify(number).evalf(precision)


def _value(expression: sp.Expr, names: Mapping[sp.Symbol, Any], precision: int) -> Any:
    return sp.sympify(expression).xreplace(dict(names)).evalf(precision)


def _holds(condition: sp.Basic, names: Mapping[sp.Symbol, Any]) -> bool:
    decided = sp.sympify(condition).xreplace(dict(names))
    return bool(decided.doit() if isinstance(decided, sp.Basic) else decided)


def _run(stages: Sequence[Stage], names: dict[sp.Symbol, Any], precision: int) -> None:
    for stage in stages:
        value = _value(stage.value, names, precision)
        if not value.is_real:
            raise _NotReal
        names[stage.symbol] = value


def _decide(guards: Sequence[Guard], names: dict[sp.Symbol, Any]) -> None:
    for guard in guards:
        names[guard.symbol] = sp.Integer(int(_holds(guard.condition, names)))


def _dotted(prefix: str, axes: str) -> Vec3:
    return Vec3(*(sp.Symbol(f"{prefix}_{axis}", real=True) for axis in axes))
