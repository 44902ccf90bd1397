"""Exported GLSL, run by a browser, returns what its vectors prove; the vectors themselves are true and tight."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import symrender as sr
from simulator.test_formulas import RUN
from symrender.bridge.glsl import Exported, glsl
from symrender.cli import main
from symrender.errors import OptionError, OutputError, Unsupported
from symrender.leaves import values
from symrender.scene.load import load

pytest.importorskip("flint", reason="python-flint is not installed")
MIXED = {
    "shading.model": "phong",
    "shading.specular_terminator": "open",
    "floor.lobe.exponent": 3000.0,
    "spheres.A.lobe.theta_max": 1.5707963267948966,
    "spheres.A.lobe.exponent": 0.0,
}
SCENES = {"gloss": {}, "chapter8": {}, "mixed": MIXED}


def exported(name: str) -> Exported:
    return glsl(load("gloss" if name == "mixed" else name).replace(SCENES[name]))


def _call(told: dict[str, Any], vector: dict[str, Any], pixel: int) -> tuple[str, int]:
    """Statements that give the pixels from ``pixel`` on the results of one vector; ``nothing`` is a uniform 0."""
    literal = lambda x: f"(float({float(x)!r}) + nothing)"  # noqa: E731
    given = ", ".join(
        f"vec3({', '.join(map(literal, x))})" if isinstance(x, list) else literal(x) for x in vector["arguments"]
    )
    form, name = told["functions"][vector["function"]], vector["function"]
    if form["returns"] == "void":
        slots = [f"r{pixel + k}" for k in range(len(form["out"]))]
        lines = f"  float {', '.join(slots)}; {name}({given}, {', '.join(slots)});\n"
    else:
        slots = [f"r{pixel}"] if form["returns"] == "float" else [f"r{pixel}.{c}" for c in "xyz"]
        lines = f"  {form['returns']} r{pixel} = {name}({given});\n"
    lines += "".join(f"  if (at == {pixel + k}) color.x = {slot};\n" for k, slot in enumerate(slots))
    return lines, len(slots)


def returned(browser: Any, text: str, told: dict[str, Any]) -> np.ndarray:
    """What the functions of ``text`` return, in a row for every vector's every result."""
    body, pixel = "", 0
    for vector in told["vectors"]:
        lines, count = _call(told, vector, pixel)
        body, pixel = body + lines, pixel + count
    head = "#version 300 es\nprecision highp float;\nuniform float nothing;\nout vec4 color;\n"
    main = f"void main() {{\n  int at = int(gl_FragCoord.x);\n  color = vec4(0.0);\n{body}}}\n"
    page = browser.new_page()
    found = page.evaluate(RUN, [f"{head}{text}\n{main}", pixel])
    page.close()
    assert not isinstance(found, str), found
    return np.array(found)


def misses(told: dict[str, Any], found: np.ndarray) -> list[str]:
    """Functions with a result outside what its vector allows."""
    results = [(vector["function"], result) for vector in told["vectors"] for result in vector["results"]]
    assert len(results) == len(found)
    return [
        f"{name}: {x} for {r}"
        for (name, r), x in zip(results, found, strict=True)
        if not r["low"] - r["float32"] <= x <= r["high"] + r["float32"]
    ]


@pytest.mark.parametrize("name", SCENES)
def test_a_browser_returns_what_is_proved(browser: Any, name: str) -> None:
    made = exported(name)
    told = json.loads(json.dumps(made.vectors))
    found = returned(browser, made.text, told)
    assert len(found) > 100
    assert (np.abs(found) > 1e-3).mean() > 0.7
    assert misses(told, found) == []
    # and the vectors see what one wrong number does
    wrong = made.text.replace("_exponent = ", "_exponent = 1.01*").replace("shininess = ", "shininess = 1.2*")
    assert {line.split(":")[0].rsplit("_")[-1] for line in misses(told, returned(browser, wrong, told))} == {
        "lobe",
        "light",
    }


