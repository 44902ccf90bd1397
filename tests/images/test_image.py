"""Images keep their numbers, tell what they cannot keep, and read other programs' files without trust."""

from __future__ import annotations

import io
import json
import pickle
import struct
import sys
import zipfile
import zlib
from pathlib import Path

import numpy as np
import PIL.Image
import pytest

from symrender.errors import ImageError, NonFiniteError, OptionError, OutputError
from symrender.images import exr, npz
from symrender.images.image import Image, read_image
from symrender.images.picture import CLASSES, colors
from symrender.images.views import false_color, gloss_view, hit_class_view

RNG = np.random.default_rng(20)


def some_image(height: int = 6, width: int = 9) -> Image:
    rgb = RNG.random((3, height, width, 3)) * 1.5
    classes = RNG.integers(0, 5, (height, width))
    layers = {"radiance": rgb[0], "direct": rgb[1], "gloss": rgb[2], "hit_class": classes, "error": rgb[0, ..., 0]}
    return Image(layers, {"scene": "name: ☃\n", "settings": '{"seed": 7}', "seed": str((1 << 63) - 1)})


def test_thousand_small_images_come_back_bit_equal_in_float32() -> None:
    rng = np.random.default_rng(5)
    signal = 0.0
    for k in range(1000):
        height, width = rng.integers(1, 9, 2)
        bits = rng.integers(0, 1 << 32, (height, width, 3), dtype=np.uint32)
        values = bits.view(np.float32) if k % 2 else rng.standard_normal((height, width, 3)).astype(np.float32)
        classes = rng.integers(0, 1 << 24, (height, width))
        with np.errstate(invalid="ignore"):
            wide = values.astype(float)
        layers, meta = exr.decode(exr.encode({"radiance": wide, "hit_class": classes.astype(float)}, {}), 99)
        assert set(layers) == {"radiance", "hit_class"} and meta == {}
        same = layers["radiance"].astype(np.float32)
        nan = np.isnan(values)
        assert np.array_equal(np.isnan(same), nan)
        assert np.array_equal(same.view(np.uint32)[~nan], values.view(np.uint32)[~nan])
        assert np.array_equal(layers["hit_class"], classes)
        signal += float(np.count_nonzero(values))
    assert signal > 10_000


@pytest.mark.parametrize("view", ["transposed", "reversed", "every other", "channels first"])
def test_arrays_that_are_not_contiguous_are_written_right(view: str, tmp_path: Path) -> None:
    base = RNG.random((12, 12, 3))
    array = {
        "transposed": base.transpose(1, 0, 2),
        "reversed": base[::-1, ::-1],
        "every other": base[::2, 1::2],
        "channels first": np.moveaxis(np.ascontiguousarray(np.moveaxis(base, -1, 0)), 0, -1),
    }[view]
    Image({"radiance": array}).save(tmp_path / "a.exr")
    assert np.array_equal(read_image(tmp_path / "a.exr").radiance, array.astype(np.float32))


@pytest.mark.parametrize("dtype", [np.uint8, np.uint32, np.int64, np.bool_, np.float16, np.float32])
def test_number_types_are_widened_exactly(dtype: type) -> None:
    array = np.arange(12).reshape(3, 4).astype(dtype)
    image = Image({"status": array})
    assert image.layers["status"].dtype == np.float64 and np.array_equal(image.layers["status"], array)


@pytest.mark.parametrize("ending", ["exr", "npz", "png"])
def test_image_can_be_rendered_again_from_the_file_alone(ending: str, tmp_path: Path) -> None:
    image = some_image()
    assert image.save(tmp_path / f"a.{ending}").bytes == (tmp_path / f"a.{ending}").stat().st_size
    back = read_image(tmp_path / f"a.{ending}")
    assert back.recipe() == ("name: ☃\n", {"seed": 7})
    assert back.meta == image.meta


