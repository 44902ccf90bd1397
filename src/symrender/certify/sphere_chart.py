"""A sphere seen from a floor point: proved bounds of what the boxes of its chart add to the lobe integral.

A box on which every guard is decided (rim, horizon, occlusion, terminators, shadows, texture) has an analytic
integrand: Gauss nodes in both coordinates, with the remainder of an analytic function,
64/15 M rho^(-2n)/(1 - rho^-2), M the largest magnitude on the surrounding complex box. On any other box the integrand
is enclosed by the box itself, an undecided guard being both of its values.
"""

from __future__ import annotations

from typing import Any, Final

from symrender.certify.balls import blocked
from symrender.certify.floor_point import FloorPoint
from symrender.expression.formulas.light_terms import blinn_term, eye_view, light_channel, phong_term, ray_view
from symrender.expression.formulas.lobes import cosine_power
from symrender.expression.formulas.shapes import chart_across, sphere_place
from symrender.expression.formulas.textures import texture_phases
from symrender.expression.vectors import Vec3, cross, dot, norm2, unit
from symrender.scene import arrays as at

NODES: Final = 3
STRETCH: Final = 4.0
"""rho of the Bernstein ellipses on which a decided box is bounded."""


class SphereChart:
    """One sphere seen from the point."""

    def __init__(self, of: FloorPoint, j: int) -> None:
        from flint import arb

        self.of, self.j = of, j
        center, self.r = of.balls[j]
        self.center = center
        away = center - of.p
        self.k = self.r / norm2(away).sqrt()
        self.pole = unit(away)
        side = Vec3(arb(1), arb(0), arb(0))
        if abs(float(self.pole.x.mid())) > 0.6:
            side = Vec3(arb(0), arb(1), arb(0))
        self.e1 = unit(cross(self.pole, side))
        self.e2 = cross(self.pole, self.e1)
        self.turn = 3.0

    def place(self, phi: Any, psi: Any) -> tuple[Vec3, Vec3, Vec3, Any]:
        """Hit point, normal, direction and solid angle per dphi dpsi."""
        across = chart_across(phi.cos(), phi.sin(), self.e1, self.e2)
        return sphere_place(psi.sin(), psi.cos(), across, self.pole, self.center, self.r, self.k)

    def contribution(self, box: tuple[float, float, float, float]) -> list[Any] | None:
        """Balls (3,) around the box's part of the integral, None where that is zero; the background is subtracted."""
        from flint import arb

        turn, quarter = 2 * arb.pi(), arb.pi() / 2
        phi = turn * arb(box[0]).union(arb(box[1]))
        psi = quarter * arb(box[2]).union(arb(box[3]))
        area = turn * (box[1] - box[0]) * quarter * (box[3] - box[2])
        q, normal, w, measure = self.place(phi, psi)
        toward = dot(w, self.of.m)
        if toward <= self.of.rim or w.z <= 0 or q.z <= 0:
            return None
        inside = True if toward > self.of.rim and w.z > 0 and q.z > 0 else None
        for h, (center, radius) in enumerate(self.of.balls):
            if h != self.j and inside is not False:
                met = blocked(self.of.p, q - self.of.p, center, radius)
                inside = False if met else (inside if met is False else None)
        if inside is False:
            return None
        label = self._label(normal, q)
        if not measure.is_finite():
            measure = arb(0).union(self.k * self.k / (1 - self.k * self.k).sqrt())
        cosine = toward.max(arb(0)).min(arb(1))
        density = cosine_power(cosine.upper(), self.of.n) if cosine.upper() > 0 else arb(0)
        floor = cosine_power(cosine.lower(), self.of.n) if inside and cosine.lower() > 0 else arb(0)
        if self.of.brdf:
            up = w.z.max(arb(0)).min(arb(1))
            density, floor = density * up.upper(), floor * up.lower()
        most = (area * measure.upper() * density / self.of.total).upper()
        least = (area * measure.max(arb(0)).lower() * floor / self.of.total).lower()
        mass = least.union(most)
        rough = []
        sky = [arb(float(b)) for b in self.of.a.shading.background]
        radiance = self.radiance(phi, psi, label, weighted=False)
        for f, top, b in zip(radiance, self.of.most, sky, strict=True):
            if not f.is_finite():
                f = arb(0).union(top) - b
            x = f.lower() * (least if f.lower() > 0 else most)
            y = f.upper() * (most if f.upper() > 0 else least)
            part = x.union(y)
            rough.append(part if inside else part.union(arb(0)))
        if not inside or None in label or not mass.is_finite():
            return rough
        exact = self._gauss(box, label)
        return exact if exact is not None and max(x.rad() for x in exact) < max(x.rad() for x in rough) else rough

    def _label(self, normal: Vec3, q: Vec3) -> tuple[Any, ...]:
        """Whether the texture is bright, then of each light 0 dark, 1 behind the terminator, 2 lit; None undecided."""
        of = self.of
        opened = of.a.shading.terminator == at.OPEN and of.a.shading.ks > 0
        states: list[int | None] = []
        for light, _ in of.lights:
            to = light - q
            cosine = dot(to, normal)
            apart = norm2(light - self.center) - self.r * self.r
            if light.z < 0 or apart < 0 or (cosine <= 0 and not opened):
                states.append(0)
                continue
            state: int | None = 2 if cosine > 0 else (1 if cosine <= 0 and apart >= 0 else None)
            for h, (center, radius) in enumerate(of.balls):
                if h != self.j and state != 0:
                    met = blocked(q, to, center, radius)
                    state = 0 if met else (state if met is False else None)
            states.append(state)
        return (self._bright(normal), *states)

    def _bright(self, normal: Vec3) -> bool | None:
        """Whether a box lies on the bright side of its sphere's texture; None where it lies on both."""
        s = self.of.a.spheres[self.j]
        if s.texture == at.SOLID:
            return True
        across, down = texture_phases(normal, float(s.ku), float(s.kv))
        sign = across.sin_pi()
        if s.texture == at.CHECKER:
            sign = sign * down.sin_pi()
        return True if sign >= 0 else (False if sign < 0 else None)

    def radiance(self, phi: Any, psi: Any, label: tuple[Any, ...], *, weighted: bool = True) -> list[Any]:
        """Radiance less background, ``weighted`` by lobe density and measure, at balls or complex balls.

        What is undecided in the label is a ball of all its values; complex balls need a decided one.
        """
        from flint import arb

        of = self.of
        shading = of.a.shading
        q, normal, w, measure = self.place(phi, psi)
        weight = cosine_power(dot(w, of.m), of.n) * measure / of.total if weighted else arb(1)
        if self.of.brdf and weighted:
            weight *= w.z
        view = eye_view(of.eye, q) if shading.highlight_view == at.EYE else ray_view(w)
        term = phong_term if shading.model == at.PHONG else blinn_term
        s = of.a.spheres[self.j]
        factor = arb(1 if label[0] else float(s.dark))
        if label[0] is None:
            factor = factor.union(arb(1))
        sums = [shading.ka * shading.ambient[c] - shading.background[c] + 0 * weight for c in range(3)]
        for (light, color), state in zip(of.lights, label[1:], strict=True):
            if state == 0:
                continue
            cosine, gleam = term(light - q, normal, view, float(shading.shininess))
            if state is None:
                cosine, gleam = cosine.max(arb(0)).union(arb(0)), gleam.union(arb(0))
            if state == 1:
                cosine = arb(0)
            for c in range(3):
                albedo = float(s.color[c]) * factor
                part = light_channel(color[c], float(shading.kd), float(shading.ks), albedo, cosine, gleam)
                sums[c] = sums[c] + part
        return [x * weight for x in sums]

    def _gauss(self, box: tuple[float, float, float, float], label: tuple[Any, ...]) -> list[Any] | None:
        """Tensor Gauss rule with a proved remainder; None where the complex box leaves the domain."""
        from flint import acb, arb

        turn, quarter = 2 * arb.pi(), arb.pi() / 2
        middle = (turn * (box[0] + box[1]) / 2, quarter * (box[2] + box[3]) / 2)
        half = (turn * (box[1] - box[0]) / 2, quarter * (box[3] - box[2]) / 2)
        spread = arb(0, (STRETCH + 1 / STRETCH) / 2), arb(0, (STRETCH - 1 / STRETCH) / 2)
        real = [m + h * arb(0, 1) for m, h in zip(middle, half, strict=True)]
        wide = [acb(m + h * spread[0], h * spread[1]) for m, h in zip(middle, half, strict=True)]
        bounds = [arb(0)] * 3
        for phi, psi in ((wide[0], acb(real[1])), (acb(real[0]), wide[1])):
            for c, x in enumerate(self.radiance(phi, psi, label)):
                if not x.is_finite():
                    return None
                bounds[c] = bounds[c] + abs(x).upper()
        remainder = arb(64) / 15 * arb(STRETCH) ** (-2 * NODES) / (1 - arb(STRETCH) ** -2)
        area = 4 * half[0] * half[1]
        sums = [arb(0)] * 3
        nodes = [arb.legendre_p_root(NODES, k, weight=True) for k in range(NODES)]
        for x, u in nodes:
            for y, v in nodes:
                value = self.radiance(middle[0] + half[0] * x, middle[1] + half[1] * y, label)
                sums = [t + u * v * z for t, z in zip(sums, value, strict=True)]
        # a rule of positive weights of sum 2 a direction passes the first remainder on unenlarged
        return [area * (t / 4 + arb(0, 1) * remainder * b / 2) for t, b in zip(sums, bounds, strict=True)]
