"""Loading: what is accepted, and the one line said about everything that is not."""

from __future__ import annotations

import io
import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from symrender.errors import SceneError
from symrender.scene import gallery
from symrender.scene.load import load, parse
from symrender.scene.parse_json import parse_json
from symrender.scene.parse_yaml import parse_yaml
from symrender.scene.scene import Scene

BASE = """\
camera: {type: plane, eye: [0, 0, 4], window_half: 1}
spheres:
  - name: A
    center: [0, 0, 1]
    radius: %s
"""


VIEW = '"camera": {"type": "plane", "eye": [0, 0, 4], "window_half": 1}'


def message(text: str | bytes, suffix: str = ".yaml") -> str:
    with pytest.raises(SceneError) as error:
        parse(text if isinstance(text, str) else text.decode(), f"scene{suffix}", suffix)
    lines = str(error.value).split("\n")
    for line in lines:
        assert line.isprintable()
        assert len(line) <= 300
    assert len(lines[0]) <= 200
    return lines[0]


def file_message(path: Path | str) -> str:
    with pytest.raises(SceneError) as error:
        load(path)
    assert str(error.value).isprintable()
    return str(error.value)


@pytest.mark.parametrize(
    ("radius", "value"),
    [
        *(("1e3", 1000.0), ("1.0e3", 1000.0), ("1E+3", 1000.0), ("010", 10.0), (".5", 0.5), ("5.", 5.0), ("+2", 2.0)),
        *(("0o17", 15.0), ("0x1F", 31.0), ("1e-30", 1e-30), ("1e-150", 1e-150), ("1e12", 1e12)),
    ],
)
def test_numbers_of_yaml_1_2(radius: str, value: float) -> None:
    assert parse(BASE % radius, "x").spheres[0].radius == value


