from __future__ import annotations

import csv
import io
import json
import math

import pytest

from symrender.errors import OptionError
from symrender.studies.report import Study, Table

TABLE = Table(
    "errors, all of them",
    ("name", "K", "error"),
    (("a,b", 2, 0.1), ('quoted "c"', 4, 1 / 3), ("tiny", 8, 5e-324), ("none", 16, None), ("inf", 32, math.inf)),
    ("how to read it",),
)


def test_csv_reads_back_bit_for_bit() -> None:
    rows = list(csv.reader(io.StringIO(TABLE.csv())))
    assert tuple(rows[0]) == TABLE.columns and len(rows) == 1 + len(TABLE.rows)
    for (name, k, error), (name_, k_, error_) in zip(TABLE.rows, rows[1:], strict=True):
        assert (name, str(k)) == (name_, k_)
        assert error_ == "" if error is None else float(error_) == error


def test_text_and_json_say_the_same() -> None:
    study = Study("toy", {"pixels": 12, "signal": 0.25}, (TABLE,))
    text = study.text()
    assert "0.3333" in text and "how to read it" in text and "pixels" in text and "0.25" in text
    plain = json.loads(study.to_json())
    assert plain["facts"] == {"pixels": 12, "signal": 0.25}
    assert [row[2] for row in plain["tables"][0]["rows"]] == [0.1, 1 / 3, 5e-324, None, None]
    assert study.table("errors").column("K") == [2, 4, 8, 16, 32]
    with pytest.raises(OptionError, match="no title of this study begins with 'missing'"):
        study.table("missing")
