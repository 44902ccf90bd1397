"""A judge of filtered pixels: one shape under one light in closed form, integrated by adaptive Gauss-Legendre rules.

It shares nothing with the package but the conventions of ``docs/radiometric.md``. What an image shows of one shape is a
convex region of the image plane, bounded by lines (the horizon, edges) and at most one conic (a silhouette, a rim). A
pixel's square within it is cut where its bounding pieces change, along lines, into panels on which both ends of a
scanline are smooth; a panel is the unit square, with nodes that crowd to its sides, so that roots at a silhouette are
resolved. Squares are quartered while light or the half vector turns by more than the lobe is wide, and then
while rules of 7 x 7 and 10 x 10 nodes differ by more than is asked. What they differ by, summed, is the judge's doubt.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.special import erf

Array = npt.NDArray[np.float64]
LOW, HIGH = 7, 10
"""Nodes of both rules of a square, along a side."""
TURN = 0.7
DEEPEST, MOST = 40, 15_000
"""Times that a square may be quartered, and squares that one call may hold."""
BATCH = 1500


def unit(v: Any) -> Array:
    v = np.asarray(v, float)
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


def dot(a: Array, b: Array) -> Array:
    with np.errstate(over="ignore", invalid="ignore"):
        return (a * b).sum(axis=-1)


@dataclass(frozen=True)
class View:
    """Camera: what lies at (x, y), in pixels from the upper left corner, is seen along forward + ... ."""

    eye: Array
    forward: Array
    right: Array
    up: Array
    width: int
    height: int

    def rays(self, x: Array, y: Array) -> Array:
        """Directions through places of the image, not of unit length."""
        return (
            self.forward
            + (2.0 * x / self.width - 1.0)[..., None] * self.right
            + (1.0 - 2.0 * y / self.height)[..., None] * self.up
        )

    def matrix(self) -> Array:
        """B with direction = B (x, y, 1)."""
        across, down = 2.0 * self.right / self.width, -2.0 * self.up / self.height
        return np.stack([across, down, self.forward - self.right + self.up], axis=1)


def view_of(scene: dict[str, Any], width: int, height: int) -> View:
    """The camera of a scene."""
    camera = scene["camera"]
    eye = np.array(camera["eye"], float)
    forward = unit(np.array(camera["target"], float) - eye)
    right = unit(np.cross(forward, camera.get("up", [0, 0, 1])))
    half = np.tan(np.radians(camera["fov"]) / 2.0)
    return View(eye, forward, half * width / height * right, half * np.cross(right, forward), width, height)


def flat_of(shape: dict[str, Any]) -> tuple[Array, Array]:
    """(a point, the unit normal) of a flat shape."""
    kind = shape["type"]
    if kind in ("plane", "disk"):
        return np.array(shape["point" if kind == "plane" else "center"], float), unit(shape["normal"])
    if kind == "rectangle":
        return np.array(shape["corner"], float), unit(np.cross(shape["edge_u"], shape["edge_v"]))
    a, b, c = np.array(shape["vertices"], float)
    return a, unit(np.cross(b - a, c - a))


def corners_of(shape: dict[str, Any]) -> Array:
    """Corners of a rectangle or a triangle, about its normal."""
    if shape["type"] == "triangle":
        return np.array(shape["vertices"], float)
    at, u, v = (np.array(shape[name], float) for name in ("corner", "edge_u", "edge_v"))
    return np.array([at, at + u, at + u + v, at + v])


@dataclass(frozen=True)
class Region:
    """Where an image shows the shape: lines l . (x, y, 1) >= 0 and a conic (x, y, 1) Q (x, y, 1) >= 0 ahead of it."""

    lines: Array
    conic: Array | None
    ahead: Array


def region_of(shape: dict[str, Any], view: View) -> Region:
    """The part of the image plane in which the shape is met."""
    basis = view.matrix()
    if shape["type"] == "sphere":
        c, radius = np.array(shape["center"], float) - view.eye, float(shape["radius"])
        far = np.linalg.norm(c)
        form = np.outer(c, c) - (far - radius) * (far + radius) * np.eye(3)
        return Region(np.zeros((0, 3)), basis.T @ form @ basis, c @ basis)
    at, normal = flat_of(shape)
    height = float(normal @ (at - view.eye))
    ahead = np.sign(height) * normal @ basis
    if shape["type"] == "disk":
        turn = np.outer(view.eye - at, normal) + height * np.eye(3)
        form = float(shape["radius"]) ** 2 * np.outer(normal, normal) - turn.T @ turn
        return Region(np.zeros((0, 3)), basis.T @ form @ basis, ahead)
    lines = [ahead]
    if shape["type"] != "plane":
        around = corners_of(shape) - view.eye
        sides = np.cross(around, np.roll(around, -1, axis=0)) @ basis
        # seen from behind corners go round the other way
        lines = [ahead, *(np.sign(height) * sides)]
    return Region(np.array(lines), None, ahead)


def roots(a: Array, b: Array, c: Array) -> tuple[Array, Array]:
    """Real roots of a x^2 + b x + c, the smaller first; NaN where there are none."""
    with np.errstate(all="ignore"):
        # the discriminant of a double root may come out a rounding below nothing
        inner = b * b - 4.0 * a * c
        root = np.sqrt(inner)
        q = -0.5 * (b + np.where(b < 0.0, -root, root))
        one, two = q / a, c / q
    return np.fmin(one, two), np.fmax(one, two)


def ends(region: Region, y: Array, low: Array, high: Array) -> tuple[Array, Array]:
    """Interval of x in [low, high] that the region takes of scanlines y."""
    for p, q, r in region.lines:
        with np.errstate(all="ignore"):
            cut = -(q * y + r) / p
        if p > 0:
            low = np.maximum(low, cut)
        elif p < 0:
            high = np.minimum(high, cut)
        else:
            high = np.where(q * y + r >= 0, high, low)
    form = region.conic
    if form is not None:
        a = np.full_like(y, form[0, 0])
        b = 2.0 * (form[0, 1] * y + form[0, 2])
        c = form[1, 1] * y * y + 2.0 * form[1, 2] * y + form[2, 2]
        first, second = roots(a, b, c)
        p, q, r = region.ahead
        middle = p * 0.5 * (first + second) + q * y + r > 0
        if form[0, 0] < 0:
            low = np.where(middle, np.fmax(low, first), np.inf)
            high = np.where(middle, np.fmin(high, second), -np.inf)
            low = np.where(np.isnan(first), np.inf, low)
        else:
            right = p * (second + 1.0) + q * y + r > p * (first - 1.0) + q * y + r
            low = np.where(right, np.fmax(low, second), low)
            high = np.where(right, high, np.fmin(high, first))
    return low, np.maximum(high, low)


def cuts(region: Region, x0: Array, x1: Array, y0: Array, y1: Array) -> Array:
    """Candidates (N, K) of y at which the pieces that bound the region within a pixel change."""
    found = [y0, y1]
    for index, (p, q, r) in enumerate(region.lines):
        with np.errstate(all="ignore"):
            found += [-(p * x0 + r) / q, -(p * x1 + r) / q]
        for other in region.lines[:index]:
            across = np.cross([p, q, r], other)
            if across[2] != 0:
                found.append(np.full_like(x0, across[1] / across[2]))
    form = region.conic
    if form is not None:
        for x in (x0, x1):
            found += roots(
                np.full_like(x, form[1, 1]),
                2.0 * (form[0, 1] * x + form[1, 2]),
                form[0, 0] * x * x + 2.0 * form[0, 2] * x + form[2, 2],
            )
        found += roots(*(np.full_like(x0, value) for value in (
            form[0, 1] ** 2 - form[0, 0] * form[1, 1],
            2.0 * (form[0, 1] * form[0, 2] - form[0, 0] * form[1, 2]),
            form[0, 2] ** 2 - form[0, 0] * form[2, 2],
        )))  # fmt: skip
    held = np.stack(np.broadcast_arrays(*found), axis=1)
    held = np.where(np.isfinite(held), held, y0[:, None])
    return np.sort(np.clip(held, y0[:, None], y1[:, None]), axis=1)


@dataclass(frozen=True)
class Lit:
    """What rays bring back of one shape under one light, and what of it turns."""

    radiance: Array
    toward: Array
    slant: Array
    side: Array
    """Which side of its kinks a ray is on: 0 in the dark, 1 where a spot falls off, 2 elsewhere."""


class OneShape:
    """One shape, one material, one light: radiance per unit of intensity or irradiance, in closed form."""

    def __init__(self, scene: dict[str, Any], width: int, height: int) -> None:
        self.scene = scene
        self.view = view_of(scene, width, height)
        (self.shape,), (self.light,) = scene["shapes"], scene["lights"]
        self.material = scene["materials"][self.shape["material"]]
        self.region = region_of(self.shape, self.view)
        if self.light["type"] == "directional":
            self.color = np.array(self.light["irradiance"], float) * np.ones(3)
        else:
            self.color = np.array(self.light["intensity"], float) * np.ones(3)
        kind = self.material["type"]
        self.color = self.color * self.material.get("reflectance", 1.0 if kind == "conductor" else 0.5)
        self.wide = (
            0.5 / np.sqrt(self.material["exponent"]) if kind == "phong" else self.material.get("alpha", 1.0)
        )  # a diffuse surface turns no faster than light

    def places(self, sent: Array) -> tuple[Array, Array]:
        """(places, unit normals on the side of the eye or, of one-sided shapes seen from behind, of nothing)."""
        eye, shape = self.view.eye, self.shape
        if shape["type"] == "sphere":
            c = np.array(shape["center"], float) - eye
            along = dot(sent, c)
            beside = c - along[..., None] * sent
            inner = np.maximum(float(shape["radius"]) ** 2 - dot(beside, beside), 0.0)
            normal = -(beside + np.sqrt(inner)[..., None] * sent)
            return eye + c + normal, normal / np.linalg.norm(normal, axis=-1, keepdims=True)
        at, normal = flat_of(shape)
        down = dot(sent, np.broadcast_to(normal, sent.shape))
        far = float(normal @ (at - eye)) / np.where(down == 0.0, 1e-300, down)
        return eye + far[..., None] * sent, np.broadcast_to(normal, sent.shape)

    def look(self, sent: Array) -> Lit:
        """What rays of these directions, within the region, bring back."""
        sent = unit(sent)
        place, normal = self.places(sent)
        light = self.light
        strength, within = np.ones(sent.shape[:-1]), 2
        if light["type"] == "directional":
            toward = np.broadcast_to(-unit(light["direction"]), sent.shape)
        else:
            way = np.array(light["position"], float) - place
            square = dot(way, way)
            toward = way / np.sqrt(square)[..., None]
            strength = 1.0 / square
            if light["type"] == "spot":
                kept = beam(light, -dot(toward, np.broadcast_to(unit(light["direction"]), sent.shape)))
                strength, within = strength * kept, np.where(kept >= 1.0, 2, np.where(kept > 0.0, 1, 0))
        out, into = -dot(normal, sent), dot(normal, toward)
        if self.material.get("two_sided", False):
            side = np.where(out < 0.0, -1.0, 1.0)
            out, into, normal = side * out, side * into, side[..., None] * normal
        lit = (out > 0.0) & (into > 0.0)
        half = toward - sent
        half = half / np.maximum(np.linalg.norm(half, axis=-1, keepdims=True), 1e-300)
        upright = dot(half, normal)
        slant = half - upright[..., None] * normal
        with np.errstate(all="ignore"):
            value = reflected(self.material, out, into, upright, slant, -dot(half, sent), normal, sent, toward)
            found = np.where(lit, value * into * strength, 0.0)
        return Lit(found, toward, slant, np.where(lit, within, 0))


def beam(light: dict[str, Any], cosine: Array) -> Array:
    """What a spot keeps of its intensity at an angle from its middle."""
    inner, outer = float(light["beam"]), float(light["cutoff"])
    if light.get("falloff", "linear") == "linear":
        angle = np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0)))
        return np.clip((outer - angle) / (outer - inner), 0.0, 1.0)
    low, high = np.cos(np.radians([outer, inner]))
    t = np.clip((cosine - low) / (high - low), 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t)


def reflected(
    material: dict[str, Any], out: Array, into: Array, upright: Array, slant: Array, turned: Array, normal: Array,
    sent: Array, toward: Array,
) -> Array:  # fmt: skip
    """The BRDF, without the colours of its reflectance: these are 1."""
    if material["type"] == "diffuse":
        return np.full(out.shape, 1.0 / np.pi)
    if material["type"] == "phong":
        mirrored = sent + 2.0 * out[..., None] * normal
        power = float(material["exponent"])
        return (power + 2.0) / (2.0 * np.pi) * np.maximum(dot(mirrored, toward), 0.0) ** power
    alpha, square = float(material["alpha"]), dot(slant, slant) / (upright * upright)
    fourth = np.pi * alpha * alpha * upright**4
    ggx = material["distribution"] == "ggx"
    density = 1.0 / (fourth * (1.0 + square / alpha**2) ** 2) if ggx else np.exp(-square / alpha**2) / fourth
    one, two = (smith(material, cosine) for cosine in (out, into))
    shown = one * two if material.get("masking", "separable") == "separable" else 1.0 / (1.0 / one + 1.0 / two - 1.0)
    return density * shown * fresnel(material, turned) / (4.0 * out * into)


def smith(material: dict[str, Any], cosine: Array) -> Array:
    """G1 of a direction."""
    alpha = float(material["alpha"])
    tangent = np.sqrt(np.maximum(1.0 - cosine * cosine, 0.0)) / cosine
    if material["distribution"] == "ggx":
        return 2.0 / (1.0 + np.sqrt(1.0 + (alpha * tangent) ** 2))
    a = 1.0 / np.maximum(alpha * tangent, 1e-300)
    if material.get("g1", "exact") == "walter":
        return np.where(a < 1.6, (3.535 * a + 2.181 * a * a) / (1.0 + 2.276 * a + 2.577 * a * a), 1.0)
    return 2.0 / (1.0 + erf(a) + np.exp(-a * a) / (a * np.sqrt(np.pi)))


def fresnel(material: dict[str, Any], cosine: Array) -> Array:
    """Share that a conductor reflects, unpolarised."""
    eta, k = float(material["eta"]), float(material["k"])
    cosine = np.clip(cosine, 0.0, 1.0)
    sine = 1.0 - cosine * cosine
    first = eta * eta - k * k - sine
    both = np.sqrt(first * first + 4.0 * eta * eta * k * k)
    twice = 2.0 * np.sqrt(0.5 * (both + first)) * cosine
    across = (both + cosine**2 - twice) / (both + cosine**2 + twice)
    along = (both * cosine**2 + sine**2 - twice * sine) / (both * cosine**2 + sine**2 + twice * sine)
    return 0.5 * across * (1.0 + along)


def pieces(kind: str, radius: float) -> list[float]:
    """Where a filter's weight has kinks, from the middle of the pixel."""
    if kind == "box":
        return [-0.5, 0.5]
    return {"tent": [-1.0, 0.0, 1.0], "gaussian": [-1.0, 0.0, 1.0], "mitchell": [-1.0, -0.5, 0.0, 0.5, 1.0]}[kind]


