"""The walls of an integrand change sign where its own guards do."""

from __future__ import annotations

import functools
from collections.abc import Callable

import numpy as np
import pytest
import sympy as sp

from symrender.expression.case import BLOCKER, BLOCKER_RADIUS, DIRECTION, LIGHT, POINT, Case
from symrender.expression.integrand import Integrand, expression

HELD = expression("chapter8")
VALUES = {symbol: HELD.table.values[name] for name, symbol in HELD.table.symbols.items()}
EYE = np.array([HELD.table.values[f"camera.eye.{axis}"] for axis in "xyz"])


@functools.cache
def function_of(value: sp.Basic) -> tuple[list[sp.Symbol], Callable[..., float | bool]]:
    """The symbols of a formula, and the formula as a function of them."""
    symbols = sorted(value.free_symbols, key=str)
    return symbols, sp.lambdify(symbols, value, "math")


def number(value: sp.Basic, names: dict[sp.Symbol, float]) -> float | bool:
    """A formula's value; raises ValueError where it is not real."""
    symbols, made = function_of(sp.sympify(value))
    return made(*(names[symbol] for symbol in symbols))


def filled(held: Integrand, case: Case, point: np.ndarray, w: np.ndarray) -> dict[sp.Symbol, float] | None:
    """Every symbol of a case's stages along w from a floor point, or None where it is not met."""
    names = VALUES | dict(zip(POINT.parts, point, strict=True)) | dict(zip(DIRECTION.parts, w, strict=True))
    incoming = (point - EYE) / np.linalg.norm(point - EYE)
    names |= {sp.Symbol(f"m_{a}", real=True): x for a, x in zip("xyz", incoming * [1, 1, -1], strict=True)}
    for stage in case.stages:
        try:
            names[stage.symbol] = float(number(stage.value, names))
        except ValueError:
            return None
    return names if number(case.met, names) else None


def wall(kind: str, shape: str) -> list[sp.Expr]:
    return [w.expression for w in HELD.walls if (w.kind, w.shape) == (kind, shape)]


@pytest.mark.parametrize("case", HELD.cases, ids=lambda c: c.shape)
def test_levels_have_the_signs_of_the_guards(case: Case) -> None:
    rng = np.random.default_rng(3)
    index = int(case.shape.split()[1])
    center = np.array([VALUES[x] for x in HELD.table.vector(f"spheres.{'AB'[index]}.center").parts])
    radius = VALUES[HELD.table.symbols[f"spheres.{'AB'[index]}.radius"]]
    seen: set[tuple[str, bool]] = set()
    for _ in range(60):
        point = np.array([*rng.uniform(-3.0, 3.0, 2), 0.0])
        target = center + 1.3 * radius * rng.normal(size=3)
        w = (target - point) / np.linalg.norm(target - point)
        if np.linalg.norm(point - center) <= radius or w[2] <= 0.0:
            continue
        names = filled(HELD, case, point, w)
        given = VALUES | dict(zip(POINT.parts, point, strict=True)) | dict(zip(DIRECTION.parts, w, strict=True))
        inside = number(wall("silhouette", case.shape)[0], given) > 0.0
        assert inside == (names is not None)
        seen.add(("silhouette", inside))
        if names is None:
            continue
        names |= dict(zip(LIGHT.parts, rng.normal(size=3) * 3.0 + np.array([0.0, 0.0, 4.0]), strict=True))
        names |= dict(zip(BLOCKER.parts, rng.normal(size=3) + np.array([0.0, 0.0, 2.0]), strict=True)) | {
            BLOCKER_RADIUS: 0.8
        }
        facing = number(wall("terminator", case.shape)[0], names) > 0.0
        for stage in case.light_stages:
            names[stage.symbol] = float(number(stage.value, names))
        assert facing == number(case.light_guards[0].condition, names)
        seen.add(("terminator", facing))
        # the segment meets a ball only inside the double cone about its shadow
        if number(case.blocks, names):
            assert number(wall("shadow", case.shape)[0], names) >= 0.0
            seen.add(("shadow", True))
        elif number(wall("shadow", case.shape)[0], names) < 0.0:
            seen.add(("shadow", False))
    assert seen == {(kind, sign) for kind in ("silhouette", "terminator", "shadow") for sign in (True, False)}
