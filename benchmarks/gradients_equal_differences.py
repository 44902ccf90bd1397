"""Exact gradients equal extrapolated differences of values, first order to 1e-8 and second to 1e-5.

Random points and parameters of six views: floors and lobes of spheres, oblique and grazing, with shadows and penumbrae.
Values are those of ``probe``; of the gradient nothing is used but its result. Left out by name, and counted: pairs
whose value changes its structure within the step (chambers or walls met differ), whose value missed its tolerance, and
whose derivative is too small for differences of doubles to resolve.
"""

from __future__ import annotations

import sys
from collections import Counter

import numpy as np
from measure import Report, arguments

import symrender as sr
from symrender.scene.parameters import get

SKIP = ("camera.target", "camera.up", "camera.fov", "camera.window")
STEPS = 4
LEAST = 1e-3
"""Differences of doubles do not resolve 1e-8 of smaller derivatives."""
VIEWS = {
    "chapter8, oblique": ("chapter8", {"camera": {"type": "look_at", "eye": (3.0, -3.0, 2.0)}}, "floor"),
    "chapter8, lobe of B": ("chapter8", {"camera": {"type": "look_at", "eye": (3.0, -3.0, 2.0)}}, "spheres.B"),
    "gloss, floor": ("gloss", {"floor.lobe.exponent": 24.0}, "floor"),
    "gloss, lobe of A": ("gloss", {"spheres.A.lobe.exponent": 24.0}, "spheres.A"),
    "penumbra": ("penumbra", {"floor.lobe.exponent": 12.0}, "floor"),
    "grazing": ("grazing", {}, "floor"),
}


def random_point(scene: sr.Scene, surface: str, rng: np.random.Generator) -> tuple[float, ...]:
    """A point of the surface that faces the eye: beside the spheres on the floor, above it on a sphere."""
    eye = np.array(scene.camera.eye)
    while True:
        if surface == "floor":
            place = np.append(rng.uniform(-1.8, 1.8, 2), 0.0)
            if all(np.linalg.norm(place - s.center) > 1.03 * s.radius for s in scene.spheres):
                return tuple(place.tolist())
            continue
        sphere = next(s for s in scene.spheres if surface == f"spheres.{s.name}")
        normal = rng.normal(size=3)
        normal /= np.linalg.norm(normal)
        place = np.array(sphere.center) + sphere.radius * normal
        if (eye - place) @ normal > 0.3 and place[2] > 0.02:
            return tuple(normal.tolist())


class Value:
    """Values of one point as one parameter moves, and what the rule met on the way."""

    def __init__(self, scene: sr.Scene, point: tuple[float, ...], surface: str, name: str) -> None:
        self.scene, self.point, self.surface, self.name = scene, point, surface, name
        self.at = float(get(scene, name))
        self.facts: set[tuple[int, int]] = set()
        self.error = 0.0

    def __call__(self, offset: float) -> np.ndarray:
        """The value at an offset of the parameter; what was met is noted."""
        found = sr.probe(
            self.scene.replace({self.name: self.at + offset}), [self.point], surface=self.surface, tol=1e-13
        )
        self.facts.add((int(found.chambers[0]), int(found.crossings[0])))
        self.error = max(self.error, float(found.error[0]))
        return found.gloss[0]


def extrapolated(value: Value, step: float, order: int) -> tuple[np.ndarray, float]:
    """Derivative of order 1 or 2 by Richardson's tableau over halved central differences, and its last change."""
    middle = value(0.0)
    rows: list[np.ndarray] = []
    for _ in range(STEPS):
        above, below = value(step), value(-step)
        first = (above - below) / (2 * step) if order == 1 else (above - 2 * middle + below) / step**2
        row = [first]
        for k, coarse in enumerate(rows):
            row.append(row[k] + (row[k] - coarse) / (4.0 ** (k + 1) - 1.0))
        rows, last, step = row, rows, step / 2
    return rows[-1], float(np.abs(rows[-1] - last[-1]).max())


