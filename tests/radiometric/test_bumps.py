"""Bumps: 60 digits, closed forms, meridians, Mitsuba's bumpmap, both pipelines, derivatives, limits and refusals."""

from __future__ import annotations

import json
import math
from collections import Counter
from pathlib import Path
from typing import Any

import mpmath
import numpy as np
import pytest
from tests.radiometric import flats, heights, meridians

import symrender as sr
from symrender.cli import main
from symrender.errors import SceneError, Unsupported
from symrender.limits import MAX_FORMULA_DEPTH, MAX_TERMS
from symrender.numeric.radiometric.pipeline import rays as numeric_rays
from symrender.scene.dump import to_yaml
from symrender.scene.radiometric.arrays import radiometric_arrays

SUN = {"type": "directional", "name": "sun", "direction": [-0.3, 0.4, -1.0], "irradiance": [3.0, 2.0, 1.0]}
KEY = {"type": "point", "name": "key", "position": [1.5, -2.0, 2.5], "intensity": [30.0, 20.0, 10.0]}
METAL = {"type": "conductor", "alpha": 0.3, "eta": [0.2, 0.9, 1.1], "k": [3.9, 2.4, 2.1]}
RECORDED = json.loads((Path(__file__).resolve().parent.parent / "data" / "mitsuba_bumps.json").read_text("utf-8"))


def bumped(bump: dict[str, Any] | None, **more: Any) -> dict[str, Any]:
    """One of every shape that has coordinates of its own, of every kind of material, all with this bump."""
    materials: dict[str, Any] = {
        "clay": {"type": "diffuse", "reflectance": [0.8, 0.5, 0.3], "two_sided": True},
        "metal": METAL,
        "wax": {"type": "phong", "exponent": 20, "reflectance": 0.5},
    }
    if bump is not None:
        materials = {name: material | {"bump": bump} for name, material in materials.items()}
    shapes = [
        flats.plane("floor", [0.1, 0.2, 0], [0, 0, 1], "clay"),
        flats.ball("ball", [-0.6, 0, 0.7], 0.7, "metal"),
        flats.ball("pearl", [0.9, -0.6, 0.45], 0.4, "clay"),
        flats.disk("disk", [1.6, 1, 0.8], [-1, -1, 0.2], 0.8, "wax"),
        flats.rectangle("wall", [-2, 1.6, 0.1], [2, 0.5, 0], [0.2, 0, 1.5], "clay"),
        flats.triangle("sail", [[-2.5, 0, 0.1], [-1.6, 0.4, 0.2], [-2.2, 0.2, 1.6]], "metal"),
    ]
    return flats.world(*shapes, lights=[SUN, KEY], materials=materials) | more


def rays(rng: np.random.Generator, count: int, shape: dict[str, Any] | None = None) -> tuple[Any, Any]:
    """Rays to anywhere, or to about the middle of a shape."""
    origins = np.tile([0.0, -5.0, 2.5], (count, 1)) + rng.normal(size=(count, 3)) * 0.3
    ways = np.column_stack([rng.uniform(-2.5, 2.5, count), rng.uniform(-1.5, 2, count), rng.uniform(0, 1.5, count)])
    if shape is not None and shape["type"] != "plane":
        middle = np.array(shape["center"] if shape["type"] == "sphere" else [-0.9, 1.9, 0.85])
        ways = middle + rng.uniform(-0.5, 0.5, (count, 3))
    ways -= origins
    return origins, ways / np.linalg.norm(ways, axis=1)[:, None]


