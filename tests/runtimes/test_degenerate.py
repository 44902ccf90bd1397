"""The degenerate scenes of the numeric tests, symbolically: finite, never negative, the same shapes met."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from numeric.conftest import with_parts
from numeric.test_pipeline import DEGENERATE, LIGHT, LOOK, SPHERE, USUAL
from runtimes.test_image import layers_of
from symrender.numeric import pipeline as numeric
from symrender.render import render
from symrender.runtimes import image as symbolic
from symrender.scene.arrays import FLOOR, scene_arrays
from symrender.scene.load import load
from symrender.scene.scene import Scene

TIES = {
    "camera on a sphere": "the eye is on the surface: inside or outside is the last bit",
    "huge": "the sphere's top and the floor are one plane to the last bit of 1e12",
    "light aimed along y": "half the disk's points are in the floor plane to the last bit",
}
"""Scenes whose very construction is a tie, where the two may decide differently, each finitely."""
UNEQUAL = 0.05
"""Share of pixels that may differ elsewhere: tangents."""
DIGITS = {"far": 1e-7}
"""Largest difference of direct light where it is not 1e-9: at 4e8 radii a double resolves 6e-8 of one."""


@pytest.mark.parametrize("name", DEGENERATE)
def test_both_pipelines_survive_and_agree(name: str) -> None:
    scene = Scene.model_validate({"camera": LOOK, "ambient": [0.1, 0.1, 0.1]} | DEGENERATE[name], strict=False)
    pair = render(scene, size=(16, 9), lobe=2, numeric="jittered", threads=1)
    assert pair.numeric is not None and pair.symbolic is not None
    for layer in ("radiance", "direct", "gloss"):
        values = pair.symbolic.layer(layer)
        assert np.isfinite(values).all() and (values >= 0).all(), layer
    if name in TIES:
        return
    same = pair.numeric.layer("hit_class") == pair.symbolic.layer("hit_class")
    assert same.mean() >= 1 - UNEQUAL
    difference = np.abs(pair.numeric.layer("direct") - pair.symbolic.layer("direct")).max(axis=-1)
    assert (difference <= DIGITS.get(name, 1e-9)).mean() >= 1 - UNEQUAL


@pytest.mark.parametrize("cell", [1e-12, 1e-18, 1e-19, 1e-20, 1e-40, 1e-150])
@pytest.mark.parametrize("camera", ["look_at", "plane"])
def test_cells_too_small_to_count_are_their_mean(cell: float, camera: str) -> None:
    looks = LOOK if camera == "look_at" else {"type": "plane", "eye": [0.0, 0.0, 3.0], "window_half": 2.0}
    floor = {"texture": {"type": "checker", "cell": cell, "bright": [0.8] * 3, "dark": [0.2] * 3}}
    lights = [{"type": "point", "name": "k", "position": [0.0, 0.0, 5.0]}]
    scenes = [
        Scene.model_validate({"camera": looks, "floor": f, "lights": lights}, strict=False)
        for f in (floor, {"texture": {"type": "solid", "color": [0.5] * 3}})
    ]
    checked, plain = (render(scene, size=(12, 9), lobe=1) for scene in scenes)
    for image, expected in ((checked.numeric, plain.numeric), (checked.symbolic, plain.symbolic)):
        assert image is not None and expected is not None
        seen = expected.layer("hit_class") == 1
        assert seen.sum() > 40 and expected.radiance[seen].min() > 0
        np.testing.assert_allclose(image.radiance[seen], expected.radiance[seen], rtol=2e-3)


@pytest.mark.parametrize("theta", [1e-12, 1e-149, 1e-151, 1e-200, 5e-324])
@pytest.mark.parametrize("rule", [{}, {"normalised": True}, {"weights": "midpoint"}, {"nodes": "barycentre"}])
def test_a_lobe_of_almost_no_angle_is_the_mirror(theta: float, rule: dict[str, Any]) -> None:
    scene = load("gloss")
    narrow, mirror = scene.replace({"floor.lobe.theta_max": theta}), scene.replace({"floor.lobe.mirror": True})
    pairs = [render(s, size=24, lobe=3, threads=1, **rule) for s in (narrow, mirror)]
    for a, b in ((pairs[0].numeric, pairs[1].numeric), (pairs[0].symbolic, pairs[1].symbolic)):
        assert a is not None and b is not None and (b.layer("gloss").max(axis=-1) > 0.05).mean() > 0.1
        difference = np.abs(a.layer("gloss") - b.layer("gloss")).max(axis=-1)
        assert (difference <= 1e-9).mean() >= 1 - 1 / 24**2 * 2, "but for a pixel or two on a texture's edge"


PIPELINES = pytest.mark.parametrize("pipeline", [numeric, symbolic], ids=["numeric", "symbolic"])


def scene_of(**parts: Any) -> Scene:
    return Scene.model_validate({"camera": LOOK, "ambient": [0.1, 0.1, 0.1], **USUAL, **parts}, strict=False)


def assert_same(a: dict[str, Any], b: dict[str, Any]) -> None:
    assert a["radiance"].max() > 0.05
    for name in ("radiance", "direct", "gloss", "hit_class"):
        assert a[name].tobytes() == b[name].tobytes(), name


@PIPELINES
def test_a_disk_without_radius_is_a_point(pipeline: Any) -> None:
    point = {"type": "point", "name": "k", "position": LIGHT["position"]}
    scenes = [scene_of(lights=[light]) for light in (LIGHT | {"radius": 0.0}, point)]
    assert_same(*(layers_of(pipeline, scene, 24, lobe=3, disk="3x3") for scene in scenes))


@PIPELINES
def test_a_light_inside_a_sphere_lights_nothing_outside(pipeline: Any) -> None:
    inside = LIGHT | {"name": "in", "position": [0.1, 0.0, 1.2], "radius": 0.2}
    a, b = (scene_of(lights=lights) for lights in ([LIGHT, inside], [LIGHT]))
    assert_same(*(layers_of(pipeline, scene, 24, lobe=3) for scene in (a, b)))


@PIPELINES
def test_an_eye_inside_a_sphere_sees_it_lit_from_within(pipeline: Any) -> None:
    """The middle pixel looks along x at distance 2: cosine 2/sqrt(4.25), from the inner light alone."""
    scene = Scene.model_validate(
        {
            "camera": LOOK | {"eye": [0.0, 0.0, 0.0], "target": [1.0, 0.0, 0.0]},
            "spheres": [{"name": "a", "center": [0.0, 0.0, 0.0], "radius": 2.0}],
            "lights": [
                {"type": "point", "name": "in", "position": [0.0, 0.0, 0.5]},
                {"type": "point", "name": "out", "position": [9.0, 0.0, 0.0]},
            ],
            "shading": {"ks": 0.0},
        },
        strict=False,
    )
    image = layers_of(pipeline, scene, 9)
    assert (image["hit_class"] == 2).all()
    np.testing.assert_allclose(image["radiance"][4, 4], 0.7 * 0.5 * 2 / np.sqrt(4.25), rtol=1e-14)


@PIPELINES
@pytest.mark.parametrize("terminator", ["open", "cut"])
@pytest.mark.parametrize("model", ["blinn", "phong"])
def test_a_light_at_the_point_it_lights_adds_nothing(pipeline: Any, model: str, terminator: str) -> None:
    """Nor does one in the floor's plane or below it; ka ambient = .01 is left."""
    shading = {"model": model, "specular_terminator": terminator}
    for spheres, top in (([], 0.0), ([SPHERE], 2.0)):
        for place in ([0.0, 0.0, top], [0.0, 0.0, -1.0]):
            light = {"type": "point", "name": "k", "position": place}
            scene = scene_of(spheres=spheres, lights=[light], shading=shading)
            found = pipeline.trace(scene_arrays(scene), [[0.0, 0.0, 5.0]], [[0.0, 0.0, -1.0]], 0)
            assert found[1][0] == (2 if spheres else 1) and found[2][0] == 5.0 - top
            np.testing.assert_allclose(found[0][0], 0.01, rtol=1e-15)


