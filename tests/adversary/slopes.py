"""Derivatives judged: what the package says, alone and with others, against differences of the evaluator's values."""

from __future__ import annotations

import copy
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from .case import Case
from .judge import EASE, LOOKS, agrees
from .lattice import lattice_value
from .sweep import swept_value
from .world import NORMAL, PLACE, SURFACE, Array, lobe_of, world_of

LEVELS: Final = 5
SHORTEST: Final = 1e-5
"""No length that steps are measured by is shorter: rounding and lines would drown what such a step changes."""
CONFIRMED: Final = ((0.77, 97, 1.0), (0.43, 1500, 0.125), (0.7, 4000, 1.0))
"""Turns of the sweeps, their cells and the share of the first step: all have to contradict a derivative before it is
called beyond. A step wider than a highlight may be extrapolated to a wrong limit from any lines."""
AXES: Final = {"x": 0, "y": 1, "z": 2}


@dataclass(frozen=True)
class Slope:
    """One derivative: what is said alone and with others, and the differences with their doubt.

    ``called``: ``honest``, ``beyond`` (of three times its statement), ``torn`` (alone and together differ by more than
    both state), ``untold`` where differences cannot tell, ``none`` where no derivative is given. ``agrees``: whether
    differences that have not seen it ended early, within its statement.
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
    agrees: bool = False

    def told(self, factor: float) -> bool:
        """Whether an error of ``factor`` times the stated one would have been called beyond."""
        return self.agrees or self.doubt <= (factor - 3.0) * self.stated[0]

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


def length_of(case: Case, index: int, name: str) -> float:
    """What a number is to be called small against: itself, or the nearest distance that it changes."""
    scene = case.scene
    kind, *_ = name.split(".")
    if kind == "shading" or ".lobe." in name:
        return abs(number(scene, name))
    lobe = lobe_of(scene, case.surface, case.points[index])
    own = int(lobe[SURFACE]) - 1
    if kind == "spheres":
        sphere = next(s for s in scene["spheres"] if name.startswith(f"spheres.{s['name']}."))
        apart = [sphere["radius"]]
        if scene["spheres"].index(sphere) != own:
            apart.append(abs(math.dist(lobe[PLACE:NORMAL], sphere["center"]) - sphere["radius"]))
        return max(SHORTEST, min(apart))
    if kind == "camera":
        place, apart = scene["camera"]["eye"], [math.dist(lobe[PLACE:NORMAL], scene["camera"]["eye"])]
    else:
        place = next(light["position"] for light in scene["lights"] if name.startswith(f"lights.{light['name']}."))
        apart = [math.dist(lobe[PLACE:NORMAL], place)]
    apart += [abs(math.dist(place, s["center"]) - s["radius"]) for s in scene["spheres"]]
    if "floor" in scene and place[2] != 0.0:
        apart.append(abs(place[2]))
    return max(SHORTEST, min(apart))


UNSETTLED: Final = 6.0
"""Changes that are left where each is at most .83 of the one before."""


def differences(
    case: Case, index: int, name: str, *, turn: float, cells: int, claim: Array | None = None, stated: float = 0.0,
    share: float = 1.0,
) -> tuple[Array, float, bool]:  # fmt: skip
    """The derivative of a value by extrapolated central differences (Ridders), and its doubt; infinite for none.

    With a ``claim`` they end early, and the third is true, where they agree with it; lines are as fine as that needs.
    The first step is ``share`` of the usual one.
    """
    step = share * 2.0**-7 * length_of(case, index, name)
    rows: list[Array] = []
    plain: list[Array] = []
    best, doubt, slow = np.zeros(3), np.inf, 0.0
    for _ in range(LEVELS):
        ends, noise = [], 0.0
        tol = 1e-10 if claim is None else min(1e-6, max(1e-10, 0.3 * stated * step))
        for offset in (step, -step):
            scene = moved(case.scene, name, offset)
            world, lobe = world_of(scene, case.disk), lobe_of(scene, case.surface, case.points[index])
            ease, looks = (0.0, 3_000_000) if claim is None else (EASE, 2 * LOOKS)
            found = swept_value(world, lobe, tol, turn=turn, cells=cells, ease=ease, most_looks=looks)
            ends.append(found.value)
            noise = max(noise, found.doubt)
            if not np.isfinite(noise):
                return best, np.inf, False
        row = [(ends[0] - ends[1]) / (2.0 * step)]
        plain.append(row[0])
        slow = unsettled(plain, noise / step)
        for k, coarse in enumerate(rows):
            row.append(row[k] + (row[k] - coarse) / (4.0 ** (k + 1) - 1.0))
            change = float(max(np.abs(row[k + 1] - row[k]).max(), np.abs(row[k + 1] - coarse).max()))
            if 2.0 * change + noise / step < doubt:
                best, doubt = row[k + 1], 2.0 * change + noise / step
        if claim is not None:
            away = np.abs(best - claim).max()
            if away <= 3.0 * stated + doubt and doubt <= 1.5 * stated:
                return best, doubt, False
            if agrees(float(away), doubt, stated):
                return best, doubt, True
        rows, step = row, 0.5 * step
    return best, max(doubt, slow), False


def unsettled(plain: list[Array], noise: float) -> float:
    """How far off central differences may end that do not fall as those of a smooth function do, else 0.

    At the end of what is smooth a value may go on like h^1.5: halving h then divides their error by 1.4, where it
    divides it by 4 where extrapolation is of use.
    """
    if len(plain) < 3:
        return 0.0
    last, before = float(np.abs(plain[-1] - plain[-2]).max()), float(np.abs(plain[-2] - plain[-3]).max())
    return UNSETTLED * last if last > max(0.45 * before, noise) else 0.0


def judge_slopes(case: Case, most: int = 2) -> list[Slope]:
    """Judge a few derivatives of a case's first point, drawn by its seed, each asked alone and all together."""
    from symrender.errors import SymrenderError

    rng = np.random.default_rng((case.seed, 41))
    names = names_of(case)
    drawn = [names[k] for k in rng.permutation(len(names))[:most]]
    try:
        many = asked(case, drawn)
        return [judge_slope(case, name, asked(case, [name]), many) for name in drawn]
    except SymrenderError:
        return []


