"""Irradiance by meridians: what a place sees is cut into half circles from its normal to its horizon.

Along a meridian what is seen changes at angles known in closed form: where it crosses the plane of an edge, the cone of
a sphere or of a disk, or the plane in which two surfaces are equally far. Between them one ray each tells what is seen,
cast by code of its own, and the cosine is integrated exactly. Across meridians the sum is integrated by the rule of
Takahasi and Mori between the azimuths at which boundaries cross or end. Nothing is shared with the package.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
NODES = (12, 24, 48, 96, 192)
"""Half the nodes between two azimuths, more where the last two sums differ."""
_ROUNDED = 16 * 2.0**-52
"""Distance from a sphere, in parts of the coordinates, up to which a place lies on it."""
_BESIDE = 1e-7
_AGREED = 1e-10


def rule(half: int) -> tuple[Array, Array]:
    """Nodes in [0, 1] and weights of the rule of Takahasi and Mori."""
    t = np.arange(-half, half + 1) * (3.05 / half)
    u = 0.5 * math.pi * np.sinh(t)
    return 0.5 + 0.5 * np.tanh(u), (3.05 / half) * 0.25 * math.pi * np.cosh(t) / np.cosh(u) ** 2


def _cross(a: Array, b: Array) -> Array:
    """Of two vectors, in a tenth of the time of ``np.cross``."""
    return np.array([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


@dataclass
class Piece:
    """A flat piece (corners about ``point``, or a disk, or endless) or a sphere, by its offset from the place."""

    owner: str
    kind: str
    point: Array
    normal: Array = field(default_factory=lambda: np.zeros(3))
    corners: Array = field(default_factory=lambda: np.zeros((0, 3)))
    radius: float = 0.0
    touched: bool = False
    """Whether the place lies on the sphere, but for roundings: it then hides all on its side of the tangent plane."""
    inward: Array = field(init=False)
    """Across each edge in the plane of the piece, towards its inside."""

    def __post_init__(self) -> None:
        edges = np.roll(self.corners, -1, axis=0) - self.corners
        self.inward = np.array([_cross(self.normal, edge) for edge in edges]).reshape(-1, 3)

    def hit(self, w: Array) -> Array:
        """Distance along unit directions (..., 3), inf where it is not met."""
        with np.errstate(all="ignore"):
            if self.kind == "sphere":
                along = w @ self.point
                if self.touched:
                    return np.where(along > 0.0, 0.0, np.inf)
                x, y, z = (w[..., k] for k in range(3))
                a, b, c = self.point
                level = self.radius**2 - ((y * c - z * b) ** 2 + (z * a - x * c) ** 2 + (x * b - y * a) ** 2)
                half = np.sqrt(np.maximum(level, 0.0))
                inside = self.point @ self.point < self.radius**2
                near = along + half if inside else along - half
                return np.where((level >= 0.0) & (near > 0.0), near, np.inf)
            far = (self.point @ self.normal) / (w @ self.normal)
            met = np.isfinite(far) & (far > 0.0)
            spot = np.where(met, far, 0.0)[..., None] * w
            if self.kind == "disk":
                met &= ((spot - self.point) ** 2).sum(axis=-1) <= self.radius**2
            for a, inward in zip(self.corners, self.inward, strict=True):
                met &= (spot - a) @ inward >= 0.0
            return np.where(met, far, np.inf)


def pieces_of(shape: dict[str, Any], place: Array) -> list[Piece]:
    """What a shape of a scene is made of."""
    name, kind = shape["name"], shape["type"]
    if kind == "sphere":
        center, radius = np.array(shape["center"], float), float(shape["radius"])
        size = max(float(np.abs(center).max()), float(np.abs(place).max()), radius)
        touched = abs(float(np.linalg.norm(center - place)) - radius) <= _ROUNDED * size
        return [Piece(name, "sphere", center - place, radius=radius, touched=touched)]
    if kind in ("plane", "disk"):
        n = np.array(shape["normal"], float)
        point = np.array(shape["point" if kind == "plane" else "center"], float) - place
        return [Piece(name, kind, point, n / np.linalg.norm(n), radius=shape.get("radius", 0.0))]
    if kind == "box":
        half = 0.5 * np.array(shape["size"], float)
        t = math.radians(shape["rotation"])
        axes = np.array([[math.cos(t), math.sin(t), 0], [-math.sin(t), math.cos(t), 0], [0, 0, 1]])
        found = []
        for k, side in itertools.product(range(3), (1, -1)):
            u, v = axes[(k + 1) % 3] * half[(k + 1) % 3], axes[(k + 2) % 3] * half[(k + 2) % 3]
            middle = np.array(shape["center"]) - place + side * half[k] * axes[k]
            corners = np.array([middle - u - v, middle + u - v, middle + u + v, middle - u + v])
            found.append(Piece(name, "polygon", corners[0], side * axes[k], corners[::side]))
        return found
    if kind == "rectangle":
        a, u, v = (np.array(shape[key], float) for key in ("corner", "edge_u", "edge_v"))
        corners = np.array([a, a + u, a + u + v, a + v])
    else:
        corners = np.array(shape["vertices"], float)
    n = np.cross(corners[1] - corners[0], corners[-1] - corners[0])
    return [Piece(name, "polygon", corners[0] - place, n / np.linalg.norm(n), corners - place)]


def irradiance(
    shapes: list[dict[str, Any]], own: str, place: Array, normal: Array, lamp: str | None, above: Array | None = None
) -> tuple[float, float]:
    """Irradiance of a place of shape ``own`` by radiance 1 of shape ``lamp``, or of the sky where it is None, and the
    error of it. Only what is ``above`` the horizon of another normal counts, if that is given."""
    pieces = [piece for shape in shapes if shape["name"] != own for piece in pieces_of(shape, place)]
    first = np.cross(normal, [0.0, 0.0, 1.0] if abs(normal[2]) < 0.7 else [1.0, 0.0, 0.0])
    first /= np.linalg.norm(first)
    second = np.cross(normal, first)
    circles, forms = _boundaries(pieces, lamp)
    if above is not None:
        circles.append(Circle(above / np.linalg.norm(above)))
    azimuths = _azimuths(circles, forms, normal, first, second)
    before = math.inf
    for half in NODES:
        nodes, weights = rule(half)
        begin, end = azimuths[:-1, None], azimuths[1:, None]
        phi = (begin + (end - begin) * nodes).ravel()
        e = np.cos(phi)[:, None] * first + np.sin(phi)[:, None] * second
        value = float(((end - begin) * weights).ravel() @ _meridians(pieces, circles, forms, e, normal, lamp, above))
        if abs(value - before) < _AGREED or half == NODES[-1]:
            break
        before = value
    return value, abs(value - before)


def _meridians(
    pieces: list[Piece], circles: list[Circle], forms: list[Array], e: Array, normal: Array, lamp: str | None,
    above: Array | None,
) -> Array:  # fmt: skip
    """What half circles towards directions ``e`` (N, 3) of the horizon add."""
    angles = _angles(circles, forms, e, normal)
    # most of the boundaries do not meet most of the meridians: pieces without a length are passed over
    rows, columns = np.nonzero(angles[:, 1:] > angles[:, :-1])
    begin, end = angles[rows, columns], angles[rows, columns + 1]
    middle = 0.5 * (begin + end)
    w = np.sin(middle)[:, None] * e[rows] + np.cos(middle)[:, None] * normal
    nearest = np.full(middle.shape, np.inf)
    seen = np.full(middle.shape, lamp is None)
    for piece in pieces:
        far = piece.hit(w)
        ahead = far < nearest
        shows = (piece.kind == "sphere") | (w @ piece.normal < 0.0)
        if piece.kind == "sphere" and not piece.touched and piece.point @ piece.point < piece.radius**2:
            shows = np.zeros_like(shows)
        seen = np.where(ahead, shows & (piece.owner == lamp), seen)
        nearest = np.where(ahead, far, nearest)
    if above is not None:
        seen &= w @ above > 0.0
    # sin^2 b - sin^2 a, without cancelling
    share = np.sin(end - begin) * np.sin(end + begin)
    return np.bincount(rows, np.where(seen, 0.5 * share, 0.0), len(e))


@dataclass
class Circle:
    """Directions at the angle of ``cosine`` from ``axis``; of an edge, those between its ends alone."""

    axis: Array
    cosine: float = 0.0
    ends: Array | None = None
    onward: tuple[Array, Array] | None = field(init=False, default=None)
    """Of an edge, what points along its circle from one end and back from the other."""

    def __post_init__(self) -> None:
        if self.ends is not None:
            self.onward = _cross(self.axis, self.ends[0]), _cross(self.ends[1], self.axis)

    def holds(self, x: Array) -> Any:
        """Whether directions (..., 3) of the circle lie on the edge, or a little beside it."""
        if self.onward is None:
            return np.full(x.shape[:-1], True)
        room = -_BESIDE * np.sqrt((x * x).sum(axis=-1))
        return (x @ self.onward[0] >= room) & (x @ self.onward[1] >= room)


def _boundaries(pieces: list[Piece], lamp: str | None) -> tuple[list[Circle], list[Array]]:
    """Circles (axis, cosine) and quadratic forms of directions across which what is seen may change."""
    circles: list[Circle] = []
    forms: list[Array] = []

    def great(m: Array, ends: Array | None = None) -> None:
        size = np.linalg.norm(m)
        if size > 0.0:
            circles.append(Circle(m / size, 0.0, ends))

    for piece in pieces:
        if piece.kind == "sphere":
            far2 = float(piece.point @ piece.point)
            if piece.touched:
                great(piece.point)
            elif far2 > piece.radius**2:
                circles.append(Circle(piece.point / math.sqrt(far2), math.sqrt(1.0 - piece.radius**2 / far2)))
            continue
        for a, b in zip(piece.corners, np.roll(piece.corners, -1, axis=0), strict=True):
            sizes = np.linalg.norm([a, b], axis=1)
            great(_cross(a, b - a), np.array([a, b]) / sizes[:, None] if sizes.all() else None)
        if piece.kind == "plane":
            great(piece.normal)
        if piece.kind == "disk":
            c, n, h = piece.point, piece.normal, float(piece.point @ piece.normal)
            mixed = np.outer(c, n)
            forms.append(h * h * np.eye(3) - h * (mixed + mixed.T) + (c @ c - piece.radius**2) * np.outer(n, n))
    flat = [piece for piece in pieces if piece.kind != "sphere"]
    for a, b in itertools.combinations(flat, 2):
        if lamp is not None and lamp in (a.owner, b.owner) and a.owner != b.owner:
            great((a.point @ a.normal) * b.normal - (b.point @ b.normal) * a.normal)
    return circles, forms


def _azimuths(circles: list[Circle], forms: list[Array], normal: Array, first: Array, second: Array) -> Array:
    """Azimuths between which boundaries neither cross nor end, from 0 to a turn."""
    found: list[float] = []

    def put(x: Array) -> None:
        found.append(math.atan2(x @ second, x @ first))

    every = [*circles, Circle(normal)]
    for one, other in itertools.combinations(every, 2):
        (a, p), (b, q) = (one.axis, one.cosine), (other.axis, other.cosine)
        d, x = float(a @ b), _cross(a, b)
        cut = float(x @ x) - p * p - q * q + 2.0 * d * p * q
        if cut >= 0.0 and x @ x > 0.0:
            flat = (p - d * q) * a + (q - d * p) * b
            for side in (1.0, -1.0):
                spot = flat + side * math.sqrt(cut) * x
                if spot @ normal >= -_BESIDE * float(x @ x) and one.holds(spot) and other.holds(spot):
                    put(spot)
    for circle in circles:
        a, p = circle.axis, circle.cosine
        for end in circle.ends if circle.ends is not None else ():
            put(end)
        size = math.hypot(a @ first, a @ second)
        sine = math.sqrt(max(0.0, 1.0 - p * p))
        if p != 0.0 and sine < size:
            at, half = math.atan2(a @ second, a @ first), math.asin(sine / size)
            found += [at - half, at + half]
    if forms:
        found += _form_azimuths(every, forms, normal, first, second)
    found += [0.0]
    turn = 2.0 * math.pi
    around = np.unique(np.array(found) % turn)
    return np.concatenate([around[np.diff(around, prepend=-1.0) > 1e-14], [turn]])


def _form_azimuths(every: list[Circle], forms: list[Array], normal: Array, first: Array, second: Array) -> list[float]:
    """Azimuths at which outlines of disks end, and those at which they cross other boundaries, by bisection."""
    grid = np.linspace(0.0, 2.0 * math.pi, 513)

    def at(phi: Array) -> Array:
        return np.cos(phi)[:, None] * first + np.sin(phi)[:, None] * second

    def ends(phi: Array) -> Array:
        e = at(phi)
        rows = []
        for form in forms:
            a, b, c = ((e @ form) * e).sum(axis=1), (e @ form) @ normal, normal @ form @ normal
            rows.append(b * b - a * c)
        return np.array(rows)

    found: list[float] = []

    def bisected(f: Any) -> None:
        values = f(grid)
        for row, column in zip(*np.nonzero(values[:, :-1] * values[:, 1:] < 0.0), strict=True):
            low, high = grid[column], grid[column + 1]
            sign = values[row, column]
            for _ in range(36):
                mid = 0.5 * (low + high)
                low, high = (mid, high) if f(np.array([mid]))[row, 0] * sign > 0.0 else (low, mid)
            found.append(0.5 * (low + high))

    def crossings(phi: Array) -> Array:
        e = at(phi)
        roots = _form_roots(forms, e, normal)
        rows = []
        for k, root in enumerate(roots.T):
            w = np.sin(root)[:, None] * e + np.cos(root)[:, None] * normal
            rows += [w @ circle.axis - circle.cosine for circle in every]
            rows += [((w @ form) * w).sum(axis=1) for j, form in enumerate(forms) if j != k // 2]
        return np.nan_to_num(np.array(rows))

    bisected(ends)
    bisected(crossings)
    return found


def _form_roots(forms: list[Array], e: Array, normal: Array) -> Array:
    """Angles from the normal at which meridians cross quadratic forms, two each, nan where they do not."""
    rows = []
    with np.errstate(all="ignore"):
        for form in forms:
            a, b, c = ((e @ form) * e).sum(axis=1), (e @ form) @ normal, normal @ form @ normal
            q = -(b + np.where(b >= 0.0, 1.0, -1.0) * np.sqrt(b * b - a * c))
            rows += [np.arctan2(q, a) % math.pi, np.arctan2(c, q) % math.pi]
    return np.array(rows).T


def _angles(circles: list[Circle], forms: list[Array], e: Array, normal: Array) -> Array:
    """Sorted angles from the normal, 0 to a quarter turn, at which meridians cross boundaries."""
    rows = [np.zeros(len(e)), np.full(len(e), 0.5 * math.pi)]
    with np.errstate(all="ignore"):
        for circle in circles:
            a, p = circle.axis, circle.cosine
            up, out = float(a @ normal), e @ a
            if p == 0.0:
                angle = np.arctan2(-up, out) % math.pi
                w = np.sin(angle)[:, None] * e + np.cos(angle)[:, None] * normal
                rows.append(np.where(circle.holds(w), angle, 0.0))
            else:
                half, at = np.arccos(p / np.hypot(up, out)), np.arctan2(out, up)
                rows += [at - half, at + half]
    if forms:
        rows += list(_form_roots(forms, e, normal).T)
    angles = np.nan_to_num(np.array(rows).T, nan=0.0)
    angles = np.sort(np.clip(angles, 0.0, 0.5 * math.pi), axis=1)
    return angles[:, np.flatnonzero(angles.max(axis=0) > 0.0)[0] - 1 :]
