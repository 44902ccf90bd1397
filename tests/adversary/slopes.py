"""Derivatives judged: what the package says, alone and with others, against differences of the evaluator's values."""

from __future__ import annotations

import copy
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from .case import Case
from .sweep import swept_value
from .world import Array, lobe_of, world_of

LEVELS: Final = 5
AXES: Final = {"x": 0, "y": 1, "z": 2}


@dataclass(frozen=True)
class Slope:
    """One derivative: what is said alone and with others, and the differences with their doubt.

    ``called``: ``honest``, ``beyond`` (of three times its statement), ``torn`` (alone and together differ by more than
    both state), ``untold`` where differences cannot tell, ``none`` where no derivative is given.
    """

    case: Case
    name: str
    alone: Array
    together: Array
    stated: tuple[float, float]
    status: int
    value: Array
    doubt: float
    called: str

    @property
    def ratio(self) -> float:
        """How far beyond the differences' doubt, over the stated error."""
        away = float(np.abs(self.alone - self.value).max()) - self.doubt
        return max(0.0, away) / max(self.stated[0], 1e-300)


def names_of(case: Case) -> list[str]:
    """Numbers of a scene that its values depend on smoothly, by dotted name."""
    names = [f"shading.{k}" for k in ("shininess", "kd", "ks") if case.scene["shading"].get(k, 0.0) > 0.0]
    names += [f"camera.eye.{axis}" for axis in AXES]
    for sphere in case.scene["spheres"]:
        names += [f"spheres.{sphere['name']}.center.{axis}" for axis in AXES]
        names.append(f"spheres.{sphere['name']}.radius")
    for light in case.scene["lights"]:
        names += [f"lights.{light['name']}.position.{axis}" for axis in AXES]
    lobe = _lobe(case)
    if not lobe.get("mirror", False):
        if lobe["exponent"] > 0.0:
            names.append(f"{case.surface}.lobe.exponent")
        if lobe["theta_max"] < 1.57:
            names.append(f"{case.surface}.lobe.theta_max")
    return names


def moved(scene: dict[str, Any], name: str, offset: float) -> dict[str, Any]:
    """A copy of a scene with one number moved."""
    changed = copy.deepcopy(scene)
    *path, last = name.split(".")
    at: Any = changed
    for step in path:
        at = next(item for item in at if item["name"] == step) if isinstance(at, list) else at[step]
    key = AXES[last] if isinstance(at, list) else last
    at[key] = at[key] + offset
    return changed


def number(scene: dict[str, Any], name: str) -> float:
    """The number of a scene by dotted name."""
    at: Any = scene
    *path, last = name.split(".")
    for step in path:
        at = next(item for item in at if item["name"] == step) if isinstance(at, list) else at[step]
    return float(at[AXES[last] if isinstance(at, list) else last])


def differences(case: Case, index: int, name: str, *, turn: float, cells: int) -> tuple[Array, float]:
    """The derivative of a value by extrapolated central differences (Ridders), and its doubt; infinite for none."""
    at = number(case.scene, name)
    step = 2.0**-7 * max(0.05, abs(at))
    rows: list[Array] = []
    best, doubt = np.zeros(3), np.inf
    for _ in range(LEVELS):
        ends, noise = [], 0.0
        for offset in (step, -step):
            scene = moved(case.scene, name, offset)
            world, lobe = world_of(scene, case.disk), lobe_of(scene, case.surface, case.points[index])
            found = swept_value(world, lobe, 1e-10, turn=turn, cells=cells)
            ends.append(found.value)
            noise = max(noise, found.doubt)
        if not np.isfinite(noise):
            return best, np.inf
        row = [(ends[0] - ends[1]) / (2.0 * step)]
        for k, coarse in enumerate(rows):
            row.append(row[k] + (row[k] - coarse) / (4.0 ** (k + 1) - 1.0))
            change = float(max(np.abs(row[k + 1] - row[k]).max(), np.abs(row[k + 1] - coarse).max()))
            if 2.0 * change + noise / step < doubt:
                best, doubt = row[k + 1], 2.0 * change + noise / step
        rows, step = row, 0.5 * step
    return best, doubt


def judge_slopes(case: Case, most: int = 2) -> list[Slope]:
    """Judge a few derivatives of a case's first point, drawn by its seed."""
    from symrender.errors import SymrenderError

    rng = np.random.default_rng((case.seed, 41))
    names = names_of(case)
    drawn = [names[k] for k in rng.permutation(len(names))[:most]]
    try:
        return [judge_slope(case, name, drawn) for name in drawn]
    except SymrenderError:
        return []


def judge_slope(case: Case, name: str, others: list[str]) -> Slope:
    """Judge the derivative by ``name``, asked alone and with ``others``."""
    import symrender as sr

    def asked(names: list[str]) -> Any:
        return sr.probe(
            case.scene, case.points[:1], surface=case.surface, tol=case.tol, disk=case.disk, budget=case.budget,
            wrt=names, threads=1,
        )  # fmt: skip

    one, many = asked([name]), asked(others)
    alone, together = one.gradient[name][0], many.gradient[name][0]
    stated = float(one.gradient_error[name][0]), float(many.gradient_error[name][0])
    status = int(one.gradient_status[name][0])

    def told(value: Array, doubt: float, called: str) -> Slope:
        return Slope(case, name, alone, together, stated, status, value, doubt, called)

    if status >= 3:
        return told(np.zeros(3), np.inf, "none")
    scale = 1e-12 * float(np.abs(alone).max())
    if np.abs(alone - together).max() > stated[0] + stated[1] + scale and int(many.gradient_status[name][0]) < 3:
        return told(np.zeros(3), np.inf, "torn")
    value, doubt = differences(case, 0, name, turn=0.1, cells=48)
    if not np.abs(alone - value).max() > 3.0 * stated[0] + doubt:
        return told(value, doubt, "honest" if doubt <= 10.0 * stated[0] + 1e-3 * np.abs(value).max() else "untold")
    again, doubt_again = differences(case, 0, name, turn=0.77, cells=97)
    doubt = max(doubt, doubt_again) + float(np.abs(again - value).max())
    return told(again, doubt, "beyond" if np.abs(alone - again).max() > 3.0 * stated[0] + doubt else "untold")


def _lobe(case: Case) -> dict[str, Any]:
    if case.surface == "floor":
        lobe: dict[str, Any] = case.scene["floor"]["lobe"]
        return lobe
    return next(s["lobe"] for s in case.scene["spheres"] if f"spheres.{s['name']}" == case.surface)
