"""Files of other renderers as they are: their spellings, the files beside them, and how they are converted."""

from __future__ import annotations

import math
import random
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import symrender as sr
from busy import in_processor_time
from symrender.cli import main
from symrender.errors import SceneError
from symrender.scene.warnings import warnings

XML = """<scene version="3.0.0">
{head}
<integrator type="path"><integer name="max_depth" value="3"/></integrator>
<sensor type="perspective"><float name="fov" value="40"/>{camera}
<film type="hdrfilm"><integer name="width" value="32"/><integer name="height" value="16"/>{film}</film></sensor>
{body}
<emitter type="point"><point name="position" x="1" y="2" z="4"/></emitter>
</scene>
"""
LOOK = '<transform name="to_world"><lookat origin="0, 0, 4" target="0, 0, 0" up="0, 1, 0"/></transform>'
BALL = '<shape type="sphere"/>'


def mitsuba(folder: Path, head: str = "", camera: str = LOOK, film: str = "", body: str = BALL) -> Any:
    path = folder / "case.xml"
    path.write_text(XML.format(head=head, camera=camera, film=film, body=body))
    return sr.load(path)


def test_parameters_files_and_references_are_put_in(tmp_path: Path) -> None:
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "materials.xml").write_text(
        '<scene version="3.0.0"><bsdf type="diffuse" id="grey"><ref id="half" name="reflectance"/></bsdf>'
        '<spectrum type="uniform" id="half"><float name="value" value="$share"/></spectrum></scene>'
    )
    head = '<default name="share" value="0.25"/><path value="parts"/><include filename="materials.xml"/>'
    head += '<alias id="grey" as="gris"/>'
    scene = mitsuba(tmp_path, head, body='<shape type="sphere"><ref id="gris"/></shape>')
    assert scene.materials[scene.shapes[0].material].reflectance.color == (0.25, 0.25, 0.25)
    assert (scene.shapes[0].center, scene.shapes[0].radius, scene.bounces) == ((0.0, 0.0, 0.0), 1.0, 1)
    (tmp_path / "parts" / "materials.xml").write_text('<scene version="3.0.0">\n<bsdf type="hair" id="grey"/></scene>')
    with pytest.raises(SceneError, match=r"parts/materials\.xml:2:1: bsdf hair: no such material here"):
        mitsuba(tmp_path, head, body='<shape type="sphere"><ref id="gris"/></shape>')


def test_only_a_sampler_may_leave_its_parameters_open(tmp_path: Path) -> None:
    draws = '<sampler type="independent"><integer name="sample_count" value="$spp"/></sampler>'
    assert mitsuba(tmp_path, camera=LOOK + draws).hash == mitsuba(tmp_path).hash
    with pytest.raises(SceneError, match=r"no default says what \$far is"):
        mitsuba(tmp_path, body='<shape type="sphere"><float name="radius" value="$far"/></shape>')


def test_old_spelling_is_new_spelling(tmp_path: Path) -> None:
    new = mitsuba(tmp_path, body='<shape type="cube"><transform name="to_world"><scale value="2"/></transform></shape>')
    text = (tmp_path / "case.xml").read_text()
    for a, b in (("max_depth", "maxDepth"), ("to_world", "toWorld"), ("lookat", "lookAt"), ("3.0.0", "0.5.0")):
        assert a in text
        text = text.replace(a, b)
    (tmp_path / "old.xml").write_text(text)
    assert sr.load(tmp_path / "old.xml").hash == new.hash


@pytest.mark.parametrize(
    ("axis", "degrees"),
    [("x", 20.62), ("y", 40.0), ("smaller", 40.0), ("larger", 20.62), ("diagonal", None)],
)
def test_the_field_of_view_is_that_of_its_axis(axis: str, degrees: float | None, tmp_path: Path) -> None:
    scene = mitsuba(tmp_path, camera=f'<string name="fov_axis" value="{axis}"/>{LOOK}')
    if degrees is None:
        degrees = math.degrees(2 * math.atan(math.tan(math.radians(20)) / math.hypot(1, 2)))
    assert abs(scene.camera.fov - degrees) < 0.01


