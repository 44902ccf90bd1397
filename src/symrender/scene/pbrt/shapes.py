"""Spheres of a pbrt file, and the squares that stand for planes."""

from __future__ import annotations

import math
from typing import Any

from symrender.scene.mitsuba.plane import frame_of, told
from symrender.scene.pbrt.flats import disk, mesh
from symrender.scene.pbrt.materials import Texture
from symrender.scene.pbrt.parameters import Parameters
from symrender.scene.pbrt.transforms import ROUNDING, Transform
from symrender.scene.printable import printable
from symrender.scene.radiometric.shapes import Plane

_INDICES = (0.0, 1.0, 2.0, 0.0, 2.0, 3.0)


def shape(parameters: Parameters, at: Transform, texture: Texture | None) -> tuple[dict[str, Any], float | None]:
    """The entry of a shape without name and material, and the side of the fields of its texture where it has some."""
    (kind,) = parameters.directive.strings
    if kind == "sphere":
        return _sphere(parameters, at, texture)
    if kind == "trianglemesh":
        if any(told(comment) for comment in parameters.directive.comments):
            return _plane(parameters, at, texture)
        return _flat(parameters, at, texture)
    if kind == "disk":
        if texture is not None and texture.dark is not None:
            raise parameters.wrong("", "must have no checker, whose chart on a disk is another here")
        return disk(parameters, at), None
    known = "sphere, disk or trianglemesh"
    raise parameters.wrong("", f"must be {known}, got {printable(kind)}, a shape not read")


def _agreed(parameters: Parameters, texture: Texture, derived: float) -> float:
    """The side of a field: as a comment says it in full where that agrees with what was ``derived``."""
    if not (math.isfinite(derived) and derived > 0.0):
        raise parameters.wrong("", "must have a chart whose fields are squares of one side")
    if texture.cell is None:
        return derived
    if abs(texture.cell - derived) > ROUNDING * derived:
        raise parameters.wrong("", f"must have fields of the side its comment says, {texture.cell:g}, got {derived:g}")
    return texture.cell


def _sphere(parameters: Parameters, at: Transform, texture: Texture | None) -> tuple[dict[str, Any], float | None]:
    radius = parameters.number("radius", 1.0)
    why = "parts of spheres are not read"
    low, high = parameters.number("zmin", -radius), parameters.number("zmax", radius)
    if low > -radius:
        parameters.must("zmin", low, -radius, why)
    if high < radius:
        parameters.must("zmax", high, radius, why)
    if (around := parameters.number("phimax", 360.0)) < 360.0:
        parameters.must("phimax", around, 360.0, why)
    parameters.done("radius")
    scale = at.scale()
    if scale is None:
        raise parameters.wrong("", "must be turned, moved and scaled alike in all directions: no scene has ellipsoids")
    entry = {"type": "sphere", "center": list(at.place((0.0, 0.0, 0.0))), "radius": radius * scale}
    if texture is None or texture.dark is None:
        return entry, None
    off = at.matrix[:3, :3] - [[-scale, 0.0, 0.0], [0.0, -scale, 0.0], [0.0, 0.0, scale]]
    if abs(off).max() > ROUNDING * scale:
        raise parameters.wrong("", "must be turned by Rotate 180 0 0 1, where the fields of a scene begin")
    uscale, vscale, udelta, vdelta = texture.turns
    cell = _agreed(parameters, texture, 1.0 / vdelta if vdelta else 0.0)
    due = (2.0 / cell, -1.0 / cell, 0.0, 1.0 / cell)
    if any(abs(a - b) > ROUNDING / cell for a, b in zip((uscale, vscale, udelta, vdelta), due, strict=True)):
        raise parameters.wrong(
            "", "must have fields of one side from its top: uscale 2/c, vscale -1/c, udelta 0, vdelta 1/c for a side c"
        )
    return entry, cell