@pytest.mark.parametrize(
    ("radius", "said"),
    [
        ("-1", "must be > 0 and finite, got -1"),
        ("0", "must be > 0 and finite, got 0"),
        ("1e-160", "must not be below 1e-150, got 1e-160"),
        ("1e30", "must be at most 1e12, got 1e+30"),
        ("on", "must be a number, got the text 'on'"),
        ("no", "must be a number, got the text 'no'"),
        ("yes", "must be a number, got the text 'yes'"),
        ("1:30", "must be a number, got the text '1:30'"),
        ("2024-01-01", "must be a number, got the text '2024-01-01'"),
        ("1_000", "must be a number, got the text '1_000'"),
        ("true", "must be a number, got true"),
        ("'1'", "must be a number, got the text '1'"),
        ("null", "must be a number, got null"),
        ("", "must be a number, got null"),
        ("[1]", "must be a number, got a list of 1"),
        ("{a: 1}", "must be a number, got a mapping of 1"),
        (".nan", "must be finite, got .nan"),
        ("-.inf", "must be finite, got -.inf"),
        ("1e400", "must be finite, got 1e400"),
        ("NaN", "must be a number, got the text 'NaN'"),
        ("9" * 100_000, "a number must have at most 400 characters, got 100000"),
        ("9" * 350, f"must be finite, got {'9' * 45}..."),
        ("0x" + "f" * 900_000, "a number in base 8 or 16 must have at most 18 characters, got 900002"),
        ("sin(t)", "must be a number, got the text 'sin(t)'"),
        ("9**9**9", "must be a number, got the text '9**9**9'"),
        ("().__class__", "must be a number, got the text '().__class__'"),
        ("__import__('os').getcwd()", "must be a number, got the text '__import__('os').getcwd()'"),
    ],
)
def test_wrong_numbers_are_named(radius: str, said: str) -> None:
    assert message(BASE % radius) == f"scene.yaml:5:5: spheres[0].radius: {said}"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "scene.yaml:1:1: must be a mapping with a camera, spheres and lights, got nothing (read as YAML)"),
        (
            "# a\n# b\n",
            "scene.yaml:1:1: must be a mapping with a camera, spheres and lights, got nothing (read as YAML)",
        ),
        (
            "- 1\n",
            "scene.yaml:1:1: must be a mapping with a camera, spheres and lights, got a list of 1 (read as YAML)",
        ),
        ("\n\n3\n", "scene.yaml:3:1: must be a mapping with a camera, spheres and lights, got 3 (read as YAML)"),
        (
            "a: !!python/object/apply:os.system [ls]",
            "scene.yaml:1:4: tags are not allowed, got tag:yaml.org,2002:pytho",
        ),
        ("a: !x 1", "scene.yaml:1:4: tags are not allowed, got !x"),
        ("a: 1\nb: &x [*x]", "scene.yaml:2:4: anchors and aliases are not allowed"),
        ("name: &x a", "scene.yaml:1:7: anchors and aliases are not allowed"),
        ("name: a\nlights: &x []", "scene.yaml:2:9: anchors and aliases are not allowed"),
        ("a: *x", "scene.yaml:1:4: anchors and aliases are not allowed"),
        ("a: 1\n<<: {b: 1}", "scene.yaml:2:1: merge keys (<<) are not allowed"),
        ("camera: {<<: {b: 1}}", "scene.yaml:1:10: camera: merge keys (<<) are not allowed"),
        ("a: 1\n" + "[" * 5000, "scene.yaml:"),
        ("a: " + "[" * 5000, "scene.yaml:1:35: nesting must be at most 32 deep"),
        ("name: x\nlights: []\nname: y\n", "scene.yaml:3:1: name: duplicate key, first on line 1"),
        (BASE % 1 + "    radius: 2\n", "scene.yaml:6:5: spheres[0].radius: duplicate key, first on line 5"),
        ("name: a\n---\nname: b\n", "scene.yaml:2:1: a scene file must hold one document, a second one starts here"),
        ("1: 2", "scene.yaml:1:1: a key must be text, got 1"),
        ("? [a]\n: 2", "scene.yaml:1:3: a key must be text, got a list or a mapping"),
        ("name: \x01", "scene.yaml:1:7: not valid YAML: control characters are not allowed"),
        ("a: [1, 2", "scene.yaml:"),
        ("a:\n\tb: 1", "scene.yaml:2:1: not valid YAML:"),
        ("".join(f"k{i}: 1\n" for i in range(100)), "scene.yaml:65:1: a mapping may hold at most 64 keys"),
        ("a: [" + "1, " * 110_000 + "1]", "scene.yaml:1:300002: a scene file may hold at most 100000 keys and items"),
        (
            BASE % 1 + "    raduis: 3\n",
            "scene.yaml:6:5: spheres[0].raduis: unknown key 'raduis', did you mean 'radius'",
        ),
        (
            BASE % 1 + "zzz: 3\n",
            "scene.yaml:6:1: zzz: unknown key 'zzz', known are name, description, camera, spheres, ",
        ),
        (BASE % 1 + '"\\e[31m\\u202e": 1\n', "scene.yaml:6:1: \\x1b[31m\\u202e: unknown key '\\x1b[31m\\u202e', known"),
        ("spheres: []\n", "scene.yaml:1:1: camera: missing, must be a mapping"),
        ("camera: {}\n", "scene.yaml:1:1: camera.type: must be one of plane, look_at, got nothing"),
        (
            "camera: {type: lookat}\n",
            "scene.yaml:1:10: camera.type: must be one of plane, look_at, got the text 'lookat'",
        ),
        (BASE % 1 + "floor: 3\n", "scene.yaml:6:1: floor: must be a mapping or null, got 3"),
        (BASE % 1 + "lights: 3\n", "scene.yaml:6:1: lights: must be a list, got 3"),
        (BASE % 1 + "lights: [3]\n", "scene.yaml:6:10: lights[0]: must be a mapping, got 3"),
        (BASE % 1 + "ambient: [1, 2]\n", "scene.yaml:6:1: ambient: must be a list of 3 numbers, got a list of 2"),
        (BASE % 1 + "ambient: [1, 2, 3, 4]\n", "scene.yaml:6:1: ambient: must be a list of 3 numbers, got a list of 4"),
        (BASE % 1 + "ambient: 1\n", "scene.yaml:6:1: ambient: must be a list of 3 numbers, got 1"),
        (BASE % 1 + "ambient: [1,\n  2, x]\n", "scene.yaml:7:6: ambient[2]: must be a number, got the text 'x'"),
        (BASE % 1 + "ambient: [1, -1, 0]\n", "scene.yaml:6:14: ambient[1]: must be >= 0 and finite, got -1"),
        (BASE % 1 + f"name: {'x' * 101}\n", "scene.yaml:6:1: name: must have at most 100 characters, got 101"),
        (
            "camera: {type: plane, eye: [0, 0, 2.0e+12], window_half: 1}",
            "scene.yaml:1:35: camera.eye[2]: must be at most",
        ),
    ],
)
def test_yaml_is_refused_in_one_line(text: str, said: str) -> None:
    assert message(text).startswith(said)


