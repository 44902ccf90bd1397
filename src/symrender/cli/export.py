"""``symrender export``: a scene's formulas for other renderers."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import typer

from symrender.cli._completions import DEFAULT_SCENE
from symrender.cli._options import Define, Force, Quiet, SceneArgument, scene_files, scene_with
from symrender.limits import MAX_LISTED_LOBE


def export(
    form: Annotated[Literal["glsl"], typer.Argument(help="What is written: GLSL ES 3.00.")],
    scene: SceneArgument = DEFAULT_SCENE,
    out: Annotated[
        str, typer.Option("--out", "-o", help="The .glsl written; default: SCENE.glsl, the vectors beside it.")
    ] = "",
    lobe: Annotated[
        int, typer.Option(help="K of the K x K directions listed for every lobe.", min=1, max=MAX_LISTED_LOBE)
    ] = 4,
    define: Define = None,
    force: Force = False,
    quiet: Quiet = False,
) -> None:
    """Write the formulas of SCENE as GLSL, and beside it vectors that prove what each function returns.

    Example: symrender export glsl gloss --out gloss.glsl
    """
    from symrender.images.output import check_target

    chosen = scene_with(scene, define, "export")
    target = Path(out or f"{Path(scene).stem}.{form}")
    beside = target.with_name(f"{target.stem}.vectors.json")
    for written in (target, beside):
        check_target(written, force=force, inputs=scene_files(scene))
    from symrender.bridge.export import export as exported

    made = exported(chosen, form, target, lobe=lobe, force=force)
    if not quiet:
        asked = made.vectors["vectors"]
        typer.echo(f"wrote {target} ({len(made.text.encode()) / 1000:.0f} kB of GLSL)")
        typer.echo(f"wrote {beside} ({len(asked)} vectors of {len(made.vectors['functions'])} functions)")
