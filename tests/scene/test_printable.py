"""Whatever is shown fits a line and cannot speak to a terminal."""

from __future__ import annotations

from hypothesis import given, settings
from hypothesis import strategies as st

from symrender.scene.printable import printable, shown


@settings(derandomize=True, max_examples=100)
@given(st.text(st.characters(), max_size=80), st.integers(5, 60))
def test_one_printable_line(text: str, limit: int) -> None:
    safe = printable(text, limit)
    assert safe.isprintable()
    assert len(safe) <= limit
    safe.encode("utf-8")
    if text.isprintable() and len(text) <= limit:
        assert safe == text


def test_the_known_tricks() -> None:
    assert printable("\x1b[31m\u202e\u2028\ud800\n") == r"\x1b[31m\u202e\u2028\ud800\n"
    assert printable("x" * 10**7) == "x" * 45 + "..."
    assert shown(10**10**6) == "an integer of 3321929 bits"
    assert [shown(v) for v in (None, True, -1, 1.5, "a", [1], {"a": 1}, 1j)] == [
        *("null", "true", "-1", "1.5", "the text 'a'", "a list of 1", "a mapping of 1", "a complex"),
    ]
