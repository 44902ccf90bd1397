from __future__ import annotations

import functools
import json
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from symrender.simulator.build import Simulator, simulator

SETTLED = """() => {
  const app = window.simulator?.app;
  const trouble = document.getElementById('trouble');
  if (trouble && !trouble.hidden) return trouble.textContent;
  return !!(app && app.frame && app.frame.whole && app.frame.generation === app.generation && !app.running
    && app.facts && app.frame.size === app.state.size);
}"""

FROM_THE_TOP = """() => {
  document.body.tabIndex = -1;
  document.body.focus();
  document.body.removeAttribute('tabindex');
  scrollTo(0, 0);
}"""
"""Tab goes on from where an earlier test clicked, even once nothing has the focus; from the body it starts anew."""


@functools.cache
def page_of(name: str) -> Simulator:
    """The page of a gallery scene, compiled once for all tests in a browser: it is the same bytes each time."""
    return simulator(name)


def without_webgl(browser: Any) -> Any:
    """A context of the browser whose pages have no WebGL 2."""
    context = browser.new_context()
    context.add_init_script("""HTMLCanvasElement.prototype.getContext = ((own) => function (kind, ...rest) {
      return kind === "webgl2" ? null : own.call(this, kind, ...rest);
    })(HTMLCanvasElement.prototype.getContext);""")
    return context


class Page:
    """A simulator's page: waits by asking, since its own policy forbids what Playwright would evaluate inside."""

    def __init__(self, page: Any) -> None:
        self.page = page

    def settle(self, limit: float = 120.0) -> None:
        end = time.monotonic() + limit
        while time.monotonic() < end:
            found = self.page.evaluate(SETTLED)
            assert not isinstance(found, str), found
            if found:
                return
            time.sleep(0.03)
        raise AssertionError("the page did not settle")

    def until(self, condition: str, limit: float = 120.0) -> Any:
        """Wait until ``condition``, an expression, is true in the page, and return it: no machine is too slow."""
        end = time.monotonic() + limit
        while not (found := self.page.evaluate(f"() => {condition}")):
            assert time.monotonic() < end, f"never true: {condition}"
            time.sleep(0.03)
        return found

    def change(self, edit: str) -> None:
        """Run ``edit`` on the state ``s`` and wait for the picture."""
        self.page.evaluate(f"() => simulator.app.change((s) => {{ {edit} }})")
        self.settle()

    def converge(self, on: bool = True) -> None:
        """Let the reference go on, or stand still: it takes a processor for seconds, and few tests ask for it."""
        self.page.evaluate("(on) => { simulator.app.paused = !on; if (on) simulator.app.rest(); }", on)

    def run(self, code: str, argument: Any = None) -> Any:
        return self.page.evaluate(code, argument)

    def values(self, code: str, argument: Any = None) -> Any:
        """The same for many numbers: as one text they come through ten times as fast. What is not finite is None."""
        return json.loads(self.page.evaluate(f"async (a) => JSON.stringify(await ({code})(a))", argument))


@pytest.fixture(scope="session")
def gloss_page(browser: Any, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Page]:
    """The default scene's page, opened once: compiling its shaders takes longer than most tests."""
    from symrender.simulator.state import State, to_fragment

    path = tmp_path_factory.mktemp("gloss") / "page.html"
    page_of("gloss").save(path)
    context = browser.new_context(viewport={"width": 1200, "height": 900})
    page, errors = context.new_page(), []
    page.on("pageerror", lambda error: errors.append(str(error)))
    page.goto(f"{path.as_uri()}{to_fragment(State(size=32))}")
    opened = Page(page)
    opened.settle()
    opened.converge(False)
    yield opened
    context.close()
    assert errors == []


@pytest.fixture
def fresh(gloss_page: Page) -> Callable[[int], Page]:
    """The page of the default scene in its first state, at a size."""

    def reset(size: int) -> Page:
        gloss_page.converge(False)
        gloss_page.change(f"Object.assign(s, structuredClone(simulator.data.defaults), {{size: {size}, cursor: null}})")
        gloss_page.run(FROM_THE_TOP)
        return gloss_page

    return reset


@pytest.fixture
def open_page(browser: Any, tmp_path: Path) -> Iterator[Callable[..., Page]]:
    """Open the page of a scene in a fresh context; any error of the page fails the test."""
    contexts: list[Any] = []
    errors: list[str] = []

    def open_one(scene: Any = "gloss", fragment: str = "", size: int | None = 96, **options: Any) -> Page:
        made = scene if isinstance(scene, Simulator) else page_of(scene)
        path = tmp_path / f"page{len(contexts)}.html"
        made.save(path)
        context = browser.new_context(**options)
        contexts.append(context)
        page = context.new_page()
        page.on("pageerror", lambda error: errors.append(str(error)))
        if size is not None and not fragment:
            from symrender.simulator.state import State, to_fragment

            fragment = to_fragment(State(size=size))
        page.goto(f"{path.as_uri()}{fragment}")
        opened = Page(page)
        opened.settle()
        opened.converge(False)
        return opened

    yield open_one
    for context in contexts:
        context.close()
    assert errors == []
