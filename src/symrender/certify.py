"""Proved bounds of the lobe integral at a floor point, by ball arithmetic.

Each visible sphere carries the chart of ``chambers/walls.py``: azimuth phi and angle of incidence psi about the
direction of its centre. A box of the chart on which every guard is decided (rim, horizon, occlusion, terminators,
shadows, texture) has an analytic integrand: Gauss nodes in both coordinates, with the remainder of an analytic
function, 64/15 M rho^(-2n)/(1 - rho^-2), M the largest magnitude on the surrounding complex box. On any other box the
integrand is enclosed by the box itself, an undecided guard being both of its values. The widest contributions are
halved until the sum is narrow enough. Nothing is shared with the split rule: no roots, no events, no estimate. All
arithmetic is outward rounded (Arb, F. Johansson, IEEE Trans. Computers 66, 2017, doi:10.1109/TC.2017.2690633).
"""

from __future__ import annotations

import heapq
import importlib.util
import itertools
import math
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from symrender.errors import OptionError
from symrender.quadrature.light_points import light_rows
from symrender.quadrature.lobe_units import is_brdf
from symrender.scene import arrays as at
from symrender.scene.arrays import SceneArrays
from symrender.settings import EXACT_DISK

Array = npt.NDArray[np.float64]

NODES: Final = 3
STRETCH: Final = 4.0
"""rho of the Bernstein ellipses on which a decided box is bounded."""


@dataclass(frozen=True)
class Enclosure:
    """Proved bounds ``low`` and ``high`` (3,) of gloss at one point, and the ``boxes`` it took."""

    low: Array
    high: Array
    boxes: int

    def holds(self, value: Array) -> bool:
        """Whether a value lies inside, with no allowance."""
        return bool((value >= self.low).all() and (value <= self.high).all())


def certify(
    arrays: SceneArrays, point: Array, disk_order: int = 2, width: float = 1e-6, most_boxes: int = 20_000
) -> Enclosure:
    """Enclose gloss(P) at the floor point ``point`` (3,), seen from the camera above the floor.

    Stops at ``width``, absolute, in scene units of radiance, or after ``most_boxes``; the enclosure holds in either
    case. Disk lights stand as K x K centroids. Raises OptionError for an exact disk, marble, or a mirror lobe.
    """
    if importlib.util.find_spec("flint") is None:
        raise OptionError("certify: needs python-flint; install symrender[certify]")
    if disk_order == EXACT_DISK:
        raise OptionError("certify: encloses point lights; use disk KxK")
    if (arrays.spheres[:, at.TEXTURE] == at.MARBLE).any():
        raise OptionError("certify: marble is not enclosed")
    if arrays.floor[at.FLOOR_LOBE + 2] == 0.0:
        raise OptionError("certify: a mirror has no lobe to integrate")
    if not arrays.camera[3] > 0.0:
        raise OptionError("certify: the camera must be above the floor")
    return _Point(arrays, point, disk_order).enclose(width, most_boxes)


