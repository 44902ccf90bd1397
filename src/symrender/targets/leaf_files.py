"""The files leaves are emitted to: their text now, and whether what is committed still says it.

``python -m symrender.targets.leaf_files`` tells the difference and fails if there is one; with ``--update`` it writes
the files. They are committed, so that what a change of a formula does to every target can be read.
"""

from __future__ import annotations

import difflib
import sys
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Final

from symrender.expression.formulas.every import LEAVES, RADIOMETRIC
from symrender.expression.leaf import Leaf
from symrender.targets import leaf_braces, leaf_python

_ROOT: Final = Path(__file__).resolve().parent.parent
_NOTE: Final = "Emitted by targets/leaf_files.py from expression/formulas: change those, not this file."


def texts() -> dict[Path, str]:
    """Path and text of every emitted file."""
    leaves = list(LEAVES.values())
    pages = [leaf for leaf in leaves if leaf.pages]
    return {
        _ROOT / "leaves" / "values.py": _python("Formulas as scalar functions.", _each(leaf_python.value, leaves)),
        _ROOT / "leaves" / "radiometric.py": _python(
            "Formulas of radiometric scenes as scalar functions.", _each(leaf_python.value, RADIOMETRIC.values())
        ),
        _ROOT / "chambers" / "leaf_rows.py": _rows(_each(leaf_python.rows, (x for x in leaves if x.rows))),
        _ROOT / "leaves" / "formulas.js": f"// {_NOTE}\n" + leaf_braces.javascript_module(pages),
        _ROOT / "leaves" / "formulas.glsl": f"// {_NOTE}\n" + leaf_braces.glsl_module(pages),
    }


def _each(write: Callable[[Leaf], str], leaves: Iterable[Leaf]) -> list[str]:
    return [write(leaf) for leaf in leaves]


def _python(title: str, functions: list[str]) -> str:
    body = "\n\n\n".join(functions)
    lines = [f'"""{title}', "", _NOTE, '"""', "", "# fmt: off", "from __future__ import annotations", "", "import math"]
    lines += ["", "from symrender.jit.marks import inlined"]
    if "gleam(" in body:
        lines.append("from symrender.leaves.gleams import gleam")
    if "math." not in body:
        lines.remove("import math")
        lines.remove("")
    return "\n".join(lines) + f"\n\n\n{body}\n"


def _rows(functions: list[str]) -> str:
    lines = ['"""Formulas as loops over the rows of nodes.', "", _NOTE, '"""', "", "# fmt: off"]
    lines += ["from __future__ import annotations", "", "import math", ""]
    lines += ["from symrender.chambers.records import NODES, Nodes", "from symrender.jit.marks import jitable"]
    return "\n".join(lines) + "\n\n\n" + "\n\n\n".join(functions) + "\n"


def differences() -> list[str]:
    """Lines by which committed files differ from what is emitted now."""
    found: list[str] = []
    for path, text in texts().items():
        held = path.read_text("utf-8") if path.exists() else ""
        name = str(path.relative_to(_ROOT))
        found += difflib.unified_diff(held.splitlines(), text.splitlines(), f"{name} (committed)", f"{name} (now)")
    return found


def main(arguments: list[str]) -> int:
    """Write the files with ``--update``, else tell the difference."""
    if arguments == ["--update"]:
        for path, text in texts().items():
            path.write_text(text, "utf-8")
        return 0
    found = differences()
    print("\n".join(found))
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
