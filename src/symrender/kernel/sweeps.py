"""Derivatives of a tape, written onto the same tape: a reverse sweep a result, or a forward sweep an input.

Slopes of roots, quotients and calls are told in terms of the value itself where that is cheapest. Where a function is
guarded its slope is too: that of a gleam comes, with its value, from one call that knows when its base is not
positive; of a length at 0 it is finite.
"""

from __future__ import annotations

from collections.abc import Sequence

from symrender.kernel.tape import Node, Tape, is_number


def slopes_of(node: Node) -> list[tuple[Node, Node]]:
    """(operand, slope of the node in it) of one operation."""
    tape, of = node.tape, node.operands
    one = tape.constant(1.0)
    match node.operation:
        case "add":
            return [(of[0], one), (of[1], one)]
        case "sub":
            return [(of[0], one), (of[1], -one)]
        case "neg":
            return [(of[0], -one)]
        case "mul":
            return [(of[0], of[1]), (of[1], of[0])]
        case "div":
            inverse = 1.0 / of[1]
            return [(of[0], inverse), (of[1], -(node * inverse))]
        case "sqrt" | "length":
            return [(of[0], 0.5 / node)]
        case "sin":
            return [(of[0], of[0].cos())]
        case "cos":
            return [(of[0], -of[0].sin())]
        case "tan":
            return [(of[0], 1.0 + node * node)]
        case "asin":
            return [(of[0], 1.0 / ((1.0 - of[0]) * (1.0 + of[0])).sqrt())]
        case "arc_cosine":
            return [(of[0], -1.0 / ((1.0 - of[0]) * (1.0 + of[0])).length())]
        case "azimuth":
            y, x = of
            far2 = (y * y + x * x).positive()
            return [(y, x / far2), (x, -(y / far2))]
        case "exp":
            return [(of[0], node)]
        case "log":
            return [(of[0], 1.0 / of[0])]
        case "log1p":
            return [(of[0], 1.0 / (1.0 + of[0]))]
        case "expm1":
            return [(of[0], 1.0 + node)]
        case "erf":
            return [(of[0], 1.1283791670955126 * (-(of[0] * of[0])).exp())]
        case "gleam":
            call = tape.node("gleam_slopes", *of)
            return [(of[0], tape.part(call, 1)), (of[1], tape.part(call, 2))]
        case "where_positive":
            # the guard stands outside: where it does not hold no slope is asked for
            return [(of[1], one)]
        case "constant" | "input":
            return []
    raise NotImplementedError(f"no slope of {node.operation}")


def _terms(node: Node, weight: Node) -> list[tuple[Node, Node]]:
    """(operand, weight times the slope in it), with as few quotients as the tape's own allow."""
    of = node.operands
    match node.operation:
        case "div" if is_number(of[0], 1.0):
            return [(of[1], -(weight * node * node))]
        case "div":
            share = _over(weight, of[1])
            return [(of[0], share), (of[1], -(share * node))]
        case "sqrt" | "length":
            return [(of[0], 0.5 * _over(weight, node))]
        case "mul" if of[0] is of[1]:
            return [(of[0], 2.0 * weight * of[0])]
    return [(operand, weight * slope) for operand, slope in slopes_of(node)]


def _over(weight: Node, bottom: Node) -> Node:
    inverse = weight.tape.inverse(bottom)
    return weight / bottom if inverse is None else weight * inverse


def reverse(tape: Tape, weights: Sequence[tuple[Node, Node]], inputs: Sequence[Node]) -> list[Node]:
    """Sum over (result, weight) of weight times the result's slope in each input: one reverse sweep."""
    adjoint: dict[int, Node] = {}
    for result, weight in weights:
        adjoint[result.index] = adjoint[result.index] + weight if result.index in adjoint else weight
    wanted = _reaching(tape, inputs)
    for node in reversed(tape.nodes[: 1 + max(adjoint, default=0)]):
        if node.index not in adjoint or node.index not in wanted or is_number(adjoint[node.index], 0.0):
            continue
        for operand, term in _terms(node, adjoint[node.index]):
            if operand.index in wanted and not is_number(term, 0.0):
                adjoint[operand.index] = adjoint[operand.index] + term if operand.index in adjoint else term
    zero = tape.constant(0.0)
    return [adjoint.get(x.index, zero) for x in inputs]


def forward(tape: Tape, results: Sequence[Node], by: Node) -> list[Node]:
    """The results' slopes in one input: one forward sweep."""
    zero = tape.constant(0.0)
    tangent: dict[int, Node] = {by.index: tape.constant(1.0)}
    for node in tape.nodes[: 1 + max(x.index for x in results)]:
        total = zero
        if not any(x.index in tangent for x in node.operands):
            continue
        for operand, slope in _forward(node, tangent):
            total = total + slope * tangent[operand.index]
        if not is_number(total, 0.0):
            tangent[node.index] = total
    return [tangent.get(x.index, zero) for x in results]


def _forward(node: Node, tangent: dict[int, Node]) -> list[tuple[Node, Node]]:
    """(operand, slope) of the operands that move."""
    of = node.operands
    if node.operation == "mul" and of[0] is of[1]:
        return [(of[0], 2.0 * of[0])]
    return [(operand, slope) for operand, slope in slopes_of(node) if operand.index in tangent]


def _reaching(tape: Tape, inputs: Sequence[Node]) -> set[int]:
    """Nodes that depend on one of the inputs."""
    found = {x.index for x in inputs}
    for node in tape.nodes:
        if any(x.index in found for x in node.operands):
            found.add(node.index)
    return found
