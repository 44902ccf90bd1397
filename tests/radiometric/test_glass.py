"""Glass and plastic: energy, reciprocity, choices against their densities, and closed forms of slabs and furnaces."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from scipy.stats import chi2

import symrender as sr
from symrender.errors import SceneError, Unsupported
from symrender.jit.records import Table
from symrender.numeric.radiometric.bsdfs import dispatch
from symrender.scene.load import load_any
from symrender.scene.radiometric.arrays import radiometric_arrays
from symrender.scene.radiometric.records import Material
from symrender.scene.radiometric.scene import RadiometricScene

WHITE = (1.0, 1.0, 1.0)
BLACK = {"type": "diffuse", "reflectance": 0}
BALL = {"type": "sphere", "name": "ball", "center": [0, 0, 0], "radius": 1, "material": "glass"}
CAMERA = {"type": "look_at", "eye": [0, -4, 0], "target": [0, 0, 0], "fov": 20}
SKY = {"type": "sky", "name": "sky", "radiance": 1}
GGX: dict[str, Any] = {"type": "dielectric", "ior": 1.5, "alpha": 0.5}
BECKMANN = GGX | {"distribution": "beckmann", "alpha": 0.4}
PLASTIC: dict[str, Any] = {"type": "plastic", "ior": 1.5, "alpha": 0.5, "diffuse": [0.2, 0.5, 0.8]}
ROUGH = {
    "ggx": GGX, "beckmann": BECKMANN, "thin air": GGX | {"ior": 0.7}, "correlated": GGX | {"masking": "correlated"},
    "plastic": PLASTIC, "plastic beckmann": PLASTIC | {"distribution": "beckmann", "nonlinear": True},
    "smooth plastic": PLASTIC | {"alpha": 0},
}  # fmt: skip


def scene(glass: dict[str, Any], **fields: Any) -> dict[str, Any]:
    return {
        "units": "radiometric", "name": "glass", "bounces": "all", "camera": CAMERA,
        "materials": {"glass": glass, "black": BLACK}, "shapes": [BALL], "lights": [SKY],
    } | fields  # fmt: skip


def laid(glass: dict[str, Any]) -> Table[Material]:
    loaded = load_any(scene(glass))
    assert isinstance(loaded, RadiometricScene)
    return dispatch.laid_materials(radiometric_arrays(loaded).materials)


def seen_at(cosine: float) -> tuple[float, float, float]:
    return math.sqrt(1.0 - cosine * cosine), 0.0, cosine


def fresnel(cosine: float, eta: float) -> float:
    beyond = np.sqrt(1.0 - (1.0 - cosine**2) / eta**2)
    s, p = (cosine - eta * beyond) / (cosine + eta * beyond), (eta * cosine - beyond) / (eta * cosine + beyond)
    return float(s * s + p * p) / 2.0


@pytest.mark.parametrize("name", sorted(ROUGH))
@pytest.mark.parametrize("inside", [False, True])
def test_choices_have_the_density_that_is_said(name: str, inside: bool) -> None:
    """Chi-square over equal solid angles; what is chosen of nothing, or of one direction, is the rest."""
    material = laid(ROUGH[name])[0]
    rng, wo, count, bins, fine = np.random.default_rng(8), seen_at(0.6), 5000, 8, 12
    told = np.zeros((bins, bins))
    for k in range(bins * fine):
        z = 2.0 * (k + 0.5) / (bins * fine) - 1.0
        for j in range(bins * fine):
            turn, r = 2.0 * math.pi * (j + 0.5) / (bins * fine), math.sqrt(1.0 - z * z)
            wi = (r * math.cos(turn), r * math.sin(turn), z)
            told[k // fine, j // fine] += dispatch.density(material, inside, WHITE, wo, wi)
    told *= 4.0 * math.pi / (bins * fine) ** 2
    found, sharp, none = np.zeros((bins, bins)), 0, 0
    for a, b, c in rng.random((count, 3)):
        made = dispatch.choose(material, inside, WHITE, wo, float(a), float(b), float(c))
        x, y, z = made.wi
        chance = dispatch.density(material, inside, WHITE, wo, made.wi)
        if made.sharp or chance <= 0.0:
            sharp, none = sharp + made.sharp, none + (not made.sharp)
            continue
        k, j = min(int((z + 1.0) / 2.0 * bins), bins - 1), int(math.atan2(y, x) / (2.0 * math.pi) * bins % bins)
        found[k, j] += 1
    expected = np.append(told.ravel(), 1.0 - told.sum()) * count
    counted = np.append(found.ravel(), sharp + none)
    assert sharp == 0 or name == "smooth plastic"
    some = expected > 8.0
    assert some.sum() >= 8 and expected[some].sum() > 0.95 * count
    rest = float(expected[~some].sum())
    statistic = float(((counted - expected)[some] ** 2 / expected[some]).sum())
    statistic += (float(counted[~some].sum()) - rest) ** 2 / rest if rest > 8.0 else 0.0
    assert chi2.sf(statistic, int(some.sum())) > 1e-5, (statistic, some.sum())


@pytest.mark.parametrize("name", sorted(ROUGH))
def test_light_may_go_either_way(name: str) -> None:
    """f(o, i) = f(i, o), times the squared relative index where light goes through."""
    material = laid(ROUGH[name])[0]
    rng, there_and_back, through = np.random.default_rng(4), [], 0
    for _ in range(300):
        one, other = rng.normal(size=(2, 3))
        one, other = one / np.linalg.norm(one), other / np.linalg.norm(other)
        inside = bool(one[2] < 0.0) and ROUGH[name]["type"] == "dielectric"
        one[2], other[2] = abs(one[2]), other[2] * (1.0 if ROUGH[name]["type"] == "dielectric" else np.sign(other[2]))
        o, i = (float(one[0]), float(one[1]), float(one[2])), (float(other[0]), float(other[1]), float(other[2]))
        f = dispatch.scattered(material, inside, WHITE, o, i)[0] / abs(i[2])
        crosses = i[2] < 0.0
        # the surface is told as whoever sees it from the other side would
        flip = -1.0 if crosses else 1.0
        back = dispatch.scattered(
            material, inside != crosses, WHITE, (i[0], i[1], flip * i[2]), (o[0], o[1], flip * o[2])
        )[0] / abs(o[2])  # fmt: skip
        eta = (ROUGH[name]["ior"] if not inside else 1.0 / ROUGH[name]["ior"]) if crosses else 1.0
        if f > 0.0:
            there_and_back.append(back / (f * eta * eta))
            through += crosses
    assert len(there_and_back) > 100 and (through > 20 or "plastic" in name)
    assert np.abs(np.array(there_and_back) - 1.0).max() < 1e-9


@pytest.mark.parametrize("name", sorted(ROUGH))
def test_no_more_light_leaves_than_arrives(name: str) -> None:
    material, rng = laid(ROUGH[name])[0], np.random.default_rng(2)
    for inside in (False, True):
        for cosine in (0.05, 0.4, 1.0):
            wo, sent = seen_at(cosine), []
            for a, b, c in rng.random((1500, 3)):
                made = dispatch.choose(material, inside, WHITE, wo, float(a), float(b), float(c))
                # radiance that goes through is that of the other medium
                power = dispatch.widening(material, inside, made.wi)
                if made.sharp:
                    sent.append(made.weight[0] * power)
                    continue
                chance = dispatch.density(material, inside, WHITE, wo, made.wi)
                value = dispatch.scattered(material, inside, WHITE, wo, made.wi)[0]
                sent.append(value / chance * power if chance > 0.0 else 0.0)
            mean, error = float(np.mean(sent)), float(np.std(sent)) / math.sqrt(len(sent))
            assert 0.4 < mean < 1.0 + 4.0 * error + 1e-3, (inside, cosine, mean, error)


@pytest.mark.parametrize(
    "glass",
    [
        {"type": "dielectric", "ior": 1.5},
        {"type": "dielectric", "ior": 0.6},
        {"type": "dielectric", "ior": 1.7, "thin": True},
        {"type": "conductor", "material": "none", "alpha": 0},
    ],
)
def test_smooth_glass_is_not_seen_in_a_furnace(glass: dict[str, Any]) -> None:
    image = sr.truth(scene(glass), size=4, tol=0.02, budget=100_000, threads=1)
    assert image.layer("hit_class").any()
    assert np.abs(image.radiance - 1.0).max(axis=2).max() < 1e-12 or (
        (np.abs(image.radiance - 1.0).max(axis=2) <= image.layer("error")).all() and image.layer("error").max() < 0.1
    )


def test_radiance_within_glass_is_that_outside_times_the_squared_index() -> None:
    camera = {"type": "look_at", "eye": [0, 0, 0], "target": [0, 1, 0.2], "fov": 60}
    made = scene({"type": "dielectric", "ior": 1.5}, camera=camera)
    image = sr.truth(made, size=3, tol=0.05, budget=200_000, threads=1)
    assert (np.abs(image.radiance - 2.25).max(axis=2) <= image.layer("error")).all()
    assert image.layer("error").max() < 0.2


def slab(
    ior: float, angle: float, at: float, bounces: int | str, glass: dict[str, Any] | None = None
) -> dict[str, Any]:
    """A lamp under a slab from z = 0 to 1, seen at an angle through its middle; the lamp's middle is at x = ``at``."""
    way = np.array([math.sin(angle), 0.0, -math.cos(angle)])
    eye = np.array([0.0, 0.0, 1.0]) - 3.0 * way
    lamp = {
        "type": "disk",
        "name": "lamp",
        "center": [at, 0, -2],
        "normal": [0, 0, 1],
        "radius": 0.05,
        "material": "black",
    }
    box = {"type": "box", "name": "slab", "center": [0, 0, 0.5], "size": [80, 80, 1], "material": "glass"}
    return scene(
        glass or {"type": "dielectric", "ior": ior}, bounces=bounces, shapes=[box, lamp],
        camera={"type": "look_at", "eye": eye.tolist(), "target": [0, 0, 1], "up": [0, 1, 0], "fov": 0.01},
        lights=[{"type": "area", "name": "glow", "shape": "lamp", "radiance": 1}],
    )  # fmt: skip


