"""Object code of modules of LLVM IR. As a program of its own: IR on standard input, object code on standard output.

A process has one LLVM, which compiles one module at a time, so that half of many are given to a second process. It
reads nothing of the package.
"""

from __future__ import annotations

import functools
import sys
from collections.abc import Sequence
from typing import Any

EFFORT = 2
"""LLVM's level of optimisation, of 0 to 3: the third takes a tenth longer, and no kernel is faster by it."""


@functools.lru_cache(maxsize=8)
def target_of(level: str | None) -> Any:
    """Target for a level of processors, by default for this one."""
    import llvmlite.binding as llvm

    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    return llvm.Target.from_triple(llvm.get_process_triple()).create_target_machine(
        cpu=llvm.get_host_cpu_name() if level is None else level,
        features=llvm.get_host_cpu_features().flatten() if level is None else "",
        opt=EFFORT,
        reloc="pic",
        codemodel="small",
    )


def object_code(text: str, level: str | None) -> bytes:
    """Object code of LLVM IR, optimised under strict floating point."""
    import llvmlite.binding as llvm

    target = target_of(level)
    module = llvm.parse_assembly(text)
    module.triple, module.data_layout = llvm.get_process_triple(), str(target.target_data)
    module.verify()
    tuning = llvm.create_pipeline_tuning_options(speed_level=EFFORT)
    tuning.loop_vectorization = tuning.slp_vectorization = True
    builder = llvm.create_pass_builder(target, tuning)
    builder.getModulePassManager().run(module, builder)
    code: bytes = target.emit_object(module)
    return code


def joined(contents: Sequence[bytes]) -> bytes:
    """Several contents as one: how many, how long each is, and all of them."""
    lengths = (len(contents), *map(len, contents))
    return b"".join([*(length.to_bytes(8, "little") for length in lengths), *contents])


def divided(whole: bytes) -> list[bytes]:
    """What ``joined`` made one of; raises ``ValueError`` where it is cut short."""
    count = int.from_bytes(whole[:8], "little")
    places = range(8, 8 + 8 * min(count, len(whole) // 8), 8)
    start, found = 8 * count + 8, []
    for length in (int.from_bytes(whole[place : place + 8], "little") for place in places):
        found.append(whole[start : start + length])
        start += length
    if start != len(whole) or not found:
        raise ValueError(f"machine code of {len(whole)} bytes, of which {start} are known")
    return found


if __name__ == "__main__":
    chosen = sys.argv[1] if len(sys.argv) > 1 else None
    sys.stdout.buffer.write(joined([object_code(each.decode(), chosen) for each in divided(sys.stdin.buffer.read())]))