def reach(kind: str, radius: float) -> float:
    """Pixels to every side that a filter takes."""
    return 1.0 if kind == "box" else radius or (1.0 if kind == "tent" else 2.0)


def weight(kind: str, reached: float, x: Array) -> Array:
    """A filter's weight along one axis, of integral 1."""
    if kind == "box":
        return np.ones_like(x)
    t = np.abs(x) / reached
    if kind == "tent":
        return np.maximum(1.0 - t, 0.0) / reached
    if kind == "gaussian":
        # a standard deviation of a quarter of the radius, lowered so as to end at nothing
        floor = np.exp(-8.0)
        whole = np.sqrt(2.0 * np.pi) / 4.0 * erf(np.sqrt(8.0)) - 2.0 * floor
        return (np.exp(-8.0 * t * t) - floor) / (whole * reached)
    t = 2.0 * t
    inner = (7.0 * t**3 - 12.0 * t**2 + 16.0 / 3.0) / 6.0
    outer = (-7.0 / 3.0 * t**3 + 12.0 * t**2 - 20.0 * t + 32.0 / 3.0) / 6.0
    return np.where(t < 1.0, inner, np.where(t < 2.0, outer, 0.0)) * 2.0 / reached


NODES = {n: np.polynomial.legendre.leggauss(n) for n in (LOW, HIGH)}


