"""``symrender audit``: judge a render against the truth of its scene."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from symrender.cli._completions import scene_names
from symrender.cli._means import Threads
from symrender.cli._options import Define, Force, Quiet, any_scene_with, scene_files
from symrender.settings import Filter


def audit(
    renders: Annotated[list[Path], typer.Argument(help="One render with moments or variances, or 8 or more seeds.")],
    scene: Annotated[
        str, typer.Option("--scene", "-s", help="What was rendered: name or file.", autocompletion=scene_names)
    ],
    truth: Annotated[Path | None, typer.Option(help="The truth as a file of ours; else it is rendered.")] = None,
    samples: Annotated[int, typer.Option(help="Samples a pixel; needed where one render is given.")] = 0,
    noise_free: Annotated[bool, typer.Option("--noise-free", help="The one render given has no noise.")] = False,
    seeds: Annotated[bool, typer.Option("--seeds", help="The renders are seeds; refuse any other reading.")] = False,
    sequential: Annotated[
        bool, typer.Option("--sequential", help="Look after 8, 16, 32 ... seeds; stop at the first decision.")
    ] = False,
    visible: Annotated[
        float, typer.Option(help="Sequential: relative bias that is small enough to stop and pass.")
    ] = 0.0,
    level: Annotated[float, typer.Option(help="Chance that a right render fails, all tests together.")] = 0.01,
    wrt: Annotated[
        list[str] | None, typer.Option(help="Parameter that may explain a failure; repeatable, else many are tried.")
    ] = None,
    explain: Annotated[bool, typer.Option(help="Seek what would explain a failure.")] = True,
    explain_seconds: Annotated[
        float, typer.Option("--explain-seconds", help="Time for explanations that need further references.")
    ] = 10.0,
    derivative: Annotated[
        str, typer.Option(metavar="NAME", help="The renders are derivatives in this number of the scene.")
    ] = "",
    filter: Annotated[
        Filter | None, typer.Option(help="What a pixel of the renders is; else what their receipts say, or centre.")
    ] = None,
    allow: Annotated[
        str | None,
        typer.Option(metavar="REL[,ABS]", help="Margin: differences of this part of the radiance do not count."),
    ] = None,
    ray_offset: Annotated[
        str | None,
        typer.Option(metavar="A[,B]", help="The renderer's secondary rays start A + B max |p| off the place p."),
    ] = None,
    tol: Annotated[float, typer.Option(help="Tolerance of the truth; 0: far under the noise.")] = 0.0,
    threads: Threads = 0,
    define: Define = None,
    json: Annotated[Path | None, typer.Option(help="Write the verdict as JSON.")] = None,
    junit: Annotated[Path | None, typer.Option(help="Write the tests as JUnit XML.")] = None,
    html: Annotated[Path | None, typer.Option(help="Write the report as one offline page.")] = None,
    force: Force = False,
    quiet: Quiet = False,
) -> None:
    """Judge RENDERS of a scene: exit 0 passed, 1 failed, 2 faulty input, 3 undecided.

    The variance comes from second moments (Mitsuba's moment integrator), from variances (pbrt's gbuffer film) or from
    the scatter of 8 or more seeds. The power is stated first: the smallest bias of each region that would be seen.

    Example: symrender audit render.exr --scene metal --samples 256 --html audit.html
    """
    import json as json_module

    from symrender.audit.audit import audit as judge
    from symrender.audit.junit import junit as as_junit
    from symrender.audit.page import page
    from symrender.cli._console import native_output_hidden
    from symrender.errors import OptionError
    from symrender.images.output import check_target, write_bytes
    from symrender.limits import MIN_SEEDS

    if (seeds or sequential) and len(renders) < MIN_SEEDS:
        raise OptionError(f"seeds: needs at least {MIN_SEEDS} renders, got {len(renders)}")
    inputs = [*renders, *scene_files(scene), *([truth] if truth else [])]
    targets = [target for target in (json, junit, html) if target is not None]
    for target in targets:
        check_target(target, force=force, inputs=inputs)
    chosen = any_scene_with(scene, define)
    with native_output_hidden():
        verdict = judge(
            renders, chosen, truth=truth, samples=samples, noise_free=noise_free, sequential=sequential,
            visible=visible, level=level, wrt=tuple(wrt or ()), explain=explain, explain_seconds=explain_seconds,
            tol=tol, derivative=derivative,
            filter=filter, allow=_pair("allow", allow), ray_offset=_pair("ray-offset", ray_offset), threads=threads,
        )  # fmt: skip
    if json is not None:
        text = json_module.dumps(verdict.as_json(), indent=2, allow_nan=False) + "\n"
        write_bytes(json, text.encode(), force=force, inputs=inputs)
    if junit is not None:
        write_bytes(junit, as_junit(verdict), force=force, inputs=inputs)
    if html is not None:
        write_bytes(html, page(verdict).encode(), force=force, inputs=inputs)
    if not quiet:
        typer.echo(verdict.text())
        for target in targets:
            typer.echo(f"wrote {target}")
    if verdict.exit_code:
        raise typer.Exit(verdict.exit_code)


def _pair(name: str, text: str | None) -> tuple[float, float] | None:
    """One or two numbers of an option, the second 0 where it is left out."""
    from symrender.errors import OptionError

    if text is None:
        return None
    words = text.split(",")
    try:
        first, second = (float(word) for word in (*words, "0")[:2])
    except ValueError:
        raise OptionError(f"{name}: must be one or two numbers, got {text[:40]!r}") from None
    if len(words) > 2:
        raise OptionError(f"{name}: must be one or two numbers, got {text[:40]!r}")
    return first, second
