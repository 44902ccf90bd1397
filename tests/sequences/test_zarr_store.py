"""Frames in a Zarr store: the reference reader finds the very doubles; interrupted and refused as files are."""

from __future__ import annotations

import hashlib
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml

from symrender.cli import main
from symrender.errors import OptionError, OutputError
from symrender.execution.fill import Means
from symrender.images.srgb import encode_srgb
from symrender.render import render
from symrender.scene.load import load
from symrender.sequences.makers import Rendered
from symrender.sequences.over import frames, parse_over
from symrender.sequences.sweep import sweep
from symrender.sequences.zarr_store import STORE, ZarrStore
from symrender.settings import Settings

SCENE = load("gloss")
OVER = parse_over("floor.lobe.exponent=4:64:2,lights.key.radius=0:1:3")
MAKER = Rendered(Settings(width=20, height=15, lobe=2))
CHANGES = {"floor.lobe.exponent": 64.0, "lights.key.radius": 0.5}


def hashes(folder: Path) -> dict[str, str]:
    files = (p for p in folder.rglob("*") if p.is_file() and p.suffix != ".csv")
    return {p.relative_to(folder).as_posix(): hashlib.sha256(p.read_bytes()).hexdigest() for p in files}


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("whole")
    assert len(sweep(SCENE, OVER, MAKER, folder, store="zarr")) == 6
    return folder


def test_the_reference_reader_finds_the_very_doubles(whole: Path) -> None:
    zarr = pytest.importorskip("zarr")
    group = zarr.open_group(str(whole / STORE), mode="r")
    pair = render(SCENE.replace(CHANGES), size=(20, 15), lobe=2)
    assert pair.numeric is not None and pair.symbolic is not None
    layers = {
        f"{side}_{name}" for side, i in (("numeric", pair.numeric), ("symbolic", pair.symbolic)) for name in i.layers
    }
    assert set(group.array_keys()) == layers | set(CHANGES)
    for side, image in (("numeric", pair.numeric), ("symbolic", pair.symbolic)):
        for name, values in image.layers.items():
            held = group[f"{side}_{name}"]
            assert held.shape == (2, 3, *values.shape) and held.dtype == np.float64
            assert np.array_equal(held[1, 1], values)
            dimensions = ("floor.lobe.exponent", "lights.key.radius", "y", "x", "channel")
            assert held.metadata.dimension_names == dimensions[: held.ndim]
            assert not np.isnan(held[...]).any() and held.attrs["method"] == image.meta["method"]
    assert np.ptp(group["numeric_radiance"][:, :, 5, 5, 0]) > 0.0
    assert list(group["floor.lobe.exponent"][:]) == [4.0, 64.0] and list(group["lights.key.radius"][:]) == [
        0.0,
        0.5,
        1.0,
    ]
    first = SCENE.replace({"floor.lobe.exponent": 4.0, "lights.key.radius": 0.0})
    assert load(yaml.safe_load(group.attrs["scene"])).hash == first.hash
    assert group.attrs["varied"] == list(CHANGES)


def test_its_own_reader_and_the_sheet_see_the_same(whole: Path, tmp_path: Path) -> None:
    assert {p.name for p in whole.iterdir()} == {STORE, "ledgers.csv", "contact_sheet.png"}
    made = frames(SCENE, OVER)
    pair = render(SCENE.replace(CHANGES), size=(20, 15), lobe=2)
    assert pair.symbolic is not None
    kept = ZarrStore(whole, OVER, made[0].scene).read(made[4], "symbolic")
    assert np.array_equal(kept.radiance, pair.symbolic.radiance) and encode_srgb(kept.radiance).max() > 100
    sweep(SCENE, OVER, MAKER, tmp_path)
    assert (tmp_path / "contact_sheet.png").read_bytes() == (whole / "contact_sheet.png").read_bytes()


class Stop(Exception):
    pass


@pytest.mark.parametrize("count", [2, 4])
def test_an_interrupted_store_goes_on(tmp_path: Path, whole: Path, count: int) -> None:
    means = Means(patience=0.0)

    def stop(done: int, total: int, label: str) -> None:
        if done == count:
            raise Stop

    with pytest.raises(Stop):
        sweep(SCENE, OVER, MAKER, tmp_path, store="zarr", means=means, progress=stop)
    resume = replace(means, start="resume")
    with pytest.raises(OptionError, match=r"form was zarr in the interrupted run and is \.exr now"):
        sweep(SCENE, OVER, MAKER, tmp_path, means=resume)
    victim = tmp_path / STORE / "symbolic_gloss" / "c" / "0" / "0" / "0" / "0" / "0"
    victim.write_bytes(victim.read_bytes()[:-1])
    before = {p: p.stat().st_mtime_ns for p in (tmp_path / STORE).rglob("0") if p.is_file()}
    sweep(SCENE, OVER, MAKER, tmp_path, store="zarr", means=resume)
    assert hashes(tmp_path) == hashes(whole)
    again = {p.relative_to(tmp_path).parts[1] for p, when in before.items() if p.stat().st_mtime_ns != when}
    assert "symbolic_gloss" in again and "floor.lobe.exponent" not in again


def test_what_stands_is_replaced_only_when_asked_and_only_if_it_is_ours(tmp_path: Path, whole: Path) -> None:
    few = parse_over("floor.lobe.exponent=4:8:2")
    sweep(SCENE, few, MAKER, tmp_path, store="zarr")
    before = hashes(tmp_path)
    (tmp_path / "contact_sheet.png").unlink()
    (tmp_path / "ledgers.csv").unlink()
    with pytest.raises(OutputError, match=r"frames\.zarr: exists; --force"):
        sweep(SCENE, OVER, MAKER, tmp_path, store="zarr")
    assert {k: v for k, v in before.items() if STORE in k} == hashes(tmp_path)
    sweep(SCENE, OVER, MAKER, tmp_path, store="zarr", force=True)
    assert hashes(tmp_path) == hashes(whole), "nothing is left of the smaller one"
    about = tmp_path / STORE / "zarr.json"
    about.write_text(json.dumps({"zarr_format": 3, "node_type": "group", "attributes": {}}))
    with pytest.raises(OutputError, match="is no sequence of symrender"):
        sweep(SCENE, OVER, MAKER, tmp_path, store="zarr", force=True)
    (tmp_path / STORE).rename(tmp_path / "mine")
    (tmp_path / STORE).symlink_to(tmp_path / "mine")
    with pytest.raises(OutputError, match="symbolic link"):
        sweep(SCENE, OVER, MAKER, tmp_path, store="zarr", force=True)


def test_the_command_line(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    over = ["--over", "lights.key.radius=0:1:2", "--size", "8", "--store", "zarr"]
    assert main(["sweep", "chapter8", "--what", "truth", "--tol", "1e-3", *over, "--out", str(tmp_path)]) == 0
    assert {"truth_radiance", "truth_error", "truth_status"} <= {p.name for p in (tmp_path / STORE).iterdir()}
    assert "wrote 2 frames" in capfd.readouterr().out
    assert main(["sweep", "chapter8", *over, "--out", str(tmp_path)]) == 74
    assert "exists; --force" in capfd.readouterr().err
