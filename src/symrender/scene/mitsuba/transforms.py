"""Transforms of a Mitsuba file: translate, rotate, scale, lookat and matrix, each applied after those before it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

import numpy as np
import numpy.typing as npt

from symrender.scene.document import Malformed
from symrender.scene.mitsuba.properties import Properties, name_of, numbers
from symrender.scene.printable import printable

if TYPE_CHECKING:
    from symrender.scene.mitsuba.xml_tree import Element

Array = npt.NDArray[np.float64]
ROUNDING: Final = 1e-5
"""Relative difference up to which axes are at right angles and of one length: files write six digits."""
_LAST: Final = [0.0, 0.0, 0.0, 1.0]
_QUARTERS: Final = {0.0: (1.0, 0.0), 90.0: (0.0, 1.0), 180.0: (-1.0, 0.0), 270.0: (0.0, -1.0)}


def taken_transform(properties: Properties, name: str = "to_world") -> Array | None:
    """(4, 4): the transform of a name, None where it is not given."""
    found = properties.take(name, "transform", "matrix", "rotate", "scale", "translate", "lookat")
    if found is None:
        return None
    return _chain(found) if found.tag == "transform" else _checked(found, _step(found))


def _chain(transform: Element) -> Array:
    whole = np.eye(4)
    for child in transform.children:
        whole = _checked(child, _step(child) @ whole)
    return whole


def _checked(element: Element, matrix: Array) -> Array:
    if not np.isfinite(matrix).all():
        raise Malformed(f"{name_of(element)}: must leave coordinates finite", element.mark)
    if (np.abs(matrix[3] - _LAST) > ROUNDING).any():
        raise Malformed(f"{name_of(element)}: the last row of a matrix must be 0 0 0 1", element.mark)
    matrix[3] = _LAST
    return matrix


def _step(element: Element) -> Array:
    matrix = np.eye(4)
    given = element.attributes
    match element.tag:
        case "translate":
            matrix[:3, 3] = _vector(element, 0.0)
        case "scale":
            matrix[:3, :3] = np.diag(_vector(element, 1.0))
        case "rotate":
            (angle,) = numbers(element, given.get("angle", ""), 1)
            matrix[:3, :3] = _turn(element, angle, np.array(_vector(element, 0.0)))
        case "lookat":
            eye, target = (np.array(numbers(element, given.get(name, ""), 3)) for name in ("origin", "target"))
            up = np.array(numbers(element, given["up"], 3)) if "up" in given else None
            matrix[:3] = _look(element, eye, target, up)
        case "matrix":
            words = given.get("value", "").replace(",", " ").split()
            if len(words) == 9:
                matrix[:3, :3] = np.array(numbers(element, given["value"], 9)).reshape(3, 3)
            else:
                matrix = np.array(numbers(element, given.get("value", ""), 16)).reshape(4, 4)
        case _:
            known = "translate, rotate, scale, lookat and matrix"
            raise Malformed(f"{printable(element.tag)} is no transform; known are {known}", element.mark)
    return matrix


def _vector(element: Element, default: float) -> list[float]:
    """Three numbers by their axes, or by ``value``, one of them for all."""
    given = element.attributes
    if "value" in given:
        words = given["value"].replace(",", " ").split()
        return numbers(element, given["value"], 1) * 3 if len(words) == 1 else numbers(element, given["value"], 3)
    return numbers(element, " ".join(given.get(axis) or repr(default) for axis in "xyz"), 3)


def _turn(element: Element, angle: float, axis: Array) -> Array:
    length = float(np.linalg.norm(axis))
    if not length > 0.0:
        raise Malformed(f"{name_of(element)}: needs an axis longer than zero", element.mark)
    x, y, z = axis / length
    cos, sin = _QUARTERS.get(angle % 360.0, (math.cos(math.radians(angle)), math.sin(math.radians(angle))))
    across = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    turned: Array = cos * np.eye(3) + sin * across + (1.0 - cos) * np.outer((x, y, z), (x, y, z))
    return turned


def _look(element: Element, eye: Array, target: Array, up: Array | None) -> Array:
    """(3, 4): from coordinates that look along z, with x to the left and y up."""
    ahead = target - eye
    length = float(np.linalg.norm(ahead))
    if not length > 0.0:
        raise Malformed(f"{name_of(element)}: origin and target must differ", element.mark)
    ahead = ahead / length
    if up is None or not np.any(up):
        # Mitsuba takes some direction at right angles
        up = np.eye(3)[int(np.argmin(np.abs(ahead)))]
    left = np.cross(up, ahead)
    size = float(np.linalg.norm(left))
    if not size > 1e-9 * float(np.linalg.norm(up)):
        raise Malformed(f"{name_of(element)}: up must not lie along the view", element.mark)
    left = left / size
    return np.column_stack((left, np.cross(ahead, left), ahead, eye))


def uniform_scale(matrix: Array) -> float | None:
    """The one factor by which a matrix scales all lengths; None where it does more than turn, mirror and scale."""
    linear = matrix[:3, :3]
    size = float(np.abs(linear).max())
    if not 1e-150 < size < 1e150:
        return None
    scaled = linear / size
    square = float((scaled * scaled).sum()) / 3.0
    near = np.abs(scaled.T @ scaled - square * np.eye(3)).max() <= 2.0 * ROUNDING * square
    return size * math.sqrt(square) if near else None
