"""Cells taken as wholes: weights that are all but cubics, deviations without a mean, cubics in place of halves'."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from tests.radiometric.flats import box, rectangle, world
from tests.radiosity.rooms import MATERIALS, closed, lamp

import symrender as sr
from symrender.radiosity import table
from symrender.radiosity.adding import FLAT_ENOUGH, PEAK, SMALL_ENOUGH, bending
from symrender.radiosity.cells import (
    NODES,
    Quads,
    deviations,
    fitting,
    frames_of,
    halves,
    joined,
    monomials,
    node_weights,
    sampled_places,
)
from symrender.radiosity.endless import laid
from symrender.radiosity.inner import inner_of
from symrender.radiosity.records import NEVER
from symrender.scene.radiometric.arrays import radiometric_arrays

Array = np.ndarray[Any, np.dtype[np.float64]]
UP = np.array([0.0, 0.0, 1.0])


def quad(rng: np.random.Generator, triangle: bool) -> Quads:
    """A convex cell of the plane z = 0, about as wide as 1."""
    turns = np.sort(rng.uniform(0, 2 * math.pi, 4)) if rng.random() < 0.5 else np.arange(4) * math.pi / 2
    while np.diff(turns, append=turns[0] + 2 * math.pi).max() > 2.8 or np.diff(turns).min() < 0.3:
        turns = np.sort(rng.uniform(0, 2 * math.pi, 4))
    corners = np.stack([np.cos(turns), np.sin(turns), 0 * turns], axis=1)
    if triangle:
        corners[3] = corners[2]
    return Quads(np.zeros(1, np.int64), np.ones(1), np.array([3 if triangle else 4]), corners[None])


def over(quads: Quads, count: int = 40) -> tuple[Array, Array]:
    """(places (n, 3), weights of a mean over the area) of a cell by a fine midpoint rule."""
    one = (np.arange(count) + 0.5) / count
    s, t = (each.ravel()[:, None] for each in np.meshgrid(one, one))
    a, b, c, d = quads.corners[0]
    by_s, by_t = (1 - t) * (b - a) + t * (c - d), (1 - s) * (d - a) + s * (c - b)
    places = (1 - s) * (1 - t) * a + s * (1 - t) * b + s * t * c + (1 - s) * t * d
    areas = np.abs(np.cross(by_s, by_t)[:, 2])
    return places, areas / areas.sum()


def test_weights_over_small_cells_are_cubics_but_for_a_little() -> None:
    """cos cos'/r^2 from geometry, its best cubic by least squares at 1,600 places, told even by corners and middle."""
    judged, tight = 0, 0.0
    for seed in range(400):
        rng = np.random.default_rng(seed)
        cell = quad(rng, bool(seed % 3 == 0))
        normal = rng.normal(size=3)
        normal /= np.linalg.norm(normal)
        place = np.array([*rng.normal(size=2), 0.0]) * rng.uniform(0, 8) + UP * 10.0 ** rng.uniform(-1, 1)
        places, areas = over(cell, 24)

        def weigh(x: Array, place: Array = place, normal: Array = normal) -> Array:
            w = x - place
            return np.asarray((w @ normal) * -w[..., 2] / (w**2).sum(axis=-1) ** 2)

        count = int(cell.count[0])
        corners = cell.corners[0, :count]
        told = weigh(np.concatenate([corners, corners.mean(axis=0)[None]]))
        if told.min() <= 0.0:
            continue
        uneven = float((told.max() - told.min()) / (told.max() + told.min()))
        size = float(np.sqrt(((corners - corners.mean(axis=0)) ** 2).sum(axis=1)).max())
        size /= float(np.linalg.norm(corners.mean(axis=0) - place))
        if uneven >= FLAT_ENOUGH or size >= SMALL_ENOUGH:
            continue
        weights = weigh(places)
        powers = monomials(frames_of(cell, UP[None]), places[None])[0]
        left = weights - powers @ np.linalg.lstsq(powers, weights, rcond=None)[0]
        off = float(np.abs(left).max() / (areas @ weights))
        bend = bending(uneven, size)
        assert off <= bend, (seed, uneven, size, off)
        # and of a whole with halves none weighs more than this times the mean
        assert weights.max() <= (1 + PEAK * uneven) * (areas @ weights), seed
        judged, tight = judged + 1, max(tight, off / bend)
    assert judged > 100 and tight > 0.02


