"""Means over lens and shutter of a radiometric scene bound to a camera, with what each may be off by."""

from __future__ import annotations

import math
import threading
from functools import lru_cache
from typing import Any, Final

import numpy as np

from symrender.errors import Unsupported
from symrender.jit.compiled import compiled
from symrender.jit.records import copied, table
from symrender.radiometric.bounds import loose_bounds
from symrender.radiometric.pieces import POLYGON, owners
from symrender.radiometric.pixels import lens, outer
from symrender.radiometric.pixels.cells import BOX, DISK, Eye
from symrender.radiometric.pixels.exposed import Box, Exposed, Waiting
from symrender.radiometric.pixels.instants import LOOKS, MOST_INSTANTS, Motion, Watch
from symrender.radiometric.pixels.lens import Lens
from symrender.radiometric.pixels.records import Family, Wall, make_room
from symrender.radiometric.shaken import doubt, shaken
from symrender.radiometric.vectors import Array
from symrender.radiometric.world import Seen, World, seen_all
from symrender.runtimes.pixels import (
    DOMAINS,
    MOST_WALLS,
    Means,
    brightest,
    check_pixels,
    delicate,
    mean_world,
    rays_from,
    wall_tables,
)
from symrender.scene.arrays import CHECKER, SOLID
from symrender.scene.frames import heights
from symrender.scene.radiometric.arrays import AREA, DIRECTIONAL, POINT, SKY, SPHERE, SPOT, RadiometricArrays
from symrender.scene.radiometric.bumped import refuse_means_of_bumps
from symrender.scene.radiometric.cut import cut_reason
from symrender.settings import Settings

_LOOKS: Final = ((0.2113248654051871, 0.3, 0.4, 0.7886751345948129), (0.7886751345948129, -0.5, -0.2, 0.29))
"""Time, places of the lens, and place of the pixel at which roundings are looked at."""


def is_exposed(arrays: RadiometricArrays) -> bool:
    """Whether an image is a mean over a lens or over time."""
    return arrays.exposure.spreads


def check_means(arrays: RadiometricArrays, settings: Settings) -> None:
    """Raise ``Unsupported`` where what is asked of filter, lens and shutter is not had."""
    refuse_means_of_bumps(arrays, settings.filter, is_exposed(arrays))
    reason = cut_reason(arrays)
    if reason and settings.filter != "centre":
        raise Unsupported(
            f"filter: {settings.filter}: is not yet integrated with bounces in a scene with {reason}; with bounces: 0 "
            "it is, filter: centre is, and the numeric pipeline samples any"
        )
    if is_exposed(arrays):
        _check_exposed(arrays, settings)
    elif settings.filter != "centre":
        check_pixels(arrays, f"filter: {settings.filter}")


def _check_exposed(arrays: RadiometricArrays, settings: Settings) -> None:
    exposure = arrays.exposure
    what = "camera.aperture" if exposure.aperture > 0.0 else "shutter"
    if arrays.bounces:
        raise Unsupported(
            f"{what}: is not yet integrated with bounces; with bounces: 0 it is, and the numeric pipeline samples any"
        )
    check_pixels(arrays, what)
    if exposure.aperture > 0.0 and exposure.moves and settings.filter == "centre":
        raise Unsupported(
            "shutter: with an aperture and filter: centre is not yet integrated: what is in focus jumps over time as "
            "it passes a point; with filter: box, tent, gaussian or mitchell it is"
        )
    moving = exposure.shapes.any() or exposure.lights.any()
    lamps = [index for index, light in enumerate(arrays.lights) if light.kind == AREA]
    if exposure.moves and moving and lamps:
        raise Unsupported(
            f"shutter: lights[{lamps[0]}], an area light, in a scene in which shapes or lights move is not yet "
            "integrated, for shapes might come to cross it; where the camera alone moves it is"
        )


