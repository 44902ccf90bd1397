"""The scene under study: which pixels are judged, what an estimator makes of them, and the truth about them."""

from __future__ import annotations

import importlib
import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from symrender.errors import OptionError
from symrender.execution.jobs import KINDS, Job, TileKernel
from symrender.ledger.statistics import Difference, difference
from symrender.runtimes.image import prepare_sight
from symrender.scene import arrays as at
from symrender.scene.arrays import Array, SceneArrays, lobes_of, scene_arrays
from symrender.scene.load import load
from symrender.scene.planes_due import refuse_planes
from symrender.scene.scene import Scene
from symrender.settings import Settings, image_size
from symrender.studies.cpu_time import filled
from symrender.studies.report import Cell

Mask = npt.NDArray[np.bool_]
Surface = Literal["floor", "all"]

_UNSUPPORTED = 3
_SIGHT = ("radiance", "direct", "gloss", "place", "normal", "incoming")


@dataclass(frozen=True)
class Subject:
    """A scene, its image's size and the surfaces whose lobes are judged.

    ``scene`` has the lobes of every other surface turned off, so that they cost nothing. ``settings`` is what all
    estimators share.
    """

    scene: Scene
    surface: Surface
    settings: Settings

    @property
    def arrays(self) -> SceneArrays:
        """The scene as plain arrays."""
        return scene_arrays(self.scene)

    def with_changes(self, changes: Mapping[str, object]) -> Subject:
        """The same study of the scene with values changed by dotted name."""
        return replace(self, scene=self.scene.replace(changes))

    def kernel(self, kind: str, **changes: Any) -> TileKernel:
        """Compiled kernel of ``kind`` (of ``jobs.KINDS``) under the settings with ``changes``."""
        module = importlib.import_module(KINDS[kind].module)
        kernel: TileKernel = module.prepare(self.arrays, replace(self.settings, **changes))
        kernel(0, 0, 0, 0, self.empty_layers(kind))
        return kernel

    def empty_layers(self, kind: str) -> dict[str, Array]:
        """Zeroed layers for a kernel of ``kind``."""
        return Job(kind, "", "", self.settings).empty_layers()

    def layers(self, kind: str, **changes: Any) -> dict[str, Array]:
        """The layers a kernel of ``kind`` makes, whole image."""
        layers = self.empty_layers(kind)
        filled(self.kernel(kind, **changes), layers, self.settings.width, self.settings.height)
        return layers

    def places(self) -> dict[str, Array]:
        """``place``, ``normal``, ``incoming`` (h, w, 3) and ``hit_class`` (h, w) of what each pixel sees."""
        shape = (self.settings.height, self.settings.width)
        names = ("radiance", "direct", "gloss", "place", "normal", "incoming", "albedo")
        layers = {name: np.zeros((*shape, 3)) for name in names}
        layers["hit_class"] = np.zeros(shape)
        filled(prepare_sight(self.arrays, self.settings), layers, self.settings.width, self.settings.height)
        return layers

    def glossy(self, hit_class: Array) -> Mask:
        """Pixels (h, w) whose surface has a lobe that is judged."""
        arrays = self.arrays
        weights = np.concatenate([[0.0], lobes_of(arrays)[:, 0]])
        if not arrays.camera.eye[2] > 0.0:
            weights[at.FLOOR] = 0.0
        return np.asarray(weights[hit_class.astype(np.int64)] > 0)


