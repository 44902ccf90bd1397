"""One bounce of the direct light of points, spots and suns, by adaptive rules within adaptive rules: an opinion apart.

Half meridians of the normal are lines, as in ``nested.py``, whose lobes and circles these are. What is met along a
line has a signature: which shape, on which side, which light reaches it, within which of a spot's two cones, on which
field, and on which side of Walter's jump. Wherever the signatures of neighbouring samples differ the place of the
change is found by halving, so that in every piece the integrand is smooth; the edges of fields on planes are found as
whole numbers. Highlights of what is met are looked for along the line by golden section, and across lines at the
directions in which half vectors are normals, by halving an arc. Pieces are then graded about them. It knows no poles,
no charts, no levels of walls and no bounds.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from . import lattice, nested, rough_lattice
from .compile import kernel
from .nested import DEEPEST, GAUSS, KRONROD, NODES, ROUNDED, STACK, Reflected
from .rough_lattice import DIFFUSE, PHONG

Array = npt.NDArray[np.float64]
SAMPLES = 24
"""Samples of a piece of a line whose signatures are compared."""
PATCH = 30.0
"""Heights of a light over a surface within which it lights a patch."""
CUTS = 12_000
FIELDS = 3_000
"""Most edges of fields that a piece of a line is cut at; adaptive halving has the rest."""
CHANGES = 5
"""Most changes of signature looked for between two samples."""
GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)


@kernel
def _signature(q: Array, own: int, d: Array, w: rough_lattice.World) -> int:
    """What decides which smooth formula holds of what is seen in direction ``d``."""
    shapes, lights = w.known.shapes, w.known.lights
    t, j = lattice._hit(q, d, own, shapes)
    if j < 0:
        return -1
    place = q + t * d
    normal = lattice._normal(place, j, shapes)
    value = 2 * j
    if normal @ d > 0.0:
        if shapes[j, 21] == 0.0:
            return -1
        value += 1
        normal = -normal
    m = w.materials[j]
    to = np.empty(3)
    for i in range(lights.shape[0]):
        far = math.inf
        if lights[i, 0] == 1.0:
            to[:] = lights[i, 1:4]
        else:
            to[:] = lights[i, 1:4] - place
            far = math.sqrt(to @ to)
            to /= far
        value *= 8
        cosine = normal @ to
        if cosine <= 0.0:
            continue
        if lights[i, 12] != 0.0:
            along = -(lights[i, 7:10] @ to)
            if along <= math.cos(lights[i, 11]):
                continue
            if along >= math.cos(lights[i, 10]):
                value += 2
        s, _ = lattice._hit(place, to, j, shapes)
        if s < far * (1.0 - lattice.NEAR):
            continue
        value += 1
        if m[9] != 0.0 and cosine > math.cos(math.atan2(1.0, rough_lattice.WALTER * m[1])):
            value += 4
        if m[0] == PHONG and 2.0 * cosine * (-(normal @ d)) + to @ d <= 0.0:
            value += 4
    value *= 4
    if m[9] != 0.0 and -(normal @ d) > math.cos(math.atan2(1.0, rough_lattice.WALTER * m[1])):
        value += 1
    if shapes[j, 20] > 0.0 and shapes[j, 0] == 0.0 and shapes[j, 22] != 2.0:
        x = (math.atan2(normal[1], normal[0]) + math.pi) / math.pi / shapes[j, 20]
        y = math.acos(max(-1.0, min(1.0, normal[2]))) / math.pi / shapes[j, 20]
        value += 2 * ((math.floor(x) + (0 if shapes[j, 22] == 1.0 else math.floor(y))) % 2)
    return value


@kernel
def _toward(t: float, n: Array, e: Array, d: Array) -> None:
    d[:] = math.cos(t) * n + math.sin(t) * e


@kernel
def _fields(q: Array, n: Array, e: Array, a: float, b: float, j: int, shapes: Array, cuts: Array, count: int) -> int:
    """Add the angles between ``a`` and ``b`` at which the plane ``j`` changes its field; the new number of cuts."""
    s = shapes[j]
    if s[0] != 1.0 or s[20] == 0.0 or s[22] == 2.0:
        return count
    # on the plane: place = q + h (cos t n + sin t e) / ((cos t n + sin t e) . N)
    h = (s[1:4] - q) @ s[5:8]
    for axis in range(1 if s[22] == 1.0 else 2):
        x = s[8 + 3 * axis : 11 + 3 * axis]
        at = (q - s[1:4]) @ x
        ends = np.empty(2)
        for k in range(2):
            t = a + (b - a) * 1e-9 if k == 0 else b - (b - a) * 1e-9
            down = math.cos(t) * (n @ s[5:8]) + math.sin(t) * (e @ s[5:8])
            ends[k] = (at + h * (math.cos(t) * (n @ x) + math.sin(t) * (e @ x)) / down) / s[20]
        low, high = math.floor(min(ends[0], ends[1])), math.floor(max(ends[0], ends[1]))
        nearest = math.floor(at / s[20])
        low, high = max(low, nearest - FIELDS // 2), min(high, nearest + FIELDS // 2)
        k = low + 1.0
        while k <= high and count < cuts.shape[0] - 200:
            # (at - k cell) (c n.N + s e.N) + h (c n.x + s e.x) = 0
            off = at - k * s[20]
            along, aside = off * (n @ s[5:8]) + h * (n @ x), off * (e @ s[5:8]) + h * (e @ x)
            t = math.atan2(-along, aside)
            if t < 0.0:
                t += math.pi
            if a < t < b:
                cuts[count] = t
                count += 1
            k += 1.0
    return count


@kernel
def _changes(
    q: Array, n: Array, e: Array, own: int, a: float, b: float, w: rough_lattice.World, cuts: Array, count: int
) -> int:
    """Add the angles between ``a`` and ``b`` at which the signature changes; the new number of cuts."""
    d = np.empty(3)
    last = a + (b - a) * 1e-7
    _toward(last, n, e, d)
    before = _signature(q, own, d, w)
    for k in range(1, SAMPLES + 1):
        at = a + (b - a) * (1e-7 + (1.0 - 2e-7) * k / SAMPLES)
        _toward(at, n, e, d)
        after = _signature(q, own, d, w)
        tries = 0
        while before != after and tries < CHANGES and count < cuts.shape[0] - 100:
            tries += 1
            low, high, beyond = last, at, after
            while high - low > 1e-16 + 4e-16 * abs(high):
                middle = 0.5 * (low + high)
                if middle <= low or middle >= high:
                    break
                _toward(middle, n, e, d)
                now = _signature(q, own, d, w)
                if now == before:
                    low = middle
                else:
                    high, beyond = middle, now
            cuts[count] = high
            count += 1
            last, before = high, beyond
        last, before = at, after
    return count


@kernel
def _near(q: Array, own: int, d: Array, i: int, w: rough_lattice.World) -> tuple[float, float]:
    """How near what is seen in direction ``d`` is to the highlight of light ``i``, a cosine, and the lobe's width."""
    shapes = w.known.shapes
    t, j = lattice._hit(q, d, own, shapes)
    if j < 0 or w.materials[j, 0] == DIFFUSE:
        return -2.0, 1.0
    place = q + t * d
    normal = lattice._normal(place, j, shapes)
    if normal @ d > 0.0:
        normal = -normal
    light = w.known.lights[i]
    to = light[1:4].copy() if light[0] == 1.0 else light[1:4] - place
    to /= math.sqrt(to @ to)
    if w.materials[j, 0] == PHONG:
        return 2.0 * (normal @ to) * -(normal @ d) + to @ d, 1.0 / math.sqrt(w.materials[j, 1] + 1.0)
    h = to - d
    return (h @ normal) / math.sqrt(max(1e-300, h @ h)), w.materials[j, 1]


