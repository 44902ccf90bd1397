"""Regions of an image, a population of pixels for every mechanism that a renderer may get wrong."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from symrender.execution.tiles import thread_count
from symrender.images.image import Image
from symrender.runtimes.glimpse import Rows, direct_rows, reflectance_rows
from symrender.scene.load import AnyScene
from symrender.scene.radiometric.arrays import FIRST_SHAPE, radiometric_arrays
from symrender.scene.radiometric.lights import Area, Environment, Light, Sky
from symrender.scene.radiometric.scene import RadiometricScene

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

FEWEST: Final = 16
"""Pixels below which a region is not tested by itself."""
_LIGHTS: Final = 8
"""Most lights whose shadow edges are found one by one."""
_WHOLE: Final = 1e-9
"""Share of a lamp's light that rounding may hide."""
_AT_ONCE: Final = 1 << 15
"""Pixels that a thread fills at a time."""


@dataclass(frozen=True, eq=False)
class Region:
    """Pixels of one population; ``tells`` says in words what a bias there speaks of."""

    name: str
    mask: Mask
    tells: str


def regions(scene: AnyScene, true: Image, threads: int = 0) -> tuple[Region, ...]:
    """Regions of the truth of ``scene``: all, every shape, silhouettes, shadow edges, texture lines, lobe walls.

    Those of fewer than ``FEWEST`` pixels are left out, and those that are another one again.
    """
    shape = (true.height, true.width)
    found = [Region("all", np.ones(shape, dtype=bool), "light units, exposure, energy")]
    classes = true.layers.get("hit_class")
    if classes is not None:
        names = _names(scene)
        for code in np.unique(classes):
            name = names[int(code)] if 0 <= int(code) < len(names) else f"class {int(code)}"
            found.append(Region(name, classes == code, f"what {name} is made of and how it is lit"))
        edges = _beside(classes)
        found.append(Region("silhouettes", edges, "the place of shapes, the camera, the pixel filter"))
        inner = ~edges
        found += [Region(r.name, r.mask & inner, r.tells) for r in _finer(scene, true, threads)]
    if "crossings" in true.layers:
        walls = true.layer("crossings")
        busy = walls > np.quantile(walls, 0.75)
        found.append(Region("busy lobes", busy, "what a lobe sees many edges of: glossy reflections of outlines"))
    return _distinct(found)


def _names(scene: AnyScene) -> list[str]:
    if isinstance(scene, RadiometricScene):
        return ["background", *(f"shapes.{shape.name}" for shape in scene.shapes)]
    spheres = [f"spheres.{sphere.name}" for sphere in scene.spheres]
    return ["background", "floor", *spheres, *(f"planes.{plane.name}" for plane in scene.planes)]


def _finer(scene: AnyScene, true: Image, threads: int) -> list[Region]:
    """Edges inside shapes: where a light begins to be hidden, where a texture changes."""
    if not isinstance(scene, RadiometricScene):
        return [Region("shading edges", _jumps(true.layer("direct")), "shadows, terminators and texture lines")]
    lamps = [light for light in scene.lights if not isinstance(light, Sky | Environment)]
    # what hides an environment hides a sky of one radiance alike
    skies = [
        Sky(name=light.name, radiance=(1.0, 1.0, 1.0)) if isinstance(light, Environment) else light
        for light in scene.lights
        if isinstance(light, Sky | Environment)
    ]
    size, found = (true.width, true.height), []
    bare = np.zeros((true.height, true.width, 3))
    for number, light in enumerate(lamps):
        alone = _direct(scene, [light], size, threads)
        bare += alone
        if number < _LIGHTS:
            edges = _beside(alone.max(axis=-1) > 0.0)
            found.append(Region(f"shadow edges of lights.{light.name}", edges, "visibility, ray offsets"))
        if number < _LIGHTS and isinstance(light, Area):
            partly = _partly_lit(scene, light, alone.max(axis=-1), true.layer("hit_class"), threads)
            found.append(
                Region(f"penumbra of lights.{light.name}", partly, "how much of a lamp is seen, how it is sampled")
            )
    if skies:
        bare += _direct(scene, skies, size, threads)
        found.append(
            Region("sky gradients", _beside(np.round(8.0 * _relative(bare))), "how the sky is hidden near contacts")
        )
    if any(hasattr(getattr(material, "reflectance", None), "cell") for material in scene.materials.values()):
        shown = filled(reflectance_rows(radiometric_arrays(scene), *size), size, threads)
        seen = (bare.sum(axis=-1) > 0.0) & (shown.sum(axis=-1) > 0.0)
        lines = _jumps(np.where(seen[..., None], shown, np.nan))
        found.append(Region("texture lines", lines, "texture coordinates, cells, half-cell offsets"))
    return found


