"""What a target is: a function from a Program to text."""

from __future__ import annotations

from typing import Protocol

from symrender.kernel.program import Program


class Target(Protocol):
    """Emit the text of a program; the same program gives the same text, byte for byte."""

    def __call__(self, program: Program) -> str:
        """Text of ``program``."""
        ...
