from __future__ import annotations

import difflib
import signal
from collections.abc import Callable
from pathlib import Path

import pytest

GOLDEN = Path(__file__).parent / "golden"

if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    # a shell starts background jobs deaf to Ctrl-C, and so would be everything the tests start
    signal.signal(signal.SIGINT, signal.default_int_handler)


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
