"""A shape seen from a floor point: proved bounds of what the boxes of its chart add to the lobe integral.

A box on which every guard is decided (rim, horizon, rooms, occlusion, terminators, shadows, texture) has an analytic
integrand: Gauss nodes in both coordinates, with the remainder of an analytic function,
64/15 M rho^(-2n)/(1 - rho^-2), M the largest magnitude on the surrounding complex box. On any other box the integrand
is enclosed by the box itself, an undecided guard being both of its values.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any, Final

from symrender.certify.balls import blocked
from symrender.certify.floor_point import FloorPoint
from symrender.expression.formulas.light_terms import blinn_term, eye_view, light_channel, phong_term, ray_view
from symrender.expression.formulas.lobes import cosine_power
from symrender.expression.vectors import Vec3, cross, dot, unit
from symrender.scene import arrays as at

NODES: Final = 3
STRETCH: Final = 4.0
"""rho of the Bernstein ellipses on which a decided box is bounded."""


class Chart(ABC):
    """A shape in polar coordinates about a pole; ``turn`` is how much longer than high boxes may be, over 2."""

    turn = 3.0
    own: int | None = None
    """The ball that is charted; None of a plane."""
    is_lit = True
    """Whether the side that the point sees reflects at all."""

    def __init__(self, of: FloorPoint, pole: Vec3) -> None:
        from flint import arb

        self.of, self.pole = of, pole
        side = Vec3(arb(1), arb(0), arb(0))
        if abs(float(pole.x.mid())) > 0.6:
            side = Vec3(arb(0), arb(1), arb(0))
        self.e1 = unit(cross(pole, side))
        self.e2 = cross(pole, self.e1)

    @abstractmethod
    def place(self, phi: Any, inner: Any) -> tuple[Vec3, Vec3, Vec3, Any]:
        """Hit point, normal, direction and solid angle per dphi dinner."""

    @abstractmethod
    def most_measure(self) -> Any:
        """A ball that holds the measure of every box."""

    @abstractmethod
    def is_bright(self, normal: Vec3, q: Vec3) -> bool | None:
        """Whether a box lies on the bright side of the texture; None where it lies on both."""

    @abstractmethod
    def albedo(self, channel: int, bright: bool | None) -> Any:
        """Albedo of a channel on that side."""

    @abstractmethod
    def shuts_out(self, light: Vec3) -> bool:
        """Whether the shape hides a light from all of itself."""

    def contribution(self, box: tuple[float, float, float, float]) -> list[Any] | None:
        """Balls (3,) around the box's part of the integral, None where that is zero; the background is subtracted."""
        from flint import arb

        turn, quarter = 2 * arb.pi(), arb.pi() / 2
        phi = turn * arb(box[0]).union(arb(box[1]))
        psi = quarter * arb(box[2]).union(arb(box[3]))
        area = turn * (box[1] - box[0]) * quarter * (box[3] - box[2])
        q, normal, w, measure = self.place(phi, psi)
        toward = dot(w, self.of.m)
        guards = [toward - self.of.rim, w.z, q.z, *self._rooms(q)]
        if any(guard <= 0 for guard in guards):
            return None
        inside = True if all(guard > 0 for guard in guards) else None
        for h, (center, radius) in enumerate(self.of.balls):
            if h != self.own and inside is not False:
                met = blocked(self.of.p, q - self.of.p, center, radius)
                inside = False if met else (inside if met is False else None)
        if inside is False:
            return None
        label = self._label(normal, q)
        if not measure.is_finite():
            measure = self.most_measure()
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

    def _rooms(self, q: Vec3) -> list[Any]:
        """Heights over the planes that bound the point's room, the charted one left out."""
        return self.of.inward(q)

    def _label(self, normal: Vec3, q: Vec3) -> tuple[Any, ...]:
        """Whether the texture is bright, then of each light 0 dark, 1 behind the terminator, 2 lit; None undecided."""
        of = self.of
        opened = of.a.shading.terminator == at.OPEN and of.a.shading.ks > 0
        states: list[int | None] = []
        for light, _ in of.lights:
            to = light - q
            cosine = dot(to, normal)
            if light.z < 0 or of.is_walled_off(light) or self.shuts_out(light) or (cosine <= 0 and not opened):
                states.append(0)
                continue
            state: int | None = 2 if cosine > 0 else (1 if cosine <= 0 else None)
            for h, (center, radius) in enumerate(of.balls):
                if h != self.own and state != 0:
                    met = blocked(q, to, center, radius)
                    state = 0 if met else (state if met is False else None)
            states.append(state)
        return (self.is_bright(normal, q), *states)

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
        ka = shading.ka if self.is_lit else 0.0
        sums = [ka * shading.ambient[c] - shading.background[c] + 0 * weight for c in range(3)]
        for (light, color), state in zip(of.lights, label[1:], strict=True):
            if state == 0:
                continue
            cosine, gleam = term(light - q, normal, view, float(shading.shininess))
            if state is None:
                cosine, gleam = cosine.max(arb(0)).union(arb(0)), gleam.union(arb(0))
            if state == 1:
                cosine = arb(0)
            for c in range(3):
                albedo = self.albedo(c, label[0])
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
