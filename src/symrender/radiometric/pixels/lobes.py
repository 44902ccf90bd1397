"""A place that reflects what arrives from all directions, as an eye: light it sees, and bounds of it in a cell.

The directions above a place are five windows, the faces of half a cube, and what it reflects of the light of each is a
mean over a window as a pixel is, weighed by f cos_i and by the solid angle.
"""

from __future__ import annotations

import math

from symrender.jit.marks import inlined, jitable
from symrender.leaves import radiometric as leaves
from symrender.radiometric.bumps import counted
from symrender.radiometric.direct import direct_light
from symrender.radiometric.pixels.cells import Cell, Eye, Lobe, heaviest, step
from symrender.radiometric.pixels.records import Room
from symrender.radiometric.pixels.sharp import far_apart, off_axis
from symrender.radiometric.pixels.sight import linear_range, may_show
from symrender.radiometric.reflection import reflected
from symrender.radiometric.sight import height_over, nearest
from symrender.radiometric.vectors import Vector, dot, minus, minus_of, vector
from symrender.radiometric.world import World
from symrender.scene.radiometric.arrays import AREA, BECKMANN, CONDUCTOR, DIFFUSE, DIRECTIONAL, SKY, SPHERE
from symrender.scene.radiometric.records import Material


@jitable
def window_of(face: int, facing: Vector, first: Vector, second: Vector) -> tuple[Vector, Vector, Vector, float]:
    """(v, vx, vy, area) of a window above a place: that straight up, then those to its sides, at distance 1."""
    if face == 0:
        return facing, first, second, 4.0
    way = first if face in (1, 2) else second
    side = way if face in (1, 3) else minus_of(way)
    across = second if face in (1, 2) else first
    half = (0.5 * facing[0], 0.5 * facing[1], 0.5 * facing[2])
    return (side[0] + half[0], side[1] + half[1], side[2] + half[2]), across, half, 2.0


@jitable
def sent_share(lobe: Lobe, v: Vector) -> Vector:
    """What a place sends on of the radiance from along v, by the place of the window: f cos_i area/|v|^3."""
    square = dot(v, v)
    size = math.sqrt(square)
    d = (v[0] / size, v[1] / size, v[2] / size)
    if dot(lobe.facing, d) <= 0.0:
        return (0.0, 0.0, 0.0)
    material = lobe.sight.materials[int(lobe.sight.pieces[lobe.own].material)]
    share = reflected(material, lobe.albedo, lobe.turned, lobe.view, d)
    by = lobe.area / (square * size)
    if material.terms != 0.0 and dot(lobe.turned, d) > 0.0:
        by *= counted(material, lobe.facing, lobe.turned, d)
    return (by * share[0], by * share[1], by * share[2])


@jitable
def add_sent(eye: Eye, lobe: Lobe, world: World, v: Vector, weight: float, row: int, room: Room) -> None:
    """Add what a place sends on of the light from along v to a row of sums; it widens the span of radiance."""
    size = math.sqrt(dot(v, v))
    d = (v[0] / size, v[1] / size, v[2] / size)
    share, light = sent_share(lobe, v), (0.0, 0.0, 0.0)
    own, _, place, normal, front = nearest(lobe.sight, eye.place, d)
    if own >= 0:
        light = direct_light(world, own, front, place, normal, minus_of(d), room.sky)
    sums, span = room.sums, room.span
    for c in range(3):
        sums[row, 3 + c] += weight * share[c] * light[c]
        span[0, c], span[1, c] = min(span[0, c], light[c]), max(span[1, c], light[c])
    room.total[7] += 1.0


@inlined
def angle_between(a: Vector, b: Vector) -> float:
    """The angle between two unit vectors."""
    return 2.0 * math.asin(min(1.0, 0.5 * math.sqrt(max(0.0, 2.0 - 2.0 * dot(a, b)))))


@jitable
def density_about(material: Material, off: float) -> float:
    """The largest f cos_i of a glossy material of albedo 1 at an angle off the middle of its lobe.

    D/4 times G1(o)/cos_o, which is no more than 2/alpha (GGX) and 4/alpha (Beckmann), and, where light counts by
    another normal's cosine and masking is separable, times the same of the light; (n + 2)/(2 pi) cos^n.
    """
    if off >= 0.5 * math.pi:
        return 0.0
    if material.kind == CONDUCTOR:
        cosine, sine = math.cos(off), math.sin(off)
        if material.density == BECKMANN:
            # of alpha beyond the root of 1/2 it is largest where cos^2 is 1/(2 alpha^2)
            square, most = min(1.0, 0.5 / (material.alpha * material.alpha)), 4.0 / material.alpha
            low = min(cosine, math.sqrt(square))
            dense = leaves.beckmann_density(low, 1.0 - low * low, material.alpha)
            if cosine > low:
                dense = max(dense, leaves.beckmann_density(cosine, sine * sine, material.alpha))
        else:
            dense, most = leaves.ggx_density(cosine, sine * sine, material.alpha), 2.0 / material.alpha
        return 0.25 * dense * most * (most if material.terms != 0.0 and material.geometric != 0.0 else 1.0)
    peak = (material.exponent + 2.0) / (2.0 * math.pi)
    return peak * math.exp(material.exponent * math.log(max(math.cos(off), 1e-300)))


