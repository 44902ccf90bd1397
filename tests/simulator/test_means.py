"""Pixel, shutter and lens in the page: the product of its rules against plain Python, chance against rules, bits."""

from __future__ import annotations

import itertools
import json
import math

import numpy as np
import pytest

import symrender as sr
from symrender.numeric.pipeline import trace
from symrender.render import render
from symrender.scene.arrays import scene_arrays
from symrender.scene.load import load
from symrender.simulator.build import simulator
from symrender.simulator.state import State, from_url, to_fragment

from .conftest import Page, page_of, without_webgl

LENS = {"aperture": 0.11, "focus": 5.2, "rings": 1}
SHUTTER = {"shutter": (-0.25, 0.75), "instants": 3, "mover": "B", "velocity": (0.4, -0.7, 0.2)}
EYE_VIEW = {"shading.highlight_view": "eye"}
OPEN = LENS | SHUTTER | {"pixel": 2}
EXACT = """([side, edit, pixels, lobe]) => {
  const {app, data, makeTables, Looks, meanExact} = simulator;
  const s = {...structuredClone(data.defaults), size: app.state.size, ...edit};
  const looks = new Looks(side, s, makeTables(s));
  return pixels.map(([column, row]) => meanExact(looks, column, row));
}"""
SIZE = 16
ALONE = {"threads": 1, "tile": SIZE}
"""An image this small is made sooner in one piece than shared out."""
EVERY = [[column, row] for row in range(SIZE) for column in range(SIZE)]


def gauss(n):
    """Nodes and weights of Gauss's rule on [0, 1]."""
    x, w = np.polynomial.legendre.leggauss(n)
    return [(0.5 + 0.5 * a, 0.5 * b) for a, b in zip(x, w, strict=True)]


def lens_points(aperture, rings):
    """(right, up, weight) on the disk, as docs/simulator.md says they lie."""
    found = []
    for ring, (square, weight) in enumerate(gauss(rings)):
        for k in range(4 * rings):
            angle = 2 * math.pi * (k + 0.5 * (ring % 2)) / (4 * rings)
            radius = aperture * math.sqrt(square)
            found.append((radius * math.cos(angle), radius * math.sin(angle), weight / (4 * rings)))
    return found


def product(state):
    """(x, y, right, up, time, weight) of every place of a mean."""
    across = gauss(state.pixel)
    lens = lens_points(state.aperture, state.rings) if state.aperture else [(0.0, 0.0, 1.0)]
    opened, closed = state.shutter
    for (x, a), (y, b), (right, up, c), (share, d) in itertools.product(across, across, lens, gauss(state.instants)):
        yield x - 0.5, y - 0.5, right, up, opened + share * (closed - opened), a * b * c * d


def opened_once(browser, path, scene):
    """The page of a scene for tests that leave its state as it is, or set every number that they ask for."""
    errors = []
    simulator(scene, path)
    context = browser.new_context()
    page = Page(context.new_page())
    page.page.on("pageerror", lambda error: errors.append(str(error)))
    page.page.goto(f"{path.as_uri()}{to_fragment(State(size=SIZE))}")
    page.settle()
    page.converge(False)
    yield page
    context.close()
    assert errors == []


def level_scene():
    """The default scene under a camera whose image is the floor, so that any place of it is a scene of its own."""
    data = load("gloss").model_dump(mode="json")
    data["camera"] = {"type": "plane", "eye": [0.3, -0.4, 4.0], "window_half": 1.6, "window_center": [0.1, -0.6]}
    data["spheres"][1]["texture"] = {"type": "marble", "ku": 3, "kv": 2}
    return sr.load(data)


