"""``symrender expression``: the formula of what a surface reflects."""

from __future__ import annotations

from typing import Annotated

import typer

from symrender.cli._completions import DEFAULT_SCENE, surfaces
from symrender.cli._options import Define, SceneArgument, scene_with


def expression(
    scene: SceneArgument = DEFAULT_SCENE,
    surface: Annotated[
        str,
        typer.Option(
            help="Surface whose lobe is written out: floor, spheres.NAME or planes.NAME.", autocompletion=surfaces
        ),
    ] = "floor",
    latex: Annotated[bool, typer.Option("--latex", help="Print LaTeX instead of plain text.")] = False,
    define: Define = None,
) -> None:
    """Print the integrand of a surface's glossy reflection: radiance, weight, normaliser and walls.

    Example: symrender expression chapter8 --surface floor --latex
    """
    chosen = scene_with(scene, define, "expression")
    from symrender.expression.integrand import expression as integrand

    held = integrand(chosen, surface=surface)
    typer.echo(held.latex() if latex else str(held))
