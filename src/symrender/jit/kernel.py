"""A kernel that is called from Python: found in the cache, or translated and compiled, or left to Numba.

The name of an entry is a digest of all that decides the machine code: the types of the arguments, the processor and its
features, llvmlite, the translator's own texts, the texts of the modules whose functions were translated, and the values
of the globals they read. Which modules and globals these are is what the translator met, kept in a list of its own
(``.list``) beside the machine code (``.kernel``): nobody keeps it by hand, and nothing can be left out.
"""

from __future__ import annotations

import functools
import hashlib
import json
import logging
import os
import sys
import threading
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from types import FunctionType
from typing import Any, Final

from symrender.jit.call import Loaded, flatten
from symrender.jit.closure import closure_texts
from symrender.jit.entries import cache_directory, read_entry, write_entry
from symrender.jit.machine import loaded, machine_code, machine_name
from symrender.jit.program import Site, Translation, digest_of, translated
from symrender.jit.refused import Refused
from symrender.jit.source import module_text
from symrender.jit.told import about_to_compile
from symrender.jit.types import Type, result_named, result_of, type_of

MODES: Final = ("auto", "llvm", "numba", "checked")
"""Values of ``SYMRENDER_COMPILER``: translated, and by Numba where that is refused; translated or an error; Numba; as
``llvm`` with every index checked."""

_LISTS: Final = 8
"""Lists of dependencies kept for one kernel: switching between versions of the sources does not compile again."""

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

    ``hits`` and ``misses`` count what was read from the disk and what was compiled; ``by_numba`` says whether the last
    was left to Numba.
    """

    def __init__(self, function: FunctionType, sources: Sequence[str] | None, options: dict[str, Any]) -> None:
        self.function, self.sources, self.options = function, sources, options
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
        return made.run(given) if isinstance(made, Loaded) else made(*arguments)

    def _make(self, arguments: tuple[Any, ...]) -> Callable[..., Any]:
        chosen = mode()
        if chosen == "numba" or self.options.get("fastmath"):
            return self._fallback(None)
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
            return self._fallback(error)

    def _fallback(self, error: Exception | None) -> Callable[..., Any]:
        from symrender.jit.fallback import dispatcher

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

    def _list_path(self, directory: Path, types: tuple[Type, ...], checked: bool) -> Path:
        name = (self.function.__module__, self.function.__qualname__)
        return directory / f"{_digest((name, types, checked, machine_name(), _translator()))}.list"

    def _read(self, types: tuple[Type, ...], checked: bool) -> Loaded | None:
        """Machine code from the disk whose dependencies are as they are now, else None."""
        directory, _ = cache_directory()
        if directory is None:
            return None
        lists = self._list_path(directory, types, checked)
        for names in _names_in(lists):
            state = _state(names)
            content = None if state is None else read_entry(_code_path(lists, state))
            if content is None:
                continue
            try:
                head, _, code = content.partition(b"\n")
                known = json.loads(head)
                made = Loaded(
                    loaded(code), types, result_of(known["result"]), tuple(Site(*each) for each in known["sites"])
                )
            except Exception as error:  # whatever an unusable entry does, compiling again is right
                _log.info("kernel cache: entry not usable: %r", error)
                continue
            self.hits += 1
            return made
        return None

    def _compile(self, types: tuple[Type, ...], checked: bool) -> Loaded:
        name = self.function.__name__
        directory, _ = cache_directory()
        lists = None if directory is None else self._list_path(directory, types, checked)
        last = [] if lists is None else _names_in(lists)
        about_to_compile(name, last[0]["seconds"] if last else _USUAL_SECONDS)
        begun = time.perf_counter()
        made = translated(self.function, types, checked=checked)
        try:
            code = machine_code(made.text)
            entry = loaded(code)
        except Exception as error:
            raise Refused(f"{name}: llvmlite cannot compile the translation: {error}") from error
        self.misses += 1
        seconds = time.perf_counter() - begun
        _log.info("kernel %s: %d functions compiled in %.1f s", name, made.functions, seconds)
        if lists is not None:
            self._write(lists, made, code, seconds)
        return Loaded(entry, types, made.result, made.sites)

    def _write(self, lists: Path, made: Translation, code: bytes, seconds: float) -> None:
        names: dict[str, Any] = {"texts": sorted(made.texts), "globals": sorted(map(list, made.constants))}
        state = _state(names)
        if state is None:
            return
        head = {"result": result_named(made.result), "sites": [[s.file, s.line, s.reason] for s in made.sites]}
        write_entry(_code_path(lists, state), json.dumps(head).encode() + b"\n" + code)
        others = [each for each in _names_in(lists) if any(each[key] != names[key] for key in names)]
        kept = [names | {"seconds": seconds}, *others][:_LISTS]
        write_entry(lists, json.dumps(kept).encode())


def _names_in(path: Path) -> list[dict[str, Any]]:
    content = read_entry(path)
    try:
        return [] if content is None else list(json.loads(content))
    except ValueError:
        return []


def _code_path(lists: Path, state: str) -> Path:
    return lists.with_name(f"{_digest((lists.stem, state))}.kernel")


def _state(names: dict[str, Any]) -> str | None:
    """Digest of the texts and globals of these names as they are now, None where one of them is gone."""
    parts = []
    for module in names["texts"]:
        if module not in sys.modules:
            return None
        parts.append(module_text(module))
    for module, name in names["globals"]:
        if module not in sys.modules or not hasattr(sys.modules[module], name):
            return None
        parts.append(digest_of(getattr(sys.modules[module], name)))
    return _digest((names["texts"], names["globals"], parts))


@functools.lru_cache(maxsize=1)
def _translator() -> str:
    """Digest of the translator's own texts."""
    files = sorted(Path(__file__).parent.glob("*.py"))
    return _digest([(file.name, file.read_bytes()) for file in files])


def _digest(value: object) -> str:
    return hashlib.sha256(repr(value).encode()).hexdigest()
