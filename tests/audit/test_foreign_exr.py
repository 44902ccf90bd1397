"""EXR files as other programs write them: windows, primaries, 16-bit floats, metadata, and what is refused."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import OpenEXR
import pytest

from symrender.audit.audit import audit
from symrender.cli import main
from symrender.errors import ImageError
from symrender.images.exr import XYZ_OF_RGB
from symrender.images.image import Image, read_image
from symrender.scene.load import AnyScene, load_any
from symrender.truth import truth

CASES = Path(__file__).resolve().parents[1] / "data" / "cases" / "exr"
SIZE = 32
XYZ = (1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1 / 3, 1 / 3)
ACES = (0.7347, 0.2653, 0.0, 1.0, 0.0001, -0.077, 0.32168, 0.33767)
DISPLAY_P3 = (0.68, 0.32, 0.265, 0.69, 0.15, 0.06, 0.3127, 0.329)
P3_OF_RGB = np.array([[0.8224620, 0.1775380, 0.0], [0.0331942, 0.9668058, 0.0], [0.0170826, 0.0723974, 0.9105199]])
"""Linear Display P3 of linear sRGB, as CSS Color 4 lists it."""


@pytest.fixture(scope="module")
def known() -> tuple[AnyScene, Image]:
    scene = load_any(CASES / "scene.yaml")
    return scene, truth(scene, size=SIZE, tol=1e-8)


def written(path: Path, rgb: Any, kind: Any = np.float32, **header: Any) -> Path:
    channels = {c: np.ascontiguousarray(rgb[..., k].astype(kind)) for k, c in enumerate("RGB")}
    OpenEXR.File({"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage, **header}, channels).write(
        str(path)
    )
    return path


@pytest.mark.parametrize(
    ("name", "judged"),
    [
        ("whole", 1024), ("y_only", 1024), ("decreasing_y", 1024), ("comment_latin1", 1024), ("log_with_nul", 1024),
        ("rgba_half", 1024), ("crop_window", 256),
    ],
)  # fmt: skip
def test_a_right_render_passes(name: str, judged: int, known: tuple[AnyScene, Image]) -> None:
    scene, true = known
    verdict = audit(CASES / f"{name}.exr", scene, truth=true, noise_free=True)
    # beside the terminator of the ball roundings of 32 bits are felt
    assert verdict.passed and verdict.pixels.judged + verdict.pixels.aside == judged and verdict.pixels.aside < 20
    assert all("\0" not in text for text in read_image(CASES / f"{name}.exr").meta.values())


def test_windows_are_placed(known: tuple[AnyScene, Image], tmp_path: Path) -> None:
    scene, true = known
    # a window that reaches over the left and lower edge, with wrong light where nobody looks
    wide = np.pad(true.radiance, ((0, 4), (4, 0), (0, 0)), constant_values=7.0)
    shown = ((0, 0), (SIZE - 1, SIZE - 1))
    path = written(tmp_path / "over.exr", wide[8:, :25], dataWindow=((-4, 8), (20, 35)), displayWindow=shown)
    image = read_image(path)
    assert image.radiance.shape == (SIZE, SIZE, 3) and image.meta["data_window"] == "0 8 20 31"
    held = np.zeros((SIZE, SIZE), dtype=bool)
    held[8:, :21] = True
    assert np.array_equal(np.isfinite(image.radiance).all(axis=-1), held)
    assert np.array_equal(image.radiance[held], true.radiance[held].astype(np.float32))
    verdict = audit(path, scene, truth=true, noise_free=True)
    assert verdict.passed and verdict.pixels.judged + verdict.pixels.aside == held.sum() > 24 * verdict.pixels.aside
    wide[20, 10] *= 1.01
    written(path, wide[8:, :25], dataWindow=((-4, 8), (20, 35)), displayWindow=shown)
    assert not audit(path, scene, truth=true, noise_free=True, explain=False).passed
    # whole, and more than that
    written(path, np.pad(true.radiance, ((3, 3), (3, 3), (0, 0))), dataWindow=((-3, -3), (34, 34)), displayWindow=shown)
    assert "data_window" not in read_image(path).meta and audit(path, scene, truth=true, noise_free=True).passed
    written(path, wide[:4, :4], dataWindow=((40, 40), (43, 43)), displayWindow=shown)
    with pytest.raises(ImageError, match="lies outside its display window"):
        read_image(path)
    written(path, wide[:4, :4], dataWindow=((0, 0), (3, 3)), displayWindow=((0, 0), (1 << 20, 1 << 20)))
    with pytest.raises(ImageError, match="pixels exceed max_pixels"):
        read_image(path)


@pytest.mark.parametrize("kind", [np.float32, np.float16])
@pytest.mark.parametrize(("primaries", "matrix"), [(XYZ, XYZ_OF_RGB), (DISPLAY_P3, P3_OF_RGB)])
def test_primaries_are_converted(
    primaries: tuple[float, ...], matrix: Any, kind: Any, known: tuple[AnyScene, Image], tmp_path: Path
) -> None:
    scene, true = known
    path = written(tmp_path / "a.exr", true.radiance @ matrix.T, kind, chromaticities=primaries)
    assert audit(path, scene, truth=true, noise_free=True).passed
    plain = written(tmp_path / "b.exr", true.radiance @ matrix.T, kind)
    # the light of the scene is white, which other primaries of the same white leave as it is
    assert audit(plain, scene, truth=true, noise_free=True, explain=False).passed == (primaries == DISPLAY_P3)
    coloured = np.full((4, 4, 3), (0.7, 0.2, 0.05))
    read = read_image(written(path, coloured @ matrix.T, kind, chromaticities=primaries)).radiance
    assert np.abs(read - coloured).max() < (2e-5 if kind == np.float32 else 2e-3)


def test_primaries_of_another_white_are_refused(tmp_path: Path) -> None:
    path = written(tmp_path / "a.exr", np.ones((4, 4, 3)), chromaticities=ACES)
    with pytest.raises(ImageError, match="only colours with the white of sRGB, and CIE XYZ, are read"):
        read_image(path)


def test_half_floats_are_off_by_half_a_unit_in_the_last_place(known: tuple[AnyScene, Image], tmp_path: Path) -> None:
    scene, true = known
    path = written(tmp_path / "a.exr", true.radiance, np.float16)
    assert audit(path, scene, truth=true, noise_free=True).passed
    off = true.radiance.copy()
    off[16, 16] *= 1 + 3 * 2.0**-10
    written(path, off, np.float16)
    assert not audit(path, scene, truth=true, noise_free=True, explain=False).passed, "three units are not half of one"


def _several(path: Path) -> None:
    one = {c: np.ones((4, 4), dtype=np.float32) for c in "RGB"}
    parts = [OpenEXR.Part({"name": name, "type": OpenEXR.scanlineimage}, dict(one)) for name in "ab"]
    OpenEXR.File(parts).write(str(path))


@pytest.mark.parametrize(
    ("make", "told"),
    [
        (lambda path: path.write_bytes((CASES / "deep.exr").read_bytes()), "a flat EXR is needed, got a deep one"),
        (_several, "an EXR of one part is needed, got 2 parts"),
    ],
    ids=["deep", "parts"],
)
def test_what_is_no_flat_image_is_refused_in_a_line(
    make: Callable[[Path], object], told: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "a.exr"
    make(path)
    assert main(["audit", str(path), "--scene", str(CASES / "scene.yaml"), "--noise-free"]) == 2
    err = capsys.readouterr().err
    assert told in err and str(path) in err and len(err.splitlines()) == 1
