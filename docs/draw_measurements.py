"""Writes docs/measurements.md from benchmarks/results.md: claim, figure, target, verdict and command.

``benchmarks/run.py --out benchmarks/results.md`` makes the results. ``--check`` fails where the page differs.
"""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
RESULTS = ROOT / "benchmarks" / "results.md"
PAGE = ROOT / "docs" / "measurements.md"
SECTION = re.compile(r"^## (\w+)\n(.*?)(?=^## |\Z)", re.DOTALL | re.MULTILINE)
VERDICT = re.compile(r"^- (.*): (\S+(?: s)?), target (.*): (held|MISSED|missed here)$", re.MULTILINE)
MITSUBA = ("ray_offset", "projective_gradients", "beckmann_sampling", "small_penumbra")
"""Benchmarks that need a Python with Mitsuba 3."""
CLAIMS: Mapping[str, str] = {
    "far_squares_are_stated": "Error estimates hold for spheres that reflect a checker reaching to the horizon.",
    "pipelines_agree": "Two pipelines that share no formula compute the same radiance along the same rays.",
    "weights_sum_to_the_normaliser": "Stratum weights sum to the lobe's normaliser for every exponent.",
    "mirror_anchor": "The lobe average converges to the mirror as 1/n, away from discontinuities.",
    "exact_weights_cost_nothing": "Exact stratum weights cost no more time than midpoint weights.",
    "threads_scale": "Two threads take half the time of one, and the image has the same bytes.",
    "starts_quickly": "A new process shows its first picture within seconds.",
    "survives_kills": "A killed run that is resumed writes the bytes of an uninterrupted run.",
    "never_a_partial_file": "A failed write leaves the old file or the new one, never a partial one.",
    "survives_worker_deaths": "Killed cluster workers change no byte of the image.",
    "interrupts_within_a_second": "Ctrl-C ends a run within a second with exit code 130.",
    "fuzz_scene_files": "No scene file causes a traceback, a long wait or large memory use.",
    "strata_equal_the_chapter": "The strata images equal those of the corrected chapter program.",
    "chapter_errata": "Figures of the source chapter, measured. See the chapter page.",
    "kernel_keeps_up_with_c": "A generated kernel is as fast as C written by hand for one scene.",
    "split_is_honest": "At least 99.9 % of random lobes are within their stated error.",
    "truth_takes_seconds": "A reference to 1e-6 in every pixel of 256 x 256 takes seconds to a minute.",
    "gradients_equal_differences": "Exact gradients equal extrapolated finite differences.",
    "gradient_costs_a_few_images": "A gradient in three coordinates costs a few images. "
    "The target has since been lowered to 3.5.",
    "one_bounce_beats_mitsuba": "One bounce between diffuse surfaces takes less CPU time than Mitsuba's path tracer.",
    "cornell_beats_mitsuba": "The Cornell box takes less CPU time than Mitsuba's path tracer.",
    "split_beats_sampling": "The split rule takes less CPU time than the best hand-written C sampler.",
    "audit_catches_mutants": "Audits detect mistakes planted in a path tracer and pass the correct one.",
    "audits_a_million_pixels": "A million pixels are audited in ten CPU seconds after the reference is made.",
    "suite_shows_mutants": "The truth suite shows planted mistakes after few samples a pixel.",
    "adversary": "Values of scenes chosen to hurt are within their stated error.",
    "mitsubas_offset_is_predicted": "Mitsuba's ray offset explains the difference of its bounced light.",
    "ray_offset": "Bounced light in Mitsuba is that of a surface moved by its ray offset.",
    "projective_gradients": "Derivatives of box-filtered images against Mitsuba's projective integrators.",
    "beckmann_sampling": "Mitsuba's Beckmann sampling does not match the density it is weighted by.",
    "small_penumbra": "Mitsuba's projective gradients are biased in a small image of a penumbra.",
    "glossy_bounces_converge": "One bounce from rough metal reaches 1e-9 within 1e5 evaluations.",
    "simulator_holds_on_a_gpu": "The simulator's shaders on a GPU draw what double precision computes.",
    "many_spheres_cost_little": "Time a pixel grows slower than the number of spheres.",
    "flanks_are_stated": "Values on the flank of a highlight are within their stated error.",
}
MEANINGS: Mapping[tuple[str, str], str] = {
    ("far_squares_are_stated", "worst true error"): "One of 3,248 values at 1e-4 is off by 4.5 times its stated error. "
    "Ask 1e-5 where a sphere reflects a checker horizon.",
    ("starts_quickly", "empty cache, 512"): "The first picture of a new installation takes about ten seconds. "
    "Later ones take about one.",
    ("cornell_beats_mitsuba", "bounces 1, relative RMSE 0.01"): "For one percent without an error estimate, a path "
    "tracer is quicker. The radiosity mesh has a minimal size.",
    ("cornell_beats_mitsuba", "bounces all, relative RMSE 0.01"): "For one percent without an error estimate, a path "
    "tracer is quicker.",
    ("split_beats_sampling", "relative RMSE 0.0001"): "In this view the split rule is 7 times as fast as the C "
    "sampler, not 20 times.",
    ("glossy_bounces_converge", "seconds of 256 x 256"): "An image of `metal` with one bounce takes minutes. Use a "
    "smaller size or a looser tolerance first.",
    ("many_spheres_cost_little", "largest exponent"): "Crowds cost more than hoped: 16 spheres take 3.2 times the "
    "time of 4, 256 take 3.1 times that of 64.",
}
"""What a missed target means for a user, by benchmark and the beginning of the figure's name."""


