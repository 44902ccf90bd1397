"""Functions of the package, translated, give Numba's bits; whole kernels: ``translated_kernels_equal_numba.py``."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from symrender.chambers.lobes.mass import cap_share, facing_mass
from symrender.jit.kernel import Kernel
from symrender.quadrature.gauss import disk_level, gauss_table, order

POPULATION = 300


def share(n: float, theta: float, tilt: float, out: Any, table: Any) -> float:
    return cap_share(n, theta, tilt, 0.5 * math.pi, table) + out[0]


def mass(n: float, theta: float, tilt: float, out: Any, table: Any) -> float:
    return facing_mass(n, theta, tilt, table) + out[0]


def steps(n: float, theta: float, tilt: float, out: Any, table: Any) -> float:
    return float(order(int(n) % 8, theta)) + 0.5 * disk_level(2, tilt) + out[0]


@pytest.mark.parametrize("function", [share, mass, steps], ids=lambda function: function.__name__)
def test_functions_of_the_package(function: Callable[..., Any], monkeypatch: pytest.MonkeyPatch) -> None:
    rng = np.random.default_rng(11)
    arguments = [
        (float(10.0 ** rng.uniform(0, 4)), float(rng.uniform(1e-3, 1.57)), float(rng.uniform(1e-3, 3.0)))
        for _ in range(POPULATION)
    ]
    out, table = np.zeros(8), gauss_table()
    found = {}
    for mode in ("llvm", "numba"):
        monkeypatch.setenv("SYMRENDER_COMPILER", mode)
        kernel = Kernel(function, None, {"_nrt": False})  # type: ignore[arg-type]
        found[mode] = np.array([kernel(*each, out, table) for each in arguments])
        assert kernel.by_numba == (mode == "numba")
    assert len(np.unique(found["llvm"])) >= 10, "there is signal"
    assert found["llvm"].tobytes() == found["numba"].tobytes()
