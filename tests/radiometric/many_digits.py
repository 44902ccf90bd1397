"""The kernel of an image run in 50 digits on dual numbers: what rounding does to a derivative is the difference to it.

The rules of calculus here are the test's own; kernels are plain Python and are run as they stand, with every float a
``Dual`` of mpmath numbers.
"""

from __future__ import annotations

import builtins
import functools
from collections.abc import Callable
from types import FunctionType, ModuleType, SimpleNamespace
from typing import Any

import mpmath
import numpy as np

from symrender.jit import moving
from symrender.radiometric import tile
from symrender.radiometric.arcs import Room
from symrender.radiometric.sky import sky_room
from symrender.radiometric.world import Seen, World

MP = mpmath.mp.clone()
MP.dps = 50


@functools.total_ordering
class Dual:
    """A number and its derivative."""

    __slots__ = ("slope", "value")

    def __init__(self, value: Any, slope: Any = 0) -> None:
        self.value, self.slope = MP.mpf(value), MP.mpf(slope)

    def __add__(self, other: Any) -> Dual:
        b = dual(other)
        return Dual(self.value + b.value, self.slope + b.slope)

    def __sub__(self, other: Any) -> Dual:
        b = dual(other)
        return Dual(self.value - b.value, self.slope - b.slope)

    def __mul__(self, other: Any) -> Dual:
        b = dual(other)
        return Dual(self.value * b.value, self.slope * b.value + self.value * b.slope)

    def __truediv__(self, other: Any) -> Dual:
        b = dual(other)
        if b.value == 0:
            return Dual(MP.nan if self.value == 0 else MP.sign(self.value) * MP.inf, MP.nan)
        return Dual(self.value / b.value, (self.slope - self.value / b.value * b.slope) / b.value)

    __radd__, __rmul__ = __add__, __mul__

    def __rsub__(self, other: Any) -> Dual:
        return dual(other) - self

    def __rtruediv__(self, other: Any) -> Dual:
        return dual(other) / self

    def __pow__(self, power: int) -> Dual:
        assert power == 2
        return self * self

    def __neg__(self) -> Dual:
        return Dual(-self.value, -self.slope)

    def __abs__(self) -> Dual:
        return -self if self.value < 0 else self

    def __int__(self) -> int:
        return int(self.value)

    def __float__(self) -> float:
        return float(self.value)

    def __eq__(self, other: object) -> bool:
        return bool(self.value == dual(other).value)

    def __lt__(self, other: Any) -> bool:
        return bool(self.value < dual(other).value)

    def __hash__(self) -> int:
        return hash(self.value)


def dual(x: Any) -> Dual:
    return x if isinstance(x, Dual) else Dual(x)


def _of_one(function: Callable[[Any], Any], slope: Callable[[Any], Any]) -> Callable[[Any], Dual]:
    def result(x: Any) -> Dual:
        a = dual(x)
        # what stands still has no slope, however steep the function
        return Dual(function(a.value), slope(a.value) * a.slope if a.slope != 0 else 0)

    return result


def _atan2(y: Any, x: Any) -> Dual:
    b, a = dual(y), dual(x)
    size = a.value**2 + b.value**2
    return Dual(MP.atan2(b.value, a.value), (a.value * b.slope - b.value * a.slope) / size if size else 0)


def _floor(x: Any) -> int:
    return int(MP.floor(dual(x).value))


def _inverse_root(x: Any) -> Any:
    return 1 / MP.sqrt(x) if x > 0 else MP.inf


