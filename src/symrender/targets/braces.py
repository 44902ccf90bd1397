"""What the languages with braces share: expressions with explicit precedence, typed whole or real, and statements.

A name is whole where any symbol of that name in its function is; everything else is real. Each language fills in how
it writes a number, a call, an element and a function's results.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping, Sequence

import sympy as sp
from sympy.core.relational import Relational

from symrender.kernel.assemble_pixels import Table
from symrender.kernel.program import Array, Call, Function, Let, Loop, Next, Program, Return, Statement, Store, When
from symrender.kernel.program import length as length_of

_OR, _AND, _COMPARE, _SUM, _PRODUCT, _UNARY, _ATOM = range(7)
_LARGEST_PRODUCT = 4


class Writer(ABC):
    """Writes the functions of a program, one after the other."""

    def __init__(self, program: Program, tables: Mapping[str, Table]) -> None:
        self.tables = tables
        self.functions = {function.name: function for function in program.functions}
        self.whole: set[str] = set()
        self.helpers: set[str] = set()

    # what a language decides

    @abstractmethod
    def literal(self, value: float) -> str:
        """A real number."""

    @abstractmethod
    def to_real(self, text: str) -> str:
        """A whole expression as a real one."""

    @abstractmethod
    def to_whole(self, text: str) -> str:
        """A real expression that holds a whole number as a whole one."""

    @abstractmethod
    def function_call(self, name: str, arguments: Sequence[str]) -> str:
        """An elementary function."""

    @abstractmethod
    def element(self, name: str, indices: Sequence[sp.Expr]) -> str:
        """An element of an array."""

    @abstractmethod
    def rows(self, name: str) -> str:
        """Number of rows of an array."""

    @abstractmethod
    def equality(self, negated: bool) -> str:
        """The sign of equality."""

    @abstractmethod
    def header(self, function: Function, results: Sequence[bool]) -> str:
        """The first line of a function; ``results`` says which results are whole."""

    @abstractmethod
    def declarations(self, reals: Sequence[str], wholes: Sequence[str]) -> list[str]:
        """Lines that declare a function's own names."""

    @abstractmethod
    def loop_lines(self, index: str, first: str, count: str) -> tuple[str, str]:
        """The first and the last line of a counted loop."""

    @abstractmethod
    def leave(self, values: Sequence[str]) -> list[str]:
        """Lines that return more than one value, or none."""

    def leave_one(self, value: str) -> list[str]:
        """Lines that return one value."""
        return [f"return {value};"]

    @abstractmethod
    def call_lines(
        self, name: str, targets: Sequence[str], arguments: Sequence[str], results: Sequence[bool]
    ) -> list[str]:
        """Lines of a call with more than one result, or none."""

    # expressions

    def real(self, expression: sp.Basic, level: int = _OR) -> str:
        """Text of an expression as a real number, bracketed where ``level`` binds tighter."""
        return self._bracketed(self._expression(expression, False), level)

    def count(self, expression: sp.Basic, level: int = _OR) -> str:
        """Text of an expression as a whole number."""
        return self._bracketed(self._expression(expression, True), level)

    def condition(self, expression: sp.Basic, level: int = _OR) -> str:
        """Text of a condition."""
        return self._bracketed(self._condition(expression), level)

    @staticmethod
    def _bracketed(part: tuple[str, int], level: int) -> str:
        text, own = part
        return text if own >= level else f"({text})"

    def _expression(self, e: sp.Basic, whole: bool) -> tuple[str, int]:
        match e:
            case sp.Integer():
                text = str(int(e)) if whole else self.literal(float(e))
                return text, _ATOM if int(e) >= 0 else _UNARY
            case sp.Symbol():
                held = e.name in self.whole
                if held == whole:
                    return self.name(e.name), _ATOM
                return (self.to_whole if whole else self.to_real)(self.name(e.name)), _ATOM
            case sp.Number() | sp.NumberSymbol():
                text = self.literal(float(e))
                return (self.to_whole(text), _ATOM) if whole else (text, _ATOM if e >= 0 else _UNARY)
            case sp.Indexed():
                text = self.element(str(e.base.label), e.indices)
                return (self.to_whole(text) if whole else text), _ATOM
            case length_of():
                text = self.rows(e.args[0].name)
                return (text if whole else self.to_real(text)), _ATOM
            case sp.floor():
                inner = e.args[0]
                share, number = inner.as_coeff_Mul()
                if number.is_integer and share.is_Rational and share.p == 1 and whole:
                    return self.function_call("halves", [self.count(number), str(int(share.q))]), _ATOM
                text = self.function_call("floor", [self.real(inner)])
                return (self.to_whole(text) if whole else text), _ATOM
            case sp.Mod():
                if all(a.is_integer for a in e.args):
                    text = self.function_call("modulo", [self.count(a) for a in e.args])
                    return (text if whole else self.to_real(text)), _ATOM
                text = self.function_call("mod", [self.real(a) for a in e.args])
                return (self.to_whole(text) if whole else text), _ATOM
            case sp.Add():
                return self._sum(e, whole), _SUM
            case sp.Mul():
                return self._product(e, whole)
            case sp.Pow():
                return self._power(e, whole)
            case sp.Max() | sp.Min():
                return self._extreme(e, whole), _ATOM
            case sp.Abs():
                inside = self.count(e.args[0]) if whole else self.real(e.args[0])
                return self.function_call("abs", [inside]), _ATOM
            case sp.Function():
                name = type(e).__name__
                if e.is_integer:
                    text = self.function_call(name, [self.count(a) for a in e.args])
                    return (text if whole else self.to_real(text)), _ATOM
                text = self.function_call(name, [self.real(a) for a in e.args])
                return (self.to_whole(text) if whole else text), _ATOM
        raise NotImplementedError(f"no text for {type(e).__name__}")

    def _typed(self, e: sp.Basic, whole: bool, level: int) -> str:
        return self.count(e, level) if whole else self.real(e, level)

    def _extreme(self, e: sp.Basic, whole: bool) -> str:
        name = "max" if isinstance(e, sp.Max) else "min"
        first, *others = (self._typed(a, whole, _OR) for a in sorted(e.args, key=sp.default_sort_key))
        for other in others:
            first = self.function_call(name, [first, other])
        return first

    def _sum(self, e: sp.Add, whole: bool) -> str:
        text = ""
        for term in sorted(e.as_ordered_terms(), key=lambda t: t.could_extract_minus_sign()):
            if not text:
                text = self._typed(term, whole, _SUM)
            elif term.could_extract_minus_sign():
                text += f" - {self._typed(-term, whole, _PRODUCT)}"
            else:
                text += f" + {self._typed(term, whole, _SUM)}"
        return text

    def _product(self, e: sp.Mul, whole: bool) -> tuple[str, int]:
        coefficient = e.as_coeff_Mul()[0]
        if coefficient.is_negative:
            return f"-{self._typed(-e, whole, _UNARY if coefficient == -1 else _PRODUCT)}", _UNARY
        over = [1 / f for f in e.args if f.is_Pow and f.exp.is_number and f.exp.is_negative]
        under = [f for f in e.args if not (f.is_Pow and f.exp.is_number and f.exp.is_negative)]
        if whole and (over or not e.is_integer):
            return self.to_whole(self._product(e, False)[0]), _ATOM
        top = "*".join(self._typed(f, whole, _PRODUCT) for f in under) or self.literal(1.0)
        if not over:
            return top, _PRODUCT
        bottom = "*".join(self.real(f, _PRODUCT) for f in over)
        single = len(over) == 1 and self._bracketed((bottom, 0), 0) == self.real(over[0], _ATOM)
        return f"{top}/{bottom if single else f'({bottom})'}", _PRODUCT

    def _power(self, e: sp.Pow, whole: bool) -> tuple[str, int]:
        base, exponent = e.args
        if exponent.is_Integer and 1 < int(exponent) <= _LARGEST_PRODUCT:
            return "*".join([self._typed(base, whole, _UNARY)] * int(exponent)), _PRODUCT
        if exponent.is_number and exponent.is_negative:
            return f"{self.literal(1.0)}/{self.real(base ** (-exponent), _ATOM)}", _PRODUCT
        if exponent == sp.Rational(1, 2):
            return self.function_call("sqrt", [self.real(base)]), _ATOM
        return self.function_call("pow", [self.real(base), self.real(exponent)]), _ATOM

    def _condition(self, e: sp.Basic) -> tuple[str, int]:
        match e:
            case sp.And():
                return " && ".join(self.condition(a, _COMPARE) for a in sorted(e.args, key=sp.default_sort_key)), _AND
            case sp.Or():
                return " || ".join(self.condition(a, _COMPARE) for a in sorted(e.args, key=sp.default_sort_key)), _OR
            case sp.Not():
                return f"!{self.condition(e.args[0], _ATOM)}", _UNARY
            case sp.logic.boolalg.BooleanAtom():
                return "true" if e else "false", _ATOM
            case Relational():
                whole = bool(e.lhs.is_integer and e.rhs.is_integer)
                sign = self.equality(isinstance(e, sp.Ne)) if isinstance(e, sp.Eq | sp.Ne) else e.rel_op
                return f"{self._typed(e.lhs, whole, _SUM)} {sign} {self._typed(e.rhs, whole, _SUM)}", _COMPARE
        raise NotImplementedError(f"no condition for {type(e).__name__}")

    # statements

    def name(self, name: str) -> str:
        """A name as the language lets it be written."""
        return name

    def results(self, function: Function) -> tuple[bool, ...]:
        """Which results of a function are whole: those whole in every return and not always a bare number."""
        held, self.whole = self.whole, whole_names(function)
        rows = list(_returns(function.body))
        self.whole = held
        if not rows:
            return ()
        return tuple(
            all(v.is_integer for v in column) and any(not v.is_number for v in column)
            for column in zip(*rows, strict=True)
        )

    def function(self, function: Function) -> str:
        """Text of one function."""
        self.whole = whole_names(function)
        parameters = {p.name for p in function.parameters}
        loops = {s.index.name for s in _walk(function.body) if isinstance(s, Loop)}
        own = sorted(_assigned(function.body) - parameters - loops)
        lines = [self.header(function, self.results(function))]
        reals = [self.name(n) for n in own if n not in self.whole]
        lines += self.declarations(reals, [self.name(n) for n in own if n in self.whole])
        return "\n".join([*lines, *self._body(function, function.body, 1), "}"])

    def _body(self, function: Function, body: Sequence[Statement], depth: int) -> list[str]:
        pad = "  " * depth
        lines: list[str] = []
        for statement in body:
            match statement:
                case Let(name=name, value=value):
                    lines.append(f"{pad}{self.name(name.name)} = {self._typed(value, name.name in self.whole, _OR)};")
                case Store(element=element, value=value):
                    place = self.element(str(element.base.label), element.indices)
                    lines.append(f"{pad}{place} = {self.real(value)};")
                case Loop():
                    lines += self.loop(function, statement, depth)
                case When(condition=condition, body=(), otherwise=other):
                    lines.append(f"{pad}if (!{self.condition(condition, _ATOM)}) {{")
                    lines += [*self._body(function, other, depth + 1), f"{pad}}}"]
                case When(condition=condition, body=inner, otherwise=other):
                    lines += [f"{pad}if ({self.condition(condition)}) {{", *self._body(function, inner, depth + 1)]
                    if other:
                        lines += [f"{pad}}} else {{", *self._body(function, other, depth + 1)]
                    lines.append(f"{pad}}}")
                case Next():
                    lines.append(f"{pad}continue;")
                case Return(values=values):
                    texts = [self._typed(v, w, _OR) for v, w in zip(values, self.results(function), strict=True)]
                    found = self.leave_one(texts[0]) if len(texts) == 1 else self.leave(texts)
                    lines += [pad + line for line in found]
                case Call():
                    lines += [pad + line for line in self._call(statement)]
        return lines

    def loop(self, function: Function, loop: Loop, depth: int) -> list[str]:
        """Lines of a counted loop."""
        pad = "  " * depth
        first, count = self.count(loop.first), self.count(loop.count, _SUM)
        head, tail = self.loop_lines(self.name(loop.index.name), first, count)
        return [f"{pad}{head}", *self._body(function, loop.body, depth + 1), f"{pad}{tail}"]

    def _call(self, call: Call) -> list[str]:
        callee = self.functions[call.function]
        arguments = [
            str(a.name) if isinstance(p, Array) else self._typed(a, bool(p.is_integer), _OR)
            for p, a in zip(callee.parameters, call.arguments, strict=True)
        ]
        for p, a in zip(callee.parameters, call.arguments, strict=True):
            if isinstance(p, Array) and p.name != a.name:
                raise ValueError(
                    f"{callee.name} is called with {a.name} for {p.name}: arrays are global in this language"
                )
        arguments = [a for p, a in zip(callee.parameters, arguments, strict=True) if self.passes(p)]
        arguments += self.carried(callee.name)
        results = self.results(callee)
        if len(results) == 1:
            text = f"{self.name(callee.name)}({', '.join(arguments)})"
            target = call.targets[0].name
            return [f"{self.name(target)} = {self._convert(text, results[0], target in self.whole)};"]
        return self.call_lines(callee.name, [t.name for t in call.targets], arguments, results)

    def _convert(self, text: str, whole: bool, wanted: bool) -> str:
        if whole == wanted:
            return text
        return self.to_whole(text) if wanted else self.to_real(text)

    def carried(self, name: str) -> list[str]:
        """What a call hands to a function beside its arguments."""
        return []

    def passes(self, parameter: sp.Symbol | Array) -> bool:
        """Whether a parameter is handed over in a call."""
        return True


