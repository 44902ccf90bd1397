"""Lobes in BRDF units, int (n + 2)/(2 pi) cos^n theta (w.N) f dw, in every rule, beside the average they are not."""

from __future__ import annotations

import json
import math
from pathlib import Path

import mpmath
import numpy as np
import pytest
import sympy as sp

from quadrature import brute_lobe
from symrender.chambers.lobes.units import lobe_scale
from symrender.cli import main
from symrender.errors import SceneError, Unsupported
from symrender.expression.formulas.lobes import brdf_normaliser, log_cosine, normaliser
from symrender.expression.integrand import expression
from symrender.gradient import gradient
from symrender.images.image import read_image
from symrender.probe import probe
from symrender.quadrature.split_point import MET, gloss_points
from symrender.render import render
from symrender.scene.arrays import scene_arrays
from symrender.scene.load import load
from symrender.scene.scene import Scene
from symrender.simulator.build import simulator
from symrender.studies.budget import budget
from symrender.studies.subject import facts, subject
from symrender.truth import truth

BRDF = {"shading.lobe_units": "brdf_normalised"}
ALBEDO = {0: 1.0, 30: 0.866, 60: 0.50, 80: 0.18}
"""Directional albedo of the lobe n = 64, by angle of incidence in degrees, to the digits it is quoted in."""


def white_sky(degrees: float, n: float = 64.0, theta_max: float = math.pi / 2, units: str = "brdf_normalised") -> Scene:
    """A floor with a lobe under a sky of radiance 1, seen at an angle to its normal: its gloss is its albedo."""
    tilt = math.radians(degrees)
    eye = (4 * math.sin(tilt), 0.0, 4 * math.cos(tilt))
    return load(
        {
            "camera": {"type": "look_at", "eye": eye, "target": (0.0, 0.0, 0.0), "up": (0.0, 1.0, 0.0), "fov": 1.0},
            "floor": {"lobe": {"weight": 1.0, "exponent": n, "theta_max": theta_max}},
            "lights": [],
            "background": (1.0, 1.0, 1.0),
            "shading": {"lobe_units": units},
        }
    )


def albedo(degrees: float, n: float = 64.0, theta_max: float = math.pi / 2) -> float:
    """The albedo in 20 digits, ring by ring about the mirror direction, the horizon clipped."""
    tilt = mpmath.radians(degrees)

    def ring(theta: mpmath.mpf) -> mpmath.mpf:
        up, across = mpmath.cos(theta) * mpmath.cos(tilt), mpmath.sin(theta) * mpmath.sin(tilt)
        half = mpmath.pi if across <= up else mpmath.acos(-up / across)
        seen = 2 * (up * half + across * mpmath.sin(half))
        return (n + 2) / (2 * mpmath.pi) * mpmath.cos(theta) ** n * seen * mpmath.sin(theta)

    meets = min(math.pi / 2 - math.radians(degrees), theta_max)
    return float(mpmath.quad(ring, [0, 0.1, 0.2, 0.3] if meets > 0.3 and degrees > 79 else [0, meets / 2, meets]) + (
        mpmath.quad(ring, [meets, (meets + theta_max) / 2, theta_max]) if meets < theta_max else 0
    ))  # fmt: skip


