"""``symrender scenes``: the scenes that come with symrender, and the form of a scene file."""

from __future__ import annotations

from typing import Annotated

import typer

from symrender.cli._completions import scene_names
from symrender.cli._options import Json
from symrender.errors import OptionError
from symrender.scene.nearest import did_you_mean


def scenes(
    show: Annotated[
        str | None,
        typer.Option(metavar="NAME", help="Print a scene's YAML: a file to start from.", autocompletion=scene_names),
    ] = None,
    schema: Annotated[bool, typer.Option("--schema", help="Print the JSON Schema of a scene file.")] = False,
    keys: Annotated[
        bool, typer.Option("--keys", help="Print every key of a scene file, its default and range.")
    ] = False,
    json: Json = False,
) -> None:
    """List the gallery scenes, or print one as YAML, every key a scene may have, or its JSON Schema.

    Example: symrender scenes --show gloss > mine.yaml
    """
    from symrender.scene import gallery
    from symrender.scene.load import load_any

    if show is not None:
        if show not in gallery.all_names():
            guess = did_you_mean(show, gallery.all_names())
            raise OptionError(f"show: must be one of {', '.join(gallery.all_names())}, got {show[:40]!r}{guess}")
        typer.echo(gallery.text(show), nl=False)
    elif keys:
        from symrender.scene.keys import key_tables

        typer.echo(key_tables())
    elif schema:
        import json as json_module

        from symrender.scene.schema import json_schema

        typer.echo(json_module.dumps(json_schema(), indent=2))
    elif json:
        import json as json_module

        typer.echo(json_module.dumps({name: load_any(name).description for name in gallery.all_names()}, indent=2))
    else:
        width = max(map(len, gallery.all_names()))
        for name in gallery.all_names():
            typer.echo(f"{name.ljust(width)}  {load_any(name).description}")
