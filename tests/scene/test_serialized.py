"""Mitsuba's serialized meshes: what is packed comes back; damaged files are told in a line, in bounded memory."""

from __future__ import annotations

import random
import struct
import zlib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import symrender as sr
from symrender.errors import SceneError

PLACES = [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.0, 2.0, 0.0), (0.0, 2.0, 0.5)]
FACES = [(0, 1, 2), (0, 2, 3), (1, 1, 2)]


def packed(version: int = 4, *, double: bool = False, extras: bool = True, meshes: int = 2) -> bytes:
    """A file of ``meshes`` meshes, the last of which is the one above."""
    whole, offsets = b"", []
    for number in range(meshes):
        kind = "<d" if double else "<f"
        flags = (0x2000 if double else 0x1000) | (0x0003 if extras else 0)
        body = struct.pack("<I", flags) + (b"name\0" if version == 4 else b"")
        scale = 1.0 if number == meshes - 1 else 9.0
        places = [scale * x for place in PLACES for x in place]
        body += struct.pack("<QQ", len(PLACES), len(FACES)) + b"".join(struct.pack(kind, x) for x in places)
        if extras:
            body += b"".join(struct.pack(kind, x) for _ in PLACES for x in (0.0, 0.0, 1.0))
            body += b"".join(struct.pack(kind, x) for x, y, _ in PLACES for x in (x, y))
        body += b"".join(struct.pack("<III", *face) for face in FACES)
        offsets.append(len(whole))
        whole += struct.pack("<HH", 0x041C, version) + zlib.compress(body)
    return whole + struct.pack(f"<{meshes}{'Q' if version == 4 else 'I'}I", *offsets, meshes)


def scene_of(name: str, **how: Any) -> dict[str, Any]:
    return {
        "units": "radiometric", "name": "m", "bounces": 0, "materials": {"w": {"type": "diffuse"}}, "lights": [],
        "camera": {"type": "look_at", "eye": [0, -6, 3], "target": [0, 0, 0.5]},
        "shapes": [{"type": "mesh", "name": "M", "material": "w", "file": name, **how}],
    }  # fmt: skip


@pytest.mark.parametrize("version", [3, 4])
@pytest.mark.parametrize("double", [False, True])
def test_a_mesh_comes_back(version: int, double: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("m.serialized").write_bytes(packed(version, double=double))
    mesh: Any = sr.load(scene_of("m.serialized", part=1)).shapes[0]
    assert mesh.vertices == tuple(PLACES) and mesh.faces == ((0, 1, 2), (0, 2, 3))
    assert "of 3 faces 1 without an area are left out" in mesh.notes
    other: Any = sr.load(scene_of("m.serialized")).shapes[0]
    assert other.vertices[2] == (9.0, 18.0, 0.0)


def test_a_matrix_places_a_mesh(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("m.serialized").write_bytes(packed(extras=False, meshes=1))
    matrix = [0, -2, 0, 5, 2, 0, 0, 6, 0, 0, 2, 7, 0, 0, 0, 1]
    mesh: Any = sr.load(scene_of("m.serialized", to_world=matrix, flip_faces=True)).shapes[0]
    due = np.array(PLACES) @ np.array(matrix).reshape(4, 4)[:3, :3].T + [5, 6, 7]
    np.testing.assert_array_equal(mesh.vertices, due)
    assert mesh.faces == ((2, 1, 0), (3, 2, 0))


@pytest.mark.parametrize(
    ("how", "told"),
    [
        ({"part": 7}, "has 2 meshes, from 0, and none at 7"),
        ({"part": -1}, "part: must be a whole number"),
        ({"to_world": [1, 2]}, "to_world: must be 16 finite numbers"),
        ({"to_world": [float("nan")] * 12 + [0, 0, 0, 1]}, "to_world: must be 16 finite numbers"),
        ({"vertex_normals": "some"}, "vertex_normals: must be none, file, smooth"),
        ({"flip_faces": 1}, "flip_faces: must be true or false"),
    ],
)
def test_what_is_said_of_a_file_is_checked(
    how: dict[str, Any], told: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("m.serialized").write_bytes(packed())
    with pytest.raises(SceneError, match=told):
        sr.load(scene_of("m.serialized", **how))


def test_a_bomb_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    head = struct.pack("<HH", 0x041C, 4)
    for counts in ((1 << 40, 3), (3, 1 << 40), (100_000, 100_000)):
        body = struct.pack("<I", 0x1000) + b"\0" + struct.pack("<QQ", *counts)
        data = head + zlib.compress(body + b"\0" * 1000)
        Path("m.serialized").write_bytes(data + struct.pack("<QI", 0, 1))
        with pytest.raises(SceneError, match=r"at most|ends too soon"):
            sr.load(scene_of("m.serialized"))
    zeros = head + zlib.compress(struct.pack("<I", 0x1000) + b"x" * (1 << 24))
    Path("m.serialized").write_bytes(zeros + struct.pack("<QI", 0, 1))
    with pytest.raises(SceneError, match="its name is longer"):
        sr.load(scene_of("m.serialized"))


def test_damaged_files_are_told_in_a_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    r = random.Random(3)
    counts = [0, 0]
    for _ in range(1500):
        data = bytearray(packed(r.choice([3, 4]), double=r.random() < 0.5))
        for _ in range(r.randint(1, 3)):
            at = r.randrange(len(data))
            data[at : at + r.choice([0, 1, 1, 40])] = bytes([r.randrange(256)]) * r.choice([0, 1, 1, 3])
        Path("m.serialized").write_bytes(bytes(data))
        try:
            sr.load(scene_of("m.serialized", part=r.randrange(2)))
            counts[0] += 1
        except SceneError as error:
            assert "m.serialized" in str(error) or "shapes[0]" in str(error)
            assert len(str(error).splitlines()) < 25
            counts[1] += 1
    assert min(counts) >= 20, counts
