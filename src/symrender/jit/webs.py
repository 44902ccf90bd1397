"""Which uses of a name are one variable.

A name may hold a number here and an array there. Assignments that reach a common use make one variable, and others do
not, so each variable has one type. What reaches the head of a loop is taken to be any assignment of its body.
"""

from __future__ import annotations

import ast
from collections.abc import Sequence

Reaching = dict[str, frozenset[int]]


class Webs:
    """Variables of a function: ``of(node)`` is the number of the one that a name node reads or writes, or None."""

    def __init__(self, function: ast.FunctionDef) -> None:
        self._parent: list[int] = []
        self._definition: dict[ast.AST, int] = {}
        self._uses: dict[ast.AST, int | None] = {}
        self._breaks: list[list[Reaching]] = []
        env: Reaching = {}
        for argument in function.args.posonlyargs + function.args.args + function.args.kwonlyargs:
            self._define(argument, argument.arg, env)
        self.assigned = {node.id for node in _names(function) if _stores(node)}
        self._block(function.body, env)

    def of(self, node: ast.AST) -> int | None:
        """The variable of a name or argument node; None for a name that no assignment reaches."""
        found = self._definition[node] if node in self._definition else self._uses.get(node)
        return None if found is None else self._root(found)

    def _root(self, number: int) -> int:
        while self._parent[number] != number:
            self._parent[number] = self._parent[self._parent[number]]
            number = self._parent[number]
        return number

    def _number(self, node: ast.AST) -> int:
        if node not in self._definition:
            self._definition[node] = len(self._parent)
            self._parent.append(len(self._parent))
        return self._definition[node]

    def _define(self, node: ast.AST, name: str, env: Reaching) -> None:
        env[name] = frozenset((self._number(node),))

    def _use(self, node: ast.Name, env: Reaching) -> int | None:
        reaching = sorted(env.get(node.id, ()))
        for other in reaching[1:]:
            self._parent[self._root(other)] = self._root(reaching[0])
        self._uses[node] = reaching[0] if reaching else None
        return self._uses[node]

    def _block(self, statements: Sequence[ast.stmt], env: Reaching) -> Reaching | None:
        """What reaches the end of the statements, None where the end is not reached."""
        current: Reaching | None = env
        for statement in statements:
            if current is None:
                return None
            current = self._statement(statement, current)
        return current

    def _statement(self, statement: ast.stmt, env: Reaching) -> Reaching | None:
        match statement:
            case ast.If(test=test, body=body, orelse=orelse):
                self._read(test, env)
                return _merged([self._block(body, dict(env)), self._block(orelse, dict(env))])
            case ast.For(target=target, iter=source, body=body):
                self._read(source, env)
                return self._loop(env, body, target)
            case ast.While(test=test, body=body):
                return self._loop(env, body, None, test)
            case ast.Break():
                if self._breaks:
                    self._breaks[-1].append(dict(env))
                return None
            case ast.Continue():
                return None
            case ast.Return(value=value):
                if value is not None:
                    self._read(value, env)
                return None
            case ast.AugAssign(target=target, value=value):
                if isinstance(target, ast.Name):
                    # the read and the write are one node: one variable
                    found = self._use(target, env)
                    self._read(value, env)
                    self._define(target, target.id, env)
                    if found is not None:
                        self._parent[self._root(self._definition[target])] = self._root(found)
                else:
                    self._read(target, env)
                    self._read(value, env)
                return env
            case ast.Assign(targets=targets, value=value):
                self._read(value, env)
                for target in targets:
                    self._write(target, env)
                return env
            case ast.AnnAssign(target=target, value=value):
                if value is not None:
                    self._read(value, env)
                    self._write(target, env)
                return env
        self._read(statement, env)
        return env

    def _loop(
        self, env: Reaching, body: Sequence[ast.stmt], target: ast.expr | None, test: ast.expr | None = None
    ) -> Reaching:
        head = dict(env)
        for part in ([] if target is None else [target], body):
            for statement in part:
                for node in _names(statement):
                    if _stores(node):
                        head[node.id] = head.get(node.id, frozenset()) | {self._number(node)}
        if test is not None:
            self._read(test, head)
        inside = dict(head)
        if target is not None:
            self._write(target, inside)
        self._breaks.append([])
        end = self._block(body, inside)
        merged = _merged([head, end, *self._breaks.pop()])
        assert merged is not None
        return merged

    def _write(self, target: ast.expr, env: Reaching) -> None:
        match target:
            case ast.Name():
                self._define(target, target.id, env)
            case ast.Tuple(elts=items) | ast.List(elts=items):
                for item in items:
                    self._write(item, env)
            case _:
                self._read(target, env)

    def _read(self, node: ast.AST, env: Reaching) -> None:
        for part in _names(node):
            if isinstance(part.ctx, ast.Load):
                self._use(part, env)


def _names(tree: ast.AST) -> list[ast.Name]:
    """The names in a tree: ``ast.walk`` asks every node for its fields, and takes three times as long."""
    found: list[ast.Name] = []
    nodes = [tree]
    while nodes:
        node = nodes.pop()
        if isinstance(node, ast.Name):
            found.append(node)
            continue
        for value in vars(node).values():
            if isinstance(value, ast.AST):
                nodes.append(value)
            elif isinstance(value, list):
                nodes.extend(item for item in value if isinstance(item, ast.AST))
    return found


def _stores(node: ast.Name) -> bool:
    return isinstance(node.ctx, ast.Store)


def _merged(ends: Sequence[Reaching | None]) -> Reaching | None:
    reached = [end for end in ends if end is not None]
    if not reached:
        return None
    names = {name for end in reached for name in end}
    return {name: frozenset().union(*(end.get(name, frozenset()) for end in reached)) for name in names}
