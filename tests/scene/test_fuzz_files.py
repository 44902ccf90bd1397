"""Two thousand hostile scene files, driven by hypothesis, and the corpus of every kind seen before."""

from __future__ import annotations

import random
import shutil
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from fuzz_scenes import CORPUS, LIMIT, SUFFIXES, check, generated, originals, restructured, scene_file, written

ACCEPTED = {"bom.yaml", "cr.yaml", "escape.yaml", "exponent.yaml", "json_in.yaml", "script.yaml"}


@pytest.mark.parametrize("name", sorted(path.name for path in CORPUS.iterdir()))
def test_corpus(name: str, tmp_path: Path) -> None:
    shutil.copy(CORPUS / name, tmp_path / name)
    assert check(tmp_path / name) == (name in ACCEPTED)


def test_the_corpus_is_whole() -> None:
    names = {path.name for path in CORPUS.iterdir()}
    assert len(names) >= 43 and names >= ACCEPTED
    assert {path.suffix for path in CORPUS.iterdir()} == set(SUFFIXES)


@given(seed=st.integers(0, 2**32))
@settings(max_examples=1600, derandomize=True, deadline=None, suppress_health_check=list(HealthCheck))
def test_files(seed: int, tmp_path_factory: pytest.TempPathFactory) -> None:
    suffix, data = scene_file(random.Random(seed))
    path = tmp_path_factory.getbasetemp() / f"case{suffix}"
    path.write_bytes(data)
    check(path)


@given(draw=st.randoms(use_true_random=False), suffix=st.sampled_from(SUFFIXES), make=st.booleans())
@settings(max_examples=400, derandomize=True, deadline=None, suppress_health_check=list(HealthCheck))
def test_files_hypothesis_may_shrink(
    draw: random.Random, suffix: str, make: bool, tmp_path_factory: pytest.TempPathFactory
) -> None:
    path = tmp_path_factory.getbasetemp() / f"drawn{suffix}"
    path.write_bytes(written(generated(draw) if make else restructured(draw), suffix))
    check(path)


def test_the_files_are_of_every_kind(tmp_path: Path) -> None:
    assert len(originals()) >= 7 and LIMIT == 2.0
    counts = {(suffix, found): 0 for suffix in SUFFIXES for found in (True, False)}
    for seed in range(300):
        suffix, data = scene_file(random.Random(seed))
        path = tmp_path / f"case{suffix}"
        path.write_bytes(data)
        counts[suffix, check(path)] += 1
    assert min(counts.values()) >= 5, counts


def test_a_broken_rule_is_noticed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "a.yaml"
    path.write_text("camera: {type: look_at, eye: [0, 0, 0]}")
    with monkeypatch.context() as patch:
        patch.setattr("fuzz_scenes.LIMIT", 0.0)
        with pytest.raises(AssertionError):
            check(path)
    with monkeypatch.context() as patch:
        patch.setattr("fuzz_scenes.load", lambda path: {}["key"])
        with pytest.raises(KeyError):
            check(path)
