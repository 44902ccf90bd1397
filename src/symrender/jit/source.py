"""Where functions are written: texts, syntax trees, arguments, read once a process."""

from __future__ import annotations

import ast
import functools
import inspect
import linecache
import sys
from dataclasses import dataclass
from pathlib import Path
from types import CodeType, FunctionType
from typing import Any

from symrender.jit.refused import Refused
from symrender.jit.types import B1, F8, I8, Scalar
from symrender.jit.webs import Webs

_ANNOTATED = {"float": F8, "int": I8, "bool": B1}


@dataclass(frozen=True)
class Source:
    """A function's text: its tree, arguments, their scalar annotations and defaults, its variables."""

    file: str
    tree: ast.FunctionDef
    arguments: tuple[ast.arg, ...]
    names: tuple[str, ...]
    annotated: dict[str, Scalar]
    defaults: dict[str, Any]
    webs: Webs


def _lines(file: str, names: dict[str, Any]) -> str:
    """Text of a file, or of the generated module whose globals are ``names``; "" where there is none."""
    text = "".join(linecache.getlines(file, names))
    if not text and file.startswith("<") and hasattr(names.get("__loader__"), "get_source"):
        # anybody may have cleared the cache of lines, which fills itself from files alone
        text = names["__loader__"].get_source(names["__name__"]) or ""
    return text


def text_of(code: CodeType, names: dict[str, Any]) -> str:
    """Text of the file or generated module that ``code`` comes from; ``names`` are its globals."""
    text = _lines(code.co_filename, names)
    if not text:
        raise Refused(f"{code.co_name}: the text of {code.co_filename} is not to be had")
    return text


@functools.lru_cache(maxsize=512)
def _definitions(text: str, nested: bool) -> dict[tuple[str, int], ast.FunctionDef]:
    """Functions of a text by their name and the first line of them or of their decorators, of all or of its module."""
    tree, found = ast.parse(text), {}
    for node in ast.walk(tree) if nested else tree.body:
        if isinstance(node, ast.FunctionDef):
            found[node.name, min([node.lineno, *(part.lineno for part in node.decorator_list)])] = node
    return found


def _definition(function: FunctionType) -> ast.FunctionDef | None:
    """The tree of a function, which few are inside of anything."""
    code = function.__code__
    text, key = text_of(code, function.__globals__), (code.co_name, code.co_firstlineno)
    return _definitions(text, False).get(key) or _definitions(text, True).get(key)


@functools.lru_cache(maxsize=4096)
def source_of(function: FunctionType) -> Source:
    """Source of a function; raises ``Refused`` where it is none that can be translated."""
    code = function.__code__
    if function.__closure__:
        raise Refused(f"{function.__qualname__} is a closure")
    node = _definition(function)
    if node is None:
        raise Refused(f"{function.__qualname__} is not found in {code.co_filename}:{code.co_firstlineno}")
    where = shown_file(code.co_filename)
    if node.args.vararg or node.args.kwarg or code.co_flags & (inspect.CO_GENERATOR | inspect.CO_COROUTINE):
        raise Refused(f"{function.__qualname__} takes any number of arguments or is a generator", where, node.lineno)
    arguments = (*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs)
    annotated = {}
    for argument in arguments:
        if isinstance(argument.annotation, ast.Name) and argument.annotation.id in _ANNOTATED:
            annotated[argument.arg] = _ANNOTATED[argument.annotation.id]
    names = tuple(argument.arg for argument in arguments)
    positional = names[: len(names) - len(node.args.kwonlyargs)]
    values = function.__defaults__ or ()
    defaults = dict(zip(positional[len(positional) - len(values) :], values, strict=True))
    return Source(where, node, arguments, names, annotated, defaults | (function.__kwdefaults__ or {}), Webs(node))


def shown_file(name: str) -> str:
    """A file's name as errors give it: from the package on."""
    parts = Path(name).parts
    return "/".join(parts[parts.index("symrender") :]) if "symrender" in parts else name


def module_text(name: str) -> str:
    """Text of an imported module, "" where it has none."""
    module = sys.modules[name]
    file = getattr(module, "__file__", None) or getattr(module.__spec__, "origin", None) or ""
    return _lines(file, vars(module))
