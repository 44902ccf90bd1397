"""Words of 32 bits: the whole-number arithmetic of a hash that gives the same numbers in every language.

A word is a whole number in two's complement, -2^31 <= word < 2^31.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import sympy as sp

from symrender.kernel.block import Block, whole
from symrender.kernel.program import Function


class xor(sp.Function):
    """Exclusive or of two words."""

    nargs = 2
    is_integer = True


class shift_right(sp.Function):
    """A word shifted right by 1 to 31 bits, zeros coming in."""

    nargs = 2
    is_integer = True


class product32(sp.Function):
    """The low 32 bits of the product of two words."""

    nargs = 2
    is_integer = True


def word(value: int) -> int:
    """``value`` wrapped to a word."""
    return (value + (1 << 31)) % (1 << 32) - (1 << 31)


MEANINGS: Mapping[str, Callable[[int, int], int]] = {
    "xor": lambda a, b: word(a ^ b),
    "shift_right": lambda a, bits: word((a % (1 << 32)) >> bits),
    "product32": lambda a, b: word(a * b),
}
"""What each operation computes, on Python's whole numbers."""

_FIRST, _SECOND = word(0x7FEB352D), word(0x846CA68B)


def scramble() -> Function:
    """A bijection of the words in which every bit of the input moves every bit of the output.

    Two rounds of xor-shift and multiplication with the constants of C. Wellons, "Prospecting for hash functions"
    (lowbias32, 2018).
    """
    x = whole("x")
    block = Block()
    for bits, factor in ((16, _FIRST), (15, _SECOND)):
        block.set(x, xor(x, shift_right(x, bits)))
        block.set(x, product32(x, factor))
    block.leave(xor(x, shift_right(x, 16)))
    return Function("scramble", (x,), block.statements, "the word x, hashed")


def pixel_word() -> Function:
    """The word all random numbers of a pixel start from."""
    column, row, seed, mixed = whole("column"), whole("row"), whole("seed"), whole("mixed")
    block = Block()
    block.call("scramble", (seed,), "mixed")
    block.call("scramble", (xor(mixed, row),), "mixed")
    block.call("scramble", (xor(mixed, column),), "mixed")
    block.leave(mixed)
    return Function("pixel_word", (column, row, seed), block.statements, "hash of seed, row and column")


def uniform_pair() -> Function:
    """Two independent numbers in [0, 1), multiples of 2^-24, so that every target holds them exactly."""
    key, index = whole("key"), whole("index")
    first, second = whole("first"), whole("second")
    block = Block()
    block.call("scramble", (xor(key, 2 * index),), "first")
    block.call("scramble", (xor(key, 2 * index + 1),), "second")
    block.leave(*(shift_right(value, 8) * sp.Float(2.0**-24) for value in (first, second)))
    return Function("uniform_pair", (key, index), block.statements, "random numbers of sample index")