@pytest.mark.parametrize("degrees", ALBEDO)
def test_directional_albedo_of_every_rule(degrees: int) -> None:
    closed, scene = albedo(degrees), white_sky(degrees)
    assert closed == pytest.approx(ALBEDO[degrees], abs=0.005)
    assert degrees or closed == pytest.approx(1.0, abs=1e-15)
    split = probe(scene, [(0.0, 0.0)], tol=1e-10)
    assert split.status[0] == MET and np.abs(split.gloss - closed).max() < 1e-11
    image = truth(scene, size=1, tol=1e-8).layer("gloss")[0, 0]
    assert np.abs(image - closed).max() < 1e-8
    # the middle of the outermost of equal shares lies far from its mean cosine
    rules = (
        ({"nodes": "gauss", "partition": "equal_weight"}, 1e-6),
        ({"nodes": "barycentre"}, 1e-5),
        ({"partition": "equal_weight"}, 3e-3),
    )
    # uniform samples of the cone: cos^64 deviates by four times its mean
    samplers = {"jittered": 0.01, "importance": 1e-4, "sobol": 1e-5, "independent": 0.06}
    for normalised in (False, True):
        for rule, off in rules:
            pair = render(scene, size=1, lobe=256, numeric="none", normalised=normalised, **rule)  # type: ignore[arg-type]
            assert pair.symbolic is not None
            assert np.abs(pair.symbolic.layer("gloss") - closed).max() < off
        for sampler, off in samplers.items():
            pair = render(scene, size=1, lobe=256, numeric=sampler, symbolic="none", normalised=normalised)  # type: ignore[arg-type]
            assert pair.numeric is not None
            assert np.abs(pair.numeric.layer("gloss") / closed - 1).max() < off


@pytest.mark.parametrize(("n", "theta_max"), [(0.0, 0.7), (2.5, 1.2), (16.0, math.pi / 3), (1e6, 0.3), (4.0, 1e-7)])
def test_scale_is_the_ratio_of_the_two_normalisers(n: float, theta_max: float) -> None:
    arrays = scene_arrays(white_sky(0.0))
    exact = normaliser(log_cosine(sp.Float(theta_max, 60)), sp.Float(n, 60)) / brdf_normaliser(sp.Float(n, 60))
    assert lobe_scale(arrays, n, theta_max) == pytest.approx(float(exact.evalf(40)), rel=1e-13)
    assert lobe_scale(arrays, n, 0.0) == 1.0
    assert lobe_scale(scene_arrays(white_sky(0.0, units="lobe_average")), n, theta_max) == 1.0


def test_pipelines_agree_direction_by_direction() -> None:
    # a mirror is one direction, the same one in both
    scene = load("gloss")
    mirrors = {f"{name}.lobe.mirror": True for name in ("floor", *(f"spheres.{s.name}" for s in scene.spheres))}
    pair = render(scene.replace(BRDF | mirrors), size=64)
    plain = render(scene.replace(mirrors), size=64, numeric="none")
    assert pair.numeric is not None and pair.symbolic is not None and plain.symbolic is not None
    a, b = pair.numeric.layer("gloss"), pair.symbolic.layer("gloss")
    signal = math.sqrt(float((a**2).mean()))
    assert pair.ledger.flips == 0 and signal > 0.05 and (a.max(axis=2) > 0.01).sum() > 1000
    assert np.abs(a - b).max() <= 1e-12 * signal
    # the mirror's cosine to the normal, and nothing else, tells the units apart
    shown = plain.symbolic.layer("gloss") > 1e-3
    ratio = b[shown] / plain.symbolic.layer("gloss")[shown]
    assert 0.0 < ratio.min() < 0.5 < ratio.max() <= 1.0 + 1e-12


def test_units_meet_at_normal_incidence_as_the_lobe_narrows() -> None:
    scene = load("chapter8").replace({"shading.ks": 0.0, "background": (0.3, 0.2, 0.1)})
    eye = scene.camera.eye
    point = [(float(eye[0]) + 1.3, float(eye[1]))]
    above = {"camera.eye": (point[0][0], point[0][1], 40.0)}
    apart = []
    for n in (100.0, 1000.0, 10000.0):
        narrow = scene.replace(above | {"floor.lobe.exponent": n})
        average, brdf = (probe(s, point, tol=1e-10) for s in (narrow, narrow.replace(BRDF)))
        assert average.convention == "lobe_average" and brdf.convention == "brdf_normalised"
        assert average.gloss.min() > 0.05
        apart.append(float(np.abs(brdf.gloss / average.gloss - 1).max()))
    # (n + 2)/(n + 1) times the mean cosine (n + 1)/(n + 2): one, but for what the radiance does across the lobe
    assert apart[0] < 0.02 and apart[1] < 0.2 * apart[0] + 1e-9 and apart[2] < 0.2 * apart[1] + 1e-9


