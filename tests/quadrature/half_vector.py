"""What a rough conductor reflects, by half-way directions: an opinion of its own, plain NumPy.

With h = (theta, phi) about the normal, w_i the mirror image of w_o in h and dw = 4 (w_o.h) dh,

    int L f cos dw = int L F G (w_o.h)/(cos_o cos_h) du dphi/(2 pi),   D cos_h dh = du dphi/(2 pi),

u = tan^2/(alpha^2 + tan^2): no peak is left, the chart knows neither poles nor walls, and visibility and shading are
those of ``brute_lobe``. Nodes are those of a rank-1 lattice; an integrand that jumps along curves is met to about
N^-3/4, and what two lattices differ by says how well.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from symrender.quadrature.light_points import light_rows
from symrender.scene.arrays import SceneArrays

from .brute_lobe import radiance

Array = npt.NDArray[np.float64]

GOLDEN = 0.6180339887498949
CHUNK = 100_000


@dataclass(frozen=True)
class Rough:
    """GGX roughness, masking, and eta - i k of three channels."""

    alpha: float
    correlated: bool
    eta: Array
    k: Array
    beckmann: bool = False
    walter: bool = False


def fresnel(cosine: Array, eta: Array, k: Array) -> Array:
    """(N, 3) mean of both polarisations, from complex amplitudes."""
    index = eta + 1j * k
    c = cosine[:, None] + 0j
    inside = np.sqrt(1.0 - (1.0 - c * c) / index**2)
    upright = (c - index * inside) / (c + index * inside)
    tilted = (index * c - inside) / (index * c + inside)
    return np.asarray(0.5 * (np.abs(upright) ** 2 + np.abs(tilted) ** 2))


def tail(cosine: Array, alpha: float) -> Array:
    """Smith's Lambda of GGX: (sqrt(1 + alpha^2 tan^2) - 1)/2."""
    tan2 = 1.0 / cosine**2 - 1.0
    return 0.5 * (np.sqrt(1.0 + alpha * alpha * tan2) - 1.0)


def smooth_tail(cosine: Array, alpha: float) -> Array:
    """Smith's Lambda of Beckmann: (exp(-a^2)/(a sqrt pi) - erfc a)/2, a = 1/(alpha tan)."""
    a = cosine / (alpha * np.sqrt((1.0 - cosine) * (1.0 + cosine)))
    return np.asarray(0.5 * (np.exp(-a * a) / (a * math.sqrt(math.pi)) - np.vectorize(math.erfc)(a)))


def fitted_tail(cosine: Array, alpha: float) -> Array:
    """1/G1 - 1 of Walter's fit to it, of ratios that are whole in thousandths."""
    a = cosine / (alpha * np.sqrt((1.0 - cosine) * (1.0 + cosine)))
    return np.asarray(np.where(a < 1.6, (1000 + 2276 * a + 2577 * a**2) / (3535 * a + 2181 * a**2) - 1.0, 0.0))


def masking(incident: Array, seen: float, rough: Rough) -> Array:
    """G of both cosines."""
    kind = fitted_tail if rough.walter else smooth_tail if rough.beckmann else tail
    one, other = kind(incident, rough.alpha), kind(np.array(seen), rough.alpha)
    if rough.correlated:
        return np.asarray(1.0 / (1.0 + one + other))
    return np.asarray(1.0 / ((1.0 + one) * (1.0 + other)))


def reflected(a: SceneArrays, origin: Array, normal: Array, incoming: Array, own: int, rough: Rough, count: int,
              shift: float = 0.0) -> Array:  # fmt: skip
    """(3,) by ``count`` nodes of a lattice moved by ``shift``."""
    lights = light_rows(a, 2)
    seen = -incoming
    helper = np.eye(3)[np.argmin(np.abs(normal))]
    e1 = np.cross(normal, helper)
    e1 /= np.linalg.norm(e1)
    e2 = np.cross(normal, e1)
    total = np.zeros(3)
    for start in range(0, count, CHUNK):
        i = np.arange(start, min(count, start + CHUNK))
        u = (i + 0.5) / count
        phi = 2.0 * np.pi * ((i * GOLDEN + shift) % 1.0)
        t = rough.alpha * np.sqrt(u / (1.0 - u))
        cos_h = 1.0 / np.sqrt(1.0 + t * t)
        h = cos_h[:, None] * (normal + t[:, None] * (np.cos(phi)[:, None] * e1 + np.sin(phi)[:, None] * e2))
        along = h @ seen
        w = 2.0 * along[:, None] * h - seen
        up = w @ normal
        good = (along > 0.0) & (up > 0.0)
        w = w[good] / np.linalg.norm(w[good], axis=1)[:, None]
        f = radiance(a, origin, w, own, lights) * fresnel(along[good], rough.eta, rough.k)
        share = masking(up[good], float(seen @ normal), rough) * along[good] / ((seen @ normal) * cos_h[good])
        total += (f * share[:, None]).sum(0)
    return total / count


def albedo(rough: Rough, cos_view: float, order: int = 600) -> Array:
    """int f cos dw over the hemisphere by Gauss rules about the mirror direction's azimuth, from the half vector."""
    x, w = np.polynomial.legendre.leggauss(order)
    # the cosine to the normal, denser near the horizon, cut where the fit jumps
    slope = 1.6 * rough.alpha
    cut = (slope / math.sqrt(1.0 + slope * slope)) ** 0.5 if rough.walter else 0.5
    t = np.concatenate([0.5 * cut * (x + 1.0), cut + 0.5 * (1.0 - cut) * (x + 1.0)])
    cosine, by = t * t, 2.0 * t * np.concatenate([0.5 * cut * w, 0.5 * (1.0 - cut) * w])
    # the azimuth, denser near the mirror direction
    sinh = math.asinh(math.pi / rough.alpha)
    phi, along = rough.alpha * np.sinh(sinh * x), w * sinh * rough.alpha * np.cosh(sinh * x)
    sine, seen = np.sqrt(1.0 - cosine**2), math.sqrt(1.0 - cos_view**2)
    wx, wy = -sine[:, None] * np.cos(phi), sine[:, None] * np.sin(phi)
    hx, hy, hz = wx + seen, wy, cosine[:, None] + cos_view
    size = np.sqrt(hx**2 + hy**2 + hz**2)
    cos_h = hz / size
    d = rough.alpha**2 / (math.pi * (cos_h**2 * (rough.alpha**2 - 1.0) + 1.0) ** 2)
    if rough.beckmann:
        d = np.exp((1.0 - 1.0 / cos_h**2) / rough.alpha**2) / (math.pi * rough.alpha**2 * cos_h**4)
    f = d * masking(cosine, cos_view, rough)[:, None] / (4.0 * cos_view)
    reflectance = fresnel((0.5 * size).ravel(), rough.eta, rough.k).reshape(*size.shape, 3)
    return np.asarray(np.einsum("ij,ijc,i,j->c", f, reflectance, by, along))