LOBE = BASE % 1 + "    lobe: {%s}\n"


@pytest.mark.parametrize(
    ("lobe", "said"),
    [
        ("exponent: -1", "exponent: must be >= 0 and finite, got -1"),
        ("exponent: -0.5", "exponent: must be >= 0 and finite, got -0.5"),
        ("exponent: 1e15", "exponent: must be at most 1e12 (ask for mirror: true), got 1000000000000000.0"),
        ("theta_max: 2", "theta_max: must be from 0 to pi/2, got 2"),
        ("theta_max: 4", "theta_max: must be from 0 to pi/2, got 4"),
        ("theta_max: -0.1", "theta_max: must be from 0 to pi/2, got -0.1"),
        ("weight: 1.5", "weight: must be from 0 to 1, got 1.5"),
        ("weight: -0.1", "weight: must be from 0 to 1, got -0.1"),
        ("mirror: 1", "mirror: must be true or false, got 1"),
        ("mirror: yes", "mirror: must be true or false, got the text 'yes'"),
    ],
)
def test_lobes_out_of_range(lobe: str, said: str) -> None:
    assert message(LOBE % lobe) == f"scene.yaml:6:12: spheres[0].lobe.{said}"


@pytest.mark.parametrize("lobe", ["exponent: 0", "exponent: 1e-300", "exponent: 1e12", "theta_max: 0", "mirror: true"])
def test_limits_of_lobes_are_scenes(lobe: str) -> None:
    assert parse(LOBE % lobe, "x").spheres[0].lobe is not None
    assert parse(LOBE % "theta_max: 1.5707963267948966", "x").spheres[0].lobe is not None


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("    color: [1.5, 0, 0]", "spheres[0].color[0]: must be from 0 to 1, got 1.5"),
        ("    color: [0, -0.1, 0]", "spheres[0].color[1]: must be from 0 to 1, got -0.1"),
        ("background: [0, 0, -1]", "background[2]: must be >= 0 and finite, got -1"),
        ("ambient: [0, 0, 2e12]", "ambient[2]: must be at most 1e12, got 2000000000000.0"),
        (
            "lights: [{type: point, name: k, position: [0, 0, 1], color: [-1, 0, 0]}]",
            "lights[0].color[0]: must be >= 0 and",
        ),
    ],
)
def test_colors_out_of_range(line: str, said: str) -> None:
    column = line.index(next(part for part in ("1.5", "-0.1", "-1", "2e12") if part in line)) + 1
    assert message(BASE % 1 + line + "\n").startswith(f"scene.yaml:6:{column}: {said}")


LOOK = "camera: {type: look_at, eye: [0, 0, 3], target: %s, up: %s, fov: %s}\n"


@pytest.mark.parametrize(
    ("camera", "said"),
    [
        (("[0, 0, 3]", "[0, 0, 1]", 40), "camera: eye and target must differ, got the same point for both"),
        (("[0, 0, 3.0e+0]", "[0, 0, 1]", 40), "camera: eye and target must differ, got the same point for both"),
        (("[0, 0, 0]", "[0, 0, 1]", 40), "camera: up must not be parallel to the view from eye to target"),
        (("[0, 0, 0]", "[0, 1e-14, 1]", 40), "camera: up must not be parallel to the view from eye to target"),
        (("[0, 0, 0]", "[0, 0, 0]", 40), "camera: up must be longer than zero"),
        (("[0, 1, 0]", "[0, 0, 1]", 0), "camera.fov: must lie between 0 and 180, both excluded, got 0"),
        (("[0, 1, 0]", "[0, 0, 1]", 180), "camera.fov: must lie between 0 and 180, both excluded, got 180"),
        (("[0, 1, 0]", "[0, 0, 1]", ".nan"), "camera.fov: must be finite, got .nan"),
    ],
)
def test_cameras_without_a_direction(camera: tuple[str, str, object], said: str) -> None:
    text = LOOK % camera
    column = text.index("fov" if "fov" in said else "camera") + 1
    assert message(text) == f"scene.yaml:1:{column}: {said}"


