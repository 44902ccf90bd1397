"""Every smooth formula is spelled once in ``expression/formulas`` and once, independently, in ``numeric/``.

Kernels take what is emitted from there (``docs/leaves.md``). A pattern is the most telling line of a formula, so that a
copy with other names may escape it; it is a fence, not a proof.
"""

from __future__ import annotations

import re
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
)

PATTERNS = {
    # the light's direction, or the view's, by its length
    "unit offset": r"1\.0 / math\.sqrt\(max\((?:1e-300, )?[a-z]x \* [a-z]x",
    "blinn": r"\(?hx \* nx \+ hy \* ny \+ hz \* nz",
    "phong": r"2(?:\.0)? \* (?:cosine|inward|nl|facing) \* (?:\(|facing|nv|_dot|nx)",
    "gleam": r"\*\* int\(shininess\)|math\.exp\(shininess \* log|base\*\*shininess|found \*= base",
    "lobe density": r"exponent \* [Mm]ath\.log1p|exp\((?:n|(?:chart|lobe)\.exponent) \* (?:math\.)?log|n\)\.exp\(\)",
    "log cosine": r"log1p\(-2\.0 \* (?:half|math\.sin)",
    "normaliser": r"2(?:\.0)? \* (?:math\.pi|arb\.pi\(\)) \* (?:-math\.expm1|\(1 - )",
    "lobe mass": r"-math\.expm1\(\(?(?:u|n \+ 1\.0|(?:lobe\.)?exponent \+ 1\.0)\)? \*",
    "azimuth coordinate": r"atan2\([^)]*\)+ \+ math\.pi\) / \(2\.0 \* math\.pi\)|atan2\(.*\) / \(2 \* arb\.pi\(\)\)",
    "polar coordinate": r"acos\(.*\)+ / math\.pi|acos\(\) / arb\.pi\(\)",
    "veins": r"0\.35 \* math\.(?:sin|cos)",
    "floor phase": r"floor\((?:\(?[a-z]+(?: \+ [a-z]+)?\)?) / cell\)",
    "sphere place": r"s[gx] \* e[xyz]? ?- cg \* |cg, sg = c[xp] \* cb",
    "sphere measure": r"k \* s[xp] \* c[xp] / cb",
    "floor place": r"(?:chart\.)?height \* (?:sx / cx|math\.tan\([a-z]\))|h \* \(t \* e \+ pole\)",
    "floor measure": r"\b(?:h|height) \* inv(?:erse)? \* inv",
    "silhouette": r"math\.sqrt\(far2 - r \* r\)",
    "terminator": r"position\[a\] - (?:chart|geo)\.center\[a\]",
    "shadow": r"sine2 \* u2 - fx \* fx|r \* r \* ux - \(gy \* zz",
    "cone conic": r"row\.xx = k \+ ax \* ax",
    "conic level": r"row\.xx \* x \* x \+ 2\.0 \* row\.xy",
    "disk frame": r"np\.cross\(w, up\)",
}

PLANTED = {
    "unit offset": "inv = 1.0 / math.sqrt(max(lx * lx + ly * ly + lz * lz, 1e-300))",
    "blinn": "half = (hx * nx + hy * ny + hz * nz) / size",
    "phong": "dx, dy, dz = 2.0 * facing * nx - lx - vx, 2.0 * facing * ny - ly - vy, 2.0 * facing * nz - lz - vz",
    "gleam": "shine = cosine ** int(shininess)",
    "lobe density": "return math.exp(lobe.exponent * log - lobe.log_normaliser)",
    "log cosine": "log = math.log1p(-2.0 * half * half)",
    "normaliser": "scale = u / (2.0 * math.pi * (1 - power))",
    "lobe mass": "missing = -math.expm1(u * log)",
    "azimuth coordinate": "u = (math.atan2(y, x) + math.pi) / (2.0 * math.pi)",
    "polar coordinate": "v = math.acos(max(-1.0, min(1.0, here.at[FACING, 2]))) / math.pi",
    "veins": "c = 0.35 * math.sin(t)",
    "floor phase": "ci, cj = math.floor((px + east) / cell), math.floor((py + north) / cell)",
    "sphere place": "nx, ny, nz = sg * ex - cg * gx, sg * ey - cg * gy, sg * ez - cg * gz",
    "sphere measure": "b.weight[i] *= k * k * sx * cx / cb",
    "floor place": "r = chart.height * math.tan(x)",
    "floor measure": "b.weight[i] *= h * inv * inv * inv",
    "silhouette": "tangent = math.sqrt(far2 - r * r)",
    "terminator": "w = light.position[a] - chart.center[a]",
    "shadow": "return float(row.sine2 * u2 - fx * fx - fy * fy)",
    "cone conic": "row.xx = k + ax * ax",
    "conic level": "level = row.xx * x * x + 2.0 * row.xy * x * y",
    "disk frame": "side = np.cross(w, up)",
}
"""A line of each, most of them as they once stood in kernels."""


def formulas_in(line: str) -> list[str]:
    """Names of the formulas whose patterns a line matches."""
    return [formula for formula, pattern in PATTERNS.items() if re.search(pattern, line)]


def test_no_formula_is_spelled_anew() -> None:
    found: dict[str, list[str]] = {}
    files = 0
    for path in sorted([*PACKAGE.rglob("*.py"), *PACKAGE.rglob("*.js")]):
        name = path.relative_to(PACKAGE).as_posix()
        if name.startswith(EXEMPT):
            continue
        files += 1
        for number, line in enumerate(path.read_text("utf-8").splitlines(), 1):
            for formula in formulas_in(line):
                found.setdefault(formula, []).append(f"{name}:{number}")
    assert files > 500, "the package is not where it was"
    assert not found, f"written by hand: {found}; take it from symrender.leaves"


@pytest.mark.parametrize("formula", PATTERNS)
def test_a_planted_formula_is_found(formula: str) -> None:
    assert formulas_in(PLANTED[formula]) == [formula]


ROOM = ("chambers/lobes/",)
"""What is true of a kind of lobe only is written here (``docs/adding-a-bsdf.md``)."""
OF_A_LOBE = r"\.exponent\b|log_normaliser|\.facing\b|facing_level|log_rim|cos\*\*n|cosine\*\*n"
NO_LOBE = (
    "chambers/leaf_rows.py",  # emitted: one of its functions is called by the room alone
    "quadrature/strata.py",  # the chapter's own rule, which integrates a lobe of an image by strata of its weight
)


def lobe_readers(ask: str) -> dict[str, list[int]]:
    """Lines of every file behind truth, probe and gradient that read what a lobe is made of, by the file's name."""
    lines: dict[str, list[int]] = {}
    for path in sorted(path for folder in ("chambers", "quadrature") for path in (PACKAGE / folder).rglob("*.py")):
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
