"""``symrender compare``: judge one image against another."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from symrender.cli._options import Force, Json, Quiet


def compare(
    reference: Annotated[Path, typer.Argument(help="The image trusted: .exr, .npz or .png.")],
    test: Annotated[Path, typer.Argument(help="The image judged against it.")],
    layer: Annotated[str, typer.Option(help="Layer compared; linear unclipped values.")] = "radiance",
    max_relative_rmse: Annotated[
        float | None, typer.Option(help="Fail above this RMSE, as a fraction of the reference's RMS.")
    ] = None,
    max_abs: Annotated[
        float | None, typer.Option(help="Fail above this |difference| in any pixel, radiance in scene units.")
    ] = None,
    max_flips: Annotated[int | None, typer.Option(help="Fail above this many pixels of different hit class.")] = None,
    flip: Annotated[bool, typer.Option("--flip", help="Also FLIP, the perceptual metric (extra 'flip').")] = False,
    out: Annotated[
        str | None,
        typer.Option("--out", "-o", help="Folder for side_by_side.png, difference.png and signed_difference.png."),
    ] = None,
    force: Force = False,
    json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Compare two images: errors, bias, worst pixel, flips, and what a black image would score.

    Exits 0 when no threshold is exceeded (without thresholds: when the images are equal), 1 when one is, 2 when the
    images cannot be compared (NaN, different sizes, a missing layer).

    Example: symrender compare reference.exr test.exr --max-relative-rmse 1e-3 --out report
    """
    from symrender.cli._console import native_output_hidden
    from symrender.ledger.compare import compare as compare_images

    with native_output_hidden():
        result = compare_images(
            reference, test, layer=layer, max_relative_rmse=max_relative_rmse, max_abs=max_abs, max_flips=max_flips
        )
    perceived = None
    if flip or out is not None:
        perceived = _pictures(reference, test, layer, out, force=force, with_flip=flip)
    if json:
        import json as json_module

        typer.echo(json_module.dumps({**result.as_json(), "flip_mean": perceived}, indent=2, allow_nan=False))
    elif not quiet:
        typer.echo(result.text())
        if perceived is not None:
            typer.echo(f"  FLIP mean {perceived:.4g} (0 equal, 1 most different)")
    if not result.passed:
        raise typer.Exit(1)


def _pictures(
    reference: Path, test: Path, layer: str, out: str | None, *, force: bool, with_flip: bool
) -> float | None:
    from symrender.images.image import read_image
    from symrender.images.output import check_target, make_folder
    from symrender.images.picture import SEQUENTIAL, Picture, color_map
    from symrender.ledger.flip import flip
    from symrender.ledger.pictures import absolute_difference, side_by_side, signed_difference

    a, b = read_image(reference), read_image(test)
    pictures = {
        "side_by_side.png": side_by_side(a, b, layer=layer),
        "difference.png": absolute_difference(a, b, layer=layer),
        "signed_difference.png": signed_difference(a, b, layer=layer),
    }
    mean = None
    if with_flip:
        perceived = flip(a, b)
        mean = perceived.mean
        map_ = color_map(perceived.map.astype(float), 0.0, 1.0, SEQUENTIAL)
        pictures["flip.png"] = Picture(map_, "FLIP: dark violet 0 to yellow 1")
    if out is not None:
        folder = make_folder(out)
        for name in pictures:
            check_target(folder / name, force=force, inputs=(reference, test))
        for name, picture in pictures.items():
            picture.save(folder / name, force=force)
    return mean
