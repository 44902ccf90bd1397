"""Mitsuba's serialized meshes: several of them in one file, each deflated, versions 3 and 4."""

from __future__ import annotations

import struct
import zlib
from typing import Final

import numpy as np
import numpy.typing as npt

from symrender.limits import MAX_MESH_BYTES, MAX_TRIANGLES
from symrender.scene.meshes.net import BadMesh, Net

_MAGIC: Final = 0x041C
_V3: Final = 3
_V4: Final = 4
_NORMALS: Final = 0x0001
_COORDINATES: Final = 0x0002
_COLOURS: Final = 0x0008
_DOUBLE: Final = 0x2000
_LONGEST_NAME: Final = 1024
_STEP: Final = 1 << 16


def read_serialized(data: bytes, part: int) -> Net:
    """The mesh at place ``part`` of a file; BadMesh says what is wrong with it."""
    begin, end, version = _place(data, part)
    body = _Inflated(data[begin + 4 : end])
    (flags,) = struct.unpack("<I", body.take(4))
    if version == _V4:
        for _ in range(_LONGEST_NAME):
            if body.take(1) == b"\0":
                break
        else:
            raise BadMesh(f"mesh {part}: its name is longer than {_LONGEST_NAME} bytes")
    vertices, triangles = struct.unpack("<QQ", body.take(16))
    if vertices > MAX_TRIANGLES or triangles > MAX_TRIANGLES:
        raise BadMesh(
            f"mesh {part}: a mesh may have at most {MAX_TRIANGLES} vertices and triangles, "
            f"got {vertices} and {triangles}"
        )
    kind = np.dtype("<f8" if flags & _DOUBLE else "<f4")

    def columns(count: int) -> npt.NDArray[np.float64]:
        return np.frombuffer(body.take(vertices * count * kind.itemsize), kind).astype(np.float64).reshape(-1, count)

    places = columns(3)
    normals = columns(3) if flags & _NORMALS else None
    coordinates = columns(2) if flags & _COORDINATES else None
    if flags & _COLOURS:
        columns(3)
    faces = np.frombuffer(body.take(triangles * 12), "<u4").reshape(-1, 3)
    if not np.isfinite(places).all():
        row = int(np.flatnonzero(~np.isfinite(places).all(axis=1))[0])
        raise BadMesh(f"mesh {part}: vertex {row}: must be finite numbers, got {places[row].tolist()}")
    if len(faces) == 0:
        raise BadMesh(f"mesh {part}: must have a triangle, got none")
    if int(faces.max()) >= len(places):
        row = int(np.flatnonzero((faces >= len(places)).any(axis=1))[0])
        raise BadMesh(
            f"mesh {part}: triangle {row}: must name some of the {len(places)} vertices, from 0, got {faces.max()}"
        )
    net = Net()
    net.vertices = places.tolist()
    net.polygons = [(corners, f"mesh {part}: triangle {row}") for row, corners in enumerate(faces.tolist())]
    for name, rows in (("normals", normals), ("uv", coordinates)):
        if rows is not None:
            setattr(net, name, rows.tolist())
    return net


def _place(data: bytes, part: int) -> tuple[int, int, int]:
    """(begin, end, version) of a mesh in a file."""
    if len(data) < 8:
        raise BadMesh("must be a serialized mesh, got fewer than 8 bytes")
    magic, version = struct.unpack_from("<HH", data)
    if magic != _MAGIC or version not in (_V3, _V4):
        raise BadMesh(f"must be a serialized mesh of version 3 or 4, got {data[:4].hex(' ')} in front")
    (count,) = struct.unpack_from("<I", data, len(data) - 4)
    width = 8 if version == _V4 else 4
    table = len(data) - 4 - width * count
    if not count > 0 or table < 4:
        raise BadMesh(f"must end in a table of its meshes, got a count of {count}")
    if not 0 <= part < count:
        raise BadMesh(f"has {count} meshes, from 0, and none at {part}")
    offsets = struct.unpack_from(f"<{count}{'Q' if version == _V4 else 'I'}", data, table)
    begin = offsets[part]
    end = min([offset for offset in offsets if offset > begin], default=table)
    if begin + 4 > end or end > table:
        raise BadMesh(f"mesh {part}: must lie in the file, got byte {begin} to {end} of {table}")
    magic, own = struct.unpack_from("<HH", data, begin)
    if magic != _MAGIC or own not in (_V3, _V4):
        raise BadMesh(f"mesh {part}: must be of version 3 or 4, got {data[begin : begin + 4].hex(' ')} in front")
    return begin, end, own


class _Inflated:
    """Bytes of a deflated text, read in order, never more than a mesh may have."""

    def __init__(self, data: bytes) -> None:
        self._inflater = zlib.decompressobj()
        self._data = data
        self._left = b""
        self._total = 0

    def take(self, count: int) -> bytes:
        """The next ``count`` bytes."""
        parts = [self._left]
        have = len(self._left)
        while have < count:
            try:
                piece = self._inflater.decompress(self._data, _STEP)
            except zlib.error as error:
                raise BadMesh(f"its deflated part is damaged: {error}") from None
            self._data = self._inflater.unconsumed_tail
            self._total += len(piece)
            if not piece or self._total > 4 * MAX_MESH_BYTES:
                raise BadMesh(f"ends too soon: {count - have} bytes more are due")
            parts.append(piece)
            have += len(piece)
        whole = b"".join(parts)
        self._left = whole[count:]
        return whole[:count]