@jitable
def radius_of(cell: Cell) -> tuple[float, float, Vector]:
    """(largest angle of a cell's rays off that in its middle, least length of v, that ray)."""
    size = math.sqrt(dot(cell.v, cell.v))
    wide = math.sqrt(dot(cell.vx, cell.vx)) + math.sqrt(dot(cell.vy, cell.vy))
    d = (cell.v[0] / size, cell.v[1] / size, cell.v[2] / size)
    return math.asin(min(1.0, wide / size)), max(size - wide, 0.0), d


@jitable
def weight_bound(eye: Eye, cell: Cell) -> float:
    """What places of a cell weigh at most."""
    if eye.lobe is None:
        return heaviest(eye.domain, cell)
    lobe = eye.lobe
    material = lobe.sight.materials[int(lobe.sight.pieces[lobe.own].material)]
    turn, least, d = radius_of(cell)
    # the middle of a window is 1 from the place, and nothing in it nearer
    least = max(least, 1.0)
    albedo = max(lobe.albedo[0], max(lobe.albedo[1], lobe.albedo[2]))
    by = albedo * lobe.area / (least * least * least)
    cosine = lobe.turned
    if material.kind == DIFFUSE:
        if material.terms != 0.0 and material.geometric != 0.0:
            cosine = lobe.facing
        _, high = linear_range(cosine, cell.v, cell.vx, cell.vy)
        return by * min(1.0, max(0.0, high) / least) / math.pi
    if material.kind == CONDUCTOR:
        half = (lobe.view[0] + d[0], lobe.view[1] + d[1], lobe.view[2] + d[2])
        size = math.sqrt(dot(half, half))
        if size < 1e-9:
            return by * density_about(material, 0.0)
        h = (half[0] / size, half[1] / size, half[2] / size)
        # h turns by no more than half of what d does over the cosine between them
        slow = math.cos(min(0.5 * math.pi, angle_between(h, d) + 0.5 * turn))
        off = angle_between(h, lobe.turned) - (0.5 * turn / slow if slow > 1e-6 else math.pi)
        return by * density_about(material, max(0.0, off))
    x, y, z, _ = off_axis(material, lobe.turned, lobe.view, d)
    off = 2.0 * math.asin(min(1.0, 0.5 * math.sqrt(x * x + y * y + z * z))) - turn
    return by * density_about(material, max(0.0, off))


@jitable
def lobe_bends(eye: Eye, cell: Cell) -> bool:
    """Whether a glossy lobe changes too much between corners of a cell for nodes to tell."""
    if eye.lobe is None:
        return False
    lobe = eye.lobe
    material = lobe.sight.materials[int(lobe.sight.pieces[lobe.own].material)]
    if material.kind == DIFFUSE:
        return False
    turn, _, d = radius_of(cell)
    x, y, z, width = off_axis(material, lobe.turned, lobe.view, d)
    for corner in range(4):
        a, b = 1.0 if corner % 2 == 1 else -1.0, 1.0 if corner >= 2 else -1.0
        v = step(cell.v, a, cell.vx, b, cell.vy)
        size = math.sqrt(dot(v, v))
        p, q, r, _ = off_axis(material, lobe.turned, lobe.view, (v[0] / size, v[1] / size, v[2] / size))
        if far_apart((x, y, z), (p, q, r), width):
            return True
    # masking goes as the cosine over alpha at the horizon
    if material.kind == CONDUCTOR:
        low, high = linear_range(lobe.turned, cell.v, cell.vx, cell.vy)
        return high - low > 2.0 * (max(0.0, low) + material.alpha)
    return turn > 1.0


@jitable
def reflects_most(material: Material) -> float:
    """The largest f cos_i of a material anywhere."""
    albedo = max(max(material.bright[0], material.dark[0]), max(material.bright[1], material.dark[1]))
    albedo = max(albedo, max(material.bright[2], material.dark[2]))
    return float(albedo / math.pi if material.kind == DIFFUSE else albedo * density_about(material, 0.0))


@jitable
def light_bound(eye: Eye, cell: Cell, room: Room, limit: float) -> float:
    """What radiance there may be at most in a cell, of points, spots and directions; inf under a sky or a lamp.

    A point is no nearer to a place than the piece is to it, nor than the rays of the cell come to it.
    """
    world, most = eye.world, 0.0
    turn, least, d = radius_of(cell)
    for j in range(world.pieces.shape[0]):
        if not may_show(room, float(j), limit):
            continue
        piece = world.pieces[j]
        reflects, found = reflects_most(world.materials[int(piece.material)]), 0.0
        for i in range(world.lights.shape[0]):
            lamp = world.lights[i]
            if lamp.kind == SKY or lamp.kind == AREA:
                return math.inf
            bright = max(lamp.emitted[0], max(lamp.emitted[1], lamp.emitted[2]))
            if lamp.kind == DIRECTIONAL:
                found += bright
                continue
            at = vector(lamp.place)
            way = minus(at, eye.place)
            away = math.sqrt(dot(way, way))
            if piece.kind == SPHERE:
                gap = minus(at, vector(piece.place))
                near = abs(math.sqrt(dot(gap, gap)) - piece.radius)
            else:
                near = abs(height_over(piece, at))
            if away > 0.0:
                off = angle_between((way[0] / away, way[1] / away, way[2] / away), d) - turn
                if off > 0.0:
                    near = max(near, away * math.sin(min(off, 0.5 * math.pi)))
            near = max(near, room.reach[j, 0] * least - away)
            found += bright / max(near * near, 1e-300)
        most = max(most, reflects * found)
    return most
