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
from typing import Any

from symrender.jit.assemble import object_code, target_of
from symrender.jit.beside import processors
from symrender.jit.program import ENTRY

_LOCK = threading.Lock()
_LINKED: list[Any] = []
"""What holds loaded machine code: it stays for as long as the process does."""


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


def machine_code(modules: Sequence[str], level: str | None = None) -> bytes:
    """Object code of a kernel's modules of LLVM IR, for this processor or a level of them.

    All but the first are compiled by processes of their own meanwhile, or here, where there can be none.
    """
    started = [_other_process(text, level) for text in modules[1:]]
    try:
        with _LOCK:
            codes = [object_code(modules[0], level)]
        for text, process in zip(modules[1:], started, strict=True):
            code = b"" if process is None else process.communicate()[0]
            if not code or process is None or process.returncode != 0:
                with _LOCK:
                    code = object_code(text, level)
            codes.append(code)
    finally:
        for process in started:
            if process is not None and process.poll() is None:
                process.kill()
                process.wait()
    return b"".join([len(codes).to_bytes(8, "little"), *(len(code).to_bytes(8, "little") for code in codes), *codes])


def _other_process(text: str, level: str | None) -> subprocess.Popen[bytes] | None:
    """A process that compiles a module, None where this machine has one processor, or gives us no process."""
    if not sys.executable or processors() < 2:
        return None
    words = [sys.executable, "-P", str(Path(__file__).with_name("assemble.py")), *([] if level is None else [level])]
    with tempfile.TemporaryFile() as file:
        file.write(text.encode())
        file.seek(0)
        try:
            return subprocess.Popen(words, stdin=file, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
        except OSError:
            return None


def objects_in(code: bytes) -> list[bytes]:
    """The object files in what ``machine_code`` gave; raises ``ValueError`` where it is cut short."""
    count = int.from_bytes(code[:8], "little")
    lengths = [int.from_bytes(code[8 * k + 8 : 8 * k + 16], "little") for k in range(min(count, 64))]
    start, found = 8 * count + 8, []
    for length in lengths:
        found.append(code[start : start + length])
        start += length
    if start != len(code) or not found:
        raise ValueError(f"machine code of {len(code)} bytes, of which {start} are known")
    return found


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
        for each in objects_in(code):
            library.add_object_img(each)
        tracker = library.link(linker, ENTRY)
        _LINKED.append((linker, tracker))
        address = tracker[ENTRY]
    if not address:
        raise RuntimeError(f"object code without {ENTRY}")
    return ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_void_p)(address)
