"""A second kind of lobe: what a rough conductor reflects, against half-way directions and closed energy."""

from __future__ import annotations

import math

import mpmath
import numpy as np
import numpy.typing as npt
import pytest

import symrender as sr
from symrender.chambers.lobes.record import CORRELATED, SEPARABLE, Conductor
from symrender.errors import Unsupported
from symrender.jit.compiled import compiled
from symrender.jit.records import Table, table
from symrender.leaves import radiometric, values
from symrender.quadrature.background import directional_albedo
from symrender.quadrature.light_points import light_rows
from symrender.quadrature.split_point import SplitResult, gloss_points
from symrender.quadrature.split_scratch import split_work
from symrender.scene.arrays import SceneArrays, scene_arrays

from .half_vector import Rough, albedo, fresnel, reflected
from .random_lobe import RandomLobe, random_lobe

Array = npt.NDArray[np.float64]

GOLD = Rough(0.1, False, np.array([0.18, 0.42, 1.37]), np.array([3.42, 2.35, 1.77]))
WHITE = (np.zeros(3), np.ones(3))
"""eta and k of a conductor that reflects everything."""


def conductors(arrays: SceneArrays, rough: Rough, surface: int) -> Table[Conductor]:
    """One surface of a scene made of it, the others of what is seen where theirs is taken."""
    rows = table(Conductor, 2 + len(arrays.spheres) + len(arrays.planes))
    for row in rows:
        row.alpha, row.masking, row.eta[:], row.k[:] = 0.77, SEPARABLE, 9.0, 0.1
    row = rows[surface]
    row.alpha, row.masking = rough.alpha, CORRELATED if rough.correlated else SEPARABLE
    row.eta[:], row.k[:] = rough.eta, rough.k
    return rows


def dark(arrays: SceneArrays) -> Array:
    """That no sphere emits, said as images of conductors under lamps say it: the kernel is theirs."""
    return np.zeros((len(arrays.spheres), 3))


def integrated(case: RandomLobe, rough: Rough, tol: float) -> SplitResult:
    return gloss_points(
        case.arrays, case.point[None], case.normal[None], case.incoming[None], np.array([case.surface]), tol,
        conductors=conductors(case.arrays, rough, case.surface), emitted=dark(case.arrays),
    )  # fmt: skip


def drawn(seed: int) -> tuple[RandomLobe, Rough]:
    """A random scene in black surroundings, of a random conductor."""
    case = random_lobe(seed)
    case.arrays.shading.background[:] = 0.0
    rng = np.random.default_rng(seed + 10**6)
    alpha = float(rng.choice([0.3, 0.1, 0.03, 10 ** rng.uniform(-3, 0)]))
    return case, Rough(alpha, bool(rng.random() < 0.5), rng.uniform(0.1, 3, 3), rng.uniform(1, 5, 3))


@pytest.mark.parametrize("alpha", [0.3, 0.1, 0.03])
def test_a_checker_spheres_and_shadows_are_what_half_way_directions_see(alpha: float) -> None:
    arrays = scene_arrays(sr.load("gloss").replace({"background": (0, 0, 0)}))
    points = np.array([[0.3, -1.0, 0.0], [1.0, -0.6, 0.0], [-1.5, 0.4, 0.0]])
    incoming = points - arrays.camera.eye
    incoming /= np.linalg.norm(incoming, axis=1)[:, None]
    up, rough = np.array([0.0, 0.0, 1.0]), Rough(alpha, False, GOLD.eta, GOLD.k)
    args = (arrays, points, np.tile(up, (3, 1)), incoming, np.ones(3, np.int64))
    rows, none = conductors(arrays, rough, 1), dark(arrays)
    loose, tight = (gloss_points(*args, tol, conductors=rows, emitted=none) for tol in (1e-4, 1e-8))
    assert (tight.status == 0).all() and (tight.error <= 1e-8).all() and (tight.chambers > 10).all()
    assert (np.abs(loose.gloss - tight.gloss).max(axis=1) <= loose.error).all()
    judged = 0
    for i in range(3):
        one, other = (reflected(arrays, points[i], up, incoming[i], -1, rough, n, n / 1e6) for n in (120_000, 80_000))
        apart = np.abs(one - other).max()
        signal = np.abs(tight.gloss[i]).max()
        assert np.abs(one - tight.gloss[i]).max() <= 4.0 * apart + 1e-6
        judged += int(signal > 4e-4 and apart < 0.03 * signal)
    assert judged >= 2


