"""Hostile and foreign files of pbrt: one line that names file, line, column and reason; nothing else is opened."""

from __future__ import annotations

import io
import os
import random
import re
import time
from contextlib import redirect_stderr
from pathlib import Path

import pytest

import symrender as sr
from busy import in_processor_time
from symrender.cli import main
from symrender.errors import SceneError

GOOD = (
    str(sr.export("interreflection", "pbrt", size=(40, 30)).files["scene.red.pbrt"])
    + """# shapes.metal
AttributeBegin
  Material "conductor" "spectrum eta" [ 300 .4 900 .4 ] "spectrum k" [ 300 2 900 2 ]
    "float roughness" [ .2 ] "bool remaproughness" false
  Translate 3 0 .5
  Shape "sphere" "float radius" [ .5 ]
AttributeEnd
# shapes.globe
AttributeBegin
  # symrender cell: 0.25
  Texture "fields" "spectrum" "checkerboard" "float uscale" 8 "float vscale" -4 "float vdelta" 4
  Material "diffuse" "texture reflectance" "fields"
  Translate -3 0 .5
  Rotate 180 0 0 1
  Shape "sphere" "float radius" [ .5 ]
AttributeEnd
MakeNamedMaterial "grey" "string type" "diffuse" "rgb reflectance" [ .5 .5 .5 ]
NamedMaterial "grey"
"""
)


def changed(old: str, new: str) -> str:
    assert old in GOOD, old
    return GOOD.replace(old, new, 1)


def behind(text: str) -> str:
    return GOOD + text + "\n"


