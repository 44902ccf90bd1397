"""Passed, failed, undecided: what the truth cannot decide at a renderer's precision accuses nobody, and receipts are
read."""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import cache
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

import symrender as sr
from symrender.audit.measured import measured
from symrender.cli import main
from symrender.errors import ImageError, OptionError
from symrender.images.image import Image
from symrender.scene.load import AnyScene

LAMP_SEEN = Path(__file__).resolve().parents[1] / "data" / "cases" / "lamp_of_radiance_1.3.yaml"
SIZE = (25, 16)
MIDDLE = 12
"""The column whose centres look at x = BESIDE."""
BESIDE = 1e-7
"""SubPixel an edge for 64 bits and on it for 32."""
Truths = Callable[[str], tuple[AnyScene, Image]]


def edged(sun: str = "directional") -> dict[str, object]:
    """A floor from above, half of it in the shadow of a wall: its edge is x = 0, sub_pixel which pixels look."""
    light: dict[str, object] = {"type": "directional", "name": "sun", "direction": [1, 0, -1], "irradiance": 3}
    if sun == "point":
        light = {"type": "point", "name": "sun", "position": [-4, 0, 4], "intensity": 60}
    return {
        "units": "radiometric", "name": "edged", "bounces": 0,
        "camera": {"type": "look_at", "eye": [BESIDE, 0, 6], "target": [BESIDE, 0, 0], "up": [0, 1, 0], "fov": 30},
        "materials": {"clay": {"type": "diffuse", "reflectance": 0.5, "two_sided": True}},
        "shapes": [
            {"type": "plane", "name": "floor", "point": [0, 0, 0], "normal": [0, 0, 1], "material": "clay"},
            {"type": "rectangle", "name": "wall", "corner": [-2, -9, 0], "edge_u": [0, 18, 0], "edge_v": [0, 0, 2],
             "material": "clay"},
        ],
        "lights": [light],
    }  # fmt: skip


@cache
def known() -> tuple[AnyScene, Image]:
    scene = sr.load(edged())
    return scene, sr.truth(scene, size=SIZE, tol=1e-9)


def changed(factor: float, column: int = MIDDLE, row: int | slice = slice(None), **meta: str) -> Image:
    """The truth with one column multiplied, or its dark side's value turned into the lit one's."""
    _, true = known()
    radiance = true.radiance.copy()
    radiance[row, column] = factor * radiance[row, MIDDLE + 2]
    return Image({"radiance": radiance}, meta)


def test_the_scene_has_its_edge_where_pixels_look() -> None:
    _, true = known()
    green = true.radiance[8, :, 1]
    assert green[MIDDLE + 1] > 0.1 and green[MIDDLE - 1] == 0.0
    assert (true.layers["hit_class"] == 1).mean() > 0.5


def test_either_side_of_an_edge_within_reach_passes() -> None:
    scene, true = known()
    for factor in (0.0, 1.0, 0.4):
        verdict = sr.audit(changed(factor), scene, truth=true, noise_free=True)
        assert verdict.verdict == "passed" and verdict.passed and verdict.exit_code == 0, factor
        assert verdict.pixels.aside >= SIZE[1] and (verdict.maps["aside"][:, MIDDLE] == 1).all()
        shown = {(b.column, b.row): b for b in verdict.sub_pixel}
        middle = shown[MIDDLE, 8]
        assert middle.low.max() < 1e-9 and middle.high.min() == pytest.approx(true.radiance[8, MIDDLE + 2, 0], rel=1e-3)
    # a renderer of 64 bits has no such excuse
    for factor, outcome in ((0.0, "failed"), (1.0, "passed")):
        double = changed(factor, precision="double")
        assert sr.audit(double, scene, truth=true, noise_free=True, explain=False).verdict == outcome


