"""BSDFs of a Mitsuba file as the materials that mean the same."""

from __future__ import annotations

from typing import Any, Final

from symrender.scene.mitsuba.colours import MEASURED, REFLECTED, Reader
from symrender.scene.mitsuba.properties import Properties
from symrender.scene.mitsuba.textures import colour_of, texture_of
from symrender.scene.mitsuba.xml_tree import Element
from symrender.scene.printable import printable

INDICES: Final = {
    "vacuum": 1.0, "helium": 1.000036, "hydrogen": 1.000132, "air": 1.000277, "carbon dioxide": 1.00045,
    "water": 1.333, "acetone": 1.36, "ethanol": 1.361, "carbon tetrachloride": 1.461, "glycerol": 1.4729,
    "benzene": 1.501, "silicone oil": 1.52045, "bromine": 1.661, "water ice": 1.31, "fused quartz": 1.458,
    "pyrex": 1.47, "acrylic glass": 1.49, "polypropylene": 1.49, "bk7": 1.5046, "sodium chloride": 1.544,
    "amber": 1.55, "pet": 1.575, "diamond": 2.419,
}  # fmt: skip
"""Indices of refraction that Mitsuba knows by name."""
_KNOWN: Final = "diffuse, conductor, dielectric and plastic, their rough ones, thindielectric and twosided"
_WALTER: Final = {"beckmann": {"g1": "walter"}, "ggx": {}}
_MAX_TWOSIDED: Final = 8


def surface(element: Element, reader: Reader) -> dict[str, Any]:
    """The material of a bsdf; a checker with a comment carries the ``scales`` of its chart."""
    two_sided = False
    for _ in range(_MAX_TWOSIDED):
        if element.attributes.get("type") != "twosided":
            break
        properties = Properties(element)
        held = [*properties.parts("bsdf", "ref"), *properties.named.values()]
        if len(held) != 1 or held[0].tag != "bsdf":
            raise properties.wrong(f"must hold one bsdf, got {len(held)}: no surface has another behind here")
        two_sided, element = True, held[0]
    material = _surface(Properties(element), reader)
    if two_sided and material["type"] != "dielectric":
        material["two_sided"] = True
    return material


def _surface(properties: Properties, reader: Reader) -> dict[str, Any]:
    kind = properties.element.attributes.get("type")
    match kind:
        case "diffuse":
            material = {"type": "diffuse"} | _textured(properties, "reflectance", "reflectance", reader)
            properties.done("reflectance")
        case "conductor" | "roughconductor":
            material = _conductor(properties, kind == "roughconductor", reader)
        case "dielectric" | "roughdielectric" | "thindielectric":
            material = _dielectric(properties, str(kind), reader)
        case "plastic" | "roughplastic":
            material = _plastic(properties, kind == "roughplastic", reader)
        case _:
            raise properties.wrong(f"no such material here; known are {_KNOWN}")
    return material


def _textured(properties: Properties, theirs: str, ours: str, reader: Reader) -> dict[str, Any]:
    """What a surface reflects, as the field of a material; nothing where it is as by default."""
    found = texture_of(properties, theirs, reader)
    return {} if found is None else {ours: found}


def _roughness(properties: Properties, *, rough: bool) -> dict[str, Any]:
    """Distribution and alpha of facets, as fields."""
    if not rough:
        return {"alpha": 0.0}
    distribution = properties.word("distribution", "beckmann").lower()
    if distribution not in _WALTER:
        raise properties.wrong(f"distribution must be ggx or beckmann, got {printable(distribution)}")
    given = properties.named.get("alpha")
    if given is not None and given.tag in ("texture", "ref"):
        raise properties.wrong("alpha must be a number: a texture there is not supported", given)
    alpha = properties.number("alpha", 0.1)
    u, v = properties.number("alpha_u", alpha), properties.number("alpha_v", alpha)
    if u != v:
        raise properties.wrong(f"alpha_u and alpha_v must be equal, got {u:g} and {v:g}: facets lie alike around here")
    properties.pop("sample_visible")
    return {"distribution": distribution, "alpha": u} | _WALTER[distribution]


def _conductor(properties: Properties, rough: bool, reader: Reader) -> dict[str, Any]:
    material: dict[str, Any] = {"type": "conductor"} | _roughness(properties, rough=rough)
    named = properties.take("material", "string")
    indexed = "eta" in properties.named or "k" in properties.named
    if named is not None and indexed:
        raise properties.wrong("material stands for eta and k, which are given too", named)
    outside = _index(properties, "ext_eta", 1.0) if "ext_eta" in properties.named else 1.0
    if indexed:
        for name in ("eta", "k"):
            colour = colour_of(properties, name, None, reader, MEASURED)
            material[name] = [x / outside for x in colour]
    else:
        material["material"] = properties.value(named) if named is not None else "none"
        if outside != 1.0:
            raise properties.wrong("ext_eta beside a material by name is not supported")
    material |= _textured(properties, "specular_reflectance", "reflectance", reader)
    properties.done("material or eta and k, specular_reflectance, distribution and alpha")
    return material


def _index(properties: Properties, name: str, default: float) -> float:
    """An index of refraction, a number or a name."""
    given = properties.named.get(name)
    if given is not None and given.tag == "string":
        word = properties.value(given).strip().lower()
        properties.pop(name)
        if word not in INDICES:
            raise properties.wrong(f"{name}: no such medium, {printable(word)}; known are {', '.join(INDICES)}", given)
        return INDICES[word]
    return properties.number(name, default)


def _relative(properties: Properties, inside: str) -> float:
    """The index of the inside over that of the outside."""
    inner, outer = _index(properties, "int_ior", INDICES[inside]), _index(properties, "ext_ior", INDICES["air"])
    if not (inner > 0.0 and outer > 0.0):
        raise properties.wrong(f"int_ior and ext_ior must be > 0, got {inner:g} and {outer:g}")
    return inner / outer


def _dielectric(properties: Properties, kind: str, reader: Reader) -> dict[str, Any]:
    material: dict[str, Any] = {"type": "dielectric", "ior": _relative(properties, "bk7")}
    if kind == "roughdielectric":
        material |= _roughness(properties, rough=True)
    elif kind == "thindielectric":
        material["thin"] = True
    material |= _textured(properties, "specular_reflectance", "reflectance", reader)
    if "specular_transmittance" in properties.named:
        material["transmittance"] = colour_of(properties, "specular_transmittance", None, reader, REFLECTED)
    properties.done("int_ior, ext_ior, specular_reflectance, specular_transmittance, distribution and alpha")
    return material


def _plastic(properties: Properties, rough: bool, reader: Reader) -> dict[str, Any]:
    material: dict[str, Any] = {"type": "plastic", "ior": _relative(properties, "polypropylene")}
    material |= _roughness(properties, rough=rough)
    material |= _textured(properties, "diffuse_reflectance", "diffuse", reader)
    if "specular_reflectance" in properties.named:
        material["specular"] = colour_of(properties, "specular_reflectance", None, reader, REFLECTED)
    if properties.flag("nonlinear", False):
        material["nonlinear"] = True
    properties.done("int_ior, ext_ior, diffuse_reflectance, specular_reflectance, nonlinear, distribution and alpha")
    return material


def checked_scales(material: dict[str, Any]) -> tuple[dict[str, Any], list[float] | None]:
    """The material without the scales of a checker with a comment, and these."""
    for field in ("reflectance", "diffuse"):
        texture = material.get(field)
        if isinstance(texture, dict) and "scales" in texture:
            scales = texture["scales"]
            return {**material, field: {key: value for key, value in texture.items() if key != "scales"}}, scales
    return material, None
