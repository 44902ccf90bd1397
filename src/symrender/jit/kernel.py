"""A kernel that is called from Python: found on a shelf, or translated and compiled, or left to Numba."""

from __future__ import annotations

import json
import logging
import os
import threading
import time
from collections.abc import Callable, Sequence
from types import FunctionType
from typing import Any, Final

from symrender.errors import Unsupported
from symrender.jit.call import Loaded, flatten
from symrender.jit.closure import closure_texts
from symrender.jit.machine import loaded, machine_code
from symrender.jit.program import Site, translated
from symrender.jit.racks import unracked
from symrender.jit.refused import Refused
from symrender.jit.shelf import own_shelf, package_shelves
from symrender.jit.shipped import ship
from symrender.jit.told import about_to_compile
from symrender.jit.types import Type, moves_in, result_of, type_of

MODES: Final = ("auto", "llvm", "numba", "checked")
"""Values of ``SYMRENDER_COMPILER``: translated, and by Numba where that is refused; translated or an error; Numba; as
``llvm`` with every index checked."""

_USUAL_SECONDS: Final = 15.0
"""Told where nothing was compiled here before; a small kernel takes less."""

_log = logging.getLogger("symrender")


def mode() -> str:
    """How kernels are compiled: the environment's ``SYMRENDER_COMPILER``, by default ``auto``."""
    chosen = os.environ.get("SYMRENDER_COMPILER") or MODES[0]
    if chosen not in MODES:
        raise ValueError(f"SYMRENDER_COMPILER: must be one of {', '.join(MODES)}, got {chosen!r}")
    return chosen


class Kernel:
    """A function compiled once for each list of argument types.

    ``name`` is its module's and its own; ``hits`` and ``misses`` count what was read from the disk and what was
    compiled; ``by_numba`` says whether the last was left to Numba.
    """

    def __init__(self, function: FunctionType, sources: Sequence[str] | None, options: dict[str, Any]) -> None:
        self.function, self.sources, self.options = function, sources, options
        self.name = function.__module__, function.__qualname__
        self.hits = self.misses = 0
        self.by_numba = False
        self._made: dict[tuple[Any, ...], Callable[..., Any]] = {}
        self._loaded: dict[tuple[tuple[Type, ...], bool], Loaded] = {}
        self._lock = threading.Lock()
        self._numba: Any = None

    def __call__(self, *arguments: Any) -> Any:
        """Run the kernel."""
        key: list[Any] = []
        given: list[Any] = []
        for argument in arguments:
            flatten(argument, key, given)
        kinds = tuple(key)
        made = self._made.get(kinds)
        if made is None:
            with self._lock:
                made = self._made.get(kinds) or self._make(arguments)
                self._made[kinds] = made
        return made.run(given) if isinstance(made, Loaded) else made(*map(unracked, arguments))

    def _make(self, arguments: tuple[Any, ...]) -> Callable[..., Any]:
        chosen = mode()
        if chosen == "numba" or self.options.get("fastmath"):
            return self._fallback(None, arguments)
        checked = chosen == "checked"
        try:
            types = tuple(map(type_of, arguments))
            # np.float64 and float are one type
            if (types, checked) not in self._loaded:
                self._loaded[types, checked] = self._read(types, checked) or self._compile(types, checked)
            return self._loaded[types, checked]
        except Refused as error:
            if chosen != "auto":
                raise
            return self._fallback(error, arguments)

    def _fallback(self, error: Exception | None, arguments: tuple[Any, ...]) -> Callable[..., Any]:
        from symrender.jit.fallback import dispatcher

        if any(moves_in(type_of(argument)) for argument in arguments):
            # to Numba they would be complex numbers
            raise error or Unsupported("SYMRENDER_COMPILER: numba knows no numbers with a tangent; choose auto or llvm")

        if error is not None:
            _log.warning("kernel %s is left to Numba, which takes minutes: %s", self.function.__name__, error)
        if self._numba is None:
            sources = self.sources
            if sources is None:
                sources = closure_texts(self.function.__module__)
            self._numba = dispatcher(self.function, sources, self.options)
        self.by_numba = True
        made: Callable[..., Any] = self._numba
        return made

    def _read(self, types: tuple[Type, ...], checked: bool) -> Loaded | None:
        """Machine code from a shelf whose dependencies are as they are now, else None."""
        own = own_shelf()
        for shelf in (*package_shelves(), *(() if own is None else (own,))):
            for content in shelf.found(shelf.lists(self.name, types, checked)):
                try:
                    head, _, code = content.partition(b"\n")
                    known = json.loads(head)
                    sites = tuple(Site(*each) for each in known["sites"])
                    made = Loaded(loaded(code), types, result_of(known["result"]), sites)
                except Exception as error:  # whatever an unusable entry does, compiling again is right
                    _log.info("kernel cache: entry not usable: %r", error)
                    continue
                self.hits += 1
                return made
        return None

    def _compile(self, types: tuple[Type, ...], checked: bool) -> Loaded:
        name, shelf = self.function.__name__, own_shelf()
        lists = None if shelf is None else shelf.lists(self.name, types, checked)
        last = [] if shelf is None or lists is None else shelf.listed(lists)
        about_to_compile(name, last[0]["seconds"] if last else _USUAL_SECONDS)
        begun = time.perf_counter()
        made = translated(self.function, types, checked=checked)
        try:
            code = machine_code(made.modules, kept=shelf)
            entry = loaded(code)
        except Exception as error:
            raise Refused(f"{name}: llvmlite cannot compile the translation: {error}") from error
        self.misses += 1
        seconds = time.perf_counter() - begun
        _log.info("kernel %s: %d functions compiled in %.1f s", name, made.functions, seconds)
        if shelf is not None and lists is not None:
            shelf.put(lists, made, code, seconds)
        if not checked:
            ship(self.name, types, made)
        return Loaded(entry, types, made.result, made.sites)
