"""Make the frames of a sequence, one after another, so that an interruption costs at most the tiles under way.

Beside the frames stands the journal of the sequence: the lock, what decides every byte, and for each finished frame its
files with their hashes and its row. A frame under way has a journal of its own. Both go when the sequence stands.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

from symrender.fill import Crew, Means, workers_of
from symrender.image import Image
from symrender.journal import Journal
from symrender.output import remove_leftovers, write_bytes
from symrender.sequences.makers import Maker, Row
from symrender.sequences.over import Frame
from symrender.tiles import Progress

Finish = Callable[[list[Row]], None]
"""Called with every frame's row once all frames stand, before the journal goes."""


def frame_name(index: int, image: str, ending: str) -> str:
    """File name of one image of a frame: ``frame_00012_numeric.exr``."""
    return f"frame_{index:05d}_{image}{ending}"


def make_frames(
    frames: Sequence[Frame],
    maker: Maker,
    folder: Path,
    means: Means,
    *,
    ending: str = ".exr",
    progress: Progress | None = None,
    finish: Finish | None = None,
) -> list[Row]:
    """Write every frame into ``folder`` and return their rows: frame, changes, figures, and the files with SHA-256.

    A frame an interrupted run finished is taken over if its files still have their hashes. ``means.journal`` is the
    sequence's journal. Progress is told in frames.
    """
    assert means.journal is not None
    rows: list[Row] = []
    with Journal(means.journal, _fields(frames, maker, ending), means.start, means.patience) as journal:
        standing = {note["frame"]: note for note in journal.notes() if _stands(folder, note)}
        with workers_of(means) as workers:
            for frame in frames:
                row = standing.get(frame.index)
                if row is None:
                    own = replace(
                        means,
                        journal=folder / f"frame_{frame.index:05d}.journal",
                        start="resume" if means.start == "resume" else "restart",
                    )
                    jobs = maker.jobs(frame.scene)
                    with Crew(own, jobs, workers=workers) as crew:
                        images, figures = maker.make(crew, frame.scene)
                        files = {
                            (name := frame_name(frame.index, key, ending)): _write(image, folder / name)
                            for key, image in images.items()
                        }
                        row = {"frame": frame.index, **dict(frame.changes), **figures, "files": files}
                        journal.note(row)
                        crew.succeeded()
                rows.append(row)
                if progress is not None:
                    progress(len(rows), len(frames), "frames")
        if finish is not None:
            finish(rows)
        journal.remove()
    return rows


def write_table(rows: Sequence[Row], path: Path, *, force: bool = True) -> None:
    """``rows`` as CSV (RFC 4180), floats with all their digits, the names of the files in the last columns."""
    import csv
    import io

    flat = [
        {**{k: v for k, v in row.items() if k != "files"}, **{f"file_{n}": f for n, f in enumerate(row["files"])}}
        for row in rows
    ]
    columns = list(dict.fromkeys(name for row in flat for name in row))
    text = io.StringIO()
    table = csv.DictWriter(text, columns, lineterminator="\r\n")
    table.writeheader()
    table.writerows(flat)
    write_bytes(path, text.getvalue().encode(), force=force)


def _fields(frames: Sequence[Frame], maker: Maker, ending: str) -> dict[str, str]:
    """What decides the bytes of all frames."""
    jobs = maker.jobs(frames[0].scene)
    changes = json.dumps([frame.changes for frame in frames])
    every = hashlib.sha256("".join(frame.scene.hash for frame in frames).encode()).hexdigest()
    decisive = {"images": " ".join(job.kind for job in jobs), "ending": ending} | jobs[0].fields()
    return decisive | {"scene": every, "over": hashlib.sha256(changes.encode()).hexdigest(), "frames": str(len(frames))}


def _write(image: Image, path: Path) -> str:
    remove_leftovers(path)
    image.save(path)
    return hashlib.sha256(path.read_bytes()).hexdigest()


def _stands(folder: Path, note: Row) -> bool:
    """Whether the files of a noted frame are there, unchanged."""
    try:
        found = {name: hashlib.sha256((folder / Path(name).name).read_bytes()).hexdigest() for name in note["files"]}
    except (OSError, KeyError, TypeError, AttributeError):
        return False
    return bool(found) and found == note["files"]
