from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from symrender.jit.records import record
from symrender.numeric.antialias import MAX_CROSSINGS, Quad, footprint, mean_sign, pixel_sign, wave
from symrender.numeric.rays import camera_frame, primary_ray
from symrender.numeric.textures import floor_sign
from symrender.scene.arrays import CHECKER, LOOK_AT, PLANE
from symrender.scene.records import Camera, Floor

Point = tuple[float, float]


def _box(p: float, w: float) -> float:
    """Mean of sign(sin pi t) over p - w/2 .. p + w/2, math.md section 8."""

    def part(x: float) -> float:
        return abs(x / 2 - math.floor(x / 2) - 0.5)

    return 2 * (part(p - w / 2) - part(p + w / 2)) / w


def _rectangle(w: float, h: float) -> Quad:
    return (-w / 2, -h / 2, w / 2, -h / 2, w / 2, h / 2, -w / 2, h / 2)


def _clip(polygon: list[Point], axis: int, bound: float, keep: float) -> list[Point]:
    """Part of a polygon with keep * (coordinate - bound) >= 0."""
    out: list[Point] = []
    for a, b in zip(polygon, polygon[1:] + polygon[:1], strict=True):
        da, db = keep * (a[axis] - bound), keep * (b[axis] - bound)
        if da >= 0:
            out.append(a)
        if (da > 0 > db) or (da < 0 < db):
            t = da / (da - db)
            out.append((a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])))
    return out


def _area(polygon: list[Point]) -> float:
    return 0.5 * sum(a[0] * b[1] - b[0] * a[1] for a, b in zip(polygon, polygon[1:] + polygon[:1], strict=True))


def _mean_by_clipping(center: Point, quad: Quad) -> float:
    """The same mean by cutting the polygon cell by cell."""
    polygon = [(center[0] + quad[2 * k], center[1] + quad[2 * k + 1]) for k in range(4)]
    xs, ys = [p[0] for p in polygon], [p[1] for p in polygon]
    total = 0.0
    for i in range(math.floor(min(xs)), math.floor(max(xs)) + 1):
        for j in range(math.floor(min(ys)), math.floor(max(ys)) + 1):
            piece = polygon
            for axis, bound, keep in ((0, i, 1), (0, i + 1, -1), (1, j, 1), (1, j + 1, -1)):
                piece = _clip(piece, axis, bound, keep) if piece else piece
            if piece:
                total += _area(piece) * (1 if (i + j) % 2 == 0 else -1)
    return total / _area(polygon)


@given(st.floats(-50, 50), st.floats(-50, 50), st.floats(1e-2, 5), st.floats(1e-2, 5))
@settings(max_examples=100, deadline=None, derandomize=True)
def test_rectangles_are_the_product_of_two_box_means(x: float, y: float, w: float, h: float) -> None:
    assert mean_sign(x, y, _rectangle(w, h)) == pytest.approx(_box(x, w) * _box(y, h), abs=2e-12)


def test_pixels_of_the_chapter_camera() -> None:
    """Every pixel of a 64 x 64 window: to 1e-13 the closed form, and a fair share of them on an edge."""
    width, half, center_y = 64, 1.2909944487358056, -0.19364916731037082
    camera = _plane((0, 0, 4), half, (0, center_y))
    frame, floor = camera_frame(camera, width, width), _checker()
    worst, mixed = 0.0, 0
    for j in range(width):
        for i in range(width):
            a, b = 2 * (i + 0.5) / width - 1, 1 - 2 * (j + 0.5) / width
            _, _, p = primary_ray(frame, a, b)
            got = pixel_sign(floor, frame, a, b, 1 / width, 1 / width, p[0], p[1])
            pixel = 2 * half / width
            worst = max(worst, abs(got - _box(p[0], pixel) * _box(p[1], pixel)))
            mixed += abs(got) < 1
    assert mixed >= 200
    assert worst <= 1e-13


def _checker(cell: float = 1.0) -> Floor:
    floor = record(Floor)
    floor.present, floor.kind, floor.bright[:], floor.cell = 1, CHECKER, 1.0, cell
    return floor


@given(st.floats(-20, 20), st.floats(-20, 20), st.lists(st.floats(0.05, 3), min_size=4, max_size=4), st.floats(0, 6.2))
@settings(max_examples=60, deadline=None, derandomize=True)
def test_any_convex_patch_equals_cutting_it_cell_by_cell(x: float, y: float, radii: list[float], turn: float) -> None:
    corners = [
        (r * math.cos(turn + k * math.pi / 2), r * math.sin(turn + k * math.pi / 2)) for k, r in enumerate(radii)
    ]
    quad: Quad = (*corners[0], *corners[1], *corners[2], *corners[3])
    expected = _mean_by_clipping((x, y), quad)
    assert mean_sign(x, y, quad) == pytest.approx(expected, abs=1e-10)
    backwards: Quad = (*corners[3], *corners[2], *corners[1], *corners[0])
    assert mean_sign(x, y, backwards) == pytest.approx(expected, abs=1e-10)


