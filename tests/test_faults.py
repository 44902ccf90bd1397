"""The planted bugs still fit the code they are planted in; ``make faults`` says that every one of them is noticed."""

from __future__ import annotations

import ast
import re
import sys
from collections import Counter
from pathlib import Path

import pytest

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE / "faults"))
from table import FAULTS, Fault  # noqa: E402 - the table lies beside its runner


def test_there_are_faults_of_every_kind() -> None:
    kinds = Counter(fault.kind for fault in FAULTS)
    assert len(FAULTS) >= 20 and len({fault.what for fault in FAULTS}) == len(FAULTS)
    wanted = {"intersection", "weights", "horizon", "shadows", "frames", "normaliser", "colour", "tiling", "journal"}
    assert wanted <= set(kinds) and min(kinds[kind] for kind in wanted) >= 2


@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: fault.what)
def test_a_fault_can_be_planted(fault: Fault) -> None:
    text = (HERE.parent / "src" / "symrender" / fault.file).read_text("utf-8")
    assert text.count(fault.old) == 1
    changed = text.replace(fault.old, fault.new)
    assert ast.dump(ast.parse(changed)) != ast.dump(ast.parse(text))
    assert fault.tests and all((HERE / test).is_file() for test in fault.tests)
    assert not any("targets" in test or "golden" in test for test in fault.tests)


def test_the_document_says_who_noticed_each() -> None:
    """As the last run of ``make faults`` wrote it; a fault added since must be planted before it may be told of."""
    page = (HERE.parent / "docs" / "robustness.md").read_text("utf-8")
    region = page.partition("<!-- faults -->\n")[2].partition("<!-- /faults -->")[0]
    rows = [line.strip("| ").split(" | ") for line in region.splitlines() if line.count(" | ") == 3][2:]
    assert [row[:3] for row in rows] == [[fault.kind, fault.file, fault.what] for fault in FAULTS]
    for *_, told in rows:
        file, _, test = told.strip("`").partition("::")
        assert re.search(rf"^def {test}\(", (HERE / file).read_text("utf-8"), re.MULTILINE), told
    assert f"{len(FAULTS)} faults planted, {len(FAULTS)} noticed, 0 missed." in region
