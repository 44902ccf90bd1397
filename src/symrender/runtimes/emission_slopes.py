"""Derivatives, by what lights send, of light that flat faces reflect: it is linear in it, to any depth.

The derivative in one number of what a light sends is the light of the same scene in which that light alone sends, one
unit, and no other does. Its error is that of this value.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt

from symrender.errors import Unsupported
from symrender.jit.records import copied, flat
from symrender.quadrature.split_setup import MET
from symrender.radiometric.slopes import record_moves
from symrender.runtimes.bounce_slopes import BouncedSlopes, SlopeBouncer
from symrender.runtimes.radiosity import Gatherer
from symrender.scene.moves import Move
from symrender.scene.radiometric.arrays import RadiometricArrays
from symrender.scene.radiometric.flat import is_round

Complex = npt.NDArray[np.complex128]


def check_emission(arrays: RadiometricArrays, wrt: tuple[Move, ...]) -> None:
    """Raise ``Unsupported``, by name, for a parameter that is not part of what a light sends."""
    for move in wrt:
        moves = record_moves(arrays, move)
        sent = copied(moves.lights)
        sent["emitted"][:] = 0.0
        others: tuple[Any, ...] = (moves.materials, moves.terms, moves.shapes, moves.facets, moves.camera, sent)
        if moves.directions.any() or any(flat(each).any() for each in others):
            raise Unsupported(
                f"{move[0]}: of light that is integrated in a scene of flat shapes there are derivatives by what "
                "lights send, intensity, irradiance and radiance, alone"
            )


class EmissionSlopes:
    """A scene of flat shapes; ``sloped`` answers as ``SlopeBouncer`` does."""

    def __init__(self, arrays: RadiometricArrays, wrt: tuple[Move, ...], tol: float, budget: int, lamps: bool) -> None:
        self._gatherers = [Gatherer(alone(arrays, move), tol, budget, lamps=lamps) for move in wrt]

    def sloped(self, rays: list[list[tuple[Complex, Complex]]], tol: float, budget: int) -> BouncedSlopes:
        """Derivatives along rays, each to ``tol``, absolute; what moves with the rays has no part in it."""
        count = len(rays[0][0][0])
        shape = len(self._gatherers), count
        found = BouncedSlopes(
            np.zeros((*shape, 3)), np.zeros((*shape, 3), np.complex128), np.zeros(shape), np.full(shape, MET),
            np.zeros(count, np.int64),
        )  # fmt: skip
        for q, (gatherer, each) in enumerate(zip(self._gatherers, rays, strict=True)):
            sent = [(np.ascontiguousarray(o.real), np.ascontiguousarray(d.real)) for o, d in each]
            light = gatherer.sent(sent, tol, budget)
            found.slopes[q], found.error[q], found.status[q] = light.indirect, light.error, light.status
            found.evaluations[:] += light.evaluations
        return found


def alone(arrays: RadiometricArrays, move: Move) -> RadiometricArrays:
    """The scene in which lights send no more than what the parameter of ``move`` adds."""
    lights = copied(arrays.lights)
    lights["emitted"][:] = record_moves(arrays, move).lights["emitted"]
    return replace(arrays, lights=lights)


def bouncer_of(
    arrays: RadiometricArrays, wrt: tuple[Move, ...], layer: str, tol: float, budget: int
) -> SlopeBouncer | EmissionSlopes:  # fmt: skip
    """Who differentiates what a layer has beside closed forms, to ``tol``."""
    if is_round(arrays):
        return SlopeBouncer(arrays, wrt, layer == "direct")
    return EmissionSlopes(arrays, wrt, tol, budget, layer == "direct")
