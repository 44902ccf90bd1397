"""Starved rules: most of whose directions fall where the lobe carries no weight."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Sequence
from itertools import pairwise
from typing import Any, Final

from symrender.images.image import Image

SHARE: Final = 0.99
"""The rings that carry this share of the lobe's weight are said to carry it."""


def carrying_rings(exponent: float, theta_max: float, k: int, partition: str) -> int:
    """The fewest of the ``k`` rings that carry ``SHARE`` of the weight of the lobe cos^n on a cone, angles in radians.

    The weight within angle t of the axis is 1 - cos^(n+1) t, up to a factor. Rings of equal weight all carry it.
    """
    if partition == "equal_weight" or theta_max == 0:
        return k
    edges = [theta_max * i / k for i in range(k + 1)]
    if partition == "equal_solid_angle":
        edges = [2 * math.asin(math.sqrt(i / k) * math.sin(theta_max / 2)) for i in range(k + 1)]
    inside = [-math.expm1((exponent + 1) * math.log1p(-2 * math.sin(t / 2) ** 2)) for t in edges]
    shares = sorted((b - a for a, b in pairwise(inside)), reverse=True)
    total, count = 0.0, 0
    while count < k and total < SHARE * inside[-1]:
        total += shares[count]
        count += 1
    return count


def starvation(
    numeric: Image | None, symbolic: Image | None, lobes: Iterable[tuple[str, float, float]]
) -> tuple[str, ...]:
    """One sentence for each pipeline of whose rings no more than half carry weight on some surface, with the remedy.

    ``lobes`` lists (surface, exponent, theta_max in radians); what each image was made by is read from its metadata.
    """
    listed = list(lobes)
    notes = []
    for side, image, remedy in (
        ("numeric", numeric, "--numeric importance"),
        ("symbolic", symbolic, "--partition equal_weight --nodes barycentre"),
    ):
        settings = _settings(image)
        partition = _partition(side, settings)
        if partition is None:
            continue
        k = int(settings["lobe"])
        notes += _told(side, remedy, k, [(n, carrying_rings(e, t, k, partition)) for n, e, t in listed])
    return tuple(notes)


def _told(side: str, remedy: str, k: int, counts: Sequence[tuple[str, int]]) -> list[str]:
    starved = {count: [name for name, c in counts if c == count] for _, count in counts if 2 * count <= k}
    return [
        f"{side}, {', '.join(names)}: {count} of {k} rings {'carries' if count == 1 else 'carry'} "
        f"{SHARE:.0%} of the lobe's weight; try {remedy}"
        for count, names in sorted(starved.items())
    ]


def _settings(image: Image | None) -> dict[str, Any]:
    try:
        found = json.loads(image.meta.get("settings", "{}")) if image is not None else {}
    except ValueError:
        found = {}
    return found if isinstance(found, dict) and type(found.get("lobe")) is int else {}


def _partition(side: str, settings: dict[str, Any]) -> str | None:
    """How the rings are cut, None where they follow the weight or there are none."""
    if side == "numeric":
        return "equal_solid_angle" if settings.get("numeric") in ("jittered", "independent") else None
    if settings.get("symbolic") != "strata" or settings.get("nodes") == "gauss":
        return None
    partition = str(settings.get("partition"))
    return None if partition == "equal_weight" else partition
