"""Exact gradients equal extrapolated differences of values, first order to 1e-8 and second to 1e-5.

Random points and parameters of nine views of five scenes: floors and lobes of spheres, oblique and grazing, with
shadows and penumbrae, disk lights as points and whole. Values are those of ``probe``; of the gradient nothing is used
but its result. What counts as a pair was settled before any was looked at:

- The parameter is a real number the point feels: its derivative is 1e-3 at least, for differences of doubles do not
  resolve 1e-8 of a smaller one.
- The differences are central, over steps halved six times from the largest of 1/10, 1/40, 1/160 ... of the parameter's
  size at whose ends the rule meets as many walls and chambers as in the middle. Where no step down to 1e-5 is so, the
  pair straddles a visual event; where the gradient itself says so, it is one-sided. Both are left out, and counted.
- The reference is that entry of Richardson's tableau that differs least from its neighbours (C. J. F. Ridders,
  Advances in Engineering Software 4, 1982, doi:10.1016/S0141-1195(82)80057-0), and that difference its error. A
  reference must be ten times as exact as what it judges: where the error exceeds 1e-9 of the derivative (1e-6, second
  order), differences cannot tell, and the pair is counted apart. So it is where the values used state an error which
  over the step (over its square) is larger than that: errors of a deterministic rule change smoothly with the
  parameter, and a tableau takes them for the derivative's own.

A view takes minutes. --views runs some of them; with --kept a view whose results lie in that folder is not run again.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from measure import Report

import symrender as sr
from symrender.errors import OptionError, SceneError, Unsupported
from symrender.gradient import STATUS
from symrender.scene.parameters import get

NOT_FELT = ("camera.target", "camera.up", "camera.fov", "camera.window")
LEVELS = 6
LEAST = 1e-3
FIRST, SECOND = 1e-8, 1e-5
ABOVE = {"camera": {"type": "look_at", "eye": (3.0, -3.0, 2.0)}}


@dataclass(frozen=True)
class View:
    """Random points of one surface; ``share`` is how many of the usual number of pairs are asked of it.

    ``tol`` is what values can be had to: lobes that look at a checkered floor run out of evaluations below 1e-12.
    """

    scene: str
    surface: str
    changes: dict[str, object]
    disk: str = "2x2"
    tol: float = 1e-13
    share: float = 1.0


VIEWS = {
    "chapter8, oblique": View("chapter8", "floor", ABOVE),
    "chapter8, lobe of B": View("chapter8", "spheres.B", ABOVE, tol=1e-12),
    "gloss, floor": View("gloss", "floor", {"floor.lobe.exponent": 24.0}),
    "gloss, lobe of A": View("gloss", "spheres.A", {"spheres.A.lobe.exponent": 24.0}, tol=1e-12),
    "penumbra": View("penumbra", "floor", {"floor.lobe.exponent": 12.0}),
    "penumbra, lobe of B": View("penumbra", "spheres.B", {"spheres.B.lobe.exponent": 24.0}, tol=1e-12),
    "grazing": View("grazing", "floor", {}),
    "needle, oblique": View("needle", "floor", ABOVE),
    "penumbra, whole disk": View("penumbra", "floor", {"floor.lobe.exponent": 12.0}, "exact", 1e-10, 0.2),
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
        others = (s for s in scene.spheres if s is not sphere)
        clear = all(np.linalg.norm(place - s.center) > 1.03 * s.radius for s in others)
        if (eye - place) @ normal > 0.3 and place[2] > 0.02 and clear:
            return tuple(normal.tolist())


class Value:
    """The value of one point as one parameter moves; values once made are kept, and the errors they state."""

    def __init__(self, view: View, scene: sr.Scene, point: tuple[float, ...], name: str) -> None:
        self.view, self.scene, self.point, self.name = view, scene, point, name
        self.at = float(get(scene, name))
        self.kept: dict[float, tuple[np.ndarray, tuple[int, int]]] = {}
        self.stated: dict[float, float] = {}

    def look(self, offset: float) -> tuple[np.ndarray, tuple[int, int]]:
        """The value at an offset of the parameter, and how many chambers and walls were met."""
        if offset not in self.kept:
            changed = self.scene.replace({self.name: self.at + offset})
            view = self.view
            found = sr.probe(
                changed, [self.point], surface=view.surface, tol=view.tol, disk=view.disk, budget=4_000_000
            )
            self.stated[offset] = float(found.error[0])
            self.kept[offset] = (found.gloss[0], (int(found.chambers[0]), int(found.crossings[0])))
        return self.kept[offset]

    def __call__(self, offset: float) -> np.ndarray:
        """The value at an offset of the parameter."""
        return self.look(offset)[0]

    def worst(self, step: float) -> float:
        """The largest error that values up to a step away state."""
        return max(error for offset, error in self.stated.items() if abs(offset) <= step)

    def room(self) -> float | None:
        """The largest step, of a tenth of the parameter's size and its quarters, with one structure; None if none."""
        step = 0.1 * max(1.0, abs(self.at))
        here = self.look(0.0)[1]
        while step > 1e-5 * max(1.0, abs(self.at)):
            try:
                if self.look(step)[1] == here == self.look(-step)[1]:
                    return step
            except (SceneError, OptionError):
                pass
            step /= 4.0
        return None


