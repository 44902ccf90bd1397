"""The page as an instrument: the reference, the disc's answers, recipes, no WebGL, no JavaScript."""

from __future__ import annotations

import io
import json
import urllib.error
import urllib.request
from threading import Thread

import numpy as np
import pytest
from PIL import Image

from symrender.probe import probe
from symrender.scene.load import load
from symrender.simulator.build import simulator, simulator_page
from symrender.simulator.serve import server
from symrender.simulator.state import State, from_url, to_fragment

from .conftest import Page, page_of, without_webgl


def converged(page, limit=120):
    """Wait until the reference is done; returns what it says of itself."""
    page.converge()
    for _ in range(10 * limit):
        if page.run("() => simulator.app.frame.converger?.done === true"):
            return page.run("() => simulator.app.frame.converger.told")
        page.page.wait_for_timeout(100)
    raise AssertionError("the reference did not converge")


FLOOR_POINTS = """() => {
  const {app, lookAt} = simulator, f = app.frame, n = f.size, out = [];
  for (let k = 0; k < n * n; k += 5) {
    const seen = lookAt(f.tables, k % n, Math.floor(k / n));
    if (seen.shape === 1) out.push([seen.q, [0, 1, 2].map((c) => f.pixel_reference[4 * k + c])]);
  }
  return out;
}"""


def test_the_reference_converges_to_the_integral_and_says_how_far(fresh):
    page = fresh(40)
    told = converged(page)
    found = page.values(FLOOR_POINTS)
    assert len(found) > 60
    exact = probe(load("gloss"), [point for point, _ in found], tol=1e-7).gloss
    assert (exact.max(axis=1) > 0.05).sum() > 20
    weight = load("gloss").floor.lobe.weight
    off = weight * (np.array([value for _, value in found]) - exact)
    rms = float(np.sqrt((off**2).mean()))
    assert 1e-6 < rms <= 3 * told["rms"]
    assert told["rms"] < 3e-3
    assert told["within"] >= 0.99
    # both estimates then have an error, not only a difference
    errors = page.run("() => simulator.app.frame.errors")
    assert errors["numeric"] > errors["symbolic"] > 5 * told["rms"]
    assert "RMS error" in page.run("() => document.getElementById('numeric-line').textContent")


def test_the_difference_is_scaled_to_what_is_there(fresh):
    page = fresh(48)
    scale, most = page.run("() => [simulator.app.frame.scale, simulator.app.ledger.most]")
    assert 0 < scale <= 5 * most
    page.change("for (const k of simulator.data.glossy) s.scene[`${k}.lobe.theta_max`] = 0.002")
    assert 0 < page.run("() => simulator.app.frame.scale") < scale / 3
    page.change("s.difference = 3")
    assert page.run("() => simulator.app.frame.scale") == 1e-3
    assert "0.001" in page.run("() => document.getElementById('difference-line').textContent")


@pytest.mark.parametrize("view", ["full", "gloss", "direct", "class", "chambers"])
def test_every_view_has_a_legend(fresh, view):
    page = fresh(32)
    page.change(f"s.view = '{view}'")
    wanted = {"class": "floor", "chambers": "chambers"}.get(view, "linear radiance")
    assert wanted in page.run("() => document.getElementById('legend').textContent")


def test_the_disc_tells_what_a_direction_sees(fresh):
    page = fresh(64)
    page.page.locator("#disc").scroll_into_view_if_needed()
    box = page.page.locator("#disc").bounding_box()
    page.page.mouse.move(box["x"] + 0.7 * box["width"], box["y"] + 0.5 * box["height"])
    found = page.run("() => simulator.app.pointedAt")
    assert found["shape"] == 4
    # the same direction traced again, and drawn in the same place
    again = page.run("""() => {
      const {app, program} = simulator, {t, seen} = app.probedAt, p = app.pointedAt;
      program.disc_place(seen.shape - 1, ...p.w, t.disc, t.lobes);
      return Array.from(program.R.slice(0, 3));
    }""")
    assert again == pytest.approx([found["x"], found["y"], found["theta"]], abs=1e-9)
    text = page.run("() => document.getElementById('direction').textContent")
    assert "sphere C" in text and "radiance" in text
    page.page.locator("#disc").focus()
    page.page.keyboard.press("Shift+ArrowLeft")
    assert page.run("() => simulator.app.pointedAt.x") == pytest.approx(found["x"] - 0.1)


