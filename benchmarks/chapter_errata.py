"""What the source chapter states and what comes out when it is run: one measured figure for each erratum.

CHAPTER is the text of the source chapter, whose own program is run, as printed and repaired.
"""

from __future__ import annotations

import math

import numpy as np
from chapter_program import chapter_program
from measure import Report, arguments

from symrender.chapter.document.measure.claims import LOBES_OFF, brdf_albedo, strata_errors
from symrender.ledger.lobe_widths import lobe_widths
from symrender.render import render
from symrender.scene.load import load

EYE = 4.0
HALF = 1.25 * EYE / math.sqrt(EYE**2 - 1)


def classes(program: dict, width: int) -> list[int]:
    """Pixels that see sphere A, sphere B and the floor, by the chapter's own renderer."""
    code = program["render_symbolic_gloss"](width, width, program["SC8"] | {"krf": 0.0})[1]
    return [int((code == k).sum()) for k in (1, 2, 3)]


def jitter(program: dict, width: int) -> tuple[float, float]:
    """RMS difference of the chapter's two renderers with the lobe, and with the lobe off."""
    found = []
    for weight in (0.3, 0.0):
        scene = program["SC8"] | {"krf": weight}
        a, b = (program[f"render_{side}_gloss"](width, width, scene)[0] for side in ("numeric", "symbolic"))
        found.append(float(np.sqrt(((a - b) ** 2).mean())))
    return found[0], found[1]


def buried_share(printed: dict, repaired: dict, height: float) -> float:
    """Share of the lobe's average that comes from below the horizon, floor points around A seen at a low angle.

    The eye looks along -x, -y or -x -y from ``height`` degrees above the floor at points 1.3 from the axis.
    """
    totals = np.zeros(2)
    k, limit = 16, math.pi / 3
    for turn in (0.0, 45.0, 90.0):
        out = np.array([math.cos(math.radians(turn)), math.sin(math.radians(turn)), 0.0])
        rise = math.radians(height)
        mirror = -math.cos(rise) * out + (0.0, 0.0, math.sin(rise))
        u1 = np.array([-out[1], out[0], 0.0])
        u2 = np.cross(mirror, u1)
        for ring in range(k):
            tilt = (ring + 0.5) / k * limit
            weight = math.cos(ring / k * limit) ** 17 - math.cos((ring + 1) / k * limit) ** 17
            for sector in range(k):
                phi = 2 * math.pi * (sector + 0.5) / k
                ray = math.cos(tilt) * mirror + math.sin(tilt) * (math.cos(phi) * u1 + math.sin(phi) * u2)
                totals += [weight * program["scene_at"](1.3 * out, ray).sum() for program in (printed, repaired)]
    return float(1 - totals[1] / totals[0])


def ratio_bias(k: int, trials: int) -> float:
    """Relative bias of the chapter's numeric estimator for f = 1 - cos theta, n = 16, theta_max = pi/3."""
    rng = np.random.default_rng(1)
    depth = (np.arange(k)[None, :, None] + rng.random((trials, k, k))) / k * 0.5
    weight = (1 - depth) ** 16
    estimate = ((weight * depth).sum(axis=(1, 2)) / weight.sum(axis=(1, 2))).mean()
    u = 17
    true = 1 - u / (u + 1) * (1 - 0.5 ** (u + 1)) / (1 - 0.5**u)
    return float(estimate / true - 1)


def main() -> None:
    options = arguments(__doc__, "chapter")
    report = Report("chapter_errata", "The source chapter's claims, each beside the figure its scene gives.")
    printed, repaired = (chapter_program(options.chapter, repaired=r) for r in (False, True))
    width = 64
    wrong, right = classes(printed, width), classes(repaired, width)
    small = 32 if options.quick else 96
    with_lobe, without_lobe = jitter(repaired, small)
    scene = load("chapter8").replace(LOBES_OFF)
    image = render(scene, size=256, numeric="none", lobe=64, aa="none").symbolic
    brightest = float(image.layers["gloss"].max())
    probes = [math.hypot(0.35, 0.62 * HALF), math.hypot(0.9, 0.35)]
    edge = EYE / math.sqrt(EYE**2 - 1)
    corner = math.degrees(math.atan(math.hypot(HALF, 1.15 * HALF) / EYE))
    buried = [buried_share(printed, repaired, height) for height in (30, 20, 10)]
    strata = strata_errors(scene, 64 if options.quick else 96)
    biases = [ratio_bias(k, 20_000) for k in (2, 4, 8)]
    widths = lobe_widths("floor", 16.0, math.pi / 3)
    albedo = [brdf_albedo(64, angle) for angle in (0, 30, 60, 80)]
    exact, centroid = (", ".join(f"{row[c]:.1e}" for row in strata) for c in (1, 2))
    rows = [
        ("the two spheres on their floor are drawn", f"as printed, sphere B fills {wrong[1]} of {width**2} pixels; "
         f"repaired: A {right[0]}, B {right[1]}, floor {right[2]}"),
        ("the reflection is a soft smudge", f"its gloss is at most {brightest:.4f}, before the weight .3"),
        ("the difference of the two renderers is the lobe's", f"RMS {with_lobe:.2e} with the lobe, "
         f"{without_lobe:.2e} without: the disk light's jitter"),
        ("lobes are probed at floor points", f"r = {probes[0]:.3f} and {probes[1]:.3f}, inside sphere A; "
         f"the visible floor begins at {edge:.3f}"),
        ("upward directions see nothing", "the sign is reversed; unclipped, the buried half of A gives "
         f"{', '.join(f'{100 * b:.0f} %' for b in buried)} of the gloss seen at 30, 20, 10 degrees"),
        ("exact weights beat centroid weights", f"RMS at K = 2, 4, 8: exact {exact}; centroid {centroid}"),
        ("the numeric estimator is unbiased", "for 1 - cos theta at K = 2, 4, 8 it is off by "
         f"{', '.join(f'{100 * b:+.2g} %' for b in biases)}"),
        ("the lobe is 1/sqrt(2n) wide", f"n = 16: {widths.chapter_ruler:.3f}; per axis {widths.sigma:.3f}, "
         f"RMS angle {widths.rms_angle:.3f}"),
        ("pictures agree after renormalising to BRDF units", "albedo of that lobe, n = 64, at 0, 30, 60, 80 degrees: "
         f"{', '.join(f'{a:.3f}' for a in albedo)}"),
        ("the lobe crosses the horizon", f"it reaches at most {corner + 60:.1f} degrees from the normal"),
    ]  # fmt: skip
    report.table(("stated or implied", "measured"), rows)
    report.say(
        f"Errors of weights: RMS over a picture {64 if options.quick else 96} pixels a side, against 96 x 96 strata of "
        "equal weight."
    )
    report.claim_number("pixels that do not see sphere B, as printed", width**2 - wrong[1], 0)
    report.leave()


if __name__ == "__main__":
    main()
