"""No value of a plane under a sphere that emits, far and small or not, is beyond 1.5 times what it states.

    python benchmarks/small_lamps_are_stated.py [--quick] [--count N] [--seed S] [--write FILE] [--plant]

A diffuse plane in any frame under a sphere whose radius is .9 to 1e-7 of its distance, above the horizon or partly
below it, alone or behind a ball that hides a part of it. Judged in 40 digits: in closed form where nothing hides the
lamp, else by tanh-sinh quadrature of what is left of each circle about its middle. The ray's meeting with the plane is
computed in 40 digits too, from the very numbers of the scene. ``--plant`` moves every value by 1e-9 of itself.
"""

from __future__ import annotations

import argparse
import itertools
import json
import sys
import time
from collections import Counter
from pathlib import Path
from typing import Any

import mpmath
import numpy as np
from measure import Report
from mpmath import mp, mpf

import symrender as sr
from symrender.errors import SymrenderError

VALUES, QUICK = 2_000, 60
RAYS = 4
FACTOR = 1.5
FINEST = 1e-13
"""Tolerance that is asked."""
DARK = 1e-30
"""Of a lamp's radiance, what nobody misses."""
mp.dps = 40
STEP, REACH = mpf("0.1"), 34
"""Of tanh-sinh quadrature: about 1e-19."""


def exact(values: Any) -> Any:
    return [mpf(float(value)) for value in values]


def minus(a: Any, b: Any) -> Any:
    return [x - y for x, y in zip(a, b, strict=True)]


def inner(a: Any, b: Any) -> Any:
    return sum(x * y for x, y in zip(a, b, strict=True))


def lamp_alone(sine: Any, cosine: Any) -> Any:
    """Integral of the cosine to a normal over a cap of directions above the horizon, over pi: its form factor.

    ``sine`` is that of the cap's half angle, ``cosine`` that of its middle to the normal.
    """
    height = sine * mpmath.mpf(1)
    if cosine >= height:
        return cosine * sine**2
    if cosine <= -height:
        return mpf(0)
    # the part above the horizon is bounded by an arc of the cap's circle and one of the horizon's
    across = mpmath.sqrt(1 - cosine**2)
    open_angle = mpmath.sqrt(1 - sine**2)
    # the circle meets the horizon where its azimuth about the middle has this cosine
    turn = mpmath.acos(max(mpf(-1), min(mpf(1), -cosine * open_angle / (across * sine))))
    # contour integral of n . (w x dw)/2 over the circle's arc; along the horizon that of its azimuth
    circle = turn * sine**2 * cosine - mpmath.sin(turn) * sine * open_angle * across
    azimuth = mpmath.atan2(sine * mpmath.sin(turn), across * open_angle - cosine * sine * mpmath.cos(turn))
    return (circle + azimuth) / mpmath.pi


def lamp_behind(middle: Any, sine: Any, normal: Any, ball: Any, ball_sine: Any) -> Any:
    """The same of a cap about the unit vector ``middle``, less what lies in another cap and below the horizon.

    Circles about the middle at angles t: on each the horizon and the other cap leave arcs, whose cosine integrates in
    closed form.
    """
    most = mpmath.asin(sine)
    far_cosine = mpmath.sqrt(1 - ball_sine**2)
    height = inner(middle, normal)
    across = [n - height * m for n, m in zip(normal, middle, strict=True)]
    if inner(across, across) == 0:
        # straight above: any direction across will do
        across = [mpf(0), normal[2], -normal[1]] if abs(normal[0]) < 0.5 else [normal[1], -normal[0], mpf(0)]
        across = [a * mpf("1e-35") for a in across]
    long = mpmath.sqrt(inner(across, across))
    one = [a / long for a in across]
    two = [middle[1] * one[2] - middle[2] * one[1], middle[2] * one[0] - middle[0] * one[2],
           middle[0] * one[1] - middle[1] * one[0]]  # fmt: skip
    b0, b1, b2 = inner(ball, middle), inner(ball, one), inner(ball, two)
    about, reach = mpmath.atan2(b2, b1), mpmath.sqrt(b1 * b1 + b2 * b2)

    def ring(t: Any) -> Any:
        s, c = mpmath.sin(t), mpmath.cos(t)
        if s == 0:
            return mpf(0)
        # above the horizon: height c + long s cos(phi) > 0
        level = -height * c / (long * s)
        up = mpmath.pi if level <= -1 else mpf(0) if level >= 1 else mpmath.acos(level)
        # in the ball's cap: b0 c + reach s cos(phi - about) > far_cosine
        limit = (far_cosine - b0 * c) / (reach * s)
        hidden = mpmath.pi if limit <= -1 else mpf(0) if limit >= 1 else mpmath.acos(limit)
        total = arc(-up, up)
        for whole in (-2 * mpmath.pi, mpf(0), 2 * mpmath.pi):
            low, high = max(-up, about - hidden + whole), min(up, about + hidden + whole)
            if high > low:
                total = tuple(a - b for a, b in zip(total, arc(low, high), strict=True))
        return s * (height * c * total[0] + long * s * total[1])

    def arc(low: Any, high: Any) -> tuple[Any, Any]:
        return high - low, mpmath.sin(high) - mpmath.sin(low)

    apart, wide = mpmath.acos(max(mpf(-1), min(mpf(1), b0))), mpmath.asin(ball_sine)
    horizon = mpmath.asin(min(mpf(1), abs(height)))
    stops = [mpf(0), most, *(stop for stop in (abs(apart - wide), apart + wide, horizon) if 0 < stop < most)]
    # where the rims of ball and horizon cross, arcs change their order
    stops += crossings(height, long, b0, b1, b2, far_cosine, most)
    stops = sorted(set(stops))
    return sum(between(ring, low, high) for low, high in itertools.pairwise(stops)) / mpmath.pi


