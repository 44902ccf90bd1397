"""A pbrt-v4 scene file as the radiometric scene that means the same; the rest is refused by name and line.

What is read is what has an exact meaning here, which is what ``export --to pbrt`` writes: grey light and reflectance,
spheres, squares that stand for planes, the box filter. pbrt reflects on both sides of a surface, and so do these.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import PurePath
from typing import Any, Final

from symrender.limits import MAX_NAME, MAX_PART_NAME
from symrender.scene.document import Document, Malformed, Mark, Path
from symrender.scene.mitsuba.plane import frame_of, told, told_cell
from symrender.scene.pbrt.directives import Directive, directives
from symrender.scene.printable import printable
from symrender.scene.radiometric.shapes import Plane

_PART: Final = re.compile(r"(shapes|lights|materials)\.([A-Za-z][A-Za-z0-9_-]*)")
_DEEPEST: Final = 32
_ENDLESS: Final = 1000
"""``maxdepth`` from which on all bounces are meant."""
_CLOSE: Final = 1e-12


@dataclass
class _State:
    """What ``AttributeBegin`` keeps: where the origin is, whether turned by half, the material, what emits."""

    place: tuple[float, float, float] = (0.0, 0.0, 0.0)
    turned: bool = False
    material: tuple[dict[str, Any], str, Mark] | None = None
    lamp: tuple[dict[str, Any], Mark] | None = None


@dataclass
class _Scene:
    """What was read so far: plain data, and where each piece stands."""

    data: dict[str, Any]
    marks: dict[Path, Mark] = field(default_factory=lambda: {(): Mark(1, 1)})
    state: _State = field(default_factory=_State)
    kept: list[_State] = field(default_factory=list)
    textures: dict[str, dict[str, Any]] = field(default_factory=dict)
    named: dict[str, tuple[dict[str, Any], str, Mark]] = field(default_factory=dict)
    head: dict[str, Directive] = field(default_factory=dict)
    world: bool = False

    def put(self, key: str, entry: dict[str, Any], mark: Mark) -> None:
        """Append to a list of parts."""
        path: Path = (key, len(self.data[key]))
        self.marks[path] = mark
        for name in entry:
            self.marks[(*path, name)] = mark
        self.data[key].append(entry)

    def name(self, at: Directive, key: str) -> str:
        """The name of a part: that of a comment ``lights.NAME`` before it, or its number."""
        for comment in reversed(at.comments):
            found = _PART.fullmatch(comment)
            if found and found[1] == key:
                return found[2][:MAX_PART_NAME]
        return f"{key[:-1]}{len(self.data[key]) + 1}"


def parse_pbrt(text: str, origin: str) -> Document:
    """The scene of a pbrt file as plain data; Malformed says which line has no meaning here, and why."""
    stem = re.sub(r"\.(red|green|blue)$", "", PurePath(origin).stem)[:MAX_NAME] or "scene"
    read = _Scene({"units": "radiometric", "name": stem, "materials": {}, "shapes": [], "lights": []})
    for at in directives(text):
        if not read.world:
            _before(read, at)
        else:
            _within(read, at)
    if not read.world:
        raise Malformed("scene: needs WorldBegin", Mark.at(text, len(text)))
    if read.kept:
        raise Malformed("scene: an AttributeBegin has no end", Mark.at(text, len(text)))
    return Document(read.data, origin, read.marks)


def _before(read: _Scene, at: Directive) -> None:
    """A directive before ``WorldBegin``: who looks, and how."""
    if at.name == "WorldBegin":
        _head(read, at)
        read.world = True
        return
    if at.name not in ("Integrator", "Sampler", "PixelFilter", "Film", "Scale", "LookAt", "Camera"):
        raise at.wrong("cannot stand before WorldBegin")
    if at.name in read.head:
        raise at.wrong("is given twice")
    turning = {"LookAt": ("Camera",), "Scale": ("LookAt", "Camera")}.get(at.name, ())
    if any(later in read.head for later in turning):
        raise at.wrong("must come before LookAt and Camera, in the order Scale, LookAt, Camera")
    read.head[at.name] = at


def _head(read: _Scene, world: Directive) -> None:
    for name in ("Integrator", "PixelFilter", "Film", "Scale", "LookAt", "Camera"):
        if name not in read.head:
            why = {
                "PixelFilter": "; without one pbrt filters by a Gaussian",
                "Scale": " -1 1 1; without it pbrt's picture is that of a mirrored scene",
            }
            raise world.wrong(f"before it must come {name}{why.get(name, '')}")
    integrator, filter_, film = (read.head[name] for name in ("Integrator", "PixelFilter", "Film"))
    if integrator.arguments[0] not in ("path", "volpath"):
        raise integrator.wrong("must be path or volpath")
    depth = integrator.one("maxdepth", "integer", 5.0)
    integrator.done("maxdepth")
    if depth not in (1.0, 2.0) and depth < _ENDLESS:
        raise integrator.wrong(f"maxdepth must be 1 (direct light), 2 (one bounce) or {_ENDLESS} (all), got {depth:g}")
    read.data["bounces"] = "all" if depth >= _ENDLESS else int(depth) - 1
    read.marks[("bounces",)] = integrator.mark
    radii = [filter_.one(f"{axis}radius", "float", 0.5) for axis in "xy"]
    if filter_.arguments[0] != "box" or radii != [0.5, 0.5]:
        raise filter_.wrong("must be a box of radius 0.5, one pixel")
    filter_.done("xradius and yradius")
    if read.head["Scale"].arguments != [-1.0, 1.0, 1.0]:
        raise read.head["Scale"].wrong("must be -1 1 1, which makes pbrt's left-handed coordinates those of a scene")
    _camera(read, film)


def _camera(read: _Scene, film: Directive) -> None:
    camera, look = read.head["Camera"], read.head["LookAt"]
    if camera.arguments[0] != "perspective":
        raise camera.wrong("must be perspective")
    wide = film.one("xresolution", "integer", 1280.0) / film.one("yresolution", "integer", 720.0)
    fov = camera.one("fov", "float", 90.0)
    window = camera.numbers("screenwindow", "float", 4, [-wide, wide, -1.0, 1.0] if wide >= 1.0 else [])
    if not window or any(abs(a - b) > _CLOSE * wide for a, b in zip(window, (-wide, wide, -1, 1), strict=True)):
        raise camera.wrong("screenwindow must be -w w -1 1 of a film w times as wide as high: fov is the vertical one")
    camera.done("fov and screenwindow")
    eye, target, up = (look.arguments[k : k + 3] for k in (0, 3, 6))
    read.data["camera"] = {"type": "look_at", "eye": eye, "target": target, "up": up, "fov": fov}
    read.marks[("camera",)] = camera.mark
    for key in ("eye", "target", "up"):
        read.marks[("camera", key)] = look.mark


def _within(read: _Scene, at: Directive) -> None:
    """A directive of the world."""
    state = read.state
    match at.name:
        case "AttributeBegin":
            if len(read.kept) >= _DEEPEST:
                raise at.wrong(f"nested more than {_DEEPEST} deep")
            read.kept.append(_State(state.place, state.turned, state.material, state.lamp))
        case "AttributeEnd":
            if not read.kept:
                raise at.wrong("ends what was not begun")
            read.state = read.kept.pop()
        case "Translate":
            if state.turned:
                raise at.wrong("must come before Rotate")
            x, y, z = (float(a) + p for a, p in zip(at.arguments, state.place, strict=True))
            state.place = (x, y, z)
        case "Rotate":
            if at.arguments != [180.0, 0.0, 0.0, 1.0] or state.turned:
                raise at.wrong("must be 180 0 0 1, once, which turns a checker to where it begins here")
            state.turned = True
        case "Texture":
            _texture(read, at)
        case "Material":
            state.material = (*_material(read, at, str(at.arguments[0])), at.mark)
        case "MakeNamedMaterial":
            if at.arguments[0] in read.named:
                raise at.wrong("is given twice")
            kind = str(at.word("type", "string", ""))
            made, _ = _material(read, at, kind)
            read.named[str(at.arguments[0])] = (made, _safe(str(at.arguments[0])), at.mark)
        case "NamedMaterial":
            if at.arguments[0] not in read.named:
                raise at.wrong("no material has this name")
            state.material = read.named[str(at.arguments[0])]
        case "LightSource":
            _light(read, at)
        case "AreaLightSource":
            _area(read, at)
        case "Shape":
            _shape(read, at)
        case _:
            raise at.wrong("cannot stand after WorldBegin")


def _safe(text: str) -> str:
    name = re.sub(r"[^A-Za-z0-9_-]", "_", text)[:MAX_PART_NAME]
    return name if name[:1].isalpha() else ""


def _texture(read: _Scene, at: Directive) -> None:
    name, kind, what = map(str, at.arguments)
    if kind != "spectrum" or what != "checkerboard":
        raise at.wrong(f"no such texture here, {printable(kind)} {printable(what)}; known is spectrum checkerboard")
    if name in read.textures:
        raise at.wrong("is given twice")
    cell = next((cell for comment in at.comments if (cell := told_cell(comment))), None)
    if cell is None:
        raise at.wrong("its chart is not known: a comment `symrender cell: LENGTH` would say it")
    scales = [at.one(f"{axis}{part}", "float", default) for part, default in (("scale", 1.0), ("delta", 0.0))
              for axis in "uv"]  # fmt: skip
    bright, dark = at.grey("tex1", 1.0), at.grey("tex2", 0.0)
    at.done("tex1, tex2, uscale, vscale, udelta and vdelta")
    read.textures[name] = {"type": "checker", "bright": bright, "dark": dark, "cell": cell, "scales": scales}


def _material(read: _Scene, at: Directive, kind: str) -> tuple[dict[str, Any], str]:
    """A material and its name, "" where no comment names it."""
    name = next((m[2] for comment in at.comments if (m := _PART.fullmatch(comment)) and m[1] == "materials"), "")
    if kind == "diffuse":
        held = at.parameters.get("reflectance")
        if held is not None and held.type == "texture":
            texture = at.word("reflectance", "texture", "")
            if texture not in read.textures:
                raise at.wrong(f"no texture has the name {printable(str(texture))}", held.mark)
            reflectance: Any = dict(read.textures[str(texture)])
        else:
            reflectance = at.grey("reflectance", 0.5)
        at.done("reflectance")
        return {"type": "diffuse", "reflectance": reflectance, "two_sided": True}, name
    if kind != "conductor":
        raise at.wrong("no such material here; known are diffuse and conductor")
    if at.word("remaproughness", "bool", True) is not False:
        raise at.wrong("remaproughness must be false: then roughness is the alpha of GGX")
    alpha = at.one("roughness", "float")
    index = {part: _constant(at, part) for part in ("eta", "k")}
    at.done("eta, k, roughness and remaproughness")
    material = {"type": "conductor", "distribution": "ggx", "alpha": alpha, **index, "masking": "correlated"}
    return material | {"two_sided": True}, name


def _constant(at: Directive, name: str) -> float:
    """The number of a spectrum of two wavelengths around all light, equal at both."""
    first, value, last, other = at.numbers(name, "spectrum", 4)
    if value != other or not (first <= 360.0 and last >= 830.0):
        raise at.wrong(f"{name} must be one number at two wavelengths around 360 to 830, got {first:g} to {last:g}")
    return value


def _light(read: _Scene, at: Directive) -> None:
    name, kind, scale = read.name(at, "lights"), at.arguments[0], at.one("scale", "float", 1.0)
    if kind == "point":
        place = at.numbers("from", "point3", 3, [0.0, 0.0, 0.0])
        entry = {"type": "point", "position": _moved(read, at, place), "intensity": scale * at.grey("I", 1.0)}
        at.done("I, scale and from")
    elif kind == "distant":
        start, end = at.numbers("from", "point3", 3, [0.0, 0.0, 0.0]), at.numbers("to", "point3", 3, [0.0, 0.0, 1.0])
        way = [b - a for a, b in zip(start, end, strict=True)]
        entry = {"type": "directional", "direction": way, "irradiance": scale * at.grey("L", 1.0)}
        at.done("L, scale, from and to")
    elif kind == "infinite":
        entry = {"type": "sky", "radiance": scale * at.grey("L", 1.0)}
        at.done("L and scale")
    else:
        raise at.wrong("no such light here; known are point, distant and infinite")
    read.put("lights", {"name": name, **entry}, at.mark)


def _moved(read: _Scene, at: Directive, place: list[float]) -> list[float]:
    if read.state.turned:
        raise at.wrong("cannot be turned")
    return [a + p for a, p in zip(place, read.state.place, strict=True)]


def _area(read: _Scene, at: Directive) -> None:
    if at.arguments[0] != "diffuse":
        raise at.wrong("must be diffuse")
    if at.word("twosided", "bool", False) is not False:
        raise at.wrong("twosided must be false: a sphere emits outside")
    entry = {
        "type": "area",
        "name": read.name(at, "lights"),
        "radiance": at.one("scale", "float", 1.0) * at.grey("L", 1.0),
    }
    at.done("L, scale and twosided")
    read.state.lamp = (entry, at.mark)


def _shape(read: _Scene, at: Directive) -> None:
    name, plane = read.name(at, "shapes"), next((p for comment in at.comments if (p := told(comment))), None)
    if read.state.material is None:
        raise at.wrong("needs a Material before it: pbrt's own has no name here")
    material, called, mark = read.state.material
    texture = material["reflectance"] if isinstance(material.get("reflectance"), dict) else None
    if at.arguments[0] == "sphere":
        radius = at.one("radius", "float", 1.0)
        at.done("radius")
        entry: dict[str, Any] = {"type": "sphere", "center": list(read.state.place), "radius": radius}
        due = [2.0 / texture["cell"], -1.0 / texture["cell"], 0.0, 1.0 / texture["cell"]] if texture else []
        if read.state.turned != bool(texture):
            raise at.wrong("Rotate 180 0 0 1 is for a checker, and a checker needs it")
    elif at.arguments[0] == "trianglemesh" and plane is not None:
        entry = {"type": "plane", **plane}
        _square(read, at, plane, texture)
        due = [1.0, 1.0, 0.0, 0.0]
    else:
        raise at.wrong("no such shape here; known are sphere, and trianglemesh with a comment `symrender plane`")
    if texture and any(abs(a - b) > _CLOSE * (1.0 + abs(b)) for a, b in zip(texture["scales"], due, strict=True)):
        raise at.wrong("the scales of its texture are not those of a checker of the cell that a comment names")
    known = {key: value for key, value in texture.items() if key != "scales"} if texture else None
    material = material | ({"reflectance": known} if known else {})
    called = called or f"of_{name}"[:MAX_PART_NAME]
    if read.data["materials"].setdefault(called, material) != material:
        raise Malformed(f"materials.{called}: two different materials have this name", mark)
    read.marks.setdefault(("materials", called), mark)
    read.put("shapes", {"name": name, "material": called, **entry}, at.mark)
    if read.state.lamp is not None:
        lamp, where = read.state.lamp
        read.put("lights", {**lamp, "shape": name}, where)


def _square(read: _Scene, at: Directive, plane: dict[str, list[float]], texture: dict[str, Any] | None) -> None:
    """Refuse two triangles that are not a square of the plane that a comment names."""
    try:
        named: dict[str, Any] = {key: tuple(value) for key, value in plane.items()}
        east, north, _ = frame_of(Plane(type="plane", name="p", material="m", **named))
    except ValueError:
        raise at.wrong("its comment names no plane") from None
    if read.state.place != (0.0, 0.0, 0.0) or read.state.turned:
        raise at.wrong("a plane stands where its comment says, under no Translate or Rotate")
    corners, places = (
        at.numbers("P", "point3", 12),
        at.numbers("uv", "point2", 8, [-1.0, -1.0, 1.0, -1.0, 1.0, 1.0, -1.0, 1.0]),
    )
    if at.numbers("indices", "integer", 6) != [0.0, 1.0, 2.0, 0.0, 2.0, 3.0]:
        raise at.wrong("indices must be 0 1 2 0 2 3, a square")
    at.done("indices, P and uv")
    half = 0.5 * sum((a - b) ** 2 for a, b in zip(corners[3:6], corners[:3], strict=True)) ** 0.5
    size = half + max(map(abs, plane["point"]))
    for k, (u, v) in enumerate(((-1, -1), (1, -1), (1, 1), (-1, 1))):
        due = [p + half * (u * e + v * n) for p, e, n in zip(plane["point"], east, north, strict=True)]
        if any(abs(a - b) > _CLOSE * size for a, b in zip(corners[3 * k : 3 * k + 3], due, strict=True)):
            raise at.wrong("its corners are not those of a square of the plane that its comment names")
    if texture:
        turns = half / texture["cell"]
        due_uv = [sign * turns for sign in (-1, -1, 1, -1, 1, 1, -1, 1)]
        if abs(turns / 2 - round(turns / 2)) > 1e-9 * turns or any(
            abs(a - b) > _CLOSE * turns for a, b in zip(places, due_uv, strict=True)
        ):
            raise at.wrong("its uv are not those of a checker of the cell that a comment names")
