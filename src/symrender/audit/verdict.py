"""What an audit finds: records with names, and the words for them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any, Final, Literal

import numpy as np
import numpy.typing as npt

from symrender.audit.reach import SubPixel

Array = npt.NDArray[np.float64]
Outcome = Literal["passed", "failed", "not judged"]
Decision = Literal["passed", "failed", "undecided"]
_LISTED: Final = 8
"""Pixels set aside that a terminal lists."""

SCHEMA: Final = 2
"""Version of the JSON of a verdict: rises when a field goes or changes its meaning."""


@dataclass(frozen=True)
class Finding:
    """One test of the family.

    ``bias`` is what was measured less the truth (``scale``: relative), ``error`` its standard error, ``allowance`` what
    the truth's own error, the margin and the reach of its rays may make of it, ``z`` the bias beyond its allowance in
    standard errors with ``freedom`` degrees, ``p`` its two-sided probability and ``adjusted`` that after Holm.
    ``visible`` is the smallest bias that such a test sees with probability .9. ``relative`` and ``visible_relative``
    are over the truth's mean. ``why``: what makes a test unsafe to judge. ``margin``: the part of ``allowance`` that
    is the equivalence margin.
    """

    name: str
    region: str
    channel: str
    pixels: int
    truth: float
    bias: float
    error: float
    allowance: float
    freedom: float
    z: float
    p: float
    adjusted: float
    visible: float
    outcome: Outcome
    why: str = ""
    margin: float = 0.0

    @property
    def within(self) -> bool:
        """Whether the margin alone makes nothing of a bias of five standard errors or more."""
        beyond = abs(self.bias) - (self.allowance - self.margin)
        return self.outcome == "passed" and self.margin > 0.0 and beyond > 5.0 * self.error

    @property
    def relative(self) -> float:
        """Bias over the truth's mean."""
        return self.bias / self.truth if self.truth else float("nan")

    @property
    def visible_relative(self) -> float:
        """Smallest visible bias over the truth's mean."""
        return self.visible / abs(self.truth) if self.truth else float("nan")


@dataclass(frozen=True)
class PixelTest:
    """Every pixel by itself: ``rejected`` by Holm at its share of the level, ``discovered`` by Benjamini-Hochberg.

    ``unjudged`` pixels are too noisy for the normal distribution or have no truth. ``worst`` is (column, row).
    ``kurtosis`` is that of the z values, 3 where they are normal. ``aside`` pixels are set aside, because their truth
    changes within reach of their rays.
    """

    judged: int
    unjudged: int
    rejected: int
    discovered: int
    worst: tuple[int, int]
    largest: float
    kurtosis: float
    outcome: Outcome
    why: str = ""
    aside: int = 0


@dataclass(frozen=True)
class Explanation:
    """One thing that would change the truth into what was measured.

    Of a parameter ``current`` is the scene's value, ``value`` what the render is consistent with, ``error`` its
    standard error; a mutation has no numbers. ``explains`` is the share of the regions' squared z values that goes.
    ``consistent``: after it no region is off any more.
    """

    name: str
    explains: float
    consistent: bool
    current: float = float("nan")
    value: float = float("nan")
    error: float = float("nan")
    how: str = ""

    def text(self) -> str:
        """One sentence."""
        if np.isfinite(self.value):
            words = f"{self.name} were {self.value:.6g} +- {self.error:.2g} instead of {self.current:.6g}"
        else:
            words = self.name
        verb = "consistent with truth if" if self.consistent else "nearer to truth, not equal, if"
        return f"{verb} {words} (explains {100 * self.explains:.2f} % of the misfit)"