CASES = {
    "empty": ("", ":1:1: must have a WorldBegin, got none"),
    "unknown": (behind("Sphere 1"), r"must be a directive, got Sphere"),
    "guess": (behind('LightSorce "point"'), r"got LightSorce, did you mean 'LightSource'"),
    "word": (behind("<scene/>"), r"must be a directive, got <scene/>"),
    "string": (behind('"float a" 1 1'), r"must be a directive, got the string .float a"),
    "include": (behind('Include "SECRET"'), r"Include: .*secret: must be a regular file"),
    "import": (behind('Import "SECRET"'), r"Import: .*secret: must be a regular file"),
    "include outside": (behind('Include "../a.pbrt"'), r"Include: \.\./a\.pbrt: lies outside the folder of the scene"),
    "old": (behind('Material "matte" "color Kd" [ 1 1 1 ]'), r"must be a file of pbrt-v4, got .* Material .matte."),
    "no object": (behind('ObjectInstance "a"'), r"ObjectInstance: must be an object given before, got a"),
    "long numbers": (
        behind('Shape "trianglemesh" "point3 P" [ ' + "1 2 3 " * 30 + "4 ]"),
        r"must be point3, made of 3 values, got 91",
    ),
    "metals": (
        changed("[ 300 .4 900 .4 ]", '"metal-Au-eta"').replace("[ 300 2 900 2 ]", '"metal-Ag-k"'),
        r"Material\.eta: must be of one metal of metal-Ag",
    ),
    "dispersive": (
        behind('Material "dielectric" "spectrum eta" [ 400 1.5 700 1.6 ]'),
        r"eta: must be one number at all",
    ),
    "bent": (
        behind('Shape "bilinearmesh" "point3 P" [ 0 0 0 1 0 0 0 1 0 1 1 1 ]'),
        r"Shape\.P: must be flat patches",
    ),
    "area": (behind('AreaLightSource "goniometric"'), r"AreaLightSource: must be diffuse"),
    "area on both sides": (behind('AreaLightSource "diffuse" "bool twosided" true'), r"twosided: must be false"),
    "area by power": (behind('AreaLightSource "diffuse" "float power" 9'), r"power: must be left out"),
    "medium": (behind('MediumInterface "a" ""'), r"MediumInterface: must not be there: a scene has no media"),
    "time": (behind("ActiveTransform EndTime"), r"ActiveTransform: must not be there: nothing moves"),
    "world end": (behind("WorldEnd"), r"must be a file of pbrt-v4, got one of an earlier version by its WorldEnd"),
    "deep": (behind("AttributeBegin\n" * 5000), r"AttributeBegin: nesting must be at most 32 deep"),
    "brackets": (behind('Shape "sphere" "float radius" ' + "[" * 5000), r"a bracket within brackets"),
    "many": (behind("Identity\n" * 120000), r"may hold at most 100000 directives, parameters and comments"),
    "long list": (
        behind('Shape "sphere" "float radius" [ ' + "1 " * 100000),
        r"Shape\.radius: must be at most 64 values",
    ),
    "many parameters": (
        behind('Shape "sphere" ' + " ".join(f'"float a{k}" 1' for k in range(100))),
        r"at most 64 parameters",
    ),
    "open string": (behind('Shape "sphere'), r"a string must end on its line"),
    "broken string": (behind('Shape "sph\nere"'), r"a string must end on its line"),
    "escape": (behind(r'Shape "sph\"ere"'), r"have no backslash"),
    "open list": (behind('Shape "sphere" "float radius" [ 1'), r"got the end of the file"),
    "closed list": (behind('Shape "sphere" "float radius" ]'), r"Shape\.radius: must be a value, got \]"),
    "empty list": (
        behind('Shape "sphere" "float radius" [ ]'),
        r"Shape\.radius: must be float, made of 1 values, got 0",
    ),
    "no value": (behind('Shape "sphere" "float radius"'), r"must be a value, got the end of the file"),
    "no name": (behind('Shape "sphere" "float" 1'), r'Shape: must be "type name"'),
    "no type": (behind('Shape "sphere" "length radius" 1'), r"Shape\.radius: must be of a type such as float"),
    "nan": (behind('Shape "sphere" "float radius" nan'), r"Shape\.radius: must be a number, got nan"),
    "inf": (behind("Translate inf 0 0"), r"Translate: must be a number, got inf"),
    "infinite": (behind("Translate 1e999 0 0"), r"Translate: must be finite, got 1e999"),
    "hex": (behind("Translate 0x10 0 0"), r"Translate: must be a number, got 0x10"),
    "underscore": (behind("Translate 1_0 0 0"), r"must be a number, got 1_0"),
    "digits": (behind("Translate \u0661 0 0"), r"must be a number"),
    "gigantic": (behind("Translate " + "9" * 100000 + " 0 0"), r"at most 400 characters"),
    "overflow": (behind("Scale 1e200 1e200 1e200\n" * 2), r"Scale: must leave coordinates finite"),
    "far": (behind('Translate 1e300 0 0\nShape "sphere"'), r"shapes\[\d+\]\.center.*must be at most 1e12"),
    "negative": (behind('Shape "sphere" "float radius" -1'), r"shapes\[\d+\]\.radius: must be > 0"),
    "wrong type": (behind('Shape "sphere" "integer radius" 1'), r"Shape\.radius: must be float, got integer"),
    "text for number": (behind('Shape "sphere" "float radius" "a"'), r'radius: must be a number, got the string "a"'),
    "number for text": (behind('MakeNamedMaterial "m" "string type" 1'), r"type: must be a string, got 1"),
    "bool": (changed('remaproughness" false', 'remaproughness" 0'), r"Material\.remaproughness: must be true or false"),
    "integer": (changed('maxdepth" [ 2 ]', 'maxdepth" [ 2.5 ]'), r"Integrator\.maxdepth: must be an integer, got 2\.5"),
    "huge integer": (changed('maxdepth" [ 2 ]', 'maxdepth" [ 9999999999 ]'), r"maxdepth: must be an integer"),
    "twice": (behind('Shape "sphere" "float radius" 1 "float radius" 2'), r"Shape\.radius: must be given once, first"),
    "two numbers": (behind('Shape "sphere" "float radius" [ 1 2 ]'), r"radius: must be 1 numbers, got 2"),
    "rgb of two": (
        behind('LightSource "point" "rgb I" [ 1 2 ]'),
        r"LightSource\.I: must be rgb, made of 3 values, got 2",
    ),
    "unknown parameter": (behind('Shape "sphere" "float alpha" .5'), r"Shape\.alpha: must be left out, got float"),
    "matrix": (behind("Transform [ 1 2 3 ]"), r"Transform: must be 16 numbers in brackets, got 3"),
    "no brackets": (behind("Transform 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1"), r"16 numbers in brackets, got 1"),
    "projective": (behind("Transform [ 1 0 0 1 0 1 0 0 0 0 1 0 0 0 0 1 ]"), r"Transform: must be affine"),
    "no axis": (behind("Rotate 10 0 0 0"), r"Rotate: must have an axis longer than zero"),
    "no view": (behind("LookAt 1 1 1 1 1 1 0 0 1"), r"LookAt: must have an eye and a target that differ"),
    "end": (behind("AttributeEnd"), r"AttributeEnd: must end an AttributeBegin, got none open"),
    "not ended": (behind("AttributeBegin"), r"AttributeEnd: must end 1 AttributeBegin more"),
    "system": (behind('CoordSysTransform "there"'), r"CoordSysTransform: must be a system of coordinates given before"),
    "color space": (behind('ColorSpace "rec2020"'), r"ColorSpace: must be srgb, got rec2020"),
    "option": ('Option "msereferenceimage" "SECRET"\n' + GOOD, r"Option: must be disablepixeljitter.*got msereference"),
    "ellipsoid": (behind('Scale 1 1 2\nShape "sphere"'), r"Shape: must be turned, moved and scaled alike"),
    "flat": (behind('Scale 0 0 0\nShape "sphere"'), r"Shape: must be turned, moved and scaled alike"),
    "part": (behind('Shape "sphere" "float zmax" .2'), r"Shape\.zmax: must be 1, got 0\.2: parts of spheres"),
    "phimax": (behind('Shape "sphere" "float phimax" 90'), r"Shape\.phimax: must be 360, got 90"),
    "ring": (
        behind('Shape "disk" "float innerradius" .5'),
        r"innerradius: must be 0, got 0\.5: rings are not",
    ),
    "ply": (behind('Shape "plymesh" "string filename" "SECRET"'), r"Shape\.filename: .*secret: must be a regular file"),
    "another plane": (changed("plane: point 0.0 0.0", "plane: point 0.0 0.1"), r"Shape\.P: must be the square"),
    "no normal": (changed("normal 0.0 0.0 1.0", "normal 0.0 0.0 0.0"), r"must have a comment that names a plane"),
    "moved plane": (changed("  # symrender plane", "Translate 0 0 1\n  # symrender plane"), r"where no transform is"),
    "indices": (changed("0 1 2 0 2 3", "0 1 2 0 2 1"), r"Shape\.indices: must be 0 1 2 0 2 3"),
    "chart": (changed('vscale" -4', 'vscale" 4'), r"Shape: must have fields of one side from its top"),
    "cell": (changed("cell: 0.25", "cell: 0.5"), r"Shape: must have fields of the side its comment says, 0\.5, got"),
    "not turned": (changed("Rotate 180", "Rotate 170"), r"Shape: must be turned by Rotate 180 0 0 1"),
    "fields": (
        changed('"float uscale" 8', '"texture tex1" "fields"'),
        r"Texture\.tex1: must be a texture given before",
    ),
    "mapping": (changed('"float uscale" 8', '"string mapping" "planar"'), r"Texture\.mapping: must be uv, got planar"),
    "image": (
        behind('Texture "i" "spectrum" "imagemap" "string filename" "SECRET"'),
        r"Texture\.filename: .*secret: must be a regular file",
    ),
    "marble": (
        behind('Texture "i" "spectrum" "marble"'),
        r"Texture: must be constant, scale, checkerboard or imagemap, got marble",
    ),
    "texture twice": (behind('Texture "fields" "spectrum" "constant"'), r"Texture: must have a name of its own"),
    "no texture": (
        behind('Material "diffuse" "texture reflectance" "x"'),
        r"Material\.reflectance: must be a texture given",
    ),
    "named twice": (
        behind('MakeNamedMaterial "grey" "string type" "diffuse"'),
        r"MakeNamedMaterial: must have a name of its own, got grey as on line \d+",
    ),
    "not named": (behind('NamedMaterial "blue"'), r"NamedMaterial: must be a material given before, got blue"),
    "unlike": (changed('"float roughness" [ .2 ]', '"float uroughness" .2'), r"must be 0\.2, got 0: facets"),
    "copper": (
        changed('"spectrum eta" [ 300 .4 900 .4 ]', ""),
        r"Material: must have eta and k, or none of them, got no eta",
    ),
    "factor": (
        changed('"spectrum eta"', '"rgb reflectance" [ 1 1 1 ] "spectrum eta"'),
        r"Material\.reflectance: must be",
    ),
    "displaced": (behind('Material "diffuse" "texture displacement" "fields"'), r"displacement: must be left out"),
    "power": (behind('LightSource "point" "float power" 60'), r"LightSource\.power: must be left out"),
    "sky image": (
        behind('LightSource "infinite" "string filename" "SECRET"'),
        r"LightSource\.filename: .*secret: must be a regular file",
    ),
    "goniometric light": (
        behind('LightSource "goniometric"'),
        r"LightSource: must be point, spot, distant or infinite, got goniometric",
    ),
    "cone of a spot": (behind('LightSource "spot" "float conedeltaangle" [ 0 ]'), r"cutoff must be larger than beam"),
    "no direction": (behind('LightSource "distant" "point3 to" [ 0 0 0 ]'), r"direction.* must be longer than zero"),
    "negative light": (behind('LightSource "point" "float scale" -1'), r"lights\[\d+\]\.intensity"),
    "two skies": (behind('LightSource "infinite"\n' * 2), r"at most one light is a sky"),
    "head late": (behind('Film "rgb"'), r"Film: must stand before WorldBegin"),
    "world early": ('Shape "sphere"\n' + GOOD, r"Shape: must stand behind WorldBegin"),
    "two cameras": (changed("WorldBegin", 'Camera "perspective"\nWorldBegin'), r"Camera: must be given once"),
    "mirrored": (
        changed("Scale -1 1 1", ""),
        r"Shape: must stand where no transform is: its comment names places of the world",
    ),
    "skewed": (changed("Scale -1 1 1", "Scale -1 2 1"), r"Camera: must stand where a look-at camera can"),
    "singular": (changed("Scale -1 1 1", "Scale 0 1 1"), r"Camera: must stand where a look-at camera can"),
    "orthographic": (changed('"perspective"', '"orthographic"'), r"Camera: must be perspective, got orthographic"),
    "window": (
        changed('"float screenwindow" [ -', '"float screenwindow" [ -9'),
        r"screenwindow: must have the view in",
    ),
    "pixels": (changed('xresolution" [ 40 ]', 'xresolution" [ 50 ]'), r"Camera\.screenwindow: must make pixels square"),
    "no pixels": (
        changed('xresolution" [ 40 ]', 'xresolution" [ 0 ]'),
        r"Film\.xresolution: must be at least 1, got 0",
    ),
    "wide box": (changed('"float xradius" [ 0.5 ]', '"float xradius" 1'), r"PixelFilter\.yradius: must be 1, got 0\.5"),
    "no world": (changed("WorldBegin", ""), r"must stand behind WorldBegin"),
    "control": (behind("\x1b[31mRed"), r"must be a directive, got \\x1b"),
}


