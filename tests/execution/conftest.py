"""A cluster of two workers on this machine, none of which outlives the tests of a file."""

from __future__ import annotations

import time
import warnings
from collections.abc import Iterator

import pytest

from execution.workers import children
from symrender.execution.cluster import Cluster, connect


@pytest.fixture(scope="module")
def local() -> Iterator[Cluster]:
    pytest.importorskip("distributed")
    pytest.importorskip("cryptography")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        with connect("local:2") as workers:
            yield workers
    deadline = time.monotonic() + 5
    while (left := children()) and time.monotonic() < deadline:
        time.sleep(0.05)
    assert not left, "no process outlives its cluster"