@dataclass(frozen=True, eq=False)
class Verdict:
    """Outcome of an audit.

    Attributes
    ----------
    verdict : {"passed", "failed", "undecided"}
        Whether a test failed; undecided where none did and ``undecided`` names a reason.
    level : float
        Family-wise level.
    scene, scene_hash : str
        Name and hash of the scene.
    source : str
        Where the variance comes from.
    samples : int
        Samples or seeds used.
    size : (int, int)
        Width and height.
    tests : tuple of Finding
        The scale of the whole image.
    regions : tuple of Finding
        Signed means of the regions.
    pixels : PixelTest
        The test of single pixels.
    attribution : tuple of Explanation
        Possible explanations, best first.
    notes : tuple of str
        Restrictions of the audit.
    looks : int
        Interim looks of a sequential audit, 1 without.
    maps : mapping of str to ndarray
        ``difference``, ``z``, ``error`` (h, w, c) and ``rejected``, ``discovered``, ``aside`` (h, w).
    undecided : tuple of str
        Why a verdict that is not failed is not passed either.
    sub_pixel : tuple of SubPixel
        Pixels set aside with their sub-pixel truth, at most 64.
    """

    verdict: Decision
    level: float
    scene: str
    scene_hash: str
    source: str
    samples: int
    size: tuple[int, int]
    tests: tuple[Finding, ...]
    regions: tuple[Finding, ...]
    pixels: PixelTest
    attribution: tuple[Explanation, ...]
    notes: tuple[str, ...]
    looks: int = 1
    maps: Mapping[str, Array] = field(default_factory=dict, repr=False)
    undecided: tuple[str, ...] = ()
    sub_pixel: tuple[SubPixel, ...] = ()

    @property
    def passed(self) -> bool:
        """Whether the verdict is ``passed``."""
        return self.verdict == "passed"

    @property
    def exit_code(self) -> int:
        """What the command ends with: 0 passed, 1 failed, 3 undecided."""
        return {"passed": 0, "failed": 1, "undecided": 3}[self.verdict]

    @property
    def failed(self) -> tuple[Finding, ...]:
        """The tests that failed, strongest first."""
        found = [test for test in (*self.tests, *self.regions) if test.outcome == "failed"]
        return tuple(sorted(found, key=lambda test: (test.p, -abs(test.z))))

    def sentence(self) -> str:
        """What a person should know, in a sentence or two."""
        whole = next(test for test in self.regions if test.region == "all")
        if self.passed:
            seen = f"a bias of {_percent(whole.visible_relative)} over the whole image would have been seen"
            return f"Passed: nothing tells this render from the truth of {self.scene}; {seen}."
        if self.verdict == "undecided":
            return f"Undecided: {'; '.join(self.undecided)}."
        words = []
        if self.failed:
            worst = self.failed[0]
            what = "all of the image" if worst.region == "all" else worst.region
            size = "brighter" if worst.bias > 0 else "darker"
            if worst.name == "scale":
                words.append(f"it is {_percent(worst.bias)} {size} as a whole")
            else:
                off = _percent(worst.relative) if worst.truth else f"{worst.bias:.3g}"
                words.append(f"{what} is {off} {size} in {worst.channel} (z {worst.z:+.1f})")
        if self.pixels.outcome == "failed":
            words.append(f"{self.pixels.rejected} single pixels are off, most at {self.pixels.worst}")
        text = f"Failed: {'; '.join(words)}."
        alike = [found for found in self.attribution if found.consistent]
        if alike:
            # what leaves no region off is not told apart by any of them
            text += f" It is {'; or '.join(found.text() for found in alike)}."
        return text

    def text(self) -> str:
        """The verdict, its power and its tests, for a terminal."""
        lines = [
            f"audit of {self.scene}, {self.size[0]} x {self.size[1]} pixels, {self.source}, {self.samples} samples; "
            f"family-wise level {self.level:g}",
            "power: bias seen with probability .9, of the truth's mean",
        ]
        for test in self.regions:
            lines.append(
                f"  {_label(test):44} {test.pixels:8d} px  {_percent(test.visible_relative):>9} (+-{test.visible:.3g})"
            )
        lines.append("tests:")
        for test in (*self.tests, *self.regions):
            what = f"  {_label(test):44} {test.bias:+.4g} +- {test.error:.2g}  z {test.z:+7.2f}  p {test.adjusted:.2g}"
            lines.append(f"{what}  {test.outcome}{_because(test.why)}")
        pixel = self.pixels
        lines.append(
            f"  pixels: {pixel.judged} judged, {pixel.unjudged} not; {pixel.rejected} rejected (Holm), "
            f"{pixel.discovered} discovered (Benjamini-Hochberg); {pixel.outcome}{_because(pixel.why)}"
        )
        if pixel.aside:
            lines.append(f"  set aside: {pixel.aside} pixels whose truth changes within reach of their rays")
        lines += [f"    {_sub_pixel(one)}" for one in self.sub_pixel[:_LISTED]]
        lines += [f"attribution: {found.text()}; {found.how}" for found in self.attribution]
        lines += [f"note: {note}" for note in self.notes]
        return "\n".join([*lines, self.sentence()])

    def as_json(self) -> dict[str, Any]:
        """Plain data without the maps; what is not a finite number is null."""
        kept: dict[str, Any] = {"schema": SCHEMA} | {
            name: getattr(self, name)
            for name in ("verdict", "passed", "level", "scene", "scene_hash", "source", "samples", "looks")
        }
        kept |= {"size": list(self.size), "sentence": self.sentence(), "notes": list(self.notes)}
        kept["tests"] = [_plain(asdict(test)) for test in self.tests]
        kept["regions"] = [_plain(asdict(test)) for test in self.regions]
        kept["pixels"] = _plain(asdict(self.pixels))
        kept["undecided"] = list(self.undecided)
        kept["sub_pixel"] = [
            {"column": b.column, "row": b.row} | {n: getattr(b, n).tolist() for n in ("truth", "low", "high")}
            for b in self.sub_pixel
        ]
        kept["attribution"] = [_plain(asdict(found)) for found in self.attribution]
        return kept


def _label(test: Finding) -> str:
    return f"{test.name} {test.region} {test.channel}" if test.name != "scale" else "scale (truth times 1 + b)"


def _sub_pixel(one: SubPixel) -> str:
    """A pixel set aside: its channel that changes most."""
    c = int((one.high - one.low).argmax())
    return (
        f"({one.column}, {one.row}): truth {one.truth[c]:.6g}, within reach {one.low[c]:.6g} to {one.high[c]:.6g} "
        f"in {('red', 'green', 'blue')[c]}"
    )


def _because(why: str) -> str:
    return f": {why}" if why else ""


def _percent(share: float) -> str:
    return f"{100 * abs(share):.3g} %" if np.isfinite(share) else "unbounded"


def _plain(record: dict[str, Any]) -> dict[str, Any]:
    return {
        key: None if isinstance(value, float) and not np.isfinite(value) else value for key, value in record.items()
    }
