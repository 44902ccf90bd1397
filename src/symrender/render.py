"""Render a scene both ways. This page is the map.

scene
    A gallery name, a file or a dict becomes a ``Scene`` of validated numbers (``scene/load.py``) and then plain
    arrays (``scene/arrays.py``); nothing later sees text.
numeric
    The conventional ray tracer, written from geometry, samples the lobe (``numeric/``).
expression
    The radiance a direction sees and the weight of the lobe, as SymPy expressions (``expression/``).
program
    The expressions become assignments, loops and guards with shared subexpressions taken out (``kernel/``).
source
    A target prints the program in a language (``targets/``).
kernel
    A runtime compiles the text and keeps it (``runtimes/``).
quadrature
    Rules over the lobe: directions and weights (``quadrature/``).
image
    Tiles, on threads or on the machines of a cluster, fill the layers of an ``Image`` (``images/``); a journal keeps
    what is finished, so that an interrupted run goes on (``execution/``).
ledger
    The two images, compared with their population, their signal and the black image beside every error
    (``ledger/``).

The numeric side imports nothing of the symbolic one, and they meet only in the ledger.
"""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from symrender.errors import OptionError, Unsupported
from symrender.execution.fill import Crew, Means
from symrender.execution.finite import check_finite
from symrender.execution.jobs import Job
from symrender.execution.provenance import provenance, sent_by
from symrender.execution.tev import watched
from symrender.execution.tiles import Progress
from symrender.execution.warm import second_beside
from symrender.images.image import Image
from symrender.ledger.ledger import Ledger, Timing, ledger
from symrender.scene.arrays import scene_arrays
from symrender.scene.load import AnyScene, Source, load_any
from symrender.scene.radiometric.arrays import radiometric_arrays
from symrender.scene.radiometric.lights import Area, Sky
from symrender.scene.radiometric.scene import RadiometricScene
from symrender.scene.undecided import check_decided
from symrender.settings import (
    Antialias,
    Filter,
    Nodes,
    Partition,
    Sampler,
    Settings,
    Symbolic,
    Weights,
    image_size,
)

Finished = Callable[[str, Image], None]
"""``finished(side, image)``, called as soon as the image of a pipeline stands."""


@dataclass(frozen=True)
class Pair:
    """Both images of one scene, either None when not asked for, and their ledger."""

    numeric: Image | None
    symbolic: Image | None
    ledger: Ledger

    def __repr__(self) -> str:
        return self.ledger.text()

    def _repr_html_(self) -> str:
        """Both pictures and the ledger, for a notebook."""
        figures = [
            f'<figure style="display:inline-block;margin:4px"><img alt="{name} render" '
            f'src="data:image/png;base64,{b64encode(image._repr_png_()).decode()}"/>'
            f"<figcaption>{name}</figcaption></figure>"
            for name, image in (("numeric", self.numeric), ("symbolic", self.symbolic))
            if image is not None
        ]
        return "".join(figures) + self.ledger._repr_html_()


