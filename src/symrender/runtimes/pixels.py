"""Means over pixels of a radiometric scene bound to a camera, with what each may be off by."""

from __future__ import annotations

import math
import threading
from collections.abc import Callable
from functools import lru_cache
from typing import Any, Final, NamedTuple

import numpy as np
import numpy.typing as npt

from symrender.errors import Unsupported
from symrender.jit.compiled import compiled
from symrender.jit.records import Table, copied, joined, table
from symrender.radiometric import tile
from symrender.radiometric.pixels import images, walls
from symrender.radiometric.pixels.cells import BOX, GAUSSIAN, MITCHELL, TENT, Eye
from symrender.radiometric.pixels.records import Family, Section, Wall, make_queue, make_room
from symrender.radiometric.shaken import doubt, shaken
from symrender.radiometric.sky import sky_room
from symrender.radiometric.vectors import Array
from symrender.radiometric.world import Seen, World, seen_all
from symrender.scene.arrays import CHECKER, MARBLE, PLANE, SOLID, STRIPES
from symrender.scene.radiometric.arrays import (
    AREA,
    BECKMANN,
    CONDUCTOR,
    DIFFUSE,
    MESH,
    PHONG,
    POINT,
    SKY,
    SPHERE,
    SPOT,
    RadiometricArrays,
)
from symrender.scene.radiometric.records import Material
from symrender.settings import Settings

DOMAINS: Final = {"centre": BOX, "box": BOX, "tent": TENT, "gaussian": GAUSSIAN, "mitchell": MITCHELL}
"""What places of a pixel weigh, by the filter's name."""
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


def check_pixels(arrays: RadiometricArrays, asked: str = "filter: box") -> None:
    """Raise ``Unsupported`` where a pixel would be cut at something whose walls are not known."""
    extended = any(light.kind in (SKY, AREA) for light in arrays.lights)
    for index, shape in enumerate(arrays.shapes):
        if extended and shape.kind not in (PLANE, SPHERE):
            raise Unsupported(
                f"{asked} has no walls yet for a sky or an area light beside polygons and disks (shapes[{index}]); "
                "for points, spots and directions it has, and centre needs none"
            )
        if shape.kind == MESH:
            raise Unsupported(f"filter: box has no walls yet for a mesh (shapes[{index}]); centre needs none")
        material = arrays.materials[int(shape.material)]
        edge = ""
        if extended and material.kind != DIFFUSE:
            edge = "a sky or an area light over a conductor or a phong material"
        if material.kind == CONDUCTOR and material.density == BECKMANN and material.walter != 0.0:
            edge = "beckmann with g1: walter, which jumps"
        if material.kind == PHONG and material.exponent < LEAST_EXPONENT:
            edge = f"a phong exponent below {LEAST_EXPONENT:g}, whose lobe has a rim,"
        turned = shape.kind == SPHERE and material.texture in (CHECKER, STRIPES)
        if turned and material.cell * MOST_TURNS < 2.0:
            edge = f"more than {MOST_TURNS} fields about a sphere"
        if edge:
            raise Unsupported(
                f"{asked} has no walls yet for {edge} (the material of shapes[{index}]); centre needs none"
            )


def wall_tables(view: Seen) -> tuple[Table[Wall], Table[Family]]:
    """All walls that an eye sees, and the texture coordinates of planes; Unsupported where they are too many."""
    count = _kernel("list_walls")(view.world, view.eye, table(Wall, 0))
    if count > MOST_WALLS:
        raise Unsupported(f"filter: box cuts at {MOST_WALLS} walls at most, this scene has {count}; centre needs none")
    found = table(Wall, count)
    _kernel("list_walls")(view.world, view.eye, found)
    return found, families_of(view)


def families_of(view: Seen) -> Table[Family]:
    """The texture coordinates of planes."""
    return families_at(view.world, view.eye)


def families_at(world: World, eye: Array) -> Table[Family]:
    """The texture coordinates of planes as an eye sees them."""
    coordinates = table(Family, _kernel("list_families")(world, eye, table(Family, 0)))
    _kernel("list_families")(world, eye, coordinates)
    return coordinates


def series_walls(world: World, eye: Array, sections: Table[Section]) -> Table[Wall]:
    """The walls of a scene in units of the series, at which textures of spheres are cut in ``sections``."""
    found = table(Wall, _kernel("list_series_walls")(world, eye, sections, table(Wall, 0)))
    _kernel("list_series_walls")(world, eye, sections, found)
    return found


class Met(NamedTuple):
    """Where N rays meet pieces: ``shape`` (N,), -1 for none, unit ``normal`` towards the ray, ``behind`` 0 or 1."""

    shape: npt.NDArray[np.int64]
    place: Array
    normal: Array
    behind: Array


def shapes_met(world: World, origins: Array, directions: Array) -> Met:
    """Where unit rays meet the shapes of a world."""
    count = len(origins)
    shape, behind, unused = np.zeros(count), np.zeros(count), np.zeros((count, 3))
    place, normal = np.zeros((count, 3)), np.zeros((count, 3))
    _kernel("fill_hits")(world, origins, directions, shape, place, normal, unused, behind)
    return Met(shape.astype(np.int64), place, normal, behind)


def seen_walls(view: Seen) -> Table[Wall]:
    """The walls at which what is seen changes, whatever shines on it."""
    found = table(Wall, _kernel("list_seen_walls")(view.world, view.eye, table(Wall, 0)))
    _kernel("list_seen_walls")(view.world, view.eye, found)
    return found


