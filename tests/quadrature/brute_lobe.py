"""The lobe integral by brute force: literal visibility and shading of midpoints, no walls, no charts, plain NumPy."""

from __future__ import annotations

import dataclasses

import numpy as np

from symrender.chambers.records import LightPoint
from symrender.jit.records import joined, table
from symrender.quadrature.light_points import disk_frame, light_rows
from symrender.scene.arrays import (
    BRDF_NORMALISED,
    CHECKER,
    CUT,
    DISK,
    EYE,
    MARBLE,
    PHONG,
    STRIPES,
    SceneArrays,
)
from symrender.scene.records import Light


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
        hit, near, far = _sphere_roots(origin, directions, s.center, s.radius)
        t = np.where(near > 0, near, far)
        closer = hit & (t > 0) & (t < best)
        best, shape = np.where(closer, t, best), np.where(closer, j, shape)
    if a.floor.present and own != -1:
        with np.errstate(divide="ignore", invalid="ignore"):
            t = -origin[2] / directions[:, 2]
        closer = (t > 0) & (t < best) & (directions[:, 2] != 0)
        best, shape = np.where(closer, t, best), np.where(closer, -2, shape)
    out = np.tile(a.shading.background, (m, 1))
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
            if a.floor.kind == CHECKER:
                x, y = ((q[:, :2] - a.floor.offset) / a.floor.cell).T
                side = (np.sin(np.pi * x) * np.sin(np.pi * y) >= 0)[:, None]
            else:
                side = np.ones((len(q), 1), bool)
            albedo = np.where(side, a.floor.bright, a.floor.dark)
        else:
            s = a.spheres[j]
            normal = (q - s.center) / s.radius
            u = (np.arctan2(normal[:, 1], normal[:, 0]) + np.pi) / (2 * np.pi)
            v = np.arccos(np.clip(normal[:, 2], -1, 1)) / np.pi
            sign_u, sign_v = np.sin(np.pi * u * s.ku), np.sin(np.pi * v * s.kv)
            factor = np.ones(len(q))
            if s.texture == CHECKER:
                factor = np.where(sign_u * sign_v >= 0, 1.0, s.dark)
            elif s.texture == STRIPES:
                factor = np.where(sign_u >= 0, 1.0, s.dark)
            elif s.texture == MARBLE:
                vein = np.sin(2 * np.pi * (s.ku * u + 0.35 * np.sin(3 * np.pi * s.kv * v)))
                factor = 0.55 + 0.45 * (0.5 + 0.5 * vein)
            albedo = s.color * factor[:, None]
        view = _unit(a.camera.eye - q) if sh.highlight_view == EYE else -w
        color = np.tile(sh.ka * sh.ambient, (len(q), 1))
        for p in lights:
            offset = p.position - q
            l = _unit(offset)
            clear = np.ones(len(q), bool)
            if a.floor.present:
                height = q[:, 2] if j >= 0 else np.full(len(q), np.sign(origin[2]) or 1.0)
                clear &= height * p.position[2] >= 0
            for k, s in enumerate(a.spheres):
                if k == j:
                    if ((p.position - s.center) ** 2).sum() < s.radius**2:
                        clear[:] = False
                    continue
                f = q - s.center
                t = np.clip(-(f * offset).sum(-1) / (offset * offset).sum(-1), 0, 1)
                clear &= ((f + t[:, None] * offset) ** 2).sum(-1) >= s.radius**2
            cosine = (normal * l).sum(-1)
            if sh.model == PHONG:
                base = 2 * cosine * (normal * view).sum(-1) - (l * view).sum(-1)
            else:
                base = (normal * _unit(l + view)).sum(-1)
            gleam = np.maximum(base, 0.0) ** sh.shininess
            if sh.terminator == CUT:
                gleam = np.where(cosine > 0, gleam, 0.0)
            diffuse = sh.kd * albedo * np.maximum(cosine, 0)[:, None]
            color += clear[:, None] * p.color * (diffuse + sh.ks * gleam[:, None])
        out[sel] = color
    return out


def exact_rows(a: SceneArrays):
    """Rows as ``light_rows`` with disks as Gauss rules of 4 areas times 8 azimuths."""
    nodes, weights = np.polynomial.legendre.leggauss(4)
    angle = 2 * np.pi * (np.arange(8) + 0.5) / 8
    found = []
    for light in a.lights:
        alone = table(Light, 1)
        alone[0] = light
        rows = light_rows(dataclasses.replace(a, lights=alone), 1)
        if light.kind == DISK:
            e1, e2 = disk_frame(light.position, light.target)
            rows = joined(LightPoint, [rows] * 32)
            around = np.outer(np.cos(angle), e1) + np.outer(np.sin(angle), e2)
            rows["position"][:] = light.position + np.kron(light.radius * np.sqrt(0.5 + 0.5 * nodes)[:, None], around)
            rows["color"][:] = np.repeat(weights / 16, 8)[:, None] * light.color
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
        if a.shading.units == BRDF_NORMALISED:
            f = f * ((n + 2) / u * end * (w @ normal))[:, None]
        total += np.where((w @ normal > 0)[:, None], f, 0.0).sum(0)
    return total / (rings * sectors)
