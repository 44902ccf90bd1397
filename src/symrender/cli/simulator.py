"""``symrender simulator``: a scene as one offline HTML page."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from symrender.cli._browser import open_address, open_page
from symrender.cli._completions import DEFAULT_SCENE
from symrender.cli._options import Define, Force, Quiet, SceneArgument, scene_files, scene_with


def simulator(
    scene: SceneArgument = DEFAULT_SCENE,
    out: Annotated[Path, typer.Option("--out", "-o", help="The HTML file to write.")] = Path("simulator.html"),
    serve: Annotated[
        bool, typer.Option("--serve", help="Serve the page on this machine instead; it can prove intervals.")
    ] = False,
    port: Annotated[int, typer.Option(help="Port to serve on; 0 takes a free one.", min=0, max=65535)] = 0,
    open_: Annotated[bool, typer.Option("--open", help="Open the page in the browser.")] = False,
    define: Define = None,
    force: Force = False,
    quiet: Quiet = False,
) -> None:
    """Compile a scene to one self-contained HTML page: sliders, both estimators, the lobe drawn; no network.

    Example: symrender simulator gloss -o gloss.html
    """
    from symrender.images.output import check_target

    chosen = scene_with(scene, define, "simulator")
    if not serve:
        check_target(out, force=force, inputs=scene_files(scene))
    from symrender.simulator.build import simulator_page

    made = simulator_page(chosen, served=serve)
    if serve:
        from symrender.simulator.serve import serve as serve_page

        told, opened = None if quiet else typer.echo, open_address if open_ else None
        serve_page(made, port=port, scene=chosen, told=told, opened=opened)
        return
    made.save(out, force=force)
    if not quiet:
        typer.echo(f"wrote {out} ({len(made.html.encode()) / 1000:.0f} kB)")
    if open_:
        open_page(out)
