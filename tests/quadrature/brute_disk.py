"""What a disk light adds to a point, by polar quadrature: visibility asked of the geometry along every radius."""

from __future__ import annotations

import itertools

import numpy as np

from symrender.scene.arrays import CUT, PHONG, SceneArrays


def integrand(a: SceneArrays, q, normal, view, own: int, disk, points):
    """(V max(0, N.l), V s) at points (m, 3) of the light ``disk``, one of ``arrays.lights``; own -1 is the floor."""
    offset = points - q
    l = offset / np.sqrt((offset**2).sum(-1, keepdims=True))
    cosine = l @ normal
    clear = np.ones(len(points), bool)
    if a.floor.present:
        clear &= (points[:, 2] if own < 0 else q[2] * points[:, 2]) > 0
    for k, s in enumerate(a.spheres):
        if k == own:
            clear &= ((points - s.center) ** 2).sum(-1) >= s.radius**2
            continue
        f = q - s.center
        t = np.clip(-(offset @ f) / (offset**2).sum(-1), 0, 1)
        met = ((f + t[:, None] * offset) ** 2).sum(-1) < s.radius**2
        if f @ f < s.radius**2:
            met = ((points - s.center) ** 2).sum(-1) >= s.radius**2
        clear &= ~met
    if a.shading.model == PHONG:
        base = 2 * cosine * (normal @ view) - l @ view
    else:
        h = l + view
        base = (h @ normal) / np.sqrt((h**2).sum(-1))
    gleam = np.maximum(base, 0.0) ** a.shading.shininess
    if a.shading.terminator == CUT:
        gleam = np.where(cosine > 0, gleam, 0.0)
    return clear * np.maximum(cosine, 0), clear * gleam, clear, cosine > 0


def means(a: SceneArrays, q, normal, view, own: int, disk, e1, e2, azimuths: int = 2000, nodes: int = 16):
    """Means over the disk: midpoint rule in azimuth, Gauss between the radii at which a point of the disk vanishes.

    The jumps along a radius are bracketed by 200 samples and bisected; what is left is the azimuth's kinks, so the
    error falls like azimuths^-1.5: compare two.
    """
    x, w = np.polynomial.legendre.leggauss(nodes)
    grid = np.linspace(0, 1, 201)
    total = np.zeros(2)
    for angle in 2 * np.pi * (np.arange(azimuths) + 0.5) / azimuths:
        ray = disk.radius * (np.cos(angle) * e1 + np.sin(angle) * e2)

        def label(r, ray=ray):
            _, _, clear, above = integrand(a, q, normal, view, own, disk, disk.position + np.outer(r, ray))
            return 2 * clear + above

        marks = label(grid)
        cuts = [0.0]
        for i in np.nonzero(np.diff(marks))[0]:
            low, high = grid[i], grid[i + 1]
            for _ in range(44):
                middle = 0.5 * (low + high)
                low, high = (middle, high) if label(np.array([middle]))[0] == marks[i] else (low, middle)
            cuts.append(0.5 * (low + high))
        cuts.append(1.0)
        for low, high in itertools.pairwise(cuts):
            r = low + (high - low) * 0.5 * (1 + x)
            d, s, _, _ = integrand(a, q, normal, view, own, disk, disk.position + np.outer(r, ray))
            total += (high - low) * np.array([(w * r * d).sum(), (w * r * s).sum()])
    return total / azimuths
