"""What is dumped loads back, bit for bit."""

from __future__ import annotations

import json
import struct

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from symrender.errors import SceneError
from symrender.scene import gallery
from symrender.scene.dump import to_json, to_yaml
from symrender.scene.load import load, parse
from symrender.scene.scene import Scene


def bits(scene: Scene) -> list[bytes]:
    return [struct.pack("<d", p.value) for p in scene.parameters()]


coordinates = st.tuples(*[st.floats(-1e12, 1e12)] * 3)
shares = st.tuples(*[st.floats(0, 1)] * 3)
texts = st.text(st.characters(exclude_categories=["Cs"]), max_size=40)
lobes = st.none() | st.fixed_dictionaries(
    {"weight": st.floats(0, 1), "exponent": st.floats(0, 1e12), "theta_max": st.floats(0, 1.5), "mirror": st.booleans()}
)
textures = st.sampled_from([{"type": t} for t in ("solid", "checker", "stripes", "marble")])
spheres = st.lists(
    st.fixed_dictionaries(
        {"center": coordinates, "radius": st.floats(1e-150, 1e12), "color": shares, "texture": textures, "lobe": lobes}
    ),
    max_size=4,
).map(lambda parts: [{"name": f"S{index}", **part} for index, part in enumerate(parts)])
scenes = st.fixed_dictionaries(
    {
        "name": texts,
        "description": texts,
        "camera": st.fixed_dictionaries(
            {
                "type": st.just("plane"),
                "eye": coordinates.filter(lambda e: e[2] != 0),
                "window_half": st.floats(1e-9, 9),
            }
        ),
        "spheres": spheres,
        "floor": st.none() | st.fixed_dictionaries({"lobe": lobes}),
        "background": shares,
    }
)


@settings(derandomize=True, max_examples=100, deadline=None)
@given(scenes)
def test_any_scene_survives(data: dict[str, object]) -> None:
    scene = load(data)
    assert len(bits(scene)) >= 10
    for text, suffix in ((to_yaml(scene), ".yaml"), (to_json(scene), ".json"), (to_json(scene), ".yaml")):
        if suffix == ".yaml" and text.startswith("{") and "\\ud8" in text:
            continue  # surrogate pairs are JSON's, not YAML's
        if suffix == ".yaml" and text.startswith("{") and any(ord(c) > 0xFFFF for c in scene.name + scene.description):
            continue
        again = parse(text, "x", suffix)
        assert again == scene
        assert bits(again) == bits(scene)
        assert again.hash == scene.hash
        assert text.isascii()
    assert to_yaml(parse(to_yaml(scene), "x")) == to_yaml(scene)


@pytest.mark.parametrize("name", gallery.names())
def test_dumps_are_read_by_other_parsers_too(name: str) -> None:
    import yaml

    scene = load(name)
    assert load(json.loads(to_json(scene))) == scene
    assert load(yaml.safe_load(to_yaml(scene))) == scene


def test_negative_zero_keeps_its_sign() -> None:
    scene = load("gloss").replace({"spheres.A.center.x": -0.0})
    assert "center: [-0.0, 0.15, 0.9]" in to_yaml(scene)
    assert bits(parse(to_yaml(scene), "x")) == bits(scene)


def test_text_is_never_structure() -> None:
    name = 'x"\n---\ncamera: !!python/object:os.system {} # </script>\u2028\x85\x1b\U0001f600'
    scene = load("gloss").replace({"name": name})
    assert parse(to_yaml(scene), "x").name == name
    assert parse(to_json(scene), "x", ".json").name == name
    with pytest.raises(SceneError, match="without lone surrogates"):
        scene.replace({"name": "\ud800"})
