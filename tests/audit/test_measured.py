"""What renderers hand over is read as it was meant, and refused in one line where it means nothing."""

from __future__ import annotations

import io
import zipfile
from pathlib import Path

import numpy as np
import pytest

from symrender.audit.measured import measured, of_seeds
from symrender.errors import ImageError, OptionError, SymrenderError
from symrender.images.exr import XYZ_OF_RGB
from symrender.images.image import Image

N = 64


def drawn(seed: int = 1) -> np.ndarray:
    """Samples (N, h, w, 3) of a positive light."""
    return np.random.default_rng(seed).gamma(2.0, 0.25, (N, 6, 8, 3))


def test_second_moments_of_every_spelling_are_one_variance(tmp_path: Path) -> None:
    x = drawn()
    true = x.var(axis=0, ddof=1) / N
    mean, second = x.mean(axis=0), (x**2).mean(axis=0)
    spellings = (
        {"radiance": mean, "m2_radiance": second},
        {"nested": mean, "m2_nested": second, "radiance": mean * 0 + 1},
        {"radiance": mean, "Variance": x.var(axis=0, ddof=1)},
        {"radiance": mean, "variance": x.var(axis=0, ddof=1)},
    )
    for k, layers in enumerate(spellings):
        found = measured([Image(layers)], N)
        assert np.abs(found.variance / true - 1).max() < 1e-10
        assert np.array_equal(found.mean, mean) and found.freedom == N - 1
        Image(layers).save(tmp_path / f"{k}.exr")
        again = measured([tmp_path / f"{k}.exr"], N)
        assert np.abs(again.variance / true - 1).max() < 1e-3


def test_the_moment_integrator_writes_xyz(tmp_path: Path) -> None:
    """Mitsuba's channels are nested.X, nested.Y, nested.Z and m2_nested.X ...; the truth is turned into them."""
    rgb = drawn()
    xyz = rgb @ XYZ_OF_RGB.T
    layers = {"radiance": rgb.mean(axis=0)}
    for c, letter in enumerate("XYZ"):
        layers |= {f"nested.{letter}": xyz.mean(axis=0)[..., c], f"m2_nested.{letter}": (xyz**2).mean(axis=0)[..., c]}
    Image(layers).save(tmp_path / "moment.exr")
    found = measured([tmp_path / "moment.exr"], N)
    assert found.channels == ("X", "Y", "Z")
    assert np.abs(found.of(rgb.mean(axis=0)) - found.mean).max() < 1e-6
    assert np.abs(found.variance / (xyz.var(axis=0, ddof=1) / N) - 1).max() < 1e-3


def test_white_is_mitsubas_white() -> None:
    # what Mitsuba 3.9.1 wrote for radiance 1, 1, 1
    assert XYZ_OF_RGB.sum(axis=1) == pytest.approx([0.950456, 1.0, 1.088754], abs=1e-6)


def test_seeds() -> None:
    x = drawn()[:8]
    found = measured([Image({"radiance": image}) for image in x])
    assert found.source == "seeds" and found.freedom == 7
    assert np.abs(found.variance - x.var(axis=0, ddof=1) / 8).max() < 1e-15
    with pytest.raises(ImageError, match="images 1 and 8 are equal"):
        of_seeds(np.concatenate([x[:7], x[:1]]))


def test_rounding_of_single_precision_is_no_variance() -> None:
    """A noiseless pixel whose 32-bit second moment lies a little below its square is no fault, a real one is."""
    mean = np.full((6, 8, 3), np.float32(0.7), dtype=np.float64)
    second = (mean.astype(np.float32) ** 2).astype(np.float64) * (1 - 2.0**-23)
    found = measured([Image({"radiance": mean, "m2_radiance": second})], N)
    assert (found.variance > 0).all() and (np.sqrt(found.variance) < 2e-4 * mean).all()
    with pytest.raises(ImageError, match="below the squared mean"):
        measured([Image({"radiance": mean, "m2_radiance": second * 0.9})], N)


def spoilt(value: float) -> Image:
    x = drawn()
    mean = x.mean(axis=0)
    mean[2, 3, 1] = value
    return Image({"radiance": mean, "m2_radiance": (x**2).mean(axis=0)})


