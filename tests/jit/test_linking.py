"""Machine code is linked wherever its memory lies: no arrangement of the process may abort it."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

FAR = """
import ctypes, math, sys
import numpy as np
from symrender.jit import parts
from symrender.jit.assemble import divided
from symrender.jit.call import Loaded
from symrender.jit.machine import loaded, machine_code
from symrender.jit.program import translated
from symrender.jit.types import type_of

def wave(value, i):
    return math.sin(value) + (0.3, 0.7, 1.1, 1.9)[i % 4] * math.exp(value)

def waves(values):
    total = 0.0
    for i in range(values.size):
        total += wave(values[i], i)
    return total

values = np.linspace(0.0, 1.0, 9)
types = (type_of(values),)
if sys.argv[1] == "2":
    # the holes hold one object each
    parts.LARGE = parts.LONG = 1
made = translated(waves, types)
code = machine_code(made.modules)
assert len(divided(code)) == int(sys.argv[1])
expected = waves(values)
libc = ctypes.CDLL(None)
libc.mmap.restype = ctypes.c_void_p
libc.mmap.argtypes = [ctypes.c_void_p, ctypes.c_size_t, ctypes.c_int, ctypes.c_int, ctypes.c_int, ctypes.c_long]
libc.munmap.argtypes = [ctypes.c_void_p, ctypes.c_size_t]
NOTHING, PAGE = 0x4022, 4096  # private, anonymous, not reserved

def taken(size):
    found = libc.mmap(None, size, 0, NOTHING, -1, 0)
    assert found not in (None, 2**64 - 1)
    return found

found = []
for pages in range(1, 13):
    area, wall = taken(16 << 20), taken(4 << 30)
    while taken(PAGE) > wall:
        pass  # every other hole above is filled
    libc.munmap(area + (8 << 20), pages * PAGE)
    found.append(Loaded(loaded(code), types, made.result)(values))
print(len(found), "equal" if all(abs(each - expected) < 1e-14 for each in found) else found)
"""


@pytest.mark.skipif(sys.platform != "linux", reason="the memory map is Linux's")
@pytest.mark.parametrize("modules", ["1", "2"])
def test_sections_that_fit_nowhere_beside_each_other(tmp_path: Path, modules: str) -> None:
    """A hole for one of its sections, and 4 GB of nothing before the next: RuntimeDyld aborts the process here."""
    program = tmp_path / "far.py"
    program.write_text(FAR)
    done = subprocess.run([sys.executable, program, modules], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    assert done.stdout.split() == ["12", "equal"]
