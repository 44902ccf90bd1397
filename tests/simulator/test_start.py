"""What a page shows first, its figures, its reference while it is worse than what it judges, and one picture alone."""

from __future__ import annotations

import re

BRIGHTNESS = """(id) => {
  const canvas = document.getElementById(id), size = canvas.width;
  const bytes = canvas.getContext("2d").getImageData(0, 0, size, size).data;
  let sum = 0;
  for (let k = 0; k < bytes.length; k += 4) sum += bytes[k] + bytes[k + 1] + bytes[k + 2];
  return [size, sum / (765 * size * size)];
}"""


def test_a_page_shows_a_picture_before_its_shaders_are_compiled(browser, tmp_path):
    from .conftest import Page, page_of

    path = tmp_path / "page.html"
    page_of("gloss").save(path)
    context = browser.new_context()
    # no program is ever ready, so that what is seen is what a reader sees while they are compiled
    context.add_init_script("""WebGL2RenderingContext.prototype.getProgramParameter = ((own) => function (made, what) {
      return what === 0x91B1 ? false : own.call(this, made, what);
    })(WebGL2RenderingContext.prototype.getProgramParameter);""")
    page = Page(context.new_page())
    page.page.goto(path.as_uri())
    page.until("window.simulator?.app.baked")
    page.until("document.getElementById('numeric-line').textContent.startsWith('compiling shaders')")
    assert page.run("() => simulator.app.frame") is None
    for panel in ("numeric", "symbolic"):
        size, brightness = page.run(BRIGHTNESS, f"panel-{panel}")
        assert size > 100 and brightness > 0.05
        assert page.run(f"() => document.getElementById('{panel}-note').textContent") == "drawn beforehand"
    assert not page.page.locator(".cursor").first.is_visible()
    context.close()


def test_a_reference_is_shown_once_it_is_better_than_both(fresh):
    page = fresh(40)
    waiting = "document.getElementById('panel-reference').classList.contains('waiting')"
    assert page.run(f"() => {waiting}")
    assert page.run("() => getComputedStyle(document.getElementById('panel-reference')).opacity") == "0"
    page.converge()
    page.until(f"!{waiting}")
    found = page.run("""() => {
      const { frame } = simulator.app, { told, done } = frame.converger;
      return [done, told.rms, frame.errors.numeric, frame.errors.symbolic];
    }""")
    assert found[0] or found[1] < min(found[2:])
    assert min(found[2:]) > 1e-3
    page.converge(False)
    page.change("s.seed = 11")
    assert page.run(f"() => {waiting}")


def test_figures_are_folded_and_have_units_and_hints(fresh):
    page = fresh(40)
    assert not page.page.locator("#ledger").is_visible()
    line = page.page.locator("#readouts-line").inner_text()
    assert re.search(r"RMS difference [\d.e-]+ radiance, [\d.]+ % of what a black image would score", line)
    page.page.locator("#readouts summary").click()
    rows = page.page.locator("#ledger > div")
    assert rows.count() >= 9
    for k in range(rows.count()):
        term, value, hint = (rows.nth(k).locator(part).inner_text() for part in ("dt", "dd:not(.hint)", "dd.hint"))
        assert re.search(r"\d (?:radiance|%|pixels)|\d°$", value), (term, value)
        assert rows.nth(k).locator("dd.hint").is_visible() and len(hint) > 15, term
    page.page.locator("#readouts summary").click()


def test_one_picture_fills_the_stage(fresh):
    page = fresh(40)
    widths = lambda: page.run("() => [...document.querySelectorAll('.panels canvas')].map((c) => c.clientWidth)")  # noqa: E731
    four = widths()
    assert min(four) > 100 and max(four) - min(four) <= 1
    page.page.keyboard.press("o")
    page.page.keyboard.press("o")
    one = widths()
    assert one[0] == one[2] == one[3] == 0 and one[1] > 1.8 * four[1]
    assert page.run("() => document.getElementById('pictures-symbolic').checked")
    mark, picture = (page.page.locator(name).nth(1).bounding_box() for name in (".cursor", ".panels canvas"))
    assert picture["x"] < mark["x"] < picture["x"] + picture["width"]
    assert picture["y"] < mark["y"] < picture["y"] + picture["height"]
    page.page.locator("label[for=pictures-all]").click()
    assert widths() == four
