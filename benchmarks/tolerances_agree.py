"""Values of a place at different tolerances differ by no more than both state, and a judge agrees with them.

    python benchmarks/tolerances_agree.py [--quick] [--kind KIND] [SEED [COUNT]]

Scenes are balls and planes anywhere, that touch, cross and all but touch, of conductors (both distributions, both
maskings, Walter's fit, alpha .001 to 1), phong of exponents from 0 on and diffuse; rays start beside what they meet,
many of them grazing. Of a ``glow`` (a sky, balls that emit, no bounce) and of ``points`` (points near surfaces, spots
and suns, one bounce, checkers and stripes) every place is asked at many tolerances: pairs that differ by more than
both state are beyond, and so are values off by more than they state from rules within rules over angles, where those
tell: ``tests/radiometric/nested.py``, and of bounces ``nested_bounce.py``. ``sunk`` (points over planes with
checkers or stripes, every ball cuts or touches one, or another ball that does) are judged by lattices of rays of direct
light (``tests/radiometric/seen_lattice.py``), and so are pairs of ``tiles`` (a sky and balls that emit, one bounce,
textures, gloss met first), which are asked alone. Of ``afar`` (small squares under lamps, points and a sky close to
the floor and many squares off, with balls behind and beside lamps) they judge every place.
"""

from __future__ import annotations

import itertools
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from measure import Report

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

Array = np.ndarray
Scene = dict[str, Any]
Ray = tuple[Array, Array]
KINDS = ("glow", "points", "tiles", "sunk", "afar")
BY_LATTICES = ("tiles", "sunk", "afar")
JUDGED = ("sunk", "afar")
"""Kinds whose every place lattices judge, not those alone that disagree."""
COUNT, QUICK = 1_000, 12
PLACES = 4
"""Rays of a scene."""
TOLERANCES = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-8, 1e-10)
"""Of the light that is there, as a first look finds it, or of a thousandth of the lights' where there is none."""
BUDGET = {"glow": 400_000, "points": 300_000, "tiles": 150_000, "sunk": 300_000, "afar": 300_000}
LOOSEST = 1.5
SHARE = 0.999
"""Of all values that a judge tells, those that are to be within what they state."""
PIECES = 3e-3
"""Share of the least error stated that the judge asks of every piece of its own."""
LEAST = 1e-12
CLOSER, EFFORT = (1e-8, 1e-10, 1e-12), (500_000, 4_000_000, 40_000_000)
"""Share of the light that the judge of bounces asks of every piece, and its budget, the next where values disagree."""
KINKED = 10.0
"""What the judge of bounces states is taken so many times: kinks across its lines may fall between nodes."""
TOLD = 0.25
"""Share of what is stated that the judge may be off and tell."""
SURE = 6.0
"""Standard errors of lattices that count for nothing."""
LOOKS = ((10946, 6765), (46368, 28657), (196418, 121393))
"""Points of lattices, the next where values disagree with the one before: what is small and bright few may meet."""


class Beyond(NamedTuple):
    """A value, or two, that are farther apart than they state; the judge's opinion of which."""

    seed: int
    place: int
    tol: float
    off: float
    stated: float
    light: float
    met: bool
    judge: str


def unit(rng: np.random.Generator) -> Array:
    """A direction."""
    v = rng.normal(size=3)
    return np.asarray(v / np.linalg.norm(v))


def material(rng: np.random.Generator) -> Scene:
    """Some material of one colour."""
    shade = rng.choice([0.0, 0.3, 1.0], 3, p=[0.15, 0.35, 0.5]).tolist()
    both = {"reflectance": shade, "two_sided": bool(rng.random() < 0.2)}
    kind = rng.choice(["conductor", "phong", "diffuse"], p=[0.6, 0.2, 0.2])
    if kind == "diffuse":
        return {"type": "diffuse"} | both
    if kind == "phong":
        blunt = [0.0, 0.6, 1.0, 2.0, 4.3, 10.0]
        exponent = rng.choice(blunt) if rng.random() < 0.4 else 10.0 ** rng.uniform(0.0, 4.0)
        return {"type": "phong", "exponent": float(exponent)} | both
    alpha = float(rng.choice([0.5, 0.1, 0.01, 10.0 ** rng.uniform(-3, 0)], p=[0.1, 0.1, 0.1, 0.7]))
    made = {"type": "conductor", "alpha": alpha, "masking": str(rng.choice(["separable", "correlated"])),
            "eta": rng.uniform(0.1, 3, 3).tolist(), "k": rng.choice([0.0, 0.5, 3.0], 3).tolist()}  # fmt: skip
    made["distribution"] = str(rng.choice(["ggx", "beckmann"]))
    if made["distribution"] == "beckmann" and rng.random() < 0.4:
        made["g1"] = "walter"
    return made | both


