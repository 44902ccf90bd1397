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
    "fov_missing.xml": (":4:1: sensor perspective: needs fov",),
    "integrator_missing.xml": (":1:1: scene: needs one integrator, whose max_depth is the bounces + 2",),
    "part.xml": (
        ":1:1: scene: needs one integrator, whose max_depth is the bounces + 2",
        ":1:1: scene: needs one sensor",
    ),
    "point_value.xml": (),
    "rectangle.xml": (),
    "ref_bsdf.xml": (),
    "ref_bsdf_named.xml": (),
    "rgb_hex.xml": (":9:115: rgb: must be numbers, got #808080",),
    "sampler.xml": (),
    "spot_up_parallel.xml": (),
    "string_top.xml": (":2:1: boolean has no meaning here",),
    "version_2.xml": (),
    "xml_declaration.xml": (),
    "xml_text.xml": (":3:1: text between elements is not allowed, got stray words",),
}
XML_WAITING: dict[str, tuple[str, ...]] = {
    "aov.xml": (":3:1: integrator aov: must be path or direct",),
    "bitmap.xml": (":9:115: texture bitmap: no such texture here; known is checkerboard",),
    "camera_chain.xml": (":6:1: sensor perspective: to_world must be one lookat",),
    "camera_matrix.xml": (":6:1: sensor perspective: to_world must be one lookat",),
    "checkerboard.xml": (":9:46: texture checkerboard: needs color0",),
    "cube_matrix_y.xml": (":9:1: shape cube: to_world must scale, turn about z and move, in this order: no scene has",),
    "cube_rotate_y.xml": (":9:20: shape cube: to_world must be one matrix",),
    "default_parameter.xml": (":2:1: default has no meaning here",),
    "depth_1.xml": (":3:1: integrator path: max_depth must be 2 (direct light), 3 (one bounce) or -1 (all),",),
    "direct_samples.xml": (":3:27: integrator direct: emitter_samples has no meaning here",),
    "directional_to_world.xml": (":10:1: emitter directional: needs direction",),
    "emitter_default_constant.xml": (":10:1: emitter constant: needs radiance",),
    "emitter_default_point.xml": (":10:1: emitter point: needs intensity",),
    "envmap.xml": (":10:1: emitter envmap: no such emitter here",),
    "film_banner.xml": (":7:112: film hdrfilm: banner has no meaning here",),
    "film_crop.xml": (
        ":7:91: film hdrfilm: crop_width has no meaning here",
        ":7:129: film hdrfilm: crop_height has no meaning here",
        ":7:168: film hdrfilm: crop_offset_x has no meaning here",
        ":7:209: film hdrfilm: crop_offset_y has no meaning here",
    ),
    "film_missing.xml": (":4:1: sensor perspective: needs a film with an rfilter box; without one Mitsuba filters",),
    "float_reflectance.xml": (":9:115: bsdf diffuse: reflectance must be rgb or texture, got float",),
    "focus_distance.xml": (":8:1: sensor perspective: focus_distance has no meaning here",),
    "fov_axis_default.xml": (":4:1: sensor perspective: fov_axis must be y: fov is the vertical field of view",),
    "path.xml": (":2:1: path has no meaning here",),
    "plastic.xml": (":9:94: bsdf plastic: no such material here",),
    "principled.xml": (":9:94: bsdf principled: no such material here",),
    "rectangle_flip.xml": (":9:25: shape rectangle: flip_normals has no meaning here",),
    "ref_texture.xml": (
        ":2:1: texture checkerboard has no meaning here",
        ":9:115: bsdf diffuse: reflectance must be rgb or texture, got ref",
    ),
    "rfilter_default.xml": (":7:1: film hdrfilm: needs an rfilter box; without one Mitsuba filters by a Gaussian",),
    "rfilter_gaussian.xml": (":7:1: film hdrfilm: needs an rfilter box; without one Mitsuba filters by a Gaussian",),
    "roughconductor_Au.xml": (":9:94: bsdf roughconductor: needs eta",),
    "shape_no_bsdf.xml": (":9:1: shape sphere: needs one bsdf, or a ref to one, got 0",),
    "spectrum_constant.xml": (":9:115: bsdf diffuse: reflectance must be rgb or texture, got spectrum",),
    "sphere_defaults.xml": (":9:1: shape sphere: needs center",),
    "spot_lookat.xml": (":10:22: emitter spot: to_world must be a lookat from 0, 0, 0 and a translate",),
    "volpath.xml": (":3:1: integrator volpath: must be path or direct",),
}
"""Refused today, line by line; each has a meaning that a scene will be able to say."""
PBRT: dict[str, tuple[str, ...]] = {
    "area.pbrt": (),
    "area_reverse.pbrt": (":12:1: Shape: must not emit behind ReverseOrientation or a mirroring, which turn the side",),
    "base.pbrt": (),
    "bom.pbrt": (),
    "colorspace.pbrt": (),
    "conductor_default.pbrt": (":9:1: Material: must have eta: pbrt takes that of copper otherwise, a spectrum",),
    "crlf.pbrt": (),
    "cropwindow.pbrt": (),
    "landscape.pbrt": (),
    "lens.pbrt": (":3:39: Camera.lensradius: must be 0, got 0.1: a scene has a pinhole",),
    "lens_zero.pbrt": (),
    "light_default.pbrt": (),
    "material_default.pbrt": (),
    "maxcomponent.pbrt": (":4:66: Film.maxcomponentvalue: must be left out, got float",),
    "no_mirror.pbrt": (":2:1: Camera: must stand behind `Scale -1 1 1`: coordinates of pbrt are left-handed, and",),
    "option.pbrt": (":1:1: Option: must be disablepixeljitter, disabletexturefiltering, seed, got bool",),
    "param_no_bracket.pbrt": (),
    "portrait.pbrt": (),
    "remap_default.pbrt": (
        ":9:1: Material.remaproughness: must be false, got true: pbrt would take the roughness for",
    ),
    "reverse.pbrt": (),
    "rgb_light.pbrt": (":8:21: LightSource.I: must be three equal numbers, got 10 9 8: pbrt makes a spectrum of",),
    "sensor_iso.pbrt": (),
    "spot.pbrt": (),
    "trianglemesh_quad.pbrt": (),
    "trianglemesh_uv.pbrt": (),
    "v3_color.pbrt": (":9:18: Material.Kd: must be of a type such as float or rgb, got color",),
    "world_transform.pbrt": (),
}
PBRT_WAITING: dict[str, tuple[str, ...]] = {
    "attribute.pbrt": (":8:1: Attribute: must not be there: parameters stand with what they belong to",),
    "bilinearmesh.pbrt": (":10:1: Shape: must be sphere, disk or trianglemesh, got bilinearmesh, a shape not read",),
    "depth_5.pbrt": (":6:19: Integrator.maxdepth: must be 1 (direct light), 2 (one bounce) or 1000000 and more",),
    "depth_default.pbrt": (":6:1: Integrator.maxdepth: must be 1 (direct light), 2 (one bounce) or 1000000 and more",),
    "filter_gaussian.pbrt": (
        ":5:1: PixelFilter: must be box, got gaussian: values would be means over other pixels too",
    ),
    "imagemap.pbrt": (":9:1: Texture: must be of numbers, got imagemap: nothing beside the file itself is opened",),
    "integrator_default.pbrt": (':1:1: Integrator: must be "path" with maxdepth 1, 2 or all, got none',),
    "trianglemesh.pbrt": (":10:69: Shape.indices: must be one triangle (0 1 2), one parallelogram (0 1 2 0 2 3), or",),
    "trianglemesh_N.pbrt": (":10:95: Shape.N: must be left out, got normal",),
    "volpath.pbrt": (":6:1: Integrator: must be path, got volpath: others have other light, or other limits",),
}
"""Refused today, line by line; each has a meaning that a scene will be able to say."""


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
    for kind, tables in (("xml", (XML, XML_WAITING)), ("pbrt", (PBRT, PBRT_WAITING))):
        assert {path.name for path in (CASES / kind).glob(f"*.{kind}")} == {name for table in tables for name in table}


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
    tables = {"xml": XML | XML_WAITING, "pbrt": PBRT | PBRT_WAITING}[kind]
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
    assert loaded >= 13 and len(tables) - loaded >= 15
