"""What must be compiled is said once, with the time it should take; what is kept is not spoken of."""

from __future__ import annotations

from pathlib import Path

import pytest

from symrender.first_use import USUAL, expected_seconds, first_use


@pytest.fixture
def empty_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("SYMRENDER_CACHE", str(tmp_path / "cache"))
    return tmp_path


def test_it_is_said_once(empty_cache: Path) -> None:
    said: list[tuple[int, int, str]] = []
    for _ in range(2):
        with first_use("truth", lambda *heard: said.append(heard)):
            pass
    assert said == [(0, 0, f"compiling truth kernels, once: about {USUAL['truth']:.0f} s")]
    assert expected_seconds("truth") < 1 and expected_seconds("numeric") == USUAL["numeric"]


def test_what_failed_is_said_again(empty_cache: Path) -> None:
    said: list[str] = []
    for _ in range(2):
        with pytest.raises(ZeroDivisionError), first_use("truth", lambda done, total, label: said.append(label)):
            raise ZeroDivisionError
    assert len(said) == 2


def test_the_rest_of_a_compilation_says_nothing_of_its_time(empty_cache: Path) -> None:
    with first_use("symbolic", None, whole=False):
        pass
    assert expected_seconds("symbolic") == USUAL["symbolic"]
