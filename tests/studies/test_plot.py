from __future__ import annotations

import io
import sys

import numpy as np
import pytest
from PIL import Image as Picture

from symrender.errors import OptionError
from symrender.studies.convergence import Convergence, Fit, Point
from symrender.studies.plot import _spread, drawn
from symrender.studies.power_law import PowerLaw
from symrender.studies.report import Study

FACTS = {
    "scene": "toy", "size": "8 x 8", "lobes of": "floor", "pixels judged": 64, "truth": "split rule, tol 1e-9",
    "relative to the signal": 1e-8,
}  # fmt: skip


def toy() -> Convergence:
    points = [
        Point(name, family, f"K={k}", k * k, k * k * 1e-6, 3, e := k ** (-2 * order), e / 2, 2 * e, e, 0.0, None, None)
        for name, family, order in (("sobol", "samples", 0.7), ("strata-angle", "strata", 0.5), ("split", "split", 2.0))
        for k in (2, 4, 8)
    ]  # fmt: skip
    law = PowerLaw(0.5, 0.4, 0.6, 1.0, 3, 4.0, 64.0)
    return Convergence(tuple(points), (Fit("sobol", "evaluations", law),), Study("convergence", FACTS, ()))


def test_there_is_something_to_see_and_nothing_is_cut() -> None:
    pytest.importorskip("matplotlib")
    pixels = np.asarray(Picture.open(io.BytesIO(drawn(toy(), "png"))).convert("RGB"))
    assert pixels.shape[0] > 600 and pixels.shape[1] > 1200
    assert len(np.unique(pixels.reshape(-1, 3), axis=0)) > 100
    ink = (pixels < 250).any(axis=2)
    assert 0.005 < ink.mean() < 0.3
    for edge in (ink[:3], ink[-3:], ink[:, :3], ink[:, -3:]):
        assert not edge.any(), "something is clipped at an edge"


def test_svg_holds_every_curve_and_is_reproducible() -> None:
    pytest.importorskip("matplotlib")
    first, second = drawn(toy(), "svg"), drawn(toy(), "svg")
    assert first == second and first.startswith(b"<?xml")
    for color in (b"#0072b2", b"#000000"):
        assert color in first.lower()


def test_without_matplotlib_one_line_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in [m for m in sys.modules if m.split(".")[0] == "matplotlib"]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(OptionError, match=r"pip install 'matplotlib"):
        drawn(toy(), "png")


def test_names_are_spread_without_overlap() -> None:
    placed = _spread([0.1, 0.101, 0.102, 0.5, 0.99, 0.995], 0.04)
    assert np.diff(placed).min() >= 0.04 - 1e-12
    assert placed[0] >= 0 and placed[-1] <= 1
    assert placed[3] == pytest.approx(0.5) and placed[1] == pytest.approx(0.101)
