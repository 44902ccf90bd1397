"""Audits fail mistakes planted in a path tracer and pass the tracer without them.

Every mutant that moves a mean beyond the stated power must fail. Those that pass are rendered again with eight times
the samples: no region may then be off by more than the first audit said it would see. The right tracer is audited a
thousand times at level .01, by moments and by seeds.
"""

from __future__ import annotations

import math

import numpy as np
from measure import Report, arguments
from mutants import MUTANTS, NOISE_FREE, SCENES, Mutant, planted, rendered, scene_of

import symrender as sr
from symrender.audit.audit import Auditor
from symrender.audit.measured import measured
from symrender.images.image import Image
from symrender.scene.load import AnyScene

SIZE = (24, 16)
LEVEL = 0.01


def audited(mutant: Mutant, scene: AnyScene, true: Image, samples: int) -> sr.Verdict:
    exact = mutant.scene in NOISE_FREE
    with planted(mutant):
        image = rendered(scene, SIZE, 1 if exact else samples, 11, plain=True)
    return sr.audit(image, scene, truth=true, samples=samples, noise_free=exact, level=LEVEL, explain=False)


def hidden(seen: sr.Verdict, mutant: Mutant, scene: AnyScene, true: Image, samples: int) -> bool:
    """Whether eight times the samples show no region further off than the first audit said it would see."""
    again = audited(mutant, scene, true, 8 * samples)
    pairs = zip(seen.regions, again.regions, strict=True)
    return all(abs(b.bias) - 3.0 * b.error <= max(a.visible, 1e-12) for a, b in pairs)


def interval(count: int, rate: float, tail: float) -> tuple[int, int]:
    """The central interval of a binomial count that leaves ``tail`` on each side."""
    total, low, high = 0.0, 0, count
    for k in range(count + 1):
        ways = math.lgamma(count + 1) - math.lgamma(k + 1) - math.lgamma(count - k + 1)
        before = total
        total += math.exp(ways + k * math.log(rate) + (count - k) * math.log1p(-rate))
        low = k if before <= tail < total else low
        if total >= 1.0 - tail:
            high = k
            break
    return low, high


def alarms(kind: str, scene: AnyScene, true: Image, count: int, samples: int) -> int:
    """How many of ``count`` audits of the right tracer fail."""
    # as ``audit`` judges, but the regions of a truth are found once
    auditor, found = Auditor(scene, true, 0.0, 0, (), False), 0
    for k in range(count):
        if kind == "moments":
            seen = measured([rendered(scene, SIZE, samples, 1000 + k, plain=False)], samples)
        else:
            seen = measured([rendered(scene, SIZE, samples // 8, 100_000 + 8 * k + s, plain=False) for s in range(8)])
        found += not auditor.verdict(seen, LEVEL, 1).passed
    return found


def main() -> None:
    options = arguments(__doc__)
    samples, mutants = (16, MUTANTS[::4]) if options.quick else (32, MUTANTS)
    report = Report(
        "audit_catches_mutants", f"{len(mutants)} mutants, {SIZE[0]} x {SIZE[1]} pixels, {samples} samples."
    )
    scenes = {name: scene_of(name) for name in SCENES}
    truths = {name: sr.truth(scene, size=SIZE, tol=1e-7) for name, scene in scenes.items()}
    rows, missed, wrongly = [], 0, 0
    for mutant in mutants:
        scene, true = scenes[mutant.scene], truths[mutant.scene]
        verdict = audited(mutant, scene, true, samples)
        worst = max((*verdict.tests, *verdict.regions), key=lambda test: abs(test.z))
        rejected = verdict.pixels.rejected
        said = "caught"
        if verdict.passed:
            below = hidden(verdict, mutant, scene, true, samples)
            said = "below the stated power" if below else "MISSED"
            missed += not below
        wrongly += mutant.same and not verdict.passed
        where = f"{worst.region} {worst.channel}"
        off = "inf" if math.isinf(worst.z) else f"{worst.z:+.1f}"
        rows.append((mutant.name, mutant.scene, said, where, off, f"{worst.visible_relative:.2g}", str(rejected)))
    report.table(("mutant", "scene", "audit", "furthest off", "z", "visible there, of truth", "pixels rejected"), rows)
    counts, alarmed = 0, 0
    lines = []
    each = 25 if options.quick else 250
    for kind in ("moments", "seeds"):
        for name in ("bounce", "sky"):
            found = alarms(kind, scenes[name], truths[name], each, 64)
            lines.append((kind, name, str(each), str(found)))
            counts, alarmed = counts + each, alarmed + found
    report.table(("variance from", "scene", "audits", "false alarms"), lines)
    low, high = interval(counts, LEVEL, 0.005)
    report.say(
        f"The level {LEVEL:g} allows {low} to {high} of {counts} audits to fail, 99 times of 100; {alarmed} did."
    )
    assert all(np.isfinite(t.radiance).all() for t in truths.values())
    report.claim_number("mutants missed that move a mean beyond the stated power", missed, 0)
    report.claim_number("mutants failed that move no mean", wrongly, 0)
    report.claim_number("false alarms of the right tracer", alarmed, high)
    report.claim_number("false alarms too few for the level", max(0, low - alarmed), 0)
    report.leave()


if __name__ == "__main__":
    main()
