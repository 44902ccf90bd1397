"""Spheres of a pbrt file, and the squares that stand for planes."""

from __future__ import annotations

import math
from typing import Any

from symrender.scene.mitsuba.plane import frame_of, told
from symrender.scene.pbrt.flats import Triangles, as_flat, disk, read_triangles
from symrender.scene.pbrt.materials import Shelf, Texture
from symrender.scene.pbrt.parameters import Parameters
from symrender.scene.pbrt.transforms import ROUNDING, Transform
from symrender.scene.printable import printable
from symrender.scene.radiometric.shapes import Plane

_INDICES = (0.0, 1.0, 2.0, 0.0, 2.0, 3.0)


def shape(
    parameters: Parameters, at: Transform, texture: Texture | None, shelf: Shelf, turned: bool
) -> tuple[dict[str, Any], float | None]:
    """The entry of a shape without name and material, and the side of the fields of its texture where it has some.

    ``turned`` says whether its orientation is reversed.
    """
    (kind,) = parameters.directive.strings
    charted = texture is not None and texture.charted
    match kind:
        case "sphere":
            return _sphere(parameters, at, texture)
        case "trianglemesh" if any(told(comment) for comment in parameters.directive.comments):
            return _plane(parameters, at, texture)
        case "trianglemesh" | "bilinearmesh":
            return _flat(parameters, at, texture, turned)
        case "plymesh":
            return _ply(parameters, at, shelf, turned), None
        case "disk":
            if charted:
                raise parameters.wrong("", "must have no checker, whose chart on a disk is another here")
            entry = disk(parameters, at)
            return (entry | {"normal": [-x for x in entry["normal"]]} if turned else entry), None
        case "cylinder":
            if charted:
                raise parameters.wrong("", "must have no texture, whose chart on a cylinder is another here")
            return _cylinder(parameters, at), None
        case _:
            known = "sphere, disk, cylinder, trianglemesh, bilinearmesh or plymesh"
            raise parameters.wrong("", f"must be {known}, got {printable(kind)}, a shape not read")


def _ply(parameters: Parameters, at: Transform, shelf: Shelf, turned: bool) -> dict[str, Any]:
    if parameters.given("displacement"):
        raise parameters.wrong("displacement", "must be left out: a mesh is as its file says")
    alpha = parameters.directive.parameters.get("alpha")
    if alpha is not None and alpha.numbers == (1.0,):
        parameters.passed("alpha")
    name = parameters.word("filename", "")
    fields: dict[str, Any] = {"type": "mesh", "file": shelf.path(parameters, "filename", name), "format": "ply"}
    parameters.passed("edgelength")
    parameters.done("filename")
    fields |= {"vertex_normals": "file", "keeps_side": True}
    if turned:
        fields["flip_faces"] = True
    if not at.plain:
        fields["to_world"] = [float(x) for x in at.matrix.ravel()]
    return fields


def _cylinder(parameters: Parameters, at: Transform) -> dict[str, Any]:
    radius = parameters.number("radius", 1.0)
    low, high = parameters.number("zmin", -1.0), parameters.number("zmax", 1.0)
    parameters.must("phimax", parameters.number("phimax", 360.0), 360.0, "parts of cylinders are not read")
    parameters.done("radius, zmin and zmax")
    scale = at.scale()
    if scale is None:
        raise parameters.wrong("", "must be turned, moved and scaled alike in all directions")
    base, top = (at.place((0.0, 0.0, z)) for z in (low, high))
    axis = [b - a for a, b in zip(base, top, strict=True)]
    return {"type": "cylinder", "base": list(base), "axis": axis, "radius": radius * scale, "caps": False}


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
    if texture is not None and texture.image is not None:
        raise parameters.wrong("", "must have no image, whose chart on a sphere is another here")
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


def _flat(
    parameters: Parameters, at: Transform, texture: Texture | None, turned: bool
) -> tuple[dict[str, Any], float | None]:
    """A shape with flat faces, and the side of its fields where it has some."""
    mesh = read_triangles(parameters, at, turned)
    flat = as_flat(parameters, at, mesh)
    if texture is None or not texture.charted:
        return (mesh.entry() if flat is None else flat), None
    cell = None
    if flat is not None and flat["type"] == "rectangle" and texture.dark is not None:
        cell = _cells(parameters, texture, mesh)
    if cell is not None and flat is not None:
        return flat, cell
    if mesh.chart is None:
        raise parameters.wrong("", "must have uv for a texture")
    return mesh.entry(), None


def _cells(parameters: Parameters, texture: Texture, mesh: Triangles) -> float | None:
    """The side of the fields of a checker that begins at the corner of a rectangle; None where it does not."""
    places, rows = mesh.places, mesh.chart
    if rows is None:
        return None
    chart = [float(x) for x in rows.ravel()]
    sides = math.dist(places[0], places[1]), math.dist(places[0], places[3])
    uscale, vscale, udelta, vdelta = texture.turns
    derived = sides[0] / (chart[2] * uscale) if chart[2] * uscale else 0.0
    if not (math.isfinite(derived) and derived > 0.0):
        return None
    cell = derived if texture.cell is None else texture.cell
    u, v = sides[0] / cell, sides[1] / cell
    due = [(0.0, 0.0), (u, 0.0), (u, v), (0.0, v)]
    got = [(uscale * chart[k] + udelta, vscale * chart[k + 1] + vdelta) for k in range(0, 8, 2)]
    if any(math.dist(a, b) > ROUNDING * (u + v) for a, b in zip(due, got, strict=True)):
        if texture.cell is not None:
            raise parameters.wrong("uv", "must be places in the rectangle, counted in fields from its corner")
        return None
    return cell


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
    if texture is not None and texture.image is not None:
        raise parameters.wrong("", "must have no image on a plane")
    if texture is None or texture.dark is None:
        return entry, None
    uscale, vscale, udelta, vdelta = texture.turns
    cell = _agreed(parameters, texture, half / (chart[2] * uscale) if chart[2] * uscale else 0.0)
    fields = [(u * half / cell, v * half / cell) for u, v in signs]
    got = [(uscale * chart[k] + udelta, vscale * chart[k + 1] + vdelta) for k in range(0, 8, 2)]
    if any(math.dist(a, b) > 2.0 * ROUNDING * half / cell for a, b in zip(fields, got, strict=True)):
        raise parameters.wrong("uv", "must be places in the plane, counted in fields from its point")
    return entry, cell