def extrapolated(difference: Callable[[float], np.ndarray], step: float) -> tuple[np.ndarray, float]:
    """The limit of an even difference quotient by Ridders's tableau over halved steps, and its error."""
    rows: list[np.ndarray] = []
    best, error = np.zeros(3), np.inf
    for _ in range(LEVELS):
        row = [difference(step)]
        for k, coarse in enumerate(rows):
            row.append(row[k] + (row[k] - coarse) / (4.0 ** (k + 1) - 1.0))
            change = float(max(np.abs(row[k + 1] - row[k]).max(), np.abs(row[k + 1] - coarse).max()))
            if change < error:
                best, error = row[k + 1], change
        rows, step = row, step / 2
    return best, error


def first_order(value: Value, step: float) -> tuple[np.ndarray, float]:
    """First derivative and its error."""
    return extrapolated(lambda h: (value(h) - value(-h)) / (2 * h), step)


def second_order(value: Value, step: float) -> tuple[np.ndarray, float]:
    """Second derivative and its error."""
    return extrapolated(lambda h: (value(h) - 2 * value(0.0) + value(-h)) / h**2, step)


def pairs_of(view: View, seed: int, wanted: int, wanted_second: int) -> dict[str, object]:
    """Relative differences of the pairs of one view, and what was left out."""
    scene = sr.load(view.scene).replace(view.changes)
    names = [
        p.name
        for p in scene.parameters()
        if not p.name.startswith(NOT_FELT) and not p.name.endswith(("lobe.weight", "texture.ku"))
    ]
    rng = np.random.default_rng((4, seed))
    left_out = Counter[str]()
    first: list[tuple[float, str]] = []
    second: list[tuple[float, str]] = []
    honest = points = 0
    while (len(first) < wanted or len(second) < wanted_second) and points < 20 * wanted:
        points += 1
        point = random_point(scene, view.surface, rng)
        asked = {"surface": view.surface, "disk": view.disk}
        found = sr.probe(scene, [point], tol=1e-5, wrt=names, **asked)
        size = {n: float(np.abs(found.gradient[n]).max()) for n in names}
        felt = [n for n in names if size[n] >= LEAST]
        left_out["derivative below 1e-3"] += len(names) - len(felt)
        # a light's colours and the like are felt everywhere and tell little: places come first
        chosen = rng.permutation(felt).tolist()[:5] if len(felt) > 8 else []
        for k, n in enumerate(chosen):
            found = sr.probe(scene, [point], tol=10 * view.tol, wrt=[n], **asked)
            status = STATUS[int(found.gradient_status[n][0])]
            if status in ("one-sided", "unsupported"):
                left_out[f"event: the gradient is {status}"] += 1
                continue
            value = Value(view, scene, point, n)
            step = value.room()
            if step is None:
                left_out["event: the structure changes within the step, or the range ends"] += 1
                continue
            where = f"{n} at {tuple(round(x, 6) for x in point)}, {status}"
            truth, error = first_order(value, step)
            error = max(error, value.worst(step) / step)
            if error > 0.1 * FIRST * size[n]:
                left_out["differences cannot tell"] += 1
            else:
                gap = float(np.abs(found.gradient[n][0] - truth).max())
                first.append((gap / size[n], where))
                honest += gap <= found.gradient_error[n][0] + error + 1e-12 * size[n]
            if k or len(second) >= wanted_second:
                continue
            truth, error = second_order(value, step)
            error = max(error, value.worst(step) / step**2)
            large = float(np.abs(truth).max())
            if large < LEAST or error > 0.1 * SECOND * large:
                left_out["second order: below 1e-3" if large < LEAST else "second order: differences cannot tell"] += 1
                continue
            try:
                curve = sr.hessian(scene, [n], [point], tol=10 * view.tol, **asked)
            except Unsupported:
                left_out["second order: at the end of its range"] += 1
                continue
            second.append((float(np.abs(curve.values[0, 0, 0] - truth).max()) / large, where))
    counts = {what: int(pairs) for what, pairs in left_out.items()}
    return {"points": points, "first": first, "second": second, "honest": int(honest), "left out": counts}