@pytest.mark.parametrize("name", CASES)
def test_a_refusal_is_one_line_with_its_place(name: str, tmp_path: Path) -> None:
    text, told = CASES[name]
    secret = tmp_path / "secret"
    os.mkfifo(secret)  # who opens it for reading waits for ever
    path = tmp_path / "case.pbrt"
    path.write_text(text.replace("SECRET", str(secret)))
    begun = time.process_time()
    err = io.StringIO()
    with redirect_stderr(err):
        assert main(["params", str(path)]) == 2
    assert in_processor_time(time.process_time() - begun, 2.0)
    first = err.getvalue().splitlines()[0]
    assert first.startswith(f"ERROR {path}:") and re.search(told, first), first
    line, column = first.removeprefix(f"ERROR {path}:").split(":")[:2]
    assert int(line) >= 1 and int(column) >= 1
    assert len(first) < 500 and "Traceback" not in err.getvalue()


def test_what_the_cases_change_is_read(tmp_path: Path) -> None:
    path = tmp_path / "case.pbrt"
    path.write_text(GOOD)
    assert len(sr.load(path).shapes) >= 4  # type: ignore[attr-defined]


def test_all_faults_of_a_file_are_told_together(tmp_path: Path) -> None:
    path = tmp_path / "case.pbrt"
    text = behind(
        'Include "a"\nFoo 1 "x"\nBar\nShape "sphere" "float radius" -1\nShape "cone"\n'
        'MakeNamedMaterial "m" "string type" "hair"\nNamedMaterial "m"\nTexture "t" "spectrum" "imagemap"\n'
        'Material "diffuse" "texture reflectance" "t"\nShape "sphere" "float zmax" .2 "float alpha" 1\nLightSource 3'
    )
    path.write_text(text.replace('maxdepth" [ 2 ]', 'maxdepth" [ -9 ]'))
    with pytest.raises(SceneError) as caught:
        sr.load(path)
    lines = str(caught.value).splitlines()
    told = ("Integrator.maxdepth", "Include: ", "got Foo", "got Bar", "radius: must be > 0", "got cone",
            "MakeNamedMaterial", "Texture: must have a filename", "zmax: must be",
            "LightSource: must be a string")  # fmt: skip
    assert len(lines) == len(told), lines
    assert all(part in line for part, line in zip(told, lines, strict=True)), lines
    path.write_text(text + 'Shape "open')
    with pytest.raises(SceneError) as caught:
        sr.load(path)
    lines = str(caught.value).splitlines()
    assert len(lines) > 5 and "a string must end on its line" in lines[-1] and "WorldBegin" not in str(caught.value)


