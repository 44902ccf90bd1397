"""The page: whole in one file, moved by its figures and nothing typed, sound in a browser, on a phone and on paper."""

from __future__ import annotations

import ast
import html
import importlib.util
import json
import math
import re
import time
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import pytest

from symrender.chapter import lab
from symrender.chapter.document import build
from symrender.chapter.document.effort import QUICK
from symrender.chapter.document.figures import Figure, Measured, shown
from symrender.chapter.document.laboratory import cell_html
from symrender.chapter.document.measure.geometry import EXPONENT, HALF_ANGLE, PLACE, lobe_path, share_angle
from symrender.chapter.document.page import SECTIONS, compose, prose_text
from symrender.chapter.document.prose import DIRECTIVE, HOLE
from symrender.chapter.lab import Output
from symrender.chapter.write_lab import text
from symrender.cli import main
from symrender.errors import OptionError
from symrender.ledger.lobe_widths import lobe_widths
from symrender.simulator.build import simulator

pytestmark = pytest.mark.timeout(900)
"""The first test waits for a build of everything, half a minute of processor time."""
MOST_BYTES = 5_000_000
THIN = "\N{NARROW NO-BREAK SPACE}"
IDS = (*SECTIONS, "sim", "lab", *lab.names(), "errata", "references", "contents")
STATE = "() => document.getElementById('simulator-frame').contentWindow?.simulator?.app"
AXE = """async () => {
  const page = { exclude: [['math'], ['.lab-cell:not(#cell1) pre']] };
  const { violations } = await axe.run(page, { resultTypes: ['violations'] });
  return violations.map((v) => [v.impact, v.id, v.nodes.slice(0, 3).map((n) => n.html)]);
}"""
"""Formulas are for MathML to make accessible, and the code of one cell stands for that of all."""
DRAWN = f"""() => {{
  const app = ({STATE})();
  return !!(app && app.frame && app.frame.whole && app.frame.generation === app.generation && !app.running);
}}"""


@dataclass(frozen=True)
class Built:
    """What the quick build measured, the page made of it, and the processor seconds both took."""

    measured: Measured
    simulator: str
    page: str
    seconds: float


@pytest.fixture(scope="module")
def built() -> Built:
    begun = time.process_time()
    measured = build.measure(QUICK)
    inside = simulator("gloss").html
    return Built(measured, inside, compose(measured, inside), time.process_time() - begun)


def words(page: str) -> str:
    """What a reader sees, without the data at the end."""
    return re.sub(r"<[^>]*>", "", page[: page.index('<script type="application/json" id="figures">')])


def test_every_section_and_cell_has_its_id(built: Built) -> None:
    found = re.findall(r'\bid="([\w-]+)"', built.page)
    assert not {name for name in IDS if found.count(name) != 1}
    targets = set(re.findall(r'href="#([\w-]+)"', built.page))
    assert len(targets) > 25
    assert not targets - set(found)


def test_no_name_is_given_twice(built: Built) -> None:
    found = re.findall(r'\bid="([\w-]+)"', built.page)
    assert len(found) > 60
    assert sorted(name for name in set(found) if found.count(name) > 1) == []


def test_the_page_is_whole_and_light(built: Built) -> None:
    assert 300_000 < len(built.page.encode()) < MOST_BYTES
    loaded = re.findall(r'(?:src|href)="([^"#]{1,40})', built.page)
    assert len(loaded) > 20
    assert {text.split(":")[0] for text in loaded if not text.startswith("https://doi.org/10.")} == {"data"}
    assert "url(" not in re.sub(r'url\((?:"data:|#|&quot;)', "", built.page.split("</style>")[0])
    assert "@{" not in words(built.page) and "\ue000" not in built.page


def test_every_hole_is_a_figure_of_this_build(built: Built) -> None:
    names = {h[1] for name in ("opening", *SECTIONS) for h in HOLE.finditer(prose_text(name))}
    assert names <= set(built.measured.figures)
    receipts = json.loads(re.search(r'id="figures">(.*?)</script>', built.page)[1])
    assert {name: entry[0] for name, entry in receipts.items()} == {
        name: figure.value for name, figure in built.measured.figures.items()
    }
    assert all(figure.source for figure in built.measured.figures.values())


