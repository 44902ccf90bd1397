"""Tape: a formula as the operations it performs, in the order written, each one once.

Nothing is rewritten: ``2*(a + b)`` stays, sums keep their order, so the emitted text rounds as the formula reads. Equal
operations on equal operands are one node; operands of a sum or a product of two may be swapped for that, which changes
no bit. What derivatives are full of is left out: products with 1, sums with 0, products with 0, double signs, 2 (x/2).
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from types import FrameType
from typing import Any, Final

from symrender.expression.leaf import Leaf
from symrender.expression.vectors import Vec3

UNARY: Final = frozenset(
    [
        "neg",
        "sqrt",
        "length",
        "positive",
        "sin",
        "cos",
        "tan",
        "asin",
        "arc_cosine",
        "exp",
        "log",
        "log1p",
        "expm1",
        "erf",
    ]
) | {"clamp", "ramp"}
"""Functions of one number; their meaning and their guards are those of ``expression/elementary.py``."""
_FORMULAS: Final = "symrender.expression.formulas."
_SWAP: Final = frozenset({"add", "mul"})


@dataclass(frozen=True, eq=False)
class Node:
    """One operation: its name, operands and, of a constant or an input, what it is."""

    tape: Tape = field(repr=False)
    index: int
    operation: str
    operands: tuple[Node, ...]
    detail: float | str = 0.0

    def _do(self, operation: str, *others: Any) -> Node:
        return self.tape.node(operation, self, *others)

    def __add__(self, other: Any) -> Node:
        return self._do("add", other)

    def __radd__(self, other: Any) -> Node:
        return self.constant(other) + self

    def __sub__(self, other: Any) -> Node:
        return self._do("sub", other)

    def __rsub__(self, other: Any) -> Node:
        return self.constant(other) - self

    def __mul__(self, other: Any) -> Node:
        return self._do("mul", other)

    def __rmul__(self, other: Any) -> Node:
        return self.constant(other) * self

    def __truediv__(self, other: Any) -> Node:
        return self._do("div", other)

    def __rtruediv__(self, other: Any) -> Node:
        return self.constant(other) / self

    def __neg__(self) -> Node:
        return self._do("neg")

    def __pow__(self, exponent: int) -> Node:
        if exponent != 2:
            raise ValueError("only squares are written as powers; any other one is a gleam or a product")
        return self * self

    def __bool__(self) -> bool:
        raise TypeError("a leaf cannot branch on its arguments: two branches are two leaves, or where_positive")

    def __getattr__(self, name: str) -> Callable[[], Node]:
        if name not in UNARY:
            raise AttributeError(name)
        return lambda: self._do(name)

    def azimuth(self, x: Any) -> Node:
        """atan2(self, x)"""
        return self._do("azimuth", x)

    def gleam(self, exponent: Any) -> Node:
        """self^exponent, guarded."""
        return self._do("gleam", exponent)

    def where_positive(self, value: Any, otherwise: float) -> Node:
        """``value`` where this is positive, else a constant."""
        return self._do("where_positive", value, otherwise)

    def constant(self, value: float) -> Node:
        """A number on the same tape."""
        return self.tape.constant(value)


class Tape:
    """The nodes of one function, in order; operands come before what uses them."""

    def __init__(self) -> None:
        self.nodes: list[Node] = []
        self.names: dict[int, str] = {}
        self._known: dict[tuple[Any, ...], Node] = {}

    def constant(self, value: float | Node) -> Node:
        """A number; a node is one already."""
        if isinstance(value, Node):
            return value
        return self._add("constant", (), float(value))

    def input(self, name: str) -> Node:
        """An argument."""
        return self._add("input", (), name)

    def node(self, operation: str, *operands: Any) -> Node:
        """The operation on these operands, of which plain numbers are constants."""
        of = tuple(self.constant(x) for x in operands)
        simple = self._simple(operation, of)
        return self._add(operation, of, 0.0) if simple is None else simple

    def _add(self, operation: str, operands: tuple[Node, ...], detail: float | str) -> Node:
        order = tuple(x.index for x in operands)
        key = (operation, tuple(sorted(order)) if operation in _SWAP else order, detail)
        if key not in self._known:
            self._known[key] = Node(self, len(self.nodes), operation, operands, detail)
            self.nodes.append(self._known[key])
        return self._known[key]

    def _simple(self, operation: str, of: tuple[Node, ...]) -> Node | None:
        """What an operation comes to without being done."""
        if operation == "neg" and of[0].operation == "neg":
            return of[0].operands[0]
        if all(x.operation == "constant" for x in of) and operation in _FOLDED:
            return self.constant(_FOLDED[operation](*(float(x.detail) for x in of)))
        if operation not in ("add", "sub", "mul", "div"):
            return None
        a, b = of
        match operation:
            case "add" if is_number(a, 0.0):
                return b
            case "add" | "sub" if is_number(b, 0.0):
                return a
            case "sub" if is_number(a, 0.0):
                return -b
            case "mul" if is_number(a, 0.0) or is_number(b, 0.0):
                return self.constant(0.0)
            case "mul" if is_number(a, 1.0):
                return b
            case "mul" | "div" if is_number(b, 1.0):
                return a
            case "mul" if is_number(a, -1.0):
                return -b
            case "mul" if is_number(b, -1.0):
                return -a
            case "div" if is_number(a, 0.0):
                return a
            case "mul" if is_number(a, 2.0) and b.operation == "mul" and is_number(b.operands[0], 0.5):
                return b.operands[1]
            # a sign is moved outwards, which changes no bit
            case "add" if b.operation == "neg":
                return a - b.operands[0]
            case "add" if a.operation == "neg":
                return b - a.operands[0]
            case "sub" if b.operation == "neg":
                return a + b.operands[0]
            case "mul" | "div" if a.operation == "neg":
                return -self.node(operation, a.operands[0], b)
            case "mul" | "div" if b.operation == "neg":
                return -self.node(operation, a, b.operands[0])
        return None

    def inverse(self, node: Node) -> Node | None:
        """1/node, if the tape has computed it."""
        return self._known.get(("div", (self.constant(1.0).index, node.index), 0.0))


_FOLDED: Final[dict[str, Callable[..., float]]] = {
    "add": lambda a, b: a + b,
    "sub": lambda a, b: a - b,
    "mul": lambda a, b: a * b,
    "div": lambda a, b: a / b,
    "neg": lambda a: -a,
}


def is_number(node: Node, value: float) -> bool:
    """Whether a node is this constant."""
    return node.operation == "constant" and node.detail == value


def trace(leaf: Leaf) -> tuple[Tape, list[Node], tuple[Node, ...]]:
    """(tape, inputs, results) of a leaf; what formulas bind to names of their own keeps them, for the emitted text."""
    tape = Tape()
    inputs = [tape.input(name) for name in leaf.scalars]
    own = {x.index for x in inputs}

    def note(frame: FrameType, event: str, _: Any) -> None:
        if event == "return" and frame.f_globals.get("__name__", "").startswith(_FORMULAS):
            for name, value in frame.f_locals.items():
                for part, node in _parts(name, value):
                    if node.index not in own and node.operation != "constant":
                        tape.names.setdefault(node.index, part)

    before = sys.getprofile()
    sys.setprofile(note)
    try:
        results = leaf(*inputs)
    finally:
        sys.setprofile(before)
    return tape, inputs, tuple(tape.constant(x) for x in results)


def _parts(name: str, value: Any) -> Sequence[tuple[str, Node]]:
    if isinstance(value, Node):
        return [(name, value)]
    if isinstance(value, Vec3):
        return [(f"{name}_{axis}", x) for axis, x in zip("xyz", value.parts, strict=True) if isinstance(x, Node)]
    return []
