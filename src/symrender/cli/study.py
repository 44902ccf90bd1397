"""``symrender study``: measure estimators on a scene, and print the tables."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Final, Literal

import typer

from symrender.cli._options import Define, Force, Json, Quiet, SceneArgument, parse_size, scene_files, scene_with
from symrender.cli._progress import ProgressMode, progress
from symrender.errors import OptionError, remedy
from symrender.images.output import check_target, make_folder, write_bytes
from symrender.settings import Nodes, Partition, Weights

if TYPE_CHECKING:
    from symrender.studies.report import Study

Kind = Literal["convergence", "weights", "budget", "timing", "anchor", "pitfalls"]

_TABLES: Final = {"convergence": 2, "weights": 2, "budget": 1, "timing": 2, "anchor": 1, "pitfalls": 6}
_TAKES: Final = {
    "convergence": ("size", "surface", "estimators", "lobes", "tolerances", "repeats", "disk", "seed"),
    "weights": ("size", "surface", "lobes", "partition", "disk"),
    "budget": ("size", "surface", "lobes", "weights", "nodes", "partition", "normalised", "disk", "seed"),
    "timing": ("size", "surface", "lobes", "repeats", "disk", "seed"),
    "anchor": ("size", "disk", "seed"),
    "pitfalls": ("size", "lobes", "disk", "seed"),
}


def study(
    kind: Annotated[Kind, typer.Argument(help="What to measure.")],
    scene: SceneArgument = "",
    size: Annotated[str | None, typer.Option(help="Pixels: N for a square, or WxH.")] = None,
    surface: Annotated[
        Literal["floor", "all"] | None, typer.Option(help="Lobes judged: the floor's, or those of all shapes.")
    ] = None,
    estimators: Annotated[
        str | None, typer.Option(help="Names separated by commas; an unknown one lists them (convergence).")
    ] = None,
    lobes: Annotated[str | None, typer.Option(help="K of the K x K directions, separated by commas.")] = None,
    tolerances: Annotated[
        str | None, typer.Option(help="Of the split rule, relative to the signal, separated by commas (convergence).")
    ] = None,
    repeats: Annotated[int | None, typer.Option(help="Interleaved timings of each point.")] = None,
    weights: Annotated[Weights | None, typer.Option(help="Weights of the strata (budget).")] = None,
    nodes: Annotated[Nodes | None, typer.Option(help="Nodes of the strata (budget).")] = None,
    partition: Annotated[Partition | None, typer.Option(help="Rings of the strata (weights, budget).")] = None,
    normalised: Annotated[
        bool | None, typer.Option("--normalised", help="Divide by the closed-form normaliser (budget).")
    ] = None,
    disk: Annotated[str | None, typer.Option(help="Disk lights: KxK centroids.")] = None,
    seed: Annotated[int | None, typer.Option(help="Seed of the samplers, and of pixels drawn.")] = None,
    define: Define = None,
    out: Annotated[
        str | None, typer.Option("--out", "-o", help="Folder for the tables as .csv and .json; made if missing.")
    ] = None,
    plot: Annotated[
        bool, typer.Option(help="With --out, also draw .svg and .png (convergence; extra 'notebook').")
    ] = True,
    force: Force = False,
    json: Json = False,
    quiet: Quiet = False,
    progress_mode: Annotated[
        ProgressMode, typer.Option("--progress", help="auto: a bar on a terminal; json: lines on stderr.")
    ] = "auto",
) -> None:
    """Measure estimators on SCENE (default gloss; grazing for pitfalls) and print the tables.

    convergence: error against evaluations and time, with fitted orders. weights: exact against midpoint, with walls
    and without. budget: the error of strata split by the wall that causes it. timing: seconds against K. anchor: the
    way to the mirror. pitfalls: horizon, crossings, starvation, bias, clipping.

    Example: symrender study convergence gloss --size 64 --estimators strata-angle,sobol,split --out study
    """
    given = {
        "size": None if size is None else parse_size(size),
        "surface": surface,
        "estimators": None if estimators is None else [name.strip() for name in estimators.split(",")],
        "lobes": _numbers("lobes", lobes, int),
        "tolerances": _numbers("tolerances", tolerances, float),
        "repeats": repeats,
        "weights": weights,
        "nodes": nodes,
        "partition": partition,
        "normalised": normalised,
        "disk": disk,
        "seed": seed,
    }
    options = {name: value for name, value in given.items() if value is not None}
    for name in options:
        if name not in _TAKES[kind]:
            raise OptionError(f"{name}: study {kind} does not take it, it takes {', '.join(_TAKES[kind])}")
    source = scene or ("grazing" if kind == "pitfalls" else "gloss")
    drawn = kind == "convergence" and plot and out is not None
    folder = None if out is None else _folder(out, kind, source, drawn=drawn, force=force)
    chosen = scene_with(source, define, "study")
    with progress(progress_mode, quiet=quiet) as advance:
        found, pictures = _measure(kind, chosen, options, advance, drawn=drawn)
    told = {} if folder is None else _write(found, pictures, folder, force=force)
    if json:
        typer.echo(found.to_json())
    elif not quiet:
        typer.echo(found.text())
        for file in told:
            typer.echo(f"wrote {file}")


def _numbers(name: str, text: str | None, read: Callable[[str], Any]) -> list[Any] | None:
    if text is None:
        return None
    try:
        return [read(part) for part in text.split(",")]
    except ValueError:
        raise OptionError(f"{name}: must be numbers separated by commas, got {text[:60]!r}") from None


def _folder(out: str, kind: Kind, source: str, *, drawn: bool, force: bool) -> Path:
    if drawn:
        import importlib.util

        if importlib.util.find_spec("matplotlib") is None:
            raise OptionError(f"plot: Matplotlib is not installed: {remedy('notebook')}, or --no-plot for tables alone")
    folder = make_folder(out)
    names = [_table_name(kind, k) for k in range(_TABLES[kind])] + [f"{kind}.json"]
    names += [f"{kind}.svg", f"{kind}.png"] if drawn else []
    for name in names:
        check_target(folder / name, force=force, inputs=scene_files(source))
    return folder


def _table_name(kind: str, k: int) -> str:
    return f"{kind}-{k + 1}.csv" if k else f"{kind}.csv"


def _measure(
    kind: Kind, scene: Any, options: dict[str, Any], advance: Any, *, drawn: bool
) -> tuple[Study, dict[str, bytes]]:
    import importlib

    function = getattr(importlib.import_module(f"symrender.studies.{kind}"), kind)
    if kind == "budget" and "lobes" in options:
        several = options.pop("lobes")
        if len(several) != 1:
            raise OptionError(f"lobes: study budget takes one K, got {several!r}")
        options["lobe"] = several[0]
    if kind != "convergence":
        return function(scene, **options), {}
    found = function(scene, progress=advance, **options)
    if not drawn:
        return found.study, {}
    from symrender.studies.plot import drawn as draw

    return found.study, {"convergence.svg": draw(found, "svg"), "convergence.png": draw(found, "png")}


def _write(found: Study, pictures: dict[str, bytes], folder: Path, *, force: bool) -> list[Path]:
    files = {_table_name(found.name, k): table.csv().encode() for k, table in enumerate(found.tables)}
    files |= {f"{found.name}.json": found.to_json().encode()} | pictures
    for name, data in files.items():
        write_bytes(folder / name, data, force=force)
    return [folder / name for name in files]