def between(rule: Any, low: Any, high: Any) -> Any:
    """Tanh-sinh quadrature from low to high."""
    half = (high - low) / 2
    return half * sum(w * rule(low + half * near if k < 0 else high - half * near) for k, near, w in ENDS)


def ends() -> list[tuple[int, Any, Any]]:
    """(side, distance from the nearer end of [-1, 1], weight) of the nodes of tanh-sinh quadrature."""
    found = []
    for k in range(-REACH, REACH + 1):
        t = mpf(k) * STEP
        inside = mpmath.pi / 2 * mpmath.sinh(t)
        found.append((k, mpmath.exp(-abs(inside)) / mpmath.cosh(inside),
                      STEP * mpmath.pi / 2 * mpmath.cosh(t) / mpmath.cosh(inside) ** 2))  # fmt: skip
    return found


def crossings(height: Any, long: Any, b0: Any, b1: Any, b2: Any, far_cosine: Any, most: Any) -> list[Any]:
    """Angles to the middle of the directions in the horizon that lie on the ball's rim."""
    # the middle's frame: normal = (long, 0, height), ball = (b1, b2, b0); w = cos(a) e + sin(a) f lies in the horizon
    e, f = (height, mpf(0), -long), (mpf(0), mpf(1), mpf(0))
    p, q = e[0] * b1 + e[2] * b0, b2
    size = mpmath.sqrt(p * p + q * q)
    if size == 0 or abs(far_cosine / size) >= 1:
        return []
    found = []
    for side in (1, -1):
        a = mpmath.atan2(q, p) + side * mpmath.acos(far_cosine / size)
        angle = mpmath.acos(max(mpf(-1), min(mpf(1), mpmath.cos(a) * e[2] + mpmath.sin(a) * f[2])))
        if 0 < angle < most:
            found.append(angle)
    return found


def expected(made: dict[str, Any], origin: Any, direction: Any) -> Any:
    """Radiance that comes back along a ray, in 40 digits, and whether the place is hidden from the eye."""
    scene = made["scene"]
    plane = scene["shapes"][0]
    o, d, n = exact(origin), exact(direction), exact(plane["normal"])
    long = mpmath.sqrt(inner(n, n))
    n = [part / long for part in n]
    far = inner(minus(exact(plane.get("point", plane.get("center"))), o), n) / inner(d, n)
    place = [a + far * b for a, b in zip(o, d, strict=True)]
    for ball in scene["shapes"][1:]:
        apart = minus(exact(ball["center"]), o)
        size = mpmath.sqrt(inner(d, d))
        along = inner(apart, d) / size
        if inner(apart, apart) - along**2 < (mpf(ball["radius"]) * mpf("1.001")) ** 2 and 0 < along < far * size:
            return None
    caps = []
    for ball in scene["shapes"][1:]:
        way = minus(exact(ball["center"]), place)
        away = mpmath.sqrt(inner(way, way))
        if away <= mpf(ball["radius"]) * mpf("1.000001"):
            return None
        caps.append(([part / away for part in way], mpf(ball["radius"]) / away, away))
    middle, sine, _ = caps[0]
    if len(caps) == 1:
        return lamp_alone(sine, inner(middle, n))
    return lamp_behind(middle, sine, n, caps[1][0], caps[1][1])


