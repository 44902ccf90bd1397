"""Numbers with a tangent: the rules of calculus, operation by operation.

A number of type ``M8`` has two parts, its value and its tangent. An operation does with values what it does with
float64, in the same bits, and writes the tangent beside; a number without one is no more work than it was. Where a
function has an infinite slope at the end of its range the slope is cut off as in ``radiometric/rules.py``, but that of
the root: it is infinite at 0 unless its argument stands still.
"""

from __future__ import annotations

import ast
from typing import Final

from symrender.jit.body import Body, double
from symrender.jit.types import F8, I8, LANES, M8, MOVING, V8, W8, Element, Scalar, Type, Value, parts_of, slopes_of

_TINY: Final = 1e-300
_INFINITE: Final = double(float("inf"))
_ZERO: Final = double(0.0)
ABS: Final = "llvm.fabs.v4f64"
STEPS: Final = ("llvm.floor.f64", "llvm.ceil.f64", "llvm.trunc.f64")
"""Functions whose results stand still."""


class Tangents(Body):
    """What is done with numbers of which one at least has a tangent; operands without one are ``F8``.

    Tangents of a number of type ``W8`` are four side by side, and all four are worked on at once.
    """

    def external(self, name: str, *operands: str) -> str:
        """Call of a function of floats."""
        listed = ", ".join(f"double {operand}" for operand in operands)
        return self.op(f"call double {self.module.runtime(name)}({listed})")

    def convert(self, value: Value, type: Type) -> Value:
        """The value in a wider type, or the same."""
        raise NotImplementedError

    def _f(self, text: str) -> str:
        """An instruction on doubles, ``fmul a, b`` as one writes it."""
        name, _, operands = text.partition(" ")
        return self.op(f"{name} double {operands}")

    def spread(self, kind: Scalar, operand: str) -> str:
        """A double as what multiplies tangents: for ``V8`` four times side by side."""
        if kind == F8:
            return operand
        if not operand.startswith("%"):
            return f"<{', '.join([f'double {operand}'] * LANES)}>"
        first = self.op(f"insertelement {kind.llvm} poison, double {operand}, i64 0")
        return self.op(f"shufflevector {kind.llvm} {first}, {kind.llvm} poison, <{LANES} x i32> zeroinitializer")

    def largest(self, value: Value) -> Value:
        """The largest of four tangents."""
        found = self.lane(value, 0).parts[0]
        for k in range(1, LANES):
            (other,) = self.lane(value, k).parts
            beyond = self.op(f"fcmp ogt double {other}, {found}")
            found = self.op(f"select i1 {beyond}, double {other}, double {found}")
        return Value(F8, (found,))

    def signs(self, value: Value) -> Value:
        """Which of the tangents are above 0, as bits of a whole number."""
        assert isinstance(value.type, Scalar)
        bits = "i1" if value.type == F8 else f"i{LANES}"
        found = self.op(f"fcmp ogt {value.type.llvm} {value.parts[0]}, {_none(value.type)}")
        if value.type != F8:
            found = self.op(f"bitcast <{LANES} x i1> {found} to {bits}")
        return Value(I8, (self.op(f"zext {bits} {found} to i64"),))

    def lane(self, value: Value, k: int) -> Value:
        """Tangent ``k`` of four."""
        return Value(F8, (self.op(f"extractelement {V8.llvm} {value.parts[0]}, i64 {k}"),))

    def still(self, value: Value) -> Value:
        """The value without its tangent."""
        return Value(F8, value.parts[:1]) if value.type in MOVING else value

    def slope_of(self, value: Value, kind: Scalar) -> str:
        """The tangent, of type ``kind``, "" where there is none."""
        if value.type not in MOVING:
            return ""
        return self.spread(kind, value.parts[1]) if slopes_of(value.type) != kind else value.parts[1]

    def moving(self, value: str, slope: str, kind: Scalar) -> Value:
        """A number with a tangent, or without one."""
        return Value(M8 if kind == F8 else W8, (value, slope)) if slope else Value(F8, (value,))

    def scaled(self, factor: str, slope: str, kind: Scalar) -> str:
        """factor times slope; what has died out has no slope, however steep its argument."""
        product = self.times_slope(factor, slope, kind)
        some = self.op(f"fcmp une double {factor}, {_ZERO}")
        return self.op(f"select i1 {some}, {kind.llvm} {product}, {kind.llvm} {_none(kind)}")

    def times_slope(self, factor: str, slope: str, kind: Scalar) -> str:
        """factor times slope."""
        return self.op(f"fmul {kind.llvm} {self.spread(kind, factor)}, {slope}")

    def unless_still(self, result: str, slope: str, kind: Scalar) -> str:
        """The slope of a result, 0 where what it is made of stands still."""
        stands = self.op(f"fcmp oeq {kind.llvm} {slope}, {_none(kind)}")
        kinds = "i1" if kind == F8 else f"<{LANES} x i1>"
        return self.op(f"select {kinds} {stands}, {kind.llvm} {_none(kind)}, {kind.llvm} {result}")

    def slope_over(self, slope: str, divisor: str, kind: Scalar) -> str:
        """slope over divisor."""
        return self.op(f"fdiv {kind.llvm} {slope}, {self.spread(kind, divisor)}")

    def added(self, a: str, b: str, kind: Scalar) -> str:
        """Sum of slopes, each "" where it is zero."""
        return self.op(f"fadd {kind.llvm} {a}, {b}") if a and b else a or b

    def less(self, a: str, b: str, kind: Scalar) -> str:
        """Difference of slopes, each "" where it is zero."""
        if a and b:
            return self.op(f"fsub {kind.llvm} {a}, {b}")
        return a or (self.op(f"fneg {kind.llvm} {b}") if b else "")

    def moving_binary(self, kind: type[ast.operator], a: Value, b: Value) -> Value:
        """``a op b``, one op of + - * / // %."""
        a, b = (value if value.type in MOVING else self.convert(value, F8) for value in (a, b))
        t = V8 if W8 in (a.type, b.type) else F8
        (x, y), dx, dy = (a.parts[0], b.parts[0]), self.slope_of(a, t), self.slope_of(b, t)
        if kind is ast.Add:
            return self.moving(self._f(f"fadd {x}, {y}"), self.added(dx, dy, t), t)
        if kind is ast.Sub:
            slope = self.less(dx, dy, t)
            return self.moving(self._f(f"fsub {x}, {y}"), slope, t)
        if kind is ast.Mult:
            first = self.op(f"fmul {t.llvm} {dx}, {self.spread(t, y)}") if dx else ""
            second = self.times_slope(x, dy, t) if dy else ""
            return self.moving(self._f(f"fmul {x}, {y}"), self.added(first, second, t), t)
        if kind is ast.Div:
            quotient = self._f(f"fdiv {x}, {y}")
            slope = self.less(dx, self.times_slope(quotient, dy, t), t) if dy else dx
            return self.moving(quotient, self.slope_over(slope, y, t), t)
        if kind is ast.FloorDiv:
            name = self.module.runtime("float_floordiv")
            return Value(F8, (self.op(f"call double {name}(double {x}, double {y})"),))
        if kind is ast.Mod:
            rest = self.external("float_mod", x, y)
            if dy:
                dx = self.less(dx, self.times_slope(self.external("float_floordiv", x, y), dy, t), t)
            return self.moving(rest, dx, t)
        raise self.refuse(f"operator {kind.__name__} of a number with a tangent")

    def moving_power(self, a: Value, b: Value) -> Value:
        """``a ** b`` of floats: of 0 the slope is that of the base alone."""
        t = V8 if W8 in (a.type, b.type) else F8
        x, y, dx, dy = a.parts[0], b.parts[0], self.slope_of(a, t), self.slope_of(b, t)
        value, first, second = self.external("llvm.pow.f64", x, y), "", ""
        if dx:
            lower = self.external("llvm.pow.f64", x, self._f(f"fsub {y}, {double(1.0)}"))
            first = self.unless_still(self.scaled(self._f(f"fmul {y}, {lower}"), dx, t), dx, t)
        if dy:
            least = self.op(f"fcmp ogt double {x}, {_ZERO}")
            base = self.op(f"select i1 {least}, double {x}, double {double(1.0)}")
            second = self.scaled(value, self.times_slope(self.external("llvm.log.f64", base), dy, t), t)
        return self.moving(value, self.added(first, second, t), t)

    def moving_call(self, name: str, values: list[Value]) -> Value:
        """A function of ``math`` of one or two floats."""
        x = values[0].parts[0]
        t = V8 if any(value.type == W8 for value in values) else F8
        result = self.external(name, *(value.parts[0] for value in values))
        if name in STEPS:
            return Value(F8, (result,))
        if len(values) == 2:
            y, dx, dy = values[1].parts[0], self.slope_of(values[0], t), self.slope_of(values[1], t)
            return self.moving(result, self._slope_of_two(name, x, y, dx, dy, result, t), t)
        return self.moving(result, self._slope_of_one(name, x, values[0].parts[1], result, t), t)

    def _slope_of_two(self, name: str, x: str, y: str, dx: str, dy: str, result: str, t: Scalar) -> str:
        dx, dy = dx or _none(t), dy or _none(t)
        match name:
            case "atan2":
                # the first argument is up, the second across
                size = self._f(f"fadd {self._f(f'fmul {x}, {x}')}, {self._f(f'fmul {y}, {y}')}")
                turn = self.less(self.times_slope(y, dx, t), self.times_slope(x, dy, t), t)
                return self.slope_over(turn, self._at_least(size), t)
            case "hypot":
                along = self.added(self.times_slope(x, dx, t), self.times_slope(y, dy, t), t)
                return self.slope_over(along, self._at_least(result), t)
            case "llvm.copysign.f64":
                alike = self.external("llvm.copysign.f64", double(1.0), y)
                return self.times_slope(self._f(f"fmul {alike}, {self._sign(x)}"), dx, t)
        raise self.refuse(f"{name} of a number with a tangent")

    def _slope_of_one(self, name: str, x: str, dx: str, result: str, t: Scalar) -> str:
        """The tangent of a function's result."""
        one = double(1.0)
        square = self._f(f"fmul {x}, {x}")
        match name:
            case "llvm.sqrt.f64":
                half = self.times_slope(double(0.5), dx, t)
                rises = self.op(f"fcmp ogt double {x}, {_ZERO}")
                end = self.unless_still(self.spread(t, _INFINITE), dx, t)
                return self.op(f"select i1 {rises}, {t.llvm} {self.slope_over(half, result, t)}, {t.llvm} {end}")
            case "llvm.exp.f64":
                return self.scaled(result, dx, t)
            case "expm1":
                return self.scaled(self._f(f"fadd {result}, {one}"), dx, t)
            case "llvm.log.f64":
                return self.slope_over(dx, x, t)
            case "llvm.log10.f64" | "log2":
                base = double(2.302585092994046 if name != "log2" else 0.6931471805599453)
                return self.slope_over(dx, self._f(f"fmul {base}, {x}"), t)
            case "log1p":
                return self.slope_over(dx, self._f(f"fadd {one}, {x}"), t)
            case "llvm.sin.f64":
                return self.times_slope(self.external("llvm.cos.f64", x), dx, t)
            case "llvm.cos.f64":
                return self.times_slope(self._f("fneg " + self.external("llvm.sin.f64", x)), dx, t)
            case "llvm.fabs.f64":
                return self.times_slope(self._sign(x), dx, t)
            case "tan":
                return self.times_slope(self._f(f"fadd {one}, " + self._f(f"fmul {result}, {result}")), dx, t)
            case "asin" | "acos" | "atanh":
                gap = self._f(f"fmul {self._f(f'fsub {one}, {x}')}, {self._f(f'fadd {one}, {x}')}")
                size = self._at_least(gap)
                if name != "atanh":
                    size = self.external("llvm.sqrt.f64", size)
                slope = self.slope_over(dx, size, t)
                return self.less("", slope, t) if name == "acos" else slope
            case "atan":
                return self.slope_over(dx, self._f(f"fadd {one}, {square}"), t)
            case "asinh":
                return self.slope_over(dx, self.external("llvm.sqrt.f64", self._f(f"fadd {one}, {square}")), t)
            case "acosh":
                gap = self._f(f"fmul {self._f(f'fsub {x}, {one}')}, {self._f(f'fadd {x}, {one}')}")
                return self.slope_over(dx, self.external("llvm.sqrt.f64", self._at_least(gap)), t)
            case "sinh" | "cosh":
                return self.times_slope(self.external("cosh" if name == "sinh" else "sinh", x), dx, t)
            case "tanh":
                return self.times_slope(self._f(f"fsub {one}, " + self._f(f"fmul {result}, {result}")), dx, t)
            case "erf" | "erfc":
                peak = self.external("llvm.exp.f64", self._f(f"fneg {square}"))
                size = double(1.1283791670955126 if name == "erf" else -1.1283791670955126)
                return self.scaled(self._f(f"fmul {size}, {peak}"), dx, t)
        raise self.refuse(f"{name} of a number with a tangent")

    def _at_least(self, operand: str) -> str:
        some = self.op(f"fcmp ogt double {operand}, {double(_TINY)}")
        return self.op(f"select i1 {some}, double {operand}, double {double(_TINY)}")

    def _sign(self, operand: str) -> str:
        below = self.op(f"fcmp olt double {operand}, {_ZERO}")
        return self.op(f"select i1 {below}, double {double(-1.0)}, double {double(1.0)}")

    def chosen(self, condition: str, a: Value, b: Value) -> Value:
        """``a`` where the condition holds, else ``b``; both of one type."""
        trios = zip(parts_of(a.type), a.parts, b.parts, strict=True)
        return Value(a.type, tuple(self.op(f"select i1 {condition}, {kind} {x}, {kind} {y}") for kind, x, y in trios))


def _none(kind: Scalar) -> str:
    """No slope."""
    return _ZERO if kind == F8 else "zeroinitializer"


def aligned(element: Element) -> str:
    """What is said of the address of an element's tangents: they are four numbers that lie as one does."""
    return ", align 8" if element.scalar == W8 else ""
