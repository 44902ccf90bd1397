"""Bounced light off marbled planes: the waves and their weights, single rays halved until they agree, and paths."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import symrender as sr
from symrender.numeric.radiometric.pipeline import rays as numeric_rays
from symrender.quadrature.gauss import BLOCK_LEVELS
from symrender.quadrature.veins import ALONG, RISE, SWINGS, VEINS, vein_wave, veined_table
from symrender.scene.load import load_any
from symrender.scene.parameters import parameters
from symrender.scene.radiometric.arrays import radiometric_arrays

from .seen_nested import gathered

POINT = {"type": "point", "name": "key", "position": [-1.5, -2, 2.5], "intensity": [30, 25, 20]}
SUN = {"type": "directional", "name": "sun", "direction": [0.4, 0.5, -1], "irradiance": [3, 2.5, 2]}
SKY = {"type": "sky", "name": "sky", "radiance": [1, 0.8, 0.6]}
EYE, AIM = np.array([0.0, -4.0, 0.3]), np.array([0.1, -0.35, 0.35])
ALBEDO = 0.8
CENTER = [0.0, 0.0, 0.6]


def scene(light: dict[str, Any], *, cell: float = 0.7, normal: tuple[float, ...] = (0, 0, 1)) -> dict[str, Any]:
    """A ball over a marbled floor."""
    veins = {"type": "marble", "bright": [0.9, 0.8, 0.7], "dark": [0.1, 0.2, 0.3], "cell": cell}
    return {
        "units": "radiometric",
        "name": "veins",
        "bounces": 1,
        "camera": {"type": "look_at", "eye": EYE.tolist(), "target": AIM.tolist(), "fov": 40},
        "materials": {
            "veins": {"type": "diffuse", "reflectance": veins, "two_sided": True},
            "chalk": {"type": "diffuse", "reflectance": ALBEDO},
        },
        "shapes": [
            {"type": "plane", "name": "floor", "point": [0.3, 0.2, 0], "normal": list(normal), "along": [1, 0.3, 0],
             "material": "veins"},
            {"type": "sphere", "name": "A", "center": CENTER, "radius": 0.5, "material": "chalk"},
            {"type": "sphere", "name": "B", "center": [1.4, 0.3, 0.8], "radius": 0.5, "material": "chalk"},
        ],
        "lights": [light],
    }  # fmt: skip


def place_of(origin: np.ndarray, aim: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Where the ray meets ball A, and its normal there."""
    center, direction = np.array(CENTER), (aim - origin) / np.linalg.norm(aim - origin)
    along = (center - origin) @ direction
    off2 = (center - origin) @ (center - origin) - along**2
    place = origin + (along - math.sqrt(0.25 - off2)) * direction
    return place, (place - center) / 0.5


