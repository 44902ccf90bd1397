"""Block: where formulas become statements.

``lets`` binds a group of expressions after taking out what they share, so a formula may be written in full and
still be computed once.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager

import sympy as sp

from symrender.expression.vectors import Vec3
from symrender.kernel.program import Array, Call, Let, Loop, Next, Return, Statement, Store, When


def real(name: str) -> sp.Symbol:
    """A real scalar."""
    return sp.Symbol(name, real=True)


def whole(name: str) -> sp.Symbol:
    """A whole number, such as an index."""
    return sp.Symbol(name, integer=True)


class Block:
    """Statements of one function being written, in order."""

    def __init__(self) -> None:
        self._open: list[list[Statement]] = [[]]
        self._shared = 0
        self._indices: list[str] = []

    @property
    def statements(self) -> tuple[Statement, ...]:
        """What has been written."""
        (body,) = self._open
        return tuple(body)

    def add(self, statement: Statement) -> None:
        """Append one statement; ValueError where it assigns the index of a loop it is written in."""
        names = statement.targets if isinstance(statement, Call) else ()
        if isinstance(statement, Let | Loop):
            names = (statement.name if isinstance(statement, Let) else statement.index,)
        # pieces that several functions share bind names of their own; what is stored after them would go astray
        if taken := {name.name for name in names} & set(self._indices):
            raise ValueError(f"{min(taken)} is the index of a loop; a name bound in the loop must be another")
        self._open[-1].append(statement)

    def lets(self, values: Mapping[str, sp.Expr]) -> tuple[sp.Symbol, ...]:
        """Bind real names to expressions, shared subexpressions first."""
        fresh = (sp.Symbol(f"v{k}", real=True) for k in iter(self._count, None))
        shared, reduced = sp.cse(list(values.values()), symbols=fresh, order="none")
        for name, value in shared:
            self.add(Let(name, value))
        names = tuple(real(name) for name in values)
        for name, value in zip(names, reduced, strict=True):
            self.add(Let(name, value))
        return names

    def _count(self) -> int:
        self._shared += 1
        return self._shared - 1

    def let(self, name: str, value: sp.Expr) -> sp.Symbol:
        """Bind one real name."""
        return self.lets({name: value})[0]

    def let_vector(self, name: str, value: Vec3) -> Vec3:
        """Bind ``name_x``, ``name_y``, ``name_z``."""
        return Vec3(*self.lets({f"{name}_{axis}": part for axis, part in zip("xyz", value.parts, strict=True)}))

    def count(self, name: str, value: sp.Expr) -> sp.Symbol:
        """Bind or assign a whole number."""
        symbol = whole(name)
        self.add(Let(symbol, value))
        return symbol

    def set(self, name: sp.Symbol, value: sp.Basic) -> None:
        """Assign an existing name."""
        self.add(Let(name, value))

    def store(self, element: sp.Indexed, value: sp.Expr) -> None:
        """Write an array element."""
        self.add(Store(element, value))

    def call(
        self, function: str, arguments: tuple[sp.Basic | Array | Vec3, ...], *targets: str
    ) -> tuple[sp.Symbol, ...]:
        """Call a function and bind its real results."""
        flat: list[sp.Basic] = []
        for argument in arguments:
            if isinstance(argument, Vec3):
                flat += argument.parts
            else:
                flat.append(argument.symbol if isinstance(argument, Array) else argument)
        names = tuple(real(target) for target in targets)
        self.add(Call(names, function, tuple(flat)))
        return names

    def next(self) -> None:
        """Go on with the next turn of the innermost loop."""
        self.add(Next())

    def leave(self, *values: sp.Basic) -> None:
        """Return from the function."""
        self.add(Return(values))

    @contextmanager
    def loop(self, index: str, count: sp.Expr | int, first: sp.Expr | int = 0) -> Iterator[sp.Symbol]:
        """Counted loop; yields the index."""
        symbol = whole(index)
        self._open.append([])
        self._indices.append(index)
        yield symbol
        self._indices.pop()
        body = tuple(self._open.pop())
        self.add(Loop(symbol, sp.sympify(first), sp.sympify(count), body))

    @contextmanager
    def when(self, condition: sp.Basic) -> Iterator[None]:
        """Guarded statements."""
        self._open.append([])
        yield
        self.add(When(condition, tuple(self._open.pop())))

    @contextmanager
    def otherwise(self) -> Iterator[None]:
        """The other side of the guard just closed."""
        guard = self._open[-1].pop()
        if not isinstance(guard, When) or guard.otherwise:
            raise ValueError("otherwise must follow a guard")
        self._open.append([])
        yield
        self.add(When(guard.condition, guard.body, tuple(self._open.pop())))
