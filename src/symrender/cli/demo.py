"""``symrender demo``: the first thing to run: two pictures, the truth, and a report that shows them."""

from __future__ import annotations

import shlex
import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from symrender.cli._browser import open_page
from symrender.cli._completions import DEFAULT_SCENE
from symrender.cli._console import Patient
from symrender.cli._means import PreviewOption, SilhouettesOption, Threads, ended_by_signals, shown_in
from symrender.cli._options import Define, Force, Json, Quiet, SceneArgument, parse_size, scene_files, scene_with
from symrender.cli._progress import ProgressMode, progress
from symrender.images.output import check_target, make_folder
from symrender.settings import Estimators

if TYPE_CHECKING:
    from symrender.images.image import Image
    from symrender.scene.scene import Scene

FILES = (
    *(f"{name}.{ending}" for name in ("numeric", "symbolic", "truth") for ending in ("png", "exr")),
    *("pictures.png", "simulator.html", "report.html"),
)
"""What a demo writes."""


def demo(
    scene: SceneArgument = DEFAULT_SCENE,
    size: Annotated[str, typer.Option(help="Pixels: N for a square, or WxH; less if the truth does not fit.")] = "256",
    seconds: Annotated[float, typer.Option(help="Seconds the truth may take.")] = 20.0,
    tol: Annotated[float, typer.Option(help="Error asked of every pixel of the truth, scene radiance.")] = 1e-3,
    lobe: Annotated[int, typer.Option(help="K of the K x K directions of a lobe.")] = 4,
    estimators: Annotated[
        Estimators, typer.Option(help="best: follow the lobe; chapter: the source chapter's, which starve.")
    ] = "best",
    silhouettes: SilhouettesOption = 3,
    disk: Annotated[str, typer.Option(help="Disk lights: KxK centroids.")] = "2x2",
    seed: Annotated[int, typer.Option(help="Seed of the sampler.")] = 7,
    threads: Threads = 0,
    define: Define = None,
    out: Annotated[str, typer.Option("--out", "-o", help="Folder the files are written to; made if missing.")] = "out",
    open_: Annotated[bool, typer.Option("--open", help="Open the report in the browser.")] = False,
    preview: PreviewOption = "",
    force: Force = False,
    json: Json = False,
    quiet: Quiet = False,
    progress_mode: Annotated[
        ProgressMode, typer.Option("--progress", help="auto: a bar on a terminal; json: lines on stderr.")
    ] = "auto",
) -> None:
    """Draw SCENE by sampling and by rule, and the truth beside them, in one offline report.

    Writes numeric, symbolic and truth as .png and .exr, each as soon as it stands, then pictures.png (all side by
    side), simulator.html and report.html, which opens in any browser and loads nothing. The truth is drawn at the
    size that fits into --seconds; the report says which.

    Example: symrender demo gloss --out out --open
    """
    begun = time.perf_counter()
    chosen = scene_with(scene, define, "demo")
    folder = make_folder(out)
    for name in FILES:
        check_target(folder / name, force=force, inputs=scene_files(scene))

    from symrender.report.build import demo_settings, page_of
    from symrender.report.demo import demo as make
    from symrender.report.strip import strip

    told = Patient()

    def say(text: str) -> None:
        if not quiet and not json:
            told(f"{time.perf_counter() - begun:6.1f} s  {text}")

    def finished(name: str, image: Image) -> None:
        image.save(folder / f"{name}.png", force=True)
        image.save(folder / f"{name}.exr", force=True)
        say(f"{name}, {image.width} x {image.height}: {folder / name}.png, .exr")

    settings = demo_settings(parse_size(size), lobe, estimators, silhouettes, disk, seed, threads)
    with ended_by_signals(), progress(progress_mode, quiet=quiet) as advance:
        made = make(
            chosen, settings, tol=tol, seconds=seconds, progress=advance, preview=shown_in(preview), finished=finished
        )
        strip(made).save(folder / "pictures.png", force=True)
        simulator = _simulator(chosen, folder / "simulator.html")
        command = shlex.join(["symrender", "demo", scene, *_told(size, seconds, tol, lobe, estimators, define)])
        page = page_of(made, simulator=simulator, command=command)
        page.save(folder / "report.html", force=True)
    told.end()
    if json:
        import json as json_module

        report = {
            "report": str(folder / "report.html"),
            "size": [made.settings.width, made.settings.height],
            "judgement": made.judgement.as_json(),
            "notes": list(made.pair.ledger.notes),
        }
        typer.echo(json_module.dumps(report, indent=2, allow_nan=False))
    elif not quiet:
        for judged in made.judgement.judged:
            whole = judged.comparisons["radiance"].whole
            off, unsure = (100 * x / whole.signal for x in (whole.rmse, made.judgement.doubt))
            say(f"{judged.pipeline.name}: {off:.3g} +- {unsure:.1g} % from the truth ({judged.pipeline.estimator})")
        for note in made.pair.ledger.notes:
            say(f"note: {note}")
        if made.smaller:
            say(f"drawn at {made.settings.width} x {made.settings.height}: the truth fits {seconds:g} s there")
        say(f"report: {(folder / 'report.html').resolve()}")
    if open_:
        open_page(folder / "report.html")


def _simulator(scene: Scene, path: Path) -> str:
    """Write the scene's simulator and return its address beside the report; "" where none can be drawn."""
    from symrender.errors import Unsupported
    from symrender.simulator.build import simulator

    try:
        simulator(scene).save(path, force=True)
    except Unsupported:
        return ""
    return path.name


def _told(size: str, seconds: float, tol: float, lobe: int, estimators: str, define: list[str] | None) -> list[str]:
    """The options that were given, as they are typed."""
    given = {"--size": (size, "256"), "--seconds": (f"{seconds:g}", "20"), "--tol": (f"{tol:g}", "0.001")}
    given |= {"--lobe": (str(lobe), "4"), "--estimators": (estimators, "best")}
    options = [word for name, (value, usual) in given.items() if value != usual for word in (name, value)]
    return [*options, *(word for change in define or () for word in ("-D", change))]