def mean_world(world: World) -> World:
    """The world with textures of what is flat replaced by their means; those of spheres stay."""
    count = len(world.materials)
    materials, pieces = joined(Material, [world.materials, copied(world.materials)]), copied(world.pieces)
    for index in range(count, 2 * count):
        material = materials[index]
        if material.texture != SOLID:
            middle = 0.5 * (material.bright + material.dark)
            material.texture, material.bright[:], material.dark[:] = SOLID, middle, middle
    for piece in pieces:
        if piece.kind != SPHERE:
            piece.material += count
    return world._replace(materials=materials, pieces=pieces)


def delicate(arrays: RadiometricArrays) -> bool:
    """Whether nodes may miss what is smooth: something near a light, a highlight, or veins."""
    held = [arrays.materials[int(shape.material)] for shape in arrays.shapes]
    glossy = any(each.kind in (CONDUCTOR, PHONG) or each.texture == MARBLE for each in held)
    return glossy or any(light.kind in (POINT, SPOT, AREA) for light in arrays.lights)


def eye_of(arrays: RadiometricArrays, view: Seen, domain: int) -> Eye:
    """What is the same for all pixels of a view; ``domain`` is what their places weigh."""
    found, coordinates = wall_tables(view)
    bright = brightest(view)
    place = (float(view.eye[0]), float(view.eye[1]), float(view.eye[2]))
    return Eye(view.world, mean_world(view.world), place, found, coordinates, bright, delicate(arrays), domain)


def prepare_means(arrays: RadiometricArrays, settings: Settings) -> Means:
    """What fills tiles with means over pixels, weighed as ``filter`` says.

    The error is what the rules state and what roundings do to single rays of the pixel.
    """
    check_pixels(arrays, f"filter: {settings.filter}")
    width, height = settings.width, settings.height
    views = seen_all(shaken(arrays), width, height)
    eye = eye_of(arrays, views[0], DOMAINS[settings.filter])
    kernel = _kernel("fill_pixels")
    own = threading.local()

    def means(x0: int, y0: int, x1: int, y1: int) -> tuple[Array, Array, Array, int]:
        if not hasattr(own, "room"):
            queue = make_queue(0) if len(views[0].world.terms) else None
            own.room = make_room(views[0].world, queue is not None), np.zeros(max(1, len(eye.walls)), np.int64), queue
        shape = (y1 - y0, x1 - x0)
        emitted, direct, error = np.zeros((*shape, 3)), np.zeros((*shape, 3)), np.zeros(shape)
        spent = kernel(
            eye, views[0].window, width, height, settings.reach, x0, y0, x1, y1, *own.room, settings.tol,
            settings.budget, emitted, direct, error,
        )  # fmt: skip
        for x, y in _NODES:
            columns: Array = x + np.arange(x0, x1, dtype=np.float64)
            rows: Array = y + np.arange(y0, y1, dtype=np.float64)
            sent = (rays_from(view.world, view.eye, _directions(view, columns, rows, width, height)) for view in views)
            closed = [each.reshape(*shape, 3) for each in sent]
            error += doubt(closed[0], closed[1:]) / len(_NODES)
        # over a bump that is so steep that its normal is no number
        lost = ~(np.isfinite(error) & np.isfinite(emitted + direct).all(axis=2))
        emitted[lost], direct[lost], error[lost] = 0.0, 0.0, np.inf
        return emitted, direct, error, int(spent)

    return means


def _directions(view: Seen, columns: Array, rows: Array, width: int, height: int) -> Array:
    """(rows x columns, 3) unit directions through places of an image, in pixels."""
    forward, right, up = view.window
    a, b = 2.0 * columns / width - 1.0, 1.0 - 2.0 * rows / height
    found = (forward + a[None, :, None] * right + b[:, None, None] * up).reshape(-1, 3)
    found /= np.sqrt((found**2).sum(axis=1, keepdims=True))
    return np.ascontiguousarray(found)


def rays_from(world: World, eye: Array, directions: Array) -> Array:
    """(N, 3) radiance along unit rays from a place."""
    count = len(directions)
    room = np.zeros((count, 3)), np.zeros((count, 3)), np.zeros(count)
    _kernel("fill_rays")(world, np.tile(eye, (count, 1)), directions, sky_room(world), *room)
    return np.asarray(room[0] + room[1])


def brightest(view: Seen) -> float:
    """A radiance of the scene: the largest of a grid of rays, of what emits, of what would arrive where rays end.

    Light arrives there as if nothing hid it, so that an image black at all these rays is not taken to be black.
    """
    side: Array = (np.arange(_LOOKS, dtype=np.float64) + 0.5) / _LOOKS
    directions = _directions(view, side, side, 1, 1)
    count = len(directions)
    shape, place = np.zeros(count), np.zeros((count, 3))
    unused = np.zeros((count, 3)), np.zeros((count, 3)), np.zeros(count)
    _kernel("fill_hits")(view.world, np.tile(view.eye, (count, 1)), directions, shape, place, *unused)
    met, found = place[shape >= 0], [rays_from(view.world, view.eye, directions)]
    for light in view.world.lights:
        share = np.ones((1, 1))
        if light.kind in (POINT, SPOT) and len(met):
            share = 1.0 / ((met - light.place) ** 2).sum(axis=1, keepdims=True)
        found.append(share * light.emitted)
    return max(float(each[np.isfinite(each)].max(initial=math.ulp(1.0))) for each in found)


@lru_cache(maxsize=8)
def _kernel(name: str) -> Any:
    """Compiled function that lists walls, sends rays or fills pixels."""
    module = next(each for each in (images, walls, tile) if hasattr(each, name) and name.startswith(("list", "fill")))
    # the kernels only borrow arrays; counting references to them would cost more than the arithmetic
    return compiled(getattr(module, name), _nrt=False)
