"""Each gallery scene shows what it is there for, judged by geometry written here and by the numeric pipeline."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from symrender.numeric.pipeline import prepare
from symrender.scene import gallery
from symrender.scene.arrays import scene_arrays
from symrender.scene.camera import LookAtCamera
from symrender.scene.load import load
from symrender.scene.scene import Scene
from symrender.settings import Settings

Array = npt.NDArray[np.float64]
SIZE = 64


def unit(v: Any) -> Array:
    v = np.asarray(v, dtype=np.float64)
    return np.asarray(v / np.linalg.norm(v, axis=-1, keepdims=True))


def primary(scene: Scene) -> Array:
    """Directions (SIZE, SIZE, 3) through the pixel centres of a square image."""
    camera = scene.camera
    assert isinstance(camera, LookAtCamera)
    forward = unit(np.subtract(camera.target, camera.eye))
    right = unit(np.cross(forward, camera.up))
    up = np.cross(right, forward)
    t = math.tan(math.radians(camera.fov) / 2) * ((2 * np.arange(SIZE) + 1) / SIZE - 1)
    return unit(forward + t[None, :, None] * right - t[:, None, None] * up)


def meets(origin: Array, direction: Array, center: Any, radius: float) -> npt.NDArray[np.bool_]:
    """Whether rays (..., 3) meet a sphere they start outside of."""
    f = np.asarray(center) - origin
    along = (f * direction).sum(-1)
    off = f - along[..., None] * direction
    return np.asarray((along > 0) & ((off * off).sum(-1) < radius**2))


def floor_points(scene: Scene) -> tuple[Array, Array]:
    """Points (N, 3) of the floor seen through pixel centres, and the directions (N, 3) they are seen along."""
    eye, d = np.asarray(scene.camera.eye), primary(scene).reshape(-1, 3)
    seen = d[:, 2] < 0
    for sphere in scene.spheres:
        seen &= ~meets(eye, d, sphere.center, sphere.radius)
    d = d[seen]
    return eye - (eye[2] / d[:, 2])[:, None] * d, d


def image(name: str, **settings: Any) -> dict[str, Array]:
    layers = {layer: np.zeros((SIZE, SIZE, 3)) for layer in ("radiance", "direct", "gloss")}
    layers["hit_class"] = np.zeros((SIZE, SIZE))
    prepare(scene_arrays(load(name)), Settings(width=SIZE, height=SIZE, **settings))(0, 0, SIZE, SIZE, layers)
    return layers


def test_names_and_descriptions() -> None:
    assert set(gallery.names()) == {"chapter8", "furnace", "gloss", "grazing", "mirror", "needle", "penumbra", "room"}
    for name in gallery.names():
        assert load(name).name == name
        assert load(name).description.endswith(".")
    for wrong in ("none", "../chapter8"):
        with pytest.raises(KeyError):
            gallery.text(wrong)


def test_chapter8_has_the_constants_of_its_chapter() -> None:
    values = {p.name: p.value for p in load("chapter8").parameters()}
    half = 1.25 * 4 / math.sqrt(15)
    assert values["camera.window_half"] == pytest.approx(half, rel=1e-15)
    assert values["camera.window_center.y"] == pytest.approx(-0.15 * half, rel=1e-15)
    assert values["floor.texture.bright.r"] == pytest.approx(0.85 * 0.75, rel=1e-15)
    assert values["floor.lobe.theta_max"] == math.pi / 3


def test_gloss_is_what_one_sees() -> None:
    layers = image("gloss", numeric="sobol", lobe=6)
    term = (layers["radiance"] - layers["direct"]).max(axis=-1)
    assert (term >= 0.05).mean() >= 0.20
    assert (layers["radiance"].max(axis=-1) > 1).mean() <= 0.02
    classes = np.bincount(layers["hit_class"].astype(int).ravel())
    assert len(classes) == 5
    assert classes[:5].min() >= 0.005 * SIZE * SIZE
    on_spheres = (layers["hit_class"] >= 2) & (term > 0.01)
    assert on_spheres.sum() >= 100


def test_gloss_has_lobes_across_the_horizon() -> None:
    scene = load("gloss")
    assert scene.floor is not None
    assert scene.floor.lobe is not None
    _, d = floor_points(scene)
    elevation = np.arcsin(-d[:, 2])
    assert len(d) >= 1000
    assert (elevation < scene.floor.lobe.theta_max).mean() >= 0.5
    # within two RMS angles of the mirror direction, where the lobe has nearly all its weight
    assert (elevation < 2 * math.sqrt(2 / scene.floor.lobe.exponent)).mean() >= 0.05


@pytest.mark.parametrize("name", ["gloss", "penumbra"])
def test_mirror_rays_meet_penumbrae(name: str) -> None:
    scene = load(name)
    key = scene.lights[0]
    assert key.type == "disk"
    assert key.radius > 0
    p, d = floor_points(scene)
    m = d * (1, 1, -1)
    distance = np.full(len(p), np.inf)
    owner = np.full(len(p), -1)
    for index, sphere in enumerate(scene.spheres):
        f = p - np.asarray(sphere.center)
        b = (f * m).sum(-1)
        disc = b * b - (f * f).sum(-1) + sphere.radius**2
        t = -b - np.sqrt(np.maximum(disc, 0))
        nearer = (disc > 0) & (t > 0) & (t < distance)
        distance[nearer], owner[nearer] = t[nearer], index
    hit = owner >= 0
    q = p[hit] + distance[hit, None] * m[hit]
    axis = unit(np.subtract(key.target, key.position))
    e1 = unit(np.cross(axis, (0.0, 0.0, 1.0)))
    e2 = np.cross(axis, e1)
    angles = np.arange(16) * math.pi / 8
    visible = []
    for light in np.asarray(key.position) + key.radius * (np.outer(np.cos(angles), e1) + np.outer(np.sin(angles), e2)):
        seen = np.ones(len(q), dtype=bool)
        for index, sphere in enumerate(scene.spheres):
            own = owner[hit] == index
            facing = ((light - q) * (q - np.asarray(sphere.center))).sum(-1) > 0
            blocked = meets(q, unit(light - q), sphere.center, sphere.radius)
            seen &= np.where(own, facing, ~blocked)
        visible.append(seen)
    share = np.mean(visible, axis=0)
    assert len(q) >= 300
    assert ((share > 0) & (share < 1)).sum() >= 15
    assert (share == 1).sum() >= 100


def test_mirror_is_a_mirror_twice() -> None:
    scene = load("mirror")
    assert scene.floor is not None
    assert scene.floor.lobe is not None
    assert scene.floor.lobe.exponent >= 1e9
    assert [s.lobe.mirror for s in scene.spheres if s.lobe] == [True]
    layers = image("mirror", numeric="sobol", lobe=2)
    limit = scene_arrays(scene.replace({"floor.lobe.mirror": True}))
    other = {key: np.zeros_like(value) for key, value in layers.items()}
    prepare(limit, Settings(width=SIZE, height=SIZE, numeric="sobol", lobe=2))(0, 0, SIZE, SIZE, other)
    floor = layers["hit_class"] == 1
    assert floor.sum() >= 1000
    assert (layers["gloss"][floor].max(axis=-1) > 0.05).sum() >= 300
    difference = np.abs(layers["gloss"] - other["gloss"])[floor].max(axis=-1)
    assert np.median(difference) <= 1e-3
    assert (difference > 0).any()


def test_furnace_returns_its_constant() -> None:
    scene = load("furnace")
    assert scene.floor is not None
    assert scene.floor.lobe is not None
    assert {scene.shading.ka * c for c in scene.ambient} == set(scene.background) == {0.25}
    assert scene.shading.kd == scene.shading.ks == 0
    _, d = floor_points(scene)
    assert len(d) >= 2000
    assert np.arcsin(-d[:, 2]).min() > scene.floor.lobe.theta_max  # no lobe on the floor crosses its horizon
    layers = image("furnace", lobe=3)
    floor = layers["hit_class"] == 1
    assert floor.sum() == len(d)
    assert np.abs(layers["gloss"][floor] / 0.25 - 1).max() <= 4 * np.finfo(float).eps


def test_needle_and_grazing() -> None:
    needle = load("needle")
    assert {p.value for p in needle.parameters() if p.name.endswith("exponent")} == {4096.0}
    chapter = {p.name: p.value for p in load("chapter8").parameters() if p.name.startswith(("spheres", "lights"))}
    same = {p.name: p.value for p in needle.parameters() if p.name in chapter and not p.name.endswith("exponent")}
    assert len(same) >= 30
    assert same == {name: value for name, value in chapter.items() if name in same}
    grazing = load("grazing")
    assert grazing.floor is not None
    assert grazing.floor.lobe is not None
    _, d = floor_points(grazing)
    assert len(d) >= 1000
    assert np.median(np.arcsin(-d[:, 2])) < math.sqrt(2 / grazing.floor.lobe.exponent)
    term = image("grazing", numeric="sobol", lobe=6)
    assert ((term["radiance"] - term["direct"]).max(axis=-1) >= 0.05).mean() >= 0.20
