"""Numbers: operators, comparisons, conversions, as Numba's strict NumPy error model has them.

Integers wrap; ``//`` and ``%`` round towards minus infinity; dividing an integer by 0 gives 0; a whole literal exponent
is done by repeated squaring; ``max(a, b)`` is ``b if b > a else a``.
"""

from __future__ import annotations

import ast
from typing import Final

from symrender.jit.body import double, whole
from symrender.jit.tangents import ABS, Tangents, aligned
from symrender.jit.types import (
    B1,
    F8,
    I8,
    LANES,
    M8,
    MOVING,
    U8,
    V8,
    W8,
    Array,
    Element,
    Scalar,
    Tuple,
    Type,
    Value,
    join,
    parts_of,
    shown,
    slopes_of,
)

TRUE: Final = Value(B1, ("true",))
FALSE: Final = Value(B1, ("false",))

_FLOAT: Final = {ast.Add: "fadd", ast.Sub: "fsub", ast.Mult: "fmul", ast.Div: "fdiv"}
_INT: Final = {ast.Add: "add", ast.Sub: "sub", ast.Mult: "mul"}
_BITS: Final = {ast.BitAnd: "and", ast.BitOr: "or", ast.BitXor: "xor", ast.LShift: "shl", ast.RShift: "ashr"}
_COMPARE: Final[dict[type[ast.cmpop], tuple[str, str]]] = {
    ast.Eq: ("oeq", "eq"), ast.NotEq: ("une", "ne"), ast.Lt: ("olt", "lt"),
    ast.LtE: ("ole", "le"), ast.Gt: ("ogt", "gt"), ast.GtE: ("oge", "ge"),
}  # fmt: skip
_MOST_SQUARED: Final = 0x10000


def literal(number: bool | int | float) -> Value:
    """Value of a number in the text."""
    if isinstance(number, bool):
        return TRUE if number else FALSE
    if isinstance(number, int):
        return Value(I8, (str((number + 2**63) % 2**64 - 2**63),))
    return Value(F8, (double(number),))


