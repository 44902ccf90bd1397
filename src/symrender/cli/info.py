"""``symrender info``: what an image file holds and how it was made."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from symrender.cli._console import native_output_hidden, show_json, show_table
from symrender.cli._options import Json


def info(
    file: Annotated[Path, typer.Argument(help="An .exr, .npz or .png, ours or another program's.")],
    scene: Annotated[bool, typer.Option("--scene", help="Print the scene it was made of, as YAML.")] = False,
    json: Json = False,
) -> None:
    """Print the layers of an image, the range of each, and what made it.

    Example: symrender info out/truth.exr
    """
    import numpy as np

    from symrender.images.image import read_image

    with native_output_hidden():
        image = read_image(file)
    if scene:
        typer.echo(image.recipe()[0], nl=False)
        return
    layers = [
        {
            "layer": name,
            "channels": 1 if array.ndim == 2 else 3,
            "lowest": float(array[np.isfinite(array)].min(initial=np.inf)),
            "mean": float(array[np.isfinite(array)].mean()) if np.isfinite(array).any() else float("nan"),
            "highest": float(array[np.isfinite(array)].max(initial=-np.inf)),
            "not_finite": int((~np.isfinite(array)).sum()),
        }
        for name, array in image.layers.items()
    ]
    facts = {name: value for name, value in image.meta.items() if name != "scene"}
    if json:
        show_json({"width": image.width, "height": image.height, "layers": layers, "meta": facts})
        return
    typer.echo(f"{file}: {image.width} x {image.height} pixels, linear")
    rows: list[tuple[str, ...]] = [("layer", "channels", "lowest", "mean", "highest", "not finite")]
    for told in layers:
        numbers = (f"{told[key]:.6g}" for key in ("lowest", "mean", "highest"))
        rows.append((str(told["layer"]), str(told["channels"]), *numbers, str(told["not_finite"])))
    show_table("layers", rows)
    for name, value in facts.items():
        typer.echo(f"{name}: {value}")
    if "scene" in image.meta:
        typer.echo(f"symrender render {file} makes it again; --scene prints its scene")
