"""Derivatives by what lights send, of any image that a provider can make: light is linear in it.

The derivative of an image in one number of what a light sends is the image of the scene in which that light alone
sends, one unit, and no other does. So it takes the providers of values, and its error is that of such a value.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
import numpy.typing as npt

from symrender.errors import Unsupported
from symrender.jit.records import chosen
from symrender.radiance import sampled
from symrender.radiance.choice import Plan, plan_of, refusal
from symrender.radiometric.vectors import Array
from symrender.runtimes import radiometric, radiometric_gradient
from symrender.runtimes.emission_slopes import alone, check_emission
from symrender.runtimes.exposed import check_means
from symrender.runtimes.image import TileKernel
from symrender.scene.moves import Move
from symrender.scene.radiometric.arrays import RadiometricArrays
from symrender.settings import Settings


@dataclass(frozen=True)
class Shares:
    """The parameters that quadrature differentiates, and those taken as values of one light, each with its plan."""

    quadrature: tuple[Move, ...]
    linear: tuple[tuple[Move, Plan], ...]

    def providers(self, name: str) -> dict[str, str]:
        """The provider of each layer of the derivative by the parameter ``name``."""
        for move, plan in self.linear:
            if move[0] == name:
                return plan.providers()
        return Plan("", "").providers()


def shares_of(arrays: RadiometricArrays, settings: Settings, wrt: Sequence[Move]) -> Shares:
    """Return who differentiates an image by which parameter.

    Raises
    ------
    Unsupported
        For a parameter that quadrature does not cover, if it is not part of what a light sends; with
        ``method: quadrature`` also for what a light sends, if quadrature does not cover the image of that light.
    """
    covered, linear = [], []
    for move in wrt:
        reason = refusal(partial(_check, arrays, settings, move))
        # what the parameter moves beside what a light sends
        other = refusal(partial(check_emission, arrays, (move,)))
        if other is None and (reason is not None or settings.filter != "centre" or settings.method == "sampled"):
            # over a pixel that is one image, and no wall of it moves
            linear.append((move, plan_of(lit_by(arrays, move), settings)))
        elif reason is not None or settings.method == "sampled":
            raise reason or other or Unsupported(move[0])
        else:
            covered.append(move)
    return Shares(tuple(covered), tuple(linear))


def _check(arrays: RadiometricArrays, settings: Settings, move: Move) -> None:
    """Raise ``Unsupported`` if quadrature does not differentiate an image by a parameter."""
    radiometric_gradient.check_gradient(arrays, (move,), settings.filter)
    check_means(arrays, settings)


def lit_by(arrays: RadiometricArrays, move: Move) -> RadiometricArrays:
    """The scene in which only the light of ``move`` stands, and sends what the parameter adds."""
    scene = alone(arrays, move)
    sends: npt.NDArray[np.bool_] = (scene.lights["emitted"] != 0.0).any(axis=1)
    if not sends.any():
        return scene
    exposure = replace(scene.exposure, lights=scene.exposure.lights[sends])
    return replace(scene, lights=chosen(scene.lights, sends), directions=scene.directions[sends], exposure=exposure)


def prepare(arrays: RadiometricArrays, settings: Settings, wrt: tuple[Move, ...]) -> TileKernel:
    """Kernel that renders tiles of the derivatives of an image by ``wrt``, of which quadrature covers a part at most.

    For every parameter it fills ``emitted:NAME``, ``direct:NAME``, ``indirect:NAME``, ``radiance:NAME`` (h, w, 3),
    ``error:NAME``, ``status:NAME`` and ``kind:NAME`` (h, w), and once ``hit_class``.
    """
    shares = shares_of(arrays, settings, wrt)
    slopes = radiometric_gradient.prepare(arrays, settings, shares.quadrature) if shares.quadrature else None
    values = {
        move[0]: (sampled if plan.sampled else radiometric).prepare(lit_by(arrays, move), settings)
        for move, plan in shares.linear
    }

    def render(x0: int, y0: int, x1: int, y1: int, layers: Mapping[str, Array]) -> int:
        spent, here = 0, (slice(y0, y1), slice(x0, x1))
        if slopes is not None:
            spent += slopes(x0, y0, x1, y1, layers)
            for name, _ in shares.quadrature:
                layers[f"kind:{name}"][here] = sampled.QUADRATURE
        for name, kernel in values.items():
            layers[f"kind:{name}"][here] = sampled.QUADRATURE
            own = {layer: layers[f"{layer}:{name}"] for layer in _EACH} | {"hit_class": layers["hit_class"]}
            spent += kernel(x0, y0, x1, y1, own)
        return spent

    return render


_EACH = ("emitted", "direct", "indirect", "radiance", "error", "status", "kind")