def sections(text: str) -> dict[str, str]:
    """Output of every benchmark by its name."""
    return dict(SECTION.findall(text))


def verdicts(text: str) -> Iterator[tuple[str, str, str, str]]:
    """(figure, value, target, verdict) of every claim that a benchmark printed."""
    for what, value, target, verdict in VERDICT.findall(text):
        yield what, value, target, "met" if verdict == "held" else "MISSED"


def command(name: str) -> str:
    """What runs a benchmark."""
    return f"python benchmarks/{'mitsuba/' if name in MITSUBA else ''}{name}.py"


def meaning(name: str, what: str) -> str:
    """What a missed target means."""
    for (benchmark, beginning), words in MEANINGS.items():
        if name == benchmark and what.startswith(beginning):
            return words
    raise SystemExit(f"{name}: {what}: a missed target without a meaning")


def page(text: str) -> str:
    """The page that these results make."""
    found = sections(text)
    made = re.search(r"on (\d{4}-\d\d-\d\d): (.*?)\. Figures", text)
    assert made is not None
    rows = {name: list(verdicts(body)) for name, body in found.items()}
    every = [(name, row) for name, part in rows.items() for row in part]
    missed = [(name, row) for name, row in every if row[3] == "MISSED"]
    lines = [
        "# Measurements",
        "",
        f"{len(every)} figures with a target, of {len(rows)} benchmarks: {len(every) - len(missed)} met, "
        f"{len(missed)} missed. Times belong to one machine ({made[2]}) which ran other work.",
        "",
        "`make bench` runs short versions. The full output, with every table, is in `benchmarks/results.md`; "
        "`docs/draw_measurements.py` makes this page of it. [Validation](validation.md) lists what was judged by "
        "independent evaluators.",
        "",
        "## Missed targets",
        "",
        "| benchmark | figure | value | target | what it means for you |",
        "| --- | --- | --- | --- | --- |",
        *(
            f"| [{name}](#{name}) | {what} | {value} | {target} | {meaning(name, what)} |"
            for name, (what, value, target, _) in missed
        ),
    ]
    for name, part in rows.items():
        lines += ["", f"## {name}", "", CLAIMS[name], "", f"    {command(name)}", ""]
        if part:
            head = ["<!-- printed -->", "| figure | value | target | verdict |", "| --- | --- | --- | --- |"]
            lines += [*head, *(f"| {' | '.join(row)} |" for row in part), "<!-- /printed -->"]
        else:
            lines += ["Its tables are in `benchmarks/results.md`."]
    return "\n".join(lines) + "\n"


def main() -> None:
    """Write the page, or compare."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true", help="write nothing, fail where the page differs")
    options = parser.parse_args()
    made = page(RESULTS.read_text("utf-8"))
    if options.check:
        sys.exit("docs/measurements.md is not as generated" if PAGE.read_text("utf-8") != made else 0)
    PAGE.write_text(made, "utf-8")


if __name__ == "__main__":
    main()
