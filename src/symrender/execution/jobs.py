"""The unit of work: one tile of one image, a pure function of scene, settings, kind and place.

A ``Job`` is all an image depends on, small enough to be sent anywhere; ``prepared(job)`` is its kernel, compiled once a
process; ``compute(job, tile)`` is the unit. Threads, processes and machines run the same units, so they give the same
bytes. A new kind of image is one more entry of ``KINDS``: a module with ``prepare(arrays, settings) -> TileKernel``
and the layers that kernel fills.
"""

from __future__ import annotations

import hashlib
import importlib
import time
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Any, Final

import numpy as np

from symrender import version
from symrender.limits import MAX_ITEMS
from symrender.scene.arrays import Array, SceneArrays, scene_arrays
from symrender.scene.dump import to_yaml
from symrender.scene.load import AnyScene, parse_any
from symrender.scene.moves import Move
from symrender.scene.radiometric.arrays import RadiometricArrays, radiometric_arrays
from symrender.scene.radiometric.scene import RadiometricScene
from symrender.settings import Settings

Tile = tuple[int, int, int, int]
"""(x0, y0, x1, y1): columns x0:x1 of rows y0:y1."""
TileKernel = Callable[[int, int, int, int, Mapping[str, Array]], int]
"""``kernel(x0, y0, x1, y1, layers)`` fills that tile of the full image's layers; returns the evaluations it made."""

CHANGES_NO_BYTE: Final = ("threads", "tile", "max_pixels")
"""Settings that say how the work is done, not what comes out."""


@dataclass(frozen=True)
class Kind:
    """Where the kernel of a kind of image comes from, the layers it fills with their channels (1 or 3), and its side.

    ``side`` is the pipeline whose image it is where two are compared, ``numeric`` or ``symbolic``. ``each`` are layers
    filled once for every parameter of a job, under the name ``layer:parameter``. ``radiometric`` says which scenes it
    makes an image of, and ``tabled`` that its module's ``tables_needed`` names tables that are made before.
    """

    module: str
    layers: tuple[tuple[str, int], ...]
    side: str = "symbolic"
    each: tuple[tuple[str, int], ...] = ()
    radiometric: bool = False
    tabled: bool = False


_RADIOMETRIC: Final = (*((name, 3) for name in ("emitted", "direct", "indirect", "radiance")), ("hit_class", 1))
_RENDER: Final = (("radiance", 3), ("direct", 3), ("gloss", 3), ("hit_class", 1))
KINDS: Final[Mapping[str, Kind]] = {
    "numeric": Kind("symrender.numeric.pipeline", _RENDER, "numeric"),
    "symbolic": Kind("symrender.runtimes.image", _RENDER),
    "truth": Kind(
        "symrender.runtimes.truth",
        (*_RENDER, *((name, 1) for name in ("error", "status", "evaluations", "chambers", "crossings"))),
    ),
    "paths": Kind("symrender.numeric.radiometric.pipeline", _RADIOMETRIC, "numeric", radiometric=True),
    "radiometric": Kind(
        "symrender.runtimes.radiometric",
        (*_RADIOMETRIC, ("error", 1), ("status", 1)),
        radiometric=True,
        tabled=True,
    ),
    "sampled": Kind(
        "symrender.radiance.sampled",
        (*_RADIOMETRIC, ("error", 1), ("status", 1), ("kind", 1)),
        radiometric=True,
    ),
    "radiometric_gradient": Kind(
        "symrender.runtimes.radiometric_gradient",
        (("hit_class", 1),),
        each=(*_RADIOMETRIC[:4], ("error", 1), ("status", 1)),
        radiometric=True,
        tabled=True,
    ),
    "linear_gradient": Kind(
        "symrender.radiance.linear",
        (("hit_class", 1),),
        each=(*_RADIOMETRIC[:4], ("error", 1), ("status", 1), ("kind", 1)),
        radiometric=True,
    ),
    "mean_gradient": Kind(
        "symrender.runtimes.series_slopes",
        (("hit_class", 1),),
        each=(("radiance", 3), ("direct", 3), ("gloss", 3), ("error", 1), ("status", 1)),
    ),
    "gradient": Kind(
        "symrender.runtimes.gradient",
        (("hit_class", 1), ("evaluations", 1)),
        each=(("radiance", 3), ("direct", 3), ("gloss", 3), ("error", 1), ("status", 1)),
    ),
}


