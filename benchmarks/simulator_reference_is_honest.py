"""The simulator's reference states an error that holds: random points of the gallery and of random scenes.

The page splits each lobe along its walls in JavaScript and states an error; the split rule of ``symrender.probe``, at
a tolerance a thousand times tighter, is the judge. Points, scenes and seeds are none the page was tuned on.

    python benchmarks/simulator_reference_is_honest.py [--quick] [FIRST]
"""

from __future__ import annotations

import random
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from measure import Report
from playwright.sync_api import sync_playwright

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from tests.conftest import CHROMIUM, FLAGS
from tests.simulator.conftest import Page

from symrender.probe import probe
from symrender.scene import gallery
from symrender.scene.load import load
from symrender.scene.scene import Scene
from symrender.simulator.build import simulator
from symrender.simulator.state import State, to_fragment

A_SCENE, RANDOM_SCENES, BUDGET, SIZE = 16, 20, 20_000, 96
POINTS = """([pixels, budget]) => {
  const {app, lookAt, surfaceLobe, reference} = simulator, n = app.frame.size, t = app.frame.tables, out = [];
  for (const [x, y] of pixels) {
    const seen = lookAt(t, Math.floor(x * n), Math.floor(y * n));
    if (seen.shape === 0 || surfaceLobe(t, seen.shape - 1).weight === 0) continue;
    out.push({...seen, ...reference(t, seen, 1e-5, budget)});
  }
  return out;
}"""


def random_scene(rng: random.Random) -> Scene:
    """The default scene with other places, sizes, lobes and lights."""
    values: dict[str, Any] = {
        "floor.lobe.exponent": 10 ** rng.uniform(0, 3),
        "floor.lobe.theta_max": rng.uniform(0.15, 1.4),
        "lights.key.radius": rng.uniform(0.1, 1.8),
        "lights.key.position.z": rng.uniform(1.5, 8),
    }
    for name in "ABC":
        values[f"spheres.{name}.lobe.exponent"] = 10 ** rng.uniform(0, 3)
        values[f"spheres.{name}.center.x"] = rng.uniform(-1.8, 1.8)
        values[f"spheres.{name}.center.y"] = rng.uniform(-1.2, 1.8)
        values[f"spheres.{name}.radius"] = rng.uniform(0.2, 0.7)
        values[f"spheres.{name}.center.z"] = rng.uniform(0.7, 1.3)
    return load("gloss").replace(values)


def judged(scene: Scene, point: dict[str, Any]) -> tuple[float, float, float]:
    """True error, stated error and signal of one point."""
    floor = point["shape"] == 1
    surface = "floor" if floor else f"spheres.{scene.spheres[int(point['shape']) - 2].name}"
    exact = probe(scene, [point["q"] if floor else point["n"]], surface=surface, tol=1e-7)
    off = float(np.abs(exact.gloss[0] - point["value"]).max())
    return max(0.0, off - float(exact.error[0])), point["error"], float(exact.gloss.max())


def main() -> None:
    words = [word for word in sys.argv[1:] if word != "--quick"]
    first = int(words[0]) if words else 0
    quick = "--quick" in sys.argv
    scenes = [(name, load(name)) for name in gallery.names()][: 2 if quick else None]
    scenes += [
        (f"random {first + k}", random_scene(random.Random(first + k))) for k in range(2 if quick else RANDOM_SCENES)
    ]
    report = Report(
        "simulator_reference_is_honest", "The page's true error is within the stated one for at least 99.5 % of points."
    )
    rows: list[tuple[float, float, float]] = []
    dishonest: list[list[object]] = []
    with sync_playwright() as playwright, tempfile.TemporaryDirectory() as folder:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        for name, scene in scenes:
            file = Path(folder) / "page.html"
            simulator(scene, file)
            page = Page(browser.new_page())
            page.page.goto(f"{file.as_uri()}{to_fragment(State(size=16))}")
            page.settle()
            page.change(f"s.size = {SIZE}; s.view = 'direct'")
            rng = random.Random(f"{name} {first}")
            pixels = [[rng.random(), rng.random()] for _ in range(A_SCENE)]
            for point in page.run(POINTS, [pixels, BUDGET]):
                rows.append(judged(scene, point))
                if rows[-1][0] > rows[-1][1]:
                    dishonest.append([name, int(point["shape"]), rows[-1][1], rows[-1][0]])
            page.page.close()
        browser.close()
    signal = sum(row[2] > 1e-3 for row in rows)
    met = sum(row[1] <= 1e-5 for row in rows)
    report.say(
        f"{len(rows)} points of {len(scenes)} scenes, {signal} brighter than 1e-3, {met} met 1e-5 within {BUDGET} "
        f"directions; median stated error {np.median([row[1] for row in rows]):.1e}."
    )
    if dishonest:
        report.table(["scene", "shape", "stated", "true"], dishonest)
    report.claim_number("points missing from 200", max(0, 200 - len(rows)), 200 if quick else 0)
    report.claim_number("true error beyond the stated one, per point", len(dishonest) / len(rows), 5e-3)
    report.leave()


if __name__ == "__main__":
    main()
