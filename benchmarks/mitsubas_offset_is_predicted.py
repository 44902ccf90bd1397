"""Mitsuba's bounced light differs from the truth by what its ray offset predicts.

    python benchmarks/mitsubas_offset_is_predicted.py

Secondary rays of Mitsuba 3.9.1 start (1 + max |p|) 8.94e-5 above a surface. Of 36 rays, each with 2.2e7 samples, what
one bounce adds was recorded in the scene as it stands less what it adds in the scene scaled by 100 about the place,
with the same random numbers (``tests/data/mitsuba_rays.py``). The prediction is the truth at the place raised by the
offset, less that of the scaled scene.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from measure import Report

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))


def main() -> None:
    from tests.radiometric.ray_offsets import moved, recorded

    report = Report("mitsubas_offset_is_predicted", "Mitsuba's bounced light is off by what its ray offset predicts.")
    found = [moved(ray) for ray in recorded()]
    report.say("Of the first channel: bounced light, what the offset adds to it, in parts of it, and z of all three.")
    report.table(
        ["ray", "bounced", "predicted", "found", "standard error", "z"],
        [
            [each.name, f"{each.light[0]:.6g}", f"{each.predicted[0] / each.light[0]:+.2e}",
             f"{each.found[0] / each.light[0]:+.2e}", f"{each.error[0] / each.light[0]:.1e}",
             " ".join(f"{z:+.1f}" for z in each.z)]
            for each in found
        ],
    )  # fmt: skip
    z = np.array([each.z for each in found])
    without = np.array([each.found / each.error for each in found])
    loud = int((np.abs(without) > 4.0).any(axis=1).sum())
    report.say(
        f"Without the prediction the largest |z| is {np.abs(without).max():.1f}, and {loud} rays of {len(found)} are "
        f"more than 4 standard errors off; with it the spread of z is {z.std():.2f}."
    )
    report.claim_number("largest |z|", float(np.abs(z).max()), 3.5)
    report.leave()


if __name__ == "__main__":
    main()
