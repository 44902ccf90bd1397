"""``symrender chapter``: the chapter as one offline HTML page."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from symrender.cli._options import Force, Quiet
from symrender.cli._progress import ProgressMode


def chapter(
    out: Annotated[Path, typer.Option("--out", "-o", help="The HTML file to write.")] = Path("chapter8.html"),
    quick: Annotated[
        bool, typer.Option("--quick", help="Measure small and leave the laboratory unrun, to try the build.")
    ] = False,
    force: Force = False,
    quiet: Quiet = False,
    progress_mode: Annotated[
        ProgressMode, typer.Option("--progress", help="auto: a bar on a terminal; json: lines on stderr.")
    ] = "auto",
) -> None:
    """Build the chapter on glossy reflection: every figure measured now, the laboratory run, the simulator inside.

    One file that opens without a network. Takes minutes; needs the extra 'chapter'.

    Example: symrender chapter -o chapter8.html
    """
    from symrender.cli._progress import progress
    from symrender.images.output import check_target

    check_target(out, force=force)
    from symrender.chapter.document.build import chapter as build

    with progress(progress_mode, quiet=quiet) as advance:
        made = build(quick=quick, progress=advance)
    made.save(out, force=force)
    if not quiet:
        size = len(made.html.encode()) / 1e6
        typer.echo(f"wrote {out} ({size:.2f} MB, {len(made.figures)} figures, {made.seconds:.0f} s of processor time)")
