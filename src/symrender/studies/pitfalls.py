"""Pitfalls: five ways to get a glossy reflection wrong without noticing, each as numbers on a scene that shows it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np

from symrender.errors import OptionError
from symrender.ledger.statistics import difference
from symrender.quadrature.strata import mirror_rule, rings, rule
from symrender.runtimes import numba
from symrender.scene import arrays as at
from symrender.scene.arrays import Array
from symrender.scene.scene import Scene
from symrender.settings import Partition
from symrender.studies.lobe_rays import LobeRays
from symrender.studies.report import Cell, Study, Table
from symrender.studies.subject import Reference, Subject, facts, relative_reference, subject

_TRUTH: Final = 1e-4
_PARTITIONS: Final[tuple[Partition, ...]] = ("equal_angle", "equal_solid_angle", "equal_weight")
_NEEDLE: Final = 4096.0
_SEEDS: Final = 24


def pitfalls(
    scene: Scene | str | Path | Mapping[str, Any] = "grazing",
    *,
    size: int | tuple[int, int] = 48,
    lobes: Sequence[int] = (2, 4, 8),
    disk: str = "2x2",
    seed: int = 7,
) -> Study:
    """Measure the common pitfalls of sampling a lobe.

    Parameters
    ----------
    scene : str, path, mapping or scene
        A scene in units of the series.
    size : int or (int, int)
        Width and height in pixels; a single number is a square.
    lobes : sequence of int
        K of the K x K directions.
    disk : str
        ``"KxK"`` replaces a disk light by K x K points.
    seed : int
        Seed of the samplers.

    Returns
    -------
    Study
        Tables: horizon, crossings, starvation, bias of the ratio estimator, clipping.

    Raises
    ------
    OptionError
        An option is out of range, or the scene has nothing to measure.
    """
    if not lobes:
        raise OptionError("lobes: must hold at least one K, got none")
    of = subject(scene, size=size, surface="floor", disk=disk, seed=seed)
    truth = relative_reference(of, _TRUTH)
    tables = (
        _horizon(of, truth),
        _crossings(truth),
        _starvation(of, sorted(lobes)),
        _ratio_bias(sorted(lobes)),
        _scene_bias(of, truth, sorted(lobes)),
        _clipping(of, truth, sorted(lobes)),
    )
    return Study("pitfalls", facts(of, truth), tables)


def _lobe(of: Subject) -> tuple[float, float]:
    floor = of.scene.floor
    assert floor is not None and floor.lobe is not None, "a reference has a pixel of the floor's lobe"
    return floor.lobe.exponent, 0.0 if floor.lobe.mirror else floor.lobe.theta_max


def _horizon(of: Subject, truth: Reference) -> Table:
    """What becomes of the light if directions below the horizon are skipped or looked along, not counted as black."""
    k = 64
    kernel_settings: dict[str, Any] = {"lobe": k, "partition": "equal_weight", "nodes": "barycentre"}
    kept = of.layers("symbolic", **kernel_settings)["gloss"]
    places = of.places()
    exponent, theta_max = _lobe(of)
    formulas: Any = numba.plain(numba.image_text())
    lobe = rule(
        rings(formulas, exponent, theta_max, k, nodes="barycentre", partition="equal_weight"),
        sectors=k,
        normalised=False,
    ) if theta_max > 0 else mirror_rule()  # fmt: skip
    rays = LobeRays(of.arrays, of.settings.disk_order)
    shares, buried = np.zeros(truth.mask.shape), np.zeros((*truth.mask.shape, 3))
    for j, i in np.argwhere(truth.mask):
        place, normal = places["place"][j, i], places["normal"][j, i]
        world = lobe.directions @ rays.frame(places["incoming"][j, i], normal)
        shares[j, i] = lobe.weights[world @ normal <= 0.0].sum()
        buried[j, i] = rays.buried(place, normal, at.FLOOR, world, lobe.weights)
    inside = shares[truth.mask]
    factor = 1.0 / np.maximum(1.0 - shares, 1e-12)
    skipped = kept * factor[:, :, None]
    energy = float(kept[truth.mask].mean())
    crossing = inside > 0
    rows: list[tuple[Cell, ...]] = [
        ("counted as black", truth.judge(kept).relative_rmse, 0.0),
        ("skipped", truth.judge(skipped).relative_rmse, float(skipped[truth.mask].mean()) / energy - 1.0),
        ("looked along", truth.judge(kept + buried).relative_rmse, float(buried[truth.mask].mean()) / energy),
    ]  # fmt: skip
    return Table(
        "1. horizon: directions below it",
        ("are", "relative RMSE", "light gained"),
        tuple(rows),
        (
            f"{int(crossing.sum())} of {len(inside)} lobes reach below the horizon; of these the mean share below is "
            f"{float(inside[crossing].mean()) if crossing.any() else 0.0:.3g}, the largest {float(inside.max()):.3g}",
            f"strata {k}x{k}, equal weight; looked along: buried halves of spheres and the background are seen",
        ),
    )


def _crossings(truth: Reference) -> Table:
    """How many walls a lobe meets on visible floor: why no rule of smooth functions keeps its order."""
    rows: list[tuple[Cell, ...]] = []
    for layer in ("crossings", "chambers"):
        counts = truth.layers[layer][truth.mask]
        rows.append((layer, len(counts), float((counts > 0).mean()), float(np.median(counts)), int(counts.max())))
    return Table(
        "2. walls met inside a lobe, visible floor",
        ("of a lobe", "pixels", "share above 0", "median", "most"),
        tuple(rows),
    )


def _starvation(of: Subject, lobes: Sequence[int]) -> Table:
    """Directions that carry weight when the lobe is a needle, and what that does to the picture."""
    formulas: Any = numba.plain(numba.image_text())
    needle = of.with_changes({"floor.lobe.exponent": _NEEDLE, "floor.lobe.mirror": False})
    theta_max = _lobe(needle)[1]
    truth = relative_reference(needle, _TRUTH)
    rows: list[tuple[Cell, ...]] = []
    for k in lobes:
        for partition in _PARTITIONS:
            w = np.repeat(rings(formulas, _NEEDLE, theta_max, k, partition=partition).weights / k, k)
            effective = float(w.sum() ** 2 / (w @ w))
            gloss = needle.layers("symbolic", lobe=k, partition=partition)["gloss"]
            rows.append((partition, k, k * k, effective, truth.judge(gloss).relative_rmse))
    return Table(
        f"3. starvation at n = {_NEEDLE:g}",
        ("partition", "K", "directions", "effective", "relative RMSE"),
        tuple(rows),
        ("effective: (sum w)^2 / sum w^2; the cure is equal_weight, which has every direction count the same",),
    )


def _ratio_bias(lobes: Sequence[int]) -> Table:
    """Bias of sum w f / sum w on f = 1 - cos theta, whose lobe average is known."""
    exponent, theta_max = 16.0, math.pi / 3
    height = 1.0 - math.cos(theta_max)
    u = exponent + 1.0
    c = math.cos(theta_max)
    exact = 1.0 - (u / (u + 1.0)) * (1.0 - c ** (u + 1.0)) / (1.0 - c**u)
    mass = (1.0 - c**u) / (u * height)
    rng = np.random.default_rng(1)
    rows: list[tuple[Cell, ...]] = []
    for k in lobes:
        trials = max(2000, 400_000 // (k * k))
        strata = np.repeat(np.arange(k), k)
        depth = (strata + rng.random((trials, k * k))) / k * height
        weight = (1.0 - depth) ** exponent
        ratio = (weight * depth).sum(axis=1) / weight.sum(axis=1)
        normalised = (weight * depth).mean(axis=1) / mass
        row: list[Cell] = [k, trials]
        for estimates in (ratio, normalised):
            row += [float(estimates.mean()) / exact - 1.0, float(estimates.std(ddof=1)) / math.sqrt(trials) / exact]
        rows.append(tuple(row))
    return Table(
        "4. bias of the ratio estimator on 1 - cos theta, n = 16, theta_max = pi/3",
        ("K", "trials", "ratio", "its standard error", "normalised", "its standard error"),
        tuple(rows),
        ("relative to the closed form; jittered samples, uniform in solid angle",),
    )


def _scene_bias(of: Subject, truth: Reference, lobes: Sequence[int]) -> Table:
    """The same bias in this scene's light: mean over the pixels, spread over seeds."""
    signal = float(truth.gloss[truth.mask].mean())
    rows: list[tuple[Cell, ...]] = []
    for k in lobes:
        row: list[Cell] = [k, _SEEDS]
        for normalised in (False, True):
            means = [
                float(of.layers("numeric", lobe=k, normalised=normalised, seed=seed)["gloss"][truth.mask].mean())
                for seed in range(_SEEDS)
            ]
            row += [float(np.mean(means)) / signal - 1.0, float(np.std(means, ddof=1)) / math.sqrt(_SEEDS) / signal]
        rows.append(tuple(row))
    return Table(
        "5. bias of the ratio estimator on this scene",
        ("K", "seeds", "ratio", "its standard error", "normalised", "its standard error"),
        tuple(rows),
        ("relative to the mean truth over the pixels judged; jittered samples, uniform in solid angle",),
    )


def _clipping(of: Subject, truth: Reference, lobes: Sequence[int]) -> Table:
    """An error measured after clipping to [0, 1] forgives whatever is bright."""
    true = truth.layers["radiance"]
    rows: list[tuple[Cell, ...]] = []
    found = of.layers("numeric", lobe=lobes[-1])["radiance"]
    for exposure in (1.0, 4.0, 16.0):
        clipped = truth.mask & (true * exposure > 1.0).any(axis=2)
        linear = _relative(true * exposure, found * exposure, truth)
        shown = _relative(np.clip(true * exposure, 0.0, 1.0), np.clip(found * exposure, 0.0, 1.0), truth)
        rows.append((exposure, lobes[-1], int(clipped.sum()), linear, shown, shown / linear if linear > 0 else None))
    return Table(
        "6. clipping before the error is measured",
        ("exposure", "K", "pixels clipped", "linear", "clipped", "ratio"),
        tuple(rows),
        ("relative RMSE of radiance, jittered samples; the linear one does not know the exposure",),
    )


def _relative(reference: Array, test: Array, truth: Reference) -> float:
    found = difference(reference, test, truth.mask)
    assert found is not None
    return found.relative_rmse
