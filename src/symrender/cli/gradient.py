"""``symrender gradient``: the derivative of an image in scene parameters, as signed pictures."""

from __future__ import annotations

from typing import Annotated

import typer

from symrender.cli._completions import DEFAULT_SCENE, numbers
from symrender.cli._console import show_json
from symrender.cli._means import (
    Cluster,
    FilterOption,
    FilterRadius,
    InsecureCluster,
    MethodOption,
    Restart,
    Resume,
    Threads,
    Tile,
    ended_by_signals,
    means_of,
)
from symrender.cli._options import Define, Force, Json, Quiet, SceneArgument, any_scene_with, parse_size, scene_files
from symrender.cli._progress import ProgressMode, progress
from symrender.images.output import check_target, make_folder
from symrender.limits import MAX_PIXELS
from symrender.settings import Antialias, split_settings


def gradient(
    scene: SceneArgument = DEFAULT_SCENE,
    wrt: Annotated[
        str,
        typer.Option(
            "--wrt",
            metavar="NAME,...",
            help="Real numbers of the scene, or vectors: spheres.B.center.",
            autocompletion=numbers,
        ),
    ] = "",
    size: Annotated[str, typer.Option(help="Pixels: N for a square, or WxH.")] = "64",
    tol: Annotated[float, typer.Option(help="Absolute error asked for, scene radiance over the unit.")] = 1e-4,
    budget: Annotated[int | None, typer.Option(help="Most evaluations a pixel may take. Default: about 1e6.")] = None,
    disk: Annotated[str, typer.Option(help="Disk lights: KxK centroids, or exact.")] = "2x2",
    aa: Annotated[Antialias, typer.Option(help="Antialiasing of the floor's checker.")] = "analytic",
    filter: FilterOption = "centre",
    filter_radius: FilterRadius = 0.0,
    method: MethodOption = "auto",
    threads: Threads = 0,
    tile: Tile = 0,
    cluster: Cluster = "",
    insecure_cluster: InsecureCluster = False,
    resume: Resume = False,
    restart: Restart = False,
    max_pixels: Annotated[int, typer.Option(help="Most pixels accepted.")] = MAX_PIXELS,
    define: Define = None,
    out: Annotated[str, typer.Option("--out", "-o", help="Folder the files are written to; made if missing.")] = "out",
    force: Force = False,
    json: Json = False,
    quiet: Quiet = False,
    progress_mode: Annotated[
        ProgressMode, typer.Option("--progress", help="auto: a bar on a terminal; json: lines on stderr.")
    ] = "auto",
) -> None:
    """Differentiate the image of SCENE, edges included; exit 4 if some derivative missed the tolerance.

    Writes for every parameter NAME gradient_NAME.png (blue falls, red rises, with a legend), .exr and .npz, with the
    layers radiance, direct, gloss, error and status.

    Example: symrender gradient gloss --wrt floor.lobe.exponent --size 32 --tol 1e-3 --out pictures
    """
    from symrender.errors import OptionError
    from symrender.gradient import file_stem
    from symrender.scene.moves import components

    names = [name.strip() for name in wrt.split(",") if name.strip()]
    if not names:
        raise OptionError(
            "wrt: name at least one real number, such as --wrt spheres.B.center.x; symrender params lists"
        )
    settings = split_settings(
        parse_size(size),
        tol=tol,
        disk=disk,
        aa=aa,
        budget=budget,
        threads=threads,
        tile=tile,
        filter=filter,
        filter_radius=filter_radius,
        method=method,
        max_pixels=max_pixels,
    )
    chosen = any_scene_with(scene, define)
    every = components(chosen, names)
    folder = make_folder(out)
    journal = folder / "gradient.journal"
    force = force or (resume and journal.exists())
    stems = {name: file_stem(name) for name in every}
    for stem in stems.values():
        for ending in ("png", "exr", "npz"):
            check_target(folder / f"{stem}.{ending}", force=force, inputs=scene_files(scene))
    means = means_of(
        threads=threads,
        tile=tile,
        resume=resume,
        restart=restart,
        cluster=cluster,
        insecure_cluster=insecure_cluster,
        journal=journal,
    )

    from symrender.execution.fill import Crew
    from symrender.gradient import STATUS, gradient_images, gradient_job
    from symrender.images.signed_view import signed_view
    from symrender.truth import verdict

    job = gradient_job(chosen, every, settings)
    with ended_by_signals(), progress(progress_mode, quiet=quiet) as advance, Crew(means, (job,), advance) as crew:
        images = gradient_images(crew, job, chosen)
        for name, image in images.items():
            signed_view(image, name).save(folder / f"{stems[name]}.png", force=force)
            image.save(folder / f"{stems[name]}.exr", force=force)
            image.save(folder / f"{stems[name]}.npz", force=force)
        crew.succeeded()
    judged = {name: verdict(image, STATUS) for name, image in images.items()}
    if json:
        report = [
            {
                "parameter": name,
                "pixels": one.pixels,
                "missed": dict(one.missed),
                "largest_error": one.largest,
                "at": one.worst,
            }
            for name, one in judged.items()
        ]
        show_json(report)
    elif not quiet:
        for name, one in judged.items():
            typer.echo(f"{name}: {one.text()}")
        for stem in stems.values():
            typer.echo(f"wrote {folder / stem}.png, .exr, .npz")
    if not all(one.met for one in judged.values()):
        raise typer.Exit(4)
