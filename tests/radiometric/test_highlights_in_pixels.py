"""Filtered pixels of highlights and of coincident planes are as far off as stated: dense Gauss rules are the judge."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import symrender as sr
from symrender.settings import Filter

Array = np.ndarray[Any, np.dtype[np.float64]]
SQUARE = np.polynomial.legendre.leggauss(6)
METAL: dict[str, Any] = {"type": "conductor", "eta": 1.5, "k": 3.0, "masking": "correlated", "reflectance": 1.0}
MATERIALS: dict[str, dict[str, Any]] = {
    "phong": {"type": "phong", "exponent": 6.0, "reflectance": 1.0},
    "ggx": METAL | {"distribution": "ggx", "alpha": 0.12},
    "beckmann": METAL | {"distribution": "beckmann", "alpha": 0.2},
}


def unit(v: Array) -> Array:
    return np.asarray(v / np.sqrt((v**2).sum(axis=-1, keepdims=True)))


def reflected(material: dict[str, Any], n: Array, o: Array, i: Array) -> Array:
    """f cos_i of a reflectance of 1, written from the literature."""
    ci, co = (n * i).sum(-1), (n * o).sum(-1)
    lit = (ci > 0.0) & (co > 0.0)
    ci, co = np.where(lit, ci, 1.0), np.where(lit, co, 1.0)
    if material["type"] == "phong":
        power = material["exponent"]
        cosine = np.maximum(((2.0 * co[..., None] * n - o) * i).sum(-1), 0.0)
        return np.asarray(np.where(lit, (power + 2.0) / (2.0 * math.pi) * ci * cosine**power, 0.0))
    a, half = material["alpha"], unit(o + i)
    ch, sin2 = np.maximum((n * half).sum(-1), 1e-9), (np.cross(n, half) ** 2).sum(-1)
    if material["distribution"] == "ggx":
        density = a * a / (math.pi * (a * a * ch**2 + sin2) ** 2)
        one, two = (2.0 * c / (c + np.sqrt(a * a + (1.0 - a * a) * c * c)) for c in (ci, co))
    else:
        density = np.exp(-sin2 / (a * ch) ** 2) / (math.pi * a * a * ch**4)
        erf = np.vectorize(math.erf, otypes=[np.float64])
        tall = [np.minimum(c / (a * np.sqrt(np.maximum(1.0 - c * c, 1e-300))), 20.0) for c in (ci, co)]
        one, two = (2.0 / (1.0 + erf(t) + np.exp(-t * t) / (t * math.sqrt(math.pi))) for t in tall)
    n_, c = material["eta"] + 1j * material["k"], (o * half).sum(-1)
    inner = np.sqrt(1.0 - (1.0 - c * c) / n_**2)
    fresnel = 0.5 * (
        np.abs((c - n_ * inner) / (c + n_ * inner)) ** 2 + np.abs((n_ * c - inner) / (n_ * c + inner)) ** 2
    )
    return np.asarray(np.where(lit, density * fresnel * one * two / (one + two - one * two) / (4.0 * co), 0.0))


def radiance(scene: dict[str, Any], material: dict[str, Any], d: Array) -> Array:
    """Radiance along unit rays, per unit of intensity."""
    eye, lamp, shape = np.array(scene["camera"]["eye"]), np.array(scene["lights"][0]["position"]), scene["shapes"][0]
    if shape["type"] == "plane":
        met = d[..., 2] < 0.0
        place = eye - d * (eye[2] / np.where(met, d[..., 2], -1.0))[..., None]
        n = np.broadcast_to(np.array([0.0, 0.0, 1.0]), place.shape)
    else:
        b = -(d @ eye)
        level = b * b - eye @ eye + 1.0
        met = (level >= 0.0) & (b > 0.0)
        place = eye + (b - np.sqrt(np.where(met, level, 0.0)))[..., None] * d
        n = unit(place)
    way = lamp - place
    square = (way**2).sum(-1)
    return np.asarray(np.where(met, reflected(material, n, -d, way / np.sqrt(square)[..., None]) / square, 0.0))


def mean(scene: dict[str, Any], material: dict[str, Any], size: int, i: int, j: int) -> float:
    """Mean over a pixel by 6 x 6 nodes in each of more and more squares; NaN where three do not agree."""
    camera, found = scene["camera"], []
    eye, target = np.array(camera["eye"]), np.array(camera["target"])
    forward = unit(target - eye)
    right = unit(np.cross(forward, np.array(camera["up"], float)))
    half = math.tan(math.radians(camera["fov"]) / 2)
    up = np.cross(right, forward)
    for cells in (5, 8, 14, 24, 41):
        x = ((np.arange(cells)[:, None] + 0.5 * (SQUARE[0] + 1.0)) / cells).ravel()
        w = np.tile(0.5 * SQUARE[1] / cells, cells)
        a, b = half * (2.0 * (i + x) / size - 1.0), half * (1.0 - 2.0 * (j + x) / size)
        d = unit(forward + a[:, None, None] * right + b[:, None] * up)
        found.append(float(w @ radiance(scene, material, d) @ w))
        if len(found) > 2 and max(abs(found[-1] - each) for each in found[-3:]) <= 1e-7 * found[-1]:
            return found[-1]
    return math.nan


def pixel_scene(seed: int, kind: str, shape: str) -> dict[str, Any]:
    """A plane or a ball beside a near lamp, which may be mirrored behind the image plane, seen with any lens."""
    rng = np.random.default_rng([seed, *kind.encode(), *shape.encode()])
    eye = np.array([0.0, rng.uniform(-2.0, 2.0), math.exp(rng.uniform(-2.5, 1.3))])
    turn, far = rng.uniform(0.0, 2.0 * math.pi), math.exp(rng.uniform(-2.5, 2.5))
    target = np.array([far * math.cos(turn), eye[1] + far * math.sin(turn), 0.0])
    lamp = eye + rng.normal(size=3) * math.exp(rng.uniform(-2.0, 0.4))
    lamp[2] = abs(lamp[2]) + 0.02
    if shape == "sphere":
        eye = unit(rng.normal(size=3)) * (1.0 + math.exp(rng.uniform(-2.0, 1.5)))
        target, lamp = 0.4 * rng.normal(size=3), unit(unit(eye) + 0.7 * rng.normal(size=3)) * rng.uniform(1.05, 4.0)
    body = {"type": "sphere", "center": [0, 0, 0], "radius": 1.0}
    floor = {"type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}
    return {
        "units": "radiometric", "name": "highlight", "bounces": 0,
        "camera": {"type": "look_at", "eye": eye.tolist(), "target": target.tolist(), "up": [0, 0, 1],
                   "fov": float(rng.choice([5.0, 30.0, 60.0, 90.0, 120.0]))},
        "materials": {"m": MATERIALS[kind]},
        "shapes": [(body if shape == "sphere" else floor) | {"name": "body", "material": "m"}],
        "lights": [{"type": "point", "name": "lamp", "position": lamp.tolist(), "intensity": 1.0}],
    }  # fmt: skip


def off(scene: dict[str, Any], kind: str, size: int, i: int, j: int, tol: float, light: float) -> float | None:
    """How far a pixel that is as bright as ``light`` is off, over what it states; None if it is no case."""
    whole = mean(scene, MATERIALS[kind], size, i, j)
    if not whole > 1e-11 * light:
        return None
    scene["lights"][0]["intensity"] = light / whole
    image = sr.truth(scene, size=size, tol=tol, filter="box", threads=1)
    assert image.layer("status")[j, i] == 0
    return float(abs(image.radiance[j, i, 0] - light) / image.layer("error")[j, i])


@pytest.mark.parametrize("kind", MATERIALS)
@pytest.mark.parametrize("shape", ["plane", "sphere"])
def test_no_highlight_lies_between_nodes(kind: str, shape: str) -> None:
    found = []
    for seed in range(24):
        rng = np.random.default_rng(seed)
        size = int(rng.choice([1, 2, 3]))
        i, j = rng.integers(size, size=2).tolist()
        tol = float(rng.choice([1e-3, 1e-4]))
        light = tol * 10.0 ** rng.uniform(-1.0, 3.5)
        found.append(off(pixel_scene(seed, kind, shape), kind, size, i, j, tol, light))
    judged = [each for each in found if each is not None]
    assert len(judged) >= 8
    assert max(judged) <= 1.5


def test_the_flank_of_a_wide_highlight_is_integrated() -> None:
    """The mirrored lamp lies behind the image plane; nodes of the whole pixel see a thousandth of its light."""
    scene = pixel_scene(0, "phong", "plane")
    eye, target = [0.0, -0.9602095951642524, 1.5865531198080904], [-2.9554476704454733, 5.06556343599294, 0.0]
    scene["camera"] |= {"eye": eye, "target": target, "fov": 90.0}
    scene["lights"][0]["position"] = [-0.2866287722177163, -0.8480962861195409, 0.5691372158466264]
    found = off(scene, "phong", 2, 1, 1, 1e-3, 0.15172565499625598)
    assert found is not None and found <= 1.5


def twice(rng: np.random.Generator, material: dict[str, Any]) -> dict[str, Any]:
    """A plane under a lamp, and a second shape of another material in the same plane."""
    up = unit(rng.normal(size=3))
    across = unit(np.cross(up, [1.0, 0.0, 0.0]))
    along, place = np.cross(up, across), up * rng.uniform(-2.0, 2.0)
    eye = place + up * rng.uniform(0.5, 4.0) + across * rng.uniform(-1.0, 1.0)
    target = place + across * rng.uniform(-0.7, 0.7) + along * rng.uniform(-0.7, 0.7)
    second = [
        {"type": "plane", "point": (place + 0.7 * across).tolist(), "normal": up.tolist()},
        {"type": "disk", "center": place.tolist(), "normal": up.tolist(), "radius": 1.5},
        {"type": "rectangle", "corner": (place - across - along).tolist(), "edge_u": (2 * across).tolist(),
         "edge_v": (2 * along).tolist()},
    ]  # fmt: skip
    return {
        "units": "radiometric", "name": "twice", "bounces": 0,
        "camera": {"type": "look_at", "eye": eye.tolist(), "target": target.tolist(), "up": along.tolist(),
                   "fov": rng.uniform(5.0, 60.0)},
        "materials": {"m": material},
        "shapes": [{"type": "plane", "name": "floor", "point": place.tolist(), "normal": up.tolist(), "material": "m"},
                   second[int(rng.integers(3))] | {"name": "other", "material": "m"}],
        "lights": [{"type": "point", "name": "lamp", "intensity": 3.0,
                    "position": (place + up * rng.uniform(0.5, 3.0) + across * rng.normal()).tolist()}],
    }  # fmt: skip


def test_roundings_between_coincident_shapes_reach_the_error_of_a_mean() -> None:
    material = {"type": "diffuse", "reflectance": [0.5, 0.6, 0.7], "two_sided": True}
    filters: list[Filter] = ["box", "tent", "mitchell"]
    noisy, pixels, worst = 0, 0, 0.0
    for seed in range(14):
        rng = np.random.default_rng(seed)
        scene, filter_ = twice(rng, material), filters[seed % 3]
        alone = scene | {"shapes": scene["shapes"][:1]}
        image = sr.truth(scene, size=2, tol=1e-4, filter=filter_, budget=5000, threads=1)
        judge = sr.truth(alone, size=2, tol=1e-7, filter=filter_, threads=1)
        gap = np.abs(image.radiance - judge.radiance).max(axis=2) - judge.layer("error")
        noisy += int((gap > 1e-4).sum())
        pixels += gap.size
        worst = max(worst, float((gap / image.layer("error")).max()))
    assert noisy >= pixels // 8
    assert worst <= 1.5
