"""Signs of textures, with atan2 and acos eliminated from every one.

With azimuth phi and polar angle theta of the unit normal, the chart is u = (phi + pi)/(2 pi), v = theta/pi, so
sin(pi u ku) = sin(m (phi + pi)) with m = ku/2. For whole m that is (-1)^m Im (Nx + i Ny)^m / sin^m theta, and for
whole kv sin(pi v kv) = sin theta U_{kv-1}(Nz): signs of polynomials in the normal.
"""

from __future__ import annotations

import sympy as sp

from symrender.expression.formulas.textures import floor_phases
from symrender.expression.vectors import Vec3


def azimuth_step(real: sp.Expr, imag: sp.Expr, normal: Vec3) -> tuple[sp.Expr, sp.Expr]:
    """(real + i imag) times -(Nx + i Ny): m steps from 1 give (-1)^m (Nx + i Ny)^m."""
    return imag * normal.y - real * normal.x, -real * normal.y - imag * normal.x


def chebyshev_step(previous: sp.Expr, current: sp.Expr, z: sp.Expr) -> tuple[sp.Expr, sp.Expr]:
    """Next pair of Chebyshev polynomials of the second kind, U_{k+1} = 2 z U_k - U_{k-1}; start from (0, 1)."""
    return current, 2 * z * current - previous


def azimuth_polynomial(normal: Vec3, ku: int) -> sp.Expr:
    """The polynomial in Nx, Ny whose sign is that of sin(pi u ku), for even ku."""
    real: sp.Expr = sp.Integer(1)
    imag: sp.Expr = sp.Integer(0)
    for _ in range(ku // 2):
        real, imag = (sp.expand(part) for part in azimuth_step(real, imag, normal))
    return imag


def polar_polynomial(normal: Vec3, kv: int) -> sp.Expr:
    """The polynomial in Nz whose sign is that of sin(pi v kv), for whole kv."""
    if kv == 0:
        return sp.Integer(0)
    previous: sp.Expr = sp.Integer(0)
    current: sp.Expr = sp.Integer(1)
    for _ in range(kv - 1):
        previous, current = (sp.expand(part) for part in chebyshev_step(previous, current, normal.z))
    return current


def wave(coordinate: sp.Expr, frequency: sp.Expr) -> sp.Expr:
    """sin(pi coordinate frequency), whose sign is a checker's or a stripe's."""
    return sp.sin(sp.pi * coordinate * frequency)


def floor_parity(x: sp.Expr, y: sp.Expr, cell: sp.Expr, offset_x: sp.Expr, offset_y: sp.Expr) -> sp.Expr:
    """Number of the floor square, floor((x - ox)/cell) + floor((y - oy)/cell): even squares are bright.

    sin(pi a) sin(pi b) is positive exactly where floor(a) + floor(b) is even.
    """
    east, north = floor_phases(x, y, cell, offset_x, offset_y)
    return sp.floor(east) + sp.floor(north)