def most_walls(arrays: RadiometricArrays, pieces: Any) -> int:
    """Walls that any place may see at any instant, at most."""
    count = len(pieces)
    balls = int((pieces["kind"] == SPHERE).sum())
    edges = [int(piece.count) if piece.kind == POLYGON else 1 for piece in pieces]
    found = sum(edges) + count * (count - 1) // 2 + 1 + count
    for piece in pieces:
        material = arrays.materials[int(piece.material)]
        if piece.kind == SPHERE and material.texture != SOLID:
            found += math.ceil(2.0 / material.cell) + 1
            found += math.ceil(1.0 / material.cell) if material.texture == CHECKER else 0
    for light in arrays.lights:
        if light.kind in (SKY, AREA):
            found += count * (2 * balls + balls * (balls - 1) + 2 * balls * (count - balls))
        else:
            found += count * (1 + (2 if light.kind == SPOT else 0) + sum(edges))
    return found


def motion_of(arrays: RadiometricArrays, world: World) -> Motion:
    """What moves, by how much while the shutter is open."""
    exposure = arrays.exposure
    shapes = exposure.shapes[owners(world.pieces)] if len(world.pieces) else np.zeros((0, 3))
    duration = exposure.duration
    return Motion(
        np.ascontiguousarray(shapes * duration), np.ascontiguousarray(exposure.lights * duration),
        exposure.camera * duration,
    )  # fmt: skip


def moved_world(world: World, motion: Motion, t: float) -> World:
    """The world at an instant, from 0 to 1."""
    pieces, lights = copied(world.pieces), copied(world.lights)
    for piece, way in zip(pieces, motion.pieces, strict=True):
        piece.place[:] += t * way
        piece.corners.reshape(4, 3)[: int(piece.count)] += t * way
    for light, way in zip(lights, motion.lights, strict=True):
        if light.kind in (POINT, SPOT):
            light.place[:] += t * way
    return world._replace(
        pieces=pieces, lights=lights, bounds=loose_bounds(len(pieces)), level=lasting_level(world, motion)
    )  # fmt: skip


def lasting_level(world: World, motion: Motion) -> Array:
    """``level`` of what stays so while the shutter is open."""
    still = heights(motion.lights, motion.pieces, np.asarray(world.pieces["up"])) == 0.0
    return np.asarray(world.level * (still | (np.asarray(world.lights["kind"])[:, None] == DIRECTIONAL)))


def lens_of(arrays: RadiometricArrays, view: Seen) -> Lens:
    """The lens and the axes of the camera."""
    axes = view.window[1:] / np.sqrt((view.window[1:] ** 2).sum(axis=1, keepdims=True))
    return Lens(view.window, np.ascontiguousarray(axes), arrays.exposure.aperture, arrays.exposure.focus)


class _Scratch:
    """What a thread writes: the world as it is at an instant, walls, and the scratch of rules."""

    def __init__(self, arrays: RadiometricArrays, view: Seen, bright: float, settings: Settings) -> None:
        count = most_walls(arrays, view.world.pieces)
        still = view.world
        # its pieces move, and bounds of where they were would leave out what comes
        bounds = loose_bounds(len(still.pieces)) if arrays.exposure.moves else still.bounds
        motion = motion_of(arrays, still)
        world = still._replace(
            pieces=copied(still.pieces), lights=copied(still.lights), bounds=bounds, level=lasting_level(still, motion)
        )
        mean = mean_world(world)
        _, families = wall_tables(view)
        inner = DISK if settings.filter == "centre" else DOMAINS[settings.filter]
        if arrays.exposure.aperture == 0.0:
            inner = BOX
        self.eye = Eye(
            world, mean, _triple(view.eye), table(Wall, count), table(Family, len(families)), bright,
            delicate(arrays), inner,
        )  # fmt: skip
        self.exposed = Exposed(
            still, self.eye, motion, lens_of(arrays, view), settings.width, settings.height,
            DOMAINS[settings.filter], settings.reach, arrays.exposure.moves,
        )  # fmt: skip
        self.room, self.candidates = make_room(still), np.zeros(count, np.int64)
        watched = count if arrays.exposure.moves else 1
        watch = Watch(
            np.zeros((LOOKS, watched)), np.zeros((LOOKS, watched), np.int64), np.zeros(LOOKS, np.int64),
            np.zeros(MOST_INSTANTS), np.zeros(MOST_INSTANTS),
        )  # fmt: skip
        self.waiting = Waiting(table(Box, outer.BOXES), np.zeros(27), np.zeros((3, 6)), np.zeros(7), np.zeros(2), watch)