def test_the_squares_of_a_checker_are_seen_from_a_ball() -> None:
    arrays = scene_arrays(sr.load("gloss").replace({"background": (0, 0, 0)}))
    normal, incoming = np.array([0.0, -0.9, -0.43]), np.array([0.2, 0.9, 0.1])
    normal, incoming = normal / np.linalg.norm(normal), incoming / np.linalg.norm(incoming)
    point = arrays.spheres[0].center + arrays.spheres[0].radius * normal
    rough = Rough(0.2, True, GOLD.eta, GOLD.k)
    found = gloss_points(
        arrays, point[None], normal[None], incoming[None], np.array([2]), 1e-6,
        conductors=conductors(arrays, rough, 2), emitted=dark(arrays),
    )  # fmt: skip
    one, other = (reflected(arrays, point, normal, incoming, 0, rough, n, n / 1e6) for n in (120_000, 80_000))
    apart, signal = np.abs(one - other).max(), np.abs(one).max()
    assert found.status[0] == 0 and signal > 0.02 and apart < 3e-3 * signal
    assert np.abs(one - found.gloss[0]).max() <= 4.0 * apart + 1e-6


@pytest.mark.timeout(300)
def test_stated_errors_hold_and_half_way_directions_agree() -> None:
    lit, judged = 0, 0
    for seed in range(48):
        case, rough = drawn(seed)
        loose, tight = integrated(case, rough, case.tol), integrated(case, rough, min(1e-8, 0.01 * case.tol))
        off = np.abs(loose.gloss - tight.gloss).max()
        assert off <= loose.error[0] + tight.error[0], (seed, rough, off, loose.error, tight.error)
        lit += int(tight.gloss.max() > 1e-6)
        if seed % 4 or tight.status[0] != 0:
            continue
        a, b = (reflected(case.arrays, case.point, case.normal, case.incoming, case.surface - 2, rough, n, n / 1e6)
                for n in (60_000, 40_000))  # fmt: skip
        apart, signal = np.abs(a - b).max(), np.abs(a).max()
        assert np.abs(a - tight.gloss[0]).max() <= 4.0 * apart + 0.02 * signal + 3e-5 / math.sqrt(rough.alpha), seed
        judged += int(signal > 1e-5)
    assert lit > 35 and judged >= 6


def above_a_plain(height: float, tilt: Array) -> SceneArrays:
    """The lowest point of a small ball sees nothing but an endless plane, as bright everywhere."""
    up = tilt / np.linalg.norm(tilt)
    white = {"type": "solid", "color": [1, 1, 1]}
    data = {
        "name": "plain", "ambient": [1, 1, 1], "background": [0, 0, 0], "floor": None, "lights": [],
        "planes": [{"name": "plain", "point": [0, 0, 0], "normal": up.tolist(), "texture": white}],
        "spheres": [{"name": "S", "center": ((height + 0.1) * up).tolist(), "radius": 0.1}],
        "shading": {"ka": 1.0, "kd": 0.0, "ks": 0.0},
        "camera": {"type": "look_at", "eye": [0, -5, 3], "target": [0, 0, 0], "up": [0, 0, 1], "fov": 40},
    }  # fmt: skip
    return scene_arrays(sr.load(data))


