"""Numbers to ask leaves at: as the formulas' arguments mean them, by their names."""

from __future__ import annotations

import numpy as np

from symrender.expression.leaf import Leaf

UNIT = {"normal", "view", "direction", "axis", "incoming", "horizon", "toward"}
RANGES = {
    "shininess": (0.5, 60.0),
    "exponent": (0.5, 400.0),
    "square": (0.0, 0.5),
    "log_normaliser": (-3.0, 1.0),
    "log_cosine": (-0.02, -0.0005),
    "log_low": (-0.02, -0.001),
    "log_high": (-0.09, -0.03),
    "depth": (0.0, 0.3),
    "theta_max": (0.1, 1.5),
    "cosine": (0.2, 0.9),
    "ratio": (0.1, 0.9),
    "radius": (0.2, 0.9),
    "height": (0.5, 2.0),
    "x": (0.1, 1.3),
    "ku": (1.0, 9.0),
    "kv": (1.0, 9.0),
    "cell": (0.2, 2.0),
    "sine2": (0.05, 0.6),
    "rim_cosine": (0.0, 0.9),
    "number": (0.0, 5.0),
    "far": (0.5, 5.0),
    "beam": (5.0, 30.0),
    "cutoff": (60.0, 120.0),
}


def unit(v: np.ndarray) -> np.ndarray:
    return v / np.linalg.norm(v)


def sample(leaf: Leaf, rng: np.random.Generator) -> list[float]:
    """The scalars of one set of arguments."""
    turn = rng.uniform(0.0, 2.0 * np.pi)
    pole = unit(rng.normal(size=3))
    first = unit(np.cross(pole, rng.normal(size=3)))
    second = np.cross(pole, first)
    angle = rng.uniform(0.1, 1.4)
    known = {
        "pole": pole,
        "first": first,
        "second": second,
        "across": np.cos(turn) * first + np.sin(turn) * second,
        "sine": np.sin(angle),
        "c": np.cos(turn),
        "s": np.sin(turn),
        "light": rng.normal(size=3) + np.array([0.0, 0.0, 4.0]),
        "center": rng.normal(size=3) + np.array([0.0, 0.0, 1.0]),
        "point": rng.normal(size=3) - np.array([0.0, 3.0, -4.0]),
        "up": np.array([0.0, 1.0, 0.0]),
    }
    if leaf.name.endswith("_place"):
        known["cosine"] = np.cos(angle)
    if (
        leaf.name in ("blinn_term", "phong_term", "blinn_square", "blinn", "phong")
        or "edge" in leaf.name
        or "_nodes" in leaf.name
        or leaf.name in ("lit_phong", "lit_conductor", "lit_beckmann")
    ):
        # the view is near the mirror image of the light, so that there is a highlight
        normal = unit(rng.normal(size=3))
        to_light = unit(normal + 0.3 * rng.normal(size=3)) * rng.uniform(0.5, 4.0)
        mirrored = 2.0 * (normal @ to_light) * normal - to_light
        known |= {"normal": normal, "to_light": to_light, "view": unit(unit(mirrored) + 0.2 * rng.normal(size=3))}
        known |= {"place": known["center"], "light": known["center"] + to_light}
    if leaf.name in ("ggx_lobe", "beckmann_lobe"):
        # a difference of unit vectors is no shorter than its part along the normal
        known["along"] = rng.uniform(-0.9, 0.9) * 0.1
        known["square"] = rng.uniform(0.1, 1.0)
    if leaf.name == "sphere_hit":
        offset = rng.normal(size=3) * 3.0 + 3.0
        known |= {"offset": offset, "direction": unit(unit(offset) + 0.03 * rng.normal(size=3)), "radius": 0.8}
    numbers: list[float] = []
    for argument in leaf.arguments:
        if argument in known:
            value = known[argument]
        elif leaf.is_vector(argument):
            value = rng.normal(size=3)
            value = unit(value) if argument in UNIT else value
        else:
            value = rng.uniform(*RANGES.get(argument, (0.1, 1.0)))
        numbers += [float(x) for x in np.atleast_1d(value)]
    return numbers