def main() -> None:
    options = arguments(__doc__)
    points, each, seconds = (2, 3, 1) if options.quick else (7, 6, 3)
    report = Report("gradients_equal_differences", "Derivatives of the lobe integral against differences of it.")
    rng = np.random.default_rng(4)
    rows, left_out = [], Counter[str]()
    worst = {1: 0.0, 2: 0.0}
    honest = 0
    for view, (name, changes, surface) in VIEWS.items():
        scene = sr.load(name).replace(changes)
        names = [
            p.name
            for p in scene.parameters()
            if not p.name.startswith(SKIP) and not p.name.endswith(("lobe.weight", "texture.ku"))
        ]
        errors: dict[int, list[float]] = {1: [], 2: []}
        tried = 0
        while len(errors[1]) < points * each and tried < 20 * points:
            tried += 1
            point = random_point(scene, surface, rng)
            found = sr.probe(scene, [point], surface=surface, tol=1e-11, wrt=names)
            size = {n: float(np.abs(found.gradient[n]).max()) for n in names}
            left_out[f"derivative below {LEAST:g} at the point"] += sum(s < LEAST for s in size.values())
            felt = [n for n in names if size[n] >= LEAST]
            if len(felt) < 2:
                continue
            for n in rng.choice(felt, min(each, len(felt)), replace=False).tolist():
                if found.gradient_status[n][0] != 0:
                    one_sided = found.gradient_status[n][0] == 4
                    left_out["one-sided" if one_sided else "derivative missed its tolerance"] += 1
                    continue
                value = Value(scene, point, surface, n)
                try:
                    truth, change = extrapolated(value, 4e-3 * max(1.0, abs(value.at) / 10), 1)
                except sr.SymrenderError:
                    left_out["at the end of its range"] += 1
                    continue
                if len(value.facts) > 1:
                    left_out["structure changes within the step"] += 1
                    continue
                if value.error > 1e-9 or change > 3e-9 * size[n]:
                    left_out["differences of values are not converged"] += 1
                    continue
                gap = float(np.abs(found.gradient[n][0] - truth).max())
                errors[1].append(gap / size[n])
                honest += gap <= found.gradient_error[n][0] + 1e-9 * size[n]
            if len(errors[2]) < seconds and felt:
                n = str(rng.choice(felt))
                value = Value(scene, point, surface, n)
                try:
                    truth, change = extrapolated(value, 2e-2 * max(1.0, abs(value.at) / 10), 2)
                    curve = sr.hessian(scene, [n], [point], surface=surface)
                except sr.SymrenderError:
                    left_out["second order: at the end of its range"] += 1
                    continue
                large = float(np.abs(truth).max())
                if len(value.facts) > 1 or change > 3e-6 * large or large < 1e-3:
                    left_out["second order: differences of values are not converged"] += 1
                    continue
                errors[2].append(float(np.abs(curve.values[0, 0, 0] - truth).max()) / large)
        rows.append((view, *(f(errors[k]) if errors[k] else 0 for k in (1, 2) for f in (len, np.median, max))))
        print(f"{rows[-1]} {dict(left_out)}", file=sys.stderr, flush=True)
        for k in (1, 2):
            worst[k] = max(worst[k], max(errors[k], default=0.0))
    report.table(("view", "pairs", "median", "largest", "second order", "median", "largest"), rows)
    report.table(("left out", "pairs"), sorted(left_out.items()))
    pairs = sum(row[1] for row in rows)
    report.say(f"{pairs} pairs; {honest} of them within the error the gradient states.")
    least = 20 if options.quick else 200
    report.claim_number(f"pairs short of {least}", least - pairs, 0)
    report.claim_number("relative difference, first order", worst[1], 1e-8)
    report.claim_number("relative difference, second order", worst[2], 1e-5)
    report.leave()


if __name__ == "__main__":
    main()