def test_transforms_follow_each_other(tmp_path: Path) -> None:
    chain = '<rotate z="1" angle="90"/><translate x="1"/><scale value="2"/><translate y="3"/>'
    body = f'<shape type="sphere"><transform name="to_world">{chain}</transform></shape>'
    body += f'<shape type="rectangle"><transform name="to_world">{chain}</transform></shape>'
    scene = mitsuba(tmp_path, body=body)
    assert (scene.shapes[0].center, scene.shapes[0].radius) == ((2.0, 3.0, 0.0), 2.0)
    corner, u, v = (np.array(getattr(scene.shapes[1], name)) for name in ("corner", "edge_u", "edge_v"))
    np.testing.assert_allclose(corner + 0.5 * u + 0.5 * v, (2.0, 3.0, 0.0), atol=1e-15)
    np.testing.assert_allclose((u, v), ((0.0, 4.0, 0.0), (-4.0, 0.0, 0.0)), atol=1e-15)


def test_a_cube_of_any_matrix_keeps_its_normals_outside(tmp_path: Path) -> None:
    for scale in ("1", "-1"):
        matrix = (
            f'<transform name="to_world"><scale x="{scale}" y="2" z="3"/><rotate x="1" y="1" angle="30"/></transform>'
        )
        mesh = mitsuba(tmp_path, body=f'<shape type="cube">{matrix}</shape>').shapes[0]
        corners = np.array(mesh.vertices)[np.array(mesh.faces)]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        assert len(normals) == 12 and (np.einsum("ij,ij->i", normals, corners.mean(axis=1)) > 0.0).all()
        assert abs(np.linalg.norm(normals, axis=1).sum() / 2 - 2 * 4 * (2 + 3 + 6)) < 1e-12


def test_an_instance_is_its_group_where_it_stands(tmp_path: Path) -> None:
    group = '<shape type="shapegroup" id="g"><shape type="sphere"><point name="center" x="1"/></shape></shape>'
    body = group + "".join(
        f'<shape type="instance"><ref id="g"/><transform name="to_world"><scale value="{k}"/></transform></shape>'
        for k in (1, 2)
    )
    scene = mitsuba(tmp_path, body=body)
    assert [(shape.center[0], shape.radius) for shape in scene.shapes] == [(1.0, 1.0), (2.0, 2.0)]


def test_a_mirrored_camera_sees_the_mirror_image(tmp_path: Path) -> None:
    body = '<shape type="sphere"><point name="center" x=".7"/><float name="radius" value=".5"/></shape>'
    plain = mitsuba(tmp_path, body=body)
    mirrored = mitsuba(tmp_path, camera=LOOK.replace("<lookat", '<scale x="-1"/><lookat'), body=body)
    one, other = (sr.truth(scene, size=(16, 8), tol=1e-3).radiance for scene in (plain, mirrored))
    assert one.max() > 0.0 and np.abs(one - one[:, ::-1]).max() > 1e-3
    np.testing.assert_allclose(other, one[:, ::-1], rtol=1e-6, atol=1e-12)


