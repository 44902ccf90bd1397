"""``symrender export``: a scene for other renderers, as itself or as formulas."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal

import typer

from symrender.cli._completions import DEFAULT_SCENE
from symrender.cli._options import (
    Define,
    Force,
    Quiet,
    SceneArgument,
    any_scene_with,
    parse_size,
    scene_files,
)
from symrender.errors import OptionError
from symrender.limits import MAX_LISTED_LOBE


def export(
    to: Annotated[
        Literal["glsl", "mitsuba", "pbrt"],
        typer.Option("--to", help="glsl: its formulas, with vectors; not glsl: the scene for Mitsuba 3, pbrt-v4."),
    ],
    scene: SceneArgument = DEFAULT_SCENE,
    out: Annotated[
        str, typer.Option("--out", "-o", help="glsl: the file; else the folder. Default: by the scene's name.")
    ] = "",
    lobe: Annotated[
        int, typer.Option(help="glsl: K of the K x K directions listed for every lobe.", min=1, max=MAX_LISTED_LOBE)
    ] = 4,
    size: Annotated[str, typer.Option(help="not glsl: pixels, N for a square, or WxH.")] = "256",
    samples: Annotated[int, typer.Option(help="not glsl: samples a pixel.")] = 256,
    rays: Annotated[
        Literal["box", "centre"],
        typer.Option(help="not glsl: all over pixels, or through centres, as truth has them."),
    ] = "box",
    scale: Annotated[float, typer.Option(help="not glsl: lengths times this; intensities times its square.")] = 1.0,
    center: Annotated[
        str,
        typer.Option(metavar="X,Y,Z", help="not glsl: what becomes the origin, a place or middle (of spheres)."),
    ] = "0,0,0",
    reach: Annotated[
        float, typer.Option(help="not glsl: size of squares that stand for planes, over the scene's; 0 chooses.")
    ] = 0.0,
    calibration: Annotated[
        bool, typer.Option("--calibration", help="not glsl: also a scene every pixel of which must be 1.")
    ] = False,
    define: Define = None,
    force: Force = False,
    quiet: Quiet = False,
) -> None:
    """Write SCENE for another renderer: as GLSL formulas, or as a folder with a program that renders it.

    Example: symrender export metal --to mitsuba --rays centre -o metal
    """
    from symrender.bridge.export import export as exported

    chosen = any_scene_with(scene, define)
    if to != "glsl":
        options: dict[str, Any] = {"reach": reach} if reach else {}
        made = exported(
            chosen, to, size=parse_size(size), samples=samples, rays=rays, scale=scale, center=_place(center),
            calibration=calibration, **options,
        )  # fmt: skip
        written = made.save(out or f"{Path(scene).stem}.{to}", force=force, inputs=scene_files(scene))
        if not quiet:
            for path in written:
                typer.echo(f"wrote {path}")
        return
    from symrender.images.output import check_target

    target = Path(out or f"{Path(scene).stem}.glsl")
    beside = target.with_name(f"{target.stem}.vectors.json")
    for path in (target, beside):
        check_target(path, force=force, inputs=scene_files(scene))
    formulas = exported(chosen, "glsl", target, lobe=lobe, force=force)
    if not quiet:
        asked = formulas.vectors["vectors"]
        typer.echo(f"wrote {target} ({len(formulas.text.encode()) / 1000:.0f} kB of GLSL)")
        typer.echo(f"wrote {beside} ({len(asked)} vectors of {len(formulas.vectors['functions'])} functions)")


def _place(text: str) -> Any:
    """``middle``, or three numbers."""
    if text == "middle":
        return text
    try:
        place = tuple(float(x) for x in text.split(","))
    except ValueError:
        place = ()
    if len(place) != 3 or not all(abs(x) < 1e12 for x in place):
        raise OptionError(f"center: must be X,Y,Z or middle, got {text[:40]!r}")
    return place
