"""Stand-ins for functions that lay walls, each without one class of them; ``leave_out`` puts them in their place.

They are put there from outside, before a kernel is compiled: the package has no switch for it. A class of spheres and
planes is left out for the rest of the process; of flat faces, whose walls no kernel lays, until it is put back.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import Any, Final

from symrender.chambers import cones, walls
from symrender.chambers.caps import Cone
from symrender.chambers.records import Chart, Wall
from symrender.chambers.work import Counts, View, Work
from symrender.jit.marks import jitable
from symrender.jit.records import Table
from symrender.quadrature.records import Conic

Array = Any

TAG: int = -1
"""The condition whose circles are left out: a tag of ``chambers/walls.py``."""
PAIRS: bool = False
"""Whether it is the cones about two spheres that are left out, or those of spots."""

_laid_cone = cones.put_cone


@jitable
def add_circle(
    rows: Table[Wall], count: int, kind: int, a0: float, a1: float, a2: float, cosine: float, tag: int, shape: int
) -> int:
    """Without circles of one tag."""
    if tag == TAG:
        return count
    return walls.add_circle(rows, count, kind, a0, a1, a2, cosine, tag, shape)


@jitable
def add_shadow(
    _rows: Table[Wall], count: int, _chart: Chart, _ux: float, _uy: float, _uz: float, _gx: float, _gy: float,
    _gz: float, _radius: float, _shape: int, _light: int,
) -> int:  # fmt: skip
    """Without edges of shadows."""
    return count


@jitable
def put_cone(
    rows: Table[Cone], count: int, px: float, py: float, pz: float, ax: float, ay: float, az: float, sine: float,
    one: int, other: int,
) -> int:  # fmt: skip
    """Without the cones of spots, or without those about two spheres."""
    if (one >= 0) == PAIRS:
        return count
    return _laid_cone(rows, count, px, py, pz, ax, ay, az, sine, one, other)


@jitable
def add_normal(
    _rows: Table[Wall], _counts: Counts, _chart: Chart, _ax: float, _ay: float, _az: float, _level: float, _tag: int,
    _shape: int,
) -> None:  # fmt: skip
    """Without circles of normals."""


@jitable
def add_direction(
    _rows: Table[Wall], _counts: Counts, _chart: Chart, _ax: float, _ay: float, _az: float, _cosine: float, _tag: int,
    _shape: int,
) -> None:  # fmt: skip
    """Without circles of directions."""


@jitable
def no_more(_view: View, _work: Work) -> None:
    """Without what a function appends to the walls of a chart."""


@jitable
def floor_conics(_own: int, _lobe: Array, _view: View, _work: Work, _conics: Table[Conic]) -> int:
    """Without the conics at which what squares of a plane send jumps."""
    return 0


@jitable
def touch_conics(n: int, _view: View, _work: Work, _conics: Table[Conic]) -> int:
    """Without the conics at which what is seen of a sky or a lamp touches."""
    return n


def none(*_: Any) -> list[Any]:
    """Without any segment."""
    return []


CHART, JUMPS, GRID = "symrender.chambers.chart", "symrender.chambers.jumps", "symrender.quadrature.split_grid"
CONES = "symrender.chambers.cones"
BREAKS, TABLE, FOREST = (f"symrender.radiosity.{name}" for name in ("breaks", "table", "forest"))
Places = list[tuple[str, str, Callable[..., Any]]]
ROUND: Final[dict[str, tuple[Places, int, bool]]] = {
    "silhouettes": ([(CHART, "add_circle", add_circle)], walls.SILHOUETTE, False),
    "horizon of the place": ([(CHART, "add_circle", add_circle)], walls.HORIZON, False),
    "lines in which planes meet": ([(CHART, "add_circle", add_circle)], walls.FLOOR_CUT, False),
    "terminators": ([(CHART, "add_circle", add_circle)], walls.TERMINATOR, False),
    "fields of balls": ([(CHART, "add_circle", add_circle)], walls.TEXTURE_EDGE, False),
    "shadows' edges": ([(CHART, "add_shadow", add_shadow)], -1, False),
    "cones of spots": ([(CONES, "put_cone", put_cone)], -1, False),
    "cones about two balls": ([(CONES, "put_cone", put_cone)], -1, True),
    "balls at horizons of balls": ([(CONES, "add_normal", add_normal)], -1, False),
    "balls at other planes": ([(CONES, "add_direction", add_direction)], -1, False),
    "conics over fields of planes": ([(GRID, "floor_conics", floor_conics)], -1, False),
    "touching conics over fields": ([(GRID, "touch_conics", touch_conics)], -1, False),
    "ends of phong's highlights": ([(JUMPS, "put_ends", no_more)], -1, False),
    "critical angles": ([(JUMPS, "put_critical", no_more)], -1, False),
    "jumps of Walter's fit": (
        [(JUMPS, "add_direction", add_direction), (JUMPS, "add_normal", add_normal), (JUMPS, "add_shadow", add_shadow)],
        -1, False,
    ),
}  # fmt: skip
"""Walls of spheres and planes, by class: what stands in for what, ``TAG`` and ``PAIRS``."""
FLAT: Final[dict[str, Places]] = {
    "contacts": [(TABLE, "contacts", none)],
    "hulls of shadows": [(BREAKS, "_around", none), (BREAKS, "_cone_edges", none)],
    "hulls of penumbrae": [(BREAKS, "_around", none)],
    "planes of lamps": [(BREAKS, "_lamp_planes", none)],
    "pyramids about spots": [(BREAKS, "_cone_edges", none)],
    "outer edges of meshes": [(BREAKS, "_outer_edges", none)],
    "fields of textures": [(FOREST, "field_lines", none)],
}
"""Walls of flat faces, by class."""


def leave_out(places: Places, tag: int = -1, pairs: bool = False) -> Places:
    """Put stand-ins in the place of functions; returns what puts these back."""
    global TAG, PAIRS
    TAG, PAIRS = tag, pairs
    before: Places = []
    for module, name, stand_in in places:
        holder = import_module(module)
        before.append((module, name, getattr(holder, name)))
        setattr(holder, name, stand_in)
    return before