class _Point:
    """The numbers of one floor point as balls."""

    def __init__(self, arrays: SceneArrays, point: Array, disk_order: int) -> None:
        from flint import arb

        self.a = arrays
        self.p = [arb(x) for x in point.tolist()]
        eye = [arb(x) for x in arrays.camera[1:4].tolist()]
        d = _unit([p - e for p, e in zip(self.p, eye, strict=True)])
        self.m = [d[0], d[1], -d[2]]
        self.eye = eye
        n = arb(float(arrays.floor[at.FLOOR_LOBE + 1]))
        theta = float(arrays.floor[at.FLOOR_LOBE + 2])
        self.n = n
        self.rim = arb(theta).cos() if theta < math.pi / 2 else arb(0)
        self.total = 2 * arb.pi() * (1 - (self.rim.log() * (n + 1)).exp() if theta < math.pi / 2 else arb(1)) / (n + 1)
        # in BRDF units the floor's cosine stands inside, and the normaliser is that of the whole lobe
        self.brdf = is_brdf(arrays)
        if self.brdf:
            self.total = 2 * arb.pi() / (n + 2)
        rows = light_rows(arrays, disk_order)
        self.lights = [([arb(x) for x in row[:3].tolist()], row[3:6].tolist()) for row in rows]
        most = arrays.shading[0] * arrays.shading[7:10] + rows[:, 3:6].sum(axis=0) * arrays.shading[1:3].sum()
        self.most = [arb(float(x)) * (1 + arb(2) ** -40) for x in most]
        self.balls = [([arb(x) for x in s[:3].tolist()], arb(float(s[3]))) for s in arrays.spheres]

    def enclose(self, width: float, most_boxes: int) -> Enclosure:
        from flint import arb

        charts = [_Chart(self, j) for j in range(len(self.balls))]
        serial = itertools.count()
        heap: list[Any] = []
        for chart in charts:
            for k in range(8):
                box = (k / 8, (k + 1) / 8, 0.0, 1.0)
                self._push(heap, serial, chart, box)
        boxes, settled = len(heap), False
        for step in itertools.count():
            # the sum of all radii is asked now and then only
            if step % 256 == 0:
                settled = sum(-entry[0] for entry in heap) <= 0.5 * width
            if settled or boxes >= most_boxes or not heap:
                break
            _, _, chart, box, _ = heapq.heappop(heap)
            a, b, c, d = box
            if (b - a) * 2.0 * chart.turn > (d - c) * 1.5:
                middle = 0.5 * (a + b)
                halves = ((a, middle, c, d), (middle, b, c, d))
            else:
                middle = 0.5 * (c + d)
                halves = ((a, b, c, middle), (a, b, middle, d))
            for half in halves:
                self._push(heap, serial, chart, half)
            boxes += 2
        sums = [arb(0)] * 3
        for entry in heap:
            sums = [x + y for x, y in zip(sums, entry[4], strict=True)]
        share = self._share() if (self.a.shading[10:13] > 0).any() else arb(1)
        sums = [x + arb(float(b)) * share for x, b in zip(sums, self.a.shading[10:13], strict=True)]
        low, high = np.array([_down(x) for x in sums]), np.array([_up(x) for x in sums])
        return Enclosure(low, high, boxes)

    def _push(self, heap: list[Any], serial: Any, chart: _Chart, box: tuple[float, float, float, float]) -> None:
        value = chart.contribution(box)
        if value is not None:
            loose = max(float(x.rad()) for x in value)
            heapq.heappush(heap, (-loose, next(serial), chart, box, value))

    def _share(self) -> Any:
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


