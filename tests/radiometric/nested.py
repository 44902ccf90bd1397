"""What a rough place reflects of skies and lamps, by rules within rules over angles about its normal: an opinion apart.

Lines are half meridians of the normal. Each is cut where it meets outlines of balls and horizons of planes, so that
under skies and lamps what it sees is constant in every piece, told by one traced ray; then, in geometric steps, about
where it comes nearest the peak of the lobe. Kronrod's rule of 15 nodes is halved until it agrees with Gauss's of 7,
along lines and across them; what both differ by is added up and told. The first lines across stand where circles of
directions cross or touch lines, for a corner between the nodes of a rule would be seen by none. Shapes, lights and
materials are those of ``rough_lattice.py``. It knows no poles, no coefficients, no bounds and no walls across lines.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from . import lattice, rough_lattice
from .compile import kernel
from .rough_lattice import BECKMANN, DIFFUSE, GGX, PHONG

Array = npt.NDArray[np.float64]
NODES = np.array([
    0.9914553711208126, 0.9491079123427585, 0.8648644233597691, 0.7415311855993945, 0.5860872354676911,
    0.4058451513773972, 0.2077849550078985, 0.0])  # fmt: skip
KRONROD = np.array([
    0.0229353220105292, 0.0630920926299786, 0.1047900103222502, 0.1406532597155259, 0.1690047266392679,
    0.1903505780647854, 0.2044329400752989, 0.2094821410847278])  # fmt: skip
GAUSS = np.array([0.1294849661688697, 0.2797053914892767, 0.3818300505051189, 0.4179591836734694])
"""Positive nodes of Kronrod's rule, their weights, and those of Gauss's rule on every second of them."""
STACK = 4000
DEEPEST = 46
"""Most halvings of a piece."""
BUDGET = 60_000_000
NEAR_NORMAL = 0.3
"""Angle to the normal up to which lines stand closer, in geometric steps, where a circle passes it."""
ROUNDED = 4e-14


class World(NamedTuple):
    """Shapes and lights as of ``rough_lattice``, what shapes emit (S, 3), and the sky (3,)."""

    known: rough_lattice.World
    emitted: Array
    sky: Array


class Reflected(NamedTuple):
    """The shape met, -1 for none, the light that it reflects of what it sees, how far off it may be, and the cost."""

    shape: int
    light: Array
    error: float
    evaluations: int


def aside(normal: Any) -> list[float]:
    """Some direction that is not this one."""
    return [float(k == int(np.argmin(np.abs(normal)))) for k in range(3)]


def world(scene: dict[str, Any]) -> World:
    """The numbers of a scene as written; what of it is not written is as it is by default."""
    materials = {name: {"reflectance": 1.0} | material for name, material in scene["materials"].items()}
    shapes = [
        shape if "normal" not in shape else {"along": aside(shape["normal"])} | shape for shape in scene["shapes"]
    ]
    scene = scene | {"materials": materials, "shapes": shapes}
    apart = [light for light in scene["lights"] if light["type"] in ("sky", "area")]
    known = rough_lattice.world(scene | {"lights": [light for light in scene["lights"] if light not in apart]})
    names = [shape["name"] for shape in scene["shapes"]]
    emitted, sky = np.zeros((len(names), 3)), np.zeros(3)
    for light in apart:
        if light["type"] == "sky":
            sky[:] = light["radiance"]
        else:
            emitted[names.index(light["shape"])] = light["radiance"]
    return World(known, emitted, sky)


@kernel
def _seen(q: Array, own: int, d: Array, w: World, out: Array) -> None:
    """Radiance that is sent to a place of ``own`` from direction ``d``."""
    _, j = lattice._hit(q, d, own, w.known.known.shapes)
    if j < 0:
        out[:] = w.sky
    else:
        out[:] = w.emitted[j]


@kernel
def _peak(cosine: float, m: Array, cos_view: float, sin_view: float) -> float:
    """Angle to the normal at which a meridian, of this cosine to that of the mirror direction, is nearest the peak."""
    if m[0] == PHONG or m[0] == DIFFUSE:
        return min(0.5 * math.pi, max(0.0, math.atan2(sin_view * cosine, cos_view)))
    low, high = 0.0, 0.5 * math.pi
    share = 0.5 * (math.sqrt(5.0) - 1.0)
    for _ in range(44):
        one, other = high - share * (high - low), low + share * (high - low)
        a = (math.cos(one) + cos_view) ** 2 / max(
            1e-300, 2.0 + 2.0 * (math.cos(one) * cos_view - math.sin(one) * sin_view * cosine)
        )
        b = (math.cos(other) + cos_view) ** 2 / max(
            1e-300, 2.0 + 2.0 * (math.cos(other) * cos_view - math.sin(other) * sin_view * cosine)
        )
        if a > b:
            high = other
        else:
            low = one
    return 0.5 * (low + high)


@kernel
def _width(m: Array) -> float:
    if m[0] == DIFFUSE:
        return 1.0
    return 1.0 / math.sqrt(m[1] + 1.0) if m[0] == PHONG else m[1]


@kernel
def _cuts(
    q: Array, n: Array, e: Array, own: int, m: Array, cosine: float, cos_view: float, sin_view: float, w: World,
    cuts: Array,
) -> int:  # fmt: skip
    """Angles at which the meridian towards ``e`` is cut; their number."""
    shapes = w.known.known.shapes
    cuts[0], cuts[1] = 0.0, 0.5 * math.pi
    count = 2
    for j in range(shapes.shape[0]):
        if j == own:
            continue
        s = shapes[j]
        if s[0] == 1.0:
            a, b, level, sine = n @ s[5:8], e @ s[5:8], 0.0, 1.0
        else:
            c = s[1:4] - q
            far2 = c @ c
            a, b, level = n @ c, e @ c, math.sqrt(max(0.0, far2 - s[4] ** 2))
            # the arc cosine of level over size knows half of the digits of a small ball's width
            across = np.cross(n, e) @ c
            sine = math.sqrt(max(0.0, (s[4] - across) * (s[4] + across)))
        if sine == 0.0 or math.hypot(a, b) == 0.0:
            continue
        middle, half = math.atan2(b, a), math.atan2(sine, level)
        for t in (middle - half, middle + half, middle + half - 2.0 * math.pi, middle - half + 2.0 * math.pi):
            if 0.0 < t < 0.5 * math.pi and count < cuts.shape[0] - 80:
                cuts[count] = t
                count += 1
    for ch in range(3):
        if m[0] in (GGX, BECKMANN) and m[6 + ch] == 0.0 and m[3 + ch] < 1.0:
            # from its critical angle on a dielectric reflects all
            a, b, level = cos_view, -sin_view * cosine, 1.0 - 2.0 * m[3 + ch] ** 2
            size = math.hypot(a, b)
            if size > abs(level):
                middle, half = math.atan2(b, a), math.acos(level / size)
                for t in (middle - half, middle + half, middle + half - 2.0 * math.pi, middle - half + 2.0 * math.pi):
                    if 0.0 < t < 0.5 * math.pi:
                        cuts[count] = t
                        count += 1
    middle, step = _peak(cosine, m, cos_view, sin_view), 0.5 * _width(m)
    if 0.0 < middle < 0.5 * math.pi:
        cuts[count] = middle
        count += 1
    while step < 0.5 * math.pi and count < cuts.shape[0] - 8:
        for t in (middle - step, middle + step):
            if 0.0 < t < 0.5 * math.pi:
                cuts[count] = t
                count += 1
        step *= 2.0
    if m[0] == PHONG:
        # where it ends
        t = math.atan2(sin_view * cosine, cos_view) + 0.5 * math.pi
        if 0.0 < t < 0.5 * math.pi:
            cuts[count] = t
            count += 1
    if m[9] != 0.0:
        cuts[count] = math.atan2(1.0, rough_lattice.WALTER * m[1])
        count += 1
    cuts[:count].sort()
    return count


@kernel
def _circles(q: Array, n: Array, own: int, seen: Array, w: World, rows: Array) -> int:
    """Rows (axis, level) of the circles of directions on which what is seen, or the lobe, is cut; their number."""
    m, shapes = w.known.materials[own], w.known.known.shapes
    rows[0, :3], rows[0, 3] = n, 0.0
    rows[1, :3], rows[1, 3] = 2.0 * (seen @ n) * n - seen, 0.0
    count = 2 if m[0] == PHONG else 1
    if m[9] != 0.0:
        rows[count, :3], rows[count, 3] = n, math.cos(math.atan2(1.0, rough_lattice.WALTER * m[1]))
        count += 1
    for a in range(3):
        if m[0] in (GGX, BECKMANN) and m[6 + a] == 0.0 and m[3 + a] < 1.0:
            rows[count, :3], rows[count, 3] = seen, 1.0 - 2.0 * m[3 + a] ** 2
            count += 1
    for j in range(shapes.shape[0]):
        s = shapes[j]
        if j == own:
            continue
        if s[0] == 1.0:
            rows[count, :3], rows[count, 3] = s[5:8], 0.0
        else:
            c = s[1:4] - q
            far = math.sqrt(c @ c)
            if far <= s[4]:
                continue
            rows[count, :3], rows[count, 3] = c / far, math.sqrt((far - s[4]) * (far + s[4])) / far
        count += 1
    return count


@kernel
def _ends(rows: Array, many: int, n: Array, x: Array, y: Array, ends: Array, count: int) -> int:
    """Add azimuths at which circles cross each other, and are tangent to meridians; the new number."""
    for i in range(many):
        a, p = rows[i, :3], rows[i, 3]
        # tangent meridians, of which a circle about the normal has none
        across = math.hypot(a @ x, a @ y)
        ratio = math.sqrt(max(0.0, 1.0 - p * p)) / max(across, 1e-300)
        if ratio < 1.0:
            for side in (-1.0, 1.0):
                for turn in (0.0, math.pi):
                    ends[count] = math.atan2(a @ y, a @ x) + side * math.asin(ratio) + turn
                    count += 1
        # close by the normal a circle is all but a meridian, and crosses the others within as little
        near = abs(math.atan2(across, a @ n) - math.acos(max(-1.0, min(1.0, p))))
        step = 0.25 * max(1e-9, near)
        while near < NEAR_NORMAL and across > 0.0 and step < 1.0 and count < ends.shape[0] - 200:
            for side in (-1.0, 1.0):
                for turn in (-0.5 * math.pi, 0.5 * math.pi):
                    ends[count] = math.atan2(a @ y, a @ x) + side * step + turn
                    count += 1
            step *= 2.0
        for j in range(i):
            b, r = rows[j, :3], rows[j, 3]
            along = a @ b
            cross = np.cross(a, b)
            sine2 = cross @ cross
            if sine2 < 1e-24:
                continue
            one, other = (p - r * along) / sine2, (r - p * along) / sine2
            rest = 1.0 - (one * p + other * r)
            if rest < 0.0:
                continue
            for side in (-1.0, 1.0):
                v = one * a + other * b + side * math.sqrt(rest / sine2) * cross
                ends[count] = math.atan2(v @ y, v @ x)
                count += 1
    for k in range(count):
        ends[k] -= 2.0 * math.pi * math.floor((ends[k] + math.pi) / (2.0 * math.pi))
    return count


@kernel
def _line(
    phi: float, q: Array, n: Array, x: Array, y: Array, own: int, seen: Array, w: World, tol: float,
    cuts: Array, stack: Array, out: Array,
) -> tuple[float, int]:  # fmt: skip
    """Integral along the meridian at azimuth ``phi`` from the mirror direction's; its error and what it cost."""
    m = w.known.materials[own]
    cos_view = seen @ n
    sin_view = math.sqrt(max(0.0, 1.0 - cos_view * cos_view))
    cosine = math.cos(phi)
    e = cosine * x + math.sin(phi) * y
    count = _cuts(q, n, e, own, m, cosine, cos_view, sin_view, w, cuts)
    out[:] = 0.0
    error, cost = 0.0, 0
    f, light, d = np.empty(3), np.ones(3), np.empty(3)
    full, half = np.empty(3), np.empty(3)
    for k in range(count - 1):
        if not cuts[k + 1] - cuts[k] > 1e-15:
            continue
        middle = 0.5 * (cuts[k] + cuts[k + 1])
        d[:] = math.cos(middle) * n + math.sin(middle) * e
        _seen(q, own, d, w, light)
        if max(light[0], light[1], light[2]) == 0.0:
            continue
        stack[0, 0], stack[0, 1], stack[0, 2] = cuts[k], cuts[k + 1], 0.0
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
def _whole(q: Array, n: Array, own: int, seen: Array, w: World, tol: float, total: Array) -> tuple[float, int]:
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
    cuts, ends, rows = np.empty(400), np.empty(2000), np.empty((w.known.materials.shape[0] + 6, 4))
    inner, outer = np.empty((STACK, 3)), np.empty((STACK, 3))
    ends[0] = 0.0
    count = _ends(rows, _circles(q, n, own, seen, w, rows), n, x, y, ends, 1)
    ends[count], ends[count + 1] = -math.pi, math.pi
    count += 2
    step = 0.5 * _width(m) * max(1e-6, cos_view) / max(size, _width(m))
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
                off, spent = _line(phi, q, n, x, y, own, seen, w, tol / (b - a), cuts, inner, line)
                missed += 0.5 * (b - a) * KRONROD[at] * off
                cost += spent
                for ch in range(3):
                    v = 0.5 * (b - a) * line[ch]
                    full[ch] += KRONROD[at] * v
                    if at % 2 == 1:
                        half[ch] += GAUSS[at // 2] * v
            off = max(abs(full[0] - half[0]), abs(full[1] - half[1]), abs(full[2] - half[2]))
            most = max(abs(full[0]), abs(full[1]), abs(full[2]))
            if off > max(tol, ROUNDED * most) and deep < DEEPEST and top + 2 < STACK and cost < BUDGET:
                outer[top, 0], outer[top, 1], outer[top, 2] = a, 0.5 * (a + b), deep + 1
                outer[top + 1, 0], outer[top + 1, 1], outer[top + 1, 2] = 0.5 * (a + b), b, deep + 1
                top += 2
                continue
            total += full
            error += off + missed
    return error, cost


def reflected(w: World, origin: Array, direction: Array, tol: float) -> Reflected:
    """What the place that a ray meets reflects of skies and lamps.

    ``tol`` is of every piece, not of the whole; what comes of it is told.
    """
    d = np.asarray(direction, float) / np.linalg.norm(direction)
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
    error, cost = _whole(q, n, j, -d, w, tol, total)
    return Reflected(j, shade * total, float(error * shade.max()), cost)