@pytest.mark.parametrize("tilt", [(0.0, 0.0, 1.0), (0.3, -0.5, 0.8)])
@pytest.mark.parametrize("correlated", [False, True])
@pytest.mark.parametrize("eta, k", [WHITE, (GOLD.eta, GOLD.k)], ids=["white", "gold"])
def test_an_endless_plane_is_reflected_by_the_directional_albedo(
    eta: Array, k: Array, correlated: bool, tilt: tuple[float, float, float]
) -> None:
    arrays = above_a_plain(0.7, np.array(tilt))
    down = -np.array(tilt) / np.linalg.norm(tilt)
    point = arrays.spheres[0].center + 0.1 * down
    aside = np.cross(down, [1.0, 0.0, 0.0])
    aside /= np.linalg.norm(aside)
    for alpha in (0.6, 0.3, 0.1):
        for cos_view in (0.9, 0.4):
            rough = Rough(alpha, correlated, eta, k)
            incoming = -(cos_view * down + math.sqrt(1.0 - cos_view**2) * aside)
            found = gloss_points(
                arrays, point[None], down[None], incoming[None], np.array([2]), 1e-9,
                conductors=conductors(arrays, rough, 2), emitted=dark(arrays),
            )  # fmt: skip
            expected = albedo(rough, cos_view, 200)
            assert expected.min() > 0.2 and expected.max() < 1.0
            assert found.status[0] == 0
            assert np.abs(found.gloss[0] - expected).max() <= found.error[0] + 1e-9


def test_no_direction_farther_off_has_a_larger_density() -> None:
    rng, tightest = np.random.default_rng(3), 0.0
    for _ in range(4000):
        alpha, cos_view = 10 ** rng.uniform(-3, 0), rng.uniform(0.01, 1.0)
        root = values.smith_root(cos_view, alpha)
        by = (cos_view + root,) * 2 if rng.random() < 0.5 else (2.0 * root, 2.0 * cos_view)
        m = np.array([math.sqrt(1.0 - cos_view**2), 0.0, cos_view])
        w = m + rng.normal(size=3) * 10 ** rng.uniform(-3, 1)
        w /= np.linalg.norm(w)
        if w[2] <= 0.0:
            continue
        square = float(((w - m) ** 2).sum())
        density, cosine2 = values.ggx_lobe(square, float(w[2] - m[2]), alpha, cos_view, *by)
        bound = values.ggx_most(square, alpha, *by)
        assert density <= bound * (1.0 + 1e-12)
        half = w - m + 2.0 * np.array([0.0, 0.0, cos_view])
        assert cosine2 == pytest.approx(0.25 * half @ half, rel=1e-12)
        tightest = max(tightest, density / bound)
    assert tightest > 0.99


def test_reflectance_is_that_of_complex_amplitudes() -> None:
    rng = np.random.default_rng(5)
    for _ in range(300):
        eta, k, cosine = rng.uniform(0.05, 4.0), rng.uniform(0.5, 8.0), rng.uniform(0.0, 1.0)
        expected = fresnel(np.array([cosine]), np.array([eta]), np.array([k]))[0, 0]
        assert radiometric.conductor_fresnel(cosine, eta, k) == pytest.approx(expected, rel=1e-11)
    for cosine in (0.0, 0.3, 1.0):
        assert radiometric.conductor_fresnel(cosine, 0.0, 1.0) == pytest.approx(1.0, abs=1e-15)


def test_reflectance_keeps_its_digits_where_hardly_anything_is_absorbed() -> None:
    """Total reflection, eta < 1 and a small k, is where the textbook's form loses half of them."""
    rng, lost = np.random.default_rng(6), []
    with mpmath.workdps(50):
        for _ in range(1000):
            eta, cosine = float(10 ** rng.uniform(-3, 1)), float(rng.uniform(0.0, 1.0))
            k = float(10 ** rng.uniform(-14, 1)) if rng.random() < 0.8 else 0.0
            index, sin2 = mpmath.mpc(eta, k) ** 2, 1 - mpmath.mpf(cosine) ** 2
            onward = mpmath.sqrt(index - sin2)
            upright, level = (
                (cosine - onward) / (cosine + onward),
                (index * cosine - onward) / (index * cosine + onward),
            )
            expected = (abs(upright) ** 2 + abs(level) ** 2) / 2
            assert abs(radiometric.conductor_fresnel(cosine, eta, k) - expected) <= 4e-15, (cosine, eta, k)
            # the same by sqrt((|s + 2 i eta k| + s)/2)
            s = (eta - k) * (eta + k) - float(sin2)
            textbook = math.sqrt(max(0.0, 0.5 * (math.hypot(s, 2.0 * eta * k) + s)))
            lost.append(float(abs(textbook - onward.real)))
    assert sum(each > 1e-10 for each in lost) > 50 and max(lost) > 1e-9