class _Chart:
    """One sphere seen from the point."""

    def __init__(self, of: _Point, j: int) -> None:
        from flint import arb

        self.of, self.j = of, j
        center, self.r = of.balls[j]
        self.center = center
        away = [c - p for c, p in zip(center, of.p, strict=True)]
        dist = _dot(away, away).sqrt()
        self.k = self.r / dist
        self.pole = [x / dist for x in away]
        side = arb(1), arb(0), arb(0)
        if abs(float(self.pole[0].mid())) > 0.6:
            side = arb(0), arb(1), arb(0)
        self.e1 = _unit(_cross(self.pole, list(side)))
        self.e2 = _cross(self.pole, self.e1)
        self.turn = 3.0

    def place(self, phi: Any, psi: Any) -> tuple[list[Any], list[Any], list[Any], Any]:
        """Direction, normal, hit point and solid angle per dphi dpsi."""
        sp, cp = psi.sin(), psi.cos()
        sb = self.k * sp
        cb = (1 - sb * sb).sqrt()
        cg, sg = cp * cb + sp * sb, sp * cb - cp * sb
        c, s = phi.cos(), phi.sin()
        e = [c * x + s * y for x, y in zip(self.e1, self.e2, strict=True)]
        w = [cb * x + sb * y for x, y in zip(self.pole, e, strict=True)]
        normal = [sg * y - cg * x for x, y in zip(self.pole, e, strict=True)]
        q = [x + self.r * y for x, y in zip(self.center, normal, strict=True)]
        return w, normal, q, self.k * self.k * sp * cp / cb

    def contribution(self, box: tuple[float, float, float, float]) -> list[Any] | None:
        """Balls (3,) around the box's part of the integral, None where that is zero; the background is subtracted."""
        from flint import arb

        turn, quarter = 2 * arb.pi(), arb.pi() / 2
        phi = turn * arb(box[0]).union(arb(box[1]))
        psi = quarter * arb(box[2]).union(arb(box[3]))
        area = turn * (box[1] - box[0]) * quarter * (box[3] - box[2])
        w, normal, q, measure = self.place(phi, psi)
        toward = _dot(w, self.of.m)
        if toward <= self.of.rim or w[2] <= 0 or q[2] <= 0:
            return None
        inside = True if toward > self.of.rim and w[2] > 0 and q[2] > 0 else None
        for h, (center, radius) in enumerate(self.of.balls):
            if h != self.j and inside is not False:
                met = _blocked(self.of.p, [x - p for x, p in zip(q, self.of.p, strict=True)], center, radius)
                inside = False if met else (inside if met is False else None)
        if inside is False:
            return None
        label = self._label(normal, q)
        if not measure.is_finite():
            measure = arb(0).union(self.k * self.k / (1 - self.k * self.k).sqrt())
        cosine = toward.max(arb(0)).min(arb(1))
        density = (cosine.upper().log() * self.of.n).exp() if cosine.upper() > 0 else arb(0)
        floor = (cosine.lower().log() * self.of.n).exp() if inside and cosine.lower() > 0 else arb(0)
        if self.of.brdf:
            up = w[2].max(arb(0)).min(arb(1))
            density, floor = density * up.upper(), floor * up.lower()
        most = (area * measure.upper() * density / self.of.total).upper()
        least = (area * measure.max(arb(0)).lower() * floor / self.of.total).lower()
        mass = least.union(most)
        rough = []
        sky = [arb(float(b)) for b in self.of.a.shading[10:13]]
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

    def _label(self, normal: list[Any], q: list[Any]) -> tuple[Any, ...]:
        """Whether the texture is bright, then of each light 0 dark, 1 behind the terminator, 2 lit; None undecided."""
        of = self.of
        opened = of.a.shading[6] == at.OPEN and of.a.shading[2] > 0
        states: list[int | None] = []
        for light, _ in of.lights:
            to = [x - y for x, y in zip(light, q, strict=True)]
            cosine = _dot(to, normal)
            apart = _dot(own := [x - y for x, y in zip(light, self.center, strict=True)], own) - self.r * self.r
            if light[2] < 0 or apart < 0 or (cosine <= 0 and not opened):
                states.append(0)
                continue
            state: int | None = 2 if cosine > 0 else (1 if cosine <= 0 and apart >= 0 else None)
            for h, (center, radius) in enumerate(of.balls):
                if h != self.j and state != 0:
                    met = _blocked(q, to, center, radius)
                    state = 0 if met else (state if met is False else None)
            states.append(state)
        return (self._bright(normal), *states)

    def _bright(self, normal: list[Any]) -> bool | None:
        """Whether a box lies on the bright side of its sphere's texture; None where it lies on both."""
        from flint import arb

        s = self.of.a.spheres[self.j]
        if s[at.TEXTURE] == at.SOLID:
            return True
        u = arb.atan2(normal[1], normal[0]) / (2 * arb.pi()) + 0.5
        sign = (u * float(s[at.KU])).sin_pi()
        if s[at.TEXTURE] == at.CHECKER:
            v = normal[2].max(arb(-1)).min(arb(1)).acos() / arb.pi()
            sign = sign * (v * float(s[at.KV])).sin_pi()
        return True if sign >= 0 else (False if sign < 0 else None)

    def radiance(self, phi: Any, psi: Any, label: tuple[Any, ...], *, weighted: bool = True) -> list[Any]:
        """Radiance less background, ``weighted`` by lobe density and measure, at balls or complex balls.

        What is undecided in the label is a ball of all its values; complex balls need a decided one.
        """
        from flint import arb

        of = self.of
        shading = of.a.shading
        w, normal, q, measure = self.place(phi, psi)
        weight = (_dot(w, of.m).log() * of.n).exp() * measure / of.total if weighted else arb(1)
        if self.of.brdf and weighted:
            weight *= w[2]
        view = _unit([e - x for e, x in zip(of.eye, q, strict=True)]) if shading[5] == at.EYE else [-x for x in w]
        s = of.a.spheres[self.j]
        factor = arb(1 if label[0] else float(s[at.DARK]))
        if label[0] is None:
            factor = factor.union(arb(1))
        sums = [shading[0] * shading[7 + c] - shading[10 + c] + 0 * weight for c in range(3)]
        for (light, color), state in zip(of.lights, label[1:], strict=True):
            if state == 0:
                continue
            l = _unit([x - y for x, y in zip(light, q, strict=True)])
            cosine = _dot(l, normal)
            if shading[4] == at.PHONG:
                base = 2 * cosine * _dot(normal, view) - _dot(l, view)
            else:
                base = _dot(_unit([x + y for x, y in zip(l, view, strict=True)]), normal)
            gleam = _highlight(base, float(shading[3]))
            if state is None:
                cosine, gleam = cosine.max(arb(0)).union(arb(0)), gleam.union(arb(0))
            for c in range(3):
                lambert = float(shading[1]) * float(s[at.COLOR + c]) * factor * cosine if state != 1 else 0
                sums[c] = sums[c] + color[c] * (lambert + float(shading[2]) * gleam)
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


