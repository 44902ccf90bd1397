"""What the source chapter states and what comes out when it is run: one measured figure for each erratum.

CHAPTER is the text of the source chapter, whose own program is run, as printed and repaired.
"""

from __future__ import annotations

import math

from chapter_program import chapter_program
from measure import Report, arguments

from symrender.chapter.document.effort import FULL, QUICK
from symrender.chapter.document.figures import shown
from symrender.chapter.document.measure import claims, mishaps

EYE = 4.0


def classes(program: dict, width: int) -> list[int]:
    """Pixels that see sphere A, sphere B and the floor, by the chapter's own renderer."""
    code = program["render_symbolic_gloss"](width, width, program["SC8"] | {"krf": 0.0})[1]
    return [int((code == k).sum()) for k in (1, 2, 3)]


def in_percent(value: float, form: str = "percent") -> str:
    """A share as the chapter document prints it."""
    return shown(value, form).replace("\N{NARROW NO-BREAK SPACE}", " ")


def main() -> None:
    options = arguments(__doc__, "chapter")
    report = Report("chapter_errata", "The source chapter's claims, each beside the figure its scene gives.")
    printed, repaired = (chapter_program(options.chapter, repaired=r) for r in (False, True))
    width = 64
    wrong, right = classes(printed, width), classes(repaired, width)
    effort = QUICK if options.quick else FULL
    figures = {**claims.measure(effort).figures, **mishaps.measure(effort).figures}
    at = {name: float(figures[name].value) for name in figures if not isinstance(figures[name].value, str)}
    edge = EYE / math.sqrt(EYE**2 - 1)
    albedo = [claims.brdf_albedo(64, angle) for angle in (0, 30, 60, 80)]
    steps = ("two", "four", "eight")
    exact, centroid = (", ".join(f"{at[f'claims.{kind}_{k}']:.1e}" for k in steps) for kind in ("exact", "midpoint"))
    buried = ", ".join(in_percent(at[f"claims.buried_{angle}"]) for angle in (30, 20, 10))
    biases = ", ".join(in_percent(at[f"pitfalls.ratio_{k}"], "signed") for k in steps)
    points = f"{at['claims.sweep']:.3f} and {at['claims.grazing']:.3f}"
    reach = math.degrees(at["claims.reach"])
    beyond, toward = (in_percent(at[f"claims.{name}"], "signed") for name in ("beyond_terminator", "toward_camera"))
    rows = [
        ("the two spheres on their floor are drawn", f"as printed, sphere B fills {wrong[1]} of {width**2} pixels; "
         f"repaired: A {right[0]}, B {right[1]}, floor {right[2]}"),
        ("times grow with K squared", f"as printed {wrong[2]} pixels see the floor: no lobe is sampled"),
        ("the reflection is a soft smudge", f"its gloss is at most {at['claims.brightest']:.3g}, before the weight .3"),
        ("the spheres reflect faintly", f"printed: not computed; RMS {at['claims.kiss']:.3g} over "
         f"{at['claims.kissed']:.0f} sphere pixels at their weight .05"),
        ("the difference of the two renderers is the lobe's", f"RMS {at['claims.least_apart']:.4f} to "
         f"{at['claims.most_apart']:.4f} over {at['claims.seeds']:.0f} seeds, the disk light's jitter; without the "
         f"lobe, that changes by at most {at['claims.lobe_apart']:.0e}"),
        ("n to 4096 snaps the difference to black", f"RMS in gloss {at['claims.slider_start']:.4f} at n = 256, "
         f"{at['claims.slider_end']:.4f} at 4096, {at['claims.slider_narrow']:.4f} in a cone of half a degree"),
        ("speckle thickens with the blur", f"n = 4096 to 1: jittered {at['claims.jittered_needle']:.4f} to "
         f"{at['claims.jittered_wide']:.4f}, importance {at['claims.importance_needle']:.4f} to "
         f"{at['claims.importance_wide']:.4f}"),
        ("Cell 6 confirms the anchor", f"repaired, it compares zero with zero: brightest mirror image "
         f"{at['claims.mirrored']:.3g} over {at['claims.mirrored_pixels']:.0f} floor pixels"),
        ("gloss tends to the mirror", "only where light is continuous there; at the edge of a sphere of radiance 1: "
         f"{at['claims.edge']:.4f} at n = 1e4, {at['claims.edge_late']:.4f} at 1e8"),
        ("lobes are probed at floor points", f"r = {points}, inside sphere A; "
         f"the visible floor begins at {edge:.3f}"),
        ("upward directions see nothing", "the sign is reversed; unclipped, the buried half of A gives "
         f"{buried} of the gloss seen at 30, 20, 10 degrees"),
        ("reflections are shaded like the rest", "toward the camera; toward the reflecting point, the RMS of the "
         f"floor's gloss changes by {toward}"),
        ("a highlight is a power of N.h", "it must end where N.l = 0; left on, it adds "
         f"{beyond} to that gloss"),
        ("exact weights beat centroid weights", f"RMS at K = 2, 4, 8: exact {exact}; centroid {centroid}"),
        ("the numeric estimator is unbiased", "for 1 - cos theta at K = 2, 4, 8 it is off by "
         f"{biases}"),
        ("the lobe is 1/sqrt(2n) wide", f"n = 16: {at['claims.ruler']:.3f}; per axis {at['claims.axis']:.3f}, "
         f"RMS angle {at['claims.rms']:.3f}"),
        ("(n + 2)/(2 pi) is a divisor", "it multiplies: a white world along the normal, n = 16, returns "
         f"{at['claims.multiplied']:.3f} multiplied, {at['claims.divided']:.3f} divided"),
        ("pictures agree after renormalising to BRDF units", "albedo of that lobe, n = 64, at 0, 30, 60, 80 degrees: "
         f"{', '.join(f'{a:.3f}' for a in albedo)}"),
        ("the lobe crosses the horizon", f"it reaches at most {reach:.1f} degrees from the normal"),
    ]  # fmt: skip
    report.table(("stated or implied", "measured"), rows)
    report.say(
        "The first row is what the chapter's own program draws; the others are what the chapter document of symrender "
        f"measures and prints too. Errors of weights: RMS over a picture {effort.errata} pixels a side, against "
        "96 x 96 strata of equal weight."
    )
    report.claim_number("pixels that do not see sphere B, as printed", width**2 - wrong[1], 0)
    report.leave()


if __name__ == "__main__":
    main()