def test_npz_is_exact_and_equal_images_give_equal_bytes(tmp_path: Path) -> None:
    image = some_image()
    image.save(tmp_path / "a.npz")
    image.save(tmp_path / "b.npz")
    back = read_image(tmp_path / "a.npz")
    assert set(back.layers) == set(image.layers)
    assert all(np.array_equal(back.layers[name], layer) for name, layer in image.layers.items())
    assert (tmp_path / "a.npz").read_bytes() == (tmp_path / "b.npz").read_bytes()
    with np.load(tmp_path / "a.npz") as archive:
        assert np.array_equal(archive["radiance"], image.radiance)


def test_png_is_the_clipped_exr_within_half_a_step(tmp_path: Path) -> None:
    image = some_image(16, 16)
    saved = image.save(tmp_path / "a.png")
    over = (image.radiance > 1).any(axis=-1).sum()
    assert 50 < over < 256 and saved.clipped == over
    back = read_image(tmp_path / "a.png").radiance
    inverse = np.where(
        image.radiance.clip(0, 1) <= 0.0031308,
        image.radiance * 12.92,
        1.055 * image.radiance.clip(0, 1) ** (1 / 2.4) - 0.055,
    )
    shown = np.asarray(PIL.Image.open(tmp_path / "a.png"), dtype=float)
    assert np.abs(shown - 255 * inverse).max() <= 0.5 + 1e-9
    assert np.abs(back - image.radiance.clip(0, 1)).max() < 0.005


def test_nan_is_kept_shown_and_never_a_png(tmp_path: Path) -> None:
    radiance = np.full((2, 3, 3), 0.25)
    radiance[1, 2, 0] = np.nan
    radiance[0, 1] = np.inf
    image = Image({"radiance": radiance})
    for ending in ("exr", "npz"):
        image.save(tmp_path / f"a.{ending}")
        assert np.array_equal(read_image(tmp_path / f"a.{ending}").radiance, radiance, equal_nan=True)
    with pytest.raises(NonFiniteError, match=r"2 non-finite pixels .* \(1, 0\), \(2, 1\)"):
        image.save(tmp_path / "a.png")
    assert not (tmp_path / "a.png").exists()
    shown = np.asarray(PIL.Image.open(io.BytesIO(image._repr_png_())))
    assert shown[1, 2].tolist() == [255, 0, 255] == shown[0, 1].tolist()
    assert shown[0, 0].tolist() == [137, 137, 137]
    bundle, metadata = image._repr_mimebundle_()
    assert bundle["image/png"].startswith(b"\x89PNG") and "2 non-finite pixels" in metadata["image/png"]["alt"]


def test_alt_text_of_an_all_nan_image() -> None:
    assert "6 non-finite pixels" in Image({"radiance": np.full((2, 3, 3), np.nan)}).alt_text()


def test_value_float32_cannot_hold_is_refused_not_infinite(tmp_path: Path) -> None:
    image = Image({"radiance": np.full((1, 1, 3), 1e39)})
    with pytest.raises(ImageError, match=r"layer radiance: 3 values exceed 32-bit float .* \.npz"):
        image.save(tmp_path / "a.exr")
    image.save(tmp_path / "a.npz")
    assert read_image(tmp_path / "a.npz").radiance[0, 0, 0] == 1e39


def test_array_protocol_follows_numpy_2() -> None:
    image = some_image()
    assert np.shares_memory(np.asarray(image), image.radiance)
    assert not np.shares_memory(np.array(image, copy=True), image.radiance)
    assert np.asarray(image, dtype=np.float32).dtype == np.float32
    with pytest.raises(ValueError, match="copy"):
        np.array(image, dtype=np.float32, copy=False)


def test_image_is_frozen_and_survives_pickling() -> None:
    image = some_image()
    with pytest.raises(ValueError, match="read-only"):
        image.radiance[0, 0, 0] = 1
    with pytest.raises(TypeError):
        image.layers["radiance"] = image.radiance  # type: ignore[index]
    back = pickle.loads(pickle.dumps(image))  # noqa: S301
    assert np.array_equal(back.radiance, image.radiance) and back.meta == image.meta


