"""What a disk light adds to a point, by polar quadrature: visibility asked of the geometry along every radius."""

from __future__ import annotations

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

    The jumps along a radius are bracketed by 200 samples and bisected, all at a time; what is left is the azimuth's
    kinks, so the error falls like azimuths^-1.5: compare two.
    """
    x, w = np.polynomial.legendre.leggauss(nodes)
    grid = np.linspace(0, 1, 201)
    angles = 2 * np.pi * (np.arange(azimuths) + 0.5) / azimuths
    rays = disk.radius * (np.cos(angles)[:, None] * e1 + np.sin(angles)[:, None] * e2)

    def seen(r, which):
        return integrand(a, q, normal, view, own, disk, disk.position + r[:, None] * rays[which])

    def label(r, which):
        _, _, clear, above = seen(r, which)
        return 2 * clear + above

    marks = label(np.tile(grid, azimuths), np.repeat(np.arange(azimuths), len(grid))).reshape(azimuths, -1)
    which, first = np.nonzero(np.diff(marks, axis=1))
    low, high = grid[first], grid[first + 1]
    for _ in range(44):
        middle = 0.5 * (low + high)
        same = label(middle, which) == marks[which, first]
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    every = np.arange(azimuths)
    radius = np.concatenate([np.zeros(azimuths), 0.5 * (low + high), np.ones(azimuths)])
    ray = np.concatenate([every, which, every])
    order = np.lexsort((radius, ray))
    radius, ray = radius[order], ray[order]
    piece = ray[:-1] == ray[1:]
    low, high, ray = radius[:-1][piece], radius[1:][piece], ray[:-1][piece]
    r = low[:, None] + (high - low)[:, None] * 0.5 * (1 + x)
    d, s, _, _ = seen(r.ravel(), np.repeat(ray, nodes))
    by = ((high - low)[:, None] * w * r).ravel()
    return np.array([(by * d).sum(), (by * s).sum()]) / azimuths
