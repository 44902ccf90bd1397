"""What would turn the truth into what was measured: a parameter moved, or a mistake that renderers are known to make.

A parameter's image of change is the exact derivative where ``gradient`` has it, else a central difference of two
truths; a mutation is an image that a known mistake would make.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import chain
from time import perf_counter
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from symrender.audit.distributions import critical
from symrender.audit.evidence import Evidence
from symrender.audit.regions import Region
from symrender.audit.verdict import Explanation
from symrender.errors import SymrenderError, Unsupported
from symrender.gradient import gradient
from symrender.images.srgb import encode_srgb
from symrender.scene.load import AnyScene, load_any
from symrender.scene.parameters import get, parameters
from symrender.scene.radiometric.scene import RadiometricScene
from symrender.truth import truth

Array = npt.NDArray[np.float64]

MOST: Final = 24
"""Most parameters tried where none are named."""
SHOWN: Final = 6
"""Most explanations kept."""
_MOST_OF_IT: Final = 0.8
"""Share of the misfit below which nothing is called consistent: less is left by chance where little is off."""
_STEP: Final = 1e-2
_MATERIAL: Final = ("materials.", "lights.", "floor.lobe.", "floor.material.")


def attribution(
    seen: Evidence, regions: Sequence[Region], scene: AnyScene | None, layers: dict[str, Array], wrt: Sequence[str],
    tol: float, seconds: float,
) -> tuple[Explanation, ...]:  # fmt: skip
    """Explanations of the misfit, those that leave no region off first, then by how much they explain.

    What needs further truths of the scene is tried for ``seconds``: none is begun that would end later if it took as
    long as the longest before it. Parameters of ``wrt`` are tried all the same.

    ``layers`` are those of the truth, ``wrt`` the parameters tried (none: real numbers of materials and lights).
    Without a ``scene`` only the layers themselves are tried, by factors and as mistakes of an image.
    """
    fit = Fit(seen, regions)
    if fit.before <= 0.0:
        return ()
    found = [fit.mutation(name, image) for name, image in image_mutations(layers)]
    found.append(fit.parameter("the factor of the whole image", 1.0, layers["radiance"], "by least squares"))
    if len(seen.channels) > 1:
        for c, channel in enumerate(("red", "green", "blue")):
            alone = np.zeros_like(layers["radiance"])
            alone[..., c] = layers["radiance"][..., c]
            found.append(fit.parameter(f"the factor of {channel}", 1.0, alone, "by least squares"))
    parts = [part for part in ("emitted", "direct", "indirect", "gloss") if part in layers and layers[part].any()]
    if len(parts) > 1:
        found += [fit.parameter(f"the factor of {p} light", 1.0, layers[p], "by least squares") for p in parts]
    size = (seen.truth.shape[1], seen.truth.shape[0])
    if scene is not None and wrt:
        found += list(_parameters(fit, scene, list(wrt), size, tol, layers["radiance"]))
    later: Iterator[Explanation] = iter(())
    if isinstance(scene, RadiometricScene):
        later = (fit.mutation(name, image) for name, image in scene_mutations(scene, size, tol))
    if scene is not None and not wrt:
        later = chain(later, _parameters(fit, scene, [], size, tol, layers["radiance"]))
    found += list(_within(later, seconds))
    useful = [e for e in found if e.explains > 0.02]
    useful.sort(key=lambda e: (not e.consistent, -e.explains))
    return tuple(useful[:SHOWN])


def _within(found: Iterator[Explanation], seconds: float) -> Iterator[Explanation]:
    """What is found as long as another one, of the time of the longest, ends within so many seconds."""
    begun, longest = perf_counter(), 0.0
    while perf_counter() - begun + longest < seconds:
        before = perf_counter()
        one = next(found, None)
        if one is None:
            return
        longest = max(longest, perf_counter() - before)
        yield one


class Fit:
    """Weighted least squares of the misfit on one image at a time."""

    def __init__(self, seen: Evidence, regions: Sequence[Region]) -> None:
        self.seen, self.regions = seen, regions
        # not a pixel's own variance, which rises and falls with its luck
        sure = seen.pooled + seen.allowance**2
        self.weights = np.where(seen.usable[..., None] & (sure > 0), 1.0 / np.maximum(sure, 1e-300), 0.0)
        self.before = self.off(seen.difference)

    def mutation(self, name: str, radiance: Array) -> Explanation:
        """How well the image ``radiance`` explains what was measured."""
        left = self.seen.difference + self.seen.truth - self.seen.measured.of(radiance)
        share = 1.0 - self.off(left) / self.before
        how = "an image that this mistake would make"
        return Explanation(f"the renderer had: {name}", share, self.consistent(left, share), how=how)

    def parameter(self, name: str, current: float, slope: Array, how: str) -> Explanation:
        """The change of one parameter that explains most of the weighted misfit; ``slope`` is the derivative."""
        g = self.seen.measured.of(np.where(np.isfinite(slope), slope, 0.0))
        weights = self.weights * np.isfinite(slope)
        norm = float((weights * g * g).sum())
        if norm <= 0.0:
            return Explanation(name, 0.0, False, current, current, 0.0, how)
        step = float((weights * g * self.seen.difference).sum()) / norm
        # channels of a pixel share their samples: their errors add
        v = self.seen.pooled
        error = float(np.sqrt(((weights * np.abs(g) * np.sqrt(v)).sum(axis=-1) ** 2).sum() * self.seen.spread)) / norm
        left = self.seen.difference - step * g
        share = 1.0 - self.off(left) / self.before
        return Explanation(name, share, self.consistent(left, share), current, current + step, error, how)

    def off(self, left: Array) -> float:
        """Sum over regions and channels of the squared z values of the mean of ``left``."""
        total = 0.0
        for region in self.regions:
            mask = region.mask & self.seen.usable
            sure = self.seen.spread * self.seen.variance[mask].sum(axis=0) + self.seen.allowance[mask].sum(axis=0) ** 2
            total += float((left[mask].sum(axis=0) ** 2 / np.maximum(sure, 1e-300)).sum())
        return total

    def consistent(self, left: Array, share: float) -> bool:
        """Whether no region is off where ``left`` remains, and the ``share`` explained is most of the misfit."""
        if share < _MOST_OF_IT:
            return False
        edge = critical(0.01 / max(3 * len(self.regions), 1))
        for region in self.regions:
            mask = region.mask & self.seen.usable
            total = np.abs(left[mask].sum(axis=0)) - self.seen.allowance[mask].sum(axis=0)
            error = np.sqrt(self.seen.spread * self.seen.variance[mask].sum(axis=0))
            if (total > edge * error).any():
                return False
        return True


def image_mutations(layers: dict[str, Array]) -> Iterator[tuple[str, Array]]:
    """Images that mistakes of units, colour, order and layers would make of the truth's own layers."""
    true = layers["radiance"]
    for name, factor in (("a factor pi", np.pi), ("a factor 1/pi", 1 / np.pi), ("a factor 2", 2.0), ("a half", 0.5)):
        yield name, true * factor
    yield "sRGB encoding instead of linear light", encode_srgb(true).astype(np.float64) / 255.0
    yield "values clipped at 1", np.minimum(true, 1.0)
    yield "rows from bottom to top", true[::-1]
    yield "columns from right to left", true[:, ::-1]
    yield "red and blue exchanged", true[..., ::-1]
    for axis, name in ((0, "row"), (1, "column")):
        for step in (-1, 1):
            yield f"the image moved by {step:+d} {name}", np.roll(true, step, axis)
    for part in ("emitted", "direct", "indirect"):
        if part in layers and layers[part].any():
            yield f"no {part} light", true - layers[part]
            yield f"{part} light twice", true + layers[part]


