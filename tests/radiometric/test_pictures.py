"""Images as textures and as skies, and normals of vertices: against formulas written here, in NumPy."""

from __future__ import annotations

import base64
import io
import math
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import PIL.Image
import pytest
from scipy.stats import chi2

import symrender as sr
from symrender.errors import SceneError, Unsupported
from symrender.images.exr import encode
from symrender.jit.compiled import compiled
from symrender.numeric.radiometric import environment
from symrender.numeric.radiometric.pipeline import rays
from symrender.numeric.radiometric.world import World, make_world
from symrender.numeric.rays import camera_frame
from symrender.radiance.lamps import seen_radiance
from symrender.scene.dump import to_yaml
from symrender.scene.load import AnyScene, load_any, parse_any
from symrender.scene.radiometric.arrays import radiometric_arrays
from symrender.settings import Settings

Array = npt.NDArray[np.float64]
CAMERA = {"type": "look_at", "eye": [0, -5, 2], "target": [0, 0, 0.5], "up": [0, 0, 1], "fov": 39}
GREY = {"type": "diffuse", "reflectance": 0.6}


def exr(image: Array) -> str:
    return base64.b64encode(encode({"radiance": image}, {})).decode("ascii")


def png(codes: npt.NDArray[np.uint8]) -> bytes:
    stream = io.BytesIO()
    PIL.Image.fromarray(codes).save(stream, "PNG")
    return stream.getvalue()


def scene(shapes: list[dict[str, Any]], lights: list[dict[str, Any]], material: Any = None, bounces: Any = 0) -> Any:
    named = [{"name": f"S{k}", "material": "m"} | shape for k, shape in enumerate(shapes)]
    return load_any(
        {
            "units": "radiometric", "name": "pictures", "bounces": bounces, "camera": CAMERA,
            "materials": {"m": material or GREY}, "shapes": named, "lights": lights,
        }
    )  # fmt: skip


def looked(made: AnyScene, origins: Any, ways: Any, order: int = 1, seed: int = 7) -> tuple[Array, Array]:
    """(emitted, direct light) along rays."""
    d = np.array(ways, dtype=np.float64)
    d /= np.linalg.norm(d, axis=1, keepdims=True)
    o = np.ascontiguousarray(np.broadcast_to(np.array(origins, dtype=np.float64), d.shape))
    return rays(radiometric_arrays(made), o, d, order=order, seed=seed)[:2]  # type: ignore[arg-type]


def texel(image: Array, u: Array, v: Array, bilinear: bool, wrap: str) -> Array:
    """Colours of an image at (u, v), written once more: padded by three copies of itself to each side."""
    modes = {"repeat": "wrap", "clamp": "edge", "mirror": "symmetric"}
    high, wide = image.shape[:2]
    padded = np.pad(image, ((3 * high, 3 * high), (3 * wide, 3 * wide), (0, 0)), mode=modes[wrap])  # type: ignore[call-overload]
    x, y = u * wide - 0.5 + 3 * wide, v * high - 0.5 + 3 * high
    if not bilinear:
        found: Array = padded[np.floor(y + 0.5).astype(int), np.floor(x + 0.5).astype(int)]
        return found
    i, j = np.floor(x).astype(int), np.floor(y).astype(int)
    f, g = (x - i)[:, None], (y - j)[:, None]
    above = padded[j, i] * (1 - f) + padded[j, i + 1] * f
    below = padded[j + 1, i] * (1 - f) + padded[j + 1, i + 1] * f
    return np.asarray(above * (1 - g) + below * g)


SQUARE = {"type": "rectangle", "corner": [0, 0, 0], "edge_u": [2, 0, 0], "edge_v": [0, 3, 0]}
SUN = {"type": "directional", "name": "sun", "direction": [0, 0, -1], "irradiance": math.pi}
"""On a surface that lies flat a diffuse reflectance is the radiance."""