def asked(case: Case, names: list[str]) -> Any:
    """What the package says of a case's first point and its derivatives by ``names``."""
    import symrender as sr

    return sr.probe(
        case.scene, case.points[:1], surface=case.surface, tol=case.tol, disk=case.disk, budget=case.budget, wrt=names,
        threads=1,
    )  # fmt: skip


def judge_slope(case: Case, name: str, one: Any, many: Any) -> Slope:
    """Judge the derivative by ``name``, as two probes say it: asked alone and with others."""
    alone, together = one.gradient[name][0], many.gradient[name][0]
    stated = float(one.gradient_error[name][0]), float(many.gradient_error[name][0])
    status = int(one.gradient_status[name][0])

    def told(value: Array, doubt: float, called: str, early: bool = False) -> Slope:
        return Slope(case, name, alone, together, stated, status, value, doubt, called, early)

    if status >= 3:
        return told(np.zeros(3), np.inf, "none")
    scale = 1e-12 * float(np.abs(alone).max())
    if np.abs(alone - together).max() > stated[0] + stated[1] + scale and int(many.gradient_status[name][0]) < 3:
        return told(np.zeros(3), np.inf, "torn")
    if not np.isfinite(alone).all():
        return told(np.zeros(3), 0.0, "beyond")
    value, doubt, early = differences(case, 0, name, turn=0.1, cells=48, claim=alone, stated=stated[0])
    if not np.abs(alone - value).max() > 3.0 * stated[0] + doubt:
        return told(value, doubt, "honest" if np.isfinite(doubt) else "untold", early)
    value, doubt, _ = differences(case, 0, name, turn=0.1, cells=48)
    for turn, cells, share in CONFIRMED:
        # lines that start too far apart can leave out the same highlight twice: the finest have the last word
        again, doubt_again, _ = differences(case, 0, name, turn=turn, cells=cells, share=share)
        doubt = max(doubt, doubt_again) + float(np.abs(again - value).max())
        if not np.abs(alone - again).max() > 3.0 * stated[0] + doubt:
            return told(again, doubt, "untold")
        value = again
    return told(again, doubt, "beyond" if sees_all(case) else "untold")


def sees_all(case: Case) -> bool:
    """Whether the lines whose differences are taken see, of the value itself, all that a lattice aimed at it sees."""
    world, lobe = world_of(case.scene, case.disk), lobe_of(case.scene, case.surface, case.points[0])
    aimed = lattice_value(world, lobe, 65_536, case.seed)
    lines = swept_value(world, lobe, 1e-10, turn=0.7, cells=4000, ease=0.0, most_looks=3_000_000)
    return bool((np.abs(aimed.value - lines.value) <= lines.doubt + 6.0 * aimed.sigma).all())


def slopes_summed(slopes: list[Slope]) -> Mapping[str, float]:
    """What a table says of derivatives."""
    given = [s for s in slopes if s.called != "none"]
    beyond = [s for s in given if s.called == "beyond"]
    return {
        "derivatives": len(given),
        "none given": len(slopes) - len(given),
        "signal": sum(bool(np.abs(s.alone).max() > 0.0) for s in given),
        "met": sum(s.status == 0 for s in given),
        "told at 4.5x": sum(s.told(4.5) for s in given),
        "told at 100x": sum(s.told(100.0) for s in given),
        "beyond 3x": len(beyond),
        "worst": max((s.ratio for s in beyond), default=0.0),
        "torn": sum(s.called == "torn" for s in given),
    }


def _lobe(case: Case) -> dict[str, Any]:
    if case.surface == "floor":
        lobe: dict[str, Any] = case.scene["floor"]["lobe"]
        return lobe
    return next(s["lobe"] for s in case.scene["spheres"] if f"spheres.{s['name']}" == case.surface)