def test_conditions_between_parts() -> None:
    twice = BASE % 1 + "  - {name: B, center: [0, 0, 1], radius: 1}\n  - {name: A, center: [9, 0, 1], radius: 1}\n"
    assert message(twice) == "scene.yaml:7:6: spheres[2].name: must be unique, spheres[0] is 'A' too"
    light = "{name: A, type: disk, position: [1, 2, 3], radius: %s, target: [1, 2, 3]}"
    same = "position and target of a disk must differ, got the same point for both"
    assert message(BASE % 1 + f"lights:\n  - {light % 0.1}\n") == f"scene.yaml:7:5: lights[0]: {same}"
    assert parse(BASE % 1 + f"lights:\n  - {light % 0}\n", "x").lights[0].name == "A"
    plane = "camera: {type: plane, eye: [1, 2, 0], window_half: 1}"
    assert message(plane).startswith("scene.yaml:1:1: camera: eye must be off the plane z = 0, which window_half")


@pytest.mark.parametrize("suffix", [".yaml", ".json", ".toml"])
def test_each_fault_of_a_file_has_its_line_and_column(suffix: str) -> None:
    texts = {
        ".yaml": BASE % ".nan" + "    colour: 1\n    lobe: {weight: 7,\n      exponent: -3}\nambient: [0, 0.1, x]\n",
        ".json": """{"camera": {"type": "plane", "eye": [0, 0, 4], "window_half": 1},
 "spheres": [{"name": "A", "center": [0, 0, 1], "radius": 1e999,
  "colour": 1, "lobe": {"weight": 7, "exponent": -3}}],
 "ambient": [0, 0.1, "x"]}""",
        ".toml": """ambient = [0, 0.1, 'x']
camera = {type = "plane", eye = [0, 0, 4], window_half = 1}
[[spheres]]
name = "A"
  center = [0, 0, 1]
  radius = -1
  colour = 1
lobe.weight = 7
lobe . exponent = -3
""",
    }
    text = texts[suffix]
    with pytest.raises(SceneError) as error:
        parse(text, "s", suffix)
    found = [re.fullmatch(r"s:(\d+):(\d+): ([^:]+): .+", line) for line in str(error.value).split("\n")]
    names = {"radius", "colour", "weight", "exponent", "ambient[2]"}
    assert {match[3].split(".")[-1] for match in found if match} == names
    assert len(found) == len(names)
    places = [(int(match[1]), int(match[2])) for match in found if match]
    assert places == sorted(places)
    for match in found:
        assert match is not None
        line = text.split("\n")[int(match[1]) - 1][int(match[2]) - 1 :]
        name = match[3].split(".")[-1]
        begins = "x" if name == "ambient[2]" else "lobe" if "lobe" in line and suffix == ".toml" else name
        assert line.lstrip("\"'").startswith(begins), (match[0], line)


@pytest.mark.parametrize("name", ["gloss", "chapter8", "room"])
def test_every_key_of_a_scene_stands_where_its_mark_says(name: str) -> None:
    document = parse_yaml(gallery.text(name), name)
    rows = gallery.text(name).split("\n")
    keys = [(path[-1], mark) for path, mark in document.marks.items() if path and isinstance(path[-1], str)]
    assert len(keys) > 30
    for key, mark in keys:
        assert rows[mark.line - 1][mark.column - 1 :].startswith(f"{key}:")
    text = json.dumps(load(name).model_dump(), indent=3)
    keys = [(path[-1], mark) for path, mark in parse_json(text, name).marks.items() if path]
    assert len(keys) > 60
    rows = text.split("\n")
    for key, mark in keys:
        row = rows[mark.line - 1]
        begin = row[mark.column - 1 :]
        assert begin.startswith(f'"{key}":') if isinstance(key, str) else row[: mark.column - 1].isspace()


