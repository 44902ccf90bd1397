"""Means over pixels in units of the series: the conventional tracer's rays, gloss of single rays, its samples."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import symrender as sr
from symrender.errors import Unsupported
from symrender.numeric.pipeline import trace
from symrender.scene.arrays import NOTHING, scene_arrays
from symrender.scene.load import load

Array = np.ndarray[Any, np.dtype[np.float64]]

SIZE = 8
DULL = {"texture": {"type": "checker", "bright": [0.3, 0.3, 0.25], "dark": [0.01, 0.01, 0], "cell": 0.9}}
NARROW = {"type": "look_at", "eye": [0.75, -6.8, 1.85], "target": [-1.57, 0.0, 0.7], "fov": 3.0}
"""Where ball A ends over the floor that mirrors it."""


def scene(**more: Any) -> Any:
    """Two balls, one with a checker, on tiles under a disk light; channels of nothing."""
    return load({
        "name": "pixels",
        "camera": {"type": "look_at", "eye": [0.75, -6.8, 1.85], "target": [0.1, -0.98, 0.44], "fov": 28.5},
        "spheres": [
            {"name": "A", "center": [-0.72, 0.15, 0.9], "radius": 0.9, "color": [0.8, 0.055, 0],
             "texture": {"type": "checker", "ku": 16, "kv": 8, "dark": 0.18},
             "lobe": {"weight": 0.15, "exponent": 32, "theta_max": 1.0}},
            {"name": "B", "center": [0.98, -0.3, 0.56], "radius": 0.56, "color": [0.015, 0.23, 0.48]},
        ],
        "floor": {"texture": {"type": "checker", "bright": [0.3, 0.3, 0.25], "dark": [0.01, 0.01, 0], "cell": 0.9},
                  "lobe": {"weight": 0.85, "exponent": 64, "theta_max": 1.0}},
        "lights": [
            {"name": "key", "type": "disk", "position": [-6.5, -6, 3.4], "radius": 1, "target": [0, 0, 0.5],
             "color": [1.5, 1.4, 1.3]},
        ],
        "ambient": [0.07, 0.08, 0.11],
        "shading": {"model": "blinn", "ka": 0.1, "kd": 0.8, "ks": 0.3, "shininess": 60},
    } | more)  # fmt: skip


def strata(rng: np.random.Generator, i: int, j: int, side: int) -> tuple[Array, Array]:
    """A random place of each of side x side parts of a pixel, in pixels."""
    x = i + (np.arange(side) + rng.random((side, side))) / side
    y = j + (np.arange(side)[:, None] + rng.random((side, side))) / side
    return x.ravel(), y.ravel()


def rays(made: Any, x: Array, y: Array) -> tuple[Array, Array]:
    """Origins and unit directions through places of the image, from the camera's own numbers."""
    camera = made.camera
    eye, target = np.array(camera.eye), np.array(camera.target)
    forward = (target - eye) / np.linalg.norm(target - eye)
    right = np.cross(forward, [0, 0, 1])
    right /= np.linalg.norm(right)
    half = np.tan(np.radians(camera.fov) / 2)
    way = forward + half * (
        (2 * x / SIZE - 1)[:, None] * right + (1 - 2 * y / SIZE)[:, None] * np.cross(right, forward)
    )
    return np.tile(eye, (len(x), 1)), way / np.linalg.norm(way, axis=1, keepdims=True)


