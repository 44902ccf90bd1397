"""Random heights of bumps, their values in 60 digits, and the normal of the raised surface by small steps along it."""

from __future__ import annotations

from typing import Any

import mpmath
import numpy as np

DIGITS = 60
_STEP = mpmath.mpf(10) ** -18

Place = list[Any]


def tree(rng: np.random.Generator, depth: int = 4) -> Any:
    """A random formula of x, y, z and numbers."""
    if depth == 0 or rng.random() < 0.15:
        kind = rng.integers(4)
        if kind == 0:
            return float(rng.normal())
        if kind == 3:
            return {"distance": rng.normal(size=3).tolist()}
        return "xyz"[rng.integers(3)]
    kind = str(rng.choice(["add", "mul", "sub", "sin", "cos", "exp", "pow"]))
    if kind in ("add", "mul"):
        return {kind: [tree(rng, depth - 1) for _ in range(int(rng.integers(2, 4)))]}
    if kind == "sub":
        return {kind: [tree(rng, depth - 1), tree(rng, depth - 1)]}
    if kind == "pow":
        return {kind: [{"sin": tree(rng, depth - 1)}, int(rng.integers(1, 6))]}
    # of sin and cos alone exp stays small
    return {kind: {"sin": tree(rng, depth - 2)} if kind == "exp" and depth > 1 else tree(rng, depth - 1)}


def varied(rng: np.random.Generator, depth: int = 4) -> Any:
    """A formula that depends on the place, of moderate size."""
    return {"mul": [float(rng.uniform(0.1, 0.6)), {"sin": {"add": [tree(rng, depth - 2), {"mul": [2.0, "x"]}, "y"]}}]}


def value(formula: Any, p: Place) -> Any:
    """The formula at a place."""
    if isinstance(formula, str):
        return p["xyz".index(formula)]
    if not isinstance(formula, dict):
        return mpmath.mpf(formula)
    ((name, given),) = formula.items()
    if name in ("sin", "cos", "exp"):
        return getattr(mpmath, name)(value(given, p))
    if name == "distance":
        return mpmath.sqrt(sum((a - mpmath.mpf(b)) ** 2 for a, b in zip(p, given, strict=True)))
    if name == "pow":
        return value(given[0], p) ** given[1]
    found = [value(part, p) for part in given]
    if name == "sub":
        return found[0] - found[1]
    return mpmath.fsum(found) if name == "add" else mpmath.fprod(found)


def exact(v: Any) -> Place:
    """A vector of doubles, exactly."""
    return [mpmath.mpf(float(x)) for x in v]


def unit(v: Place) -> Place:
    size = mpmath.sqrt(sum(x * x for x in v))
    return [x / size for x in v]


def dot(a: Place, b: Place) -> Any:
    return sum(x * y for x, y in zip(a, b, strict=True))


def cross(a: Place, b: Place) -> Place:
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def raised_normal(
    bump: dict[str, Any], place: Place, normal: Place, axes: tuple[Place, Place, Place] | None, size: Any = 1
) -> Place:
    """Unit normal of the surface raised along the unit ``normal`` that it has at a place.

    ``axes`` are (origin, along x, along y) of coordinates that are not the world's; of a sphere's (centre, [], []).
    Lengths are of the order of ``size``.
    """
    amplitude = mpmath.mpf(bump.get("amplitude", 1.0))

    def height(p: Place) -> Any:
        if axes is not None:
            offset = [a - b for a, b in zip(p, axes[0], strict=True)]
            p = [dot(offset, axes[1]), dot(offset, axes[2]), mpmath.mpf(0)] if axes[1] else offset
        return amplitude * value(bump["height"], p)

    step = _STEP * size
    first = unit(cross(normal, exact([0.3, 0.5, -0.8])))
    second = cross(normal, first)
    tangents = []
    for t in (first, second):
        ahead, behind = ([a + s * b for a, b in zip(place, t, strict=True)] for s in (step, -step))
        rise = (height(ahead) - height(behind)) / (2 * step)
        tangents.append([a + rise * n for a, n in zip(t, normal, strict=True)])
    return unit(cross(*tangents))