def test_all_problems_are_listed_and_long_lists_cut() -> None:
    with pytest.raises(SceneError) as error:
        parse(BASE % -1 + "    colour: 1\nfloor: 3\n", "s.yaml")
    assert str(error.value).split("\n") == [
        "s.yaml:5:5: spheres[0].radius: must be > 0 and finite, got -1",
        "s.yaml:6:5: spheres[0].colour: unknown key 'colour', did you mean 'color'",
        "s.yaml:7:1: floor: must be a mapping or null, got 3",
    ]
    with pytest.raises(SceneError) as error:
        load({"camera": {"type": "plane", "eye": (0, 0, 1), "window_half": 1}, "spheres": [{}] * 50})
    assert str(error.value).split("\n")[20:] == ["... and 130 more"]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "scene.json:1:1: not valid JSON: expected a value, got the end of the text"),
        ("[]", "scene.json:1:1: must be a mapping with a camera, spheres and lights, got a list of 0 (read as JSON)"),
        ('{"name": "a",\n"name": "b"}', "scene.json:2:1: name: duplicate key, first on line 1"),
        ('{"a": NaN}', "scene.json:1:7: not valid JSON: expected a value, got 'NaN'"),
        ('{"a": Infinity}', "scene.json:1:7: not valid JSON: expected a value, got 'Infinity'"),
        ('{"ambient": [0, -1e400, 0], ' + VIEW + "}", "scene.json:1:17: ambient[1]: must be finite, got -1e400"),
        (
            '{"a": ' + "9" * 100_000 + f", {VIEW}}}",
            "scene.json:1:2: a: a number must have at most 400 characters, got 100000",
        ),
        ('{"a": 01}', "scene.json:1:8: not valid JSON: expected ',' or '}', got '1'"),
        ('{"a": 1,}', "scene.json:1:9: not valid JSON: expected a key in double quotes, got '}'"),
        ("{} x", "scene.json:1:4: not valid JSON: expected the end of the text, got 'x'"),
        ("[" * 100_000, "scene.json:1:33: nesting must be at most 32 deep"),
        ('{"a":' * 100_000, "scene.json:1:161: nesting must be at most 32 deep"),
        ("[" + "1," * 110_000 + "1]", "scene.json:1:200002: a scene file may hold at most 100000 keys and items"),
        (
            "{" + VIEW + ', "name": "\\ud800"}',
            "scene.json:1:67: name: must be text without lone surrogates, got the text '\\ud800'",
        ),
        (
            '{"a": "x',
            "scene.json:1:7: not valid JSON: a text without its closing quote, or with a bare control character",
        ),
        ('{"a": "\x01"}', "scene.json:1:7: not valid JSON: a text without its closing quote, or with a bare control"),
        ('{"a": "\\x"}', "scene.json:1:7: not valid JSON: Invalid \\escape"),
        ("name = 'x'", "scene.json:1:1: not valid JSON: expected a value, got 'name'"),
        ("{" + ",".join(f'"k{i}": 1' for i in range(99)) + "}", "scene.json:1:568: a mapping may hold at most 64 keys"),
    ],
)
def test_json_is_refused_in_one_line(text: str, said: str) -> None:
    assert message(text, ".json").startswith(said)


TOML = """\
name = "x"
camera = {type = "plane", eye = [0, 0, 4], window_half = 1}
[[spheres]]
name = "A"
center = [0, 0, 1]
radius = 1
[[spheres]]
name = "B" # a comment with = and [
center = [
  0, 0,
  1]
radius = %s
[spheres.lobe]
weight = %s
"""


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "scene.toml:1:1: must be a mapping with a camera, spheres and lights, got nothing (read as TOML)"),
        (TOML % (-1, 1), "scene.toml:12:1: spheres[1].radius: must be > 0 and finite, got -1"),
        (TOML % ("nan", 1), "scene.toml:12:1: spheres[1].radius: must be > 0 and finite, got nan"),
        (TOML % ("1e400", 1), "scene.toml:12:1: spheres[1].radius: must be > 0 and finite, got inf"),
        (TOML % ("2024-01-01", 1), "scene.toml:12:1: spheres[1].radius: must be a number, got a date"),
        (
            TOML % ("0x" + "f" * 300, 1),
            "scene.toml:12:1: spheres[1].radius: must be at most 1e12, got an integer of 1200",
        ),
        (TOML % ("9" * 100_000, 1), "scene.toml:12:10: a number or a key must have at most 400 characters, got 100000"),
        (TOML % (1, 7), "scene.toml:14:1: spheres[1].lobe.weight: must be from 0 to 1, got 7"),
        ((TOML % (-1, 1)).replace("\n", "\r\n"), "scene.toml:12:1: spheres[1].radius: must be > 0 and finite, got -1"),
        ("a" + ".a" * 20_000 + " = 1", "scene.toml:1:64: nesting must be at most 32 deep"),
        ("a = " + "[" * 5000, "scene.toml:1:37: nesting must be at most 32 deep"),
        ("a = " + "{a=" * 5000, "scene.toml:1:101: nesting must be at most 32 deep"),
        ("a = 1\nb = 2\na = 3", "scene.toml:3:1: a: duplicate key, first on line 1"),
        ("[a]\nb = 1\n[a]", "scene.toml:3:1: a: duplicate key, first on line 1"),
        ("a = {b = 1, b = 2}", "scene.toml:1:13: a.b: duplicate key, first on line 1"),
        ('"\\u0061" = 1\na = 2', "scene.toml:2:6: not valid TOML: Cannot overwrite a value"),
        ("a = = 3", "scene.toml:1:5: not valid TOML: Invalid value"),
        ("a = 2024-13-41", "scene.toml:1:9: not valid TOML: "),
        ("a = 'x", "scene.toml:1:5: not valid TOML: a text without its closing quote"),
        ('a = """' + "x\n" * 400_000, "scene.toml:1:7: not valid TOML: a text without its closing quote"),
        ('a = "' + "\\n" * 400_000 + '"', "scene.toml:1:5: a text must have at most 20000 characters"),
        ("[[a]]\n" * 5000, "scene.toml:4097:1: a: a list of tables may hold at most 4096"),
        ("".join(f"k{i} = 1\n" for i in range(100)), "scene.toml:65:1: a mapping may hold at most 64 keys"),
        ("a = [" + "1," * 110_000 + "]", "scene.toml:1:200003: a scene file may hold at most 100000 keys and items"),
        (BASE % 1, "scene.toml:1:7: not valid TOML: Expected '=' after a key in a key/value pair"),
    ],
)
def test_toml_is_refused_in_one_line(text: str, said: str) -> None:
    assert message(text, ".toml").startswith(said)


