"""Leaves as Python in the language of kernels: scalar functions, their derivatives, and loops over rows of nodes."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Final

from symrender.chambers.records import Nodes
from symrender.expression.elementary import LEAST
from symrender.expression.leaf import Leaf
from symrender.kernel.tape import Node, Tape, trace
from symrender.targets.leaf_text import ATOM, Scribe

_CALLS: Final = {
    **{
        name: f"math.{name}({{}})"
        for name in ("sqrt", "sin", "cos", "tan", "asin", "exp", "log", "log1p", "expm1", "erf")
    },
    "length": f"math.sqrt(max({{}}, {LEAST!r}))",
    "positive": f"max({{}}, {LEAST!r})",
    "arc_cosine": "math.acos(max(-1.0, min(1.0, {})))",
    "azimuth": "math.atan2({}, {})",
    "clamp": "min(1.0, max(0.0, {}))",
    "ramp": "max({}, 0.0)",
    "gleam": "gleam({}, {})",
}
_WIDTH: Final = 118
_TAKEN: Final = ("gleam", "i", "m", "math", "max", "min", "nodes", "power")


class _Python(Scribe):
    """Python text that kernels can be made of."""

    def literal(self, value: float) -> str:
        return "math.pi" if value == math.pi else repr(value)

    def call(self, operation: str, operands: Sequence[str]) -> str:
        return _CALLS[operation].format(*operands)

    def choice(self, test: str, value: str, otherwise: str) -> str:
        return f"{value} if {test} else {otherwise}"

    def assign(self, name: str, value: str) -> str:
        return f"{name} = {value}"


def folded(head: str, items: Iterable[str], tail: str, pad: str) -> list[str]:
    """``head item, item, ... tail`` in lines no wider than the page."""
    items = list(items)
    one = f"{head}{', '.join(items)}{tail}"
    if len(one) <= _WIDTH:
        return [one]
    lines, line = [head], ""
    for item in items:
        if len(pad) + 4 + len(line) + len(item) + 2 > _WIDTH:
            lines.append(f"{pad}    {line.rstrip()}")
            line = ""
        line += f"{item}, "
    return [*lines, f"{pad}    {line.rstrip()}", f"{pad}{tail.lstrip()}"]


def function(name: str, arguments: Sequence[str], tape: Tape, results: Sequence[Node], doc: str) -> str:
    """A function of scalars that returns the results; where a guard does not hold, its constant and no slopes."""
    body: list[str] = []
    guard = results[0] if results[0].operation == "where_positive" else None
    scribe = _Python(tape, [guard.operands[0]] if guard is not None else results, taken=_TAKEN)
    if guard is not None:
        body += scribe.lines()
        otherwise = [scribe.literal(float(guard.operands[2].detail)), *("0.0" for _ in results[1:])]
        body += [f"if not {scribe.test(guard.operands[0])}:", f"    return {', '.join(otherwise)}"]
        known = scribe.texts
        scribe = _Python(tape, [guard.operands[1], *results[1:]], taken=[*_TAKEN, *scribe.taken])
        scribe.texts.update({k: v for k, v in known.items() if v[1] == ATOM})
    body += scribe.lines()
    values = [scribe.text(x) for x in scribe.results]
    kind = "float" if len(values) == 1 else f"tuple[{', '.join(['float'] * len(values))}]"
    if len(kind) > 90:
        kind = "tuple[float, ...]"
    head = folded(f"def {name}(", [f"{a}: float" for a in arguments], f") -> {kind}:", "")
    leave = [f"return {', '.join(values)}"]
    if len(leave[0]) > _WIDTH - 4:
        leave = folded("return (", values, ")", "    ")
    lines = [*(f"    {line}" for line in body), f"    {leave[0]}", *leave[1:]]
    return "\n".join(["@inlined", *head, *_doc(doc), *lines])


def _doc(text: str) -> list[str]:
    words, lines, line = text.split(" "), [], '    """'
    for word in words:
        if len(line) + len(word) + 1 > _WIDTH:
            lines.append(line.rstrip())
            line = "    "
        line += word if line.endswith(('"""', "    ")) else f" {word}"
    return [*lines, f'{line}"""'] if not lines else [*lines, line, '    """']


def value(leaf: Leaf) -> str:
    """The leaf itself."""
    tape, inputs, results = trace(leaf)
    return function(leaf.name, [str(x.detail) for x in inputs], tape, results, leaf.doc)


def rows(leaf: Leaf) -> str:
    """A loop over nodes ``start`` to ``stop``; what is the same for all of them is computed before it."""
    assert leaf.rows is not None
    tape, inputs, results = trace(leaf)
    loads = dict(leaf.rows.loads)
    places = {
        part: _element(row, k)
        for argument, row in loads.items()
        for k, part in enumerate(leaf.parts(argument))
    }  # fmt: skip
    uniform = [str(x.detail) for x in inputs if str(x.detail) not in places]
    found = dict(zip(leaf.result_names, results, strict=True))
    stores = [(row, mode, [n for n in found if n == name or n[:-2] == name]) for name, row, mode in leaf.rows.stores]
    # a result that goes to two rows is used twice
    scribe = _Python(tape, [found[part] for _, _, parts in stores for part in parts], taken=_TAKEN)
    varying = {x.index for x in inputs if str(x.detail) in places}
    for node in scribe.needed:
        if any(x.index in varying for x in node.operands):
            varying.add(node.index)
    everywhere = frozenset(x.index for x in scribe.needed)
    before = [] if not uniform else scribe.lines(everywhere - frozenset(varying))
    read = {str(x.detail) for x in scribe.needed if x.operation == "input"}
    body = [f"{part} = {place}" for part, place in places.items() if part in read]
    body += scribe.lines(frozenset(varying))
    for row, mode, parts in stores:
        for k, part in enumerate(parts):
            sign = {"set": "=", "scale": "*="}[mode]
            body.append(f"{_element(row, k)} {sign} {scribe.text(found[part])}")
    arguments = ["start: int", "stop: int", *(f"{name}: float" for name in uniform), "nodes: Nodes"]
    head = folded(f"def {leaf.name}_rows(", arguments, ") -> None:", "")
    doc = f"{_plain(leaf.doc)}, of nodes ``start`` to ``stop``."
    lines = [*(f"    {line}" for line in before), "    stop = min(stop, NODES)", "    for i in range(start, stop):"]
    return "\n".join(["@jitable", *head, *_doc(doc), *lines, *(f"        {line}" for line in body)])


def _element(row: str, k: int) -> str:
    """Element of a row of ``Nodes``, of the k-th of those of a vector."""
    return f"nodes.{row}[{k}, i]" if len(Nodes.layout[row].shape) > 1 else f"nodes.{row}[i]"


def _plain(doc: str) -> str:
    return doc.rstrip(".")
