"""Means over one pixel of what single rays see, scanned line by line: nothing of it is the kernels' of pixels.

Lines across a filter's support are looked at in steps, what the conventional tracer meets is bisected where it changes,
and Gauss rules between these places add what ``probe`` says of single rays. Moved scenes are scanned along the same
lines, so that differences of their means converge between events.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

import symrender as sr
from symrender.numeric.radiometric.pipeline import rays as numeric_rays
from symrender.radiometric.world import seen
from symrender.scene.parameters import get
from symrender.scene.radiometric.arrays import radiometric_arrays

REACH = {"box": 0.5, "tent": 1.0, "gaussian": 2.0, "mitchell": 2.0}
LOOKS, HALVINGS, NODES = 96, 44, 6
"""Steps of a line, halvings of one, nodes between two places where something ends."""
BATCH = 64
"""Rays that are asked for at once."""
MOST = 24
"""Ends along a line, at most; a line with more is not known."""


def profile(kind: str, x: Any) -> Any:
    """Weight of places x, in pixels from the middle, along one axis."""
    far, reach = np.abs(x), REACH[kind]
    if kind == "box":
        return np.ones_like(far)
    if kind == "tent":
        return np.maximum(0.0, 1.0 - far)
    if kind == "gaussian":
        s = reach / 4.0
        low = np.exp(-(reach**2) / (2 * s * s))
        return np.maximum(0.0, np.exp(-(far**2) / (2 * s * s)) - low)
    b = c = 1.0 / 3.0
    near = ((12 - 9 * b - 6 * c) * far**3 + (-18 + 12 * b + 6 * c) * far**2 + 6 - 2 * b) / 6
    rest = ((-b - 6 * c) * far**3 + (6 * b + 30 * c) * far**2 + (-12 * b - 48 * c) * far + 8 * b + 24 * c) / 6
    return np.where(far < 1, near, np.where(far < 2, rest, 0.0))


def knots(kind: str) -> list[float]:
    """Places, in pixels from the middle, between which the weight is smooth."""
    reach = REACH[kind]
    inner = {"tent": [0.0], "mitchell": [-1.0, 0.0, 1.0]}.get(kind, [])
    return [-reach, *inner, reach]


def whole_of(kind: str) -> float:
    """The integral of the weight along one axis."""
    x, w = np.polynomial.legendre.leggauss(20)
    parts = [0.5 * (b - a) * float(w @ profile(kind, a + (b - a) * 0.5 * (x + 1))) for a, b in pairwise(knots(kind))]
    return sum(parts)


@dataclass(frozen=True)
class Lines:
    """Heights of lines, in pixels from the middle, and what each weighs."""

    heights: Any
    weights: Any

    @staticmethod
    def of(kind: str, count: int) -> Lines:
        """``count`` Gauss lines in each of as many stretches as the profile has, halved once."""
        ends = np.array(knots(kind))
        ends = np.sort(np.concatenate([ends, 0.5 * (ends[1:] + ends[:-1]) + 0.0312 * np.diff(ends)]))
        x, w = np.polynomial.legendre.leggauss(count)
        heights = np.concatenate([a + (b - a) * 0.5 * (x + 1) for a, b in pairwise(ends)])
        weights = np.concatenate([(b - a) * 0.5 * w for a, b in pairwise(ends)])
        return Lines(heights, weights * profile(kind, heights) / whole_of(kind))


class Scan:
    """A scene whose only pixel is scanned."""

    def __init__(self, scene: Any, kind: str) -> None:
        self.scene, self.kind = scene, kind
        arrays = radiometric_arrays(scene)
        self.eye, self.window = np.array(arrays.camera.eye), np.array(seen(arrays, 1, 1).window)
        # of a lamp at the eye nothing hides: the light of a texture over that of white is the texture
        lamp = [{"type": "point", "name": "eye", "position": self.eye.tolist(), "intensity": 1.0}]
        dumped = scene.model_dump()
        dumped = {k: v for k, v in dumped.items() if k not in ("lights", "bounces")}
        white = dict(dumped)
        plain = {"type": "diffuse", "reflectance": 1.0, "two_sided": True}
        names = dumped["materials"]
        colored = {
            k: (m | {"two_sided": True}) if m["type"] == "diffuse" and not _smooth(m) else plain
            for k, m in names.items()
        }
        white["materials"] = dict.fromkeys(names, plain)
        dumped["materials"] = colored
        self.tested = [radiometric_arrays(sr.load(each | {"lights": lamp, "bounces": 0})) for each in (dumped, white)]

    def rays(self, x: Any, y: Any) -> Any:
        """(N, 3) unit directions through places, in pixels from the middle, y downwards."""
        forward, right, up = self.window
        sent = forward + (2 * x)[:, None] * right - (2 * y)[:, None] * up
        return sent / np.linalg.norm(sent, axis=1, keepdims=True)

    def classes(self, x: Any, y: Any) -> Any:
        """(N,) numbers that tell what rays meet apart."""
        sent = self.rays(x, y)
        eyes = np.tile(self.eye, (len(sent), 1))
        (_, own, _, hit), (_, white, _, _) = (numeric_rays(each, eyes, sent) for each in self.tested)
        ratio = np.where(white > 0, own / np.where(white > 0, white, 1.0), 0.0)
        code = np.rint(ratio * 1000) @ np.array([1.0, 1009.0, 1018081.0])
        return hit + 64.0 * code

    def ends(self, heights: Any) -> list[Any]:
        """For each line the places at which what is met changes, ends of its knots among them."""
        reach, count = REACH[self.kind], len(heights)
        steps = np.linspace(-reach, reach, LOOKS + 1)
        # off the middle by an irrational part, so that no step lies on a symmetric wall
        steps[1:-1] += 0.381966 * (steps[1] - steps[0])
        found = self.classes(np.tile(steps, count), np.repeat(heights, LOOKS + 1)).reshape(count, -1)
        line, at = np.nonzero(found[:, 1:] != found[:, :-1])
        low, high, first = steps[at], steps[at + 1], found[line, at]
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            same = self.classes(middle, heights[line]) == first if len(line) else np.zeros(0, bool)
            low, high = np.where(same, middle, low), np.where(same, high, middle)
        # a Gaussian is no polynomial over its support: nodes that move with an end would tell its slope badly
        inner = np.array([-2.0, -1.3, -0.65, 0.0, 0.65, 1.3, 2.0] if self.kind == "gaussian" else knots(self.kind))
        return [np.sort(np.concatenate([inner, high[line == k]])) for k in range(count)]

    def mean(self, lines: Lines, tol: float, budget: int = 100_000) -> tuple[Any, float, list[int]]:
        """(indirect light of the pixel, what its rays may be off by, how many ends every line has)."""
        ends = self.ends(lines.heights)
        u, w = np.polynomial.legendre.leggauss(NODES)
        u = 0.5 * (u + 1)
        # drawn to both ends, where slopes may be as one over a root
        place, slope = u * u * (3 - 2 * u), 6 * u * (1 - u)
        xs, ys, ws = [], [], []
        for y, weight, cuts in zip(lines.heights, lines.weights, ends, strict=True):
            if len(cuts) > MOST:
                raise ValueError("too many ends")
            for a, b in pairwise(cuts):
                if b > a:
                    x = a + (b - a) * place
                    xs.append(x)
                    ys.append(np.full(NODES, y))
                    ws.append(weight * (b - a) * 0.5 * w * slope * profile(self.kind, x))
        x, y, weight = (np.concatenate(each) for each in (xs, ys, ws))
        sent = self.rays(x, y)
        weight = weight / whole_of(self.kind)
        light, off = np.zeros(3), 0.0
        for k in range(0, len(sent), BATCH):
            some = sent[k : k + BATCH]
            found = sr.probe(self.scene, rays=(np.tile(self.eye, (len(some), 1)), some), tol=tol, budget=budget)
            light += weight[k : k + BATCH] @ found.indirect
            off += float(np.abs(weight[k : k + BATCH]) @ found.error)
        return light, off, [len(each) for each in ends]


def _smooth(material: dict[str, Any]) -> bool:
    """Whether a texture has no fields."""
    return isinstance(material["reflectance"], dict) and material["reflectance"]["type"] == "marble"


def slope(scene: Any, name: str, kind: str, step: float, tol: float, count: int = 7) -> tuple[Any, float, bool]:
    """(derivative of the mean by scans of moved scenes, what it may be off by, whether it is known)."""
    value = float(get(scene, name))
    found, known = [], True
    for lines in (Lines.of(kind, count), Lines.of(kind, count - 2)):
        quotients, doubt = [], 0.0
        for each in (step, 2 * step):
            (high, off, one), (low, rest, two) = (
                Scan(scene.replace({name: value + side * each}), kind).mean(lines, tol) for side in (1, -1)
            )
            quotients.append((high - low) / (2 * each))
            doubt = doubt + (off + rest) / (2 * each)
            known = known and one == two
        near, far = quotients
        found.append(((4 * near - far) / 3, float(np.abs(near - far).max()), doubt))
    (first, bent, doubt), (second, _, _) = found
    # ends that come and go within the step make differences of first order alone
    off = (0.1 if known else 1.0) * bent + 2 * float(np.abs(first - second).max())
    return first, off + doubt, known
