"""Sweep: one image for every combination of scene values, a table of their figures, and all of them on a page."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Final, Literal

from symrender.execution.fill import Means
from symrender.execution.tiles import Progress
from symrender.images.output import check_target, make_folder
from symrender.scene.scene import Scene
from symrender.sequences.makers import Maker, Row
from symrender.sequences.over import Axis, frames
from symrender.sequences.sequence import make_frames, replacing, write_table
from symrender.sequences.sheet import caption, contact_sheet
from symrender.sequences.store import Files, Store
from symrender.sequences.zarr_store import ZarrStore

TABLE: Final = "ledgers.csv"
SHEET: Final = "contact_sheet.png"
JOURNAL: Final = "sweep.journal"
Form = Literal["exr", "zarr"]
"""A file an image in 32-bit floats, or all frames in one Zarr store in 64."""
_WIDEST: Final = 32


def sweep(
    scene: Scene,
    over: Sequence[Axis],
    maker: Maker,
    folder: str | Path,
    *,
    store: Form = "exr",
    means: Means | None = None,
    force: bool = False,
    inputs: Sequence[Path] = (),
    progress: Progress | None = None,
) -> list[Row]:
    """Make every frame of the product of ``over``; return and write the rows of figures.

    ``folder`` receives ``frame_NNNNN_IMAGE.exr``, or for ``store="zarr"`` the folder ``frames.zarr`` (zarr_store.py),
    ``ledgers.csv`` and ``contact_sheet.png``, or a sheet an image, ``contact_sheet_IMAGE.png``, where they are signed.
    ``maker`` says what a frame becomes (``makers.py``). The bytes of the frames and of the sheets depend on the scene,
    the ranges and the settings alone; the table also states seconds. Raises SceneError, before any work, for a value
    the scene refuses.
    """
    chosen = means or Means()
    made = frames(scene, over)
    for frame in made:
        # a scene without such images is refused before any work
        images = maker.names(frame.scene)
    place = make_folder(folder)
    own = replace(chosen, journal=chosen.journal or place / JOURNAL)
    sheets = {SHEET: images[-1]} if not maker.signed else {f"contact_sheet_{name}.png": name for name in images}
    kept: Store = Files(place) if store == "exr" else ZarrStore(place, over, made[0].scene)
    with replacing(own, force=force) as may:
        for name in (TABLE, *sheets):
            check_target(place / name, force=may, inputs=inputs)
        for frame in made:
            for image in images:
                kept.check(frame, image, force=may, inputs=inputs)
    columns = len(over[-1].values) if len(over) > 1 and len(over[-1].values) <= _WIDEST else 0

    def finish(rows: list[Row]) -> None:
        write_table(rows, place / TABLE)
        captions = [caption(frame.changes) for frame in made]
        for sheet, image in sheets.items():
            pictures = [partial(kept.read, frame, image) for frame in made]
            contact_sheet(pictures, captions, columns, signed=maker.signed).save(place / sheet)

    return make_frames(made, maker, place, own, store=kept, progress=progress, finish=finish)