@PIPELINES
def test_a_lobe_of_no_weight_is_not_integrated(pipeline: Any) -> None:
    scene = scene_of()
    lobes = {"floor.lobe.weight": 0.0, "spheres.a.lobe.weight": 0.0}
    dark, lit = (layers_of(pipeline, s, 24, lobe=3) for s in (scene.replace(lobes), scene))
    assert lit["gloss"].max() > 0.01 and not dark["gloss"].any() and dark["evaluations"] == 0
    assert dark["radiance"].tobytes() == lit["direct"].tobytes()


@PIPELINES
def test_the_ends_of_the_exponent(pipeline: Any) -> None:
    """The mean over the cap at n = 0 is that at 1e-300, bit for bit; at 1e12 the mirror, but for walls in its way."""
    wide = scene_of().replace({"floor.lobe.theta_max": 1.5707963267948966})
    narrow = {"numeric": "importance"} if pipeline is numeric else {"partition": "equal_weight", "nodes": "barycentre"}
    zero, tiny = (layers_of(pipeline, wide.replace({"floor.lobe.exponent": n}), 24, lobe=4) for n in (0.0, 1e-300))
    assert_same(zero, tiny)
    huge = layers_of(pipeline, wide.replace({"floor.lobe.exponent": 1e12}), 24, lobe=4, **narrow)
    mirror = layers_of(pipeline, wide.replace({"floor.lobe.mirror": True}), 24, lobe=4)
    floor = mirror["hit_class"] == FLOOR
    assert (mirror["gloss"][floor].max(axis=-1) > 0.01).sum() > 20
    assert (np.abs(huge["gloss"] - mirror["gloss"])[floor].max(axis=-1) > 1e-5).sum() <= 2