def from_place(scene, state, place):
    """``scene`` from a place: the ray of the window's middle from the lens to where it is sharp, and on."""
    x, y, right, up, time, _ = place
    camera = scene.camera
    side = 2 * camera.window_half / SIZE
    eye, spot = np.array(camera.eye), np.array([*camera.window_center, 0.0]) + np.array([x * side, -y * side, 0.0])
    lens = eye + np.array([right, up, 0.0])
    sharp = eye + (spot - eye) * (state.focus / eye[2])
    way = sharp - lens
    met = lens - way * (lens[2] / way[2])
    return state.at(scene, time).replace({"camera.eye": tuple(lens), "camera.window_center": tuple(met[:2])})


@pytest.fixture(scope="module")
def level_page(browser, tmp_path_factory):
    """The page of the level scene, opened once: compiling its shaders takes longer than a test."""
    yield from opened_once(browser, tmp_path_factory.mktemp("level") / "page.html", level_scene())


@pytest.mark.parametrize(
    "opened",
    [
        {"pixel": 3, "focus": 5.0},
        LENS | {"focus": 2.5},
        LENS | {"focus": 9.0, "rings": 2},
        SHUTTER | {"focus": 5.0},
        OPEN,
    ],
    ids=["pixel", "near lens", "far lens", "shutter", "all"],
)
def test_the_product_is_that_of_scenes_rendered_one_by_one(level_page, opened):
    """Direct light and gloss of 256 pixels against as many renders as the product has places: the lens, the shutter and
    the box from ``Scene.replace`` alone."""
    scene, page = level_scene(), level_page
    state = State(size=SIZE, lobe=2, partition="equal_weight", **opened)
    options = {"lobe": 2, "partition": "equal_weight", "aa": "none" if state.pixel > 1 else "analytic"}
    direct, gloss = np.zeros((SIZE, SIZE, 3)), np.zeros((SIZE, SIZE, 3))
    moving = state.shutter[0] != state.shutter[1]
    places = list(product(state if moving else State(**{**vars(state), "instants": 1})))
    for place in places:
        layers = render(from_place(scene, state, place), size=SIZE, numeric="none", **options, **ALONE).symbolic.layers
        direct += place[5] * layers["direct"]
        gloss += place[5] * (layers["radiance"] - layers["direct"])
    edit = {k: getattr(state, k) for k in ("lobe", "partition", *opened)}
    found = np.array(page.values(EXACT, ["symbolic", edit, EVERY, 2])).reshape(SIZE, SIZE, 6)
    assert page.run("(e) => simulator.countsOf({...simulator.app.state, ...e}).all", edit) == len(places)
    assert np.median(direct) > 0.01 and np.mean(gloss.max(axis=2) > 0.01) > 0.3
    still = render(scene, size=SIZE, numeric="none", **options).symbolic.layers
    assert np.abs(direct - still["direct"]).max() > 0.02
    assert np.abs(found[..., :3] - direct).max() <= 1e-12
    assert np.abs(found[..., 3:] - gloss).max() <= 1e-12


def camera_rays(scene, state, places, column, row):
    """Origins and unit directions of one pixel, from the definition of a thin lens in docs/exposure.md."""
    camera = scene.camera
    eye, target, up = (np.array(v, dtype=float) for v in (camera.eye, camera.target, camera.up))
    forward = (target - eye) / np.linalg.norm(target - eye)
    right = np.cross(forward, up) / np.linalg.norm(np.cross(forward, up))
    above, tangent = np.cross(right, forward), math.tan(math.radians(camera.fov) / 2)
    for x, y, u, v, _, _ in places:
        a, b = 2 * (column + 0.5 + x) / state.size - 1, 1 - 2 * (row + 0.5 + y) / state.size
        sharp = eye + state.focus * (forward + tangent * a * right + tangent * b * above)
        lens = eye + u * right + v * above
        yield lens, (sharp - lens) / np.linalg.norm(sharp - lens)


