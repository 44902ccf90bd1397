"""What the page computes, against the compiled kernels: JavaScript to 1e-12, GLSL to 2e-5 off the walls.

A pixel lies on a wall of an estimate where moving its point by 2e-6 of its distance, or turning its normal or ray by
1e-6, changes the estimate, in double precision, by more than 1e-5: there a float32 ray may see the other side, and
the pixel is counted instead of compared.
"""

from __future__ import annotations

import itertools
import random

import numpy as np
import pytest

from symrender.kernel.assemble_pixels import pixel_program
from symrender.render import render
from symrender.runtimes import interpreter
from symrender.scene import gallery
from symrender.scene.load import load

SIZE = 32
EVERYTHING = """() => {
  const {app, program, data, lookAt, directExact, glossExact} = simulator;
  const f = app.frame, n = f.size, t = f.tables, out = {direct: [], symbolic: [], numeric: [], edge: []};
  const world = [t.eye, t.spheres, t.floor, t.points, t.shading];
  for (let r = 0; r < n; r++) for (let c = 0; c < n; c++) {
    out.direct.push(...directExact(t, c, r));
    const symbolic = glossExact("pixel_symbolic", t, c, r), numeric = glossExact("pixel_numeric", t, c, r);
    out.symbolic.push(...symbolic);
    out.numeric.push(...numeric);
    const seen = lookAt(t, c, r), key = program.pixel_word(c, r, app.state.seed);
    let moved = [0, 0];
    if (symbolic[3] > 0) {
      const far = 2e-6 * Math.hypot(...seen.q.map((v, k) => v - t.eye[k]));
      for (let k = 0; k < 18; k++) {
        const v = {q: [...seen.q], n: [...seen.n], d: [...seen.d]}, part = "qnd"[Math.floor(k / 6)];
        v[part][k % 3] += (k % 6 < 3 ? 1 : -1) * (part === "q" ? far : 1e-6);
        program.strata_gloss(...v.q, ...v.n, ...v.d, seen.shape, t.estimate, t.lobes, t.rings, t.sectors, ...world);
        for (let i = 0; i < 3; i++) moved[0] = Math.max(moved[0], Math.abs(program.R[i] - symbolic[i]));
        program.jittered_gloss(...v.q, ...v.n, ...v.d, seen.shape, key, t.estimate, t.lobes, ...world);
        for (let i = 0; i < 3; i++) moved[1] = Math.max(moved[1], Math.abs(program.R[i] - numeric[i]));
      }
    }
    out.edge.push(...moved);
  }
  out.gpu = {};
  for (const side of ["direct", "symbolic", "numeric"]) out.gpu[side] = Array.from(f[`pixel_${side}`]);
  return out;
}"""
FLOAT32 = 2e-5
MOST_ON_WALLS = 0.2
"""Largest share of pixels on a wall: with 16 directions and several lights, walls are everywhere."""


def exact_and_gpu(page):
    found = page.run(EVERYTHING)
    size = page.run("() => simulator.app.frame.size")
    exact = {k: np.array(found[k]).reshape(size, size, 4) for k in ("direct", "symbolic", "numeric")}
    gpu = {k: np.array(v).reshape(size, size, 4) for k, v in found["gpu"].items()}
    return exact, gpu, np.array(found["edge"]).reshape(size, size, 2)


@pytest.mark.parametrize("name", gallery.names())
def test_gallery_scenes(open_page, name):
    page = open_page(name, size=SIZE)
    exact, gpu, edge = exact_and_gpu(page)
    image = render(name, size=SIZE, numeric="none").symbolic
    assert image.layers["hit_class"].max() > 0
    assert np.abs(exact["direct"][..., :3] - image.layers["direct"]).max() <= 1e-12
    assert np.abs(exact["symbolic"][..., :3] - image.layers["gloss"]).max() <= 1e-12
    assert np.array_equal(exact["direct"][..., 3], image.layers["hit_class"])
    assert np.abs(exact["direct"] - gpu["direct"]).max() <= FLOAT32
    for side, moved in (("symbolic", edge[..., 0]), ("numeric", edge[..., 1])):
        smooth = moved <= 1e-5
        assert np.mean(smooth) >= 1 - MOST_ON_WALLS, (name, side, np.mean(smooth))
        assert np.abs(exact[side] - gpu[side])[smooth].max() <= FLOAT32, (name, side)
        # on a wall a ray may fall on either side, but no more than that can happen
        assert np.abs(exact[side] - gpu[side]).max() <= 1.0


