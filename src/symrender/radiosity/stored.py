"""What faces send as bytes and back: digested, so that what is altered or torn is not believed."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from typing import Any, Final, cast

import numpy as np

from symrender.jit.records import Table
from symrender.radiosity.endless import Laid
from symrender.radiosity.forest import Forest
from symrender.radiosity.records import Cell
from symrender.radiosity.table import Sendings

MARK: Final = b"\x93symrender\x00sent\n"
_DIGEST: Final = 32


def packed(sent: Sendings, fields: Mapping[str, str]) -> bytes:
    """A mark, the digest of what follows, a line of JSON, then the numbers of every forest.

    ``fields`` name the table.
    """
    forests = [(len(each.cells), len(each.roots), len(each.leaves)) for each in sent.forests]
    head = json.dumps({"fields": dict(fields), "fine": sent.fine.hex(), "forests": forests}).encode() + b"\n"
    arrays = [part for each in sent.forests for part in (each.cells, each.roots, each.leaves)]
    body = head + b"".join(np.ascontiguousarray(part).tobytes() for part in arrays)
    return MARK + hashlib.sha256(body).digest() + body


def unpacked(data: bytes, fields: Mapping[str, str], laid: Laid) -> Sendings | None:
    """The table of a scene, or None where ``data`` is not that of these ``fields``, whole and unaltered."""
    body = memoryview(data)[len(MARK) + _DIGEST :]
    if not data.startswith(MARK) or hashlib.sha256(body).digest() != data[len(MARK) : len(MARK) + _DIGEST]:
        return None
    end = data.find(b"\n", len(MARK) + _DIGEST) + 1
    head: dict[str, Any] = json.loads(data[len(MARK) + _DIGEST : end])
    if head["fields"] != dict(fields):
        return None
    forests, at = [], end
    for cells, roots, leaves in head["forests"]:
        table = cast("Table[Cell]", np.frombuffer(data, Cell.layout, cells, at).copy())
        at += cells * Cell.layout.itemsize
        rows = np.frombuffer(data, np.int64, roots + leaves, at).copy()
        at += rows.nbytes
        forests.append(Forest(table, rows[:roots], rows[roots:]))
    return Sendings(laid, tuple(forests), float.fromhex(head["fine"]))
