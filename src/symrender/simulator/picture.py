"""The picture a page shows where no program may run: the page's own program, run here point by point.

It needs no compiler, so that a page is written as quickly as its text: a few thousand pixels, few directions a lobe.
"""

from __future__ import annotations

import io
from collections.abc import Callable
from functools import cache
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from symrender.images.srgb import encode_srgb
from symrender.kernel.assemble_pixels import TABLES, pixel_program
from symrender.quadrature.light_points import light_rows
from symrender.scene import arrays as at
from symrender.scene.scene import Scene

Array = npt.NDArray[np.float64]

SIZE: Final = 72
_SHOWN: Final = 384
_DISK_STRATA: Final = 2
_SIDE: Final = 2
_EQUAL_WEIGHT: Final = 2
_USED: Final = ("camera_axes", "fill_lobe", "fill_sectors", "pixel_seen", "pixel_direct", "pixel_symbolic")


def picture(scene: Scene) -> bytes:
    """``scene`` as a small JPEG: SIZE x SIZE pixels, each lobe by 2 x 2 directions of equal weight, shown larger."""
    from PIL import Image

    pixels = Image.fromarray(encode_srgb(np.clip(_radiance(scene), 0.0, 1.0)))
    file = io.BytesIO()
    pixels.resize((_SHOWN, _SHOWN), Image.Resampling.BICUBIC).save(file, "JPEG", quality=84, optimize=True)
    return file.getvalue()


@cache
def _functions() -> dict[str, Callable[..., Any]]:
    """What a picture takes of the program, as plain Python functions."""
    from symrender.targets import numba

    program, held = pixel_program(), dict[str, Any]()
    for name in _USED:
        exec(compile(numba.emit(program.part(name)), name, "exec"), held)  # noqa: S102 (the text is our own, of no scene)
    return held


def _radiance(scene: Scene) -> Array:
    """Linear radiance (SIZE, SIZE, 3)."""
    call, arrays = _functions(), at.scene_arrays(scene)
    rows = len(arrays.spheres) + 1
    tables: dict[str, Array] = {
        "spheres": arrays.spheres,
        "floor": arrays.floor,
        "shading": arrays.shading,
        "camera": arrays.camera,
        "eye": arrays.camera[1:4],
        "points": light_rows(arrays, _DISK_STRATA),
        "image_frame": np.array([0.0, 0.0, SIZE, SIZE, SIZE, SIZE, 1.0]),
        "axes": np.zeros(TABLES["axes"].columns),
        "seen": np.zeros(TABLES["seen"].columns),
        "hits": np.zeros(TABLES["hits"].columns),
        "lobes": np.zeros((rows, TABLES["lobes"].columns)),
        "rings": np.zeros((rows * _SIDE, TABLES["rings"].columns)),
        "sectors": np.zeros((_SIDE, TABLES["sectors"].columns)),
        "estimate": np.array([_SIDE, 0.0, 0.0, _SIDE, -np.inf, 0.0]),
    }
    if arrays.camera[0] == at.LOOK_AT:
        call["camera_axes"](tables["camera"], tables["axes"])
    weights = [arrays.floor[at.FLOOR_LOBE :], *(row[at.LOBE :] for row in arrays.spheres)]
    for row, (weight, exponent, theta_max) in enumerate(w[:3] for w in weights):
        if weight > 0.0:
            rule = (_SIDE, _SIDE, _EQUAL_WEIGHT, 0, 0, 0, 0.0)
            call["fill_lobe"](row, exponent, theta_max, *rule, tables["lobes"], tables["rings"])
    call["fill_sectors"](_SIDE, tables["sectors"])
    # rows of tables are read number by number, which plain lists do several times as fast as arrays
    plain: dict[str, Any] = {name: table.tolist() for name, table in tables.items()}
    plain |= {name: _Rows(tables[name]) for name in ("spheres", "points", "lobes", "rings", "sectors")}
    program = {f.name: f for f in pixel_program().functions}
    taken = {name: [plain[p.name] for p in program[name].parameters[2:]] for name in _USED[3:]}
    found = np.zeros((SIZE, SIZE, 3))
    for row in range(SIZE):
        for column in range(SIZE):
            call["pixel_seen"](column, row, *taken["pixel_seen"])
            direct = call["pixel_direct"](column, row, *taken["pixel_direct"])
            gloss = call["pixel_symbolic"](column, row, *taken["pixel_symbolic"])
            found[row, column] = [direct[c] + gloss[3] * gloss[c] for c in range(3)]
    return found


class _Rows:
    """A table of two axes as the program reads it: ``table[row, column]`` and ``table.shape``."""

    def __init__(self, table: Array) -> None:
        self.rows, self.shape = table.tolist(), table.shape

    def __getitem__(self, place: tuple[int, int]) -> float:
        row, column = place
        return float(self.rows[row][column])