@pytest.mark.parametrize(
    ("renders", "samples", "message"),
    [
        ([], 64, "at least one"),
        ([spoilt(np.nan)], 64, r"first at \(3, 2\)"),
        ([spoilt(np.inf)], 64, "1 values are NaN, infinite"),
        ([spoilt(1e200)], 64, "beyond 1e100"),
        ([spoilt(0.5)], 0, "samples: must be the samples a pixel.*got none"),
        ([spoilt(0.5)], 3, "got 3"),
        ([Image({"radiance": np.ones((4, 4, 3))})], 64, "neither second moments"),
        ([Image({"radiance": np.ones((4, 4, 3)), "Variance": -np.ones((4, 4, 3))})], 64, "must not be negative"),
        ([Image({"radiance": np.ones((4, 4, 3))})] * 3, 64, "8 to 1024 seeds, got 3"),
        ([Image({"depth": np.ones((4, 4))})] * 8, 64, "no layer 'radiance'"),
        (
            [*[Image({"radiance": np.ones((4, 4, 3))})] * 7, Image({"radiance": np.ones((4, 5, 3))})],
            64,
            "is 5 x 4 pixels, the first render 4 x 4",
        ),
    ],
)
def test_what_means_nothing_is_refused(renders: list[Image], samples: int, message: str) -> None:
    with pytest.raises(SymrenderError, match=message) as refused:
        measured(renders, samples)
    assert "\n" not in str(refused.value) and refused.value.exit_code == 2


def _bomb() -> bytes:
    """An archive whose array claims 2^40 numbers."""
    stream, array = io.BytesIO(), io.BytesIO()
    np.lib.format.write_array_header_1_0(array, {"descr": "<f8", "fortran_order": False, "shape": (1 << 20, 1 << 20)})
    with zipfile.ZipFile(stream, "w") as archive:
        archive.writestr("radiance.npy", array.getvalue())
    return stream.getvalue()


@pytest.mark.parametrize(
    ("name", "data", "message"),
    [
        ("bomb.npz", _bomb(), "exceed max_pixels"),
        ("torn.npz", _bomb()[:40], "not a readable NPZ"),
        ("torn.exr", b"v/1\x01" + bytes(60), "not a readable EXR|needed"),
        ("empty.exr", b"", "not a readable EXR"),
        ("render.png", b"\x89PNG\r\n\x1a\n", "not a readable PNG|rounded to 8 bits"),
        ("render.tiff", b"II*\0", "must end in"),
    ],
    # an archive holds the time it was made, which no two workers' names of a test may
    ids=["bomb.npz", "torn.npz", "torn.exr", "empty.exr", "render.png", "render.tiff"],
)
def test_hostile_files_are_refused(name: str, data: bytes, message: str, tmp_path: Path) -> None:
    (tmp_path / name).write_bytes(data)
    with pytest.raises(ImageError, match=message) as refused:
        measured([tmp_path / name], 64)
    assert "\n" not in str(refused.value)


def test_a_picture_is_no_measurement(tmp_path: Path) -> None:
    Image({"radiance": np.full((4, 4, 3), 0.5)}).save(tmp_path / "a.png")
    with pytest.raises(ImageError, match="rounded to 8 bits"):
        measured([tmp_path / "a.png"], 64)


def test_more_seeds_than_fit_are_refused() -> None:
    with pytest.raises(OptionError, match="1024"):
        measured([Image({"radiance": np.ones((1, 1, 3))})] * 1025)


def test_a_render_that_tells_its_samples_need_not_be_told(tmp_path: Path) -> None:
    values = drawn()
    layers = {"radiance": values.mean(axis=0), "m2_radiance": (values**2).mean(axis=0)}
    for name in ("told.npz", "told.exr"):
        Image(layers, {"samples": str(len(values))}).save(tmp_path / name)
        found = measured([tmp_path / name])
        assert found.samples == len(values) >= 16 and found.source == "moments"
        assert np.allclose(found.variance, values.var(axis=0, ddof=1) / len(values), rtol=1e-4)
    for told in ("", "many", "-4", "9" * 40, "٣٢"):
        Image(layers, {"samples": told}).save(tmp_path / "untold.npz")
        with pytest.raises(OptionError, match=r"samples: must be the samples a pixel"):
            measured([tmp_path / "untold.npz"])
