"""What a page unpacks is what was packed, to float32."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from symrender.report.pixels import packed, unpacked


@settings(max_examples=50, derandomize=True, deadline=None)
@given(hnp.arrays(np.float64, hnp.array_shapes(min_dims=2, max_dims=3), elements=st.floats(width=32)))
def test_layers_come_back(layer: np.ndarray) -> None:
    assert np.array_equal(unpacked(packed(layer)), layer.reshape(-1), equal_nan=True)
