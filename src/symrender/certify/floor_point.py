"""A floor point, what it is seen from and what it sees, as balls."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from symrender.certify.balls import unit
from symrender.quadrature.light_points import light_rows
from symrender.quadrature.lobe_units import is_brdf
from symrender.scene.arrays import SceneArrays

Array = npt.NDArray[np.float64]


class FloorPoint:
    """The numbers of one floor point as balls."""

    def __init__(self, arrays: SceneArrays, point: Array, disk_order: int) -> None:
        from flint import arb

        self.a = arrays
        self.p = [arb(x) for x in point.tolist()]
        eye = [arb(x) for x in arrays.camera.eye.tolist()]
        d = unit([p - e for p, e in zip(self.p, eye, strict=True)])
        self.m = [d[0], d[1], -d[2]]
        self.eye = eye
        n = arb(float(arrays.floor.exponent))
        theta = float(arrays.floor.theta_max)
        self.n = n
        self.rim = arb(theta).cos() if theta < math.pi / 2 else arb(0)
        self.total = 2 * arb.pi() * (1 - (self.rim.log() * (n + 1)).exp() if theta < math.pi / 2 else arb(1)) / (n + 1)
        # in BRDF units the floor's cosine stands inside, and the normaliser is that of the whole lobe
        self.brdf = is_brdf(arrays)
        if self.brdf:
            self.total = 2 * arb.pi() / (n + 2)
        rows = light_rows(arrays, disk_order)
        self.lights = [([arb(x) for x in row.position.tolist()], row.color.tolist()) for row in rows]
        most = arrays.shading.ka * arrays.shading.ambient + rows["color"].sum(axis=0) * (
            arrays.shading.kd + arrays.shading.ks
        )
        self.most = [arb(float(x)) * (1 + arb(2) ** -40) for x in most]
        self.balls = [([arb(x) for x in s.center.tolist()], arb(float(s.radius))) for s in arrays.spheres]

    def share(self) -> Any:
        """Share of the lobe above the horizon: rings, on each of which the visible azimuths fall with the angle.

        In BRDF units every direction counts with its cosine, whose mean over a ring of which the share a is visible is
        (cos theta lift pi a + sin theta across sin(pi a))/pi.
        """
        from flint import arb

        lift = self.m[2]
        across = (1 - lift * lift).sqrt()
        rings = 4096
        u = self.n + 1
        total = arb(0)
        theta_max = self.rim.acos()
        before, seen_before, c_before, s_before = arb(1), arb(1), arb(1), arb(0)
        for k in range(1, rings + 1):
            theta = theta_max * k / rings
            c, s = theta.cos(), theta.sin()
            rest = (c.log() * u).exp() if c > 0 else arb(0)
            if s * across <= c * lift:
                seen = arb(1)
            elif c * lift <= -s * across:
                seen = arb(0)
            else:
                ratio = c * lift / (s * across)
                ratio = ratio.min(arb(1)).max(arb(-1))
                seen = 1 - ratio.acos() / arb.pi()
            up = seen.union(seen_before)
            if self.brdf:
                arc = arb.pi() * up
                up = (c.union(c_before) * lift * arc + s.union(s_before) * across * arc.sin()) / arb.pi()
            total += (before - rest) * up
            before, seen_before, c_before, s_before = rest, seen, c, s
        return total * (self.n + 2) / (self.n + 1) if self.brdf else total / (1 - before)