@PIPELINES
def test_spheres_that_coincide_are_one(pipeline: Any) -> None:
    """Whatever the second is made of: no speckles where each would shade the other."""
    one = scene_of(lights=[LIGHT, {"type": "point", "name": "l", "position": [-3.0, -2.0, 4.0]}])
    two = with_parts(one, spheres=[SPHERE, SPHERE | {"name": "b", "color": [1.0, 0.0, 0.0]}])
    assert_same(*(layers_of(pipeline, scene, 32, lobe=4) for scene in (one, two)))


@PIPELINES
def test_far_from_the_origin_the_same_is_seen(pipeline: Any) -> None:
    """A million units away, where a coordinate has ten digits left, but for pixels on edges."""

    def moved(p: Any) -> list[float]:
        return [p[0] + 1e6, p[1] - 1e6, p[2]]

    floor = {"texture": {"type": "solid"}, "lobe": {}}
    light = LIGHT | {"target": [0.0, 0.0, 0.0]}
    near = scene_of(floor=floor, lights=[light])
    far = scene_of(
        camera=LOOK | {"eye": moved(LOOK["eye"]), "target": moved(LOOK["target"])},
        spheres=[SPHERE | {"center": moved(SPHERE["center"])}],
        floor=floor,
        lights=[light | {name: moved(light[name]) for name in ("position", "target")}],
    )
    a, b = (layers_of(pipeline, scene, 32, lobe=3) for scene in (near, far))
    assert (a["hit_class"] != b["hit_class"]).sum() <= 2
    assert (np.abs(a["radiance"] - b["radiance"]).max(axis=-1) > 1e-6).sum() <= 4


@pytest.mark.parametrize("size", [(1, 1), (3, 7), (257, 1), (1, 63), (16384, 1)])
def test_odd_sizes(size: tuple[int, int]) -> None:
    pair = render(scene_of(), size=size, lobe=1, threads=1)
    for image in (pair.numeric, pair.symbolic):
        assert image is not None and image.radiance.shape == (size[1], size[0], 3)
        assert np.isfinite(image.radiance).all()
        assert image.layer("hit_class").any() or size == (1, 1)
