"""The report in a browser: pictures, keys, line, values, accessibility, no request."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from symrender.report.build import Report

AXE = """async (page) => {
  const { violations } = await axe.run(document, { resultTypes: ['violations'] });
  return violations.map((v) => [v.impact, v.id, v.nodes.map((n) => n.html.slice(0, 90))]);
}"""
PIXEL = "(name) => [...report.stage.sheet(name).getContext('2d').getImageData(20, 26, 1, 1).data]"


@pytest.fixture
def opened(browser: Any, made: tuple[Report, Path], request: pytest.FixtureRequest) -> Iterator[Any]:
    errors: list[str] = []
    requests: list[str] = []
    context = browser.new_context(**getattr(request, "param", {"viewport": {"width": 1366, "height": 768}}))
    page = context.new_page()
    page.on("pageerror", lambda error: errors.append(str(error)))
    page.on("request", lambda asked: requests.append(asked.url))
    page.goto(made[1].as_uri())
    for _ in range(200):
        # its own policy forbids what Playwright would evaluate inside while it waits
        if page.evaluate("() => !!(window.report && report.stage.place)"):
            break
        page.wait_for_timeout(50)
    else:
        raise AssertionError(f"the page did not open: {errors}")
    yield page
    context.close()
    assert errors == [] and requests == [made[1].as_uri()]


def text(page: Any, name: str) -> str:
    return str(page.locator(f"#{name}").inner_text())


def test_pictures_and_controls_stand_on_one_screen(opened: Any) -> None:
    for name in ("picture", "cards", "values", "exposure", "layer", "beside", "gap"):
        box = opened.locator(f"#{name}").bounding_box()
        assert box["y"] >= 0 and box["y"] + box["height"] <= 768, name
        assert box["x"] >= 0 and box["x"] + box["width"] <= 1366, name


def test_it_opens_on_the_worst_pixel_with_its_error(opened: Any, made: tuple[Report, Path]) -> None:
    i, j = made[0].demo.judgement.judged[0].comparisons["radiance"].whole.pixel
    assert f"({i}, {j})" in text(opened, "where")
    radiance = made[0].demo.truth.radiance[j, i]
    assert [f"{value:.5f}" for value in radiance] == opened.locator("#values tr:first-child td").all_inner_texts()[:3]
    assert opened.locator("#values tr:first-child td").all_inner_texts()[3].startswith("± 0.0")


def test_keys_flip_the_pictures(opened: Any) -> None:
    for number, name in enumerate(("truth", "numeric", "symbolic", "difference"), 1):
        opened.keyboard.press(str(number))
        assert text(opened, "tag-left") == name
        assert opened.locator("#handle").get_attribute("aria-valuenow") == "100"
        assert opened.locator("#cards button").nth(number - 1).get_attribute("aria-pressed") == "true"
    assert "numeric − truth" in text(opened, "legend")
    opened.keyboard.press("0")
    assert opened.locator("#handle").get_attribute("aria-valuenow") == "50"


def test_the_line_is_dragged_and_moved_by_keys(opened: Any) -> None:
    box = opened.locator("#stage").bounding_box()
    opened.mouse.move(box["x"] + 0.5 * box["width"], box["y"] + 40)
    opened.mouse.down()
    opened.mouse.move(box["x"] + 0.2 * box["width"], box["y"] + 60)
    opened.mouse.up()
    assert opened.locator("#handle").get_attribute("aria-valuenow") == "20"
    opened.locator("#handle").focus()
    opened.keyboard.press("ArrowRight")
    assert opened.locator("#handle").get_attribute("aria-valuenow") == "22"
    opened.keyboard.press("End")
    assert opened.locator("#handle").get_attribute("aria-valuenow") == "100"


def test_the_pointer_and_the_arrows_read_values(opened: Any) -> None:
    box = opened.locator("#stage").bounding_box()
    opened.mouse.move(box["x"] + 10.5 / 32 * box["width"], box["y"] + 20.5 / 32 * box["height"])
    assert "(10, 20)" in text(opened, "where")
    opened.keyboard.press("ArrowDown")
    opened.keyboard.press("Shift+ArrowRight")
    assert "(20, 21)" in text(opened, "where")


def test_exposure_changes_light_and_difference(opened: Any) -> None:
    before = {name: opened.evaluate(PIXEL, name) for name in ("truth", "difference")}
    opened.keyboard.press("]")
    opened.keyboard.press("]")
    assert text(opened, "stops") == "+0.50"
    for name, old in before.items():
        new = opened.evaluate(PIXEL, name)
        assert new[3] == 255 and sum(new[:3]) > sum(old[:3]), name


def test_gloss_alone_is_another_figure(opened: Any) -> None:
    before = opened.locator("#cards button").nth(1).inner_text()
    opened.keyboard.press("g")
    assert opened.locator("#cards button").nth(1).inner_text() != before
    assert text(opened, "where").startswith("gloss term")


def test_the_ledger_leads_to_its_pixels(opened: Any, made: tuple[Report, Path]) -> None:
    i, j = made[0].demo.judgement.judged[1].comparisons["gloss"].whole.pixel
    opened.locator("#ledger button").nth(3).click()
    assert f"gloss term at pixel ({i}, {j})" in text(opened, "where") and text(opened, "tag-left") == "symbolic"


@pytest.mark.parametrize(
    "opened",
    [
        {"viewport": {"width": 1600, "height": 1000}, "color_scheme": "light"},
        {"viewport": {"width": 390, "height": 844}, "color_scheme": "dark"},
    ],
    ids=["wide-light", "phone-dark"],
    indirect=True,
)
def test_it_can_be_read_by_everyone(opened: Any) -> None:
    axe_module = pytest.importorskip("axe_playwright_python", reason="axe-playwright-python is not installed")
    assert opened.evaluate("() => document.documentElement.scrollWidth <= innerWidth")
    opened.evaluate((Path(axe_module.__file__).parent / "axe.min.js").read_text(encoding="utf-8"))
    assert opened.evaluate(AXE) == []


def test_paper_shows_the_whole_ledger(opened: Any) -> None:
    opened.set_viewport_size({"width": 720, "height": 1000})
    opened.emulate_media(media="print")
    assert opened.evaluate("() => document.getElementById('ledger').rows.length") >= 6
    assert opened.evaluate("() => document.querySelector('.ledger').getBoundingClientRect().right <= innerWidth")
    assert not opened.locator(".controls").is_visible()
