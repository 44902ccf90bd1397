"""Jobs: the process that makes one reads no text of the scene it holds, others read it and make the same bytes."""

from __future__ import annotations

import pickle
from importlib import metadata

import pytest

from symrender.execution import jobs as under_test
from symrender.execution.jobs import Job, compute, prepared
from symrender.runtimes import numba
from symrender.scene.dump import to_yaml
from symrender.scene.load import AnyScene, load_any, parse_any
from symrender.scene.radiometric.scene import RadiometricScene
from symrender.scene.scene import Scene
from symrender.settings import Settings
from symrender.truth import truth

TILE = (0, 0, 12, 12)


def _job(scene: AnyScene) -> Job:
    return Job.of("truth", scene, Settings(width=12, height=12, tol=1e-2))


def _sent(job: Job) -> Job:
    """``job`` as another process gets it."""
    found = pickle.loads(pickle.dumps(job))  # noqa: S301, of our own making
    assert isinstance(found, Job)
    return found


def test_a_scene_at_hand_is_not_read_from_its_text(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object, **__: object) -> AnyScene:
        raise AssertionError("the text was read")

    prepared.cache_clear()
    here = compute(_job(load_any("gloss")), TILE)
    prepared.cache_clear()
    sent = _sent(_job(load_any("gloss")))
    there = compute(sent, TILE)
    assert here.blocks["gloss"].max() > 0.1
    assert {name: block.tobytes() for name, block in here.blocks.items()} == {
        name: block.tobytes() for name, block in there.blocks.items()
    }
    monkeypatch.setattr(under_test, "parse_any", refuse)
    prepared.cache_clear()
    compute(_job(load_any("gloss")), TILE)
    prepared.cache_clear()
    with pytest.raises(AssertionError, match="the text was read"):
        compute(sent, TILE)


def test_a_job_that_was_sent_is_the_same_job_without_its_scene() -> None:
    job = _job(load_any("gloss"))
    sent = _sent(job)
    assert job.held is not None and sent.held is None
    assert sent == job and hash(sent) == hash(job)
    assert len(pickle.dumps(job)) < len(job.scene) + 2000


def test_the_version_of_sympy_is_looked_for_once(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[str] = []
    version = metadata.version

    def counted(name: str) -> str:
        asked.append(name)
        return version(name)

    monkeypatch.setattr(metadata, "version", counted)
    numba._sympy.cache_clear()
    for _ in range(3):
        with numba.emitting("image"):
            pass
    assert asked == ["sympy"]


@pytest.mark.parametrize("name", ["gloss", "furnace_radiometric"])
def test_an_image_carries_the_text_of_its_job_which_is_written_once(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    written: list[str] = []

    def counted(scene: Scene | RadiometricScene) -> str:
        written.append(scene.name)
        return to_yaml(scene)

    monkeypatch.setattr(under_test, "to_yaml", counted)
    scene = load_any(name)
    meta = truth(scene, size=2, tol=1e-2).meta
    assert written == [scene.name]
    assert meta["scene"] == to_yaml(scene) and meta["scene_hash"] == scene.hash
    assert parse_any(meta["scene"], "meta") == scene