@pytest.mark.parametrize(
    ("layers", "meta", "message"),
    [
        ({}, {}, "has no layers"),
        ({"radiance": np.zeros((2, 2, 4))}, {}, r"must have shape \(h, w, 3\) or \(h, w\), got \(2, 2, 4\)"),
        ({"radiance": np.zeros((0, 2, 3))}, {}, r"got \(0, 2, 3\)"),
        ({"radiance": np.zeros((2, 2, 3)), "error": np.zeros((3, 2))}, {}, "differ in size: radiance 2x2, error 2x3"),
        ({"radiance": np.zeros((2, 2, 3), dtype=complex)}, {}, "must hold real numbers, got complex128"),
        ({"a\nb": np.zeros((2, 2))}, {}, "layer name must be"),
        ({"error": np.zeros((2, 2))}, {"seed": 7}, "metadata seed must be Unicode text"),
        ({"error": np.zeros((2, 2))}, {"scene": "a\0b"}, "metadata scene must be Unicode text without NUL"),
        ({"error": np.zeros((2, 2))}, {"scene": "\ud800"}, "metadata scene must be Unicode text"),
        ({"error": np.zeros((2, 2))}, {"a b": ""}, "metadata name must be"),
    ],
)
def test_wrong_layers_are_refused(layers: dict[str, np.ndarray], meta: dict[str, str], message: str) -> None:
    with pytest.raises(ImageError, match=message):
        Image(layers, meta)


def test_missing_layer_lists_those_there_are() -> None:
    with pytest.raises(ImageError, match="has no layer 'radiance', it has error"):
        _ = Image({"error": np.zeros((2, 2))}).radiance


@pytest.mark.parametrize(
    ("meta", "message"),
    [
        ({}, "no scene and no settings"),
        ({"scene": "x"}, "carries no settings"),
        ({"scene": "x", "settings": "[1]"}, "not a JSON object"),
        ({"scene": "x", "settings": "{"}, "not a JSON object"),
        ({"scene": "x", "settings": "[" * 100_000}, "not a JSON object"),
    ],
)
def test_incomplete_recipe_is_refused(meta: dict[str, str], message: str) -> None:
    with pytest.raises(ImageError, match=message):
        Image({"error": np.zeros((2, 2))}, meta).recipe()


def foreign_exr(path: Path, channels: dict[str, np.ndarray], **header: object) -> Path:
    import OpenEXR

    OpenEXR.File({"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage} | header, channels).write(
        str(path)
    )
    return path


def test_exr_of_another_program(tmp_path: Path) -> None:
    rgb = RNG.random((3, 4, 5)).astype(np.float16)
    grey = RNG.random((4, 5)).astype(np.float32)
    ids = np.arange(20, dtype=np.uint32).reshape(4, 5)
    colour = {"R": rgb[0], "G": rgb[1], "B": rgb[2], "A": grey, "n.R": grey, "n.G": grey, "n.B": grey, "id": ids}
    path = foreign_exr(tmp_path / "a.exr", colour, comments="theirs", scene="not ours")
    image = read_image(path)
    assert set(image.layers) == {"radiance", "A", "n", "id"}
    assert np.array_equal(image.radiance, np.moveaxis(rgb.astype(float), 0, -1))
    assert np.array_equal(image.layers["id"], ids)
    assert image.meta["exr.comments"] == "theirs" and "scene" not in image.meta
    luminance = read_image(foreign_exr(tmp_path / "y.exr", {"Y": grey}))
    assert np.array_equal(luminance.radiance, np.repeat(grey.astype(float)[..., None], 3, axis=-1))


def test_exr_cut_anywhere_is_refused_in_one_line(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    data = exr.encode(some_image().layers, {})
    refused = 0
    for cut in range(0, len(data), 37):
        (tmp_path / "a.exr").write_bytes(data[:cut])
        with pytest.raises(ImageError, match=r"a\.exr: ") as caught:
            read_image(tmp_path / "a.exr")
        assert "\n" not in str(caught.value)
        refused += 1
    assert refused > 20
    capfd.readouterr()


def png_header(width: int, height: int, depth: int = 8, kind: int = 2) -> bytes:
    def chunk(name: bytes, body: bytes) -> bytes:
        return struct.pack(">I", len(body)) + name + body + struct.pack(">I", zlib.crc32(name + body))

    header = chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, depth, kind, 0, 0, 0))
    return b"\x89PNG\r\n\x1a\n" + header + chunk(b"IDAT", zlib.compress(b"\0" * 10)) + chunk(b"IEND", b"")


