"""The judge: what the package says of a case against what the evaluator finds, the cheap way first.

Lattices come first, lines where lattices cannot tell at the stated error, a second sweep and longer lattices where the
first opinion contradicts. A value is called beyond its statement only where two opinions that share no method, or two
long lattices that share no shift, both leave it there.
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Final

import numpy as np
from scipy.integrate import quad

from .case import Case
from .lattice import lattice_value, mirror_value
from .sweep import Sweep, Swept, swept_value
from .world import (
    AMBIENT,
    BACKGROUND,
    BRDF,
    EXPONENT,
    EYE,
    KA,
    KD,
    KS,
    MIRROR,
    NORMAL,
    PLACE,
    SHININESS,
    SURFACE,
    THETA_MAX,
    Array,
    World,
    lobe_of,
    world_of,
)

SIGMAS: Final = 5.0
"""Standard errors of 16 shifts taken as the doubt of a lattice: t with 15 degrees beyond 5 is 1.6e-4, and a second,
fresh and longer lattice is asked before anything is called beyond, which makes 3e-8 a channel."""
BROAD: Final = 32.0
"""Shininess below which a highlight is as wide as what it lies on, so that a sliver of it may be missed."""
UNSEEN: Final = 10.0
"""A part of the lobe that none of N looks met is smaller than this over N, but for a chance of e^-10."""
FINEST: Final = 3e-9
"""What lines are trusted to, relative to the value: in symmetric scenes two sweeps may share an error below it."""
NEAR: Final = 0.5
"""Stated errors from a claim at which coarse lines leave it alone, but for a share of the cases."""
CHANCE: Final = 5.0
"""An evaluator that has not seen the claim ends early where its distance from it, times its doubt, is below this times
the stated error squared: half the stated error at a doubt of ten, a twentieth at a hundred. A claim that is wrong by
more than stated would have to be met by an error of the evaluator's own of the same size and sign; of errors spread as
far as the doubt, one in so many (the ratio of the two) lies there."""
ROUGH: Final = 300.0
"""First lines take this many times the stated error, and half the cells."""
EASE: Final = 0.2
"""A quick judge takes seven lines or nodes for fifteen where their error is so small a share of what is allowed."""
LOOKS: Final = 160_000
"""What lines may look at before a quick judge leaves them; with many lights, of which each look takes all, fewer."""
DEEP: Final = 3
"""Of so many cases one is asked on where coarse lines come near the claim, but doubt more than that is worth."""
AUDITED: Final = 16
"""Of so many cases one is judged the dear way from the first."""
SPENT: Final = 2.0
"""A budget is a promise within this factor."""
BATCHES: Final = 4
"""Of so many cases one is asked in the opposite order too: a value depends on its own point alone."""
SLACK: Final = 1000
"""Evaluations beyond the budget that are not worth a word."""


@dataclass(frozen=True)
class Opinion:
    """An independent value (3,) and how far it may be off."""

    value: Array
    doubt: Array
    method: str
    agrees: bool = False
    """Whether it ended early, since it came as close to the claim as ``CHANCE`` says."""


@dataclass(frozen=True)
class Verdict:
    """One value judged. ``ratio``: how far the value lies off what can be told, over the stated error."""

    case: Case
    index: int
    value: Array
    stated: float
    status: int
    evaluations: int
    opinion: Opinion
    called: str
    seconds: float

    @property
    def off(self) -> float:
        """The part of the difference that the evaluator's doubt does not explain, worst channel."""
        return float(max(0.0, (np.abs(self.value - self.opinion.value) - self.opinion.doubt).max()))

    @property
    def ratio(self) -> float:
        """``off`` over the stated error."""
        return self.off / max(self.stated, 1e-300)

    def told(self, factor: float) -> bool:
        """Whether an error of ``factor`` times the stated one would have been called beyond."""
        return self.opinion.agrees or bool(self.opinion.doubt.max() <= (factor - 1.0) * self.stated)

    @property
    def signal(self) -> bool:
        """Whether there was anything to see."""
        return bool(np.abs(self.opinion.value).max() > 0.0)

    @property
    def overspent(self) -> bool:
        """Whether the budget was not kept."""
        return self.evaluations > SPENT * self.case.budget + SLACK


