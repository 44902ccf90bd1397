"""``symrender view``: a layer of an image as a picture that any program shows."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from symrender.cli._browser import open_page
from symrender.cli._completions import layers_of_file
from symrender.cli._console import native_output_hidden
from symrender.cli._options import Exposure, Force, Quiet, TonemapOption
from symrender.images.output import check_target


def view(
    file: Annotated[Path, typer.Argument(help="An .exr, .npz or .png.")],
    layer: Annotated[
        str, typer.Option(help="The layer shown; symrender info lists them.", autocompletion=layers_of_file)
    ] = "radiance",
    exposure: Exposure = 0.0,
    tonemap: TonemapOption = "clip",
    scale: Annotated[
        float | None,
        typer.Option(help="Value of the last colour of layers that are no light; default: measured."),
    ] = None,
    out: Annotated[str, typer.Option("--out", "-o", help="The .png written; default: beside FILE.")] = "",
    open_: Annotated[bool, typer.Option("--open", help="Open the picture.")] = False,
    force: Force = False,
    quiet: Quiet = False,
) -> None:
    """Write a layer of FILE as a PNG, and print what its colours mean.

    Example: symrender view out/truth.exr --layer error --open
    """
    from symrender.images.image import read_image

    target = Path(out) if out else file.with_name(f"{file.stem}_{layer}.png")
    check_target(target, force=force, inputs=[file])
    with native_output_hidden():
        image = read_image(file)
    picture = image.view(layer, exposure=exposure, tonemap=tonemap, scale=scale)
    picture.save(target, force=force)
    if not quiet:
        typer.echo(f"wrote {target} ({picture.caption})")
    if open_:
        open_page(target)
