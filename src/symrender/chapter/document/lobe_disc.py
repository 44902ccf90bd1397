"""The lobe of one point as a disc: what each direction sees, the walls across which it changes, and a rule's cells.

Equal areas of the disc hold equal shares of the lobe: the radius is the root of the lobe's share inside. So the mean
colour of the disc is the point's gloss.
"""

from __future__ import annotations

import html
import math
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from symrender.chapter.document.pictures import data_uri
from symrender.images.srgb import encode_srgb
from symrender.quadrature.strata import Rings
from symrender.runtimes import numba
from symrender.scene.arrays import Array, SceneArrays
from symrender.studies.lobe_rays import BEHIND, BELOW, LIGHTS, SHAPE, TEXTURE, LobeRays

_WALLS: Final = {"texture": (0.62, 0.62, 0.62), "shadow": (0.05, 0.05, 0.05), "terminator": (1.0, 0.82, 0.4),
                 "silhouette": (1.0, 1.0, 1.0), "horizon": (0.6, 0.82, 1.0)}  # fmt: skip
"""Colours of the walls in sRGB, in the order in which one is drawn over another."""
VIEW: Final = 512
"""Sides of the square a disc is drawn in."""


@dataclass(frozen=True, eq=False)
class Disc:
    """What the directions of one lobe see: ``pixels`` (side, side, 3) in sRGB, transparent outside ``inside``.

    ``mean`` (3,) is the average of radiance over the disc, ``kinds`` counts the pixels on each kind of wall.
    """

    pixels: npt.NDArray[np.uint8]
    mean: Array
    kinds: dict[str, int]


