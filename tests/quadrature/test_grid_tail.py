"""What a taper cannot see of endless squares: the places, against curves drawn and counted by brute force."""

from __future__ import annotations

import math

import numpy as np
import pytest

from symrender.chambers.events import ROOT, SMOOTH
from symrender.chambers.work import work_arrays
from symrender.jit.records import Table, table
from symrender.quadrature import conic_places, grid_tail
from symrender.quadrature.records import Conic, Remainder
from symrender.quadrature.square_rows import nearest_branch

CURVES = 400
CORNERS = 200


def drawn(rng: np.random.Generator, kind: str) -> tuple[tuple[float, ...], np.ndarray]:
    """A random conic as (xx, xy, yy, x, y, free), and points along it, (n, 2); NaN between two branches."""
    turn, a, b = rng.uniform(0.0, np.pi), rng.uniform(0.3, 3.0), rng.uniform(0.3, 3.0)
    middle = rng.uniform(-2.0, 2.0, 2)
    if kind == "ellipse":
        t = np.linspace(0.0, 2.0 * np.pi, 20_001)
        own, form = np.stack([a * np.cos(t), b * np.sin(t)], 1), (1.0 / a**2, 1.0 / b**2, 0.0, -1.0)
    elif kind == "hyperbola":
        t = np.linspace(-4.0, 4.0, 20_001)
        right = np.stack([a * np.cosh(t), b * np.sinh(t)], 1)
        own = np.concatenate([right, [[np.nan, np.nan]], -right])
        form = (1.0 / a**2, -1.0 / b**2, 0.0, -1.0)
    else:
        t = np.linspace(-30.0, 30.0, 20_001)
        own, form = np.stack([a * t**2, t], 1), (0.0, a, -0.5, 0.0)
    c, s = math.cos(turn), math.sin(turn)
    xx, yy, along, free = form
    # u = c (x - mx) + s (y - my) and v = -s (x - mx) + c (y - my) in xx u^2 + yy v^2 + 2 along u + free
    u, v = np.array([c, s, -(c * middle[0] + s * middle[1])]), np.array([-s, c, s * middle[0] - c * middle[1]])
    one = np.array([0.0, 0.0, 1.0])
    form3 = xx * np.outer(u, u) + yy * np.outer(v, v) + along * (np.outer(u, one) + np.outer(one, u))
    form3[2, 2] += free
    points = middle + own @ np.array([[c, s], [-s, c]])
    return (form3[0, 0], form3[0, 1], form3[1, 1], form3[0, 2], form3[1, 2], form3[2, 2]), points


def conic_of(words: tuple[float, ...]) -> Conic:
    row = table(Conic, 1)[0]
    row.xx, row.xy, row.yy, row.x, row.y, row.free = words
    return row


def level(words: tuple[float, ...], x: np.ndarray, y: np.ndarray) -> np.ndarray:
    xx, xy, yy, a, b, free = words
    return xx * x * x + 2.0 * xy * x * y + yy * y * y + 2.0 * (a * x + b * y) + free


def turns(values: np.ndarray) -> np.ndarray:
    """Where a sampled function has its extremes."""
    step = np.diff(values)
    return np.flatnonzero(step[:-1] * step[1:] < 0.0) + 1


