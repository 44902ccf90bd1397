from __future__ import annotations

import difflib
from collections.abc import Callable
from pathlib import Path

import pytest

GOLDEN = Path(__file__).parent / "golden"


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--update-golden", action="store_true", help="rewrite the files of tests/golden")


@pytest.fixture
def golden(request: pytest.FixtureRequest) -> Callable[[str, str], None]:
    """Compare a text with the file of that name in tests/golden; a difference is shown as a unified diff."""

    def compare(name: str, text: str) -> None:
        path = GOLDEN / name
        if request.config.getoption("--update-golden"):
            path.write_text(text, encoding="utf-8")
            return
        stored = path.read_text(encoding="utf-8")
        lines = difflib.unified_diff(stored.splitlines(), text.splitlines(), name, "emitted now", lineterm="", n=2)
        if stored != text:
            pytest.fail("\n".join([*lines, "--update-golden rewrites the file"]), pytrace=False)

    return compare