def shapes_of(rng: np.random.Generator, names: list[str], near: float) -> list[Scene]:
    """Planes and balls; no two balls cross with chance ``near``."""
    shapes: list[Scene] = []
    for k in range(int(rng.integers(0, 3))):
        tilt = unit(rng) * float(rng.choice([0.0, 1e-3, 0.3]))
        normal = np.array([[0, 0, 1], [1, 0, 0]][k]) + tilt
        point = -normal * float(rng.choice([0.0, 1.0, 1.01, 2.0]))
        shapes.append({"type": "plane", "name": f"P{k}", "point": point.tolist(), "normal": normal.tolist(),
                       "along": unit(rng).tolist(), "material": str(rng.choice(names))})  # fmt: skip
    balls: list[tuple[Array, float]] = []
    for k in range(int(rng.integers(1, 4))):
        radius = float(rng.choice([1.0, 10.0 ** rng.uniform(-2, 1)]))
        center = rng.normal(size=3) * 1.5
        how = rng.choice(["free", "floor", "beside", "cross"], p=[0.4, 0.2, 0.3, 0.1])
        gap = float(rng.choice([0.0, 1e-6, 1e-3, 0.1]))
        if how == "floor":
            center[2] = radius + gap
        elif how == "beside" and balls:
            other, size = balls[int(rng.integers(len(balls)))]
            center = other + unit(rng) * (size + radius + gap)
        elif how == "cross" and rng.random() > near:
            center *= 0.3
        balls.append((center, radius))
        shapes.append({"type": "sphere", "name": f"S{k}", "center": center.tolist(), "radius": radius,
                       "material": str(rng.choice(names))})  # fmt: skip
    return shapes


def sunk_of(rng: np.random.Generator) -> list[Scene]:
    """A floor, often a wall across it, and balls that cut or touch them or each other."""
    planes: list[Scene] = []
    for k in range(1 + int(rng.random() < 0.5)):
        normal = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0]][k]) + unit(rng) * float(rng.choice([0.0, 1e-3, 0.3]))
        planes.append({"type": "plane", "name": f"P{k}", "point": [1.2 * k, 0.0, 0.0], "normal": normal.tolist(),
                       "along": [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]][k] if rng.random() < 0.3 else unit(rng).tolist(),
                       "material": "tiles"})  # fmt: skip
    balls: list[Scene] = []
    for k in range(int(rng.integers(1, 4))):
        radius = float(rng.choice([0.5, 10.0 ** rng.uniform(-1.5, 0.5)]))
        depth = float(
            rng.choice([rng.uniform(-0.97, 0.97), 1.0, 1.0 - 10.0 ** rng.uniform(-6, -1)], p=[0.7, 0.15, 0.15])
        )
        if balls and rng.random() < 0.4:
            other = balls[int(rng.integers(len(balls)))]
            center = np.array(other["center"]) + unit(rng) * (other["radius"] + depth * radius)
        else:
            plane = planes[int(rng.integers(len(planes)))]
            place, normal = spot_on(rng, plane, (0.3, 1.0))
            center = place + depth * radius * normal
        balls.append({"type": "sphere", "name": f"S{k}", "center": center.tolist(), "radius": radius,
                      "material": str(rng.choice(["m0", "m1", "m2"]))})  # fmt: skip
    return planes + balls


def tiles_of(rng: np.random.Generator, cells: tuple[float, ...], shades: tuple[float, ...] = (0.0, 0.3, 0.9)) -> Scene:
    """A checker, or stripes."""
    colours = [rng.choice(shades, 3).tolist() for _ in range(2)]
    return {"type": str(rng.choice(["checker", "stripes"])), "bright": colours[0], "dark": colours[1],
            "cell": float(rng.choice(cells))}  # fmt: skip