@pytest.mark.parametrize(
    ("where", "place", "exponent"),
    [("floor", (1.0, -1.2, 0.0), 4.0), ("A", (0.7, -0.7, -0.1), 3.0), ("A", (0.5, -0.6, 0.4), 12.0)],
)
def test_brute_force(where: str, place: tuple[float, float, float], exponent: float) -> None:
    scene = load("chapter8").replace(BRDF | {"camera.eye": (3.0, -3.0, 2.0), "background": (0.2, 0.1, 0.05)})
    lobe = {"exponent": exponent, "theta_max": 1.3}
    scene = scene.replace({f"{s}.lobe.{key}": value for s in ("floor", "spheres.A") for key, value in lobe.items()})
    a = scene_arrays(scene)
    own = -1 if where == "floor" else 0
    normal = np.array([0.0, 0.0, 1.0]) if own < 0 else np.array(place) / np.linalg.norm(place)
    point = np.array(place) if own < 0 else a.spheres[0].center + a.spheres[0].radius * normal
    d = point - a.camera.eye
    d /= np.linalg.norm(d)
    found = gloss_points(a, point[None], normal[None], d[None], np.array([own + 2]), 1e-6)
    coarse, fine = (brute_lobe.gloss(a, point, normal, d, own, exponent, 1.3, k, 2 * k) for k in (60, 120))
    assert found.status[0] == MET and fine.min() > 0.01
    assert np.abs(found.gloss[0] - fine).max() <= found.error[0] + 4 * np.abs(fine - coarse).max() + 1e-3 * fine.max()
    # and the two conventions are told apart by more than that
    average = gloss_points(scene_arrays(scene.replace({"shading.lobe_units": "lobe_average"})), point[None],
                           normal[None], d[None], np.array([own + 2]), 1e-6)  # fmt: skip
    assert np.abs(average.gloss - found.gloss).max() > 0.008 * fine.max()


def test_images_of_the_rules_meet_the_truth() -> None:
    scene = load("gloss").replace(BRDF | {"floor.lobe.exponent": 24.0})
    true = truth(scene, size=10, tol=1e-4, aa="none")
    pair = render(scene, size=10, lobe=48, numeric="sobol", partition="equal_weight", nodes="barycentre", aa="none")
    average = truth(scene.replace({"shading.lobe_units": "lobe_average"}), size=10, tol=1e-3, aa="none")
    signal = math.sqrt(float((true.layer("gloss") ** 2).mean()))
    assert (true.layer("status") == MET).mean() > 0.99 and signal > 0.01
    for image in (pair.numeric, pair.symbolic):
        assert image is not None
        assert np.sqrt(((image.layer("gloss") - true.layer("gloss")) ** 2).mean()) < 0.02 * signal
    assert np.sqrt(((average.layer("gloss") - true.layer("gloss")) ** 2).mean()) > 0.2 * signal


def test_bounds_of_ball_arithmetic_hold_the_value() -> None:
    pytest.importorskip("flint")
    from symrender.certify.enclosure import certify

    point = np.array([1.0842336190554618, 0.1442282860697033, 0.0])
    for sky in (0.0, 0.2):
        scene = load("chapter8").replace(BRDF | {"shading.ks": 0.0, "background": (sky, sky, sky)})
        value = probe(scene, [point], tol=1e-9).gloss[0]
        proved = certify(scene_arrays(scene), point, most_boxes=600)
        assert value.max() > 1e-4 and proved.holds(value)
        assert (proved.high - proved.low).max() < 0.3 * value.max() + 1e-2
        assert not proved.holds(value + (proved.high - proved.low).max())


