"""Nodes of a line that lies beside a wall, weighed by how fast the wall moves across them (``radial_walls.py``)."""

from __future__ import annotations

import math

from symrender.chambers.line import wall_level
from symrender.chambers.walls import NORMAL
from symrender.chambers.work import Work
from symrender.jit.marks import jitable
from symrender.jit.moving import held, moved, moves, tangent


@jitable
def weigh_by_speed(m: int, c: float, s: float, work: Work) -> None:
    """Let the weights of the nodes of a line grow as the wall that it lies beside moves across them."""
    b, chart = work.nodes, work.chart
    if not moves(chart.swept_end):
        return
    row = work.walls[chart.swept - 1]
    across = held(row.axis[2] * c - row.axis[1] * s)
    for i in range(m):
        x, w = held(b.inner[i]), held(b.weight[i])
        # a circle through the pole turns by its level over the sine of the polar angle
        sine = math.sin(x)
        if chart.shape_index >= 0:
            sine *= held(chart.ratio)
            if row.kind == NORMAL:
                sine = math.sin(x - math.asin(sine))
        speed = -tangent(wall_level(chart.swept - 1, x, c, s, work)) / (across * max(sine, 1e-300))
        b.weight[i] = moved(w, w * held(chart.swept_sign) * (speed - tangent(chart.swept_end)))
