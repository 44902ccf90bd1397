"""Draws docs/images/simulator.webp: the page of the default scene in a browser; needs Playwright and Chromium."""

from __future__ import annotations

import io
import sys
import tempfile
from pathlib import Path

from PIL import Image
from playwright.sync_api import sync_playwright

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from tests.conftest import CHROMIUM, FLAGS
from tests.simulator.conftest import Page

from symrender.simulator.build import simulator
from symrender.simulator.state import State, to_fragment

VIEWPORT, SIZE, QUALITY = {"width": 1440, "height": 900}, 256, 82
_MOST_WAITS = 240
TARGET = Path(__file__).resolve().parent / "images" / "simulator.webp"


def main() -> None:
    """Open, wait for the reference, photograph."""
    with sync_playwright() as playwright, tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "page.html"
        simulator("gloss", file)
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        page = Page(browser.new_page(viewport=VIEWPORT, color_scheme="light"))
        page.page.goto(f"{file.as_uri()}{to_fragment(State(size=SIZE))}")
        page.settle()
        for _ in range(_MOST_WAITS):
            if page.run("() => (simulator.app.frame.converger?.told?.directions ?? 0) >= 1024"):
                break
            page.page.wait_for_timeout(500)
        picture = Image.open(io.BytesIO(page.page.screenshot(timeout=120_000))).convert("RGB")
        browser.close()
    picture.save(TARGET, quality=QUALITY, method=6)
    print(f"{TARGET.name}: {TARGET.stat().st_size / 1000:.0f} kB")


if __name__ == "__main__":
    main()
