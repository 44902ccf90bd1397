"""Means over pixels of a radiometric scene bound to a camera, with what each may be off by."""

from __future__ import annotations

import math
import threading
from collections.abc import Callable
from functools import lru_cache
from typing import Any, Final

import numpy as np

from symrender.errors import Unsupported
from symrender.jit.compiled import compiled
from symrender.jit.records import Table, copied, joined, table
from symrender.radiometric import tile
from symrender.radiometric.pixels import pixel, walls
from symrender.radiometric.pixels.pixel import Eye
from symrender.radiometric.pixels.records import Family, Wall, make_room
from symrender.radiometric.shaken import doubt, shaken
from symrender.radiometric.sky import sky_room
from symrender.radiometric.world import Array, Seen, World, seen
from symrender.scene.arrays import CHECKER, PLANE, SOLID, STRIPES
from symrender.scene.radiometric.arrays import (
    AREA,
    BECKMANN,
    CONDUCTOR,
    PHONG,
    POINT,
    SKY,
    SPHERE,
    RadiometricArrays,
)
from symrender.scene.radiometric.records import Material
from symrender.settings import Settings

MOST_WALLS: Final = 100_000
"""Walls of a scene that pixels are cut at, at most."""
MOST_TURNS: Final = 256
"""Fields about a sphere, at most."""
LEAST_EXPONENT: Final = 4.0
"""Of a phong material: below it the rim of its lobe is an edge that is not among the walls."""
_LOOKS: Final = 32
_NODES: Final = ((0.2113248654051871, 0.7886751345948129), (0.7886751345948129, 0.2113248654051871))
"""Where in a pixel roundings are looked at."""

Means = Callable[[int, int, int, int], tuple[Array, Array, Array, int]]
"""(emitted, direct, error, evaluations) of a tile."""


def check_pixels(arrays: RadiometricArrays) -> None:
    """Raise ``Unsupported`` where a pixel would be cut at something whose walls are not known."""
    for index, shape in enumerate(arrays.shapes):
        if shape.kind not in (PLANE, SPHERE):
            raise Unsupported(
                f"filter: box knows the walls of planes and spheres, shapes[{index}] is neither; centre knows all"
            )
        material = arrays.materials[int(shape.material)]
        edge = ""
        if material.kind == CONDUCTOR and material.density == BECKMANN and material.walter != 0.0:
            edge = "beckmann with g1: walter, which jumps"
        if material.kind == PHONG and material.exponent < LEAST_EXPONENT:
            edge = f"a phong exponent below {LEAST_EXPONENT:g}, whose lobe has a rim,"
        turned = shape.kind == SPHERE and material.texture in (CHECKER, STRIPES)
        if turned and material.cell * MOST_TURNS < 2.0:
            edge = f"more than {MOST_TURNS} fields about a sphere"
        if edge:
            raise Unsupported(
                f"filter: box has no walls yet for {edge} (the material of shapes[{index}]); centre needs none"
            )


def wall_tables(view: Seen) -> tuple[Table[Wall], Table[Family]]:
    """All walls that an eye sees, and the texture coordinates of planes; Unsupported where they are too many."""
    count = _kernel("list_walls")(view.world, view.eye, table(Wall, 0))
    if count > MOST_WALLS:
        raise Unsupported(f"filter: box cuts at {MOST_WALLS} walls at most, this scene has {count}; centre needs none")
    found, coordinates = table(Wall, count), table(Family, 2 * len(view.world.shapes))
    _kernel("list_walls")(view.world, view.eye, found)
    return found, coordinates[: _kernel("list_families")(view.world, view.eye, coordinates)]  # type: ignore[index]


def mean_world(arrays: RadiometricArrays) -> World:
    """The world with textures of planes replaced by their means; those of spheres stay."""
    count = len(arrays.materials)
    materials, shapes = joined(Material, [arrays.materials, copied(arrays.materials)]), copied(arrays.shapes)
    for index in range(count, 2 * count):
        material = materials[index]
        if material.texture != SOLID:
            middle = 0.5 * (material.bright + material.dark)
            material.texture, material.bright[:], material.dark[:] = SOLID, middle, middle
    for shape in shapes:
        if shape.kind == PLANE:
            shape.material += count
    return World(materials, shapes, arrays.frames, arrays.lights)