def _triple(v: Array) -> tuple[float, float, float]:
    return float(v[0]), float(v[1]), float(v[2])


def prepare_exposed(arrays: RadiometricArrays, settings: Settings) -> Means:
    """What fills tiles with means over lens and shutter, and over pixels unless ``filter`` is ``centre``.

    The error is what the rules state and what roundings do to single rays of the pixel.
    """
    width, height = settings.width, settings.height
    moved = shaken(arrays)
    views = seen_all(moved, width, height)
    count = most_walls(arrays, views[0].world.pieces)
    if count > MOST_WALLS:
        raise Unsupported(f"lens and shutter know {MOST_WALLS} walls at most, this scene may have {count}")
    motion = motion_of(arrays, views[0].world)
    bright = max(
        brightest(Seen(moved_world(views[0].world, motion, t), views[0].eye + t * motion.camera, views[0].window))
        for t in ((0.0, 0.5, 1.0) if arrays.exposure.moves else (0.0,))
    )
    own = threading.local()
    alone = settings.filter == "centre" and not arrays.exposure.moves

    def means(x0: int, y0: int, x1: int, y1: int) -> tuple[Array, Array, Array, int]:
        if not hasattr(own, "scratch"):
            own.scratch = _Scratch(arrays, views[0], bright, settings)
        here: _Scratch = own.scratch
        shape = (y1 - y0, x1 - x0)
        emitted, direct, error = np.zeros((*shape, 3)), np.zeros((*shape, 3)), np.zeros(shape)
        limits, layers = (settings.tol, settings.budget), (emitted, direct, error)
        if alone:
            spent = _kernel("fill_lenses")(
                here.eye, here.exposed.lens, width, height, x0, y0, x1, y1, here.room, here.candidates, *limits, *layers
            )
        else:
            spent = _kernel("fill_exposed")(
                here.exposed, settings.filter != "centre", x0, y0, x1, y1, here.room, here.candidates, here.waiting,
                *limits, *layers,
            )  # fmt: skip
        for look in _LOOKS:
            closed = [
                _look(each, view, look, (x0, y0, x1, y1), settings).reshape(*shape, 3)
                for each, view in zip(moved, views, strict=True)
            ]
            error += doubt(closed[0], closed[1:]) / len(_LOOKS)
        return emitted, direct, error, int(spent)

    return means


def _look(
    arrays: RadiometricArrays, view: Seen, look: tuple[float, float, float, float], tile: tuple[int, int, int, int],
    settings: Settings,
) -> Array:  # fmt: skip
    """(N, 3) radiance along one ray of every pixel of a tile, through a place of the lens at an instant."""
    t, x, y, place = look
    exposure, motion = arrays.exposure, motion_of(arrays, view.world)
    there = place if settings.filter != "centre" else 0.5
    columns, rows = there + np.arange(tile[0], tile[2], dtype=float), there + np.arange(tile[1], tile[3], dtype=float)
    eye = view.eye + (t * motion.camera if exposure.moves else 0.0)
    forward, right, up = view.window
    a, b = 2.0 * columns / settings.width - 1.0, 1.0 - 2.0 * rows / settings.height
    v = (forward + a[None, :, None] * right + b[:, None, None] * up).reshape(-1, 3)
    axes = lens_of(arrays, view).axes
    shift = exposure.aperture * (x * axes[0] + y * axes[1])
    v = v - shift / exposure.focus
    v /= np.sqrt((v**2).sum(axis=1, keepdims=True))
    world = moved_world(view.world, motion, t) if exposure.moves else view.world
    return rays_from(world, eye + shift, np.ascontiguousarray(v))


@lru_cache(maxsize=2)
def _kernel(name: str) -> Any:
    """Compiled function that fills means."""
    module = lens if hasattr(lens, name) else outer
    # the kernels only borrow arrays; counting references to them would cost more than the arithmetic
    return compiled(getattr(module, name), _nrt=False)