def mean_of(values: Array, side: int) -> tuple[Array, Array]:
    """(mean, standard error) of samples in strata."""
    squares = values.reshape(side // 2, 2, side // 2, 2, 3).transpose(0, 2, 1, 3, 4).reshape(-1, 4, 3)
    return values.mean(axis=0), np.sqrt(squares.var(axis=1, ddof=1).mean(axis=0)) / side


def test_direct_light_is_the_mean_of_the_conventional_tracers_rays() -> None:
    made = scene(floor=DULL)
    made = made.replace({"spheres.A.lobe.weight": 0.0})
    image = sr.truth(made, size=SIZE, tol=1e-3, filter="box", threads=1)
    direct, error = image.layers["direct"], image.layer("error")
    arrays, rng = scene_arrays(made), np.random.default_rng(5)
    lit = cut = 0
    for j in range(SIZE):
        for i in range(SIZE):
            x, y = strata(rng, i, j, 48)
            expected, sigma = mean_of(trace(arrays, *rays(made, x, y), NOTHING)[0], 48)
            if np.abs(direct[j, i] - expected).max() > 1.5 * error[j, i] + 6 * sigma.max() + 1e-9:
                # few samples miss the corner of a field
                x, y = strata(rng, i, j, 600)
                expected, sigma = mean_of(trace(arrays, *rays(made, x, y), NOTHING)[0], 600)
            assert np.abs(direct[j, i] - expected).max() <= 1.5 * error[j, i] + 6 * sigma.max() + 1e-9, (i, j)
            lit += expected.max() > 0.05
            cut += sigma.max() > 1e-4
    assert lit > 30 and cut > 30
    # but where tiles shrink to the horizon
    assert (image.layer("status") == 0).mean() > 0.75


def test_gloss_is_the_mean_of_what_single_rays_gather() -> None:
    made, side = scene(camera=NARROW), 12
    image = sr.truth(made, size=4, tol=2e-4, filter="box", threads=1)
    assert np.abs(image.radiance - image.layers["direct"] - image.layers["gloss"]).max() < 1e-12
    fine = sr.truth(made, size=4 * side, tol=2e-5, counts=False, aa="none", threads=1)
    weight = np.array([0.0, 0.85, 0.15, 0.0])[fine.layer("hit_class").astype(int)]
    single = (weight[..., None] * fine.layers["gloss"]).reshape(4, side, 4, side, 3)
    expected, spread = single.mean(axis=(1, 3)), single.std(axis=(1, 3)).max(axis=2)
    off, error = np.abs(image.layers["gloss"] - expected).max(axis=2), image.layer("error")
    # a grid misses what an edge leaves by no more than a row of it
    assert (off <= 1.5 * error + 2e-5 + 2 * spread / side).all()
    assert (expected.max(axis=2) > 20 * error).sum() >= 4 and (spread > 2e-3).sum() >= 2


def test_what_a_rim_begins_to_touch_in_a_corner_is_stated() -> None:
    """A blunt lobe whose rim leaves the background in a part of a smooth pixel that five nodes hardly see."""
    made = load({
        "name": "rim",
        "camera": {"type": "look_at", "eye": [2.730668, 3.996346, 1.560882], "target": [0.896536, -0.490069, 1.125704],
                   "fov": 9.249504},
        "spheres": [{"name": "S", "center": [0.624002, -0.992586, 0.708005], "radius": 0.708005,
                     "color": [0.257, 0.798, 0.606],
                     "lobe": {"weight": 0.5, "exponent": 8.33549, "theta_max": 0.918771}}],
        "floor": {"texture": {"type": "checker", "bright": [0.8, 0.7, 0.6], "dark": [0.1, 0.1, 0.2], "cell": 0.441631},
                  "lobe": {"weight": 0.7, "exponent": 339.0, "theta_max": 0.978292}},
        "lights": [{"name": "L", "type": "point", "position": [-2.18, -3.45, 4.05], "color": [0.37, 0.88, 0.76]}],
        "background": [0.1, 0.15, 0.25], "ambient": [0.1, 0.1, 0.1],
        "shading": {"model": "blinn", "ka": 0.0, "kd": 0.8, "ks": 0.4, "shininess": 69.7},
    })  # fmt: skip
    # the four pixels about the middle, as an image of their own
    near = math.degrees(2 * math.atan(math.tan(math.radians(9.249504 / 2)) * 2 / SIZE))
    image, side = sr.truth(made.replace({"camera.fov": near}), size=2, tol=1e-5, filter="box", threads=1), 24
    x, y = 4 + (np.arange(side) + 0.5) / side, 4 + (np.arange(side)[:, None] + 0.5) / side
    eyes, sent = rays(made, np.broadcast_to(x, (side, side)).ravel(), np.broadcast_to(y, (side, side)).ravel())
    _, hit, far = trace(scene_arrays(made), eyes, sent, NOTHING)
    assert (hit == 2).all()
    places = eyes + far[:, None] * sent - np.array(made.spheres[0].center)
    normals = places / np.linalg.norm(places, axis=1, keepdims=True)
    single = 0.5 * sr.probe(made, normals, surface="spheres.S", tol=1e-8, threads=1).gloss
    # most of the pixel sees nothing but the background, and a part of it what the tolerance feels
    dark = 0.125 - single[:, 2]
    assert 0.02 < (dark > 1e-4).mean() < 0.2 and (dark < 1e-9).mean() > 0.6
    off = np.abs(image.layers["gloss"][1, 1] - single.mean(axis=0)).max()
    assert off <= 1.5 * image.layer("error")[1, 1] + 1e-6


@pytest.mark.parametrize("kind", ["box", "gaussian"])
def test_samples_of_the_numeric_side_agree(kind: Any) -> None:
    made = scene(camera=NARROW)
    asked: Any = {"size": 3, "lobe": 8, "numeric": "jittered", "filter": kind, "normalised": True, "threads": 1}
    pair = sr.render(made, symbolic="chambers", tol=2e-3, **asked)
    more = [sr.render(made, symbolic="none", seed=seed, **asked) for seed in range(20, 25)]
    assert pair.symbolic is not None
    found = np.array([each.numeric.radiance for each in (pair, *more) if each.numeric is not None])
    sigma = found.std(axis=0, ddof=1) / np.sqrt(len(found))
    off = np.abs(found.mean(axis=0) - pair.symbolic.radiance)
    assert len(found) == 6 and pair.symbolic.radiance.max() > 0.1 and np.median(sigma) < 5e-3
    assert (off <= 1.5 * pair.symbolic.layer("error")[..., None] + 8 * sigma + 1e-9).all()


def test_what_is_not_had_is_refused() -> None:
    asked: Any = {"size": 4, "filter": "box", "tol": 1e-2}
    with pytest.raises(Unsupported, match="disk: exact"):
        sr.truth(scene(), disk="exact", **asked)
    with pytest.raises(Unsupported, match="mirrors"):
        sr.truth("mirror", **asked)
    with pytest.raises(Unsupported, match="silhouettes: 2"):
        sr.truth(scene(), silhouettes=2, **asked)
    with pytest.raises(Unsupported, match="shininess below 4"):
        sr.truth(scene(shading={"shininess": 2}), **asked)
    with pytest.raises(Unsupported, match="strata"):
        sr.render(scene(), **asked)
    with pytest.raises(Unsupported, match="mirrors"):
        sr.gradient("mirror", wrt=["camera.fov"], **asked)