def npz_header(shape: tuple[int, ...], dtype: str = "<f8") -> bytes:
    head = io.BytesIO()
    np.lib.format.write_array_header_1_0(head, {"descr": dtype, "fortran_order": False, "shape": shape})
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as archive:
        archive.writestr("radiance.npy", head.getvalue())
    return stream.getvalue()


@pytest.mark.parametrize(
    ("name", "data", "message"),
    [
        ("a.png", png_header(1 << 30, 1 << 30), "1073741824 x 1073741824 pixels exceed max_pixels"),
        ("a.png", png_header(4, 4, depth=16), "16-bit colour PNG is not read"),
        ("a.png", png_header(40, 40), "not a readable PNG"),
        ("a.png", b"", "its header is missing"),
        ("a.png", b"\x89PNG\r\n\x1a\n" + b"x" * 40, "its header is missing"),
        ("a.npz", npz_header((1 << 40, 1 << 40)), "exceed max_pixels"),
        ("a.npz", npz_header((2, 2, 1 << 40)), r"must be \(h, w, 3\) or \(h, w\)"),
        ("a.npz", npz_header((2, 2), "|O"), "real numbers"),
        ("a.npz", npz_header((2, 2)), "not a readable NPZ"),
        ("a.npz", b"PK", "not a readable NPZ"),
        ("a.exr", b"nope" * 20, "not a readable EXR"),
        ("a.exr", b"", "not a readable EXR"),
        ("a.jpg", b"", r"must end in \.exr, \.npz or \.png"),
    ],
)
def test_hostile_files_are_refused_before_they_are_decoded(
    name: str, data: bytes, message: str, tmp_path: Path
) -> None:
    (tmp_path / name).write_bytes(data)
    with pytest.raises(ImageError, match=message) as caught:
        read_image(tmp_path / name)
    assert "\n" not in str(caught.value)


def test_pickle_in_an_npz_is_never_loaded(tmp_path: Path) -> None:
    np.savez(tmp_path / "a.npz", radiance=np.array([[{"a": 1}]], dtype=object))
    with pytest.raises(ImageError, match="real numbers"):
        read_image(tmp_path / "a.npz")


@pytest.mark.parametrize("ending", ["exr", "npz", "png"])
def test_size_cap_is_the_callers(ending: str, tmp_path: Path) -> None:
    some_image(6, 9).save(tmp_path / f"a.{ending}")
    assert read_image(tmp_path / f"a.{ending}", max_pixels=54).width == 9
    with pytest.raises(ImageError, match="9 x 6 pixels exceed max_pixels 53"):
        read_image(tmp_path / f"a.{ending}", max_pixels=53)


def test_what_is_not_a_file_is_refused(tmp_path: Path) -> None:
    (tmp_path / "folder.png").mkdir()
    with pytest.raises(ImageError, match="is not a regular file"):
        read_image(tmp_path / "folder.png")
    with pytest.raises(ImageError, match="no such file"):
        read_image(tmp_path / "none.png")
    with pytest.raises(ImageError):
        read_image(tmp_path / "a\0b.png")
    with pytest.raises(ImageError, match="must end in"):
        some_image().save(tmp_path / "a.tif")
    with pytest.raises(OutputError, match="exists"):
        some_image().save(some_image().save(tmp_path / "a.exr").path, force=False)


