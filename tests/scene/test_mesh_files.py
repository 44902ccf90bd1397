"""Meshes from files: what is read, where it lies, and what hostile files are told."""

from __future__ import annotations

import json
import struct
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import symrender as sr
from symrender.errors import SceneError
from symrender.limits import MAX_ITEMS, MAX_MESH_BYTES, MAX_TRIANGLES
from symrender.scene.dump import to_yaml
from symrender.scene.load import load_any, parse_any
from symrender.scene.radiometric.shapes import Mesh
from symrender.scene.warnings import warnings

VERTICES = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
FACES = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]
HEAD = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
LIST = "element face 4\nproperty list uchar int vertex_indices\nend_header\n"
ROWS = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n"
PLY = f"{HEAD}{LIST}{ROWS}3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n"
OBJ = "# a corner\nv 0 0 0\nv 1 0 0 1.0\nv 0 1 0\nv 0 0 1\nvn 0 0 1\n"
OBJ += "f 1/2/3 3 2\nf -4 -3 \\\n -1\nf 2 3 4\nf 1//1 4//1 3//1\n"


def scene(**shape: Any) -> dict[str, Any]:
    return {
        "units": "radiometric", "name": "m", "bounces": 0,
        "materials": {"white": {"type": "diffuse", "reflectance": 1}},
        "camera": {"type": "look_at", "eye": [0, -6, 3], "target": [0, 0, 0.5]},
        "shapes": [{"type": "mesh", "name": "M", "material": "white"} | shape], "lights": [],
    }  # fmt: skip


def loaded(folder: Path, name: str, text: str | bytes) -> Mesh:
    """The mesh of a scene in ``folder`` that names a file beside it."""
    (folder / name).write_bytes(text if isinstance(text, bytes) else text.encode())
    (folder / "scene.json").write_text(json.dumps(scene(file=name)))
    made = load_any(folder / "scene.json")
    (mesh,) = made.shapes  # type: ignore[union-attr]
    assert isinstance(mesh, Mesh)
    return mesh


def binary() -> bytes:
    rows = b"".join(struct.pack("<3f", *vertex) for vertex in VERTICES)
    rows += b"".join(struct.pack("<B3i", 3, *face) for face in FACES)
    return (HEAD + LIST).replace("ascii", "binary_little_endian").encode() + rows


@pytest.mark.parametrize(("name", "text"), [("a.obj", OBJ), ("a.ply", PLY), ("A.PLY", binary())])
def test_files_are_read_beside_the_scene(name: str, text: str | bytes, tmp_path: Path) -> None:
    mesh = loaded(tmp_path, name, text)
    assert [list(vertex) for vertex in mesh.vertices] == VERTICES
    assert [sorted(face) for face in mesh.faces] == [sorted(face) for face in FACES]
    assert mesh.file == "" and mesh.faces[0] == (0, 2, 1)


def test_a_scene_that_was_read_stands_alone(tmp_path: Path) -> None:
    loaded(tmp_path, "a.obj", OBJ)
    made = load_any(tmp_path / "scene.json")
    again = tmp_path / "elsewhere.yaml"
    again.write_text(to_yaml(made))
    (tmp_path / "a.obj").unlink()
    assert load_any(again) == made and load_any(again).hash == made.hash
    inline = load_any(scene(vertices=VERTICES, faces=[list(face) for face in made.shapes[0].faces]))  # type: ignore[union-attr]
    assert inline.hash == made.hash
    moved = made.replace({"shapes.M.vertices[1].x": 1.5, "shapes.M.scale": 2.0})
    assert moved.shapes[0].vertices[1] == (1.5, 0.0, 0.0)  # type: ignore[union-attr]
    names = [each.name for each in made.parameters()]
    assert "shapes.M.vertices[3].z" in names and not any("faces" in name for name in names)


def test_faces_of_more_corners_are_fans(tmp_path: Path) -> None:
    mesh = loaded(tmp_path, "a.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n")
    assert mesh.faces == ((0, 1, 2), (0, 2, 3))


