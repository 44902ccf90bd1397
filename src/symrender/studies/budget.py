"""Budget: the error of strata split by cause, cell by cell, closing to the error measured against truth.

An estimate is a sum over cells of weight times radiance at a node; the true value is the sum of the cells' integrals.
So the error is a sum of one term a cell, and a cell's term has a cause: the wall that crosses it.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

import numpy as np

from symrender.errors import OptionError
from symrender.quadrature.strata import rings
from symrender.runtimes import numba
from symrender.scene import arrays as at
from symrender.scene.arrays import Array, lobes_of
from symrender.scene.scene import Scene
from symrender.settings import Nodes, Partition, Weights
from symrender.studies.lobe_rays import BEHIND, BELOW, LIGHTS, SHAPE, TEXTURE, Labels, LobeRays
from symrender.studies.report import Cell, Study, Table
from symrender.studies.subject import Subject, Surface, facts, relative_reference, subject

WALLS: Final = ("horizon", "silhouette", "texture edge", "terminator", "shadow edge")
"""Causes that are walls, in the order in which a change of several labels at once is put down to one."""
CAUSES: Final = (*WALLS, "no wall", "weight")
_SMOOTH, _WEIGHT = len(WALLS), len(WALLS) + 1
_TRUTH: Final = 1e-4
_TINY: Final = 1e-6


def budget(
    scene: Scene | str | Path | Mapping[str, Any] = "gloss",
    *,
    size: int | tuple[int, int] = 48,
    lobe: int = 8,
    weights: Weights = "exact",
    nodes: Nodes = "midpoint",
    partition: Partition = "equal_angle",
    normalised: bool = False,
    surface: Surface = "floor",
    disk: str = "2x2",
    seed: int = 7,
    pixels: int = 96,
    fine: int = 128,
) -> Study:
    """Split the error of the strata rule by cause.

    Parameters
    ----------
    scene : str, path, mapping or scene
        A scene in units of the series.
    size : int or (int, int)
        Width and height in pixels; a single number is a square.
    lobe : int
        K of the K x K strata.
    weights : {"exact", "midpoint"}
        Weights of the strata.
    nodes : {"midpoint", "barycentre"}
        Direction of a stratum.
    partition : {"equal_angle", "equal_solid_angle", "equal_weight"}
        How the lobe is divided into rings.
    normalised : bool
        Divide by the closed-form integral of the weight.
    surface : {"floor", "all"}
        Whose lobes are judged.
    disk : str
        ``"KxK"`` replaces a disk light by K x K points.
    seed : int
        Seed of the samplers.
    pixels : int
        Pixels drawn from those with a lobe.
    fine : int
        Rings and sectors by which every cell is integrated.

    Returns
    -------
    Study
        Tables of the error by cause.

    Raises
    ------
    OptionError
        An option is out of range, or the scene has nothing to measure.

    Notes
    -----
    A cell's error goes to the discontinuities that cross it, in proportion to the jump of radiance along each.
    ``share`` is the covariance of a cause's error with the measured one over its mean square. ``if cut`` is the
    relative RMSE without that cause, ``sole`` its part in cells that no other discontinuity crosses.
    """
    if nodes == "gauss":
        raise OptionError("nodes: 'gauss' has no cells whose error could be told apart, choose midpoint or barycentre")
    if pixels < 1 or not lobe <= fine <= 4096:
        raise OptionError(f"pixels, fine: must be >= 1 and from K = {lobe} to 4096, got {pixels!r} and {fine!r}")
    of = subject(scene, size=size, surface=surface, disk=disk, seed=seed)
    rule: dict[str, Any] = {
        "lobe": lobe, "weights": weights, "nodes": nodes, "partition": partition, "normalised": normalised,
    }  # fmt: skip
    truth = relative_reference(of, _TRUTH)
    estimate = of.layers("symbolic", **rule)["gloss"]
    candidates = np.argwhere(truth.mask)
    drawn = np.random.default_rng(seed).permutation(len(candidates))[:pixels]
    chosen = [(int(j), int(i)) for j, i in candidates[np.sort(drawn)]]
    cells = _Cells(of, rule, fine)
    causes, sole, size_of = np.zeros((len(chosen), len(CAUSES), 3)), np.zeros(len(CAUSES)), np.zeros(len(CAUSES))
    for row, pixel in enumerate(chosen):
        causes[row], alone, whole = cells.errors(pixel)
        sole += alone
        size_of += whole
    rows, columns = np.array(chosen).T
    measured = estimate[rows, columns] - truth.gloss[rows, columns]
    signal = float(np.sqrt(np.mean(truth.gloss[rows, columns] ** 2)))
    power = float((measured**2).sum())
    if power == 0 or signal == 0:
        raise OptionError(f"scene: the {len(chosen)} pixels drawn have no error or no signal to split")
    lines: list[tuple[Cell, ...]] = []
    for k, name in enumerate(CAUSES):
        share = float((causes[:, k] * measured).sum()) / power
        left = _rms(measured - causes[:, k]) / signal
        lines.append((name, share, _rms(causes[:, k]) / signal, left, sole[k] / size_of[k] if size_of[k] else None))
    accounted = causes.sum(axis=1)
    total = float((accounted * measured).sum()) / power
    lines.append(("all causes", total, _rms(accounted) / signal, _rms(measured - accounted) / signal, None))
    lines.append(("measured", 1.0, _rms(measured) / signal, 0.0, None))
    table = Table(
        "error by cause",
        ("cause", "share", "relative RMSE", "if cut", "sole"),
        tuple(lines),
        (
            "share: of the mean square error; all causes less 1 is what does not close",
            "if cut: relative RMSE left were this cause removed; sole: part of it in cells no other wall crosses",
        ),
    )
    described = {"pixels drawn": len(chosen), "signal of these, RMS": signal, "does not close": total - 1.0}
    words = f"strata {lobe}x{lobe}, {weights} weights, {nodes} nodes, {partition}"
    return Study("budget", facts(of, truth) | {"estimator": words} | described, (table,))


class _Cells:
    """The cells of a rule on each lobe of a scene, and their errors by cause at a pixel."""

    def __init__(self, of: Subject, rule: Mapping[str, Any], fine: int) -> None:
        self._arrays, self._rule, self._fine = of.arrays, rule, fine
        self._rays = LobeRays(self._arrays, of.settings.disk_order)
        self._formulas: Any = numba.plain(numba.image_text())
        self._places = of.places()
        self._layouts: dict[tuple[float, float], _Layout] = {}

    def errors(self, pixel: tuple[int, int]) -> tuple[Array, Array, Array]:
        """Errors (causes, 3), and of each cause the absolute error in cells of its own and in all."""
        surface = int(self._places["hit_class"][pixel])
        lobe = lobes_of(self._arrays)[surface - at.FLOOR]
        key = (float(lobe[1]), float(lobe[2]))
        if key not in self._layouts:
            if key[1] == 0.0:
                raise OptionError("scene: a mirror has no cells whose error could be told apart")
            self._layouts[key] = _Layout(self._formulas, *key, self._rule, self._fine)
        layout = self._layouts[key]
        place, normal = self._places["place"][pixel], self._places["normal"][pixel]
        frame = self._rays.frame(self._places["incoming"][pixel], normal)
        node = self._rays.see(place, normal, surface, layout.nodes @ frame).radiance
        seen = self._rays.see(place, normal, surface, layout.directions @ frame)
        return layout.split(node, seen.radiance, seen.labels)


class _Layout:
    """Directions of a rule and of its finer one, in the lobe's frame: rings one after the other, sectors within."""

    def __init__(self, formulas: Any, exponent: float, theta_max: float, rule: Mapping[str, Any], fine: int) -> None:
        k = self._k = int(rule["lobe"])
        ring = rings(
            formulas, exponent, theta_max, k, weights=rule["weights"], nodes=rule["nodes"], partition=rule["partition"]
        )
        u = exponent + 1.0
        total = formulas.ring_weight(0.0, theta_max, u)
        self._exact = np.array(
            [formulas.ring_weight(a, b, u) / total for a, b in zip(ring.edges[:-1], ring.edges[1:], strict=True)]
        )
        self._weights = ring.weights if rule["normalised"] else ring.weights / ring.weights.sum()
        self._sectors = max(1, fine // k)
        self.nodes = _directions(ring.nodes, (np.arange(k) + 0.5) / k)
        self._rings: list[Array] = []
        angles: list[Array] = []
        for a, b, share in zip(ring.edges[:-1].tolist(), ring.edges[1:].tolist(), self._exact.tolist(), strict=True):
            count = max(4, round(fine * share))
            edges = np.linspace(a, b, count + 1)
            if share > _TINY:
                below = formulas.ring_weight(0.0, a, u) / total if a > 0 else 0.0
                inner = [formulas.share_angle(below + share * j / count, theta_max, u) for j in range(1, count)]
                edges[1:-1] = np.clip(inner, a, b)
            pairs = list(zip(edges[:-1].tolist(), edges[1:].tolist(), strict=True))
            self._rings.append(np.array([formulas.ring_weight(c, d, u) / total for c, d in pairs]))
            angles.append(np.array([formulas.ring_barycentre(c, d, u) if d > c else c for c, d in pairs]))
        turns = (np.arange(k * self._sectors) + 0.5) / (k * self._sectors)
        self.directions = np.concatenate([_directions(angle, turns) for angle in angles])

    def split(self, node: Array, radiance: Array, labels: Labels) -> tuple[Array, Array, Array]:
        """Errors by cause from the radiance at the nodes and on the finer rule; see ``_Cells.errors``."""
        k, sectors = self._k, self._sectors
        errors, sole, whole = np.zeros((len(CAUSES), 3)), np.zeros(len(CAUSES)), np.zeros(len(CAUSES))
        start = 0
        for r, share in enumerate(self._rings):
            stop = start + len(share) * k * sectors
            shape = (len(share), k, sectors, -1)
            f, label = radiance[start:stop].reshape(shape), labels[start:stop].reshape(shape)
            start = stop
            integral = np.einsum("j,jksc->kc", share, f) / (k * sectors)
            at_node = node[r * k : (r + 1) * k]
            errors[_WEIGHT] += (self._weights[r] - self._exact[r]) / k * at_node.sum(axis=0)
            missed = self._exact[r] / k * at_node - integral
            jumps = _jumps(f, label, share, axis=0) + _jumps(f, label, share, axis=2)
            crossed = jumps.sum(axis=0)
            parts = np.zeros((len(CAUSES), k))
            parts[: len(WALLS)] = np.divide(jumps, crossed, out=np.zeros_like(jumps), where=crossed > 0)
            parts[_SMOOTH] = crossed == 0
            errors += parts @ missed
            size = np.abs(missed).sum(axis=1)
            whole += parts @ size
            sole += (parts == 1.0) @ size
        return errors, sole, whole


def _jumps(f: Array, label: Labels, share: Array, axis: int) -> Array:
    """Weighted |change of radiance| between neighbours along ``axis`` by the wall between them: (walls, sectors)."""
    count = f.shape[axis]
    before, after = [np.take(label, np.arange(count - 1) + step, axis=axis) for step in (0, 1)]
    change = np.abs(np.diff(f, axis=axis)).sum(axis=3) * share[: before.shape[0], None, None]
    differ = before != after
    horizon = differ[..., SHAPE] & ((before[..., SHAPE] == BELOW) | (after[..., SHAPE] == BELOW))
    lights = differ[..., LIGHTS:]
    behind = ((before[..., LIGHTS:] == BEHIND) != (after[..., LIGHTS:] == BEHIND)).any(axis=3)
    kinds = (horizon, differ[..., SHAPE], differ[..., TEXTURE], behind, lights.any(axis=3))
    free = np.ones(change.shape, np.bool_)
    sums = []
    for kind in kinds:
        # a wall across which nothing changes costs nothing, but still counts as crossing
        sums.append(np.where(kind & free, change + 1e-300, 0.0).sum(axis=(0, 2)))
        free &= ~kind
    return np.array(sums)


def _directions(angles: Array, turns: Array) -> Array:
    """Unit directions in the lobe's frame, ring by ring."""
    sine, cosine = np.sin(angles)[:, None], np.cos(angles)[:, None]
    phi = 2.0 * np.pi * turns
    parts = np.broadcast_arrays(sine * np.cos(phi), sine * np.sin(phi), cosine)
    return np.stack(parts, axis=-1).reshape(-1, 3)


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))