def whole_names(function: Function) -> set[str]:
    """Names that stand for whole numbers in a function."""
    symbols: set[sp.Symbol] = set()
    for statement in _walk(function.body):
        for expression in _expressions(statement):
            symbols |= expression.atoms(sp.Symbol)
    symbols |= {p for p in function.parameters if isinstance(p, sp.Symbol)}
    return {s.name for s in symbols if s.is_integer}


def _walk(body: Sequence[Statement]) -> Iterator[Statement]:
    for statement in body:
        yield statement
        match statement:
            case Loop(body=inner):
                yield from _walk(inner)
            case When(body=inner, otherwise=other):
                yield from _walk(inner)
                yield from _walk(other)


def _expressions(statement: Statement) -> list[sp.Basic]:
    match statement:
        case Let(name=name, value=value):
            return [name, value]
        case Store(element=element, value=value):
            return [element, value]
        case Loop(index=index, first=first, count=count):
            return [index, first, count]
        case When(condition=condition):
            return [condition]
        case Return(values=values):
            return list(values)
        case Call(targets=targets, arguments=arguments):
            return [*targets, *arguments]
    return []


def _returns(body: Sequence[Statement]) -> Iterator[tuple[sp.Basic, ...]]:
    return (s.values for s in _walk(body) if isinstance(s, Return))


def _assigned(body: Sequence[Statement]) -> set[str]:
    names: set[str] = set()
    for s in _walk(body):
        match s:
            case Let(name=name):
                names.add(name.name)
            case Call(targets=targets):
                names |= {t.name for t in targets}
    return names
