"""Machine code of LLVM IR by llvmlite, without any compiler or linker, and loading it."""

from __future__ import annotations

import ctypes
import functools
import hashlib
import threading
from collections.abc import Callable
from typing import Any

from symrender.jit.program import ENTRY

_LOCK = threading.Lock()
_EFFORT = 2
"""LLVM's level of optimisation, of 0 to 3: the third takes a tenth longer, and no kernel is faster by it."""
_LINKED: list[Any] = []
"""What holds loaded machine code: it stays for as long as the process does."""


@functools.lru_cache(maxsize=8)
def _target(level: str | None) -> Any:
    """Target for a level of processors, by default for this one."""
    import llvmlite.binding as llvm

    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    return llvm.Target.from_triple(llvm.get_process_triple()).create_target_machine(
        cpu=llvm.get_host_cpu_name() if level is None else level,
        features=llvm.get_host_cpu_features().flatten() if level is None else "",
        opt=_EFFORT,
        reloc="pic",
        codemodel="small",
    )


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


def machine_code(text: str, level: str | None = None) -> bytes:
    """Object code of LLVM IR, optimised under strict floating point, for this processor or a level of them."""
    import llvmlite.binding as llvm

    with _LOCK:
        target = _target(level)
        module = llvm.parse_assembly(text)
        module.triple, module.data_layout = llvm.get_process_triple(), str(target.target_data)
        module.verify()
        tuning = llvm.create_pipeline_tuning_options(speed_level=_EFFORT)
        tuning.loop_vectorization = tuning.slp_vectorization = True
        builder = llvm.create_pass_builder(target, tuning)
        builder.getModulePassManager().run(module, builder)
        code: bytes = target.emit_object(module)
        return code


def loaded(code: bytes) -> Callable[[int], int]:
    """The kernel's entry in object code: it takes the address of its block, and runs without the interpreter's lock.

    Linked by JITLink, which gives an object one piece of memory. RuntimeDyld asks for each section's own, and where the
    process holds so much that they come to lie more than 2 GB apart, it aborts the process.
    """
    import llvmlite.binding as llvm

    with _LOCK:
        _target(None)
        linker = llvm.create_lljit_compiler(use_jit_link=True)
        library = llvm.JITLibraryBuilder().add_object_img(code).export_symbol(ENTRY).add_current_process()
        tracker = library.link(linker, ENTRY)
        _LINKED.append((linker, tracker))
        address = tracker[ENTRY]
    if not address:
        raise RuntimeError(f"object code without {ENTRY}")
    return ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_void_p)(address)
