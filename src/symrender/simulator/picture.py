"""The picture a page shows where no program may run: the page's own program, run here point by point.

It needs no compiler, so that a page is written as quickly as its text: a few thousand pixels, few directions a lobe.
"""

from __future__ import annotations

import io
from collections.abc import Callable, Iterable
from functools import cache
from types import SimpleNamespace
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from symrender.images.srgb import encode_srgb
from symrender.jit.records import Record
from symrender.kernel.assemble_pixels import TABLES, pixel_program
from symrender.quadrature.light_points import light_rows
from symrender.scene import arrays as at
from symrender.scene.arrays import lobes_of
from symrender.scene.scene import Scene

Array = npt.NDArray[np.float64]

SIZE: Final = 72
_SHOWN: Final = 384
_DISK_STRATA: Final = 2
_SIDE: Final = 2
_EQUAL_WEIGHT: Final = 2
_ONCE: Final = ("camera_axes", "stand_planes", "fill_lobe", "fill_sectors")
_PIXEL: Final = ("pixel_seen", "pixel_direct", "pixel_symbolic")


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
    from symrender.runtimes import numba as runtime
    from symrender.targets import numba as target

    program = pixel_program()
    return {name: getattr(runtime.plain(target.emit(program.part(name))), name) for name in (*_ONCE, *_PIXEL)}


def _radiance(scene: Scene) -> Array:
    """Linear radiance (SIZE, SIZE, 3)."""
    call, arrays = _functions(), at.scene_arrays(scene)
    rows = len(lobes_of(arrays))
    lights = light_rows(arrays, _DISK_STRATA)
    tables: dict[str, Array] = {
        "eye": arrays.camera.eye,
        "points": np.hstack([lights["position"], lights["color"]]),
        "image_frame": np.array([0.0, 0.0, SIZE, SIZE, SIZE, SIZE, 1.0]),
        "axes": np.zeros(TABLES["axes"].columns),
        "seen": np.zeros(TABLES["seen"].columns),
        "hits": np.zeros(TABLES["hits"].columns),
        "lobes": np.zeros((rows, TABLES["lobes"].columns)),
        "rings": np.zeros((rows * _SIDE, TABLES["rings"].columns)),
        "sectors": np.zeros((_SIDE, TABLES["sectors"].columns)),
        "estimate": np.array([_SIDE, 0.0, 0.0, _SIDE, -np.inf, 0.0]),
    }
    if arrays.camera.kind == at.LOOK_AT:
        call["camera_axes"](arrays.camera, tables["axes"])
    for row, (weight, exponent, theta_max) in enumerate(lobes_of(arrays).tolist()):
        if weight > 0.0:
            rule = (_SIDE, _SIDE, _EQUAL_WEIGHT, 0, 0, 0, 0.0)
            call["fill_lobe"](row, exponent, theta_max, *rule, tables["lobes"], tables["rings"])
    call["fill_sectors"](_SIDE, tables["sectors"])
    # tables and records are read number by number, which plain lists and objects do several times as fast as arrays
    plain: dict[str, Any] = {name: table.tolist() for name, table in tables.items()}
    plain |= {name: _Rows(tables[name]) for name in ("points", "lobes", "rings", "sectors")}
    plain |= {name: _plain(getattr(arrays, name)) for name in ("floor", "shading", "camera")}
    plain |= {name: _Records(getattr(arrays, name)) for name in ("spheres", "planes")}
    call["stand_planes"](plain["planes"])
    program = {f.name: f for f in pixel_program().functions}
    taken = {name: [plain[p.name] for p in program[name].parameters[2:]] for name in _PIXEL}
    found = np.zeros((SIZE, SIZE, 3))
    for row in range(SIZE):
        for column in range(SIZE):
            call["pixel_seen"](column, row, *taken["pixel_seen"])
            direct = call["pixel_direct"](column, row, *taken["pixel_direct"])
            gloss = call["pixel_symbolic"](column, row, *taken["pixel_symbolic"])
            found[row, column] = [direct[c] + gloss[3] * gloss[c] for c in range(3)]
    return found


def _plain(row: Record) -> SimpleNamespace:
    """A record as a plain object."""
    return SimpleNamespace(**{name: np.asarray(getattr(row, name)).tolist() for name in row.names()})


class _Records(list[SimpleNamespace]):
    """A table of records as the program reads it: ``table[row].radius`` and ``table.shape``."""

    def __init__(self, rows: Iterable[Record]) -> None:
        super().__init__(map(_plain, rows))
        self.shape = (len(self),)


class _Rows:
    """A table of two axes as the program reads it: ``table[row, column]`` and ``table.shape``."""

    def __init__(self, table: Array) -> None:
        self.rows, self.shape = table.tolist(), table.shape

    def __getitem__(self, place: tuple[int, int]) -> float:
        row, column = place
        return float(self.rows[row][column])
