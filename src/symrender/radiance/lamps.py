"""Which pixels may see a light itself: emission that no path met is bounded by it."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from symrender.jit.records import chosen, copied
from symrender.radiometric.pieces import POLYGON, laid_pieces
from symrender.radiometric.world import camera_window
from symrender.scene.radiometric.arrays import (
    AREA,
    CONDUCTOR,
    CYLINDER,
    DIELECTRIC,
    ENVIRONMENT,
    EXTENDED,
    PLASTIC,
    SKY,
    SPHERE,
    RadiometricArrays,
)
from symrender.scene.radiometric.detail import CORNERS, EQUAL_AREA, Detail
from symrender.scene.radiometric.records import Light
from symrender.settings import Settings

Array = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]


@dataclass(frozen=True)
class Balls:
    """Bounding spheres of the parts of lights that have an area, M of them, and the radiance that they send."""

    centers: Array
    radii: Array
    radiance: Array


def lamps_of(arrays: RadiometricArrays) -> Balls:
    """Bounding spheres of what emits."""
    rows: list[tuple[Array, float, float]] = []
    for light in arrays.lights:
        if light.kind != AREA:
            continue
        # of that shape alone: a large mesh that sends nothing is not looked at
        own = np.arange(len(arrays.shapes)) == int(light.emitter)
        emitter = replace(arrays, shapes=chosen(arrays.shapes, own), frames=chosen(arrays.frames, own))
        for piece in laid_pieces(_bounded(emitter)):
            center, radius = np.array(piece.place), float(piece.radius)
            if piece.kind == POLYGON:
                corners = np.array(piece.corners).reshape(4, 3)[: int(piece.count)]
                center = corners.mean(axis=0)
                radius = float(np.linalg.norm(corners - center, axis=1).max())
            rows.append((center, radius, float(light.emitted.max())))
    return Balls(np.array([r[0] for r in rows]).reshape(-1, 3), *np.array([r[1:] for r in rows]).reshape(-1, 2).T)


def focused_radiance(arrays: RadiometricArrays) -> float:
    """Largest radiance that a path may carry from a light over what mirrors or bends it; 0 in a scene without such.

    Of light that is chosen by itself as well as by materials few paths carry more than most do. Lights choose no way
    over smooth surfaces and through glass, so there one path in many may bring all that a light sends.
    """
    used = [arrays.materials[int(shape.material)] for shape in arrays.shapes]
    if not any(each.kind == DIELECTRIC or (each.kind in (CONDUCTOR, PLASTIC) and each.alpha == 0.0) for each in used):
        return 0.0
    sent = [float(light.emitted.max()) for light in arrays.lights if light.kind in EXTENDED]
    return max(sent, default=0.0)


def _bounded(arrays: RadiometricArrays) -> RadiometricArrays:
    """The scene with the bounding sphere of every shape that has no pieces in its place."""
    shapes = copied(arrays.shapes)
    for shape in shapes:
        if shape.kind == CYLINDER:
            half = 0.5 * np.array(shape.normal)
            shape.kind, shape.radius = SPHERE, float(np.hypot(np.linalg.norm(half), shape.radius))
            shape.place[:] += half
    return replace(arrays, shapes=shapes)


def seen_radiance(arrays: RadiometricArrays, settings: Settings, columns: Ints, rows: Ints) -> Array:
    """Largest radiance that lights themselves may send through each of N pixels, 0 where none can be in sight.

    A pixel is taken for the cone about its support; a light for its bounding sphere, grown by what a lens and motion
    move it in the image.
    """
    found = np.zeros(len(columns))
    lamps, eye = lamps_of(arrays), np.array(arrays.camera.eye)
    width, height = settings.width, settings.height
    window = camera_window(arrays.camera, width, height)
    a, b = (2.0 * columns + 1.0) / width - 1.0, 1.0 - (2.0 * rows + 1.0) / height
    ways = window[0] + a[:, None] * window[1] + b[:, None] * window[2]
    reach = 2.0 * settings.reach * np.hypot(
        np.linalg.norm(window[1]) / width, np.linalg.norm(window[2]) / height
    )  # fmt: skip
    sizes = np.linalg.norm(ways, axis=1)
    # the directions of a pixel end on a plane at distance 1
    spread = np.arcsin(np.minimum(1.0, reach / sizes))
    exposure = arrays.exposure
    for light in arrays.lights:
        if light.kind == SKY:
            found[:] = float(light.emitted.max())
        if light.kind == ENVIRONMENT:
            # a ray through the lens is turned by no more than this
            lens = math.atan(exposure.aperture / max(float(exposure.focus), 1e-300)) if exposure.aperture else 0.0
            found[:] = _brightest(arrays.detail, light, ways / sizes[:, None], spread + lens)
    shapes = np.linalg.norm(exposure.shapes, axis=1).max(initial=0.0) if exposure.moves else 0.0
    drift = exposure.duration * (float(np.linalg.norm(exposure.camera)) + float(shapes)) if exposure.moves else 0.0
    if not len(lamps.radii):
        return found
    for center, radius, radiance in zip(lamps.centers, lamps.radii, lamps.radiance, strict=True):
        away = center - eye
        far = float(np.linalg.norm(away))
        grown = radius + drift + exposure.aperture * (1.0 + far / max(float(exposure.focus), 1e-300))
        half = math.asin(min(1.0, grown / far)) if far > grown else math.pi
        between = np.arccos(np.clip(ways @ away / (sizes * max(far, 1e-300)), -1.0, 1.0))
        found = np.where(between <= half + spread, np.maximum(found, radiance), found)
    return found


def _brightest(detail: Detail, light: Light, ways: Array, spread: Array) -> Array:
    """Largest radiance of an environment within cones about N unit directions, ``spread`` (N,) wide.

    Of every cone all pixels count that lie within its polar angles and azimuths, and their neighbours.
    """
    picture = detail.pictures[int(light.emitter)]
    wide, high, start = int(picture.wide), int(picture.high), int(picture.start)
    image = (detail.texels[start : start + wide * high] * light.emitted).max(axis=1).reshape(high, wide)
    if picture.grid == EQUAL_AREA:
        return np.full(len(ways), image.max())
    own = ways @ np.reshape(picture.turn, (3, 3)).T
    angle = np.arctan2(np.hypot(own[:, 0], own[:, 1]), own[:, 2])
    step = np.pi / (high - 1 if picture.grid == CORNERS else high)
    first = np.clip(np.floor((angle - spread) / step) - 1, 0, high - 1).astype(np.int64)
    last = np.clip(np.ceil((angle + spread) / step) + 1, 0, high - 1).astype(np.int64)
    # a cone about neither pole spans asin(sin spread / sin angle) to both sides
    room = np.minimum(angle, np.pi - angle)
    share = np.sin(spread) / np.maximum(np.sin(angle), 1e-300)
    half = np.where(spread < room, np.arcsin(np.minimum(1.0, share)), np.pi)
    column = np.arctan2(own[:, 0], own[:, 1]) / (2.0 * np.pi) * wide - 0.5
    reach = np.minimum(np.ceil(half / (2.0 * np.pi) * wide) + 1, wide // 2 + 1).astype(np.int64)
    middle = np.floor(column).astype(np.int64)
    found = np.zeros(len(ways))
    for k in range(len(ways)):
        columns = np.arange(middle[k] - reach[k], middle[k] + reach[k] + 2) % wide
        found[k] = image[first[k] : last[k] + 1][:, columns].max()
    return found
