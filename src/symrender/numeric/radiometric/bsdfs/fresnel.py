"""Reflectance of smooth interfaces by Fresnel's equations, for unpolarised light.

Of metals the amplitudes are computed as complex numbers, as pairs.
"""

from __future__ import annotations

import math

from symrender.jit.marks import inlined, jitable

Complex = tuple[float, float]


@inlined
def times(a: Complex, b: Complex) -> Complex:
    """Product of two complex numbers."""
    return (a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0])


@inlined
def over(a: Complex, b: Complex) -> Complex:
    """Quotient of two complex numbers."""
    size = b[0] * b[0] + b[1] * b[1]
    return ((a[0] * b[0] + a[1] * b[1]) / size, (a[1] * b[0] - a[0] * b[1]) / size)


@inlined
def principal_root(a: Complex) -> Complex:
    """Square root of a complex number, its real part not negative."""
    size = math.sqrt(math.sqrt(a[0] * a[0] + a[1] * a[1]))
    half = 0.5 * math.atan2(a[1], a[0])
    return (size * math.cos(half), size * math.sin(half))


@jitable
def fresnel(cosine: float, eta: float, k: float) -> float:
    """Mean of |r_s|^2 and |r_p|^2 of a conductor of index n = eta + i k, by Snell's law for a complex n."""
    n = (eta, k)
    bent = over((1.0 - cosine * cosine, 0.0), times(n, n))
    inner = principal_root((1.0 - bent[0], -bent[1]))
    a, b = times(n, inner), (n[0] * cosine, n[1] * cosine)
    s = over((cosine - a[0], -a[1]), (cosine + a[0], a[1]))
    p = over((b[0] - inner[0], b[1] - inner[1]), (b[0] + inner[0], b[1] + inner[1]))
    return 0.5 * (s[0] * s[0] + s[1] * s[1] + p[0] * p[0] + p[1] * p[1])


@jitable
def interface(cosine: float, eta: float) -> tuple[float, float]:
    """(mean of |r_s|^2 and |r_p|^2, cosine beyond) of light before ``eta`` times its index; 1, 0 if none crosses."""
    if eta == 1.0:
        return 0.0, cosine
    beyond = 1.0 - (1.0 - cosine * cosine) / (eta * eta)
    if beyond <= 0.0:
        return 1.0, 0.0
    inner = math.sqrt(beyond)
    s = (cosine - eta * inner) / (cosine + eta * inner)
    p = (eta * cosine - inner) / (eta * cosine + inner)
    return 0.5 * (s * s + p * p), inner


def diffuse_reflectance(eta: float) -> float:
    """Share of diffuse light that an interface to ``eta`` times its index reflects, as Mitsuba's plastic has it.

    Fits: W. G. Egan, T. Hilgeman, "Spectral reflectance of particulate materials" (1973) below 1; E. d'Eon, G. Irving,
    "A quantized-diffusion model for rendering translucent materials" (2011) above. They are .1 % off from 2/3 to 2.
    """
    if eta < 1.0:
        return -1.4399 * eta * eta + 0.7099 * eta + 0.6681 + 0.0636 / eta
    x = 1.0 / eta
    return 0.919317 + x * (-3.4793 + x * (6.75335 + x * (-7.80989 + x * (4.98554 - 1.36881 * x))))
