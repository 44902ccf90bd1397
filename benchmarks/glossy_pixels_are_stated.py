"""No mean of gloss over a pixel, in units of the series, is beyond 1.5 times what it states.

    python benchmarks/glossy_pixels_are_stated.py [--quick] [SEED [COUNT]]

Crowds of up to five spheres that touch or nearly touch each other and a floor, with lobes of exponents 4 to 1,024, seen
through pixels at limbs, beside contacts and anywhere, of some hundredths of a sphere or of many spheres; and, one in
four, pixels of ``gloss`` at 256 x 256 and 1e-5, every other one beside a limb. Every pixel is judged by single rays
along lines across it: what is met is bisected where it changes along a line, by the conventional tracer, and Gauss
rules stand between. Three sets of lines say what the judge may be off by, and a finer one is asked where they do not
tell.
"""

from __future__ import annotations

import sys
import time
from itertools import pairwise
from typing import Any

import numpy as np
from measure import Report

import symrender as sr
from symrender.errors import SymrenderError
from symrender.numeric.pipeline import trace
from symrender.runtimes.series_pixels import prepare_series
from symrender.scene.arrays import SceneArrays, scene_arrays
from symrender.settings import Settings

PIXELS, QUICK = 600, 6
TOLERANCES = (1e-3, 1e-4, 1e-5)
LAYERS = {"radiance": 3, "direct": 3, "gloss": 3, "error": 1, "status": 1, "evaluations": 1, "hit_class": 1}
LOOKS, HALVINGS = 64, 40
SETS = ((7, 6), (9, 7), (14, 9)), ((9, 7), (14, 9), (20, 12))
"""Lines a stretch and nodes between two ends of three sets; then of those asked where they do not tell."""
KNOTS = (-0.5, -0.04, 0.5)
"""Between which a line and the pixel are cut, in pixels: not at the middle."""
TOLD = 0.3
"""Part of what is stated or asked that a judge's doubt is to be below."""


def shown(rng: np.random.Generator, limb: bool) -> tuple[Any, int, int, int, float]:
    """A pixel of ``gloss``, beside a ``limb`` or anywhere on what it shows."""
    scene, size = sr.load("gloss"), 256
    judge = Judge(scene, size, 0, 0)
    places = np.arange(size, dtype=float)
    hit = judge.met(np.tile(places, size), np.repeat(places, size)).reshape(size, size)
    wanted = hit > 1
    if limb:
        beside = np.zeros((size, size), bool)
        beside[:, 1:] |= hit[:, 1:] != hit[:, :-1]
        beside[1:] |= hit[1:] != hit[:-1]
        wanted = beside & (hit > 0)
    rows, columns = np.nonzero(wanted)
    one = int(rng.integers(len(rows)))
    return scene, size, int(columns[one]), int(rows[one]), 1e-5


