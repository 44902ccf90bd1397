"""Nodes on squares of the checkered floor, and the taper by which they are weighed."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from symrender.chambers.labels import LIT, is_hidden, light_state
from symrender.chambers.lobes.density import facing_of
from symrender.chambers.lobes.rows import densities, lean_square, tint
from symrender.chambers.records import NODES, Nodes
from symrender.chambers.work import View, Work
from symrender.jit.marks import inlined, jitable
from symrender.leaves import values
from symrender.quadrature.gauss import FALLS
from symrender.quadrature.glow_nodes import add_glows
from symrender.quadrature.light_nodes import light_nodes
from symrender.quadrature.node_rows import whole_vectors
from symrender.quadrature.veins import vein_wave

Array = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]


@inlined
def seen(x: float, y: float, lobe: Array, view: View, work: Work, states: Array) -> bool:
    """Whether the floor point (x, y) from the foot is in the lobe and seen; ``states`` of its lights, 0 unlit."""
    chart = work.chart
    h = chart.height
    dot = x * lobe[0] + y * lobe[1] - h * lobe[2]
    if not dot > chart.lobe.rim_cos * math.sqrt(x * x + y * y + h * h):
        return False
    qx, qy = chart.point[0] + x, chart.point[1] + y
    if is_hidden(qx, qy, 0.0, view, work):
        return False
    for i in range(view.points.shape[0]):
        state = light_state(i, qx, qy, 0.0, 0.0, 0.0, 1.0, view, work)
        states[i] = state if state >= LIT else 0.0
    return True


@inlined
def floor_nodes(
    m: int, pieces: int, step: int, reach: float, veined: bool, lobe: Array, view: View, work: Work, gauss: Array
) -> None:  # fmt: skip
    """Fill ``radiance`` of ``m`` nodes, (``sine``, ``cosine``) from the foot, with what the deviation holds there.

    That is ``weight`` times the taper to ``reach`` times lobe density times solid angle per area times the sum of
    colour N.l over the lights that the nodes' pieces see, and where ``veined`` times the waves of a marble. ``near``
    and ``between`` get the shorter tapers over the longest one.
    """
    m = whole_vectors(m)
    chart, b = work.chart, work.nodes
    h, px, py = chart.height, chart.point[0], chart.point[1]
    ax, ay, az = lobe[0], lobe[1], lobe[2]
    flat, fx, fy, fz = facing_of(chart.lobe)
    for i in range(m):
        x, y = b.sine[i], b.cosine[i]
        wx, wy, wz, measure = values.floor_seen(x, y, h)
        b.chord[i] = values.lobe_chord(wx, wy, wz, ax, ay, az)
        b.weight[i] *= measure * (flat + fx * wx + fy * wy + fz * wz)
        b.place[0, i], b.place[1, i], b.place[2, i] = px + x, py + y, 0.0
    for i in range(m):
        b.normal[0, i], b.normal[1, i], b.normal[2, i] = 0.0, 0.0, 1.0
        b.toward[0, i], b.toward[1, i], b.toward[2, i] = 0.0, 0.0, 1.0
    for i in range(m):
        b.factor[0, i] = b.factor[1, i] = b.factor[2, i] = 1.0
        b.radiance[0, i] = b.radiance[1, i] = b.radiance[2, i] = 0.0
    if veined:
        floor = view.floor
        for i in range(m):
            x, y = b.place[0, i] - floor.offset[0], b.place[1, i] - floor.offset[1]
            b.weight[i] *= vein_wave(x / floor.cell, y / floor.cell)
    lean_square(m, lobe, chart, b, view.conductors)
    densities(m, FALLS[step], b, chart.lobe, view.conductors)
    light_nodes(pieces, step, 0.0, view, work, gauss)
    add_glows(pieces, view, work, view.glows)
    for i in range(m):
        b.near[i] = b.between[i] = 1.0
    if reach < math.inf:
        taper_rows(m, reach, b)
    for i in range(m):
        w = b.weight[i]
        b.radiance[0, i] *= w
        b.radiance[1, i] *= w
        b.radiance[2, i] *= w
    tint(m, chart.lobe, b, view.conductors)


@jitable
def taper(distance: float, reach: float) -> float:
    """exp(-(d / .6 reach)^8): 1 near the foot, below 1e-25 beyond ``reach``; entire, so that nothing breaks at it."""
    u = distance / (0.6 * reach)
    return math.exp(-min(40.0, u**8))


@inlined
def decay(t: float) -> float:
    """exp(-t), down to exp(-40), by its series at t/64 squared six times; vector instructions can take it."""
    x = min(40.0, t) * (1.0 / 64.0)
    y = 1.0 - x * (1.0 / 13.0)
    y = 1.0 - x * (1.0 / 12.0) * y
    y = 1.0 - x * (1.0 / 11.0) * y
    y = 1.0 - x * (1.0 / 10.0) * y
    y = 1.0 - x * (1.0 / 9.0) * y
    y = 1.0 - x * (1.0 / 8.0) * y
    y = 1.0 - x * (1.0 / 7.0) * y
    y = 1.0 - x * (1.0 / 6.0) * y
    y = 1.0 - x * (1.0 / 5.0) * y
    y = 1.0 - x * (1.0 / 4.0) * y
    y = 1.0 - x * (1.0 / 3.0) * y
    y = 1.0 - x * (1.0 / 2.0) * y
    y = 1.0 - x * y
    y *= y
    y *= y
    y *= y
    y *= y
    y *= y
    y *= y
    return y


@jitable
def taper_rows(m: int, reach: float, b: Nodes) -> None:
    """Multiply ``weight`` by the taper; ``near`` gets the ratio to it of one of .7 its reach, ``between`` of .84."""
    m = min(m, NODES)
    scale = 1.0 / (0.36 * reach * reach)
    shorter, middle = 0.7**-8 - 1.0, 0.84**-8 - 1.0
    for i in range(m):
        u = (b.sine[i] * b.sine[i] + b.cosine[i] * b.cosine[i]) * scale
        u *= u
        b.radix[i] = u * u
    for i in range(m):
        b.near[i] = decay(shorter * b.radix[i])
        b.between[i] = decay(middle * b.radix[i])
        b.weight[i] *= decay(b.radix[i])


@inlined
def add_tapered(
    red: float, green: float, blue: float, weight: float, near: float, between: float, out: Array
) -> None:  # fmt: skip
    """Add what a node sees to the sums under three tapers, ``out`` (9,): the longest, the shortest, that between."""
    near, between = weight * near, weight * between
    out[0] += weight * red
    out[1] += weight * green
    out[2] += weight * blue
    out[3] += near * red
    out[4] += near * green
    out[5] += near * blue
    out[6] += between * red
    out[7] += between * green
    out[8] += between * blue
