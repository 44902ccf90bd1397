"""Signs of textures by polynomials, against the angles they eliminate."""

from __future__ import annotations

import math

import mpmath
import numpy as np
import pytest
import sympy as sp

from emitted import FORMULAS
from symrender.expression import texture
from symrender.expression.vectors import vec3
from symrender.jit.records import Table, table
from symrender.scene import arrays as at
from symrender.scene.records import Sphere

NORMAL = vec3("n")


def textured(kind: int, ku: float, kv: float, dark: float) -> Table[Sphere]:
    """One sphere of this texture; nothing else of it matters here."""
    spheres = table(Sphere, 1)
    sphere = spheres[0]
    sphere.texture, sphere.ku, sphere.kv, sphere.dark = kind, ku, kv, dark
    return spheres


def normals(count: int, seed: int) -> np.ndarray:
    """Random unit normals, uniform over the sphere."""
    n = np.random.default_rng(seed).normal(size=(count, 3))
    return n / np.linalg.norm(n, axis=1)[:, None]


def waves(n: np.ndarray, ku: float, kv: float) -> tuple[np.ndarray, np.ndarray]:
    """sin(pi u ku), sin(pi v kv) by the chart."""
    u = (np.arctan2(n[:, 1], n[:, 0]) + math.pi) / (2 * math.pi)
    v = np.arccos(np.clip(n[:, 2], -1, 1)) / math.pi
    return np.sin(math.pi * u * ku), np.sin(math.pi * v * kv)


@pytest.mark.parametrize("k", [0, 1, 2, 3, 4, 7, 8, 16])
def test_polynomials_have_the_signs_of_the_waves(k: int) -> None:
    n = normals(4000, k)
    azimuthal, polar = waves(n, 2 * k, k)
    for wave, polynomial in (
        (azimuthal, texture.azimuth_polynomial(NORMAL, 2 * k)),
        (polar, texture.polar_polynomial(NORMAL, k)),
    ):
        assert polynomial.is_polynomial(*NORMAL.parts)
        assert not polynomial.has(sp.atan2, sp.acos, sp.sin)
        if k == 0:
            assert polynomial == 0
            continue
        found = sp.lambdify(NORMAL.parts, polynomial, "math")
        values = np.array([found(*row) for row in n])
        clear = np.abs(wave) > 1e-9
        assert clear.sum() >= 3990 and (k == 1 or 0.2 < (wave > 0).mean() < 0.8)
        assert (np.sign(values[clear]) == np.sign(wave[clear])).all()


def test_polynomials_are_the_identities_they_claim() -> None:
    phi, theta = sp.symbols("phi theta", positive=True)
    on_sphere = {
        NORMAL.x: sp.sin(theta) * sp.cos(phi),
        NORMAL.y: sp.sin(theta) * sp.sin(phi),
        NORMAL.z: sp.cos(theta),
    }
    for k in (1, 2, 5):
        azimuthal = texture.azimuth_polynomial(NORMAL, 2 * k).subs(on_sphere)
        polar = texture.polar_polynomial(NORMAL, k).subs(on_sphere)
        for found, wave in (
            (azimuthal, sp.sin(theta) ** k * sp.sin(k * (phi + sp.pi))),
            (sp.sin(theta) * polar, sp.sin(k * theta)),
        ):
            assert sp.expand((found - wave).rewrite(sp.exp)) == 0


@pytest.mark.parametrize("kind", [at.CHECKER, at.STRIPES])
@pytest.mark.parametrize(("ku", "kv"), [(8, 4), (16, 8), (7, 3), (2.5, 1.75), (64, 64), (66, 65), (0, 4), (8, 0)])
def test_emitted_factor_is_the_sign_of_the_waves(kind: int, ku: float, kv: float) -> None:
    spheres = textured(kind, ku, kv, 0.2)
    n = normals(3000, 17)
    azimuthal, polar = waves(n, ku, kv)
    wave = azimuthal * (polar if kind == at.CHECKER else 1)
    # a chart has rounding of about 1e-16 k; nothing this close to a tie says which side it is
    clear = (np.abs(azimuthal) > 1e-11) & (np.abs(polar) > 1e-11)
    found = np.array([FORMULAS.texture_factor(0, *row, spheres) for row in n.tolist()])
    if ku == 0 or (kv == 0 and kind == at.CHECKER):
        assert (found == 1).all()
        return
    if kv:
        assert clear.sum() >= 2990
    else:
        clear = np.abs(azimuthal) > 1e-11
    assert 0.3 < (found == 1).mean() < 0.8
    assert (found[clear] == np.where(wave[clear] >= 0, 1.0, 0.2)).all()


def test_marble_against_thirty_digits() -> None:
    spheres = textured(at.MARBLE, 3.0, 2.0, 0.0)
    values = []
    for row in normals(200, 5).tolist():
        with mpmath.workdps(30):
            u = (mpmath.atan2(row[1], row[0]) + mpmath.pi) / (2 * mpmath.pi)
            v = mpmath.acos(min(1, max(-1, row[2]))) / mpmath.pi
            vein = mpmath.sin(2 * mpmath.pi * (3 * u + mpmath.mpf("0.35") * mpmath.sin(6 * mpmath.pi * v)))
            exact = mpmath.mpf("0.55") + mpmath.mpf("0.225") * (1 + vein)
        values.append(FORMULAS.texture_factor(0, *row, spheres))
        assert abs(values[-1] - exact) < 1e-14
    assert max(values) > 0.99 and min(values) < 0.56


@pytest.mark.parametrize("kind", [at.CHECKER, at.STRIPES])
def test_ties_on_a_sphere_are_bright(kind: int) -> None:
    spheres = textured(kind, 8, 4, 0.2)
    # sin(4 (phi + pi)) = 0 exactly at phi = 0, pi/2, pi, and at both poles; U_3 = 0 on the equator
    ties = [(1.0, 0.0, 0.0), (-1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.6, 0.0, 0.8), (0.0, 0.0, 1.0), (0.0, 0.0, -1.0)]
    if kind == at.CHECKER:
        ties += [(0.6, 0.8, 0.0), (0.28, -0.96, 0.0)]
    for tie in ties:
        assert FORMULAS.texture_factor(0, *tie, spheres) == 1, tie


@pytest.mark.parametrize(("cell", "offset"), [(1.0, (0.0, 0.0)), (0.5, (0.25, -3.0)), (3.0, (1.0, 2.0))])
def test_floor_parity_and_its_ties(cell: float, offset: tuple[float, float]) -> None:
    rng = np.random.default_rng(8)
    dark = ties = 0
    for a, b in rng.uniform(-9, 9, size=(500, 2)).tolist():
        bright = math.sin(math.pi * a) * math.sin(math.pi * b) >= 0
        dark += not bright
        assert FORMULAS.floor_side(offset[0] + cell * a, offset[1] + cell * b, cell, *offset) == bright
        for x, y in ((math.floor(a), b), (a, math.floor(b)), (math.floor(a), math.floor(b))):
            ties += 1
            assert FORMULAS.floor_side(offset[0] + cell * x, offset[1] + cell * y, cell, *offset) == 1
    assert 200 < dark < 300 and ties == 1500


def test_parity_symbol() -> None:
    x, y, c = sp.symbols("x y c", real=True)
    parity = texture.floor_parity(x, y, c, sp.Integer(0), sp.Integer(0))
    for a, b in ((0.5, 0.5), (-0.5, 0.5), (2.25, -3.75)):
        even = int(parity.subs({x: a, y: b, c: 1})) % 2 == 0
        assert even == (math.sin(math.pi * a) * math.sin(math.pi * b) > 0)