def test_a_camera_that_looks_at_something_has_the_lens_of_the_definition(fresh):
    """Direct light of 40 pixels, 24 places each, against single rays of the conventional tracer."""
    page, scene = fresh(SIZE), load("gloss")
    state = State(size=SIZE, **OPEN)
    places = list(product(state))
    pixels = EVERY[2::4][:40]
    found = np.array(page.values(EXACT, ["symbolic", OPEN, pixels, 4]))[:, :3]
    worlds = {time: scene_arrays(state.at(scene, time)) for time in {p[4] for p in places}}
    assert len(worlds) == 3
    rays = np.array([list(camera_rays(scene, state, places, column, row)) for column, row in pixels])
    wanted = np.zeros((len(pixels), 3))
    for j, place in enumerate(places):
        radiance, _, _ = trace(worlds[place[4]], rays[:, j, 0], rays[:, j, 1], 0)
        wanted += place[5] * radiance
    assert len(places) == 48
    assert np.mean(wanted.max(axis=1) > 0.01) > 0.7
    assert np.abs(found - wanted).max() <= 1e-12


DRAWN = """([edit, pixels]) => {
  const {app, Drawn, Looks, makeTables} = simulator, s = {...structuredClone(app.state), ...edit};
  const drawn = new Drawn(s, s.size), looks = new Looks("numeric", s, makeTables(s));
  const every = [...Array(drawn.count).keys()];
  const seeds = every.map((k) => Array.from(looks.at(k).tables.estimate).join());
  const places = pixels.map(([column, row]) => every.map((k) => drawn.place(column, row, k)));
  return [drawn.tall, drawn.wide, places, seeds];
}"""


@pytest.mark.parametrize(
    "opened", [{"pixel": 3}, {"instants": 7}, {"pixel": 3, "rings": 2, "instants": 6}], ids=["pixel", "time", "all"]
)
def test_places_by_chance_take_every_stratum_once_in_orders_of_their_own(fresh, opened):
    page = fresh(16)
    state = {"aperture": 0.4 if "rings" in opened else 0, "velocity": [1, 0, 0], **opened}
    state["shutter"] = [-1, 2] if "instants" in opened else [0, 0]
    tall, wide, pixels, seeds = page.values(DRAWN, [state, [[3, 4], [4, 3], [15, 15]]])
    count = tall * wide
    assert count == opened.get("pixel", 1) ** 2 * opened.get("instants", 1) * (16 if "rings" in opened else 1)
    assert len(set(seeds)) == count
    orders = []
    for places in pixels:
        found = {key: np.array([place[key] for place in places]) for key in ("x", "y", "right", "up", "time")}
        assert {place["weight"] for place in places} == {1 / count}
        if "pixel" in opened:
            cells = np.floor((found["x"] + 0.5) * wide) * tall + np.floor((found["y"] + 0.5) * tall)
            assert sorted(cells) == list(range(count))
            orders.append(tuple(cells))
        if "rings" in opened:
            square = (found["right"] ** 2 + found["up"] ** 2) / 0.4**2
            turn = np.arctan2(found["up"], found["right"]) / (2 * math.pi) % 1
            cells = np.floor(square * wide) * tall + np.floor(turn * tall)
            assert sorted(cells) == list(range(count))
            orders.append(tuple(cells))
        if "instants" in opened:
            cells = np.floor((found["time"] + 1) / 3 * count)
            assert sorted(cells) == list(range(count))
            orders.append(tuple(cells))
    assert len(set(orders)) == len(orders)


CHANCE = """([edit, pixels, seeds]) => {
  const {app, makeTables, Looks, meanExact} = simulator, out = [];
  for (let seed = 0; seed < seeds; seed++) {
    const s = {...structuredClone(app.state), ...edit, seed}, looks = new Looks("numeric", s, makeTables(s));
    out.push(pixels.map(([column, row]) => meanExact(looks, column, row)));
  }
  return out;
}"""
SEEDS, MOST_SIGMA = 48, 5.5