def test_the_amplitudes_of_the_waves_are_the_leafs() -> None:
    x, y = np.arange(8) / 8.0, np.arange(256) / 128.0
    table = np.array([[vein_wave(a, b) for a in x] for b in y])
    waves = 2.0 * np.abs(np.fft.fft2(table)) / table.size
    # over y there are two cells, so that q pi is the q-th harmonic; over x p = 2 is the first one
    rows = RISE * np.arange(len(SWINGS))
    found = np.maximum(waves[rows, ALONG // 2], waves[-rows, ALONG // 2])
    assert (found <= np.array(SWINGS)).all() and (found > 0.85 * np.array(SWINGS)).all()
    left = waves.copy()
    for n in range(len(SWINGS)):
        for p in (1, -1):
            left[RISE * n, p] = left[-RISE * n, p] = 0.0
    assert left.max() < 1e-5 < waves.max()


@pytest.mark.parametrize("level", [0, 1, 3])
@pytest.mark.parametrize("begin", [0, 1])
def test_weights_integrate_polynomials_times_veins(level: int, begin: int) -> None:
    table, n, cells = veined_table(), 9, 2**level
    start = n * (n - 1) // 2
    x, w = np.polynomial.legendre.leggauss(24)
    fine, weight = (0.5 * (1.0 + x[None]) + np.arange(2 * cells)[:, None]).ravel() / (2 * cells), np.tile(w, 2 * cells)
    weight = weight / weight.sum()

    def smooth(s: Any, t: Any) -> Any:
        return (1.0 + s - 2.0 * s**5) * (0.3 - t + t**7)

    at = np.array([[vein_wave(cells * s, begin + cells * t) for s in fine] for t in fine])
    true = weight @ (at * smooth(fine[None, :], fine[:, None])) @ weight
    sine, cosine, even, odd = (table[VEINS + 4 * level + row, start : start + n] for row in range(4))
    nodes = table[0, start : start + n]
    rule = even[:, None] * sine + (1.0 if begin == 0 else -1.0) * odd[:, None] * cosine
    assert abs(true) > 1e-6
    assert float((rule * smooth(nodes[None, :], nodes[:, None])).sum()) == pytest.approx(true, rel=1e-9, abs=1e-13)
    assert len(table) == VEINS + 4 * BLOCK_LEVELS


@pytest.mark.parametrize(
    ("light", "normal", "closer"),
    [(POINT, (0, 0, 1), 1e-8), (POINT, (0, 0, -1), 1e-8), (SUN, (0.1, 0, 1), 3e-6)],
)
def test_single_rays_gather_as_much(light: dict[str, Any], normal: tuple[float, ...], closer: float) -> None:
    made = scene(light, normal=normal)
    known = gathered(made, *place_of(EYE, AIM), closer)
    assert known.light.min() > 0.02 and known.error < 1e-2 * known.light.max()
    for tol in (1e-3, 1e-5):
        seen = sr.probe(made, rays=(EYE, AIM - EYE), tol=tol)
        assert seen.status[0] == 0 and seen.shape == ("shapes.A",)
        off = np.abs(seen.indirect[0] - ALBEDO * known.light).max()
        assert off <= seen.error[0] + ALBEDO * known.error
    # veins are seen: another phase of them is another light
    moved = sr.load(made).replace({"shapes.floor.point.x": 0.3 + 0.25 * 0.7})
    other = sr.probe(moved, rays=(EYE, AIM - EYE), tol=1e-5)
    assert np.abs(other.indirect - seen.indirect).max() > 5.0 * (seen.error[0] + other.error[0])


@pytest.mark.parametrize("light", [SUN, SKY])
def test_paths_find_as_much(light: dict[str, Any]) -> None:
    made = sr.load(scene(light, cell=1.3, normal=(0.2, 0.1, -1)))
    aims = np.array([[0.1, -0.35, 0.35], [-0.2, -0.4, 0.6], [1.3, 0, 0.5], [1.5, -0.1, 0.6]])
    origins = np.tile(EYE, (4, 1))
    seen = sr.probe(made, rays=(origins, aims - origins), tol=1e-4)
    unit = (aims - origins) / np.linalg.norm(aims - origins, axis=1, keepdims=True)
    runs = [numeric_rays(radiometric_arrays(made), origins, unit, order=96, seed=s)[2] for s in range(8)]
    mean, error = np.mean(runs, axis=0), np.std(runs, axis=0, ddof=1) / math.sqrt(8)
    assert (seen.status == 0).all() and seen.indirect.min() > 0.01 and (error < 0.03 * seen.indirect).all()
    # eight runs make a t of seven degrees
    assert np.abs((mean - seen.indirect) / error).max() < 8.0


def test_a_loose_tolerance_keeps_its_word() -> None:
    random, values = np.random.default_rng(5), 0
    for cell, light in ((0.1, POINT), (0.4, SUN), (3.0, POINT)):
        made = sr.load(scene(light, cell=cell))
        aims = np.column_stack(
            [random.uniform(-0.4, 1.7, 6), random.uniform(-0.3, 0.1, 6), random.uniform(0.3, 0.8, 6)]
        )
        rays = (np.tile(EYE, (6, 1)), aims - EYE)
        strict = sr.probe(made, rays=rays, tol=1e-6)
        for tol in (1e-2, 1e-3, 1e-4):
            loose = sr.probe(made, rays=rays, tol=tol)
            assert (np.abs(loose.indirect - strict.indirect).max(axis=1) <= loose.error + strict.error).all()
            values += int((strict.indirect.max(axis=1) > 1e-2).sum())
    assert values > 25


def test_derivatives_are_differences() -> None:
    made = sr.load(scene(POINT))
    names = ["shapes.A.center.x", "shapes.floor.point.x", "materials.veins.reflectance.cell", "lights.key.position.y",
             "materials.veins.reflectance.bright.r", "shapes.floor.normal.x"]  # fmt: skip
    values = {each.name: each.value for each in parameters(load_any(scene(POINT)))}
    slopes = sr.gradient(made, names, size=1, tol=1e-4, threads=1, tile=1)
    size = 0.0
    for name in names:
        found = slopes[name].layer("indirect")[0, 0]
        assert slopes[name].layer("status")[0, 0] == 0
        h, ends = 2e-3, []
        for step in (h, -h, 0.5 * h, -0.5 * h):
            moved = made.replace({name: float(values[name]) + step})
            ends.append(sr.truth(moved, size=1, tol=1e-8, threads=1, tile=1).layer("indirect")[0, 0])
        differences = (8.0 * (ends[2] - ends[3]) - (ends[0] - ends[1])) / (6.0 * h)
        assert np.abs(found - differences).max() < 2e-5
        size = max(size, float(np.abs(found).max()))
    assert size > 0.1
