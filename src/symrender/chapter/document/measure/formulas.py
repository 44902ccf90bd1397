"""The closed forms: as SymPy derives them, as they are computed, and what the textbook subtraction would lose."""

from __future__ import annotations

import math
from typing import Any, Final

import numpy as np

from symrender.chapter.document.effort import Effort
from symrender.chapter.document.figures import Measured, figures_of
from symrender.chapter.document.prose import mathml
from symrender.chapter.document.tables import table
from symrender.ledger.lobe_widths import lobe_widths
from symrender.quadrature.strata import rings
from symrender.runtimes import numba

_RIM: Final = math.pi / 3
_EXPONENTS: Final = (4.0, 16.0, 64.0, 256.0, 4096.0)
_CASES: Final = 4000
_DIGITS: Final = 40
_SEED: Final = 8


def measure(effort: Effort) -> Measured:
    """Blocks ``formulas.weight`` and ``formulas.widths``; figures ``weights.*`` and ``widths.*``."""
    return Measured(
        _subtraction() | _sums() | _widths_figures(), {"formulas.weight": _derived(), "formulas.widths": _widths()}
    )


def _derived() -> str:
    import sympy as sp

    theta, n, a, b = sp.symbols("theta n a b", positive=True)
    found = sp.integrate(sp.cos(theta) ** n * sp.sin(theta), (theta, a, b), conds="none")
    given = sp.latex(sp.Integral(sp.cos(theta) ** n * sp.sin(theta), (theta, a, b)))
    neat = sp.simplify(found.rewrite(sp.cos))
    return f'<div class="display" tabindex="0">{mathml(f"{given} = {sp.latex(neat)}", block=True)}</div>'


def _subtraction() -> dict[str, Any]:
    """Random thin rings of random lobes, the subtraction and our form against many digits."""
    import mpmath

    formulas: Any = numba.plain(numba.image_text())
    rng = np.random.default_rng(_SEED)
    lost, worst, worst_plain = 0, 0.0, 0.0
    with mpmath.workdps(_DIGITS):
        for _ in range(_CASES):
            u = 1.0 + 10.0 ** rng.uniform(0.0, 6.0)
            a = rng.uniform(0.0, 1.4) * min(1.0, 6.0 / math.sqrt(u))
            b = a + 10.0 ** rng.uniform(-12.0, -1.0) * min(1.0, 1.0 / math.sqrt(u))
            true = (mpmath.cos(a) ** u - mpmath.cos(b) ** u) / u
            plain = (math.cos(a) ** u - math.cos(b) ** u) / u
            lost += plain <= 0.0
            worst = max(worst, abs(float(formulas.ring_weight(a, b, u) / true - 1)))
            worst_plain = max(worst_plain, abs(float(plain / true - 1)))
    source = f"{_CASES} random thin rings of random lobes, against {_DIGITS} digits"
    return figures_of("weights", source, cases=_CASES, lost=lost / _CASES, worst=worst, worst_plain=worst_plain)


def _sums() -> dict[str, Any]:
    formulas: Any = numba.plain(numba.image_text())
    worst = max(
        abs(math.fsum(rings(formulas, n, _RIM, k, partition=partition).weights.tolist()) - 1.0) / np.spacing(1.0)
        for n in _EXPONENTS
        for k in (2, 16, 256)
        for partition in ("equal_angle", "equal_solid_angle")
    )
    midpoint = [math.fsum(rings(formulas, 16.0, _RIM, k, weights="midpoint").weights.tolist()) - 1.0 for k in (2, 4, 8)]
    source = "sum of the weights of a lobe against the normaliser"
    values = dict(zip(("midpoint_two", "midpoint_four", "midpoint_eight"), midpoint, strict=True))
    return figures_of("sums", source, ulp=float(worst), **values)


def _widths() -> str:
    rows = []
    for n in _EXPONENTS:
        w = lobe_widths("", n, _RIM)
        rows.append([int(n), *(math.degrees(v) for v in (w.chapter_ruler, w.sigma, w.rms_angle, w.rms_angle_limit)),
                     1.0 - w.mean_cosine])  # fmt: skip
    columns = ("n", "chapter's ruler, °", "per axis, °", "RMS angle, °", "its limit, °", "1 - mean cosine")
    return table(columns, rows, label="Widths of the lobe")


def _widths_figures() -> dict[str, Any]:
    w = lobe_widths("", 16.0, _RIM)
    return figures_of(
        "widths", "n = 16, 60 degrees: exact moments of the lobe", ruler=w.chapter_ruler, sigma=w.sigma,
        rms=w.rms_angle, mean_cosine=w.mean_cosine, factor=w.rms_angle_limit / w.chapter_ruler,
    )  # fmt: skip
