"""The GLSL target: golden text of every pass, the same text twice, and what a strict compiler would refuse."""

from __future__ import annotations

import re

import pytest

from symrender.kernel.assemble_pixels import PASSES, SPREAD, TABLES, pixel_program
from symrender.targets import glsl
from symrender.targets.glsl_words import RESERVED

PROGRAM = pixel_program()


@pytest.mark.parametrize("entry", PASSES)
def test_golden_text(golden, entry):
    golden(f"{entry}.glsl.txt", glsl.emit(PROGRAM.part(entry)))


@pytest.mark.parametrize("entry", SPREAD)
def test_an_eye_and_a_time_of_every_pixel_are_read_where_one_was_for_all(entry):
    """Beside what is read from ``image_own`` the two texts are the same, and no eye or center is left that is not."""
    plain, spread = (glsl.emit(PROGRAM.part(entry), spread=s) for s in (False, True))
    assert "t_eye[0]" in plain and "t_eye[0]" not in spread.partition("};")[2].partition("};")[2]
    centers = re.compile(r"t_spheres\[[^]+]*\]\.[xyz]")
    moved = re.compile(r"\((t_spheres\[[^]+]*\]\.([xyz])) \+ \((\w+) == own_row \? own_way\.\2 : 0\.0\)\)")
    assert len(centers.findall(plain)) > 2
    assert len(moved.findall(spread)) == len(centers.findall(spread)) == len(centers.findall(plain))
    head, _, body = moved.sub(r"\1", spread).partition("void main() {\n")
    body = re.sub(r"own_eye\.([xyz])", r"t_eye[0].\1", body).split("\n", 3)[3]
    assert plain.partition("void main() {\n")[2] == body
    assert all(line in head.splitlines() for line in plain.partition("void main() {\n")[0].splitlines())


def test_the_same_program_gives_the_same_text():
    again = pixel_program()
    assert all(glsl.emit(PROGRAM.part(e)) == glsl.emit(again.part(e)) for e in PASSES)


@pytest.mark.parametrize("entry", PASSES)
def test_no_name_comes_from_a_scene_and_none_is_reserved(entry):
    text = re.sub(r"//.*", "", glsl.emit(PROGRAM.part(entry)))
    declared = re.findall(r"\b(?:float|int) ([A-Za-z_]\w*)", text)
    assert len(declared) > 100
    assert all("__" not in name and not name.startswith("gl_") for name in declared)
    assert not set(declared) & RESERVED - {"main"}


@pytest.mark.parametrize("entry", PASSES)
def test_functions_come_before_their_use_and_none_calls_itself(entry):
    text = re.sub(r"//.*", "", glsl.emit(PROGRAM.part(entry)))
    defined: set[str] = set()
    names = set(re.findall(r"(?m)^(?:float|int|void) (\w+)\(", text))
    for body in re.split(r"(?m)^(?=(?:float|int|void) \w+\()", text)[1:]:
        own = re.match(r"\w+ (\w+)\(", body).group(1)
        called = set(re.findall(r"\b(\w+)\(", body)) & names - {own}
        assert called <= defined
        assert len(re.findall(rf"\b{own}\(", body)) == 1
        defined.add(own)
    assert "main" in defined


def test_whole_and_real_numbers_are_never_mixed():
    text = glsl.emit(PROGRAM.part("pixel_numeric"))
    assert re.findall(r"(?<![\w.\[])\d+\.\d*\s*[-+*/]\s*\d+(?![\w.\]])", text) == []


def test_blocks_fit_what_webgl_promises():
    blocks = glsl.blocks()
    assert len(blocks) <= 12
    for names in blocks.values():
        rows = sum(-(-TABLES[name].columns // 4) * TABLES[name].rows for name in names)
        assert rows * 16 <= 16_384
