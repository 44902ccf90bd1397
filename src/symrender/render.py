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
from symrender.scene.radiometric.lights import Area, Environment, Sky
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
    """Both images of one scene and their comparison.

    Attributes
    ----------
    numeric : Image or None
        The image of the path tracer, if asked for.
    symbolic : Image or None
        The image of the symbolic pipeline, if asked for.
    ledger : Ledger
        Cost, differences and lobe widths.
    """

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
    """Render a scene by sampling and by quadrature, and compare the two images.

    Use it for quick images and to compare estimators. Its images carry no error estimate, except with
    ``symbolic="chambers"``.

    Parameters
    ----------
    scene : str, path, mapping or scene
        Name of a gallery scene, file, dict with the keys of a file, or a loaded scene.
    size : int or (int, int)
        Width and height in pixels; a single number is a square.
    lobe : int
        K of the K x K directions of a lobe; the path tracer draws K x K paths a pixel.
    numeric : {"jittered", "independent", "importance", "sobol", "none"}
        Sampler of the path tracer, or none.
    normalised : bool
        Divide by the closed-form integral of the weight instead of the sum of the sampled weights.
    symbolic : {"strata", "chambers", "none"}
        Rule of the symbolic pipeline: fixed strata, the split rule of ``truth``, or none.
    weights : {"exact", "midpoint"}
        Weights of the strata.
    nodes : {"midpoint", "barycentre", "gauss"}
        Direction of a stratum.
    partition : {"equal_angle", "equal_solid_angle", "equal_weight"}
        How the lobe is divided into rings.
    disk : str
        ``"KxK"`` replaces a disk light by K x K points on both sides; ``"exact"`` is sampled by the path tracer,
        integrated by ``chambers`` and refused by ``strata``.
    aa : {"analytic", "none"}
        Filter the floor's checker over the pixel, or read it at the centre (scenes in units of the series).
    tol : float
        Absolute error asked of ``chambers``, and of the symbolic image of a radiometric scene.
    budget : int
        Most evaluations for a pixel.
    silhouettes : int
        K of the K x K points averaged in pixels next to another shape; 1 is the centre alone.
    filter : {"centre", "box", "tent", "gaussian", "mitchell"}
        What a pixel is: the ray through its centre, or the weighted mean over a square about it.
    filter_radius : float
        Half the width of the filter in pixels, 0.5 to 2; 0 takes the filter's own.
    seed : int
        Seed of the samplers.
    threads : int
        Worker threads; 0 takes the processors of this process. The result does not depend on it.
    tile : int
        Side of a tile in pixels; 0 measures one. The result does not depend on it.
    max_pixels : int, optional
        Allow larger images than the limit.
    progress : callable, optional
        Called with finished and total work.
    preview : str or path, optional
        PNG file that shows the image while it is made, or ``"tev"``.
    cluster : str
        ``"local:N"``, ``"tls://host:port"`` or ``"tcp://host:port"`` of a dask scheduler; empty for threads.
    insecure_cluster : bool
        Allow ``tcp://`` to another machine, whose network is then trusted.

    Returns
    -------
    Pair
        ``numeric`` and ``symbolic``, images with layers as those of ``truth``, and their ``ledger``.

    Raises
    ------
    SceneError
        The scene is wrong.
    OptionError
        An argument is out of range.
    Unsupported
        The method does not cover the scene.
    NonFiniteError
        A pixel is not a number; the message names it.

    See Also
    --------
    truth : The same light with an error for every pixel.

    Notes
    -----
    The two pipelines share no formula. Where both read the radiance along the same rays, as in the layer ``direct``,
    they must agree to rounding. The symbolic image of a radiometric scene is that of ``truth``.
    Keywords are many because each is an option of ``symrender render``.

    Examples
    --------
    >>> import symrender as sr
    >>> pair = sr.render("gloss", size=(16, 12))
    >>> pair.ledger.comparisons["direct"].whole.relative_rmse < 1e-12
    True
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

        try:
            check(radiometric_arrays(scene))
            check_means(radiometric_arrays(scene), settings)
        except Unsupported as error:
            raise Unsupported(f"{error}. Its image by paths alone is had with symbolic: none") from None
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
    if any(isinstance(light, Sky | Environment) for light in scene.lights):
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