@pytest.mark.parametrize("kind", ["ellipse", "hyperbola", "parabola"])
def test_waves_run_along_a_wall_where_it_is_farthest_along_their_direction(kind: str) -> None:
    rng = np.random.default_rng(3)
    places = 0
    for _ in range(CURVES // 4):
        words, points = drawn(rng, kind)
        assert np.nanmax(np.abs(level(words, points[:, 0], points[:, 1]))) < 1e-8 * np.nanmax(points**2 + 1.0)
        p, q = (float(v) for v in rng.choice([-7, -3, -1, 1, 3, 5], 2))
        found, x0, y0, x1, y1 = conic_places.point_of_wave(conic_of(words), p, q)
        got = [(x0, y0), (x1, y1)][:found]
        at = points[turns(points @ np.array([p, q]))]
        # those that were drawn are among those in closed form, and all in closed form lie on the curve
        spacing = np.nanmax(np.linalg.norm(np.diff(points, axis=0), axis=1))
        for place in at:
            assert min(math.dist(place, other) for other in got) < 2.0 * spacing
        for x, y in got:
            assert abs(level(words, np.float64(x), np.float64(y))) < 1e-9 * (1.0 + x * x + y * y)
        assert len(at) == found if kind == "ellipse" else len(at) <= found
        places += len(at)
    assert places >= CURVES // 4


def test_two_walls_meet_where_their_curves_cross() -> None:
    rng = np.random.default_rng(4)
    work = work_arrays(2, 1)
    kinds, met = ["ellipse", "hyperbola", "parabola"], 0
    for k in range(CORNERS):
        one, points = drawn(rng, kinds[k % 3])
        other, _ = drawn(rng, kinds[(k // 3) % 3])
        if k % 10 == 0:
            other = (0.0, 0.0, 0.0, *rng.normal(size=3))
        far = 12.0
        rows = np.zeros((8, 2))
        found = conic_places.meetings(conic_of(one), conic_of(other), far, work, rows)
        for x, y in rows[:found]:
            size = 1.0 + x * x + y * y
            gone = [abs(level(words, x, y)) / (size * max(map(abs, words))) for words in (one, other)]
            assert max(gone) < 1e-6
        side = level(other, points[:, 0], points[:, 1])
        cross = np.flatnonzero(side[:-1] * side[1:] < 0.0)
        spacing = np.nanmax(np.linalg.norm(np.diff(points, axis=0), axis=1))
        for i in cross:
            if np.abs(points[i]).max() > 0.95 * far:
                continue
            met += 1
            assert min(math.dist(points[i], row) for row in rows[:found]) < 2.0 * spacing + 1e-6
    assert met >= CORNERS


def test_straight_parts_are_what_a_hyperbola_tends_to_and_lines_themselves() -> None:
    rng = np.random.default_rng(5)
    lines = 0
    for _ in range(60):
        words, points = drawn(rng, "hyperbola")
        parts, x, y, ax, ay, bx, by = conic_places.straight_parts(conic_of(words))
        assert parts == 2
        ends = points[[0, 20_000, 20_002, -1]]
        for end in ends:
            # 4 in the curve's own parameter is e^4 / 2 of its half axes out, where it is e^-4 of them off
            off = [abs(s * (end[0] - x) - c * (end[1] - y)) for c, s in ((ax, ay), (bx, by))]
            assert min(off) < 0.04 * 3.0
            lines += 1
        nx, ny, free = rng.normal(size=3)
        parts, x, y, ax, ay, *_ = conic_places.straight_parts(conic_of((0.0, 0.0, 0.0, nx, ny, free)))
        assert parts == 1
        for s in (-3.0, 0.0, 5.0):
            assert abs(2.0 * (nx * (x + s * ax) + ny * (y + s * ay)) + free) < 1e-9
    assert lines == 240
    ellipse, _ = drawn(rng, "ellipse")
    assert conic_places.straight_parts(conic_of(ellipse))[0] == 0


def test_a_full_list_of_places_goes_on_in_its_last_row() -> None:
    rows: Table[Remainder] = table(Remainder, 2)
    n = 0
    for k in range(5):
        n = grid_tail.note_remainder(1.0, 2.0, 1.0 + k, 10.0, 0, -1, rows, n)
    assert n == 2
    assert grid_tail.tail_of_squares(rows, n) == pytest.approx(grid_tail.REST * 15.0)
    assert rows[0].swing + rows[1].swing == 50.0


@pytest.mark.parametrize("away", [0.3, 0.02, 1e-3])
def test_a_strip_feels_where_a_conic_turns_just_outside(away: float) -> None:
    work = work_arrays(2, 1)
    work.root_id[1] = 0
    conics = table(Conic, 1)
    circle = (1.0, 0.0, 1.0, 0.0, -(1.0 - away), (1.0 - away) ** 2 - 1.0)
    conics[0].xx, conics[0].xy, conics[0].yy, conics[0].x, conics[0].y, conics[0].free = circle
    told = nearest_branch(0.0, 1.0, SMOOTH, SMOOTH, 2, np.zeros(1), conics, work)
    z = 1.0 + 2.0 * away
    assert told == pytest.approx(math.log(z + math.sqrt(z * z - 1.0)))
    # the Legendre coefficients of the chord fall at this rate
    nodes, weights = np.polynomial.legendre.leggauss(400)
    chord = np.sqrt(1.0 - (0.5 + 0.5 * nodes - (1.0 - away)) ** 2)
    degree = min(24, int(9.0 / told))
    first, later = (
        abs(np.sum(weights * chord * np.polynomial.legendre.legval(nodes, np.eye(k + 1)[k])) * (2 * k + 1))
        for k in (degree, 2 * degree)
    )
    assert later > 1e-12
    rate = (math.log(first / later) - math.log(2.0)) / degree
    assert rate == pytest.approx(told, rel=0.15, abs=0.02)
    # where the map begins there is no branch left: the circle's other end, two radii on, is the next
    z = 2.0 * math.sqrt(2.0 / (1.0 + away)) - 1.0
    mapped = nearest_branch(-away, 1.0, ROOT, SMOOTH, 2, np.zeros(1), conics, work)
    assert mapped == pytest.approx(math.log(z + math.sqrt(z * z - 1.0)))
    # a parabola touches one line only
    parabola = (1.0, 0.0, 0.0, 0.0, -0.5, -away)
    conics[0].xx, conics[0].xy, conics[0].yy, conics[0].x, conics[0].y, conics[0].free = parabola
    assert nearest_branch(0.0, 1.0, SMOOTH, SMOOTH, 2, np.zeros(1), conics, work) == pytest.approx(told)
