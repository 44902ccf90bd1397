"""No function over 80 lines or 12 arguments and no file over 400 lines, but where its docstring gives the reason.

Emitted files are as long as what they say. A reason is a sentence that says what is long or many because of what. The
options of a verb of the command line are its arguments, so what is counted there is the work below the docstring. A
numpydoc docstring of a public function describes every parameter and does not count.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

PACKAGE = Path(__file__).resolve().parent.parent / "src" / "symrender"
LINES, ARGUMENTS, FILE = 80, 12, 400
REASON = re.compile(r"\b(?:[Ll]ong|[Mm]any)\b[^.]*\bbecause\b")
Function = ast.FunctionDef | ast.AsyncFunctionDef


def reasoned(node: ast.Module | Function) -> bool:
    return bool(REASON.search(" ".join((ast.get_docstring(node) or "").split())))


def described(node: ast.AST) -> int:
    """Lines of a numpydoc docstring, 0 for any other."""
    first = node.body[0] if isinstance(node, (*Function.__args__, ast.ClassDef)) else None
    text = ast.get_docstring(node) if isinstance(node, (*Function.__args__, ast.ClassDef)) else None
    if first is None or not re.search(r"^(Parameters|Attributes)\n-+$", text or "", re.MULTILINE):
        return 0
    assert first.end_lineno is not None
    return first.end_lineno - first.lineno + 1


def size(node: Function, *, verb: bool = False) -> tuple[int, int]:
    """Lines, with a docstring that is not numpydoc, and arguments, without ``self``."""
    every = [*node.args.posonlyargs, *node.args.args]
    count = len(every) - (bool(every) and every[0].arg in ("self", "cls")) + len(node.args.kwonlyargs)
    count += (node.args.vararg is not None) + (node.args.kwarg is not None)
    assert node.end_lineno is not None
    if verb:
        return node.end_lineno - node.body[1].lineno + 1, 0
    return node.end_lineno - node.lineno + 1 - described(node), count


def too_large(name: str, text: str) -> Iterator[str]:
    """``file.py`` and ``file.py::function`` of what is too large in a file and gives no reason."""
    tree = ast.parse(text)
    if "Emitted by targets/" in (ast.get_docstring(tree) or ""):
        return
    if len(text.splitlines()) - sum(map(described, ast.walk(tree))) > FILE and not reasoned(tree):
        yield name
    for node in ast.walk(tree):
        if isinstance(node, Function):
            verb = name == f"cli/{node.name}.py" and node in tree.body
            lines, count = size(node, verb=verb)
            if (lines > LINES or count > ARGUMENTS) and not reasoned(node):
                yield f"{name}::{node.name}"


def test_what_is_large_gives_its_reason() -> None:
    files = {
        path.relative_to(PACKAGE).as_posix(): path.read_text("utf-8")
        for path in PACKAGE.rglob("*.py")
        if path.parent != PACKAGE / "chapter" / "cells"
    }
    assert len(files) > 250
    found = {entry for name, text in files.items() for entry in too_large(name, text)}
    assert sorted(found) == [], "too large, without a reason in its docstring"


def test_what_is_planted_is_seen() -> None:
    body = "\n".join("    x = 1" for _ in range(LINES))
    many = ", ".join(f"a{k}" for k in range(ARGUMENTS + 1))
    excuse = '    """Long because the world is."""'
    assert list(too_large("a.py", f"def f():\n{body}")) == ["a.py::f"]
    assert list(too_large("a.py", f"def f():\n{excuse}\n{body}")) == []
    assert list(too_large("a.py", f"def f({many}): pass")) == ["a.py::f"]
    assert list(too_large("a.py", f"class A:\n    def f(self, {many.removeprefix('a0, ')}): pass")) == []
    assert list(too_large("cli/f.py", f"def f({many}):\n    'Does it.'\n    x = 1")) == []
    assert list(too_large("cli/f.py", f"def f({many}):\n    'Does it.'\n{body}\n    x = 1")) == ["cli/f.py::f"]
    parameters = '    """Do it.\n\n    Parameters\n    ----------\n    x : int\n    """'
    assert list(too_large("a.py", f"def f(x):\n{parameters}\n" + "    x = 1\n" * (LINES - 1))) == []
    assert list(too_large("a.py", f"def f(x):\n{parameters}\n" + "    x = 1\n" * LINES)) == ["a.py::f"]
    assert list(too_large("a.py", "\n" * (FILE + 1))) == ["a.py"]
