"""One bounce between rough surfaces: energy by reciprocity, Mitsuba, the path tracer, bounds, what is not stated."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from tests.quadrature.half_vector import Rough, albedo, fitted_tail, fresnel, masking, smooth_tail

import symrender as sr
from symrender.chambers.lobes.record import CONDUCTOR, LAMBERT, POWER, Sender
from symrender.chambers.lobes.sending import most_sent
from symrender.errors import Unsupported
from symrender.jit.records import table
from symrender.leaves import values
from symrender.numeric.radiometric.pipeline import rays as numeric_rays
from symrender.scene.radiometric.arrays import radiometric_arrays

Array = npt.NDArray[np.float64]
DATA = json.loads((Path(__file__).resolve().parent.parent / "data" / "mitsuba_rays.json").read_text("utf-8"))
ETA, K = [0.18, 0.42, 1.37], [3.42, 2.35, 1.77]
GOLD = {"type": "conductor", "eta": ETA, "k": K}
WHITE = {"type": "diffuse", "reflectance": [1.0, 1.0, 1.0]}
PEA = 1e-5


def over_a_plain(pea: dict[str, Any], plain: dict[str, Any], slant: float) -> dict[str, Any]:
    """A ball so small that its shadow is nothing, over an endless plain, under a sun at this cosine to the vertical."""
    sun = {"type": "directional", "name": "sun", "direction": [math.sqrt(1 - slant * slant), 0, -slant]}
    return {
        "units": "radiometric",
        "bounces": 1,
        "camera": {"type": "look_at", "eye": [0, -5, 2.5], "target": [0, 0, 0.5]},
        "materials": {"pea": pea, "plain": plain},
        "shapes": [
            {"type": "plane", "name": "plain", "point": [0, 0, 0], "normal": [0, 0, 1], "material": "plain"},
            {"type": "sphere", "name": "pea", "center": [0, 0, 1], "radius": PEA, "material": "pea"},
        ],
        "lights": [sun | {"irradiance": [math.pi, math.pi, math.pi]}],
    }


def from_below(cosine: float) -> tuple[list[float], list[float]]:
    """A ray that meets the lowest place of the ball at this cosine to its normal."""
    sine = math.sqrt(1.0 - cosine * cosine)
    origin = np.array([0.3 * sine, 0.4 * sine, 1.0 - PEA - 0.5 * cosine])
    return origin.tolist(), (np.array([0.0, 0.0, 1.0 - PEA]) - origin).tolist()


def phong_albedo(exponent: float, cosine: float) -> float:
    """int (n + 2)/(2 pi) cos^n cos dw about the mirror direction, by Gauss rules cut at the horizon."""
    x, w = np.polynomial.legendre.leggauss(80)
    u, up = 0.5 * (x + 1.0), math.asin(cosine)
    # rings that the horizon crosses begin with a root
    theta = np.concatenate([up * u, up + (0.5 * math.pi - up) * u**2])
    by = 0.5 * np.concatenate([up * w, (0.5 * math.pi - up) * 2.0 * u * w])
    sine, total = math.sqrt(1.0 - cosine * cosine), 0.0
    for t, weight in zip(theta, by, strict=True):
        flat, swing = math.cos(t) * cosine, math.sin(t) * sine
        # half of the azimuths above the horizon
        half = math.acos(max(-1.0, min(1.0, -flat / max(swing, 1e-300))))
        ring = 2.0 * (flat * half + swing * math.sin(half))
        total += weight * math.sin(t) * (exponent + 2.0) / (2.0 * math.pi) * math.cos(t) ** exponent * ring
    return total


@pytest.mark.parametrize("distribution", ["ggx", "beckmann", "walter"])
@pytest.mark.parametrize("alpha, masking", [(0.6, "separable"), (0.3, "correlated"), (0.1, "separable")])
def test_a_conductor_gives_back_its_albedo_of_what_it_sees_and_of_what_shines_on_it(
    alpha: float, masking: str, distribution: str
) -> None:
    metal = GOLD | {"alpha": alpha, "masking": masking, "distribution": distribution}
    fitted = distribution == "walter"
    if fitted:
        metal |= {"distribution": "beckmann", "g1": "walter"}
    rough = Rough(alpha, masking == "correlated", np.array(ETA), np.array(K), distribution != "ggx", fitted)
    for cosine in (0.9, 0.4):
        known = albedo(rough, cosine, 320)
        assert known.min() > 0.2 and known.max() < 1.0
        # the plain is as bright as 1 at a cosine of 1
        seeing = sr.probe(over_a_plain(metal, WHITE, 1.0), rays=from_below(cosine), tol=1e-9)
        # what leaves a place of the plain, weighed by cosines, is what arrives: reciprocity
        sending = sr.probe(over_a_plain(WHITE, metal, cosine), rays=from_below(1.0), tol=1e-9)
        for seen, expected in ((seeing, known), (sending, cosine * known)):
            assert 500 < seen.evaluations[0] < 100_000
            assert np.abs(seen.indirect[0] - expected).max() <= 1e-9 and seen.error[0] < 1e-7


@pytest.mark.parametrize("exponent", [10.0, 64.5])
def test_phong_gives_back_its_albedo_of_what_it_sees_and_of_what_shines_on_it(exponent: float) -> None:
    gloss = {"type": "phong", "exponent": exponent, "reflectance": [0.9, 0.5, 0.0]}
    for cosine in (0.9, 0.4):
        known = phong_albedo(exponent, cosine) * np.array([0.9, 0.5, 0.0])
        assert known[0] > 0.3
        seeing = sr.probe(over_a_plain(gloss, WHITE, 1.0), rays=from_below(cosine), tol=1e-9)
        sending = sr.probe(over_a_plain(WHITE, gloss, cosine), rays=from_below(1.0), tol=1e-9)
        for seen, expected in ((seeing, known), (sending, cosine * known)):
            assert 500 < seen.evaluations[0] < 100_000
            assert np.abs(seen.indirect[0] - expected).max() <= 1e-9 and seen.error[0] < 1e-7


def view_cosine(ray: dict[str, Any]) -> float:
    """Of the view with the normal of what the ray meets: the sphere or the floor that is made of what is tested."""
    (tested,) = (shape for shape in ray["scene"]["shapes"] if shape["material"] == "tested")
    normal = [0.0, 0.0, 1.0]
    if tested["type"] == "sphere":
        normal = (np.array(ray["place"]) - tested["center"]) / tested["radius"]
    return float(-np.dot(normal, ray["direction"]))


def test_one_bounce_is_mitsubas() -> None:
    """By chance one of 30 recorded rays is beyond 3 in 1 of 12 recordings; three channels of a ray are one number."""
    z, grazing = [], 0.0
    for ray in DATA["rays"]:
        name = ray["scene"]["name"]
        if "bounced" not in ray or "diffuse" in name:
            continue
        seen = sr.probe(ray["scene"] | {"bounces": 1}, rays=(ray["origin"], ray["direction"]), tol=1e-8)
        b = ray["bounced"]
        mean = np.array(b["sum"]) / b["samples"]
        error = np.sqrt((np.array(b["sum_of_squares"]) / b["samples"] - mean**2) / b["samples"])
        assert b["samples"] > 1e8 and (error < 4e-3 * seen.indirect[0]).all()
        assert seen.status[0] == 0 and seen.error[0] <= 1e-8
        # directions are drawn by the exact masking of the view, and weighed by Walter's fit of it
        cosine = np.array(view_cosine(ray))
        drawn = (1.0 + fitted_tail(cosine, 0.3)) / (1.0 + smooth_tail(cosine, 0.3)) if "beckmann" in name else 1.0
        z.append((mean - b["direct"] - drawn * seen.indirect[0]) / error)
        grazing = max(grazing, float(np.abs((drawn - 1.0) * seen.indirect[0] / error).max()))
    assert len(z) == 30 and grazing > 4.5
    assert np.abs(z).max() < 3 and float(np.std(z)) < 1.5


def crowd(seed: int) -> dict[str, Any]:
    """Rough and diffuse balls, and a checkered and a phong plane, under a lamp and a sun."""
    rng = np.random.default_rng(seed)
    made = over_a_plain(WHITE, WHITE, 0.8)
    checker = {"type": "checker", "bright": [0.9, 0.7, 0.2], "dark": [0.1, 0.3, 0.0], "cell": 0.6}
    made["materials"] = {
        "tiles": {"type": "diffuse", "reflectance": checker},
        "wall": {"type": "phong", "exponent": 40, "reflectance": 0.6},
        "smooth": GOLD | {"alpha": float(10.0 ** rng.uniform(-2.5, -1))},
        "rough": GOLD | {"alpha": 0.4, "masking": "correlated", "reflectance": checker | {"cell": 0.25}},
        "blasted": GOLD | {"alpha": 0.25, "distribution": "beckmann"},
        "gloss": {"type": "phong", "exponent": float(10.0 ** rng.uniform(1, 3)), "reflectance": [0.2, 0.9, 0.5]},
    }
    made["shapes"] = [
        {"type": "plane", "name": "tiles", "point": [0, 0, -0.6], "normal": [0, 0.1, 1], "material": "tiles"},
        {"type": "plane", "name": "wall", "point": [0, 2, 0], "normal": [0, -1, 0.2], "material": "wall"},
    ]
    for k, name in enumerate(("smooth", "rough", "gloss", "blasted")):
        center = np.array([1.1 * (k - 1.5), 0.4 * (k % 2), 0.1]) + rng.uniform(-0.1, 0.1, 3)
        made["shapes"].append({"type": "sphere", "name": f"S{k}", "center": center.tolist(),
                               "radius": float(rng.uniform(0.3, 0.5)), "material": name})  # fmt: skip
    made["lights"].append({"type": "point", "name": "key", "position": [0.2, -1, 1.2], "intensity": [9, 5, 2]})
    return made


def test_a_loose_tolerance_keeps_its_word() -> None:
    lit, kinds = 0, set()
    for seed in range(3):
        made = sr.load(crowd(seed))
        rng = np.random.default_rng(seed + 200)
        rays = ([0.0, -6.0, 1.0], np.column_stack([rng.uniform(-2, 2, 8), np.full(8, 6.2), rng.uniform(-1.7, -0.5, 8)]))
        strict = sr.probe(made, rays=rays, tol=1e-6)
        assert (strict.status == 0).sum() >= 6 and strict.error.max() < 3e-6
        kinds |= set(strict.shape)
        for tol in (1e-2, 1e-4):
            loose = sr.probe(made, rays=rays, tol=tol)
            off = np.abs(loose.indirect - strict.indirect).max(axis=1)
            assert (off <= loose.error + strict.error).all() and (loose.error <= tol).all()
        lit += int((strict.indirect.max(axis=1) > 1e-3).sum())
    assert lit > 15 and len(kinds) >= 5


def test_one_bounce_is_the_path_tracers() -> None:
    tame = crowd(7)
    # what the tracer meets often enough to know its own error
    tame["materials"]["smooth"]["alpha"], tame["materials"]["gloss"]["exponent"] = 0.3, 12
    made = sr.load(tame)
    rng = np.random.default_rng(7)
    origins = np.tile([0.0, -6.0, 1.0], (16, 1))
    directions = np.column_stack([rng.uniform(-2, 2, 16), np.full(16, 6.2), rng.uniform(-1.7, -0.5, 16)])
    seen = sr.probe(made, rays=(origins, directions), tol=1e-5)
    assert (seen.status == 0).all() and len(set(seen.shape)) >= 4
    unit = directions / np.linalg.norm(directions, axis=1, keepdims=True)
    runs = [numeric_rays(radiometric_arrays(made), origins, unit, order=64, seed=s) for s in range(8)]
    mean = np.mean([run[2] for run in runs], axis=0)
    error = np.std([run[2] for run in runs], axis=0, ddof=1) / math.sqrt(len(runs))
    known = (seen.indirect > 1e-3) & (error < 0.03 * seen.indirect)
    assert known.sum() >= 15
    z = (mean - seen.indirect)[known] / (error[known] + 1e-5)
    assert np.abs(z).max() < 8 and abs(float(np.mean(z))) < 1.2, z


def test_nothing_sends_more_than_its_bound() -> None:
    rng, tight = np.random.default_rng(5), [0.0, 0.0, 0.0]
    senders = table(Sender, 3)
    senders[0].kind, senders[1].kind, senders[2].kind = CONDUCTOR, POWER, CONDUCTOR
    senders[2].conductor.beckmann = 1.0
    for _ in range(4000):
        alpha, exponent, masking = 10.0 ** rng.uniform(-3, 0), 10.0 ** rng.uniform(1, 3), float(rng.integers(2))
        senders[0].conductor.alpha, senders[1].exponent = alpha, exponent
        light, view = rng.normal(size=3), rng.normal(size=3)
        if rng.random() < 0.5:
            light = np.array([-view[0], -view[1], view[2]]) + rng.normal(size=3) * 10.0 ** rng.uniform(-3, 0)
        light, view = light / np.linalg.norm(light), view / np.linalg.norm(view)
        if min(light[2], view[2]) <= 0.0:
            continue
        half = light + view
        square = float(((half / np.linalg.norm(half) - [0, 0, 1]) ** 2).sum())
        senders[2].conductor.alpha = alpha
        for row, formula in ((0, values.lit_conductor), (2, values.lit_beckmann)):
            shares = formula(*(3.0 * light), 0, 0, 0, 0, 0, 1, *view, 0.0, alpha, masking, 0, 0, 0, 1, 1, 1)
            most = most_sent(square, float(view[2]), float(light[2]), row, senders)
            assert shares[0] <= most * (1.0 + 1e-9) + 1e-300
            tight[row] = max(tight[row], shares[0] / most if most > 1e-9 else 0.0)
        share, base = values.lit_phong(*(3.0 * light), 0, 0, 0, 0, 0, 1, *view, 0.0, exponent)
        mirrored = np.array([-light[0], -light[1], light[2]])
        most = most_sent(float(((mirrored - view) ** 2).sum()), float(view[2]), float(light[2]), 1, senders)
        assert share * base**exponent <= most * (1.0 + 1e-9) + 1e-300
        tight[1] = max(tight[1], share * base**exponent / most if most > 1e-9 else 0.0)
    assert min(tight) > 0.95 and LAMBERT not in (CONDUCTOR, POWER)


def test_what_is_not_integrated_is_refused_by_name() -> None:
    checker = {"type": "checker", "bright": 0.9, "dark": 0.1, "cell": 1}
    made = over_a_plain(WHITE, GOLD | {"alpha": 0.3, "reflectance": checker}, 0.5)
    made["lights"] = [{"type": "sky", "name": "sky", "radiance": 1.0}]
    with pytest.raises(Unsupported, match="in a scene with a sky beside a conductor or a phong material"):
        sr.truth(made, size=4, method="quadrature")


@pytest.mark.parametrize("exponent", [0.0, 1.0, 2.5, 3.0, 6.0, 9.0])
def test_a_highlight_that_ends_with_a_low_power_is_integrated(exponent: float) -> None:
    blunt = {"type": "phong", "exponent": exponent, "reflectance": [0.9, 0.5, 0.0]}
    for cosine in (0.9, 0.4):
        known = phong_albedo(exponent, cosine) * np.array([0.9, 0.5, 0.0])
        assert known[0] > 0.1
        seeing = sr.probe(over_a_plain(blunt, WHITE, 1.0), rays=from_below(cosine), tol=1e-9)
        # of light at a slant the highlight ends on the plain, in view
        sending = sr.probe(over_a_plain(WHITE, blunt, cosine), rays=from_below(1.0), tol=1e-9)
        for seen, expected in ((seeing, known), (sending, cosine * known)):
            assert 100 < seen.evaluations[0] < 400_000
            assert np.abs(seen.indirect[0] - expected).max() <= 1e-9 and seen.error[0] < 1e-7


def test_total_reflection_of_what_is_seen_is_stated() -> None:
    """A light on the axis below a place over a plain: an integral over rings, cut at those of critical angles.

    With k = 0 and eta < 1 reflectance is a root beside them, and no wall stands there.
    """
    height, low, eta = 1.0 - PEA, 0.4, np.array([0.19, 0.92, 0.21])
    rough = Rough(0.65, True, eta, np.zeros(3))
    plain = {"type": "conductor", "distribution": "ggx", "alpha": rough.alpha, "masking": "correlated"}
    scene = over_a_plain(WHITE, plain | {"eta": eta.tolist(), "k": [0, 0, 0]}, 1.0)
    scene["lights"] = [{"type": "point", "name": "lamp", "position": [0, 0, low], "intensity": [1, 1, 1]}]

    def ring(r: Array) -> Array:
        """(N, 3) what rings of these radii send upwards, an angle to the axis each."""
        far, near = np.hypot(r, height), np.hypot(r, low)
        seen, lit = height / far, low / near
        half = np.stack([-r / far - r / near, seen + lit], axis=1)
        size = np.linalg.norm(half, axis=1)
        cos_h = half[:, 1] / size
        d = rough.alpha**2 / (math.pi * (cos_h**2 * (rough.alpha**2 - 1.0) + 1.0) ** 2)
        smith = np.array([masking(lit[i : i + 1], float(seen[i]), rough)[0] for i in range(len(r))])
        share = d * smith / (4.0 * seen * lit) * lit / near**2 * seen**2 / far**2 * 2.0 * r
        return np.asarray(share[:, None] * fresnel(0.5 * size, eta, np.zeros(3)))

    x, w = np.polynomial.legendre.leggauss(60)
    s = 0.5 * (x + 1.0)
    for a in (0, 2):
        # tan of the angle that light and place are seen apart, tangents of twice the critical angle
        apart = math.tan(math.acos(1.0 - 2.0 * eta[a] ** 2))
        spread = math.sqrt((height - low) ** 2 - 4.0 * apart * apart * height * low)
        rings = [(height - low - sign * spread) / (2.0 * apart) for sign in (1.0, -1.0)]
        assert 0.1 < rings[0] < rings[1] < 3.0
        known = 0.0
        for begin, end in zip([0.0, *rings], [*rings, 20.0], strict=True):
            r = begin + (end - begin) * s * s * (3.0 - 2.0 * s)
            known += float((ring(r)[:, a] * 0.5 * w * (end - begin) * 6.0 * s * (1.0 - s)).sum())
        t = 1.0 / 20.0 * s
        known += float((ring(1.0 / t)[:, a] * 0.5 * w / 20.0 / t**2).sum())
        for tol in (1e-3, 1e-5, 1e-7, 1e-9):
            found = sr.probe(scene, rays=tuple(np.array([each]) for each in from_below(0.7)), tol=tol)
            assert found.error[0] < 3.0 * tol
            assert abs(found.indirect[0, a] - known) <= found.error[0] + 1e-10