class Lobe:
    """The lobe at one point of a shape of hit class ``leaves``, seen along the unit direction ``incoming``."""

    def __init__(
        self, arrays: SceneArrays, place: Array, normal: Array, incoming: Array, leaves: int, lobe: tuple[float, float]
    ) -> None:
        self._rays = LobeRays(arrays, 2)
        self._formulas: Any = numba.plain(numba.image_text())
        self._place, self._normal, self._leaves = place, normal, leaves
        self._frame = self._rays.frame(incoming, normal)
        self.exponent, self.theta_max = lobe

    def disc(self, side: int, *, gain: float, fine: int, walls: bool = True) -> Disc:
        """Rendered ``side`` pixels wide from ``fine`` x ``fine`` directions a pixel; ``walls`` are drawn or not."""
        n = side * fine
        step = (2.0 * np.arange(n) + 1.0) / n - 1.0
        x, y = np.meshgrid(step, -step)
        rho = np.hypot(x, y)
        inside = rho <= 1.0
        radiance, labels = np.zeros((n, n, 3)), np.zeros((n, n, LIGHTS + self._rays_lights()), np.int64)
        seen = self._rays.see(
            self._place, self._normal, self._leaves, self._directions(rho[inside], x[inside], y[inside])
        )
        radiance[inside], labels[inside] = seen.radiance, seen.labels
        mean: Array = radiance[inside].mean(axis=0)
        shown = np.clip(encode_srgb(radiance * gain).astype(np.float64) / 255.0, 0.0, 1.0)
        below = inside & (labels[:, :, SHAPE] == BELOW)
        stripes = (np.add.outer(np.arange(n), np.arange(n)) // (3 * fine)) % 2
        shown[below] = (0.13 + 0.04 * stripes[below])[:, None]
        kinds = {}
        for name, edge in _edges(labels, inside).items():
            kinds[name] = int(edge.sum())
            thick = edge.copy()
            for axis in (0, 1):
                thick |= np.roll(edge, 1, axis) | np.roll(edge, -1, axis)
            if walls:
                shown[thick & inside] = _WALLS[name]
        blocks = shown.reshape(side, fine, side, fine, 3).mean(axis=(1, 3))
        return Disc((blocks * 255.0 + 0.5).astype(np.uint8), mean, kinds)

    def _rays_lights(self) -> int:
        probe = self._rays.see(self._place, self._normal, self._leaves, self._frame[2:3])
        return int(probe.labels.shape[1]) - LIGHTS

    def _directions(self, rho: Array, x: Array, y: Array) -> Array:
        u = self.exponent + 1.0
        knots = np.linspace(0.0, 1.0, 4097)
        inner = [self._formulas.share_angle(k * k, self.theta_max, u) for k in knots[1:-1].tolist()]
        angles = np.array([0.0, *inner, self.theta_max])
        theta = np.interp(rho, knots, angles)
        sine = np.sin(theta) / np.maximum(rho, 1e-12)
        local = np.stack([sine * x, sine * y, np.cos(theta)], axis=-1)
        world: Array = local @ self._frame
        world /= np.linalg.norm(world, axis=1, keepdims=True)
        return world

    def radius(self, theta: float) -> float:
        """Where an angle is drawn, 0 in the middle and 1 at the rim."""
        if theta <= 0.0:
            return 0.0
        u = self.exponent + 1.0
        total = self._formulas.ring_weight(0.0, self.theta_max, u)
        return math.sqrt(float(self._formulas.ring_weight(0.0, min(theta, self.theta_max), u)) / total)

    def picture(self, disc: Disc, ring: Rings, sectors: int, alt: str, name: str) -> str:
        """SVG of the disc with the cells and nodes of a rule over it; the area of a dot is its cell's weight.

        ``name`` is what its own parts are called in the page; no two pictures may share it.
        """
        middle, outer = VIEW / 2, VIEW / 2 - 4
        clip = f"clip-{name}"
        parts = [
            f'<clipPath id="{clip}"><circle cx="{middle}" cy="{middle}" r="{outer}"/></clipPath>',
            f'<image id="disc-{name}" clip-path="url(#{clip})" x="4" y="4" width="{2 * outer}" height="{2 * outer}" '
            f'href="{data_uri(disc.pixels)}"/>',
        ]
        parts += self.cells(ring, sectors)
        parts.append(f'<circle class="rim" cx="{middle}" cy="{middle}" r="{outer}"/>')
        return (
            f'<svg class="disc" viewBox="0 0 {VIEW} {VIEW}" role="img" aria-label="{html.escape(alt, quote=True)}">'
            f"{''.join(parts)}</svg>"
        )

    def cells(self, ring: Rings, sectors: int) -> list[str]:
        """The cells and nodes of a rule, as parts of an SVG ``VIEW`` wide."""
        middle, outer = VIEW / 2, VIEW / 2 - 4
        parts = []
        for edge in ring.edges[1:-1].tolist():
            parts.append(f'<circle class="cell" cx="{middle}" cy="{middle}" r="{outer * self.radius(edge):.2f}"/>')
        for sector in range(sectors):
            turn = 2.0 * math.pi * sector / sectors
            ends = (middle + outer * math.cos(turn), middle - outer * math.sin(turn))
            parts.append(f'<path class="cell" d="M{middle} {middle}L{ends[0]:.2f} {ends[1]:.2f}"/>')
        for node, weight in zip(ring.nodes.tolist(), (ring.weights / sectors).tolist(), strict=True):
            size = 0.3 * outer * math.sqrt(weight)
            for sector in range(sectors):
                turn = 2.0 * math.pi * (sector + 0.5) / sectors
                at = outer * self.radius(node)
                x, y = middle + at * math.cos(turn), middle - at * math.sin(turn)
                parts.append(f'<circle class="node" cx="{x:.2f}" cy="{y:.2f}" r="{size:.2f}"/>')
        return parts


def _edges(labels: npt.NDArray[np.int64], inside: npt.NDArray[np.bool_]) -> dict[str, npt.NDArray[np.bool_]]:
    """Pixels beside which a label changes, by the kind of wall that changes it."""
    found = {name: np.zeros(inside.shape, np.bool_) for name in _WALLS}
    for axis in (0, 1):
        other = np.roll(labels, -1, axis)
        both = inside & np.roll(inside, -1, axis)
        differ = (labels != other) & both[:, :, None]
        horizon = differ[:, :, SHAPE] & ((labels[:, :, SHAPE] == BELOW) | (other[:, :, SHAPE] == BELOW))
        shape = differ[:, :, SHAPE] & ~horizon
        lights, behind = differ[:, :, LIGHTS:], (labels[:, :, LIGHTS:] == BEHIND) != (other[:, :, LIGHTS:] == BEHIND)
        same = both & ~differ[:, :, SHAPE]
        found["horizon"] |= horizon
        found["silhouette"] |= shape
        found["texture"] |= differ[:, :, TEXTURE] & same
        found["terminator"] |= behind.any(axis=2) & same
        found["shadow"] |= (lights & ~behind).any(axis=2) & same
    return found
