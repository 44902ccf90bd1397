"""What a camera sees of a radiometric scene, row by row and without an error: for who asks where light changes.

An image states its error, and computes the scene seven times for it. Where a shadow begins takes one.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import Any

import numpy as np
import numpy.typing as npt

from symrender.errors import Unsupported
from symrender.jit.compiled import compiled
from symrender.radiometric import tile
from symrender.radiometric.shaken import shaken
from symrender.radiometric.sky import sky_room
from symrender.radiometric.vectors import Array
from symrender.radiometric.world import Seen, camera_window, seen
from symrender.runtimes.bounce import hits
from symrender.runtimes.radiometric import check, lamps_on_gloss
from symrender.scene.mitsuba.plane import frame_of
from symrender.scene.radiometric.arrays import RadiometricArrays, radiometric_arrays
from symrender.scene.radiometric.scene import RadiometricScene
from symrender.scene.radiometric.shapes import Plane

Ints = npt.NDArray[np.intp]
Rows = Callable[[int, int, Array], None]
"""``rows(y0, y1, layer)`` fills rows y0:y1 of a layer (h, w, 3); rows apart may be filled at the same time."""


def direct_rows(arrays: RadiometricArrays, width: int, height: int) -> Rows:
    """Direct light through the centres of pixels; ``Unsupported`` where an image of the scene is."""
    check(arrays)
    if lamps_on_gloss(arrays):
        raise Unsupported(
            "regions: of a sky or an area light over a conductor or a phong material they are not yet known"
        )
    view = seen(arrays, width, height)

    def rows(y0: int, y1: int, layer: Array) -> None:
        emitted, hit_class = np.zeros((y1 - y0, width, 3)), np.zeros((y1 - y0, width))
        part = (width, height, 0, y0, width, y1)
        _kernel("fill_tile")(*view, *part, sky_room(view.world), emitted, layer[y0:y1], hit_class)

    return rows


def reflectance_rows(arrays: RadiometricArrays, width: int, height: int) -> Rows:
    """How the place reflects that the centre of a pixel sees, its texture's colour there; 0 where nothing is."""
    view = seen(arrays, width, height)

    def rows(y0: int, y1: int, layer: Array) -> None:
        directions = np.zeros((width * (y1 - y0), 3))
        _kernel("fill_directions")(view.window, width, height, 0, y0, width, y1, directions)
        seen_there = hits(view.world, np.tile(view.eye, (len(directions), 1)), directions)
        layer[y0:y1] = seen_there.albedo.reshape(y1 - y0, width, 3)

    return rows


def shaken_rows(arrays: RadiometricArrays, width: int, height: int, shake: float) -> tuple[Rows, ...]:
    """What rays through centres of pixels meet in the scene and in those of ``shaken``, a ``Rows`` each.

    A layer (h, w, 4) takes emitted and direct light, as far as it is closed, and the class of the shape.
    """
    check(arrays)
    # each lays out its own: what one decides of lights in planes and of bounds another, this far off, need not
    views = [seen(each, width, height) for each in shaken(arrays, shake)]

    def rows_of(view: Seen) -> Rows:
        def rows(y0: int, y1: int, layer: Array) -> None:
            emitted, direct, hit_class = (np.zeros((y1 - y0, width, *last)) for last in ((3,), (3,), ()))
            part = (width, height, 0, y0, width, y1)
            _kernel("fill_tile")(*view, *part, sky_room(view.world), emitted, direct, hit_class)
            layer[y0:y1, :, :3], layer[y0:y1, :, 3] = emitted + direct, hit_class

        return rows

    return tuple(map(rows_of, views))