@dataclass
class Panels:
    """Panels of pixels: the pixel, its x limits and y limits, and the middle of the pixel."""

    pixel: npt.NDArray[np.int64]
    x0: Array
    x1: Array
    y0: Array
    y1: Array
    middle: Array


def panels_of(one: OneShape, pixels: Any, kind: str, radius: float) -> Panels:
    """Panels on which a pixel's scanlines have smooth ends."""
    limits = np.array(pieces(kind, radius)) * reach(kind, radius)
    count = len(limits) - 1
    middles = np.asarray(pixels, float) + 0.5
    which = np.repeat(np.arange(len(middles)), count * count)
    i, j = (grid.ravel() for grid in np.meshgrid(np.arange(count), np.arange(count)))
    middle = middles[which]
    i, j = np.tile(i, len(middles)), np.tile(j, len(middles))
    x0, x1 = middle[:, 0] + limits[i], middle[:, 0] + limits[i + 1]
    y0, y1 = middle[:, 1] + limits[j], middle[:, 1] + limits[j + 1]
    held = cuts(one.region, x0, x1, y0, y1)
    low, high = held[:, :-1], held[:, 1:]
    shape = low.shape
    which, x0, x1 = (np.broadcast_to(part[:, None], shape).ravel() for part in (which, x0, x1))
    middle = np.repeat(middle, shape[1], axis=0)
    low, high = low.ravel(), high.ravel()
    seen = np.zeros(len(low), bool)
    for share in (0.01, 0.3, 0.5, 0.8, 0.99):
        left, right = ends(one.region, low + share * (high - low), x0, x1)
        seen |= right > left
    keep = seen & (high > low)
    return Panels(which[keep], x0[keep], x1[keep], low[keep], high[keep], middle[keep])


