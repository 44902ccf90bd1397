from __future__ import annotations

import numpy as np
import pytest

from symrender.errors import OptionError
from symrender.studies.weights import weights


def test_exact_weights_pay_only_where_no_wall_crosses() -> None:
    study = weights("chapter8", size=12, lobes=(2, 4, 8))
    facts = study.facts
    assert int(facts["pixels judged"] or 0) > 50 and int(facts["smooth scene, pixels judged"] or 0) == 144
    assert float(facts["walls met a lobe"] or 0) > 1
    assert facts["smooth scene, walls met a lobe"] == 0
    assert float(facts["smooth scene, truth's own error"] or 1) < 1e-7
    crossed, smooth = study.tables
    for table in (crossed, smooth):
        sums = np.abs(np.array(table.column("sum - 1, exact")))
        assert sums.max() < 1e-14
        assert (np.abs(table.column("sum - 1, midpoint")) > 1e-4).all()
    # no wall: what the midpoint weights lose is the error of their sum, and exact weights take it away
    lost, kept = np.array(smooth.column("midpoint, normalised")), np.array(smooth.column("exact"))
    np.testing.assert_allclose(lost, np.abs(smooth.column("sum - 1, midpoint")), rtol=0.05)
    assert (kept < 0.02 * lost).all()
    assert (np.array(smooth.column("exact, barycentre"))[1:] < 0.5 * kept[1:]).all()
    # walls: exact weights do not win (erratum of the source chapter)
    assert (np.array(crossed.column("midpoint"))[:2] < np.array(crossed.column("exact"))[:2]).all()


def test_no_k_is_refused() -> None:
    with pytest.raises(OptionError, match="lobes: must hold at least one K"):
        weights("gloss", size=8, lobes=())
