"""Random pixels of an image that states its error, made again by brute force: the numeric pipeline's own tracer.

Nothing is shared with the rule that made the image: no walls, no charts, no formula. A pixel is rendered ``REPLICATES``
times with scrambled Sobol' samples of its lobe (and of exact disks); the mean is the second opinion, the spread between
replicates its standard error. A pixel contradicts the image where some channel differs by more than its stated error,
plus Student's quantile times the standard error, plus what samples may have missed altogether: a part of the lobe that
none of N samples met holds, but for a chance delta, less than ln(1/delta)/N of it, and no radiance exceeds what all
lights together can bring. The direct light of whole disks is drawn too coarsely for that, so it is left out and the
receipt says that ``of`` the image only the reflection was verified. A pixel beside another shape that is the mean of
K x K points is rendered at each of them. The chances of a false alarm, over all pixels and channels, sum to
``FALSE_ALARMS``.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from typing import Final

import numpy as np
import numpy.typing as npt

from symrender.execution.silhouettes import edges
from symrender.execution.tiles import run_threads, thread_count
from symrender.images.image import Image
from symrender.numeric.pipeline import prepare
from symrender.scene import arrays as at
from symrender.scene.arrays import Array, SceneArrays, lobes_of, scene_arrays
from symrender.scene.scene import Scene
from symrender.settings import EXACT_DISK, Settings, check_share

REPLICATES: Final = 16
SIDE: Final = 64
"""Samples of a lobe a replicate, squared."""
FALSE_ALARMS: Final = 1e-3
"""Chance that an image without fault is contradicted."""
LISTED: Final = 20
"""Most contradicted pixels a receipt lists."""
_NEVER_FINER: Final = 1e-12
"""Relative difference of two correct pipelines in double precision."""


@dataclass(frozen=True)
class Receipt:
    """What the second opinion said of ``verified_pixels`` random pixels.

    ``contradicted`` of them differ by more than can be explained; ``at``: the worst of these, (i, j). ``skipped``:
    pixels drawn that state no value. ``worst_ratio``: the largest difference over what was allowed. ``power``: the
    error, relative to the RMS of the image, that would have been seen in half and in nine tenths of the pixels.
    ``false_alarms``: the chance that an image without fault is contradicted. ``samples``: of a lobe, a pixel.
    ``of``: what was compared, ``radiance`` or, with whole disks, ``radiance - direct``.
    """

    verified_pixels: int
    contradicted: int
    at: tuple[tuple[int, int], ...]
    skipped: int
    worst_ratio: float
    power: tuple[float, float]
    false_alarms: float
    samples: int
    of: str

    def text(self) -> str:
        """One line."""
        where = f" at {', '.join(map(str, self.at))}" if self.at else ""
        half, most = self.power
        return (
            f"verified {self.of} of {self.verified_pixels} pixels by brute force: "
            f"{self.contradicted} contradicted{where}; "
            f"errors of {half:.2g} of the image's RMS would have been seen in half of them, {most:.2g} in nine tenths"
        )

    def json(self) -> str:
        """The receipt as metadata of an image."""
        return json.dumps(asdict(self), sort_keys=True)


def verified(image: Image, scene: Scene, settings: Settings, share: float, threads: int = 0) -> Image:
    """``image``, of ``scene`` under ``settings``, with the receipt of a ``share`` of its pixels as ``verified``."""
    receipt = verify(image.layers, scene, settings, share, threads)
    return Image(image.layers, {**image.meta, "verified": receipt.json()})


def verify(layers: Mapping[str, Array], scene: Scene, settings: Settings, share: float, threads: int = 0) -> Receipt:
    """Compare a random ``share`` of the pixels, at least one, with what the numeric pipeline makes of them.

    The pixels drawn depend on the scene alone, so that the receipt can be made again.
    """
    check_share(share)
    arrays = scene_arrays(scene)
    width, height = settings.width, settings.height
    rng = np.random.default_rng(int(scene.hash[:16], 16))
    drawn = np.sort(rng.choice(width * height, max(1, round(share * width * height)), replace=False))
    stated = layers["error"].reshape(-1)[drawn]
    pixels = drawn[np.isfinite(stated)]
    allowed_chance = FALSE_ALARMS / (2.0 * 3.0 * max(1, len(pixels)))
    whole_disks = settings.disk_order == EXACT_DISK and bool((arrays.lights["kind"] == at.DISK).any())
    k = settings.silhouettes
    at_edge = edges(layers["hit_class"]).reshape(-1)[pixels] if k > 1 else np.zeros(len(pixels), dtype=np.bool_)
    means, errors, weights = (np.zeros((len(pixels), n)) for n in (3, 3, 1))
    for points, chosen in ((1, ~at_edge), (k, at_edge)):
        if chosen.any():
            found = _opinions(arrays, settings, pixels[chosen], points, threads, reflected=whole_disks)
            means[chosen], errors[chosen], weights[chosen] = found
    # whichever of the points has the part that was missed
    unseen = np.log(np.where(at_edge, k * k, 1) / allowed_chance) / (REPLICATES * SIDE**2)
    margin = (
        student_quantile(REPLICATES - 1, 0.5 * allowed_chance) * errors
        + unseen[:, None] * weights * brightest(arrays)
        + _NEVER_FINER * np.abs(means)
    )
    made = layers["radiance"] - layers["direct"] if whole_disks else layers["radiance"]
    value = made.reshape(-1, 3)[pixels]
    allowed = layers["error"].reshape(-1)[pixels][:, None] + margin
    apart = np.abs(value - means)
    ratios = np.divide(apart, allowed, out=np.where(apart > 0, np.inf, 0.0), where=allowed > 0).max(axis=1, initial=0.0)
    wrong = np.nonzero(ratios > 1.0)[0]
    worst = wrong[np.argsort(-ratios[wrong], kind="stable")][:LISTED]
    rms = float(np.sqrt(np.mean(np.square(layers["radiance"]))))
    seen = margin.max(axis=1, initial=0.0) / rms if rms > 0 else np.zeros(len(pixels))
    power = tuple(float(q) for q in np.quantile(seen, (0.5, 0.9))) if len(seen) else (0.0, 0.0)
    return Receipt(
        verified_pixels=len(pixels),
        contradicted=len(wrong),
        at=tuple((int(pixels[k]) % width, int(pixels[k]) // width) for k in worst),
        skipped=len(drawn) - len(pixels),
        worst_ratio=float(ratios.max(initial=0.0)),
        power=(power[0], power[1]),
        false_alarms=FALSE_ALARMS,
        samples=REPLICATES * SIDE**2,
        of="radiance - direct" if whole_disks else "radiance",
    )


def brightest(arrays: SceneArrays) -> Array:
    """A bound (3,) of the radiance that anything sends, scene units: every light full on a white surface, at once."""
    s = arrays.shading
    lit = s.ka * s.ambient + (s.kd + s.ks) * arrays.lights["color"].sum(axis=0)
    bound: Array = np.maximum(lit, s.background)
    return bound


def student_quantile(freedom: int, tail: float) -> float:
    """The t that Student's distribution exceeds with probability ``tail``."""
    constant = math.exp(math.lgamma(0.5 * (freedom + 1)) - math.lgamma(0.5 * freedom)) / math.sqrt(math.pi)

    def beyond(angle: float) -> float:
        # t = sqrt(freedom) tan(angle) makes the density a power of the cosine
        nodes, weights = np.polynomial.legendre.leggauss(64)
        half = 0.5 * (0.5 * math.pi - angle)
        return constant * half * float(weights @ np.cos(angle + half * (1.0 + nodes)) ** (freedom - 1))

    low, high = 0.0, 0.5 * math.pi
    for _ in range(100):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if beyond(middle) > tail else (low, middle)
    return math.sqrt(freedom) * math.tan(low)


