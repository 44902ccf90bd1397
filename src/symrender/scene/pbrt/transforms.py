"""The current transform of a pbrt file: a matrix from the coordinates of what follows, and the first words it is of."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from symrender.scene.document import Malformed
from symrender.scene.pbrt.directives import Directive

Matrix = npt.NDArray[np.float64]
Triple = tuple[float, float, float]
Words = tuple[tuple[str, tuple[float, ...]], ...]

ROUNDING: Final = 1e-12
"""Relative difference up to which numbers that a comment says are those of a file."""
_DIGITS: Final = 1e-5
"""By how much, of its size, a matrix may be off from a turn: files write six digits."""
_KEPT: Final = 3
"""How many words a transform remembers: a camera has two."""


@dataclass(frozen=True, eq=False)
class Transform:
    """A matrix from coordinates of what follows to those of the world (of the camera: the other way round)."""

    matrix: Matrix
    words: Words = ()

    def then(self, directive: Directive) -> Transform:
        """This transform after one more directive."""
        name, numbers = directive.name, directive.numbers
        if name == "Identity":
            return IDENTITY
        with np.errstate(over="ignore", invalid="ignore"):
            matrix: Matrix = _given(numbers) if name == "Transform" else self.matrix @ _step(directive)
        words = ((name, numbers),) if name == "Transform" else (*self.words, (name, numbers))[:_KEPT]
        if not np.isfinite(matrix).all():
            raise Malformed("must leave coordinates finite", directive.mark, (name,))
        if matrix[3].tolist() != [0.0, 0.0, 0.0, 1.0]:
            raise Malformed("must be affine, its last row 0 0 0 1", directive.mark, (name,))
        return Transform(matrix, words)

    def inside(self, outer: Transform) -> Transform:
        """This transform within another one."""
        if outer.plain:
            return self
        with np.errstate(over="ignore", invalid="ignore"):
            return Transform(outer.matrix @ self.matrix, (("", ()),))

    def after(self, inner: Transform) -> Transform:
        """This transform after another one."""
        if inner.plain:
            return self
        return Transform(self.matrix @ inner.matrix, (("", ()),))

    @property
    def mirrors(self) -> bool:
        """Whether it turns a right hand into a left one."""
        return float(np.linalg.det(self.matrix[:3, :3])) < 0.0

    def inverse(self) -> Transform | None:
        """The way back; None where there is none."""
        try:
            with np.errstate(all="ignore"):
                matrix = np.linalg.inv(self.matrix).astype(np.float64)
        except np.linalg.LinAlgError:
            return None
        return Transform(matrix, (("", ()),)) if np.isfinite(matrix).all() else None

    @property
    def plain(self) -> bool:
        """Whether it changes nothing."""
        return bool((self.matrix == np.eye(4)).all())

    def place(self, at: Triple) -> Triple:
        """Where a place goes."""
        if self.plain:
            return at
        with np.errstate(all="ignore"):
            x, y, z = (float(v) for v in self.matrix[:3, :3] @ at + self.matrix[:3, 3])
        return x, y, z

    def vector(self, along: Triple) -> Triple:
        """Where a direction goes."""
        if self.plain:
            return along
        with np.errstate(all="ignore"):
            x, y, z = (float(v) for v in self.matrix[:3, :3] @ along)
        return x, y, z

    def scale(self) -> float | None:
        """The one factor by which it scales all lengths; None where it does more than turn, mirror and scale."""
        linear = self.matrix[:3, :3]
        size = float(np.abs(linear).max())
        if not 1e-150 < size < 1e150:
            return None
        columns = [math.hypot(*column) for column in linear.T]
        off = linear.T @ linear - columns[0] ** 2 * np.eye(3)
        return columns[0] if np.abs(off).max() <= 2.0 * _DIGITS * columns[0] ** 2 else None


IDENTITY: Final = Transform(np.eye(4))
MIRROR: Final = Transform(np.diag([-1.0, 1.0, 1.0, 1.0]), (("", ()),))
"""Turns left-handed coordinates into right-handed ones."""


def _step(directive: Directive) -> Matrix:
    n = directive.numbers
    matrix = np.eye(4)
    match directive.name:
        case "Translate":
            matrix[:3, 3] = n
        case "Scale":
            matrix[:3, :3] = np.diag(n)
        case "Rotate":
            matrix[:3, :3] = _turn(directive, n[0], _unit(directive, n[1:], "an axis longer than zero"))
        case "ConcatTransform":
            matrix = _given(n)
        case _:
            matrix = _look(directive, *(np.array(n[k : k + 3]) for k in (0, 3, 6)))
    return matrix


def _given(numbers: tuple[float, ...]) -> Matrix:
    """A matrix as pbrt reads it, column by column."""
    return np.array(numbers, dtype=np.float64).reshape(4, 4).T


def _unit(directive: Directive, vector: Any, wanted: str) -> Matrix:
    size = float(np.abs(vector).max())
    if not size > 0.0 or not math.isfinite(size):
        raise Malformed(f"must have {wanted}", directive.mark, (directive.name,))
    scaled: Matrix = np.asarray(vector) / size
    return scaled / math.hypot(*scaled)


def _turn(directive: Directive, degrees: float, axis: Matrix) -> Matrix:
    """A right-handed turn about a unit axis; quarters of a turn about an axis of coordinates are exact."""
    quarters = {0.0: (1.0, 0.0), 90.0: (0.0, 1.0), 180.0: (-1.0, 0.0), 270.0: (0.0, -1.0)}
    angle = math.radians(degrees % 360.0)
    cos, sin = quarters.get(degrees % 360.0, (math.cos(angle), math.sin(angle)))
    x, y, z = axis
    across = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    turned: Matrix = cos * np.eye(3) + sin * across + (1.0 - cos) * np.outer(axis, axis)
    return turned


def _look(directive: Directive, eye: Matrix, target: Matrix, up: Matrix) -> Matrix:
    """From the world to a camera that looks along its z, with y up and x to the right of the image."""
    ahead = _unit(directive, target - eye, "an eye and a target that differ")
    right = _unit(directive, np.cross(_unit(directive, up, "up longer than zero"), ahead), "up not along the view")
    axes = np.stack([right, np.cross(ahead, right), ahead])
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = axes, -axes @ eye
    return matrix
