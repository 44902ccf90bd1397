"""Local names of kernels that carry something from one turn of a loop to the next where none was meant.

A name is *exposed* in a loop if a turn may read it before it binds it: it then holds what the turn before left. Sums
and brackets are meant so. What is not:

- ``stale``: the name is not bound before the loop on every path, so that the first turn reads nothing;
- ``leaks``: bound before the loop, and overwritten, by a value that does not depend on it, in a loop inside;
- ``mixed``: bound to a truth value in one place and to a number in another.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from dataclasses import dataclass, field


@dataclass(frozen=True, order=True)
class Leak:
    """A finding: the function, the line in its file, the name and the kind."""

    function: str
    line: int
    name: str
    kind: str


@dataclass
class _Loop:
    """A loop being walked: reads that its turns expose, and lines of plain overwrites in loops inside it."""

    exposed: dict[str, int] = field(default_factory=dict)
    overwritten: dict[str, int] = field(default_factory=dict)
    breaks: list[set[str]] = field(default_factory=list)
    """What is bound where each ``break`` leaves the loop."""


def leaks(source: str) -> list[Leak]:
    """Every finding in the functions of a module's text."""
    found: set[Leak] = set()
    for node in ast.parse(source).body:
        if isinstance(node, ast.FunctionDef):
            found |= _Function(node).found
    return sorted(found)


class _Function:
    def __init__(self, node: ast.FunctionDef) -> None:
        self.name = node.name
        self.found: set[Leak] = set()
        self.locals = {n.id for n in ast.walk(node) if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)}
        self.loops: list[_Loop] = []
        # of each open loop what is bound in this turn; the first is the function itself
        self.turns: list[set[str]] = []
        arguments = node.args
        names = {a.arg for a in (*arguments.posonlyargs, *arguments.args, *arguments.kwonlyargs)}
        self._block(node.body, [names])
        self._mixed(node)

    def _note(self, line: int, name: str, kind: str) -> None:
        self.found.add(Leak(self.name, line, name, kind))

    def _read(self, node: ast.expr | None, bound: list[set[str]]) -> None:
        """``bound``: what is bound on every path, one set for the function and one for each turn of an open loop."""
        parts = list(ast.walk(node)) if node is not None else []
        own = {n.id for part in parts if isinstance(part, ast.comprehension) for n in _names(part.target)}
        for name in parts:
            if not (isinstance(name, ast.Name) and isinstance(name.ctx, ast.Load)) or name.id in own:
                continue
            if name.id not in self.locals:
                continue
            if not any(name.id in turn for turn in bound):
                self._note(name.lineno, name.id, "stale")
            for depth, loop in enumerate(self.loops, 1):
                if not any(name.id in turn for turn in bound[depth:]):
                    loop.exposed.setdefault(name.id, name.lineno)

    def _bind(self, target: ast.expr, value: ast.expr | None, bound: list[set[str]]) -> None:
        if isinstance(target, ast.Tuple):
            for part in target.elts:
                self._bind(part, value, bound)
        elif isinstance(target, ast.Name):
            depends = value is None or any(isinstance(n, ast.Name) and n.id == target.id for n in ast.walk(value))
            if not depends:
                for loop in self.loops[:-1]:
                    loop.overwritten.setdefault(target.id, target.lineno)
            bound[-1].add(target.id)
        else:
            self._read(target, bound)

    def _block(self, body: list[ast.stmt], bound: list[set[str]]) -> bool:
        """Walk statements; whether the end of the block is reached."""
        for statement in body:
            match statement:
                case ast.Assign(targets=targets, value=value):
                    self._read(value, bound)
                    for target in targets:
                        self._bind(target, value, bound)
                case ast.AnnAssign(target=target, value=value):
                    self._read(value, bound)
                    if value is not None:
                        self._bind(target, value, bound)
                case ast.AugAssign(target=target, value=value):
                    self._read(value, bound)
                    if isinstance(target, ast.Name):
                        self._read(ast.copy_location(ast.Name(target.id, ast.Load()), target), bound)
                    else:
                        self._read(target, bound)
                case ast.Expr(value=value):
                    self._read(value, bound)
                case ast.Return(value=value):
                    self._read(value, bound)
                    return False
                case ast.Break():
                    self.loops[-1].breaks.append(set(bound[-1]))
                    return False
                case ast.Continue() | ast.Raise():
                    return False
                case ast.If(test=test, body=then, orelse=other):
                    self._read(test, bound)
                    ends = []
                    for branch in (then, other):
                        inside = [set(turn) for turn in bound]
                        if self._block(branch, inside):
                            ends.append(inside)
                    if not ends:
                        return False
                    for turn, *reached in zip(bound, *ends, strict=True):
                        turn |= set.intersection(*reached)
                case ast.For(target=target, iter=over, body=inner):
                    self._read(over, bound)
                    self._loop(inner, bound, target)
                case ast.While(test=test, body=inner):
                    loop = self._loop([ast.copy_location(ast.Expr(test), test), *inner], bound, None)
                    if isinstance(test, ast.Constant) and test.value:
                        if not loop.breaks:
                            return False
                        bound[-1] |= set.intersection(*loop.breaks)
                case ast.Pass() | ast.Assert() | ast.Import() | ast.ImportFrom() | ast.FunctionDef() | ast.ClassDef():
                    pass
                case ast.With(body=inner) | ast.Try(body=inner):
                    if not self._block(inner, bound):
                        return False
                case _:
                    raise NotImplementedError(f"{self.name}: {type(statement).__name__} in line {statement.lineno}")
        return True

    def _loop(self, body: list[ast.stmt], bound: list[set[str]], target: ast.expr | None) -> _Loop:
        loop = _Loop()
        self.loops.append(loop)
        inside = [*(set(turn) for turn in bound), set()]
        if target is not None:
            self._bind(target, None, inside)
        self._block(body, inside)
        self.loops.pop()
        for name, line in loop.exposed.items():
            if name in loop.overwritten:
                self._note(line, name, "leaks")
        return loop

    def _mixed(self, node: ast.FunctionDef) -> None:
        kinds: dict[str, set[bool]] = {}
        lines: dict[str, int] = {}
        for name, value in _bindings(node):
            kind = _truth(value)
            if kind is not None:
                kinds.setdefault(name, set()).add(kind)
                lines[name] = value.lineno
        for name, found in kinds.items():
            if len(found) == 2:
                self._note(lines[name], name, "mixed")


def _bindings(node: ast.AST) -> Iterator[tuple[str, ast.expr]]:
    for statement in ast.walk(node):
        if not isinstance(statement, ast.Assign):
            continue
        for target in statement.targets:
            if isinstance(target, ast.Name):
                yield target.id, statement.value
            elif isinstance(target, ast.Tuple) and isinstance(statement.value, ast.Tuple):
                for part, value in zip(target.elts, statement.value.elts, strict=False):
                    if isinstance(part, ast.Name):
                        yield part.id, value


def _names(node: ast.AST) -> list[ast.Name]:
    return [n for n in ast.walk(node) if isinstance(n, ast.Name)]


def _truth(value: ast.expr) -> bool | None:
    """True of a truth value, False of a number, None of what may be either."""
    match value:
        case ast.Compare() | ast.BoolOp() | ast.UnaryOp(op=ast.Not()):
            return True
        case ast.Constant(value=constant):
            return isinstance(constant, bool)
        case ast.BinOp():
            return False
    return None
