"""The command line and radiometric scenes: what is written, what is printed, what is refused with exit 2."""

from __future__ import annotations

import contextlib
import io
import json
from pathlib import Path

import numpy as np
import pytest

import symrender as sr
from symrender.cli import main


def run(*words: str) -> tuple[int, str, str]:
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        code = main(list(words))
    return code, out.getvalue(), err.getvalue()


def test_truth_and_render_write_their_files(tmp_path: Path) -> None:
    code, out, _ = run("truth", "metal", "--size", "24x12", "--layers", "error", "-o", str(tmp_path))
    assert code == 0 and "288 pixels; missed their tolerance: none" in out and "W/(m2 sr)" in out
    image = sr.read_image(tmp_path / "truth.npz")
    assert {"emitted", "direct", "indirect", "radiance", "error", "status", "hit_class"} <= set(image.layers)
    assert image.layer("radiance").max() > 0.1
    again = run("truth", str(tmp_path / "truth.exr"), "--size", "24x12", "-o", str(tmp_path / "again"))
    assert again[0] == 0
    same = sr.read_image(tmp_path / "again" / "truth.npz")
    np.testing.assert_array_equal(same.layer("radiance"), image.layer("radiance"))
    code, out, _ = run("render", "metal", "--size", "24x12", "--views", "-o", str(tmp_path / "pair"))
    assert code == 0 and "flips 0" in out
    written = {path.name for path in (tmp_path / "pair").iterdir()}
    assert {"numeric.exr", "symbolic.exr", "difference.png", "numeric_hit_class.png"} <= written
    assert "numeric_gloss.png" not in written


def test_probe_prints_what_comes_back_along_rays() -> None:
    ray = "0,-9.5,3.1,0,9.5,-2.5"
    code, out, _ = run("probe", "metal", "--ray", ray, "--ray", "0,0,5,0,0,1", "--json")
    rows = json.loads(out)
    assert code == 0 and [row["shape"] for row in rows] == ["shapes.C", "nothing"]
    found = sr.probe("metal", rays=([0, -9.5, 3.1], [0, 9.5, -2.5]))
    assert rows[0]["radiance"] == found.radiance[0].tolist() and min(rows[0]["radiance"]) > 0
    code, out, _ = run("probe", "metal", "--ray", ray)
    assert code == 0 and "W/(m2 sr)  met, shapes.C" in out
    for words, told in ((("--ray", "1,2,3"), "six numbers"), ((), "give points"), (("-p", "1,2"), "radiometric")):
        code, _, err = run("probe", "metal", *words)
        assert code == 2 and told in err and len(err.strip().splitlines()) == 1


def test_probe_refuses_along_rays_what_it_does_not_know() -> None:
    ray = ("probe", "metal", "--ray", "0,-9.5,3.1,0,9.5,-2.5")
    code, out, err = run(*ray, "--certify")
    assert code == 2 and not out
    assert "certify: does not know radiometric scenes yet" in err and len(err.strip().splitlines()) == 1


def test_probe_tells_derivatives_along_rays() -> None:
    ray, name = "0,-9.5,3.1,0,9.5,-2.5", "lights.key.intensity.g"
    code, out, _ = run("probe", "metal", "--ray", ray, "--wrt", f"{name},camera.fov", "--json")
    row = json.loads(out)[0]
    found = row["gradient"]
    assert code == 0 and found[name]["value"][1] > 1e-6 and found["camera.fov"]["value"] == [0.0, 0.0, 0.0]
    assert found[name]["status"] == "met" and 0 < found[name]["error"] < 1e-9
    code, out, _ = run("probe", "metal", "--ray", ray, "--wrt", name)
    assert code == 0 and f"\n  d/d {name}: 0 " in out
    code, _, err = run("probe", "metal", "--ray", ray, "--wrt", "lights.kee.intensity.g")
    assert code == 2 and "kee" in err


def test_a_probed_ray_names_its_convention_and_what_it_is_made_of() -> None:
    code, out, _ = run("probe", "metal", "--ray", "0,-9.5,3.1,0,9.5,-2.5", "--json")
    (row,) = json.loads(out)
    assert code == 0 and row["convention"] == "radiometric" and min(row["direct"]) > 0
    for channel in range(3):
        parts = row["emitted"][channel] + row["direct"][channel] + row["indirect"][channel]
        assert row["radiance"][channel] == parts


def test_scenes_and_params_list_them() -> None:
    code, out, _ = run("scenes")
    assert code == 0 and "metal " in out
    code, out, _ = run("scenes", "--show", "metal")
    assert code == 0 and "units: radiometric" in out
    code, out, _ = run("params", "metal", "--json")
    assert code == 0 and any(p["name"] == "materials.gold05.alpha" for p in json.loads(out))


@pytest.mark.parametrize(
    "words",
    [
        ("gradient", "mirror", "--wrt", "camera.fov", "--size", "4", "--filter", "box"),
        ("expression", "metal"),
        ("simulator", "metal"),
        ("study", "convergence", "metal"),
        ("sweep", "metal", "--over", "camera.fov=20:30:2"),
        ("animate", "metal", "--orbit", "4"),
        ("truth", "metal", "--size", "4", "--verify", "0.5"),
        ("truth", "mirror", "--size", "4", "--filter", "box"),
        ("render", "gloss", "--size", "4", "--filter", "box"),
        ("truth", "metal", "--size", "4", "--layers", "chambers"),
        ("render", "metal", "--size", "4", "-D", "bounces=all"),
    ],
)
def test_other_verbs_refuse_with_one_line_and_exit_2(words: tuple[str, ...], tmp_path: Path, monkeypatch) -> None:  # type: ignore[no-untyped-def]
    monkeypatch.chdir(tmp_path)
    code, _, err = run(*words)
    assert code == 2, err
    assert len(err.strip().splitlines()) == 1, err
    assert "radiometric" in err or "is not yet integrated" in err or "filter: box" in err
    assert not list(tmp_path.rglob("*.png"))
