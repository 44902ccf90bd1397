"""``symrender sweep``: an image for every combination of scene values."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Annotated, Final, Literal

import typer

from symrender.cli._completions import DEFAULT_SCENE, numbers, ranges
from symrender.cli._console import show_json
from symrender.cli._means import Cluster, InsecureCluster, Restart, Resume, Threads, Tile, ended_by_signals, means_of
from symrender.cli._options import Define, Force, Json, Quiet, SceneArgument, parse_size, scene_files, scene_with
from symrender.cli._progress import ProgressMode, progress
from symrender.errors import OptionError
from symrender.settings import Antialias, Sampler, Settings, image_size

What = Literal["render", "truth", "gradient"]
_TOLERANCE: Final = {"truth": 1e-6, "gradient": 1e-4}


def sweep(
    scene: SceneArgument = DEFAULT_SCENE,
    over: Annotated[
        str,
        typer.Option(
            metavar="NAME=A:B:N[:log],...",
            help="Ranges of scene values, N numbers from A to B each; every combination is a frame.",
            autocompletion=ranges,
        ),
    ] = "",
    what: Annotated[
        What, typer.Option(help="What a frame is: both renders with their ledger, a truth, or the gradients by --wrt.")
    ] = "render",
    wrt: Annotated[
        str,
        typer.Option(
            metavar="NAME,...", help="Real numbers a gradient is taken by, or vectors.", autocompletion=numbers
        ),
    ] = "",
    size: Annotated[str, typer.Option(help="Pixels: N for a square, or WxH.")] = "128",
    lobe: Annotated[int, typer.Option(help="K of the K rings x K sectors (K x K samples) of a lobe.")] = 4,
    numeric: Annotated[Sampler, typer.Option(help="Sampler of the numeric pipeline.")] = "jittered",
    symbolic: Annotated[Literal["strata", "none"], typer.Option(help="Rule of the symbolic pipeline.")] = "strata",
    disk: Annotated[str, typer.Option(help="Disk lights: KxK centroids, or exact.")] = "2x2",
    aa: Annotated[Antialias, typer.Option(help="Antialiasing of the floor's checker.")] = "analytic",
    seed: Annotated[int, typer.Option(help="Seed of the samplers.")] = 7,
    tol: Annotated[
        float | None,
        typer.Option(
            help="Absolute error asked of every pixel: 1e-6 for a truth, 1e-4 for gradients.", show_default=False
        ),
    ] = None,
    store: Annotated[
        Literal["exr", "zarr"],
        typer.Option(help="exr: a file an image, in 32 bits; zarr: all frames in frames.zarr (Zarr 3), in 64 bits."),
    ] = "exr",
    threads: Threads = 0,
    tile: Tile = 0,
    cluster: Cluster = "",
    insecure_cluster: InsecureCluster = False,
    resume: Resume = False,
    restart: Restart = False,
    define: Define = None,
    out: Annotated[
        str, typer.Option("--out", "-o", help="Folder the files are written to; made if missing.")
    ] = "sweep",
    force: Force = False,
    json: Json = False,
    quiet: Quiet = False,
    progress_mode: Annotated[
        ProgressMode, typer.Option("--progress", help="auto: a bar on a terminal; json: lines on stderr.")
    ] = "auto",
) -> None:
    """Make an image of SCENE for every combination of --over; write frames, ledgers.csv, contact_sheet.png.

    Exit 4 if some pixel of a truth or a gradient missed its tolerance.

    For gradients there is a contact sheet a parameter, contact_sheet_gradient_NAME.png: blue falls, red rises.

    Resumable: --resume continues after any interruption, frame by frame and tile by tile.

    Example: symrender sweep gloss --over floor.lobe.exponent=4:1024:5:log,lights.key.radius=0:1:3 --size 128 --out s
    """
    from symrender.sequences.makers import Certain, Maker, Rendered, Sloped
    from symrender.sequences.over import parse_over
    from symrender.sequences.sweep import JOURNAL
    from symrender.sequences.sweep import sweep as make

    width, height = image_size(parse_size(size))
    names = tuple(name.strip() for name in wrt.split(",") if name.strip())
    if bool(names) != (what == "gradient"):
        raise OptionError("wrt: names the real numbers of --what gradient, such as --wrt spheres.B.center.x")
    asked = _TOLERANCE.get(what, 1e-6) if tol is None else tol
    settings = Settings(width=width, height=height, lobe=lobe, disk=disk, aa=aa, seed=seed, tol=asked)
    split = replace(settings, numeric="none", symbolic="chambers")
    maker: Maker
    if what == "render":
        maker = Rendered(replace(settings, numeric=numeric, symbolic=symbolic))
    else:
        maker = Certain(split) if what == "truth" else Sloped(split, names)
    axes = parse_over(over)
    means = means_of(
        threads=threads,
        tile=tile,
        resume=resume,
        restart=restart,
        cluster=cluster,
        insecure_cluster=insecure_cluster,
        journal=Path(out) / JOURNAL,
    )
    chosen = scene_with(scene, define, "sweep")
    with ended_by_signals(), progress(progress_mode, quiet=quiet) as advance:
        rows = make(
            chosen,
            axes,
            maker,
            out,
            store=store,
            means=means,
            force=force,
            inputs=scene_files(scene),
            progress=advance,
        )
    missed = sum(value for row in rows for name, value in row.items() if "missed_" in name)
    if json:
        show_json(rows)
    elif not quiet:
        sheets = "the contact sheets" if what == "gradient" else "contact_sheet.png"
        told = f"; {missed} pixels missed their tolerance" if missed else ""
        typer.echo(f"wrote {len(rows)} frames, ledgers.csv and {sheets} in {out}{told}")
    if missed:
        raise typer.Exit(4)
