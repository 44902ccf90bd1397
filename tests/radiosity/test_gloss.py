"""Gloss and spheres among flat faces: furnaces, the split rule, paths, lattices, what is stated, what is refused."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from tests.radiometric.flats import ball, box, plane, rectangle, world
from tests.radiometric.test_materials import albedo_by_facets
from tests.radiosity.rooms import MATERIALS, closed, hostile, lamp, reflected_once

import symrender as sr
from symrender.errors import Unsupported
from symrender.numeric.radiometric.pipeline import rays as numeric_rays
from symrender.radiometric.shaken import shaken_rays
from symrender.radiometric.world import make_world
from symrender.radiosity import lobes, rings
from symrender.radiosity.records import make_scratch
from symrender.runtimes.bounce import Bouncer
from symrender.runtimes.radiosity import Gatherer, met
from symrender.scene.radiometric.arrays import radiometric_arrays

INDEX = {"eta": [0.2, 0.5, 1.2], "k": [3.0, 2.0, 4.0]}
GLOSSY: dict[str, Any] = {
    "ggx": {"type": "conductor", "alpha": 0.3} | INDEX,
    "smooth": {"type": "conductor", "alpha": 0.03, "masking": "correlated"} | INDEX,
    "beckmann": {"type": "conductor", "distribution": "beckmann", "alpha": 0.15} | INDEX,
    "phong": {"type": "phong", "exponent": 40, "reflectance": [0.5, 0.7, 0.2]},
    "broad": {"type": "phong", "exponent": 1.5, "reflectance": [0.5, 0.7, 0.2]},
    "coal": {"type": "diffuse", "reflectance": 0},
}


def toward(origin: Any, aims: Any) -> tuple[np.ndarray, np.ndarray]:
    """Unit rays from one place to others."""
    ways = np.asarray(aims, float) - np.asarray(origin, float)
    return np.tile(np.asarray(origin, float), (len(ways), 1)), ways / np.linalg.norm(ways, axis=1, keepdims=True)


@pytest.mark.parametrize("rule", [lobes.DEGREE_5, lobes.DEGREE_8], ids=["5", "8"])
def test_rules_of_triangles_are_exact_to_their_degree(rule: np.ndarray) -> None:
    degree = 5 if len(rule) == 7 else 8
    assert len(rule) == (7 if degree == 5 else 16) and (rule > 0).all()
    for i in range(degree + 2):
        for j in range(degree + 2 - i):
            got = float((rule[:, 3] * rule[:, 0] ** i * rule[:, 1] ** j).sum())
            exact = 2.0 * math.factorial(i) * math.factorial(j) / math.factorial(i + j + 2)
            if i + j <= degree:
                assert got == pytest.approx(exact, abs=2e-14)
    odd = abs(float((rule[:, 3] * rule[:, 0] ** (degree + 1)).sum()) - 2.0 / ((degree + 2) * (degree + 3)))
    assert odd > 1e-6, "a higher degree would be another rule"


@pytest.mark.parametrize("name", ["ggx", "smooth", "beckmann", "phong"])
def test_in_a_furnace_a_ball_reflects_its_directional_albedo(name: str) -> None:
    """Every wall emits 1: what is glossy sends its albedo for the direction, known by quadrature over half vectors."""
    walls = closed(material="coal")
    middle = ball("B", [0.5, 0.5, 0.5], 0.2, name)
    scene = sr.load(world(*walls, middle, lights=[lamp(w) for w in walls], materials=GLOSSY, bounces=0))
    origins, directions = toward([0.5, 0.02, 0.5], [[0.6, 0.5, 0.5]])
    seen = sr.probe(scene, rays=(origins, directions), tol=1e-5)
    assert set(seen.shape) == {"shapes.B"} and not seen.status.any() and seen.error.max() < 1e-5
    arrays = radiometric_arrays(scene)
    at, _ = met(make_world(arrays), origins, directions)
    material = arrays.materials[int(arrays.shapes[len(walls)].material)]
    for k, cosine in enumerate((at.normal * at.view).sum(axis=1).tolist()):
        wo = (math.sqrt(1 - cosine * cosine), 0.0, cosine)
        true = np.asarray(albedo_by_facets(material, wo, 128)) if name != "phong" else phong_albedo(cosine)
        assert 0.1 < true.max() < 1.0
        assert np.abs(seen.direct[k] - true).max() <= 1.5 * seen.error[k] + 1e-7, (k, seen.direct[k], true)


def phong_albedo(cosine: float) -> np.ndarray:
    """By a grid of directions about the mirror direction, the part below the horizon cut off."""
    nodes, weights = np.polynomial.legendre.leggauss(200)
    n, sine = 40.0, math.sqrt(1 - cosine * cosine)
    t = 0.5 * (nodes + 1)
    turn = math.pi * t
    total = 0.0
    for angle, w in zip(0.5 * math.pi * t, weights, strict=True):
        up = np.maximum(0.0, math.cos(angle) * cosine + math.sin(angle) * sine * np.cos(turn))
        total += 0.25 * math.pi * w * math.cos(angle) ** n * math.sin(angle) * float((weights * up).sum()) * math.pi
    return (n + 2) / (2 * math.pi) * total * np.array([0.5, 0.7, 0.2])


def crowd(seed: int) -> Any:
    """Balls over a floor, two of them lamps."""
    rng = np.random.default_rng(seed)
    shapes, placed = [plane("floor", [0, 0, 0], [0, 0, 1], ["ggx", "smooth", "beckmann", "phong"][seed % 4])], []
    for k in range(7):
        r, p = float(rng.uniform(0.1, 0.5)), rng.uniform(-1.3, 1.3, 3)
        # some touch the floor, but no lamp does: one that crosses another shape is refused
        p[2] = r + (0.0 if k > 1 and rng.random() < 0.4 else 0.05 + 0.5 * abs(p[2]))
        if all(np.linalg.norm(p - q) > r + s for q, s in placed):
            placed.append((p, r))
            shapes.append(ball(f"s{k}", p, r, "coal" if k % 2 else "phong"))
    lights = [lamp(shape, [3, 2, 1]) for shape in shapes[1:3]]
    return world(*shapes, lights=lights, materials=GLOSSY, bounces=0)


def test_lamps_are_what_the_split_rule_finds() -> None:
    """Spheres over spheres and a floor, twice: line by line between walls, and as parts beside circles."""
    lit, worst = 0, 0.0
    for seed in range(12):
        arrays = radiometric_arrays(sr.load(crowd(seed)))
        rng = np.random.default_rng([seed, 1])
        origins, directions = toward([0, -4, 2], np.column_stack([rng.uniform(-1.2, 1.2, (25, 2)), rng.random(25)]))
        pair = shaken_rays(arrays, origins, directions)
        for tol in (1e-3, 1e-6):
            one = Bouncer(arrays, True).sent(pair, tol, 1_000_000)
            two = Gatherer(arrays, tol, lamps=True).sent(pair, tol, 4_000_000)
            known = np.isfinite(one.error)
            off = np.abs(one.indirect - two.indirect).max(axis=1)[known]
            assert (two.error[known] <= tol).mean() > 0.9
            lit += int((one.indirect[known].max(axis=1) > 1e-3).sum())
            worst = max(worst, float((off / (one.error + two.error + 1e-13)[known]).max()))
    assert lit > 100 and worst <= 1.5, (lit, worst)


def test_an_edge_through_the_middle_of_a_lamp_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    """Rays that meet an edge near their origin turn within a small angle: the judge above told, two rules did not."""
    monkeypatch.setattr(rings, "_REACH", 1e300)
    scratch = make_scratch(1, 0)
    ring = scratch.circles[0]
    rings.put_ring(ring, (0.0, 0.0, 1.0), 0.3, 0, 1.0)
    # a square whose left edge passes the axis at a distance of 1e-3
    for k, (x, y) in enumerate([(1e-3, -0.5), (0.5, -0.5), (0.5, 0.5), (1e-3, 0.5)]):
        scratch.corners[0, 3 * k : 3 * k + 3] = x, y, 1.0
    scratch.sizes[0] = 4
    assert not rings.is_near(scratch, 0, ring)
    monkeypatch.undo()
    assert rings.is_near(scratch, 0, ring)


def glossy_room(bounces: Any, tint: str = "ggx") -> Any:
    """A lamp below the ceiling, a ball that touches the floor and a smooth box that stands on it."""
    glow = rectangle("glow", [0.3, 0.3, 0.98], [0, 0.4, 0], [0.4, 0, 0], "coal")
    shapes = [
        *closed(material="grey"), glow, ball("B", [0.3, 0.35, 0.2], 0.2, tint),
        box("block", [0.7, 0.65, 0.2], [0.3, 0.3, 0.4], 25.0, "smooth"),
    ]  # fmt: skip
    shapes[4]["material"] = "red"
    scene = world(*shapes, lights=[lamp(glow, [5, 4, 3])], materials=MATERIALS | GLOSSY, bounces=bounces)
    return scene | {"gloss": "first_hit"}


@pytest.mark.parametrize("bounces", [0, 1, "all"])
def test_rooms_with_gloss_are_those_of_paths(bounces: Any) -> None:
    scene = sr.load(glossy_room(bounces))
    aims = [*np.random.default_rng(3).uniform(0.05, 0.95, (12, 3)), [0.3, 0.3, 0.3], [0.25, 0.3, 0.15], [0.7, 0.6, 0.2]]
    origins, directions = toward([0.45, 0.03, 0.5], aims)
    seen = sr.probe(scene, rays=(origins, directions), tol=0.2 if bounces == "all" else 0.02)
    assert {"shapes.B", "shapes.block", "shapes.floor"} <= set(seen.shape) and (seen.status == 0).mean() > 0.85
    arrays = radiometric_arrays(scene)
    runs = [numeric_rays(arrays, origins, directions, order=32, seed=k) for k in range(10)]
    for name, part in (("direct", 1), ("indirect", 2)):
        drawn = np.array([run[part] for run in runs])
        mean, wide = drawn.mean(axis=0), drawn.std(axis=0, ddof=1) / math.sqrt(len(runs))
        value = getattr(seen, name)
        assert (np.abs(mean - value) <= 1.5 * seen.error[:, None] + 6 * wide).all(), name
        bright = value > 0.02
        if name == "direct" or bounces:
            assert bright.sum() >= 15
            z = (mean - value)[bright] / np.hypot(wide, seen.error[:, None] / 6)[bright]
            assert abs(float(z.mean())) < 2 and np.abs(z).max() < 8
        else:
            assert not value.any()


def test_gloss_at_the_first_hit_alone_is_dark_to_others() -> None:
    """A place that sees the ball sees it black: with a black ball the diffuse faces are the same."""
    first, coal = sr.load(glossy_room(1)), sr.load(glossy_room(1, "coal"))
    origins, directions = toward([0.45, 0.03, 0.5], [[0.75, 0.3, 0.0], [0.6, 0.4, 0.0], [0.0, 0.7, 0.6]])
    a, b = (sr.probe(scene, rays=(origins, directions), tol=0.02) for scene in (first, coal))
    assert set(a.shape) == {"shapes.floor", "shapes.left"} and a.indirect.min(axis=0).max() > 0.01
    assert (np.abs(a.indirect - b.indirect).max(axis=1) <= a.error + b.error).all()
    every = radiometric_arrays(first.replace({"gloss": "every_hit"}))
    all_gloss = numeric_rays(every, origins, directions, order=100)[2]
    assert (all_gloss - a.indirect)[:, 0].max() > 5 * a.error.max(), "a ball that reflects to others is another scene"


def test_balls_before_faces_state_what_they_are_off() -> None:
    """Hostile rooms with black balls that touch walls, floor and each other, against lattices of rays."""
    judged = lit = 0
    for seed, scale in enumerate((1.0, 1e-3, 1e2)):
        scene = hostile(seed, 1.0)
        scene["shapes"] = scene["shapes"][:6]
        scene["shapes"] += [
            box("block", [0.35, 0.75, 0.15], [0.3, 0.2, 0.3], 20.0 * seed, "both"),
            ball("one", [0.7, 0.25, 0.2], 0.2, "coal"), ball("two", [0.7, 0.25, 0.55], 0.15, "coal"),
            ball("three", [0.05, 0.6, 0.6], 0.05, "coal"),
        ]  # fmt: skip
        scene["materials"] |= {"coal": GLOSSY["coal"]}
        scaled(scene, scale)
        small = make_world(radiometric_arrays(sr.load(scene)))
        origins, directions = toward([0.2 * scale, 0.15 * scale, 0.45 * scale], scale * BALL_AIMS)
        seen = sr.probe(scene, rays=(origins, directions), tol=0.02)
        at, albedo = met(small, origins, directions)
        for i in np.flatnonzero(albedo.max(axis=1) > 0.0).tolist():
            mean, wide = reflected_once(scene, at.place[i], at.normal[i], 4000, 7 * seed + i)
            off = np.abs(albedo[i] * mean - seen.indirect[i])
            assert (off <= 1.5 * seen.error[i] + 6.0 * albedo[i] * wide + 1e-12).all(), (seed, i, off, seen.error[i])
            judged, lit = judged + 1, lit + int(seen.indirect[i].max() > 10 * seen.error[i])
    assert judged >= 8 and lit >= 6, (judged, lit)


BALL_AIMS = np.array([[0.62, 0.3, 0.0], [0.7, 0.6, 0.0], [1.0, 0.3, 0.3], [0.0, 0.62, 0.66], [0.5, 1.0, 0.3]])


def scaled(scene: Any, scale: float) -> None:
    """Make a scene ``scale`` times as large."""
    for shape in scene["shapes"]:
        for key in ("corner", "edge_u", "edge_v", "center", "size"):
            if key in shape:
                shape[key] = [scale * c for c in shape[key]]
        if "vertices" in shape:
            shape["vertices"] = [[scale * c for c in v] for v in shape["vertices"]]
        if "radius" in shape:
            shape["radius"] *= scale
    for light in scene["lights"]:
        light["position"] = [scale * c for c in light["position"]]
        light["intensity"] = [scale * scale * c for c in light["intensity"]]


def refused(words: str, scene: Any, **more: Any) -> None:
    with pytest.raises(Unsupported, match=words):
        sr.probe(scene | more, rays=([0.45, 0.03, 0.5], [0, 1, 0]), tol=1e-2)


def test_what_is_not_had_is_refused_by_name() -> None:
    refused("reflects after the first hit too", glossy_room(1), gloss="every_hit")
    refused("a diffuse sphere", glossy_room("all", "white"))
    room = glossy_room(1)
    walter = GLOSSY["beckmann"] | {"g1": "walter"}
    refused("g1: walter", room, materials=room["materials"] | {"ggx": walter})
    sunk = [*room["shapes"], ball("sunk", [0.8, 0.2, 0.05], 0.1, "ggx")]
    refused(r"shapes\[9\] and shapes\[0\] cross", room, shapes=sunk)
    held = [*room["shapes"], ball("held", [0.3, 0.35, 0.2], 0.1, "ggx")]
    refused(r"shapes\[7\] and shapes\[9\] cross", room, shapes=held)
    shining = [*room["lights"], lamp(room["shapes"][7])]
    refused("a sphere that emits", room, lights=shining)
    plain = {"ggx": GLOSSY["ggx"], "smooth": GLOSSY["ggx"], "coal": GLOSSY["coal"]}
    for form in ("mitsuba", "pbrt"):
        with pytest.raises(Unsupported, match=f"gloss: {form}: materials.ggx reflects at every hit there"):
            sr.export(room | {"materials": MATERIALS | plain}, form)  # type: ignore[call-overload]
    plates = world(
        *closed(material="coal"), ball("B", [0.5, 0.5, 0.5], 0.2, "walter"), lights=[lamp(closed()[1])],
        materials=GLOSSY | {"walter": walter}, bounces=0,
    )  # fmt: skip
    refused("a box or a mesh, and a conductor of g1: walter", plates)


@pytest.mark.parametrize("bounces", [0, 1])
def test_a_ray_does_not_know_its_neighbours(bounces: int) -> None:
    """A glossy checker's fields are as fine as its brightest wherever they are asked, alone, in a batch or a tile."""
    tiles = {
        "type": "phong",
        "exponent": 20,
        "reflectance": {"type": "checker", "bright": 0.8, "dark": 0.1, "cell": 0.1},
    }
    key = {"type": "point", "name": "key", "position": [0.7, 0.3, 0.8], "intensity": [1, 0.8, 0.5]}
    rug = rectangle("rug", [0.1, 0.1, 0.2], [0.6, 0, 0], [0, 0.6, 0], "tiles")
    glow = rectangle("glow", [0.3, 0.3, 0.999], [0, 0.4, 0], [0.4, 0, 0])
    scene = world(
        *closed(), rug, glow, lights=[key, lamp(glow, [5, 4, 3])], materials=MATERIALS | {"tiles": tiles},
        bounces=bounces, gloss="first_hit",
    )  # fmt: skip
    scene["camera"] = {"type": "look_at", "eye": [0.5, 0.2, 0.9], "target": [0.41, 0.4, 0.2], "fov": 50}
    one, two = (sr.truth(scene, size=(8, 6), tol=1e-2, tile=side, threads=1) for side in (1, 8))
    assert len(np.unique(one.layer("radiance").round(6))) > 40
    for name, layer in one.layers.items():
        np.testing.assert_array_equal(layer, two.layers[name], name)
    rng = np.random.default_rng(0)
    origins = np.tile([0.5, 0.2, 0.9], (12, 1))
    directions = np.column_stack([rng.uniform(0.12, 0.68, (12, 2)), np.full(12, 0.2)]) - origins
    every = sr.probe(scene, rays=(origins, directions), tol=1e-2)
    assert set(every.shape) == {"shapes.rug"}
    for k in range(12):
        alone = sr.probe(scene, rays=(origins[k], directions[k]), tol=1e-2)
        assert (alone.radiance == every.radiance[k]).all() and alone.error[0] == every.error[k]
