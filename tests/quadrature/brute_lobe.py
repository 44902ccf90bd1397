"""The lobe integral by brute force: literal visibility and shading of midpoints, no walls, no charts, plain NumPy."""

from __future__ import annotations

import dataclasses

import numpy as np

from symrender.chambers.records import LightPoint
from symrender.quadrature.light_points import disk_frame, light_rows
from symrender.records import joined
from symrender.scene.arrays import DISK, SceneArrays


def _unit(v):
    return v / np.sqrt((v * v).sum(-1, keepdims=True))


def _sphere_roots(origin, direction, center, radius):
    f = origin - center
    b = (f * direction).sum(-1)
    disc = b * b - ((f * f).sum(-1) - radius**2)
    root = np.sqrt(np.maximum(disc, 0.0))
    return disc > 0, -b - root, -b + root


def radiance(a: SceneArrays, origin, directions, own: int, lights) -> np.ndarray:
    """f(P, w) for directions (M, 3); ``own`` is the sphere P lies on, -1 for the floor, -2 for none."""
    m = len(directions)
    best, shape = np.full(m, np.inf), np.full(m, -1)
    for j, s in enumerate(a.spheres):
        if j == own:
            continue
        hit, near, far = _sphere_roots(origin, directions, s[:3], s[3])
        t = np.where(near > 0, near, far)
        closer = hit & (t > 0) & (t < best)
        best, shape = np.where(closer, t, best), np.where(closer, j, shape)
    if a.floor[0] and own != -1:
        with np.errstate(divide="ignore", invalid="ignore"):
            t = -origin[2] / directions[:, 2]
        closer = (t > 0) & (t < best) & (directions[:, 2] != 0)
        best, shape = np.where(closer, t, best), np.where(closer, -2, shape)
    out = np.tile(a.shading[10:13], (m, 1))
    sh = a.shading
    for j in (-2, *range(len(a.spheres))):
        sel = shape == j
        if not sel.any():
            continue
        w = directions[sel]
        q = origin + best[sel, None] * w
        if j == -2:
            if origin[2] < 0:
                out[sel] = 0.0
                continue
            q[:, 2] = 0.0
            normal = np.tile([0.0, 0.0, 1.0], (len(q), 1))
            if a.floor[1] == 1:
                x, y = (q[:, 0] - a.floor[9]) / a.floor[8], (q[:, 1] - a.floor[10]) / a.floor[8]
                side = (np.sin(np.pi * x) * np.sin(np.pi * y) >= 0)[:, None]
            else:
                side = np.ones((len(q), 1), bool)
            albedo = np.where(side, a.floor[2:5], a.floor[5:8])
        else:
            s = a.spheres[j]
            normal = (q - s[:3]) / s[3]
            u = (np.arctan2(normal[:, 1], normal[:, 0]) + np.pi) / (2 * np.pi)
            v = np.arccos(np.clip(normal[:, 2], -1, 1)) / np.pi
            sign_u, sign_v = np.sin(np.pi * u * s[8]), np.sin(np.pi * v * s[9])
            factor = np.ones(len(q))
            if s[7] == 1:
                factor = np.where(sign_u * sign_v >= 0, 1.0, s[10])
            elif s[7] == 2:
                factor = np.where(sign_u >= 0, 1.0, s[10])
            elif s[7] == 3:
                vein = np.sin(2 * np.pi * (s[8] * u + 0.35 * np.sin(3 * np.pi * s[9] * v)))
                factor = 0.55 + 0.45 * (0.5 + 0.5 * vein)
            albedo = s[4:7] * factor[:, None]
        view = _unit(a.camera[1:4] - q) if sh[5] == 1 else -w
        color = np.tile(sh[0] * sh[7:10], (len(q), 1))
        for p in lights:
            offset = p.position - q
            l = _unit(offset)
            clear = np.ones(len(q), bool)
            if a.floor[0]:
                height = q[:, 2] if j >= 0 else np.full(len(q), np.sign(origin[2]) or 1.0)
                clear &= height * p.position[2] >= 0
            for k, s in enumerate(a.spheres):
                if k == j:
                    if ((p.position - s[:3]) ** 2).sum() < s[3] ** 2:
                        clear[:] = False
                    continue
                f = q - s[:3]
                t = np.clip(-(f * offset).sum(-1) / (offset * offset).sum(-1), 0, 1)
                clear &= ((f + t[:, None] * offset) ** 2).sum(-1) >= s[3] ** 2
            cosine = (normal * l).sum(-1)
            if sh[4] == 1:
                base = 2 * cosine * (normal * view).sum(-1) - (l * view).sum(-1)
            else:
                base = (normal * _unit(l + view)).sum(-1)
            gleam = np.maximum(base, 0.0) ** sh[3]
            if sh[6] == 0:
                gleam = np.where(cosine > 0, gleam, 0.0)
            diffuse = sh[1] * albedo * np.maximum(cosine, 0)[:, None]
            color += clear[:, None] * p.color * (diffuse + sh[2] * gleam[:, None])
        out[sel] = color
    return out


