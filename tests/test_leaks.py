"""No local name of a kernel carries from one turn of a loop to the next what was not meant to be carried."""

from __future__ import annotations

from pathlib import Path

import pytest

from leaks import leaks
from symrender.runtimes import numba

ROOT = Path(__file__).resolve().parent.parent / "src" / "symrender"
FOLDERS = ("chambers", "quadrature", "numeric")
MEANT = {
    # a list of nodes that is evaluated, and begun again, when it is full
    ("arc_term", "m"), ("strip_integral", "m"), ("strip_integral", "placed"),
    # the height of a stack
    ("integrate_cells", "top"),
    # where a scan has arrived, and the structure there
    ("cut_strips", "before"), ("cut_strips", "left"), ("cut_strips", "start"),
    # the smallest so far
    ("highlight_end", "best"),
    # bound by the first of at least one turn
    ("split_span", "left_signature"),
}  # fmt: skip
"""What is carried on purpose: each looked at, and why."""

SHADOWED = """
def kernel(points, shading):
    shine = shading[2] != 0.0
    for k in range(8):
        mean = term(shine)
        for c in range(3):
            lambert, shine = shading[1] * points[c], shading[2] * points[c]
            points[k] += lambert * mean + shine
"""
FORGOTTEN = """
def kernel(points, out):
    for k in range(8):
        if points[k] > 0.0:
            level = points[k]
        out[k] = level
"""
SUM = """
def kernel(points, out):
    total, lowest = 0.0, points[0]
    for k in range(8):
        part = 0.0
        for c in range(3):
            part += points[c]
        total += part
        if part < lowest:
            lowest = part
    out[0] = total - lowest
"""


@pytest.mark.parametrize(
    ("text", "found"),
    [(SHADOWED, {("shine", "leaks"), ("shine", "mixed")}), (FORGOTTEN, {("level", "stale")}), (SUM, set())],
)
def test_tells_a_leak_from_a_sum(text: str, found: set[tuple[str, str]]) -> None:
    assert {(leak.name, leak.kind) for leak in leaks(text)} == found


def test_kernels_leak_nothing() -> None:
    files = [path for folder in FOLDERS for path in sorted((ROOT / folder).glob("*.py"))]
    texts = {str(path.relative_to(ROOT)): path.read_text() for path in files}
    texts["image program"] = numba.image_text()
    functions = sum(text.count("\ndef ") for text in texts.values())
    assert len(texts) > 60 and functions > 400
    found = [(where, leak) for where, text in texts.items() for leak in leaks(text)]
    assert [(where, leak) for where, leak in found if (leak.function, leak.name) not in MEANT] == []