def hostile(seed: int) -> dict[str, Any]:
    """A plane, a lamp, now and then a ball that hides a part of it, and rays at the plane."""
    rng = np.random.default_rng([seed, 514])
    normal = np.eye(3)[rng.integers(3)] if rng.random() < 0.5 else rng.normal(size=3)
    axis = normal / np.linalg.norm(normal)
    one = np.cross(axis, rng.normal(size=3))
    one = one / np.linalg.norm(one)
    two = np.cross(axis, one)
    at = rng.normal(size=3) * float(rng.choice([0.0, 1.0, 100.0]))
    ratio = 10 ** float(rng.uniform(-7, -0.05) if rng.random() < 0.8 else rng.uniform(-1, -0.02))
    away = 10 ** float(rng.uniform(-2, 4))
    flat = rng.random() < 0.5
    if rng.random() < 0.6 or not flat:
        sine = float(rng.uniform(min(0.9, 1.01 * ratio), 1))
    else:
        # on the horizon, within its own width, over a floor that ends before it
        sine = ratio * float(rng.uniform(-0.99, 3))
    place = at + rng.normal() * one + rng.normal() * two
    turn = rng.uniform(0, 2 * np.pi)
    level = np.cos(turn) * one + np.sin(turn) * two
    middle = np.sqrt(max(0.0, 1 - sine * sine)) * level + sine * axis
    lamp = place + away * middle
    radius = ratio * away
    shapes: list[dict[str, Any]] = [
        {"type": "plane", "name": "floor", "point": at.tolist(), "normal": normal.tolist(), "along": one.tolist(),
         "material": "m"},
        {"type": "sphere", "name": "lamp", "center": lamp.tolist(), "radius": radius, "material": "m"},
    ]  # fmt: skip
    if flat:
        size = 0.4 * (1.0 - ratio) * away
        shapes[0] = {"type": "disk", "name": "floor", "center": place.tolist(), "normal": normal.tolist(),
                     "radius": size, "along": one.tolist(), "material": "m"}  # fmt: skip
    if rng.random() < 0.15:
        share = float(rng.uniform(0.05, 0.8))
        near, size = share * away, ratio * share * away * 10 ** float(rng.uniform(-0.7, 0.7))
        size = min(size, 0.5 * (away - near - radius), 0.9 * near)
        beside = np.cross(middle, rng.normal(size=3))
        beside = beside / np.linalg.norm(beside)
        shift = beside * (ratio * near + size) * float(rng.uniform(0, 1))
        if size > 0:
            center = place + near * middle + shift
            if np.linalg.norm(center - lamp) > 1.05 * (size + radius):
                shapes.append(
                    {"type": "sphere", "name": "ball", "center": center.tolist(), "radius": size, "material": "m"}
                )
    scale = 10 ** float(rng.uniform(-1, 3)) / ratio**2 if ratio > 1e-5 else 1e9
    scene = {
        "units": "radiometric", "name": "lamp", "bounces": 0, "shapes": shapes,
        "materials": {"m": {"type": "diffuse", "reflectance": 1.0}},
        "camera": {"type": "look_at", "eye": [3.1, -7.2, 2.3], "target": [0, 0, 0], "fov": 30},
        "lights": [{"type": "area", "name": "L", "shape": "lamp", "radiance": min(scale, 1e9)}],
    }  # fmt: skip
    targets = [
        place + min(1.0, ratio * away, 0.1 * (1.0 - ratio) * away) * 0.3 * k * (rng.normal() * one + rng.normal() * two)
        for k in range(RAYS)
    ]
    eyes = np.array(
        [
            t + min(1.0, away) * (axis * 10 ** rng.uniform(-1, 1) + rng.normal() * one + rng.normal() * two)
            for t in targets
        ]
    )
    return {"seed": seed, "scene": scene, "ratio": ratio, "origins": eyes, "directions": np.array(targets) - eyes,
            "radiance": min(scale, 1e9), "hidden": len(shapes) > 2}  # fmt: skip


