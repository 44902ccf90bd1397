"""``audit``: is this render what its scene says?"""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Final

import numpy as np
import numpy.typing as npt

from symrender.audit.attribution import attribution
from symrender.audit.evidence import Evidence, Margin, evidence
from symrender.audit.judge import judged, outside, pixel_test, region_tests, scale_test
from symrender.audit.measured import Measured, Origin, Render, finite, measured
from symrender.audit.reach import Reach, SubPixel, nowhere, reach, sub_pixel
from symrender.audit.regions import Region, regions
from symrender.audit.sequential import sequential as in_turn
from symrender.audit.verdict import Decision, Explanation, Finding, PixelTest, Verdict
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
_ASIDE: Final = 0.25
"""Share of pixels set aside beyond which an audit without a failure is undecided."""
Offset = float | tuple[float, float]


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
    explain_seconds: float = 10.0,
    tol: float = 0.0,
    derivative: str = "",
    filter: Filter | None = None,
    allow: Offset | None = None,
    ray_offset: Offset | None = None,
    threads: int = 0,
) -> Verdict:
    """Test whether renders of a scene are correct, at a stated level.

    Parameters
    ----------
    renders : image, path, or iterable of these
        One image with second moments or variances, one without noise, or 8 to 1024 images that differ in their seed.
    scene : str, path, mapping or scene
        Name of a gallery scene, file, dict with the keys of a file, or a loaded scene.
    truth : Image or path, optional
        The reference; without it one is rendered.
    samples : int
        Samples a pixel of a single render with moments or variances.
    noise_free : bool
        The single render has no noise.
    sequential : bool
        Look after 8, 16, 32 ... images of an iterable, and stop at the first decision.
    visible : float
        Relative bias of the whole image that a sequential pass must be able to detect.
    level : float
        Probability that a correct render fails, 1e-12 to 0.5, all tests together.
    wrt : sequence of str
        Dotted names of parameters that explanations try first, also after a pass.
    explain : bool
        Look for explanations where a region or the scale failed.
    explain_seconds : float
        Time for explanations that need further references; those of ``wrt`` are tried whatever they take.
    tol : float
        Tolerance of a rendered reference; 0 is a twentieth of the standard error of the image's mean.
    derivative : str
        Dotted name of a number: the renders are images of the derivative by it.
    filter : {"centre", "box", "tent", "gaussian", "mitchell"}, optional
        What a pixel of the renders is; without it what their receipts say, else ``centre``. A given reference states it
        itself.
    allow : float or (float, float), optional
        Equivalence margin: differences of this part of the radiance, and of this absolute size, do not count. Without
        it 1e-4 for a render without noise, 2^-22 for samples of 32 bits or of unknown precision, and 0 for 64 bits.
    ray_offset : float or (float, float), optional
        Secondary rays of the renderer start this far off a surface, or a + b max |p| off the place p for (a, b);
        without it what receipts say, else 0.
    threads : int
        Worker threads; 0 takes the processors of this process.

    Returns
    -------
    Verdict
        Passed, failed or undecided; tests of regions, scale and pixels, explanations, and maps.

    Raises
    ------
    ImageError
        A render cannot be judged: NaN, another size, another scene.
    OptionError
        An argument is out of range.
    Unsupported
        The reference does not cover the scene.

    See Also
    --------
    compare : Difference of two images without a test.

    Notes
    -----
    Half of ``level`` goes to signed means of regions and the scale of the image, half to single pixels, each by Holm's
    method (doi:10.2307/4615733). The error stated by the reference is allowed for in every test. Looks of a sequential
    audit have the level divided by 2, 4, 8 ... (Bonferroni). Pixels whose truth changes by more than the margin within
    the reach of 32-bit arithmetic or of the ray offset are set aside: they can leave an audit undecided, never failed.
    Keywords are many because each is an option of ``symrender audit``.

    Examples
    --------
    >>> import symrender as sr
    >>> true = sr.truth("interreflection", size=(24, 16), tol=1e-4)
    >>> images = [
    ...     sr.render("interreflection", size=(24, 16), lobe=4, symbolic="none", seed=k).numeric for k in range(8)
    ... ]
    >>> sr.audit(images, "interreflection", truth=true).passed
    True
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
    auditor = Auditor(
        loaded, truth, tol, threads, tuple(wrt), explain, derivative, filter, _pair("allow", allow),
        _pair("ray_offset", ray_offset), explain_seconds,
    )  # fmt: skip
    if sequential:
        auditor.margin = _FAR_UNDER / 8.0
        return in_turn(many, level, visible, auditor.verdict)
    return auditor.verdict(measured(list(many), samples, noise_free=noise_free), level, 1)


def _pair(name: str, given: Offset | None) -> tuple[float, float] | None:
    """One or two numbers, none of them negative."""
    if given is None:
        return None
    first, second = (given, 0.0) if isinstance(given, (int, float)) else given
    if not (0.0 <= first <= 1e6 and 0.0 <= second <= 1e6):
        raise OptionError(f"{name}: must be numbers from 0 to 1e6, got {first:g} and {second:g}")
    return float(first), float(second)


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
        filter: Filter | None = None,
        allow: tuple[float, float] | None = None,
        ray_offset: tuple[float, float] | None = None,
        seconds: float = 10.0,
    ) -> None:
        self.seconds = seconds
        self.filter: Filter = filter or "centre"
        self._asked = filter
        self.allow, self.ray_offset = allow, ray_offset
        self.scene, self.given, self.tol, self.threads = scene, given, tol, threads
        self.wrt, self.explain, self.derivative = wrt, explain, derivative
        # smaller in a sequence: the error of its last look is smaller than that of its first
        self.margin = _FAR_UNDER
        self._true: Image | None = None
        self._regions: tuple[Region, ...] = ()
        self._reach: Reach | None = None

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
        lost = found.origin.numbers("radiance_lost", 1)
        margin = None if self.allow is None else Margin(*self.allow)
        known = self._known(found, true)
        error = error + (lost[0] if lost else 0.0)
        seen = evidence(found, true.radiance, error, true.layers.get("hit_class"), margin, known)
        tests = judged([scale_test(seen), *region_tests(seen, self._regions)], 0.5 * level)
        pixels, maps = pixel_test(seen, 0.5 * level)
        sub_pixel = self._sub_pixel(seen, true, known, found)
        undecided = self._undecided(seen, tests, pixels, outside(seen, 0.5 * level, sub_pixel))
        failed = pixels.outcome == "failed" or any(test.outcome == "failed" for test in tests)
        verdict: Decision = "failed" if failed else "undecided" if undecided else "passed"
        why: tuple[Explanation, ...] = ()
        if self.explain and (self.wrt or any(test.outcome == "failed" for test in tests)):
            layers = dict(true.layers)
            loose = max(4.0 * self._tolerance(found), _EXPLAINED * float(np.abs(found.mean).mean()))
            # what explains is known of centre rays; of means over pixels factors of the image are tried alone
            scene = None if self.derivative or self.filter != "centre" or _exposed(self.scene) else self.scene
            why = attribution(seen, self._regions, scene, layers, self.wrt, loose, self.seconds)
        return Verdict(
            verdict, level, self.scene.name, self.scene.hash, found.source, found.samples, (true.width, true.height),
            tuple(tests[:1]), tuple(tests[1:]), pixels, why, self._notes(seen, true, tests, pixels.kurtosis), look,
            maps, undecided, sub_pixel,
        )  # fmt: skip

    def _known(self, found: Measured, true: Image) -> Reach:
        """What the truth changes by within reach, computed once: looks of a sequence share it."""
        if self._reach is None:
            size, scene = (true.width, true.height), self.scene
            offset = self.ray_offset or found.origin.numbers("ray_offset", 2) or (0.0, 0.0)
            placed = found.origin.numbers("placed", 4) or (1.0, 0.0, 0.0, 0.0)
            if placed[0] <= 0.0:
                raise ImageError(f"placed: its scale must be positive, got {placed[0]:g}")
            if not isinstance(scene, RadiometricScene) or not (found.single or any(offset) or found.origin.halves):
                self._reach = nowhere(size)
            else:
                filtered = self.filter != "centre" or _exposed(scene) or bool(self.derivative)
                self._reach = reach(
                    scene, true, found.single, (offset[0], offset[1]), placed, found.origin.halves, filtered,
                    self.threads,
                )  # fmt: skip
        return self._reach

    def _sub_pixel(self, seen: Evidence, true: Image, known: Reach, found: Measured) -> tuple[SubPixel, ...]:
        if not isinstance(self.scene, RadiometricScene) or not seen.aside.any():
            return ()
        order = np.abs(seen.difference).max(axis=-1)
        return sub_pixel(self.scene, true, known, seen.aside, order, self._tolerance(found), self.threads)

    def _undecided(
        self, seen: Evidence, tests: list[Finding], pixels: PixelTest, off: list[SubPixel]
    ) -> tuple[str, ...]:
        """Why what did not fail has not passed."""
        found = []
        if off:
            found.append(
                f"{len(off)} of {pixels.aside} pixels set aside lie outside of their sub-pixel truth, first "
                f"({off[0].column}, {off[0].row})"
            )
        share = pixels.aside / seen.aside.size
        if share > _ASIDE:
            found.append(
                f"{100 * share:.0f} % of the pixels are set aside: their truth changes within the precision or the ray "
                "offset of the renderer"
            )
        if all(test.outcome == "not judged" for test in tests):
            found.append(f"nothing can be judged: {tests[0].why or tests[-1].why}")
        return tuple(found)

    def true(self, found: Measured) -> Image:
        """The truth at the size of ``found``, with an error layer."""
        height, width = found.mean.shape[:2]
        if self._true is None:
            self.filter = self._filter(found.origin)
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

    def _filter(self, origin: Origin) -> Filter:
        """What pixels are, as the truth, the caller and the receipts of the renders agree."""
        said = origin.filter
        if self.given is not None:
            held = filter_of(self.given)
            if said not in (None, held):
                raise ImageError(f"truth: its pixels are {held}, those of the renders are {said} by their receipts")
            return held
        if self._asked is not None and said not in (None, self._asked):
            raise OptionError(f"filter: the renders' receipts say {said}, got {self._asked}")
        return self._asked or said or "centre"

    def _tolerance(self, found: Measured) -> float:
        if self.tol:
            return self.tol
        error = float(np.sqrt(found.variance.sum(axis=(0, 1)).max())) / (found.mean.shape[0] * found.mean.shape[1])
        light = float(np.abs(found.mean).mean())
        asked = self.margin * error if error > 0.0 else 1e-7 * light
        return float(np.clip(asked, _TIGHTEST, _LOOSEST))

    def _notes(self, seen: Evidence, true: Image, tests: list[Finding], kurtosis: float) -> tuple[str, ...]:
        notes = [
            f"{test.region} differs by {test.bias:+.3g} in {test.channel}, within the margin of {test.margin:.2g}"
            for test in tests
            if test.within
        ][:3]
        lost = seen.measured.origin.numbers("radiance_lost", 1)
        if lost and lost[0] > 0.0:
            notes.append(f"the exported scene differs from the scene by up to {lost[0]:.3g}, which is allowed for")
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
        unknown = int((held & ~seen.usable & ~seen.aside).sum())
        if unknown:
            notes.append(f"{unknown} pixels have no truth and are left out")
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