def displaced_rows(arrays: RadiometricArrays, width: int, height: int, far: Array, turn: float) -> Rows:
    """The same where the ray of every pixel starts ``far`` (h, w) off the eye, at right angles to itself.

    So its place on any shape moves by that length or more. ``turn`` is the angle from the image's right.
    """
    check(arrays)
    view = seen(arrays, width, height)
    room = sky_room(view.world)

    def rows(y0: int, y1: int, layer: Array) -> None:
        count = width * (y1 - y0)
        directions, emitted, direct = np.zeros((3, count, 3))
        _kernel("fill_directions")(view.window, width, height, 0, y0, width, y1, directions)
        hit_class = np.zeros(count)
        origins = view.eye + far[y0:y1].reshape(-1, 1) * _across(view, directions, turn)
        _kernel("fill_rays")(view.world, origins, directions, room, emitted, direct, hit_class)
        layer[y0:y1, :, :3] = (emitted + direct).reshape(y1 - y0, width, 3)
        layer[y0:y1, :, 3] = hit_class.reshape(y1 - y0, width)

    return rows


def places_rows(arrays: RadiometricArrays, width: int, height: int) -> Rows:
    """Where the centre of a pixel looks, (h, w, 3); the eye itself where nothing is."""
    view = seen(arrays, width, height)

    def rows(y0: int, y1: int, layer: Array) -> None:
        directions = np.zeros((width * (y1 - y0), 3))
        _kernel("fill_directions")(view.window, width, height, 0, y0, width, y1, directions)
        found = hits(view.world, np.tile(view.eye, (len(directions), 1)), directions)
        places = np.where(found.shape[:, None] < 0, view.eye, found.place)
        layer[y0:y1] = places.reshape(y1 - y0, width, 3)

    return rows


def displaced_rays(
    arrays: RadiometricArrays, width: int, height: int, columns: Ints, rows: Ints, far: Array, turn: float
) -> tuple[Array, Array]:
    """Origins and unit directions (N, 3) of the rays of ``displaced_rows`` through some pixels alone."""
    view = seen(arrays, width, height)
    directions = np.zeros((len(columns), 3))
    for k, (column, row) in enumerate(zip(columns.tolist(), rows.tolist(), strict=True)):
        _kernel("fill_directions")(view.window, width, height, column, row, column + 1, row + 1, directions[k : k + 1])
    return view.eye + far[:, None] * _across(view, directions, turn), directions


def plane_apart(scene: RadiometricScene, plane: Plane, size: tuple[int, int], centre: bool) -> Array:
    """Largest coordinate about its point of the place where each ray would meet a plane alone, infinite if nowhere.

    (h, w) of rays through the centres of pixels, or (h + 1, w + 1) through their corners.
    """
    width, height = size
    arrays = radiometric_arrays(scene)
    forward, right, up = camera_window(arrays.camera, width, height)
    if centre:
        columns, rows = np.arange(width) + 0.5, np.arange(height) + 0.5
    else:
        columns, rows = np.arange(width + 1.0), np.arange(height + 1.0)
    x, y = 2.0 * columns / width - 1.0, 1.0 - 2.0 * rows / height
    rays = forward + x[None, :, None] * right + y[:, None, None] * up
    east, north, normal = (np.array(v) for v in frame_of(plane))
    from_point = np.array(arrays.camera.eye) - np.array(plane.point)
    with np.errstate(divide="ignore", invalid="ignore"):
        travel = -(from_point @ normal) / (rays @ normal)
        places = from_point + travel[..., None] * rays
        apart = np.maximum(np.abs(places @ east), np.abs(places @ north))
    return np.where((travel > 0.0) & np.isfinite(apart), apart, np.inf)


def _across(view: Seen, directions: Array, turn: float) -> Array:
    """Unit vectors at right angles to directions, ``turn`` away from the image's right."""
    right = view.window[1] - (directions @ view.window[1])[:, None] * directions
    right /= np.linalg.norm(right, axis=1, keepdims=True)
    return np.asarray(np.cos(turn) * right + np.sin(turn) * np.cross(directions, right))


@lru_cache(maxsize=3)
def _kernel(name: str) -> Any:
    """Compiled function of ``radiometric/tile.py``."""
    # the kernels only borrow arrays; counting references to them would cost more than the arithmetic
    return compiled(getattr(tile, name), _nrt=False)