def judge(case: Case) -> list[Verdict]:
    """Judge every point of a case; values the package refuses are called ``refused``."""
    import symrender as sr
    from symrender.errors import SymrenderError

    begun = time.perf_counter()
    try:
        found = sr.probe(
            case.scene, case.points, surface=case.surface, tol=case.tol, disk=case.disk, budget=case.budget, threads=1
        )
    except SymrenderError as error:
        nothing = Opinion(np.zeros(3), np.zeros(3), str(error))
        return [Verdict(case, 0, np.zeros(3), 0.0, 3, 0, nothing, "refused", time.perf_counter() - begun)]
    seconds = (time.perf_counter() - begun) / len(case.points)
    if len(case.points) > 1 and case.seed % BATCHES == 0 and (torn := _torn(case, found.gloss, found.error)):
        return torn
    return [
        verdict(
            case, k, found.gloss[k], float(found.error[k]), int(found.status[k]), int(found.evaluations[k]), seconds
        )
        for k in range(len(case.points))
    ]


def _torn(case: Case, gloss: Array, error: Array) -> list[Verdict]:
    """Points whose value is another one when they are asked in the opposite order; called ``torn``."""
    import symrender as sr

    back = sr.probe(
        case.scene, case.points[::-1], surface=case.surface, tol=case.tol, disk=case.disk, budget=case.budget, threads=1
    )
    other = back.gloss[::-1]
    return [
        Verdict(case, k, gloss[k], float(error[k]), 0, 0, Opinion(other[k], np.zeros(3), "asked in turn"), "torn", 0.0)
        for k in np.nonzero((gloss != other).any(axis=1))[0].tolist()
    ]


def verdict(
    case: Case, index: int, value: Array, stated: float, status: int, evaluations: int, seconds: float
) -> Verdict:
    """Judge what is said of one point."""
    if status == 3:
        nothing = Opinion(np.zeros(3), np.zeros(3), "")
        return Verdict(case, index, value, stated, status, evaluations, nothing, "unsupported", seconds)
    world, lobe = world_of(case.scene, case.disk), lobe_of(case.scene, case.surface, case.points[index])
    asked = contradicts if case.seed % AUDITED == 0 else quickly
    opinion, called = asked(world, lobe, value, stated, case.seed)
    return Verdict(case, index, value, stated, status, evaluations, opinion, called, seconds)


def quickly(world: World, lobe: Array, claim: Array, stated: float, seed: int) -> tuple[Opinion, str]:
    """As ``contradicts``, which has the last word on every contradiction, but no dearer than a claim that holds needs.

    A short lattice tells what is wrong by much; coarse lines come next, and fine ones where coarse ones do not come
    near the claim, and in a share of the cases. Longer lattices are left to what lines cannot take.
    """
    finite = np.isfinite(claim).all() and np.isfinite(stated)
    if not finite or (lobe[THETA_MAX] == 0.0 and not len(world.disks)):
        return contradicts(world, lobe, claim, stated, seed)
    best, doubtful = None, seed % DEEP == 0
    for opinion in opinions(world, lobe, stated, seed):
        holds = _within(opinion, claim, stated)
        if not holds and opinion.method != "coarse lines":
            return contradicts(world, lobe, claim, stated, seed)
        best = opinion if best is None or not holds else _finer(opinion, best)
        if opinion.method == "short lattice":
            continue
        if holds and opinion.doubt.max() <= 0.5 * stated:
            return opinion, "honest"
        away = float(np.abs(opinion.value - claim).max())
        if agrees(away, float(opinion.doubt.max()), stated):
            return replace(opinion, agrees=True), "honest"
        doubtful = doubtful or away > NEAR * stated
        if not doubtful and (opinion.method != "lattice" or opinion.doubt.max() > 3.0 * stated):
            break
    assert best is not None
    return best, "honest"


