"""A derived kernel keeps up with C written by hand for this one scene.

PEERS is a folder with ``lobe.c``; it is compiled into a temporary folder with gcc, all optimisations and fast-math.
The job is the lobe term of ``chapter8`` on its floor pixels, 16 x 16 strata, one thread, double precision.
"""

from __future__ import annotations

import json
import subprocess
import tempfile
from pathlib import Path

import numpy as np
from lobe_term import floor_pixels, picture
from measure import Report, arguments, cpu_seconds, median

FLAGS = ("-O3", "-march=native", "-ffast-math", "-fopenmp")
K = 16


def main() -> None:
    options = arguments(__doc__, "peers")
    width, rounds = (64, 3) if options.quick else (256, 9)
    report = Report(
        "kernel_keeps_up_with_c", f"Lobe term of chapter8, {width} x {width}, {K} x {K} strata, one thread."
    )
    with tempfile.TemporaryDirectory() as folder:
        program, out = Path(folder, "lobe"), Path(folder, "out.bin")
        subprocess.run(["gcc", *FLAGS, str(options.peers / "lobe.c"), "-o", str(program), "-lm"], check=True)

        def rival() -> dict[str, float]:
            words = (str(program), str(width), "16", "2x2", "strata-alg", str(K), "1", "1", str(out))
            return json.loads(subprocess.run(words, check=True, capture_output=True, text=True).stdout)

        lit_work, layers = picture(width, K)
        dark_work, _ = picture(width, K, floor_weight=0.0)
        first, evaluations = rival(), lit_work()
        dark_work()
        floor = floor_pixels(layers)
        theirs = np.fromfile(out).reshape(width, width, 3)
        ours_s, whole_s, theirs_s = [], [], []
        for _ in range(rounds):
            lit = cpu_seconds(lit_work)
            theirs_s.append(rival()["cpu_s"])
            whole_s.append(lit)
            ours_s.append(lit - cpu_seconds(dark_work))
    assert first["floor_px"] == floor.sum() and first["evals"] == evaluations, "not the same job"
    signal = float(np.sqrt((theirs[floor] ** 2).mean()))
    gap = float(np.abs(layers["gloss"] - theirs)[floor].max()) / signal
    ns = [1e9 * median(s) / evaluations for s in (ours_s, whole_s, theirs_s)]
    report.table(
        ("program", "floor pixels", "directions", "CPU s", "ns a direction"),
        [
            ("symrender, lobe term", int(floor.sum()), evaluations, median(ours_s), ns[0]),
            ("symrender, whole picture", int(floor.sum()), evaluations, median(whole_s), ns[1]),
            ("C by hand, lobe term", int(floor.sum()), evaluations, median(theirs_s), ns[2]),
        ],
    )
    report.say("C: gcc " + " ".join(FLAGS) + "; symrender: strict arithmetic, any scene.")
    report.claim_number("largest difference over the RMS of the lobe term (fast-math)", gap, 1e-11)
    report.claim_time("ours over C, a direction", ns[0] / ns[2], 0, 1.5)
    report.leave()


if __name__ == "__main__":
    main()