def smooth_scene():
    """One large ball under two points, no shadow and no texture in sight: rules are then right to many digits."""
    return sr.load(
        {
            "name": "smooth",
            "camera": {"type": "look_at", "eye": [0, -6, 1], "target": [0, 0, 1], "fov": 16},
            "spheres": [
                {"name": "ball", "center": [0, 0, 1], "radius": 2.4, "color": [0.7, 0.5, 0.3],
                 "lobe": {"weight": 0.5, "exponent": 40, "theta_max": 0.5}}
            ],
            "lights": [
                {"name": "key", "type": "point", "position": [-3, -9, 5], "color": [1, 0.9, 0.8]},
                {"name": "fill", "type": "point", "position": [5, -8, 2], "color": [0.2, 0.3, 0.5]},
            ],
            "ambient": [0.1, 0.1, 0.1],
            "background": [0.2, 0.3, 0.4],
            "shading": {"model": "blinn", "ka": 0.3, "kd": 0.8, "ks": 0.3, "shininess": 8},
        }
    )  # fmt: skip


@pytest.fixture(scope="module")
def smooth_page(browser, tmp_path_factory):
    """The page of the smooth scene, opened once: nothing here changes its state."""
    yield from opened_once(browser, tmp_path_factory.mktemp("smooth") / "page.html", smooth_scene())


@pytest.mark.parametrize("which", ["pixel", "lens", "shutter", "all"])
def test_chance_converges_to_the_rules(smooth_page, which):
    """The mean of 48 seeds at 36 pixels of a scene without walls, against a rule finer than any of its errors.

    Nothing biases the estimate: lobes are normalised. Of 108 values (channels go together) one is beyond 5.5 standard
    errors, by Student with 47 degrees, in fewer than 2 of 10,000 runs. A ball of one colour under a sky of one colour:
    the gloss is the same all over, and what differs is direct light.
    """
    edit = {"pixel": {"pixel": 3}, "lens": LENS | {"aperture": 1.2, "rings": 2}, "shutter": {**SHUTTER, "mover": None}}
    edit["all"] = {k: v for part in ("pixel", "lens", "shutter") for k, v in edit[part].items()} | {"pixel": 2}
    page, chosen = smooth_page, edit[which] | {"normalised": True, "lobe": 2, "size": 16}
    pixels = [[c, r] for r in range(1, 16, 3) for c in range(0, 16, 2)][:36]
    drawn = np.array(page.values(CHANCE, [chosen, pixels, SEEDS]))[..., :3]
    fine = chosen | {k: v for k, v in {"pixel": 4, "instants": 6, "rings": 3}.items() if k in chosen}
    finer = np.array(page.values(EXACT, ["symbolic", fine, pixels, 2]))[:, :3]
    coarse = np.array(page.values(EXACT, ["symbolic", chosen, pixels, 2]))[:, :3]
    single = np.array(page.values(EXACT, ["symbolic", {"size": 16, "lobe": 2, "normalised": True}, pixels, 2]))[:, :3]
    mean, spread = drawn.mean(axis=0), drawn.std(axis=0, ddof=1) / math.sqrt(SEEDS)
    assert finer.min() > 0.02 and (spread > 1e-7).all()
    # the rule is right where it is asked to be: what it misses is no part of what chance does
    assert np.abs(coarse - finer).max() < 0.2 * np.median(spread)
    z = (mean - finer) / spread
    assert np.abs(z).max() < MOST_SIGMA
    assert 0.6 < np.sqrt(np.mean(z**2)) < 1.5
    # and this would tell one ray through the middle from the mean
    assert np.abs((single - finer) / spread).max() > MOST_SIGMA


PANELS = """() => {
  const f = simulator.app.frame, out = {};
  for (const [name, values] of Object.entries(f)) if (values instanceof Float32Array) out[name] = Array.from(values);
  return out;
}"""


