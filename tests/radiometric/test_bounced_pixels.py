"""Means over pixels of bounced light: single rays on a grid, and paths of the conventional tracer."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import symrender as sr
from symrender.radiometric.world import seen
from symrender.scene.load import load_any
from symrender.scene.radiometric.arrays import radiometric_arrays
from symrender.scene.radiometric.scene import RadiometricScene

Array = np.ndarray[Any, np.dtype[np.float64]]


def world(floor: Any, **more: Any) -> RadiometricScene:
    """Two balls that light each other over a floor."""
    made = load_any({
        "units": "radiometric", "bounces": 1,
        "camera": {"type": "look_at", "eye": [0.3, -5.6, 2.5], "target": [-0.15, 0, 0.55], "up": [0, 0, 1], "fov": 31},
        "materials": {
            "floor": {"type": "diffuse", "reflectance": floor},
            "red": {"type": "diffuse", "reflectance": [0.8, 0.2, 0]},
            "metal": {"type": "conductor", "distribution": "ggx", "alpha": 0.2, "eta": 0.9, "k": [3, 2, 1]},
        },
        "shapes": [
            {"type": "plane", "name": "floor", "point": [0, 0, 0], "normal": [0, 0, 1], "material": "floor"},
            {"type": "sphere", "name": "A", "center": [-0.78, 0.1, 0.85], "radius": 0.85, "material": "red"},
            {"type": "sphere", "name": "B", "center": [0.72, -0.22, 0.6], "radius": 0.6, "material": "metal"},
        ],
        "lights": [
            {"type": "directional", "name": "sun", "direction": [-0.84, -0.5, -0.8], "irradiance": [3.6, 3.3, 0]},
        ],
    } | more)  # fmt: skip
    assert isinstance(made, RadiometricScene)
    return made


SOLID = [0.8, 0.77, 0.7]
TILES = {"type": "checker", "bright": 0.8, "dark": [0.1, 0, 0.3], "cell": 0.8}
NARROW = {"type": "look_at", "eye": [0.3, -5.6, 2.5], "target": [0.15, -0.4, 0.6], "up": [0, 0, 1], "fov": 2.5}
"""Where ball B ends before the floor."""
HALF = NARROW | {"target": [0.1, -0.2, 0.35], "fov": 9.4}
"""Where both balls stand on the floor and in each other's light."""
SIZE, TOL = 4, 2e-3


def on_a_grid(scene: RadiometricScene, pixel: tuple[int, int], side: int) -> tuple[Array, Array]:
    """(mean of the indirect light of a pixel, its standard error) of rays in strata, a ray each."""
    (i, j), rng = pixel, np.random.default_rng(pixel)
    forward, right, up = seen(radiometric_arrays(scene), SIZE, SIZE).window
    x = i + (np.arange(side) + rng.random((side, side))) / side
    y = j + (np.arange(side)[:, None] + rng.random((side, side))) / side
    sent = forward + (2 * x / SIZE - 1)[..., None] * right + (1 - 2 * y / SIZE)[..., None] * up
    sent = sent.reshape(-1, 3) / np.linalg.norm(sent.reshape(-1, 3), axis=1, keepdims=True)
    eyes = np.tile(radiometric_arrays(scene).camera.eye, (len(sent), 1))
    found = sr.probe(scene, rays=(eyes, sent), tol=TOL / 10).indirect
    squares = found.reshape(side // 2, 2, side // 2, 2, 3).transpose(0, 2, 1, 3, 4).reshape(-1, 4, 3)
    return found.mean(axis=0), np.sqrt(squares.var(axis=1, ddof=1).mean(axis=0)) / side


@pytest.mark.parametrize("floor", [SOLID, TILES], ids=["solid", "tiles"])
def test_means_are_those_of_single_rays(floor: Any) -> None:
    scene = world(floor, camera=HALF)
    image = sr.truth(scene, size=SIZE, tol=TOL, filter="box", threads=1)
    indirect, error = image.layers["indirect"], image.layer("error")
    assert (image.layer("status") == 0).mean() > 0.85
    assert (indirect.max(axis=2) > 5 * error).sum() > 11, "much of the image says something of what bounces"
    judged = cut = 0
    brightest = np.argsort(-indirect.max(axis=2), axis=None)[:9]
    for k in brightest.tolist():
        pixel = k % SIZE, k // SIZE
        expected, sigma = on_a_grid(scene, pixel, 12)
        value = indirect[pixel[1], pixel[0]]
        assert np.abs(value - expected).max() <= 1.5 * error[pixel[1], pixel[0]] + 5 * sigma.max() + TOL / 10
        judged += expected.max() > 1e-2
        cut += sigma.max() > 3e-4
    assert judged == 9 and cut >= 4


@pytest.mark.parametrize("kind", ["tent", "mitchell"])
def test_filters_agree_with_paths(kind: Any) -> None:
    scene = world(SOLID, camera=NARROW)
    image = sr.truth(scene, size=2, tol=5e-3, filter=kind, threads=1)
    runs = [
        sr.render(scene, size=2, numeric="jittered", symbolic="none", lobe=96, filter=kind, seed=seed).numeric
        for seed in range(12)
    ]
    found = np.array([run.layers["indirect"] for run in runs if run is not None])
    sigma = found.std(axis=0, ddof=1) / np.sqrt(len(found))
    off = np.abs(found.mean(axis=0) - image.layers["indirect"])
    assert image.layers["indirect"].max() > 0.05
    # 12 values, and sigmas of 12 runs
    assert (off <= 1.5 * image.layer("error")[..., None] + 7 * sigma + 1e-9).all()
    assert np.median(sigma) < 2e-3


def test_noise_falls_with_the_number_of_paths() -> None:
    scene, sigma = world(SOLID, camera=NARROW), []
    for lobe in (24, 96):
        runs = [
            sr.render(scene, size=2, numeric="jittered", symbolic="none", lobe=lobe, filter="tent", seed=seed).numeric
            for seed in range(12)
        ]
        found = np.array([run.layers["indirect"] for run in runs if run is not None])
        sigma.append(float(np.sqrt((found.std(axis=0, ddof=1) ** 2).mean())))
    # sixteen times the paths: a quarter of the noise, or less by strata
    assert 0.0 < sigma[1] < 0.6 * sigma[0]


def test_no_tile_changes_a_byte() -> None:
    scene = world(TILES, camera=NARROW)
    one, other = (
        sr.truth(scene, size=6, tol=1e-2, filter="box", threads=threads, tile=tile)
        for threads, tile in ((1, 6), (2, 2))
    )
    assert one.layers["indirect"].max() > 0.05
    assert all(one.layers[name].tobytes() == other.layers[name].tobytes() for name in one.layers)
