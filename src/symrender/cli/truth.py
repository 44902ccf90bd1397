"""``symrender truth``: an image whose every pixel states its error."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING, Annotated

import typer

from symrender.cli._completions import DEFAULT_SCENE, one_of
from symrender.cli._console import show_json
from symrender.cli._means import (
    Cluster,
    FilterOption,
    FilterRadius,
    InsecureCluster,
    MethodOption,
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
)
from symrender.cli._progress import ProgressMode, progress
from symrender.images.output import check_target, make_folder
from symrender.limits import MAX_PIXELS
from symrender.scene.nearest import did_you_mean
from symrender.settings import Antialias, check_share, split_settings

if TYPE_CHECKING:
    from symrender.scene.load import AnyScene

LAYERS = ("error", "status", "evaluations", "chambers", "crossings")
RADIOMETRIC_LAYERS = ("error", "status")


def truth(
    scene: SceneArgument = DEFAULT_SCENE,
    size: Annotated[str, typer.Option(help="Pixels: N for a square, or WxH.")] = "256",
    tol: Annotated[float, typer.Option(help="Absolute error asked of every pixel, scene radiance.")] = 1e-6,
    budget: Annotated[int | None, typer.Option(help="Most evaluations a pixel may take. Default: about 1e6.")] = None,
    disk: Annotated[str, typer.Option(help="Disk lights: KxK centroids, or exact.")] = "2x2",
    aa: Annotated[Antialias, typer.Option(help="Antialiasing of the floor's checker.")] = "analytic",
    layers: Annotated[
        str,
        typer.Option(
            metavar="NAME,...",
            help=f"Layers to write as pictures too: {', '.join(LAYERS)}.",
            autocompletion=one_of(LAYERS),
        ),
    ] = "",
    counts: Annotated[
        bool, typer.Option(help="Count chambers and crossings; without, loose tolerances are met sooner.")
    ] = True,
    silhouettes: SilhouettesOption = 1,
    filter: FilterOption = "centre",
    filter_radius: FilterRadius = 0.0,
    method: MethodOption = "auto",
    threads: Threads = 0,
    tile: Tile = 0,
    cluster: Cluster = "",
    insecure_cluster: InsecureCluster = False,
    resume: Resume = False,
    restart: Restart = False,
    verify: Annotated[
        float, typer.Option(metavar="SHARE", help="Share of the pixels that brute force makes again, drawn at random.")
    ] = 0.0,
    max_pixels: Annotated[int, typer.Option(help="Most pixels accepted.")] = MAX_PIXELS,
    define: Define = None,
    out: Annotated[str, typer.Option("--out", "-o", help="Folder the files are written to; made if missing.")] = "out",
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
    """Render SCENE so that every pixel is within its stated error.

    Exit 4 if some pixel missed the tolerance or is contradicted by --verify.

    Writes truth.png, truth.exr (float32) and truth.npz (float64), with error, status, evaluations, chambers and
    crossings as layers beside the radiance. The image is written even if pixels missed their tolerance.

    Example: symrender truth chapter8 --size 128 --tol 1e-8 --layers error,crossings --out pictures
    """
    from symrender.scene.load import in_series

    wanted = _wanted(layers, counts=counts)
    check_share(verify)
    settings = split_settings(
        parse_size(size), tol=tol, disk=disk, aa=aa, budget=budget, threads=threads, tile=tile, counts=counts,
        silhouettes=silhouettes, filter=filter, filter_radius=filter_radius, method=method, max_pixels=max_pixels,
    )  # fmt: skip
    chosen = any_scene_with(scene, define)
    _refuse_radiometric(chosen, wanted, verify)
    if not quiet:
        from symrender.scene.warnings import warnings

        for warning in warnings(chosen):
            typer.echo(f"WARNING {warning}", err=True)
    from symrender.truth import truth_job

    job = truth_job(chosen, settings)
    folder = make_folder(out)
    journal = folder / "truth.journal"
    force = force or (resume and journal.exists())
    names = ["truth.png", "truth.exr", "truth.npz", *(f"truth_{name}.png" for name in wanted)]
    for name in names:
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

    from symrender.execution.fill import Crew
    from symrender.execution.first_use import first_use
    from symrender.images.image import Image
    from symrender.images.views import false_color
    from symrender.truth import true_image, verdict
    from symrender.verify import verify as brute_force

    with (
        ended_by_signals(),
        progress(progress_mode, quiet=quiet) as advance,
        Crew(means, (job,), advance, preview=shown_in(preview)) as crew,
    ):
        image = true_image(crew, job, chosen)
        with first_use("verify", advance):
            receipt = brute_force(image.layers, in_series(chosen), settings, verify, threads) if verify else None
        if receipt is not None:
            image = Image(image.layers, {**image.meta, "verified": receipt.json()})
        for name in names[:3]:
            image.save(folder / name, force=force, exposure=exposure, tonemap=tonemap)
        for name in wanted:
            false_color(image, name).save(folder / f"truth_{name}.png", force=force)
        crew.succeeded()
    judged = verdict(image)
    if json:
        report = {
            "files": names,
            "pixels": judged.pixels,
            "missed": dict(judged.missed),
            "largest_error": judged.largest,
            "at": judged.worst,
            "convention": image.meta["convention"],
        } | ({} if receipt is None else {"verified": asdict(receipt)})
        show_json(report)
    elif not quiet:
        known = "conventions" in image.meta
        units = image.meta["units"] if known else f"units of lobes: {image.meta['convention']}"
        typer.echo(f"{judged.text()}; {units}")
        if receipt is not None:
            typer.echo(receipt.text())
        for name in names:
            typer.echo(f"wrote {folder / name}")
    if not judged.met or (receipt is not None and receipt.contradicted):
        raise typer.Exit(4)


def _wanted(layers: str, *, counts: bool) -> list[str]:
    """The layers that are to be written as pictures too."""
    from symrender.errors import OptionError

    wanted = [name for name in layers.split(",") if name]
    if unknown := sorted(set(wanted) - set(LAYERS)):
        raise OptionError(
            f"layers: must be of {', '.join(LAYERS)}, got {unknown[0]!r}{did_you_mean(unknown[0], LAYERS)}"
        )
    if uncounted := sorted({"chambers", "crossings"}.intersection(() if counts else wanted)):
        raise OptionError(f"layers: {uncounted[0]} cannot be written without counts")
    return wanted


def _refuse_radiometric(scene: AnyScene, wanted: list[str], verify: float) -> None:
    """Refuse what only scenes in units of the series have."""
    from symrender.errors import OptionError
    from symrender.scene.load import in_series
    from symrender.scene.radiometric.scene import RadiometricScene

    if not isinstance(scene, RadiometricScene):
        return
    if verify:
        in_series(scene, "verify")
    if unknown := sorted(set(wanted) - set(RADIOMETRIC_LAYERS)):
        raise OptionError(f"layers: {unknown[0]} is not a layer of a radiometric scene")