def case(seed: int, plant: bool) -> dict[str, Any]:
    """What became of the rays of one scene."""
    made = hostile(seed)
    # every digit of a direction counts: the package makes them units, and so moves the place by roundings
    try:
        said = sr.probe(made["scene"], rays=(made["origins"], made["directions"]), tol=FINEST, threads=1)
    except SymrenderError as error:
        return made | {"refused": f"{type(error).__name__}: {error}"}
    rows = []
    for k, (origin, direction) in enumerate(zip(made["origins"], made["directions"], strict=True)):
        truth = expected(made, origin, direction)
        if truth is None or "floor" not in said.shape[k]:
            continue
        value = float(said.radiance[k, 0]) * (1.0 + 1e-9 * plant)
        due = truth * mpf(made["radiance"])
        stated = float(said.error[k])
        off = float(abs(mpf(value) - due))
        rows.append({
            "ray": k, "value": value, "stated": stated, "truth": float(due), "off": off, "status": int(said.status[k]),
            "beyond": off > FACTOR * stated + 1e-15 * float(due) + DARK * made["radiance"],
        })  # fmt: skip
    return made | {"rows": rows}


ENDS = ends()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="small enough for continuous integration")
    parser.add_argument("--count", type=int, help="values")
    parser.add_argument("--seed", type=int, default=0, help="the first scene's")
    parser.add_argument("--plant", action="store_true", help="plant a fault that the judge must see")
    parser.add_argument("--write", type=Path, help="file for the values that are beyond, one JSON object a line")
    parser.add_argument("--seconds", type=float, default=np.inf, help="leave off after so long, however few they are")
    options = parser.parse_args()
    last = time.monotonic() + options.seconds
    wanted = options.count or (QUICK if options.quick else VALUES)
    report = Report("small_lamps_are_stated", __doc__.split("\n")[0])
    sums: Counter[str] = Counter()
    refused: Counter[str] = Counter()
    bands: dict[int, list[float]] = {}
    worst, seed, begun = 0.0, options.seed, time.process_time()
    while sums["judged"] < wanted and time.monotonic() < last:
        row = case(seed, options.plant)
        seed += 1
        if "refused" in row:
            refused[row["refused"][:150]] += 1
            continue
        for each in row["rows"]:
            sums["judged"] += 1
            sums["hidden"] += row["hidden"]
            sums["lit"] += each["truth"] > 0
            sums["sharp"] += each["stated"] < 1e-6 * each["truth"]
            sums["beyond"] += each["beyond"]
            ratio = each["off"] / max(each["stated"], DARK * row["radiance"])
            worst = max(worst, ratio)
            bands.setdefault(int(np.floor(np.log10(row["ratio"]))), []).append(ratio)
            if each["beyond"]:
                lamp = "half hidden by a ball" if row["hidden"] else "alone"
                report.say(
                    f"seed {row['seed']}, ray {each['ray']}: radius over distance {row['ratio']:.2g}, {lamp}: "
                    f"{each['value']:.15g} stated {each['stated']:.2g} (status {each['status']}), judge "
                    f"{each['truth']:.15g}: off by {each['off']:.2g}, ratio {ratio:.3g}"
                )
                if options.write:
                    said = each | {"seed": row["seed"], "scene": row["scene"]} | {
                        name: row[name + "s"][each["ray"]].tolist() for name in ("origin", "direction")
                    }  # fmt: skip
                    with options.write.open("a", encoding="utf-8") as file:
                        file.write(json.dumps(said) + "\n")
    for text, count in refused.items():
        report.say(f"refused {count} times: {text}")
    report.table(
        ("radius over distance from", "values", "largest error over what is stated"),
        [[f"1e{band}", len(held), max(held)] for band, held in sorted(bands.items())],
    )
    report.say(
        f"{sums['judged']} values, seeds {options.seed} to {seed - 1}, {sums['hidden']} with a ball before the lamp, "
        f"{sum(refused.values())} scenes refused; {sums['lit']} lit, {sums['sharp']} stated to 1e-6 of themselves; "
        f"worst ratio {worst:.3g}; {1e3 * (time.process_time() - begun) / max(1, sums['judged']):.3g} ms each"
    )
    report.claim_number("values beyond 1.5 times what they state", sums["beyond"], 0)
    report.claim_number("share of values that are dark", 1.0 - sums["lit"] / max(1, sums["judged"]), 0.2)
    report.leave()


if __name__ == "__main__":
    sys.exit(main())
