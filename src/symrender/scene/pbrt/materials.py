"""Textures and materials of a pbrt file: diffuse and rough metal, of one number or in the fields of a checker."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Final

from symrender.scene.document import Mark
from symrender.scene.mitsuba.plane import told_cell
from symrender.scene.pbrt.parameters import Parameters
from symrender.scene.printable import printable

SMOOTHEST: Final = 1e-3
"""Roughness below which pbrt takes a conductor for a mirror."""


@dataclass(frozen=True)
class Texture:
    """A number, or fields of two: ``turns`` are uscale, vscale, udelta, vdelta, ``cell`` is what a comment says."""

    bright: float
    dark: float | None = None
    turns: tuple[float, float, float, float] = (1.0, 1.0, 0.0, 0.0)
    cell: float | None = None


@dataclass(frozen=True)
class Surface:
    """A material: its entry without a reflectance, that as a texture, its name where one is told, where it stands."""

    entry: dict[str, Any]
    texture: Texture | None
    name: str
    mark: Mark


DEFAULT: Final = Texture(0.5)
"""What a diffuse surface reflects if nobody says."""


def texture(parameters: Parameters, known: dict[str, Texture]) -> tuple[str, Texture]:
    """Name and meaning of a directive ``Texture``."""
    name, kind, plugin = parameters.directive.strings
    if name in known:
        raise parameters.wrong("", f"must have a name of its own, got {printable(name)} for a second one")
    parameters.must("", kind, "spectrum", "other textures are not read")
    match plugin:
        case "constant":
            found = Texture(parameters.grey("value", 1.0))
            parameters.done("value")
        case "scale":
            inner = parameters.take("tex", "texture", "rgb", "spectrum", "blackbody")
            by = parameters.number("scale", 1.0)
            if inner is not None and inner.type == "texture":
                found = _named(parameters, "tex", inner.strings[0], known)
            else:
                found = Texture(parameters.grey("tex", 1.0))
            dark = None if found.dark is None else by * found.dark
            found = replace(found, bright=by * found.bright, dark=dark)
            parameters.done("tex and scale")
        case "checkerboard":
            found = _checkerboard(parameters, known)
        case "imagemap" | "ptex":
            raise parameters.wrong("", f"must be of numbers, got {plugin}: nothing beside the file itself is opened")
        case _:
            known_ones = "constant, scale or checkerboard"
            raise parameters.wrong("", f"must be {known_ones}, got {printable(plugin)}, a texture no scene has")
    return name, found


def _checkerboard(parameters: Parameters, known: dict[str, Texture]) -> Texture:
    parameters.must("dimension", parameters.number("dimension", 2.0, "integer"), 2.0, "fields are those of u and v")
    parameters.must("mapping", parameters.word("mapping", "uv"), "uv", "fields are those of u and v")
    turns = tuple(parameters.number(n, d) for n, d in zip(("uscale", "vscale", "udelta", "vdelta"),
                                                         (1.0, 1.0, 0.0, 0.0), strict=True))  # fmt: skip
    tones = []
    for name, default in (("tex1", 1.0), ("tex2", 0.0)):
        tone = spectrum(parameters, name, known, Texture(default))
        if tone.dark is not None:
            raise parameters.wrong(name, "must be one number, got fields within fields")
        tones.append(tone.bright)
    parameters.done("tex1, tex2, uscale, vscale, udelta and vdelta")
    cells = (told_cell(comment) for comment in parameters.directive.comments)
    cell = next((c for c in cells if c is not None and c > 0.0), None)
    return Texture(tones[0], tones[1], (turns[0], turns[1], turns[2], turns[3]), cell)


def _named(parameters: Parameters, name: str, given: str, known: dict[str, Texture]) -> Texture:
    if given not in known:
        raise parameters.wrong(name, f"must be a texture given before, got {printable(given)}")
    return known[given]


def spectrum(parameters: Parameters, name: str, known: dict[str, Texture], default: Texture) -> Texture:
    """A reflectance: a number, or a texture given before."""
    given = parameters.directive.parameters.get(name)
    if given is not None and given.type == "texture":
        parameters.passed(name)
        return _named(parameters, name, given.strings[0], known)
    return Texture(parameters.grey(name)) if given is not None else default


def surface(parameters: Parameters, plugin: str, name: str, known: dict[str, Texture]) -> Surface:
    """The meaning of a material of pbrt, which reflects on both sides."""
    match plugin:
        case "diffuse":
            entry: dict[str, Any] = {"type": "diffuse", "two_sided": True}
            found = spectrum(parameters, "reflectance", known, DEFAULT)
            parameters.done("reflectance")
            return Surface(entry, found, name, parameters.mark)
        case "conductor":
            return Surface(_conductor(parameters), None, name, parameters.mark)
        case _:
            raise parameters.wrong(
                "", f"must be diffuse or conductor, got {printable(plugin) or 'no type'}, a material no scene has"
            )


def _conductor(parameters: Parameters) -> dict[str, Any]:
    if parameters.given("reflectance"):
        raise parameters.wrong("reflectance", "must be left out: eta and k say what a conductor is")
    eta, k = parameters.grey("eta"), parameters.grey("k")
    both = parameters.number("roughness", 0.0)
    u, v = parameters.number("uroughness", both), parameters.number("vroughness", both)
    parameters.must("vroughness", v, u, "facets of a scene lie alike in all directions")
    where = "uroughness" if parameters.given("uroughness") else "roughness"
    if not u >= SMOOTHEST:
        raise parameters.wrong(where, f"must be at least {SMOOTHEST:g}, got {u:g}: pbrt makes a mirror of it")
    why = "pbrt would take the roughness for another alpha"
    parameters.must("remaproughness", parameters.word("remaproughness", "true", "bool"), "false", why)
    parameters.done("eta, k, roughness, uroughness, vroughness and remaproughness")
    return {"type": "conductor", "distribution": "ggx", "masking": "correlated", "alpha": u, "eta": [eta] * 3,
            "k": [k] * 3, "two_sided": True}  # fmt: skip


def entry_of(found: Surface, cell: float | None) -> dict[str, Any]:
    """The material as an entry of a scene, its fields of the side ``cell``."""
    if found.texture is None:
        return found.entry
    bright, dark = found.texture.bright, found.texture.dark
    if dark is None:
        return found.entry | {"reflectance": {"type": "solid", "color": [bright] * 3}}
    return found.entry | {"reflectance": {"type": "checker", "bright": [bright] * 3, "dark": [dark] * 3, "cell": cell}}