def second_opinion() -> Any:
    """The program of docs/ that recomputes figures."""
    path = Path(__file__).resolve().parents[2] / "docs" / "second_opinion.py"
    tree = ast.parse(path.read_text(encoding="utf-8"))
    imported = {a.name for node in ast.walk(tree) if isinstance(node, ast.Import) for a in node.names}
    imported |= {str(node.module) for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)}
    assert imported and not [name for name in imported if name.startswith("symrender")]
    spec = importlib.util.spec_from_file_location("second_opinion", path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_figures_are_recomputed_without_the_package(built: Built) -> None:
    """Figures that code of its own finds again; what remains are settings, times, and errors measured against it."""
    opinion = second_opinion()
    held = {name: [figure.value, figure.source] for name, figure in built.measured.figures.items()}
    names, differ = opinion.compared(held)
    assert differ == []
    shown_names = {h[1] for name in ("opening", *SECTIONS) for h in HOLE.finditer(prose_text(name))}
    assert len(shown_names & set(names)) > 100
    # and a figure that is off by little more than its room is named
    opinion.SUBJECTS = (opinion.arithmetic, opinion.classes, opinion.one_ray, opinion.anchor)
    for name, factor in (("claims.axis", 1 + 1e-8), ("claims.a_true", 1871 / 1872), ("claims.kiss", 1.00001),
                         ("digits.green", 1 + 1e-12), ("anchor.symbolic.wall_slope", 1.05)):  # fmt: skip
        wrong = held | {name: [float(held[name][0]) * factor, held[name][1]]}
        assert [line.split(":")[0] for line in opinion.compared(wrong)[1]] == [name]


def test_what_is_measured_is_shown(built: Built) -> None:
    """A block no prose asks for is work for nothing."""
    texts = [prose_text(name) for name in ("opening", *SECTIONS)]
    directives = [DIRECTIVE.fullmatch(line) for text in texts for line in text.splitlines()]
    assert {found[2] for found in directives if found} == set(built.measured.blocks)


@pytest.mark.parametrize(
    ("name", "value", "text"),
    [
        ("claims.a_true", 1871, "1 871"),
        ("pitfalls.ratio_two", 0.4321, "+43.2 %"),
        ("anchor.symbolic.slope", -0.95, "−0.950"),
        ("rays.worst", 3e-12, "3.0 × 10"),
    ],
)
def test_another_figure_is_another_text(built: Built, name: str, value: float, text: str) -> None:
    figure = built.measured.figures[name]
    figures = {**built.measured.figures, name: Figure(value, figure.source)}
    changed = words(compose(replace(built.measured, figures=figures), built.simulator))
    before = words(built.page).split("\n")
    differ = [line for line, old in zip(changed.split("\n"), before, strict=True) if line != old]
    assert differ
    assert any(text in line.replace("\N{NARROW NO-BREAK SPACE}", " ") for line in differ)
    assert len(differ) <= 3


def test_a_figure_that_breaks_a_claim_breaks_the_build(built: Built) -> None:
    broken = {**built.measured.figures, "claims.midpoint_two": Figure(1.0, "")}
    with pytest.raises(OptionError, match=r"s10\.md: @holds claims\.midpoint_two < claims\.exact_two: measured 1 <"):
        compose(replace(built.measured, figures=broken), built.simulator)
    missing = {k: v for k, v in built.measured.figures.items() if k != "claims.a_true"}
    with pytest.raises(OptionError, match=r"s10\.md: no figure is called 'claims\.a_true'"):
        compose(replace(built.measured, figures=missing), built.simulator)


def test_the_page_prints_the_same_errata(built: Built) -> None:
    """One measurement in both places: what does not depend on how much a build measures is compared digit by digit."""
    page = (Path(__file__).resolve().parents[2] / "docs" / "chapter.md").read_text("utf-8")
    plain = lambda name, form: shown(built.measured.figures[name].value, form).replace(THIN, " ")  # noqa: E731
    buried = ", ".join(plain(f"claims.buried_{angle}", "percent") for angle in (30, 20, 10))
    assert f"{buried} of the gloss seen" in page
    widths = [plain(f"claims.{name}", ".3f") for name in ("ruler", "axis", "rms")]
    assert "n = 16: {}; per axis {}, RMS angle {} |".format(*widths) in page
    counted = [plain(f"claims.{name}", "count").replace(" ", "") for name in ("b_printed", "a_true", "b_true")]
    assert "sphere B fills {} of 4096 pixels; repaired: A {}, B {},".format(*counted) in page


def test_outputs_of_a_cell_are_shown_as_they_are() -> None:
    cell = lab.load("cell1")
    code = next(k for k, part in enumerate(cell.parts) if part.kind == "code")
    outputs = (
        Output(code, "text", "a < b & c\n"),
        Output(code, "html", "<b>rich</b>"),
        Output(code, "png", b"\x89PNG", "a picture"),
        Output(code, "svg", '<svg onload="alert(1)"></svg>', 'a "plot"'),
    )
    made = cell_html(cell, outputs)
    assert '<pre class="out" tabindex="0">a &lt; b &amp; c</pre>' in made
    assert "<b>rich</b>" in made and 'alt="a picture" src="data:image/png;base64,' in made
    assert 'alt="a &quot;plot&quot;" src="data:image/svg+xml;base64,' in made and "onload" not in made
    assert made.count("Not run") == 0 and "Not run in this build" in cell_html(cell, None)
    parts = re.findall(r'<pre class="code"[^>]*><code>(.*?)</code></pre>', made, re.S)
    code_text = [html.unescape(re.sub(r"<[^>]*>", "", t)) for t in parts]
    assert code_text == [part.text.strip("\n") for part in cell.parts if part.kind == "code"]
    held = re.search(r'id="notebook-cell1">(.*?)</script>', made, re.S)[1]
    assert "<" not in held
    assert json.loads(held) == text(lab.notebook(cell))


def test_the_command_refuses_before_it_works(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "chapter8.html"
    path.write_text("mine")
    assert main(["chapter", "-o", str(path)]) == 74
    assert path.read_text() == "mine"
    assert main(["chapter", "--help"]) == 0
    assert "chapter8.html" in capsys.readouterr().out


@pytest.fixture(scope="module")
def opened(browser: Any, built: Built, tmp_path_factory: pytest.TempPathFactory) -> tuple[Any, str]:
    path = tmp_path_factory.mktemp("chapter") / "chapter8.html"
    path.write_text(built.page, encoding="utf-8")
    return browser, path.as_uri()


class Reader:
    """A page that remembers what it asked for and what it complained of."""

    def __init__(self, opened: tuple[Any, str], **options: Any) -> None:
        browser, self.address = opened
        self.context = browser.new_context(**options)
        self.requests: list[str] = []
        self.complaints: list[str] = []
        self.context.on("request", lambda request: self.requests.append(request.url))
        self.page = self.context.new_page()
        self.page.on("pageerror", lambda error: self.complaints.append(str(error)))
        self.page.on("console", lambda m: self.complaints.append(m.text) if m.type == "error" else None)
        self.session = self.context.new_cdp_session(self.page)
        # processor time of the page's thread, whatever else the machine does
        self.session.send("Performance.enable", {"timeDomain": "threadTicks"})
        self.page.goto(self.address)

    def seconds(self) -> float:
        """Processor time the page has taken."""
        metrics = self.session.send("Performance.getMetrics")["metrics"]
        return next(m["value"] for m in metrics if m["name"] == "TaskDuration")

    def close(self) -> None:
        foreign = [u for u in self.requests if not u.startswith((self.address, "data:", "blob:", "about:"))]
        self.context.close()
        assert foreign == []
        assert self.complaints == []


def test_it_opens_at_once_and_works(opened: tuple[Any, str]) -> None:
    reader = Reader(opened, viewport={"width": 1280, "height": 900}, offline=True, accept_downloads=True)
    page = reader.page
    assert page.evaluate("() => performance.getEntriesByType('navigation')[0].loadEventEnd") > 0
    assert 0 < reader.seconds() < 3
    assert page.evaluate("(ids) => ids.filter((id) => !document.getElementById(id))", list(IDS)) == []
    assert page.evaluate("() => document.fonts.check('16px \"Chapter Math\"', 'θ')")
    assert page.evaluate("() => document.querySelectorAll('math').length") > 60
    broken = "() => [...document.images].filter((i) => i.complete && !i.naturalWidth).length"
    assert page.evaluate(broken) == 0
    assert not page.locator("#simulator-frame").is_visible()
    page.locator("data.figure").first.click()
    assert "source.assistant" in page.locator("#receipt").inner_text()
    with page.expect_download() as download:
        page.locator('[data-notebook="cell2"]').click()
    saved = json.loads(Path(download.value.path()).read_text(encoding="utf-8"))
    assert download.value.suggested_filename == "cell2.ipynb"
    assert saved["nbformat"] == 4
    page.evaluate("""() => Object.defineProperty(navigator, "clipboard", {
      value: { writeText: async (text) => { window.copied = text; } },
    })""")
    page.locator('[data-copy="cell2"]').click()
    copied = page.evaluate("() => window.copied")
    assert copied.startswith("# of a wheel: pip install 'FILE.whl")
    assert "# in a clone: pip install '.[notebook]'" in copied
    ast.parse(copied)
    line = page.locator(".compare input")
    line.focus()
    page.keyboard.press("Home")
    assert page.evaluate("() => document.querySelector('.compare').style.getPropertyValue('--at')") == "0%"
    reader.close()


def test_the_simulator_inside_draws_and_takes_its_presets(opened: tuple[Any, str]) -> None:
    reader = Reader(opened, viewport={"width": 1100, "height": 800}, offline=True)
    page = reader.page
    assert page.evaluate(f"() => !({STATE})()")
    page.locator("#sim").scroll_into_view_if_needed()
    page.wait_for_function(f"() => !!({STATE})()?.change", timeout=60_000)
    assert not page.locator("#simulator-poster").is_visible()
    page.evaluate(f"() => ({STATE})().change((s) => {{ s.size = 48; }})")
    page.wait_for_function(DRAWN, timeout=120_000)
    page.evaluate("() => document.querySelector('[data-preset=\"4\"]').click()")
    page.wait_for_function(f"() => ({STATE})().state.partition === 'equal_weight'", timeout=60_000)
    reader.close()


@pytest.mark.parametrize(("scheme", "width"), [("light", 1280), ("dark", 390)])
def test_it_can_be_read_by_everyone(opened: tuple[Any, str], scheme: str, width: int) -> None:
    axe_module = pytest.importorskip("axe_playwright_python", reason="axe-playwright-python is not installed")
    source = (Path(axe_module.__file__).parent / "axe.min.js").read_text(encoding="utf-8")
    reader = Reader(opened, color_scheme=scheme, viewport={"width": width, "height": 900})
    page = reader.page
    assert page.evaluate("() => document.documentElement.scrollWidth <= innerWidth")
    page.evaluate("() => { for (const d of document.querySelectorAll('details')) d.open = true; }")
    assert page.evaluate("() => document.documentElement.scrollWidth <= innerWidth")
    page.evaluate(source)
    found = page.evaluate(AXE)
    assert found == []
    reader.close()


def test_it_prints(opened: tuple[Any, str]) -> None:
    reader = Reader(opened, color_scheme="dark")
    paper = reader.page.pdf(format="A4", prefer_css_page_size=True)
    assert paper.startswith(b"%PDF")
    assert 12 < paper.count(b"/Type /Page\n") + paper.count(b"/Type /Page ") < 90
    reader.close()


def test_the_drawing_before_the_integral_answers(opened: tuple[Any, str]) -> None:
    """The point and the numbers are dragged or moved by keys; the drawing and every sentence about the lobe follow."""
    reader = Reader(opened, viewport={"width": 1100, "height": 900})
    page = reader.page
    section = page.locator("#s3").inner_html()
    assert section.index('id="fig-lobe-geometry"') < section.index('class="display"')
    text = lambda name: page.locator(f'[data-live="{name}"]').first.inner_text()  # noqa: E731
    assert text("half") == f"{share_angle(0.5, EXPONENT, HALF_ANGLE):.1f}°"
    before = page.locator("#geometry .lobe").first.get_attribute("d")
    assert before == lobe_path(EXPONENT, HALF_ANGLE, math.atan2(204.0, 190.0))
    page.locator("[data-drag=n]").first.focus()
    for _ in range(4):
        page.keyboard.press("ArrowRight")
    page.locator("[data-drag=theta]").first.focus()
    page.keyboard.press("End")
    assert [page.locator("[data-drag=n]").nth(k).inner_text() for k in (0, 1)] == ["24", "24"]
    assert text("half") == f"{share_angle(0.5, 24.0, 90.0):.1f}°"
    assert text("rms") == f"{math.degrees(lobe_widths('', 24.0, math.pi / 2).rms_angle):.1f}°"
    assert page.locator("#geometry .lobe").first.get_attribute("d") != before
    assert "below the floor" in text("horizon")
    page.keyboard.press("Home")
    assert text("horizon") == "All of the cone lies above the floor."
    page.locator("#geometry").scroll_into_view_if_needed()
    number, point = page.locator("[data-drag=n]").first.bounding_box(), page.locator("#geometry-point").bounding_box()
    for box, by in ((number, 60), (point, 50)):
        page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
        page.mouse.down()
        page.mouse.move(box["x"] + box["width"] / 2 + by, box["y"] + box["height"] / 2, steps=3)
        page.mouse.up()
    assert page.locator("[data-drag=n]").first.inner_text() == "48"
    scale = page.locator("#geometry").bounding_box()["width"] / 680.0
    moved = float(page.locator("#geometry-point").get_attribute("aria-valuenow"))
    assert moved == pytest.approx(PLACE + 50.0 / scale, abs=1.0)
    reader.close()


def test_a_lobe_is_built_up_without_a_program(opened: tuple[Any, str]) -> None:
    reader = Reader(opened, viewport={"width": 1100, "height": 900}, java_script_enabled=False)
    page = reader.page
    stages = page.locator(".stages label")
    assert stages.count() == 5
    for k in range(5):
        stages.nth(k).click()
        shown = [page.locator(f".stages g.stage-{j}").is_visible() for j in (1, 2, 3, 5)]
        assert shown == [k == j for j in (0, 1, 2, 4)]
    reader.context.close()


def test_the_laboratory_is_folded_and_its_addresses_open_it(opened: tuple[Any, str]) -> None:
    reader = Reader(opened, viewport={"width": 1100, "height": 800})
    page = reader.page
    assert page.evaluate("() => [...document.querySelectorAll('.lab-cell details')].filter((d) => d.open).length") == 0
    argument = page.evaluate("""() => ['s1', 's2', 's3', 's4', 's6', 's7'].reduce((sum, id) => {
      const words = document.getElementById(id).cloneNode(true);
      words.querySelectorAll('details, script, table, svg, math').forEach((e) => e.remove());
      return sum + words.textContent.trim().split(/\\s+/).length;
    }, 0)""")
    # what the opening calls the argument: a quarter of an hour at 220 words a minute
    assert 2500 < argument <= 3300
    page.evaluate("() => { document.documentElement.style.scrollBehavior = 'auto'; location.hash = '#cell7'; }")
    page.wait_for_function("() => document.querySelector('#cell7 details').open")
    reader.close()


def test_no_heading_of_the_outline_is_empty(opened: tuple[Any, str]) -> None:
    reader = Reader(opened, viewport={"width": 1366, "height": 768})
    headings = reader.page.locator("h1, h2, h3, h4").evaluate_all("(all) => all.map((one) => one.innerText.trim())")
    assert len(headings) > 45
    assert "" not in headings
    assert reader.page.locator(".lab-cell .step").count() > 25
    reader.close()


@pytest.mark.parametrize("width", [1366, 390])
def test_an_address_of_a_cell_shows_its_heading(opened: tuple[Any, str], width: int) -> None:
    """Also on a slow machine, where pictures and letters arrive after the page has scrolled."""
    browser, address = opened
    context = browser.new_context(viewport={"width": width, "height": 768})
    page = context.new_page()
    context.new_cdp_session(page).send("Emulation.setCPUThrottlingRate", {"rate": 4})
    for name in ("cell5", "cell13"):
        page.goto("about:blank")
        page.goto(f"{address}#{name}")
        page.wait_for_function(f"() => document.querySelector('#{name} details').open")
        bar = "() => document.getElementById('bar').getBoundingClientRect().bottom"
        heading = f"() => document.querySelector('#{name} h3').getBoundingClientRect().top"
        page.wait_for_timeout(300)
        below = page.evaluate(heading) - page.evaluate(bar)
        assert 0 < below < 100
        # what comes in late above it moves nothing
        page.evaluate(
            "() => document.getElementById('s2').insertAdjacentHTML('beforeend', '<p style=height:900px></p>')"
        )
        page.wait_for_timeout(300)
        assert abs(page.evaluate(heading) - page.evaluate(bar) - below) < 2
    context.close()


@pytest.mark.parametrize("first", ["s6", "errata"])
def test_an_address_lands_where_it_says(opened: tuple[Any, str], first: str) -> None:
    """Also past the simulator, which starts on the way to the first and must move nothing."""
    reader = Reader(opened, viewport={"width": 1366, "height": 768}, reduced_motion="reduce")
    page = reader.page
    page.evaluate("() => document.getElementById('sim').scrollIntoView()")
    page.wait_for_function("() => !document.getElementById('simulator-frame').hidden")
    for name in (first, "s4", "sim", "s10"):
        top = f"() => document.getElementById('{name}').getBoundingClientRect().top"
        page.evaluate("() => scrollTo(0, 0)")
        assert abs(page.evaluate(top) - 64) > 100
        page.evaluate(f"() => {{ location.hash = '#{name}'; }}")
        page.wait_for_function(f"() => Math.abs(({top})() - 64) < 4")
    reader.close()


@pytest.mark.parametrize(("width", "height"), [(1366, 768), (1600, 900), (390, 844)])
def test_the_first_screen_is_one_picture_and_one_slider(opened: tuple[Any, str], width: int, height: int) -> None:
    reader = Reader(opened, viewport={"width": width, "height": height})
    page = reader.page
    box = page.locator(".stepped").bounding_box()
    assert box["y"] > 0 and box["y"] + box["height"] < height
    controls = page.locator("header input, header [role=slider]")
    assert controls.count() == 1
    assert page.locator(".lead").bounding_box()["y"] > box["y"] + box["height"]
    shown = lambda: page.evaluate("() => document.querySelector('.stepped img.now').dataset.value")  # noqa: E731
    assert shown() == page.locator(".stepped output").inner_text() == "256"
    controls.focus()
    page.keyboard.press("End")
    assert shown() == page.locator(".stepped output").inner_text() == "16384"
    page.keyboard.press("Home")
    assert shown() == controls.get_attribute("aria-valuetext") == "4"
    assert page.locator(".stepped img:visible").count() == 1
    marked = page.locator(".contents .path").all_inner_texts()
    assert [text.split()[0] for text in marked] == ["1", "2", "3", "4", "6", "7"]
    reader.close()


def test_paper_has_what_the_screen_has(opened: tuple[Any, str]) -> None:
    """Where the simulator is there is a picture, started or not; nothing stands beyond the sheet."""
    reader = Reader(opened, viewport={"width": 672, "height": 1000})
    page = reader.page
    page.evaluate("() => document.getElementById('simulator-start').click()")
    page.emulate_media(media="print")
    assert page.locator("#simulator-poster img").is_visible()
    assert not page.locator("#simulator-frame").is_visible()
    beyond = """() => [...document.querySelectorAll('footer li, main p, figure, table')]
      .filter((e) => e.getBoundingClientRect().right > innerWidth + 1 || e.getBoundingClientRect().left < -1).length"""
    assert page.evaluate("() => document.querySelectorAll('footer li').length") > 15
    assert page.evaluate(beyond) == 0
    assert page.evaluate("() => parseFloat(getComputedStyle(document.querySelector('ol.references')).paddingLeft)") > 30
    reader.close()
