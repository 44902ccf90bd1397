"""Error against cost: strata, samples and the split rule on one scene, against truth that is none of them."""

from __future__ import annotations

from typing import Any, Final

from symrender.chapter.document.effort import Effort
from symrender.chapter.document.figures import Figure, Measured, figures_of, merged, real
from symrender.chapter.document.plots import Curve, log_log
from symrender.chapter.document.tables import study_table
from symrender.studies.budget import budget
from symrender.studies.convergence import convergence
from symrender.studies.weights import weights

_ESTIMATORS: Final = (
    "strata-angle", "strata-angle-midpoint-weights", "strata-weight-barycentre", "jittered", "sobol", "split"
)  # fmt: skip
_COMPARED: Final = 8
"""K at which two kinds of weights are compared."""
_WORDS: Final = {
    "strata-angle": "strata, equal angles",
    "strata-angle-midpoint-weights": "the same, midpoint weights",
    "strata-weight-barycentre": "strata of equal weight",
    "jittered": "jittered samples",
    "sobol": "Sobol samples of the lobe",
    "split": "split at the walls",
}


def measure(effort: Effort) -> Measured:
    """Blocks ``convergence.*``, ``weights.*`` and ``budget.table``, and their figures."""
    found = convergence(
        "gloss", size=effort.study, estimators=_ESTIMATORS, lobes=effort.lobes, tolerances=effort.tolerances,
        repeats=effort.repeats,
    )  # fmt: skip
    facts = found.study.facts
    source = f"study convergence, gloss, {facts['size']}, {facts['pixels judged']} pixels"
    witness = min((p for p in found.points if p.family != "split"), key=lambda p: p.relative)
    figures: dict[str, Figure] = figures_of(
        "convergence",
        source,
        pixels=int(facts["pixels judged"] or 0),
        signal=float(facts["signal, RMS"] or 0),
        own=float(facts["relative to the signal"] or 0),
        witness=witness.relative,
        witness_name=f"{_WORDS[witness.estimator]} ({witness.knob})",
        size=str(facts["size"]),
    )
    curves = []
    for color, name in enumerate(_ESTIMATORS):
        points = [p for p in found.points if p.estimator == name]
        low, high = [max(p.low, 1e-9) for p in points], [p.high for p in points]
        x, y = [p.evaluations for p in points], [p.relative for p in points]
        curves.append(Curve(_WORDS[name], x, y, color, dashed=points[0].family == "samples", low=low, high=high))
        key = f"convergence.{name.replace('-', '_')}"
        best = min(points, key=lambda p: p.relative)
        figures[f"{key}.best"] = Figure(best.relative, f"{source}; {best.knob}, {best.evaluations} evaluations")
        figures[f"{key}.cost"] = Figure(best.evaluations, f"{source}; {best.knob}")
        figures[f"{key}.seconds"] = Figure(best.seconds, f"{source}; {best.knob}, processor seconds of one thread")
    for fit in found.fits:
        if fit.cost == "evaluations":
            words = f"{source}; 95 % interval {fit.law.low:.2f} to {fit.law.high:.2f}, {fit.law.points} points"
            figures[f"convergence.{fit.estimator.replace('-', '_')}.order"] = Figure(fit.law.order, words)
    plot = log_log(
        "convergence", curves, x="evaluations, whole picture", y="RMS error / RMS of the truth",
        level={"a black picture": 1.0},
        alt="Relative error against evaluations: strata and samples fall slowly, the split rule steeply",
    )  # fmt: skip
    keep = {"estimator": "estimator", "knob": "setting", "evaluations": "evaluations", "seconds": "seconds",
            "relative": "error", "low": "at least", "high": "at most", "bias": "bias"}  # fmt: skip
    blocks = {
        "convergence.plot": plot,
        "convergence.table": study_table(found.study.table("error against cost"), keep),
        "convergence.orders": study_table(found.study.table("observed order")),
    }
    return merged([Measured(figures, blocks), _weights(effort), _budget(effort)])


def _weights(effort: Effort) -> Measured:
    found = weights("gloss", size=effort.study, lobes=effort.lobes)
    source = f"study weights, {found.facts['size']}"
    crossed, smooth = (found.table(title) for title in ("walls cross", "no wall"))
    at = crossed.column("K").index(_COMPARED)
    ratios = {
        f"{case}_{rule}": [
            real(a) / real(b) for a, b in zip(errors.column(name), errors.column("midpoint"), strict=True)
        ]
        for case, errors in (("crossed", crossed), ("smooth", smooth))
        for rule, name in (("exact", "exact"), ("barycentre", "exact, barycentre"))
    }
    figures = figures_of(
        "weight_choice",
        source,
        walls=float(found.facts["walls met a lobe"] or 0),
        smooth_walls=float(found.facts["smooth scene, walls met a lobe"] or 0),
        k=int(smooth.column("K")[at]),
        smooth_exact=float(smooth.column("exact")[at]),
        smooth_midpoint=float(smooth.column("midpoint, normalised")[at]),
        smooth_barycentre=float(smooth.column("exact, barycentre")[at]),
        crossed_exact=float(crossed.column("exact")[at]),
        crossed_barycentre=float(crossed.column("exact, barycentre")[at]),
        crossed_midpoint=float(crossed.column("midpoint")[at]),
        smooth_own_sum=float(smooth.column("midpoint")[at]),
        **{f"{name}_least": min(values) for name, values in ratios.items()},
        **{f"{name}_most": max(values) for name, values in ratios.items()},
    )
    return Measured(
        figures,
        {"weight_choice.crossed": study_table(crossed), "weight_choice.smooth": study_table(smooth, notes=False)},
    )


def _budget(effort: Effort) -> Measured:
    found = budget("gloss", size=effort.study, lobe=8, pixels=32, fine=96)
    rows = {str(row[0]): row for row in found.tables[0].rows}
    source = f"study budget, gloss, {found.facts['size']}, {found.facts['pixels drawn']} pixels, strata 8 x 8"
    names = {"silhouette": "silhouette", "texture edge": "texture", "shadow edge": "shadow", "no wall": "smooth"}
    values: dict[str, Any] = {key: float(rows[name][1] or 0) for name, key in names.items()}
    values["open"] = abs(float(found.facts["does not close"] or 0))
    return Measured(figures_of("budget", source, **values), {"budget.table": study_table(found.tables[0])})