def _flat(parameters: Parameters, at: Transform, texture: Texture | None) -> tuple[dict[str, Any], float | None]:
    """A flat shape that ends, and the side of its fields where it has some."""
    entry, places, chart = mesh(parameters, at)
    if texture is None or texture.dark is None:
        return entry, None
    if entry["type"] != "rectangle" or len(chart) != 2 * len(places):
        raise parameters.wrong("", "must have no checker, but on a rectangle with four pairs uv")
    sides = math.dist(places[0], places[1]), math.dist(places[0], places[3])
    uscale, vscale, udelta, vdelta = texture.turns
    cell = _agreed(parameters, texture, sides[0] / (chart[2] * uscale) if chart[2] * uscale else 0.0)
    u, v = sides[0] / cell, sides[1] / cell
    due = [(0.0, 0.0), (u, 0.0), (u, v), (0.0, v)]
    got = [(uscale * chart[k] + udelta, vscale * chart[k + 1] + vdelta) for k in range(0, 8, 2)]
    if any(math.dist(a, b) > ROUNDING * (u + v) for a, b in zip(due, got, strict=True)):
        raise parameters.wrong("uv", "must be places in the rectangle, counted in fields from its corner")
    return entry, cell


def _plane(parameters: Parameters, at: Transform, texture: Texture | None) -> tuple[dict[str, Any], float | None]:
    """The plane that a comment names, refused where the square says another one."""
    plane = next((found for comment in parameters.directive.comments if (found := told(comment))), None)
    if plane is None:
        raise parameters.wrong(
            "", "must have a comment `symrender plane` before it, whose square it is: finite shapes are not read"
        )
    if not at.plain:
        raise parameters.wrong("", "must stand where no transform is: its comment names places of the world")
    if parameters.several("indices", 6, "integer") != _INDICES:
        raise parameters.wrong("indices", "must be 0 1 2 0 2 3, those of a square")
    given = parameters.take("P", "point3")
    places = given.numbers if given else ()
    if len(places) != 12:
        raise parameters.wrong("P" if given else "", f"must have P, 4 places, got {len(places) // 3}")
    charted = parameters.take("uv", "point2")
    chart = charted.numbers if charted else (0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0, 1.0)
    if len(chart) != 8:
        raise parameters.wrong("uv", f"must be 4 pairs, got {len(chart) // 2}")
    parameters.done("indices, P and uv")
    try:
        meant = Plane(name="plane", material="m", **{key: tuple(value) for key, value in plane.items()})  # type: ignore[arg-type]
    except ValueError:
        raise parameters.wrong(
            "", "must have a comment that names a plane, with a normal and a direction along it"
        ) from None
    half = math.dist(places[0:3], places[3:6]) / 2.0
    east, north, _ = frame_of(meant)
    signs = ((-1, -1), (1, -1), (1, 1), (-1, 1))
    due = [p + half * (u * e + v * n) for u, v in signs for p, e, n in zip(meant.point, east, north, strict=True)]
    near = math.isfinite(half) and half > 0.0
    if not near or not all(abs(a - b) <= ROUNDING * (abs(b) + half) for a, b in zip(places, due, strict=True)):
        raise parameters.wrong("P", "must be the square of the plane that its comment names")
    entry = {"type": "plane", **plane}
    if texture is None or texture.dark is None:
        return entry, None
    uscale, vscale, udelta, vdelta = texture.turns
    cell = _agreed(parameters, texture, half / (chart[2] * uscale) if chart[2] * uscale else 0.0)
    fields = [(u * half / cell, v * half / cell) for u, v in signs]
    got = [(uscale * chart[k] + udelta, vscale * chart[k + 1] + vdelta) for k in range(0, 8, 2)]
    if any(math.dist(a, b) > 2.0 * ROUNDING * half / cell for a, b in zip(fields, got, strict=True)):
        raise parameters.wrong("uv", "must be places in the plane, counted in fields from its point")
    return entry, cell
