from __future__ import annotations

from pathlib import Path

import pytest

from symrender.report.build import Report, report
from symrender.scene.load import load

HOSTILE = "</script><img src=x onerror=alert(1)>"


@pytest.fixture(scope="session")
def made(tmp_path_factory: pytest.TempPathFactory) -> tuple[Report, Path]:
    """A small report of a scene whose words try to become markup, by the chapter's estimators."""
    path = tmp_path_factory.mktemp("report") / "report.html"
    scene = load("gloss").replace({"description": HOSTILE})
    return report(scene, path, size=32, tol=1e-2, seconds=1000, estimators="chapter"), path
