"""Options of the verbs that work long: threads, tiles, a cluster, a journal; and how a signal ends them."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING, Annotated

import typer

from symrender.cli._signals import heard
from symrender.errors import OptionError
from symrender.settings import Filter, Method

if TYPE_CHECKING:
    from symrender.execution.fill import Means
    from symrender.execution.journal import Start
    from symrender.execution.preview import Watch

Threads = Annotated[int, typer.Option(help="Worker threads; 0 takes the processors this process may use.")]
Tile = Annotated[int, typer.Option(help="Side of a tile, pixels; 0 measures one; changes no byte of the image.")]
Resume = Annotated[
    bool, typer.Option("--resume", help="Continue an interrupted run: its bytes are those of a whole one.")
]
Restart = Annotated[bool, typer.Option("--restart", help="Discard what an interrupted run left.")]
Cluster = Annotated[
    str,
    typer.Option(
        metavar="ADDRESS",
        help="Work on a dask.distributed cluster: tcp://host:port, tls://host:port, or local:N processes here "
        "(extra 'dist'); changes no byte of the image.",
    ),
]
InsecureCluster = Annotated[
    bool,
    typer.Option(
        "--insecure-cluster", help="Accept a scheduler on another machine without TLS: anyone there may listen."
    ),
]

PreviewOption = Annotated[
    str,
    typer.Option(
        "--preview",
        metavar="WHERE",
        help="A .png that shows the picture while it is made, or tev to see it there.",
    ),
]
SilhouettesOption = Annotated[
    int, typer.Option("--silhouettes", help="K of the K x K points of a pixel at a silhouette; 1: its centre.")
]

FilterOption = Annotated[
    Filter,
    typer.Option("--filter", help="What a pixel is: its centre's ray, the mean over its box, or weighed."),
]
FilterRadius = Annotated[
    float,
    typer.Option("--filter-radius", metavar="R", help="Half the filter's width in pixels, .5 to 2; 0: its own."),
]

MethodOption = Annotated[
    Method,
    typer.Option(
        "--method",
        help="quadrature: refuse what it does not cover. sampled: paths with a confidence interval. auto: quadrature "
        "for each component that it covers, paths for the rest.",
    ),
]


def means_of(
    *, threads: int, tile: int, resume: bool, restart: bool, cluster: str, insecure_cluster: bool, journal: Path
) -> Means:
    """The options as one value; OptionError when they contradict each other."""
    from symrender.execution.fill import Means

    if resume and restart:
        raise OptionError("resume, restart: choose one")
    start: Start = "resume" if resume else "restart" if restart else "new"
    return Means(threads, tile, cluster, insecure_cluster, journal, start)


@contextmanager
def ended_by_signals() -> Iterator[None]:
    """Within the block SIGTERM and SIGHUP end the run as Ctrl-C does, cleaned up, with the exit code 128 + signal."""

    def leave(number: int, frame: FrameType | None) -> None:
        raise SystemExit(128 + number)

    numbers = [getattr(signal, name) for name in ("SIGTERM", "SIGHUP") if hasattr(signal, name)]
    before = {number: signal.signal(number, heard(leave)) for number in numbers}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def shown_in(file: str) -> Watch | None:
    """The preview ``--preview`` asks for, None for none."""
    from symrender.execution.tev import watched

    return watched(file) if file else None