def _plane(eye: tuple[float, float, float], half: float, center: Point) -> Camera:
    camera = record(Camera)
    camera.kind, camera.eye[:], camera.window_half, camera.window_center[:] = PLANE, eye, half, center
    return camera


def _look_at() -> Camera:
    camera = record(Camera)
    camera.kind, camera.eye[:], camera.target[:] = LOOK_AT, (3, -4, 2), (0, 0, 0)
    camera.up[:], camera.fov = (0, 0, 1), 40
    return camera


def test_perspective_footprint_is_where_the_pixel_looks() -> None:
    """Points looked at from inside the pixel are inside the patch, its corners on its border; mean against sampling."""
    frame, width = camera_frame(_look_at(), 24, 24), 24
    compared = 0
    for i, j in ((3, 20), (12, 12), (20, 8), (9, 4)):
        a, b = 2 * (i + 0.5) / width - 1, 1 - 2 * (j + 0.5) / width
        _, _, p = primary_ray(frame, a, b)
        whole, quad = footprint(frame, a, b, 1 / width, 1 / width, p[0], p[1])
        assert whole
        corner = primary_ray(frame, a - 1 / width, b - 1 / width)[2]
        assert (quad[0] + p[0], quad[1] + p[1]) == pytest.approx(corner[:2], abs=1e-12)
        mean = pixel_sign(_checker(0.25), frame, a, b, 1 / width, 1 / width, p[0], p[1])
        n = 200
        total = weight = 0.0
        corners = np.array(quad).reshape(4, 2)
        for s in (np.arange(n) + 0.5) / n:
            for t in (np.arange(n) + 0.5) / n:
                # bilinear patch of the same quadrilateral, with its own area element
                x, y = (
                    (1 - s) * (1 - t) * corners[0]
                    + s * (1 - t) * corners[1]
                    + s * t * corners[2]
                    + (1 - s) * t * corners[3]
                )
                ds = (1 - t) * (corners[1] - corners[0]) + t * (corners[2] - corners[3])
                dt = (1 - s) * (corners[3] - corners[0]) + s * (corners[2] - corners[1])
                area = abs(ds[0] * dt[1] - ds[1] * dt[0])
                total += area * floor_sign(_checker(0.25), x + p[0], y + p[1])
                weight += area
        assert mean == pytest.approx(total / weight, abs=0.01)
        compared += abs(mean) < 0.95
    assert compared >= 2


def test_horizon_and_overflow_fall_back() -> None:
    frame = camera_frame(_look_at(), 24, 24)
    whole, _ = footprint(frame, 0.0, 1.09, 1 / 24, 1 / 24, 0.0, 0.0)
    looks_up = frame[6] + (1.09 + 1 / 24) * frame[12] > 0
    assert looks_up and not whole
    assert pixel_sign(_checker(), frame, 0.0, 1.09, 1 / 24, 1 / 24, 0.0, 0.0) == 0.0
    wide = _rectangle(MAX_CROSSINGS, 3.0)
    assert mean_sign(0.3, 0.4, wide) == 0.0
    assert math.isnan(mean_sign(0.3, 0.4, _rectangle(1e300, 1e300)))
    assert math.isnan(mean_sign(0.3, 0.4, (0.0,) * 8))
    nowhere = camera_frame(_plane((0, 0, 4), 1e-200, (0.3, 0.4)), 1, 1)
    point = pixel_sign(_checker(), nowhere, 0, 0, 1, 1, 0.3, 0.4)
    assert point == 1.0, "a pixel without area is its own point"


def test_neglect_beyond_the_cap_is_within_the_stated_bound() -> None:
    for w, h in ((3001.5, 2.5), (2.5, 3001.5), (1234.5, 1234.5)):
        exact = _box(0.3, w) * _box(0.4, h)
        bound = min(2 * w, 2 * h) / (2 * w * h)
        assert abs(exact) <= bound


def test_wave() -> None:
    assert [wave(x) for x in (-1.0, -0.25, 0.0, 0.25, 1.0, 1.75, 2.0)] == [1.0, 0.25, 0.0, 0.25, 1.0, 0.25, 0.0]
