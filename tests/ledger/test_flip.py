"""FLIP is optional, refuses what its evaluator would hide, and gets the images it expects."""

from __future__ import annotations

import sys
import types
from typing import Any

import numpy as np
import pytest

from symrender.errors import ImageError, OptionError
from symrender.images.image import Image
from symrender.ledger.flip import flip

GREY = Image({"radiance": np.full((4, 5, 3), 0.25)})


def test_missing_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "flip_evaluator", None)
    with pytest.raises(OptionError, match=r"pip install 'flip-evaluator"):
        flip(GREY, GREY)


def test_refused_before_the_evaluator_sees_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "flip_evaluator", None)
    broken = np.array(GREY.radiance)
    broken[0, 0, 0] = np.nan
    with pytest.raises(ImageError, match="test: 1 values are NaN or infinite"):
        flip(GREY, Image({"radiance": broken}))
    with pytest.raises(ImageError, match="sizes differ"):
        flip(GREY, Image({"radiance": np.zeros((4, 4, 3))}))
    with pytest.raises(OptionError, match="kind"):
        flip(GREY, GREY, kind="SDR")  # type: ignore[arg-type]


@pytest.mark.parametrize(("kind", "seen"), [("LDR", 137 / 255), ("HDR", 0.25)])
def test_evaluator_gets_float32_in_its_own_range(kind: Any, seen: float, monkeypatch: pytest.MonkeyPatch) -> None:
    calls: list[Any] = []

    def evaluate(reference: Any, test: Any, dynamic_range: str, **options: Any) -> Any:
        calls.append((reference, test, dynamic_range, options))
        return np.full((4, 5, 1), 0.5, dtype=np.float32), 0.5, {"ppd": 67.0}

    module = types.ModuleType("flip_evaluator")
    module.evaluate = evaluate  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "flip_evaluator", module)
    result = flip(GREY, GREY, kind=kind)
    assert (result.mean, result.map.shape, result.parameters) == (0.5, (4, 5), {"ppd": 67.0})
    ((reference, _, dynamic_range, options),) = calls
    assert dynamic_range == kind and options == {"inputsRGB": True, "applyMagma": False}
    assert reference.dtype == np.float32 and reference[0, 0, 0] == pytest.approx(seen, rel=1e-6)


def test_real_evaluator_orders_images_as_eyes_do() -> None:
    pytest.importorskip("flip_evaluator")
    near, far = (Image({"radiance": GREY.radiance * k}) for k in (1.05, 2.0))
    assert flip(GREY, GREY).mean == 0 < flip(GREY, near).mean < flip(GREY, far).mean
