"""Textures and materials of a pbrt file, which reflect on both sides."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any, Final

from symrender.errors import SceneError
from symrender.scene.document import Mark
from symrender.scene.files import Opener, found
from symrender.scene.mitsuba.plane import told_cell
from symrender.scene.pbrt.parameters import Parameters
from symrender.scene.printable import printable
from symrender.scene.spectra.curves import Rgb

SMOOTHEST: Final = 1e-3
"""Roughness below which pbrt takes a surface for smooth."""
_WRAPS: Final = {"repeat": "repeat", "clamp": "clamp"}
_FILTERS: Final = {
    "bilinear": "bilinear",
    "point": "nearest",
    "trilinear": "bilinear",
    "EWA": "bilinear",
    "ewa": "bilinear",
}
_GLASSES: Final = {"glass-BK7": 1.5168, "glass-BAF10": 1.67003, "glass-FK51A": 1.48656, "glass-LASF9": 1.85025}
"""Indices at 587.6 nm of glasses that pbrt knows by name."""
_METALS: Final = {"metal-Ag": "Ag", "metal-Al": "Al", "metal-Au": "Au", "metal-Cu": "Cu"}
COATED: Final = (
    "coateddiffuse is computed as plastic, in closed form; pbrt walks at random, no farther than its maxdepth"
)
KNOWN: Final = "diffuse, conductor, dielectric, thindielectric and coateddiffuse"


@dataclass(frozen=True)
class Texture:
    """A colour, fields of two, or an image.

    ``turns`` are uscale, vscale, udelta, vdelta, ``cell`` is what a comment says.
    """

    bright: Rgb
    dark: Rgb | None = None
    turns: tuple[float, float, float, float] = (1.0, 1.0, 0.0, 0.0)
    cell: float | None = None
    image: dict[str, Any] | None = None

    @property
    def charted(self) -> bool:
        """Whether it depends on the place."""
        return self.dark is not None or self.image is not None


@dataclass(frozen=True)
class Surface:
    """A material: its entry without a reflectance, that as a texture, its name where one is told, where it stands."""

    entry: dict[str, Any]
    texture: Texture | None
    name: str
    mark: Mark
    field: str = "reflectance"


DEFAULT: Final = Texture((0.5, 0.5, 0.5))
"""What a diffuse surface reflects if nobody says."""


class Shelf:
    """Textures by name, what opens files, and notes of what is not as the file says."""

    def __init__(self, opener: Opener) -> None:
        self.opener = opener
        self.textures: dict[str, Texture] = {}
        self.numbers: dict[str, float] = {}
        self.notes: dict[str, None] = {}

    def colour(self, parameters: Parameters, name: str, default: Rgb | None = None) -> Rgb | None:
        """A reflectance that is no texture."""
        return parameters.colour(name, "reflects", self.opener, default)

    def texture(self, parameters: Parameters, name: str, default: Texture) -> Texture:
        """A reflectance: a colour, or a texture given before."""
        given = parameters.directive.parameters.get(name)
        if given is not None and given.type == "texture":
            parameters.passed(name)
            if given.strings[0] not in self.textures:
                raise parameters.wrong(name, f"must be a texture given before, got {printable(given.strings[0])}")
            return self.textures[given.strings[0]]
        colour = self.colour(parameters, name)
        return default if colour is None else Texture(colour)

    def number(self, parameters: Parameters, name: str, default: float) -> float:
        """A number, or a texture of one number given before."""
        given = parameters.directive.parameters.get(name)
        if given is not None and given.type == "texture":
            parameters.passed(name)
            if given.strings[0] not in self.numbers:
                raise parameters.wrong(name, "must be one number: a texture there is not supported")
            return self.numbers[given.strings[0]]
        return parameters.number(name, default)

    def put(self, parameters: Parameters) -> None:
        """Take in a directive ``Texture``."""
        name, kind, plugin = parameters.directive.strings
        if name in (self.textures if kind == "spectrum" else self.numbers):
            raise parameters.wrong("", f"must have a name of its own, got {printable(name)} for a second one")
        if kind == "float":
            self._put_number(parameters, name, plugin)
            return
        if kind != "spectrum":
            parameters.must("", kind, "spectrum or float")
        match plugin:
            case "constant":
                made = Texture(self.colour(parameters, "value", (1.0, 1.0, 1.0)) or (1.0, 1.0, 1.0))
                parameters.done("value")
            case "scale":
                made = self._scaled(parameters)
            case "checkerboard":
                made = self._checkerboard(parameters)
            case "imagemap":
                made = self._image(parameters)
            case _:
                known = "constant, scale, checkerboard or imagemap"
                raise parameters.wrong("", f"must be {known}, got {printable(plugin)}, a texture no scene has")
        self.textures[name] = made

    def _put_number(self, parameters: Parameters, name: str, plugin: str) -> None:
        if plugin == "constant":
            self.numbers[name] = parameters.number("value", 1.0)
            parameters.done("value")
        # a texture of numbers that varies is refused where it is used

    def _scaled(self, parameters: Parameters) -> Texture:
        inner = self.texture(parameters, "tex", Texture((1.0, 1.0, 1.0)))
        by = self.number(parameters, "scale", 1.0)
        parameters.done("tex and scale")
        if inner.image is not None and by != 1.0:
            raise parameters.wrong("scale", f"must be 1 of an image, got {by:g}")
        bright, dark = ((None if c is None else (by * c[0], by * c[1], by * c[2])) for c in (inner.bright, inner.dark))
        return replace(inner, bright=bright or inner.bright, dark=dark)

    def _turns(self, parameters: Parameters) -> tuple[float, float, float, float]:
        parameters.must("mapping", parameters.word("mapping", "uv"), "uv", "places are those of u and v")
        names, defaults = ("uscale", "vscale", "udelta", "vdelta"), (1.0, 1.0, 0.0, 0.0)
        a, b, c, d = (parameters.number(n, default) for n, default in zip(names, defaults, strict=True))
        return a, b, c, d

    def _checkerboard(self, parameters: Parameters) -> Texture:
        parameters.must("dimension", parameters.number("dimension", 2.0, "integer"), 2.0, "fields are those of u and v")
        turns = self._turns(parameters)
        tones = []
        for name, default in (("tex1", 1.0), ("tex2", 0.0)):
            tone = self.texture(parameters, name, Texture((default,) * 3))
            if tone.charted:
                raise parameters.wrong(name, "must be one colour, got a texture within fields")
            tones.append(tone.bright)
        parameters.done("tex1, tex2, uscale, vscale, udelta and vdelta")
        cells = (told_cell(comment) for comment in parameters.directive.comments)
        cell = next((c for c in cells if c is not None and c > 0.0), None)
        return Texture(tones[0], tones[1], turns, cell)

    def _image(self, parameters: Parameters) -> Texture:
        turns = self._turns(parameters)
        name = parameters.word("filename", "")
        wrap, kind = parameters.word("wrap", "repeat"), parameters.word("filter", "bilinear")
        for given, choices, what in ((wrap, _WRAPS, "wrap"), (kind, _FILTERS, "filter")):
            if given not in choices:
                raise parameters.wrong(what, f"must be {' or '.join(choices)}, got {printable(given)}")
        parameters.must("scale", parameters.number("scale", 1.0), 1.0, "an image is not scaled")
        parameters.must("invert", parameters.word("invert", "false", "bool"), "false", "an image is not inverted")
        encoding = parameters.word("encoding", "sRGB")
        if encoding not in ("sRGB", "linear"):
            raise parameters.wrong("encoding", f"must be sRGB or linear, got {printable(encoding)}")
        parameters.passed("maxanisotropy")
        parameters.done("filename, wrap, filter, encoding, uscale, vscale, udelta and vdelta")
        image = {"type": "image", "file": self.path(parameters, "filename", name), "filter": _FILTERS[kind]}
        image |= {"wrap": _WRAPS[wrap], "encoding": "srgb" if encoding == "sRGB" else "raw"}
        return Texture((1.0, 1.0, 1.0), None, turns, None, image)

    def path(self, parameters: Parameters, name: str, file: str) -> str:
        """The name by which the opener opens a file."""
        if not file:
            raise parameters.wrong("", f"must have a {name}")
        try:
            return found(file, [""], self.opener)
        except SceneError as error:
            raise parameters.wrong(name, str(error)) from None


def surface(parameters: Parameters, plugin: str, name: str, shelf: Shelf) -> Surface:
    """The meaning of a material of pbrt."""
    mark = parameters.mark
    for what in ("displacement", "normalmap"):
        if parameters.given(what):
            raise parameters.wrong(what, "must be left out: a surface is as smooth as its shape")
    match plugin:
        case "diffuse":
            found = shelf.texture(parameters, "reflectance", DEFAULT)
            parameters.done("reflectance")
            return Surface({"type": "diffuse", "two_sided": True}, found, name, mark)
        case "conductor":
            return Surface(_conductor(parameters, shelf), None, name, mark)
        case "dielectric" | "thindielectric":
            entry: dict[str, Any] = {"type": "dielectric", "ior": _index(parameters, shelf)}
            if plugin == "thindielectric":
                entry["thin"] = True
            else:
                entry |= _roughness(parameters, shelf)
            parameters.done("eta, roughness, uroughness, vroughness and remaproughness")
            return Surface(entry, None, name, mark)
        case "coateddiffuse":
            return _coated(parameters, name, shelf)
        case _:
            raise parameters.wrong(
                "", f"must be {KNOWN}, got {printable(plugin) or 'no type'}, a material no scene has"
            )


def _coated(parameters: Parameters, name: str, shelf: Shelf) -> Surface:
    """A coat over a diffuse base: in the limit of all bounces between them it is plastic with ``nonlinear``."""
    found = shelf.texture(parameters, "reflectance", DEFAULT)
    if (shelf.colour(parameters, "albedo", (0.0, 0.0, 0.0)) or (1.0,)) != (0.0, 0.0, 0.0):
        raise parameters.wrong("albedo", "must be 0: nothing scatters in a coat")
    entry = {"type": "plastic", "ior": _index(parameters, shelf), "nonlinear": True, "two_sided": True}
    entry |= _roughness(parameters, shelf)
    parameters.passed("thickness", "g", "maxdepth", "nsamples")
    parameters.done("reflectance, eta, roughness, uroughness, vroughness and remaproughness")
    shelf.notes[COATED] = None
    return Surface(entry, found, name, parameters.mark, "diffuse")


def _index(parameters: Parameters, shelf: Shelf) -> float:
    """The index of refraction of a dielectric; of a glass by name at 587.6 nm."""
    given = parameters.directive.parameters.get("eta")
    if given is None or given.type in ("float", "texture"):
        return shelf.number(parameters, "eta", 1.5)
    if given.type == "spectrum" and given.strings and given.strings[0] in _GLASSES:
        parameters.passed("eta")
        shelf.notes[f"{given.strings[0]} is taken with its index at 587.6 nm: colours do not part"] = None
        return _GLASSES[given.strings[0]]
    colour = parameters.colour("eta", "index", shelf.opener)
    if colour is None or len(set(colour)) != 1:
        raise parameters.wrong("eta", "must be one number at all wavelengths, or a glass by name")
    return colour[0]


def _roughness(parameters: Parameters, shelf: Shelf) -> dict[str, Any]:
    both = shelf.number(parameters, "roughness", 0.0)
    u, v = (shelf.number(parameters, f"{axis}roughness", both) for axis in "uv")
    parameters.must("vroughness", v, u, "facets of a scene lie alike in all directions")
    if not u >= 0.0:
        raise parameters.wrong(
            "uroughness" if parameters.given("uroughness") else "roughness", f"must be >= 0, got {u:g}"
        )
    alpha = math.sqrt(u) if parameters.word("remaproughness", "true", "bool") == "true" else u
    if alpha < SMOOTHEST:
        return {"alpha": 0.0}
    return {"distribution": "ggx", "masking": "correlated", "alpha": alpha}


def _conductor(parameters: Parameters, shelf: Shelf) -> dict[str, Any]:
    entry: dict[str, Any] = {"type": "conductor", **_roughness(parameters, shelf), "two_sided": True}
    if parameters.given("reflectance"):
        if parameters.given("eta") or parameters.given("k"):
            raise parameters.wrong("reflectance", "must be left out: eta and k say what a conductor is")
        tone = shelf.texture(parameters, "reflectance", DEFAULT)
        if tone.charted:
            raise parameters.wrong("reflectance", "must be one colour of a conductor")
        shares = [min(max(c, 0.0), 0.9999) for c in tone.bright]
        entry |= {"eta": [1.0] * 3, "k": [2.0 * math.sqrt(c) / math.sqrt(1.0 - c) for c in shares]}
    elif (metal := _metal(parameters)) is not None:
        entry["material"] = metal
    else:
        for name in ("eta", "k"):
            colour = parameters.colour(name, "index", shelf.opener)
            if colour is None:
                raise parameters.wrong("", f"must have eta and k, or none of them, got no {name}")
            entry[name] = list(colour)
    parameters.done("eta, k, reflectance, roughness, uroughness, vroughness and remaproughness")
    return entry


def _metal(parameters: Parameters) -> str | None:
    """The metal that eta and k name, copper where there are none; None where they are numbers."""
    named = set()
    for name in ("eta", "k"):
        given = parameters.directive.parameters.get(name)
        text = given.strings[0] if given is not None and given.type == "spectrum" and given.strings else ""
        if given is None:
            text = f"metal-Cu-{name}"
        if not text.startswith("metal-"):
            return None
        named.add(text.removesuffix(f"-{name}"))
    metal = _METALS.get(named.pop()) if len(named) == 1 else None
    if metal is None:
        where = "eta" if parameters.given("eta") else "k"
        raise parameters.wrong(where, f"must be of one metal of {', '.join(_METALS)}, as metal-Cu-eta and metal-Cu-k")
    parameters.passed("eta", "k")
    return metal


def entry_of(found: Surface, cell: float | None) -> dict[str, Any]:
    """The material as an entry of a scene, its fields of the side ``cell``, or in (u, v) where there is none."""
    texture = found.texture
    if texture is None:
        return found.entry
    uscale, vscale, udelta, vdelta = texture.turns
    if texture.image is not None:
        # t of pbrt grows upwards, v of an image down
        put: dict[str, Any] = {**texture.image, "scale": [uscale, -vscale], "offset": [udelta, 1.0 - vdelta]}
    elif texture.dark is None:
        put = {"type": "solid", "color": list(texture.bright)}
    elif cell is None:
        put = {"type": "checkerboard", "scale": [0.5 * uscale, 0.5 * vscale], "offset": [0.5 * udelta, 0.5 * vdelta]}
        put |= {"bright": list(texture.bright), "dark": list(texture.dark)}
    else:
        put = {"type": "checker", "bright": list(texture.bright), "dark": list(texture.dark), "cell": cell}
    return found.entry | {found.field: put}
