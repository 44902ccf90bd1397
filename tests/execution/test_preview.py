"""Previews: what stands is shown as it is, the rest by its neighbours, and a file is always a whole picture."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
import PIL.Image
import pytest

from slow_kind import slow_job
from symrender.errors import OutputError
from symrender.execution.fill import Crew, Means
from symrender.execution.preview import Preview, mosaic, preview_file
from symrender.execution.tiles import tiles
from symrender.images.srgb import encode_srgb


def test_unfinished_tiles_are_the_mean_of_the_nearest_finished_one() -> None:
    radiance = np.zeros((4, 8, 3))
    radiance[:, :2], radiance[:, 6:] = 0.25, 1.0
    work = list(tiles(8, 4, 2))
    finished = [tile for tile in work if tile[0] in (0, 6)]
    shown = mosaic(radiance, finished, [tile for tile in work if tile not in finished])
    assert (shown[:, :4] == encode_srgb(np.array(0.25))).all() and (shown[:, 4:] == 255).all()
    assert (mosaic(radiance, [], work) == encode_srgb(np.array(0.2))).all()
    assert (mosaic(radiance, work, []) == encode_srgb(radiance)).all()


def test_a_run_shows_pictures_that_grow_and_the_last_is_whole() -> None:
    shown: list[tuple[bytes, str]] = []
    preview = Preview(lambda picture, caption: shown.append((picture, caption)), every=0.0)
    with Crew(Means(2, 4), (job := slow_job(24, 18, 8),), preview=preview) as crew:
        layers, _ = crew.fill(job)
    assert len(shown) > 3 and shown[-1][1] == "slow: 30 of 30 tiles"
    counts = [int(caption.split()[1]) for _, caption in shown]
    assert counts == sorted(counts) and counts[0] < 15
    with PIL.Image.open(io.BytesIO(shown[-1][0])) as picture:
        assert (np.asarray(picture) == encode_srgb(layers["radiance"])).all()


def test_a_file_is_rewritten_whole(tmp_path: Path) -> None:
    path = tmp_path / "preview.png"
    with Crew(Means(1, 6), (job := slow_job(24, 18),), preview=preview_file(path)) as crew:
        crew.fill(job)
    with PIL.Image.open(path) as picture:
        assert picture.size == (24, 18)
    assert [p.name for p in tmp_path.iterdir()] == ["preview.png"]


def test_a_place_that_cannot_be_written_is_refused_before_the_work(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="does not exist"):
        preview_file(tmp_path / "nowhere" / "preview.png")
    with pytest.raises(OutputError, match=r"must end in \.png"):
        preview_file(tmp_path / "preview.jpg")
