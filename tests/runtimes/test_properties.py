"""What no image may notice, whatever the scene: properties of both pipelines over random small scenes.

A scene has up to three spheres, a floor, one to three lights, every lobe and texture that is not excluded by the
property. Images are 8 x 6, so that columns mirror exactly and a hundred scenes cost a second.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from numeric.test_pipeline import _scaled
from symrender.numeric import pipeline as numeric
from symrender.runtimes import image as symbolic
from symrender.scene.arrays import FIRST_SPHERE, FLOOR, Array, scene_arrays
from symrender.scene.scene import Scene
from symrender.settings import Settings

WIDTH, HEIGHT = 8, 6
Data = dict[str, Any]
PIPELINES = pytest.mark.parametrize("pipeline", [numeric, symbolic], ids=["numeric", "symbolic"])
examples = settings(
    max_examples=50, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.function_scoped_fixture]
)


def reals(low: float, high: float) -> st.SearchStrategy[float]:
    """Reals in a range that may be halved and doubled without leaving the normal numbers."""
    return st.floats(low, high, allow_subnormal=False).map(lambda x: 0.0 if abs(x) < 1e-9 else x)


def vectors(low: float, high: float) -> st.SearchStrategy[list[float]]:
    return st.lists(reals(low, high), min_size=3, max_size=3)


LOBES = st.none() | st.fixed_dictionaries(
    {"weight": reals(0.1, 1), "exponent": reals(0, 200), "theta_max": reals(0.05, 1.5)}
)
COLORS = vectors(0.1, 1)


@st.composite
def scenes(draw: st.DrawFn, *, points: bool = False, plain: bool = False) -> Data:
    """Plain data of a scene; ``points``: no disks; ``plain``: no textures."""
    textures = st.just({"type": "solid"})
    if not plain:
        textures |= st.just({"type": "checker", "ku": 4.0, "kv": 3.0, "dark": 0.2}) | st.just({"type": "marble"})
    spheres = [
        {
            "name": f"s{k}",
            "center": [*draw(vectors(-1, 1))[:2], draw(reals(-0.2, 1.4))],
            "radius": draw(reals(0.2, 0.9)),
            "color": draw(COLORS),
            "texture": draw(textures),
            "lobe": draw(LOBES),
        }
        for k in range(draw(st.integers(0, 3)))
    ]
    lights = []
    for k in range(draw(st.integers(1, 3))):
        light = {"type": "point", "name": f"l{k}", "color": draw(COLORS)}
        light["position"] = [*draw(vectors(-5, 5))[:2], draw(reals(0.5, 6))]
        if not points and draw(st.booleans()):
            light |= {"type": "disk", "radius": draw(reals(0.05, 1))}
        lights.append(light)
    floor = {"texture": {"type": "solid"} if plain or draw(st.booleans()) else {"type": "checker"}, "lobe": draw(LOBES)}
    return {
        "camera": {"type": "look_at", "eye": [draw(reals(-3, 3)), -4.0, draw(reals(1, 4))], "target": [0, 0, 0.3]},
        "spheres": spheres,
        "floor": draw(st.sampled_from([floor, floor, None])),
        "lights": lights,
        "ambient": draw(COLORS),
        "background": draw(COLORS),
        "shading": {
            "shininess": draw(st.sampled_from([0.0, 1.0, 2.5, 40.0])),
            "model": draw(st.sampled_from(["blinn", "phong"])),
        },
    }


def layers(pipeline: Any, scene: Scene | Data, **options: Any) -> dict[str, Array]:
    """Every layer of the image of a scene."""
    scene = scene if isinstance(scene, Scene) else Scene.model_validate(scene, strict=False)
    found = {name: np.full((HEIGHT, WIDTH, 3), np.nan) for name in ("radiance", "direct", "gloss")}
    found["hit_class"] = np.full((HEIGHT, WIDTH), np.nan)
    kernel = pipeline.prepare(scene_arrays(scene), Settings(width=WIDTH, height=HEIGHT, **{"lobe": 2} | options))
    kernel(0, 0, WIDTH, HEIGHT, found)
    assert all(np.isfinite(layer).all() for layer in found.values())
    return found


def same(a: dict[str, Array], b: dict[str, Array], names: tuple[str, ...] = ("radiance", "hit_class")) -> None:
    for name in names:
        np.testing.assert_array_equal(a[name], b[name], err_msg=name)


def colored(data: Data, change: Any) -> Data:
    """The data with every colour of light, ambient and background changed; materials stay."""
    lights = [light | {"color": change(light["color"])} for light in data["lights"]]
    return data | {"lights": lights, "ambient": change(data["ambient"]), "background": change(data["background"])}


def test_the_scenes_are_worth_rendering() -> None:
    """Most have spheres and lobes that show, some a floor, some none: or every property would hold of nothing."""
    seen = {"sphere": 0, "floor": 0, "gloss": 0, "scenes": 0}

    @settings(max_examples=100, deadline=None, derandomize=True, database=None)
    @given(scenes())
    def look(data: Data) -> None:
        image = layers(symbolic, data)
        seen["scenes"] += 1
        seen["sphere"] += bool((image["hit_class"] >= FIRST_SPHERE).any())
        seen["floor"] += bool((image["hit_class"] == FLOOR).any())
        seen["gloss"] += bool(image["gloss"].max() > 0.02)

    look()
    assert seen["scenes"] >= 80 and min(seen["sphere"], seen["floor"], seen["gloss"]) >= 15, seen


@PIPELINES
@examples
@given(data=scenes(), power=st.integers(-35, 35))
def test_scaling_by_a_power_of_two_changes_no_bit(pipeline: Any, data: Data, power: int) -> None:
    scene = Scene.model_validate(data, strict=False)
    same(layers(pipeline, scene), layers(pipeline, _scaled(scene, 2.0**power)))


@PIPELINES
@examples
@given(data=scenes(points=True, plain=True))
def test_a_mirrored_world_is_the_mirrored_picture(pipeline: Any, data: Data) -> None:
    """Bit for bit, but for lobes, whose frame has a hand."""

    def flipped(p: list[float]) -> list[float]:
        return [-p[0], p[1], p[2]]

    mirrored = data | {
        "camera": data["camera"] | {name: flipped(data["camera"][name]) for name in ("eye", "target")},
        "spheres": [sphere | {"center": flipped(sphere["center"])} for sphere in data["spheres"]],
        "lights": [light | {"position": flipped(light["position"])} for light in data["lights"]],
    }
    a, b = layers(pipeline, data), layers(pipeline, mirrored)
    same(a, {name: layer[:, ::-1] for name, layer in b.items()}, ("direct", "hit_class"))


@PIPELINES
@examples
@given(data=scenes(plain=True), x=st.integers(-1000, 1000), y=st.integers(-1000, 1000))
def test_a_world_moved_along_its_floor_looks_the_same(pipeline: Any, data: Data, x: int, y: int) -> None:
    """To the rounding of its larger coordinates, but for a pixel or two on an edge."""

    def moved(p: list[float]) -> list[float]:
        return [p[0] + x, p[1] + y, p[2]]

    lights = [light | {"position": moved(light["position"])} for light in data["lights"]]
    lights = [light | ({"target": moved([0, 0, 0])} if light["type"] == "disk" else {}) for light in lights]
    other = data | {
        "camera": data["camera"] | {name: moved(data["camera"][name]) for name in ("eye", "target")},
        "spheres": [sphere | {"center": moved(sphere["center"])} for sphere in data["spheres"]],
        "lights": lights,
    }
    a, b = layers(pipeline, data)["radiance"], layers(pipeline, other)["radiance"]
    assert (np.abs(a - b).max(axis=-1) > 1e-8).sum() <= 2


@PIPELINES
@examples
@given(data=scenes(), power=st.integers(-20, 20))
def test_brightness_is_linear_bit_for_bit(pipeline: Any, data: Data, power: int) -> None:
    brighter = colored(data, lambda color: [2.0**power * c for c in color])
    a, b = layers(pipeline, data), layers(pipeline, brighter)
    for name in ("radiance", "direct", "gloss"):
        np.testing.assert_array_equal(2.0**power * a[name], b[name])


@PIPELINES
@examples
@given(data=scenes(), other=COLORS)
def test_red_never_sees_green(pipeline: Any, data: Data, other: list[float]) -> None:
    changed = colored(data, lambda color: [color[0], other[1], other[2]])
    a, b = layers(pipeline, data), layers(pipeline, changed)
    np.testing.assert_array_equal(a["radiance"][..., 0], b["radiance"][..., 0])


@PIPELINES
@examples
@given(data=scenes())
def test_light_is_additive_and_may_be_split(pipeline: Any, data: Data) -> None:
    dark = data | {"lights": []}
    base = layers(pipeline, dark)["radiance"]
    whole = layers(pipeline, data)["radiance"]
    parts = sum(layers(pipeline, data | {"lights": [light]})["radiance"] - base for light in data["lights"])
    np.testing.assert_allclose(whole - base, parts, atol=1e-14 * (1 + whole.max()), rtol=0)
    halves = [
        light | {"name": f"{light['name']}{k}", "color": [0.5 * c for c in light["color"]]}
        for light in data["lights"]
        for k in "ab"
    ]
    np.testing.assert_allclose(layers(pipeline, data | {"lights": halves})["radiance"], whole, rtol=4e-15)


@PIPELINES
@examples
@given(data=scenes(), weight=reals(0.1, 1))
def test_radiance_is_affine_in_the_weight_of_a_lobe(pipeline: Any, data: Data, weight: float) -> None:
    def weighed(lobe: Data | None) -> Data | None:
        return lobe and lobe | {"weight": weight}

    floor = data["floor"] and data["floor"] | {"lobe": weighed(data["floor"]["lobe"])}
    spheres = [sphere | {"lobe": weighed(sphere["lobe"])} for sphere in data["spheres"]]
    a, b = layers(pipeline, data), layers(pipeline, data | {"floor": floor, "spheres": spheres})
    same(a, b, ("direct", "gloss"))
    has = [False, bool(floor and floor["lobe"]), *(bool(sphere["lobe"]) for sphere in spheres)]
    share = weight * np.array(has)[b["hit_class"].astype(int)]
    np.testing.assert_array_equal(b["radiance"], b["direct"] + share[..., None] * b["gloss"])


@PIPELINES
@examples
@given(data=scenes(), seed=st.randoms(use_true_random=False))
def test_order_does_not_matter(pipeline: Any, data: Data, seed: Any) -> None:
    """Of spheres not by a bit, nor which of two coincident ones comes first; of lights by the rounding of their sum."""
    order = list(range(len(data["spheres"])))
    seed.shuffle(order)
    shuffled = data | {"spheres": [data["spheres"][k] for k in order]}
    a, b = layers(pipeline, data), layers(pipeline, shuffled)
    same(a, b, ("radiance",))
    classes = np.array([0, 1, *(FIRST_SPHERE + order.index(k) for k in range(len(order)))])
    np.testing.assert_array_equal(classes[a["hit_class"].astype(int)], b["hit_class"])
    turned = layers(pipeline, data | {"lights": data["lights"][::-1]})
    np.testing.assert_allclose(turned["radiance"], a["radiance"], rtol=8e-15)
    assert layers(pipeline, data | {"name": "other"})["radiance"].tobytes() == a["radiance"].tobytes()


@PIPELINES
@examples
@given(data=scenes(), share=reals(0.1, 0.9))
def test_what_cannot_be_seen_changes_no_bit(pipeline: Any, data: Data, share: float) -> None:
    """Below the floor, inside another sphere, or the same sphere twice."""
    hidden = []
    if data["floor"] is not None:
        hidden.append({"center": [0.3, 0.2, -share], "radius": share})
    if data["spheres"]:
        first = data["spheres"][0]
        hidden.append({"center": first["center"], "radius": share * first["radius"]})
        hidden.append({"center": first["center"], "radius": first["radius"]})
    image = layers(pipeline, data)
    for k, place in enumerate(hidden):
        more = [*data["spheres"], place | {"name": f"h{k}", "color": [1, 1, 1], "lobe": {}}]
        same(image, layers(pipeline, data | {"spheres": more}), ("radiance", "direct", "gloss", "hit_class"))


@PIPELINES
@examples
@given(data=scenes(), center=vectors(-1, 1), radius=reals(0.1, 0.7))
def test_a_blocker_never_brightens(pipeline: Any, data: Data, center: list[float], radius: float) -> None:
    blocker = {"name": "blocker", "center": [center[0], center[1], center[2] + 1.2], "radius": radius}
    a, b = layers(pipeline, data), layers(pipeline, data | {"spheres": [*data["spheres"], blocker]})
    still = a["hit_class"] == b["hit_class"]
    assert (b["direct"][still] <= a["direct"][still]).all()


@PIPELINES
@examples
@given(data=scenes())
def test_gloss_stays_within_what_there_is_to_see(pipeline: Any, data: Data) -> None:
    image = layers(pipeline, data, lobe=3)
    shading = Scene.model_validate(data, strict=False).shading
    lit = np.sum([light["color"] for light in data["lights"]], axis=0) * (shading.kd + shading.ks)
    most = np.maximum(shading.ka * np.array(data["ambient"]) + lit, data["background"])
    assert (image["gloss"] >= 0).all() and (image["gloss"] <= most * (1 + 1e-14)).all()
    dark = layers(pipeline, data | {"lights": []}, lobe=3)
    most = np.maximum(shading.ka * np.array(data["ambient"]), data["background"])
    assert (dark["gloss"] <= most * (1 + 1e-14)).all()