def _weights(arrays: SceneArrays) -> Array:
    """How much of its lobe a surface of each hit class adds to a pixel; a mirror has no samples to miss anything by."""
    rows = lobes_of(arrays)
    scale = np.where(arrays.shading.units == at.BRDF_NORMALISED, (rows[:, 1] + 2.0) / (rows[:, 1] + 1.0), 1.0)
    return np.concatenate([[0.0], np.where(rows[:, 2] > 0.0, rows[:, 0] * scale, 0.0)])


def _opinions(
    arrays: SceneArrays,
    settings: Settings,
    pixels: npt.NDArray[np.int64],
    points: int,
    threads: int,
    *,
    reflected: bool,
) -> tuple[Array, Array, Array]:
    """Radiance of pixels, or what is ``reflected`` of it, each the mean of ``points`` x ``points`` points.

    The mean (N, 3) over replicates, its standard error, and how much of their lobes the points add on average (N, 1).
    """
    height, width = points * settings.height, points * settings.width
    finer = replace(settings, width=width, height=height, silhouettes=1, numeric="sobol", lobe=SIDE, symbolic="none")
    kernels = [prepare(arrays, replace(finer, seed=settings.seed + k)) for k in range(REPLICATES)]
    surfaces = _weights(arrays)
    means, errors, weights = (np.empty((len(pixels), n)) for n in (3, 3, 1))

    def batch(first: int, _: int, stop: int, __: int, ___: Mapping[str, Array]) -> int:
        # memory is taken only where a pixel is written
        layers = _room(height, width)
        values = np.empty((REPLICATES, 3))
        for k in range(first, stop):
            j, i = (points * n for n in divmod(int(pixels[k]), settings.width))
            here = np.s_[j : j + points, i : i + points]
            for row, kernel in zip(values, kernels, strict=True):
                kernel(i, j, i + points, j + points, layers)
                seen = layers["radiance"][here] - (layers["direct"][here] if reflected else 0.0)
                row[:] = seen.mean(axis=(0, 1))
            means[k] = values.mean(axis=0)
            errors[k] = values.std(axis=0, ddof=1) / math.sqrt(REPLICATES)
            weights[k] = surfaces[layers["hit_class"][here].astype(np.int64)].mean()
        return 0

    # one thread loads or compiles the kernel; several would each do it
    kernels[0](0, 0, 0, 0, _room(1, 1))
    work = [(first, 0, min(first + 4, len(pixels)), 1) for first in range(0, len(pixels), 4)]
    run_threads(batch, {}, work, thread_count(threads), lambda *_: None)
    return means, errors, weights


def _room(height: int, width: int) -> dict[str, Array]:
    colors = {name: np.zeros((height, width, 3)) for name in ("radiance", "direct", "gloss")}
    return colors | {"hit_class": np.zeros((height, width))}
