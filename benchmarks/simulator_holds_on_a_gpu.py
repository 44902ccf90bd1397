"""The simulator's shaders, on a real GPU, draw what its JavaScript computes in double precision.

Tests hold the panels to it by a software driver, where roundings are a processor's. Here a browser writes what the
panels are drawn from, and what double precision says, and a machine with a GPU, without a browser, draws them:

    python benchmarks/simulator_holds_on_a_gpu.py --look FOLDER
    python benchmarks/simulator_holds_on_a_gpu.py FOLDER

The first needs Chromium and Playwright, as the tests do; the second NumPy, moderngl and a driver with EGL whose OpenGL
takes the shaders of OpenGL ES 3, which are WebGL 2's. A pixel is on a wall as in the tests: its estimate changes where
its ray moves by a few 1e-6.
"""

from __future__ import annotations

import json
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

SIZE, FRAMES = 48, 20
PASSES = ("pixel_direct", "pixel_symbolic", "pixel_numeric")
FLOAT32 = 2e-5
"""What single precision may be off, of linear radiance."""
MOST_ON_WALLS = 0.01
LOOK = """() => {
  const {app, data, directExact, glossExact, onWall} = simulator, f = app.frame, n = f.size, t = f.tables;
  const out = {size: n, rows: {}, tables: {}, exact: {}, walls: {}};
  for (const name of ["spheres", "planes", "points"]) out.rows[name] = t[name].length / data.tables[name].columns;
  for (const name of Object.values(data.blocks).flat()) out.tables[name] = Array.from(t[name]);
  const seen = app.gpu.images.get("seen");
  out.seen = {width: seen.width, height: seen.height, values: Array.from(seen.values)};
  for (const pass of ["pixel_direct", "pixel_symbolic", "pixel_numeric"]) {
    const exact = [], walls = [];
    for (let r = 0; r < n; r++) for (let c = 0; c < n; c++) {
      exact.push(...(pass === "pixel_direct" ? directExact(t, c, r) : glossExact(pass, t, c, r)));
      walls.push(pass === "pixel_direct" ? 0 : +onWall(pass, t, c, r));
    }
    out.exact[pass] = exact, out.walls[pass] = walls;
  }
  return out;
}"""
DATA = """() => {
  const {data} = simulator, shaders = {};
  for (const pass of ["pixel_direct", "pixel_symbolic", "pixel_numeric"]) shaders[pass] = data.shaders[pass];
  return {vertex: data.vertex, shaders, blocks: data.blocks, layouts: data.tables};
}"""


def look(folder: Path) -> None:
    """Write what the pages of the gallery's scenes draw, one file each."""
    from playwright.sync_api import sync_playwright

    sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
    from tests.conftest import CHROMIUM, FLAGS
    from tests.simulator.conftest import Page

    from symrender.scene import gallery
    from symrender.simulator.build import simulator
    from symrender.simulator.state import State, to_fragment

    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as name, sync_playwright() as play:
        browser = play.chromium.launch(executable_path=CHROMIUM, args=list(FLAGS))
        for scene in gallery.names():
            path = Path(name) / f"{scene}.html"
            simulator(scene, path)
            page = browser.new_page()
            page.goto(f"{path.as_uri()}{to_fragment(State(size=SIZE))}")
            opened = Page(page)
            opened.settle()
            found = opened.run(DATA) | opened.run(LOOK)
            (folder / f"{scene}.json").write_text(json.dumps(found), "utf-8")
            print(f"{scene}: {SIZE} x {SIZE} pixels", flush=True)
            page.close()
        browser.close()