def test_a_mark_is_line_and_column_of_the_parameter(tmp_path: Path) -> None:
    path = tmp_path / "case.pbrt"
    path.write_text(changed('"float roughness" [ .2 ]', '"float roughness" [ 5 ]'))
    line = next(k for k, text in enumerate(path.read_text().splitlines(), 1) if 'Material "conductor"' in text)
    with pytest.raises(SceneError, match=rf"case\.pbrt:{line}:3: materials\.material\d\.alpha: must be"):
        sr.load(path)
    path.write_text("# one\n\n \r\n\t" + changed("WorldBegin", "WorldBegin Bogus"))
    line = next(k for k, text in enumerate(path.read_text().splitlines(), 1) if "Bogus" in text)
    with pytest.raises(SceneError, match=rf"case\.pbrt:{line}:12: must be a directive, got Bogus"):
        sr.load(path)


def test_files_are_as_large_as_scenes_may_be(tmp_path: Path) -> None:
    path = tmp_path / "case.pbrt"
    path.write_text("1 " * 20_000_000)
    begun = time.process_time()
    with pytest.raises(SceneError, match="may hold at most 33554432 bytes"):
        sr.load(path)
    path.write_text("1 " * 500_000)
    with pytest.raises(SceneError, match="must be a directive, got 1"):
        sr.load(path)
    path.write_text('Sampler "a" ' + '"float x" [ 1 ] ' * 50_000)
    with pytest.raises(SceneError, match="must be given once"):
        sr.load(path)
    path.write_text("#" * 1_000_000 + "\n")
    with pytest.raises(SceneError, match="must have a WorldBegin"):
        sr.load(path)
    path.write_text("#\n" * 500_000)
    with pytest.raises(SceneError, match="may hold at most 100000 directives, parameters and comments"):
        sr.load(path)
    path.write_text("Translate 1 0 0\n" * 20_000)
    with pytest.raises(SceneError, match="must have a WorldBegin"):
        sr.load(path)
    assert in_processor_time(time.process_time() - begun, 6.0)