def hostile(seed: int) -> tuple[Any, int, int, int, float]:
    """(scene, size of its square image, column, row, tolerance) of one case."""
    rng = np.random.default_rng([seed, 77])
    if seed % 4 == 3:
        return shown(rng, seed % 8 == 7)
    spheres: list[dict[str, Any]] = []
    while len(spheres) < 1 + seed % 5:
        radius = float(10 ** rng.uniform(-1.2, 0.0))
        place = np.array([*rng.uniform(-1.2, 1.2, 2), radius])
        if spheres and rng.random() < 0.5:
            # beside another one, at a distance of nothing up to a tenth
            other = spheres[int(rng.integers(len(spheres)))]
            turn, gap = rng.uniform(0, 2 * np.pi), float(10 ** rng.uniform(-5, -1)) * (rng.random() < 0.7)
            away = radius + float(other["radius"]) + gap
            rise = radius - float(other["center"][2])
            flat = np.sqrt(max(0.0, away**2 - rise**2))
            place[:2] = np.array(other["center"][:2]) + flat * np.array([np.cos(turn), np.sin(turn)])
        else:
            place[2] += float(10 ** rng.uniform(-5, -0.5)) * (rng.random() < 0.6)
        clear = (np.linalg.norm(place - np.array(s["center"])) > radius + s["radius"] - 1e-9 for s in spheres)
        if all(clear):
            lobe = {"weight": 0.5, "exponent": float(4 ** rng.uniform(1, 5)), "theta_max": float(rng.uniform(0.4, 1.5))}
            texture = {"type": "solid"} if rng.random() < 0.7 else {"type": "checker", "ku": 8, "kv": 4, "dark": 0.2}
            spheres.append(
                {"name": f"S{len(spheres)}", "center": place.tolist(), "radius": radius, "texture": texture,
                 "color": rng.uniform(0.1, 1, 3).tolist(), "lobe": lobe}
            )  # fmt: skip
    checkered = {"type": "checker", "bright": [0.8, 0.7, 0.6], "dark": [0.1, 0.1, 0.2],
                 "cell": float(10 ** rng.uniform(-0.5, 0.5))}  # fmt: skip
    ground = {"type": "solid", "color": [0.5, 0.4, 0.3]}
    lobe = {"weight": 0.7, "exponent": float(4 ** rng.uniform(1, 5)), "theta_max": float(rng.uniform(0.4, 1.5))}
    eye = np.array([*rng.uniform(-4, 4, 2), float(10 ** rng.uniform(-0.7, 0.6))])
    scene = sr.load(
        {
            "name": f"crowd{seed}", "spheres": spheres, "background": [0.1, 0.15, 0.25], "ambient": [0.1, 0.1, 0.1],
            "camera": {"type": "look_at", "eye": eye.tolist(), "target": aim(rng, spheres, eye).tolist(),
                       "up": [0, 0, 1], "fov": float(10 ** rng.uniform(-1.0, 1.3))},
            "floor": {"texture": checkered if rng.random() < 0.5 else ground, "lobe": lobe},
            "lights": [{"name": f"L{k}", "type": "point", "color": rng.uniform(0.3, 1, 3).tolist(),
                        "position": [*rng.uniform(-4, 4, 2).tolist(), float(rng.uniform(1, 5))]} for k in range(2)],
            "shading": {"model": ["blinn", "phong"][seed % 2], "ka": 0.1, "kd": 0.8, "ks": 0.4,
                        "shininess": float(10 ** rng.uniform(1, 2.5))},
        }
    )  # fmt: skip
    size = 8
    return scene, size, 4, 4, TOLERANCES[seed % len(TOLERANCES)]


def aim(rng: np.random.Generator, spheres: list[dict[str, Any]], eye: Any) -> Any:
    """Where the camera looks: a limb, a contact, or anywhere on a sphere or the floor."""
    sphere = spheres[int(rng.integers(len(spheres)))]
    center, radius = np.array(sphere["center"]), float(sphere["radius"])
    way = center - eye
    kind = int(rng.integers(4))
    if kind == 0:
        side = np.cross(way, rng.normal(size=3))
        return center + radius * float(rng.uniform(0.9, 1.02)) * side / np.linalg.norm(side)
    if kind == 1:
        return np.array([center[0], center[1], 0.0]) - 0.3 * radius * np.array([*way[:2], 0.0]) / np.linalg.norm(way)
    if kind == 2:
        toward = -way / np.linalg.norm(way) + 0.7 * rng.normal(size=3)
        return center + radius * toward / np.linalg.norm(toward)
    return np.array([*(center[:2] + radius * rng.normal(size=2)), 0.0])


