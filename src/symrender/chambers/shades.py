"""Which shadows a chart has to know: those of which P sees some, or some of the edge, where no others lie over it.

Many spheres lay many shadows, most of them behind spheres or in other shadows. What is left out changes no value: where
P sees the charted shape nothing changes across such an edge.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from symrender.chambers.listed import ROUNDED_UP, SLACK, in_lobe, shadow_disc
from symrender.chambers.records import Chart, LightPoint
from symrender.chambers.unseen import (
    ARCS,
    CORNER,
    HALVINGS,
    QUARTERINGS,
    across,
    covers,
    is_unseen,
    next_arc,
    next_square,
    square_place,
)
from symrender.chambers.work import View, Work
from symrender.jit.marks import inlined, jitable
from symrender.jit.moving import held
from symrender.scene.records import Sphere

Array = npt.NDArray[np.float64]


class Rivals(NamedTuple):
    """The occluders ``first`` up to ``kept`` and those after ``own``: all of one light but for one at hand."""

    first: int
    kept: int
    own: int


@jitable
def is_dark(x: float, y: float, z: float, size: float, rivals: Rivals, view: View, work: Work) -> bool:
    """Whether one of ``rivals`` hides its light point from all that is within ``size`` of P + (x, y, z)."""
    p = work.chart.point
    for c in range(rivals.first, work.counts.casters):
        if rivals.kept <= c <= rivals.own:
            continue
        light, ball = view.points[work.casters[c].light], view.spheres[work.casters[c].ball]
        dx, dy, dz = (
            held(ball.center[0] - light.position[0]),
            held(ball.center[1] - light.position[1]),
            held(ball.center[2] - light.position[2]),
        )
        qx, qy, qz = (
            x + held(p[0] - light.position[0]),
            y + held(p[1] - light.position[1]),
            z + held(p[2] - light.position[2]),
        )
        away = math.sqrt(qx * qx + qy * qy + qz * qz)
        if not size < away:
            return False
        sine = size / away
        cosine = math.sqrt((1.0 - sine) * (1.0 + sine))
        if covers(
            dx, dy, dz, held(ball.radius), qx / away, qy / away, qz / away, sine, cosine, away - size
        ):  # fmt: skip
            return True
    return False


class Ellipse(NamedTuple):
    """The edge of a shadow on the floor: its middle as of P's foot, half-axes, the longer one's direction; P's height.

    Places are right to within ``slack``.
    """

    x: float
    y: float
    wide: float
    short: float
    ux: float
    uy: float
    height: float
    slack: float


@inlined
def shadow_ellipse(light: LightPoint, ball: Sphere, chart: Chart) -> tuple[bool, Ellipse]:
    """Whether the edge of a ball's shadow, from a light point, is an ellipse on the charted floor; and that ellipse.

    It lies about a place of the cone's axis, with the half-axes h sin a cos a/(cos(b - a) cos(b + a)) and
    h sin a/sqrt(cos(b - a) cos(b + a)), h the light's height, a the cone's half-angle and b its axis's from the nadir.
    """
    mx, my, reach = shadow_disc(light, ball)
    if not reach < math.inf or light.radius > 0.0:
        return False, Ellipse(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    x, y, wide, height = held(mx - chart.point[0]), held(my - chart.point[1]), held(reach), held(chart.point[2])
    lift, radius = held(light.position[2]), held(ball.radius)
    ex, ey = held(ball.center[0] - light.position[0]), held(ball.center[1] - light.position[1])
    ez = held(ball.center[2]) - lift
    far2, flat = ex * ex + ey * ey + ez * ez, math.hypot(ex, ey)
    sine2 = radius * radius / far2
    # cos(b - a) cos(b + a), which ``shadow_disc`` keeps off 0
    level = max(1e-7, (1.0 - sine2) - flat * flat / far2)
    ux, uy = (ex / flat, ey / flat) if flat > 0.0 else (1.0, 0.0)
    slack = SLACK * (abs(held(mx)) + abs(held(my)) + wide + abs(x) + abs(y) + abs(height))
    return True, Ellipse(x, y, wide, lift * math.sqrt(sine2 / level), ux, uy, height, slack)


@inlined
def place_unseen(
    u: float, v: float, size: float, e: Ellipse, rivals: Rivals, lobe: Array, view: View, work: Work
) -> bool:  # fmt: skip
    """Whether P sees nothing lit of the floor within ``size`` of the place (u, v) of an ellipse, in its half-axes."""
    a, b = e.wide * u, e.short * v
    x, y, z = e.x + a * e.ux - b * e.uy, e.y + a * e.uy + b * e.ux, -e.height
    away = math.sqrt(x * x + y * y + z * z)
    if size >= away:
        return False
    if is_unseen(x / away, y / away, z / away, size / away, away - size, lobe, view, work):
        return True
    return is_dark(x, y, z, size, rivals, view, work)


@jitable
def edge_unseen(
    light: LightPoint, ball: Sphere, rivals: Rivals, lobe: Array, view: View, work: Work
) -> bool:  # fmt: skip
    """Whether P sees nothing of the edge of a ball's shadow on the floor, but where ``rivals`` shadow it too."""
    found, e = shadow_ellipse(light, ball, work.chart)
    if not found:
        return False
    index, halvings = 0, 0
    while halvings > 0 or index < ARCS:
        half = math.pi / (ARCS << halvings)
        turn = (2 * index + 1) * half
        s, c = math.sin(turn), math.cos(turn)
        # how far the arc reaches along either axis
        off, bent = math.sin(half), 2.0 * math.sin(0.5 * half) ** 2
        along, aside = e.wide * (abs(s) * off + abs(c) * bent), e.short * (abs(c) * off + abs(s) * bent)
        size = ROUNDED_UP * math.sqrt(along * along + aside * aside) + e.slack
        if place_unseen(c, s, size, e, rivals, lobe, view, work):
            index, halvings = next_arc(index, halvings)
        elif halvings == HALVINGS or not place_unseen(c, s, 0.0, e, rivals, lobe, view, work):
            return False
        else:
            index, halvings = 2 * index, halvings + 1
    return True