RANDOM = """async (states) => {
  const {app, makeTables, directExact, glossExact} = simulator, n = 16, out = [];
  for (const edit of states) {
    const t = makeTables({...app.state, ...edit, size: n}), gpu = {};
    app.gpu.upload(t);
    for (const pass of ["pixel_direct", "pixel_numeric", "pixel_symbolic", "pixel_chambers"]) {
      await app.gpu.draw(pass, n, 0, n);
      gpu[pass] = await app.gpu.read(pass, n);
    }
    let direct = 0, finite = true, signal = 0;
    const errors = [];
    for (let k = 0; k < n * n; k += 3) {
      const d = directExact(t, k % n, Math.floor(k / n)), s = glossExact("pixel_symbolic", t, k % n, Math.floor(k / n));
      let e = 0;
      for (let i = 0; i < 3; i++) {
        direct = Math.max(direct, Math.abs(d[i] - gpu.pixel_direct[4 * k + i]));
        e = Math.max(e, Math.abs(s[i] - gpu.pixel_symbolic[4 * k + i]) / Math.max(1, Math.abs(s[i])));
        signal = Math.max(signal, s[i]);
        for (const values of Object.values(gpu)) finite &&= Number.isFinite(values[4 * k + i]);
      }
      errors.push(e);
    }
    errors.sort((a, b) => a - b);
    out.push([errors[Math.floor(0.8 * errors.length)], direct, finite, signal, app.gpu.gl.getError()]);
  }
  return out;
}"""


def random_state(rng):
    changes = {
        "shading.model": rng.choice(["blinn", "phong"]),
        "shading.highlight_view": rng.choice(["ray", "eye"]),
        "shading.specular_terminator": rng.choice(["cut", "open"]),
        "shading.shininess": rng.choice([0.0, 1.5, 32.0, 700.5, 5000.0]),
        "floor.lobe.exponent": rng.choice([0.0, 0.5, 16.0, 300.25, 4096.0, 1e6]),
        "floor.lobe.theta_max": rng.choice([0.0, 1e-3, 0.4, 1.2, 1.5707963267948966]),
        "lights.key.radius": rng.choice([0.0, 0.3, 2.0]),
        "spheres.A.texture.ku": rng.choice([2.0, 7.0, 8.5, 16.0]),
        "spheres.A.texture.kv": rng.choice([0.0, 3.0, 4.5, 70.0]),
        "background.g": rng.choice([0.0, 0.2]),
    }
    for name in "ABC":
        changes[f"spheres.{name}.texture.type"] = rng.choice(["solid", "checker", "stripes", "marble"])
        changes[f"spheres.{name}.center.z"] = rng.uniform(0.1, 1.5)
        changes[f"spheres.{name}.lobe.exponent"] = rng.choice([0.0, 2.0, 64.0])
    return {
        "scene": changes,
        "lobe": rng.choice([1, 2, 3]),
        "weights": rng.choice(["exact", "midpoint"]),
        "nodes": rng.choice(["midpoint", "barycentre"]),
        "partition": rng.choice(["equal_angle", "equal_solid_angle", "equal_weight"]),
        "normalised": rng.choice([True, False]),
        "seed": rng.randrange(2**31),
    }