class Judge:
    """One pixel, as single rays see it, along its rows or ``upright``."""

    upright = False

    def __init__(self, scene: Any, size: int, column: int, row: int) -> None:
        self.scene, self.arrays = scene, scene_arrays(scene)
        self.size, self.column, self.row = size, column, row
        camera = self.arrays.camera
        forward = camera.target - camera.eye
        forward = forward / np.linalg.norm(forward)
        right = np.cross(forward, camera.up)
        right = right / np.linalg.norm(right)
        reach = np.tan(0.5 * np.radians(float(camera.fov)))
        shapes = [("floor", scene.floor), *((f"spheres.{each.name}", each) for each in scene.spheres)]
        self.surfaces = [(name, float(shape.lobe.weight)) for name, shape in shapes]
        self.axes = forward, reach * right, reach * np.cross(right, forward)

    def rays(self, along: Any, across: Any) -> Any:
        """(N, 3) unit directions through places, in pixels from the pixel's middle along its lines and across them."""
        x, y = (across, along) if self.upright else (along, across)
        a = 2.0 * (self.column + 0.5 + x) / self.size - 1.0
        b = 1.0 - 2.0 * (self.row + 0.5 + y) / self.size
        forward, right, up = self.axes
        sent = forward + a[:, None] * right + b[:, None] * up
        return sent / np.linalg.norm(sent, axis=1, keepdims=True)

    def met(self, x: Any, y: Any) -> Any:
        """(N,) what rays meet."""
        sent = self.rays(x, y)
        return trace(self.arrays, np.tile(self.arrays.camera.eye, (len(sent), 1)), sent, 0, 1)[1]

    def ends(self, heights: Any) -> list[Any]:
        """For each line the places at which what is met changes, and the knots."""
        count = len(heights)
        steps = np.linspace(-0.5, 0.5, LOOKS + 1)
        found = self.met(np.tile(steps, count), np.repeat(heights, LOOKS + 1)).reshape(count, -1)
        line, at = np.nonzero(found[:, 1:] != found[:, :-1])
        low, high, first = steps[at], steps[at + 1], found[line, at]
        for _ in range(HALVINGS if len(line) else 0):
            middle = 0.5 * (low + high)
            same = self.met(middle, heights[line]) == first
            low, high = np.where(same, middle, low), np.where(same, high, middle)
        return [np.sort(np.concatenate([KNOTS, high[line == k]])) for k in range(count)]

    def looked(self, sets: tuple[tuple[int, int], ...], tol: float) -> tuple[Any, float, int]:
        """(gloss of the pixel, what that may be off by, the most that lines are cut), along rows or columns.

        A limb that touches rows is told by columns: the sets of lines that differ less from their finest are right.
        """
        looks = []
        for self.upright in (False, True):
            *coarse, (value, off, ends) = (self.mean(*each, tol) for each in sets)
            spread = max(float(np.abs(value - near).max()) for near, _, _ in coarse)
            looks.append((spread + 2.0 * off, value, ends))
        doubt, value, ends = min(looks, key=lambda each: each[0])
        return value, doubt, ends

    def mean(self, lines: int, nodes: int, tol: float) -> tuple[Any, float, int]:
        """(gloss of the pixel, what its rays may be off by, the most that lines are cut)."""
        x, w = np.polynomial.legendre.leggauss(lines)
        heights = np.concatenate([a + (b - a) * 0.5 * (x + 1) for a, b in pairwise(KNOTS)])
        weights = np.concatenate([(b - a) * 0.5 * w for a, b in pairwise(KNOTS)])
        ends = self.ends(heights)
        u, v = np.polynomial.legendre.leggauss(nodes)
        u = 0.5 * (u + 1)
        place, slope = u * u * (3 - 2 * u), 3 * u * (1 - u) * v
        rows = [
            (a + (b - a) * place, np.full(nodes, y), weight * (b - a) * slope)
            for y, weight, cuts in zip(heights, weights, ends, strict=True)
            for a, b in pairwise(cuts)
            if b > a
        ]
        across, down, weight = (np.concatenate(each) for each in zip(*rows, strict=True))
        value, off = self.gloss(self.rays(across, down), tol)
        return weight @ value, float(np.abs(weight) @ off), max(map(len, ends))

    def gloss(self, sent: Any, tol: float) -> tuple[Any, Any]:
        """(gloss (N, 3), weighed, of single rays, what each may be off by)."""
        eye = np.asarray(self.arrays.camera.eye)
        _, hit, far = trace(self.arrays, np.tile(eye, (len(sent), 1)), sent, 0, 1)
        value, off = np.zeros((len(sent), 3)), np.zeros(len(sent))
        for k, (surface, weight) in enumerate(self.surfaces, 1):
            some = np.flatnonzero(hit == k)
            if len(some):
                places = eye + far[some, None] * sent[some]
                if k > 1:
                    places = self.facing(places, sent[some], self.scene.spheres[k - 2])
                else:
                    places[:, 2] = 0.0
                found = sr.probe(self.scene, places, surface=surface, tol=tol / weight, threads=1)
                value[some], off[some] = weight * found.gloss, weight * found.error
        return value, off

    @staticmethod
    def facing(places: Any, sent: Any, sphere: Any) -> Any:
        """Unit normals of places of a sphere, none of which roundings at the limb turn away."""
        normals = places - np.array(sphere.center)
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        away = np.maximum(0.0, (normals * sent).sum(axis=1) + 1e-8)
        normals -= 2.0 * away[:, None] * sent
        return normals / np.linalg.norm(normals, axis=1, keepdims=True)


