"""Animate: the frames of a changing scene as a PNG sequence and as a video."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final

from symrender.execution.fill import Means
from symrender.execution.tiles import Progress
from symrender.images.output import check_target, make_folder
from symrender.sequences.makers import Maker, Row
from symrender.sequences.over import Frame
from symrender.sequences.sequence import make_frames, replacing
from symrender.sequences.store import Files
from symrender.sequences.video import Container, check_video, write_video

JOURNAL: Final = "animation.journal"


def animate(
    frames: Sequence[Frame],
    maker: Maker,
    folder: str | Path,
    *,
    video: Container = "mp4",
    rate: float = 24.0,
    means: Means | None = None,
    force: bool = False,
    inputs: Sequence[Path] = (),
    progress: Progress | None = None,
) -> list[Row]:
    """Make ``frames`` (of ``over.frames`` or ``orbit.orbit``) as PNG and, unless ``video`` is ``none``, a video.

    ``folder`` receives ``frame_NNNNN_IMAGE.png`` and, for each image a frame has, ``animation_IMAGE.mp4`` or
    ``.webm`` at ``rate`` frames a second. What cannot be encoded is refused before anything is rendered.
    """
    check_video(video, rate)
    chosen = means or Means()
    place = make_folder(folder)
    own = replace(chosen, journal=chosen.journal or place / JOURNAL)
    kinds = maker.names(frames[0].scene)
    videos = {kind: place / f"animation_{kind}.{video}" for kind in kinds if video != "none"}
    store = Files(place, ".png")
    names = [store.path(frame, kind) for frame in frames for kind in kinds]
    with replacing(own, force=force) as may:
        for path in (*videos.values(), *names):
            check_target(path, force=may, inputs=inputs)

    def finish(rows: list[Row]) -> None:
        for kind, path in videos.items():
            write_video([store.path(frame, kind) for frame in frames], path, rate=rate)

    return make_frames(frames, maker, place, own, store=store, progress=progress, finish=finish)