def test_closed_and_single_the_panels_are_what_they_were(fresh):
    page = fresh(40)
    before = page.values(PANELS)
    closed = "shutter: [0, 0], instants: 9, mover: 'C', velocity: [3, 1, 0], aperture: 0, focus: 2, rings: 4, pixel: 1"
    page.change(f"Object.assign(s, {{{closed}}}); simulator.app.held.clear(); simulator.app.seen = null")
    assert not page.run("() => simulator.app.frame.mean")
    assert page.values(PANELS) == before
    assert set(before) == {"pixel_direct", "pixel_numeric", "pixel_symbolic"}
    # a shutter that opens and closes at once shows that instant, and a sphere that stands still none
    page.change("s.shutter = [0.5, 0.5]; s.velocity = [0.3, 0, 0]; s.mover = 'B'")
    assert not page.run("() => simulator.app.frame.mean")
    moved = page.values(PANELS)
    assert moved != before
    page.change("s.shutter = [0, 0]; s.scene['spheres.B.center.x'] = 0.98 + 0.15")
    assert page.values(PANELS) == moved
    page.change("delete s.scene['spheres.B.center.x']; s.velocity = [0, 0, 0]; s.shutter = [0, 1]")
    assert page.values(PANELS) == before


AGAINST_EXACT = """(step) => {
  const {app, Looks, meanExact, anyOnWall} = simulator, f = app.frame, n = f.size, out = [];
  for (const side of ["symbolic", "numeric"]) {
    const looks = new Looks(side, f.state, f.tables);
    for (let k = 0; k < n * n; k += step) {
      const exact = meanExact(looks, k % n, Math.floor(k / n));
      let off = 0;
      for (let c = 0; c < 3; c++) {
        off = Math.max(off, Math.abs(exact[c] - f[`direct_${side}`][4 * k + c]));
        off = Math.max(off, Math.abs(exact[3 + c] - f[`pixel_${side}`][4 * k + c]));
      }
      out.push([off, exact[0] + exact[3], off > 2e-5 && !anyOnWall(looks, k % n, Math.floor(k / n))]);
    }
  }
  return out;
}"""


@pytest.mark.parametrize("opened", [{"pixel": 2}, LENS, SHUTTER, OPEN], ids=["pixel", "lens", "shutter", "all"])
def test_panels_of_means_are_those_of_double_precision(fresh, opened):
    """192 pixels of either panel: within 2e-5, or on a wall of one of its rays."""
    page = fresh(24)
    # of the ways to see a highlight the one that asks where the eye is
    page.change(f"Object.assign(s, {json.dumps(opened)}); s.lobe = 2; s.scene['shading.highlight_view'] = 'eye'")
    assert page.run("() => simulator.app.frame.mean.numeric === simulator.app.frame.mean.count")
    found = page.values(AGAINST_EXACT, 3)
    assert len(found) == 2 * 192
    assert np.mean([light > 0.01 for _, light, _ in found]) > 0.6
    assert not any(unexplained for _, _, unexplained in found)
    assert np.mean([off > 2e-5 for off, _, _ in found]) < 0.02
    assert np.median([off for off, _, _ in found]) < 1e-6


def test_without_webgl_means_are_drawn_too(browser, tmp_path):
    page_of("gloss").save(tmp_path / "page.html")
    context = without_webgl(browser)
    # so quick a page that its first picture seems to follow a drag
    context.add_init_script("""performance.now = ((own, calls) => () => (calls++ < 40 ? 0.01 * calls : own()))(
      performance.now.bind(performance), 0);""")
    page = Page(context.new_page())
    page.page.goto(f"{(tmp_path / 'page.html').as_uri()}{to_fragment(State(size=16, lobe=2, scene=EYE_VIEW, **OPEN))}")
    page.settle()
    assert page.run("() => simulator.app.gpu.slow && simulator.app.frame.mean.count") == 48
    found = page.values(AGAINST_EXACT, 2)
    assert len(found) == 256
    # pixels are kept in single precision
    assert max(off for off, _, _ in found) < 1e-6
    assert np.mean([light > 0.01 for _, light, _ in found]) > 0.6
    context.close()


REFERENCE_LAYERS = """() => {
  const f = simulator.app.frame;
  return [f.direct_reference, f.pixel_reference].map((values) => Array.from(values));
}"""


