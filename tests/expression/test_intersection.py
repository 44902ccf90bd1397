"""Rays, segments and spheres, against roots in 60 digits of the very doubles that enter."""

from __future__ import annotations

import math
from collections.abc import Callable

import mpmath
import numpy as np
import pytest
import sympy as sp

from emitted import FORMULAS
from symrender.expression import intersection
from symrender.expression.vectors import dot, norm2, renormalising, vec3
from symrender.jit.records import Table, record, table
from symrender.scene import arrays as at
from symrender.scene.records import Floor, Plane, Sphere

Vector = tuple[float, float, float]
F, W = vec3("f"), vec3("w")
RADIUS = sp.Symbol("r", positive=True)
DISCRIMINANT: Callable[..., float] = sp.lambdify(
    (*F.parts, *W.parts, RADIUS), intersection.discriminant(F, W, RADIUS), "math"
)
NAIVE: Callable[..., float] = sp.lambdify((*F.parts, *W.parts, RADIUS), dot(F, W) ** 2 - (norm2(F) - RADIUS**2), "math")


def test_discriminant_is_the_textbook_one_for_unit_directions() -> None:
    difference = intersection.discriminant(F, W, RADIUS) - (dot(F, W) ** 2 - norm2(W) * (norm2(F) - RADIUS**2))
    # |f x w|^2 = |f|^2 |w|^2 - (f.w)^2, so they differ by r^2 (1 - |w|^2) alone
    assert sp.expand(difference - RADIUS**2 * (1 - norm2(W))) == 0


def _exact(f: Vector, w: Vector, radius: float) -> mpmath.mpf:
    a, b = [mpmath.mpf(x) for x in f], [mpmath.mpf(x) for x in w]
    square = sum(x * x for x in b)
    along = sum(x * y for x, y in zip(a, b, strict=True))
    return mpmath.mpf(radius) ** 2 - (sum(x * x for x in a) - along**2 / square)


@pytest.mark.parametrize("distance", [1e4, 1e6, 1e8])
def test_far_sphere_keeps_its_discriminant(distance: float) -> None:
    rng = np.random.default_rng(12)
    worst = naive = 0.0
    hits = misses = wrong = naive_wrong = 0
    for _ in range(400):
        out = rng.normal(size=3)
        out /= np.linalg.norm(out)
        aim = rng.normal(size=3)
        aim *= 2 * rng.random() / np.linalg.norm(aim)
        f = tuple((distance * out).tolist())
        w = distance * out + aim
        w = tuple((w / np.linalg.norm(w)).tolist())
        with mpmath.workdps(60):
            exact = _exact(f, w, 1.0)
        if abs(exact) < 1e-6:
            continue
        hits, misses = hits + (exact > 0), misses + (exact <= 0)
        found, subtracted = DISCRIMINANT(*f, *w, 1.0), NAIVE(*f, *w, 1.0)
        worst, naive = max(worst, float(abs(found - exact))), max(naive, float(abs(subtracted - exact)))
        wrong, naive_wrong = wrong + ((found > 0) != (exact > 0)), naive_wrong + ((subtracted > 0) != (exact > 0))
    assert hits > 100 and misses > 100
    # |f x w| is a sum of products of about ``distance``: its error is some ulps of that, not of its square
    assert worst <= 32 * 2.0**-53 * distance
    assert wrong == 0
    assert naive > 1e3 * worst
    assert naive_wrong > 0 or distance < 1e8


def _scene_of(spheres: list[tuple[Vector, float]]) -> Table[Sphere]:
    rows = table(Sphere, len(spheres))
    for row, (center, radius) in zip(rows, spheres, strict=True):
        row.center[:], row.radius = center, radius
    return rows


def test_nearest_hit_from_outside_and_inside() -> None:
    rng = np.random.default_rng(4)
    inside = outside = missed = 0
    for _ in range(600):
        center, radius = rng.normal(size=3), float(rng.uniform(0.1, 2))
        p = center + rng.normal(size=3) * radius * float(rng.choice([0.4, 2.0]))
        w = rng.normal(size=3)
        w = (center - p) + rng.normal(size=3) * radius if rng.random() < 0.7 else w
        w /= np.linalg.norm(w)
        shape, distance = FORMULAS.nearest(
            *p.tolist(), *w.tolist(), 0, _scene_of([(tuple(center.tolist()), radius)]), record(Floor), table(Plane, 0)
        )
        with mpmath.workdps(60):
            o = [mpmath.mpf(x) - mpmath.mpf(y) for x, y in zip(p.tolist(), center.tolist(), strict=True)]
            d = [mpmath.mpf(x) for x in w.tolist()]
            a, b = sum(x * x for x in d), sum(x * y for x, y in zip(o, d, strict=True))
            c = sum(x * x for x in o) - mpmath.mpf(radius) ** 2
            delta = b * b - a * c
            roots = [] if delta < 0 else [(-b - mpmath.sqrt(delta)) / a, (-b + mpmath.sqrt(delta)) / a]
            ahead = [t for t in roots if t > 0]
        if abs(delta) < 1e-12:
            continue
        assert (shape == at.FIRST_SPHERE) == bool(ahead)
        if not ahead:
            missed += 1
            assert distance == math.inf
            continue
        inside, outside = inside + (c < 0), outside + (c > 0)
        # the root of a grazing chord loses half the digits of its half chord
        chord = float(mpmath.sqrt(delta))
        size = float(np.linalg.norm(p - center)) + radius
        assert abs(distance - ahead[0]) <= 32 * 2.0**-53 * size * (1 + size / chord)
    assert inside > 100 and outside > 100 and missed > 50


