"""What conductors reflect of a sky where masking and reflectance are singular near by, against rules within rules.

Each case was off by 1.1 to 1,800 times what it stated before its singularity was listed
(``chambers/lobes/levels.py``): a critical angle, masking near the horizon of smooth metal, height-correlated masking
and Beckmann's normals at grazing views, the direction that grazing views all but reflect into. Of one the ridge of the
lobe crosses a wall between lines (``quadrature/crossed_poles.py``).
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import symrender as sr

from . import nested

DULL = {"eta": [2.8, 2.3, 0.6], "k": [3.0, 0.5, 3.0]}
CLEAR = {"eta": [2.8, 0.94, 1.5], "k": [3.0, 0.0, 0.0]}
CASES = {
    "critical": (CLEAR | {"distribution": "ggx", "alpha": 0.057, "masking": "correlated"}, 0.2753, 0.4),
    "smooth": (DULL | {"distribution": "ggx", "alpha": 0.0012, "masking": "separable"}, 0.195, 1.0),
    "correlated": (DULL | {"distribution": "ggx", "alpha": 0.0074, "masking": "correlated"}, 0.0017, 1.0),
    "grazing": (DULL | {"distribution": "beckmann", "alpha": 0.214, "masking": "separable"}, 0.000586, 1.0),
}  # fmt: skip


def scene(metal: dict[str, Any]) -> dict[str, Any]:
    """A metal ball among others over a floor, under a sky."""
    return {
        "units": "radiometric", "name": "rough", "bounces": 0,
        "camera": {"type": "look_at", "eye": [0, 0, 9], "target": [0, 0, 0], "up": [0, 1, 0], "fov": 30},
        "materials": {"metal": {"type": "conductor"} | metal, "clay": {"type": "diffuse", "reflectance": 0.5}},
        "shapes": [{"type": "sphere", "name": "ball", "center": [0, 0, 0], "radius": 1, "material": "metal"},
                   {"type": "sphere", "name": "other", "center": [1.6, 0.9, 0.3], "radius": 0.8, "material": "clay"},
                   {"type": "plane", "name": "floor", "point": [0, 0, -1.1], "normal": [0, 0, 1], "material": "clay"}],
        "lights": [{"type": "sky", "name": "sky", "radiance": 1}],
    }  # fmt: skip


def ray(cosine: float, turn: float) -> tuple[np.ndarray, np.ndarray]:
    """A ray that meets the ball beside the other one, at this cosine to its normal."""
    n = np.array([math.cos(0.5), math.sin(0.5), 0.4])
    n /= np.linalg.norm(n)
    x = np.cross(n, [0.0, 0.0, 1.0])
    x /= np.linalg.norm(x)
    toward = cosine * n + math.sqrt(1.0 - cosine**2) * (math.cos(turn) * x + math.sin(turn) * np.cross(n, x))
    return n + 0.01 * toward, -toward


@pytest.mark.parametrize("case", CASES)
def test_what_is_singular_near_by_is_stated(case: str) -> None:
    metal, cosine, turn = CASES[case]
    made = scene(metal)
    light, told = 0.0, 0
    for around in (turn, turn + 2.0):
        rays = ray(cosine, around)
        known = nested.reflected(nested.world(made), *rays, 1e-12)
        assert known.shape == 0 and known.error < 2e-10
        light = max(light, float(known.light.max()))
        for tol in (1e-4, 1e-5, 1e-6, 1e-7, 1e-8):
            seen = sr.probe(made, rays=rays, tol=tol)
            assert seen.status[0] == 0 and seen.shape[0] == "shapes.ball"
            told += known.error < 0.2 * seen.error[0]
            assert np.abs(seen.direct[0] - known.light).max() <= seen.error[0] + known.error, (around, tol)
    assert light > 0.1 and told >= 9


ALONE = {
    "units": "radiometric", "name": "alone", "bounces": 0,
    "camera": {"type": "look_at", "eye": [0, 0, 9], "target": [0, 0, 0], "up": [0, 1, 0], "fov": 30},
    "materials": {"metal": {"type": "conductor", "distribution": "ggx", "alpha": 0.1, "masking": "separable",
                            "eta": [0.847214804569557, 0.8559269880257706, 1.8041055323787079], "k": [3, 0.5, 3]}},
    "shapes": [{"type": "sphere", "name": "ball", "center": [0, 0, 0], "radius": 1, "material": "metal"}],
    "lights": [{"type": "sky", "name": "sky", "radiance": 1}],
}  # fmt: skip


@pytest.mark.parametrize("cosine", [3.2067e-4, 1e-3, 5e-3])
def test_reflectance_is_singular_where_a_grazing_view_goes_on(cosine: float) -> None:
    n, x = np.array([0.6, 0.0, 0.8]), np.array([0.0, 1.0, 0.0])
    toward = cosine * n + math.sqrt(1.0 - cosine**2) * x
    known = nested.reflected(nested.world(ALONE), n + 0.5 * toward, -toward, 1e-14)
    assert known.shape == 0 and known.error < 1e-11 and known.light.max() > 0.5
    for tol in (1e-4, 1e-5, 1e-6, 1e-7, 1e-8):
        seen = sr.probe(ALONE, rays=(n + 0.5 * toward, -toward), tol=tol)
        assert seen.status[0] == 0 and seen.error[0] > 4.0 * known.error
        assert np.abs(seen.direct[0] - known.light).max() <= seen.error[0], tol


def test_a_ridge_that_crosses_a_jump_between_lines_is_seen() -> None:
    rough = {"type": "conductor", "distribution": "beckmann", "g1": "walter", "alpha": 0.031069664104437282,
             "masking": "correlated", "eta": [2.19883394, 2.98402412, 0.63396887], "k": [0.5, 0, 0]}  # fmt: skip
    down = np.array([0.0009340418909884287, -0.0003028708058953425, 1.000189301402042])
    made = ALONE | {
        "materials": {"rough": rough, "clay": {"type": "diffuse", "reflectance": 0.5}},
        "shapes": [
            {"type": "plane", "name": "floor", "point": (-down).tolist(), "normal": down.tolist(), "material": "rough"},
            {"type": "sphere", "name": "over", "center": [0.0005775247920164, -1.651259951398792, 1.775806678397185],
             "radius": 1, "material": "clay"},
            {"type": "sphere", "name": "ball", "center": [-0.424996280267955, -2.216131420012699, 0.787731030527079],
             "radius": 1, "material": "rough"},
            {"type": "sphere", "name": "far", "center": [0.751527895074182, 1.148536214873753, -0.471893674795525],
             "radius": 1, "material": "clay"}],
    }  # fmt: skip
    way = np.array([0.27469347, -0.92474419, -0.263423])
    rays = (np.array([0.41661687, -1.85062614, 0.39011666]), way / np.linalg.norm(way))
    known = nested.reflected(nested.world(made), *rays, 1e-13)
    # the lobe, whose albedo is .86 and more, sees the floor alone
    assert known.shape == 2 and known.error == 0.0 and not known.light.any()
    for tol in (1e-5, 1e-6, 1e-7, 1e-8):
        seen = sr.probe(made, rays=rays, tol=tol)
        assert seen.status[0] == 0 and seen.shape[0] == "shapes.ball"
        assert np.abs(seen.direct[0]).max() <= seen.error[0], tol


def test_masking_beyond_a_horizon_that_a_wall_runs_into_is_seen() -> None:
    """Of a grazing view its pole lies a thousandth beyond the place where the edge of two planes meets the horizon."""
    metal = {"type": "conductor", "distribution": "ggx", "alpha": 0.5, "masking": "correlated",
             "eta": [0.7004914645205412, 1.081027335213117, 0.7003778478153948], "k": [3.0, 0.0, 0.5]}  # fmt: skip
    below = np.array([-0.00026202732142796233, -0.0009620935490302056, 0.9999243846196878])
    side = np.array([1.093968779980182, -0.2607483348402705, -0.11480494008126267])
    made = ALONE | {
        "materials": {"metal": metal, "clay": {"type": "diffuse", "reflectance": 0.5}},
        "shapes": [
            {"type": "plane", "name": "floor", "point": (-2.0 * below).tolist(), "normal": below.tolist(),
             "material": "clay"},
            {"type": "plane", "name": "wall", "point": (-side).tolist(), "normal": side.tolist(), "material": "clay"},
            {"type": "sphere", "name": "ball", "center": [-0.31232248787654, -1.2079755642642427, 0.7149600051478222],
             "radius": 0.6959872489106793, "material": "metal"}],
    }  # fmt: skip
    rays = (np.array([-0.8291803849656297, -0.7946249686641584, 0.4994030604961146]),
            np.array([-0.5511896353317636, -0.8111174701803925, -0.19564875535253906]))  # fmt: skip
    known = nested.reflected(nested.world(made), *rays, 1e-15)
    assert known.shape == 2 and known.error < 1e-13 and known.light.max() > 1e-5
    for tol in (1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10):
        seen = sr.probe(made, rays=rays, tol=tol * known.light.max())
        assert seen.status[0] == 0 or tol < 1e-8
        assert np.abs(seen.direct[0] - known.light).max() <= seen.error[0] + known.error, tol


@pytest.mark.parametrize("exponent", [0.6, 2.7, 4.3])
def test_a_lobe_that_ends_with_a_broken_power_meets_its_tolerance(exponent: float) -> None:
    made = scene({})
    made["materials"]["metal"] = {"type": "phong", "exponent": exponent, "reflectance": 1}
    for cosine, turn in ((0.7, 0.4), (0.3, 2.0), (0.05, 1.0)):
        rays = ray(cosine, turn)
        known = nested.reflected(nested.world(made), *rays, 1e-12)
        assert known.shape == 0 and known.error < 1e-10 and known.light.max() > 0.05
        for tol in (1e-4, 1e-6, 3e-8):
            seen = sr.probe(made, rays=rays, tol=tol)
            assert seen.status[0] == 0 and seen.shape[0] == "shapes.ball"
            assert np.abs(seen.direct[0] - known.light).max() <= seen.error[0] + known.error, (cosine, tol)


HIDDEN = {
    "along": (
        {"alpha": 0.009538955240607492, "g1": "walter", "k": [3, 0.5, 0],
         "eta": [0.9275472292977233, 1.991316917712526, 1.8601072158987029],
         "reflectance": 0.3, "two_sided": True},
        {"type": "sphere", "name": "metal", "center": [-0.7334470438289854, 0.2924262977381033, 1.1], "radius": 1,
         "material": "metal"},
        {"type": "plane", "name": "hides", "point": [0, 0, 0], "normal": [1, 0, 0], "along": [0, 1, 0],
         "material": "clay"},
        ([-0.5481279, -0.41886129, 0.42187379], [0.94576104, -0.0430333, 0.32200029]), 1e-11,
    ),
    "beyond the horizon": (
        {"alpha": 0.022715162606361926, "masking": "correlated", "g1": "walter", "reflectance": [0, 1, 1],
         "eta": [2.782404497931267, 0.5708370835533985, 0.990487879570835], "k": [3, 0.5, 0]},
        {"type": "sphere", "name": "metal", "center": [-0.5157150089625968, -1.3735680115561448, -1.0899831033710188],
         "radius": 0.14842778656200772, "material": "metal"},
        {"type": "plane", "name": "hides", "point": [0, 0, 0], "material": "clay",
         "normal": [-0.21521571945280307, 0.19286115948048874, 1.0805404697295333]},
        ([-0.44240968, -1.33047979, -1.21164176], [-0.72388249, 0.66178744, -0.19501672]), 7e-9,
    ),
    "a critical circle": (
        {"alpha": 0.4824757496320805, "distribution": "ggx", "masking": "correlated",
         "eta": [0.9699763667549581, 2.4911356688972734, 2.6007487136285534], "k": [0, 3, 3]},
        {"type": "sphere", "name": "metal", "center": [2.790799898606523, -2.4297584689542173, 1.6472881846486023],
         "radius": 1, "material": "metal"},
        {"type": "plane", "name": "hides", "point": [0.002061280741250873, 0.1121727376987486, -2.5894175328566953],
         "normal": [-0.0010306403706254366, -0.0560863688493743, 1.2947087664283476], "material": "clay"},
        ([3.45216567, -2.03639571, 2.64268511], [-0.45335198, 0.56491386, -0.68945218]), 1e-11,
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", HIDDEN)
def test_what_is_hidden_of_a_lobe_is_all_seen(case: str) -> None:
    """A black wall hides part of what a lobe reflects, and what is left is the difference of two integrals over it.

    Far from its axis a line sees a Gauss curve as narrow as anywhere, and pieces sought it where a quadratic form put
    it, a tenth of a radian off. Where a circle of critical angles touches a line, the integral across them goes as
    x log(x).
    """
    metal, shines, hides, ray, tol = HIDDEN[case]
    data = scene({"distribution": "beckmann", "masking": "separable"} | metal)
    rays = tuple(np.array([each]) for each in ray)
    data["shapes"] = [shines]
    assert sr.probe(data, rays=rays, tol=1e-4).direct.max() > 0.1
    data["shapes"] = [shines, hides]
    data["materials"]["clay"] = {"type": "diffuse", "reflectance": 0}
    known = nested.reflected(nested.world(data), rays[0][0], rays[1][0], 1e-14)
    assert known.error < 1e-13
    for at in np.geomspace(tol, 1e3 * tol, 13):
        seen = sr.probe(data, rays=rays, tol=at, budget=2_000_000)
        assert seen.error[0] < 30.0 * at
        assert abs(seen.direct[0] - known.light).max() <= seen.error[0]