def reference_of(page, passes):
    """Direct light and gloss of the reference, and the standard error it states, after so many passes."""
    page.converge()
    page.until(f"simulator.app.frame.converger?.done || (simulator.app.frame.converger?.passes ?? 0) >= {passes}")
    page.converge(False)
    page.until("!simulator.app.sampling")
    found = np.array(page.values(REFERENCE_LAYERS)).reshape(2, SIZE, SIZE, 4)[..., :3]
    return found, page.run("() => simulator.app.frame.converger.told.rms")


def supersampled(many):
    """Radiance of 16 x 16 box pixels from ``many`` x ``many`` rays each."""
    options = {"lobe": 8, "partition": "equal_weight", "nodes": "barycentre", "aa": "none", "numeric": "none"}
    fine = render("gloss", size=16 * many, **options).symbolic.layers["radiance"]
    return fine.reshape(16, many, 16, many, 3).mean(axis=(1, 3))


def test_the_reference_converges_to_the_mean_over_the_pixel(fresh):
    """256 pixels against 400 rays each of compiled kernels, whose own error is told by 225 of them."""
    page = fresh(16)
    page.change("s.pixel = 3; s.lobe = 8; s.partition = 'equal_weight'")
    layers, told = reference_of(page, 512)
    mean = layers.sum(axis=0)
    judge, other = supersampled(20), supersampled(15)
    rms = lambda values: float(np.sqrt(np.mean(values**2)))  # noqa: E731
    assert told < 3e-3 and rms(judge - other) < 5e-3
    assert 1e-6 < rms(mean - judge) <= 3 * told + rms(judge - other)
    # the centre alone is another picture
    centre = render("gloss", size=16, lobe=8, partition="equal_weight", numeric="none").symbolic.layers["radiance"]
    assert rms(judge - centre) > 10 * rms(mean - judge)
    errors = page.run("() => simulator.app.frame.errors")
    assert errors["numeric"] > 3 * told


def test_the_reference_converges_over_lens_and_shutter(level_page):
    """256 pixels against 600 scenes rendered from random places, each at a random instant: two halves say how well."""
    scene, rng = level_scene(), np.random.default_rng(3)
    wide = OPEN | {"aperture": 0.6, "focus": 2.5, "velocity": (1.2, -1.0, 0.2)}
    state = State(size=SIZE, lobe=2, partition="equal_weight", **wide)
    page = level_page
    page.change(f"Object.assign(s, {json.dumps(wide | {'lobe': 2, 'partition': 'equal_weight'})})")
    layers, told = reference_of(page, 256)
    halves = np.zeros((2, SIZE, SIZE, 3))
    for k in range(600):
        x, y, a, b, share = rng.random(5)
        radius, turn = state.aperture * math.sqrt(a), 2 * math.pi * b
        time = state.shutter[0] + share * (state.shutter[1] - state.shutter[0])
        place = (x - 0.5, y - 0.5, radius * math.cos(turn), radius * math.sin(turn), time, 1)
        options = {"lobe": 6, "partition": "equal_weight", "nodes": "barycentre", "aa": "none", "numeric": "none"}
        image = render(from_place(scene, state, place), size=SIZE, **options, **ALONE).symbolic
        halves[k % 2] += image.layers["radiance"] / 300
    rms = lambda values: float(np.sqrt(np.mean(values**2)))  # noqa: E731
    judge, doubt = halves.mean(axis=0), rms(halves[0] - halves[1]) / 2
    assert rms(judge) > 0.05 and told < 5e-3 and doubt < 1e-2
    assert rms(layers.sum(axis=0) - judge) <= 3 * math.hypot(told, doubt)
    # neither the middle of all nor a lens without a shutter is as near
    for edit in ({"pixel": 1, "aperture": 0, "shutter": [0.25, 0.25]}, {"shutter": [0.25, 0.25]}, {"aperture": 0}):
        other = np.array(
            page.values(EXACT, ["symbolic", {**wide, "lobe": 4, "partition": "equal_weight", **edit}, EVERY, 2])
        )
        apart = other.reshape(SIZE, SIZE, 2, 3).sum(axis=2) - judge
        assert rms(apart) > 3 * math.hypot(told, doubt)


