"""Modules made of generated text."""

from __future__ import annotations

import hashlib
import importlib.abc
import importlib.util
import linecache
import sys
from types import ModuleType
from typing import Any


def load_module(text: str) -> ModuleType:
    """Module made of generated source ``text``, named after its SHA-256; the same text gives the same module.

    The text is executed as it is: it must come from an emitter, never from a scene. Functions in it can be given to
    ``compiled`` with ``sources=[text]``; tracebacks show its lines.
    """
    name = f"symrender_generated_{hashlib.sha256(text.encode()).hexdigest()[:32]}"
    if name not in sys.modules:
        file = f"<{name}>"
        spec = importlib.util.spec_from_loader(name, _Text(text, file), origin=file)
        assert spec is not None and spec.loader is not None
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        linecache.cache[file] = (len(text), None, text.splitlines(keepends=True), file)
        sys.modules.setdefault(name, module)
    return sys.modules[name]


class _Text(importlib.abc.InspectLoader):
    """Loader of a module whose source is a string."""

    def __init__(self, text: str, file: str) -> None:
        self.text, self.file = text, file

    def get_source(self, fullname: str) -> str:
        return self.text

    def get_code(self, fullname: str) -> Any:
        return compile(self.text, self.file, "exec", dont_inherit=True)