def results(name: str, quick: bool, kept: Path | None) -> dict[str, object]:
    """The results of a view, made or read."""
    file = kept / f"{''.join(c if c.isalnum() else '_' for c in name)}.json" if kept else None
    if file is not None and file.exists():
        found: dict[str, object] = json.loads(file.read_text("utf-8"))
        return found
    view = VIEWS[name]
    wanted, second = (4, 1) if quick else (26, 4)
    share = view.share
    found = pairs_of(view, list(VIEWS).index(name), max(2, round(share * wanted)), max(1, round(share * second)))
    if file is not None:
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(json.dumps(found), "utf-8")
    return found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="small enough for continuous integration")
    parser.add_argument("--views", default="", help="names of the views to run, separated by semicolons")
    parser.add_argument("--kept", type=Path, help="folder of results: views found there are read, others written")
    options = parser.parse_args()
    # an exact disk takes minutes a pair
    usual = [name for name in VIEWS if not (options.quick and VIEWS[name].disk == "exact")]
    chosen = [name.strip() for name in options.views.split(";") if name.strip()] or usual
    report = Report(
        "gradients_equal_differences",
        f"Derivatives of the lobe integral against differences of it: {len(chosen)} views of "
        f"{len({VIEWS[name].scene for name in chosen})} scenes.",
    )
    rows, misses, left_out = [], [], Counter[str]()
    pairs = honest = 0
    worst = {"first": 0.0, "second": 0.0}
    for name in chosen:
        found = results(name, options.quick, options.kept)
        row: list[object] = [name, found["points"]]
        for order, bound in (("first", FIRST), ("second", SECOND)):
            gaps = [gap for gap, _ in found[order]]
            row += [len(gaps), float(np.median(gaps)) if gaps else "", max(gaps, default=0.0)]
            worst[order] = max(worst[order], max(gaps, default=0.0))
            misses += [(name, order, where, gap) for gap, where in found[order] if gap > bound]
        rows.append(row)
        left_out.update(found["left out"])
        pairs += len(found["first"])
        honest += int(found["honest"])
        print(f"{row} {found['left out']}", file=sys.stderr, flush=True)
    report.table(("view", "points", "pairs", "median", "largest", "second order", "median", "largest"), rows)
    report.table(("left out", "pairs"), sorted(left_out.items()))
    if misses:
        report.table(("view", "order", "missed", "relative difference"), misses)
    report.say(f"{pairs} pairs; {honest} of them within the error the gradient states.")
    least = 3 * len(chosen) if options.quick else 200 if chosen == usual else 0
    report.claim_number(f"pairs short of {least}", least - pairs, 0)
    report.claim_number("relative difference, first order", worst["first"], FIRST)
    report.claim_number("relative difference, second order", worst["second"], SECOND)
    report.leave()


if __name__ == "__main__":
    main()
