from __future__ import annotations

import sys
from collections.abc import Callable
from functools import cache
from pathlib import Path
from types import ModuleType

import pytest

from symrender.images.image import Image
from symrender.scene.load import AnyScene
from symrender.truth import truth

BENCHMARKS = Path(__file__).resolve().parents[2] / "benchmarks"
SIZE = (24, 16)

Truths = Callable[[str], tuple[AnyScene, Image]]


@pytest.fixture(scope="session")
def mutants() -> ModuleType:
    sys.path.insert(0, str(BENCHMARKS))
    try:
        import mutants as found
    finally:
        sys.path.remove(str(BENCHMARKS))
    return found


@pytest.fixture(scope="session")
def truths(mutants: ModuleType) -> Truths:
    """Scenes of the mutants by name, with their truth."""

    @cache
    def of(name: str) -> tuple[AnyScene, Image]:
        scene = mutants.scene_of(name)
        return scene, truth(scene, size=SIZE, tol=1e-7)

    return of