def test_what_a_cubic_leaves_is_stated_on_the_mean() -> None:
    """Kinks across cells, whose mean with weights 1, u and v a fine rule finds: the sum of many is within what is told.

    One cell may hold more; so the quantile is judged.
    """
    shares, small = [], []
    for seed in range(300):
        rng = np.random.default_rng([seed, 5])
        cell = quad(rng, bool(seed % 2))
        frames = frames_of(cell, UP[None])
        angle, at = rng.uniform(0, 2 * math.pi), rng.uniform(-0.8, 0.8)

        def light(x: Array, angle: float = angle, at: float = at) -> Array:
            return np.maximum(np.cos(angle) * x[..., 0] + np.sin(angle) * x[..., 1] - at, 0.0) ** 1.5

        places = sampled_places(cell)
        powers = monomials(frames, places)
        values = np.repeat(light(places)[..., None], 3, axis=2)
        fit = fitting(powers, node_weights(cell))
        made = fit @ values[:, :NODES]
        moments = (node_weights(cell)[0] * (values - powers @ made)[0, :NODES, 0]) @ powers[0, :NODES]
        assert np.abs(moments).max() < 1e-12, "by Gauss's rule what is left has no mean"
        most, bulk, even = deviations(powers, fit, values - powers @ made)
        fine, areas = over(cell)
        terms = monomials(frames, fine[None])[0]
        left = light(fine) - terms @ made[0, :, 0]
        if most[0] < 1e-6:
            continue
        assert 0 < even[0] <= most[0] and bulk[0] <= most[0]
        shares.append(max(abs(areas @ (left * terms[:, k])) for k in range(3)) / even[0])
        small.append(even[0] / most[0])
    assert len(shares) > 200 and np.quantile(shares, 0.95) < 1.0 and np.median(small) < 0.2


def test_a_cubic_in_place_of_its_halves_is_off_by_nothing_on_any_cubic() -> None:
    for seed in range(12):
        rng = np.random.default_rng([seed, 6])
        whole = quad(rng, bool(seed % 2))
        one, two = halves(whole, rng.normal(size=(1, 25, 3)))
        quads = joined([whole, one, two])
        frames = frames_of(quads, np.tile(UP, (3, 1)))
        inner = inner_of(quads, frames, np.array([1, -1, -1]), np.array([2, -1, -1]), np.zeros(0, np.int64))
        cells = table_of_cells(frames)
        terms = rng.normal(size=(3, 3, 10))
        cells["terms"][:] = terms.reshape(3, -1)
        inner.write(cells)
        made = np.asarray(cells["terms"])[0].reshape(3, 10)
        moments, farthest = np.zeros((3, 10)), 0.0
        for half in (1, 2):
            places, areas = over(quads.some(np.array([half])), 120)
            at = np.array([half])
            own = monomials(frames.some(np.array([0])), places[None])[0]
            left = own @ made.T - monomials(frames.some(at), places[None])[0] @ terms[half].T
            moments += float(frames.area[half]) * np.einsum("n,nc,nk->ck", areas, left, own)
            farthest = max(farthest, float(np.abs(left).max()))
        assert farthest > 0.1 and np.abs(moments).max() < 1e-3 * farthest
        assert float(cells["rough"][0]) >= farthest


def table_of_cells(frames: Any) -> Any:
    from symrender.jit.records import table as records
    from symrender.radiosity.records import Cell

    cells = records(Cell, len(frames.area))
    cells["area"][:] = frames.area
    return cells


def test_wholes_stand_for_their_leaves() -> None:
    """What places gather of few cells is what they gather of the leaves alone, within what the wholes add."""
    glow = rectangle("glow", [0.3, 0.3, 0.999], [0, 0.4, 0], [0.4, 0, 0])
    shapes = [*closed(), glow, box("block", [0.25, 0.6, 0.2], [0.3, 0.3, 0.4], 25.0)]
    scene = world(*shapes, lights=[lamp(glow, [5, 4, 3])], materials=MATERIALS, bounces=1)
    small = laid(radiometric_arrays(sr.load(scene)))
    made = table.sendings(small, False, 2e-3)
    rng = np.random.default_rng(2)
    owns, fronts = np.zeros(40, np.int64), np.ones(40, np.int64)
    places = np.column_stack([rng.uniform(0.05, 0.95, (40, 2)), np.zeros(40)])
    found = made.gathered(owns, fronts, places)
    for forest in made.forests:
        inner = np.setdiff1d(np.arange(len(forest.cells)), forest.leaves)
        assert len(inner) > 20
        forest.cells["rough"][inner] = NEVER
    alone = made.gathered(owns, fronts, places)
    off = np.abs(found[:, :3] - alone[:, :3]).max(axis=1)
    assert off.max() > 0.0, "no whole was taken"
    assert (off <= 0.2 * (found[:, 3] + found[:, 4])).all() and (off <= made.fine).all()
    assert found[:, 5].sum() < alone[:, 5].sum()
