"""``symrender render``: one scene, both pipelines, their difference and the ledger."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from symrender.cli._completions import DEFAULT_SCENE
from symrender.cli._console import Patient
from symrender.cli._means import (
    Cluster,
    FilterOption,
    FilterRadius,
    InsecureCluster,
    PreviewOption,
    Restart,
    Resume,
    SilhouettesOption,
    Threads,
    Tile,
    ended_by_signals,
    means_of,
    shown_in,
)
from symrender.cli._options import (
    Define,
    Exposure,
    Force,
    Json,
    Quiet,
    SceneArgument,
    TonemapOption,
    any_scene_with,
    parse_size,
    scene_files,
    settings_of,
)
from symrender.cli._progress import ProgressMode, progress
from symrender.errors import SymrenderError
from symrender.images.output import check_target, make_folder, remove_leftovers
from symrender.limits import MAX_PIXELS
from symrender.settings import Antialias, Nodes, Partition, Sampler, Settings, Symbolic, Weights, image_size

if TYPE_CHECKING:
    from symrender.images.image import Image
    from symrender.ledger.ledger import Ledger
    from symrender.settings import Tonemap

Land = Callable[[str, str], None]
"""``land(file, remark)``, called once that file stands."""


def render(
    ctx: typer.Context,
    scene: SceneArgument = DEFAULT_SCENE,
    size: Annotated[str, typer.Option(help="Pixels: N for a square, or WxH.")] = "512",
    lobe: Annotated[int, typer.Option(help="K of the K rings x K sectors (K x K samples) of a lobe.")] = 4,
    numeric: Annotated[Sampler, typer.Option(help="Sampler of the numeric pipeline.")] = "jittered",
    normalised: Annotated[
        bool, typer.Option(help="Divide by the closed-form normaliser instead of the sum of weights met.")
    ] = False,
    symbolic: Annotated[Symbolic, typer.Option(help="Rule of the symbolic pipeline.")] = "strata",
    weights: Annotated[Weights, typer.Option(help="Weights of the strata.")] = "exact",
    nodes: Annotated[Nodes, typer.Option(help="Where in a stratum the radiance is read.")] = "midpoint",
    partition: Annotated[Partition, typer.Option(help="How the lobe is cut into rings.")] = "equal_angle",
    disk: Annotated[str, typer.Option(help="Disk lights: KxK centroids, or exact.")] = "2x2",
    aa: Annotated[Antialias, typer.Option(help="Antialiasing of the floor's checker.")] = "analytic",
    tol: Annotated[float, typer.Option(help="Error asked of chambers, scene radiance.")] = 1e-3,
    budget: Annotated[int, typer.Option(help="Most evaluations a pixel of chambers.")] = 1_000_000,
    seed: Annotated[int, typer.Option(help="Seed of the samplers.")] = 7,
    silhouettes: SilhouettesOption = 1,
    filter: FilterOption = "centre",
    filter_radius: FilterRadius = 0.0,
    threads: Threads = 0,
    tile: Tile = 0,
    cluster: Cluster = "",
    insecure_cluster: InsecureCluster = False,
    resume: Resume = False,
    restart: Restart = False,
    max_pixels: Annotated[int, typer.Option(help="Most pixels accepted.")] = MAX_PIXELS,
    define: Define = None,
    out: Annotated[str, typer.Option("--out", "-o", help="Folder the files are written to; made if missing.")] = "out",
    views: Annotated[
        bool, typer.Option("--views", help="Also write gloss and hit-class pictures of each render.")
    ] = False,
    exposure: Exposure = 0.0,
    tonemap: TonemapOption = "clip",
    preview: PreviewOption = "",
    force: Force = False,
    json: Json = False,
    quiet: Quiet = False,
    progress_mode: Annotated[
        ProgressMode, typer.Option("--progress", help="auto: a bar on a terminal; json: lines on stderr.")
    ] = "auto",
) -> None:
    """Render SCENE numerically and symbolically, write both, their difference, and print the ledger.

    Writes numeric.png and numeric.exr as soon as that image stands, then symbolic.png and symbolic.exr, then
    difference.png. Every file is its old self or the new one, never in between; an error says which files are of an
    earlier run. The .exr holds every layer as linear radiance with the scene and the settings; the .png is clipped to
    [0, 1] and sRGB encoded.

    A run longer than two seconds keeps what it has finished in render.journal beside them, until they are written;
    --resume continues it after any interruption.

    An image of ours in place of SCENE is made again: its scene and its settings, but for the options given.

    Example: symrender render gloss --size 640x480 --lobe 8 -D floor.lobe.exponent=64 --out pictures
    """
    width, height = image_size(parse_size(size))
    asked = {
        "width": width, "height": height, "lobe": lobe, "numeric": numeric, "normalised": normalised,
        "symbolic": symbolic, "weights": weights, "nodes": nodes, "partition": partition, "disk": disk, "aa": aa,
        "tol": tol, "budget": budget, "silhouettes": silhouettes, "filter": filter, "filter_radius": filter_radius,
        "seed": seed, "threads": threads, "tile": tile, "max_pixels": max_pixels,
    }  # fmt: skip
    settings = Settings(**as_made(asked, settings_of(scene), ctx))
    chosen = any_scene_with(scene, define)
    if not quiet:
        from symrender.scene.warnings import warnings

        for warning in warnings(chosen):
            typer.echo(f"WARNING {warning}", err=True)

    from symrender.execution.fill import Crew
    from symrender.render import carry_out, plan

    jobs = plan(chosen, settings)
    names = [job.side for job in jobs]
    gloss = "gloss" in jobs[0].empty_layers()
    folder = make_folder(out)
    journal = folder / "render.journal"
    # a journal is left only by a run that was allowed to replace these files
    force = force or (resume and journal.exists())
    for name in _file_names(names, views=views, gloss=gloss):
        check_target(folder / name, force=force, inputs=scene_files(scene))
    means = means_of(
        threads=threads,
        tile=tile,
        resume=resume,
        restart=restart,
        cluster=cluster,
        insecure_cluster=insecure_cluster,
        journal=journal,
    )
    written: dict[str, str] = {}
    say = Patient()

    def land(file: str, remark: str) -> None:
        written[file] = remark
        if not json and not quiet:
            say(f"wrote {folder / file}{f' ({remark})' if remark else ''}")

    with (
        ended_by_signals(),
        progress(progress_mode, quiet=quiet) as advance,
        Crew(means, jobs, advance, preview=shown_in(preview)) as crew,
        _older_files_named(folder, _file_names(names, views=views, gloss=gloss), written),
    ):
        for name in _file_names(names, views=views, gloss=gloss):
            remove_leftovers(folder / name)
        pair = carry_out(
            crew,
            jobs,
            chosen,
            lambda side, image: _write(side, image, folder, land, views=views, force=force, look=(exposure, tonemap)),
        )
        if pair.numeric is not None and pair.symbolic is not None:
            _write_difference(pair.numeric, pair.symbolic, folder, land, force=force)
        crew.succeeded()
    say.end()
    if json:
        import json as json_module

        report = {"files": written, "ledger": pair.ledger.as_json()}
        typer.echo(json_module.dumps(report, indent=2, allow_nan=False))
    elif not quiet:
        _print_ledger(pair.ledger)


def as_made(asked: dict[str, Any], made: dict[str, Any], ctx: typer.Context) -> dict[str, Any]:
    """The settings ``asked`` for, with those an image was ``made`` with where no option says otherwise."""

    def given(name: str) -> bool:
        source = ctx.get_parameter_source("size" if name in ("width", "height") else name)
        return source is not None and source.name != "DEFAULT"

    decisive = {field.name for field in fields(Settings)} - {"threads", "tile", "max_pixels"}
    return asked | {name: value for name, value in made.items() if name in decisive and not given(name)}


def _print_ledger(ledger: Ledger) -> None:
    if sys.stdout.isatty():
        from rich.console import Console

        Console().print(ledger)
    else:
        typer.echo(ledger.text())


def _file_names(sides: list[str], *, views: bool, gloss: bool) -> list[str]:
    shown = ("_gloss.png", "_hit_class.png")[0 if gloss else 1 :]
    endings = (".png", ".exr", *(shown if views else ()))
    names = [side + ending for side in sides for ending in endings]
    return [*names, "difference.png"] if len(sides) == 2 else names


@contextmanager
def _older_files_named(folder: Path, names: list[str], written: Mapping[str, str]) -> Iterator[None]:
    """An error after the first picture says, in its line, which files are still those of an earlier run."""
    try:
        yield
    except SymrenderError as error:
        older = [name for name in names if name not in written and (folder / name).exists()]
        if written and older:
            error.args = (f"{error} ({', '.join(written)} are of this run; {', '.join(older)} of an earlier one)",)
        raise


def _write(
    side: str, image: Image, folder: Path, land: Land, *, views: bool, force: bool, look: tuple[float, Tonemap]
) -> None:
    """Write the files of one pipeline; ``land`` is told each, with what its picture leaves out or means."""
    from concurrent.futures import ThreadPoolExecutor

    from symrender.images.views import gloss_view, hit_class_view

    # the encoders leave Python to work
    with ThreadPoolExecutor(1) as pool:
        whole = pool.submit(image.save, folder / f"{side}.exr", force=force)
        try:
            saved = image.save(folder / f"{side}.png", force=force, exposure=look[0], tonemap=look[1])
            land(f"{side}.png", f"{saved.clipped} of {image.width * image.height} pixels clipped")
            if views:
                made = [("gloss", gloss_view(image))] if "gloss" in image.layers else []
                for file, view in (*made, ("hit_class", hit_class_view(image))):
                    view.save(folder / f"{side}_{file}.png", force=force)
                    land(f"{side}_{file}.png", view.caption)
        finally:
            whole.result()
            land(f"{side}.exr", "")


def _write_difference(numeric: Image, symbolic: Image, folder: Path, land: Land, *, force: bool) -> None:
    from symrender.ledger.pictures import absolute_difference

    picture = absolute_difference(numeric, symbolic)
    picture.save(folder / "difference.png", force=force)
    land("difference.png", picture.caption)
