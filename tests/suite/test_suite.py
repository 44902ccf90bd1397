"""The truth suite: every scene is right where its value is known, and its files say what they hold."""

from __future__ import annotations

import hashlib
import json
import math
from pathlib import Path

import numpy as np
import pytest

import symrender as sr
from symrender.cli import main
from symrender.errors import OptionError
from symrender.suite.write import MECHANISMS, Entry, entry, scene_of, write_suite


@pytest.mark.parametrize("name", MECHANISMS)
def test_a_scene_holds_signal_and_goes_to_a_renderer(name: str) -> None:
    made = entry(name, size=12, tol=1e-5 if name == "interreflection" else 1e-8)
    lit = (made.truth.radiance.max(axis=-1) > 0.0).mean()
    assert lit > 0.1 and made.told["rms_radiance"] > 0.01
    assert made.told["status"] == {"met": 144}
    # far from the origin, beside a contact, roundings are felt
    assert made.told["largest_error"] < {"interreflection": 1e-5, "epsilon": 1e-8}.get(name, 1e-10)
    assert (name == "interreflection") == (not made.told["derivatives"])
    assert len(made.told["mistakes_shown_after_samples"]) >= 4
    for told in made.told["derivatives"].values():
        assert told["rms"] > 1e-4 and told["met"] > 130 and told["file"] in made.files
    assert any(not told.startswith("refused") for told in made.told["exports"].values())
    assert scene_of(name).name == name and len(scene_of(name).description) > 20


def test_values_that_are_known() -> None:
    ball = entry("normalisation", size=16).truth
    inside = ball.layers["hit_class"] > 0
    assert 60 < inside.sum() < 250
    np.testing.assert_allclose(ball.radiance[inside], np.tile([0.25, 0.5, 1.0], (inside.sum(), 1)), rtol=1e-13)
    np.testing.assert_allclose(ball.radiance[~inside], 1.0, rtol=0)
    # under the lamp, a ray straight down: rho/pi I/h^2
    below = sr.probe(scene_of("falloff"), rays=((0.3, 0.2, 0.4), (0, 0, -1)), tol=1e-9).radiance[0, 0]
    assert below == pytest.approx(0.8 / math.pi * 2 / 0.5**2, rel=1e-13)
    # towards the sun: rho/pi E
    sun = -np.array([-1, 0.35, -0.3])
    sun /= np.linalg.norm(sun)
    facing = sr.probe(scene_of("cosine"), rays=(2 * sun, -sun), tol=1e-9).radiance[0]
    np.testing.assert_allclose(facing, np.array([0.9, 0.6, 0.3]) * 3 / math.pi, rtol=1e-13)


def test_its_files_agree_and_are_the_same_again(tmp_path: Path) -> None:
    heard: list[Entry] = []
    written = write_suite(tmp_path / "one", ["falloff", "masking"], size=8, done=heard.append)
    again = write_suite(tmp_path / "two", ["masking", "falloff"], size=8)
    assert [p.relative_to(tmp_path / "one") for p in written] == [p.relative_to(tmp_path / "two") for p in again]
    assert all(a.read_bytes() == b.read_bytes() for a, b in zip(written, again, strict=True))
    assert [e.name for e in heard] == ["falloff", "masking"]
    manifest = json.loads((tmp_path / "one" / "suite.json").read_text())
    told = manifest["scenes"]["falloff"]
    folder = tmp_path / "one" / told["folder"]
    scene = sr.load(str(folder / "scene.yaml"))
    assert told["scene_hash"] == scene.hash and told["folder"] == f"falloff-{scene.hash[:12]}"
    assert hashlib.sha256((folder / "truth.npz").read_bytes()).hexdigest() == told["truth_sha256"]
    exact, single = sr.read_image(folder / "truth.npz"), sr.read_image(folder / "truth.exr")
    text = json.loads((folder / "truth.json").read_text())
    assert exact.radiance.max() > 0.1
    np.testing.assert_array_equal(np.array(text["radiance"]), exact.radiance)
    np.testing.assert_array_equal(single.radiance, exact.radiance.astype(np.float32))
    mean, variance = (sr.read_image(folder / f"falloff_{part}.exr").radiance for part in ("ref_rgb", "ref_rgb_var"))
    np.testing.assert_array_equal(mean, single.radiance)
    error = np.repeat(exact.layers["error"][..., None], 3, axis=2)
    np.testing.assert_allclose(variance, (error**2).astype(np.float32), rtol=1e-6)
    assert (folder / "mitsuba" / "scene.xml").exists() and (folder / "pbrt" / "scene.pbrt").exists()
    assert manifest["scenes"]["masking"]["exports"]["pbrt"].startswith("refused: materials.steel.masking: pbrt")


def test_the_verb_writes_it_and_refuses_in_a_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["suite", "silhouette", "--size", "8", "-o", "here"]) == 0
    out = capsys.readouterr().out
    assert "silhouette: what is in front; error at most" in out and "files below here" in out
    assert main(["suite", "silhouette", "--size", "8", "-o", "here"]) == 74
    assert "here" in capsys.readouterr().err
    assert main(["suite", "caustic"]) == 2
    assert capsys.readouterr().err.startswith("ERROR scene: must be one of cosine, epsilon, falloff")
    assert not (tmp_path / "suite").exists()
    with pytest.raises(OptionError, match="must be one of"):
        scene_of("../../gallery/metal")
