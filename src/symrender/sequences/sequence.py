"""Make the frames of a sequence, one after another, so that an interruption costs at most the tiles under way.

Beside the frames stands the journal of the sequence: the lock, what decides every byte, and for each finished frame its
files with their hashes and its row. A frame under way has a journal of its own. Both go when the sequence stands.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

from symrender.errors import OptionError, OutputError
from symrender.execution.fill import Crew, Means, workers_of
from symrender.execution.journal import Journal
from symrender.execution.tiles import Progress
from symrender.images.output import write_bytes
from symrender.sequences.makers import Maker, Row
from symrender.sequences.over import Frame
from symrender.sequences.store import Store

Finish = Callable[[list[Row]], None]
"""Called with every frame's row once all frames stand, before the journal goes."""


def make_frames(
    frames: Sequence[Frame],
    maker: Maker,
    folder: Path,
    means: Means,
    *,
    store: Store,
    progress: Progress | None = None,
    finish: Finish | None = None,
) -> list[Row]:
    """Keep every frame in ``store`` and return their rows: frame, changes, figures, and the files with SHA-256.

    A frame an interrupted run finished is taken over if its files, below ``folder``, still have their hashes.
    ``means.journal`` is the sequence's journal. Progress is told in frames.
    """
    assert means.journal is not None
    rows: list[Row] = []
    with Journal(means.journal, _fields(frames, maker, store), means.start, means.patience) as journal:
        standing = {note["frame"]: note for note in journal.notes() if _stands(folder, note)}
        if not standing:
            store.clear()
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
                        files: dict[str, str] = {}
                        for name, image in images.items():
                            files |= store.write(frame, name, image)
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


@contextmanager
def replacing(means: Means, *, force: bool) -> Iterator[bool]:
    """Whether files that stand may be replaced; a refusal within the block names the run that left them, if one did."""
    journal = means.journal
    left = journal is not None and journal.exists()
    try:
        yield force or (left and means.start != "new")
    except OutputError:
        if not left or means.start != "new":
            raise
        raise OptionError(
            f"{journal}: a run that was interrupted, or still goes on, left frames here; "
            "--resume continues it, --restart discards it"
        ) from None


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


def _fields(frames: Sequence[Frame], maker: Maker, store: Store) -> dict[str, str]:
    """What decides the bytes of all frames."""
    jobs = maker.jobs(frames[0].scene)
    changes = json.dumps([frame.changes for frame in frames])
    every = hashlib.sha256("".join(frame.scene.hash for frame in frames).encode()).hexdigest()
    decisive = {"images": " ".join(job.kind for job in jobs), "form": store.form} | jobs[0].fields()
    return decisive | {"scene": every, "over": hashlib.sha256(changes.encode()).hexdigest(), "frames": str(len(frames))}


def _stands(folder: Path, note: Row) -> bool:
    """Whether the files of a noted frame are there, unchanged."""
    try:
        names = [name for name in note["files"] if ".." not in Path(name).parts and not Path(name).is_absolute()]
        found = {name: hashlib.sha256((folder / name).read_bytes()).hexdigest() for name in names}
    except (OSError, KeyError, TypeError, AttributeError):
        return False
    return bool(found) and found == note["files"]
