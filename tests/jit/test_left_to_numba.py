"""Kernels keep to what Numba compiles as well: it is the fallback, and too slow to be asked about whole kernels here.

What a scene may lack is None in its ``View``. Numba leaves out a branch for what is there only where a parameter of the
function says that it is not, and then compiles nothing that reads it.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import symrender
from symrender.chambers.work import View

PACKAGE = Path(symrender.__file__).parent
OPTIONAL = {name for name, kind in View.__annotations__.items() if "None" in str(kind)} | {"disk"}
"""Fields of a ``View``, and that of a ``Charted``, that may be None."""
WRONG = """
@jitable
def one(k: int, view: View, disk: Array | None) -> float:
    if view.glows is not None:
        return two(view.glows) + view.glows[k].sphere
    if disk is None or view.cones is None:
        return 0.0
    found = view.senders
    return disk[k] + three(disk, found) + (found[0].kind if found is not None else 0.0)

@jitable
def two(glows: Table[Glow]) -> float:
    return glows[0].sphere

@jitable
def three(disk: Array | None, senders: Table[Sender] | None) -> float:
    return 0.0
"""


def kernel_functions(module: ast.Module) -> Iterator[ast.FunctionDef]:
    """Functions of a module that are compiled."""
    for node in ast.walk(module):
        if isinstance(node, ast.FunctionDef):
            marks = {ast.unparse(mark) for mark in node.decorator_list}
            if marks & {"jitable", "inlined"} or any(mark.startswith("kernel") for mark in marks):
                yield node


def perhaps_none(function: ast.FunctionDef) -> set[str]:
    """What a function compares with None and is none of its parameters."""
    given = {argument.arg for argument in function.args.args}
    compared = {
        ast.unparse(node.left)
        for node in ast.walk(function)
        if isinstance(node, ast.Compare) and ast.unparse(node.comparators[0]) == "None"
    }
    return compared - given


def is_optional(value: ast.expr) -> bool:
    """Whether this is a field of a ``View`` or of a ``Charted`` that may be None."""
    holder = ast.unparse(value).split(".")[0]
    return isinstance(value, ast.Attribute) and holder in ("view", "world", "on") and value.attr in OPTIONAL


def read_though_none(function: ast.FunctionDef) -> set[str]:
    """What a function reads of something that may be None and is none of its parameters."""
    none = perhaps_none(function)
    parts = [node for node in ast.walk(function) if isinstance(node, ast.Subscript | ast.Attribute)]
    return {ast.unparse(node) for node in parts if ast.unparse(node.value) in none or is_optional(node.value)}


def handed_though_none(function: ast.FunctionDef, known: dict[str, ast.FunctionDef]) -> set[str]:
    """Calls that hand on what may be None for a parameter that is not."""
    found = set()
    for node in ast.walk(function):
        if not (isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in known):
            continue
        for argument, parameter in zip(node.args, known[node.func.id].args.args, strict=False):
            optional = isinstance(argument, ast.Attribute) and argument.attr in OPTIONAL
            of_walls = ast.unparse(argument).startswith("row.")
            if optional and not of_walls and parameter.annotation and "None" not in ast.unparse(parameter.annotation):
                found.add(f"{node.func.id}: {ast.unparse(argument)}")
    return found


def test_what_numba_cannot_leave_out_is_noticed() -> None:
    functions = {each.name: each for each in kernel_functions(ast.parse(WRONG))}
    assert set(functions) == {"one", "two", "three"}
    assert read_though_none(functions["one"]) == {"view.glows[k]", "found[0]"}
    assert handed_though_none(functions["one"], functions) == {"two: view.glows"}


def test_what_a_scene_may_lack_is_read_by_functions_that_are_given_it() -> None:
    modules = {
        path.relative_to(PACKAGE).as_posix(): ast.parse(path.read_text("utf-8"))
        for folder in ("chambers", "quadrature")
        for path in sorted((PACKAGE / folder).rglob("*.py"))
    }
    known = {each.name: each for module in modules.values() for each in kernel_functions(module)}
    assert {"glows", "cones", "senders", "conductors", "emitted", "disk"} <= OPTIONAL and len(known) > 500
    wrong = {
        f"{name}: {each.name}": found
        for name, module in modules.items()
        for each in kernel_functions(module)
        if (found := read_though_none(each) | handed_though_none(each, known))
    }
    assert sum(len(perhaps_none(each)) for each in known.values()) > 20, "there is what may be missing"
    assert not wrong, f"Numba reads what is not there: {wrong}"


def test_nothing_that_kernels_hand_on_has_a_field_that_numba_refuses() -> None:
    # an attribute ``view`` of what is no array is refused wherever it is read
    for folder in ("chambers", "quadrature"):
        for path in sorted((PACKAGE / folder).rglob("*.py")):
            module = ast.parse(path.read_text("utf-8"))
            for each in kernel_functions(module):
                read = [ast.unparse(node) for node in ast.walk(each) if isinstance(node, ast.Attribute)]
                assert not [name for name in read if name.endswith(".view")], f"{path.name}: {each.name}"
