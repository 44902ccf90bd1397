"""The one call that renders both ways: its errors, its records, its refusal of what is not finite."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from symrender import version
from symrender.errors import NonFiniteError, OptionError, SceneError, SymrenderError
from symrender.execution.jobs import prepared
from symrender.images.image import Image
from symrender.numeric import pipeline as numeric
from symrender.render import Pair, render
from symrender.runtimes import image as symbolic
from symrender.scene.load import load

SIZE = 24
LAYERS = {"radiance", "direct", "gloss", "hit_class"}


@pytest.fixture(scope="module")
def pair() -> Pair:
    return render("gloss", size=(SIZE, 18), lobe=2, seed=11)


def _images(pair: Pair) -> dict[str, Image]:
    assert pair.numeric is not None and pair.symbolic is not None
    return {"numeric": pair.numeric, "symbolic": pair.symbolic}


def test_layers_add_up(pair: Pair) -> None:
    weights = {1: 0.85, 2: 0.15, 3: 0.4, 4: 0.15}
    for image in _images(pair).values():
        assert image.layers.keys() >= LAYERS
        radiance, direct, gloss, shape = (image.layers[n] for n in ("radiance", "direct", "gloss", "hit_class"))
        assert radiance.shape == (18, SIZE, 3) and shape.shape == (18, SIZE)
        assert set(np.unique(shape)) >= {1, 2, 3, 4} and gloss.max() > 0.1
        weight = np.vectorize(lambda c: weights.get(int(c), 0.0))(shape)[..., None]
        np.testing.assert_allclose(radiance, direct + weight * gloss, rtol=1e-15)


def test_every_record_is_there_and_true(pair: Pair) -> None:
    scene = load("gloss")
    for method, image in _images(pair).items():
        meta = image.meta
        assert meta["method"] == method
        assert meta["scene_name"] == "gloss" and meta["scene_hash"] == scene.hash
        assert load(_parsed(meta["scene"])).hash == scene.hash
        assert meta["seed"] == "11" and meta["version"] == version.VERSION
        chosen = json.loads(meta["settings"])
        assert (chosen["width"], chosen["height"], chosen["lobe"], chosen["seed"]) == (SIZE, 18, 2, 11)
        assert not chosen.keys() & {"threads", "tile"}
        assert meta["units"] == "scene radiance, linear RGB" and meta["convention"] == "lobe_average"
        assert "2x2" in meta["estimator"]
    images = _images(pair)
    assert images["numeric"].meta["estimator"] == "jittered 2x2, ratio"
    assert images["symbolic"].meta["estimator"] == "strata 2x2, exact weights, midpoint nodes, equal_angle, ratio"


def _parsed(text: str) -> dict[str, Any]:
    import yaml

    parsed: dict[str, Any] = yaml.safe_load(text)
    return parsed


def test_the_pair_shows_its_ledger(pair: Pair) -> None:
    text = repr(pair)
    assert text == pair.ledger.text() and len(text.splitlines()) > 5
    page = pair._repr_html_()
    assert page.count("<figure") == 2 and page.count("data:image/png;base64,") == 2
    assert "<script" not in page


@pytest.mark.parametrize(("numeric_", "symbolic_"), [("none", "strata"), ("sobol", "none")])
def test_one_side_alone(numeric_: Any, symbolic_: Any) -> None:
    alone = render("gloss", size=8, lobe=1, numeric=numeric_, symbolic=symbolic_)
    assert (alone.numeric is None) == (numeric_ == "none")
    assert (alone.symbolic is None) == (symbolic_ == "none")
    assert alone._repr_html_().count("<figure") == 1


def test_settings_reach_the_image() -> None:
    base = render("gloss", size=SIZE, lobe=2)
    again = render("gloss", size=SIZE, lobe=2)
    for other in ({"seed": 8}, {"numeric": "independent"}, {"lobe": 3}, {"disk": "1x1"}, {"normalised": True}):
        changed = render("gloss", size=SIZE, **({"lobe": 2} | other))
        assert not np.array_equal(_images(base)["numeric"].layers["gloss"], _images(changed)["numeric"].layers["gloss"])
    for other in (
        *({"weights": "midpoint"}, {"nodes": "barycentre"}, {"nodes": "gauss"}, {"partition": "equal_weight"}),
        *({"lobe": 3}, {"disk": "1x1"}),
    ):
        changed = render("gloss", size=SIZE, **({"lobe": 2, "numeric": "none"} | other))
        found = changed.symbolic
        assert found is not None
        assert not np.array_equal(_images(base)["symbolic"].layers["gloss"], found.layers["gloss"])
    for method in ("numeric", "symbolic"):
        for name in LAYERS:
            assert _images(base)[method].layers[name].tobytes() == _images(again)[method].layers[name].tobytes()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"size": 0}, "width: must be a whole number from 1"),
        ({"size": (4, -1)}, "height: must be a whole number from 1"),
        ({"size": "big"}, "size: must be N or"),
        ({"size": (1, 2, 3)}, "size: must be N or"),
        ({"size": 100_000}, "exceed max_pixels"),
        ({"size": 64, "max_pixels": 64}, "exceed max_pixels 64"),
        ({"lobe": 0}, "lobe: must be"),
        ({"lobe": 2.0}, "lobe: must be"),
        ({"lobe": True}, "lobe: must be"),
        ({"numeric": "jitter"}, "numeric: must be one of jittered"),
        ({"symbolic": "magic"}, "symbolic: must be one of"),
        ({"weights": "wrong"}, "weights: must be one of"),
        ({"nodes": "wrong"}, "nodes: must be one of"),
        ({"partition": "wrong"}, "partition: must be one of"),
        ({"aa": "msaa"}, "aa: must be one of"),
        ({"disk": "2"}, "disk: must be"),
        ({"disk": "2x3"}, "disk: must be"),
        ({"disk": "0x0"}, "disk: must be"),
        ({"disk": "exact"}, "disk: 'exact'"),
        ({"seed": -1}, "seed: must be"),
        ({"threads": -1}, "threads: must be"),
        ({"tile": -1}, "tile: must be"),
        ({"numeric": "none", "symbolic": "none"}, "numeric, symbolic: at least one"),
    ],
    ids=lambda value: ",".join(map(str, value)) if isinstance(value, dict) else None,
)
def test_wrong_options_are_one_line(options: dict[str, Any], message: str) -> None:
    with pytest.raises(OptionError) as caught:
        render("gloss", **({"size": 4} | options))
    assert message in str(caught.value)
    assert len(str(caught.value).splitlines()) == 1


@pytest.mark.parametrize("scene", ["no such scene", "/no/such/file.yaml"])
def test_wrong_scenes_are_one_line(scene: Any) -> None:
    with pytest.raises(SymrenderError) as caught:
        render(scene, size=4)
    assert isinstance(caught.value, SceneError)
    assert len(str(caught.value).splitlines()) == 1


@pytest.mark.parametrize("method", ["numeric", "symbolic"])
@pytest.mark.parametrize("value", [math.nan, math.inf])
def test_what_is_not_finite_is_named_and_refused(method: str, value: float, monkeypatch: pytest.MonkeyPatch) -> None:
    module = {"numeric": numeric, "symbolic": symbolic}[method]
    prepare: Callable[..., Any] = module.prepare

    def broken(*arguments: Any) -> Any:
        kernel = prepare(*arguments)

        def fill(x0: int, y0: int, x1: int, y1: int, layers: Any) -> int:
            spent: int = kernel(x0, y0, x1, y1, layers)
            for column, row, shape in ((3, 17, 1), (9, 12, 2), (5, 1, 0)):
                if x0 <= column < x1 and y0 <= row < y1:
                    layers["radiance"][row, column, 1], layers["hit_class"][row, column] = value, shape
            return spent

        return fill

    monkeypatch.setattr(module, "prepare", broken)
    # kernels are remembered by their job
    prepared.cache_clear()
    try:
        with pytest.raises(NonFiniteError) as caught:
            render("gloss", size=SIZE, lobe=1)
    finally:
        prepared.cache_clear()
    text = str(caught.value)
    assert text.startswith(f"{method}: 3 pixels are not finite: ") and len(text.splitlines()) == 1
    assert "(3, 17) on floor" in text and "(9, 12) on spheres.A" in text and "(5, 1) on nothing" in text
    assert caught.value.exit_code == 3