def test_a_slab_shifts_what_is_seen_through_it() -> None:
    """Between parallel faces a ray is bent to sin(a)/n, goes on as it came, and keeps (1 - F)^2 of its light."""
    ior, angle = 1.5, math.radians(50)
    bent = math.asin(math.sin(angle) / ior)
    at = math.tan(bent) + 2.0 * math.tan(angle)
    seen = sr.truth(slab(ior, angle, at, 1), size=1, tol=1e-3, budget=400_000, threads=1)
    wanted = (1.0 - fresnel(math.cos(angle), ior)) ** 2
    assert 0.8 < wanted < 0.95
    assert abs(seen.radiance[0, 0, 0] - wanted) <= seen.layer("error")[0, 0] < 0.01
    assert not seen.layer("direct").any() and seen.layer("indirect").all()
    straight = sr.truth(slab(ior, angle, 3.0 * math.tan(angle), 1), size=1, tol=1e-2, budget=100_000, threads=1)
    assert straight.radiance.max() < 1e-12
    assert sr.truth(slab(ior, angle, at, 0), size=1, tol=1e-2, budget=9_000, threads=1).radiance.max() == 0.0


@pytest.mark.parametrize("thin", [False, True])
def test_a_slab_at_normal_incidence_lets_2n_over_1_plus_n2_through(thin: bool) -> None:
    ior = 1.8
    made = slab(ior, 0.0, 0.0, "all")
    if thin:
        made["materials"]["glass"] |= {"thin": True}
        made["shapes"][0] = {
            "type": "rectangle", "name": "pane", "corner": [-4, -4, 0.5], "edge_u": [8, 0, 0], "edge_v": [0, 8, 0],
            "material": "glass",
        }  # fmt: skip
    image = sr.truth(made, size=1, tol=5e-3, budget=400_000, threads=1)
    assert abs(image.radiance[0, 0, 0] - 2.0 * ior / (1.0 + ior**2)) <= image.layer("error")[0, 0] < 0.02