def own_axes(shape: dict[str, Any]) -> tuple[list[Any], list[Any], list[Any]]:
    """(origin, along x, along y) of a shape's own coordinates, in many digits."""
    if shape["type"] == "sphere":
        return heights.exact(shape["center"]), [], []
    if shape["type"] == "rectangle":
        e = heights.unit(heights.exact(shape["edge_u"]))
        n = heights.unit(heights.cross(heights.exact(shape["edge_u"]), heights.exact(shape["edge_v"])))
        return heights.exact(shape["corner"]), e, heights.cross(n, e)
    if shape["type"] == "triangle":
        a, b, c = (heights.exact(v) for v in shape["vertices"])
        u, v = ([x - y for x, y in zip(p, a, strict=True)] for p in (b, c))
        e, n = heights.unit(u), heights.unit(heights.cross(u, v))
        return a, e, heights.cross(n, e)
    n = heights.unit(heights.exact(shape["normal"]))
    along = heights.exact(shape.get("along", [1, 0, 0]))
    part = heights.dot(along, n)
    e = heights.unit([a - part * b for a, b in zip(along, n, strict=True)])
    return heights.exact(shape["point" if shape["type"] == "plane" else "center"]), e, heights.cross(n, e)


def hit(shape: dict[str, Any], origin: list[Any], way: list[Any]) -> tuple[list[Any], list[Any], bool]:
    """(place, unit normal, whether the normal looks away) where a line meets a shape's surface first."""
    origin_, e, f = own_axes(shape)
    offset = [a - b for a, b in zip(origin, origin_, strict=True)]
    if shape["type"] == "sphere":
        b, c = heights.dot(offset, way), heights.dot(offset, offset) - mpmath.mpf(shape["radius"]) ** 2
        reach = -b - mpmath.sqrt(b * b - c)
        place = [o + reach * w for o, w in zip(origin, way, strict=True)]
        return place, heights.unit([p - q for p, q in zip(place, origin_, strict=True)]), False
    n = heights.cross(e, f)
    slope = heights.dot(n, way)
    reach = -heights.dot(n, offset) / slope
    return [o + reach * w for o, w in zip(origin, way, strict=True)], n, slope > 0


@pytest.mark.parametrize("coordinates", ["world", "own"])
@pytest.mark.parametrize("normals", ["shading", "geometric"])
def test_a_diffuse_surface_has_the_normal_of_the_raised_one(coordinates: str, normals: str) -> None:
    rng = np.random.default_rng([3, len(coordinates), len(normals)])
    judged, cut, dark, behind, turned = Counter[str](), 0, 0, 0, 0.0
    for seed in range(12):
        bump = {"height": heights.varied(rng), "amplitude": float(rng.uniform(0.2, 0.8)),
                "coordinates": coordinates, "normals": normals}  # fmt: skip
        scene = bumped(bump, lights=[SUN | {"direction": [*rng.uniform(-1, 1, 2).tolist(), -0.4 - 0.1 * seed]}])
        # by itself nothing is hidden, and the judge knows no shadows
        for shape in scene["shapes"]:
            if scene["materials"][shape["material"]]["type"] != "diffuse":
                continue
            alone = sr.load(scene | {"shapes": [shape]})
            origins, ways = rays(rng, 10, shape)
            if seed % 3 == 0 and shape["type"] == "rectangle":
                # from behind
                origins, ways = origins + 30.0 * ways, -ways
            found = sr.probe(alone, rays=(origins, ways), tol=1e-9)
            for k in np.flatnonzero(np.array(found.shape) != "nothing"):
                with mpmath.workdps(heights.DIGITS):
                    way = heights.unit(heights.exact(ways[k]))
                    place, normal, back = hit(shape, heights.exact(origins[k]), way)
                    axes = own_axes(shape) if coordinates == "own" else None
                    n = heights.raised_normal(bump, place, normal, axes)
                    if back:
                        n, normal = [-x for x in n], [-x for x in normal]
                    light = heights.unit([-x for x in heights.exact(scene["lights"][0]["direction"])])
                    a, b, c = heights.dot(n, light), heights.dot(normal, light), -heights.dot(n, way)
                    cosine = (a if normals == "shading" else b) if a > 0 and b > 0 and c > 0 else mpmath.mpf(0)
                    expected = np.array([float(r * e * cosine / mpmath.pi) for r, e in zip(
                        scene["materials"]["clay"]["reflectance"], SUN["irradiance"], strict=True)])  # fmt: skip
                    cut += bool(a > 0 and b <= 0) or bool(a <= 0 and b > 0)
                    dark += bool(c <= 0)
                    turned = max(turned, 1.0 - float(heights.dot(n, normal)))
                apart = np.abs(found.direct[k] - expected).max()
                assert apart <= found.error[k] + 1e-14, (seed, shape["name"], k)
                judged[shape["type"]] += bool(expected.max() > 1e-3)
                behind += back
    assert min(judged[kind] for kind in ("plane", "sphere", "rectangle")) > 20 and judged.total() > 120
    assert cut > 5 and dark > 2 and behind > 10 and turned > 0.2


