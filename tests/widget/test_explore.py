"""Sliders over a scene: their ranges, what is drawn at their places, and the widget where anywidget is there."""

from __future__ import annotations

import importlib.util
import io
import json
import sys
from pathlib import Path
from typing import Any

import numpy as np
import PIL.Image
import pytest

import symrender as sr
from symrender.errors import OptionError, SceneError
from symrender.widget import sliders as sliders_module
from symrender.widget.explore import _widget_class
from symrender.widget.sliders import Drawing, sliders_of

FILES = Path(sr.__file__).parent / "widget"
N = "floor.lobe.exponent"


def test_sliders_have_ranges_one_looks_at() -> None:
    scene = sr.load("gloss")
    found = {s.name: s for s in sliders_of(scene)}
    assert len(found) >= 3 and all(name.endswith("lobe.exponent") for name in found)
    assert (found[N].low, found[N].high, found[N].log) == (1.0, 4096.0, True)
    x, r, w = sliders_of(scene, ["spheres.B.center.x", "spheres.B.radius", "floor.lobe.weight"])
    assert (x.low, x.high) == pytest.approx((-0.02, 1.98)) and not x.log
    assert (r.low, r.high) == (0.14, 2.24) and (w.low, w.high) == (0.0, 1.0)
    (own,) = sliders_of(scene, {N: (8, 512)})
    assert (own.low, own.high) == (8.0, 512.0)


@pytest.mark.parametrize(
    ("names", "match"),
    [
        (["floor.lobe.exponents"], r"'floor.lobe.exponents' is no number of the scene, did you mean '" + N),
        ({N: (512, 1024)}, "must run from low to high around"),
        ({N: (-5, 512)}, "must run from low to high around"),
    ],
)
def test_a_wrong_slider_is_named(names: Any, match: str) -> None:
    with pytest.raises(OptionError, match=match):
        sliders_of(sr.load("gloss"), names)


def test_what_is_drawn_is_what_render_draws() -> None:
    drawing = Drawing(sr.load("gloss"), [N], 24, {})
    there = drawing.draw({N: 16.0})
    changed = sr.load("gloss").replace({N: 16.0})
    expected = sr.render(changed, size=24, numeric="none", partition="equal_weight", nodes="barycentre").symbolic
    assert expected is not None and (there.radiance == expected.radiance).all()
    assert drawing.scene == changed
    assert np.abs(drawing.draw({}).radiance - there.radiance).max() > 1e-3, "the slider must matter"
    with pytest.raises(OptionError, match=r"no slider is named 'floor.lobe.weight'"):
        drawing.draw({"floor.lobe.weight": 0.1})
    with pytest.raises(SceneError):
        drawing.draw({N: -3.0})
    assert drawing.image is not there and drawing.scene == sr.load("gloss"), "the last picture stays"


def test_a_moving_picture_is_as_coarse_as_keeps_pace(monkeypatch: pytest.MonkeyPatch) -> None:
    drawing = Drawing(sr.load("gloss"), [N], 32, {})
    monkeypatch.setattr(sliders_module, "_HAND", 0.0)
    assert [drawing.draw({N: 16.0}, moving=True).width for _ in range(4)] == [16, 8, 4, 4]
    assert drawing.draw({N: 16.0}).width == 32
    monkeypatch.setattr(sliders_module, "_HAND", 1e3)
    assert [drawing.draw({N: 16.0}, moving=True).width for _ in range(5)] == [4, 8, 16, 32, 32]


def test_without_anywidget_the_line_that_installs_it_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "anywidget", None)
    _widget_class.cache_clear()
    with pytest.raises(OptionError, match=r"explore: anywidget is not installed: pip install '?(anywidget|symrender)"):
        sr.explore("gloss")
    _widget_class.cache_clear()


@pytest.mark.skipif(importlib.util.find_spec("anywidget") is None, reason="anywidget is not installed")
@pytest.mark.filterwarnings("ignore")
def test_the_widget_draws_what_its_model_asks_for() -> None:
    widget = sr.explore("gloss", [N], size=24, exposure=-1.0)
    told: list[str] = []
    widget.observe(lambda change: told.append(change["name"]), names=["picture", "caption", "trouble"])
    first = pixels(widget)
    assert first.shape == (24, 24, 3) and widget.caption.endswith(f"{N} = {sr.load('gloss').floor.lobe.exponent:.4g}")
    # as a front end sends it
    widget.set_state({"asked": {"values": {N: 4.0}, "moving": False}})
    assert (pixels(widget) != first).any() and widget.caption.endswith(f"{N} = 4")
    assert widget.scene == sr.load("gloss").replace({N: 4.0})
    assert (pixels(widget) == widget.image.view(exposure=-1.0).pixels).all()
    assert {"picture", "caption"} <= set(told)
    kept = pixels(widget)
    widget.asked = {"values": {N: -1.0}, "moving": False}
    assert "exponent" in widget.trouble and (pixels(widget) == kept).all()
    widget.asked = {"values": {N: 4.0}, "moving": True}
    assert widget.trouble == "" and pixels(widget).shape == (12, 12, 3)


def pixels(widget: Any) -> Any:
    with PIL.Image.open(io.BytesIO(widget.picture)) as picture:
        return np.asarray(picture)


def test_the_page_asks_for_the_place_of_its_slider(browser: Any) -> None:
    drawing = Drawing(sr.load("gloss"), [N, "spheres.B.center.x"], 24, {})
    page = browser.new_page()
    page.goto("about:blank")
    page.add_style_tag(content=(FILES / "explore.css").read_text("utf-8"))
    page.evaluate(
        """async ([code, sliders]) => {
          const { default: widget } = await import(URL.createObjectURL(new Blob([code], { type: "text/javascript" })));
          const picture = new DataView(new ArrayBuffer(1));
          const held = { sliders, size: 24, asked: {}, picture, caption: "", trouble: "" };
          const heard = {};
          window.sent = [];
          window.model = {
            get: (name) => held[name],
            set: (name, value) => { held[name] = value; heard["change:" + name]?.(); },
            save_changes: () => window.sent.push(held.asked),
            on: (event, run) => (heard[event] = run), off: (event) => delete heard[event],
          };
          window.heard = heard;
          const el = document.createElement("main");
          document.body.append(el);
          window.leave = widget.render({ model, el });
        }""",
        [(FILES / "explore.js").read_text("utf-8"), json.loads(json.dumps(drawing.plain()))],
    )
    slider = page.get_by_label(N)
    assert slider.get_attribute("aria-valuetext") == f"{sr.load('gloss').floor.lobe.exponent:g}"
    slider.fill("0")
    assert page.evaluate("sent.at(-1)") == {"values": {N: 1}, "moving": False}
    slider.press("End")
    page.get_by_label("spheres.B.center.x").press("Home")
    assert page.evaluate("sent.at(-1).values") == {N: 4096, "spheres.B.center.x": pytest.approx(-0.02)}
    page.evaluate("model.set('trouble', 'no such light'), model.set('caption', 'a ball')")
    assert page.get_by_role("status").text_content() == "no such light"
    assert page.locator("img").get_attribute("alt") == "a ball"
    page.evaluate("leave()")
    assert page.evaluate("Object.keys(heard).length") == 0
    page.close()
