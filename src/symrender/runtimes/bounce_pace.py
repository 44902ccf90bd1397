"""How fast light that no node looked at may change with a parameter, over what it holds at most.

A rule leaves out what its bound shows to be small, and the derivative of what is left out is small only as far as
nothing moves fast. Every number of a scene that a parameter may move has its own measure here; one that is not named
is refused.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from symrender.scene.radiometric.arrays import DIRECTIONAL, RadiometricArrays
from symrender.scene.radiometric.records import Light, Material, Shape

Array = npt.NDArray[np.float64]

COLOUR, LENGTH, TURN, SHARE, POWER, PLAIN, ANGLE, FIELD, FIXED = range(9)
MEASURES: Final[dict[type, dict[str, int]]] = {
    Material: {
        "bright": COLOUR, "dark": COLOUR, "cell": FIELD, "alpha": SHARE, "exponent": POWER, "eta": PLAIN, "k": PLAIN,
        "amplitude": FIXED, "kind": FIXED, "two_sided": FIXED, "texture": FIXED, "density": FIXED, "correlated": FIXED,
        "walter": FIXED, "begin": FIXED, "terms": FIXED, "own": FIXED, "geometric": FIXED,
        "ior": FIXED, "transmitted": FIXED, "thin": FIXED, "specular": FIXED, "nonlinear": FIXED, "through": FIXED,
        "within": FIXED, "picture": FIXED,
    },
    Shape: {
        "place": LENGTH, "radius": LENGTH, "normal": TURN, "along": TURN, "kind": FIXED, "material": FIXED,
        "second": FIXED, "third": FIXED, "rotation": FIXED, "start": FIXED, "faces": FIXED, "caps": FIXED,
    },
    Light: {
        "place": LENGTH, "emitted": COLOUR, "axis": TURN, "beam": ANGLE, "cutoff": ANGLE, "kind": FIXED,
        "emitter": FIXED, "smooth": FIXED,
    },
}  # fmt: skip
"""What each number is. Bounds hold what a COLOUR moves by; FIXED is what no scene of spheres and planes moves.

LENGTH is of places, TURN of directions of any length, SHARE of what is felt in proportion, POWER of a cosine, PLAIN
of refractive indices, ANGLE of a spot's, in degrees, FIELD the side of a texture's field.
"""
FAINT: Final = 0.1
"""Of a colour, beside the one by which it moves."""
QUICKEST: Final = 4.0
"""No lobe changes faster by its width's own relative change, and no reflectance by a refractive index."""


@dataclass(frozen=True)
class Pace:
    """How fast a scene's numbers move with a parameter: lengths, more of them per ``size``, turns, and the rest."""

    lengths: float
    per_size: float
    turns: float
    others: float

    def at(self, shifts: tuple[Array, Array], near: Array, size: Array, sharp: Array) -> Array:
        """(N,) upper estimate of how fast what N places see changes, relative to its bound.

        ``shifts`` are the speeds (N,) of the places themselves and of their normals and rays; ``near`` (N,) is no more
        than any length of the scene beside them, ``size`` (N,) no less than any coordinate; ``sharp`` (N,) is the
        largest slope of what is reflected in the directions.
        """
        lengths, turns = shifts[0] + self.lengths + self.per_size * size, shifts[1] + self.turns
        return np.asarray((lengths + turns * size) / near * (1.0 + sharp) + turns * sharp + self.others)


def pace_of(arrays: RadiometricArrays, moves: RadiometricArrays) -> Pace:
    """How fast the numbers of a scene move with the parameter of ``moves``."""
    lengths = per_size = turns = others = 0.0
    rows: Any = (
        (Material, arrays.materials, moves.materials),
        (Shape, arrays.shapes, moves.shapes),
        (Light, arrays.lights, moves.lights),
    )
    for kind, here, there in rows:
        for name, measure in MEASURES[kind].items():
            for row, change in zip(here, there, strict=True):
                speed, value = (float(np.abs(each[name]).max()) for each in (change, row))
                if speed == 0.0:
                    continue
                if measure == FIXED:
                    raise ValueError(f"{kind.__name__}.{name}: nothing is known of how fast it moves light")
                if measure == LENGTH and kind is Light and row["kind"] == DIRECTIONAL:
                    measure = TURN
                value = max(value, 1e-300)
                if measure == COLOUR:
                    others += 1.0
                elif measure == LENGTH:
                    lengths += speed
                elif measure == TURN:
                    turns += speed / value
                elif measure == ANGLE:
                    turns += speed / max(float(row["cutoff"] - row["beam"]), 1e-300)
                elif measure == FIELD:
                    lengths += speed
                    per_size += speed / value
                    others += speed / value * (1.0 + 1.0 / value)
                else:
                    others += QUICKEST * speed / {PLAIN: 1.0, SHARE: value, POWER: value + 1.0}[measure]
    return Pace(lengths, per_size, turns, others)


def moves_lengths(arrays: RadiometricArrays, moves: RadiometricArrays) -> bool:
    """Whether the parameter of ``moves`` is a length: then derivatives in it go as one over the scene's."""
    points = arrays.lights["kind"] != DIRECTIONAL
    lengths = (moves.shapes["place"], moves.shapes["radius"], moves.lights["place"][points], moves.camera.eye)
    return any(bool((each != 0.0).any()) for each in lengths)


def is_faint_colour(arrays: RadiometricArrays, moves: RadiometricArrays) -> bool:
    """Whether the parameter of ``moves`` is a colour so faint that a value's own errors tell little of its slope's."""
    found, most = 0.0, 0.0
    for name, here, there in (
        ("bright", arrays.materials, moves.materials), ("dark", arrays.materials, moves.materials),
        ("emitted", arrays.lights, moves.lights),
    ):  # fmt: skip
        colours: Any = here[name]
        moved = (np.asarray(there[name]) != 0.0).any(axis=1)
        found += float(moved.sum())
        most = max(most, float(np.abs(colours[moved]).max(initial=0.0)))
    return found > 0.0 and most < FAINT