def points_of(rng: np.random.Generator, shapes: list[Scene]) -> list[Scene]:
    """Points, spots and suns, some of them close to a surface."""
    lights: list[Scene] = []
    for k in range(int(rng.integers(1, 3))):
        colour = rng.choice([0.0, 0.5, 3.0], 3, p=[0.15, 0.35, 0.5]).tolist()
        if rng.random() < 0.35:
            lights.append({"type": "directional", "name": f"L{k}", "direction": unit(rng).tolist(),
                           "irradiance": colour})  # fmt: skip
            continue
        place = rng.normal(size=3) * 2.0
        if rng.random() < 0.4:
            at, normal = spot_on(rng, shapes[int(rng.integers(len(shapes)))])
            place = at + normal * float(10.0 ** rng.uniform(-3, 0))
        light: Scene = {"type": "point", "name": f"L{k}", "position": place.tolist(), "intensity": colour}
        if rng.random() < 0.3:
            beam = float(rng.choice([0.0, 5.0, 30.0, 60.0]))
            light |= {"type": "spot", "direction": unit(rng).tolist(), "beam": beam,
                      "cutoff": beam + float(rng.choice([1e-3, 1.0, 20.0])),
                      "falloff": str(rng.choice(["linear", "smooth"]))}  # fmt: skip
        lights.append(light)
    return lights


def glows_of(rng: np.random.Generator, shapes: list[Scene]) -> list[Scene]:
    """A sky, balls that emit, or both."""
    balls = [shape["name"] for shape in shapes if shape["type"] == "sphere"]
    kind = str(rng.choice(["sky", "lamp", "both"], p=[0.5, 0.25, 0.25]))
    lights: list[Scene] = []
    if kind != "lamp":
        lights.append(
            {"type": "sky", "name": "sky", "radiance": rng.choice([0.0, 0.3, 1.0], 3, p=[0.1, 0.2, 0.7]).tolist()}
        )
    if kind != "sky":
        for k, name in enumerate(rng.choice(balls, int(rng.integers(1, 3)))):
            radiance = rng.choice([0.0, 0.5, 5.0], 3, p=[0.1, 0.3, 0.6]).tolist()
            if name not in [light.get("shape") for light in lights]:
                lights.append({"type": "area", "name": f"lamp{k}", "shape": str(name), "radiance": radiance})
    return lights


def afar_of(rng: np.random.Generator) -> tuple[list[Scene], list[Scene]]:
    """A floor of small squares, balls over it, and lights of every kind close to it, many squares off."""
    normal = np.array([0.0, 0.0, 1.0]) + unit(rng) * float(rng.choice([0.0, 1e-3, 0.3]))
    normal /= np.linalg.norm(normal)
    floor = {"type": "plane", "name": "P0", "point": [0.0, 0.0, 0.0], "normal": normal.tolist(),
             "along": [1.0, 0.0, 0.0] if rng.random() < 0.3 else unit(rng).tolist(), "material": "tiles"}  # fmt: skip
    shapes: list[Scene] = [floor]
    for k in range(int(rng.integers(1, 3))):
        radius = float(rng.choice([0.5, 10.0 ** rng.uniform(-1.0, 0.3)]))
        gap = float(rng.choice([0.0, 1e-3, 0.1, 1.0]))
        place, _ = spot_on(rng, floor, (0.1, 1.0))
        shapes.append({"type": "sphere", "name": f"S{k}", "center": (place + (radius + gap) * normal).tolist(),
                       "radius": radius, "material": f"m{k}"})  # fmt: skip
    lights: list[Scene] = []
    for k in range(int(rng.integers(1, 4))):
        place, _ = spot_on(rng, floor, (1.0, 4.0, 16.0))
        high = float(10.0 ** rng.uniform(-2.0, 0.3))
        colour = rng.choice([0.5, 3.0], 3).tolist()
        if rng.random() < 0.7:
            radius = high * float(rng.choice([0.05, 0.5, 0.99, 1.0]))
            shapes.append({"type": "sphere", "name": f"S{k + 5}", "center": (place + high * normal).tolist(),
                           "radius": radius, "material": "m2"})  # fmt: skip
            lights.append({"type": "area", "name": f"L{k}", "shape": f"S{k + 5}", "radiance": colour})
            if rng.random() < 0.5:
                # one that hides some of the lamp, or is lit by it from close by
                size = float(radius * rng.choice([0.1, 1.0, 3.0]))
                aside = unit(rng) * (radius + size) * float(rng.choice([1.0, 1.01, 1.5, 4.0]))
                center = place + high * normal + aside
                shapes.append({"type": "sphere", "name": f"S{k + 8}", "center": center.tolist(), "radius": size,
                               "material": f"m{k % 2}"})  # fmt: skip
        else:
            lights.append({"type": "point", "name": f"L{k}", "position": (place + high * normal).tolist(),
                           "intensity": colour})  # fmt: skip
    if rng.random() < 0.25:
        lights.append({"type": "sky", "name": "sky", "radiance": rng.choice([0.1, 1.0], 3).tolist()})
    return shapes, lights