def delicate(arrays: RadiometricArrays) -> bool:
    """Whether nodes may miss what is smooth: something near a light, or a highlight."""
    glossy = any(arrays.materials[int(shape.material)].kind in (CONDUCTOR, PHONG) for shape in arrays.shapes)
    return glossy or any(light.kind in (POINT, AREA) for light in arrays.lights)


def prepare_means(arrays: RadiometricArrays, settings: Settings) -> Means:
    """What fills tiles with means over pixels, all of them equally weighted (``filter: box``).

    The error is what the rules state and what roundings do to single rays of the pixel.
    """
    check_pixels(arrays)
    width, height = settings.width, settings.height
    views = [seen(each, width, height) for each in shaken(arrays)]
    found, coordinates = wall_tables(views[0])
    bright = brightest(views[0])
    place = tuple(float(x) for x in views[0].eye)
    eye = Eye(views[0].world, mean_world(arrays), place, found, coordinates, bright, delicate(arrays))  # type: ignore[arg-type]
    kernel = _kernel("fill_pixels")
    own = threading.local()

    def means(x0: int, y0: int, x1: int, y1: int) -> tuple[Array, Array, Array, int]:
        if not hasattr(own, "room"):
            own.room = make_room(len(arrays.shapes)), np.zeros(max(1, len(found)), np.int64)
        shape = (y1 - y0, x1 - x0)
        emitted, direct, error = np.zeros((*shape, 3)), np.zeros((*shape, 3)), np.zeros(shape)
        spent = kernel(
            eye, views[0].window, width, height, x0, y0, x1, y1, *own.room, settings.tol, settings.budget, emitted,
            direct, error,
        )  # fmt: skip
        for x, y in _NODES:
            closed = [_rays(view, x0 + x + np.arange(x1 - x0), y0 + y + np.arange(y1 - y0), settings) for view in views]
            error += doubt(closed[0], closed[1:]) / len(_NODES)
        return emitted, direct, error, int(spent)

    return means


def _rays(view: Seen, columns: Array, rows: Array, settings: Settings) -> Array:
    """(rows, columns, 3) radiance along rays through places of an image, in pixels."""
    forward, right, up = view.window
    a, b = 2.0 * columns / settings.width - 1.0, 1.0 - 2.0 * rows / settings.height
    directions = (forward + a[None, :, None] * right + b[:, None, None] * up).reshape(-1, 3)
    directions /= np.sqrt((directions**2).sum(axis=1, keepdims=True))
    count = len(directions)
    room = np.zeros((count, 3)), np.zeros((count, 3)), np.zeros(count)
    eyes = np.tile(view.eye, (count, 1))
    _kernel("fill_rays")(view.world, eyes, np.ascontiguousarray(directions), *sky_room(view.world), *room)
    return (room[0] + room[1]).reshape(len(rows), len(columns), 3)


def brightest(view: Seen) -> float:
    """Largest finite radiance of a grid of rays through the image, and of all that emits."""
    side = (np.arange(_LOOKS) + 0.5) * (1.0 / _LOOKS)
    found = _rays(view, side, side, Settings(width=1, height=1))
    emitted = [float(light.emitted.max()) for light in view.world.lights if light.kind in (SKY, AREA)]
    return max([0.0, float(found[np.isfinite(found)].max(initial=0.0)), *emitted, math.ulp(1.0)])


@lru_cache(maxsize=5)
def _kernel(name: str) -> Any:
    """Compiled function that lists walls, sends rays or fills pixels."""
    module = next(each for each in (pixel, walls, tile) if hasattr(each, name) and name.startswith(("list", "fill")))
    # the kernels only borrow arrays; counting references to them would cost more than the arithmetic
    return compiled(getattr(module, name), _nrt=False)
