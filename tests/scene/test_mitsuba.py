"""Hostile and foreign Mitsuba files: one line that names file, line and reason; nothing run, nothing read elsewhere."""

from __future__ import annotations

import io
import os
import random
import time
from contextlib import redirect_stderr
from pathlib import Path

import pytest

import symrender as sr
from busy import in_processor_time
from symrender.cli import main
from symrender.errors import SceneError

GOOD = str(sr.export("metal", "mitsuba").files["scene.xml"])
HEAD = '<scene version="3.0.0">'
LAUGHS = (
    '<!DOCTYPE lolz [<!ENTITY a "aaaaaaaaaa">'
    + "".join(f'<!ENTITY {y} "{f"&{x};" * 10}">' for x, y in zip("abcdefgh", "bcdefghi", strict=True))
    + "]><scene>&i;</scene>"
)


def changed(old: str, new: str) -> str:
    assert old in GOOD, old
    return GOOD.replace(old, new, 1)


CASES = {
    "laughs": (LAUGHS, ":1:16: document types are not allowed"),
    "external": ('<!DOCTYPE s SYSTEM "SECRET"><scene/>', "document types are not allowed"),
    "entity": ('<!DOCTYPE s [<!ENTITY x SYSTEM "file://SECRET">]><scene>&x;</scene>', "document types"),
    "undefined": ("<scene>&nbsp;</scene>", "not valid XML"),
    "instruction": ('<?php system("touch SECRET"); ?><scene/>', "scene: needs one sensor"),
    "include": (changed(HEAD, HEAD + '<include filename="/etc/passwd"/>'), "lies outside the folder of the scene"),
    "include up": (changed(HEAD, HEAD + '<include filename="../a.xml"/>'), "../a.xml: lies outside the folder"),
    "include fifo": (changed(HEAD, HEAD + '<include filename="secret"/>'), "secret: must be a regular file"),
    "include itself": (changed(HEAD, HEAD + '<include filename="case.xml"/>'), "at most 15 files inside each other"),
    "path": (
        changed(HEAD, HEAD + '<path value="../.."/><include filename="a.xml"/>'),
        "a.xml: lies outside the folder",
    ),
    "parameter": (changed(HEAD, HEAD + '<default name="a" value="$b"/>'), "no default says what $b is"),
    "laughing parameters": (
        changed(
            HEAD,
            HEAD
            + '<default name="a" value="aaaaaaaaaa"/>'
            + "".join(
                f'<default name="{y}" value="{f"${x}" * 10}"/>' for x, y in zip("abcdefgh", "bcdefghi", strict=True)
            ),
        ),
        "value is too long",
    ),
    "twice an id": (changed(HEAD, HEAD + '<bsdf type="diffuse" id="material-gold05"/>'), "given twice"),
    "circle": (
        changed(HEAD, HEAD + '<bsdf type="twosided" id="c"><ref id="c"/></bsdf>'),
        "c refers to itself",
    ),
    "deep": (HEAD + "<a>" * 5000, "nesting must be at most 32 deep"),
    "many": (HEAD + "<a/>" * 120000, "may hold at most 100000"),
    "unclosed": ("<scene>", "not valid XML"),
    "empty": ("", "not valid XML"),
    "text": (changed(HEAD, HEAD + "hello"), "text between elements"),
    "root": ("<svg/>", "must be a scene, got svg"),
    "nan": (changed('name="alpha" value="0.05"', 'name="alpha" value="nan"'), "float: must be finite, got nan"),
    "infinite": (changed('name="alpha" value="0.05"', 'name="alpha" value="1e999"'), "must be finite"),
    "words": (changed('name="alpha" value="0.05"', 'name="alpha" value="rough"'), "must be numbers, got rough"),
    "long": (changed('name="alpha" value="0.05"', f'name="alpha" value="{"9" * 100000}"'), "at most 400 characters"),
    "negative": (
        changed('name="alpha" value="0.05"', 'name="alpha" value="-1"'),
        "materials.gold05.alpha: must be from",
    ),
    "gigantic": (
        changed('name="radius" value="0.62"', 'name="radius" value="1e300"'),
        "shapes[1].radius: must be at most 1e12",
    ),
    "no value": (changed('name="alpha" value="0.05"', 'name="alpha"'), "needs a value"),
    "no name": (changed('<float name="alpha"', "<float"), "needs a name"),
    "wrong type": (
        changed('<float name="radius" value="0.62"/>', '<rgb name="radius" value="1"/>'),
        "radius must be float",
    ),
    "two numbers": (changed('name="radius" value="0.62"', 'name="radius" value="1 2"'), "must be 1 numbers, got 2"),
    "twice": (
        changed('<string name="distribution"', '<float name="alpha" value="1"/><string name="distribution"'),
        "twice",
    ),
    "plugin": (changed('type="roughconductor"', 'type="principled"'), "bsdf principled: no such material here"),
    "emitter": (changed('emitter type="point"', 'emitter type="envmap"'), "emitter envmap: needs a filename"),
    "shape": (changed('shape type="sphere"', 'shape type="bunny"'), "shape bunny: no such shape"),
    "cube": (changed('shape type="sphere"', 'shape type="cube"'), "shape cube: center has no meaning here"),
    "disk": (changed('shape type="sphere"', 'shape type="disk"'), "shape disk: center has no meaning here"),
    "area": (
        changed('<point name="center"', '<emitter type="area"><float name="radiance"/></emitter><point name="center"'),
        "float: must be 1 numbers, got 0",
    ),
    "lamp of another kind": (
        changed('<point name="center"', '<emitter type="projector"/><point name="center"'),
        "a shape emits as area",
    ),
    "filter": (changed('<rfilter type="box"/>', '<rfilter type="sinc"/>'), "rfilter sinc: no such filter here"),
    "depth": (changed('name="max_depth" value="2"', 'name="max_depth" value="0"'), "max_depth must be -1 (all) or"),
    "ref": (changed('<ref id="material-gold05"/>', '<ref id="nothing"/>'), "ref: no bsdf has the id nothing"),
    "clip": (changed('name="near_clip" value="', 'name="near_clip" value="9'), "cuts"),
    "property": (changed('<float name="alpha"', '<float name="alfa"'), "alfa has no meaning here"),
    "unlike": (changed('<float name="alpha"', '<float name="alpha_u"'), "alpha_u and alpha_v must be equal"),
    "spectrum": (changed('<rgb name="eta"', '<spectrum name="eta"'), "spectrum: must be 1 numbers, got 3"),
    "curve": (changed('<rgb name="eta" value="', '<spectrum name="eta" value="500:1, 400:2, '), "must be pairs"),
    "mesh": (changed('shape type="sphere"', 'shape type="ply"'), "shape ply: needs a filename"),
    "medium": (changed('<point name="center"', '<medium type="homogeneous"/><point name="center"'), "a medium is not"),
    "another plane": (
        changed("symrender plane: point 0.0 0.0", "symrender plane: point 0.0 0.1"),
        "is not a square of",
    ),
    "flat": (changed("normal 0.0 0.0 1.0", "normal 0.0 0.0 0.0"), "its comment names no plane"),
    "another cell": (changed("symrender cell: 1.0", "symrender cell: 1.5"), "is not that of a checker"),
}