def test_the_film_says_what_image_is_due(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    scene = mitsuba(tmp_path)
    assert (scene.film.width, scene.film.filter, scene.film.filter_radius) == (32, "gaussian", 2.0)
    crop = '<rfilter type="tent"/>' + "".join(
        f'<integer name="crop_{name}" value="8"/>' for name in ("width", "height", "offset_x", "offset_y")
    )
    other = mitsuba(tmp_path, film=crop)
    assert other.film.filter == "tent" and other.hash == scene.hash
    assert any("window of 8 x 8" in line for line in warnings(other))
    assert main(["info", str(tmp_path / "case.xml")]) == 0
    printed = capsys.readouterr().out
    assert "--size 32x16" in printed and "--filter tent --filter-radius 1" in printed


def test_max_depth_1_is_emission(tmp_path: Path) -> None:
    body = '<shape type="sphere"><emitter type="area"><rgb name="radiance" value="2"/></emitter></shape>'
    mitsuba(tmp_path, body=body)
    path = tmp_path / "case.xml"
    path.write_text(path.read_text().replace('"max_depth" value="3"', '"max_depth" value="1"'))
    image = sr.truth(path, size=(16, 8), tol=1e-3)
    assert set(np.unique(image.radiance).tolist()) == {0.0, 2.0}


def test_a_file_is_converted(tmp_path: Path) -> None:
    (tmp_path / "in").mkdir()
    (tmp_path / "in" / "a.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    body = '<shape type="obj"><string name="filename" value="a.obj"/><transform name="to_world"><scale value="2"/>'
    body += '<translate x="-1"/></transform><boolean name="face_normals" value="true"/></shape>' + BALL
    scene = mitsuba(tmp_path / "in", body=body)
    target = tmp_path / "out.yaml"
    assert main(["convert", str(tmp_path / "in" / "case.xml"), str(target), "-q"]) == 0
    assert sr.load(target).hash == scene.hash and (tmp_path / "out_files" / "a.obj").exists()
    assert main(["convert", str(tmp_path / "in" / "case.xml"), str(target), "-q"]) == 74, "it exists"


def test_files_outside_are_read_where_allowed(tmp_path: Path) -> None:
    (tmp_path / "in").mkdir()
    (tmp_path / "a.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    body = '<shape type="obj"><string name="filename" value="../a.obj"/></shape>'
    with pytest.raises(SceneError, match="lies outside the folder of the scene; --allow-outside"):
        mitsuba(tmp_path / "in", body=body)
    path = tmp_path / "in" / "case.xml"
    assert len(sr.load(path, allow_outside=True).shapes) == 1  # type: ignore[attr-defined]
    assert main(["params", str(path)]) == 2 and main(["--allow-outside", "params", str(path)]) == 0
    assert main(["params", str(path)]) == 2, "it is allowed once"
    (tmp_path / "in" / "link.obj").symlink_to(tmp_path / "a.obj")
    with pytest.raises(SceneError, match="lies outside the folder of the scene"):
        mitsuba(tmp_path / "in", body=body.replace("../a.obj", "link.obj"))


PBRT = """Film "rgb" "integer xresolution" 32 "integer yresolution" 16
Scale -1 1 1
LookAt 0 -5 1  0 0 0  0 0 1
Camera "perspective" "float fov" 40
WorldBegin
LightSource "point" "rgb I" [ 9 6 3 ] "point3 from" [ 2 -3 4 ]
"""


def pbrt(folder: Path, text: str, head: str = PBRT) -> Any:
    path = folder / "case.pbrt"
    path.write_text(head + text)
    return sr.load(path)


def test_defaults_of_pbrt(tmp_path: Path) -> None:
    scene = pbrt(
        tmp_path, 'Material "conductor" "rgb reflectance" [ .25 .5 .75 ] "float roughness" .09\nShape "sphere"'
    )
    assert (scene.film.filter, scene.film.filter_radius, scene.bounces) == ("gaussian", 1.5, 4)
    assert scene.lights[0].intensity == (9.0, 6.0, 3.0)
    metal = scene.materials["material1"]
    assert metal.alpha == pytest.approx(0.3)
    # Fresnel's reflectance along the normal is the one asked
    for eta, k, due in zip(metal.eta, metal.k, (0.25, 0.5, 0.75), strict=True):
        assert ((eta - 1) ** 2 + k**2) / ((eta + 1) ** 2 + k**2) == pytest.approx(due, rel=1e-12)


def test_instances_includes_and_attributes_of_pbrt(tmp_path: Path) -> None:
    (tmp_path / "ball.pbrt").write_text('Translate 1 0 0\nShape "sphere"\n')
    text = 'ObjectBegin "b"\nInclude "ball.pbrt"\nObjectEnd\n'
    text += 'Attribute "shape" "float radius" .5\n' + 'AttributeBegin\nScale 2 2 2\nObjectInstance "b"\nAttributeEnd\n'
    scene = pbrt(tmp_path, text + 'ObjectInstance "b"\nShape "sphere"\nShape "sphere" "float radius" .25\n')
    found = [(shape.center, shape.radius) for shape in scene.shapes]
    assert found[:2] == [((2.0, 0.0, 0.0), 2.0), ((1.0, 0.0, 0.0), 1.0)]
    assert found[2:] == [((0.0, 0.0, 0.0), 0.5), ((0.0, 0.0, 0.0), 0.25)]


def test_a_camera_of_either_hand(tmp_path: Path) -> None:
    text = 'Translate 1 0 .2\nShape "sphere" "float radius" .5\n'
    one = sr.truth(pbrt(tmp_path, text), size=(16, 8), tol=1e-3).radiance
    other = sr.truth(pbrt(tmp_path, text, PBRT.replace("Scale -1 1 1", "")), size=(16, 8), tol=1e-3).radiance
    assert one.max() > 0.0 and np.abs(one - one[:, ::-1]).max() > 1e-3
    np.testing.assert_allclose(other, one[:, ::-1], rtol=1e-6, atol=1e-12)


@pytest.mark.parametrize("reverse", [False, True])
@pytest.mark.parametrize("mirror", [False, True])
@pytest.mark.parametrize("hand", [False, True])
def test_a_lamp_shines_on_the_side_of_pbrt(reverse: bool, mirror: bool, hand: bool, tmp_path: Path) -> None:
    quad = 'Shape "trianglemesh" "integer indices" [0 1 2 0 2 3] "point3 P" [-1 -1 0 1 -1 0 1 1 0 -1 1 0]\n'
    words = 'AttributeBegin\nAreaLightSource "diffuse" "rgb L" [ 1 1 1 ]\n' + "ReverseOrientation\n" * reverse
    scene = pbrt(
        tmp_path, words + "Scale -1 1 1\n" * mirror + "Translate 0 0 3\n" + quad + "AttributeEnd\n",
        PBRT if hand else PBRT.replace("Scale -1 1 1", ""),
    )  # fmt: skip
    shape = scene.shapes[0]
    # in the object's own coordinates z is up; a mirroring does not turn it, ReverseOrientation does
    assert (np.cross(shape.edge_u, shape.edge_v)[2] < 0.0) == reverse


@pytest.mark.parametrize("ending", ["xml", "pbrt"])
def test_mutated_files_are_told_in_a_line(ending: str, tmp_path: Path) -> None:
    r = random.Random(11)
    (tmp_path / "a.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    body = '<shape type="obj"><string name="filename" value="a.obj"/></shape><shape type="cube"><bsdf type="twosided">'
    body += '<bsdf type="diffuse"><spectrum name="reflectance" value="400:.3, 700:.5"/></bsdf></bsdf></shape>'
    head = '<default name="a" value="1"/>'
    good = XML.format(head=head, camera=LOOK, film='<rfilter type="box"/>', body=body)
    if ending == "pbrt":
        good = PBRT + 'AttributeBegin\nTranslate 1 2 3\nTexture "t" "spectrum" "constant" "rgb value" [ .1 .2 .3 ]\n'
        good += 'Material "diffuse" "texture reflectance" "t"\nObjectBegin "o"\nShape "sphere"\nObjectEnd\n'
        good += 'ObjectInstance "o"\nShape "trianglemesh" "point3 P" [ 0 0 0 1 0 0 0 1 0 ]\nAttributeEnd\n'
    words = good.replace("<", " <").split(" ")
    path = tmp_path / f"case.{ending}"
    counts, begun = [0, 0], time.process_time()
    for _ in range(1200):
        if r.random() < 0.5:
            data = bytearray(good.encode())
            at = r.randrange(len(data))
            data[at : at + r.choice([0, 1, 1, 40, 400])] = bytes([r.randrange(256)]) * r.choice([0, 1, 1, 3])
            path.write_bytes(bytes(data))
        else:
            mixed = list(words)
            at, to = r.randrange(len(mixed)), r.randrange(len(mixed))
            mixed[at : at + r.randint(0, 3)] = mixed[to : to + r.randint(0, 6)]
            path.write_text(" ".join(mixed))
        try:
            sr.load(path)
            counts[0] += 1
        except SceneError as error:
            lines = str(error).splitlines()
            assert len(lines) <= 21 and all(len(line) < 600 for line in lines)
            counts[1] += 1
    assert min(counts) >= 50, counts
    assert in_processor_time(time.process_time() - begun, 60.0)
