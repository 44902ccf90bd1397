"""What a shape that is no diffuse one sends of a light, over what a diffuse one that faces the light would."""

from __future__ import annotations

import math

from symrender.chambers.leaf_rows import lit_beckmann_rows, lit_conductor_rows, lit_phong_rows
from symrender.chambers.lobes.fit import FIT_OVER, fit_over_exact
from symrender.chambers.lobes.levels import is_critical
from symrender.chambers.lobes.record import CONDUCTOR, LAMBERT, POWER, Sender
from symrender.chambers.records import INVERSE_SQUARE, NODES, LightPoint, Nodes
from symrender.chambers.row_powers import powers
from symrender.jit.marks import inlined, jitable
from symrender.jit.records import Table
from symrender.leaves.values import lit_beckmann_most, lit_conductor_most

TAME = 2.0
"""A power of width w is tame to this times w beside the real line: it grows there by no more than a factor 8."""


@jitable
def most_sent(square: float, tilt: float, facing: float, row: int, senders: Table[Sender] | None) -> float:
    """No place where the angle has this squared chord or more, cos_o this or more, and N.l this or less sends more."""
    if senders is None:
        return 0.0
    sender = senders[row]
    if sender.kind == POWER:
        base = max(0.0, 1.0 - 0.5 * square)
        return float(0.5 * (sender.exponent + 2.0) * min(1.0, max(0.0, facing)) * base**sender.exponent)
    rough = sender.conductor
    if rough.beckmann != 0.0:
        most = lit_beckmann_most(min(2.0, square), min(1.0, max(0.0, tilt)), rough.alpha)
        return float(most * FIT_OVER if rough.walter != 0.0 else most)
    return float(lit_conductor_most(min(2.0, square), max(0.0, tilt), rough.alpha))


@jitable
def sent_width(nearest: float, row: int, senders: Table[Sender] | None) -> float:
    """How far the angle may turn and what is sent stay tame, where its chord is ``nearest`` or more."""
    if senders is None:
        return 1.0
    sender = senders[row]
    if sender.kind == POWER:
        return TAME / math.sqrt(sender.exponent)
    if sender.conductor.beckmann != 0.0:
        return float(sender.conductor.alpha)
    return math.hypot(sender.conductor.alpha, nearest)


@inlined
def is_phong(row: int, senders: Table[Sender] | None) -> bool:
    """Whether a sender is a phong material."""
    if senders is None:
        return False
    return bool(senders[row].kind == POWER)


@jitable
def end_power(row: int, senders: Table[Sender] | None) -> float:
    """With which power of the distance the highlight of a phong material ends, 0 of what has no end."""
    if senders is None:
        return 0.0
    if row < 0:
        return 0.0
    return float(senders[row].exponent) if senders[row].kind == POWER else 0.0


@jitable
def reflects_wholly(row: int, senders: Table[Sender] | None) -> bool:
    """Whether a shape's material reflects wholly beyond a critical angle in some channel."""
    if senders is None:
        return False
    if row < 0 or senders[row].kind != CONDUCTOR:
        return False
    metal = senders[row].conductor
    found = False
    for a in range(3):
        found = found or is_critical(metal.eta[a], metal.k[a])
    return found


@jitable
def grazing_pole(row: int, senders: Table[Sender] | None) -> float:
    """How far beside a right angle the masking's root is 0, where a cosine is +- i alpha/sqrt(1 - alpha^2)."""
    if senders is None:
        return math.inf
    if senders[row].kind != CONDUCTOR:
        return math.inf
    return math.atanh(min(senders[row].conductor.alpha, 0.999))


@jitable
def sent_shares(start: int, stop: int, b: Nodes, p: LightPoint, row: int, senders: Table[Sender] | None) -> None:
    """Fill ``shares`` of nodes with what the shape ``row`` sends of the light point, by channels."""
    if senders is None:
        return
    stop = min(stop, NODES)
    rough, exponent = senders[row].conductor, senders[row].exponent
    eta, k = rough.eta, rough.k
    x, y, z = p.position[0], p.position[1], p.position[2]
    falling = 1.0 if p.fall == INVERSE_SQUARE else 0.0
    if senders[row].kind == POWER:
        lit_phong_rows(start, stop, x, y, z, falling, exponent, b)
        if exponent == 0.0:
            # nothing is reflected below the plane across the mirror image
            for i in range(start, stop):
                b.power[i] = 1.0 if b.radix[i] > 0.0 else 0.0
        else:
            powers(start, stop, b, exponent)
        for i in range(start, stop):
            b.shares[0, i] = b.shares[1, i] = b.shares[2, i] = b.power[i]
        return
    if rough.beckmann != 0.0:
        lit_beckmann_rows(
            start, stop, x, y, z, falling, rough.alpha, rough.masking, eta[0], eta[1], eta[2], k[0], k[1], k[2], b
        )
        if rough.walter != 0.0:
            for i in range(start, stop):
                lx, ly, lz = x - b.place[0, i], y - b.place[1, i], z - b.place[2, i]
                inward = lx * b.normal[0, i] + ly * b.normal[1, i] + lz * b.normal[2, i]
                inward /= math.sqrt(max(1e-300, lx * lx + ly * ly + lz * lz))
                outward = b.toward[0, i] * b.normal[0, i] + b.toward[1, i] * b.normal[1, i]
                outward += b.toward[2, i] * b.normal[2, i]
                share = fit_over_exact(inward, outward, rough.alpha, rough.masking)
                for a in range(3):
                    b.shares[a, i] *= share
        return
    lit_conductor_rows(
        start, stop, x, y, z, falling, rough.alpha, rough.masking, eta[0], eta[1], eta[2], k[0], k[1], k[2], b
    )


def largest_sent(senders: Table[Sender] | None) -> float:
    """No shape sends more."""
    rows = [] if senders is None else [row for row, sender in enumerate(senders) if sender.kind != LAMBERT]
    return max([1.0, *(most_sent(0.0, 0.0, 1.0, row, senders) for row in rows)])