def test_a_hundred_random_scenes_in_one_page(open_page):
    """Random values in every table, so that no branch of the shaders goes unseen; nothing is compiled again."""
    page = open_page("gloss", size=16)
    rng = random.Random(8)
    found = page.run(RANDOM, [random_state(rng) for _ in range(100)])
    assert len(found) == 100
    assert sum(signal > 0.01 for *_, signal, _ in found) >= 60
    for most, direct, finite, _, error in found:
        assert finite
        assert error == 0
        # of the gloss four pixels in five: the others may lie on a wall
        assert most <= FLOAT32
        assert direct <= 0.5


def test_the_jittered_estimate_is_that_of_the_interpreter(open_page):
    """The judge of every target walks the program; JavaScript repeats it, random numbers and all."""
    page = open_page("chapter8", size=16)
    tables = page.run("""() => Object.fromEntries(Object.entries(simulator.app.frame.tables).map(
      ([name, values]) => [name, Array.from(values)]))""")
    from symrender.kernel.assemble_pixels import TABLES

    arrays = {}
    for name, values in tables.items():
        flat = np.array(values)
        if name in TABLES:
            arrays[name] = flat if TABLES[name].rows == 1 else flat.reshape(-1, TABLES[name].columns)
    program = pixel_program()
    compared = 0
    for entry in ("pixel_numeric", "pixel_symbolic"):
        function = next(f for f in program.functions if f.name == entry)
        for column, row in ((3, 12), (8, 7), (9, 8)):
            arguments = [column, row, *(arrays[p.name] for p in function.parameters[2:])]
            wanted = interpreter.run(program, entry, arguments)
            found = page.run(f"() => simulator.glossExact('{entry}', simulator.app.frame.tables, {column}, {row})")
            assert np.abs(np.array(wanted, dtype=float) - found).max() <= 1e-12
            compared += sum(wanted[:3]) > 0
    assert compared >= 2


def test_rules_made_in_the_page_are_those_of_the_quadrature(open_page):
    page = open_page("gloss", size=20)
    choices = itertools.product(
        ("equal_angle", "equal_solid_angle", "equal_weight"),
        ("exact", "midpoint"),
        ("midpoint", "barycentre"),
        (False, True),
    )
    signal = 0.0
    for partition, weights, nodes, normalised in choices:
        options = {"weights": weights, "nodes": nodes, "partition": partition, "normalised": normalised}
        exact = page.run(
            """(rule) => {
              const t = simulator.makeTables({...simulator.app.state, ...rule, lobe: 3}), found = [];
              for (let k = 0; k < 400; k++) {
                found.push(...simulator.glossExact("pixel_symbolic", t, k % 20, Math.floor(k / 20)));
              }
              return found;
            }""",
            options,
        )
        gloss = render("gloss", size=20, numeric="none", lobe=3, **options).symbolic.layers["gloss"]
        signal = max(signal, gloss.max())
        assert np.abs(np.array(exact).reshape(20, 20, 4)[..., :3] - gloss).max() <= 1e-12, options
    assert signal > 0.3


def test_changes_in_the_page_are_changes_of_the_scene(open_page):
    from symrender.simulator.state import from_url

    page = open_page("gloss", size=32)
    page.change(
        "s.scene['spheres.B.center.x'] = 0.4; s.scene['spheres.B.texture.type'] = 'marble';"
        "s.scene['lights.key.radius'] = 0; s.scene['shading.model'] = 'phong'; s.off = ['fill']"
    )
    link = page.run("async () => await simulator.app.link()")
    state = from_url(link)
    assert state.scene["spheres.B.center.x"] == 0.4
    image = render(state.apply(load("gloss")), size=32, numeric="none").symbolic
    found = page.run("""() => { const out = []; for (let r = 0; r < 32; r++) for (let c = 0; c < 32; c++)
      out.push(...simulator.directExact(simulator.app.frame.tables, c, r)); return out; }""")
    exact = np.array(found).reshape(32, 32, 4)
    assert np.abs(exact[..., :3] - image.layers["direct"]).max() <= 1e-12
