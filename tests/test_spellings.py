"""Every smooth formula is spelled once in ``expression/formulas`` and once, independently, in ``numeric/``.

What is still written by hand elsewhere is listed here, and the list may only shrink: replace a spelling by the emitted
function (``docs/leaves.md``) and lower its number. A pattern is the most telling line of a formula, so that a copy with
other names may escape it; it is a fence, not a proof.
"""

from __future__ import annotations

import re
from collections import Counter
from pathlib import Path

import pytest

PACKAGE = Path(__file__).resolve().parent.parent / "src" / "symrender"
EXEMPT = (
    "expression/",
    "numeric/",
    "leaves/",
    "chapter/",
    "chambers/leaf_rows.py",
    "kernel/tape.py",
    "kernel/sweeps.py",
)

PATTERNS = {
    # the light's direction, or the view's, by its length
    "unit offset": r"1\.0 / math\.sqrt\(max\((?:1e-300, )?[a-z]x \* [a-z]x",
    "blinn": r"\(?hx \* nx \+ hy \* ny \+ hz \* nz",
    "phong": r"2(?:\.0)? \* (?:cosine|nl|facing) \* (?:\(|facing|nv|_dot|nx)",
    "gleam": r"\*\* int\(shininess\)|math\.exp\(shininess \* log|base\*\*shininess|found \*= base",
    "lobe density": r"exponent \* Math\.log1p|exp\((?:n|(?:chart|geo|lobe)\.exponent) \* (?:math\.)?log|n\)\.exp\(\)",
    "log cosine": r"log1p\(-2\.0 \* (?:half|math\.sin)",
    "normaliser": r"2(?:\.0)? \* (?:math\.pi|arb\.pi\(\)) \* (?:-math\.expm1|\(1 - )",
    "lobe mass": r"-math\.expm1\(\(?(?:u|n \+ 1\.0|(?:lobe\.)?exponent \+ 1\.0)\)? \*",
    "azimuth coordinate": r"atan2\([^)]*\)+ \+ math\.pi\) / \(2\.0 \* math\.pi\)|atan2\(.*\) / \(2 \* arb\.pi\(\)\)",
    "polar coordinate": r"acos\(.*\)+ / math\.pi|acos\(\) / arb\.pi\(\)",
    "veins": r"0\.35 \* math\.(?:sin|cos)",
    "floor phase": r"floor\((?:\(?[a-z]+(?: \+ [a-z]+)?\)?) / cell\)",
    "sphere place": r"s[gx] \* e[xyz]? ?- cg \* |cg, sg = c[xp] \* cb",
    "sphere measure": r"k \* s[xp] \* c[xp] / cb",
    "floor place": r"(?:chart\.)?height \* (?:sx / cx|math\.tan\(x\))|h \* \(t \* e \+ pole\)",
    "silhouette": r"math\.sqrt\(far2 - r \* r\)",
    "terminator": r"position\[a\] - (?:chart|geo)\.center\[a\]",
    "shadow": r"sine2 \* u2 - fx \* fx|r \* r \* ux - \(gy \* zz",
    "cone conic": r"row\.xx = k \+ ax \* ax",
    "conic level": r"row\.xx \* x \* x \+ 2\.0 \* row\.xy",
    "disk frame": r"np\.cross\(w, up\)",
}

HAND_WRITTEN: dict[str, dict[str, int]] = {}


def found() -> dict[str, dict[str, list[int]]]:
    """Pattern to file to the lines that match."""
    table: dict[str, dict[str, list[int]]] = {name: {} for name in PATTERNS}
    for path in sorted([*PACKAGE.rglob("*.py"), *PACKAGE.rglob("*.js")]):
        name = path.relative_to(PACKAGE).as_posix()
        if name.startswith(EXEMPT):
            continue
        for number, line in enumerate(path.read_text("utf-8").splitlines(), 1):
            for formula, pattern in PATTERNS.items():
                if re.search(pattern, line):
                    table[formula].setdefault(name, []).append(number)
    return table


@pytest.mark.parametrize("formula", PATTERNS)
def test_no_formula_is_spelled_anew(formula: str) -> None:
    counted = {name: len(lines) for name, lines in found()[formula].items()}
    known = HAND_WRITTEN.get(formula, {})
    more = {name: n for name, n in counted.items() if n > known.get(name, 0)}
    assert not more, f"{formula}: written by hand in {more}; take it from symrender.leaves"
    fewer = {name: n for name, n in known.items() if counted.get(name, 0) < n}
    assert not fewer, f"{formula}: {fewer} is no longer so often there; lower the number in HAND_WRITTEN"


def test_the_two_texts_that_stay_are_seen() -> None:
    """The patterns find what they are made for: the independent pipeline's own spellings, and a planted one."""
    planted = "half = (hx * nx + hy * ny + hz * nz) / size\nc = 0.35 * math.sin(t)\n"
    seen = Counter(
        formula for formula, pattern in PATTERNS.items() for line in planted.splitlines() if re.search(pattern, line)
    )
    assert seen == {"blinn": 1, "veins": 1}


ROOM = ("chambers/lobes/", "adjoint/lobe.py", "adjoint/lobe_mass.py")
"""What is true of a kind of lobe only is written here (``docs/adding-a-lobe.md``)."""
OF_A_LOBE = r"\.exponent\b|log_normaliser|\.facing\b|facing_level|log_rim|cos\*\*n|cosine\*\*n"
NO_LOBE = (
    "chambers/leaf_rows.py",  # emitted: one of its functions is called by the room alone
    "quadrature/strata.py",  # the chapter's own rule, which integrates a lobe of an image by strata of its weight
)


def lobe_readers(ask: str) -> dict[str, list[int]]:
    """Lines of every file behind truth, probe and gradient that read what a lobe is made of, by the file's name."""
    lines: dict[str, list[int]] = {}
    for path in sorted(
        path for folder in ("chambers", "quadrature", "adjoint") for path in (PACKAGE / folder).rglob("*.py")
    ):
        name = path.relative_to(PACKAGE).as_posix()
        for number, line in enumerate(path.read_text("utf-8").splitlines(), 1):
            if name not in NO_LOBE and re.search(ask, line):
                lines.setdefault(name, []).append(number)
    return lines


def test_only_the_room_of_lobes_reads_what_a_lobe_is_made_of() -> None:
    lines = lobe_readers(OF_A_LOBE)
    inside = {name: numbers for name, numbers in lines.items() if name.startswith(ROOM)}
    assert len(inside) >= 5 and sum(map(len, inside.values())) > 30, "the pattern has lost what it looks for"
    outside = {name: numbers for name, numbers in lines.items() if name not in inside}
    assert not outside, f"what is true of cos^n only belongs into {ROOM}: {outside}"
