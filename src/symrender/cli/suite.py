"""``symrender suite``: the truth suite as files."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from symrender.cli._means import Threads
from symrender.cli._options import Force, Quiet, parse_size

if TYPE_CHECKING:
    from symrender.suite.write import Entry


def suite(
    scenes: Annotated[list[str] | None, typer.Argument(help="Names of scenes of the suite; none: all of them.")] = None,
    out: Annotated[
        str, typer.Option("--out", "-o", help="Folder the files are written to; made if missing.")
    ] = "suite",
    size: Annotated[str, typer.Option(help="Pixels: N for a square, or WxH.")] = "32",
    tol: Annotated[float, typer.Option(help="Absolute error asked of every pixel.")] = 1e-8,
    threads: Threads = 0,
    force: Force = False,
    quiet: Quiet = False,
) -> None:
    """Write small scenes, one mechanism of light each, with truths and what Mitsuba and pbrt read.

    A renderer that is wrong in one of them is wrong in one way. Truths are .npz, .exr and .json, of rays through pixel
    centres; suite.json names all by hash.

    Example: symrender suite falloff masking -o suite
    """
    from symrender.suite.write import write_suite

    def done(entry: Entry) -> None:
        if not quiet:
            told = entry.told
            typer.echo(f"{entry.name}: {told['mechanism']}; error at most {told['largest_error']:.1e}")

    written = write_suite(out, scenes or (), size=parse_size(size), tol=tol, threads=threads, force=force, done=done)
    if not quiet:
        typer.echo(f"wrote {len(written)} files below {out}")
