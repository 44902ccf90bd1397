"""``audit``: is this render what its scene says?"""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Final

import numpy as np
import numpy.typing as npt

from symrender.audit.attribution import attribution
from symrender.audit.judge import Evidence, evidence, judged, pixel_test, region_tests, scale_test
from symrender.audit.measured import Measured, Render, finite, measured
from symrender.audit.regions import Region, regions
from symrender.audit.sequential import sequential as in_turn
from symrender.audit.verdict import Explanation, Verdict
from symrender.errors import ImageError, OptionError
from symrender.execution.provenance import filtered
from symrender.gradient import gradient
from symrender.images.image import Image, read_image
from symrender.limits import MAX_AUDIT_PIXELS
from symrender.runtimes.exposed import is_exposed
from symrender.scene.load import AnyScene, Source, load_any
from symrender.scene.moves import components
from symrender.scene.radiometric.arrays import radiometric_arrays
from symrender.scene.radiometric.scene import RadiometricScene
from symrender.settings import Filter
from symrender.truth import STATUS, truth

Array = npt.NDArray[np.float64]

_FAR_UNDER: Final = 0.05
"""Tolerance asked of the truth, over the standard error of the whole image's mean."""
_LOOSEST: Final = 1e-3
_TIGHTEST: Final = 1e-10
_EXPLAINED: Final = 2e-5
"""Tolerance of the truths that an explanation is sought with, over the light of the image."""
_UNKNOWN: Final = 0.1
"""Share of pixels without a truth beyond which nothing is judged."""


def audit(
    renders: Render | Iterable[Render],
    scene: Source,
    *,
    truth: Image | str | os.PathLike[str] | None = None,
    samples: int = 0,
    noise_free: bool = False,
    sequential: bool = False,
    visible: float = 0.0,
    level: float = 0.01,
    wrt: Sequence[str] = (),
    explain: bool = True,
    tol: float = 0.0,
    derivative: str = "",
    filter: Filter = "centre",
    threads: int = 0,
) -> Verdict:
    """Judge ``renders`` of ``scene``: one image with second moments or variances, or K >= 8 of K seeds.

    ``truth`` is an image of ours or a file of one; without it the truth is rendered, to ``tol`` (0: a twentieth of the
    standard error of the image's mean). ``samples`` a pixel, where one render is given; ``noise_free`` says that it
    has no noise. ``level`` is the chance that a right render fails, all tests together: half for the signed means of
    regions and the scale, half for single pixels, each by Holm. ``sequential`` looks after 8, 16, 32 ... images of an
    iterable and stops at the first decision, which may be a power that sees the relative bias ``visible``. After a
    failure, or where ``wrt`` names parameters, ``explain`` seeks what would explain it.
    With ``derivative``, the dotted name of a number of the scene, ``renders`` are images of the derivative in it, and
    the truth is that of ``gradient``: of what the ray through a pixel's centre meets. ``filter`` is what a pixel of the
    renders is, its ``centre``'s ray or the mean over its ``box``; a truth that is given says it itself.
    Raises ``ImageError`` and ``OptionError`` for what cannot be judged. Keywords are many because each is an option of
    ``symrender audit``, by its name.
    """
    if not 1e-12 <= level <= 0.5:
        raise OptionError(f"level: must be 1e-12 to 0.5, got {level:g}")
    if not (tol == 0.0 or _TIGHTEST <= tol <= 1.0):
        raise OptionError(f"tol: must be 0 or {_TIGHTEST:g} to 1, got {tol:g}")
    loaded = load_any(scene)
    many: list[Render] | Iterable[Render] = [renders] if isinstance(renders, (Image, str, os.PathLike)) else renders
    if derivative and wrt:
        raise OptionError("wrt: derivatives of derivatives explain nothing here; leave it out, or --derivative")
    if derivative and components(loaded, [derivative]) != (derivative,):
        raise OptionError(f"derivative: must name one number, got {derivative[:60]!r}")
    auditor = Auditor(loaded, truth, tol, threads, tuple(wrt), explain, derivative, filter)
    if sequential:
        auditor.margin = _FAR_UNDER / 8.0
        return in_turn(many, level, visible, auditor.verdict)
    return auditor.verdict(measured(list(many), samples, noise_free=noise_free), level, 1)


