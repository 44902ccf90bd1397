"""What a sky, spheres that emit and spots add to quadrature nodes: closed forms, node by node.

What a node sees of a sky or of a sphere that emits is bounded by arcs of caps, in the coordinates of its chart: those
of ``radiometric/sky.py`` in a scene of spheres and planes alone.
"""

from __future__ import annotations

import math

from symrender.chambers.records import LINEAR, NODES, LightPoint, Nodes
from symrender.chambers.rooms import height
from symrender.chambers.work import View, Work
from symrender.jit.marks import inlined, jitable
from symrender.jit.records import Table
from symrender.leaves import radiometric as leaves
from symrender.leaves.values import heading
from symrender.radiometric.arcs import Room, put_circle
from symrender.radiometric.region import few_irradiance
from symrender.radiometric.vectors import Vector, minus, vector
from symrender.scene.radiometric.records import Glow

HIDDEN = -1
"""What stands for the count of arcs where nothing is seen."""


@jitable
def fade(start: int, stop: int, p: LightPoint, b: Nodes) -> None:
    """Multiply ``clear`` of nodes by the share of a spot's intensity that goes towards them."""
    axis = vector(p.axis)
    for q in range(start, min(stop, NODES)):
        if b.clear[q] == 0.0:
            continue
        x, y, z = p.position[0] - b.place[0, q], p.position[1] - b.place[1, q], p.position[2] - b.place[2, q]
        x, y, z, _, _ = heading(x, y, z)
        if p.spot == LINEAR:
            b.clear[q] *= leaves.linear_spot(x, y, z, *axis, p.beam, p.cutoff)
        else:
            b.clear[q] *= leaves.smooth_spot(x, y, z, *axis, p.beam, p.cutoff)


@jitable
def gather_glow(lamp: int, place: Vector, normal: Vector, view: View, work: Work, room: Room) -> tuple[int, int]:
    """List sphere ``lamp``, or the sky for -1, and what hides it from a place of the charted shape: arcs and cones.

    The count of arcs is negative where nothing is seen. A lamp crosses no other shape, and of two spheres apart from
    each other the one of less power is before the other.
    """
    chart = work.chart
    count, cones, whole = put_circle(room, 0, 0, normal, 0.0, 1.0), 1, math.inf
    if lamp >= 0:
        offset = minus(vector(view.spheres[lamp].center), place)
        whole = leaves.sphere_power(*offset, view.spheres[lamp].radius)
        if lamp == chart.shape_index or whole <= 0.0:
            return HIDDEN, 0
        x, y, z, cosine, sine = leaves.sphere_cap(*offset, view.spheres[lamp].radius)
        count = put_circle(room, count, 0, (x, y, z), cosine, sine)
    for i in range(view.spheres.shape[0]):
        if i == lamp:
            continue
        ball = view.spheres[i]
        if lamp >= 0:
            apart = minus(vector(ball.center), vector(view.spheres[lamp].center))
            if leaves.sphere_power(*apart, ball.radius) < 0.0:
                # the lamp is inside of it, and the place is not
                return HIDDEN, 0
        if i == chart.shape_index:
            continue
        offset = minus(vector(ball.center), place)
        power = leaves.sphere_power(*offset, ball.radius)
        if power <= 0.0:
            return HIDDEN, 0
        if power < whole:
            x, y, z, cosine, sine = leaves.sphere_cap(*offset, ball.radius)
            count = put_circle(room, count, cones, (x, y, z), cosine, sine)
            cones += 1
    for k in range(view.sides.shape[0]):
        side = view.sides[k]
        here = height(side, place[0], place[1], place[2])
        if lamp >= 0:
            center = view.spheres[lamp].center
            over = height(side, center[0], center[1], center[2])
            if (over <= 0.0) if k == chart.plane else (over * here < 0.0):
                return HIDDEN, 0
        elif k != chart.plane:
            way = -1.0 if here >= 0.0 else 1.0
            count = put_circle(room, count, cones, (way * side.up[0], way * side.up[1], way * side.up[2]), 0.0, 1.0)
            cones += 1
    return count, cones


@inlined
def glow_room(work: Work) -> Room:
    """The scratch of one place; nothing is listed by pieces, so that five of its arrays are never looked at."""
    none = work.touched
    return Room(
        work.arcs, work.crossings, work.begin, work.stop, none, none, none, work.caps, work.within, work.touched, none,
        none,
    )  # fmt: skip


@jitable
def glow_at(place: Vector, normal: Vector, view: View, work: Work, glows: Table[Glow] | None) -> float:
    """What a place of the charted shape gets of skies and lamps; their largest channels, summed."""
    total = 0.0
    if glows is None:
        return total
    room = glow_room(work)
    for g in range(glows.shape[0]):
        count, cones = gather_glow(int(glows[g].sphere), place, normal, view, work, room)
        light = glows[g].radiance
        total += few_irradiance(room, count, cones, normal) * max(light[0], light[1], light[2])
    return total


@jitable
def add_glows(pieces: int, view: View, work: Work, glows: Table[Glow] | None) -> None:
    """Add to ``radiance`` of the nodes that the first ``pieces`` pieces own what skies and lamps add."""
    if glows is None:
        return
    if work.chart.shape_index < 0 and work.chart.side < 0.0:
        return
    b, room = work.nodes, glow_room(work)
    for piece in range(pieces):
        first = work.pieces[piece].first
        for q in range(first, first + work.pieces[piece].count):
            place = (b.place[0, q], b.place[1, q], b.place[2, q])
            normal = (b.normal[0, q], b.normal[1, q], b.normal[2, q])
            for g in range(glows.shape[0]):
                count, cones = gather_glow(int(glows[g].sphere), place, normal, view, work, room)
                seen = few_irradiance(room, count, cones, normal)
                for a in range(3):
                    b.radiance[a, q] += b.factor[a, q] * seen * glows[g].radiance[a]
