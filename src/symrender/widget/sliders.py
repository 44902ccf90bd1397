"""Sliders over the numbers of a scene: their ranges, and the picture at any of their places."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any, Final

from symrender.errors import OptionError
from symrender.images.image import Image
from symrender.render import render
from symrender.scene.nearest import did_you_mean
from symrender.scene.parameters import Parameter, parameters
from symrender.scene.scene import Scene
from symrender.settings import ESTIMATORS

Ranges = Sequence[str] | Mapping[str, tuple[float, float]]
"""Dotted names, each perhaps with the ends of its slider."""

_WIDE: Final = 1e4
"""Ranges wider than this are those of what is accepted, not of what is looked at."""
_EXPONENTS: Final = (1.0, 4096.0)
_HAND: Final = 0.06
"""Seconds a picture may take while a slider moves."""
_COARSEST: Final = 8


@dataclass(frozen=True)
class Slider:
    """One slider: a dotted name, where it stands and ends; ``log`` slides by factors."""

    name: str
    value: float
    low: float
    high: float
    unit: str
    log: bool
    description: str


def sliders_of(scene: Scene, names: Ranges = ()) -> tuple[Slider, ...]:
    """The sliders of ``names``, of the exponents of its lobes where none is given.

    OptionError names what is no number of the scene, or a range that does not hold its value.
    """
    known = {p.name: p for p in parameters(scene)}
    asked = list(names) or [name for name in known if name.endswith("lobe.exponent")]
    if not asked:
        raise OptionError("sliders: the scene has no lobe; name numbers of it, as symrender params lists them")
    made = []
    for name in asked:
        if name not in known:
            raise OptionError(f"sliders: {name[:80]!r} is no number of the scene{did_you_mean(name, known)}")
        low, high = names[name] if isinstance(names, Mapping) else _range(known[name])
        p = known[name]
        if not (p.low <= low <= p.value <= high <= p.high and low < high):
            raise OptionError(
                f"sliders: {name}: must run from low to high around {p.value:g} within [{p.low:g}, {p.high:g}], "
                f"got {low!r} to {high!r}"
            )
        log = low > 0 and high / low >= 100
        made.append(Slider(name, p.value, float(low), float(high), p.unit, log, p.description))
    return tuple(made)


def _range(p: Parameter) -> tuple[float, float]:
    """Ends for a slider of ``p``: its own range if that is narrow, else some about its value."""
    if p.name.endswith(".exponent"):
        return min(_EXPONENTS[0], p.value), max(_EXPONENTS[1], p.value)
    if p.high - p.low <= _WIDE:
        return p.low, p.high
    if p.low > 0:
        return max(p.low, p.value / 4), min(p.high, p.value * 4)
    reach = max(1.0, abs(p.value))
    return max(p.low, p.value - reach), min(p.high, p.value + reach)


class Drawing:
    """Draws ``scene`` at the places of its sliders; ``scene``, ``image`` are those last drawn."""

    def __init__(self, scene: Scene, names: Ranges, size: int, options: Mapping[str, Any]) -> None:
        self._base, self.size = scene, size
        self.sliders = sliders_of(scene, names)
        self._options = {**ESTIMATORS["best"], "numeric": "none", **options}
        self.scene = scene
        self.image: Image | None = None
        self._share = 2

    def plain(self) -> list[dict[str, Any]]:
        """The sliders as plain data."""
        return [asdict(slider) for slider in self.sliders]

    def draw(self, values: Mapping[str, float], *, moving: bool = False) -> Image:
        """The picture at ``values``; ``moving``, as coarse as keeps pace with a hand. SceneError as in ``replace``."""
        own = {slider.name for slider in self.sliders}
        if not set(values) <= own:
            raise OptionError(f"values: no slider is named {min(set(values) - own)[:80]!r}")
        scene = self._base.replace({name: float(value) for name, value in values.items()})
        side = max(1, self.size // (self._share if moving else 1))
        begun = time.perf_counter()
        pair = render(scene, size=side, **self._options)
        if moving:
            self._adapt(time.perf_counter() - begun)
        image = pair.symbolic if pair.symbolic is not None else pair.numeric
        assert image is not None
        self.scene, self.image = scene, image
        return image

    def _adapt(self, took: float) -> None:
        """Coarser at once where a picture lags behind the hand, finer where four times the pixels fit."""
        if took > _HAND:
            self._share = min(2 * self._share, _COARSEST)
        elif took < _HAND / 5:
            self._share = max(self._share // 2, 1)