def test_strata_that_carry_nothing_are_named_and_can_be_fed(fresh):
    page = fresh(48)
    text = "() => document.getElementById('carried').textContent"
    assert "Rings 2 to 4 of 4 carry nothing: 12 of 16" in page.run(text)
    page.page.locator("#carried button").click()
    page.settle()
    assert "Each of the 4 rings carries weight" in page.run(text)


def test_space_turns_and_shows_the_scene(fresh):
    page = fresh(32)
    page.run("() => { window.before = document.getElementById('space').toDataURL(); }")
    colors = page.run("""() => {
      const c = document.getElementById('space'), d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data;
      const met = new Set();
      for (let k = 0; k < d.length; k += 4) {
        if (d[k + 3]) met.add((d[k] >> 5) << 6 | (d[k + 1] >> 5) << 3 | d[k + 2] >> 5);
      }
      return met.size;
    }""")
    assert colors > 20
    page.page.locator("#space").focus()
    page.page.keyboard.press("ArrowLeft")
    page.until("document.getElementById('space').toDataURL() !== before")


def test_a_screenshot_holds_its_recipe(fresh):
    page = fresh(48)
    page.change("s.scene['floor.lobe.exponent'] = 31.25; s.lobe = 3")
    with page.page.expect_download() as waiting:
        page.page.locator("#shot").click()
    image = Image.open(waiting.value.path())
    image.load()
    assert image.width > 4 * 320
    assert image.info["symrender.scene"] == "gloss"
    state = from_url(image.info["symrender.link"])
    assert (state.lobe, state.scene["floor.lobe.exponent"]) == (3, 31.25)


def test_what_is_done_can_be_recorded(fresh):
    page = fresh(32)
    size = page.run("""async () => {
      if (typeof MediaRecorder === 'undefined') return null;
      const stop = simulator.recording(simulator.app);
      for (let k = 0; k < 4; k++) {
        await simulator.app.settle((s) => (s.scene['floor.lobe.exponent'] = 8 + 8 * k));
        await new Promise((r) => setTimeout(r, 80));
      }
      return (await stop()).size;
    }""")
    if size is None:
        pytest.skip("this browser has no MediaRecorder")
    assert size > 500


@pytest.mark.parametrize(("width", "height"), [(1920, 1080), (1440, 900), (1366, 768), (1284, 676), (390, 844)])
def test_pictures_and_controls_are_on_one_screen(fresh, width, height):
    page = fresh(32)
    before = page.page.viewport_size
    page.page.set_viewport_size({"width": width, "height": height})
    if width < 500:
        page.page.locator("#sheet").click()
    # the sheet slides
    page.until("!document.getAnimations().some((a) => a.playState === 'running')")
    shown = page.run("""() => {
      const box = (e) => e.getBoundingClientRect(), rail = box(document.getElementById('drawer'));
      const inside = (b) => b.width > 100 && b.top >= 0 && b.bottom <= innerHeight && b.right <= innerWidth;
      const free = (b) => inside(b) && (b.bottom <= rail.top || b.right <= rail.left);
      const panels = [...document.querySelectorAll('.panels canvas')].map((e) => free(box(e)));
      return [...panels, inside(box(document.querySelector('#presets button')))];
    }""")
    assert page.run("() => document.documentElement.scrollWidth <= innerWidth")
    if width > 500:
        # the frame of the chapter is 1284 by 676: it shows the lobe, too
        low = "document.getElementById(name).getBoundingClientRect().bottom"
        shown += page.run(f"() => ['disc', 'space'].map((name) => {low} <= innerHeight)")
    if width < 500:
        page.page.locator("#sheet").click()
    page.page.set_viewport_size(before)
    assert shown == [True] * (7 if width > 500 else 5)


