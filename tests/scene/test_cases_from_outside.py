"""Small files as other programs write them: each has the outcome that its table says.

The files are in ``tests/data/cases``. What a table says of a mesh is its area, of a scene that it loads (an empty
text), of all that is refused the problems, in the order of their lines. Files that wait for a feature are named.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import symrender as sr
from symrender.errors import SceneError
from symrender.scene.load import load_any
from symrender.scene.radiometric.shapes import Mesh
from symrender.scene.warnings import warnings

CASES = Path(__file__).resolve().parents[1] / "data" / "cases"
NORMALS = "its shading normals are not used"

MESHES: dict[str, tuple[float, str]] = {
    "obj name with space ü.obj": (1.0, ""),
    "obj_bad_vn.obj": (0.5, NORMALS),
    "obj_bom.obj": (1.0, ""),
    "obj_bom_comment.obj": (1.0, ""),
    "obj_colours.obj": (0.5, ""),
    "obj_concave_dart.obj": (1.5, ""),
    "obj_concave_dart_rot.obj": (1.5, ""),
    "obj_concave_turned.obj": (1.5, ""),
    "obj_continuation.obj": (1.0, ""),
    "obj_cr.obj": (1.0, ""),
    "obj_crlf.obj": (1.0, ""),
    "obj_concave_L.obj": (3.0, ""),
    "obj_degenerate_in_ngon.obj": (1.0, ""),
    "obj_degenerate_line.obj": (1.0, "of 2 faces 1 without an area are left out"),
    "obj_degenerate_repeat.obj": (1.0, "of 2 faces 1 without an area are left out"),
    "obj_duplicate_face.obj": (1.0, "of 2 faces 1 that lie in others are left out"),
    "obj_fo.obj": (1.0, ""),
    "obj_forward.obj": (1.0, ""),
    "obj_forward_split.obj": (0.5, ""),
    "obj_hash_name.obj": (1.0, ""),
    "obj_latin1_comment.obj": (1.0, ""),
    "obj_latin1_name.obj": (1.0, ""),
    "obj_leading.obj": (0.5, ""),
    "obj_negative.obj": (1.5, ""),
    "obj_nonplanar_quad.obj": (math.sqrt(2.0), ""),
    "obj_numbers.obj": (1.0, ""),
    "obj_pentagon.obj": (2.377743, ""),
    "obj_quad.obj": (1.0, ""),
    "obj_slash_empty.obj": (1.0, ""),
    "obj_slashes.obj": (1.0, NORMALS),
    "obj_smooth_ball.obj": (12.0453102833, NORMALS),
    "obj_tabs.obj": (1.0, ""),
    "obj_unknown_cinterp.obj": (1.0, ""),
    "obj_unknown_crease.obj": (1.0, "unknown statements are passed over: t"),
    "obj_unknown_usemap.obj": (1.0, ""),
    "obj_unknown_vw.obj": (1.0, "unknown statements are passed over: vw"),
    "obj_upper.OBJ": (1.0, ""),
    "obj_utf8_name.obj": (1.0, ""),
    "obj_vn.obj": (1.0, NORMALS),
    "obj_w.obj": (0.5, ""),
    **{
        f"ply_{name}.ply": (1.0, "")
        for name in (
            "ascii", "big", "big_crlf", "big_double", "big_trailing", "big_ushort", "bom", "colour_face",
            "comment_plain", "comment_utf8", "comments", "cr", "crlf", "extra_elements", "face_first", "float_index",
            "format_space", "little", "little_crlf", "little_double", "little_mixed", "little_trailing",
            "little_ushort", "texcoord_first", "types", "vertex_index",
        )
    },
    "ply_concave.ply": (1.5, ""),
    "ply_degenerate.ply": (1.0, "of 2 faces 1 without an area are left out"),
    "ply_mixed.ply": (1.5, ""),
}  # fmt: skip
REFUSED_MESHES = {
    "obj_bad_unreferenced.obj": "obj_bad_unreferenced.obj:5:3: must be a finite number, got 'nan'",
    "obj_bowtie.obj": "obj_bowtie.obj:5:1: a face must not cross itself",
    "obj_comma.obj": "obj_comma.obj:1:3: must be a finite number, got '0,0'",
    "obj_huge_index.obj": "obj_huge_index.obj:5:7: must name one of the 4 vertices, got '3000000000'",
    "obj_zero_index.obj": "obj_zero_index.obj:5:3: must name one of the 4 vertices, got '0'",
    "ply_empty_face.ply": "element 'face': row 0: a face must have at least 3 vertices, got 0",
    "ply_negative.ply": "element 'face': row 0: must name some of the 4 vertices, from 0, got -1",
    "ply_tristrips.ply": "must have an element 'face', has vertex, tristrips",
}

XML: dict[str, tuple[str, ...]] = {
    "base.xml": (),
    "bom.xml": (),
    "bsdf_default.xml": (),
    "bsdf_named.xml": (),
    "comment_first.xml": (),
    "fov_missing.xml": (":4:1: sensor perspective: needs fov, whose axis fov_axis names",),
    "integrator_missing.xml": (),
    "part.xml": (":1:1: scene: needs one sensor",),
    "point_value.xml": (),
    "rectangle.xml": (),
    "ref_bsdf.xml": (),
    "ref_bsdf_named.xml": (),
    "rgb_hex.xml": (":9:115: rgb: must be numbers, got #808080",),
    "sampler.xml": (),
    "spot_up_parallel.xml": (":10:49: lookat: up must not lie along the view",),
    "string_top.xml": (":2:1: boolean has no meaning here",),
    "version_2.xml": (),
    "xml_declaration.xml": (),
    "xml_text.xml": (":3:1: text between elements is not allowed, got stray words",),
}
XML |= dict.fromkeys(
    (
        "aov.xml", "camera_chain.xml", "camera_matrix.xml", "cube_matrix_y.xml", "cube_rotate_y.xml",
        "default_parameter.xml", "depth_1.xml", "direct_samples.xml", "directional_to_world.xml",
        "emitter_default_constant.xml", "emitter_default_point.xml", "film_banner.xml", "film_crop.xml",
        "film_missing.xml", "float_reflectance.xml", "focus_distance.xml", "fov_axis_default.xml", "path.xml",
        "rectangle_flip.xml", "rfilter_default.xml", "rfilter_gaussian.xml", "shape_no_bsdf.xml",
        "spectrum_constant.xml", "sphere_defaults.xml", "spot_lookat.xml", "volpath.xml",
    ),
    (),
)  # fmt: skip
XML |= {
    "bitmap.xml": (":9:115: texture bitmap: ",),
    "envmap.xml": (":10:1: emitter envmap: ",),
}
XML |= dict.fromkeys(("checkerboard.xml", "plastic.xml", "ref_texture.xml", "roughconductor_Au.xml"), ())
XML |= {"principled.xml": (":9:94: bsdf principled: no such material here",)}
PBRT: dict[str, tuple[str, ...]] = {
    "area.pbrt": (),
    "area_reverse.pbrt": (":12:1: Shape: must not emit behind ReverseOrientation or a mirroring, which turn the side",),
    "base.pbrt": (),
    "bom.pbrt": (),
    "colorspace.pbrt": (),
    "crlf.pbrt": (),
    "cropwindow.pbrt": (),
    "landscape.pbrt": (),
    "lens.pbrt": (),
    "lens_zero.pbrt": (),
    "light_default.pbrt": (),
    "material_default.pbrt": (),
    "maxcomponent.pbrt": (),
    "no_mirror.pbrt": (),
    "option.pbrt": (":1:1: Option: must be disablepixeljitter, disabletexturefiltering,",),
    "param_no_bracket.pbrt": (),
    "portrait.pbrt": (),
    "remap_default.pbrt": (),
    "reverse.pbrt": (),
    "rgb_light.pbrt": (),
    "sensor_iso.pbrt": (),
    "spot.pbrt": (),
    "trianglemesh_quad.pbrt": (),
    "trianglemesh_uv.pbrt": (),
    "v3_color.pbrt": (":9:1: must be a file of pbrt-v4, got one of an earlier version by its Material",),
    "world_transform.pbrt": (),
}
PBRT |= dict.fromkeys(
    (
        "attribute.pbrt", "bilinearmesh.pbrt", "depth_5.pbrt", "depth_default.pbrt", "filter_gaussian.pbrt",
        "integrator_default.pbrt", "trianglemesh.pbrt", "trianglemesh_N.pbrt", "volpath.pbrt",
    ),
    (),
)  # fmt: skip
PBRT |= {"imagemap.pbrt": (":9:35: Texture.filename: ",)}
PBRT |= {"conductor_default.pbrt": ()}


def scene_of(name: str) -> dict[str, Any]:
    return {
        "units": "radiometric", "name": "m", "bounces": 0, "materials": {"w": {"type": "diffuse"}}, "lights": [],
        "camera": {"type": "look_at", "eye": [0, -6, 3], "target": [0, 0, 0.5]},
        "shapes": [{"type": "mesh", "name": "M", "material": "w", "file": name}],
    }  # fmt: skip


def area_of(mesh: Mesh) -> float:
    corners = np.array(mesh.vertices)[np.array(mesh.faces)]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return 0.5 * float(np.linalg.norm(across, axis=1).sum())


def test_every_file_is_in_one_table() -> None:
    found = {path.name for path in (CASES / "mesh").iterdir() if path.suffix != ".yaml"}
    assert found == MESHES.keys() | REFUSED_MESHES.keys() and len(found) > 60
    for kind, table in (("xml", XML), ("pbrt", PBRT)):
        assert {path.name for path in (CASES / kind).glob(f"*.{kind}")} == table.keys()


@pytest.mark.parametrize("name", MESHES)
def test_a_mesh_has_its_area(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(CASES / "mesh")
    scene = load_any(scene_of(name))
    mesh, (area, note) = scene.shapes[0], MESHES[name]  # type: ignore[union-attr]
    assert isinstance(mesh, Mesh) and abs(area_of(mesh) - area) < 1e-6 * area
    told = [line for line in warnings(scene) if line.startswith("shapes.M: ")]
    assert len(told) == (note != "") and all(name in line and note in line for line in told)


@pytest.mark.parametrize("name", REFUSED_MESHES)
def test_a_mesh_is_refused_by_name_and_place(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(CASES / "mesh")
    with pytest.raises(SceneError) as caught:
        load_any(scene_of(name))
    assert REFUSED_MESHES[name] in str(caught.value) and name in str(caught.value)


def test_a_ray_looks_through_the_notch_of_a_turned_dart() -> None:
    image = sr.truth(load_any(CASES / "mesh" / "obj_concave_turned.yaml"), size=1, tol=1e-6)
    assert not image.radiance.any() and not image.layer("error").any() and not image.layer("status").any()


@pytest.mark.parametrize("kind", ["xml", "pbrt"])
def test_a_scene_loads_or_every_problem_of_it_is_told(kind: str) -> None:
    tables = {"xml": XML, "pbrt": PBRT}[kind]
    loaded = 0
    for name, told in tables.items():
        path = CASES / kind / name
        try:
            load_any(path)
        except SceneError as error:
            lines = [line.removeprefix(str(path)) for line in str(error).splitlines()]
            assert len(lines) == len(told) and all(map(str.startswith, lines, told)), (name, lines)
        else:
            assert not told, name
            loaded += 1
    assert loaded >= 30 and len(tables) - loaded >= 4