def scene_mutations(scene: RadiometricScene, size: tuple[int, int], tol: float) -> Iterator[tuple[str, Array]]:
    """Truths with the roughness, masking, texture or lights mistaken in ways that renderers are known for."""
    changes: list[tuple[str, Callable[[dict[str, Any]], None]]] = []
    data = scene.model_dump()
    for name, part in data["materials"].items():
        changes += [
            (f"{words} of materials.{name}", _changed("materials", name, new)) for words, new in _mistaken(part)
        ]
    for index, light in enumerate(data["lights"][:8]):
        changes.append((f"no lights.{light['name']}", _without(index)))
    for words, change in changes[:MOST]:
        other = scene.model_dump()
        change(other)
        try:
            yield words, truth(load_any(other), size=size, tol=tol).radiance
        except SymrenderError:
            # a mistake that makes no scene is none that a renderer of this scene made
            continue


def _mistaken(part: dict[str, Any]) -> Iterator[tuple[str, dict[str, Any]]]:
    """Known mistakes of one material, and the fields they change."""
    if "alpha" in part:
        yield "alpha squared", {"alpha": part["alpha"] ** 2}
        yield "the square root of alpha", {"alpha": part["alpha"] ** 0.5}
        other = {"separable": "correlated", "correlated": "separable"}[part["masking"]]
        yield f"masking {other}", {"masking": other}
        yield "eta and k exchanged", {"eta": part["k"], "k": part["eta"]}
        if part["distribution"] == "beckmann":
            other = {"exact": "walter", "walter": "exact"}[part["g1"] or "exact"]
            yield f"g1 {other}", {"g1": other}
        wrong = {"ggx": "beckmann", "beckmann": "ggx"}[part["distribution"]]
        yield f"distribution {wrong}", {"distribution": wrong, "g1": "exact" if wrong == "beckmann" else None}
    texture = part.get("reflectance")
    if isinstance(texture, dict) and "cell" in texture:
        yield "cells of twice the size", {"reflectance": texture | {"cell": 2 * texture["cell"]}}
        yield "cells of half the size", {"reflectance": texture | {"cell": texture["cell"] / 2}}
        swapped = texture | {"bright": texture["dark"], "dark": texture["bright"]}
        yield "bright and dark exchanged", {"reflectance": swapped}