@pytest.mark.parametrize("wrap", ["repeat", "clamp", "mirror"])
@pytest.mark.parametrize("bilinear", [True, False])
def test_an_image_over_a_rectangle_is_its_texels_mixed(wrap: str, bilinear: bool) -> None:
    rng = np.random.default_rng(5)
    image = rng.random((3, 4, 3)).astype(np.float32).astype(np.float64)
    texture = {
        "type": "image", "data": exr(image), "wrap": wrap, "filter": "bilinear" if bilinear else "nearest",
        "scale": [2, -1.5], "offset": [0.3, 0.1], "rotation": 30,
    }  # fmt: skip
    places = np.column_stack([rng.uniform(0.01, 1.99, 400), rng.uniform(0.01, 2.99, 400), np.ones(400)])
    made = scene([SQUARE], [SUN], {"type": "diffuse", "reflectance": texture})
    found = looked(made, places, np.tile([0.0, 0.0, -1.0], (400, 1)))[1]
    u, v = places[:, 0] / 2, places[:, 1] / 3
    c, s = math.cos(math.radians(30)), math.sin(math.radians(30))
    expected = texel(image, 2 * (c * u - s * v) + 0.3, -1.5 * (s * u + c * v) + 0.1, bilinear, wrap)
    assert expected.std() > 0.1 and found.shape == (400, 3)
    assert np.abs(found - expected).max() < 1e-12


def test_the_mean_of_a_rectangle_is_that_of_its_image() -> None:
    """Seen from straight above, one pixel of a box filter; repeated, a bilinear image has the mean of its texels."""
    image = np.random.default_rng(6).random((4, 4, 3)).astype(np.float32).astype(np.float64)
    made = scene([{"type": "rectangle", "corner": [-1, -1, 0], "edge_u": [2, 0, 0], "edge_v": [0, 2, 0]}], [SUN],
                 {"type": "diffuse", "reflectance": {"type": "image", "data": exr(image)}})  # fmt: skip
    far = {"camera.eye": [0.0, 0.0, 1000.0], "camera.target": [0.0, 0.0, 0.0], "camera.up": [0.0, 1.0, 0.0],
           "camera.fov": math.degrees(2 * math.atan(1e-3))}  # fmt: skip
    truth = sr.truth(made.replace(far), size=1, tol=2e-3, filter="box", threads=1)
    error = truth.layer("error")[0, 0]
    assert 0.0 < error < 0.01 and image.std() > 0.2
    assert np.abs(truth.radiance[0, 0] - image.mean(axis=(0, 1))).max() <= error


def board(u: Array, v: Array) -> Array:
    """A checkerboard of two fields a unit, as Mitsuba's."""
    return np.where((u - np.floor(u) > 0.5) == (v - np.floor(v) > 0.5), 0.8, 0.1)