def render(
    scene: Source = "gloss",
    *,
    size: int | tuple[int, int] = 512,
    lobe: int = 4,
    numeric: Sampler = "jittered",
    normalised: bool = False,
    symbolic: Symbolic = "strata",
    weights: Weights = "exact",
    nodes: Nodes = "midpoint",
    partition: Partition = "equal_angle",
    disk: str = "2x2",
    aa: Antialias = "analytic",
    tol: float = 1e-3,
    budget: int = 1_000_000,
    silhouettes: int = 1,
    filter: Filter = "centre",
    filter_radius: float = 0.0,
    seed: int = 7,
    threads: int = 0,
    tile: int = 0,
    max_pixels: int | None = None,
    progress: Progress | None = None,
    preview: str | Path | None = None,
    cluster: str = "",
    insecure_cluster: bool = False,
) -> Pair:
    """Render ``scene`` numerically and symbolically and compare.

    ``scene``: a gallery name, a path, a dict or a Scene. ``size``: N or (width, height) in pixels. ``lobe``: K of
    K x K directions a lobe. ``numeric``: sampler of the conventional side, or ``none``. ``symbolic``: ``strata``,
    ``chambers`` (split at the walls, to ``tol`` in radiance or ``budget`` evaluations a pixel; the image has the
    layers of ``truth``) or ``none``. ``weights``, ``nodes``, ``partition``: the strata rule
    (``quadrature/strata.py``). ``normalised``: divide by the closed-form integral of the weight, not by the sum of
    weights met. ``disk``: the K x K centroids rule of disk lights, the same on both sides, or ``exact`` (sampled
    without bias by the numeric side, integrated by ``chambers``, refused by ``strata``). ``aa``: filter the floor
    texture over the pixel (``analytic``) or read it at the centre (``none``). ``seed``: of the samplers. ``threads``:
    0 takes the processors at hand; the bytes do not depend on it, nor on ``tile``, the side of a tile, 0 to measure
    one, nor on ``cluster``: ``tcp://host:port``, ``tls://host:port`` or ``local:N`` processes
    (``execution/cluster.py``). ``preview``: a PNG file that shows each image while it is made, or ``tev`` to see it
    there. ``silhouettes``: K of the K x K points whose mean a pixel beside another shape is, 1 for its centre alone.
    ``filter``, ``filter_radius``: what a pixel of a radiometric scene is, as in ``truth``, on both sides.

    Images hold ``radiance`` = ``direct`` + (lobe weight) ``gloss`` in linear scene units, and ``hit_class``
    (0 nothing, 1 floor, 2 + j sphere j, then planes). Those of radiometric scenes have the layers of ``truth``: the
    numeric side traces ``lobe`` squared paths a pixel, which draw directions for a sky and for bounces (``importance``
    by the material alone, else by light and material), the symbolic side is that of ``truth``, to ``tol``, whatever
    rule is asked for.
    Raises SceneError, OptionError, Unsupported, and NonFiniteError naming the pixels.

    Keywords are many because each is an option of ``symrender render``, by its name.
    """
    loaded = load_any(scene)
    width, height = image_size(size)
    limits: dict[str, Any] = {} if max_pixels is None else {"max_pixels": max_pixels}
    settings = Settings(
        width=width,
        height=height,
        lobe=lobe,
        numeric=numeric,
        normalised=normalised,
        symbolic=symbolic,
        weights=weights,
        nodes=nodes,
        partition=partition,
        disk=disk,
        aa=aa,
        tol=float(tol),
        budget=budget,
        silhouettes=silhouettes,
        filter=filter,
        filter_radius=float(filter_radius),
        seed=seed,
        threads=threads,
        tile=tile,
        **limits,
    )
    jobs = plan(loaded, settings)
    shown = None if preview is None else watched(preview)
    with Crew(Means(threads, tile, cluster, insecure_cluster), jobs, progress, preview=shown) as crew:
        return carry_out(crew, jobs, loaded)


def plan(scene: AnyScene, settings: Settings) -> tuple[Job, ...]:
    """The jobs that make the images ``settings`` ask for; OptionError when they ask for none, or for one unknown."""
    radiometric = isinstance(scene, RadiometricScene)
    symbolic = dict.fromkeys(("strata", "chambers"), "radiometric")
    if not radiometric:
        symbolic = {"strata": "symbolic", "chambers": "truth"}
    kinds = ["paths" if radiometric else "numeric"] if settings.numeric != "none" else []
    kinds += [symbolic[settings.symbolic]] if settings.symbolic != "none" else []
    if not kinds:
        raise OptionError("numeric, symbolic: at least one must not be 'none'")
    if not isinstance(scene, RadiometricScene):
        if settings.filter != "centre" and "symbolic" in kinds:
            raise Unsupported(
                f"filter: {settings.filter} is had of symbolic: chambers; of a scene in units of the series strata "
                "know only centre"
            )
        if "truth" in kinds:
            if settings.filter != "centre":
                from symrender.runtimes.series_refusals import check_series_pixels

                check_series_pixels(scene_arrays(scene), settings)
            check_decided(scene)
    elif "radiometric" in kinds:
        from symrender.runtimes.exposed import check_means
        from symrender.runtimes.radiometric import check

        check(radiometric_arrays(scene))
        check_means(radiometric_arrays(scene), settings)
    return tuple(Job.of(kind, scene, settings) for kind in kinds)


