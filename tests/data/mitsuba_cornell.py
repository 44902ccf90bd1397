"""Records what Mitsuba 3.9.1 makes of the Cornell box along single rays: ``mitsuba_cornell.json``.

    PYTHONPATH=src:. python tests/data/mitsuba_cornell.py write WORK
    DRJIT_LIBLLVM_PATH=... python tests/data/mitsuba_cornell.py trace WORK tests/data/mitsuba_cornell.json

As ``mitsuba_flats.py``, whose program traces. The box with all bounces, the same with a black ball in place of its
short block, and one bounce over a ball of rough gold, whose reflections see no gloss, so that the gloss of the first
hit is all there is. Scenes are exported at scale 100 about the place that a ray meets.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import numpy as np
from mitsuba_flats import digest, exports, trace

EYE = np.array([0.0, -0.8, 0.273])
GOLD = {"type": "conductor", "alpha": 0.25, "eta": [0.16, 0.42, 1.47], "k": [3.9, 2.4, 1.6]}
BALL = {"type": "sphere", "name": "short", "center": [0.0925, 0.169, 0.0925], "radius": 0.0925}
AIMS = {
    "all": [
        (-0.2, 0.2, 0.0), (0.05, 0.05, 0.0), (0.24, 0.45, 0.0), (-0.1, 0.3, 0.5488), (0.2, 0.1, 0.5488),
        (-0.278, 0.3, 0.1), (-0.278, 0.1, 0.45), (0.278, 0.25, 0.2), (0.278, 0.5, 0.4), (0.1, 0.5592, 0.3),
        (-0.2, 0.5592, 0.45), (-0.08, 0.27, 0.15), (0.1, 0.1, 0.08), (0.09, 0.17, 0.165),
    ],
    "ball": [(0.02, 0.08, 0.0), (0.22, 0.2, 0.0), (0.278, 0.2, 0.1), (0.15, 0.5592, 0.2), (-0.02, 0.28, 0.05),
             (0.0, 0.1, 0.5488)],
    "gold": [(0.09, 0.08, 0.09), (0.05, 0.09, 0.13), (0.13, 0.09, 0.15), (0.03, 0.1, 0.06), (0.14, 0.09, 0.05),
             (0.1, 0.1, 0.03)],
}  # fmt: skip


def rows() -> list[dict[str, Any]]:
    """A row a ray."""
    import symrender as sr
    from symrender.numeric.radiometric.hits import first_hit
    from symrender.numeric.radiometric.world import make_world
    from symrender.scene.radiometric.arrays import radiometric_arrays

    found = []
    for kind, aims in AIMS.items():
        scene = sr.load("cornell").model_dump(mode="json")
        scene["name"], scene["bounces"] = f"cornell {kind}", 1 if kind == "gold" else "all"
        if kind != "all":
            scene["materials"]["other"] = GOLD if kind == "gold" else {"type": "diffuse", "reflectance": 0}
            scene["shapes"][5] = BALL | {"material": "other"}
        world = make_world(radiometric_arrays(sr.load(scene)))
        for aim in aims:
            way = np.array(aim) - EYE
            way /= np.linalg.norm(way)
            hit = first_hit(world, tuple(EYE.tolist()), tuple(way.tolist()), -1, False)
            place = EYE + way * hit.distance
            found.append({"scene": scene, "origin": EYE.tolist(), "direction": way.tolist(), "place": place.tolist()})
    return found


def write(work: Path) -> None:
    work.mkdir(parents=True, exist_ok=True)
    done = [row | {"made": (made := exports(row)), "sha256": digest(made["files"])} for row in rows()]
    (work / "rows.json").write_text(json.dumps(done))


def main() -> None:
    if sys.argv[1] == "write":
        write(Path(sys.argv[2]))
    else:
        trace(Path(sys.argv[2]), Path(sys.argv[3]))


if __name__ == "__main__":
    main()