CHARTS: dict[str, tuple[dict[str, Any], list[list[float]], list[list[float]], list[tuple[float, float]]]] = {
    # shape, origins and directions of rays, (u, v) where they meet it
    "rectangle": (SQUARE, [[0.5, 2.0, 1]], [[0, 0, -1]], [(0.25, 2 / 3)]),
    "plane": ({"type": "plane", "point": [1, 0, 0], "normal": [0, 0, 1]}, [[1.2, 0.3, 1]], [[0, 0, -1]], [(0.2, 0.3)]),
    "sphere": (
        {"type": "sphere", "center": [0, 0, 0], "radius": 2}, [[-5, 0, 0], [0, 5, 5], [1, -5, -1]],
        [[1, 0, 0], [0, -1, -1], [0, 1, 0]],
        [(0.5, 0.5), (0.25, 0.25), (1 + math.atan2(-math.sqrt(2), 1) / math.tau, math.acos(-0.5) / math.pi)],
    ),
    "disk": (
        {"type": "disk", "center": [1, 0, 0], "normal": [0, 0, 1], "radius": 2}, [[2, 1, 1], [1, -0.5, 3]],
        [[0, 0, -1], [0, 0, -1]], [(math.sqrt(2) / 2, 0.125), (0.25, 0.75)],
    ),
    "box": (
        {"type": "box", "center": [0, 0, 0], "size": [2, 4, 6]},
        [[5, 1, 1], [-5, 1, 1], [0.5, 5, 1], [0.5, -5, 1], [0.5, 1, 5], [0.5, 1, -5]],
        [[-1, 0, 0], [1, 0, 0], [0, -1, 0], [0, 1, 0], [0, 0, -1], [0, 0, 1]],
        # Mitsuba 3.9.1's cube, looked up in its vertex_texcoords
        [(0.75, 1 / 3), (0.75, 2 / 3), (0.25, 1 / 3), (2 / 3, 0.75), (0.75, 0.75), (0.25, 0.75)],
    ),
    "triangle": ({"type": "triangle", "vertices": [[0, 0, 0], [2, 0, 0], [0, 4, 0]]}, [[0.5, 1, 1]], [[0, 0, -1]],
                 [(0.25, 0.25)]),
    "mesh": (
        {"type": "mesh", "vertices": [[0, 0, 0], [2, 0, 0], [0, 4, 0]], "faces": [[0, 1, 2]], "position": [1, 0, 0],
         "uv": [[0.1, 0.2], [0.9, 0.4], [0.3, 0.8]]}, [[1.5, 1, 1]], [[0, 0, -1]],
        [(0.5 * 0.1 + 0.25 * 0.9 + 0.25 * 0.3, 0.5 * 0.2 + 0.25 * 0.4 + 0.25 * 0.8)],
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", CHARTS)
def test_shapes_have_the_coordinates_of_mitsuba(name: str) -> None:
    """Linear in u and in v, an image tells both; seen along the light, whose cosine is that of the shape."""
    shape, origins, ways, charts = CHARTS[name]
    ramp = np.zeros((64, 64, 3))
    ramp[..., 0], ramp[..., 1] = (np.arange(64) + 0.5) / 64, ((np.arange(64) + 0.5) / 64)[:, None]
    ramp[..., 2] = 1.0
    texture = {"type": "image", "data": exr(ramp), "wrap": "clamp"}
    for origin, way, (u, v) in zip(origins, ways, charts, strict=True):
        sun = SUN | {"direction": way}
        made = scene([shape], [sun], {"type": "diffuse", "reflectance": texture, "two_sided": True})
        red, green, white = looked(made, origin, [way])[1][0]
        clipped = [min(max(x, 0.5 / 64), 63.5 / 64) for x in (u, v)]
        assert white > 0.1
        assert [red / white, green / white] == pytest.approx(clipped, abs=1e-7)


def test_a_checkerboard_is_mitsubas() -> None:
    rng = np.random.default_rng(8)
    texture = {"type": "checkerboard", "bright": 0.8, "dark": 0.1, "scale": [3, 2], "offset": [0.25, 0]}
    made = scene([SQUARE], [SUN], {"type": "diffuse", "reflectance": texture})
    places = np.column_stack([rng.uniform(0, 2, 300), rng.uniform(0, 3, 300), np.ones(300)])
    found = looked(made, places, np.tile([0.0, 0.0, -1.0], (300, 1)))[1][:, 1]
    expected = board(1.5 * places[:, 0] + 0.25, 2 / 3 * places[:, 1])
    assert 50 < (expected > 0.5).sum() < 250
    assert np.abs(found - expected).max() < 1e-12


@pytest.mark.parametrize("encoding", ["srgb", "raw"])
def test_codes_are_decoded_as_the_standard_says(encoding: str, tmp_path: Path) -> None:
    codes = np.arange(256, dtype=np.uint8).reshape(16, 16)
    (tmp_path / "codes.png").write_bytes(png(codes))
    shown = f"""
units: radiometric
bounces: 0
camera: {{type: look_at, eye: [0, -5, 2], target: [0, 0, 0.5], fov: 39}}
materials:
  m: {{type: diffuse, reflectance: {{type: image, file: codes.png, filter: nearest, encoding: {encoding}}}}}
shapes: [{{type: rectangle, name: A, corner: [0, 0, 0], edge_u: [16, 0, 0], edge_v: [0, 16, 0], material: m}}]
lights: [{{type: directional, name: sun, direction: [0, 0, -1], irradiance: {math.pi!r}}}]
"""
    (tmp_path / "a.yaml").write_text(shown)
    column, row = np.meshgrid(np.arange(16.0), np.arange(16.0))
    places = np.column_stack([column.ravel() + 0.5, row.ravel() + 0.5, np.ones(256)])
    found = looked(load_any(str(tmp_path / "a.yaml")), places, np.tile([0.0, 0.0, -1.0], (256, 1)))[1]
    x = codes.ravel() / 255
    decoded = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in x]
    assert np.abs(found[:, 0] - (x if encoding == "raw" else decoded)).max() < 1e-15


def rgbe(image: npt.NDArray[np.uint8], packed: bool) -> bytes:
    """A Radiance file of bytes (h, w, 4), its lines in runs and dumps or plain."""
    high, wide, _ = image.shape
    head = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y %d +X %d\n" % (high, wide)
    if not packed:
        return head + image.tobytes()
    lines = b""
    for row in image:
        lines += bytes([2, 2, wide >> 8, wide & 255])
        for channel in row.T:
            half = wide // 2
            lines += bytes([half, *channel[:half]]) + bytes([128 + wide - half, channel[half]])
    return head + lines


@pytest.mark.parametrize("packed", [True, False])
def test_radiance_files_are_mantissas_and_an_exponent(packed: bool, tmp_path: Path) -> None:
    rng = np.random.default_rng(9)
    image = rng.integers(128, 256, (3, 10, 4)).astype(np.uint8)
    image[..., 3] = rng.integers(120, 138, (3, 1))
    image[:, 5:] = image[:, 5:6]
    image[1, 0] = 0
    (tmp_path / "sky.hdr").write_bytes(rgbe(image, packed))
    light = {"type": "environment", "name": "e", "file": str(tmp_path / "sky.hdr"), "rows": "centres"}
    made = scene([], [light | {"filter": "nearest"}])
    angle, turn = np.meshgrid((np.arange(3) + 0.5) / 3 * np.pi, (np.arange(10) + 0.5) / 10 * math.tau, indexing="ij")
    ways = np.stack([np.sin(turn) * np.sin(angle), np.cos(turn) * np.sin(angle), np.cos(angle)], -1).reshape(-1, 3)
    found = looked(made, [0, 0, 0], ways)[0].reshape(3, 10, 3)
    expected = np.ldexp(image[..., :3].astype(float), image[..., 3:].astype(int) - 136)
    expected[1, 0] = 0.0
    assert (expected.max() / expected[expected > 0].min()) > 1e3
    assert (found == expected).all()


def sky(image: Array, ways: Array, rows: str, bilinear: bool) -> Array:
    """Radiance of a map by longitude and latitude, z up, written once more."""
    high, wide = image.shape[:2]
    u = np.arctan2(ways[:, 0], ways[:, 1]) / math.tau % 1.0
    y = np.arccos(np.clip(ways[:, 2], -1, 1)) / math.pi
    row = y * (high - 1) if rows == "corners" else y * high - 0.5
    padded = np.pad(image, ((1, 1), (1, 1), (0, 0)), mode="wrap")
    padded[0], padded[-1] = padded[1], padded[-2]
    x, y = u * wide + 0.5, row + 1.0
    if not bilinear:
        return np.asarray(padded[np.floor(y + 0.5).astype(int), np.floor(x + 0.5).astype(int)])
    i, j = np.floor(x).astype(int), np.minimum(np.floor(y).astype(int), high)
    f, g = (x - i)[:, None], (y - j)[:, None]
    upper = padded[j, i] * (1 - f) + padded[j, i + 1] * f
    return np.asarray(upper * (1 - g) + (padded[j + 1, i] * (1 - f) + padded[j + 1, i + 1] * f) * g)


MAPS = [
    {}, {"rows": "centres"}, {"filter": "nearest"}, {"filter": "nearest", "rows": "centres"},
    {"filter": "nearest", "layout": "equal_area"},
]  # fmt: skip
TURN = [[1, 0, 0], [0, 0, -1], [0, 1, 0]]


def mapped(**options: Any) -> tuple[Any, Array]:
    """A scene of a turned environment alone, dark and bright places in it, and its image."""
    rng = np.random.default_rng(3)
    image = rng.random((12, 12, 3) if options.get("layout") else (8, 16, 3)) ** 6
    image[2, 5], image[6:] = 30.0, 0.0
    image = image.astype(np.float32).astype(np.float64)
    light = {"type": "environment", "name": "e", "data": exr(image), "rotation": 33, "to_world": TURN, "scale": 2}
    return scene([], [light | options]), image


def grid(rows: int) -> tuple[Array, Array]:
    """Directions of the sphere, and the solid angle of each."""
    turn, angle = np.meshgrid((np.arange(2 * rows) + 0.5) * np.pi / rows, (np.arange(rows) + 0.5) * np.pi / rows)
    ways = np.stack([np.sin(angle) * np.cos(turn), np.sin(angle) * np.sin(turn), np.cos(angle)], -1)
    return ways.reshape(-1, 3), (np.sin(angle) * (np.pi / rows) ** 2).ravel()


@pytest.mark.parametrize("options", MAPS[:4])
def test_an_environment_is_seen_where_it_is_turned_to(options: dict[str, Any]) -> None:
    made, image = mapped(**options)
    ways = np.random.default_rng(4).normal(size=(2000, 3))
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    c, s = math.cos(math.radians(33)), math.sin(math.radians(33))
    turned = ways @ (np.array(TURN) @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]))
    expected = 2 * sky(image, turned, options.get("rows", "corners"), "filter" not in options)
    found = looked(made, [0, 0, 0], ways)[0]
    assert expected.max() > 20
    assert np.abs(found - expected).max() < 1e-11