def test_links_carry_pixel_shutter_and_lens(open_page):
    state = State(size=32, lobe=1, cursor=(12, 20), **OPEN)
    page = open_page("gloss", fragment=to_fragment(state))
    assert from_url(page.run("async () => await simulator.app.link()")) == state
    assert page.run("() => simulator.app.frame.mean.count") == 48
    told = page.run("() => document.getElementById('ledger').textContent")
    assert "48 × 1" in told
    assert page.run("() => !document.getElementById('middle').hidden")
    # what does not fit is left as it was
    wrong = "{shutter: [1, 0], velocity: [1], mover: 'Z', aperture: -1, focus: 0, pixel: 9, instants: 1.5, rings: '2'}"
    kept = page.run(f"() => {{ const s = {{}}; simulator.fitMean(s, {wrong}); return s; }}")
    assert kept == {}


def test_a_probe_is_answered_while_a_mean_is_drawn(fresh):
    page = fresh(96)
    page.run("() => simulator.app.change((s) => { s.pixel = 8; })")
    page.until("simulator.app.frame.mean && simulator.app.frame.mean.symbolic > 0 && simulator.app.running")
    page.page.locator("#panel-symbolic").scroll_into_view_if_needed()
    box = page.page.locator("#panel-symbolic").bounding_box()
    page.page.mouse.move(box["x"] + 0.31 * box["width"], box["y"] + 0.27 * box["height"])
    page.until("simulator.app.facts.pixel.join() === '29,25'")
    assert page.run("() => simulator.app.frame.mean.symbolic") < 64
    page.run("() => simulator.app.change((s) => { s.pixel = 1; })")
    page.settle()


def test_a_sweep_of_the_lens_is_a_film_and_leaves_the_state_as_it_was(fresh):
    page = fresh(32)
    before = page.run("() => simulator.app.state")
    found = page.run("""async () => {
      if (typeof VideoEncoder === 'undefined') return null;
      const seen = [], {app, filmed} = simulator, count = () => seen.push(app.frame.mean?.count ?? 1);
      await filmed(app, {name: 'pixel', from: 1, to: 3, frames: 3}, count);
      await filmed(app, {name: 'shutter.close', from: 0, to: 1, frames: 2}, count);
      await filmed(app, {name: 'aperture', from: 0, to: 0.2, frames: 2}, count);
      return seen;
    }""")
    if found is None:
        pytest.skip("this browser has no VideoEncoder")
    assert found == [1, 4, 9, 1, 4, 1, 16]
    page.settle()
    assert page.run("() => simulator.app.state") == before
    names = page.run("() => [...document.querySelectorAll('#sweep-name option')].map((o) => o.value)")
    assert {"pixel", "shutter.open", "shutter.close", "velocity.x", "aperture", "focus"} <= set(names)


def test_a_scene_without_spheres_has_no_shutter(open_page):
    scene = sr.load("gloss")
    page = open_page(simulator(scene.model_copy(update={"spheres": ()})), size=32)
    told = page.run("() => document.getElementById('form').textContent")
    assert "No sphere could move" in told and "Shutter opens at" not in told
    page.change("s.shutter = [0, 1]; s.pixel = 2")
    assert page.run("() => simulator.app.frame.mean.count") == 4


FEWER = OPEN | {"instants": 2}
ALL_OPEN = f"""Object.assign(s, structuredClone(simulator.data.defaults), {{size: 16, cursor: null, lobe: 1}},
  {json.dumps(FEWER)})"""


