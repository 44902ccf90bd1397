"""Regions of an image, a population of pixels for every mechanism that a renderer may get wrong."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from symrender.images.image import Image
from symrender.scene.load import AnyScene, load_any
from symrender.scene.radiometric.lights import Sky
from symrender.scene.radiometric.scene import RadiometricScene
from symrender.truth import truth

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

FEWEST: Final = 16
"""Pixels below which a region is not tested by itself."""
_LIGHTS: Final = 8
"""Most lights whose shadow edges are found one by one."""
_LOOSE: Final = 1e-3


@dataclass(frozen=True, eq=False)
class Region:
    """Pixels of one population; ``tells`` says in words what a bias there speaks of."""

    name: str
    mask: Mask
    tells: str


def regions(scene: AnyScene, true: Image) -> tuple[Region, ...]:
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
        found += [Region(r.name, r.mask & inner, r.tells) for r in _finer(scene, true)]
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


def _finer(scene: AnyScene, true: Image) -> list[Region]:
    """Edges inside shapes: where a light begins to be hidden, where a texture changes."""
    if not isinstance(scene, RadiometricScene):
        return [Region("shading edges", _jumps(true.layer("direct")), "shadows, terminators and texture lines")]
    size, found = (true.width, true.height), []
    plain = load_any(_plain(scene))
    lit = [light for light in scene.lights if not isinstance(light, Sky)][:_LIGHTS]
    for light in lit:
        alone = _direct(load_any(_plain(scene) | {"lights": [light.model_dump()]}), size)
        found.append(
            Region(f"shadow edges of lights.{light.name}", _beside(alone.max(axis=-1) > 0.0), "visibility, ray offsets")
        )
    if any(isinstance(light, Sky) for light in scene.lights):
        near = _beside(np.round(8.0 * _relative(_direct(plain, size))))
        found.append(Region("sky gradients", near, "how the sky is hidden near contacts"))
    textures = [getattr(material, "reflectance", None) for material in scene.materials.values()]
    if any(hasattr(texture, "cell") for texture in textures):
        # light over that of one white material, on bare daylight: the texture alone, times what lobes do to it
        shown, bare = (_direct(load_any(data), size).sum(axis=-1) for data in (_textures(scene), _plain(scene)))
        ratio = np.where((bare > 0.0) & (shown > 0.0), shown / np.where(bare > 0.0, bare, 1.0), np.nan)
        found.append(Region("texture lines", _jumps(ratio[..., None]), "texture coordinates, cells, half-cell offsets"))
    return found


def _textures(scene: RadiometricScene) -> dict[str, Any]:
    """The scene without bounces, every surface diffuse with its own reflectance."""
    data = _plain(scene)
    for name, part in scene.model_dump()["materials"].items():
        data["materials"][name] = data["materials"][name] | {"reflectance": part["reflectance"]}
    return data


def _plain(scene: RadiometricScene) -> dict[str, Any]:
    """The scene without bounces, every surface of one white diffuse material."""
    data = scene.model_dump()
    white = {"type": "diffuse", "reflectance": 0.5}
    sided = {name: part.get("two_sided", False) for name, part in data["materials"].items()}
    data["materials"] = {name: white | {"two_sided": sided[name]} for name in data["materials"]}
    return data | {"bounces": 0}


def _direct(scene: AnyScene, size: tuple[int, int]) -> Array:
    return np.asarray(truth(scene, size=size, tol=_LOOSE).layer("direct"))


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
