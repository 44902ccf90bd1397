"""The estimators a study judges, by name: what each is, and the knob that makes it finer."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final, Literal

from symrender.errors import OptionError

Family = Literal["strata", "samples", "split"]


@dataclass(frozen=True)
class Estimator:
    """An estimator of the lobe integral: a kind of kernel (``jobs.KINDS``) with fixed settings.

    Its knob is ``lobe`` (K of K x K directions) for strata and samples, ``tol`` for the split rule.
    """

    name: str
    family: Family
    kind: str
    settings: Mapping[str, Any]


def _strata(name: str, **settings: str) -> Estimator:
    return Estimator(name, "strata", "symbolic", settings)


def _samples(name: str, sampler: str, *, normalised: bool = False) -> Estimator:
    return Estimator(name, "samples", "numeric", {"numeric": sampler, "normalised": normalised})


ESTIMATORS: Final[Mapping[str, Estimator]] = {
    e.name: e
    for e in (
        _strata("strata-angle", partition="equal_angle"),
        _strata("strata-angle-midpoint-weights", partition="equal_angle", weights="midpoint"),
        _strata("strata-angle-barycentre", partition="equal_angle", nodes="barycentre"),
        _strata("strata-solid-angle", partition="equal_solid_angle"),
        _strata("strata-weight", partition="equal_weight"),
        _strata("strata-weight-barycentre", partition="equal_weight", nodes="barycentre"),
        _strata("gauss", partition="equal_weight", nodes="gauss"),
        _samples("jittered", "jittered"),
        _samples("jittered-normalised", "jittered", normalised=True),
        _samples("independent", "independent"),
        _samples("importance", "importance"),
        _samples("sobol", "sobol"),
        Estimator("split", "split", "truth", {}),
    )
}
"""``strata-*``: exact weights and midpoint nodes unless the name says otherwise; ``gauss``: Gauss in cos^(n+1) theta by
equal sectors; ``jittered`` and ``independent``: ratio estimators, uniform in solid angle; ``importance`` and ``sobol``:
density of the lobe itself."""


def chosen(names: Sequence[str]) -> tuple[Estimator, ...]:
    """Estimators by name, in the order asked for; OptionError for an unknown name or for none."""
    unknown = [name for name in names if name not in ESTIMATORS]
    if unknown or not names:
        got = repr(unknown[0][:40]) if unknown else "none"
        raise OptionError(f"estimators: must be names out of {', '.join(ESTIMATORS)}, got {got}")
    return tuple(ESTIMATORS[name] for name in dict.fromkeys(names))