def test_rough_glass_tends_to_smooth_glass() -> None:
    glass = {"type": "dielectric", "ior": 1.5, "alpha": 1e-3}
    image = sr.truth(slab(1.5, 0.0, 0.0, 1, glass), size=1, tol=1e-2, budget=400_000, threads=1)
    assert abs(image.radiance[0, 0, 0] - 0.96**2) <= image.layer("error")[0, 0] < 0.05


def test_plastic_of_no_index_is_diffuse() -> None:
    made = {"camera": CAMERA, "bounces": 0}
    plastic = sr.truth(scene({"type": "plastic", "ior": 1, "diffuse": 0.6}, **made), size=2, tol=2e-3, threads=1)
    assert np.abs(plastic.radiance - 0.6).max() < 2e-3


def test_plastic_mirrors_by_fresnel_and_is_diffuse_beneath() -> None:
    """A lamp in the mirror direction of smooth plastic adds F L, and its light on the base the rest."""
    ior, angle = 1.5, math.radians(60)
    mirror = [math.sin(angle), 0.0, math.cos(angle)]
    eye = [-3 * mirror[0], 0.0, 3 * mirror[2]]
    center, radius = [5 * mirror[0], 0.0, 5 * mirror[2]], 0.2
    lamp = {"type": "sphere", "name": "lamp", "center": center, "radius": radius, "material": "black"}
    floor = {
        "type": "rectangle", "name": "floor", "corner": [-9, -9, 0], "edge_u": [18, 0, 0], "edge_v": [0, 18, 0],
        "material": "glass",
    }  # fmt: skip
    plastic = {"type": "plastic", "ior": ior, "diffuse": 0.5, "specular": [1, 0.5, 0]}
    image = sr.truth(
        scene(
            plastic, bounces=0, shapes=[floor, lamp],
            lights=[{"type": "area", "name": "l", "shape": "lamp", "radiance": 9}],
            camera={"type": "look_at", "eye": eye, "target": [0, 0, 0], "fov": 0.01},
        ),
        size=1, tol=1e-2, budget=1_000_000, threads=1,
    )  # fmt: skip
    eta, back = 1.0 / ior, fresnel(math.cos(angle), ior)
    within = -1.4399 * eta**2 + 0.7099 * eta + 0.6681 + 0.0636 / eta
    # Fresnel's share hardly changes over the lamp
    irradiance = math.pi * 9 * (radius / 5) ** 2 * math.cos(angle)
    base = 0.5 / (1.0 - within) * (1.0 - back) ** 2 / (math.pi * ior**2) * irradiance
    wanted = np.array([9 * back, 4.5 * back, 0.0]) + base
    assert 9 * back > 0.5
    assert np.abs(image.radiance[0, 0] - wanted).max() <= image.layer("error")[0, 0] + 1e-3
    assert image.layer("error")[0, 0] < 0.05


def test_faults_are_named_and_quadrature_declines() -> None:
    for wrong, said in (
        ({"type": "dielectric", "ior": 1.5, "alpha": 0.1, "thin": True}, "must be 0 of a pane that is thin"),
        ({"type": "dielectric", "ior": 1, "alpha": 0.1}, "must not be 1 of a rough dielectric"),
        ({"type": "dielectric"}, "ior"),
        ({"type": "plastic", "ior": 1.5, "g1": "walter"}, "g1: walter is a fit to beckmann"),
    ):
        with pytest.raises(SceneError, match=said):
            load_any(scene(wrong))
    for glass, name in (({"type": "dielectric", "ior": 1.5}, "a dielectric"), (PLASTIC, "plastic")):
        with pytest.raises(Unsupported, match=f"{name} is not integrated by quadrature"):
            sr.truth(scene(glass), size=1, method="quadrature")