HOSTILE = [
    ("a.obj", "v 0 0\nf 1 1 1\n", r"a.obj:1:1: a vertex must have 3 coordinates, got 2"),
    ("a.obj", "v 0 0 x\n", r"a.obj:1:7: must be a finite number, got 'x'"),
    ("a.obj", "v 0 0 nan\n", r"a.obj:1:7: must be a finite number, got 'nan'"),
    ("a.obj", "v 1_0 0 0\n", r"a.obj:1:3: must be a finite number, got '1_0'"),
    ("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n  f 1 2 4\n", r"a.obj:4:9: must name one of the 3 vertices, got '4'"),
    ("a.obj", "v 0 0 0\nf 1 0 1\n", r"a.obj:2:5: must name"),
    ("a.obj", "v 0 0 0\nv 1 0 0\nf 1 2\n", r"a.obj:3:1: a face must have at least 3 vertices, got 2"),
    ("a.obj", "v 0 0 0\nsurf 0 1 0 1 1 2\n", r"a.obj:2:1: surf: a free-form surface is not read"),
    ("a.obj", "", r"a.obj:1:1: must hold a face, got none"),
    ("a.obj", b"v 0 0 \xff\n", r"a.obj:1:7: must be a finite number"),
    ("a.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", r"a.obj:4:1: a mesh must have a face with an area"),
    ("a.obj", "v 0 0 0\n" * (MAX_TRIANGLES + 1), rf"a.obj:{MAX_TRIANGLES + 1}:1: a mesh may have at most"),
    ("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n" + "f 1 2 3\n" * (MAX_TRIANGLES + 1), r"at most \d+ triangles"),
    ("a.obj", "#" * (MAX_MESH_BYTES + 1), r"a.obj: a mesh's file may hold at most \d+ bytes"),
    ("a.ply", "", r"a.ply: must have a header"),
    ("a.ply", PLY.replace("1 0 0", "1 0 x"), r"a.ply: element 'vertex': row 1: property 'z'"),
    ("a.ply", PLY.replace("3 0 1 3", "3 0 1 9"), r"a.ply: element 'face': row 1: must name some of the 4 vertices"),
    ("a.ply", PLY.replace("3 0 1 3", "2 0 1"), r"a.ply: element 'face': row 1: a face must have at least 3"),
    ("a.ply", PLY.replace("vertex 4", "vertex 99999999"), r"a.ply:3:1: element 'vertex': must have at most"),
    ("a.ply", PLY.replace("vertex 4", "vertex -4"), r"a.ply:3:1: element 'vertex': must have a whole count"),
    ("a.ply", PLY.replace("vertex 4", "vertix 4"), r"a.ply: must have an element 'vertex', has vertix, face"),
    ("a.ply", PLY.replace("0 0 1\n3", "0 0 inf\n3"), r"row 3: must be finite numbers"),
    ("a.ply", PLY.replace("property float z", "property list uchar float z"), r"a.ply: "),
    ("a.ply", PLY.replace("property list uchar int vertex_indices", "property int vertex_indices"), r"a.ply: "),
    ("a.ply", PLY.replace("vertex_indices", "others"), r"must have a property 'vertex_indices'"),
    ("a.ply", PLY.replace("ascii", "binary_big_endian"), r"a.ply: "),
    ("a.ply", b"\xff\xfe\x00end_header", r"a.ply: "),
    ("a.stl", "solid", r"a.stl: must be a file ending in .obj, .ply or .serialized"),
]


@pytest.mark.parametrize(("name", "text", "told"), HOSTILE, ids=[str(k) for k in range(len(HOSTILE))])
def test_hostile_files_are_told_what_is_wrong_and_where(
    name: str, text: str | bytes, told: str, tmp_path: Path
) -> None:
    with pytest.raises(SceneError, match=told) as caught:
        loaded(tmp_path, name, text)
    assert "scene.json:1:" in str(caught.value) and len(str(caught.value)) < 400


