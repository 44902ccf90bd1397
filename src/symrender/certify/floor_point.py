"""A floor point, what it is seen from and what it sees, as balls."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from symrender.chambers.lobes.units import is_brdf
from symrender.errors import OptionError
from symrender.expression.formulas.lobes import (
    NO_RIM,
    brdf_normaliser,
    cosine_power,
    log_rim,
    mirror_direction,
    normaliser,
)
from symrender.expression.vectors import Vec3, cross, dot, unit
from symrender.quadrature.light_points import light_rows
from symrender.scene.arrays import SceneArrays
from symrender.scene.records import Plane

Array = npt.NDArray[np.float64]


def ball_vector(numbers: Array) -> Vec3:
    """Three doubles as balls without a radius."""
    from flint import arb

    return Vec3(*(arb(float(x)) for x in numbers))


class PlaneBalls:
    """A plane as balls: its frame, and on which ``side`` of it, 1 or -1, a point lies."""

    def __init__(self, plane: Plane, point: Vec3) -> None:
        self.origin = ball_vector(plane.point)
        self.up = unit(ball_vector(plane.normal))
        along = ball_vector(plane.along)
        self.east = unit(along - self.up * dot(along, self.up))
        self.north = cross(self.up, self.east)
        above = self.height(point)
        if not (above > 0 or above < 0):
            raise OptionError("certify: the point lies in a plane, or too near to one")
        self.side = 1 if above > 0 else -1

    def height(self, q: Vec3) -> Any:
        """Distance of a point from the plane, negative behind it."""
        return dot(q - self.origin, self.up)


class FloorPoint:
    """The numbers of one floor point as balls."""

    def __init__(self, arrays: SceneArrays, point: Array, disk_order: int) -> None:
        from flint import arb

        self.a = arrays
        self.p, self.eye = ball_vector(point), ball_vector(arrays.camera.eye)
        self.up = Vec3(arb(0), arb(0), arb(1))
        self.m = mirror_direction(unit(self.p - self.eye), self.up)
        n = arb(float(arrays.floor.exponent))
        theta = float(arrays.floor.theta_max)
        self.n = n
        self.rim = arb(theta).cos() if theta < math.pi / 2 else arb(0)
        self.log_rim = log_rim(arb(theta)) if theta < math.pi / 2 else arb(NO_RIM)
        self.total = normaliser(self.log_rim, n)
        # in BRDF units the floor's cosine stands inside, and the normaliser is that of the whole lobe
        self.brdf = is_brdf(arrays)
        if self.brdf:
            self.total = brdf_normaliser(n)
        rows = light_rows(arrays, disk_order)
        self.lights = [(ball_vector(row.position), row.color.tolist()) for row in rows]
        shading = arrays.shading
        most = shading.ka * shading.ambient + rows["color"].sum(axis=0) * (shading.kd + shading.ks)
        self.most = [arb(float(x)) * (1 + arb(2) ** -40) for x in most]
        self.balls = [(ball_vector(s.center), arb(float(s.radius))) for s in arrays.spheres]
        self.planes = [PlaneBalls(plane, self.p) for plane in arrays.planes]

    def inward(self, q: Vec3, but: int = -1) -> list[Any]:
        """Heights over all planes but one, positive on the point's side: all of them in its room."""
        return [plane.height(q) * plane.side for k, plane in enumerate(self.planes) if k != but]

    def is_walled_off(self, light: Vec3) -> bool:
        """Whether some plane certainly stands between the point's room and a light."""
        return any(height < 0 for height in self.inward(light))

    def share(self) -> Any:
        """Share of the lobe above the horizon: rings, on each of which the visible half-arc falls with the angle.

        In BRDF units every direction counts with its cosine, whose mean over a ring of visible half-arc a is
        (cos theta lift a + sin theta across sin a)/pi.
        """
        from flint import arb

        lift = self.m.z
        across = (1 - lift * lift).sqrt()
        rings = 4096
        u = self.n + 1
        total = arb(0)
        theta_max = self.rim.acos()
        before, arc_before, c_before, s_before = arb(1), arb.pi(), arb(1), arb(0)
        for k in range(1, rings + 1):
            theta = theta_max * k / rings
            c, s = theta.cos(), theta.sin()
            rest = cosine_power(c, u) if c > 0 else arb(0)
            if s * across <= c * lift:
                arc = arb.pi()
            elif c * lift <= -s * across:
                arc = arb(0)
            else:
                ratio = c * lift / (s * across)
                ratio = ratio.min(arb(1)).max(arb(-1))
                arc = (-ratio).acos()
            up = arc.union(arc_before)
            if self.brdf:
                up = c.union(c_before) * lift * up + s.union(s_before) * across * up.sin()
            total += (before - rest) * up
            before, arc_before, c_before, s_before = rest, arc, c, s
        total /= arb.pi()
        return total * (self.n + 2) / (self.n + 1) if self.brdf else total / (1 - before)