def spot_on(rng: np.random.Generator, shape: Scene, far: tuple[float, ...] = (0.1, 1.0, 5.0)) -> tuple[Array, Array]:
    """A place on a shape, of a plane about ``far`` from its point, and its normal."""
    if shape["type"] == "sphere":
        normal = unit(rng)
        return np.array(shape["center"]) + shape["radius"] * normal, normal
    normal = np.array(shape["normal"]) / np.linalg.norm(shape["normal"])
    v = rng.normal(size=3) * float(rng.choice(far))
    return np.array(shape["point"]) + v - (v @ normal) * normal, normal


def ray_to(rng: np.random.Generator, shapes: list[Scene]) -> tuple[Array, Array]:
    """A ray that starts beside a shape that it meets, half of them grazing."""
    shape = shapes[int(rng.integers(len(shapes)))]
    place, normal = spot_on(rng, shape)
    cosine = float(10.0 ** rng.uniform(-3.5, 0)) if rng.random() < 0.5 else float(rng.uniform(0, 1))
    aside = unit(rng)
    aside -= (aside @ normal) * normal
    toward = cosine * normal + np.sqrt(1.0 - cosine**2) * aside / np.linalg.norm(aside)
    size = shape.get("radius", 1.0)
    return place + toward * size * 10.0 ** rng.uniform(-3, 0), -toward


def drawn(seed: int, kind: str) -> tuple[Scene, Array, Array]:
    """A scene of a kind, and origins and directions of rays."""
    rng = np.random.default_rng([seed, KINDS.index(kind), 17])
    materials = {f"m{k}": material(rng) for k in range(3)}
    far, near = afar_of(rng) if kind == "afar" else ([], [])
    if kind in JUDGED:
        shapes = far or sunk_of(rng)
        materials["tiles"] = {
            "type": "diffuse",
            "reflectance": tiles_of(rng, (0.25, 0.7, 1.3, 3.0) if kind == "sunk" else (0.05, 0.11, 0.25, 0.6)),
            "two_sided": bool(rng.random() < 0.2),
        }
    else:
        shapes = shapes_of(rng, list(materials), 0.0 if kind == "points" else 1.0)
    scene: Scene = {
        "units": "radiometric", "name": "drawn", "bounces": 0 if kind == "glow" else 1,
        "camera": {"type": "look_at", "eye": [0, 0, 99], "target": [0, 0, 0], "up": [0, 1, 0], "fov": 40},
        "materials": materials, "shapes": shapes,
        "lights": near or (points_of(rng, shapes) if kind in ("points", "sunk") else glows_of(rng, shapes)),
    }  # fmt: skip
    if kind == "sunk":
        for light in scene["lights"]:
            above, sign = ("position", 1.0) if "position" in light else ("direction", -1.0)
            light[above][2] = sign * abs(light[above][2])
    if kind in ("tiles", "afar"):
        scene["gloss"] = "first_hit"
        if kind == "tiles" and rng.random() < 0.5:
            scene["lights"] += points_of(rng, shapes)[:1]
    if kind != "glow":
        on_planes = {shape["material"] for shape in shapes if shape["type"] == "plane"}
        for name, made in materials.items():
            if rng.random() < 0.4 and (made["type"] == "diffuse" or name not in on_planes):
                made["reflectance"] = tiles_of(rng, (0.11, 0.25, 1.3))
    rays = [ray_to(rng, shapes) for _ in range(PLACES)]
    return scene, np.array([ray[0] for ray in rays]), np.array([ray[1] for ray in rays])


