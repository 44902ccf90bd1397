"""Derivatives of bounced light of which nothing is looked at: what is black, and what is too faint to be integrated."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

import symrender as sr
from symrender.quadrature.split_setup import MET
from symrender.quadrature.split_slopes import SlopeResult
from symrender.runtimes.bounce_pace import FIXED, MEASURES
from symrender.runtimes.bounce_slopes import _Sums
from symrender.scene.radiometric.records import Light, Material, Shape

Array = npt.NDArray[np.float64]
SIZES = (1.0, 1e-4, 1e3)


def scene_of(seed: int, size: float = 1.0, **changes: Any) -> dict[str, Any]:
    """A floor that is seen, under a lamp, two balls beside it and a small one far away, none of which is seen."""
    rng = np.random.default_rng(seed)
    around = rng.uniform(0, 2 * np.pi, 3)
    away = np.array([0.9, 1.5, rng.uniform(8, 20)])
    radii = np.array([0.3, 0.4, rng.uniform(0.05, 0.2)])
    centers = np.column_stack([away * np.cos(around), away * np.sin(around), radii + rng.uniform(0.1, 0.4, 3)])
    materials = {"floor": [0.8, 0.6, 0.4], "near": [0.3, 0.5, 0.7], "other": [0.6, 0.2, 0.1], "far": [0.9, 0.5, 0.7]}
    materials |= changes
    lamp = np.array([*rng.uniform(-1, 1, 2), 3.0])
    return {
        "units": "radiometric", "bounces": 1,
        "camera": {"type": "look_at", "eye": [0, -0.01 * size, 2 * size], "target": [0, 0, 0], "fov": 5},
        "materials": {name: {"type": "diffuse", "reflectance": value} for name, value in materials.items()},
        "shapes": [
            {"type": "plane", "name": "floor", "point": [0, 0, 0], "normal": [0, 0, 1], "material": "floor"},
            *({"type": "sphere", "name": name, "center": (size * c).tolist(), "radius": size * r, "material": name}
              for name, c, r in zip(("near", "other", "far"), centers, radii.tolist(), strict=True)),
        ],
        "lights": [{"type": "point", "name": "key", "position": (size * lamp).tolist(),
                    "intensity": (size * size * np.array([30.0, 25.0, 20.0])).tolist()}],
    }  # fmt: skip


def light(scene: Any, tol: float = 1e-10) -> Array:
    """Bounced light of the one pixel."""
    image = sr.truth(scene, size=1, tol=tol, threads=1, tile=1, budget=4_000_000)
    assert image.layer("error")[0, 0] <= tol
    return np.asarray(image.layer("indirect")[0, 0])


def slope(scene: Any, name: str, tol: float) -> tuple[Array, float, int]:
    """The derivative of the one pixel, what it states, its status."""
    image = sr.gradient(scene, [name], size=1, tol=tol, threads=1, tile=1)[name]
    layers = (image.layer(each)[0, 0] for each in ("indirect", "error", "status"))
    value, error, status = layers
    return np.asarray(value), float(error), int(status)


@pytest.mark.parametrize("channel", [0, 2])
def test_a_ball_that_is_black_has_a_slope(channel: int) -> None:
    name = f"materials.near.reflectance.color.{'rgb'[channel]}"
    for seed in range(3):
        lit = np.zeros(3)
        lit[channel] = 1.0
        black, bright = (scene_of(seed, near=each) for each in ([0.0] * 3, lit.tolist()))
        # one bounce is of first degree in what is seen
        wanted = light(bright) - light(black)
        assert wanted[channel] > 1e-4
        for tol in (1e-2, 1e-5, 1e-8):
            found, error, status = slope(black, name, tol)
            assert np.abs(found - wanted).max() <= error + 2e-10 and error > 0.0 and (status != MET or error <= tol)
        np.testing.assert_allclose(found, wanted, atol=1e-7)


def test_a_lamp_without_light_has_a_slope() -> None:
    for seed in range(3):
        dark, bright = scene_of(seed), scene_of(seed)
        dark["lights"][0]["intensity"], bright["lights"][0]["intensity"] = [0.0] * 3, [0.0, 1.0, 0.0]
        wanted = light(bright)
        assert wanted[1] > 1e-5
        for tol in (1e-1, 1e-3, 1e-7):
            found, error, _ = slope(dark, "lights.key.intensity.g", tol)
            assert np.abs(found - wanted).max() <= error + 2e-10 and error > 0.0


@pytest.mark.parametrize("size", SIZES)
def test_what_is_too_faint_is_stated(size: float) -> None:
    names = ["materials.far.reflectance.color.g", "shapes.far.radius", "shapes.far.center.z", "lights.key.position.x"]
    told = 0
    for seed in range(3):
        scene = sr.load(scene_of(seed, size))
        for name in names:
            exact, sure, _ = slope(scene, name, 1e-9 / (1.0 if "color" in name else size))
            for tol in (1.0, 1e-1, 1e-2, 1e-3):
                found, error, status = slope(scene, name, tol)
                assert np.abs(found - exact).max() <= error + sure
                assert error > 0.0 and (status != MET or error <= tol)
                told += bool(np.abs(exact).max() > 10.0 * sure and np.abs(found - exact).max() > sure)
    # where something was left out it is what was stated
    assert told >= 10


def test_every_number_of_a_scene_has_a_measure() -> None:
    for kind in (Material, Shape, Light):
        assert set(MEASURES[kind]) == set(kind.layout.names or ())
    assert sum(measure != FIXED for kind in MEASURES.values() for measure in kind.values()) == 16


def test_a_slope_of_which_nothing_is_known_leaves_its_value_known() -> None:
    sums, count = _Sums.of(2), np.zeros(2, np.int64)
    error = np.array([complex(1e-3, np.inf), complex(1e-3, 2e-3)])
    seen = SlopeResult(np.full((2, 3), 1.0 + 1.0j), error, np.zeros(2), np.zeros(2), count, count)
    sums.add(seen, np.full((2, 3), 0.5 + 0.0j))
    np.testing.assert_array_equal(sums.missed.real, 5e-4)
    np.testing.assert_array_equal(sums.missed.imag, [np.inf, 1e-3])
