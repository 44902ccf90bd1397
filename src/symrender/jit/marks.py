"""Which functions kernels may call, and which of them are copied into every caller."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from types import FunctionType
from typing import Any, Final, TypeVar

F = TypeVar("F", bound=Callable[..., Any])

_MOST_COPIED: Final = 100
_INLINE: dict[FunctionType, bool] = {}
_AT_NUMBA: set[FunctionType] = set()


def jitable(function: F, *, inline: bool = False) -> F:
    """Mark a plain function as callable from kernels; it stays callable from Python, for tests.

    ``inline`` copies its machine code into every caller.
    """
    assert isinstance(function, FunctionType), f"{function!r}: only a plain function can be translated"
    _INLINE[function] = inline
    return function


def inlined(function: F) -> F:
    """``jitable`` with ``inline``: for a function whose arguments (a scene's arrays) cost more to pass than to use."""
    return jitable(function, inline=True)


def is_marked(function: FunctionType) -> bool:
    """Whether kernels may call it."""
    return function in _INLINE


def is_inlined(function: FunctionType) -> bool:
    """Whether its machine code is copied into every caller."""
    return _INLINE.get(function, False)


def is_copied(marked: bool, instructions: Sequence[str]) -> bool:
    """Whether a function ``marked`` to be copied into every caller is.

    Of long ones LLVM's own inliner is the judge: copying them all makes half as much machine code again, and no kernel
    faster.
    """
    return marked and len(instructions) <= _MOST_COPIED


def known_to_numba() -> None:
    """Tell Numba of every function marked so far, so that it can compile what is refused here."""
    from numba.extending import register_jitable

    for function, inline in _INLINE.items():
        if function not in _AT_NUMBA:
            _AT_NUMBA.add(function)
            register_jitable(forceinline=inline)(function)