class Counts(NamedTuple):
    """What came of all places: numbers of them, and what is beyond."""

    scenes: list[int]
    values: list[float]
    told: list[float]
    pairs: list[int]
    beyond: list[Beyond]
    refused: list[str]
    useless: list[tuple[int, int, float, float]]


def strength(light: Scene) -> float:
    """The largest channel of what a light sends, in its own units."""
    return float(np.max([light[word] for word in ("intensity", "irradiance", "radiance") if word in light]))


def light_of(probe: Any, kind: str) -> Array:
    """The layer that is asked of."""
    return np.asarray(probe.direct if kind == "glow" else probe.indirect)


def opinions_of(
    data: Scene, shape: str, ray: tuple[Array, Array], kind: str, found: list[tuple[Array, float, int]], scale: float
) -> list[tuple[Array, float]] | None:
    """What the judge finds and how far it may be off, looked at closer where values do not agree; None: other shape."""
    from tests.radiometric import nested, nested_bounce

    world, opinions = nested.world(data), []
    least = min(each[1] for each in found)
    points = kind == "points"
    for k, tol in enumerate(CLOSER if points else (PIECES * max(least / scale, 1e-12), 1e-4 * PIECES)):
        if points:
            known = nested_bounce.reflected(world, *ray, tol * scale, EFFORT[k])
        else:
            known = nested.reflected(world, *ray, tol * scale)
        if known.shape < 0 or shape != f"shapes.{data['shapes'][known.shape]['name']}":
            return None
        doubt = KINKED * known.error if points else known.error
        opinions.append((known.light, doubt))
        if points:
            if all(float(np.abs(value - known.light).max()) - doubt <= stated for value, stated, _ in found):
                break
        elif doubt < TOLD * least:
            break
    return opinions


def one_place(seed: int, place: int, kind: str, made: tuple[Any, Scene], ray: tuple[Array, Array], to: Counts) -> None:
    """Ask one place at all tolerances, and judge what it says."""
    from tests.radiometric import seen_lattice

    import symrender as sr
    from symrender.errors import SymrenderError

    scene, data = made
    try:
        first = sr.probe(scene, rays=ray, tol=1e-3, budget=BUDGET[kind])
    except SymrenderError as reason:
        to.refused.append(str(reason)[:70])
        return
    light = float(light_of(first, kind).max())
    if first.shape[0] == "nothing" or first.status[0] == 3:
        return
    scale = max(light, 1e-3 * max(map(strength, data["lights"])), 1e-6)
    tolerances = [max(LEAST, tol * scale) for tol in TOLERANCES]
    seen = [sr.probe(scene, rays=ray, tol=tol, budget=BUDGET[kind]) for tol in tolerances]
    found = [(light_of(each, kind)[0], float(each.error[0]), int(each.status[0])) for each in seen]
    for tol, each in zip(tolerances, seen, strict=True):
        if each.error[0] > 0.05 * scale and each.error[0] > 30 * tol:
            to.useless.append((seed, place, tol / scale, float(each.error[0]) / scale))
    to.values.extend(each[1] for each in found if each[2] == 0)
    apart = []
    for one, other in itertools.combinations(range(len(found)), 2):
        off, both = float(np.abs(found[one][0] - found[other][0]).max()), found[one][1] + found[other][1]
        to.pairs[0] += 1
        if off > LOOSEST * both:
            apart.append((one, other, off, both))
    if kind in BY_LATTICES:
        opinions: list[tuple[Array, float]] | None = []
        for look in LOOKS if apart or kind in JUDGED else ():
            known = seen_lattice.bounced(data, *ray, np.random.default_rng([seed, place, 5]), *look)
            doubt = SURE * float(known.sigma.max())
            opinions = [(known.indirect, doubt)]
            if all(float(np.abs(value - known.indirect).max()) - doubt <= stated for value, stated, _ in found):
                break
    else:
        opinions = opinions_of(data, seen[0].shape[0], ray, kind, found, scale)
        if opinions is None:
            return
    best, doubt = opinions[-1] if opinions else (np.zeros(3), np.inf)
    judged = set()
    for k, (value, stated, _) in enumerate(found):
        off = float(np.abs(value - best).max()) - doubt
        if doubt < TOLD * stated or (doubt < np.inf and off > LOOSEST * stated):
            to.told.append(off / stated)
            judged.add(k)
            if off > stated:
                to.beyond.append(
                    Beyond(
                        seed, place, tolerances[k] / scale, off, stated, scale, found[k][2] == 0, f"judge {doubt:.0e}"
                    )
                )
    for one, other, off, both in apart:
        if not (one in judged and other in judged):
            to.beyond.append(
                Beyond(
                    seed,
                    place,
                    tolerances[one] / scale,
                    off,
                    both,
                    scale,
                    found[one][2] == found[other][2] == 0,
                    f"pair {TOLERANCES[other]:.0e}",
                )
            )