def test_files_that_are_none_are_told_so(tmp_path: Path) -> None:
    (tmp_path / "scene.json").write_text(json.dumps(scene(file="gone.ply")))
    with pytest.raises(SceneError, match=r"scene.json:1:\d+: shapes\[0\].file: .*gone.ply: cannot be read"):
        load_any(tmp_path / "scene.json")
    (tmp_path / "gone.ply").mkdir()
    with pytest.raises(SceneError, match="must be a regular file, got a directory"):
        load_any(tmp_path / "scene.json")
    with pytest.raises(SceneError, match="a mesh has a file, or vertices and faces, got both"):
        load_any(scene(file="a.obj", vertices=VERTICES, faces=FACES))
    with pytest.raises(SceneError, match=r"shapes\[0\].file: must be text, got 3"):
        load_any(scene(file=3))
    with pytest.raises(SceneError, match=r"shapes\[0\].faces: must hold at least one face"):
        load_any(scene())
    with pytest.raises(SceneError, match=r"faces\[0\]\[2\]: must be a whole number from 0, got 1.5"):
        load_any(scene(vertices=VERTICES, faces=[[0, 1, 1.5]]))
    with pytest.raises(SceneError, match=r"faces\[1\]: lies in faces\[0\], and which of them is seen"):
        load_any(scene(vertices=VERTICES, faces=[[0, 1, 2], [2, 1, 0]]))
    with pytest.raises(SceneError, match=r"faces\[1\]: there are 4 vertices, from 0, got 4"):
        load_any(scene(vertices=VERTICES, faces=[[0, 1, 2], [0, 1, 4]]))


def test_without_plyfile_the_line_that_installs_it_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "plyfile", None)
    with pytest.raises(SceneError, match=r"plyfile, which is not installed; pip install"):
        loaded(tmp_path, "a.ply", PLY)
    assert loaded(tmp_path, "a.obj", OBJ).faces


def test_all_triangles_of_a_scene_are_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("symrender.scene.radiometric.scene.MAX_TRIANGLES", 500)
    half = 251
    arc = [[k * 1e-3, (k * 1e-3) ** 2, 0.0] for k in range(half + 1)]
    fan = [[0, k, k + 1] for k in range(1, half)]
    one = {"type": "mesh", "material": "white", "vertices": [*arc, [0.0, 0.0, 1.0]], "faces": [*fan, [0, 1, half + 1]]}
    with pytest.raises(SceneError, match=r"shapes\[1\].faces: meshes may have at most 500 triangles together"):
        sr.load(scene() | {"shapes": [one | {"name": "A"}, one | {"name": "B"}]})


def test_what_of_a_file_is_not_used_is_told_and_is_no_part_of_the_scene(tmp_path: Path) -> None:
    smooth = OBJ.replace("f 1/2/3 3 2", "f 1/2/1 3/2/1 2/2/1")
    plain = loaded(tmp_path, "a.obj", OBJ.replace("1//1 4//1 3//1", "1 4 3").replace("f 1/2/3", "f 1"))
    made = load_any(tmp_path / "scene.json")
    assert loaded(tmp_path, "a.obj", smooth).notes.startswith("a.obj: its shading normals are not used")
    noted = load_any(tmp_path / "scene.json")
    assert plain.notes == "" and noted != made and noted.hash == made.hash
    assert load_any(plain_text(tmp_path, to_yaml(noted))) == noted
    assert [line for line in warnings(noted) if "shading normals" in line] and not any(
        map("normals".count, warnings(made))
    )
    kept = noted.replace({"shapes.M.scale": 2.0})
    image = sr.truth(kept, size=2, tol=1e-3)
    assert json.loads(image.meta["conventions"])["meshes"] == {"M": noted.shapes[0].notes}  # type: ignore[union-attr]
    normals = PLY.replace("float z\n", "float z\nproperty float nx\nproperty float ny\nproperty float nz\n")
    for row in ROWS.splitlines():
        normals = normals.replace(f"\n{row}\n", f"\n{row} 0 0 1\n", 1)
    assert "shading normals" in loaded(tmp_path, "a.ply", normals).notes