def test_expression_integrates_to_the_albedo() -> None:
    scene = white_sky(30.0, n=4.0, theta_max=1.0)
    held = expression(scene)
    assert held.units == "brdf_normalised" and "units: brdf_normalised" in str(held) and r"brdf\_norm" in held.latex()
    w, m = (sp.symbols(f"{v}_x {v}_y {v}_z", real=True) for v in "wm")
    assert held.weight == (w[0] * m[0] + w[1] * m[1] + w[2] * m[2]) ** held.parameters["floor.lobe.exponent"] * w[2]
    density = sp.lambdify((*w, *m, held.parameters["floor.lobe.exponent"]), held.weight / held.normaliser)
    axis = (-0.5, 0.0, math.sqrt(0.75))
    z = (1 + math.cos(1.0)) / 2 + (1 - math.cos(1.0)) / 2 * np.polynomial.legendre.leggauss(40)[0]
    share = np.polynomial.legendre.leggauss(40)[1] * (1 - math.cos(1.0)) / 2
    phi = 2 * np.pi * (np.arange(80) + 0.5) / 80
    total = 0.0
    for c, weight in zip(z, share, strict=True):
        s = math.sqrt(1 - c * c)
        x, y = s * np.cos(phi), s * np.sin(phi)
        world = (c * axis[0] + x * axis[2], y, c * axis[2] - x * axis[0])
        total += weight * float(np.mean(density(*world, *axis, 4.0))) * 2 * math.pi
    assert total == pytest.approx(albedo(30.0, 4.0, 1.0), rel=1e-12)
    assert total == pytest.approx(probe(scene, [(0.0, 0.0)]).gloss[0, 0], rel=1e-9)
    plain = expression(scene.replace({"shading.lobe_units": "lobe_average"}))
    assert plain.units == "lobe_average" and "units: lobe_average" in str(plain) and not plain.weight.has(sp.pi)


def test_every_output_names_the_units(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    for units in ("brdf_normalised", "lobe_average"):
        define = ["-D", f"shading.lobe_units={units}", "--force", "--out", str(tmp_path)]
        assert main(["render", "gloss", "--size", "8", "--lobe", "2", *define]) == 0
        assert f"units of lobes: {units}" in capfd.readouterr().out
        assert main(["render", "gloss", "--size", "8", "--lobe", "2", "--json", *define]) == 0
        assert json.loads(capfd.readouterr().out)["ledger"]["convention"] == units
        for side in ("numeric", "symbolic"):
            image = read_image(tmp_path / f"{side}.exr")
            assert image.meta["convention"] == units and f'lobe_units: "{units}"' in image.meta["scene"]
        assert main(["truth", "furnace", "--size", "4", "--tol", "1e-3", *define]) == 0
        assert f"units of lobes: {units}" in capfd.readouterr().out
        assert read_image(tmp_path / "truth.exr").meta["convention"] == units
        assert main(["probe", "chapter8", "-p", "1.2,-0.4", "--tol", "1e-3", *define[:2]]) == 0
        assert units in capfd.readouterr().out
        assert facts(subject(load("gloss").replace({"shading.lobe_units": units})))["units of lobes"] == units
    assert load("gloss").hash != load("gloss").replace(BRDF).hash


def test_a_study_that_splits_the_error_itself_follows_the_units() -> None:
    scene = load("gloss").replace(BRDF | {"floor.lobe.exponent": 24.0})
    study = budget(scene, size=8, lobe=4)
    assert study.facts["units of lobes"] == "brdf_normalised"


def test_what_has_no_brdf_units_refuses_them_by_name(tmp_path: Path) -> None:
    scene = load("gloss").replace(BRDF)
    with pytest.raises(Unsupported, match=r"shading\.lobe_units: brdf_normalised is not differentiated"):
        gradient(scene, ["spheres.B.center.x"], size=8)
    with pytest.raises(Unsupported, match=r"shading\.lobe_units: brdf_normalised is not differentiated"):
        probe(scene, [(0.3, -1.0)], wrt=["floor.lobe.exponent"])
    with pytest.raises(Unsupported, match=r"simulator: shading\.lobe_units brdf_normalised is not drawn"):
        simulator(scene, tmp_path / "page.html")
    with pytest.raises(SceneError, match=r"shading\.lobe_units: must be lobe_average or brdf_normalised"):
        load("gloss").replace({"shading.lobe_units": "watts"})
