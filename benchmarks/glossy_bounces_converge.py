"""One bounce of light reaches 1e-9 from rough surfaces of any alpha, at the cost of a cosine power.

    python benchmarks/glossy_bounces_converge.py [--quick] [--picture FILE]

Two diffuse balls, one checkered, over a floor of GGX under a lamp, at three places: what the mirror direction meets is
a ball, its limb, and the dark. Errors are those against a run at 1e-12. The cost is that of the same rays where the
floor is phong with as narrow a lobe, n = 2/alpha^2 - 2, both at 1e-4. The image of ``metal`` is timed at 64 x 64 and
told for sixteen times as many pixels. ``--picture`` draws error against evaluations, at tolerances from 1e-2 to 1e-10,
and does nothing else.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any, Final

import numpy as np
from measure import Report, cpu_seconds, interleaved, median

import symrender as sr

ALPHAS = (0.3, 0.1, 0.03, 0.01)
PLACES = ([0.3, -1.2, 0.0], [0.93, -0.8, 0.0], [-1.6, 0.9, 0.0])
EYE = [0.5, -6.0, 2.2]
ASKED, ENOUGH = 1e-9, 100_000
DRAWN: Final = tuple(10.0**-k for k in range(2, 11))
"""Tolerances of the picture."""
LOOKS: Final = (("#0072B2", "ball"), ("#D55E00", "limb"), ("#009E73", "dark"))
"""Colours and names of the places."""


def scene(floor: dict[str, Any]) -> Any:
    """Two diffuse balls over a floor of this material."""
    checker = {"type": "checker", "bright": [0.8, 0.6, 0.3], "dark": 0.1, "cell": 0.25}
    return sr.load(
        {
            "units": "radiometric",
            "name": "converge",
            "bounces": 1,
            "camera": {"type": "look_at", "eye": EYE, "target": [0, 0, 0.3], "fov": 30},
            "materials": {
                "floor": floor,
                "A": {"type": "diffuse", "reflectance": 0.7},
                "B": {"type": "diffuse", "reflectance": checker},
            },
            "shapes": [
                {"type": "plane", "name": "floor", "point": [0, 0, 0], "normal": [0, 0, 1], "material": "floor"},
                {"type": "sphere", "name": "A", "center": [-0.5, 0.3, 0.7], "radius": 0.7, "material": "A"},
                {"type": "sphere", "name": "B", "center": [0.9, 0.1, 0.45], "radius": 0.45, "material": "B"},
            ],
            "lights": [{"type": "point", "name": "key", "position": [-2, -4, 5], "intensity": [60, 50, 40]}],
        }
    )


def rough(alpha: float) -> dict[str, Any]:
    """GGX."""
    return {"type": "conductor", "alpha": alpha, "eta": [0.18, 0.42, 1.37], "k": [3.42, 2.35, 1.77]}


def draw(file: Path) -> None:
    """The picture: a panel an alpha; what is stated is hollow, what is off is full, a colour a place."""
    from matplotlib.figure import Figure

    page = Figure(figsize=(13.0, 3.8), layout="constrained", facecolor="white")
    rays = (EYE, np.array(PLACES) - EYE)
    for axes, alpha in zip(page.subplots(1, len(ALPHAS), sharey=True), ALPHAS, strict=True):
        made = scene(rough(alpha))
        best = sr.probe(made, rays=rays, tol=1e-12)
        looks = [sr.probe(made, rays=rays, tol=tol) for tol in DRAWN]
        for k, (color, name) in enumerate(LOOKS):
            spent = [int(seen.evaluations[k]) for seen in looks]
            # an error of nothing stands at the foot of the picture
            off = [max(1e-15, float(np.abs(seen.indirect[k] - best.indirect[k]).max())) for seen in looks]
            axes.plot(spent, off, "o-", color=color, lw=1, ms=4, label=f"{name}, off by")
            axes.plot(spent, [float(seen.error[k]) for seen in looks], "o--", color=color, mfc="white", lw=1, ms=4,
                      label=f"{name}, stated")  # fmt: skip
        axes.set(xscale="log", yscale="log", title=f"GGX, alpha {alpha:g}", xlabel="evaluations", ylim=(5e-16, 1e-1))
    page.axes[0].set_ylabel("error, W/(m2 sr)")
    page.axes[-1].legend(fontsize=6.5, loc="lower left")
    page.savefig(file, dpi=110)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="fewer rounds")
    parser.add_argument("--picture", type=Path, help="file to draw error against evaluations to")
    options = parser.parse_args()
    if options.picture is not None:
        draw(options.picture)
        return
    quick = options.quick
    report = Report("glossy_bounces_converge", "One bounce reaches 1e-9 from rough surfaces within 1e5 evaluations.")
    rays = (EYE, np.array(PLACES) - EYE)
    rows, most, worst, late = [], 0, 0.0, 0
    for alpha in ALPHAS:
        made = scene(rough(alpha))
        best, found = sr.probe(made, rays=rays, tol=1e-12), sr.probe(made, rays=rays, tol=ASKED)
        for k in range(len(PLACES)):
            true = float(np.abs(found.indirect[k] - best.indirect[k]).max())
            rows.append([alpha, k, float(best.indirect[k].max()), int(found.evaluations[k]), true,
                         float(found.error[k])])  # fmt: skip
            most, worst = max(most, int(found.evaluations[k])), max(worst, true / float(found.error[k]))
            late += int(found.status[k] != 0)
    report.say(f"{len(rows)} values, {late} of them not met within a million evaluations.")
    report.table(["alpha", "place", "light", "evaluations", "true error", "stated"], rows)
    report.claim_number("most evaluations over 1e5", most / ENOUGH, 1.0)
    report.claim_number("largest true error over the stated one", worst, 1.0)
    ratios, rng = [], np.random.default_rng(0)
    aims = np.column_stack([rng.uniform(-2, 2, 40), rng.uniform(-3, 1, 40), np.zeros(40)])
    many = (EYE, aims - EYE)
    for alpha in ALPHAS[:3]:
        pair = {"ggx": scene(rough(alpha)), "power": scene({"type": "phong", "exponent": 2.0 / alpha**2 - 2.0})}

        def run(name: str, pair: dict[str, Any] = pair) -> Any:
            return sr.probe(pair[name], rays=many, tol=1e-4, threads=1)

        times = interleaved({name: lambda name=name, run=run: run(name) for name in pair}, 2 if quick else 7)
        ratios.append(median(times["ggx"]) / median(times["power"]))
        report.say(f"- alpha {alpha:g}: {ratios[-1]:.2f} times the CPU time of cos^n over the same 40 places")
    report.claim_number("largest ratio", max(ratios), 2.5)
    metal = sr.load("metal").replace({"bounces": 1})
    sr.truth(metal, size=4, tol=1e-4, threads=1)
    held = cpu_seconds(lambda: sr.truth(metal, size=32 if quick else 64, tol=1e-4, threads=1))
    held *= 64.0 if quick else 16.0
    report.say(f"- `metal` with a bounce at 1e-4: {held:.0f} CPU seconds for 256 x 256, {held / 2:.0f} on two threads")
    report.claim_time("seconds of 256 x 256 on two threads", held / 2.0, 0, 60)
    report.leave()


if __name__ == "__main__":
    main()
