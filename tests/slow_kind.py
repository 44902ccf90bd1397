"""A kind of image whose kernel is plain Python: exact, uneven, and as slow as its scene's seed asks for."""

from __future__ import annotations

import time
from collections.abc import Mapping

import numpy as np

from symrender.execution import jobs
from symrender.execution.jobs import Job, TileKernel
from symrender.scene.arrays import Array, SceneArrays
from symrender.settings import Settings


def prepare(arrays: SceneArrays, settings: Settings) -> TileKernel:
    """Every layer a function of the place; ``seed`` is the milliseconds a tile takes."""

    def kernel(x0: int, y0: int, x1: int, y1: int, layers: Mapping[str, Array]) -> int:
        if x1 > x0:
            time.sleep(settings.seed / 1000)
        j, i = np.mgrid[y0:y1, x0:x1]
        layers["radiance"][y0:y1, x0:x1] = np.sin(i * 1.1 + j * 7.3)[..., None] * (1.0, 2.0, 3.0)
        layers["hit_class"][y0:y1, x0:x1] = i + j
        return (x1 - x0) * (y1 - y0) * 3

    return kernel


def install() -> None:
    """Make the kind ``slow`` known in this process."""
    jobs.KINDS["slow"] = jobs.Kind("slow_kind", (("radiance", 3), ("hit_class", 1)))  # type: ignore[index]


def slow_job(width: int = 24, height: int = 18, milliseconds: int = 0, **settings: object) -> Job:
    """A job of that kind."""
    from symrender.scene.load import load

    install()
    chosen = Settings(width=width, height=height, seed=milliseconds, **settings)  # type: ignore[arg-type]
    return Job.of("slow", load("chapter8"), chosen)
