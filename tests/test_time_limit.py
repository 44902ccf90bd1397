"""The limit of a test does not run while a kernel is compiled, by us or by Numba."""

from __future__ import annotations

import signal
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest

from conftest import alone
from symrender.jit.compiled import compiled

pytestmark = pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="POSIX alarms")


def square(x: float) -> float:
    return x * x


@pytest.fixture
def limit() -> object:
    """An alarm far away, as pytest-timeout sets it; the test's own comes back afterwards."""
    before = signal.setitimer(signal.ITIMER_REAL, 1000.0)
    yield
    signal.setitimer(signal.ITIMER_REAL, *before)


@pytest.mark.usefixtures("limit")
def test_our_compiler_takes_no_time(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    import symrender.jit.kernel as module

    seen: list[float] = []
    translated = module.translated

    def slow(*given: object, **named: object) -> object:
        seen.append(signal.getitimer(signal.ITIMER_REAL)[0])
        time.sleep(1.0)
        return translated(*given, **named)  # type: ignore[arg-type]

    tmp_path.chmod(0o700)
    monkeypatch.setenv("SYMRENDER_CACHE", str(tmp_path))
    monkeypatch.setattr(module, "translated", slow)
    assert compiled(square)(3.0) == 9.0
    assert seen == [0.0]
    assert signal.getitimer(signal.ITIMER_REAL)[0] > 999.2


@pytest.mark.usefixtures("limit")
def test_the_limit_runs_on_elsewhere() -> None:
    time.sleep(0.2)
    assert signal.getitimer(signal.ITIMER_REAL)[0] < 999.9


@pytest.mark.usefixtures("limit")
def test_numbas_takes_none_either() -> None:
    if "numba" not in sys.modules:
        pytest.skip("no test of this session is compiled by Numba")
    import numba
    from numba.core import event

    seen: list[float] = []

    class Listener(event.Listener):  # type: ignore[misc]
        def on_start(self, event: object) -> None:
            seen.append(signal.getitimer(signal.ITIMER_REAL)[0])

        def on_end(self, event: object) -> None:
            pass

    with event.install_listener("numba:compile", Listener()):
        assert numba.njit(square)(np.float64(3.0)) == 9.0
    assert seen and seen[0] == 0.0
    assert signal.getitimer(signal.ITIMER_REAL)[0] > 990.0


def test_who_needs_what_another_compiles_waits_for_it(tmp_path: Path) -> None:
    found, order = [], []

    def second() -> None:
        with alone(tmp_path / "kernel") as waited:
            order.append("second")
            found.append(waited)

    with alone(tmp_path / "kernel") as waited:
        found.append(waited)
        other = threading.Thread(target=second)
        other.start()
        other.join(0.2)
        order.append("first")
    other.join()
    assert (order, found) == (["first", "second"], [False, True])
    with alone(tmp_path / "kernel") as waited:
        assert not waited
