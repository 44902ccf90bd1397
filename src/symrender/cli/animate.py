"""``symrender animate``: frames of a changing scene, and a video of them."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import typer

from symrender.cli._completions import DEFAULT_SCENE, ranges
from symrender.cli._console import show_json
from symrender.cli._means import Cluster, InsecureCluster, Restart, Resume, Threads, Tile, ended_by_signals, means_of
from symrender.cli._options import Define, Force, Json, Quiet, SceneArgument, parse_size, scene_files, scene_with
from symrender.cli._progress import ProgressMode, progress
from symrender.errors import OptionError
from symrender.settings import Antialias, Settings, image_size

Side = Literal["symbolic", "numeric"]
Video = Literal["mp4", "webm", "none"]


def animate(
    scene: SceneArgument = DEFAULT_SCENE,
    over: Annotated[
        str,
        typer.Option(
            metavar="NAME=A:B:N[:log],...",
            help="A range of scene values, one frame each; or --orbit.",
            autocompletion=ranges,
        ),
    ] = "",
    orbit: Annotated[int, typer.Option(help="N frames of one turn of the camera about its target.")] = 0,
    pipeline: Annotated[Side, typer.Option(help="Which of the two renderers draws the frames.")] = "symbolic",
    size: Annotated[str, typer.Option(help="Pixels: N for a square, or WxH.")] = "320x240",
    lobe: Annotated[int, typer.Option(help="K of the K rings x K sectors (K x K samples) of a lobe.")] = 8,
    disk: Annotated[str, typer.Option(help="Disk lights: KxK centroids.")] = "2x2",
    aa: Annotated[Antialias, typer.Option(help="Antialiasing of the floor's checker.")] = "analytic",
    seed: Annotated[int, typer.Option(help="Seed of the numeric sampler.")] = 7,
    video: Annotated[Video, typer.Option(help="Also a video (extra 'video'); none: PNG files only.")] = "mp4",
    rate: Annotated[float, typer.Option(help="Frames a second of the video.")] = 24.0,
    threads: Threads = 0,
    tile: Tile = 0,
    cluster: Cluster = "",
    insecure_cluster: InsecureCluster = False,
    resume: Resume = False,
    restart: Restart = False,
    define: Define = None,
    out: Annotated[
        str, typer.Option("--out", "-o", help="Folder the files are written to; made if missing.")
    ] = "animation",
    force: Force = False,
    json: Json = False,
    quiet: Quiet = False,
    progress_mode: Annotated[
        ProgressMode, typer.Option("--progress", help="auto: a bar on a terminal; json: lines on stderr.")
    ] = "auto",
) -> None:
    """Draw SCENE as a value changes (--over) or as the camera goes round (--orbit): PNG frames, and mp4 or webm.

    Resumable: --resume continues after any interruption, frame by frame and tile by tile.

    Example: symrender animate gloss --orbit 48 --size 320x240 --out turn
    """
    from symrender.sequences.animate import JOURNAL
    from symrender.sequences.animate import animate as make
    from symrender.sequences.makers import Rendered
    from symrender.sequences.orbit import orbit as around
    from symrender.sequences.over import frames, parse_over

    if bool(over) == bool(orbit):
        raise OptionError("over, orbit: give exactly one of them")
    width, height = image_size(parse_size(size))
    settings = Settings(
        width=width,
        height=height,
        lobe=lobe,
        numeric="jittered" if pipeline == "numeric" else "none",
        symbolic="strata" if pipeline == "symbolic" else "none",
        disk=disk,
        aa=aa,
        seed=seed,
    )
    means = means_of(
        threads=threads,
        tile=tile,
        resume=resume,
        restart=restart,
        cluster=cluster,
        insecure_cluster=insecure_cluster,
        journal=Path(out) / JOURNAL,
    )
    chosen = scene_with(scene, define, "animate")
    drawn = around(chosen, orbit) if orbit else frames(chosen, parse_over(over))
    with ended_by_signals(), progress(progress_mode, quiet=quiet) as advance:
        rows = make(
            drawn,
            Rendered(settings),
            out,
            video=video,
            rate=rate,
            means=means,
            force=force,
            inputs=scene_files(scene),
            progress=advance,
        )
    if json:
        show_json(rows)
    elif not quiet:
        typer.echo(f"wrote {len(rows)} frames{'' if video == 'none' else f' and a video ({video})'} in {out}")