@pytest.mark.parametrize("mode", ["L", "LA", "P", "RGB", "RGBA", "1", "I;16"])
def test_png_of_another_program_is_decoded_to_linear(mode: str, tmp_path: Path) -> None:
    if mode == "I;16":
        picture = PIL.Image.fromarray(np.full((2, 3), 188 * 257, dtype=np.uint16))
    else:
        picture = PIL.Image.new("RGBA", (3, 2), (188, 188, 188, 128)).convert(mode)
    picture.save(tmp_path / "a.png")
    image = read_image(tmp_path / "a.png")
    expected = {"1": 1.0}.get(mode, ((188 / 255 + 0.055) / 1.055) ** 2.4)
    bright = image.radiance.max()
    assert (image.width, image.height) == (3, 2)
    assert bright == pytest.approx(expected, rel=1e-12)
    assert ("alpha" in image.layers) == (mode in ("LA", "RGBA", "P"))


def test_metadata_longer_than_a_compressed_text_chunk_may_be(tmp_path: Path) -> None:
    text = "a: 1\n" * 300_000
    image = Image({"radiance": np.zeros((1, 1, 3))}, {"scene": text})
    for ending in ("exr", "npz", "png"):
        image.save(tmp_path / f"a.{ending}")
        assert read_image(tmp_path / f"a.{ending}").meta["scene"] == text


def test_metadata_of_a_foreign_npz_must_be_an_object() -> None:
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as archive:
        archive.writestr("meta.json", json.dumps([1]))
    with pytest.raises(ImageError, match="not an object"):
        npz.decode(stream.getvalue(), 10)


def test_views_show_what_their_captions_say() -> None:
    classes = np.array([[0, 1, 2], [8, 9, np.nan]])
    image = Image({"hit_class": classes, "gloss": np.full((2, 3, 3), 0.03), "error": np.arange(6.0).reshape(2, 3)})
    shown = hit_class_view(image).pixels
    palette = colors(CLASSES)
    assert shown[0].tolist() == palette[:3].tolist()
    assert shown[1, 0].tolist() == palette[8].tolist() and shown[1, 1].tolist() == palette[2].tolist()
    assert shown[1, 2].tolist() == [255, 0, 255]
    gloss = gloss_view(image)
    assert gloss.caption == "gloss term x 32" and int(gloss.pixels[0, 0, 0]) == 250
    scale = false_color(image, "error")
    assert scale.pixels[0, 0].tolist() == [0x44, 0x01, 0x54] and scale.pixels[1, 2].tolist() == [0xFD, 0xE7, 0x25]
    assert "0 to yellow 5" in scale.caption
    flat = false_color(Image({"error": np.zeros((2, 2))}), "error")
    assert (flat.pixels == [0x44, 0x01, 0x54]).all()


def test_an_image_is_a_tensor_of_its_radiance() -> None:
    image = some_image()
    taken = np.from_dlpack(image)
    assert taken.shape == (6, 9, 3) and taken.max() > 0.5
    assert np.array_equal(taken, image.radiance)
    assert not np.shares_memory(taken, image.radiance)


def test_an_image_is_a_dataset_of_its_layers() -> None:
    pytest.importorskip("xarray", reason="xarray is not installed")
    image = some_image()
    found = image.to_xarray()
    assert set(found.data_vars) == set(image.layers) and found.attrs == dict(image.meta)
    assert found["radiance"].dims == ("y", "x", "channel") and found["error"].dims == ("y", "x")
    assert np.array_equal(found["radiance"].sel(y=2.5, x=8.5, channel="g"), image.radiance[2, 8, 1])


def test_without_xarray_the_line_that_installs_it_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "xarray", None)
    with pytest.raises(OptionError, match="pip install xarray"):
        some_image().to_xarray()
