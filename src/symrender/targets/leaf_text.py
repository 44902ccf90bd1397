"""Tape to statements: what every language of a leaf shares.

A node used once is written where it is used; one used more often, or bound to a name by the formula, gets a statement.
Brackets keep the order of operations as it was written.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import Final

from symrender.kernel.tape import Node, Tape

_SUM, _PRODUCT, _SIGN, ATOM = range(4)
_WIDEST: Final = 84
"""Longest expression written where it is used."""
_LONGEST: Final = 96
"""Longest expression of a statement, if it can be broken."""
_SIGNS: Final = {"add": ("+", _SUM), "sub": ("-", _SUM), "mul": ("*", _PRODUCT), "div": ("/", _PRODUCT)}


class Scribe(ABC):
    """Writes the nodes some results need, in order, as lines of one language."""

    def __init__(self, tape: Tape, results: Sequence[Node], taken: Sequence[str] = ()) -> None:
        self.tape = tape
        self.results = list(results)
        self.needed = _needed(self.results)
        self.uses: dict[int, int] = {}
        for node in self.needed:
            for operand in node.operands:
                at = operand.index
                self.uses[at] = self.uses.get(at, 0) + 1
        for node in self.results:
            self.uses[node.index] = self.uses.get(node.index, 0) + 1
        self.lazy = self._lazy()
        self.texts: dict[int, tuple[str, int]] = {}
        self.taken = {*taken, *(str(n.detail) for n in tape.nodes if n.operation == "input")}
        self.count = 0

    # what a language decides

    @abstractmethod
    def literal(self, value: float) -> str:
        """A number, with its point."""

    @abstractmethod
    def call(self, operation: str, operands: Sequence[str]) -> str:
        """An elementary function."""

    @abstractmethod
    def choice(self, test: str, value: str, otherwise: str) -> str:
        """``value`` where the condition holds."""

    @abstractmethod
    def assign(self, name: str, value: str) -> str:
        """A statement that binds a name."""

    def input(self, name: str) -> str:
        """How an argument is written."""
        return name

    # the writing

    def _lazy(self) -> set[int]:
        """Nodes that may only be computed where a guard holds: they are written inside its choice."""
        found: set[int] = set()
        for node in self.results:
            if node.operation == "where_positive":
                outside = [node.operands[0], *(x for x in self.results if x is not node)]
                found |= {x.index for x in _needed([node.operands[1]])}
                found -= {x.index for x in _needed(outside)}
        return found

    def lines(self, only: frozenset[int] | None = None) -> list[str]:
        """Statements for the nodes that need one; with ``only``, for those of these indices."""
        found: list[str] = []
        for node in self.needed:
            if (only is not None and node.index not in only) or node.index in self.texts:
                continue
            if node.operation in ("constant", "input") or node.index in self.lazy:
                continue
            bare = node.index not in self.tape.names
            text, level = self._written(node)
            widest = _WIDEST if node not in self.results else _LONGEST
            if self.uses[node.index] == 1 and (bare or node in self.results) and len(text) <= widest:
                self.texts[node.index] = text, level
                continue
            found += self._broken(node)
            text, level = self._written(node)
            if self.uses[node.index] == 1 and node in self.results and len(text) <= _LONGEST:
                self.texts[node.index] = text, level
            else:
                found.append(self.assign(self._name(node), text))
        return found

    def _broken(self, node: Node) -> list[str]:
        """Statements for the longest operands of a node whose own text is too long for a line."""
        found: list[str] = []
        operands = sorted(node.operands, key=lambda x: -len(self.text(x)))
        for operand in operands:
            if len(self._written(node)[0]) > _LONGEST and operand.operation not in ("constant", "input"):
                text = self._written(operand)[0]
                found.append(self.assign(self._name(operand), text))
        return found

    def _next(self) -> int:
        self.count += 1
        return self.count

    def _name(self, node: Node) -> str:
        name = self.tape.names.get(node.index, "")
        while not name or name in self.taken:
            name = f"t{self._next()}"
        self.taken.add(name)
        self.texts[node.index] = name, ATOM
        return name

    def text(self, node: Node, level: int = _SUM) -> str:
        """How a node is written where it is used, bracketed where ``level`` binds tighter."""
        node = node
        text, own = self.texts[node.index] if node.index in self.texts else self._written(node)
        return text if own >= level else f"({text})"

    def _written(self, node: Node) -> tuple[str, int]:
        match node.operation:
            case "constant":
                value = float(node.detail)
                return self.literal(value), _SIGN if value < 0.0 else ATOM
            case "input":
                return self.input(str(node.detail)), ATOM
            case "add" | "sub" | "mul" | "div" as operation:
                sign, level = _SIGNS[operation]
                a, b = node.operands
                return f"{self.text(a, level)} {sign} {self.text(b, level + 1)}", level
            case "neg":
                return f"-{self.text(node.operands[0], _SIGN)}", _SIGN
            case "where_positive":
                test, guarded, otherwise = node.operands
                return f"({self.choice(self.test(test), self.text(guarded), self.text(otherwise))})", ATOM
        return self.call(node.operation, [self.text(x) for x in node.operands]), ATOM

    def test(self, node: Node) -> str:
        """The condition that a node is positive."""
        # a difference is positive exactly where its first operand is larger
        if node.operation == "sub" and self.uses[node.index] == 1:
            a, b = node.operands
            if a.operation == "constant":
                return f"{self.text(b)} < {self.text(a)}"
            return f"{self.text(a)} > {self.text(b)}"
        return f"{self.text(node)} > {self.literal(0.0)}"


def _needed(results: Sequence[Node]) -> list[Node]:
    """What results depend on, themselves included, operands first."""
    order: list[Node] = []
    done: set[int] = set()

    def visit(node: Node) -> None:
        if node.index in done:
            return
        done.add(node.index)
        for operand in node.operands:
            visit(operand)
        order.append(node)

    for result in sorted(results, key=lambda x: x.index):
        visit(result)
    return order
