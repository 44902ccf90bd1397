"""``symrender fit``: find scene parameters from an image."""

from __future__ import annotations

import math
import sys
from typing import Annotated

import typer

from symrender.cli._completions import numbers
from symrender.cli._means import FilterOption, FilterRadius
from symrender.cli._options import Define, Force, Json, Quiet, SceneArgument, any_scene_with, scene_files
from symrender.images.output import check_target, write_bytes


def fit(
    scene: SceneArgument,
    target: Annotated[str, typer.Argument(help="Image to be met: an .exr or .npz with a radiance layer.")],
    free: Annotated[
        str,
        typer.Option(
            "--free", metavar="NAME,...", help="Real numbers of the scene to be found.", autocompletion=numbers
        ),
    ],
    tol: Annotated[float, typer.Option(help="Absolute error asked of every pixel, scene radiance.")] = 1e-6,
    iterations: Annotated[int, typer.Option(help="Most iterations.")] = 20,
    precision: Annotated[float, typer.Option(help="Relative change of the parameters that ends the fit.")] = 1e-9,
    disk: Annotated[str, typer.Option(help="Disk lights: KxK centroids, or exact.")] = "2x2",
    filter: FilterOption = "centre",
    filter_radius: FilterRadius = 0.0,
    define: Define = None,
    out: Annotated[str, typer.Option("--out", "-o", help="File the scene found is written to, .yaml.")] = "",
    force: Force = False,
    json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Change the numbers --free of SCENE until its image is TARGET; exit 4 if that did not converge.

    The report names the combinations of the numbers that TARGET does not determine and the numbers at the end of their
    range.

    Example: symrender fit gloss out/truth.npz --free spheres.B.center,floor.lobe.exponent -D spheres.B.center.x=1.05
    """
    from symrender.images.image import read_image

    chosen = any_scene_with(scene, define)
    if out:
        check_target(out, force=force, inputs=[*scene_files(scene), target])
    image = read_image(target)
    if target.lower().endswith(".png") and not quiet:
        typer.echo(
            f"WARNING {target}: a PNG holds 8 bits clipped to [0, 1]: parameters are found to about .004 of the light, "
            "and none where it clips; fit to an .exr or .npz",
            err=True,
        )

    from symrender.fit import STEP_HEADING, Step
    from symrender.fit import fit as find

    def told(step: Step) -> None:
        if not quiet and not json:
            typer.echo((f"{STEP_HEADING}\n" if step.iteration == 1 else "") + step.text(), err=True)

    names = [name.strip() for name in free.split(",") if name.strip()]
    found = find(
        chosen, image, names, tol=tol, iterations=iterations, precision=precision, disk=disk, filter=filter,
        filter_radius=filter_radius, progress=told,
    )  # fmt: skip
    if out:
        from symrender.scene.dump import to_yaml

        write_bytes(out, to_yaml(found.scene).encode(), force=force)
    if json:
        import json as json_module

        report = {
            "converged": found.converged,
            "reason": found.reason,
            "values": dict(found.values),
            # JSON has no infinity: null is the deviation of what is not determined
            "deviations": {name: part if math.isfinite(part) else None for name, part in found.deviations.items()},
            "rank": found.rank,
            "undetermined": [dict(each) for each in found.undetermined],
            "at_bound": dict(found.at_bound),
            "iterations": len(found.steps),
            "steps": [
                {"weighted_rms": step.cost, "change": step.change, "values": dict(step.values)} for step in found.steps
            ],
            "residual": found.residual,
        }
        typer.echo(json_module.dumps(report, indent=2))
    elif not quiet:
        # on a terminal the steps have been told already
        typer.echo(found.text(steps=not sys.stderr.isatty()))
    if not found.converged:
        raise typer.Exit(4)
