"""Images against points: a pixel is what ``probe`` says of the place it sees, whatever tiles and threads made it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from .direct import ray
from .families import FAMILIES, generate
from .light import nearest, outward_normal
from .world import world_of

KINDS = tuple(family for family in FAMILIES if family not in ("budget", "crowd"))
SIZE = (5, 4)


@dataclass
class Count:
    """Pixels compared with a probe, those with a reflection, images made, those refused."""

    pixels: int = 0
    signal: int = 0
    images: int = 0
    refused: int = 0


def judge_image(seed: int, count: Count) -> list[str]:
    """What is wrong with the images of scene ``seed``, in words."""
    import symrender as sr
    from symrender.errors import SymrenderError

    case = generate(KINDS[seed % len(KINDS)], 700_000 + seed)
    asked: dict[str, Any] = {"size": SIZE, "tol": max(case.tol, 1e-5), "disk": case.disk, "budget": 40_000}
    try:
        images = [sr.truth(case.scene, threads=t, tile=n, **asked) for t, n in ((1, 0), (1, 1), (2, 3), (2, 2), (1, 7))]
    except SymrenderError:
        count.refused += 1
        return []
    first, wrong = images[0], []
    for other in images[1:]:
        if any(first.layers[n].tobytes() != other.layers[n].tobytes() for n in first.layers):
            wrong.append(f"{case.name}: bytes depend on tiles or threads")
    count.images += len(images)
    for name in ("error", "radiance", "gloss", "direct"):
        layer, status = first.layers[name], first.layers["status"]
        least = 0.0 if name == "error" else -first.layers["error"][status == 0].max(initial=0.0)
        if np.isnan(layer).any() or (layer[status == 0] < least).any() or not np.isfinite(layer[status == 0]).all():
            wrong.append(f"{case.name}: {name} is negative or no number where the tolerance was met")
    if (first.layers["error"][first.layers["status"] == 0] > asked["tol"]).any():
        wrong.append(f"{case.name}: met with an error beyond the tolerance")
    world, eye = world_of(case.scene, "1x1"), np.array(case.scene["camera"]["eye"], float)
    for j in range(SIZE[1]):
        for i in range(SIZE[0]):
            if first.layers["status"][j, i] == 3:
                continue
            d = ray(case.scene, i, j, *SIZE)
            shape, inside, t = nearest(world, -1, tuple(eye.tolist()), tuple(d.tolist()))
            if int(first.layers["hit_class"][j, i]) != 1 + shape:
                # equal spheres are one: the last is seen, the first is named
                wrong.append(f"{case.name}: pixel {i, j} sees another shape")
                continue
            if shape < 0 or inside or (shape == 0 and d[2] >= 0.0):
                continue
            surface, point = "floor", [*(eye + t * d)[:2], 0.0]
            if shape > 0:
                surface = f"spheres.{case.scene['spheres'][shape - 1]['name']}"
                point = list(outward_normal(world.spheres, shape - 1, tuple(eye.tolist()), tuple(d.tolist()), inside))
            try:
                found = sr.probe(
                    case.scene, [point], surface=surface, tol=asked["tol"], disk=case.disk, budget=40_000, threads=1
                )
            except SymrenderError:
                continue
            if found.status[0] == 3:
                continue
            count.pixels += 1
            gloss, said = first.layers["gloss"][j, i], first.layers["error"][j, i] + found.error[0]
            count.signal += bool(gloss.max() > 0.0)
            # the place is the same to rounding, which grazing views and high powers of cosines stretch
            if np.abs(gloss - found.gloss[0]).max() > said + 1e-7 * (1e-3 + np.abs(gloss).max()):
                wrong.append(f"{case.name}: pixel {i, j} {gloss} is no {found.gloss[0]} +- {said:.3g}")
    return wrong