def agrees(away: float, doubt: float, stated: float) -> bool:
    """Whether an opinion so far from a claim may end early, as ``CHANCE`` says."""
    return away <= NEAR * stated and away * doubt <= CHANCE * stated * stated


def opinions(world: World, lobe: Array, stated: float, seed: int) -> Iterator[Opinion]:
    """Opinions of a lobe, each dearer and finer than the one before, as long as somebody asks."""
    short = by_lattice(world, lobe, 128, seed, careful=False)
    yield replace(short, method="short lattice")
    sky = sky_alone(world, lobe)
    if sky is not None:
        yield sky
        return
    if short.doubt.max() <= 2.0 * stated:
        yield by_lattice(world, lobe, 512, seed + 6)
    if not len(world.disks):
        rough, most = max(ROUGH * stated, 1e-9), int(LOOKS * 6.0 / (6.0 + len(world.points)))
        first = Sweep(world, lobe, rough, 0.1, 24, EASE, most // 2)
        first.refine(rough, 3000, most // 2)
        if np.isfinite(first.result().doubt):
            yield replace(of_lines(world, lobe, first.result()), method="coarse lines")
        fine = Sweep(world, lobe, max(3.0 * stated, 1e-10), 0.77, 48, EASE, most)
        for tol in (max(3.0 * stated, 1e-10), max(0.3 * stated, 1e-10)):
            fine.refine(tol, 3000, most)
            if not np.isfinite(fine.result().doubt):
                break
            yield of_lines(world, lobe, fine.result())
            if fine.looks >= most:
                return
        else:
            return
    for k, count in enumerate((512, 4096)):
        yield by_lattice(world, lobe, count, seed + 7 + k)


def contradicts(world: World, lobe: Array, claim: Array, stated: float, seed: int) -> tuple[Opinion, str]:
    """An opinion of a lobe and what it calls a claimed value: ``honest`` or ``beyond``."""
    opinion, called = opposed(world, lobe, claim, stated, seed)
    if called == "beyond" and np.isfinite(opinion.value).all() and stands_in_a_surface(world):
        return Opinion(opinion.value, np.full(3, np.inf), "rounding says which side a light is on"), "honest"
    return opinion, called


def opposed(world: World, lobe: Array, claim: Array, stated: float, seed: int) -> tuple[Opinion, str]:
    """As ``contradicts``, of a world whose lights stand clear of surfaces."""
    if not np.isfinite(claim).all() or not np.isfinite(stated):
        return Opinion(np.zeros(3), np.zeros(3), "not finite"), "beyond"
    if lobe[THETA_MAX] == 0.0 and not len(world.disks):
        opinion = mirrored(world, lobe)
        return opinion, "honest" if _within(opinion, claim, stated) else "beyond"
    best = by_lattice(world, lobe, 512, seed, careful=False)
    if not len(world.disks):
        first = by_lines(world, lobe, max(0.3 * stated, 1e-10), 0.1, 48)
        if first is not None and not _within(first, claim, stated):
            second = by_lines(world, lobe, max(0.05 * stated, 1e-11), 0.77, 97, most=12_000)
            long = by_lattice(world, lobe, 16_384, seed + 1)
            if second is not None:
                # a sliver that all lines of two sweeps miss is no contradiction: a third looks far closer
                third = by_lines(world, lobe, max(0.05 * stated, 1e-11), 1.234, 400, most=12_000)
                sweeps = [first, second] if third is None else [first, second, third]
                values = np.array([opinion.value for opinion in sweeps])
                apart = values.max(axis=0) - values.min(axis=0)
                if (apart > first.doubt + second.doubt).any():
                    apart *= 2.0
                twice = Opinion(np.median(values, axis=0), second.doubt + apart, "lines thrice")
                if (np.abs(long.value - twice.value) <= long.doubt + twice.doubt).all():
                    if not _within(twice, claim, stated):
                        return twice, "beyond"
                    best = _finer(twice, best)
        elif first is not None:
            best = _finer(first, best)
    # where the finest opinion so far cannot tell, longer lattices; what they contradict, a longer one has to as well
    for k, count in enumerate((4096, 16_384)):
        if _within(best, claim, stated) and best.doubt.max() <= 3.0 * stated:
            return best, "honest"
        longer = by_lattice(world, lobe, count, seed + 2 + k)
        if not _within(longer, claim, stated):
            last = by_lattice(world, lobe, 131_072, seed + 5)
            return last, "honest" if _within(last, claim, stated) else "beyond"
        best = longer if not _within(best, claim, stated) else _finer(longer, best)
    return best, "honest"


def stands_in_a_surface(world: World) -> bool:
    """Whether a light point is as near to a sphere's surface as its coordinates are rounded, but not on it exactly.

    Inside it lights nothing, outside half of space: two computations of one place of a disk may differ in that.
    """
    for x, y, z, *_ in world.points:
        for cx, cy, cz, radius, *_ in world.spheres:
            level = (
                sum((Fraction(a) - Fraction(b)) ** 2 for a, b in ((x, cx), (y, cy), (z, cz))) - Fraction(radius) ** 2
            )
            size = max(abs(x), abs(y), abs(z), radius)
            if 0 < abs(level) <= 4e-16 * size * radius:
                return True
    return False


def _finer(one: Opinion, other: Opinion) -> Opinion:
    return one if one.doubt.max() < other.doubt.max() else other


def by_lattice(world: World, lobe: Array, count: int, seed: int, *, careful: bool = True) -> Opinion:
    """An opinion by lattices; a ``careful`` one doubts what no look may have met, others are hints."""
    found = lattice_value(world, lobe, count, seed)
    rules = world.rules
    smooth = rules[KA] * rules[AMBIENT:BACKGROUND] + rules[KD] * (
        world.points[:, 3:].sum(axis=0) + world.disks[:, 9:].sum(axis=0)
    )
    if rules[SHININESS] < BROAD:
        smooth = smooth + rules[KS] * (world.points[:, 3:].sum(axis=0) + world.disks[:, 9:].sum(axis=0))
    # narrow highlights have hats of their own; all other light may hide in a part of the lobe never met
    most = max(smooth.max(), rules[BACKGROUND:EYE].max()) if careful else 0.0
    rest = UNSEEN / found.looks * max(most, float(np.abs(found.value).max()))
    doubt = SIGMAS * found.sigma + rest + rounding(world, lobe) * np.abs(found.value)
    return Opinion(found.value, doubt, "lattice")


def sky_alone(world: World, lobe: Array) -> Opinion | None:
    """What a lobe sees that can meet no shape, or None: the background over the rings' arcs above the horizon.

    Lines share an error there that grows as the lobe narrows, up to 1e-6 of the value.
    """
    place, normal, mirror = lobe[PLACE:NORMAL], lobe[NORMAL:MIRROR], lobe[MIRROR:EXPONENT]
    half, exponent = float(lobe[THETA_MAX]), float(lobe[EXPONENT])
    if lobe[BRDF] != 0.0 or half == 0.0:
        return None
    for j, sphere in enumerate(world.spheres):
        away = sphere[:3] - place
        far = float(np.linalg.norm(away))
        if sphere[3] == 0.0 or j + 1 == lobe[SURFACE]:
            continue
        if far <= sphere[3]:
            return None
        if math.acos(max(-1.0, min(1.0, float(away @ mirror) / far))) < half + math.asin(sphere[3] / far):
            return None
    if world.floor[0] != 0.0 and lobe[SURFACE] != 0.0 and math.asin(max(-1.0, min(1.0, mirror[2]))) < half:
        return None
    tilt = math.acos(max(-1.0, min(1.0, float(mirror @ normal))))
    free = 0.5 * math.pi - tilt
    mass = -math.expm1((exponent + 1.0) * math.log(math.cos(half))) if half < 0.5 * math.pi else 1.0
    full = min(free, half)
    share = (-math.expm1((exponent + 1.0) * math.log(math.cos(full))) if full < 0.5 * math.pi else 1.0) / mass
    if free < half:

        def ring(s: float) -> float:
            theta = free + (half - free) * s * s
            x = -math.cos(theta) * math.cos(tilt) / (math.sin(theta) * math.sin(tilt))
            arc = math.acos(max(-1.0, min(1.0, x)))
            return arc * math.cos(theta) ** exponent * math.sin(theta) * 2.0 * (half - free) * s

        part = quad(ring, 0.0, 1.0, epsabs=0.0, epsrel=1e-12, limit=400)[0]
        share += part * (exponent + 1.0) / (math.pi * mass)
    value = world.rules[BACKGROUND:EYE] * share
    return Opinion(value, 1e-11 * np.abs(value) + 1e-300, "rings")


def by_lines(world: World, lobe: Array, tol: float, turn: float, cells: int, *, most: int = 3000) -> Opinion | None:
    """An opinion by one sweep, or None where lines cannot tell."""
    sky = sky_alone(world, lobe)
    if sky is not None:
        return sky
    found = swept_value(world, lobe, tol, turn=turn, cells=cells, most=most, most_looks=400 * most)
    return of_lines(world, lobe, found) if np.isfinite(found.doubt) else None


def of_lines(world: World, lobe: Array, found: Swept) -> Opinion:
    """What a sweep found, with what sweeps may share and rounding."""
    small = FINEST * np.abs(found.value).max() + rounding(world, lobe) * np.abs(found.value)
    return Opinion(found.value, found.doubt + small, "lines")


def mirrored(world: World, lobe: Array) -> Opinion:
    """The one direction of a mirror; beside a wall, where the last bits decide, the doubt is the jump."""
    value = mirror_value(world, lobe, np.empty(0))
    doubt = 16.0 * rounding(world, lobe) * np.abs(value)
    for k in range(3):
        for sign in (1.0, -1.0):
            near = lobe.copy()
            near[MIRROR + k] += 1e-12 * sign
            near[MIRROR:EXPONENT] /= np.linalg.norm(near[MIRROR:EXPONENT])
            doubt = np.maximum(doubt, np.abs(mirror_value(world, near, np.empty(0)) - value))
    return Opinion(value, doubt, "mirror")


def rounding(world: World, lobe: Array) -> float:
    """Relative error that doubles leave: high powers multiply what their bases lost."""
    return 1e-14 + 4e-16 * float(world.rules[SHININESS] + lobe[EXPONENT])


def _within(opinion: Opinion, claim: Array, stated: float) -> bool:
    return bool((np.abs(claim - opinion.value) <= stated + opinion.doubt).all())


def is_beyond(case: Case) -> bool:
    """Whether any point of a case is beyond its statement."""
    return any(v.called == "beyond" for v in judge(case))


LARGEST: Final = ("worst", "worst budget", "slowest s")
"""Columns of a table of which the largest counts; all others add."""


def summed(verdicts: list[Verdict]) -> dict[str, float]:
    """What a table says of a family's verdicts."""
    asked = [v for v in verdicts if v.called not in ("refused", "unsupported")]
    beyond = [v for v in asked if v.called == "beyond"]
    return {
        "values": len(asked),
        "refused": len(verdicts) - len(asked),
        "signal": sum(v.signal for v in asked),
        "met": sum(v.status == 0 for v in asked),
        "told at 1.5x": sum(v.told(1.5) for v in asked),
        "told at 100x": sum(v.told(100.0) for v in asked),
        "beyond": len(beyond),
        "beyond 1.5x": sum(v.ratio > 1.5 for v in beyond),
        "worst": max((v.ratio for v in beyond), default=0.0),
        "torn": sum(v.called == "torn" for v in asked),
        "overspent": sum(v.overspent for v in asked),
        "worst budget": max((v.evaluations / v.case.budget for v in asked), default=0.0),
        "slowest s": max((v.seconds for v in verdicts), default=0.0),
    }


def together(rows: Iterable[Mapping[str, float]]) -> dict[str, float]:
    """Rows of tables as one."""
    total: dict[str, float] = {}
    for row in rows:
        for name, count in row.items():
            before = total.get(name, 0)
            total[name] = max(before, count) if name in LARGEST else before + count
    return total
