"""No value of the sky or of a lamp among disks and balls lies beyond one and a half times the error stated.

Rims touch, coincide, lie on balls, in each other's plane and in each other's outline; balls stand on disks; scales are
1e-4, 1 and 1e3 (``tests/radiometric/rounds.py``). The judge integrates by meridians
(``tests/radiometric/meridians.py``) and shares nothing with the package; it states its own error.

    python benchmarks/disks_among_round_shapes_are_stated.py [FIRST [COUNT]]
"""

from __future__ import annotations

import math
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from tests.radiometric import meridians, rounds

import symrender as sr
from symrender.errors import Unsupported

JUDGE = 1e-9
"""What is allowed the judge beyond the difference of its last two sums."""
UP = np.array([0.0, 0.0, 1.0])


def main() -> int:
    """Print what was judged, and every value beyond; 1 where there is one."""
    first, count = (*(int(x) for x in sys.argv[1:3]), *(0, 400)[len(sys.argv) - 1 :])
    judged = lit = met = refused = hidden = 0
    worst = 0.0
    beyond: list[int] = []
    for seed in range(first, first + count):
        scene, place, lamp = rounds.scene(seed)
        try:
            found = sr.probe(scene, rays=(place + 1e-7 * abs(place[2]) * UP, -UP), tol=1e-6)
        except Unsupported:
            refused += 1
            continue
        if found.shape[0] != "shapes.floor":
            hidden += 1
            continue
        true, known = (x / math.pi for x in meridians.irradiance(scene["shapes"], "floor", place, UP, lamp))
        off = abs(float(found.direct[0, 0]) - true)
        judged, lit, met = judged + 1, lit + (true > 1e-6), met + int(found.status[0] == 0)
        if found.status[0] == 0 and known < 1e-9:
            worst = max(worst, off)
        if off > 1.5 * float(found.error[0]) + known + JUDGE:
            beyond.append(seed)
            print(f"seed {seed}: {found.direct[0, 0]:.12g} is {true:.12g} +- {known:.2g}, stated {found.error[0]:.2g}")
    print(f"{judged} values judged, {lit} lit, {met} met 1e-6, {refused} refused, {hidden} places hidden")
    print(f"{len(beyond)} beyond; of those met, where the judge is sure, the largest difference is {worst:.2g}")
    return int(bool(beyond) or lit < judged // 4)


if __name__ == "__main__":
    sys.exit(main())
