"""Spots: known shares of their intensity, 50 digits, the path tracer, derivatives, both bridges, what is refused."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import mpmath
import numpy as np
import pytest

import symrender as sr
from symrender.errors import SceneError, Unsupported
from symrender.leaves import radiometric as leaves
from symrender.numeric.radiometric.pipeline import rays as numeric_rays
from symrender.scene.radiometric.arrays import radiometric_arrays

HEIGHT = 2.0
WHITE = {"white": {"type": "diffuse", "reflectance": 1, "two_sided": True}}
DOWN = {"type": "spot", "name": "key", "position": [0, 0, HEIGHT], "direction": [0, 0, -3], "intensity": [8, 4, 2]}


def lit(*lights: dict[str, Any], **more: Any) -> dict[str, Any]:
    """A white floor and a metal ball under lights."""
    return {
        "units": "radiometric", "bounces": 0, "camera": {"type": "look_at", "eye": [0, -6, 3], "target": [0, 0, 0.5]},
        "materials": {"white": {"type": "diffuse", "reflectance": 1},
                      "metal": {"type": "conductor", "alpha": 0.3, "eta": 1.5, "k": 3}},
        "shapes": [
            {"type": "plane", "name": "floor", "point": [0, 0, 0], "normal": [0, 0, 1], "material": "white"},
            {"type": "sphere", "name": "A", "center": [9, 0, 0.6], "radius": 0.6, "material": "metal"},
        ],
        "lights": list(lights),
    } | more  # fmt: skip


def share(light: dict[str, Any], angle: float) -> float:
    """Share of its intensity with which a spot that looks down lights the floor at this angle, in degrees."""
    x = HEIGHT * math.tan(math.radians(angle))
    found = sr.probe(lit(light), rays=([-x, 0, 1e-3], [0, 0, -1]), tol=1e-6)
    assert found.shape == ("shapes.floor",) and found.status[0] == 0
    falls = math.cos(math.radians(angle)) ** 3 / (HEIGHT * HEIGHT) / math.pi
    np.testing.assert_allclose(found.radiance[0], np.array([8, 4, 2]) * found.radiance[0, 2] / 2, rtol=1e-14)
    return float(found.radiance[0, 2]) / (2 * falls)


@pytest.mark.parametrize(("falloff", "half"), [("linear", 15.0), ("smooth", None)])
def test_a_spot_is_whole_in_its_beam_half_between_and_dark_beyond(falloff: str, half: float | None) -> None:
    light = DOWN | {"beam": 10, "cutoff": 20, "falloff": falloff}
    mean = (math.cos(math.radians(10)) + math.cos(math.radians(20))) / 2
    between = math.degrees(math.acos(mean)) if half is None else half
    shares = [share(light, angle) for angle in (0.0, 9.9, between, 20.1, 60.0)]
    assert shares == pytest.approx([1.0, 1.0, 0.5, 0.0, 0.0], abs=1e-13)


@pytest.mark.parametrize("leaf", [leaves.linear_spot, leaves.smooth_spot])
@pytest.mark.parametrize("cutoff", [1e-3, 1.0, 40.0, 90.0, 170.0])
def test_a_share_keeps_its_digits(leaf: Any, cutoff: float) -> None:
    rng = np.random.default_rng(3)
    beam, seen = 0.3 * cutoff, 0
    for _ in range(200):
        axis = rng.normal(size=3)
        axis /= np.linalg.norm(axis)
        aside = np.cross(axis, rng.normal(size=3))
        aside /= np.linalg.norm(aside)
        angle = math.radians(rng.uniform(0.0, 1.2 * cutoff))
        toward = -(math.cos(angle) * axis + math.sin(angle) * aside)
        with mpmath.workdps(50):
            w, a = [mpmath.mpf(float(x)) for x in toward], [mpmath.mpf(float(x)) for x in axis]
            size = mpmath.sqrt(sum(x * x for x in w) * sum(x * x for x in a))
            c = -sum(x * y for x, y in zip(w, a, strict=True)) / size
            first, last = mpmath.radians(mpmath.mpf(beam)), mpmath.radians(mpmath.mpf(cutoff))
            if leaf is leaves.linear_spot:
                true = min(1, max(0, (last - mpmath.acos(c)) / (last - first)))
            else:
                t = min(1, max(0, (c - mpmath.cos(last)) / (mpmath.cos(first) - mpmath.cos(last))))
                true = t * t * (3 - 2 * t)
        seen += 0.01 < true < 0.99
        # a direction is known to an ulp, which is so much of the angle; and so is a cosine, of one less it
        lost = 1e-15 / math.radians(cutoff) ** (1 if leaf is leaves.linear_spot else 2)
        assert abs(leaf(*toward, *axis, beam, cutoff) - float(true)) < 1e-14 + 10 * lost
    assert seen > 60


def random_spot(rng: np.random.Generator, number: int) -> dict[str, Any]:
    cutoff = float(rng.uniform(5, 120))
    light = {"type": "spot", "name": f"s{number}", "intensity": float(rng.uniform(1, 9)), "cutoff": cutoff}
    light |= {"position": [*rng.uniform(-3, 3, 2).tolist(), float(rng.uniform(1, 4))]}
    light |= {"direction": [*rng.uniform(-1, 1, 2).tolist(), -1.0], "beam": float(rng.uniform(0, 0.9)) * cutoff}
    return light | {"falloff": ("linear", "smooth")[int(rng.integers(2))]}


def test_both_pipelines_see_the_same_spots() -> None:
    rng = np.random.default_rng(5)
    worst, bright, values = 0.0, 0, set()
    for _ in range(40):
        world = lit(*(random_spot(rng, k) for k in range(3)))
        world["shapes"][1]["center"] = [0, 0, 0.6]
        origins = np.tile([0.0, -4.0, 3.0], (50, 1))
        directions = np.column_stack([rng.uniform(-2, 2, 50), rng.uniform(-2, 2, 50), np.full(50, 0.3)]) - origins
        directions /= np.linalg.norm(directions, axis=1)[:, None]
        closed = sr.probe(world, rays=(origins, directions), tol=1e-6)
        traced = numeric_rays(radiometric_arrays(sr.load(world)), origins, directions)[1]
        apart, size = np.abs(closed.direct - traced).max(axis=1), np.abs(traced).max(axis=1)
        assert (apart <= closed.error + 1e-12 * size).all()
        worst = max(worst, float((apart / np.maximum(size, 1e-3)).max()))
        bright += int((size > 1e-2).sum())
        values |= set(np.round(size, 6).tolist())
    assert bright > 800 and len(values) > 800
    assert worst < 1e-11


@pytest.mark.parametrize(
    "name", ["beam", "cutoff", "direction.x", "direction.z", "position.x", "position.z", "intensity.g"]
)
@pytest.mark.parametrize("falloff", ["linear", "smooth"])
def test_derivatives_are_differences(name: str, falloff: str) -> None:
    light = {
        **DOWN,
        "position": [1, -1, 2.5],
        "direction": [-1, 1.2, -2.2],
        "beam": 12,
        "cutoff": 30,
        "falloff": falloff,
    }
    world = sr.load(lit(light))
    size, step, full = (24, 16), 1e-5, f"lights.key.{name}"
    value = {"beam": 12.0, "cutoff": 30.0, "direction.x": -1.0, "direction.z": -2.2, "position.x": 1.0,
             "position.z": 2.5, "intensity.g": 4.0}[name]  # fmt: skip
    slope = sr.gradient(world, [full], size=size)[full]
    there, here = (sr.truth(world.replace({full: value + s}), size=size).radiance for s in (step, -step))
    difference = (there - here) / (2 * step)
    met = np.abs(difference).max(axis=2) > 1e-4
    assert met.sum() > 20 and np.abs(difference).max() > 1e-3
    apart = np.abs(slope.radiance - difference).max(axis=2)
    # a pixel over which the edge of beam or cone passes within the step has no difference
    assert np.quantile(apart, 0.98) < 1e-8


def test_spots_go_to_mitsuba_and_come_back(tmp_path: Path) -> None:
    light = {**DOWN, "direction": [0.3, -0.7, -3.1], "beam": 11.3, "cutoff": 27.9}
    scene = sr.load(lit(light))
    made = sr.export(scene, "mitsuba")
    assert 'emitter type="spot"' in made.files["scene.xml"]
    (tmp_path / "scene.xml").write_text(made.files["scene.xml"])
    assert sr.load(tmp_path / "scene.xml").hash == scene.hash
    moved = sr.export(scene, "mitsuba", scale=100.0, center=(1.0, 2.0, 3.0))
    (tmp_path / "moved.xml").write_text(moved.files["scene.xml"])
    there = sr.load(tmp_path / "moved.xml").lights[0]
    assert there.position == (-100.0, -200.0, -100.0) and there.intensity[0] == pytest.approx(8e4)
    with pytest.raises(Unsupported, match=r"lights\.key: Mitsuba's spot"):
        sr.export(lit(light | {"falloff": "smooth"}), "mitsuba")


def test_spots_go_to_pbrt_and_come_back(tmp_path: Path) -> None:
    light = {
        **DOWN,
        "direction": [0.3, -0.7, -3.1],
        "beam": 11.25,
        "cutoff": 27.75,
        "falloff": "smooth",
        "intensity": 3,
    }
    shapes = lit()["shapes"][:1]
    made = sr.export(lit(light, shapes=shapes, materials=WHITE), "pbrt")
    (tmp_path / "scene.pbrt").write_text(made.files["scene.pbrt"])
    back = sr.load(tmp_path / "scene.pbrt").lights[0]
    assert back.type == "spot" and back.falloff == "smooth"
    assert back.direction == (0.3, -0.7, -3.1) and back.position == (0.0, 0.0, HEIGHT)
    assert (back.beam, back.cutoff) == (11.25, 27.75) and back.intensity == (3.0, 3.0, 3.0)
    with pytest.raises(Unsupported, match=r"lights\.key: pbrt's spot"):
        sr.export(lit(light | {"falloff": "linear"}, shapes=shapes, materials=WHITE), "pbrt")


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"beam": 20, "cutoff": 20}, "cutoff must be larger than beam"),
        ({"beam": 30, "cutoff": 20}, "cutoff must be larger than beam"),
        ({"beam": -1, "cutoff": 20}, r"lights\[0\]\.beam: must be from 0 to 180"),
        ({"beam": 10, "cutoff": 181}, r"lights\[0\]\.cutoff: must be from 0 to 180"),
        ({"beam": 10, "cutoff": 20, "direction": [0, 0, 0]}, "direction must be longer than zero"),
        ({"beam": 10, "cutoff": 20, "falloff": "sharp"}, r"lights\[0\]\.falloff"),
    ],
)
def test_what_is_no_spot_is_refused(wrong: dict[str, Any], said: str) -> None:
    with pytest.raises(SceneError, match=said):
        sr.load(lit(DOWN | wrong))
