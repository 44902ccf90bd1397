"""The hash depends on values alone."""

from __future__ import annotations

import json
import random
from typing import Any

from hypothesis import given, settings
from hypothesis import strategies as st

from symrender.scene import gallery
from symrender.scene.canonical import canonical
from symrender.scene.dump import to_json, to_yaml
from symrender.scene.load import load, parse


def shuffled(value: Any, random_: random.Random) -> Any:
    if isinstance(value, dict):
        keys = list(value)
        random_.shuffle(keys)
        return {key: shuffled(value[key], random_) for key in keys}
    return [shuffled(entry, random_) for entry in value] if isinstance(value, list | tuple) else value


def toml(value: Any) -> str:
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key} = {toml(entry)}" for key, entry in value.items() if entry is not None) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(toml, value)) + "]"
    return json.dumps(value)


@settings(derandomize=True, max_examples=50, deadline=None)
@given(st.sampled_from(gallery.names()), st.randoms(use_true_random=False))
def test_key_order_and_format_do_not_matter(name: str, random_: random.Random) -> None:
    scene = load(name)
    data = shuffled(scene.model_dump(), random_)
    text = "\n".join(f"{key} = {toml(entry)}" for key, entry in data.items() if entry is not None)
    for same in (
        load(data),
        parse(json.dumps(data), "x", ".json"),
        parse(json.dumps(data), "x", ".yaml"),
        parse(text, "x", ".toml"),
        parse(to_yaml(scene), "x"),
        parse(to_json(scene), "x", ".json"),
    ):
        assert same.hash == scene.hash
        assert same == scene


def test_spelling_defaults_sign_of_zero_and_name_do_not_matter() -> None:
    scene = load("gloss")
    assert len(scene.hash) == 64
    assert scene.hash == load("gloss").hash
    assert scene.replace({"name": "other", "description": ""}).hash == scene.hash
    assert scene.replace({"camera.up": (-0.0, 0, 1)}).hash == scene.hash
    short, full = (
        "camera: {type: look_at, eye: [1, 2e0, 3.0]}",
        "camera: {up: [0, 0, 1], eye: [1, 2, 3], type: look_at}",
    )
    assert parse(short, "x").hash == parse(full, "x").hash


def test_every_number_and_choice_matters() -> None:
    for name in gallery.names():
        scene = load(name)
        hashes = {scene.hash}
        changes: list[tuple[str, object]] = []
        for p in scene.parameters():
            middle = 0.5 * (max(p.low, -1.0) + min(p.high, 3.0))
            changes.append((p.name, middle if p.value != middle else middle + 0.125))
        changes += [("shading.model", "phong" if scene.shading.model == "blinn" else "blinn"), ("floor", None)]
        for key, value in changes:
            hashes.add(scene.replace({key: value}).hash)
        assert len(hashes) == len(changes) + 1


def test_the_next_double_is_another_scene() -> None:
    scene = load("gloss")
    assert scene.replace({"spheres.A.radius": 0.9000000000000001}).hash != scene.hash
    assert "\n" not in canonical(scene)
    assert canonical(scene).isascii()


def test_keys_are_sorted_whatever_the_order_of_the_models() -> None:
    seen: list[list[str]] = []

    def keep(pairs: list[tuple[str, Any]]) -> None:
        seen.append([key for key, _ in pairs])

    json.loads(canonical(load("gloss")), object_pairs_hook=keep)
    assert len(seen) >= 10
    assert all(keys == sorted(keys) for keys in seen)
