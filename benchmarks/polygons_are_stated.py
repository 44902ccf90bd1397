"""No value of the sky or of a lamp among flat shapes lies beyond one and a half times the error stated.

Shapes touch, lie in one plane, share edges and corners, needles among them; places lie in planes of lamps and of what
hides them, and within 1e-9 of edges; scales go from 1e-4 to 1e3. The judge integrates by meridians
(``tests/radiometric/meridians.py``) and shares nothing with the package; it states its own error.

    python benchmarks/polygons_are_stated.py [FIRST [COUNT]]
"""

from __future__ import annotations

import math
import sys
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from tests.radiometric import flats, meridians

import symrender as sr
from symrender.errors import Unsupported

JUDGE = 1e-9
"""What is allowed the judge beyond the difference of its last two sums."""
LIFT = 1e-7
"""Height of where rays begin, in parts of the place's largest coordinate."""


def is_covered(scene: dict[str, Any], place: np.ndarray, normal: np.ndarray, lamp: str | None, lift: float) -> bool:
    """Whether a face of the lamp lies on the place, but for roundings, so that the ray begins behind it.

    Such a ray meets the face from behind or a place behind the face, and both are dark; the judge, who asks of the
    place alone, sees all of the face or nothing of it, as rounding decides.
    """
    shapes = [shape for shape in scene["shapes"] if shape["name"] == lamp]
    pieces = [piece for shape in shapes for piece in meridians.pieces_of(shape, place + lift * normal)]
    met = [float(piece.hit(-normal[None])[0]) for piece in pieces if piece.kind == "polygon"]
    return any(abs(far - lift) < 1e-5 * lift for far in met)


def main() -> int:
    """Print what was judged, and every value beyond; 1 where there is one."""
    first, count = (*(int(x) for x in sys.argv[1:3]), *(0, 2000)[len(sys.argv) - 1 :])
    judged = lit = met = refused = hidden = covered = 0
    beyond: list[int] = []
    for seed in range(first, first + count):
        scene, own, place, normal, lamp = flats.contact(seed)
        size = max(abs(place).max(), 1e-4)
        if is_covered(scene, place, normal, lamp, LIFT * size):
            covered += 1
            continue
        try:
            found = sr.probe(scene, rays=(place + LIFT * size * normal, -normal), tol=1e-6)
        except Unsupported:
            refused += 1
            continue
        if found.shape[0] != f"shapes.{own}":
            hidden += 1
            continue
        true, known = (x / math.pi for x in meridians.irradiance(scene["shapes"], own, place, normal, lamp))
        off = abs(float(found.direct[0, 0]) - true)
        judged, lit, met = judged + 1, lit + (true > 1e-6), met + int(found.status[0] == 0)
        if off > 1.5 * float(found.error[0]) + known + JUDGE:
            beyond.append(seed)
            print(f"seed {seed}: {found.direct[0, 0]:.12g} is {true:.12g}, stated {found.error[0]:.2g}", flush=True)
    print(f"{judged} values judged, {lit} lit, {met} met 1e-6")
    print(f"{refused} refused, {hidden} places hidden, {covered} under a face of the lamp")
    print(f"{len(beyond)} beyond")
    return int(bool(beyond) or lit < judged // 4)


if __name__ == "__main__":
    sys.exit(main())
