"""``symrender convert``: a scene file of another renderer as YAML."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from symrender.cli._options import Force, Quiet
from symrender.errors import OptionError


def convert(
    scene: Annotated[str, typer.Argument(help="A scene of Mitsuba (.xml) or pbrt-v4 (.pbrt).")],
    to: Annotated[str, typer.Argument(help="The YAML file to write.")],
    force: Force = False,
    quiet: Quiet = False,
) -> None:
    """Write a scene of Mitsuba or pbrt as YAML, and the meshes and images that it names into a folder next to it.

    Example: symrender convert scene.xml scene.yaml
    """
    from symrender.images.output import check_target
    from symrender.scene.convert import write_converted

    target = Path(to)
    if target.suffix.lower() not in (".yaml", ".yml"):
        raise OptionError(f"{to}: must be a file ending in .yaml or .yml")
    check_target(target, force=force, inputs=[Path(scene)])
    written = write_converted(scene, to)
    if not quiet:
        for path in written:
            typer.echo(f"wrote {path}")
