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
_ENGINES: list[Any] = []
"""What holds loaded machine code: it stays for as long as the process does."""


@functools.lru_cache(maxsize=1)
def _target() -> Any:
    import llvmlite.binding as llvm

    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    return llvm.Target.from_triple(llvm.get_process_triple()).create_target_machine(
        cpu=llvm.get_host_cpu_name(),
        features=llvm.get_host_cpu_features().flatten(),
        opt=3,
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


def machine_code(text: str) -> bytes:
    """Object code of LLVM IR, optimised fully under strict floating point."""
    import llvmlite.binding as llvm

    with _LOCK:
        target = _target()
        module = llvm.parse_assembly(text)
        module.triple, module.data_layout = llvm.get_process_triple(), str(target.target_data)
        module.verify()
        tuning = llvm.create_pipeline_tuning_options(speed_level=3)
        tuning.loop_vectorization = tuning.slp_vectorization = True
        builder = llvm.create_pass_builder(target, tuning)
        builder.getModulePassManager().run(module, builder)
        code: bytes = target.emit_object(module)
        return code


def loaded(code: bytes) -> Callable[[int], int]:
    """The kernel's entry in object code: it takes the address of its block, and runs without the interpreter's lock."""
    import llvmlite.binding as llvm

    with _LOCK:
        engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), _new_target())
        engine.add_object_file(llvm.ObjectFileRef.from_data(code))
        engine.finalize_object()
        address = engine.get_function_address(ENTRY)
        _ENGINES.append(engine)
    if not address:
        raise RuntimeError(f"object code without {ENTRY}")
    return ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_void_p)(address)


def _new_target() -> Any:
    import llvmlite.binding as llvm

    _target()
    return llvm.Target.from_triple(llvm.get_process_triple()).create_target_machine(reloc="pic", codemodel="small")
