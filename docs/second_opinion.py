"""Recomputes the chapter's figures by code that shares nothing with the package, and names those that differ.

    python docs/second_opinion.py chapter8.html

A small renderer in NumPy after the source chapter's printed program, closed forms and brute force. It reads the numbers
of the scenes and the figures a page carries, with the sizes they were measured at. Exit code 1 where a figure differs.
"""

from __future__ import annotations

import argparse
import itertools
import json
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import yaml

Array = npt.NDArray[np.float64]
GALLERY = Path(__file__).resolve().parents[1] / "src" / "symrender" / "scene" / "gallery"
FED = {"partition": "weight", "nodes": "barycentre"}
UP = np.array([0.0, 0.0, 1.0])


def unit(v: Array) -> Array:
    """Vectors along the last axis, of length one."""
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


def rms(values: Array) -> float:
    """Root of the mean square."""
    return float(np.sqrt(np.mean(values**2)))


def batched(entries: Iterator[Any], count: int) -> Iterator[list[Any]]:
    """Lists of so many entries, the last perhaps shorter."""
    while batch := list(itertools.islice(entries, count)):
        yield batch


class World:
    """A scene in units of the series: spheres, a floor, lights; ``changes`` by dotted name."""

    def __init__(self, scene: str | dict[str, Any], **changes: Any) -> None:
        data = yaml.safe_load((GALLERY / f"{scene}.yaml").read_text("utf-8")) if isinstance(scene, str) else scene
        shading = {"ka": 0.1, "kd": 0.7, "ks": 0.5, "shininess": 32, "highlight_view": "ray"}
        self.shading = shading | {"specular_terminator": "cut"} | data["shading"] | changes.pop("shading", {})
        self.camera, self.floor = data["camera"], data["floor"]
        self.spheres, self.lights = data.get("spheres", []), data.get("lights", [])
        self.ambient = np.array(data.get("ambient", [0.0] * 3))
        self.background = np.array(data.get("background", [0.0] * 3), float)
        self.lobe = {"theta_max": np.pi / 3} | self.floor["lobe"] | changes.pop("lobe", {})
        self.sphere_lobes = changes.pop("sphere_lobes", True)
        self.points = [point for light in self.lights for point in _points(light)]

    def rays(self, width: int, height: int | None = None) -> tuple[Array, Array]:
        """Eye and unit rays (h, w, 3) through the pixels' middles."""
        height = height or width
        x = 2 * (np.arange(width) + 0.5) / width - 1
        y = 1 - 2 * (np.arange(height) + 0.5) / height
        eye = np.array(self.camera["eye"], float)
        if self.camera["type"] == "plane":
            half, middle = self.camera["window_half"], self.camera["window_center"]
            places = np.stack([*np.meshgrid(middle[0] + half * x, middle[1] + half * y), np.zeros((height, width))], -1)
            return eye, unit(places - eye)
        forward = unit(np.array(self.camera["target"]) - eye)
        right = unit(np.cross(forward, self.camera.get("up", [0, 0, 1])))
        tall = np.tan(np.radians(self.camera["fov"]) / 2)
        across = tall * width / height * x[None, :, None] * right + tall * y[:, None, None] * np.cross(right, forward)
        return eye, unit(forward + across)

    def seen(self, start: Array, rays: Array, leaves: int = 0, points: Any = None) -> tuple[Array, Array]:
        """Radiance and class of rays (N, 3): 0 nothing, 1 the floor, 2 and on the spheres."""
        start = np.broadcast_to(start, rays.shape)
        going = rays[:, 2] < 0
        down = np.where(going & (leaves != 1), -start[:, 2] / np.where(going, rays[:, 2], -1.0), np.inf)
        depth = [np.where(down > 0, down, np.inf)]
        depth += [_meets(start, rays, s) if leaves != k else np.full(len(rays), np.inf)
                  for k, s in enumerate(self.spheres, 2)]  # fmt: skip
        near = np.min(depth, axis=0)
        code = np.where(np.isfinite(near), np.argmin(depth, axis=0) + 1, 0)
        result = np.broadcast_to(self.background, rays.shape).copy()
        for k in range(1, len(depth) + 1):
            here = code == k
            if here.any():
                place = start[here] + near[here, None] * rays[here]
                result[here] = self.shaded(place, rays[here], k, points, here)
        return result, code

    def shaded(self, place: Array, rays: Array, k: int, points: Any, here: Any) -> Array:
        """Direct light of places on the shape of class ``k``, seen along ``rays``."""
        s = self.shading
        if k == 1:
            normal, texture = np.broadcast_to(UP, place.shape), self.floor["texture"]
            albedo = np.broadcast_to(texture.get("color", texture.get("bright")), place.shape)
            if texture["type"] == "checker":
                cell = texture["cell"]
                dark = np.sin(np.pi * place[:, 0] / cell) * np.sin(np.pi * place[:, 1] / cell) < 0
                albedo = np.where(dark[:, None], texture["dark"], texture["bright"])
        else:
            ball = self.spheres[k - 2]
            normal = (place - np.array(ball["center"])) / ball["radius"]
            albedo = np.broadcast_to(ball.get("color", [1.0, 1.0, 1.0]), place.shape)
            texture = ball.get("texture", {"type": "solid"})
            if texture["type"] == "checker":
                u = (np.arctan2(normal[:, 1], normal[:, 0]) + np.pi) / 2
                v = np.arccos(np.clip(normal[:, 2], -1, 1))
                dark = np.sin(u * texture["ku"]) * np.sin(v * texture["kv"]) < 0
                albedo = np.where(dark[:, None], texture["dark"], 1.0) * albedo
        view = -rays if s["highlight_view"] == "ray" else unit(np.array(self.camera["eye"]) - place)
        total = np.broadcast_to(s["ka"] * self.ambient, place.shape).copy()
        for light, color in self.points if points is None else points:
            way = (light[here] if light.ndim > 1 else light) - place
            reach = np.linalg.norm(way, axis=1)
            way = way / reach[:, None]
            hidden = np.zeros(len(place), bool)
            for j, other in enumerate(self.spheres, 2):
                if j != k:
                    hidden |= _meets(place, way, other) < reach
            mu = (normal * way).sum(axis=1)
            if s["specular_terminator"] == "cut":
                hidden |= mu <= 0
            gleam = np.maximum((normal * unit(way + view)).sum(axis=1), 0.0) ** s["shininess"]
            lit = s["kd"] * albedo * np.maximum(mu, 0.0)[:, None] + s["ks"] * gleam[:, None]
            total += np.where(hidden[:, None], 0.0, color * lit)
        return total

    def gloss(
        self, place: Array, normal: Array, rays: Array, leaves: int, lobe: Any, rule: Any, *, stopped: bool = True
    ) -> Array:
        """Lobe average at places (N, 3) by ``rule``: polar angle, azimuth, weight; ``stopped`` by the horizon."""
        m = rays - 2 * (rays * normal).sum(axis=1, keepdims=True) * normal
        aside = np.where(np.abs(m[:, 1:2]) < 0.9, [0.0, 1.0, 0.0], [1.0, 0.0, 0.0])
        u1 = unit(np.cross(m, aside))
        u2 = np.cross(m, u1)
        total, weights = np.zeros(place.shape), np.zeros((len(place), 1))
        at_once = max(1, 20_000 // len(place))
        for entries in batched(rule(lobe, len(place)), at_once):
            # (directions, places or 1, 1)
            theta, phi, weight = (np.array([np.atleast_2d(e[part]) for e in entries]) for part in range(3))
            ray = np.cos(theta) * m + np.sin(theta) * (np.cos(phi) * u1 + np.sin(phi) * u2)
            above = ((ray * normal).sum(axis=2) > 0) | (not stopped)
            light = np.zeros(ray.shape)
            light[above] = self.seen(np.broadcast_to(place, ray.shape)[above], ray[above], leaves)[0]
            total += (weight * light).sum(axis=0)
            weights += np.broadcast_to(weight, (len(entries), len(place), 1)).sum(axis=0)
        return total / weights

    def picture(self, rule: Any, width: int, height: int | None = None, only: Any = None, points: Any = None) -> Any:
        """Direct light, lobe term and class of every pixel, (h, w, ...), and the reflected light."""
        eye, rays = self.rays(width, height)
        flat = rays.reshape(-1, 3)
        direct, code = self.seen(eye, flat, points=points)
        gloss, reflected = np.zeros(flat.shape), np.zeros(flat.shape)
        for k in range(1, len(self.spheres) + 2):
            here = code == k
            lobe = self.lobe if k == 1 else {"theta_max": np.pi / 3} | self.spheres[k - 2].get("lobe", {"weight": 0})
            if rule is None or not here.any() or not lobe["weight"] or (only and k not in only):
                continue
            if k > 1 and not self.sphere_lobes:
                continue
            ray = flat[here]
            if k == 1:
                place, normal = eye - eye[2] / ray[:, 2:] * ray, np.broadcast_to(UP, ray.shape)
            else:
                ball = self.spheres[k - 2]
                place = eye + _meets(np.broadcast_to(eye, ray.shape), ray, ball)[:, None] * ray
                normal = (place - np.array(ball["center"])) / ball["radius"]
            gloss[here] = self.gloss(place, normal, ray, k, lobe, rule)
            reflected[here] = lobe["weight"] * gloss[here]
        shape = rays.shape
        return direct.reshape(shape), gloss.reshape(shape), code.reshape(shape[:2]), reflected.reshape(shape)


def _points(light: dict[str, Any]) -> Iterator[tuple[Array, Array]]:
    place, color = np.array(light["position"], float), np.array(light.get("color", [1, 1, 1]), float)
    if light["type"] == "point":
        yield place, color
        return
    e1, e2 = disk_axes(light)
    for u in (0.25, 0.75):
        for v in (0.25, 0.75):
            around = np.cos(2 * np.pi * v) * e1 + np.sin(2 * np.pi * v) * e2
            yield place + light["radius"] * np.sqrt(u) * around, color / 4


def disk_axes(light: dict[str, Any]) -> tuple[Array, Array]:
    """Two unit vectors across the axis of a disk light."""
    w = unit(np.subtract(light["target"], light["position"]).astype(float))
    e1 = unit(np.cross(w, [0.0, 1.0, 0.0] if abs(w[1]) < 0.9 else [1.0, 0.0, 0.0]))
    return e1, np.cross(w, e1)


def _meets(start: Array, rays: Array, ball: dict[str, Any]) -> Array:
    """Nearest distance along unit rays to a sphere; infinity where it is missed."""
    apart = start - np.array(ball["center"])
    middle = -(apart * rays).sum(axis=1)
    inside = ball["radius"] ** 2 - ((apart + middle[:, None] * rays) ** 2).sum(axis=1)
    half = np.sqrt(np.maximum(inside, 0.0))
    near = np.where(middle - half > 0, middle - half, middle + half)
    return np.where((inside >= 0) & (near > 0), near, np.inf)


def mass(a: Any, b: Any, power: float) -> Any:
    """Integral of cos^power sin from a to b."""
    u = power + 1
    return -np.exp(u * _log_cos(a)) * np.expm1(u * (_log_cos(b) - _log_cos(a))) / u


def _log_cos(t: Any) -> Any:
    return np.log1p(-2 * np.sin(np.asarray(t) / 2) ** 2)


def strata(
    k: int, partition: str = "angle", nodes: str = "midpoint", weights: str = "exact", true: bool = False
) -> Any:
    """A rule of k rings by k sectors; ``true`` divides by the normaliser, not by the sum of the weights."""

    def rule(lobe: Any, count: int) -> Iterator[tuple[float, float, float]]:
        n, rim = lobe["exponent"], lobe["theta_max"]
        edges = np.linspace(0, rim, k + 1)
        if partition == "weight":
            share = np.arange(k) / k
            depth = -np.expm1(np.log1p(share * np.expm1((n + 1) * _log_cos(rim))) / (n + 1))
            edges = np.array([*2 * np.arcsin(np.sqrt(depth / 2)), rim])
        middle = (edges[1:] + edges[:-1]) / 2
        exact = mass(edges[:-1], edges[1:], n)
        ring = exact if weights == "exact" else np.exp(n * _log_cos(middle)) * np.sin(middle) * np.diff(edges)
        at = middle
        if nodes == "barycentre":
            at = np.arccos(np.clip(mass(edges[:-1], edges[1:], n + 1) / exact, -1, 1))
            if n > 1e5:
                # cosines so near one keep no digits: small angles, u t^2/2 uniform between the edges
                low, high = (np.exp(-(n + 1) * e**2 / 2) for e in (edges[:-1], edges[1:]))
                x = [(n + 1) * e**2 / 2 for e in (edges[:-1], edges[1:])]
                at = np.sqrt(2 / (n + 1) * (low * (1 + x[0]) - high * (1 + x[1])) / (low - high))
        for theta, weight in zip(at, ring / exact.sum(), strict=True):
            for j in range(k):
                yield theta, 2 * np.pi * (j + 0.5) / k, weight / k
        if true:
            # what the weights lack of one is counted as black, which divides by the normaliser
            yield np.pi, 0.0, 1 - float((ring / exact.sum()).sum())

    return rule


def sampled(k: int, seed: int, importance: bool = False) -> Any:
    """k by k random directions a place, stratified: even in solid angle with weights, or of the lobe's density."""

    def rule(lobe: Any, count: int) -> Iterator[tuple[Array, Array, Any]]:
        rng = np.random.default_rng([seed, count])
        n, rim = lobe["exponent"], lobe["theta_max"]
        for i in range(k):
            for j in range(k):
                a, b = (i + rng.random((count, 1))) / k, (j + rng.random((count, 1))) / k
                if importance:
                    depth = -np.expm1(np.log1p(a * np.expm1((n + 1) * _log_cos(rim))) / (n + 1))
                    yield 2 * np.arcsin(np.sqrt(depth / 2)), 2 * np.pi * b, 1.0
                else:
                    depth = a * 2 * np.sin(rim / 2) ** 2
                    yield 2 * np.arcsin(np.sqrt(depth / 2)), 2 * np.pi * b, np.exp(n * np.log1p(-depth))

    return rule


def lattice(count: int) -> Any:
    """Evenly spread directions of the lobe's density, the same in every place: brute force."""

    def rule(lobe: Any, places: int) -> Iterator[tuple[float, float, float]]:
        n, rim = lobe["exponent"], lobe["theta_max"]
        golden = 1.32471795724474602596
        a, b = ((np.arange(count) + 0.5)[:, None] / [golden, golden**2] % 1).T
        depth = -np.expm1(np.log1p(a * np.expm1((n + 1) * _log_cos(rim))) / (n + 1))
        for theta, phi in zip(2 * np.arcsin(np.sqrt(depth / 2)), 2 * np.pi * b, strict=True):
            yield theta, phi, 1.0

    return rule


class Figures:
    """The figures of a page by name: [value, source]."""

    def __init__(self, held: dict[str, Any]) -> None:
        self.held = held

    def value(self, name: str) -> Any:
        """A figure's value."""
        return self.held[name][0]

    def size(self, name: str) -> tuple[int, int]:
        """Width and height that a figure's source names first."""
        found = re.search(r"(\d+) x (\d+)", self.held[name][1])
        assert found is not None, f"{name} names no size"
        return int(found[1]), int(found[2])


Recomputed = Iterator[tuple[str, float, float]]
"""Name, value, and how far the page's figure may be from it, as a share of it."""
EXACT, FINE, ROUGH, NOISE = 1e-9, 2e-3, 0.03, 0.2
"""Closed forms and equal rules; brute force; sums of errors; random numbers of other seeds."""


def arithmetic(page: Figures) -> Recomputed:
    """Constants of the scenes and what follows from them."""
    chapter, gloss = (yaml.safe_load((GALLERY / f"{name}.yaml").read_text("utf-8")) for name in ("chapter8", "gloss"))
    half, eye = chapter["camera"]["window_half"], chapter["camera"]["eye"][2]
    corner = np.arctan(np.hypot(half, 1.15 * half) / eye)
    side = page.value("anchor.side")
    yield "claims.sweep", np.hypot(0.35, 0.62 * half), EXACT
    yield "claims.grazing", np.hypot(0.9, 0.35), EXACT
    yield "claims.visible", eye / np.sqrt(eye**2 - 1), EXACT
    yield "claims.reach", corner + np.pi / 3, EXACT
    yield "claims.ruler", 1 / np.sqrt(32), EXACT
    yield "claims.sigma", 1 / np.sqrt(16), EXACT
    yield "claims.cone", np.radians(0.5), EXACT
    yield "claims.multiplied", 1.0, 1e-4
    yield "claims.divided", (2 * np.pi / 18) ** 2, 1e-4
    yield "anchor.pixel", np.radians(gloss["camera"]["fov"]) / side, EXACT
    yield "anchor.wide", 1 / np.sqrt(page.value("anchor.wall_from")), EXACT
    yield "anchor.narrow", 1 / np.sqrt(page.value("anchor.wall_to")), EXACT
    yield "scenes.chapter8.kiss", chapter["spheres"][0]["lobe"]["weight"], EXACT
    yield "scenes.chapter8.weight", chapter["floor"]["lobe"]["weight"], EXACT
    yield "scenes.gloss.exponent", gloss["floor"]["lobe"]["exponent"], EXACT
    yield "scenes.gloss.theta_max", gloss["floor"]["lobe"]["theta_max"], EXACT
    yield "timing.work", 16.0, EXACT
    yield "widths.factor", 2.0, EXACT
    for name in ("claims.counted", "claims.b_printed"):
        yield name, 64**2, EXACT
    x, w = np.polynomial.legendre.leggauss(400)
    theta, w = np.pi / 6 * (x + 1), np.pi / 6 * w
    weight = w * np.cos(theta) ** 16 * np.sin(theta)
    rms_angle = np.sqrt((weight * theta**2).sum() / weight.sum())
    yield "claims.rms", rms_angle, EXACT
    yield "widths.rms", rms_angle, EXACT
    yield "claims.axis", np.sqrt((weight * np.sin(theta) ** 2).sum() / weight.sum() / 2), EXACT
    for word, k in (("two", 2), ("four", 4), ("eight", 8)):
        middle = (np.arange(k) + 0.5) / k * np.pi / 3
        total = (np.cos(middle) ** 16 * np.sin(middle)).sum() * np.pi / 3 / k
        yield f"sums.midpoint_{word}", total / mass(0.0, np.pi / 3, 16) - 1, EXACT
    # albedo of the lobe of 64 with the cosine inside: brute force over the hemisphere about the mirror direction
    height, w = (x + 1) / 2, np.polynomial.legendre.leggauss(400)[1] / 2
    phi = 2 * np.pi * (np.arange(2000) + 0.5) / 2000
    for degrees in (0, 30, 60, 80):
        t = np.radians(degrees)
        up = height[:, None] * np.cos(t) + np.sqrt(1 - height**2)[:, None] * np.sin(t) * np.cos(phi)
        yield f"units.at_{degrees}", 66 * (w * height**64 * np.maximum(up, 0).mean(axis=1)).sum(), 1e-3


def thin_rings(page: Figures) -> Recomputed:
    """What subtraction loses of thin rings: the same random rings, judged by Gauss quadrature."""
    rng = np.random.default_rng(8)
    x, w = np.polynomial.legendre.leggauss(24)
    lost, worst, worst_plain, count = 0, 0.0, 0.0, page.value("weights.cases")
    for _ in range(count):
        u = 1 + 10 ** rng.uniform(0, 6)
        a = rng.uniform(0, 1.4) * min(1, 6 / np.sqrt(u))
        b = a + 10 ** rng.uniform(-12, -1) * min(1, 1 / np.sqrt(u))
        at = a + (b - a) * (x + 1) / 2
        true = (w * np.exp((u - 1) * _log_cos(at)) * np.sin(at)).sum() * (b - a) / 2
        plain = (np.cos(a) ** u - np.cos(b) ** u) / u
        lost += plain <= 0
        worst_plain = max(worst_plain, abs(plain / true - 1))
        worst = max(worst, abs(mass(a, b, u - 1) / true - 1))
    yield "weights.lost", lost / count, EXACT
    yield "weights.worst_plain", worst_plain, ROUGH


def classes(page: Figures) -> Recomputed:
    """Pixels by what they show, in the scene of the source."""
    code = World("chapter8").picture(None, 64)[2]
    for k, name in ((1, "floor"), (2, "a"), (3, "b")):
        yield f"claims.{name}_true", int((code == k).sum()), EXACT
    wide = World("chapter8", lobe={"exponent": 1.0, "theta_max": 1e-12}, sphere_lobes=False)
    _, mirror, code, _ = wide.picture(strata(1), 128)
    yield "claims.mirrored", float(mirror.max()), EXACT
    yield "claims.mirrored_pixels", int((code == 1).sum()), EXACT
    width, _ = page.size("claims.kiss")
    code, reflected = World("chapter8").picture(strata(8, **FED), width)[2:]
    yield "claims.kissed", int((code > 1).sum()), EXACT
    yield "claims.kiss", rms(reflected[code > 1]), 1e-6


def smudge(page: Figures) -> Recomputed:
    """The floor's gloss in the scene of the source, and the errors of both kinds of weights in it."""
    width, _ = page.size("claims.exact_two")
    world = World("chapter8", sphere_lobes=False)
    yield "claims.brightest", float(world.picture(strata(48), 2 * width)[1].max()), 1e-6
    truth = world.picture(strata(96, **FED), width)[3]
    for word, k in (("two", 2), ("four", 4), ("eight", 8)):
        for kind in ("exact", "midpoint"):
            yield f"claims.{kind}_{word}", rms(world.picture(strata(k, weights=kind), width)[3] - truth), 1e-5
    gloss = {}
    for view in ("eye", "ray"):
        for end in ("open", "cut"):
            shading = {"highlight_view": view, "specular_terminator": end}
            made = World("chapter8", sphere_lobes=False, shading=shading).picture(strata(32, **FED), width)
            gloss[view, end] = rms(made[1][made[2] == 1])
    yield "claims.toward_camera", gloss["ray", "open"] / gloss["eye", "open"] - 1, 1e-5
    yield "claims.beyond_terminator", gloss["ray", "open"] / gloss["ray", "cut"] - 1, 1e-3


def noise(page: Figures) -> Recomputed:
    """Speckle, by random numbers of our own."""
    width, _ = page.size("claims.jittered_wide")
    for word, exponent in (("wide", 1.0), ("needle", 4096.0)):
        world = World("gloss", lobe={"exponent": exponent})
        for kind in ("jittered", "importance"):
            pair = [world.picture(sampled(4, seed, kind == "importance"), width, only=(1,)) for seed in (1, 2)]
            floor = pair[0][2] == 1
            yield f"claims.{kind}_{word}", rms((pair[0][1] - pair[1][1])[floor]) / np.sqrt(2), NOISE
    for name, exponent, rim in (
        ("start", 256.0, np.pi / 3), ("end", 4096.0, np.pi / 3), ("narrow", 4096.0, np.radians(0.5))
    ):  # fmt: skip
        world = World("gloss", lobe={"exponent": exponent, "theta_max": rim})
        apart = world.picture(sampled(4, 3), width)[3] - world.picture(strata(4), width)[3]
        yield f"claims.slider_{name}", rms(apart), NOISE
    for word, k in (("two", 2), ("four", 4), ("eight", 8)):
        rng, rim, trials = np.random.default_rng(3), 0.5, 400_000 // (k * k)
        known = 1 - 17 / 18 * (1 - rim**18) / (1 - rim**17)
        depth = (np.arange(k)[None, :, None] + rng.random((trials, k, k))) / k * (1 - rim)
        weight = (1 - depth) ** 16
        ratio = (weight * depth).sum(axis=(1, 2)) / weight.sum(axis=(1, 2))
        yield f"pitfalls.ratio_{word}", float(ratio.mean() / known - 1), NOISE


def pictures(page: Figures) -> Recomputed:
    """Shares and signals of the two scenes, and the pair of pipelines."""
    width, height = page.size("scenes.gloss.share")
    _, _, code, reflected = World("gloss", sphere_lobes=False).picture(strata(16, **FED), width, height)
    yield "scenes.gloss.pixels", code.size, EXACT
    yield "scenes.gloss.share", float((reflected.max(axis=2) >= 0.05).mean()), 1e-9
    yield "scenes.gloss.signal", rms(reflected[code == 1]), 1e-6
    width, height = page.size("pair.gloss")
    world = World("gloss")
    made, drawn = world.picture(strata(4, **FED), width, height), world.picture(sampled(4, 5, True), width, height)
    yield "pair.pixels", width * height, EXACT
    yield "pair.gloss_signal", rms(made[1]), 1e-2
    yield "pair.gloss", rms(drawn[1] - made[1]) / rms(made[1]), NOISE


def one_lobe(page: Figures) -> Recomputed:
    """One lobe by a great many directions, and by strata."""
    world = World("gloss")
    place = np.array([[page.value("lobe.x"), page.value("lobe.y"), 0.0]])
    ray = unit(place - np.array(world.camera["eye"]))
    light = light_of_a_lobe(world, page.value("lobe.x"), page.value("lobe.y"), 2**19)
    yield "lobe.gloss", float(light[0]), FINE
    yield "lobe.disc", float(light[0]), 0.01
    yield "split.signal", float(light.max()), FINE
    normal = np.broadcast_to(UP, ray.shape)
    # the printed error is largest over the channels, relative to the brightest
    fed = world.gloss(
        place, normal, ray, 1, world.lobe, strata(int(page.value("split.equal_weight.cost") ** 0.5), **FED)
    )
    if page.value("split.equal_weight.best") > 1e-3:
        yield "split.equal_weight.best", float(np.abs(fed - light).max() / light.max()), NOISE


def light_of_a_lobe(world: World, x: float, y: float, count: int) -> Array:
    """Lobe average at a floor point by brute force: evenly spread directions of the lobe's density."""
    place = np.array([[x, y, 0.0]])
    ray = unit(place - np.array(world.camera["eye"]))
    golden, n, rim = 1.32471795724474602596, world.lobe["exponent"], world.lobe["theta_max"]
    a, b = ((np.arange(count) + 0.5)[:, None] / [golden, golden**2] % 1).T
    depth = -np.expm1(np.log1p(a * np.expm1((n + 1) * _log_cos(rim))) / (n + 1))
    m = ray[0] * [1, 1, -1]
    u1 = unit(np.cross(m, [1.0, 0.0, 0.0] if abs(m[1]) >= 0.9 else [0.0, 1.0, 0.0]))
    across = np.cos(2 * np.pi * b)[:, None] * u1 + np.sin(2 * np.pi * b)[:, None] * np.cross(m, u1)
    rays = (1 - depth)[:, None] * m + np.sqrt(depth * (2 - depth))[:, None] * across
    found: Array = np.where(rays[:, 2:] > 0, world.seen(place, rays, 1)[0], 0).mean(axis=0)
    return found


def slope(page: Figures) -> Recomputed:
    """The derivative at one floor point as a wide difference of brute force."""
    sides, step = [], 0.02
    for move in (step, -step):
        world = World("gloss")
        ball = next(ball for ball in world.spheres if ball["name"] == "B")
        ball["center"] = [ball["center"][0] + move, *ball["center"][1:]]
        sides.append(light_of_a_lobe(world, 0.45, -1.1, 2**20)[0])
    yield "slopes.value", (sides[0] - sides[1]) / (2 * step), 0.05


def disk_jitter(page: Figures) -> Recomputed:
    """What random points of the disk light do to the source's picture: RMS over seeds of our own."""
    width, _ = page.size("claims.least_apart")
    world = World("chapter8", sphere_lobes=False)
    key, fill = world.lights
    e1, e2 = disk_axes(key)
    strata_light, code = world.picture(None, width)[0], World("chapter8").picture(None, width)[2]
    apart = []
    for seed in range(int(page.value("claims.seeds"))):
        rng, points = np.random.default_rng(seed), []
        for i in range(2):
            for j in range(2):
                r = key["radius"] * np.sqrt((i + rng.random(code.size)) / 2)
                turn = 2 * np.pi * (j + rng.random(code.size)) / 2
                around = np.cos(turn)[:, None] * e1 + np.sin(turn)[:, None] * e2
                points.append((np.array(key["position"]) + r[:, None] * around, np.array(key["color"]) / 4))
        points.append((np.array(fill["position"], float), np.array(fill["color"])))
        apart.append(rms(world.picture(None, width, points=points)[0] - strata_light))
    yield "claims.least_apart", min(apart), 0.35
    yield "claims.most_apart", max(apart), 0.35


def one_ray(page: Figures) -> Recomputed:
    """One direction of gloss, in double precision: the first digits of the printed ones."""
    ray = unit(np.array([[-0.05, 0.6, 0.5]]))
    light = World("gloss").seen(np.array([[-0.5, -1.5, 0.0]]), ray, 1)[0][0]
    yield "digits.green", float(light[1]), 1e-13


def buried(page: Figures) -> Recomputed:
    """Share of the light that lobes in the source's scene have from below the floor, were nothing there to stop it."""
    world, normal = World("chapter8"), np.broadcast_to(UP, (3, 3))
    for height in (30, 20, 10):
        turn, rise = np.radians([0.0, 45.0, 90.0]), np.radians(height)
        out = np.stack([np.cos(turn), np.sin(turn), np.zeros(3)], axis=1)
        place, rays = 1.3 * out, -np.cos(rise) * out - np.sin(rise) * UP
        kept = world.gloss(place, normal, rays, 1, world.lobe, strata(64)).sum()
        # the light of directions below: of all, none stopped, less that of those above
        below = world.gloss(place, normal, rays, 1, world.lobe, strata(64), stopped=False).sum() - kept
        yield f"claims.buried_{height}", below / (kept + below), 1e-4


def at_an_edge(page: Figures) -> Recomputed:
    """Half of a jump: the share of the lobe in a disk whose rim goes through its middle, one integral."""
    alpha, rim = np.arcsin(0.5 / np.hypot(2.0, 0.5)), np.pi / 3
    x, w = np.polynomial.legendre.leggauss(600)
    for word, n in (("edge", page.value("claims.edge_n")), ("edge_late", page.value("claims.edge_late_n"))):
        top = min(2 * alpha, rim, 12 / np.sqrt(n))
        theta, step = top / 2 * (x + 1), top / 2 * w
        # at theta the circle lies inside the disk over 2 acos(tan(theta/2)/tan(alpha))
        arc = 2 * np.arccos(np.clip(np.tan(theta / 2) / np.tan(alpha), -1, 1))
        inside = (arc * np.exp(n * _log_cos(theta)) * np.sin(theta) * step).sum()
        yield f"claims.{word}", float(inside / (2 * np.pi * mass(0.0, rim, n))), 1e-4


def convergence(page: Figures) -> Recomputed:
    """Strata on the floor of gloss against brute force: errors, their ratios and their order."""
    width, height = page.size("convergence.signal")
    world = World("gloss", sphere_lobes=False)
    truth, code = world.picture(lattice(2**13), width, height)[1:3]
    floor = code == 1
    signal = rms(truth[floor])
    yield "convergence.pixels", int(floor.sum()), EXACT
    yield "convergence.signal", signal, FINE

    def error(rule: Any) -> float:
        return rms((world.picture(rule, width, height)[1] - truth)[floor]) / signal

    for rule in ("exact", "barycentre"):
        options = {"exact": {}, "barycentre": {"nodes": "barycentre"}}[rule]
        ratios = [error(strata(k, **options)) / error(strata(k, weights="midpoint")) for k in (2, 4, 8, 16)]
        kept = ratios if page.value("weight_choice.crossed_barycentre_least") < 0.7 else ratios[1:]
        yield f"weight_choice.crossed_{rule}_least", min(kept), 0.1
        yield f"weight_choice.crossed_{rule}_most", max(kept), 0.1
    k = page.value("weight_choice.k")
    yield "weight_choice.crossed_exact", error(strata(k)), ROUGH
    yield "weight_choice.crossed_midpoint", error(strata(k, weights="midpoint")), ROUGH
    yield "weight_choice.crossed_barycentre", error(strata(k, nodes="barycentre")), ROUGH
    ks = (4, 8, 16)
    for name, options in (("strata_angle", {}), ("strata_weight_barycentre", FED)):
        errors = [error(strata(k, **options)) for k in ks]
        yield f"convergence.{name}.order", -np.polyfit(2 * np.log(ks), np.log(errors), 1)[0], 0.3


def smooth(page: Figures) -> Recomputed:
    """Weights where no wall is: the scene of one great sphere, integrated by Gauss rules."""
    width, height = page.size("weight_choice.smooth_exact")
    scene = {
        "camera": {"type": "look_at", "eye": [0, -3, 1], "target": [0, -0.5, 0], "fov": 8},
        "spheres": [{"center": [0, 31, 0], "radius": 30, "color": [0.8, 0.5, 0.3]}],
        "floor": {
            "texture": {"type": "solid", "color": [0.1] * 3}, "lobe": {"weight": 1, "exponent": 256, "theta_max": 0.28}
        },
        "lights": [{"type": "point", "position": [2, -4, 2], "color": [1, 0.9, 0.8]}],
        "shading": {"ka": 0, "kd": 1, "ks": 0},
    }  # fmt: skip
    world = World(scene)

    def gauss(lobe: Any, count: int) -> Iterator[tuple[float, float, float]]:
        x, w = np.polynomial.legendre.leggauss(48)
        theta = lobe["theta_max"] * (x + 1) / 2
        weight = w * np.exp(lobe["exponent"] * _log_cos(theta)) * np.sin(theta)
        for at, one in zip(theta, weight / weight.sum(), strict=True):
            for j in range(48):
                yield at, 2 * np.pi * (j + 0.5) / 48, one / 48

    truth, code = world.picture(gauss, width, height)[1:3]
    floor = code == 1
    found: dict[str, list[float]] = {"exact": [], "own_sum": [], "barycentre": []}
    for k in (4, 8, 16):
        for name, options in (
            ("exact", {}),
            ("own_sum", {"weights": "midpoint"}),
            ("barycentre", {"nodes": "barycentre"}),
        ):
            off = (world.picture(strata(k, **options), width, height)[1] - truth)[floor]
            found[name].append(rms(off) / rms(truth[floor]))
    for name, errors in found.items():
        yield f"weight_choice.smooth_{name}", errors[1], 0.01
    for name in ("exact", "barycentre"):
        ratios = [a / b for a, b in zip(found[name], found["own_sum"], strict=True)]
        yield f"weight_choice.smooth_{name}_least", min(ratios), 0.02
    middle = world.picture(strata(8, weights="midpoint", true=False), width, height)[1]
    factor = 1 + sum_error(8, 256.0, 0.28)
    yield "weight_choice.smooth_midpoint", rms((factor * middle - truth)[floor]) / rms(truth[floor]), 0.01


def sum_error(k: int, n: float, rim: float) -> float:
    """What the sum of midpoint weights of k rings misses of the normaliser."""
    at = (np.arange(k) + 0.5) / k * rim
    return float((np.exp(n * _log_cos(at)) * np.sin(at)).sum() * rim / k / mass(0.0, rim, n) - 1)


def anchor(page: Figures) -> Recomputed:
    """Distance to the mirror image over the pixels whose mirror ray sees light, by strata."""
    side = page.value("anchor.side")
    mirror = World("gloss", lobe={"exponent": 1.0, "theta_max": 1e-13}, sphere_lobes=False).picture(strata(1), side)
    lit = (mirror[2] == 1) & (mirror[1].max(axis=2) > 0.05)
    yield "anchor.pixels", int(lit.sum()), EXACT
    gaps = {}
    for n in (1e4, 1e5, 1e6, 1e7, 1e8, 1e9):
        made = World("gloss", lobe={"exponent": n}, sphere_lobes=False).picture(strata(16, **FED), side, only=(1,))[1]
        gaps[n] = np.abs(made - mirror[1])[lit].max(axis=1)
    beside = [n for n in gaps if page.value("anchor.wall_from") <= n <= page.value("anchor.wall_to")]
    fall = np.polyfit(np.log(beside), [np.log(rms(gaps[n])) for n in beside], 1)[0]
    yield "anchor.symbolic.wall_slope", fall, 0.02
    far = [n for n in gaps if n >= page.value("anchor.from")]
    yield "anchor.symbolic.slope", np.polyfit(np.log(far), [np.log(np.median(gaps[n])) for n in far], 1)[0], 0.05


def grazing(page: Figures) -> Recomputed:
    """Lobes that reach below the horizon: what skipping those directions gains."""
    width, height = page.size("pitfalls.pixels")
    world = World("grazing", sphere_lobes=False)
    _, gloss, code, _ = world.picture(strata(32, **FED), width, height)
    floor = code == 1
    ray = world.rays(width, height)[1][floor]
    m, below, total = ray * [1, 1, -1], np.zeros(len(ray)), 0.0
    u1 = unit(np.cross(m, np.where(np.abs(m[:, 1:2]) < 0.9, [0.0, 1.0, 0.0], [1.0, 0.0, 0.0])))
    for theta, phi, weight in strata(64, **FED)(world.lobe, 0):
        height_of = np.cos(theta) * m[:, 2] + np.sin(theta) * (
            np.cos(phi) * u1[:, 2] + np.sin(phi) * np.cross(m, u1)[:, 2]
        )
        below, total = below + weight * (height_of <= 0), total + weight
    skipped = gloss[floor] / (1 - below / total)[:, None]
    yield "pitfalls.pixels", int(floor.sum()), EXACT
    yield "pitfalls.skipped", skipped.mean() / gloss[floor].mean() - 1, ROUGH
    truth = world.picture(lattice(2**12), width, height)[1][floor]
    yield "pitfalls.skipped_error", rms(skipped - truth) / rms(truth), ROUGH
    eye = world.rays(width, height)[0]
    place, normal = eye - eye[2] / ray[:, 2:] * ray, np.broadcast_to(UP, ray.shape)
    all_through = world.gloss(place, normal, ray, 1, world.lobe, strata(32, **FED), stopped=False)
    yield "pitfalls.buried", all_through.mean() / gloss[floor].mean() - 1, 0.05
    thin = World("grazing", lobe={"exponent": page.value("pitfalls.needle")}, sphere_lobes=False)
    true = thin.picture(lattice(2**11), width, height)[1][floor]
    for name, rule in (("starved", strata(8)), ("fed", strata(8, partition="weight"))):
        yield f"pitfalls.{name}", rms(thin.picture(rule, width, height)[1][floor] - true) / rms(true), 0.1
    runs = [world.picture(sampled(2, seed), width, height)[1][floor].mean() for seed in range(32)]
    yield "pitfalls.scene_ratio", np.mean(runs) / truth.mean() - 1, NOISE
    needle = mass(np.linspace(0, np.pi / 2, 9)[:-1], np.linspace(0, np.pi / 2, 9)[1:], page.value("pitfalls.needle"))
    yield "pitfalls.effective", 8 * needle.sum() ** 2 / (needle**2).sum(), 1e-6
    yield "pitfalls.directions", 64, EXACT


SUBJECTS = (
    arithmetic, thin_rings, classes, smudge, disk_jitter, buried, noise, pictures, one_ray, one_lobe, slope, at_an_edge,
    convergence, smooth, anchor, grazing,
)  # fmt: skip


def compared(held: dict[str, Any]) -> tuple[list[str], list[str]]:
    """Names of the figures recomputed, and a line for each that differs."""
    page, names, differ = Figures(held), [], []
    for subject in SUBJECTS:
        for name, ours, share in subject(page):
            names.append(name)
            theirs = float(page.value(name))
            if not abs(theirs - ours) <= share * abs(ours) + 1e-15:
                differ.append(f"{name}: the page has {theirs!r}, recomputed {float(ours)!r}, allowed {share:g} of it")
    return names, differ


def main() -> int:
    """Recompute the figures of a page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("page", type=Path)
    text = parser.parse_args().page.read_text(encoding="utf-8")
    found = re.search(r'id="figures">(.*?)</script>', text)
    if found is None:
        print("the page holds no figures", file=sys.stderr)
        return 1
    names, differ = compared(json.loads(found[1]))
    print("\n".join([*differ, f"{len(names)} figures recomputed, {len(differ)} differ"]))
    return 1 if differ else 0


if __name__ == "__main__":
    sys.exit(main())