def chosen(world: World, numbers: Array, found: Array) -> None:
    for k in range(numbers.shape[0]):
        d = environment.sky_way(world, numbers[k, 0], numbers[k, 1])
        found[k, 0], found[k, 1], found[k, 2] = d


def densities(world: World, ways: Array, found: Array) -> None:
    for k in range(ways.shape[0]):
        found[k] = environment.sky_chance(world, (ways[k, 0], ways[k, 1], ways[k, 2]))


@pytest.mark.parametrize("options", MAPS)
def test_directions_are_chosen_with_the_density_that_is_stated(options: dict[str, Any]) -> None:
    world = make_world(radiometric_arrays(mapped(**options)[0]))
    ways, shares = grid(1200)
    density = np.zeros(len(ways))
    compiled(densities, _nrt=False)(world, ways, density)
    assert (density * shares).sum() == pytest.approx(1.0, abs=2e-3)
    count = 100_000
    found = np.zeros((count, 3))
    compiled(chosen, _nrt=False)(world, np.random.default_rng(1).random((count, 2)), found)
    assert np.abs(np.linalg.norm(found, axis=1) - 1.0).max() < 1e-12

    def cells(d: Array) -> npt.NDArray[np.int64]:
        height = np.minimum(np.arccos(np.clip(d[:, 2], -1, 1)) / np.pi * 12, 11).astype(np.int64)
        return height * 24 + (np.arctan2(d[:, 1], d[:, 0]) / math.tau % 1.0 * 24).astype(np.int64) % 24

    expected = np.bincount(cells(ways), density * shares, 288) * count
    seen = np.bincount(cells(found), None, 288)
    full = expected > 10
    assert full.sum() > 100
    assert chi2.sf(((seen - expected)[full] ** 2 / expected[full]).sum(), full.sum() - 1) > 1e-4