def plain_text(folder: Path, text: str) -> Path:
    (folder / "again.yaml").write_text(text)
    return folder / "again.yaml"


def test_a_mesh_of_many_triangles_is_read_changed_and_sent(tmp_path: Path) -> None:
    side = 95
    rows = [f"v {x} {y} {0.1 * (x * y % 7)}" for x in range(side) for y in range(side)]
    rows += [
        f"f {(at := x * side + y + 1)} {at + side} {at + side + 1} {at + 1}"
        for x in range(side - 1) for y in range(side - 1)
    ]  # fmt: skip
    mesh = loaded(tmp_path, "a.obj", "\n".join(rows))
    assert len(mesh.faces) == 2 * (side - 1) ** 2 > 17_500
    scene = load_any(tmp_path / "scene.json")
    (cost,) = [line for line in warnings(scene) if "triangles" in line]
    assert "17672 triangles" in cost and "s a pixel" in cost
    moved = scene.replace({"shapes.M.scale": 2.0})
    text = to_yaml(moved)
    assert parse_any(text, "scene", most=MAX_ITEMS) == moved
    with pytest.raises(SceneError, match="may hold at most 100000 keys"):
        parse_any(text, "scene")


HEADERS = [
    (HEAD.replace("ascii", "text"), r"a.ply:2:1: must be format, comment, .*got 'format text 1.0'"),
    (HEAD.replace("float z", "number z"), r"a.ply:6:1: must be .*got 'property number z'"),
    (HEAD.replace("ply", "pyl", 1), r"a.ply:1:1: must begin with the line ply, got 'pyl'"),
    (HEAD + "wrong\n", r"a.ply:7:1: must be .*got 'wrong'"),
    (
        "\ufeff" + HEAD.replace("format", "comment Küche\nformat") + "elemént face 1\n",
        r"a.ply:8:1: must be .*got 'elem",
    ),
]


@pytest.mark.parametrize(("head", "told"), HEADERS, ids=["format", "type", "magic", "keyword", "utf-8"])
@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_a_fault_of_a_ply_header_is_told_by_its_line(head: str, told: str, end: str, tmp_path: Path) -> None:
    with pytest.raises(SceneError, match=told) as caught:
        loaded(tmp_path, "a.ply", (head + LIST + ROWS).replace("\n", end))
    assert "codec" not in str(caught.value)


def test_a_ply_of_any_line_ends_and_words_is_read(tmp_path: Path) -> None:
    for end in ("\n", "\r\n", "\r"):
        # behind lone carriage returns a line feed is the first byte of the rows
        for last in ("\r",) if end == "\r" else ("\n", "\r\n"):
            head = (HEAD.replace("format", "comment é\nobj_info ü\nformat") + LIST).replace(
                "ascii", "binary_little_endian"
            )
            head = head.removesuffix("end_header\n").replace("\n", end) + "end_header" + last
            body = binary()[len((HEAD + LIST).replace("ascii", "binary_little_endian")) :]
            assert len(loaded(tmp_path, "a.ply", head.encode() + body).faces) == 4
    head = (HEAD + LIST).replace("ascii", "binary_little_endian").replace("\n", "\r").encode()
    # the first number of the rows begins with a line feed
    body = binary()[len(head) :]
    mesh = loaded(tmp_path, "a.ply", head + struct.pack("<I", 0x3F80000A) + body[4:])
    assert mesh.vertices[0][0] == np.frombuffer(struct.pack("<I", 0x3F80000A), "<f4")[0]


def test_the_gallery_has_the_meshes_its_program_writes() -> None:
    root = Path(__file__).resolve().parents[2]
    done = subprocess.run(
        [sys.executable, str(root / "docs" / "make_meshes.py"), "--check"], capture_output=True, text=True
    )
    assert done.returncode == 0 and done.stdout.strip() == "", done.stdout + done.stderr
    made = load_any("mesh")
    faces = {shape.name: len(shape.faces) for shape in made.shapes if isinstance(shape, Mesh)}
    assert faces == {"vase": 360, "ball": 320, "pebble": 320}
