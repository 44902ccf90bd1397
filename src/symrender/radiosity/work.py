"""Rows of numbers that are dear: worked out on threads, or taken over from what an earlier process kept of them.

A table is made of a few hundred arrays, light at so many places each. What fills a row depends on nothing but arrays,
so that a digest of these names it; whoever keeps rows by their names gives a table that is interrupted back bit for
bit, and nothing that another scene, another tolerance or another cell was asked can be taken for it.
"""

from __future__ import annotations

import hashlib
import math
import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from typing import Any, Final, Protocol

import numpy as np
import numpy.typing as npt

from symrender.radiometric.vectors import Array

CHUNK: Final = 256
"""Rows a thread works out at a time."""
PIECE: Final = 64 * CHUNK
"""Rows that are kept together: some seconds of a processor."""


class Kept(Protocol):
    """Where rows are kept by the digest of all they are made of."""

    def find(self, name: str) -> Array | None:
        """What was kept under this name."""

    def keep(self, name: str, values: Array) -> None:
        """Keep it."""


@dataclass
class Spent:
    """Evaluations that a table has taken so far, of at most about ``most``."""

    most: float = math.inf
    evaluations: float = 0.0

    def lasts(self, part: float, more: float = 0.0) -> bool:
        """Whether ``more`` evaluations fit into this part of the most."""
        return self.evaluations + more <= part * self.most


@dataclass(frozen=True)
class Work:
    """How rows are worked out: on how many ``threads``, 0 for all, and where they are ``kept``, if anywhere.

    ``about`` names what they are made of beside arrays: the scene. What they take is added to ``spent``.
    """

    threads: int = 1
    kept: Kept | None = None
    about: str = ""
    spent: Spent = field(default_factory=Spent)

    def filled(
        self, width: int, fill: Callable[[slice, Array], None], common: Sequence[Any], each: Sequence[npt.NDArray[Any]]
    ) -> Array:  # fmt: skip
        """(N, width): what ``fill(part, rows)`` adds to zero rows, made of all of ``common`` and N rows of ``each``."""
        found = np.zeros((len(each[0]), width))
        if self.kept is None:
            in_parts(lambda part: fill(part, found[part]), 0, len(found), self.threads)
            return found
        about = _digest([self.about.encode(), np.array([width]), *common])
        for begin in range(0, len(found), PIECE):
            piece = slice(begin, min(begin + PIECE, len(found)))
            name = _digest([about, *(rows[piece] for rows in each)]).hex()
            before = self.kept.find(name)
            if before is not None and before.shape == found[piece].shape:
                found[piece] = before
                continue
            in_parts(lambda part: fill(part, found[part]), piece.start, piece.stop, self.threads)
            self.kept.keep(name, found[piece])
        return found


def in_parts(run: Callable[[slice], None], first: int, end: int, threads: int) -> None:
    """Call ``run`` with every part of the rows from ``first`` up to ``end``."""
    parts = [slice(begin, min(begin + CHUNK, end)) for begin in range(first, end, CHUNK)]
    threads = threads or os.cpu_count() or 1
    if threads == 1 or len(parts) < 2:
        for part in parts:
            run(part)
        return
    with ThreadPoolExecutor(threads) as pool:
        try:
            for _ in pool.map(run, parts):
                pass
        except BaseException:
            # what waits is dropped, so that Ctrl-C is heard within a part
            pool.shutdown(cancel_futures=True)
            raise


def _digest(values: Sequence[Any]) -> bytes:
    digest = hashlib.sha256()
    for value in values:
        data = value if isinstance(value, bytes) else np.ascontiguousarray(value).tobytes()
        # lengths, so that no two lists of parts have one text
        digest.update(len(data).to_bytes(8, "little"))
        digest.update(data)
    return digest.digest()
