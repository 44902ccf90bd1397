"""``symrender params``: every number of a scene by its dotted name."""

from __future__ import annotations

import typer

from symrender.cli._completions import DEFAULT_SCENE
from symrender.cli._options import Define, Json, SceneArgument, any_scene_with


def params(scene: SceneArgument = DEFAULT_SCENE, define: Define = None, json: Json = False) -> None:
    """List the parameters of SCENE: name, value, unit, range. The names work in -D and in Python.

    Example: symrender params chapter8
    """
    from symrender.cli._console import show_table

    parameters = any_scene_with(scene, define).parameters()
    if json:
        import json as json_module
        from dataclasses import asdict

        typer.echo(json_module.dumps([asdict(p) for p in parameters], indent=2, allow_nan=False))
        return
    rows = [("name", "value", "unit", "lowest", "highest")]
    rows += [(p.name, f"{p.value!r}", p.unit, f"{p.low:g}", f"{p.high:g}") for p in parameters]
    show_table(f"parameters of {scene}", rows)
