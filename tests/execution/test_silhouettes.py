"""Silhouettes: pixels beside another shape are means over their own points, all others are as they were."""

from __future__ import annotations

import numpy as np
import pytest

from symrender.errors import OptionError
from symrender.execution.fill import Crew, Means
from symrender.execution.jobs import Job
from symrender.execution.silhouettes import edges
from symrender.scene.arrays import Array
from symrender.scene.load import load
from symrender.settings import Settings
from symrender.truth import truth

SIZE, K = 24, 3


def layers(kind: str, size: int, silhouettes: int, threads: int = 2, tile: int = 0) -> dict[str, Array]:
    settings = Settings(width=size, height=size, lobe=2, silhouettes=silhouettes)
    job = Job.of(kind, load("gloss"), settings)
    with Crew(Means(threads, tile), (job,)) as crew:
        return crew.fill(job)[0]


def test_edges_are_pixels_beside_another_shape() -> None:
    seen = np.zeros((4, 5))
    seen[1:3, 2:] = 1
    expected = np.array([[0, 0, 1, 1, 1], [0, 1, 1, 1, 1], [0, 1, 1, 1, 1], [0, 0, 1, 1, 1]], dtype=bool)
    expected[1, 3:] = expected[2, 3:] = True
    assert (edges(seen) == expected).all()
    assert not edges(np.ones((3, 3))).any()


def test_the_symbolic_picture_holds_the_means_of_a_larger_one_there() -> None:
    plain, smooth, large = (layers("symbolic", n, k) for n, k in ((SIZE, 1), (SIZE, K), (K * SIZE, 1)))
    chosen = edges(plain["hit_class"])
    assert 20 < chosen.sum() < chosen.size / 2
    for name in ("radiance", "direct", "gloss"):
        means = large[name].reshape(SIZE, K, SIZE, K, 3).mean(axis=(1, 3))
        assert np.allclose(smooth[name][chosen], means[chosen], rtol=1e-13)
        assert (smooth[name][~chosen] == plain[name][~chosen]).all()
        assert np.abs(smooth[name] - plain[name]).max() > 0.05
    assert (smooth["hit_class"] == plain["hit_class"]).all()


@pytest.mark.parametrize("kind", ["numeric", "symbolic"])
def test_threads_and_tiles_change_no_byte(kind: str) -> None:
    whole = {name: layer.tobytes() for name, layer in layers(kind, SIZE, K, 1, SIZE).items()}
    for threads, tile in ((2, 5), (3, 1)):
        assert {name: layer.tobytes() for name, layer in layers(kind, SIZE, K, threads, tile).items()} == whole


def test_a_smooth_truth_bounds_the_mean_of_its_points() -> None:
    smooth = truth("gloss", size=12, tol=1e-2, silhouettes=2)
    points = truth("gloss", size=24, tol=1e-4)
    chosen = edges(smooth.layer("hit_class"))
    means = points.radiance.reshape(12, 2, 12, 2, 3).mean(axis=(1, 3))
    off = np.abs(smooth.radiance - means).max(axis=-1)
    assert chosen.sum() > 10 and (off <= smooth.layer("error") + 1e-4)[chosen].all()


def test_too_many_points_are_refused() -> None:
    with pytest.raises(OptionError, match=r"silhouettes: 4096 x 4096 pixels of 8 x 8 points exceed"):
        Settings(width=4096, height=4096, silhouettes=8)
    with pytest.raises(OptionError, match="silhouettes: must be a whole number from 1 to 8"):
        Settings(silhouettes=9)
