"""``symrender cite``: how to refer to this version, and to a scene by its hash."""

from __future__ import annotations

from typing import Annotated

import typer

from symrender.cli._options import Define, any_scene_with
from symrender.version import VERSION


def cite(
    scene: Annotated[str, typer.Argument(help="A scene to name with its hash; none: the program alone.")] = "",
    define: Define = None,
) -> None:
    """Print a BibTeX entry of this version, with the hash of SCENE where one is given.

    Example: symrender cite gloss
    """
    note = ""
    if scene:
        chosen = any_scene_with(scene, define)
        note = f"\n  note    = {{Scene {chosen.name}, SHA-256 {chosen.hash}}},"
    typer.echo(
        f"@software{{symrender,\n  title   = {{symrender: the oracle for rendering}},\n"
        f"  author  = {{{{The symrender authors}}}},\n  version = {{{VERSION}}},\n  license = {{MIT}},{note}\n}}"
    )