@pytest.mark.parametrize("name", CASES)
def test_a_refusal_is_one_line_with_its_place(name: str, tmp_path: Path) -> None:
    text, told = CASES[name]
    secret = tmp_path / "secret"
    os.mkfifo(secret)  # who opens it for reading waits for ever
    path = tmp_path / "case.xml"
    path.write_text(text.replace("SECRET", str(secret)))
    begun, used = time.monotonic(), time.process_time()
    err = io.StringIO()
    with redirect_stderr(err):
        assert main(["params", str(path)]) == 2
    assert in_processor_time(time.process_time() - used, 2.0)
    assert time.monotonic() - begun < 60.0, "and it waits for nothing"
    first = err.getvalue().splitlines()[0]
    assert told in first, first
    place = first.removeprefix("ERROR ").removeprefix(str(path))
    line, column = place.split(":")[1:3]
    assert int(line) >= 1 and int(column) >= 1
    assert len(first) < 400 and "Traceback" not in err.getvalue()


def test_all_faults_of_a_file_are_told_together(tmp_path: Path) -> None:
    path = tmp_path / "case.xml"
    text = changed('name="alpha" value="0.05"', 'name="alpha" value="-1"')
    for old, new in (
        ('name="radius" value="0.62"', 'name="radius" value="wide"'),
        ('emitter type="point"', 'emitter type="projector"'),
        ('<rfilter type="box"/>', '<rfilter type="sinc"/>'),
        ("</scene>", '<hair/><shape type="bunny"><emitter type="projector"/></shape><shape type="bunny"/></scene>'),
    ):
        assert old in text
        text = text.replace(old, new, 1)
    path.write_text(text)
    with pytest.raises(SceneError) as caught:
        sr.load(path)
    lines = str(caught.value).splitlines()
    told = ("alpha: must be", "no such filter", "must be numbers, got wide", "no such emitter", "hair has no",
            "(2 times, first here)", "a shape emits as area")  # fmt: skip
    assert len(lines) == len(told) and all(sum(part in line for line in lines) == 1 for part in told), lines
    places = [tuple(map(int, line.removeprefix(f"{path}:").split(":")[:2])) for line in lines]
    assert places == sorted(places)


def test_a_bsdf_may_have_a_name(tmp_path: Path) -> None:
    path = tmp_path / "case.xml"
    path.write_text(changed('<ref id="material-gold05"/>', '<ref name="bsdf" id="material-gold05"/>'))
    assert len(sr.load(path).shapes) > 1  # type: ignore[attr-defined]
    path.write_text(changed('<ref id="material-gold05"/>', '<ref id="material-gold05"/><ref id="material-gold05"/>'))
    with pytest.raises(SceneError, match="needs one bsdf, or a ref to one, got 2"):
        sr.load(path)


def test_a_mark_is_the_line_of_the_property(tmp_path: Path) -> None:
    path = tmp_path / "case.xml"
    path.write_text(changed('name="alpha" value="0.1"', 'name="alpha" value="5"'))
    line = next(k for k, text in enumerate(path.read_text().splitlines(), 1) if 'value="5"' in text)
    with pytest.raises(SceneError, match=rf"case\.xml:{line}:5: materials\.gold10\.alpha: must be from"):
        sr.load(path)


def test_damaged_files_are_refused_or_loaded(tmp_path: Path) -> None:
    r = random.Random(5)
    path = tmp_path / "case.xml"
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