@dataclass(frozen=True, eq=False)
class Reference:
    """Truth of the gloss layer by the split rule: ``gloss`` (h, w, 3) with ``error`` (h, w) on the pixels of ``mask``.

    ``error`` is the rule's own estimate of the largest error over the channels. ``tol`` is what was asked for,
    ``missed`` pixels did not reach it, ``signal`` is the RMS of the truth and ``own`` the RMS of its error, both over
    the mask, ``layers`` everything the rule reported.
    """

    gloss: Array
    error: Array
    mask: Mask
    tol: float
    missed: int
    signal: float
    own: float
    seconds: float
    layers: Mapping[str, Array]

    def judge(self, gloss: Array) -> Difference:
        """``gloss`` (h, w, 3) against the truth, over the mask."""
        result = difference(self.gloss, gloss, self.mask)
        assert result is not None, "a reference holds at least one pixel"
        return result

    def interval(self, rmse: float) -> tuple[float, float]:
        """Bounds of the true RMSE of what measured ``rmse``: the reference's own error taken off and put on."""
        return max(0.0, rmse - self.own), rmse + self.own


def subject(
    scene: Scene | str | Path | Mapping[str, Any],
    *,
    size: int | tuple[int, int] = 64,
    surface: Surface = "floor",
    disk: str = "2x2",
    seed: int = 7,
) -> Subject:
    """The study of ``scene``; ``surface``: lobes of the floor alone, or of all shapes.

    Raises OptionError for a size out of range or an unknown surface, SceneError for a scene that cannot be read.
    """
    if surface not in ("floor", "all"):
        raise OptionError(f"surface: must be floor or all, got {surface!r}")
    loaded = load(scene, "study")
    refuse_planes(loaded, "study")
    if surface == "floor":
        loaded = loaded.replace(
            {f"spheres.{s.name}.lobe.weight": 0.0 for s in loaded.spheres if s.lobe is not None}
        )  # fmt: skip
    width, height = image_size(size)
    return Subject(loaded, surface, Settings(width=width, height=height, disk=disk, seed=seed, aa="none"))


def reference(of: Subject, tol: float) -> Reference:
    """Truth to ``tol``, absolute, in scene units of radiance.

    Raises OptionError where no pixel carries a judged lobe, or where all their lobes are black: nothing could be
    measured there.
    """
    layers = of.empty_layers("truth")
    kernel = of.kernel("truth", tol=tol)
    _, seconds = filled(kernel, layers, of.settings.width, of.settings.height)
    mask = of.glossy(layers["hit_class"]) & (layers["status"] != _UNSUPPORTED)
    where = f"{of.scene.name} at {of.settings.width} x {of.settings.height}"
    if not mask.any():
        raise OptionError(f"scene: no pixel of {where} shows a lobe of surface {of.surface}; nothing can be measured")
    signal = _rms(layers["gloss"][mask])
    if signal == 0:
        raise OptionError(f"scene: every lobe of {where} is black; nothing can be measured")
    return Reference(
        gloss=layers["gloss"],
        error=layers["error"],
        mask=mask,
        tol=tol,
        missed=int((layers["status"][mask] != 0).sum()),
        signal=signal,
        own=_rms(layers["error"][mask]),
        seconds=seconds,
        layers=layers,
    )


def relative_reference(of: Subject, relative: float) -> Reference:
    """Truth to ``relative`` times the RMS of the signal, which one quick look measures first."""
    rough = reference(of, 1e-2)
    return reference(of, max(1e-13, min(1e-2, relative * rough.signal)))


def facts(of: Subject, truth: Reference | None = None) -> dict[str, Cell]:
    """What every study says about its subject."""
    described: dict[str, Cell] = {
        "scene": of.scene.name,
        "size": f"{of.settings.width} x {of.settings.height}",
        "lobes of": of.surface,
        "units of lobes": of.scene.shading.lobe_units,
        "disk lights": of.settings.disk,
        "seed": of.settings.seed,
    }
    if truth is not None:
        described |= {
            "pixels judged": int(truth.mask.sum()),
            "signal, RMS": truth.signal,
            "truth": f"split rule, tol {truth.tol:.3g}, {truth.missed} pixels missed it",
            "truth's own error, RMS": truth.own,
            "relative to the signal": truth.own / truth.signal,
        }
    return described


def _rms(values: Array) -> float:
    return math.sqrt(float(np.mean(np.square(values))))