def carry_out(crew: Crew, jobs: Sequence[Job], scene: AnyScene, finished: Finished | None = None) -> Pair:
    """Make the images of ``jobs``, all of ``scene``, with an open ``crew``, and compare them.

    ``finished`` is told each image as soon as it stands.
    """
    images: dict[str, Image] = {}
    timings: dict[str, Timing] = {}
    with second_beside(jobs, crew.progress) as second_compiled:
        for job in jobs:
            if images:
                second_compiled()
            images[job.side], timings[job.side] = _one(crew, job, scene)
            if finished is not None:
                finished(job.side, images[job.side])
    report = ledger(
        images.get("numeric"),
        images.get("symbolic"),
        numeric_timing=timings.get("numeric"),
        symbolic_timing=timings.get("symbolic"),
        lobes=_lobes(scene),
    )
    return Pair(images.get("numeric"), images.get("symbolic"), report)


def _one(crew: Crew, job: Job, scene: AnyScene) -> tuple[Image, Timing]:
    layers, timing = crew.fill(job)
    check_finite(layers, scene, job.side)
    if isinstance(scene, RadiometricScene):
        words = _paths(scene, job.settings) if job.side == "numeric" else sent_by(scene, job.settings)
    else:
        words = _numeric_estimator(job.settings) if job.side == "numeric" else _symbolic_estimator(job.settings)
    return Image(layers, provenance(job, scene, job.side, words)), timing


def _paths(scene: RadiometricScene, settings: Settings) -> str:
    """What the path tracer draws at random."""
    drawn = ["point and directional lights exactly"]
    if any(isinstance(light, Sky) for light in scene.lights):
        alone = settings.numeric == "importance"
        drawn.append(
            "the sky by the material" if alone else "the sky by both itself and the material (balance heuristic)"
        )
    if any(isinstance(light, Area) for light in scene.lights):
        by = "the material" if settings.numeric == "importance" else "both themselves and the material"
        drawn.append(f"spheres that emit by {by}")
    if scene.bounces != 0:
        drawn.append(f"bounces ({scene.bounces}) by the material")
    return f"paths, {settings.numeric} {settings.lobe}x{settings.lobe}: {', '.join(drawn)}"


def _numeric_estimator(settings: Settings) -> str:
    form = "normalised" if settings.normalised else "ratio"
    return f"{settings.numeric} {settings.lobe}x{settings.lobe}, {form}"


def _symbolic_estimator(settings: Settings) -> str:
    if settings.symbolic == "chambers":
        return f"split at the walls, tol {settings.tol:g}, budget {settings.budget}"
    form = "normalised" if settings.normalised else "ratio"
    if settings.nodes == "gauss":
        return f"Gauss in cos^(n+1), {settings.lobe}x{settings.lobe}"
    words = f"{settings.weights} weights, {settings.nodes} nodes, {settings.partition}"
    return f"strata {settings.lobe}x{settings.lobe}, {words}, {form}"


def _lobes(scene: AnyScene) -> list[tuple[str, float, float]]:
    if isinstance(scene, RadiometricScene):
        return []
    surfaces = [] if scene.floor is None else [("floor", scene.floor.lobe)]
    surfaces += [(f"spheres.{sphere.name}", sphere.lobe) for sphere in scene.spheres]
    surfaces += [(f"planes.{plane.name}", plane.lobe) for plane in scene.planes]
    return [
        (name, lobe.exponent, 0.0 if lobe.mirror else lobe.theta_max)
        for name, lobe in surfaces
        if lobe is not None and lobe.weight > 0
    ]
