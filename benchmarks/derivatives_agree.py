"""Derivatives of bounced light under lamps, a sky and points agree at all tolerances, and with differences of values.

    python benchmarks/derivatives_agree.py [--quick] [--kind KIND] [SEED [COUNT]]

Places are those of ``tolerances_agree.py``: ``afar`` (lamps, points and a sky over tiles, close and many squares off),
``sunk`` (balls that cut or touch textured planes), ``points`` and ``tiles``. Three numbers of each scene are drawn: of
its balls, planes, textures and lights. Derivatives of a place at two tolerances that differ by more than 1.5 times what
both state are beyond. So are those that differ from central differences of values, which share no tangent with
them, by more than they state and the differences may be off by: what values state over the step, and the change from
one step to its half. A place that a wall passes within a step has no difference that tells.
"""

from __future__ import annotations

import itertools
from typing import Any, NamedTuple

import numpy as np
from measure import Report
from tolerances_agree import LOOSEST, Ray, asked_for, scenes_of, strength

import symrender as sr
from symrender.errors import SymrenderError
from symrender.quadrature.split_setup import EVENT, MET, UNSUPPORTED
from symrender.scene.parameters import get

Array = np.ndarray
TOLERANCES = (1e-1, 1e-3, 1e-5)
"""Of the bounced light that is there, over the size of the scene."""
COUNT, QUICK, NAMES = 400, 6, 3
BUDGET = 400_000
STEPS = (1e-3, 1e-4, 1e-5)
"""Over the distance of a place, or 1; each is halved once."""
CLEAR = 1e-3
"""Part of a difference that it may be off by for no smaller step to be tried."""
FAINTEST = 1e-4
"""Least bounced light of a place that is asked, over a thousandth of the brightest light."""


class Told(NamedTuple):
    """A derivative at one tolerance: its value (3,), what it states and its status."""

    value: Array
    stated: float
    status: int


class Counts:
    """What was asked and found so far."""

    def __init__(self) -> None:
        self.scenes = self.derivatives = self.met = self.pairs = self.judged = self.moved = 0
        self.refused: list[str] = []
        self.beyond: list[tuple[Any, ...]] = []


def numbers_of(data: dict[str, Any]) -> list[str]:
    """Names of the real numbers of a scene that may be asked for."""
    names = []
    for shape in data["shapes"]:
        own = f"shapes.{shape['name']}"
        if shape["type"] == "sphere":
            names += [f"{own}.center.{axis}" for axis in "xyz"] + [f"{own}.radius"]
        else:
            names += [f"{own}.point.{axis}" for axis in "xyz"]
    for light in data["lights"]:
        if "position" in light:
            names += [f"lights.{light['name']}.position.{axis}" for axis in "xyz"]
    for name, material in data["materials"].items():
        reflectance = material.get("reflectance")
        if isinstance(reflectance, dict) and "cell" in reflectance:
            names.append(f"materials.{name}.reflectance.cell")
        if "alpha" in material:
            names.append(f"materials.{name}.alpha")
    return names


def slopes_at(scene: Any, ray: Ray, name: str, scale: float) -> list[Told] | None:
    """A derivative at all tolerances; None where it is refused."""
    found = []
    for tol in TOLERANCES:
        probe = sr.probe(scene, rays=ray, tol=max(1e-12, tol * scale), wrt=[name], budget=BUDGET)
        told = Told(
            np.array(probe.gradient[name][0]), float(probe.gradient_error[name][0]),
            int(probe.gradient_status[name][0]),
        )  # fmt: skip
        if told.status == UNSUPPORTED:
            return None
        found.append(told)
    return found


