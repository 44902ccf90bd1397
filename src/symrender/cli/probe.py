"""``symrender probe``: single values of the lobe integral."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated, Any

import typer

from symrender.cli._completions import numbers, surfaces
from symrender.cli._console import show_json
from symrender.cli._means import Threads
from symrender.cli._options import Define, Json, SceneArgument, any_scene_with

if TYPE_CHECKING:
    from symrender.probe import Probe
    from symrender.probe_rays import RayProbe
    from symrender.scene.load import AnyScene
    from symrender.scene.scene import Scene

_TOUCHES = 1e-12
"""Distance from a sphere, in its radii, that rounding leaves of none."""


def probe(
    scene: SceneArgument,
    point: Annotated[
        list[str] | None,
        typer.Option(
            "--point",
            "-p",
            metavar="X,Y[,Z]",
            help="X,Y on the floor or of a plane's texture; the unit normal X,Y,Z on a sphere.",
        ),
    ] = None,
    ray: Annotated[
        list[str] | None,
        typer.Option("--ray", metavar="X,Y,Z,DX,DY,DZ", help="Origin and direction, in a radiometric scene."),
    ] = None,
    surface: Annotated[
        str,
        typer.Option(help="Surface the points are on: floor, spheres.NAME or planes.NAME.", autocompletion=surfaces),
    ] = "floor",
    tol: Annotated[float, typer.Option(help="Absolute error asked for, scene radiance.")] = 1e-9,
    budget: Annotated[int, typer.Option(help="Most evaluations a point may take.")] = 1_000_000,
    disk: Annotated[str, typer.Option(help="Disk lights: KxK centroids, or exact.")] = "2x2",
    wrt: Annotated[
        str,
        typer.Option(
            "--wrt", metavar="NAME,...", help="Differentiate by these numbers or vectors too.", autocompletion=numbers
        ),
    ] = "",
    certify: Annotated[
        bool, typer.Option("--certify", help="Enclose each value by ball arithmetic (needs symrender[certify]).")
    ] = False,
    threads: Threads = 0,
    define: Define = None,
    json: Json = False,
) -> None:
    """Print the lobe integral at points of a surface, each with its error; exit 4 if one missed its tolerance.

    Of a radiometric scene it prints the radiance along rays instead.

    Example: symrender probe chapter8 -p 1.2,-0.4 -p 0.5,-1.1 --tol 1e-10
    """
    from symrender.errors import OptionError
    from symrender.scene.printable import printable
    from symrender.scene.radiometric.scene import RadiometricScene

    if bool(point) == bool(ray):
        raise OptionError("point, ray: give points of a surface, or rays through a radiometric scene")
    if ray:
        names = _names(wrt)
        _probe_rays(any_scene_with(scene, define), ray, json=json, tol=tol, budget=budget, wrt=names, certify=certify,
                    threads=threads)  # fmt: skip
        return
    points = _points(point or [])
    chosen = any_scene_with(scene, define)
    if isinstance(chosen, RadiometricScene):
        raise OptionError(
            f"point: {printable(chosen.name)} is a radiometric scene, which is probed along rays: "
            "--ray X,Y,Z,DX,DY,DZ, an origin and a direction"
        )

    from symrender.cli._progress import progress
    from symrender.execution.first_use import first_use
    from symrender.probe import probe as probe_points
    from symrender.truth import STATUS

    names = _names(wrt)
    with progress("auto", quiet=json) as advance, first_use("probe", advance):
        found = probe_points(
            chosen,
            points,
            surface=surface,
            tol=tol,
            disk=disk,
            budget=budget,
            wrt=names,
            certify=certify,
            threads=threads,
        )
    rows = [
        {
            "point": p,
            "gloss": gloss.tolist(),
            "error": float(error),
            "evaluations": int(evaluations),
            "status": STATUS[int(status)],
            "chambers": int(chambers),
            "crossings": int(crossings),
            "convention": found.convention,
        }
        for p, gloss, error, evaluations, status, chambers, crossings in zip(
            points, found.gloss, found.error, found.evaluations, found.status, found.chambers, found.crossings,
            strict=True,
        )
    ]  # fmt: skip
    for row, proved, value in zip(rows, found.enclosures, found.gloss, strict=False):
        row |= {"low": proved.low.tolist(), "high": proved.high.tolist(), "enclosed": proved.holds(value)}
    slopes = _slopes(found, len(points))
    if json:
        show_json([row | {"gradient": slope} if names else row for row, slope in zip(rows, slopes, strict=True)])
    else:
        for text, row, slope in zip(point or (), rows, slopes, strict=True):
            gloss = " ".join(f"{x:.15g}" for x in row["gloss"])
            typer.echo(
                f"{text}: {gloss} +- {row['error']:.2g}  {row['status']}, {row['evaluations']} "
                f"evaluations, {row['chambers']} chambers, {row['crossings']} crossings, {found.convention}"
            )
            if row["status"] == "unsupported":
                typer.echo(f"  no value: {_why(chosen, surface, row['point'])}")
            if certify:
                bounds = " ".join(f"[{a:.6g}, {b:.6g}]" for a, b in zip(row["low"], row["high"], strict=True))
                typer.echo(f"  proved: {bounds}; the value is {'inside' if row['enclosed'] else 'OUTSIDE'}")
            _show_slopes(slope)
    if (found.status != 0).any() or not all(row.get("enclosed", True) for row in rows):
        raise typer.Exit(4)


def _slopes(found: Probe | RayProbe, count: int) -> list[dict[str, dict[str, Any]]]:
    """Of every point or ray, what is told of its derivatives by name."""
    from symrender.gradient import STATUS

    return [
        {
            name: {
                "value": found.gradient[name][k].tolist(),
                "error": float(found.gradient_error[name][k]),
                "status": STATUS[int(found.gradient_status[name][k])],
            }
            for name in found.gradient
        }
        for k in range(count)
    ]


def _show_slopes(slopes: dict[str, dict[str, Any]]) -> None:
    """Print them, a line each."""
    for name, found in slopes.items():
        value = " ".join(f"{x:.15g}" for x in found["value"])
        typer.echo(f"  d/d {name}: {value} +- {found['error']:.2g}  {found['status']}")


def _names(wrt: str) -> list[str]:
    return [name.strip() for name in wrt.split(",") if name.strip()]


def _points(point: list[str]) -> list[list[float]]:
    from symrender.errors import OptionError

    points = []
    for text in point:
        try:
            points.append([float(x) for x in text.split(",")])
        except ValueError:
            raise OptionError(f"point: must be numbers X,Y or X,Y,Z, got {text!r}") from None
    if len({len(p) for p in points}) != 1:
        raise OptionError("point: all points need the same number of coordinates")
    return points


def _probe_rays(scene: AnyScene, ray: list[str], *, json: bool, **options: Any) -> None:
    from symrender.cli._progress import progress
    from symrender.errors import OptionError
    from symrender.execution.first_use import first_use
    from symrender.probe import probe as probe_scene
    from symrender.truth import STATUS

    numbers = []
    for text in ray:
        try:
            numbers.append([float(x) for x in text.split(",")])
        except ValueError:
            numbers.append([])
        if len(numbers[-1]) != 6:
            raise OptionError(f"ray: must be six numbers X,Y,Z,DX,DY,DZ, got {text!r}")
    given = ([n[:3] for n in numbers], [n[3:] for n in numbers])
    with progress("auto", quiet=json) as advance, first_use("probe", advance):
        found = probe_scene(scene, rays=given, **options)
    three = {name: getattr(found, name).tolist() for name in ("radiance", "emitted", "direct", "indirect")}
    rows = [
        {"ray": n, "shape": found.shape[k]}
        | {name: values[k] for name, values in three.items()}
        | {"error": float(found.error[k]), "status": STATUS[int(found.status[k])], "convention": found.convention}
        for k, n in enumerate(numbers)
    ]
    slopes = _slopes(found, len(rows))
    if json:
        show_json([row | {"gradient": slope} if slope else row for row, slope in zip(rows, slopes, strict=True)])
    else:
        for text, row, radiance, slope in zip(ray, rows, found.radiance, slopes, strict=True):
            value = " ".join(f"{x:.15g}" for x in radiance)
            typer.echo(f"{text}: {value} +- {row['error']:.2g} W/(m2 sr)  {row['status']}, {row['shape']}")
            _show_slopes(slope)
    if found.status.any():
        raise typer.Exit(4)


def _why(scene: Scene, surface: str, point: Sequence[float]) -> str:
    """Which sphere holds or touches a point that has no value."""
    place = tuple([*point, 0.0][:3])
    own = next((sphere for sphere in scene.spheres if f"spheres.{sphere.name}" == surface), None)
    if own is not None:
        place = tuple(c + own.radius * n for c, n in zip(own.center, place, strict=True))
    others = [(s, math.dist(place, s.center) - s.radius) for s in scene.spheres if s is not own]
    touching = [s.name for s, apart in others if abs(apart) <= _TOUCHES * s.radius]
    holding = [s.name for s, apart in others if apart < 0 and s.name not in touching]
    at = ", ".join(f"{x:.6g}" for x in place)
    if touching and not holding:
        named = " and ".join(f"spheres.{name}" for name in touching)
        return f"({at}) touches {named}: no rule covers a point in which two shapes meet"
    if not holding:
        return "no rule covers this point"
    return f"({at}) is inside {' and '.join(f'spheres.{name}' for name in holding)}, and nothing is seen from there"
