"""One bounce of light at a diffuse place by adaptive rules within adaptive rules over single rays.

What a ray meets sends what ``bounces: 0`` says, a closed form with judges of its own. Rays fill half meridians from the
place's normal to its horizon; each is cut where the outline of a shape, or the line in which two planes meet, crosses
it, and across them the first pieces end where such outlines cross each other or touch a meridian. Kronrod's rule of 15
nodes is halved until it agrees with Gauss's of 7, along meridians and across; the differences are added up and told.
So jumps and kinks of what is sent, by shadows, penumbrae, terminators, textures and contacts, are found by halving
alone: it knows none of the walls at which the rules cut, nor any cell, cubic or event.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from symrender.radiometric.sky import sky_room
from symrender.radiometric.world import World, make_world
from symrender.runtimes.radiometric import _kernel
from symrender.scene.load import load_any
from symrender.scene.radiometric.arrays import radiometric_arrays

from .meridians import Piece, pieces_of
from .nested import GAUSS, KRONROD, NODES

Array = npt.NDArray[np.float64]
LIFT = 1e-11
"""How far above its surface the place lies, over the size of the scene, so that no ray meets the surface itself."""
DEEPEST = 44
"""Most halvings of a piece."""
FIRST = np.array([0.0, 0.004, 0.03, 0.15, 0.4, 0.7, 0.9, 0.98, 0.997, 1.0])
"""Where pieces of a meridian are cut at first, in parts of them: a sliver of shadow beside an outline lies between the
nodes of a longer one, which then agree without it."""
FINER = np.unique(np.concatenate([FIRST, np.linspace(0.0, 1.0, 17)]))
"""The same where edges of shadows are many."""
MOST = 40_000_000
"""Rays from which on nothing is halved."""
_AT = np.concatenate([NODES, -NODES[-2::-1]])
_WHOLE = np.concatenate([KRONROD, KRONROD[-2::-1]])
_HALF = np.zeros(15)
_HALF[1::2] = np.concatenate([GAUSS, GAUSS[-2::-1]])


class Gathered(NamedTuple):
    """Irradiance over pi of a place, three channels, how far off it may be, and rays spent."""

    light: Array
    error: float
    rays: int


class _Judge:
    """A place of a scene, the circles that cut what it sees, and the kernel that answers for rays."""

    def __init__(self, scene: dict[str, Any], place: Array, normal: Array, first: Array) -> None:
        self.world: World = make_world(radiometric_arrays(load_any(scene | {"bounces": 0})))
        self.parts, self.normal, self.spent = first, normal, 0
        self.first = np.cross(normal, [0.0, 0.0, 1.0] if abs(normal[2]) < 0.7 else [1.0, 0.0, 0.0])
        self.first /= np.linalg.norm(self.first)
        self.second = np.cross(normal, self.first)
        pieces = [piece for shape in scene["shapes"] for piece in pieces_of(shape, place)]
        size = max(1e-300, max(float(np.abs(piece.point).max()) for piece in pieces))
        self.origin = place + LIFT * size * normal
        self.axes, self.levels = _circles(pieces, size)

    def sent(self, ways: Array) -> Array:
        """(N, 3) direct light along unit rays."""
        count = len(ways)
        self.spent += count
        found = np.zeros((count, 3)), np.zeros((count, 3)), np.zeros(count)
        origins = np.tile(self.origin, (count, 1))
        _kernel("fill_rays")(self.world, origins, np.ascontiguousarray(ways), sky_room(self.world), *found)
        return found[1]

    def lines(self, phi: Array, tol: Array) -> tuple[Array, Array]:
        """(integrals (M, 3) along meridians at azimuths ``phi``, what they may be off (M,))."""
        e = np.cos(phi)[:, None] * self.first + np.sin(phi)[:, None] * self.second
        low, high, row = self._pieces(e)
        total, missed = np.zeros((len(phi), 3)), np.zeros(len(phi))
        for deep in range(DEEPEST + 1):
            if not len(row):
                break
            half = 0.5 * (high - low)
            t = (0.5 * (low + high))[:, None] + half[:, None] * _AT
            c, s = np.cos(t), np.sin(t)
            ways = c[..., None] * self.normal + s[..., None] * e[row][:, None, :]
            light = self.sent(ways.reshape(-1, 3)).reshape(*t.shape, 3) * (c * s)[..., None]
            whole, gauss = (half[:, None] * np.einsum("k,nkc->nc", rule, light) for rule in (_WHOLE, _HALF))
            off = np.abs(whole - gauss).max(axis=1)
            done = off <= np.maximum(tol[row], 1e-15 * np.abs(whole).max(axis=1))
            done |= (deep == DEEPEST) | (self.spent > MOST)
            np.add.at(total, row[done], whole[done])
            np.add.at(missed, row[done], off[done])
            low, high, row = low[~done], high[~done], row[~done]
            middle = 0.5 * (low + high)
            low, high, row = np.concatenate([low, middle]), np.concatenate([middle, high]), np.concatenate([row, row])
        return total, missed

    def _pieces(self, e: Array) -> tuple[Array, Array, Array]:
        """(begin, end, meridian) of the pieces of meridians between the circles that cut them."""
        along, out = self.axes @ self.normal, e @ self.axes.T
        size = np.hypot(along, out)
        with np.errstate(all="ignore"):
            middle, half = np.arctan2(out, along), np.arccos(self.levels / size)
        cuts = [np.zeros((len(e), 1)), np.full((len(e), 1), 0.5 * math.pi)]
        for angle in (middle - half, middle + half, middle + half - 2.0 * math.pi, middle - half + 2.0 * math.pi):
            cuts.append(np.where((angle > 0.0) & (angle < 0.5 * math.pi), angle, 0.0))
        ends = np.sort(np.nan_to_num(np.concatenate(cuts, axis=1)), axis=1)
        rows, columns = np.nonzero(np.diff(ends, axis=1) > 1e-15)
        begin, span = ends[rows, columns], np.diff(ends, axis=1)[rows, columns]
        parts = begin[:, None] + span[:, None] * self.parts
        return parts[:, :-1].ravel(), parts[:, 1:].ravel(), np.repeat(rows, len(self.parts) - 1)

    def azimuths(self) -> Array:
        """Azimuths, from 0 to a turn, at which circles cross each other or the horizon, or touch a meridian."""
        axes, levels = np.vstack([self.axes, self.normal]), np.append(self.levels, 0.0)
        found = [0.0, 2.0 * math.pi]
        for i, (a, p) in enumerate(zip(axes, levels, strict=True)):
            across = math.hypot(a @ self.first, a @ self.second)
            sine = math.sqrt(max(0.0, 1.0 - p * p))
            if 0.0 < sine < across:
                middle, half = math.atan2(a @ self.second, a @ self.first), math.asin(sine / across)
                found += [middle + side * half + turn for side in (-1.0, 1.0) for turn in (0.0, math.pi)]
            for b, r in zip(axes[:i], levels[:i], strict=True):
                x, d = np.cross(a, b), float(a @ b)
                sine2 = float(x @ x)
                rest = sine2 - p * p - r * r + 2.0 * d * p * r
                if sine2 < 1e-20 or rest < 0.0:
                    continue
                flat = (p - d * r) * a + (r - d * p) * b
                for spot in (flat + math.sqrt(rest) * x, flat - math.sqrt(rest) * x):
                    if spot @ self.normal > -1e-9 * math.sqrt(spot @ spot):
                        found.append(math.atan2(spot @ self.second, spot @ self.first))
        around = np.unique(np.concatenate([np.array(found[2:]) % (2.0 * math.pi), found[:2]]))
        return np.asarray(around[np.diff(around, prepend=-1.0) > 1e-13])


def _circles(pieces: list[Piece], size: float) -> tuple[Array, Array]:
    """(unit axes (K, 3), cosines (K,)) of the circles in which outlines and lines between planes are seen."""
    axes: list[Array] = []
    levels: list[float] = []

    def put(axis: Array, level: float = 0.0) -> None:
        length = float(np.linalg.norm(axis))
        if length > 1e-14 * size:
            axis = axis / length
            known = zip(axes, levels, strict=True)
            if not any(abs(level - r) < 1e-14 and np.abs(axis - a).max() < 1e-14 for a, r in known):
                axes.append(axis)
                levels.append(level)

    flat = [piece for piece in pieces if piece.kind == "plane"]
    for k, piece in enumerate(pieces):
        if piece.kind == "sphere":
            far2 = float(piece.point @ piece.point)
            if far2 > piece.radius**2 * (1.0 + 1e-12):
                put(size * piece.point, math.sqrt(1.0 - piece.radius**2 / far2))
        elif piece.kind == "plane":
            put(size * piece.normal)
        for a, b in zip(piece.corners, np.roll(piece.corners, -1, axis=0), strict=True):
            put(np.cross(a, b) / size)
        assert piece.kind != "disk", k
    for k, one in enumerate(flat):
        for other in flat[:k]:
            put((one.point @ one.normal) * other.normal - (other.point @ other.normal) * one.normal)
    return np.array(axes).reshape(-1, 3), np.array(levels)


def gathered(scene: dict[str, Any], place: Array, normal: Array, tol: float, first: Array = FIRST) -> Gathered:
    """What arrives at a place of a scene, whose own normal is unit: irradiance by one bounce, over pi.

    ``tol`` is of every piece, not of the whole; what comes of it is told. Pieces of meridians are cut at ``first``.
    """
    judge = _Judge(scene, np.asarray(place, float), np.asarray(normal, float), first)
    ends = judge.azimuths()
    low, high = ends[:-1], ends[1:]
    total, missed = np.zeros(3), 0.0
    for deep in range(DEEPEST + 1):
        if not len(low):
            break
        half = 0.5 * (high - low)
        phi = (0.5 * (low + high))[:, None] + half[:, None] * _AT
        line, off_line = judge.lines(phi.ravel(), np.repeat(tol / (2.0 * half), 15))
        line, off_line = line.reshape(*phi.shape, 3), off_line.reshape(phi.shape)
        whole, gauss = (half[:, None] * np.einsum("k,nkc->nc", rule, line) for rule in (_WHOLE, _HALF))
        off = np.abs(whole - gauss).max(axis=1)
        done = (off <= tol) | (deep == DEEPEST) | (judge.spent > MOST)
        total += whole[done].sum(axis=0)
        missed += float(off[done].sum() + (half[:, None] * _WHOLE * off_line)[done].sum())
        low, high = low[~done], high[~done]
        middle = 0.5 * (low + high)
        low, high = np.concatenate([low, middle]), np.concatenate([middle, high])
    return Gathered(total / math.pi, missed / math.pi, judge.spent)