def test_paper_shows_the_pictures_and_no_controls(fresh):
    page = fresh(32)
    page.page.emulate_media(media="print")
    hidden = page.run(
        "() => ['controls', 'views', 'share'].map((n) => document.getElementById(n).getBoundingClientRect().width)"
    )
    shown = page.run("() => [...document.querySelectorAll('.panels canvas, .lobe canvas')].map((e) => e.clientWidth)")
    page.page.emulate_media(media="screen")
    assert hidden == [0, 0, 0]
    assert len(shown) == 6 and min(shown) > 200


def test_without_webgl_the_javascript_program_draws(browser, tmp_path):
    page_of("gloss").save(tmp_path / "page.html")
    context = without_webgl(browser)
    page = Page(context.new_page())
    page.page.goto(f"{(tmp_path / 'page.html').as_uri()}{to_fragment(State(size=24))}")
    page.settle()
    assert "Drawn by JavaScript" in page.run("() => document.getElementById('slow').textContent")
    off = page.run("""() => {
      const {app, glossExact} = simulator, f = app.frame;
      let off = 0, signal = 0;
      for (let k = 0; k < 576; k++) {
        const exact = glossExact('pixel_symbolic', f.tables, k % 24, Math.floor(k / 24));
        for (let c = 0; c < 3; c++) {
          off = Math.max(off, Math.abs(exact[c] - f.pixel_symbolic[4 * k + c]));
          signal = Math.max(signal, exact[c]);
        }
      }
      return [off, signal, app.gpu.slow];
    }""")
    assert off[1] > 0.1 and off[2] is True
    assert off[0] < 2e-5
    assert page.run("() => simulator.app.facts.weight") > 0
    context.close()


def test_without_javascript_there_is_a_picture_and_a_sentence(browser, tmp_path):
    page_of("gloss").save(tmp_path / "page.html")
    context = browser.new_context(java_script_enabled=False)
    page = context.new_page()
    page.goto((tmp_path / "page.html").as_uri())
    assert page.locator(".without img").is_visible()
    assert "JavaScript" in page.locator(".without p").inner_text()
    assert not page.locator("main").is_visible()
    shot = np.asarray(Image.open(io.BytesIO(page.locator(".without img").screenshot())).convert("RGB"), dtype=float)
    assert shot.std() > 20
    assert np.abs(shot[..., 0] - shot[..., 2]).max() > 100
    context.close()


def ask(address, body, **headers):
    request = urllib.request.Request(f"{address}/certify", json.dumps(body).encode(), headers)
    with urllib.request.urlopen(request) as answer:
        return json.loads(answer.read())


def test_a_served_page_is_told_proved_intervals_and_nobody_else_is():
    pytest.importorskip("flint", reason="python-flint is not installed")
    scene = load("gloss")
    page = simulator_page(scene, served=True)
    assert "connect-src 'self'" in page.html.replace("&#x27;", "'")
    assert "connect-src" not in simulator("gloss").html
    point, state = [1.6, -0.2, 0.0], State(scene={"floor.lobe.exponent": 64.0})
    with server(page, scene=scene) as running:
        thread = Thread(target=running.serve_forever)
        thread.start()
        try:
            address = f"http://127.0.0.1:{running.server_port}"
            body = {"fragment": to_fragment(state), "point": point}
            found = ask(address, body, **{"Content-Type": "application/json"})
            exact = probe(state.apply(scene), [point], tol=1e-9).gloss[0]
            assert exact.max() > 0.01
            assert (np.array(found["low"]) <= exact).all() and (exact <= np.array(found["high"])).all()
            assert max(np.subtract(found["high"], found["low"])) < 1e-3
            for wrong, headers in (
                (body, {"Content-Type": "text/plain"}),
                (body, {"Content-Type": "application/json", "Host": "elsewhere:1"}),
                ({"fragment": "#s=x", "point": point}, {"Content-Type": "application/json"}),
                (body | {"point": [0.0, 0.0, 1.0]}, {"Content-Type": "application/json"}),
            ):
                with pytest.raises(urllib.error.HTTPError) as refused:
                    ask(address, wrong, **headers)
                refused.value.close()
        finally:
            running.shutdown()
            thread.join()
