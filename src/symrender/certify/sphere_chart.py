"""A sphere's chart in balls: azimuth about the direction of its centre, and angle of incidence."""

from __future__ import annotations

from typing import Any

from symrender.certify.chart import Chart
from symrender.certify.floor_point import FloorPoint
from symrender.expression.formulas.shapes import chart_across, sphere_place
from symrender.expression.formulas.textures import texture_phases
from symrender.expression.vectors import Vec3, norm2, unit
from symrender.scene import arrays as at


class SphereChart(Chart):
    """Sphere ``j`` seen from the point."""

    def __init__(self, of: FloorPoint, j: int) -> None:
        self.own = j
        self.center, self.r = of.balls[j]
        away = self.center - of.p
        self.k = self.r / norm2(away).sqrt()
        super().__init__(of, unit(away))

    def place(self, phi: Any, inner: Any) -> tuple[Vec3, Vec3, Vec3, Any]:
        """Hit point, normal, direction and solid angle per dphi dinner."""
        across = chart_across(phi.cos(), phi.sin(), self.e1, self.e2)
        return sphere_place(inner.sin(), inner.cos(), across, self.pole, self.center, self.r, self.k)

    def most_measure(self) -> Any:
        """A ball that holds the measure of every box."""
        from flint import arb

        return arb(0).union(self.k * self.k / (1 - self.k * self.k).sqrt())

    def is_bright(self, normal: Vec3, q: Vec3) -> bool | None:
        """Whether a box lies on the bright side of the texture; None where it lies on both."""
        s = self.of.a.spheres[self.own or 0]
        if s.texture == at.SOLID:
            return True
        across, down = texture_phases(normal, float(s.ku), float(s.kv))
        sign = across.sin_pi()
        if s.texture == at.CHECKER:
            sign = sign * down.sin_pi()
        return True if sign >= 0 else (False if sign < 0 else None)

    def albedo(self, channel: int, bright: bool | None) -> Any:
        """Albedo of a channel on that side."""
        from flint import arb

        s = self.of.a.spheres[self.own or 0]
        factor = arb(1 if bright else float(s.dark))
        if bright is None:
            factor = factor.union(arb(1))
        return float(s.color[channel]) * factor

    def shuts_out(self, light: Vec3) -> bool:
        """Whether the ball hides a light from all of itself."""
        return bool(norm2(light - self.center) - self.r * self.r < 0)