def test_a_background_is_what_nothing_hides_of_the_directional_albedo() -> None:
    background = np.array([0.4, 0.2, 0.1])
    arrays = scene_arrays(sr.load("gloss").replace({"background": tuple(background.tolist())}))
    points = np.array([[0.3, -1.0, 0.0], [1.0, -0.6, 0.0], [-1.5, 0.4, 0.0]])
    incoming = points - arrays.camera.eye
    incoming /= np.linalg.norm(incoming, axis=1)[:, None]
    up, rough = np.array([0.0, 0.0, 1.0]), Rough(0.3, True, GOLD.eta, GOLD.k)
    rows = conductors(arrays, rough, 1)
    less = gloss_points(
        arrays, points, np.tile(up, (3, 1)), incoming, np.ones(3, np.int64), 1e-7, conductors=rows, emitted=dark(arrays)
    )
    whole = directional_albedo(rows[1], -incoming[:, 2], 1e-8, 10**6, split_work(arrays, light_rows(arrays, 2)))
    assert (less.status == 0).all() and (whole.status == 0).all() and (whole.error <= 1e-8).all()
    for i in range(3):
        assert np.abs(whole.gloss[i] - albedo(rough, float(-incoming[i, 2]), 200)).max() < 1e-8
        one, other = (reflected(arrays, points[i], up, incoming[i], -1, rough, n, n / 1e6) for n in (120_000, 80_000))
        apart, value = np.abs(one - other).max(), less.gloss[i] + background * whole.gloss[i]
        assert value.max() > 0.02 and np.abs(background * whole.gloss[i] - value).max() > 0.01
        # lattices know edges to N^-3/4, and two of them may agree by chance
        assert np.abs(one - value).max() <= 4.0 * apart + 1.5e-4


def test_slope_of_reflectance_at_total_reflection() -> None:
    """By cosine and eta nothing changes while all is reflected; a first trace of absorption is felt at once."""
    kernel = compiled(_fill_reflectance)

    def reflectance(*given: complex) -> complex:
        """Reflectance, and as imaginary part its derivative along the imaginary parts."""
        found = np.zeros(1, np.complex128)
        kernel(np.array(given, np.complex128), found)
        return complex(found[0])

    for cosine, eta in ((0.3, 0.25), (0.5, 0.6), (0.05, 0.9)):
        assert reflectance(cosine + 1j, eta, 0.0) == pytest.approx(1.0, abs=1e-14)
        assert reflectance(cosine, eta + 1j, 0.0) == pytest.approx(1.0, abs=1e-14)
        step = 1e-6
        by_difference = (radiometric.conductor_fresnel(cosine, eta, step) - 1.0) / step
        assert by_difference < -0.1
        assert reflectance(cosine, eta, step + 1j).imag == pytest.approx(by_difference, rel=1e-4)


def _fill_reflectance(given: Array, found: Array) -> None:
    found[0] = radiometric.conductor_fresnel(given[0], given[1], given[2])


def test_what_is_not_integrated_is_refused_by_name() -> None:
    case, rough = drawn(1)
    arrays = case.arrays
    args = (arrays, case.point[None], case.normal[None], case.incoming[None], np.array([case.surface]))
    with pytest.raises(ValueError, match=r"conductors: \d rows are asked for"):
        gloss_points(*args, conductors=table(Conductor, 1))
    wrong = conductors(arrays, rough, case.surface)
    wrong[1].alpha = -0.1
    with pytest.raises(ValueError, match=r"conductors: alpha must be in \[0, 1\]"):
        gloss_points(*args, conductors=wrong)
    arrays.shading.units = 1.0
    with pytest.raises(Unsupported, match="brdf_normalised says nothing of a conductor"):
        gloss_points(*args, conductors=conductors(arrays, rough, case.surface))
