"""Planes anywhere in both image pipelines: against each other, against the floor, and against a moved copy."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from runtimes.rays import TOLERANCE, assert_agree
from runtimes.test_image import layers_of
from symrender.numeric import pipeline as numeric
from symrender.runtimes import image as symbolic
from symrender.scene import arrays as at
from symrender.scene.arrays import Array, SceneArrays, scene_arrays
from symrender.scene.frames import frames
from symrender.scene.load import load
from symrender.scene.scene import Scene

Data = dict[str, Any]
PIPELINES = pytest.mark.parametrize("pipeline", [numeric, symbolic], ids=["numeric", "symbolic"])
SEEDS = range(12)
SIZE = 24


def _unit(rng: np.random.Generator) -> Array:
    v = rng.normal(size=3)
    return np.asarray(v / np.linalg.norm(v))


def room(seed: int) -> Data:
    """A scene of one to four planes: some through spheres, some crossing, some that face away from the camera.

    Lights lie in front of planes, behind them and, of every third scene, exactly in one. Normals and directions are of
    any length; every other scene has a floor.
    """
    rng = np.random.default_rng(seed)
    spheres = [
        {
            "name": f"s{k}",
            "center": rng.uniform([-1.2, -1.0, -0.2], [1.2, 1.5, 1.5]).tolist(),
            "radius": float(rng.uniform(0.25, 0.7)),
            "color": rng.uniform(0.2, 1, 3).tolist(),
            "lobe": {"weight": 0.5, "exponent": 20.0, "theta_max": 1.0},
        }
        for k in range(3)
    ]
    planes = []
    for k in range(int(rng.integers(1, 5))):
        through = k == 0 or rng.random() < 0.4
        up = _unit(rng)
        point = np.array(spheres[k % 3]["center"]) + 0.2 * _unit(rng) if through else -rng.uniform(1.2, 2.5) * up
        planes.append(
            {
                "name": f"w{k}",
                "point": point.tolist(),
                "normal": (up * 10 ** rng.uniform(-2, 2)).tolist(),
                "along": (np.cross(up, _unit(rng)) + 0.3 * up).tolist(),
                "texture": {
                    "type": "checker",
                    "bright": rng.uniform(0.5, 1, 3).tolist(),
                    "dark": rng.uniform(0, 0.3, 3).tolist(),
                    "cell": float(rng.uniform(0.2, 0.8)),
                    "offset": rng.uniform(-1, 1, 2).tolist(),
                },
                "lobe": {"weight": 0.7, "exponent": 30.0, "theta_max": 1.0},
            }
        )
    lights = [
        {"type": "point", "name": f"l{k}", "position": (rng.uniform(1, 4) * _unit(rng)).tolist(), "color": [0.8] * 3}
        for k in range(4)
    ]
    if seed % 3 == 0:
        lights[0]["position"] = planes[0]["point"]
    lights.append({"type": "disk", "name": "d", "position": [0.5, -2.0, 3.0], "radius": 0.7, "target": [0.0, 0.0, 0.0]})
    camera = {"type": "look_at", "eye": (4 * _unit(rng)).tolist(), "target": [0.0, 0.0, 0.4], "fov": 60.0}
    return {
        "camera": camera,
        "spheres": spheres,
        "floor": {"lobe": {"weight": 0.4, "exponent": 12.0, "theta_max": 1.0}} if seed % 2 else None,
        "planes": planes,
        "lights": lights,
        "ambient": [0.2, 0.1, 0.15],
        "background": [0.3, 0.5, 0.1],
        "shading": {"highlight_view": "eye" if seed % 4 < 2 else "ray", "shininess": 20.0},
    }


def scene_of(data: Data) -> Scene:
    return Scene.model_validate(data, strict=False)


def rays_in(arrays: SceneArrays, count: int, seed: int) -> tuple[Array, Array, Array]:
    """Rays that leave spheres and planes above their horizons, and rays from nowhere, which may be behind planes."""
    rng = np.random.default_rng(seed)
    shapes = len(arrays.spheres) + len(arrays.planes)
    own = rng.integers(-1, shapes, count)
    origins, directions = rng.uniform(-2.5, 2.5, size=(count, 3)), rng.normal(size=(count, 3))
    normals = np.zeros((count, 3))
    ball = rng.normal(size=(count, 3))
    ball /= np.linalg.norm(ball, axis=1)[:, None]
    for j, sphere in enumerate(arrays.spheres):
        here = own == j
        origins[here], normals[here] = sphere.center + sphere.radius * ball[here], ball[here]
    for k, frame in enumerate(frames(arrays.planes)):
        here = own == len(arrays.spheres) + k
        place = rng.uniform(-2.5, 2.5, size=(int(here.sum()), 2))
        origins[here] = frame.origin + place[:, :1] * frame.east + place[:, 1:] * frame.north
        normals[here] = frame.up
    below = (directions * normals).sum(axis=1) < 0
    directions[below] -= 2 * (directions * normals).sum(axis=1)[below, None] * normals[below]
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    leaves = np.where(own < 0, at.NOTHING, at.FIRST_SPHERE + own)
    return origins, directions, leaves.astype(np.float64)


def test_the_rooms_hold_what_they_are_meant_to() -> None:
    """Planes through spheres, eyes behind planes, lights in front of them, behind them and in them."""
    through = eyes = behind = lit = inside = crossing = shaded = 0
    for seed in SEEDS:
        arrays = scene_arrays(scene_of(room(seed)))
        made = frames(arrays.planes)
        for frame in made:
            over = (arrays.spheres["center"] - frame.origin) @ frame.up
            through += int((np.abs(over) < 0.9 * arrays.spheres["radius"]).sum())
            eyes += bool((arrays.camera.eye - frame.origin) @ frame.up < 0)
            lamps = (arrays.lights["position"] - frame.origin) @ frame.up
            inside += int((lamps == 0).sum())
            behind += int((lamps < 0).sum())
            lit += int((lamps > 0).sum())
        crossing += sum(abs(a.up @ b.up) < 0.9 for i, a in enumerate(made) for b in list(made)[:i])
        radiance, hit, _ = numeric.trace(arrays, *rays_in(arrays, 500, seed))
        ambient = arrays.shading.ka * arrays.shading.ambient
        shaded += int((radiance > ambient + 0.02).all(axis=1)[hit >= at.FIRST_SPHERE + len(arrays.spheres)].sum())
    assert shaded >= 200
    assert through >= 15 and eyes >= 8 and inside >= 4 and behind >= 20 and lit >= 20 and crossing >= 20


@pytest.mark.parametrize("seed", SEEDS)
def test_pipelines_agree_ray_by_ray(seed: int) -> None:
    arrays = scene_arrays(scene_of(room(seed)))
    rays = rays_in(arrays, 6000, seed)
    a, b = numeric.trace(arrays, *rays), symbolic.trace(arrays, *rays)
    planes = a[1] >= at.FIRST_SPHERE + len(arrays.spheres)
    assert planes.sum() > 600 and (a[0][planes].max(axis=1) > 0).sum() > 100
    if len(arrays.planes) > 1:
        assert (a[0][planes].max(axis=1) == 0).sum() > 50, "backs of planes"
    assert_agree(a, b, rays=6000, closed=True)


@pytest.mark.parametrize("aa", ["analytic", "none"])
@pytest.mark.parametrize("seed", SEEDS)
def test_direct_layers_agree(seed: int, aa: str) -> None:
    scene = scene_of(room(seed))
    a, b = (layers_of(pipeline, scene, SIZE, lobe=1, aa=aa) for pipeline in (numeric, symbolic))
    assert (a["hit_class"] == b["hit_class"]).all()
    assert (a["hit_class"] >= at.FIRST_SPHERE + 3).sum() > 10
    rms = math.sqrt((a["direct"] ** 2).mean())
    # a camera may look at nothing but the black side of a plane
    assert np.abs(a["direct"] - b["direct"]).max() <= TOLERANCE * max(rms, 0.01)
    assert np.isfinite(a["radiance"]).all() and np.isfinite(b["radiance"]).all()


def test_a_floor_that_is_written_as_a_plane_is_the_floor() -> None:
    """To rounding in every layer of both pipelines, above and below, filtered and not, in both conventions."""
    signal = 0.0
    for name in ("gloss", "chapter8", "penumbra", "grazing"):
        data = load(name).model_dump()
        data["shading"]["lobe_units"] = "brdf_normalised" if name == "grazing" else "lobe_average"
        floor = data.pop("floor")
        plane = {"name": "floor", "point": (0.0, 0.0, 0.0), "normal": (0.0, 0.0, 2.5), "along": (3.0, 0.0, 0.7)}
        for eye in (data["camera"]["eye"], (0.3, -5.0, -1.0)):
            data["camera"]["eye"] = eye
            flat, moved = (scene_of(data | changes) for changes in ({"floor": floor}, {"planes": (plane | floor,)}))
            for pipeline in (numeric, symbolic):
                for aa in ("analytic", "none"):
                    a, b = (layers_of(pipeline, s, SIZE, lobe=3, aa=aa) for s in (flat, moved))
                    # a plane camera reads the floor's own rectangle
                    for layer in ("direct", "gloss", "radiance"):
                        assert np.abs(a[layer] - b[layer]).max() <= 1e-11 * max(1.0, a[layer].max()), (name, layer)
                    classes = np.array([0, 2 + len(data["spheres"]), *range(2, 10)])
                    assert (classes[a["hit_class"].astype(int)] == b["hit_class"]).all()
                    signal += a["gloss"].max()
    assert signal > 5


def turned(data: Data, turn: Array, shift: Array) -> Data:
    """The world of ``data`` turned and shifted; its floor becomes a plane."""

    def place(v: Any) -> list[float]:
        return [float(x) for x in turn @ np.asarray(v, dtype=float) + shift]

    def way(v: Any) -> list[float]:
        return [float(x) for x in turn @ np.asarray(v, dtype=float)]

    made = dict(data)
    camera = data["camera"]
    made["camera"] = camera | {
        "eye": place(camera["eye"]),
        "target": place(camera["target"]),
        "up": way(camera.get("up", (0, 0, 1))),
    }
    made["spheres"] = [s | {"center": place(s["center"])} for s in data["spheres"]]
    made["lights"] = [
        light
        | {"position": place(light["position"])}
        | ({"target": place(light["target"])} if light["type"] == "disk" else {})
        for light in data["lights"]
    ]
    made["planes"] = [
        p | {"point": place(p["point"]), "normal": way(p["normal"]), "along": way(p["along"])}
        for p in data.get("planes", ())
    ]
    if data.get("floor") is not None:
        flat = {"point": place((0, 0, 0)), "normal": way((0, 0, 1)), "along": way((1, 0, 0))}
        made["planes"].append({"name": "floor"} | flat | data["floor"])
    made["floor"] = None
    return made


@PIPELINES
def test_a_world_that_is_turned_and_shifted_looks_the_same(pipeline: Any) -> None:
    """Every layer, under exact mirrors where the frame of a lobe does not count."""
    data = load("room").model_dump()
    for part in (*data["spheres"], *data["planes"], data["floor"]):
        if part["lobe"] is not None:
            part["lobe"] |= {"mirror": True, "theta_max": 0.0, "exponent": 0.0}
    # the strata of a disk turn with the world, up to their azimuth
    data["lights"] = [{"type": "point", "name": l["name"], "position": l["position"]} for l in data["lights"]]
    still = layers_of(pipeline, scene_of(data), SIZE, lobe=1)
    last = at.FIRST_SPHERE + len(data["spheres"]) + len(data["planes"])
    assert (still["hit_class"] == at.FLOOR).sum() > 50 and still["gloss"].max() > 0.3
    for seed in range(6):
        rng = np.random.default_rng(seed)
        turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        turn *= np.sign(np.linalg.det(turn))
        moved = layers_of(pipeline, scene_of(turned(data, turn, rng.uniform(-3, 3, 3))), SIZE, lobe=1)
        floor = np.where(still["hit_class"] == at.FLOOR, last, still["hit_class"])
        assert (moved["hit_class"] == floor).all()
        for layer in ("direct", "gloss", "radiance"):
            off = np.abs(moved[layer] - still[layer])
            assert off.max() <= 1e-10, (layer, off.max())


@PIPELINES
def test_a_plane_is_black_from_behind_and_hides_what_is_beyond_it(pipeline: Any) -> None:
    data: Data = {
        "camera": {"type": "look_at", "eye": [0.0, -4.0, 0.0], "target": [0.0, 0.0, 0.0], "fov": 40.0},
        "spheres": [{"name": "A", "center": [0.0, 2.0, 0.0], "radius": 0.8}],
        "planes": [{"name": "w", "point": [0.0, 0.0, 0.0], "normal": [0.0, 1.0, 0.0], "lobe": {}}],
        "lights": [{"type": "point", "name": "k", "position": [0.0, -3.0, 1.0]}],
        "ambient": [0.5, 0.5, 0.5],
        "background": [0.7, 0.7, 0.7],
    }
    image = layers_of(pipeline, scene_of(data), SIZE)
    assert (image["hit_class"] == at.FIRST_SPHERE + 1).all()
    assert not image["radiance"].any() and not image["gloss"].any()
    data["planes"][0]["normal"] = [0.0, -1.0, 0.0]
    image = layers_of(pipeline, scene_of(data), SIZE)
    assert (image["hit_class"] == at.FIRST_SPHERE + 1).all() and image["direct"].min() > 0.1


@PIPELINES
@pytest.mark.parametrize(
    "light,lit",
    [
        ((0.0, 1.0, 2.0), True),
        ((0.0, 1.0, -2.0), False),
        ((0.0, 3.0, 0.0), False),
        ((0.0, 5.0, 2.0), True),
        ((0.0, 6.0, 2.0), False),
    ],
    ids=["in front", "behind", "in it", "in the other plane", "behind the other plane"],
)
def test_who_lights_a_plane(pipeline: Any, light: tuple[float, float, float], lit: bool) -> None:
    """The plane z = 0 beside the plane y = 5: what is in front of the one and not behind the other lights it."""
    data: Data = {
        "camera": {"type": "look_at", "eye": [0.0, 0.0, 3.0], "target": [0.0, 0.01, 0.0], "fov": 20.0},
        "planes": [
            {"name": "w", "point": [3.0, 1.0, 0.0], "normal": [0.0, 0.0, 0.2], "texture": {"type": "solid"}},
            {"name": "far", "point": [0.0, 5.0, 0.0], "normal": [0.0, -1.0, 0.0]},
        ],
        "lights": [{"type": "point", "name": "k", "position": light}],
        "shading": {"specular_terminator": "open", "shininess": 0.0},
    }
    image = layers_of(pipeline, scene_of(data), SIZE)
    assert (image["hit_class"] == at.FIRST_SPHERE).all()
    assert (image["direct"] > 0).all() if lit else not image["direct"].any()