def _highlight(base: Any, shininess: float) -> Any:
    """max(0, base)^s where base has one sign on the ball; not finite, or from 0 up, where it has both."""
    from flint import acb, arb

    complex_ball = isinstance(base, acb)
    real = base.real if complex_ball else base
    if real > 0:
        return base ** int(shininess) if shininess.is_integer() else (base.log() * shininess).exp()
    if shininess == 0.0:
        return base * 0 + 1
    if real <= 0:
        return base * 0
    if complex_ball:
        return acb("nan")
    top = real.max(arb(0))
    return arb(0).union(
        top.upper() ** int(shininess) if shininess.is_integer() else (top.upper().log() * shininess).exp()
    )


def _blocked(p: list[Any], d: list[Any], center: list[Any], radius: Any) -> bool | None:
    """Whether the segments from p to p + d meet the ball; None where some may and some may not."""
    f = [x - c for x, c in zip(p, center, strict=True)]
    slope, length2 = _dot(f, d), _dot(d, d)
    inside = _dot(f, f) - radius * radius
    end = [x + y for x, y in zip(f, d, strict=True)]
    ends = _dot(end, end) - radius * radius
    if inside < 0 or ends < 0:
        return True
    if slope >= 0:
        return False if inside > 0 else None
    cross = _cross(f, d)
    apart = _dot(cross, cross) - radius * radius * length2
    if apart > 0:
        return False
    if slope + length2 <= 0:
        return False if ends > 0 else None
    return True if apart < 0 and slope < 0 and slope + length2 > 0 else None


def _dot(a: list[Any], b: list[Any]) -> Any:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def _cross(a: list[Any], b: list[Any]) -> list[Any]:
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def _unit(a: list[Any]) -> list[Any]:
    length = _dot(a, a).sqrt()
    return [x / length for x in a]


def _down(ball: Any) -> float:
    """A double not above the ball."""
    return math.nextafter(float(ball.lower()), -math.inf)


def _up(ball: Any) -> float:
    return math.nextafter(float(ball.upper()), math.inf)