def _partly_lit(scene: RadiometricScene, lamp: Area, light: Array, classes: Array, threads: int) -> Mask:
    """Pixels that get less of a lamp, ``light``, than they would with no other shape beside their own, but some."""
    height, width = light.shape
    partly = np.zeros(light.shape, dtype=bool)
    for code, shape in enumerate(scene.shapes, start=FIRST_SHAPE):
        here = (classes == code) & (light > 0.0)
        if shape.name == lamp.shape or not here.any():
            continue
        whole = _direct(scene, [lamp], (width, height), threads, (shape.name, lamp.shape)).max(axis=-1)
        partly |= here & (light < (1.0 - _WHOLE) * whole)
    return partly


def _direct(
    scene: RadiometricScene, lights: Sequence[Light], size: tuple[int, int], threads: int, names: Sequence[str] = ()
) -> Array:
    """Direct light of ``lights`` alone where every surface is of one white diffuse material, faces flat, (h, w, 3).

    Where ``names`` are given the scene has these shapes only.
    """
    data = scene.model_dump()
    data["shapes"] = [shape for shape in data["shapes"] if not names or shape["name"] in names]
    data["shapes"] = [
        shape | ({"shading_normals": "ignore"} if shape["type"] == "mesh" else {}) for shape in data["shapes"]
    ]
    white = {"type": "diffuse", "reflectance": 0.5}
    sided = {name: part.get("two_sided", False) for name, part in data["materials"].items()}
    data["materials"] = {name: white | {"two_sided": sided[name]} for name in data["materials"]}
    data |= {"bounces": 0, "lights": [light.model_dump() for light in lights]}
    return filled(direct_rows(radiometric_arrays(RadiometricScene.model_validate(data)), *size), size, threads)


def filled(rows: Rows, size: tuple[int, int], threads: int, last: int = 3) -> Array:
    """A layer (h, w, last) that ``rows`` fill, a few at a time so that Ctrl-C is heard."""
    width, height = size
    layer, step = np.zeros((height, width, last)), max(1, _AT_ONCE // width)
    with ThreadPoolExecutor(thread_count(threads)) as pool:
        started = [pool.submit(rows, y, min(y + step, height), layer) for y in range(0, height, step)]
        try:
            for one in started:
                one.result()
        finally:
            for one in started:
                one.cancel()
    return layer


def _relative(light: Array) -> Array:
    total = light.sum(axis=-1)
    return np.asarray(total / max(float(total.max()), 1e-300))


def _beside(labels: npt.NDArray[Any]) -> Mask:
    """Pixels one of whose eight neighbours has another label."""
    found = np.zeros(labels.shape, dtype=bool)
    height, width = labels.shape
    for dy, dx in ((0, 1), (1, 0), (1, 1), (1, -1)):
        rows, other = slice(dy, height), slice(0, height - dy)
        a = slice(max(dx, 0), width + min(dx, 0))
        b = slice(max(-dx, 0), width + min(-dx, 0))
        differ = labels[rows, a] != labels[other, b]
        found[rows, a] |= differ
        found[other, b] |= differ
    return found


def _jumps(values: Array) -> Mask:
    """Pixels that differ by a quarter from one beside them."""
    light = values.sum(axis=-1)
    found = np.zeros(light.shape, dtype=bool)
    for axis in (0, 1):
        a = np.take(light, range(1, light.shape[axis]), axis)
        b = np.take(light, range(light.shape[axis] - 1), axis)
        apart = np.abs(a - b) > 0.25 * np.maximum(np.abs(a), np.abs(b))
        before = [slice(None), slice(None)]
        after = [slice(None), slice(None)]
        before[axis], after[axis] = slice(0, -1), slice(1, None)
        found[tuple(before)] |= apart
        found[tuple(after)] |= apart
    return found


def _distinct(found: list[Region]) -> tuple[Region, ...]:
    kept: list[Region] = []
    for region in found:
        if region.mask.sum() >= min(FEWEST, region.mask.size) and not any(
            np.array_equal(region.mask, other.mask) for other in kept
        ):
            kept.append(region)
    return tuple(kept)
