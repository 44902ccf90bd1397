"""Charts of nasty scenes for tests, on one lobe's shapes one after the other."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import numpy.typing as npt

from adversary.case import Case
from symrender.chambers.chart import floor_chart, sphere_chart
from symrender.chambers.events import line_range
from symrender.chambers.lobes.setup import lobe_setup
from symrender.chambers.unseen import list_seen
from symrender.chambers.work import View, Work, begin_counts, scene_view, work_arrays
from symrender.errors import SymrenderError
from symrender.jit.compiled import compiled
from symrender.probe import _places
from symrender.quadrature.light_points import light_rows
from symrender.quadrature.split_setup import inside_another, place_point
from symrender.scene.arrays import FIRST_SPHERE, FLOOR, scene_arrays
from symrender.scene.load import load

FLOOR_CHART = -1


def chart_of(shape: int, own: int, axis: npt.NDArray[np.float64], view: View, work: Work) -> None:
    """Chart the sphere ``shape``, or the floor."""
    if shape == FLOOR_CHART:
        floor_chart(0, own, axis, view, work)
    else:
        sphere_chart(shape, own, axis, view, work)


CHART_OF = compiled(chart_of)
Chart = tuple[int, View, Work, float, float, npt.NDArray[np.float64]]


def charts_of(case: Case, tol: float = 1e-9) -> Iterator[Chart]:
    """(shape, view, work, low, high, mirror direction) of every chart of the case's first point that the lobe meets."""
    try:
        scene = load(case.scene)
        place, normal, surface = _places(scene, np.atleast_2d(np.asarray(case.points[0], dtype=float)), case.surface)
    except SymrenderError:
        return
    arrays = scene_arrays(scene)
    lights = light_rows(arrays, 0 if case.disk == "exact" else int(case.disk.split("x")[0]))
    view = scene_view(arrays, lights)
    work = work_arrays(len(arrays.spheres), len(lights))
    own = surface - FIRST_SPHERE
    shape = scene.floor if surface == FLOOR else scene.spheres[own]
    assert shape is not None
    if shape.lobe is None or shape.lobe.mirror or inside_another(place[0], own, view.spheres):
        return
    away = place[0] - arrays.camera.eye
    lobe = np.zeros(3)
    begin_counts(10**9, work)
    place_point(place[0], normal[0], away / np.linalg.norm(away), 0 if surface == FLOOR else -1, lobe, view, work)
    lobe_setup(shape.lobe.exponent, shape.lobe.theta_max, tol, 1.0, work.chart.lobe)
    list_seen(own, lobe, view, work)
    for j in (*range(len(arrays.spheres)), FLOOR_CHART):
        if j == own:
            continue
        if j == FLOOR_CHART and (surface == FLOOR or arrays.floor.present == 0.0 or place[0, 2] == 0.0):
            continue
        CHART_OF(j, own, lobe, view, work)
        low, high = line_range(work.chart)
        if low < high:
            yield j, view, work, low, high, lobe