@dataclass
class Squares:
    """Squares of panels' unit squares: the panel, the lower corner and the side."""

    panel: npt.NDArray[np.int64]
    s: Array
    t: Array
    side: Array

    def part(self, chosen: Any) -> Squares:
        """Those chosen."""
        return Squares(self.panel[chosen], self.s[chosen], self.t[chosen], self.side[chosen])

    def quarters(self) -> Squares:
        """Four of each, half as wide."""
        half = np.repeat(self.side, 4) / 2.0
        step = np.tile([0.0, 0.0, 1.0, 1.0], len(self.side)), np.tile([0.0, 1.0, 0.0, 1.0], len(self.side))
        return Squares(
            np.repeat(self.panel, 4), np.repeat(self.s, 4) + half * step[0], np.repeat(self.t, 4) + half * step[1], half
        )


def rules(
    one: OneShape, panels: Panels, squares: Squares, kind: str, reached: float
) -> tuple[Array, Array, Array, Array]:
    """(rule of HIGH nodes, its difference from LOW, whether light turns too much, whether it has a kink) of each."""
    sides: list[Array] = []
    sums, rough, sizes = [], np.zeros(len(squares.side), bool), np.zeros(len(squares.side))
    for count in (LOW, HIGH):
        nodes, weights = NODES[count]
        grid = (nodes + 1.0) / 2.0
        s = squares.s[:, None, None] + squares.side[:, None, None] * grid[None, :, None]
        t = squares.t[:, None, None] + squares.side[:, None, None] * grid[None, None, :]
        y0, y1 = panels.y0[squares.panel][:, None, None], panels.y1[squares.panel][:, None, None]
        y = y0 + (y1 - y0) * 0.5 * (1.0 - np.cos(np.pi * s))
        x0, x1 = panels.x0[squares.panel][:, None, None], panels.x1[squares.panel][:, None, None]
        left, right = ends(one.region, y, np.broadcast_to(x0, y.shape), np.broadcast_to(x1, y.shape))
        with np.errstate(invalid="ignore"):
            x = left + (right - left) * 0.5 * (1.0 - np.cos(np.pi * t))
            x = np.where(np.isfinite(x), x, x0)
            room = np.where(right > left, right - left, 0.0)
        measure = (y1 - y0) * room * (np.pi / 2.0) ** 2 * np.sin(np.pi * s) * np.sin(np.pi * t)
        middle = panels.middle[squares.panel][:, None, None, :]
        measure = measure * weight(kind, reached, x - middle[..., 0]) * weight(kind, reached, y - middle[..., 1])
        y = np.broadcast_to(y, x.shape)
        lit = one.look(one.view.rays(x, y))
        share = weights[None, :, None] * weights[None, None, :] / 4.0 * squares.side[:, None, None] ** 2
        sums.append((share * measure * lit.radiance).sum(axis=(1, 2)))
        sides.append(lit.side.reshape(len(x), -1))
        if count == LOW:
            flat = lit.slant.reshape(len(x), -1, 3), lit.toward.reshape(len(x), -1, 3)
            span = np.linalg.norm(flat[0].max(axis=1) - flat[0].min(axis=1), axis=1)
            near = np.linalg.norm(flat[0], axis=2).min(axis=1)
            turn = np.linalg.norm(flat[1].max(axis=1) - flat[1].min(axis=1), axis=1)
            rough = (span > near + one.wide) | (turn > TURN)
        else:
            sizes = (share * np.abs(measure) * lit.radiance).sum(axis=(1, 2))
    side = np.concatenate(sides, axis=1)
    return sums[1], np.abs(sums[1] - sums[0]) + 1e-14 * sizes, rough, side.max(axis=1) != side.min(axis=1)


