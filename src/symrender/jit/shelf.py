"""Shelves: folders in which machine code is found under a key made of everything it was made of.

The name of an entry is a digest of all that decides the machine code: the types of the arguments, the processor, the
translator's own texts, the texts of the modules whose functions were translated, and the values of the globals they
read. Which modules and globals these are is what the translator met, kept in a list of its own (``.list``) beside the
machine code (``.kernel``): nobody keeps it by hand, and nothing can be left out.

Parts of large kernels (``parts.py``) lie beside them (``.part``), named by their texts, for other kernels that have the
same.

There are two kinds: the folder that comes with the package, for levels of processors, only read; and the user's cache,
for this very processor and this llvmlite.
"""

from __future__ import annotations

import functools
import hashlib
import json
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from symrender.jit.entries import cache_directory, read_entry, write_entry
from symrender.jit.levels import levels_here
from symrender.jit.machine import machine_name
from symrender.jit.program import Translation, digest_of
from symrender.jit.source import module_text
from symrender.jit.types import Type, result_named

PACKAGE_FOLDER: Final = Path(__file__).parents[1] / "_kernels"
"""What a wheel with machine code brings; a wheel without it and a clone have no such folder."""

_LISTS: Final = 8
"""Lists of dependencies kept for one kernel: switching between versions of the sources does not compile again."""


@dataclass(frozen=True)
class Shelf:
    """A folder, the processor its code is for, and whether its files must belong to this user to be believed."""

    folder: Path
    machine: str
    private: bool = True

    def lists(self, kernel: tuple[str, str], types: tuple[Type, ...], checked: bool) -> Path:
        """File of the lists of what a kernel (module, name) for these types depends on."""
        return self.folder / f"{_digest((kernel, types, checked, self.machine, _translator()))}.list"

    def found(self, lists: Path) -> Iterator[bytes]:
        """Entries, a line of JSON and the machine code, whose dependencies are as they are now."""
        for names in self.listed(lists):
            state = _state(names)
            content = None if state is None else read_entry(_code_path(lists, state), private=self.private)
            if content is not None:
                yield content

    def listed(self, lists: Path) -> list[dict[str, Any]]:
        """Names of what versions of a kernel depend on, and the seconds each took, the last made first."""
        content = read_entry(lists, private=self.private)
        try:
            return [] if content is None else list(json.loads(content))
        except ValueError:
            return []

    def put(self, lists: Path, made: Translation, code: bytes, seconds: float) -> None:
        """Keep the machine code of a translation."""
        names: dict[str, Any] = {"texts": sorted(made.texts), "globals": sorted(map(list, made.constants))}
        state = _state(names)
        if state is None:
            return
        head = {"result": result_named(made.result), "sites": [[s.file, s.line, s.reason] for s in made.sites]}
        write_entry(_code_path(lists, state), json.dumps(head).encode() + b"\n" + code)
        others = [each for each in self.listed(lists) if any(each[key] != names[key] for key in names)]
        kept = [names | {"seconds": seconds}, *others][:_LISTS]
        write_entry(lists, json.dumps(kept).encode())

    def part(self, text: str) -> bytes | None:
        """Machine code of a part of a kernel, made of this text."""
        return read_entry(self._part_path(text), private=self.private)

    def put_part(self, text: str, code: bytes) -> None:
        """Keep the machine code of a part for other kernels."""
        write_entry(self._part_path(text), code)

    def _part_path(self, text: str) -> Path:
        return self.folder / f"{_digest((text, self.machine, _translator()))}.part"


def own_shelf() -> Shelf | None:
    """The user's cache, None where there is none."""
    directory, _ = cache_directory()
    return None if directory is None else Shelf(directory, machine_name())


def package_shelves() -> tuple[Shelf, ...]:
    """What comes with the package and this processor can run, the best first.

    Its files may belong to anyone who may write the package's texts: they are executed with the same trust.
    """
    if not PACKAGE_FOLDER.is_dir():
        return ()
    return tuple(Shelf(PACKAGE_FOLDER, level, private=False) for level in levels_here())


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