@pytest.fixture(scope="module")
def first_panels(gloss_page):
    """The panels where every mean is open, which each test that takes them finds again at its end."""
    gloss_page.change(ALL_OPEN)
    return gloss_page.values(PANELS)


@pytest.fixture
def open_panels(gloss_page, first_panels):
    """The page where every mean is open, drawn anew only if a test has left it otherwise, and its panels."""
    gloss_page.change(ALL_OPEN)
    return gloss_page, first_panels


@pytest.mark.parametrize("edit", [
    {"pixel": 1}, {"shutter": [-0.25, 0.5]}, {"instants": 3}, {"mover": "C"}, {"velocity": [0.4, -0.7, 0]},
    {"aperture": 0.2}, {"focus": 6}, {"rings": 2}, {"seed": 8}, {"scene": {"spheres.B.center.x": 0.5}},
])  # fmt: skip
def test_panels_of_means_follow_every_number_and_are_kept_while_none_changes(open_panels, edit):
    page, before = open_panels
    held = "['symbolic', 'numeric'].map((side) => simulator.app.held.get(`mean ${side}`).sums)"
    page.run(f"() => {{ window.kept = {held}; }}")
    page.change("s.exposure = 1; s.view = 'gloss'; s.difference = 2")
    assert page.run(f"() => {held}.every((sums, k) => sums === window.kept[k])")
    page.change(f"Object.assign(s, {json.dumps(edit)})")
    after = page.values(PANELS)
    assert after["direct_numeric"] != before["direct_numeric"]
    assert (after["direct_symbolic"] != before["direct_symbolic"]) == ("seed" not in edit)
    page.change(f"Object.assign(s, {json.dumps(FEWER)}); s.lobe = 1; s.seed = 7; s.scene = {{}}")
    assert page.values(PANELS) == before


def test_controls_move_the_panels_and_go_back(fresh):
    """Every slider of pixel, shutter and lens, by its label; what opens after it closes takes the other with it."""
    page = fresh(24)
    slide = """([label, value]) => {
      const named = [...document.querySelectorAll('#form .control > label')].find((e) => e.textContent === label);
      const range = document.getElementById(named.htmlFor);
      range.value = value;
      range.dispatchEvent(new Event('input'));
      range.dispatchEvent(new Event('change'));
      return simulator.app.state;
    }"""
    assert page.run(slide, ["Places of a pixel", 3])["pixel"] == 3
    assert page.run(slide, ["Shutter opens at", 0.4])["shutter"] == [0.4, 0.4]
    assert page.run(slide, ["Shutter closes at", 0.9])["shutter"] == [0.4, 0.9]
    assert page.run(slide, ["Shutter opens at", -0.3])["shutter"] == [-0.3, 0.9]
    assert page.run(slide, ["Its velocity along y", -2])["velocity"] == [1, -2, 0]
    assert page.run(slide, ["Instants", 2])["instants"] == 2
    assert page.run(slide, ["Aperture", 0.3])["aperture"] == pytest.approx(0.3, abs=2e-3)
    assert page.run(slide, ["Rings of the lens", 1])["rings"] == 1
    assert page.run(slide, ["Focus", 3])["focus"] == pytest.approx(8, rel=0.02)
    page.settle()
    assert page.run("() => simulator.app.frame.mean.count") == 9 * 2 * 4
    words = page.run("async () => simulator.recipeLines(await simulator.app.link()).join()")
    assert "pixel 3 x 3; shutter -0.3 to 0.9 s, 2 instants, sphere A at 1 -2 0 /s; aperture" in words
    for name in ("Places of a pixel", "Shutter closes at", "Its velocity along y", "Aperture", "Focus"):
        page.page.locator(f"button[aria-label='Reset {name}']").evaluate("(e) => e.click()")
    page.settle()
    state = page.run("() => simulator.app.state")
    assert [state[k] for k in ("pixel", "shutter", "velocity", "aperture", "focus")] == [
        1,
        [-0.3, 0],
        [1, 0, 0],
        0,
        None,
    ]