@dataclass(frozen=True)
class Job:
    """One image to be made: its ``kind`` (of ``KINDS``), its scene as text that loads bit for bit, its settings.

    ``wrt`` is what the parameters move that a ``gradient`` differentiates by. ``held`` is the scene itself in the
    process that made the job, which then need not read its text; elsewhere it is None, and no job differs by it.
    """

    kind: str
    scene: str
    scene_hash: str
    settings: Settings
    wrt: tuple[Move, ...] = ()
    held: AnyScene | None = field(default=None, compare=False, repr=False)

    def __getstate__(self) -> dict[str, Any]:
        """What another process is sent: all but the scene that this one holds."""
        return self.__dict__ | {"held": None}

    @property
    def side(self) -> str:
        """The pipeline whose image this is: ``numeric`` or ``symbolic``."""
        return KINDS[self.kind].side

    @classmethod
    def of(cls, kind: str, scene: AnyScene, settings: Settings, wrt: tuple[Move, ...] = ()) -> Job:
        """The job that makes this image."""
        return cls(kind, to_yaml(scene), scene.hash, settings, wrt, scene)

    def fields(self) -> dict[str, str]:
        """What decides the bytes of the image, by name: two jobs with equal fields make equal images."""
        chosen = {k: str(v) for k, v in asdict(self.settings).items() if k not in CHANGES_NO_BYTE}
        if self.wrt:
            chosen["wrt"] = ", ".join(name for name, _ in self.wrt)
        return {"version": version.VERSION, "code": code_digest()[:16], "scene": self.scene_hash} | chosen

    def empty_layers(self) -> dict[str, Array]:
        """Layers of the full image, zero: (h, w, 3) or (h, w). Memory is taken only where they are written."""
        return _zeros(self, self.settings.width, self.settings.height)


@dataclass(frozen=True)
class Done:
    """A finished unit: its blocks (tile height, tile width[, 3]) by layer, evaluations, and processor seconds."""

    tile: Tile
    blocks: Mapping[str, Array]
    evaluations: int
    seconds: float


def compute(job: Job, tile: Tile) -> Done:
    """Run one unit; the same call gives the same bytes in any process of this code on this kind of machine."""
    kernel, layers = prepared(job), job.empty_layers()
    begun = time.thread_time()
    evaluations = kernel(*tile, layers)
    seconds = time.thread_time() - begun
    return Done(tile, {name: block.copy() for name, block in blocks(layers, tile).items()}, evaluations, seconds)


def blocks(layers: Mapping[str, Array], tile: Tile) -> dict[str, Array]:
    """The part of every layer inside ``tile``, as views."""
    x0, y0, x1, y1 = tile
    return {name: layer[y0:y1, x0:x1] for name, layer in layers.items()}


@lru_cache(maxsize=4)
def prepared(job: Job) -> TileKernel:
    """Kernel of ``job``, compiled or read from the cache before any clock runs."""
    kind = KINDS[job.kind]
    what = (arrays_of(job), job.settings, *((job.wrt,) if kind.each else ()))
    kernel: TileKernel = importlib.import_module(kind.module).prepare(*what)
    # an empty tile is what makes the runtime compile
    kernel(0, 0, 0, 0, _zeros(job, 1, 1))
    return kernel


def arrays_of(job: Job) -> SceneArrays | RadiometricArrays:
    """The numbers of a job's scene."""
    scene = job.held or parse_any(job.scene, "scene", most=MAX_ITEMS)
    return radiometric_arrays(scene) if isinstance(scene, RadiometricScene) else scene_arrays(scene)


@lru_cache(maxsize=1)
def code_digest() -> str:
    """SHA-256 of every source file of the package: what its version number cannot promise while it is developed."""
    package = Path(__file__).resolve().parents[1]
    digest = hashlib.sha256()
    for path in sorted(package.rglob("*.py")):
        if path.parent.name != "cli":
            digest.update(path.relative_to(package).as_posix().encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()


def _zeros(job: Job, width: int, height: int) -> dict[str, Array]:
    kind = KINDS[job.kind]
    each = ((f"{layer}:{name}", channels) for name, _ in job.wrt for layer, channels in kind.each)
    return {
        name: np.zeros((height, width, channels) if channels > 1 else (height, width))
        for name, channels in (*kind.layers, *each)
    }
