"""Texts of a module and of all it imports of its package: what a kernel in it can depend on, found in the texts."""

from __future__ import annotations

import ast
import sys
from collections.abc import Iterator

from symrender.jit.source import module_text


def closure_texts(module: str) -> list[str]:
    """Texts of ``module`` and of all that it imports of its package and of this one, directly or not, by name."""
    packages, found, waiting = {module.partition(".")[0], __name__.partition(".")[0]}, {}, [module]
    while waiting:
        name = waiting.pop()
        if name in found or name not in sys.modules:
            continue
        found[name] = module_text(name)
        waiting += [each for each in _imported(found[name], name) if each.partition(".")[0] in packages]
    return [found[name] for name in sorted(found)]


def _imported(text: str, module: str) -> Iterator[str]:
    """Names of what a text imports; of ``from a import b`` both a and a.b, which may be a module."""
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            parts = module.split(".")[: -node.level] if node.level else []
            base = ".".join([*parts, *([node.module] if node.module else [])])
            yield base
            yield from (f"{base}.{alias.name}" for alias in node.names)