def test_an_environment_of_one_radiance_is_a_sky() -> None:
    """What quadrature states of a sky, the sampled environment has within both errors."""
    shapes = [
        {"type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]},
        {"type": "sphere", "center": [0, 0, 1], "radius": 1},
    ]
    light = {"type": "environment", "name": "e", "data": exr(np.tile([0.5, 0.75, 1.0], (8, 16, 1))), "rotation": 20}
    options: dict[str, Any] = {"size": 4, "tol": 2e-3, "threads": 1}
    known = sr.truth(scene(shapes, [{"type": "sky", "name": "e", "radiance": [0.5, 0.75, 1.0]}]), **options)
    found = sr.truth(scene(shapes, [light]), **options)
    assert (known.layer("kind") == 1).all() if "kind" in known.layers else True
    error = known.layer("error") + found.layer("error")
    assert 0.0 < error.max() < 5e-3 and known.radiance.std() > 0.05
    assert (np.abs(known.radiance - found.radiance).max(axis=-1) <= error).all()


def test_one_bright_pixel_lights_a_floor_as_its_solid_angle_says() -> None:
    image = np.zeros((16, 32, 3))
    image[5, 7] = [400.0, 200.0, 100.0]
    light = {"type": "environment", "name": "e", "data": exr(image)}
    made = scene([{"type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}], [light])
    ways, shares = grid(1000)
    up = ways[:, 2] > 0
    seen = sky(image, ways[up], "corners", True)
    expected = 0.6 / np.pi * (seen * (shares[up] * ways[up, 2])[:, None]).sum(axis=0)
    found = np.array([looked(made, [0, 0, 1], [[0.1, 0.2, -1]], order=16, seed=k)[1][0] for k in range(16)])
    assert expected.min() > 0.3
    # the density has the image's own shape: without it some texels in a thousand would carry everything
    noise = found.std(axis=0, ddof=1) / 4
    assert (noise / expected).max() < 2e-3
    assert (np.abs(found.mean(axis=0) - expected) / noise).max() < 4


def test_light_is_linear_in_the_scale_of_an_environment() -> None:
    made, _ = mapped()
    made = made.model_copy(update={"shapes": scene([SQUARE], [SUN]).shapes})
    name = "lights.e.scale.g"
    options: dict[str, Any] = {"size": 2, "tol": 0.02, "threads": 1}
    slope, value = sr.gradient(made, [name], **options)[name], sr.truth(made, **options)
    error = 2 * slope.layer("error") + value.layer("error")
    assert value.radiance[..., 1].max() > 5 * error.max()
    assert (np.abs(2 * slope.radiance[..., 1] - value.radiance[..., 1]) <= error).all()
    assert (slope.radiance[..., 0] == 0.0).all()
    with pytest.raises(Unsupported, match=r"lights\.e\.rotation: is not yet differentiated"):
        sr.gradient(made, ["lights.e.rotation"], **options)


NORMALS = [[0.3, 0.1, 1], [-0.2, 0.3, 1], [0, -0.4, 0.9]]


@pytest.mark.parametrize("two_sided", [False, True])
def test_smooth_meshes_reflect_by_interpolated_normals(two_sided: bool) -> None:
    corners = np.array([[0, 0, 0], [2, 0, 0], [0, 2, 0]], dtype=np.float64)
    mesh = {"type": "mesh", "vertices": corners.tolist(), "faces": [[0, 1, 2]], "normals": NORMALS, "rotation": 30,
            "shading_normals": "use"}  # fmt: skip
    # from just below the face, as Mitsuba has it, some places are lit
    suns = [SUN | {"name": f"L{k}", "direction": way} for k, way in enumerate(([0.2, 0, -1], [1, -0.2, 0.1]))]
    made = scene([mesh], suns, {"type": "diffuse", "reflectance": 1.0, "two_sided": two_sided})
    rng = np.random.default_rng(2)
    shares = rng.dirichlet([1, 1, 1], 200)
    c, s = math.cos(math.radians(30)), math.sin(math.radians(30))
    turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    n = shares @ np.array(NORMALS) @ turn.T
    n /= np.linalg.norm(n, axis=1, keepdims=True)
    ways = rng.normal(size=(200, 3)) * [1, 1, 0.3] - [0, 0, 0.5]
    ways[:, 2] = -np.abs(ways[:, 2]) * np.where(rng.random(200) < 0.8, 1, -1 if two_sided else 1)
    found = looked(made, shares @ corners @ turn.T - ways, ways)[1][:, 0]
    facing = (ways * n).sum(axis=1) < 0
    if two_sided:
        n *= np.where(facing, 1.0, -1.0)[:, None]
    lit = sum(
        np.maximum(0.0, -(n @ (np.array(sun["direction"]) / np.linalg.norm(sun["direction"])))) for sun in suns
    )  # fmt: skip
    expected = np.where(facing | two_sided, lit, 0.0)
    assert 5 < (~facing).sum() < 120 and expected.max() > 0.9
    assert np.abs(found - expected).max() < 1e-12


OBJ = """v 0 0 0
v 1 0 0
v 1 1 1
v 0 1 0
vt .1 .2
vt .3 .4
vt .5 .6
vn 0 0 2
vn 0 1 1
f 1/1/1 2/2/1 3/3/2
f 1/2/1 3/3/2 4/1/2
"""
PLY = """ply
format ascii 1.0
element vertex 3
property float x
property float y
property float z
property float s
property float t
property float nx
property float ny
property float nz
element face 1
property list uchar int vertex_indices
end_header
0 0 0 .1 .2 0 0 1
1 0 0 .3 .4 0 1 0
0 1 0 .5 .6 1 0 0
3 0 1 2
"""


def of_file(folder: Path, name: str, text: str, **more: Any) -> Any:
    (folder / name).write_text(text)
    return scene([{"type": "mesh", "file": str(folder / name)} | more], [SUN])


def test_meshes_have_the_coordinates_and_normals_of_their_files(tmp_path: Path) -> None:
    obj = of_file(tmp_path, "a.obj", OBJ, shading_normals="use").shapes[0]
    # v of an OBJ points up, rows of an image go down
    assert np.allclose(obj.uv, [(0.1, 0.8), (0.3, 0.6), (0.5, 0.4)])
    assert obj.uv_faces == ((0, 1, 2), (1, 2, 0)) and obj.normal_faces == ((0, 0, 1), (0, 1, 1))
    assert obj.normals == ((0.0, 0.0, 2.0), (0.0, 1.0, 1.0)) and obj.notes == ""
    flat = of_file(tmp_path, "b.obj", OBJ).shapes[0]
    assert flat.normals == () and "shading normals are not used" in flat.notes
    ply = of_file(tmp_path, "a.ply", PLY, shading_normals="use").shapes[0]
    assert np.allclose(ply.uv, [(0.1, 0.2), (0.3, 0.4), (0.5, 0.6)], atol=1e-7) and ply.uv_faces == ()
    assert ply.normals == ((0.0, 0.0, 1.0), (0.0, 1.0, 0.0), (1.0, 0.0, 0.0))
    partly = of_file(tmp_path, "c.obj", OBJ.replace("4/1/2", "4//2")).shapes[0]
    assert partly.uv == () and "texture coordinates are not used" in partly.notes


def test_normals_that_a_file_has_not_are_sums_by_angles(tmp_path: Path) -> None:
    bare = "".join(line for line in OBJ.splitlines(keepends=True) if line[:2] not in ("vt", "vn"))
    made = of_file(tmp_path, "a.obj", bare.replace("/1/1", "").replace("f", "#f") + "f 1 2 3\nf 1 3 4\n",
                   shading_normals="use")  # fmt: skip
    normals = radiometric_arrays(made).detail.normals.reshape(2, 3, 3)
    normals /= np.linalg.norm(normals, axis=2, keepdims=True)
    # vertex_normals of Mitsuba 3.9.1 for this file
    known = {
        0: [-0.40824828, -0.40824828, 0.81649655],
        1: [0, -0.70710677, 0.70710677],
        3: [-0.70710677, 0, 0.70710677],
    }
    for (face, corner), vertex in {(0, 0): 0, (0, 1): 1, (1, 0): 0, (1, 2): 3}.items():
        assert np.abs(normals[face, corner] - known[vertex]).max() < 1e-6


def test_quadrature_declines_each_by_name_and_paths_sample_it() -> None:
    image = {"type": "diffuse", "reflectance": {"type": "image", "data": exr(np.full((2, 2, 3), 0.5))}}
    mesh = {"type": "mesh", "vertices": [[0, 0, 0], [2, 0, 0], [0, 2, 0]], "faces": [[0, 1, 2]], "normals": NORMALS}
    smooth = mesh | {"shading_normals": "use"}
    lit = {"type": "environment", "name": "e", "data": exr(np.ones((4, 8, 3)))}
    cases = {
        "an image as a texture": scene([SQUARE], [SUN], image),
        r"a checkerboard in \(u, v\)": scene(
            [SQUARE], [SUN], {"type": "diffuse", "reflectance": {"type": "checkerboard"}}
        ),
        "an environment from an image": scene([SQUARE], [lit]),
        "shading normals of a mesh": scene([smooth], [SUN]),
    }
    for words, made in cases.items():
        with pytest.raises(Unsupported, match=words):
            sr.truth(made, size=1, method="quadrature")
        found = sr.truth(made, size=1, tol=0.05, threads=1)
        assert np.isfinite(found.radiance).all() and found.layer("error")[0, 0] < np.inf
    assert (sr.truth(scene([mesh], [SUN]), size=2, tol=1e-3, method="quadrature").layer("status") == 0).all()


def test_the_hash_is_that_of_the_file_and_a_dump_holds_it(tmp_path: Path) -> None:
    codes = np.arange(12, dtype=np.uint8).reshape(2, 2, 3)
    (tmp_path / "a.png").write_bytes(png(codes))
    (tmp_path / "b.png").write_bytes(png(codes))
    (tmp_path / "c.png").write_bytes(png(codes + 1))
    a, b, c = (
        scene([SQUARE], [SUN], {"type": "diffuse", "reflectance": {"type": "image", "file": str(tmp_path / name)}})
        for name in ("a.png", "b.png", "c.png")
    )
    assert a == b and a.hash == b.hash != c.hash
    again = parse_any(to_yaml(a), "again")
    assert again == a and again.hash == a.hash


@pytest.mark.parametrize(
    ("field", "content", "words"),
    [
        ("texture", b"", "must be a PNG, JPEG, OpenEXR or Radiance HDR file"),
        ("texture", png(np.zeros((2, 2, 3), np.uint8))[:40], "not a readable PNG"),
        ("texture", b"\xff\xd8\xff\xe0", "not a readable JPEG"),
        ("texture", b"v/1\x01\x02", "not a readable EXR"),
        ("texture", b"#?RADIANCE\n\n-Y 2 +X 2\nabc", "it ends within its pixels"),
        ("texture", b"#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\nabcd", "32-bit_rle_rgbe is read"),
        ("texture", b"#?RADIANCE\n\n-Y 99999 +X 99999\nabcd", "exceed 33554432"),
        ("texture", encode({"radiance": np.full((2, 2, 3), 1.5)}, {}), "reflectances must be at most 1"),
        ("texture", encode({"radiance": np.full((2, 2, 3), -0.5)}, {}), "must not be negative"),
        ("sky", encode({"radiance": np.full((2, 2, 3), np.inf)}, {}), "column 0, row 0 is no finite number"),
        ("sky", encode({"radiance": np.full((1, 2, 3), 1.0)}, {}), "must have at least 2 rows"),
        ("sky", None, "cannot be read"),
    ],
)  # fmt: skip
def test_a_file_that_is_no_image_is_told_with_its_field(
    field: str, content: bytes | None, words: str, tmp_path: Path
) -> None:
    if content is not None:
        (tmp_path / "bad").write_bytes(content)
    texture = "{type: image, file: bad}" if field == "texture" else "0.5"
    light = "{type: environment, name: e, file: bad}" if field == "sky" else "{type: sky, name: e, radiance: 1}"
    (tmp_path / "a.yaml").write_text(f"""units: radiometric
bounces: 0
camera: {{type: look_at, eye: [0, -5, 2], target: [0, 0, 0.5], fov: 39}}
materials:
  m: {{type: diffuse, reflectance: {texture}}}
shapes: [{{type: sphere, name: A, center: [0, 0, 0], radius: 1, material: m}}]
lights:
  - {light}
""")
    with pytest.raises(SceneError) as error:
        load_any(str(tmp_path / "a.yaml"))
    line = 5 if field == "texture" else 8
    named = "materials.m.reflectance.file" if field == "texture" else "lights[0].file"
    assert f"a.yaml:{line}:" in str(error.value) and f"{named}: " in str(error.value) and words in str(error.value)


@pytest.mark.parametrize("options", MAPS)
def test_what_a_pixel_may_see_of_an_environment_bounds_what_it_sees(options: dict[str, Any]) -> None:
    made, (everywhere, _) = mapped(**options)[0], grid(60)
    bright = everywhere[looked(made, [0, 0, 0], everywhere)[0].max(axis=1).argmax()]
    made = made.replace({"camera.fov": 100.0, "camera.target": (np.array([0.0, -5.0, 2.0]) + bright).tolist()})
    arrays, size = radiometric_arrays(made), 24
    settings = Settings(width=size, height=size, filter="box")
    columns, rows = (k.ravel() for k in np.meshgrid(np.arange(size), np.arange(size)))
    bound = seen_radiance(arrays, settings, columns, rows)
    frame = camera_frame(arrays.camera, size, size)
    most = np.zeros(size * size)
    rng = np.random.default_rng(5)
    for _ in range(60):
        a = 2 * (columns + rng.random(size * size)) / size - 1
        b = 1 - 2 * (rows + rng.random(size * size)) / size
        ways = frame[4:7] + a[:, None] * frame[7:10] + b[:, None] * frame[10:13]
        most = np.maximum(most, looked(made, [0, -5, 2], ways)[0].max(axis=1))
    assert most.max() > 20 > np.median(most)
    assert (most <= bound * (1 + 1e-12)).all()
    # of a map of 16 columns some pixels cannot see the brightest one
    assert options.get("layout") or (bound < 0.2 * bound.max()).mean() > 0.05