@kernel
def _glints(
    q: Array, n: Array, e: Array, own: int, a: float, b: float, w: rough_lattice.World, cuts: Array, count: int
) -> int:
    """Add angles, in geometric steps, about the brightest place of every highlight between ``a`` and ``b``."""
    d = np.empty(3)
    for i in range(w.known.lights.shape[0]):
        best, where, width = -2.0, 0, 1.0
        for k in range(SAMPLES):
            _toward(a + (b - a) * (k + 0.5) / SAMPLES, n, e, d)
            near, wide = _near(q, own, d, i, w)
            if near > best:
                best, where, width = near, k, wide
        if best < -1.5:
            continue
        low, high = a + (b - a) * max(0.0, (where - 0.5) / SAMPLES), a + (b - a) * min(1.0, (where + 1.5) / SAMPLES)
        for _ in range(34):
            one, other = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
            _toward(one, n, e, d)
            first, _ = _near(q, own, d, i, w)
            _toward(other, n, e, d)
            second, _ = _near(q, own, d, i, w)
            if first > second:
                high = other
            else:
                low = one
        middle, step = 0.5 * (low + high), 0.02 * width * (b - a)
        if a < middle < b:
            cuts[count] = middle
            count += 1
        while step < b - a and count < cuts.shape[0] - 8:
            for t in (middle - step, middle + step):
                if a < t < b:
                    cuts[count] = t
                    count += 1
            step *= 3.0
    return count


