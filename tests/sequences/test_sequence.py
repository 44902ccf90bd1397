"""Sweeps and animations: interrupted anywhere they go on, and every file is the one of an undisturbed run."""

from __future__ import annotations

import csv
import hashlib
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from symrender.errors import OptionError, OutputError, Unsupported
from symrender.execution.fill import Means
from symrender.gradient import gradient
from symrender.images.image import read_image
from symrender.images.srgb import encode_srgb
from symrender.render import render
from symrender.scene.load import load
from symrender.sequences.animate import animate
from symrender.sequences.makers import Rendered, Sloped
from symrender.sequences.orbit import orbit
from symrender.sequences.over import parse_over
from symrender.sequences.sheet import MAX_SHEET, contact_sheet
from symrender.sequences.sweep import sweep
from symrender.settings import Settings

SCENE = load("gloss")
OVER = parse_over("floor.lobe.exponent=4:64:2,lights.key.radius=0:1:3")
MAKER = Rendered(Settings(width=40, height=30, lobe=2))


class Stop(Exception):
    pass


def hashes(folder: Path) -> dict[str, str]:
    return {p.name: hashlib.sha256(p.read_bytes()).hexdigest() for p in folder.iterdir() if p.suffix != ".csv"}


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("whole")
    assert len(sweep(SCENE, OVER, MAKER, folder)) == 6
    return folder


def test_a_sweep_is_its_frames_a_table_and_a_sheet(whole: Path) -> None:
    names = {f"frame_{k:05d}_{side}.exr" for k in range(6) for side in ("numeric", "symbolic")}
    assert {p.name for p in whole.iterdir()} == names | {"ledgers.csv", "contact_sheet.png"}
    with (whole / "ledgers.csv").open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [float(row["lights.key.radius"]) for row in rows] == [0.0, 0.5, 1.0] * 2
    changes = {"floor.lobe.exponent": 64.0, "lights.key.radius": 0.5}
    pair = render(SCENE.replace(changes), size=(40, 30), lobe=2)
    assert pair.numeric is not None and pair.symbolic is not None
    for side, image in (("numeric", pair.numeric), ("symbolic", pair.symbolic)):
        held = read_image(whole / f"frame_00004_{side}.exr")
        assert np.array_equal(held.radiance, image.radiance.astype(np.float32))
        assert held.meta["scene_hash"] == SCENE.replace(changes).hash
    compared = pair.ledger.comparisons["radiance"].whole
    assert float(rows[4]["radiance_rmse"]) == compared.rmse > 0.001
    assert int(rows[4]["numeric_evaluations"]) == pair.ledger.pipelines[0].timing.evaluations
    sheet = read_image(whole / "contact_sheet.png")
    assert sheet.width == 3 * 166 + 6, "the last range runs across"


@pytest.mark.parametrize("count", [1, 3, 5])
def test_an_interrupted_sweep_goes_on(tmp_path: Path, whole: Path, count: int) -> None:
    means = Means(patience=0.0)

    def stop(done: int, total: int, label: str) -> None:
        if done == count:
            raise Stop

    with pytest.raises(Stop):
        sweep(SCENE, OVER, MAKER, tmp_path, means=means, progress=stop)
    with pytest.raises(OptionError, match="--resume continues it, --restart discards it"):
        sweep(SCENE, OVER, MAKER, tmp_path, means=means)
    with pytest.raises(OptionError, match="lobe was 2 in the interrupted run and is 3 now"):
        sweep(SCENE, OVER, Rendered(replace(MAKER.settings, lobe=3)), tmp_path, means=replace(means, start="resume"))
    with pytest.raises(OptionError, match=r"(frames|over|scene) was"):
        sweep(SCENE, OVER[:1], MAKER, tmp_path, means=replace(means, start="resume"))
    victim = tmp_path / "frame_00000_numeric.exr"
    victim.write_bytes(victim.read_bytes()[:-1] + b"?")
    before = {p.name: p.stat().st_mtime_ns for p in tmp_path.glob("*.exr")}
    sweep(SCENE, OVER, MAKER, tmp_path, means=replace(means, start="resume"))
    assert hashes(tmp_path) == hashes(whole)
    again = [name for name, when in before.items() if (tmp_path / name).stat().st_mtime_ns != when]
    assert sorted(again) == ["frame_00000_numeric.exr", "frame_00000_symbolic.exr"], "only the damaged frame is redone"


def test_restart_discards_the_frames_of_an_interrupted_sweep(tmp_path: Path) -> None:
    means = Means(patience=0.0)

    def stop(done: int, total: int, label: str) -> None:
        raise Stop

    with pytest.raises(Stop):
        sweep(
            SCENE, OVER, replace(MAKER, settings=replace(MAKER.settings, lobe=3)), tmp_path, means=means, progress=stop
        )
    few = parse_over("floor.lobe.exponent=4:64:2")
    sweep(SCENE, few, MAKER, tmp_path, means=replace(means, start="restart"))
    assert len(list(tmp_path.glob("*.exr"))) == 4 and not list(tmp_path.glob("*.journal"))
    alone = render(SCENE.replace({"floor.lobe.exponent": 4.0}), size=(40, 30), lobe=2).symbolic
    assert alone is not None
    held = read_image(tmp_path / "frame_00000_symbolic.exr")
    assert np.array_equal(held.radiance, alone.radiance.astype(np.float32))
    with pytest.raises(OutputError, match="exists; --force"):
        sweep(SCENE, few, MAKER, tmp_path, means=means)