def filter_of(given: Image | str | os.PathLike[str]) -> Filter:
    """What a pixel of a truth is, as its metadata say."""
    image = given if isinstance(given, Image) else read_image(str(Path(given)), max_pixels=MAX_AUDIT_PIXELS)
    said = filtered(image.meta)
    return "centre" if said is None else said.filter


def _exposed(scene: AnyScene) -> bool:
    """Whether images of a scene are means over a lens or over time."""
    return isinstance(scene, RadiometricScene) and is_exposed(radiometric_arrays(scene))


class Auditor:
    """The truth of one scene, made once, and the verdicts about measurements of it."""

    def __init__(
        self,
        scene: AnyScene,
        given: Image | str | os.PathLike[str] | None,
        tol: float,
        threads: int,
        wrt: tuple[str, ...],
        explain: bool,
        derivative: str = "",
        filter: Filter = "centre",
    ) -> None:
        self.filter = filter if given is None else filter_of(given)
        self.scene, self.given, self.tol, self.threads = scene, given, tol, threads
        self.wrt, self.explain, self.derivative = wrt, explain, derivative
        # smaller in a sequence: the error of its last look is smaller than that of its first
        self.margin = _FAR_UNDER
        self._true: Image | None = None
        self._regions: tuple[Region, ...] = ()

    def verdict(self, found: Measured, level: float, look: int) -> Verdict:
        """The verdict on a measurement at ``level``."""
        if other := {name for name in found.receipts if name and name != self.scene.hash}:
            made = sorted(other)[0][:12]
            raise ImageError(f"renders: made of scene {made}, not of {self.scene.name} {self.scene.hash[:12]}")
        true = self.true(found)
        error = np.where(np.isfinite(true.layer("error")), true.layer("error"), np.inf)
        finite(np.where(np.isfinite(error)[..., None], true.radiance, 0.0), "truth: radiance")
        unknown = float(np.isinf(error).mean())
        if unknown > _UNKNOWN:
            raise ImageError(f"truth: {100 * unknown:.0f} % of its pixels have no stated error, nothing can be judged")
        seen = evidence(found, true.radiance, error, true.layers.get("hit_class"))
        tests = judged([scale_test(seen), *region_tests(seen, self._regions)], 0.5 * level)
        pixels, maps = pixel_test(seen, 0.5 * level)
        if all(test.outcome == "not judged" for test in tests) and pixels.outcome != "failed":
            raise ImageError(f"renders: cannot be judged: {tests[0].why or tests[-1].why}")
        passed = all(test.outcome != "failed" for test in tests) and pixels.outcome != "failed"
        why: tuple[Explanation, ...] = ()
        if self.explain and (self.wrt or not passed):
            layers = dict(true.layers)
            loose = max(4.0 * self._tolerance(found), _EXPLAINED * float(np.abs(found.mean).mean()))
            # what explains is known of centre rays; of means over pixels factors of the image are tried alone
            scene = None if self.derivative or self.filter != "centre" or _exposed(self.scene) else self.scene
            why = attribution(seen, self._regions, scene, layers, self.wrt, loose)
        return Verdict(
            passed, level, self.scene.name, self.scene.hash, found.source, found.samples, (true.width, true.height),
            tuple(tests[:1]), tuple(tests[1:]), pixels, why, self._notes(seen, true, pixels.kurtosis), look, maps,
        )  # fmt: skip

    def true(self, found: Measured) -> Image:
        """The truth at the size of ``found``, with an error layer."""
        height, width = found.mean.shape[:2]
        if self._true is None:
            self._true = self._brought((width, height), found)
            self._regions = regions(self.scene, self._true, self.threads)
        if (self._true.width, self._true.height) != (width, height):
            raise ImageError(
                f"renders: are {width} x {height} pixels, the truth {self._true.width} x {self._true.height}"
            )
        return self._true

    def _brought(self, size: tuple[int, int], found: Measured) -> Image:
        if self.given is None and self.derivative:
            asked = {"size": size, "tol": self._tolerance(found), "threads": self.threads, "filter": self.filter}
            return gradient(self.scene, [self.derivative], **asked)[self.derivative]  # type: ignore[arg-type]
        if self.given is None:
            tol = self._tolerance(found)
            return truth(self.scene, size=size, tol=tol, threads=self.threads, filter=self.filter)
        given, name = self.given, "truth"
        if not isinstance(given, Image):
            name = str(Path(given))
            given = read_image(name, max_pixels=MAX_AUDIT_PIXELS)
        made = given.meta.get("scene_hash", "")
        if made and made != self.scene.hash:
            raise ImageError(f"{name}: is the truth of scene {made[:12]}, not of {self.scene.name}")
        if given.meta.get("parameter", "") != self.derivative:
            what = given.meta.get("parameter", "") or "no parameter"
            raise ImageError(f"{name}: is the derivative in {what}, not in {self.derivative or 'none'}")
        if "error" not in given.layers or given.layer("error").ndim != 2:
            raise ImageError(f"{name}: has no error layer, so it is no truth; symrender truth writes one")
        if (given.layer("error") < 0).any():
            raise ImageError(f"{name}: some stated errors are negative")
        return given

    def _tolerance(self, found: Measured) -> float:
        if self.tol:
            return self.tol
        error = float(np.sqrt(found.variance.sum(axis=(0, 1)).max())) / (found.mean.shape[0] * found.mean.shape[1])
        light = float(np.abs(found.mean).mean())
        asked = self.margin * error if error > 0.0 else 1e-7 * light
        return float(np.clip(asked, _TIGHTEST, _LOOSEST))

    def _notes(self, seen: Evidence, true: Image, kurtosis: float) -> tuple[str, ...]:
        notes = []
        if "" in seen.measured.receipts:
            notes.append("unverified scene: the render carries no receipt, so it may be of another scene")
        if self.filter != "centre":
            notes.append("the truth is of means over pixels; a render of centre rays differs at every edge")
        elif isinstance(self.scene, RadiometricScene) or self.given is None:
            notes.append("the truth is of rays through pixel centres; a render with jitter differs at every edge")
        if self.derivative and self.filter == "centre":
            notes.append(
                f"images of the derivative in {self.derivative}, of what the rays through pixel centres meet: how "
                "edges move across a pixel is no part of it"
            )
        if self.given is not None and "scene_hash" not in true.meta:
            notes.append("unverified truth: its file names no scene")
        held = seen.measured.origin.held(true.height, true.width)
        if not held.all():
            notes.append(f"{int((~held).sum())} pixels lie outside the data window of the render and are not judged")
        if seen.measured.origin.precision == "half":
            notes.append("the render has 16-bit floats: half a unit in the last place is allowed for at every pixel")
        if seen.measured.origin.chromaticities:
            notes.append("the render's colours are converted to linear sRGB from the primaries that its file names")
        lost = int((held & ~seen.usable).sum())
        if lost:
            notes.append(f"{lost} pixels have no truth and are left out")
        if "status" in true.layers and (missed := int((true.layer("status") != 0).sum())):
            kinds = ", ".join(
                f"{int((true.layer('status') == code).sum())} {word}" for code, word in STATUS.items() if code
            )
            notes.append(
                f"the truth missed its tolerance at {missed} pixels ({kinds}); its stated errors are allowed for"
            )
        if seen.spread > 1.0:
            notes.append(
                f"neighbouring pixels are correlated (variance of sums {seen.spread:.2f} times as large, allowed for): "
                "a filter wider than a pixel, shared random numbers, or a smooth bias; 8 seeds tell which"
            )
        if seen.measured.source != "seeds" and seen.variance.any() and kurtosis > 6.0:
            notes.append(f"z values have kurtosis {kurtosis:.3g}, not 3: heavy tails, or a few pixels that are wrong")
        return tuple(notes)
