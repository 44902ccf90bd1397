"""Machine code of LLVM IR by llvmlite, without any compiler or linker, and loading it."""

from __future__ import annotations

import ctypes
import functools
import hashlib
import subprocess
import sys
import tempfile
import threading
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, Final, Protocol

from symrender.jit.assemble import divided, joined, object_code, target_of
from symrender.jit.beside import processors
from symrender.jit.program import ENTRY

_LOCK = threading.Lock()
_LINKED: list[Any] = []
"""What holds loaded machine code: it stays for as long as the process does."""

_ALONE: Final = 400_000
"""Characters of IR for which no second process is started: it takes a third of a second to begin."""


class Kept(Protocol):
    """Where machine code of parts of kernels is kept (``shelf.py``)."""

    def part(self, text: str) -> bytes | None:
        """Object code of a part's IR, None where there is none."""

    def put_part(self, text: str, code: bytes) -> None:
        """Keep it."""


@functools.lru_cache(maxsize=1)
def machine_name() -> str:
    """What the machine code depends on beside the kernel: processor, its features, llvmlite and its LLVM."""
    import llvmlite
    import llvmlite.binding as llvm

    parts = (
        llvmlite.__version__,
        str(llvm.llvm_version_info),
        llvm.get_process_triple(),
        llvm.get_host_cpu_name(),
        llvm.get_host_cpu_features().flatten(),
    )
    return hashlib.sha256(repr(parts).encode()).hexdigest()


def machine_code(modules: Sequence[str], level: str | None = None, kept: Kept | None = None) -> bytes:
    """Object code of a kernel's modules of LLVM IR, for this processor or a level of them.

    Parts of a large kernel that are ``kept`` are not compiled again, whichever kernel they were compiled for.
    """
    if kept is None or len(modules) == 1:
        return joined(_object_codes(modules, level))
    known = {text: code for text in modules if (code := kept.part(text)) is not None}
    missing = [text for text in modules if text not in known]
    made = dict(zip(missing, _object_codes(missing, level), strict=True))
    for text, code in made.items():
        kept.put_part(text, code)
    known |= made
    return joined([known[text] for text in modules])


def _object_codes(texts: Sequence[str], level: str | None) -> list[bytes]:
    """Object code of each; of many, half is compiled by a process of its own meanwhile, where there can be one."""
    here: list[str] = []
    there: list[str] = []
    for text in sorted(texts, key=len, reverse=True):
        min(here, there, key=lambda half: sum(map(len, half))).append(text)
    process = _other_process(there, level) if sum(map(len, texts)) > _ALONE else None
    try:
        with _LOCK:
            codes = {text: object_code(text, level) for text in here}
        others = b"" if process is None else process.communicate()[0]
        if not others or process is None or process.returncode != 0:
            with _LOCK:
                codes |= {text: object_code(text, level) for text in there}
        else:
            codes |= zip(there, divided(others), strict=True)
    finally:
        if process is not None and process.poll() is None:
            process.kill()
            process.wait()
    return [codes[text] for text in texts]


def _other_process(texts: Sequence[str], level: str | None) -> subprocess.Popen[bytes] | None:
    """A process that compiles modules, None where this machine has one processor, or gives us no process."""
    if not texts or not sys.executable or processors() < 2:
        return None
    words = [sys.executable, "-P", str(Path(__file__).with_name("assemble.py")), *([] if level is None else [level])]
    with tempfile.TemporaryFile() as file:
        file.write(joined([text.encode() for text in texts]))
        file.seek(0)
        try:
            return subprocess.Popen(words, stdin=file, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
        except OSError:
            return None


def loaded(code: bytes) -> Callable[[int], int]:
    """The kernel's entry in machine code: it takes the address of its block, and runs without the interpreter's lock.

    Linked by JITLink, which gives an object one piece of memory. RuntimeDyld asks for each section's own, and where the
    process holds so much that they come to lie more than 2 GB apart, it aborts the process.
    """
    import llvmlite.binding as llvm

    with _LOCK:
        target_of(None)
        linker = llvm.create_lljit_compiler(use_jit_link=True)
        library = llvm.JITLibraryBuilder().export_symbol(ENTRY).add_current_process()
        for each in divided(code):
            library.add_object_img(each)
        tracker = library.link(linker, ENTRY)
        _LINKED.append((linker, tracker))
        address = tracker[ENTRY]
    if not address:
        raise RuntimeError(f"object code without {ENTRY}")
    return ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_void_p)(address)