@kernel
def _foot(light: Array, s: Array) -> tuple[Array, float]:
    """The place of a shape's surface that is nearest to a light, and how far they are apart."""
    if s[0] == 1.0:
        high = (light[1:4] - s[1:4]) @ s[5:8]
        return light[1:4] - high * s[5:8], abs(high)
    b = light[1:4] - s[1:4]
    far = math.sqrt(b @ b)
    return s[1:4] + (s[4] / max(far, 1e-300)) * b, abs(far - s[4])


@kernel
def _patches(q: Array, n: Array, e: Array, own: int, w: rough_lattice.World, more: Array, count: int) -> int:
    """Cut a meridian, in geometric steps, where it passes the patch that a light lights close by; the new number."""
    shapes, aside = w.known.shapes, np.cross(n, e)
    for j in range(shapes.shape[0]):
        for i in range(w.known.lights.shape[0]):
            light = w.known.lights[i]
            if j == own or light[0] == 1.0:
                continue
            foot, high = _foot(light, shapes[j])
            d = foot - q
            far = math.sqrt(d @ d)
            if high > 0.1 * far or abs(d @ aside) > PATCH * high or d @ e <= 0.0:
                continue
            middle, step = math.atan2(d @ e, d @ n), 0.25 * max(1e-6, high / far)
            while step < 0.5 and count + 2 < more.shape[0]:
                for t in (middle - step, middle + step):
                    if 0.0 < t < 0.5 * math.pi:
                        more[count] = t
                        count += 1
                step *= 2.0
    return count