class Arithmetic(Tangents):
    """What is done with numbers."""

    def number(self, value: Value) -> Value:
        """The value, a truth value as a whole number."""
        if not isinstance(value.type, Scalar):
            raise self.refuse(f"a number is wanted, not {shown(value.type)}")
        return self.convert(value, I8) if value.type == B1 else value

    def convert(self, value: Value, type: Type) -> Value:
        """The value in a wider type, or the same."""
        if value.type == type:
            return value
        match value.type, type:
            case Scalar(), Scalar():
                return self._scalar(value, type)
            case Array(), Array() if value.type.contiguous and not type.contiguous:
                strides = self.strides(value)
                return Value(type, (*value.parts, *strides))
            case Tuple(), Tuple() if len(value.type.items) == len(type.items):
                pairs = zip(self.items(value), type.items, strict=True)
                return Value(type, tuple(part for item, wanted in pairs for part in self.convert(item, wanted).parts))
        raise self.refuse(f"{shown(value.type)} cannot become {shown(type)}")

    def items(self, value: Value) -> list[Value]:
        """Values of a tuple's items."""
        raise NotImplementedError

    def strides(self, value: Value) -> list[str]:
        """Bytes between neighbours along each axis of an array."""
        raise NotImplementedError

    def _scalar(self, value: Value, type: Scalar) -> Value:
        operand = value.parts[0]
        known = whole(operand)
        if type == W8 and value.type == M8:
            return Value(W8, (operand, self.spread(V8, value.parts[1])))
        if type in MOVING:
            number = operand if value.type == F8 else self._scalar(value, F8).parts[0]
            return Value(type, (number, double(0.0) if type == M8 else "zeroinitializer"))
        if type == V8:
            return Value(V8, (self.spread(V8, self.convert(value, F8).parts[0]),))
        if value.type == V8:
            raise self.refuse("tangents where a number is wanted")
        if value.type in MOVING:
            if type == F8:
                raise self.refuse("a number with a tangent where none has room")
            return self._scalar(self.still(value), type)
        match value.type, type:
            case _, _ if value.type == B1 and operand in ("true", "false"):
                return self._scalar(literal(int(operand == "true")), type)
            case _, _ if value.type == I8 and type == F8 and known is not None:
                return literal(float(known))
            case _, _ if {value.type, type} == {I8, U8}:
                return Value(type, (operand,))
        if type == B1:
            return self.truth(value)
        if value.type == F8:
            return Value(type, (self.op(f"{'fptosi' if type == I8 else 'fptoui'} double {operand} to i64"),))
        if type == F8:
            assert isinstance(value.type, Scalar)
            kind = "sitofp" if value.type == I8 else "uitofp"
            return Value(F8, (self.op(f"{kind} {value.type.llvm} {operand} to double"),))
        return Value(type, (self.op(f"zext i1 {operand} to i64"),))

    def truth(self, value: Value) -> Value:
        """Whether a number is not 0."""
        value = self.still(value)
        (operand,) = value.parts or ("",)
        if value.type == B1:
            return value
        if value.type == F8:
            return Value(B1, (self.op(f"fcmp une double {operand}, 0.0"),))
        if value.type in (I8, U8):
            return Value(B1, (self.op(f"icmp ne i64 {operand}, 0"),))
        raise self.refuse(f"{shown(value.type)} is no condition")

    def alike(self, a: Value, b: Value) -> tuple[Value, Value]:
        """Both as numbers of the wider type."""
        a, b = self.number(a), self.number(b)
        for moving in MOVING:
            if U8 in (a.type, b.type) and moving in (a.type, b.type):
                return self.convert(a, moving), self.convert(b, moving)
        if {a.type, b.type} == {U8, F8}:
            return self.convert(a, F8), self.convert(b, F8)
        if a.type != b.type and U8 in (a.type, b.type):
            raise self.refuse("uint64 meets int64: convert one of them")
        wide = join(a.type, b.type)
        return self.convert(a, wide), self.convert(b, wide)

    def binary(self, op: ast.operator, a: Value, b: Value) -> Value:
        """``a op b`` of numbers."""
        kind = type(op)
        if kind is ast.Pow:
            return self.power(a, b)
        if kind in _BITS:
            return self._bitwise(kind, a, b)
        if a.type in MOVING or b.type in MOVING:
            return self.moving_binary(kind, self.number(a), self.number(b))
        a, b = self.alike(a, b)
        if a.type == V8 and kind in _FLOAT:
            return Value(V8, (self.op(f"{_FLOAT[kind]} {V8.llvm} {a.parts[0]}, {b.parts[0]}"),))
        if kind is ast.Div:
            a, b = self.convert(a, F8), self.convert(b, F8)
        (x,), (y,) = a.parts, b.parts
        if kind in (ast.FloorDiv, ast.Mod):
            return self._divided(kind is ast.FloorDiv, a, b)
        if a.type == F8 and kind in _FLOAT:
            return Value(F8, (self.op(f"{_FLOAT[kind]} double {x}, {y}"),))
        if kind in _INT:
            m, n = whole(x), whole(y)
            if m is not None and n is not None and a.type == I8:
                return literal(m + n if kind is ast.Add else m - n if kind is ast.Sub else m * n)
            return Value(a.type, (self.op(f"{_INT[kind]} i64 {x}, {y}"),))
        raise self.refuse(f"operator {kind.__name__} is outside the subset")

    def _bitwise(self, kind: type[ast.operator], a: Value, b: Value) -> Value:
        name = _BITS[kind]
        if a.type == b.type == B1 and kind in (ast.BitAnd, ast.BitOr, ast.BitXor):
            return Value(B1, (self.op(f"{name} i1 {a.parts[0]}, {b.parts[0]}"),))
        a, b = self.alike(a, b)
        if a.type in (F8, V8, *MOVING):
            raise self.refuse("bits of a float")
        if a.type == U8 and kind is ast.RShift:
            name = "lshr"
        return Value(a.type, (self.op(f"{name} i64 {a.parts[0]}, {b.parts[0]}"),))

    def _divided(self, quotient: bool, a: Value, b: Value) -> Value:
        (x,), (y,) = a.parts, b.parts
        if a.type == F8:
            name = self.module.runtime("float_floordiv" if quotient else "float_mod")
            return Value(F8, (self.op(f"call double {name}(double {x}, double {y})"),))
        if a.type == U8:
            raise self.refuse("// and % of uint64")
        if (whole(y) or 0) > 0:
            rest = self.op(f"srem i64 {x}, {y}")
            low = self.op(f"icmp slt i64 {rest}, 0")
            if quotient:
                cut = self.op(f"sdiv i64 {x}, {y}")
                less = self.op(f"sub i64 {cut}, 1")
                return Value(I8, (self.op(f"select i1 {low}, i64 {less}, i64 {cut}"),))
            more = self.op(f"add i64 {rest}, {y}")
            return Value(I8, (self.op(f"select i1 {low}, i64 {more}, i64 {rest}"),))
        name = self.module.runtime("int_floordiv" if quotient else "int_mod")
        return Value(I8, (self.op(f"call i64 {name}(i64 {x}, i64 {y})"),))

    def power(self, a: Value, b: Value) -> Value:
        """``a ** b``."""
        a, b = self.number(a), self.number(b)
        exponent = whole(b.parts[0]) if b.type == I8 else None
        if exponent is not None and abs(exponent) <= _MOST_SQUARED:
            return self._moving_whole_power(a, exponent) if a.type in MOVING else self._whole_power(a, exponent)
        if a.type in MOVING or b.type in MOVING:
            a, b = (value if value.type in MOVING else self.convert(value, F8) for value in (a, b))
            return self.moving_power(a, b)
        if a.type == F8 and b.type == I8:
            name = self.module.runtime("float_power")
            return Value(F8, (self.op(f"call double {name}(double {a.parts[0]}, i64 {b.parts[0]})"),))
        if b.type != F8:
            raise self.refuse(f"{shown(a.type)} ** {shown(b.type)} is outside the subset")
        a = self.convert(a, F8)
        name = self.module.runtime("llvm.pow.f64")
        return Value(F8, (self.op(f"call double {name}(double {a.parts[0]}, double {b.parts[0]})"),))

    def _whole_power(self, a: Value, exponent: int) -> Value:
        if a.type != F8 and exponent < 0:
            raise self.refuse("a negative power of a whole number")
        kind = "fmul double" if a.type == F8 else "mul i64"
        result, factor = ("1.0" if a.type == F8 else "1"), a.parts[0]
        left = abs(exponent)
        while left:
            if left & 1:
                result = self.op(f"{kind} {result}, {factor}")
            left >>= 1
            if left:
                factor = self.op(f"{kind} {factor}, {factor}")
        if exponent < 0:
            result = self.op(f"fdiv double 1.0, {result}")
        return Value(a.type, (result,))

    def _moving_whole_power(self, a: Value, exponent: int) -> Value:
        """The value by squaring as without a tangent; the slope is n a^(n - 1) times the tangent."""
        value, lower = self._whole_power(self.still(a), exponent), self._whole_power(self.still(a), exponent - 1)
        if exponent == 0:
            return value
        slope = self.binary(ast.Mult(), literal(float(exponent)), lower)
        kind = slopes_of(a.type)
        slope_ = self.op(f"fmul {kind.llvm} {self.spread(kind, slope.parts[0])}, {a.parts[1]}")
        return Value(a.type, (value.parts[0], slope_))

    def compare(self, op: ast.cmpop, a: Value, b: Value) -> Value:
        """``a op b`` of numbers, a truth value."""
        if type(op) not in _COMPARE:
            raise self.refuse(f"comparison {type(op).__name__} is outside the subset")
        by_float, by_int = _COMPARE[type(op)]
        a, b = self.alike(self.still(a), self.still(b))
        if a.type == V8:
            raise self.refuse("tangents are compared: ask for the largest of them")
        if a.type == F8:
            return Value(B1, (self.op(f"fcmp {by_float} double {a.parts[0]}, {b.parts[0]}"),))
        if by_int not in ("eq", "ne"):
            by_int = ("u" if a.type == U8 else "s") + by_int
        return Value(B1, (self.op(f"icmp {by_int} i64 {a.parts[0]}, {b.parts[0]}"),))

    def negative(self, value: Value) -> Value:
        """``-value``."""
        value = self.number(value)
        if value.type in (V8, *MOVING):
            pairs = zip(parts_of(value.type), value.parts, strict=True)
            return Value(value.type, tuple(self.op(f"fneg {kind} {part}") for kind, part in pairs))
        (operand,) = value.parts
        if value.type == F8:
            return Value(F8, (self.op(f"fneg double {operand}"),))
        known = whole(operand)
        if known is not None:
            return literal(-known)
        return Value(value.type, (self.op(f"sub i64 0, {operand}"),))

    def extreme(self, op: ast.cmpop, values: list[Value]) -> Value:
        """``max`` (``op`` Gt) or ``min`` (Lt) from left to right: the later one only where it is really beyond."""
        best = self.number(values[0])
        for value in values[1:]:
            best, value = self.alike(best, value)
            if best.type == V8:
                x, y = value.parts[0], best.parts[0]
                beyond = self.op(f"fcmp {_COMPARE[type(op)][0]} {V8.llvm} {x}, {y}")
                best = Value(V8, (self.op(f"select <{LANES} x i1> {beyond}, {V8.llvm} {x}, {V8.llvm} {y}"),))
                continue
            (beyond,) = self.compare(op, value, best).parts
            best = self.chosen(beyond, value, best)
        return best

    def absolute(self, value: Value) -> Value:
        """``abs(value)``."""
        value = self.number(value)
        if value.type in MOVING:
            return self.moving_call("llvm.fabs.f64", [value])
        (operand,) = value.parts
        if value.type == V8:
            return Value(V8, (self.op(f"call {V8.llvm} {self.module.runtime(ABS)}({V8.llvm} {operand})"),))
        if value.type == F8:
            return Value(F8, (self.op(f"call double {self.module.runtime('llvm.fabs.f64')}(double {operand})"),))
        (minus,) = self.negative(value).parts
        low = self.op(f"icmp slt i64 {operand}, 0")
        return Value(value.type, (self.op(f"select i1 {low}, i64 {minus}, i64 {operand}"),))

    def read_number(self, element: Element, address: str, remark: str = "") -> Value:
        """The number at an address."""
        if element.scalar in MOVING:
            other = self.op(f"getelementptr inbounds double, ptr {address}, i64 1")
            places = zip(parts_of(element.scalar), (address, other), ("", aligned(element)), strict=True)
            return Value(
                element.scalar, tuple(self.op(f"load {kind}, ptr {place}{fit}{remark}") for kind, place, fit in places)
            )
        raw = self.op(f"load {element.llvm}, ptr {address}{remark}")
        if element.scalar == B1:
            return Value(B1, (self.op(f"icmp ne i8 {raw}, 0"),))
        if element.llvm in ("i8", "i32"):
            kind = "zext" if element.name.startswith("u") else "sext"
            raw = self.op(f"{kind} {element.llvm} {raw} to i64")
        return Value(element.scalar, (raw,))

    def write_number(self, element: Element, address: str, value: Value) -> None:
        """Store a number, converted as an assignment to an array's element converts it."""
        if not isinstance(value.type, Scalar):
            raise self.refuse(f"{shown(value.type)} stored in an array of {element.name}")
        if element.scalar in MOVING:
            number, slope = self.convert(value, element.scalar).parts
            other = self.op(f"getelementptr inbounds double, ptr {address}, i64 1")
            self.do(f"store double {number}, ptr {address}")
            self.do(f"store {slopes_of(element.scalar).llvm} {slope}, ptr {other}{aligned(element)}")
            return
        (operand,) = self.convert(value, element.scalar).parts
        if element.scalar == B1:
            operand = self.op(f"zext i1 {operand} to i8")
        elif element.llvm in ("i8", "i32"):
            operand = self.op(f"trunc i64 {operand} to {element.llvm}")
        self.do(f"store {element.llvm} {operand}, ptr {address}")