def asked_for(kind: str, every: int, few: int) -> tuple[str, int, int]:
    """Kind, first seed and number of scenes that the command line names, where it names them."""
    words = sys.argv[1:]
    kind = words[words.index("--kind") + 1] if "--kind" in words else kind
    seeds = [int(word) for word in words if word.isdigit()]
    return kind, (seeds[0] if seeds else 0), (seeds[1] if len(seeds) > 1 else few if "--quick" in words else every)


def scenes_of(kind: str, first: int, count: int, refused: list[str]) -> Iterator[tuple[int, Scene, Any, list[Ray]]]:
    """(seed, its data, the scene, rays) of all that are no nonsense; of the others ``refused`` gets the reason."""
    from symrender.errors import SymrenderError
    from symrender.scene.load import load_any

    for seed in range(first, first + count):
        data, origins, directions = drawn(seed, kind)
        try:
            scene = load_any(data)
        except SymrenderError as reason:
            refused.append(str(reason)[:70])
            continue
        yield seed, data, scene, list(zip(origins[:PLACES], directions[:PLACES], strict=True))


def main() -> None:
    kind, first, count = asked_for("glow", COUNT, QUICK)
    report = Report("tolerances_agree", "Values at all tolerances agree with each other and with a judge.")
    to = Counts([0], [], [], [0], [], [], [])
    for seed, data, scene, rays in scenes_of(kind, first, count, to.refused):
        to.scenes[0] += 1
        before = len(to.beyond)
        for place, ray in enumerate(rays):
            one_place(seed, place, kind, (scene, data), ray, to)
        for each in to.beyond[before:]:
            print("beyond", *each, flush=True)
    report.say(
        f"{to.scenes[0]} scenes of {kind} from seed {first}, {len(to.refused)} places refused; {len(to.values)} values "
        f"met, {to.pairs[0]} pairs; of {len(to.told)} values the judge tells; beyond: {len(to.beyond)}; "
        f"{len(to.useless)} state a twentieth of the light or more, thirty times what was asked."
    )
    report.table(
        ["seed", "place", "tol", "off", "stated", "light", "met", "by"],
        [list(each) for each in sorted(to.beyond, key=lambda x: -x.off / x.stated)[:30]],
    )
    for reason in sorted(set(to.refused)):
        report.say(f"- refused, {to.refused.count(reason)}: {reason}")
    for each in to.useless[:10]:
        report.say(f"- useless: seed {each[0]} place {each[1]}, {each[2]:.0e} asked, {each[3]:.1e} stated")
    within = sum(ratio <= 1.0 for ratio in to.told)
    report.say(f"{within} of {len(to.told)} told values are off by no more than they state, {SHARE:.1%} wanted.")
    report.claim_number("told values off by more than they state, of a thousand",
        1e3 * (len(to.told) - within) / max(
        1, len(to.told)), 1e3 * (1.0 - SHARE))  # fmt: skip
    report.claim_number(
        f"values more than {LOOSEST:g} times beyond", sum(each.off > LOOSEST * each.stated for each in to.beyond), 0
    )
    report.leave()


if __name__ == "__main__":
    main()
