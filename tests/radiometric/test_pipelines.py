"""Both pipelines end to end: they agree ray by ray, error holds, bounces return what closed forms and Mitsuba say."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import symrender as sr
from symrender.errors import OptionError, Unsupported
from symrender.numeric.radiometric.pipeline import rays as numeric_rays
from symrender.scene.radiometric.arrays import radiometric_arrays

DATA = json.loads((Path(__file__).resolve().parent.parent / "data" / "mitsuba_rays.json").read_text("utf-8"))

LOOK = {"type": "look_at", "eye": [0, 0, 0], "target": [1, 0.2, 0.1]}


def crowd(seed: int) -> dict[str, Any]:
    """A scene of everything there is: textures, materials, shapes in and behind each other, lights anywhere."""
    random = np.random.default_rng(seed)
    texture = {"bright": [0.9, 0.8, 0.7], "dark": [0.1, 0.2, 0.3]}
    metal = {"type": "conductor", "eta": [0.2, 0.9, 1.1], "k": [3.9, 2.4, 2.1]}
    materials = {
        "checker": {"type": "diffuse", "reflectance": {"type": "checker", "cell": 0.37} | texture, "two_sided": True},
        "stripes": {"type": "phong", "exponent": 40, "reflectance": {"type": "stripes", "cell": 0.25} | texture},
        "marble": metal | {"alpha": 0.2, "reflectance": {"type": "marble", "cell": 0.5} | texture, "two_sided": True},
        "rough": metal | {"alpha": 0.5, "distribution": "beckmann", "masking": "correlated"},
        "fitted": metal | {"alpha": 0.15, "distribution": "beckmann", "g1": "walter"},
    }
    names = list(materials)
    shapes: list[dict[str, Any]] = [
        {"type": "sphere", "name": f"S{k}", "center": random.uniform(-2, 2, 3).tolist(),
         "radius": float(random.uniform(0.2, 0.9)), "material": names[k % 5]}
        for k in range(7)
    ]  # fmt: skip
    shapes += [
        {"type": "plane", "name": f"P{k}", "point": (2.5 * n).tolist(),
         "normal": (-n + 0.2 * random.normal(size=3)).tolist(), "along": [0.3, 1, 0.7],
         "material": names[(k + seed) % 5]}
        for k, n in enumerate(np.eye(3))
    ]  # fmt: skip
    lights = [
        {"type": "point", "name": "key", "position": random.uniform(-2, 2, 3).tolist(), "intensity": [9, 5, 2]},
        {"type": "point", "name": "fill", "position": random.uniform(-2, 2, 3).tolist(), "intensity": [1, 5, 7]},
        {"type": "directional", "name": "sun", "direction": random.normal(size=3).tolist(), "irradiance": [1, 2, 3]},
    ]
    return {
        "units": "radiometric",
        "bounces": 0,
        "camera": LOOK,
        "materials": materials,
        "shapes": shapes,
        "lights": lights,
    }


def test_the_pipelines_agree_ray_by_ray() -> None:
    lit = met = 0
    kinds: set[str] = set()
    for seed in range(40):
        scene = sr.load(crowd(seed))
        random = np.random.default_rng(1000 + seed)
        origins, directions = random.uniform(-2.2, 2.2, (400, 3)), random.normal(size=(400, 3))
        directions /= np.linalg.norm(directions, axis=1, keepdims=True)
        true = sr.probe(scene, rays=(origins, directions), tol=1e-9)
        emitted, direct, indirect, hit_class = numeric_rays(radiometric_arrays(scene), origins, directions)
        names = np.array(["nothing", *(f"shapes.{shape.name}" for shape in scene.shapes)])[hit_class.astype(int)]
        assert (names == np.array(true.shape)).all()
        off = np.abs(direct - true.direct).max(axis=1)
        assert (off <= 1e-12 * np.maximum(1, np.abs(direct).max(axis=1))).all()
        assert (off <= true.error + 1e-300).all()
        assert not emitted.any() and not indirect.any()
        lit += int((direct.max(axis=1) > 1e-6).sum())
        met += int((hit_class > 0).sum())
        kinds |= set(names[direct.max(axis=1) > 1e-6].tolist())
    assert lit > 1500 and met > 10_000 and len(kinds) == 10


def test_error_is_small_where_nothing_is_sharp() -> None:
    image = sr.truth("metal", size=(96, 48))
    assert (image.layer("radiance").max(axis=2) > 1e-3).mean() > 0.5
    assert float(np.median(image.layer("error"))) < 1e-12 and float(image.layer("error").max()) < 1e-8
    assert not image.layer("status").any()
    np.testing.assert_array_equal(image.layer("radiance"), image.layer("emitted") + image.layer("direct"))
    assert not image.layer("indirect").any()
    strict = sr.truth("metal", size=(96, 48), tol=1e-13)
    assert ((strict.layer("error") > 1e-13) == (strict.layer("status") == 1)).all() and strict.layer("status").any()


def test_truth_says_of_what_it_is_the_truth() -> None:
    meta = sr.truth("metal", size=4).meta
    said = json.loads(meta["conventions"])
    assert said["bounces"] == 0 and said["filter"] == "centre"
    assert said["materials"]["gold05"] == {
        "type": "conductor", "distribution": "ggx", "masking": "separable", "g1": "exact", "two_sided": False,
    }  # fmt: skip
    assert meta["convention"] == "radiometric" and meta["units"].startswith("radiance, W/(m2 sr)")
    assert sr.load(meta["scene_name"]).hash == meta["scene_hash"]


@pytest.mark.parametrize("tile", [0, 7])
def test_bytes_do_not_depend_on_threads_or_tiles(tile: int) -> None:
    sky = sr.load("metal").replace({"bounces": 1, "lights": [{"type": "sky", "name": "sky", "radiance": 1}]})
    one = sr.render(sky, size=(40, 20), lobe=2, symbolic="none", threads=1)
    two = sr.render(sky, size=(40, 20), lobe=2, symbolic="none", threads=3, tile=tile)
    assert one.numeric is not None and two.numeric is not None
    assert one.numeric.layer("indirect").max() > 0.01
    for name, layer in one.numeric.layers.items():
        np.testing.assert_array_equal(layer, two.numeric.layers[name])


def test_a_pair_is_compared_and_says_what_was_drawn() -> None:
    pair = sr.render("metal", size=(64, 32))
    assert set(pair.ledger.comparisons) == {"radiance", "direct", "indirect"}
    whole = pair.ledger.comparisons["radiance"].whole
    assert whole.pixels == 64 * 32 and whole.max_abs < 1e-12 and pair.ledger.comparisons["radiance"].black.rmse > 0.1
    assert "point and directional lights exactly" in pair.ledger.pipelines[0].estimator
    world = crowd(1) | {"lights": [{"type": "sky", "name": "sky", "radiance": 1}], "bounces": 1}
    for sampler, words in (("sobol", "both itself and the material"), ("importance", "the sky by the material")):
        numeric = sr.render(world, size=4, numeric=sampler, symbolic="none").numeric
        assert numeric is not None and words in numeric.meta["estimator"]
        assert "bounces (1) by the material" in numeric.meta["estimator"]


@pytest.mark.parametrize(("bounces", "series"), [(0, 1.0), (1, 1.6), ("all", 1 / 0.4)])
def test_inside_a_white_ball_bounces_are_a_geometric_series(bounces: int | str, series: float) -> None:
    rho, radius, intensity = 0.6, 1.5, 3.0
    scene = {
        "units": "radiometric", "bounces": bounces, "camera": LOOK,
        "materials": {"white": {"type": "diffuse", "reflectance": rho, "two_sided": True}},
        "shapes": [{"type": "sphere", "name": "ball", "center": [0, 0, 0], "radius": radius, "material": "white"}],
        "lights": [{"type": "point", "name": "key", "position": [0, 0, 0], "intensity": intensity}],
    }  # fmt: skip
    numeric = sr.render(scene, size=8, lobe=16, symbolic="none").numeric
    assert numeric is not None
    expected = rho / math.pi * intensity / radius**2
    np.testing.assert_allclose(numeric.layer("direct"), expected, rtol=1e-13)
    mean = numeric.layer("radiance").mean()
    # roulette makes the sum of all a random one
    assert mean == pytest.approx(expected * series, rel=1e-12 if bounces != "all" else 0.02)
    if bounces == 0:
        np.testing.assert_allclose(sr.truth(scene, size=8).layer("radiance"), expected, rtol=1e-13)


def test_one_bounce_is_mitsubas_within_noise() -> None:
    compared, z = 0, []
    for ray in DATA["rays"]:
        if "bounced" not in ray or "0.05" in ray["scene"]["name"]:
            continue
        arrays = radiometric_arrays(sr.load(ray["scene"]).replace({"bounces": 1}))
        rows = [np.tile(ray[name], (36, 1)) for name in ("origin", "direction")]
        indirect = numeric_rays(arrays, rows[0], rows[1], order=128)[2][:, 0]
        mine, mine_error = indirect.mean(), indirect.std(ddof=1) / 6
        b = ray["bounced"]
        count, mean = b["samples"], b["sum"][0] / b["samples"]
        other_error = math.sqrt((b["sum_of_squares"][0] / count - mean**2) / count)
        assert count > 2e7 and mine > 1e-4 and mine_error < 0.06 * mine
        z.append((mean - b["direct"][0] - mine) / math.hypot(mine_error, other_error))
        compared += 1
    assert compared == 30
    assert np.abs(z).max() < 5 and abs(float(np.mean(z))) < 1 and float(np.std(z)) < 2


def test_what_takes_a_lobe_is_refused_by_name() -> None:
    scene = sr.load("metal").replace({"bounces": "all"})
    for call in (
        lambda: sr.truth(scene, size=4, method="quadrature"),
        lambda: sr.render(scene, size=4),
        lambda: sr.probe(scene, rays=([0, -5, 2], [0, 1, 0])),
    ):
        with pytest.raises(Unsupported, match="bounces: all is not yet integrated"):
            call()
    sky = sr.load("metal").replace({"lights": [{"type": "sky", "name": "sky", "radiance": 1}]})
    assert sr.truth(sky, size=4).layer("radiance").max() > 0.1
    with pytest.raises(Unsupported, match="bounces: 1 is not yet integrated in a scene with a sky"):
        sr.truth(sky.replace({"bounces": 1}), size=4, method="quadrature")


def test_other_verbs_refuse_by_name() -> None:
    calls: dict[str, Any] = {
        "expression": lambda: sr.expression("metal"),
        "simulator": lambda: sr.simulator("metal", "never.html"),
        "verify": lambda: sr.truth("metal", size=4, verify=0.5),
    }
    for verb, call in calls.items():
        with pytest.raises(Unsupported, match=rf"^{verb}: does not know radiometric scenes yet \(metal\)") as told:
            call()
        assert "\n" not in str(told.value)


def test_rays_are_checked() -> None:
    for rays, words in (
        (([0, 0, 0],), "must be"),
        (([0, 0], [0, 1, 0]), "N, 3"),
        (([0, 0, 0], [0, 0, 0]), "direction 0 is zero"),
        (([0, 0, math.nan], [0, 0, 1]), "finite"),
    ):
        with pytest.raises(OptionError, match=words):
            sr.probe("metal", rays=rays)  # type: ignore[arg-type]
    with pytest.raises(Unsupported, match="probed at points alone"):
        sr.probe("gloss", rays=([0, 0, 0], [0, 0, 1]))
    with pytest.raises(Unsupported, match="probed along rays"):
        sr.probe("metal", [(0, 0)])
    with pytest.raises(OptionError, match="one of them must be given"):
        sr.probe("gloss")  # type: ignore[call-overload]
    long = sr.probe("metal", rays=([0, -9.5, 3.1], [0, 9.5e200, -2.5e200]))
    same = sr.probe("metal", rays=([0, -9.5, 3.1], [0, 9.5, -2.5]))
    np.testing.assert_allclose(long.direct, same.direct, rtol=1e-12)


@pytest.mark.parametrize("name, count", [("metal", 9000), ("interreflection", 40)])
def test_order_and_number_of_rays_change_no_bit(name: str, count: int) -> None:
    rng = np.random.default_rng(5)
    origins = np.array([0.0, -6.0, 2.0]) + rng.normal(size=(count, 3)) * 0.1
    directions = rng.uniform(-1.2, 1.2, (count, 3)) * [1, 1, 0.8] + [0, 0, 0.6] - origins
    told = ("radiance", "emitted", "direct", "indirect", "error", "status", "evaluations")
    whole = sr.probe(name, rays=(origins, directions), tol=1e-4, threads=1)
    assert (whole.radiance.max(axis=1) > 1e-3).sum() > 0.5 * count and len(set(whole.shape)) > 2
    order = rng.permutation(count)
    again = sr.probe(name, rays=(origins[order], directions[order]), tol=1e-4, threads=3)
    some = sr.probe(name, rays=(origins[3:11], directions[3:11]), tol=1e-4)
    for each in told:
        np.testing.assert_array_equal(getattr(whole, each)[order], getattr(again, each))
        np.testing.assert_array_equal(getattr(whole, each)[3:11], getattr(some, each))
    assert tuple(whole.shape[k] for k in order) == again.shape


@pytest.mark.parametrize("bounces", [0, 1])
def test_nothing_to_meet_and_no_rays_are_answered(bounces: int) -> None:
    camera = {"type": "look_at", "eye": [0, -3, 1], "target": [0, 0, 0], "fov": 30}
    empty = {"units": "radiometric", "name": "empty", "bounces": bounces, "camera": camera}
    empty |= {"materials": {"grey": {"type": "diffuse"}}, "shapes": [], "lights": []}
    found = sr.probe(empty, rays=([0, 0, 0], [0, 0, 1]))
    assert found.shape == ("nothing",) and not found.radiance.any() and found.status[0] == 0
    assert (sr.truth(empty, size=3).layer("status") == 0).all()
    none = sr.probe(empty, rays=(np.zeros((0, 3)), np.zeros((0, 3))))
    assert none.shape == () and none.radiance.shape == (0, 3)