_MATH = SimpleNamespace(
    pi=MP.pi * 1,
    inf=MP.inf,
    sqrt=_of_one(MP.sqrt, lambda x: _inverse_root(x) / 2),
    exp=_of_one(MP.exp, MP.exp),
    expm1=_of_one(MP.expm1, MP.exp),
    log=_of_one(MP.log, lambda x: 1 / x),
    log1p=_of_one(MP.log1p, lambda x: 1 / (1 + x)),
    sin=_of_one(MP.sin, MP.cos),
    cos=_of_one(MP.cos, lambda x: -MP.sin(x)),
    tan=_of_one(MP.tan, lambda x: 1 + MP.tan(x) ** 2),
    erf=_of_one(MP.erf, lambda x: 2 / MP.sqrt(MP.pi) * MP.exp(-x * x)),
    acos=_of_one(MP.acos, lambda x: -_inverse_root(1 - x * x)),
    asin=_of_one(MP.asin, lambda x: _inverse_root(1 - x * x)),
    atan2=_atan2,
    floor=_floor,
)
"""What kernels use of ``math``, in many digits."""


class _Module:
    """A module of the package whose functions are rebound when they are looked up."""

    def __init__(self, module: ModuleType) -> None:
        self._module = module

    def __getattr__(self, name: str) -> Any:
        return _rebound(getattr(self._module, name))


@functools.cache
def _rebound_function(function: FunctionType) -> FunctionType:
    known = function.__globals__
    names = {name: _rebound(known[name]) for name in function.__code__.co_names if name in known}
    return FunctionType(function.__code__, {"__builtins__": builtins, **names}, function.__name__)


def _rebound(value: Any) -> Any:
    """A global of a kernel as the kernel shall see it."""
    if isinstance(value, FunctionType) and value.__module__.startswith("symrender."):
        # a value that is held keeps its slope: the derivative is the exact one
        return dual if value is moving.held else _rebound_function(value)
    if isinstance(value, ModuleType):
        return _MATH if value.__name__ == "math" else _Module(value)
    return value


@functools.lru_cache(maxsize=4096)
def _still(value: float) -> Dual:
    """A number that stands still; most are the zeros of scratch."""
    return Dual(value)


def _exact(value: Any, slope: Any = None) -> Any:
    """Numbers of records and arrays in many digits."""
    if not isinstance(value, np.ndarray):
        return _still(float(value)) if slope is None or slope == 0 else Dual(float(value), float(slope))
    slopes = np.zeros(value.shape) if slope is None else slope
    pairs = zip(value.ravel().tolist(), np.asarray(slopes).ravel().tolist(), strict=True)
    made = np.empty(value.size, dtype=object)
    made[:] = [_exact(*pair) for pair in pairs]
    return made.reshape(value.shape)


def _record(row: Any, slope: Any = None) -> SimpleNamespace:
    return SimpleNamespace(
        **{name: _exact(row[name], None if slope is None else slope[name]) for name in row.dtype.names}
    )


class _Rows(list[Any]):
    @property
    def shape(self) -> tuple[int, ...]:
        return (len(self),)


def _world(world: World, moves: World) -> World:
    *tables, level = world
    parts = (
        _Rows(_record(*pair) for pair in zip(part, slopes, strict=True))
        for part, slopes in zip(tables, moves[:-1], strict=True)
    )
    return World(*parts, level)  # type: ignore[arg-type]


def value_and_slope(view: Seen, moves: Seen) -> tuple[list[Any], int, list[Any]]:
    """Radiance of the one pixel, its hit class, and its derivative."""
    emitted, direct, hit_class = (_exact(np.zeros(shape)) for shape in ((1, 1, 3), (1, 1, 3), (1, 1)))
    arcs, crossings, *numbers = sky_room(view.world)
    rows = [_Rows(_record(row) for row in part) for part in (arcs, crossings)]
    room = Room(*rows, *(_exact(part) for part in numbers))  # type: ignore[arg-type]
    _rebound(tile.fill_tile)(
        _world(view.world, moves.world), _exact(view.eye, moves.eye), _exact(view.window, moves.window), 1, 1,
        0, 0, 1, 1, room, emitted, direct, hit_class,
    )  # fmt: skip
    radiance = [dual(emitted[0, 0, c] + direct[0, 0, c]) for c in range(3)]
    return [each.value for each in radiance], int(hit_class[0, 0]), [each.slope for each in radiance]
