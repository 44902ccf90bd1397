"""Calls: Python's own functions, ``math``, ``np``, named tuples, and functions of the package."""

from __future__ import annotations

import ast
import builtins
import math
from types import FunctionType
from typing import Any, Final

import numpy as np

from symrender.jit.arithmetic import literal
from symrender.jit.moving import held, most, moved, moves, rising, tangent
from symrender.jit.places import Places
from symrender.jit.types import B1, F8, I8, M8, MOVING, U8, V8, W8, Array, Bundle, Scalar, Static, Tuple, Value, shown

_UNARY: Final[dict[object, str]] = {
    math.sqrt: "llvm.sqrt.f64", math.exp: "llvm.exp.f64", math.log: "llvm.log.f64", math.log10: "llvm.log10.f64",
    math.sin: "llvm.sin.f64", math.cos: "llvm.cos.f64", math.fabs: "llvm.fabs.f64",
    np.floor: "llvm.floor.f64", np.ceil: "llvm.ceil.f64",
} | {
    getattr(math, name): name
    for name in ("log1p", "expm1", "tan", "asin", "acos", "atan", "asinh", "acosh", "atanh", "sinh", "cosh", "tanh",
                 "log2", "erf", "erfc")
}  # fmt: skip
_BINARY: Final[dict[object, str]] = {
    math.atan2: "atan2", math.hypot: "hypot", math.copysign: "llvm.copysign.f64", math.pow: "llvm.pow.f64",
}  # fmt: skip
_ROUNDED: Final[dict[object, str]] = {
    math.floor: "llvm.floor.f64", math.ceil: "llvm.ceil.f64", math.trunc: "llvm.trunc.f64",
}  # fmt: skip
_CONVERTED: Final[dict[object, Scalar]] = {
    float: F8, np.float64: F8, int: I8, np.int64: I8, bool: B1, np.bool_: B1, np.uint64: U8,
}  # fmt: skip


class Calls(Places):
    """Values of calls; the arguments are values already."""

    def call(self, callee: Any, values: list[Value], names: dict[str, Value]) -> Value:
        """``callee(*values, **names)``."""
        if callee in (moves, held, tangent, moved, most, rising):
            return self._of_tangents(callee, values)
        if isinstance(callee, FunctionType):
            return self.call_function(callee, values, names)
        if isinstance(callee, type) and issubclass(callee, tuple) and hasattr(callee, "_fields"):
            return self._named_tuple(callee, values, names)
        if names:
            raise self.refuse(f"a named argument of {callee!r}")
        return self._call_known(callee, values)

    def _of_tangents(self, callee: Any, values: list[Value]) -> Value:
        """The functions of ``moving.py``."""
        value = self.number(values[0])
        if callee is moves:
            return literal(value.type in MOVING)
        if callee is moved:
            first, slope = self.convert(self.still(value), F8), self.still(self.number(values[1]))
            several = slope.type == V8
            slope = slope if several else self.convert(slope, F8)
            return Value(W8 if several else M8, (first.parts[0], slope.parts[0]))
        if callee is held:
            return self.still(value)
        if callee is most:
            return self.largest(value) if value.type == V8 else value
        if callee is rising:
            return self.signs(value if value.type == V8 else self.convert(self.still(value), F8))
        return Value(F8 if value.type == M8 else V8, (value.parts[1],)) if value.type in MOVING else literal(0.0)

    def call_function(self, callee: FunctionType, values: list[Value], names: dict[str, Value]) -> Value:
        """Call of a function that is translated too."""
        raise NotImplementedError

    def _call_known(self, callee: Any, values: list[Value]) -> Value:
        try:
            hash(callee)
        except TypeError:
            raise self.refuse(f"{callee!r} is called") from None
        count = len(values)
        match callee:
            case _ if callee in _UNARY and count == 1:
                return self._external(_UNARY[callee], values)
            case _ if callee in _BINARY and count == 2:
                return self._external(_BINARY[callee], values)
            case _ if callee in _ROUNDED and count == 1:
                value = self.number(values[0])
                return value if value.type == I8 else self.convert(self._external(_ROUNDED[callee], [value]), I8)
            case _ if callee in _CONVERTED and count == 1:
                value, wanted = self._scalar_only(values[0]), _CONVERTED[callee]
                return value if value.type in (V8, *MOVING) and wanted == F8 else self.convert(value, wanted)
            case builtins.max | builtins.min:
                if count == 1 and isinstance(values[0].type, Tuple):
                    values = self.items(values[0])
                if len(values) < 2:
                    raise self.refuse(f"{callee.__name__} of {count} arguments")
                return self.extreme(ast.Gt() if callee is max else ast.Lt(), values)
            case builtins.abs if count == 1:
                return self.absolute(values[0])
            case builtins.len if count == 1:
                return self._length(values[0])
        return self._call_rare(callee, values)

    def _call_rare(self, callee: Any, values: list[Value]) -> Value:
        match callee, values:
            case math.isnan, [value]:
                (x,) = self.convert(self.number(self.still(value)), F8).parts
                return Value(B1, (self.op(f"fcmp uno double {x}, {x}"),))
            case ((math.isinf | math.isfinite), [value]):
                (x,) = self.absolute(self.convert(self.number(self.still(value)), F8)).parts
                kind = "oeq" if callee is math.isinf else "olt"
                return Value(B1, (self.op(f"fcmp {kind} double {x}, {literal(math.inf).parts[0]}"),))
            case math.ldexp, [value, exponent] if value.type not in MOVING:
                (x,) = self.convert(self.number(value), F8).parts
                (n,) = self._scalar_only(exponent).parts
                if exponent.type != I8:
                    raise self.refuse("the exponent of ldexp is no whole number")
                cut = self.op(f"trunc i64 {n} to i32")
                return Value(F8, (self.op(f"call double {self.module.runtime('ldexp')}(double {x}, i32 {cut})"),))
        name = getattr(callee, "__qualname__", repr(callee))
        module = getattr(callee, "__module__", "") or ""
        raise self.refuse(f"a call of {module}.{name} with {len(values)} arguments is outside the subset")

    def _external(self, name: str, values: list[Value]) -> Value:
        numbers = [value if value.type in MOVING else self.convert(self.number(value), F8) for value in values]
        if any(value.type in MOVING for value in numbers):
            if name == "llvm.pow.f64":
                return self.moving_power(*numbers)
            return self.moving_call(name, numbers)
        return Value(F8, (self.external(name, *(value.parts[0] for value in numbers)),))

    def _scalar_only(self, value: Value) -> Value:
        if not isinstance(value.type, Scalar):
            raise self.refuse(f"a number is wanted, not {shown(value.type)}")
        return value

    def _length(self, value: Value) -> Value:
        match value.type:
            case Tuple(items=items) | Bundle(items=items):
                return literal(len(items))
            case Array():
                return Value(I8, (value.parts[1],))
            case Static(value=str() as text):
                return literal(len(text))
        raise self.refuse(f"len of {shown(value.type)}")

    def _named_tuple(self, callee: Any, values: list[Value], names: dict[str, Value]) -> Value:
        fields: tuple[str, ...] = callee._fields
        given = dict(zip(fields, values, strict=False)) | names
        if set(given) != set(fields) or len(values) + len(names) != len(fields):
            raise self.refuse(f"{callee.__name__} takes {', '.join(fields)}")
        parts = tuple(part for field in fields for part in given[field].parts)
        return Value(Tuple(tuple(given[field].type for field in fields), fields), parts)
