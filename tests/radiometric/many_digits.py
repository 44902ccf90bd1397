"""The pushed kernel run in 50 digits: what roundings do to a derivative is the difference to it."""

from __future__ import annotations

import functools
import inspect
from types import SimpleNamespace
from typing import Any

import mpmath
import numpy as np

from symrender.radiometric import rules
from symrender.radiometric.arcs import Room
from symrender.radiometric.sky import sky_room
from symrender.radiometric.slopes import pushed_text
from symrender.radiometric.world import Seen, World

MP = mpmath.mp.clone()
MP.dps = 50


class _Math:
    """What kernels use of ``math``, in many digits."""

    pi, inf = MP.pi * 1, MP.inf
    sqrt, exp, log, sin, cos, tan, erf = MP.sqrt, MP.exp, MP.log, MP.sin, MP.cos, MP.tan, MP.erf
    acos, atan2, floor, log1p, expm1 = MP.acos, MP.atan2, MP.floor, MP.log1p, MP.expm1


def _loaded(text: str, **names: Any) -> SimpleNamespace:
    """A module's text with other names in place of what it imports."""
    space: dict[str, Any] = {"__name__": "many_digits"}
    exec(compile(text, "<many digits>", "exec", dont_inherit=True), space)  # noqa: S102
    space |= {"math": _Math} | names
    return SimpleNamespace(**space)


_RULES = _loaded(inspect.getsource(rules))
_KERNEL = _loaded(pushed_text(), rules=_RULES)


@functools.lru_cache(maxsize=4096)
def _digits(value: float) -> Any:
    """A number in many digits; most of them are zeros of rooms that are still empty."""
    return MP.mpf(value)


def _exact(value: Any) -> Any:
    """Numbers of records and arrays in many digits."""
    if isinstance(value, np.ndarray) and value.dtype.names is None:
        return np.array([_digits(x) for x in value.ravel().tolist()], dtype=object).reshape(value.shape)
    return _digits(float(value))


def _record(row: Any) -> SimpleNamespace:
    return SimpleNamespace(**{name: _exact(row[name]) for name in row.dtype.names})


class _Rows(list[Any]):
    @property
    def shape(self) -> tuple[int, ...]:
        return (len(self),)


def _world(world: World) -> World:
    return World(*(_Rows(_record(row) for row in part) for part in world))  # type: ignore[arg-type]


def value_and_slope(view: Seen, moves: Seen) -> tuple[list[Any], int, list[Any]]:
    """Radiance of the one pixel, its hit class, and its slope."""

    def zeros(*shape: int) -> Any:
        return np.array([MP.mpf(0)] * int(np.prod(shape)), dtype=object).reshape(shape)

    def layers() -> tuple[Any, ...]:
        return zeros(1, 1, 3), zeros(1, 1, 3), zeros(1, 1)

    def room() -> Room:
        arcs, crossings, *numbers = sky_room(view.world)
        rows = [_Rows(_record(row) for row in part) for part in (arcs, crossings)]
        return Room(*rows, *map(_exact, numbers))  # type: ignore[arg-type]

    values, slopes = layers(), layers()
    _KERNEL.fill_tile_dot(
        _world(view.world), _exact(view.eye), _exact(view.window), 1, 1, 0, 0, 1, 1, room(), *values,
        _world(moves.world), _exact(moves.eye), _exact(moves.window), room(), *slopes,
    )  # fmt: skip
    radiance, slope = (
        [emitted[0, 0, c] + direct[0, 0, c] for c in range(3)] for emitted, direct, _ in (values, slopes)
    )
    return radiance, int(values[2][0, 0]), slope
