"""No light gathered between flat faces is beyond what it states.

    python benchmarks/gathered_light_is_stated.py [--quick] [--crowded | --disks] [SEED [COUNT]]

Scenes are the hostile rooms of ``tests/radiosity/rooms.py``: walls, blocks and partitions that touch, thin boxes,
needles, gaps of 1e-2 to 1e-6, shapes that cross walls, both sides, sizes 1e-4 to 1e3, under a point light. Those of
``--crowded`` hold meshes with dents and folds, open and turned over, squares and stripes, under a point, a spot, a lamp
or a sky that comes in where a wall is missing. Those of ``--disks`` hold disks, large and tiny, a little over walls and
through them, under all kinds of lights, disks too. The judge is
a mean over shifted lattices of rays of the numeric pipeline. What looks beyond is judged again by thirty-two times as
many rays.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from measure import Report

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from tests.radiosity.rooms import crowded, hostile, reflected_once, with_disks

import symrender as sr
from symrender.errors import Unsupported
from symrender.radiometric.world import make_world
from symrender.runtimes.radiosity import met
from symrender.scene.radiometric.arrays import radiometric_arrays

COUNT, QUICK, PLACES = 200, 6, 5
RAYS, AGAIN = 4000, 32
SURE, LOOSEST = 6.0, 1.5
TOLERANCES = (1e-2, 2e-3, 5e-4)
SCALES = (1.0, 1e-4, 1e3, 1e-2)


def main() -> None:
    numbers = [int(word) for word in sys.argv[1:] if not word.startswith("-")]
    first = numbers[0] if numbers else 0
    count = numbers[1] if len(numbers) > 1 else (QUICK if "--quick" in sys.argv else COUNT)
    make = crowded if "--crowded" in sys.argv else with_disks if "--disks" in sys.argv else hostile
    report = Report("gathered_light_is_stated", "No light gathered between flat faces is beyond what it states.")
    judged = lit = kept = refused = 0
    beyond: list[str] = []
    for seed in range(first, first + count):
        scale, tol = SCALES[seed // 4 % len(SCALES)], TOLERANCES[seed % len(TOLERANCES)]
        scene = make(seed, scale)
        rng = np.random.default_rng([seed, 1])
        origins = scale * rng.uniform(0.2, 0.8, (PLACES, 3))
        directions = rng.normal(size=(PLACES, 3))
        directions /= np.linalg.norm(directions, axis=1, keepdims=True)
        try:
            seen = sr.probe(scene, rays=(origins, directions), tol=tol)
        except Unsupported:
            refused += 1
            continue
        small = make_world(radiometric_arrays(sr.load(scene)))
        at, albedo = met(small, origins, directions)
        for i in np.flatnonzero(albedo.max(axis=1) > 0.0).tolist():
            normal = np.array(small.pieces[int(at.own[i])].up) * (1.0 if at.front[i] else -1.0)
            for rays in (RAYS, AGAIN * RAYS):
                mean, wide = reflected_once(scene, at.place[i], normal, rays, seed)
                off = np.abs(albedo[i] * mean - seen.indirect[i])
                fine = bool((off <= LOOSEST * seen.error[i] + SURE * albedo[i] * wide + 1e-12).all())
                if fine:
                    break
            judged, lit = judged + 1, lit + int(seen.indirect[i].max() > 10 * seen.error[i])
            kept += int(seen.status[i] == 0)
            if not fine:
                beyond.append(f"seed {seed} place {i}: off {off.max():.3g}, stated {seen.error[i]:.3g}")
    report.say(f"{judged} places, {lit} of them lit, {kept} met their tolerance; {refused} scenes refused.")
    for line in beyond:
        report.say(line)
    report.claim_number(f"places more than {LOOSEST:g} times beyond", len(beyond), 0)
    report.claim_number("places, of a hundred, too dark to tell", 100.0 * (judged - lit) / max(judged, 1), 70.0)
    report.leave()


if __name__ == "__main__":
    main()