def test_a_sweep_never_replaces_a_file_unasked(tmp_path: Path, whole: Path) -> None:
    (tmp_path / "frame_00003_numeric.exr").write_bytes(b"mine")
    with pytest.raises(OutputError, match=r"exists; --force"):
        sweep(SCENE, OVER, MAKER, tmp_path)
    assert [p.name for p in tmp_path.iterdir()] == ["frame_00003_numeric.exr"]
    sweep(SCENE, OVER, MAKER, tmp_path, force=True)
    assert hashes(tmp_path) == hashes(whole)


# the reader of the library leaves its pipes to the garbage collector
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning", "ignore::ResourceWarning")
@pytest.mark.parametrize("video", ["mp4", "webm"])
def test_an_animation_has_every_frame(tmp_path: Path, video: str) -> None:
    encoder = pytest.importorskip("imageio_ffmpeg")
    maker = Rendered(Settings(width=41, height=30, lobe=2, numeric="none"))
    rows = animate(orbit(SCENE, 4), maker, tmp_path, video=video, rate=12.0)  # type: ignore[arg-type]
    assert len(rows) == 4
    assert {p.name for p in tmp_path.iterdir()} == {
        f"animation_symbolic.{video}", *(f"frame_{k:05d}_symbolic.png" for k in range(4))
    }  # fmt: skip
    reader = encoder.read_frames(str(tmp_path / f"animation_symbolic.{video}"))
    facts = next(reader)
    pictures = [np.frombuffer(data, dtype=np.uint8).reshape(30, 42, 3) for data in reader]
    assert facts["size"] == (42, 30) and facts["fps"] == 12.0 and len(pictures) == 4
    stills = [
        encode_srgb(read_image(tmp_path / f"frame_{k:05d}_symbolic.png").radiance).astype(float) for k in range(4)
    ]
    for k, picture in enumerate(pictures):
        away = [float(np.sqrt(np.mean((picture[:, :41] - still) ** 2))) for still in stills]
        assert away[k] < 20 and all(other > 40 for n, other in enumerate(away) if n != k), "lossy, but this frame"


def test_what_cannot_be_encoded_is_refused_before_anything_is_rendered(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    maker = Rendered(Settings(width=8, height=8, lobe=1, numeric="none"))
    for rate in (0.0, -1.0, 241.0, float("nan"), float("inf")):
        with pytest.raises(OptionError, match="rate: must be a number in"):
            animate(orbit(SCENE, 2), maker, tmp_path / "a", rate=rate, video="none")
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    with pytest.raises(Unsupported, match=r"pip install 'imageio-ffmpeg"):
        animate(orbit(SCENE, 2), maker, tmp_path / "a")
    assert not (tmp_path / "a").exists()
    animate(orbit(SCENE, 2), maker, tmp_path / "a", video="none")
    assert len(list((tmp_path / "a").iterdir())) == 2


def test_a_sweep_of_gradients_is_those_of_its_scenes(tmp_path: Path) -> None:
    name, over = "spheres.A.center.x", parse_over("spheres.A.center.x=0.0:0.05:2")
    scene = load(
        {
            "name": "one_ball",
            "camera": {"type": "look_at", "eye": [0.3, -4, 2], "target": [0, -0.6, 0], "fov": 26},
            "spheres": [{"name": "A", "center": [0, 0.4, 0.8], "radius": 0.3}],
            "floor": {"texture": {"type": "solid"}, "lobe": {"weight": 1, "exponent": 16}},
            "ambient": [1, 1, 1],
            "shading": {"ka": 1, "kd": 0, "ks": 0},
        }
    )
    split = Settings(width=12, height=9, numeric="none", symbolic="chambers", tol=1e-3)
    rows = sweep(scene, over, Sloped(split, (name, "camera.eye")), tmp_path)
    stems = [f"gradient_{n}" for n in (name, "camera.eye.x", "camera.eye.y", "camera.eye.z")]
    assert {p.name for p in tmp_path.iterdir()} == {
        "ledgers.csv",
        *(f"contact_sheet_{stem}.png" for stem in stems),
        *(f"frame_{k:05d}_{stem}.exr" for stem in stems for k in range(2)),
    }
    # what is asked for together is refined together
    alone = gradient(scene.replace({name: 0.05}), [name, "camera.eye"], size=(12, 9), tol=1e-3)[name]
    held = read_image(tmp_path / f"frame_00001_{stems[0]}.exr")
    assert np.abs(alone.layer("gloss")).max() > 0.1, "the reflection moves"
    assert np.array_equal(held.layer("gloss"), alone.layer("gloss").astype(np.float32))
    assert rows[1][f"{name}_largest_error"] == alone.layer("error").max()
    sheet = read_image(tmp_path / f"contact_sheet_{stems[0]}.png")
    pixels = encode_srgb(sheet.radiance).astype(int)
    assert (pixels[..., 0] - pixels[..., 2]).max() > 60 and (pixels[..., 2] - pixels[..., 0]).max() > 60, "red and blue"


def test_a_long_sequence_is_shown_in_part(whole: Path) -> None:
    file = whole / "frame_00000_numeric.exr"
    sheet = contact_sheet([lambda: read_image(file)] * (MAX_SHEET + 50), [["a" * 500]] * (MAX_SHEET + 50))
    assert sheet.caption.startswith(f"{MAX_SHEET} of {MAX_SHEET + 50} frames")
    assert sheet.pixels.shape[1] == 20 * 166 + 6
