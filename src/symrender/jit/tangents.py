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
from symrender.jit.types import F8, M8, Scalar, Type, Value

_TINY: Final = 1e-300
_INFINITE: Final = double(float("inf"))
_ZERO: Final = double(0.0)
STEPS: Final = ("llvm.floor.f64", "llvm.ceil.f64", "llvm.trunc.f64")
"""Functions whose results stand still."""


class Tangents(Body):
    """What is done with numbers of which one at least has a tangent; operands without one are ``F8``."""

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

    def still(self, value: Value) -> Value:
        """The value without its tangent."""
        return Value(F8, value.parts[:1]) if value.type == M8 else value

    def slope_of(self, value: Value) -> str:
        """The tangent, "" where there is none."""
        return value.parts[1] if value.type == M8 else ""

    def moving(self, value: str, slope: str) -> Value:
        """A number with a tangent, or without one."""
        return Value(M8, (value, slope)) if slope else Value(F8, (value,))

    def scaled(self, factor: str, slope: str) -> str:
        """factor times slope; what has died out has no slope, however steep its argument."""
        product = self._f(f"fmul {factor}, {slope}")
        some = self.op(f"fcmp une double {factor}, {_ZERO}")
        return self.op(f"select i1 {some}, double {product}, double {_ZERO}")

    def added(self, a: str, b: str) -> str:
        """Sum of slopes, each "" where it is zero."""
        return self._f(f"fadd {a}, {b}") if a and b else a or b

    def moving_binary(self, kind: type[ast.operator], a: Value, b: Value) -> Value:
        """``a op b``, op one of + - * / // %."""
        a, b = (value if value.type == M8 else self.convert(value, F8) for value in (a, b))
        (x, y), dx, dy = (a.parts[0], b.parts[0]), self.slope_of(a), self.slope_of(b)
        if kind is ast.Add:
            return self.moving(self._f(f"fadd {x}, {y}"), self.added(dx, dy))
        if kind is ast.Sub:
            minus = self._f(f"fneg {dy}") if dy else ""
            slope = self._f(f"fsub {dx}, {dy}") if dx and dy else dx or minus
            return self.moving(self._f(f"fsub {x}, {y}"), slope)
        if kind is ast.Mult:
            first = self._f(f"fmul {dx}, {y}") if dx else ""
            second = self._f(f"fmul {x}, {dy}") if dy else ""
            return self.moving(self._f(f"fmul {x}, {y}"), self.added(first, second))
        if kind is ast.Div:
            quotient = self._f(f"fdiv {x}, {y}")
            slope = dx
            if dy:
                taken = self._f(f"fmul {quotient}, {dy}")
                slope = self._f(f"fsub {dx}, {taken}") if dx else self._f(f"fneg {taken}")
            return self.moving(quotient, self._f(f"fdiv {slope}, {y}"))
        if kind is ast.FloorDiv:
            name = self.module.runtime("float_floordiv")
            return Value(F8, (self.op(f"call double {name}(double {x}, double {y})"),))
        if kind is ast.Mod:
            rest = self.external("float_mod", x, y)
            if dy:
                whole = self.external("float_floordiv", x, y)
                taken = self._f(f"fmul {whole}, {dy}")
                dx = self._f(f"fsub {dx}, {taken}") if dx else self._f(f"fneg {taken}")
            return self.moving(rest, dx)
        raise self.refuse(f"operator {kind.__name__} of a number with a tangent")

    def moving_power(self, a: Value, b: Value) -> Value:
        """``a ** b`` of floats: of 0 the slope is that of the base alone."""
        x, y, dx, dy = a.parts[0], b.parts[0], self.slope_of(a), self.slope_of(b)
        value, first, second = self.external("llvm.pow.f64", x, y), "", ""
        if dx:
            lower = self.external("llvm.pow.f64", x, self._f(f"fsub {y}, {double(1.0)}"))
            first = self.scaled(self._f(f"fmul {y}, {lower}"), dx)
        if dy:
            least = self.op(f"fcmp ogt double {x}, {_ZERO}")
            base = self.op(f"select i1 {least}, double {x}, double {double(1.0)}")
            second = self.scaled(value, self._f(f"fmul {self.external('llvm.log.f64', base)}, {dy}"))
        return self.moving(value, self.added(first, second))

    def moving_call(self, name: str, values: list[Value]) -> Value:
        """A function of ``math`` of one or two floats."""
        x = values[0].parts[0]
        result = self.external(name, *(value.parts[0] for value in values))
        if name in STEPS:
            return Value(F8, (result,))
        if len(values) == 2:
            y, dx, dy = values[1].parts[0], self.slope_of(values[0]), self.slope_of(values[1])
            return self.moving(result, self._slope_of_two(name, x, y, dx or _ZERO, dy or _ZERO, result))
        return self.moving(result, self._slope_of_one(name, x, values[0].parts[1], result))

    def _slope_of_two(self, name: str, x: str, y: str, dx: str, dy: str, result: str) -> str:
        match name:
            case "atan2":
                # the first argument is up, the second across
                size = self._f(f"fadd {self._f(f'fmul {x}, {x}')}, {self._f(f'fmul {y}, {y}')}")
                turn = self._f(f"fsub {self._f(f'fmul {y}, {dx}')}, {self._f(f'fmul {x}, {dy}')}")
                return self._f(f"fdiv {turn}, {self._at_least(size)}")
            case "hypot":
                along = self._f(f"fadd {self._f(f'fmul {x}, {dx}')}, {self._f(f'fmul {y}, {dy}')}")
                return self._f(f"fdiv {along}, {self._at_least(result)}")
            case "llvm.copysign.f64":
                alike = self.external("llvm.copysign.f64", double(1.0), y)
                return self._f(f"fmul {self._f(f'fmul {alike}, {self._sign(x)}')}, {dx}")
        raise self.refuse(f"{name} of a number with a tangent")

    def _slope_of_one(self, name: str, x: str, dx: str, result: str) -> str:
        """The tangent of a function's result."""
        one = double(1.0)
        square = self._f(f"fmul {x}, {x}")
        match name:
            case "llvm.sqrt.f64":
                half = self._f(f"fmul {double(0.5)}, {dx}")
                rises = self.op(f"fcmp ogt double {x}, {_ZERO}")
                stands = self.op(f"fcmp oeq double {dx}, {_ZERO}")
                end = self.op(f"select i1 {stands}, double {_ZERO}, double {_INFINITE}")
                return self.op(f"select i1 {rises}, double {self._f(f'fdiv {half}, {result}')}, double {end}")
            case "llvm.exp.f64":
                return self.scaled(result, dx)
            case "expm1":
                return self.scaled(self._f(f"fadd {result}, {one}"), dx)
            case "llvm.log.f64":
                return self._f(f"fdiv {dx}, {x}")
            case "llvm.log10.f64" | "log2":
                base = double(2.302585092994046 if name != "log2" else 0.6931471805599453)
                return self._f(f"fdiv {dx}, {self._f(f'fmul {base}, {x}')}")
            case "log1p":
                return self._f(f"fdiv {dx}, {self._f(f'fadd {one}, {x}')}")
            case "llvm.sin.f64":
                return self._f(f"fmul {self.external('llvm.cos.f64', x)}, {dx}")
            case "llvm.cos.f64":
                return self._f(f"fmul {self._f('fneg ' + self.external('llvm.sin.f64', x))}, {dx}")
            case "llvm.fabs.f64":
                return self._f(f"fmul {self._sign(x)}, {dx}")
            case "tan":
                return self._f(f"fmul {self._f(f'fadd {one}, ' + self._f(f'fmul {result}, {result}'))}, {dx}")
            case "asin" | "acos" | "atanh":
                gap = self._f(f"fmul {self._f(f'fsub {one}, {x}')}, {self._f(f'fadd {one}, {x}')}")
                size = self._at_least(gap)
                if name != "atanh":
                    size = self.external("llvm.sqrt.f64", size)
                slope = self._f(f"fdiv {dx}, {size}")
                return self._f(f"fneg {slope}") if name == "acos" else slope
            case "atan":
                return self._f(f"fdiv {dx}, {self._f(f'fadd {one}, {square}')}")
            case "asinh":
                return self._f(f"fdiv {dx}, {self.external('llvm.sqrt.f64', self._f(f'fadd {one}, {square}'))}")
            case "acosh":
                gap = self._f(f"fmul {self._f(f'fsub {x}, {one}')}, {self._f(f'fadd {x}, {one}')}")
                return self._f(f"fdiv {dx}, {self.external('llvm.sqrt.f64', self._at_least(gap))}")
            case "sinh" | "cosh":
                return self._f(f"fmul {self.external('cosh' if name == 'sinh' else 'sinh', x)}, {dx}")
            case "tanh":
                return self._f(f"fmul {self._f(f'fsub {one}, ' + self._f(f'fmul {result}, {result}'))}, {dx}")
            case "erf" | "erfc":
                peak = self.external("llvm.exp.f64", self._f(f"fneg {square}"))
                size = double(1.1283791670955126 if name == "erf" else -1.1283791670955126)
                return self.scaled(self._f(f"fmul {size}, {peak}"), dx)
        raise self.refuse(f"{name} of a number with a tangent")

    def _at_least(self, operand: str) -> str:
        some = self.op(f"fcmp ogt double {operand}, {double(_TINY)}")
        return self.op(f"select i1 {some}, double {operand}, double {double(_TINY)}")

    def _sign(self, operand: str) -> str:
        below = self.op(f"fcmp olt double {operand}, {_ZERO}")
        return self.op(f"select i1 {below}, double {double(-1.0)}, double {double(1.0)}")

    def chosen(self, condition: str, a: Value, b: Value) -> Value:
        """``a`` where the condition holds, else ``b``; both of one type."""
        assert isinstance(a.type, Scalar)
        kind = a.type.llvm
        picked = (
            self.op(f"select i1 {condition}, {kind} {x}, {kind} {y}") for x, y in zip(a.parts, b.parts, strict=True)
        )
        return Value(a.type, tuple(picked))
