"""Cylinders, mirrors, glass and plastic as other renderers read them."""

from __future__ import annotations

import re
from typing import Any
from xml.etree import ElementTree

import pytest

import symrender as sr
from symrender.errors import Unsupported

CHECKER = {"type": "checker", "bright": 0.8, "dark": 0.1, "cell": 0.25}
MATERIALS: dict[str, dict[str, Any]] = {
    "mirror": {"type": "conductor", "material": "Au", "alpha": 0, "two_sided": True},
    "clear": {"type": "dielectric", "ior": 1.5},
    "pane": {"type": "dielectric", "ior": 1.5, "thin": True},
    "frosted": {"type": "dielectric", "ior": 1.5, "alpha": 0.2, "transmittance": [0.5, 0.6, 0.7]},
    "shiny": {"type": "plastic", "ior": 1.5, "diffuse": CHECKER, "nonlinear": True},
    "worn": {"type": "plastic", "ior": 1.5, "alpha": 0.1, "distribution": "beckmann", "g1": "walter", "specular": 0.5},
}
KINDS = {
    "mirror": "conductor", "clear": "dielectric", "pane": "thindielectric", "frosted": "roughdielectric",
    "shiny": "plastic", "worn": "roughplastic",
}  # fmt: skip


def scene(**fields: Any) -> dict[str, Any]:
    balls = [
        {"type": "sphere", "name": name, "center": [k, 0, 0], "radius": 0.4, "material": name}
        for k, name in enumerate(MATERIALS)
    ]
    tube = {
        "type": "cylinder",
        "name": "tube",
        "base": [0, 2, 0],
        "axis": [0, 0, 2],
        "radius": 0.5,
        "material": "mirror",
    }
    can = tube | {"name": "can", "base": [3, 2, 0], "axis": [1, 0, 1], "caps": True}
    return {
        "units": "radiometric", "name": "glass", "bounces": 3, "materials": MATERIALS, "shapes": [*balls, tube, can],
        "camera": {"type": "look_at", "eye": [2, -9, 1], "target": [2, 0, 0], "fov": 40},
        "lights": [{"type": "area", "name": "glow", "shape": "can", "radiance": 2}],
    } | fields  # fmt: skip


def test_mitsuba_has_a_plugin_for_each() -> None:
    root = ElementTree.fromstring(sr.export(scene(), "mitsuba", size=8).files["scene.xml"])
    found = {}
    for bsdf in root.iter("bsdf"):
        name = str(bsdf.get("id", "")).removeprefix("material-").split(":")[0]
        if name in KINDS:
            inner = bsdf.find("bsdf") if bsdf.get("type") == "twosided" else bsdf
            assert inner is not None
            found[name] = inner
    assert {name: bsdf.get("type") for name, bsdf in found.items()} == KINDS
    values = {name: {p.get("name"): p.get("value") for p in bsdf} for name, bsdf in found.items()}
    assert values["clear"]["int_ior"] == "1.5" and values["clear"]["ext_ior"] == "1.0"
    assert values["frosted"]["specular_transmittance"] == "0.5, 0.6, 0.7" and values["frosted"]["alpha"] == "0.2"
    assert values["shiny"]["nonlinear"] == "true" and values["worn"]["distribution"] == "beckmann"
    assert str(values["mirror"]["eta"]).startswith("0.143") and "alpha" not in values["mirror"]
    kinds = [shape.get("type") for shape in root.findall("shape")]
    # a cylinder with caps is three shapes, and each of them shines
    assert kinds.count("cylinder") == 2 and kinds.count("disk") == 2
    names = [light.get("id") for light in root.iter("emitter")]
    assert len(names) == len(set(names)) == 3


def test_pbrt_has_cylinders_mirrors_and_glass() -> None:
    made = scene(materials=MATERIALS | {
        "shiny": MATERIALS["clear"], "worn": MATERIALS["pane"],
        "frosted": {"type": "dielectric", "ior": 1.5, "alpha": 0.2, "masking": "correlated"},
    })  # fmt: skip
    text = sr.export(made, "pbrt", size=8).files["scene.red.pbrt"]
    assert text.count('Material "thindielectric" "float eta" [ 1.5 ]') == 2
    assert text.count('Material "dielectric" "float eta" [ 1.5 ] "float roughness" [ 0.0 ]') == 2
    assert text.count('Shape "cylinder" "float radius" [ 0.5 ] "float zmin" [ 0 ] "float zmax"') == 2
    assert text.count('Shape "disk"') == 2 and text.count("AreaLightSource") == 3


@pytest.mark.parametrize(
    ("to", "material", "said"),
    [
        ("mitsuba", {"masking": "correlated"}, "materials.frosted.masking: mitsuba"),
        ("mitsuba", {"distribution": "beckmann"}, "materials.frosted.g1: mitsuba"),
        ("pbrt", {}, "materials.frosted.masking: pbrt: dielectrics have masking: correlated"),
        ("pbrt", {"masking": "correlated"}, "materials.frosted.transmittance: pbrt"),
    ],
)
def test_what_a_renderer_cannot_state_is_refused(to: str, material: dict[str, Any], said: str) -> None:
    made = scene(materials=MATERIALS | {"frosted": MATERIALS["frosted"] | material})
    with pytest.raises(Unsupported, match=re.escape(said)):
        sr.export(made, to, size=8)  # type: ignore[call-overload]
    plastic = scene(materials=MATERIALS | {"frosted": MATERIALS["clear"]})
    if to == "pbrt":
        with pytest.raises(Unsupported, match=r"materials\.shiny: pbrt"):
            sr.export(plastic, "pbrt", size=8)