@jitable
def shadow_unseen(
    light: LightPoint, ball: Sphere, rivals: Rivals, lobe: Array, view: View, work: Work
) -> bool:  # fmt: skip
    """Whether P sees nothing of a ball's shadow on the charted floor, but where ``rivals`` shadow it too."""
    found, e = shadow_ellipse(light, ball, work.chart)
    if not found:
        return False
    index, level = 0, 0
    while level > 0 or index < 1:
        u, v, half = square_place(index, level)
        off2, size = u * u + v * v, ROUNDED_UP * half * math.hypot(e.wide, e.short) + e.slack
        if math.sqrt(off2) > 1.0 + CORNER * half or place_unseen(u, v, size, e, rivals, lobe, view, work):
            index, level = next_square(index, level)
        elif level == QUARTERINGS or (off2 < 1.0 and not place_unseen(u, v, 0.0, e, rivals, lobe, view, work)):
            return False
        else:
            index, level = 4 * index, level + 1
    return True


@jitable
def falls_in_sight(i: int, ball: Sphere, lobe: Array, view: View, work: Work) -> bool:
    """Whether P can see, inside its lobe, some of what a ball shadows or partly hides of light ``i`` on the floor."""
    x, y, radius = shadow_disc(view.points[i], ball)
    if not radius < math.inf:
        return True
    if not in_lobe(x, y, 0.0, radius, lobe, work.chart):
        return False
    nobody = Rivals(0, 0, work.counts.casters)
    return not shadow_unseen(view.points[i], ball, nobody, lobe, view, work)


