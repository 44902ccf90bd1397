from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from symrender.numeric.pipeline import prepare
from symrender.scene.arrays import Array, scene_arrays
from symrender.scene.load import load
from symrender.scene.scene import Scene
from symrender.settings import Settings

Layers = dict[str, Array]
Render = Callable[..., Layers]


def render(scene: Scene, width: int = 64, height: int | None = None, tile: int = 0, **settings: Any) -> Layers:
    """All layers of a scene rendered in square tiles (0: one tile), NaN wherever the kernel left them alone."""
    height = width if height is None else height
    layers = {name: np.full((height, width, 3), np.nan) for name in ("radiance", "direct", "gloss")}
    layers["hit_class"] = np.full((height, width), np.nan)
    kernel = prepare(scene_arrays(scene), Settings(width=width, height=height, **settings))
    step = tile or max(width, height)
    spent = 0
    for y in range(0, height, step):
        for x in range(0, width, step):
            spent += kernel(x, y, min(x + step, width), min(y + step, height), layers)
    layers["evaluations"] = np.array(spent)
    return layers


def with_parts(scene: Scene, **parts: Any) -> Scene:
    """The scene with top-level parts replaced by plain data, validated again."""
    return Scene.model_validate(scene.model_dump() | parts, strict=False)


@pytest.fixture(scope="session")
def chapter8() -> Scene:
    return load("chapter8")