def test_toml_in_all_its_spellings_is_one_scene() -> None:
    plain = parse(TOML % (1, 0.5), "x", ".toml")
    spelled = """
    name = '''x'''
    camera.type = "plane"
    camera.eye = [ 0.0,
       0, # comment ]
       4e0 ]
    camera."window_half" = 1_0e-1
    spheres = [ {name = "A", center = [0, 0, 1], radius = +1},
      {name = 'B', center = [0, 0, 1], radius = 0x1, lobe = {weight = 5e-1}} ]
    """
    assert parse(spelled, "x", ".toml") == plain


@pytest.mark.parametrize("suffix", [".yaml", ".yml", ".YAML", ".json", ".Json", ".toml"])
def test_the_ending_chooses_the_parser(tmp_path: Path, suffix: str) -> None:
    text = json.dumps(load("gloss").model_dump()) if suffix.lower() != ".toml" else TOML % (1, 1)
    (tmp_path / f"s{suffix}").write_text(text, encoding="utf-8")
    assert isinstance(load(tmp_path / f"s{suffix}"), Scene)
    assert load(str(tmp_path / f"s{suffix}")) == load(tmp_path / f"s{suffix}")


def test_bytes_that_are_no_scene(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    path = Path("s.yaml")
    good = (BASE % 1).encode()
    for data, said in [
        (good.decode().encode("utf-16"), "s.yaml: must be UTF-8, got UTF-16 or UTF-32"),
        (good + b"# \xff\n", "s.yaml:6:3: must be UTF-8, got byte 0xff"),
        (good + b"# \0\n", "s.yaml:6:3: must be text, got a NUL byte"),
        (b"#" * (1 << 21) + b"\n", "s.yaml: a scene file may hold at most 2097152 bytes"),
    ]:
        path.write_bytes(data)
        assert file_message("s.yaml") == said
    for data in (b"\xef\xbb\xbf" + good, good.replace(b"\n", b"\r\n"), good + b"#" * ((1 << 21) - len(good))):
        path.write_bytes(data)
        assert load(path).spheres[0].name == "A"
    for suffix, text in ((".json", json.dumps(load("gloss").model_dump())), (".toml", TOML % (1, 1))):
        Path(f"s{suffix}").write_bytes(b"\xef\xbb\xbf" + text.encode())
        assert load(f"s{suffix}").spheres[0].name == "A"


def test_what_is_not_a_regular_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert file_message("none.yaml") == "none.yaml: cannot be read: No such file or directory"
    Path("d.yaml").mkdir()
    assert re.search(r"d\.yaml: (must be a regular file, got a directory|cannot be read)", file_message("d.yaml"))
    if hasattr(os, "mkfifo"):
        os.mkfifo("f.yaml")
        assert file_message("f.yaml") == "f.yaml: must be a regular file, got a device, pipe or socket"
        Path("z.yaml").symlink_to("/dev/zero")
        assert file_message("z.yaml") == "z.yaml: must be a regular file, got a device, pipe or socket"
        Path("loop.yaml").symlink_to("loop.yaml")
        assert file_message("loop.yaml").startswith("loop.yaml: cannot be read: ")
    for name in ("\0.yaml", "x" * 5000 + ".yaml", "\x1b[31m\u202e.yaml", "\ud800.yaml", "", ".", "..", "a/", "yaml"):
        assert len(file_message(name)) < 300
    Path("s.yaml").write_text("a: 1")
    Path("s.yaml").chmod(0)
    if os.geteuid() != 0:
        assert file_message("s.yaml") == "s.yaml: cannot be read: Permission denied"


def test_names_that_are_no_scene() -> None:
    assert file_message("glos").endswith(", .xml, .pbrt nor a gallery scene, did you mean 'gloss'")
    assert "chapter8" in file_message("qqqqqqqq")
    with pytest.raises(SceneError, match="must be a name, a path, a mapping or a Scene, got 3"):
        load(3)  # type: ignore[arg-type]


def test_a_gallery_name_goes_before_a_file_but_a_path_is_a_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("gloss").write_text("a: 1")
    assert load("gloss").name == "gloss"
    assert "nor a gallery scene" in file_message(Path("gloss"))


def test_standard_input(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.stdin", io.TextIOWrapper(io.BytesIO((BASE % 2).encode())))
    assert load("-").spheres[0].radius == 2
    monkeypatch.setattr("sys.stdin", io.TextIOWrapper(io.BytesIO((BASE % -2).encode())))
    with pytest.raises(SceneError, match=r"^stdin:5:5: spheres\[0\]\.radius: must be > 0"):
        load("-")


def test_dicts() -> None:
    import numpy as np

    camera = {"type": "plane", "eye": np.array([0.0, 0, 4]), "window_half": np.float32(1)}
    scene = load({"camera": camera, "spheres": ({"name": "A", "center": (0, 0, np.int64(1)), "radius": 1},)})
    assert scene == parse(BASE % 1, "x")
    assert load(scene) is scene
    deep: dict[str, object] = {}
    deep["a"] = deep
    wide: list[object] = [1] * 10
    for _ in range(20):
        wide = [wide] * 10
    for data, said in [
        ({}, "camera: missing, must be a mapping"),
        (deep, "scene: nesting must be at most 32 deep"),
        ({"a": wide}, "scene: a scene may hold at most 1048576 keys and items"),
        ({1: 2}, "scene: a key must be text, got 1"),
        ({"camera": camera, "name": b"x"}, "name: must be text, got a bytes"),
        ({"camera": {**camera, "window_half": 10**400}}, "scene: must be finite, got an integer of 1329 bits"),
        ({"camera": {**camera, "window_half": float("nan")}}, "camera.window_half: must be > 0 and finite, got nan"),
        ({"camera": {**camera, "window_half": True}}, "camera.window_half: must be a number, got true"),
        ({"camera": {**camera, "window_half": 1j}}, "camera.window_half: must be a number, got a complex"),
    ]:
        with pytest.raises(SceneError) as error:
            load(data)  # type: ignore[arg-type]
        assert str(error.value).split("\n")[0] == said


def test_loading_is_light() -> None:
    code = "import sys, symrender.scene.load as l; l.load('gloss'); print(*sys.modules)"
    modules = set(
        subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split()
    )
    assert "symrender.scene.load" in modules
    assert not modules & {"numpy", "sympy", "numba", "rich", "OpenEXR", "PIL"}


def test_as_many_spheres_as_the_limit_fit_a_file() -> None:
    sphere = "  - {name: S%d, center: [%d, 0, 1], radius: 0.3, color: [1, 0, 0]}\n"
    text = "camera: {type: plane, eye: [0, 0, 4], window_half: 1}\nspheres:\n"
    body = [sphere % (i, i) for i in range(4097)]
    assert len(parse(text + "".join(body[:4096]), "x").spheres) == 4096
    assert message(text + "".join(body)) == "scene.yaml:2:1: spheres: must hold at most 4096 entries, got 4097"
    light = "{type: point, name: L%d, position: [0, 0, %d]}"
    many = "lights: [" + ", ".join(light % (i, i) for i in range(257)) + "]"
    assert message(BASE % 1 + many) == "scene.yaml:6:1: lights: must hold at most 256 entries, got 257"
