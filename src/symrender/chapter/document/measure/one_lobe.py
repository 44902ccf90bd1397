"""One lobe looked at closely: its disc, its walls, and how strata and the split rule integrate it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from symrender.chapter.document.effort import Effort
from symrender.chapter.document.figures import Figure, Measured, figures_of
from symrender.chapter.document.lobe_disc import Disc, Lobe
from symrender.chapter.document.lobe_stages import Stage, staged
from symrender.chapter.document.pictures import element
from symrender.chapter.document.plots import Curve, log_log
from symrender.chapter.document.tables import table
from symrender.images.picture import SEQUENTIAL, color_map
from symrender.images.srgb import encode_srgb
from symrender.probe import Probe, probe
from symrender.quadrature.strata import Rule, mirror_rule, rings, rule
from symrender.runtimes import numba
from symrender.scene import arrays as at
from symrender.scene.arrays import Array
from symrender.studies.lobe_rays import LobeRays
from symrender.studies.power_law import fit_power_law
from symrender.studies.subject import Subject, reference, subject

_SCENE: Final = "gloss"
_POINT: Final = (0.18, -2.66)
"""Its lobe sees all three spheres, texture lines and terminators."""
_SIDE: Final = 8
_GAIN: Final = 1.6
_TRUTH: Final = 1e-11
_LOOK: Final = 1e-2
_FINE: Final = 2
_DIM: Final = 0.45
_STAGED: Final = 360


@dataclass(frozen=True, eq=False)
class Spot:
    """A floor point, and the unit direction along which the eye sees it."""

    place: Array
    incoming: Array


def measure(effort: Effort) -> Measured:
    """Blocks ``lobe.*`` and ``walls.map``; figures ``lobe.*``, ``walls.*``."""
    of = subject(_SCENE, size=effort.map_size)
    truth = reference(of, _LOOK)
    spot = _spot(of)
    lobe = _lobe(of, spot)
    disc = lobe.disc(effort.disc, gain=_GAIN, fine=_FINE)
    true = _probe(spot, _TRUTH)
    counts = truth.layers["crossings"][truth.mask]
    where = f"scene {_SCENE}, floor point ({spot.place[0]:.4f}, {spot.place[1]:.4f})"
    figures = figures_of(
        "lobe", where, x=float(spot.place[0]), y=float(spot.place[1]), chambers=int(true.chambers[0]),
        crossings=int(true.crossings[0]), gloss=float(true.gloss[0, 0]), error=float(true.error[0]),
        disc=float(disc.mean[0]), apart=float(np.abs(disc.mean / true.gloss[0] - 1.0).max()),
        directions=int(math.pi / 4 * (_FINE * effort.disc) ** 2), exponent=lobe.exponent, theta_max=lobe.theta_max,
        sides=_SIDE, looked=int(_probe(spot, _LOOK).crossings[0]),
    )  # fmt: skip
    staged = _staged(of, lobe, spot, true)
    figures |= staged.figures
    figures |= figures_of(
        "walls", f"scene {_SCENE}, {of.settings.width} x {of.settings.height}, {len(counts)} floor pixels",
        pixels=len(counts), share=float((counts > 0).mean()), median=float(np.median(counts)), most=int(counts.max()),
        tolerance=_LOOK,
    )  # fmt: skip
    blocks = {
        "lobe.starved": _drawn(lobe, disc, "equal_angle", "midpoint"),
        "lobe.fed": _drawn(lobe, disc, "equal_weight", "barycentre"),
        "walls.map": _map(truth.layers),
        **staged.blocks,
    }
    integrated = _integrated(effort, of, spot, true)
    return Measured({**figures, **integrated.figures}, {**blocks, **integrated.blocks})


def _spot(of: Subject) -> Spot:
    place = np.array([*_POINT, 0.0])
    away: Array = place - of.arrays.camera.eye
    return Spot(place, away / np.linalg.norm(away))


def _lobe(of: Subject, spot: Spot) -> Lobe:
    floor = of.scene.floor
    assert floor is not None and floor.lobe is not None
    shape = (floor.lobe.exponent, floor.lobe.theta_max)
    return Lobe(of.arrays, spot.place, np.array([0.0, 0.0, 1.0]), spot.incoming, at.FLOOR, shape)


def _drawn(lobe: Lobe, disc: Disc, partition: Any, nodes: Any) -> str:
    formulas: Any = numba.plain(numba.image_text())
    ring = rings(formulas, lobe.exponent, lobe.theta_max, _SIDE, partition=partition, nodes=nodes)
    words = partition.replace("_", " ")
    return lobe.picture(
        disc, ring, _SIDE, f"The lobe of one floor point as a disc, cut into cells of {words}", partition
    )


def _staged(of: Subject, lobe: Lobe, spot: Spot, true: Probe) -> Measured:
    """Block ``lobe.stages``: the lobe in one direction, four, sixteen, all, and its walls; figures ``lobe.stage_*``."""
    formulas: Any = numba.plain(numba.image_text())
    signal = float(np.abs(true.gloss[0]).max())
    stages, errors = [], {}
    for name, k in (("one", 1), ("four", 2), ("sixteen", 4)):
        ring = None
        if k > 1:
            ring = rings(formulas, lobe.exponent, lobe.theta_max, k, partition="equal_weight", nodes="barycentre")
        found = _along(of, spot, mirror_rule() if ring is None else rule(ring, sectors=k, normalised=False))
        errors[f"stage_{name}"] = float(np.abs(found - true.gloss[0]).max()) / signal
        stages.append(Stage(k * k, ring, found, errors[f"stage_{name}"]))
    plain = lobe.disc(_STAGED, gain=_GAIN, fine=_FINE, walls=False)
    walls = int(true.crossings[0])
    source = f"scene {_SCENE}, one floor point, strata of equal weight at barycentres, against the split rule"
    return Measured(
        figures_of("lobe", source, **errors),
        {"lobe.stages": staged(lobe, plain, stages, true.gloss[0] * _GAIN, _GAIN, walls, "disc-equal_angle")},
    )


def _probe(spot: Spot, tol: float) -> Probe:
    return probe(_SCENE, [spot.place[:2].tolist()], tol=tol, budget=10_000_000)


def _map(layers: Any) -> str:
    """Floor pixels by the walls their lobes meet, over the picture in dark grey."""
    met = layers["crossings"].astype(np.float64)
    grey = encode_srgb(layers["radiance"]).mean(axis=2, keepdims=True) * _DIM
    colors = color_map(met, 0.0, float(met.max()), SEQUENTIAL)
    pixels = np.where(met[:, :, None] > 0, colors, grey).astype(np.uint8)
    return element(pixels, "The floor of the scene, brightest where a lobe meets most walls", smooth=False)


def _integrated(effort: Effort, of: Subject, spot: Spot, true: Probe) -> Measured:
    """Error against evaluations at one point: the split rule, and strata by angle and by weight."""
    signal = float(np.abs(true.gloss[0]).max())

    def gap(gloss: Array) -> float:
        return float(np.abs(gloss - true.gloss[0]).max()) / signal

    rows: list[list[Any]] = []
    split: list[tuple[int, float]] = []
    for tol in effort.probe_tolerances:
        found = _probe(spot, tol)
        split.append((int(found.evaluations[0]), gap(found.gloss[0])))
        rows.append([tol, int(found.evaluations[0]), float(found.error[0]), gap(found.gloss[0]) * signal])
    curves = [_curve("split at the walls", split, 5)]
    figures: dict[str, Figure] = {}
    source = f"scene {_SCENE}, one floor point, against the split rule at {_TRUTH:g}"
    for color, (name, partition, nodes) in enumerate(
        (("strata, equal angles", "equal_angle", "midpoint"), ("strata of equal weight", "equal_weight", "barycentre"))
    ):
        points = [(k * k, gap(_strata(of, spot, k, partition, nodes))) for k in effort.strata]
        curves.append(_curve(name, points, 2 * color))
        law = fit_power_law([n for n, _ in points], [max(e, 1e-16) for _, e in points])
        assert law is not None
        figures |= figures_of(f"split.{partition}", source, order=law.order, best=points[-1][1], cost=points[-1][0])
    figures |= figures_of(
        "split", source, cost=split[-1][0], best=split[-1][1], tol=effort.probe_tolerances[-1], truth=_TRUTH,
        honest=sum(row[3] <= row[2] + float(true.error[0]) for row in rows), asked=len(rows), signal=signal,
    )  # fmt: skip
    plot = log_log(
        "split", curves, x="evaluations, one lobe", y="error / value",
        alt="Error against evaluations at one point: strata fall slowly and irregularly, the split rule drops",
    )  # fmt: skip
    columns = ("tolerance asked", "evaluations", "error it states", "error it has")
    return Measured(figures, {"split.plot": plot, "split.table": table(columns, rows, label="The split rule")})


def _curve(name: str, points: list[tuple[int, float]], color: int) -> Curve:
    kept = [(n, e) for n, e in points if e > 0]
    return Curve(name, [n for n, _ in kept], [e for _, e in kept], color)


def _strata(of: Subject, spot: Spot, k: int, partition: Any, nodes: Any) -> Array:
    formulas: Any = numba.plain(numba.image_text())
    floor = of.scene.floor
    assert floor is not None and floor.lobe is not None
    ring = rings(formulas, floor.lobe.exponent, floor.lobe.theta_max, k, partition=partition, nodes=nodes)
    return _along(of, spot, rule(ring, sectors=k, normalised=False))


def _along(of: Subject, spot: Spot, lobe: Rule) -> Array:
    """What a rule makes of the floor's lobe at ``spot``."""
    rays = LobeRays(of.arrays, 2)
    normal = np.array([0.0, 0.0, 1.0])
    seen = rays.see(spot.place, normal, at.FLOOR, lobe.directions @ rays.frame(spot.incoming, normal))
    found: Array = lobe.weights @ seen.radiance
    return found
