"""What one shape adds to the lobe integral of a place: a sphere, or a plane with its checker."""

from __future__ import annotations

import math
from typing import Final, NamedTuple

import numpy as np
import numpy.typing as npt

from symrender.chambers.chart import floor_chart, sphere_chart
from symrender.chambers.cones import put_cones
from symrender.chambers.jumps import put_jumps
from symrender.chambers.lobes.density import largest_density
from symrender.chambers.lobes.setup import weigh_by_cosine
from symrender.chambers.lobes.width import fastest_fall
from symrender.chambers.rooms import in_a_plane
from symrender.chambers.work import Frames, View, Work
from symrender.jit.marks import inlined, jitable
from symrender.jit.moving import brightest, held, moved, moves, rising, tangent
from symrender.quadrature.fall_off import chart_bound, is_radiometric, plane_bound, sphere_bound
from symrender.quadrature.lattice_sphere import aim_lattice, lattice_sum
from symrender.quadrature.paces import is_still, outline, set_pace
from symrender.quadrature.panel_rule import stretched
from symrender.quadrature.split_grid import split_grid
from symrender.quadrature.split_panel import split_chart
from symrender.quadrature.split_scratch import SplitWork
from symrender.quadrature.split_setup import floor_strips, spare_share, sphere_strips, stand_in_frame
from symrender.scene.arrays import BRDF_NORMALISED, SOLID

Array = npt.NDArray[np.float64]

LEVEL: Final = 1e-15
"""Height of a light over its distance from the point's foot up to which it lies in a plane, but for rounding."""
FAINT: Final = 1e-4
"""Share of the tolerance below which slopes of a whole sphere are left out."""


class Asked(NamedTuple):
    """What is asked of every place: the tolerance, with at ``most`` so many evaluations, of light below ``bound``.

    Where not ``walled``, a sphere is done on a lattice of directions as far as that is good enough.
    """

    tol: float
    bound: float
    most: int
    walled: bool


class Stand(NamedTuple):
    """A place: its lobe's axis, its sphere ``own`` or plane ``home``, each negative of the other."""

    point: Array
    normal: Array
    lobe: Array
    own: int
    home: int
    conductor: bool


@jitable
def add_ball(
    j: int, part: float, total: float, stand: Stand, view: View, s: SplitWork, asked: Asked, value: Array
) -> tuple[float, int]:  # fmt: skip
    """Add what sphere ``j`` adds to ``value``, to a ``part`` of the tolerance that ``total`` leaves.

    Returns (its error, panels that stayed unresolved).
    """
    work, chart, lobe, own = s.work, s.work.chart, stand.lobe, stand.own
    if not asked.walled and not stand.conductor and not in_a_plane(view, work):
        mass = aim_lattice(j, lobe, view, work)
        if mass >= 0.0:
            spare = max(part * (asked.tol - total), min(0.05, part) * asked.tol)
            bright = sphere_bound(j, view, chart)
            e = lattice_sum(j, own, spare, mass, bright, asked.most, view, work, value)
            if e >= 0.0:
                return held(e), 0
    sphere_chart(j, own, lobe, view, work)
    k = chart.ratio
    # all of the shape, at the lobe's largest density on it
    gap = max(0.0, chart.lobe_beta - chart.beta_max)
    most = largest_density(4.0 * math.sin(0.5 * gap) ** 2, chart.lobe) * 2.0 * math.pi * k * k * asked.bound
    if moves(most) and work.notes.heed != 0:
        set_pace(work)
        # how fast the lobe falls over the shape, too
        most, steep = held(most), held(fastest_fall(gap, chart.lobe) + outline(chart))
        if gap < 1.5 and most * steep * held(work.notes.quick) < FAINT * asked.tol:
            return moved(most, most * steep * tangent(work.notes.quick)), 0
        if is_still(view, work):
            return 0.0, 0
    elif gap < 1.5 and most < min(0.1, part) * asked.tol:
        return held(most), 0
    put_cones(view, work)
    put_jumps(view, work)
    sphere_strips(j, view, work)
    chart.bright = chart_bound(sphere_bound(j, view, chart), view, work)
    spare = max(part * (asked.tol - total), min(0.05, part) * asked.tol)
    return split_chart(spare, view, work, s.gauss, s.panels, s.spans, s.ids, s.events, s.scratch, value)


@inlined
def note_level_lights(framed: View, work: Work) -> None:
    """Note what lifts a point light off the plane in which it lies: all of the plane is lit from there on."""
    for i in range(framed.points.shape[0]):
        light = framed.points[i]
        if moves(light.radius):
            reach = abs(light.position[0]) + abs(light.position[1])
            if not light.radius > 0.0 and abs(light.position[2]) <= LEVEL * reach:
                work.counts.parted |= rising(abs(tangent(light.position[2])))


@jitable
def add_plane(
    k: int, left: int, total: float, stand: Stand, view: View, frames: Frames, s: SplitWork, asked: Asked, value: Array
) -> tuple[float, int, int]:  # fmt: skip
    """Add what plane ``k`` adds to ``value``; ``left`` integrals are to come, ``total`` of the tolerance is spent.

    Returns (what is spent now, integrals to come, panels that stayed unresolved).
    """
    work, chart, notes, own, axis = s.work, s.work.chart, s.work.notes, stand.own, s.work.notes.axis
    stand_in_frame(k, stand.point, stand.normal, stand.lobe, frames, work, axis)
    if view.shading.units == BRDF_NORMALISED:
        weigh_by_cosine(chart.normal, chart.lobe)
    front = work.room[k] > 0.0
    if front:
        note_level_lights(frames.views[k], work)
    if not front and brightest(view.shading.background) == 0.0:
        return total, left, 0
    framed = frames.views[k]
    floor_chart(k, own, axis, framed, work)
    if moves(total) and is_still(framed, work):
        return total, left, 0
    set_pace(work)
    put_cones(framed, work)
    put_jumps(framed, work)
    floor_strips(framed, work)
    # what planes send may be bounded by their lights
    shown = is_radiometric(view) or view.glows is not None or view.emitted is not None
    chart.bright = chart_bound(plane_bound(framed) if shown else asked.bound, framed, work)
    spare = max(spare_share(left) * (asked.tol - total), 0.05 * asked.tol)
    e, bad = split_chart(spare, framed, work, s.gauss, s.panels, s.spans, s.ids, s.events, s.scratch, value)
    total, left = total + e, left - 1
    if not front or framed.floor.kind == SOLID:
        return total, left, bad
    # unlike panels, blocks of a checker may end a little above what they were given
    part = min(0.5, spare_share(left))
    half, deviation, contrast = notes.half, notes.deviation, 0.0
    for a in range(3):
        half[a] = 0.5 * view.shading.kd * (framed.floor.bright[a] - framed.floor.dark[a])
        deviation[a] = 0.0
        contrast = max(contrast, abs(half[a]))
    if contrast > 0.0:
        spare = max(part * (asked.tol - total), 0.05 * asked.tol) / contrast
        e, unseen = split_grid(spare, own, axis, framed, s, asked.most, deviation)
        total += stretched(contrast) * e
        if moves(total):
            notes.errs += held(stretched(contrast)) * (held(e) - unseen)
        for a in range(3):
            value[a] += half[a] * deviation[a]
    return total, left - 1, bad
