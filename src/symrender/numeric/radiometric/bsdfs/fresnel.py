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