def asked(arrays: SceneArrays, size: int, column: int, row: int, tol: float) -> tuple[Any, float, int, float]:
    """(gloss, error, status, CPU seconds) of one pixel by the rule that is judged."""
    begun = time.process_time()
    render = prepare_series(arrays, Settings(width=size, height=size, tol=tol, filter="box", threads=1))
    layers = {
        name: np.zeros((size, size, 3) if channels == 3 else (size, size)) for name, channels in LAYERS.items()
    }  # fmt: skip
    render(column, row, column + 1, row + 1, layers)
    error, status = float(layers["error"][row, column]), int(layers["status"][row, column])
    return layers["gloss"][row, column], error, status, time.process_time() - begun


def main() -> None:
    words = [int(word) for word in sys.argv[1:] if word.isdigit()]
    first, report = words[0] if words else 0, Report("glossy_pixels_are_stated", __doc__.split("\n")[0])
    count = words[1] if len(words) > 1 else (QUICK if "--quick" in sys.argv else PIXELS)
    judged = cut = signal = met = told = beyond = refused = 0
    seconds = 0.0
    worst: list[float] = []
    for seed in range(first, first + count):
        try:
            scene, size, column, row, tol = hostile(seed)
            judge = Judge(scene, size, column, row)
            gloss, stated, status, spent = asked(judge.arrays, size, column, row, tol)
            for sets in SETS:
                value, doubt, ends = judge.looked(sets, 0.01 * tol)
                if doubt <= TOLD * max(stated, tol):
                    break
        except SymrenderError as error:
            refused += 1
            print(f"seed {seed}: {error}", file=sys.stderr)
            continue
        judged, cut, seconds = judged + 1, cut + (ends > len(KNOTS)), seconds + spent
        signal += float(np.abs(value).max()) > 100 * tol
        met, told = met + (status == 0), told + (doubt <= TOLD * max(stated, tol))
        gap = float(np.abs(gloss - value).max())
        worst.append(gap / (stated + doubt))
        if gap > 1.5 * stated + doubt:
            beyond += 1
            print(f"seed {seed}, tol {tol:g}: {gloss} +- {stated:.3g}, lines {value} +- {doubt:.3g}", file=sys.stderr)
    report.say(
        f"{judged} pixels, {refused} refused, {cut} with a limb, {signal} that show more than a hundred times what "
        f"is asked, {met} that meet it, {told} that lines tell to {TOLD:g} of what is stated or asked; the worst is "
        f"off by {max(worst, default=0.0):.2g} of what both state; {seconds / max(judged, 1):.3g} CPU s each"
    )
    report.claim_number("pixels beyond 1.5 times what they state", beyond, 0)
    report.leave()


if __name__ == "__main__":
    main()