def test_both_pipelines_see_the_same_bumps() -> None:
    rng = np.random.default_rng(5)
    bright, worst, shapes = 0, 0.0, Counter[str]()
    for seed in range(24):
        bump = {"height": heights.varied(rng, 5), "amplitude": float(rng.uniform(0.1, 0.9)),
                "coordinates": ("world", "own")[seed % 2],
                "normals": ("shading", "geometric")[seed // 2 % 2]}  # fmt: skip
        scene = sr.load(bumped(bump))
        origins, ways = rays(rng, 150)
        closed = sr.probe(scene, rays=(origins, ways), tol=1e-6)
        traced = numeric_rays(radiometric_arrays(scene), origins, ways)[1]
        apart, size = np.abs(closed.direct - traced).max(axis=1), np.abs(traced).max(axis=1)
        assert (apart <= closed.error + 1e-12 * np.maximum(size, 1.0)).all(), seed
        worst = max(worst, float((apart / np.maximum(size, 1e-2)).max()))
        bright += int((size > 1e-2).sum())
        shapes.update(name for name, lit in zip(closed.shape, size > 1e-2, strict=True) if lit)
    assert bright > 1200 and min(shapes.values()) > 15 and len(shapes) == 6
    assert worst < 1e-9


@pytest.mark.parametrize("ray", RECORDED["rays"], ids=lambda ray: ray["scene"]["name"])
def test_direct_light_is_that_of_mitsubas_bumpmap(ray: dict[str, Any]) -> None:
    found = sr.probe(ray["scene"], rays=(ray["origin"], ray["direction"]), tol=1e-9)
    assert found.status[0] == 0 and found.shape == ("shapes.floor",)
    expected = np.array(ray["direct"])
    # a sine is sampled, and of the rest single precision leaves so much
    limit = 1e-4 if "sine" in ray["scene"]["name"] else 3e-5
    assert np.abs(found.direct[0] - expected).max() <= limit * max(expected.max(), 1e-7)


def test_the_recorded_rays_cover_what_they_should() -> None:
    lit = Counter(ray["scene"]["name"].split(", ")[2] for ray in RECORDED["rays"] if max(ray["direct"]) > 1e-4)
    assert RECORDED["mitsuba"] == "3.9.1" and len(RECORDED["rays"]) == 72
    # what is above the turned horizon alone is dark in both
    assert lit["high"] > 10 and lit["sun"] > 10 and lit["low"] > 5 and "below" not in lit
    below = [ray for ray in RECORDED["rays"] if "slope" in ray["scene"]["name"] and "below" in ray["scene"]["name"]]
    assert len(below) == 6 and sr.probe(
        below[0]["scene"] | {"lights": [below[0]["scene"]["lights"][0] | {"position": [-5, -5, 0.4]}]},
        rays=(below[0]["origin"], below[0]["direction"]),
    ).direct.max() > 0.01  # fmt: skip


@pytest.mark.parametrize("tilt", [1e-6, 0.3, 1.0, 1.5])
@pytest.mark.parametrize("normals", ["shading", "geometric"])
def test_a_tilted_sky_is_a_lune(tilt: float, normals: str) -> None:
    """A height tan(t) x turns the normal by t, and between both horizons E = pi (1 + cos t)/2 of either cosine."""
    bump = {"height": {"mul": [math.tan(tilt), "x"]}, "normals": normals}
    material = flats.WHITE | {"bump": bump}
    scene = flats.world(flats.plane("floor", [0, 0, 0], [0, 0, 1]), lights=[flats.SKY], materials={"white": material})
    found = sr.probe(scene, rays=([-1, 0, 2], [0.5, 0, -1]))
    assert found.direct[0, 0] == pytest.approx((1 + math.cos(tilt)) / 2, abs=1e-14) and found.status[0] == 0
    seen_from_behind = sr.probe(scene, rays=([3, 0, 0.1], [-1, 0, -0.1]))
    assert (seen_from_behind.direct[0, 0] == 0.0) == (math.tan(tilt) > 0.1)


@pytest.mark.parametrize("normals", ["shading", "geometric"])
def test_hostile_contacts_are_what_meridians_see(normals: str) -> None:
    judged = lit = met = cut = 0
    for seed in range(30_000, 30_012):
        scene, own, place, normal, lamp = flats.contact(seed)
        rng = np.random.default_rng([seed, 4])
        # slopes along axes too, which are those of the scene's own edges
        slope = rng.normal(size=2) * float(rng.choice([1e-9, 0.3, 0.7, 2.0])) * rng.choice([0.0, 1.0, 1.0], 2)
        form = {"add": [{"mul": [float(slope[0]), "x"]}, {"mul": [float(slope[1]), "y"]}]}
        for name in ("white", "both"):
            scene["materials"][name] = scene["materials"][name] | {"bump": {"height": form, "normals": normals}}
        size = max(abs(place).max(), 1e-4)
        toward = np.array([-0.2 * slope[0], -0.2 * slope[1], 1.0])
        try:
            found = sr.probe(scene, rays=(place + 1e-7 * size * toward, -toward), tol=1e-6)
        except Unsupported:
            continue
        if found.shape[0] != f"shapes.{own}":
            continue
        turned = np.array([-slope[0], -slope[1], 1.0]) / math.sqrt(1 + slope @ slope)
        by, other = (turned, normal) if normals == "shading" else (normal, turned)
        true, known = (x / math.pi for x in meridians.irradiance(scene["shapes"], own, place, by, lamp, other))
        assert known < 1e-4 and abs(found.direct[0, 0] - true) <= 1.5 * found.error[0] + known + 1e-9, seed
        judged, lit, met = judged + 1, lit + (true > 1e-6), met + (found.status[0] == 0)
        cut += true > 1e-6 and slope @ slope > 0.1
    assert judged > 7 and lit > 2 and met > 4 and cut > 1


def test_a_height_of_nothing_changes_nothing() -> None:
    height = {"mul": [0.3, {"sin": {"mul": [7, "x"]}}]}
    lights: list[list[dict[str, Any]]] = [[SUN, KEY], [flats.SKY], [flats.area("pearl", [3, 2, 1])]]
    for given in lights:
        flat, still = (bumped(bump, lights=given) for bump in (None, {"height": height, "amplitude": 0.0}))
        if given[0]["type"] != "directional":
            # a sky and a lamp over what is glossy are a lobe's integral, and those of a disk beside spheres are refused
            for scene in (flat, still):
                scene["shapes"] = [shape | {"material": "clay"} for shape in scene["shapes"] if shape["name"] != "disk"]
        a, b = (sr.truth(scene, size=(24, 16), tol=1e-6) for scene in (flat, still))
        assert a.radiance.max() > 0.05 and (a.radiance.max(axis=2) > 1e-3).sum() > 150
        assert np.abs(a.radiance - b.radiance).max() < 1e-12 * a.radiance.max()
        there = sr.truth(sr.load(still).replace({"materials.clay.bump.amplitude": 0.3}), size=(24, 16), tol=1e-6)
        assert np.abs(there.radiance - a.radiance).max() > 0.01


def test_lamps_and_skies_are_those_of_the_path_tracer() -> None:
    height = {"mul": [0.3, {"sin": {"add": [{"mul": [6, "x"]}, {"pow": ["y", 2]}]}}]}
    sizes = []
    for normals in ("shading", "geometric"):
        scene = bumped({"height": height, "normals": normals}, lights=[flats.SKY, flats.area("wall", [3, 2, 1])])
        scene["shapes"] = [shape | {"material": "clay"} for shape in scene["shapes"] if shape["name"] != "disk"]
        scene = sr.load(scene)
        image = sr.truth(scene, size=(20, 12), tol=1e-6)
        draws = np.array([
            sr.render(scene, size=(20, 12), numeric="jittered", symbolic="none", lobe=16, seed=seed).numeric.radiance
            for seed in range(12)
        ])  # fmt: skip
        mean, sigma = draws.mean(axis=0), draws.std(axis=0, ddof=1) / math.sqrt(len(draws))
        z = (mean - image.radiance) / np.maximum(sigma, 1e-4)
        assert (image.radiance.max(axis=2) > 0.05).sum() > 150
        # twelve draws: of 720 values that follow Student's t the largest is about 5
        assert np.abs(z).max() < 8.0 and np.sqrt((z**2).mean()) < 1.3
        sizes.append(image.radiance)
    assert np.abs(sizes[0] - sizes[1]).max() > 0.02


@pytest.mark.parametrize("end", ["amplitude", "height.mul[0]", "height.mul[1].sin.add[0].mul[0]",
                                 "height.mul[1].sin.add[1].distance[0]"])  # fmt: skip
def test_derivatives_are_differences(end: str) -> None:
    height = {"mul": [0.3, {"sin": {"add": [{"mul": [6, "x"]}, {"distance": [0.2, -0.4, 0.1]}]}}]}
    scene = bumped({"height": height, "amplitude": 0.7})
    for material in ("metal", "wax"):
        scene["materials"][material].pop("bump")
    scene = sr.load(scene)
    name, size, step = f"materials.clay.bump.{end}", (24, 16), 1e-5
    value = {p.name: p.value for p in scene.parameters()}[name]
    slope = sr.gradient(scene, [name], size=size)[name]
    there, here = (sr.truth(scene.replace({name: value + s}), size=size).radiance for s in (step, -step))
    difference = (there - here) / (2 * step)
    met = np.abs(difference).max(axis=2) > 1e-3
    assert met.sum() > 80 and not slope.layer("status").any()
    apart = np.abs(slope.radiance - difference).max(axis=2)
    # a pixel whose normal passes a horizon within the step has no difference
    assert np.quantile(apart, 0.98) < 1e-7 * np.abs(difference).max()


def test_scaled_scenes_are_the_same() -> None:
    values = []
    for scale in (1e-4, 1.0, 1e3):
        height = {"sin": {"mul": [9.0 / scale, "x"]}}
        material = {"type": "diffuse", "reflectance": 0.8, "bump": {"height": height, "amplitude": 0.05 * scale}}
        floor = flats.plane("floor", [0, 0, 0], [0, 0, 1])
        ball = flats.ball("ball", np.array([0.3, 0, 0.5]) * scale, 0.5 * scale)
        key = KEY | {"position": [1.5 * scale, -2 * scale, 2.5 * scale], "intensity": 30 * scale**2}
        camera = {"type": "look_at", "eye": [0, -3 * scale, 2 * scale], "target": [0, 0, 0.0]}
        scene = flats.world(floor, ball, lights=[key], materials={"white": material}, camera=camera)
        rng = np.random.default_rng(2)
        ways = np.column_stack([rng.uniform(-1, 1, 60), rng.uniform(-1, 1, 60), np.zeros(60)]) - [0.0, -3.0, 2.0]
        found = sr.probe(scene, rays=(np.tile([0.0, -3 * scale, 2 * scale], (60, 1)), ways), tol=1e-9)
        values.append(found.direct[:, 0])
        assert (found.status == 0).all()
    assert values[1].max() > 0.3 and (values[1] > 0.01).sum() > 40 and np.ptp(values[1]) > 0.2
    np.testing.assert_allclose(values[0], values[1], rtol=1e-11, atol=1e-13)
    np.testing.assert_allclose(values[2], values[1], rtol=1e-11, atol=1e-13)


def test_what_is_no_number_is_unsupported() -> None:
    """A slope beyond all numbers turns normals to nowhere: nothing is stated of it, in values and derivatives."""
    steep = {"mul": [1e12] * 14 + ["x"]}
    grown = {"exp": {"mul": [1e3, "x"]}}
    for height in (steep, {"mul": [steep, steep]}, grown):
        scene = bumped({"height": height, "amplitude": 1e12})
        image = sr.truth(scene, size=(24, 16), tol=1e-3)
        lost = image.layer("status") == 3
        assert lost.sum() > 50 and np.isinf(image.layer("error")[lost]).all() and not image.radiance[lost].any()
        assert np.isfinite(image.radiance).all() and np.isfinite(image.layer("error")[~lost]).all()
        traced = sr.render(scene, size=(24, 16), symbolic="none").numeric
        assert np.isfinite(traced.radiance).all()
        seen = sr.probe(scene, rays=([0.4, -5, 2.5], [0.4, 4.0, -2.4]))
        assert seen.status[0] in (0, 3) and np.isfinite(seen.radiance).all()
        name = "materials.clay.bump.amplitude"
        slope = sr.gradient(scene, [name], size=(24, 16))[name]
        assert (slope.layer("status")[lost] == 3).all()


WRONG: list[tuple[Any, str]] = [
    ({"sinn": "x"}, r"bump\.height\.sinn: unknown operation, did you mean 'sin'"),
    ({"sin": "t"}, r"bump\.height\.sin: must be a number, x, y, z or a mapping of one operation, got the text 't'"),
    ({"sin": "x", "cos": "x"}, r"bump\.height: must be a mapping of one operation, got 2 keys"),
    ({"mul": ["x", True]}, r"bump\.height\.mul\[1\]: must be a number, got true"),
    ({"mul": [10**400, "x"]}, r"must be finite|at most 1e\+12"),
    ({"add": ["x"]}, r"bump\.height\.add: must be a list of 2 to 16 formulas"),
    ({"pow": ["x", 0.5]}, r"bump\.height\.pow\[1\]: must be a whole number from 1 to 16, got 0\.5"),
    ({"pow": ["x", 17]}, r"from 1 to 16, got 17"),
    ({"distance": [0, 0]}, r"bump\.height\.distance: must be a list of 3 numbers"),
    ({"mul": [2, 3]}, r"must depend on x, y or z"),
    ("__import__('os').abort()", r"must be a number, x, y, z or a mapping"),
]  # fmt: skip


@pytest.mark.parametrize(("height", "words"), WRONG)
def test_formulas_are_data_and_faults_are_named(height: Any, words: str) -> None:
    with pytest.raises(SceneError, match=words):
        sr.load(bumped({"height": height}))


def test_formulas_have_limits() -> None:
    deep: Any = "x"
    for _ in range(MAX_FORMULA_DEPTH):
        deep = {"sin": deep}
    with pytest.raises(SceneError, match=f"at most {MAX_FORMULA_DEPTH} deep"):
        sr.load(bumped({"height": deep}))
    wide = {"add": [{"mul": ["x"] * 16}] * 3}
    with pytest.raises(SceneError, match=f"at most {MAX_TERMS} numbers"):
        sr.load(bumped({"height": wide}))
    fits = {"add": [{"mul": ["x"] * 16}, {"mul": ["y"] * 16}]}
    assert sr.load(bumped({"height": fits})).hash


def test_a_fault_has_line_and_column(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = to_yaml(sr.load(bumped({"height": {"mul": [0.5, {"sin": "x"}]}})))
    path = tmp_path / "scene.yaml"
    path.write_text(text.replace('{sin: "x"}', '{sin: "q"}', 1))
    line = next(k for k, row in enumerate(path.read_text().splitlines(), 1) if '"q"' in row)
    column = path.read_text().splitlines()[line - 1].index("sin") + 1
    assert main(["truth", str(path), "--size", "4", "--out", str(tmp_path)]) == 2
    said = capsys.readouterr().err
    assert f"scene.yaml:{line}:{column}: materials.clay.bump.height.mul[1].sin: must be" in said
    assert "Traceback" not in said and "got the text 'q'" in said


def test_names_and_files_of_formulas(tmp_path: Path) -> None:
    height = {"mul": [0.5, {"sin": {"add": [{"mul": [6, "x"]}, {"pow": ["y", 2]}]}}]}
    scene = sr.load(bumped({"height": height}))
    names = [p.name for p in scene.parameters() if p.name.startswith("materials.clay.bump.")]
    assert names == [f"materials.clay.bump.{end}" for end in (
        "height.mul[0]", "height.mul[1].sin.add[0].mul[0]", "amplitude")]  # fmt: skip
    for suffix, text in (("yaml", to_yaml(scene)), ("json", scene.model_dump_json())):
        (tmp_path / f"scene.{suffix}").write_text(text)
        assert sr.load(tmp_path / f"scene.{suffix}").hash == scene.hash
    other = scene.replace({names[1]: 7.0})
    assert other.hash != scene.hash and other.replace({names[1]: 6.0}) == scene
    assert sr.load(bumped(None)).hash == sr.load(bumped(None)).replace({"materials.clay.bump": None}).hash
    with pytest.raises(SceneError, match="unknown name 'cos'"):
        scene.replace({"materials.clay.bump.height.cos": 1.0})
    with pytest.raises(SceneError, match="is not a real number"):
        sr.gradient(scene, ["materials.clay.bump.height.mul[1].sin.add[1].pow[1]"], size=2)


@pytest.mark.parametrize(("change", "words"), [
    ({"bounces": 1, "lights[0]": flats.SKY}, r"bounces: 1 is not yet integrated over a bump, that of shapes\[0\]"),
    ({"bounces": "all"}, r"bounces: all is not yet integrated over a bump"),
    ({"shutter": [0.0, 1.0], "shapes[1].velocity": [1.0, 0.0, 0.0]}, "a lens or a shutter: is not yet integrated over"),
    ({"camera.aperture": 0.1}, "a lens or a shutter: is not yet integrated over a bump"),
    ({"lights[0]": flats.SKY}, r"a sky over a conductor or a phong material with a bump, that of shapes\[1\]"),
])  # fmt: skip
def test_what_is_not_had_is_refused_by_name(change: dict[str, Any], words: str) -> None:
    scene = sr.load(bumped({"height": {"sin": "x"}})).replace(change)
    with pytest.raises(Unsupported, match=words):
        sr.truth(scene, size=4, filter="box" if "camera.aperture" in change else "centre", method="quadrature")


def test_more_that_is_refused() -> None:
    scene = sr.load(bumped({"height": {"sin": "x"}}))
    with pytest.raises(Unsupported, match="filter: box: is not yet integrated where a sky shines on a bump"):
        clay = bumped({"height": {"sin": "x"}}, lights=[flats.SKY])
        clay["shapes"] = [
            shape | {"material": "clay"} for shape in clay["shapes"] if shape["type"] in ("plane", "sphere")
        ]
        sr.truth(clay, size=4, filter="box", method="quadrature")
    with pytest.raises(Unsupported, match="gradient: filter: box over a bump"):
        sr.gradient(scene, ["camera.fov"], size=4, filter="box")
    for target in ("mitsuba", "pbrt"):
        with pytest.raises(Unsupported, match="bump"):
            sr.export(scene, target)
    own = bumped({"height": {"sin": "x"}, "coordinates": "own"})
    own["shapes"].append(flats.box("crate", [3, 3, 1], [1, 1, 1], 10, "clay"))
    with pytest.raises(SceneError, match=r"shapes\[6\]\.material: 'clay' has a bump in coordinates: own, and a box"):
        sr.load(own)
    # a material that no shape has is no bump of the scene
    unused = sr.load(bumped(None)).replace({"materials.clay.bump": {"height": {"sin": "x"}}, "bounces": 0})
    assert sr.truth(unused, size=4).radiance.max() > 0