@kernel
def _line(
    phi: float, q: Array, n: Array, x: Array, y: Array, own: int, seen: Array, w: nested.World, tol: float,
    cuts: Array, more: Array, stack: Array, out: Array,
) -> tuple[float, int]:  # fmt: skip
    """Integral along the meridian at azimuth ``phi`` from the mirror direction's; its error and what it cost."""
    known = w.known
    shapes = known.known.shapes
    m = known.materials[own]
    cos_view = seen @ n
    sin_view = math.sqrt(max(0.0, 1.0 - cos_view * cos_view))
    cosine = math.cos(phi)
    e = cosine * x + math.sin(phi) * y
    some = nested._cuts(q, n, e, own, m, cosine, cos_view, sin_view, w, cuts)
    d, count = np.empty(3), 0
    for k in range(some):
        more[count] = cuts[k]
        count += 1
    for k in range(some - 1):
        a, b = cuts[k], cuts[k + 1]
        if not b - a > 1e-14:
            continue
        _toward(0.5 * (a + b), n, e, d)
        _, j = lattice._hit(q, d, own, shapes)
        if j < 0:
            continue
        first = count
        count = _fields(q, n, e, a, b, j, shapes, more, count)
        if count - first < 200:
            count = _changes(q, n, e, own, a, b, known, more, count)
        else:
            # shadows and cones between many edges: a scan of each field
            more[first:count].sort()
            last, stop = a, count
            for i in range(first, stop + 1):
                at = more[i] if i < stop else b
                if at - last > 1e-14 and i - first < 400:
                    count = _changes(q, n, e, own, last, at, known, more, count)
                last = at
        if known.materials[j, 0] != DIFFUSE:
            count = _glints(q, n, e, own, a, b, known, more, count)
    count = _patches(q, n, e, own, known, more, count)
    more[:count].sort()
    out[:] = 0.0
    error, cost = 0.0, 0
    f, light = np.empty(3), np.empty(3)
    full, half = np.empty(3), np.empty(3)
    for k in range(count - 1):
        if not more[k + 1] - more[k] > 1e-15:
            continue
        stack[0, 0], stack[0, 1], stack[0, 2] = more[k], more[k + 1], 0.0
        top = 1
        while top > 0:
            top -= 1
            a, b, deep = stack[top, 0], stack[top, 1], stack[top, 2]
            full[:], half[:] = 0.0, 0.0
            for i in range(15):
                node = NODES[i] if i < 8 else -NODES[14 - i]
                at = i if i < 8 else 14 - i
                t = 0.5 * (a + b) + 0.5 * (b - a) * node
                c, s = math.cos(t), math.sin(t)
                d[:] = c * n + s * e
                _seen(q, own, d, w, light)
                if max(light[0], light[1], light[2]) == 0.0:
                    continue
                rough_lattice._scattered(m, n, seen, d, f)
                for ch in range(3):
                    v = 0.5 * (b - a) * f[ch] * light[ch] * c * s
                    full[ch] += KRONROD[at] * v
                    if at % 2 == 1:
                        half[ch] += GAUSS[at // 2] * v
            cost += 15
            off = max(abs(full[0] - half[0]), abs(full[1] - half[1]), abs(full[2] - half[2]))
            size = max(abs(full[0]), abs(full[1]), abs(full[2]))
            if off > max(tol, ROUNDED * size) and deep < DEEPEST and top + 2 < STACK:
                stack[top, 0], stack[top, 1], stack[top, 2] = a, 0.5 * (a + b), deep + 1
                stack[top + 1, 0], stack[top + 1, 1], stack[top + 1, 2] = 0.5 * (a + b), b, deep + 1
                top += 2
                continue
            out += full
            error += off
    return error, cost


@kernel
def _seen(q: Array, own: int, d: Array, w: nested.World, out: Array) -> None:
    """Radiance that a place of ``own`` sees in direction ``d``: direct light of points, reflected there."""
    shapes = w.known.known.shapes
    t, j = lattice._hit(q, d, own, shapes)
    out[:] = 0.0
    if j < 0:
        return
    place = q + t * d
    normal = lattice._normal(place, j, shapes)
    shade = np.empty(3)
    lattice._albedo(place, normal, j, shapes, shade)
    if normal @ d > 0.0:
        if shapes[j, 21] == 0.0:
            return
        normal = -normal
    rough_lattice._direct(place, normal, j, -d, w.known, out)
    out *= shade


@kernel
def _about(phi: float, step: float, growth: float, ends: Array, count: int) -> int:
    """Add an azimuth and, on both sides of it, steps that grow by a factor; the new number."""
    ends[count] = phi
    count += 1
    while step < 1.0 and count < ends.shape[0] - 60:
        ends[count], ends[count + 1] = phi - step, phi + step
        count += 2
        step *= growth
    return count


@kernel
def _mirrors(q: Array, own: int, n: Array, x: Array, y: Array, w: rough_lattice.World, ends: Array, count: int) -> int:
    """Add azimuths, in geometric steps, about where shapes mirror lights and where they are close; the new number."""
    shapes = w.known.shapes
    for j in range(shapes.shape[0]):
        s = shapes[j]
        if j == own:
            continue
        for i in range(w.known.lights.shape[0]):
            light = w.known.lights[i]
            sun = light[0] == 1.0
            if s[0] == 1.0:
                normal = s[5:8]
                side = 1.0 if (q - s[1:4]) @ normal > 0.0 else -1.0
                if sun:
                    d = -light[1:4] + 2.0 * (light[1:4] @ normal) * normal
                else:
                    image = light[1:4] - 2.0 * ((light[1:4] - s[1:4]) @ normal) * normal
                    d = image - q
                if side * (d @ normal) >= 0.0:
                    continue
            else:
                a = q - s[1:4]
                a /= math.sqrt(a @ a)
                b = light[1:4].copy() if sun else light[1:4] - s[1:4]
                b /= math.sqrt(b @ b)
                low, high = 0.0, 1.0
                foot = a.copy()
                for _ in range(50):
                    share = 0.5 * (low + high)
                    middle = (1.0 - share) * a + share * b
                    middle /= max(1e-300, math.sqrt(middle @ middle))
                    foot = s[1:4] + s[4] * middle
                    v = q - foot
                    v /= math.sqrt(v @ v)
                    to = light[1:4].copy() if sun else light[1:4] - foot
                    to /= max(1e-300, math.sqrt(to @ to))
                    if middle @ v > middle @ to:
                        low = share
                    else:
                        high = share
                d = foot - q
            phi = math.atan2(d @ y, d @ x)
            width = 1.0 if w.materials[j, 0] == DIFFUSE else nested._width(w.materials[j])
            count = _about(phi, 1e-3 * width, 4.0, ends, count)
            if sun:
                continue
            # a light close by a shape lights a patch about its foot
            foot, high = _foot(light, s)
            d = foot - q
            phi = math.atan2(d @ y, d @ x)
            count = _about(phi, 0.1 * max(1e-6, high / math.sqrt(d @ d)), 2.0, ends, count)
    for k in range(count):
        ends[k] -= 2.0 * math.pi * math.floor((ends[k] + math.pi) / (2.0 * math.pi))
    return count


@kernel
def _whole(
    q: Array, n: Array, own: int, seen: Array, w: nested.World, tol: float, budget: int, total: Array
) -> tuple[float, int]:
    """Integral over the hemisphere; its error and what it cost."""
    m = w.known.materials[own]
    cos_view = seen @ n
    x = cos_view * n - seen
    size = math.sqrt(x @ x)
    if size < 1e-9:
        x, _ = rough_lattice._frame(n)
    else:
        x /= size
    y = np.cross(n, x)
    cuts, ends, rows = np.empty(400), np.empty(4000), np.empty((w.known.materials.shape[0] + 6, 4))
    more = np.empty(CUTS)
    inner, outer = np.empty((STACK, 3)), np.empty((STACK, 3))
    ends[0] = 0.0
    count = nested._ends(rows, nested._circles(q, n, own, seen, w, rows), n, x, y, ends, 1)
    count = _mirrors(q, own, n, x, y, w.known, ends, count)
    ends[count], ends[count + 1] = -math.pi, math.pi
    count += 2
    step = 0.5 * nested._width(m) * max(1e-6, cos_view) / max(size, nested._width(m))
    while step < math.pi:
        ends[count], ends[count + 1] = step, -step
        count += 2
        step *= 2.0
    ends[:count].sort()
    total[:] = 0.0
    full, half, line = np.empty(3), np.empty(3), np.empty(3)
    error, cost = 0.0, 0
    for k in range(count - 1):
        if not ends[k + 1] - ends[k] > 1e-15:
            continue
        outer[0, 0], outer[0, 1], outer[0, 2] = ends[k], ends[k + 1], 0.0
        top = 1
        while top > 0:
            top -= 1
            a, b, deep = outer[top, 0], outer[top, 1], outer[top, 2]
            full[:], half[:] = 0.0, 0.0
            missed = 0.0
            for i in range(15):
                node = NODES[i] if i < 8 else -NODES[14 - i]
                at = i if i < 8 else 14 - i
                phi = 0.5 * (a + b) + 0.5 * (b - a) * node
                off, spent = _line(phi, q, n, x, y, own, seen, w, tol, cuts, more, inner, line)
                missed += 0.5 * (b - a) * KRONROD[at] * off
                cost += spent
                for ch in range(3):
                    v = 0.5 * (b - a) * line[ch]
                    full[ch] += KRONROD[at] * v
                    if at % 2 == 1:
                        half[ch] += GAUSS[at // 2] * v
            off = max(abs(full[0] - half[0]), abs(full[1] - half[1]), abs(full[2] - half[2]))
            most = max(abs(full[0]), abs(full[1]), abs(full[2]))
            if off > max(tol, ROUNDED * most) and deep < DEEPEST and top + 2 < STACK and cost < budget:
                outer[top, 0], outer[top, 1], outer[top, 2] = a, 0.5 * (a + b), deep + 1
                outer[top + 1, 0], outer[top + 1, 1], outer[top + 1, 2] = 0.5 * (a + b), b, deep + 1
                top += 2
                continue
            total += full
            error += off + missed
    return error, cost


def reflected(w: nested.World, origin: Array, direction: Array, tol: float, budget: int) -> Reflected:
    """What the place that a ray meets reflects, once, of the direct light of points, spots and suns elsewhere.

    ``tol`` is of every piece, not of the whole; after ``budget`` looks along lines no piece across lines is halved
    again. What comes of both is told.
    """
    d: Any = np.asarray(direction, float) / np.linalg.norm(direction)
    shapes = w.known.known.shapes
    t, j = lattice._hit(np.asarray(origin, float), d, -1, shapes)
    if j < 0:
        return Reflected(j, np.zeros(3), math.inf, 0)
    q = origin + t * d
    n, shade = lattice._normal(q, j, shapes), np.empty(3)
    lattice._albedo(q, n, j, shapes, shade)
    if n @ d > 0.0:
        if shapes[j, 21] == 0.0:
            return Reflected(j, np.zeros(3), 0.0, 0)
        n = -n
    total = np.zeros(3)
    error, cost = _whole(q, n, j, -d, w, tol, budget, total)
    return Reflected(j, shade * total, float(error * shade.max()), cost)