def _changed(field: str, name: str, new: dict[str, Any]) -> Callable[[dict[str, Any]], None]:
    def change(data: dict[str, Any]) -> None:
        data[field][name] = {key: value for key, value in (data[field][name] | new).items() if value is not None}

    return change


def _without(index: int) -> Callable[[dict[str, Any]], None]:
    def change(data: dict[str, Any]) -> None:
        data["lights"] = [light for k, light in enumerate(data["lights"]) if k != index]

    return change


def _parameters(
    fit: Fit, scene: AnyScene, wrt: list[str], size: tuple[int, int], tol: float, here: Array
) -> Iterator[Explanation]:
    """Every named parameter by itself; where none are named, colours and numbers of materials and lights."""
    if wrt:
        for name in wrt:
            slope, how = _slope(scene, name, size, tol)
            yield fit.parameter(name, float(get(scene, name)), slope, how)
        return
    names = [p.name for p in parameters(scene) if p.name.startswith(_MATERIAL)]
    colours = dict.fromkeys(name.removesuffix(".r") for name in names if name.endswith(".r"))
    single = [name for name in names if not name.endswith((".r", ".g", ".b"))]
    for name in [*colours, *single][:MOST]:
        try:
            if name in colours:
                slope = _scaled_slope(scene, name, size, tol, here)
                yield fit.parameter(f"the factor of {name}", 1.0, slope, "by a difference of two truths")
            else:
                slope, how = _slope(scene, name, size, tol)
                yield fit.parameter(name, float(get(scene, name)), slope, how)
        except SymrenderError:
            # not every number can be moved, nor has every scene derivatives
            continue


def _scaled_slope(scene: AnyScene, name: str, size: tuple[int, int], tol: float, here: Array) -> Array:
    """Derivative of the radiance ``here`` in a factor of the colour ``name``, nearly linear, so one-sided."""
    changes = {f"{name}.{c}": float(get(scene, f"{name}.{c}")) * (1.0 - _STEP) for c in "rgb"}
    return np.asarray((here - truth(scene.replace(changes), size=size, tol=tol).radiance) / _STEP)


def _slope(scene: AnyScene, name: str, size: tuple[int, int], tol: float) -> tuple[Array, str]:
    """Derivative of the radiance (NaN where there is none, or a shape changes) and how it was had."""
    try:
        made = gradient(scene, [name], size=size, tol=max(tol, 1e-6))[name]
    except Unsupported:
        if not isinstance(scene, RadiometricScene):
            raise
        return _difference(scene, name, size, tol), "by a central difference of two truths"
    slope = made.radiance.copy()
    slope[~np.isfinite(made.layer("error"))] = np.nan
    return slope, "by its exact derivative"


def _difference(scene: RadiometricScene, name: str, size: tuple[int, int], tol: float) -> Array:
    """Central difference of two truths, for what has a truth and no derivative."""
    value = float(get(scene, name))
    step = _STEP * max(abs(value), 0.1)
    low, high = (truth(scene.replace({name: value + s}), size=size, tol=tol) for s in (-step, step))
    slope = (high.radiance - low.radiance) / (2.0 * step)
    slope[high.layer("hit_class") != low.layer("hit_class")] = np.nan
    return np.asarray(slope)
