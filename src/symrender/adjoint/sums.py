"""Tables of sums: adjoints (4, columns), and numbers of every parameter and channel (parameters, 4)."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from symrender.jit.marks import inlined, jitable

Array = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]


@inlined
def clear(sums: Array) -> None:
    """Set a table to 0."""
    for row in range(sums.shape[0]):
        for k in range(sums.shape[1]):
            sums[row, k] = 0.0


@inlined
def clear_used(sums: Array, used: Ints) -> None:
    """Set the columns ``used`` of a table to 0."""
    for row in range(sums.shape[0]):
        for k in used:
            sums[row, k] = 0.0


@inlined
def clear_columns(own: Array) -> None:
    """Set one wall's adjoint to 0."""
    for k in range(own.shape[0]):
        own[k] = 0.0


@inlined
def put(sums: Array, out: Array) -> None:
    """Copy a table."""
    for row in range(sums.shape[0]):
        for k in range(sums.shape[1]):
            out[row, k] = sums[row, k]


@inlined
def add(sums: Array, out: Array) -> None:
    """Add a table to another one."""
    for row in range(sums.shape[0]):
        for k in range(sums.shape[1]):
            out[row, k] += sums[row, k]


@inlined
def largest_channel(sums: Array) -> float:
    """The largest number of any parameter's three channels."""
    largest = 0.0
    for p in range(sums.shape[0]):
        for c in range(3):
            largest = max(largest, abs(sums[p, c]))
    return largest


@inlined
def largest_change(sums: Array, others: Array) -> float:
    """By how much two tables differ at most in any parameter's three channels."""
    change = 0.0
    for p in range(sums.shape[0]):
        for c in range(3):
            change = max(change, abs(sums[p, c] - others[p, c]))
    return change


@jitable
def contract(adjoint: Array, moves: Array, out: Array) -> None:
    """out[p, c] += sum over columns of adjoint[c] moves[p]; ``out`` (parameters, 4)."""
    for p in range(moves.shape[0]):
        for c in range(4):
            total = 0.0
            for k in range(moves.shape[1]):
                total += adjoint[c, k] * moves[p, k]
            out[p, c] += total