def means(
    one: OneShape, pixels: Any, kind: str, radius: float, asked: Array, turns: int = 6, kinks: int = 0
) -> tuple[Array, Array, int]:
    """(means over pixels (x, y), doubts, squares used); each is sought to ``asked``, per unit of the light's colour.

    Squares are quartered for what turns in them at most ``turns`` times, those with kinks ``kinks`` times, for rules of
    few nodes agree by chance beside them, and for what their rules differ by until all that a pixel's differ by is what
    is asked.
    """
    panels, reached = panels_of(one, pixels, kind, radius), reach(kind, radius)
    count, number = len(panels.x0), len(asked)
    value, doubt, used = np.zeros(number), np.zeros(number), 0
    if count == 0:
        return value, doubt, 0
    first = Squares(np.arange(count), np.zeros(count), np.zeros(count), np.ones(count)).quarters()
    live, depth = first, 0
    kept_value, kept_doubt = np.zeros(number), np.zeros(number)
    while True:
        parts = [
            rules(one, panels, live.part(slice(at, at + BATCH)), kind, reached)
            for at in range(0, len(live.side), BATCH)
        ]
        used += len(live.side)
        sums, off, rough, bent = (np.concatenate([part[k] for part in parts]) for k in range(4))
        owner = panels.pixel[live.panel]
        due = np.bincount(owner, off, number) + kept_doubt > asked
        # what is left may take its share of what is asked
        least = 0.02 * asked[owner]
        halved = (
            (due[owner] & (off > least) & (off > 1e-3 * np.bincount(owner, off, number)[owner]))
            | (rough & (depth < turns))
            | (bent & (depth < kinks))
        )
        if depth >= DEEPEST or used > MOST * (1 + kinks) or not halved.any():
            halved = np.zeros(len(sums), bool)
        kept_value += np.bincount(owner[~halved], sums[~halved], number)
        kept_doubt += np.bincount(owner[~halved], off[~halved], number)
        if not halved.any():
            return kept_value, kept_doubt, used
        live, depth = live.part(halved).quarters(), depth + 1


