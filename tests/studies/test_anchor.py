from __future__ import annotations

import numpy as np
import pytest

from symrender.errors import OptionError
from symrender.studies.anchor import anchor


def test_both_pipelines_reach_the_mirror() -> None:
    study = anchor("gloss", size=32, exponents=(1e6, 1e7, 1e8))
    table = study.table("distance")
    assert min(table.column("pixels")) > 150
    assert len({name.split(":")[0] for name in table.column("estimator")}) == 2
    medians = np.array(table.column("median")).reshape(2, 3)
    assert (np.diff(medians, axis=1) < 0).all() and medians.min() > 1e-10 and medians.max() < 1e-3
    slopes = np.array([np.nan if s is None else s for s in table.column("slope")]).reshape(2, 3)
    assert np.isnan(slopes[:, 0]).all()
    assert (np.abs(slopes[:, 1:] + 1) < 0.25).all()
    # pixels beside a wall close more slowly
    assert (np.array(table.column("99 %")) > 20 * np.array(table.column("median"))).all()


@pytest.mark.parametrize(
    ("scene", "options", "message"),
    [
        ("gloss", {"exponents": (1e6,)}, "exponents: must be at least two"),
        ("gloss", {"exponents": (0.0, 1e6)}, "exponents: must be at least two"),
        ({"camera": {"type": "look_at", "eye": [0, -4, 2], "target": [0, 0, 0]}}, {}, "no floor with a lobe"),
    ],
)  # fmt: skip
def test_what_has_no_anchor_is_refused(scene: object, options: dict[str, object], message: str) -> None:
    with pytest.raises(OptionError, match=message):
        anchor(scene, size=8, **options)  # type: ignore[arg-type]


def test_dark_reflections_are_refused() -> None:
    with pytest.raises(OptionError, match="nothing to anchor"):
        anchor("chapter8", size=16)