def test_nothing_beside_the_file_is_opened(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "case.pbrt"
    path.write_text(GOOD)
    sr.load(path)
    opened: list[str] = []
    real = os.open

    def watched(name: str, *rest: int, **more: int) -> int:
        opened.append(os.fspath(name))
        return real(name, *rest, **more)

    monkeypatch.setattr(os, "open", watched)
    monkeypatch.setattr("builtins.open", lambda *a, **k: pytest.fail(f"opened {a}"))
    assert len(sr.load(path).shapes) >= 4  # type: ignore[attr-defined]
    assert opened == [str(path)]


def test_a_file_that_includes_itself_ends(tmp_path: Path) -> None:
    (tmp_path / "loop.pbrt").write_text('Identity\nInclude "loop.pbrt"\nInclude "loop.pbrt"\n')
    path = tmp_path / "case.pbrt"
    path.write_text(behind('Include "loop.pbrt"'))
    begun = time.process_time()
    with pytest.raises(SceneError, match=r"loop\.pbrt:\d:1: Include: must be at most"):
        sr.load(path)
    assert in_processor_time(time.process_time() - begun, 10.0)


def test_numbers_at_the_ends_are_refused_or_loaded(tmp_path: Path) -> None:
    r = random.Random(6)
    path = tmp_path / "case.pbrt"
    places = [m.span() for m in re.finditer(r"(?<=[ \[])-?[0-9.]+(?:e-?[0-9]+)?(?=[ \n])", GOOD)]
    assert len(places) > 60
    counts = [0, 0]
    for _ in range(400):
        begin, end = r.choice(places)
        number = r.choice(["0", "-0.0", "1e308", "-1e308", "5e-324", "1e160", "-1e-170", "1e11", "0.5", "2147483647"])
        path.write_text(GOOD[:begin] + number + GOOD[end:])
        try:
            sr.load(path)
            counts[0] += 1
        except SceneError as error:
            assert str(error).startswith(str(path))
            counts[1] += 1
    assert min(counts) >= 10, counts


def test_damaged_files_are_refused_or_loaded(tmp_path: Path) -> None:
    r = random.Random(5)
    path = tmp_path / "case.pbrt"
    counts = [0, 0]
    for _ in range(400):
        data = bytearray(GOOD.encode())
        for _ in range(r.randint(1, 3)):
            at = r.randrange(len(data))
            data[at : at + r.choice([0, 1, 1, 40])] = bytes([r.randrange(256)]) * r.choice([0, 1, 1, 3])
        path.write_bytes(bytes(data))
        try:
            sr.load(path)
            counts[0] += 1
        except SceneError as error:
            assert str(error).startswith(str(path))
            counts[1] += 1
    assert min(counts) >= 10, counts