@jitable
def thin_out(first: int, lobe: Array, view: View, work: Work) -> None:
    """Drop occluders, of one light from ``first`` on, whose shadows add nothing to others' where P sees the floor.

    Of those that stay it is noted whether the edge is unseen.
    """
    kept = first
    for c in range(first, work.counts.casters):
        light, ball = view.points[work.casters[c].light], view.spheres[work.casters[c].ball]
        if not shadow_unseen(light, ball, Rivals(first, kept, c), lobe, view, work):
            work.casters[kept] = work.casters[c]
            kept += 1
    work.counts.casters = kept
    for c in range(first, kept):
        caster = work.casters[c]
        light, ball = view.points[caster.light], view.spheres[caster.ball]
        caster.unseen = 1 if edge_unseen(light, ball, Rivals(first, c, c), lobe, view, work) else 0


@jitable
def ray_dark(x: float, y: float, z: float, sine: float, near: float, rivals: Rivals, view: View, work: Work) -> bool:
    """Whether one of ``rivals`` hides all that their light point shines on, in a cone of rays, from ``near`` on."""
    cosine = math.sqrt((1.0 - sine) * (1.0 + sine))
    for c in range(rivals.first, work.counts.casters):
        if rivals.kept <= c <= rivals.own:
            continue
        p, ball = view.points[work.casters[c].light].position, view.spheres[work.casters[c].ball]
        dx, dy, dz = held(ball.center[0] - p[0]), held(ball.center[1] - p[1]), held(ball.center[2] - p[2])
        if covers(dx, dy, dz, held(ball.radius), x, y, z, sine, cosine, near):
            return True
    return False


@jitable
def rays_unseen(own: int, first: int, view: View, work: Work) -> bool:
    """Whether the rays along an occluder's edge pass what P sees of the charted sphere, but where others shadow it too.

    ``own`` is the occluder; ``first`` that from which on they are of one light point.
    """
    light, ball, chart = view.points[work.casters[own].light], view.spheres[work.casters[own].ball], work.chart
    p, at = light.position, chart.ball
    x, y, z = held(ball.center[0] - p[0]), held(ball.center[1] - p[1]), held(ball.center[2] - p[2])
    far, radius = math.sqrt(x * x + y * y + z * z), held(ball.radius)
    bx, by, bz = held(at[0] - p[0]), held(at[1] - p[1]), held(at[2] - p[2])
    away, reach = math.sqrt(bx * bx + by * by + bz * bz), held(chart.ball_radius)
    if far <= radius or away <= ROUNDED_UP * reach:
        return False
    x, y, z, bx, by, bz = x / far, y / far, z / far, bx / away, by / away, bz / away
    sine, wide, near = radius / far, reach / away, away - reach
    cosine, narrow = math.sqrt((1.0 - sine) * (1.0 + sine)), math.sqrt((1.0 - wide) * (1.0 + wide))
    fx, fy, fz, gx, gy, gz = across(x, y, z)
    index, halvings = 0, 0
    while halvings > 0 or index < ARCS:
        half = math.pi / (ARCS << halvings)
        turn = (2 * index + 1) * half
        s, c = sine * math.sin(turn), sine * math.cos(turn)
        chord = ROUNDED_UP * 2.0 * sine * math.sin(0.5 * half)
        size = chord * math.sqrt(1.0 - 0.25 * chord * chord)
        px, py, pz = cosine * x + c * fx + s * gx, cosine * y + c * fy + s * gy, cosine * z + c * fz + s * gz
        towards, thin = px * bx + py * by + pz * bz, math.sqrt((1.0 - size) * (1.0 + size))
        if towards < narrow * thin - wide * size - SLACK or ray_dark(
            px, py, pz, size, near, Rivals(first, own, own), view, work
        ):
            index, halvings = next_arc(index, halvings)
        elif halvings == HALVINGS or (
            towards > narrow and not ray_dark(px, py, pz, 0.0, near, Rivals(first, own, own), view, work)
        ):
            return False
        else:
            index, halvings = 2 * index, halvings + 1
    return True