def padded(values: list[float], columns: int, rows: int) -> np.ndarray:
    """A table as rows of vec4, padded to its most rows, flat."""
    whole = np.zeros((rows, 4 * -(-columns // 4)), np.float32)
    given = np.array(values, np.float64).reshape(-1, columns)
    with np.errstate(over="ignore"):
        # what never ends is infinite on a GPU
        whole[: len(given), :columns] = given
    return whole.ravel()


class Panel:
    """A pass of a scene on a GPU."""

    def __init__(self, context: Any, found: dict[str, Any], name: str) -> None:
        self.context = context
        self.program = context.program(vertex_shader=found["vertex"], fragment_shader=found["shaders"][name])
        self.buffers = []
        for index, (block, names) in enumerate(found["blocks"].items()):
            layouts = [found["layouts"][each] for each in names]
            parts = [
                padded(found["tables"][each], layout["columns"], layout["rows"])
                for each, layout in zip(names, layouts, strict=True)
            ]
            buffer = context.buffer(np.concatenate(parts).tobytes())
            self.buffers.append((buffer, index))
            if block in self.program:
                self.program[block].binding = index
        for rows, count in found["rows"].items():
            if f"{rows}_rows" in self.program:
                self.program[f"{rows}_rows"] = int(count)
        seen = found["seen"]
        values = np.array(seen["values"], np.float32)
        self.seen = context.texture((seen["width"], seen["height"]), 4, values.tobytes(), dtype="f4")
        self.vertices = context.vertex_array(self.program, [])

    def draw(self, size: int) -> np.ndarray:
        """(size, size, 4) pixels, row 0 on top."""
        target = self.context.framebuffer([self.context.texture((size, size), 4, dtype="f4")])
        target.use()
        self.seen.use(0)
        for buffer, index in self.buffers:
            buffer.bind_to_uniform_block(index)
        self.vertices.render(vertices=3)
        self.context.finish()
        return np.frombuffer(target.read(components=4, dtype="f4"), np.float32).reshape(size, size, 4)


def draw(folder: Path) -> None:
    """Draw every scene of the folder and hold it to double precision."""
    import moderngl
    from measure import Report

    report = Report("simulator_holds_on_a_gpu", "A real GPU draws the panels as double precision has them.")
    context = moderngl.create_context(standalone=True, backend="egl", require=430)
    report.say(f"{context.info['GL_RENDERER']}, {context.info['GL_VERSION']}; {SIZE} x {SIZE} pixels a scene.")
    worst, walls, pixels, rows = 0.0, 0, 0, []
    for path in sorted(folder.glob("*.json")):
        found = json.loads(path.read_text("utf-8"))
        for name in PASSES:
            begun = time.perf_counter()
            panel = Panel(context, found, name)
            image = panel.draw(found["size"])
            first = time.perf_counter() - begun
            begun = time.perf_counter()
            for _ in range(FRAMES):
                panel.draw(found["size"])
            each = (time.perf_counter() - begun) / FRAMES
            exact = np.array(found["exact"][name]).reshape(image.shape)
            wall = np.array(found["walls"][name], bool).reshape(image.shape[:2])
            apart = np.abs(exact - image).max(axis=2)
            light = float(exact[..., :3].max())
            worst = max(worst, float(apart[~wall].max(initial=0.0)))
            walls += int((apart[wall] > FLOAT32).sum())
            pixels += apart.size
            rows.append([path.stem, name[6:], light, float(apart[~wall].max(initial=0.0)), int(wall.sum()),
                         int((apart[wall] > FLOAT32).sum()), 1e3 * first, 1e3 * each])  # fmt: skip
    report.table(
        ["scene", "pass", "brightest", "worst off walls", "on walls", "of these off", "first ms", "next ms"], rows
    )
    report.say(f"{pixels} pixels of {len(rows)} panels; on walls {walls} are off by more than {FLOAT32:g}.")
    report.claim_number("worst pixel off the walls", worst, FLOAT32)
    report.claim_number("share of pixels on walls that differ", walls / max(1, pixels), MOST_ON_WALLS)
    report.leave()


def main() -> None:
    folders = [Path(word) for word in sys.argv[1:] if not word.startswith("--")]
    if len(folders) != 1:
        sys.exit(__doc__)
    (look if "--look" in sys.argv else draw)(folders[0])


if __name__ == "__main__":
    main()
