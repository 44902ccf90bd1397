"""Two pipelines that share no formula see the same radiance along the same ray.

Rays are those of lobes: from a visible floor or sphere point into the half-space above it, over five gallery scenes.
"""

from __future__ import annotations

import numpy as np
from measure import Report, arguments

from symrender.numeric.pipeline import trace as numeric
from symrender.runtimes.image import trace as symbolic
from symrender.scene import arrays as at
from symrender.scene.arrays import SceneArrays, scene_arrays
from symrender.scene.load import load

SCENES = ("chapter8", "gloss", "penumbra", "grazing", "needle")
SEED = 20
BOUND = 1e-12
"""Of the RMS radiance."""


def lobe_rays(arrays: SceneArrays, count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Origins, unit directions and hit classes left, half of them on the floor and half on spheres.

    Half of the directions are uniform over the half-space, half aim at a random point of a random other sphere's
    bounding cube, so that most of the rays meet something.
    """
    rng = np.random.default_rng(SEED)
    centers, radii = arrays.spheres["center"], arrays.spheres["radius"]
    which = rng.integers(0, len(radii), count)
    on_floor = rng.random(count) < 0.5
    center, radius = centers[which], radii[which]
    normal = unit(rng.standard_normal((count, 3)))
    spread = 2.5 * (np.abs(centers).max() + radii.max())
    spot = np.concatenate([rng.uniform(-spread, spread, (count, 2)), np.zeros((count, 1))], axis=1)
    covered = [np.hypot(*(spot[:, :2] - c[:2]).T) < r for c, r in zip(centers, radii, strict=True) if c[2] < r]
    on_floor &= ~np.any(covered, axis=0) if covered else True
    origin = np.where(on_floor[:, None], spot, center + radius[:, None] * normal)
    normal = np.where(on_floor[:, None], (0.0, 0.0, 1.0), normal)
    leaves = np.where(on_floor, at.FLOOR, at.FIRST_SPHERE + which)
    aim = rng.integers(0, len(radii), count)
    target = centers[aim] + radii[aim, None] * rng.uniform(-1, 1, (count, 3))
    direction = np.where(rng.random(count)[:, None] < 0.5, unit(rng.standard_normal((count, 3))), unit(target - origin))
    height = (direction * normal).sum(axis=1, keepdims=True)
    direction -= 2 * np.minimum(height, 0) * normal
    return origin, unit(direction), leaves


def unit(v: np.ndarray) -> np.ndarray:
    return v / np.linalg.norm(v, axis=1, keepdims=True)


def nearness(arrays: SceneArrays, origin: np.ndarray, direction: np.ndarray) -> float:
    """Smallest |distance from a sphere's centre - radius| of one ray, over the radius."""
    f = arrays.spheres["center"] - origin
    offset = np.linalg.norm(f - (f @ direction)[:, None] * direction, axis=1)
    return float(np.abs(offset / arrays.spheres["radius"] - 1).min())


def main() -> None:
    options = arguments(__doc__)
    count = 20_000 if options.quick else 200_000
    report = Report("pipelines_agree", f"{count * len(SCENES)} random lobe rays, the same to both pipelines.")
    rows, worst, mismatched = [], [], 0
    for name in SCENES:
        arrays = scene_arrays(load(name))
        origin, direction, leaves = lobe_rays(arrays, count)
        a, class_a, distance_a = numeric(arrays, origin, direction, leaves)
        b, class_b, distance_b = symbolic(arrays, origin, direction, leaves)
        met = class_a != at.NOTHING
        signal = float(np.sqrt((a[met] ** 2).mean()))
        differ = int((class_a != class_b).sum())
        mismatched += differ
        gap = np.abs(a - b).max(axis=1) / signal
        gap[class_a != class_b] = 0.0
        both = met & (class_b != at.NOTHING)
        apart = float(np.max(np.abs(distance_a[both] / distance_b[both] - 1)))
        quantiles = np.quantile(gap[met], (0.5, 0.99, 0.9999))
        rows.append((name, count, f"{met.mean():.1%}", signal, *map(float, quantiles), float(gap.max()), differ, apart))
        worst += [
            (gap[k], name, k, nearness(arrays, origin[k], direction[k]), a[k], b[k]) for k in np.argsort(gap)[-3:]
        ]
    report.table(
        ("scene", "rays", "met", "RMS radiance", "median", "99 %", "99.99 %", "largest", "classes differ", "distance"),
        rows,
    )
    report.say(
        "Differences are of the worst channel over the RMS radiance of what was met; a black image differs by 1 or "
        "more. `distance` is the largest relative difference of the distances."
    )
    beyond = sorted((w for w in worst if w[0] > BOUND), key=lambda w: -w[0])
    for gap, name, k, near, a, b in beyond:
        report.say(f"- {name} ray {k}: {gap:.2e}; it passes {near:.1e} radii from a silhouette; {a} and {b}")
    assert all(float(row[2].rstrip("%")) > 20 and row[3] > 0.01 for row in rows), "too little signal to compare"
    report.claim_number("rays that met different shapes", mismatched, 0)
    report.claim_number("largest relative difference of radiance", max(row[7] for row in rows), BOUND)
    report.leave()


if __name__ == "__main__":
    main()