def exact_rows(a: SceneArrays):
    """Rows as ``light_rows`` with disks as Gauss rules of 4 areas times 8 azimuths."""
    nodes, weights = np.polynomial.legendre.leggauss(4)
    angle = 2 * np.pi * (np.arange(8) + 0.5) / 8
    found = []
    for light in a.lights:
        rows = light_rows(dataclasses.replace(a, lights=light[None]), 1)
        if light[0] == DISK:
            e1, e2 = disk_frame(light[1:4], light[8:11])
            rows = joined(LightPoint, [rows] * 32)
            around = np.outer(np.cos(angle), e1) + np.outer(np.sin(angle), e2)
            rows["position"][:] = light[1:4] + np.kron(light[4] * np.sqrt(0.5 + 0.5 * nodes)[:, None], around)
            rows["color"][:] = np.repeat(weights / 16, 8)[:, None] * light[5:8]
        found.append(rows)
    return joined(LightPoint, found)


def gloss(a: SceneArrays, origin, normal, incoming, own: int, n, theta_max, rings=600, sectors=1200, disk=2):
    """Midpoint rule on equal-weight rings; converges like 1/rings, so for three to five digits.

    Where the scene says so, int (n + 2)/(2 pi) cos^n (w.N) f dw: the lobe's integral of cos^n is 2 pi end/u.
    """
    lights = light_rows(a, disk) if disk else exact_rows(a)
    m = incoming - 2 * (incoming @ normal) * normal
    m /= np.linalg.norm(m)
    helper = np.array([1.0, 0, 0]) if abs(m[0]) < 0.6 else np.array([0, 1.0, 0])
    e1 = _unit(np.cross(m, helper))
    e2 = np.cross(m, e1)
    u = n + 1.0
    end = -np.expm1(u * np.log1p(-2 * np.sin(theta_max / 2) ** 2)) if theta_max < np.pi / 2 else 1.0
    t = (np.arange(rings) + 0.5) / rings * end
    versine = -np.expm1(np.log1p(-t) / u)
    cosine, sine = 1 - versine, np.sqrt(versine * (2 - versine))
    phi = 2 * np.pi * (np.arange(sectors) + 0.5) / sectors
    total = np.zeros(3)
    for c, s in zip(cosine, sine, strict=True):
        w = c * m + s * (np.cos(phi)[:, None] * e1 + np.sin(phi)[:, None] * e2)
        f = radiance(a, origin, _unit(w), own, lights)
        if a.shading[13] == 1:
            f = f * ((n + 2) / u * end * (w @ normal))[:, None]
        total += np.where((w @ normal > 0)[:, None], f, 0.0).sum(0)
    return total / (rings * sectors)
