"""A plane's chart in balls: azimuth about its normal, and the angle to it."""

from __future__ import annotations

from typing import Any

from symrender.certify.chart import Chart
from symrender.certify.floor_point import FloorPoint
from symrender.expression.formulas.shapes import chart_across, floor_sight
from symrender.expression.formulas.textures import floor_phases
from symrender.expression.vectors import Vec3, dot
from symrender.scene import arrays as at


class PlaneChart(Chart):
    """Plane ``k`` seen from the point, which is off it."""

    def __init__(self, of: FloorPoint, k: int) -> None:
        self.k = k
        self.plane = of.planes[k]
        self.is_lit = self.plane.side > 0
        self.height = self.plane.height(of.p) * self.plane.side
        super().__init__(of, self.plane.up * -self.plane.side)

    def place(self, phi: Any, inner: Any) -> tuple[Vec3, Vec3, Vec3, Any]:
        """Hit point, normal, direction and solid angle per dphi dinner."""
        across = chart_across(phi.cos(), phi.sin(), self.e1, self.e2)
        offset, w, measure = floor_sight(inner, across, self.pole, self.height)
        return self.of.p + offset, self.plane.up, w, measure

    def most_measure(self) -> Any:
        """A ball that holds the measure of every box."""
        from flint import arb

        return arb(0).union(arb(1))

    def _rooms(self, q: Vec3) -> list[Any]:
        return self.of.inward(q, but=self.k)

    def is_bright(self, normal: Vec3, q: Vec3) -> bool | None:
        """Whether a box lies on the bright side of the texture; None where it lies on both."""
        row, away = self.of.a.planes[self.k], q - self.plane.origin
        if row.kind != at.CHECKER:
            return True
        east, north = dot(away, self.plane.east), dot(away, self.plane.north)
        x, y = floor_phases(east, north, float(row.cell), float(row.offset[0]), float(row.offset[1]))
        sign = x.sin_pi() * y.sin_pi()
        return True if sign >= 0 else (False if sign < 0 else None)

    def albedo(self, channel: int, bright: bool | None) -> Any:
        """Albedo of a channel on that side."""
        from flint import arb

        row = self.of.a.planes[self.k]
        light, dark = arb(float(row.bright[channel])), arb(float(row.dark[channel]))
        return light.union(dark) if bright is None else (light if bright else dark)

    def shuts_out(self, light: Vec3) -> bool:
        """Whether the plane hides a light from all of itself."""
        return not self.is_lit or bool(self.plane.height(light) <= 0)
