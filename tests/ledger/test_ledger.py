"""The ledger of a pair: every layer, both costs, the black image, the widths."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest
from rich.console import Console

from symrender.errors import ImageError
from symrender.images.image import Image
from symrender.ledger.ledger import Ledger, Timing, ledger

RNG = np.random.default_rng(3)


def pair() -> tuple[Image, Image]:
    direct, gloss = RNG.random((2, 8, 8, 3))
    classes = RNG.integers(0, 3, (8, 8))
    flipped = classes.copy()
    flipped[2, 3] += 1
    numeric = {"radiance": direct + gloss, "direct": direct, "gloss": gloss, "hit_class": classes}
    off = gloss * 1.01
    symbolic = {"radiance": direct + off, "direct": direct, "gloss": off, "hit_class": flipped}
    return Image(numeric, {"estimator": "ratio"}), Image(symbolic, {"estimator": "strata [red]"})


def some_ledger() -> Ledger:
    numeric, symbolic = pair()
    return ledger(
        numeric,
        symbolic,
        numeric_timing=Timing(2.0, 1000),
        symbolic_timing=Timing(0.5, 2000),
        lobes=[("floor", 16.0, math.pi / 3), ("spheres.A", 0.0, 1.0)],
    )


def test_every_layer_is_compared_with_its_black_image() -> None:
    book = some_ledger()
    assert list(book.comparisons) == ["radiance", "direct", "gloss"]
    gloss = book.comparisons["gloss"]
    assert gloss.whole.relative_rmse == pytest.approx(0.01, rel=1e-9) and gloss.whole.signal > 0.3
    assert book.comparisons["direct"].whole.max_abs == 0
    assert book.flips == 1
    interior = book.comparisons["radiance"].interior
    assert interior is not None and interior.pixels == 63
    rows = dict(book.tables())
    (table,) = (rows[title] for title in rows if title.startswith("symbolic - numeric; flips 1;"))
    assert [row[:2] for row in table[1:4]] == [
        ("radiance", "all"),
        ("radiance", "interior"),
        ("radiance", "black image"),
    ]


def test_text_terminal_and_json_tell_the_same() -> None:
    book = some_ledger()
    text = book.text()
    console = Console(width=200, record=True, file=None, quiet=True)
    with console.capture():
        console.print(book)
    assert "numeric     2.000         1000    2e+06         ratio" in text
    assert "strata [red]" in text
    report = json.loads(book.to_json())
    assert report["pipelines"][1] == {
        "name": "symbolic",
        "estimator": "strata [red]",
        "timing": {"seconds": 0.5, "evaluations": 2000},
    }
    assert report["comparisons"]["gloss"]["whole"]["pixels"] == 64
    assert report["lobes"][1]["sigma"] is None and report["lobes"][0]["sigma"] == 0.25
    assert "0.1768" in text and "0.3364" in text


def test_rich_tables_do_not_read_cells_as_markup() -> None:
    console = Console(width=200, color_system=None)
    with console.capture() as capture:
        console.print(some_ledger())
    assert "strata [red]" in capture.get() and "black image" in capture.get()


def test_one_pipeline_alone() -> None:
    numeric, _ = pair()
    book = ledger(numeric, None, numeric_timing=Timing(1, 0))
    assert book.comparisons == {} and book.flips is None and [p.name for p in book.pipelines] == ["numeric"]
    assert "numeric" in book.text() and json.loads(book.to_json())["comparisons"] == {}


def test_nan_stops_the_ledger() -> None:
    numeric, symbolic = pair()
    broken = np.array(symbolic.radiance)
    broken[0, 0, 0] = np.nan
    with pytest.raises(ImageError, match="test: layer radiance: 1 values are NaN"):
        ledger(numeric, Image({**symbolic.layers, "radiance": broken}))
