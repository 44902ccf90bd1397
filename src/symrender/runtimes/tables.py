"""Tables of what the faces of scenes send each other: made once a process, or taken from who made them before."""

from __future__ import annotations

import hashlib
import threading
from collections import OrderedDict
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np

from symrender.radiosity.endless import laid
from symrender.radiosity.stored import packed, unpacked
from symrender.radiosity.table import Sendings, sendings
from symrender.radiosity.work import Kept, Spent, Work
from symrender.scene.radiometric.arrays import ALL, RadiometricArrays

KEPT: Final = 16
"""Tables that are kept in memory; a derivative has its own."""

SHARED: Final = 256
"""Evaluations of a table, over those of a ray: all rays of a scene share it."""

_tables: OrderedDict[str, Sendings] = OrderedDict()
_lock = threading.Lock()


@dataclass(frozen=True)
class Need:
    """A table that is needed: what the faces of a scene send each other, for radiances to ``tol``.

    It takes about ``SHARED`` times as many evaluations as ``budget``, those of a ray, at most.
    """

    arrays: RadiometricArrays
    tol: float
    budget: int = 1_000_000

    @cached_property
    def key(self) -> str:
        """Digest of all the numbers that the table is made of; from where the scene is seen is none of them."""
        of = self.arrays
        parts = (of.materials, of.terms, of.shapes, of.facets, of.frames, of.lights, of.directions)
        digest = hashlib.sha256()
        for part in (*parts, np.array([of.bounces, of.first_gloss, self.budget], np.int64), np.array([self.tol])):
            data = np.ascontiguousarray(part).tobytes()
            digest.update(len(data).to_bytes(8, "little") + data)
        return digest.hexdigest()


def table_of(need: Need, threads: int = 1, kept: Kept | None = None) -> Sendings:
    """The table that is needed; made once, and kept in memory. What it is made of may be ``kept`` on the way."""
    with _lock:
        if need.key not in _tables:
            work = Work(threads, kept, need.key, Spent(float(SHARED) * need.budget))
            _put(need, sendings(laid(need.arrays), need.arrays.bounces == ALL, need.tol, work))
        _tables.move_to_end(need.key)
        return _tables[need.key]


def is_had(need: Need) -> bool:
    """Whether the table is in memory."""
    with _lock:
        return need.key in _tables


def given(need: Need, fields: Mapping[str, str]) -> bytes:
    """The table, which is had, as bytes; ``fields`` say who made it."""
    return packed(table_of(need), {**fields, "table": need.key})


def taken(need: Need, fields: Mapping[str, str], data: bytes) -> bool:
    """Take the table from bytes of ``given``; False where they are altered, another's, or of another table."""
    with _lock:
        if need.key not in _tables:
            found = unpacked(data, {**fields, "table": need.key}, laid(need.arrays))
            if found is None:
                return False
            _put(need, found)
    return True


def _put(need: Need, sent: Sendings) -> None:
    _tables[need.key] = sent
    while len(_tables) > KEPT:
        _tables.popitem(last=False)
