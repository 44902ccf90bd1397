"""``symrender info``: what an image or a scene holds, and who computes what of it."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from symrender.cli._console import native_output_hidden, show_json, show_table
from symrender.cli._means import FilterOption
from symrender.cli._options import IMAGES, Define, Json, any_scene_with

if TYPE_CHECKING:
    from symrender.scene.radiometric.film import Film


def info(
    file: Annotated[str, typer.Argument(help="An .exr, .npz or .png, or a scene: a gallery name or a file.")],
    scene: Annotated[bool, typer.Option("--scene", help="Print the scene an image was made of, as YAML.")] = False,
    filter: FilterOption = "centre",
    define: Define = None,
    json: Json = False,
) -> None:
    """Print the layers of an image and what made it; of a scene what it holds and what computes its light.

    Light is computed by quadrature where that covers the scene, else by sampled paths; the reason is printed.

    Example: symrender info out/truth.exr

    Example: symrender info metal --filter box
    """
    if Path(file).suffix.lower() in IMAGES and not define:
        _image(Path(file), scene, json)
        return
    facts = _scene(file, define, filter)
    if json:
        show_json(facts)
        return
    for name, value in facts.items():
        if isinstance(value, dict):
            show_table(name, [(name, ""), *((key, str(each)) for key, each in value.items())])
        else:
            typer.echo(f"{name}: {value}")


def _scene(source: str, define: Define, filter: FilterOption) -> dict[str, Any]:
    """Facts of a scene, and the provider of each layer of its reference image."""
    from symrender.scene.radiometric.scene import RadiometricScene

    found = any_scene_with(source, define)
    facts: dict[str, Any] = {"name": found.name, "hash": found.hash}
    if not isinstance(found, RadiometricScene):
        return facts | {
            "units": "series",
            "spheres": len(found.spheres),
            "planes": len(found.planes),
            "lights": len(found.lights),
            "providers": {"direct": "quadrature", "gloss": "quadrature"},
        }
    from symrender.radiance.choice import plan_of
    from symrender.scene.radiometric.arrays import radiometric_arrays
    from symrender.settings import Settings

    settings = Settings(filter=filter, method="auto")
    return facts | {
        "units": "radiometric",
        "bounces": found.bounces,
        **({"film": _film(found.film)} if found.film is not None else {}),
        "shapes": dict(Counter(each.type for each in found.shapes)),
        "materials": dict(Counter(each.type for each in found.materials.values())),
        "lights": dict(Counter(each.type for each in found.lights)),
        "providers": plan_of(radiometric_arrays(found), settings).providers(),
    }


def _film(film: Film) -> dict[str, str]:
    """What image the file of another renderer asks for."""
    radius = "" if film.filter_radius is None else f" --filter-radius {film.filter_radius:g}"
    due = {"size": f"--size {film.width}x{film.height}", "filter": f"--filter {film.filter}{radius}"}
    return due | {f"note {number}": note for number, note in enumerate(film.notes.split("; "), 1) if note}


def _image(file: Path, scene: bool, json: bool) -> None:
    """Print what an image file holds, or its scene."""
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