def test_what_lies_outside_of_its_sub_pixel_truth_leaves_an_audit_undecided(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    scene, true = known()
    verdict = sr.audit(changed(1.5, row=8), scene, truth=true, noise_free=True)
    assert verdict.verdict == "undecided" and not verdict.passed and not verdict.failed and verdict.exit_code == 3
    assert "1 of" in verdict.sentence() and f"({MIDDLE}, 8)" in verdict.sentence()
    assert verdict.as_json()["verdict"] == "undecided" and verdict.as_json()["schema"] == 2
    # sub_pixel it everything is judged as ever
    failed = sr.audit(changed(1.01, column=MIDDLE + 3), scene, truth=true, noise_free=True, explain=False)
    assert failed.verdict == "failed" and failed.exit_code == 1
    codes = []
    (tmp_path / "edged.json").write_text(json.dumps(edged()))
    true.save(tmp_path / "truth.npz")
    for image in (changed(1.0), changed(1.01, column=MIDDLE + 3), changed(1.5, row=8)):
        image.save(tmp_path / "a.npz")
        words = ["audit", str(tmp_path / "a.npz"), "--scene", str(tmp_path / "edged.json"), "--noise-free"]
        words += ["--truth", str(tmp_path / "truth.npz"), "--no-explain", "--junit", str(tmp_path / "a.xml"), "--force"]
        codes.append(main(words))
    assert codes == [0, 1, 3] and "<skipped message=" in (tmp_path / "a.xml").read_text()
    assert "set aside: " in capsys.readouterr().out
    assert main([*words[:-3], "--allow", "1e-3,1,2"]) == 2
    assert "allow: must be one or two numbers" in capsys.readouterr().err


def test_secondary_rays_that_start_off_a_surface(mutants: ModuleType) -> None:
    """Shadow rays that start .03 above the floor move a shadow's edge by as much under a lamp at 45 degrees."""
    scene = sr.load(edged("point"))
    size = (64, 64)
    true = sr.truth(scene, size=size, tol=1e-9)
    mistake = mutants.Mutant(
        "bias", "", (("reaches", "hit.place, toward", "along(hit.place, 0.03, hit.outward), toward"),)
    )
    with mutants.planted(mistake):
        image = mutants.rendered(scene, size, 1, 3, plain=True)
    off = np.abs(image.radiance - true.radiance).max(axis=-1) > 1e-3
    assert 32 <= off.sum() <= 192
    assert sr.audit(image, scene, truth=true, noise_free=True, explain=False).verdict == "failed"
    for offset in (0.03, (0.03, 0.0), (0.025, 0.01)):
        verdict = sr.audit(image, scene, truth=true, noise_free=True, ray_offset=offset)
        assert verdict.verdict == "passed" and verdict.maps["aside"][off].all()
        assert verdict.pixels.judged > 0.6 * size[0] * size[1]
    told = Image(image.layers, {"ray_offset": "0.3 0", "placed": "10 0 0 0"})
    assert sr.audit(told, scene, truth=true, noise_free=True).verdict == "passed"
    bright = Image({"radiance": 1.01 * image.radiance})
    assert sr.audit(bright, scene, truth=true, noise_free=True, ray_offset=0.03, explain=False).verdict == "failed"


def test_the_margin_is_told_where_it_decides() -> None:
    scene, true = known()
    off = Image({"radiance": 1.0005 * true.radiance})
    assert sr.audit(off, scene, truth=true, noise_free=True, explain=False).verdict == "failed"
    verdict = sr.audit(off, scene, truth=true, noise_free=True, allow=1e-3)
    assert verdict.passed and any("within the margin" in note for note in verdict.notes)
    exact = sr.audit(Image({"radiance": true.radiance}), scene, truth=true, noise_free=True)
    assert exact.passed and not any("within the margin" in note for note in exact.notes)
    light = float(true.radiance.mean())
    add = Image({"radiance": true.radiance + 1e-3 * light})
    assert sr.audit(add, scene, truth=true, noise_free=True, explain=False).verdict == "failed"
    assert sr.audit(add, scene, truth=true, noise_free=True, allow=(0.0, 2e-3 * light)).passed
    with pytest.raises(OptionError, match="allow: must be numbers from 0"):
        sr.audit(off, scene, truth=true, noise_free=True, allow=-1.0)


def test_precision_is_what_the_receipt_says() -> None:
    """A lamp of radiance 1.3 is seen in every sample: in 32 bits it is 1.2999999523, whose mean no scatter excuses."""
    scene = sr.load(LAMP_SEEN)
    true = sr.truth(scene, size=24, tol=1e-9)
    lit = true.radiance[..., 0] == 1.3
    assert lit.sum() > 20
    mean = true.radiance.astype(np.float32).astype(np.float64)
    # other pixels hold means of samples, which are no numbers of 32 bits
    mean[~lit] *= 1.0 + 1e-12
    layers = {"radiance": mean, "m2_radiance": mean**2}
    for meta, outcome in (({}, "passed"), ({"precision": "single"}, "passed"), ({"precision": "double"}, "failed")):
        found = measured([Image(layers, meta)], 4096)
        assert found.single == (outcome == "passed")
        verdict = sr.audit(Image(layers, meta), scene, truth=true, samples=4096, explain=False)
        assert verdict.verdict == outcome, meta


def test_filter_seed_and_lost_radiance_are_read(truths: Truths) -> None:
    scene, true = known()
    boxed = sr.truth(scene, size=SIZE, tol=1e-6, filter="box")
    assert np.abs(boxed.radiance - true.radiance).max() > 0.05
    render = Image({"radiance": boxed.radiance}, {"rays": "box"})
    assert sr.audit(render, scene, noise_free=True).passed
    with pytest.raises(OptionError, match="filter: the renders' receipts say box, got centre"):
        sr.audit(render, scene, noise_free=True, filter="centre")
    with pytest.raises(ImageError, match="truth: its pixels are centre, those of the renders are box"):
        sr.audit(render, scene, truth=true, noise_free=True)
    dark = Image({"radiance": true.radiance - 0.01 * (true.radiance > 0)}, {"radiance_lost": "0.02"})
    verdict = sr.audit(dark, scene, truth=true, noise_free=True)
    assert verdict.passed and any("up to 0.02, which is allowed for" in note for note in verdict.notes)
    assert sr.audit(Image(dark.layers), scene, truth=true, noise_free=True, explain=False).verdict == "failed"
    rng = np.random.default_rng(3)
    noisy = [true.radiance * (1 + 0.01 * rng.standard_normal((SIZE[1], SIZE[0], 1))) for _ in range(8)]
    seeds = [Image({"radiance": each}, {"seed": str(k % 7)}) for k, each in enumerate(noisy)]
    with pytest.raises(ImageError, match="was made with seed 0"):
        sr.audit(seeds, scene, truth=true)
    for meta, told in (
        ({"rays": "sinc"}, "rays: must be one of centre"), ({"ray_offset": "1"}, "ray_offset: must be 2 finite"),
        ({"radiance_lost": "nan"}, "radiance_lost: must be 1 finite"), ({"placed": "-1 0 0 0"}, "must be positive"),
    ):  # fmt: skip
        with pytest.raises(ImageError, match=told):
            sr.audit(Image({"radiance": true.radiance}, meta), scene, noise_free=True, tol=1e-6)


@pytest.mark.parametrize("filter", ["centre", "box"])
def test_what_an_exported_square_does_not_hold_is_set_aside(filter: str) -> None:
    """A floor seen out to its horizon, exported as a square: a render is black where the square has ended."""
    scene = sr.load(edged() | {"camera": {"type": "look_at", "eye": [0, -6, 1.5], "target": [0, 0, 0.9], "fov": 30}})
    true = sr.truth(scene, size=SIZE, tol=1e-6, filter=filter)  # type: ignore[call-overload]
    wide = sr.truth(scene, size=(8 * SIZE[0], 8 * SIZE[1]), tol=1e-6)
    rows = 1.5 / np.tan(np.radians(5.71 - np.arange(-15, 15, 0.01)))
    assert (rows > 50).any(), "the horizon is in view"
    half = 20.0
    x, y = (np.arange(n) + 0.5 for n in (8 * SIZE[0], 8 * SIZE[1]))
    forward, up, reach = (
        np.array([0, 1, -0.1]) / np.hypot(1, 0.1),
        np.array([0, 0.1, 1]) / np.hypot(1, 0.1),
        np.tan(np.radians(15)),
    )
    ways = (
        forward
        + ((2 * x / len(x) - 1)[None, :, None] * reach * SIZE[0] / SIZE[1] * np.array([1.0, 0, 0]))
        + (1 - 2 * y / len(y))[:, None, None] * reach * up
    )
    with np.errstate(divide="ignore"):
        places = np.array([0, -6, 1.5]) - 1.5 * ways / ways[..., 2:]
    gone = (wide.layers["hit_class"] == 1) & (np.abs(places[..., :2]).max(axis=-1) > half)
    cut = np.where(gone[..., None], 0.0, wide.radiance)
    if filter == "box":
        cut = cut.reshape(SIZE[1], 8, SIZE[0], 8, 3).mean(axis=(1, 3))
        kept = wide.radiance.reshape(SIZE[1], 8, SIZE[0], 8, 3).mean(axis=(1, 3))
        radiance = true.radiance + cut - kept
    else:
        gone = gone[4::8, 4::8]
        radiance = np.where(gone[..., None], 0.0, true.radiance)
    off = np.abs(radiance - true.radiance).max(axis=-1) > 1e-3
    assert 8 < off.sum() < 100
    bare = sr.audit(Image({"radiance": radiance}), scene, truth=true, noise_free=True, explain=False)
    assert bare.verdict == "failed"
    told = Image({"radiance": radiance}, {"squares": f"floor={10 * half}", "placed": "10 0 0 0"})
    verdict = sr.audit(told, scene, truth=true, noise_free=True, explain=False)
    assert verdict.maps["aside"][off].all() and not verdict.failed and verdict.verdict != "failed"
    assert verdict.pixels.judged > 250
    with pytest.raises(ImageError, match="squares: must be name=half side"):
        sr.audit(Image({"radiance": radiance}, {"squares": "floor=wide"}), scene, truth=true, noise_free=True)