def difference(scene: Any, ray: Ray, name: str, shape: str, scale: float, length: float) -> tuple[Array, float]:
    """Central difference of values and what it may be off by, of the step that tells best."""
    best, least = np.zeros(3), np.inf
    for step in STEPS:
        found = []
        for part in (step * length, 0.5 * step * length):
            sides, doubt = [], 0.0
            for side in (part, -part):
                moved = scene.replace({name: get(scene, name) + side})
                probe = sr.probe(moved, rays=ray, tol=max(1e-13, 1e-8 * scale), budget=BUDGET)
                sides.append(np.array(probe.radiance[0]))
                # beyond a limb nothing of this shape is told
                doubt += float(probe.error[0]) if probe.shape[0] == shape else np.inf
            found.append(((sides[0] - sides[1]) / (2 * part), doubt / (2 * part)))
        (wide, _), (narrow, doubt) = found
        # the error of the narrow one is a third of what both differ by, where nothing breaks between them
        doubt += float(np.abs(narrow - wide).max())
        if doubt < least:
            best, least = narrow + (narrow - wide) / 3.0, doubt
        if least <= CLEAR * np.abs(best).max():
            break
    return best, least


def one_place(seed: int, place: int, scene: Any, data: Any, ray: Ray, to: Counts) -> None:
    """Ask one place for its derivatives, and judge them."""
    least = 1e-3 * max(map(strength, data["lights"]))
    try:
        look = sr.probe(scene, rays=ray, tol=least, budget=BUDGET)
    except SymrenderError as reason:
        to.refused.append(str(reason)[:70])
        return
    scale = float(look.indirect.max())
    if look.shape[0] == "nothing" or look.status[0] == UNSUPPORTED or scale <= FAINTEST * least:
        return
    rng = np.random.default_rng([seed, place])
    center = next((shape["center"] for shape in data["shapes"] if shape["type"] == "sphere"), np.zeros(3))
    length = min(1.0, max(1e-3, float(np.linalg.norm(np.asarray(ray[0]) - np.asarray(center)))))
    for name in rng.choice(numbers_of(data), NAMES, replace=False).tolist():
        try:
            found = slopes_at(scene, ray, name, scale / length)
            if found is None:
                continue
            expected, doubt = difference(scene, ray, name, look.shape[0], scale, length)
        except SymrenderError as reason:
            to.refused.append(str(reason)[:70])
            continue
        to.derivatives += len(found)
        to.met += sum(each.status == MET for each in found)
        for one, other in itertools.combinations(found, 2):
            if EVENT in (one.status, other.status):
                continue
            to.pairs += 1
            off, both = float(np.abs(one.value - other.value).max()), one.stated + other.stated
            if off > LOOSEST * both + 1e-12 * scale:
                to.beyond.append((seed, place, name, "pair", off, both, float(np.abs(other.value).max())))
        size = float(np.abs(expected).max())
        if doubt > 0.01 * size + 1e-9 * scale or found[-1].status == EVENT:
            continue
        to.judged += len(found)
        to.moved += size > 1e-6 * scale
        for each in found:
            off = float(np.abs(each.value - expected).max())
            if off > LOOSEST * each.stated + doubt + 1e-9 * scale:
                to.beyond.append((seed, place, name, "difference", off, each.stated + doubt, size))


def main() -> None:
    kind, first, count = asked_for("afar", COUNT, QUICK)
    report, to = Report("derivatives_agree", __doc__.split("\n")[0]), Counts()
    for seed, data, scene, rays in scenes_of(kind, first, count, to.refused):
        to.scenes += 1
        before = len(to.beyond)
        for place, ray in enumerate(rays):
            one_place(seed, place, scene, data, ray, to)
        for each in to.beyond[before:]:
            print("beyond", *each, flush=True)
    report.say(
        f"{to.scenes} scenes of {kind} from seed {first}: {to.derivatives} derivatives, {to.met} of them met, in "
        f"{to.pairs} pairs; differences tell {to.judged}, of {to.moved} numbers that move what is seen; beyond: "
        f"{len(to.beyond)}; refused {len(to.refused)}."
    )
    for reason in sorted(set(to.refused)):
        report.say(f"- refused, {to.refused.count(reason)}: {reason}")
    # of some kinds most places are dark
    report.claim_number("numbers that move what is seen, short of one in four scenes", to.scenes / 4 - to.moved, 0)
    report.claim_number(f"derivatives more than {LOOSEST:g} times beyond", len(to.beyond), 0)
    report.leave()


if __name__ == "__main__":
    main()