COARSE, FINE = 16, 48
"""Places along a side of a square in both sums by midpoints."""


def midpoint_mean(
    one: OneShape, pixel: Any, kind: str, radius: float, asked: float, most: int = 40_000
) -> tuple[float, float]:
    """(mean over a pixel by sums of midpoints in squares, its doubt), sought to ``asked`` by ``most`` squares.

    Squares of the largest differences of two sums are quartered. Nothing is taken to be smooth: beside kinks, where a
    spot falls off say, rules of few nodes agree by chance, but not two sums of 256 and 2,304 places.
    """
    reached = 0.5 if kind == "box" else reach(kind, radius)
    middle = np.asarray(pixel, float) + 0.5

    def sums(x: Array, y: Array, half: Array) -> tuple[Array, Array]:
        found = []
        for count in (COARSE, FINE):
            at = (2.0 * np.arange(count) + 1.0) / count - 1.0
            across, lines = (
                x[:, None, None] + half[:, None, None] * at,
                y[:, None, None] + half[:, None, None] * at[:, None],
            )
            across, lines = np.broadcast_arrays(across, lines)
            left, right = ends(one.region, lines, np.full(lines.shape, -1e300), np.full(lines.shape, 1e300))
            light = one.look(one.view.rays(across, lines)).radiance
            light = np.where((across >= left) & (across <= right), light, 0.0)
            light = light * weight(kind, reached, across - middle[0]) * weight(kind, reached, lines - middle[1])
            found.append(light.mean(axis=(1, 2)) * (2.0 * half) ** 2)
        gap = found[1] - found[0]
        # what midpoints miss goes as the square of their distance
        return found[1] + gap / ((FINE / COARSE) ** 2 - 1.0), np.abs(gap) / ((FINE / COARSE) ** 2 - 1.0)

    side = 8
    grid = reached * ((2.0 * np.arange(side) + 1.0) / side - 1.0)
    x, y = (part.ravel() for part in np.meshgrid(middle[0] + grid, middle[1] + grid))
    half = np.full(side * side, reached / side)
    value, off = sums(x, y, half)
    while off.sum() > asked and len(off) < most:
        worst = np.argsort(-off)[: max(16, min(len(off) // 4, 500))]
        quarters = half[worst] / 2.0
        fx, fy, fh = (
            np.concatenate([x[worst] + i * quarters for i in (-1, 1) for _ in (0, 1)]),
            np.concatenate([y[worst] + j * quarters for _ in (0, 1) for j in (-1, 1)]), np.tile(quarters, 4),
        )  # fmt: skip
        more, rest = sums(fx, fy, fh)
        keep = np.ones(len(off), bool)
        keep[worst] = False
        x, y, half = (np.concatenate([a[keep], b]) for a, b in ((x, fx), (y, fy), (half, fh)))
        value, off = np.concatenate([value[keep], more]), np.concatenate([off[keep], rest])
    return float(value.sum()), float(off.sum())