@pytest.mark.parametrize("name", SCENES)
def test_vectors_are_true_and_tight(name: str) -> None:
    told = exported(name).vectors
    seen = set()
    for vector in told["vectors"]:
        for result in vector["results"]:
            size = max(abs(result["low"]), abs(result["high"]))
            assert result["low"] <= result["high"] <= result["low"] + 1e-15 * size + 1e-40
            # a thousandth of the value, where nothing cancels
            assert result["float32"] <= 1e-2 * max(size, 0.05)
        if hasattr(values, vector["function"]):
            got = np.atleast_1d(getattr(values, vector["function"])(*vector["arguments"]))
            for x, result in zip(got, vector["results"], strict=True):
                assert x == pytest.approx(result["low"], rel=1e-9, abs=1e-12)
            seen.add(vector["function"])
    assert {"sphere_hit", "mirror_direction", "floor_hit"} <= seen


def test_guards_are_among_the_vectors() -> None:
    told = exported("gloss").vectors["vectors"]
    zeros = {v["function"] for v in told if all(r["high"] == r["low"] == r["float32"] == 0.0 for r in v["results"])}
    assert zeros == {v["function"] for v in told if v["function"].endswith(("_lobe", "_light"))}
    assert len(zeros) == 6


def test_the_rule_integrates_its_lobe() -> None:
    made = exported("gloss")
    for part in ("floor", "spheres_A"):
        block = made.text.split(f"{part}_rule[16] = vec4[16](\n")[1].split("\n);")[0]
        rows = np.array([[float(x) for x in line.strip(" ,")[5:-1].split(",")] for line in block.splitlines()])
        assert rows.shape == (16, 4)
        assert rows[:, 3].sum() == pytest.approx(1.0, abs=1e-6)
        assert np.linalg.norm(rows[:, :3], axis=1) == pytest.approx(np.ones(16), abs=1e-6)
        exponent = load("gloss").floor.lobe.exponent if part == "floor" else 128.0
        # the mean cosine of cos^n over a wide cone, which barycentres keep
        assert rows[:, 3] @ rows[:, 2] == pytest.approx((exponent + 1) / (exponent + 2), abs=1e-6)


def test_names_are_glsl_names() -> None:
    scene = load("gloss")
    data = scene.model_dump()
    data["spheres"] = [data["spheres"][0] | {"name": n} for n in ("a-_b", "a_b", "a_b-")]
    made = glsl(load(data))
    assert "__" not in made.text
    assert len({line.split()[2] for line in made.text.splitlines() if line.startswith("const vec4 spheres_")}) == 3


def test_what_is_not_written_is_refused() -> None:
    with pytest.raises(Unsupported, match="brdf_normalised is not written"):
        glsl(load("gloss").replace({"shading.lobe_units": "brdf_normalised"}))
    with pytest.raises(OptionError, match="lobe: must be from 1 to 32"):
        glsl(load("gloss"), lobe=33)


def test_python_and_the_command_line_write_the_same_files(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    made = sr.export("gloss", "glsl", tmp_path / "a.glsl", lobe=2)
    assert main(["export", "gloss", "--to", "glsl", "--lobe", "2", "--out", str(tmp_path / "b.glsl")]) == 0
    assert "b.vectors.json" in capsys.readouterr().out
    assert made.text == (tmp_path / "a.glsl").read_text() == (tmp_path / "b.glsl").read_text()
    beside = (tmp_path / "a.vectors.json").read_text()
    assert len(made.vectors["vectors"]) > 50
    assert beside == (tmp_path / "b.vectors.json").read_text()
    assert json.loads(json.dumps(made.vectors)) == json.loads(beside)
    with pytest.raises(OutputError, match=r"a\.vectors\.json: exists"):
        sr.export("gloss", "glsl", tmp_path / "a.glsl", lobe=2, force=False)
    with pytest.raises(OptionError, match=r"^form: must be one of glsl, mitsuba, pbrt, got 'hlsl'"):
        sr.export("gloss", "hlsl")