def test_normals_are_unit_and_face_the_ray() -> None:
    """The formula is unit to an ulp of the distance in radii; the factor after it leaves four ulp at any distance."""
    b, h, side, r = sp.symbols("b h side r", real=True)
    normal = sp.lambdify((*F.parts, *W.parts, b, h, side, r), intersection.normal(F, W, b, h, side, r).parts, "math")
    factor = sp.lambdify(F.parts, renormalising(F), "math")
    rng = np.random.default_rng(9)
    for distance in (0.3, 0.9, 2.0, 8.0, 50.0, 1e4, 1e8):
        hits = 0
        raw_worst = worst = 0.0
        for _ in range(200):
            out = rng.normal(size=3)
            out *= distance / np.linalg.norm(out)
            aim = out + rng.uniform(-0.9, 0.9, size=3)
            aim /= np.linalg.norm(aim)
            chord2 = DISCRIMINANT(*out, *aim, 1.0)
            if chord2 <= 0:
                continue
            hits += 1
            raw = normal(*out, *aim, float(out @ aim), math.sqrt(chord2), -1 if distance < 1 else 1, 1.0)
            n = np.array(raw) * factor(*raw)
            raw_worst, worst = max(raw_worst, abs(math.hypot(*raw) - 1)), max(worst, abs(math.hypot(*n) - 1))
            assert float(n @ aim) <= 2.0**-52 * max(1, distance)
        assert hits >= 100
        assert raw_worst <= 8 * 2.0**-52 * max(1.0, distance)
        assert worst <= 4 * 2.0**-52
        assert raw_worst > worst or distance < 50


_A, _B, _C = sp.symbols("a b c", real=True)
MEETS: Callable[..., bool] = sp.lambdify((_A, _B, _C), intersection.segment_meets(_A, _B, _C, _A + 2 * _B + _C), "math")


def _segment(q: np.ndarray, l: np.ndarray, radius: float) -> tuple[list[mpmath.mpf], mpmath.mpf]:
    """Roots of |q + s (l - q)| = radius in (0, 1) and how close a root or its being comes to a tie."""
    a0, b0 = [mpmath.mpf(x) for x in q.tolist()], [mpmath.mpf(x) for x in l.tolist()]
    d = [y - x for x, y in zip(a0, b0, strict=True)]
    a, b = sum(x * x for x in d), sum(x * y for x, y in zip(a0, d, strict=True))
    c = sum(x * x for x in a0) - mpmath.mpf(radius) ** 2
    delta = b * b - a * c
    if delta < 0:
        return [], -delta / (a * mpmath.mpf(radius) ** 2)
    roots = [(-b + s * mpmath.sqrt(delta)) / a for s in (-1, 1)]
    tie = min([delta / (a * mpmath.mpf(radius) ** 2), *(abs(t) for t in roots), *(abs(1 - t) for t in roots)])
    return [t for t in roots if 0 < t < 1], tie


def test_segment_meets_where_a_root_lies_inside_it() -> None:
    rng = np.random.default_rng(6)
    count = {"outside": 0, "inside": 0, "both inside": 0, "crossed": 0, "met": 0, "missed": 0}
    for _ in range(3000):
        radius = 1.0
        q, l = (v * rng.choice([0.5, 1.5, 6.0]) / np.linalg.norm(v) for v in rng.normal(size=(2, 3)))
        with mpmath.workdps(60):
            roots, tie = _segment(q, l, radius)
        if tie < 1e-12:
            continue
        d = l - q
        a, b, c = float(d @ d), float(q @ d), float(q @ q) - radius**2
        met = bool(MEETS(a, b, c))
        assert met == bool(roots), (q, l)
        ends = (bool(q @ q < 1), bool(l @ l < 1))
        count["outside"] += ends == (False, False)
        count["both inside"] += ends == (True, True)
        count["inside"] += ends[0] != ends[1]
        count["crossed"] += len(roots) == 2
        count["met"], count["missed"] = count["met"] + met, count["missed"] + (not met)
    assert min(count.values()) > 100, count


def test_tangent_segment_and_ends_on_the_surface() -> None:
    # tangent from (-2, 1, 0) to (2, 1, 0): touching counts
    assert MEETS(16.0, -8.0, 4.0)
    # a hair further out it does not
    assert not MEETS(16.0, -8.0, 4.0 + 1e-12)
    # tangent line, but the point of tangency lies before or behind the segment
    assert not MEETS(1.0, 2.0, 4.0)
    assert not MEETS(1.0, -2.0, 4.0)
    # an end on the surface is not inside an open segment
    assert not MEETS(1.0, 1.0, 0.0)
    assert not MEETS(1.0, -2.0, 3.0)
