"""The image every renderer can be tested against: each pixel with its error and a status.

The value of a pixel is the radiance along the ray through its centre: direct light plus the lobe integral, split at
the walls where the integrand breaks (``quadrature/split_point.py``). The floor texture is filtered as ``aa`` says.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np

from symrender.errors import Unsupported
from symrender.execution.fill import Crew, Means
from symrender.execution.finite import check_finite
from symrender.execution.jobs import Job
from symrender.execution.provenance import provenance, sent_by
from symrender.execution.tev import watched
from symrender.execution.tiles import Progress
from symrender.images.image import Image
from symrender.quadrature.split_setup import CAPPED, MET, NEAR_TANGENT, UNSUPPORTED
from symrender.scene.arrays import scene_arrays
from symrender.scene.load import AnyScene, Source, in_series, load_any
from symrender.scene.radiometric.arrays import radiometric_arrays
from symrender.scene.radiometric.scene import RadiometricScene
from symrender.scene.undecided import check_decided
from symrender.settings import Antialias, Filter, Method, Settings, check_share, split_settings

STATUS: Final = {MET: "met", CAPPED: "capped", NEAR_TANGENT: "near-tangent", UNSUPPORTED: "unsupported"}
"""What the numbers of a status layer mean."""


def truth(
    scene: Source = "gloss",
    *,
    size: int | tuple[int, int] = 256,
    tol: float = 1e-6,
    disk: str = "2x2",
    aa: Antialias = "analytic",
    budget: int | None = None,
    counts: bool = True,
    silhouettes: int = 1,
    filter: Filter = "centre",
    filter_radius: float = 0.0,
    method: Method = "auto",
    threads: int = 0,
    tile: int = 0,
    cluster: str = "",
    insecure_cluster: bool = False,
    verify: float = 0.0,
    progress: Progress | None = None,
    preview: str | Path | None = None,
) -> Image:
    """Render a reference image, every pixel with an error estimate and a status.

    Use it for images that are to be trusted or compared with; ``render`` is faster and has no error estimate.

    Parameters
    ----------
    scene : str, path, mapping or scene
        Name of a gallery scene, file, dict with the keys of a file, or a loaded scene.
    size : int or (int, int)
        Width and height in pixels; a single number is a square.
    tol : float
        Absolute error asked of the radiance of every pixel, in scene units or W/(m2 sr).
    disk : str
        ``"KxK"`` replaces a disk light by K x K points, ``"exact"`` integrates it (scenes in units of the series).
    aa : {"analytic", "none"}
        Filter the floor's checker over the pixel, or read it at the centre (scenes in units of the series).
    budget : int, optional
        Most evaluations for a pixel, kept within twice itself. By default 1,000,000 along a ray; a filtered pixel of
        reflected light then stops refining after 1,000,000, but may have taken some 40 times as many at once.
    counts : bool
        Count smooth regions and discontinuities; without, lattice rules may be used at loose tolerances.
    silhouettes : int
        K of the K x K points averaged in pixels next to another shape; 1 is the centre alone.
    filter : {"centre", "box", "tent", "gaussian", "mitchell"}
        What a pixel is: the ray through its centre, or the weighted mean over a square about it.
    filter_radius : float
        Half the width of the filter in pixels, 0.5 to 2; 0 takes the filter's own.
    method : {"auto", "quadrature", "sampled"}
        Who computes a radiometric scene. ``"quadrature"`` refuses what it does not cover. ``"sampled"`` is the path
        tracer, with a confidence interval for every pixel. ``"auto"`` takes quadrature for each component that it
        covers and samples the rest; the metadata ``providers`` say which, and why.
    threads : int
        Worker threads; 0 takes the processors of this process. The result does not depend on it.
    tile : int
        Side of a tile in pixels; 0 measures one. The result does not depend on it.
    cluster : str
        ``"local:N"``, ``"tls://host:port"`` or ``"tcp://host:port"`` of a dask scheduler; empty for threads.
    insecure_cluster : bool
        Allow ``tcp://`` to another machine, whose network is then trusted.
    verify : float
        Share of the pixels, 0 to 1, that the path tracer renders again; the result is the metadata ``verified``.
    progress : callable, optional
        Called with finished and total work.
    preview : str or path, optional
        PNG file that shows the image while it is made, or ``"tev"``.

    Returns
    -------
    Image
        Layers of shape (h, w, 3): ``radiance`` = ``direct`` + lobe weight times ``gloss``, or, of a radiometric scene,
        ``emitted`` + ``direct`` + ``indirect``. Layers of shape (h, w): ``hit_class``; ``error``, the estimated largest
        absolute error over the channels; ``status``, as in ``STATUS``; ``evaluations``, ``chambers``, ``crossings``.

    Raises
    ------
    SceneError
        The scene is wrong.
    OptionError
        An argument is out of range.
    Unsupported
        The method does not cover the scene; the message names what.
    NonFiniteError
        A pixel is not a number; the message names it.

    See Also
    --------
    probe : Single points or rays.
    gradient : Derivatives of this image.

    Notes
    -----
    The integrand of a lobe is cut at its discontinuities (silhouettes, shadow edges, terminators, texture edges, the
    horizon and the rim), and each smooth piece is integrated by Gauss rules that are refined until the error estimate
    meets ``tol``. A pixel that misses it keeps its value and its error. Direct light of a radiometric scene is a
    closed form; its error is the effect of rounding.
    Keywords are many because each is an option of ``symrender truth``.

    Examples
    --------
    >>> import symrender as sr
    >>> image = sr.truth("metal", size=(4, 3), tol=1e-6)
    >>> bool((image.layer("status") == 0).all() and image.layer("error").max() < 1e-6)
    True
    """
    loaded = load_any(scene)
    settings = split_settings(
        size,
        tol=tol,
        disk=disk,
        aa=aa,
        budget=budget,
        threads=threads,
        tile=tile,
        counts=counts,
        silhouettes=silhouettes,
        filter=filter,
        filter_radius=float(filter_radius),
        method=method,
    )
    check_share(verify)
    judged = in_series(loaded, "verify") if verify else None
    if verify and filter != "centre":
        raise Unsupported(f"verify: makes rays through centres again, and knows no filter: {filter} yet")
    job = truth_job(loaded, settings)
    shown = None if preview is None else watched(preview)
    with Crew(Means(threads, tile, cluster, insecure_cluster), (job,), progress, preview=shown) as crew:
        image = true_image(crew, job, loaded)
    if judged is None:
        return image
    from symrender.verify import verified

    return verified(image, judged, settings, verify, threads)


def truth_job(scene: AnyScene, settings: Settings) -> Job:
    """The job that makes the image; what checks radiometric scenes is imported for these alone."""
    if isinstance(scene, RadiometricScene):
        from symrender.radiance.choice import plan_of

        kind = "sampled" if plan_of(radiometric_arrays(scene), settings).sampled else "radiometric"
        return Job.of(kind, scene, settings)
    if settings.filter != "centre":
        from symrender.runtimes.series_refusals import check_series_pixels

        check_series_pixels(scene_arrays(scene), settings)
    check_decided(scene)
    return Job.of("truth", scene, settings)


def true_image(crew: Crew, job: Job, scene: AnyScene) -> Image:
    """Carry out ``job``, of ``scene``, with an open ``crew``."""
    layers, timing = crew.fill(job)
    check_finite(layers, scene, "truth")
    if isinstance(scene, RadiometricScene):
        words = "sampled" if job.kind == "sampled" else sent_by(scene, job.settings)
        meta = provenance(job, scene, "truth", f"{words}, tol {job.settings.tol:g}")
        return Image(layers, meta | {"providers": json.dumps(_providers(scene, job.settings))})
    estimator = f"split at the walls, tol {job.settings.tol:g}, {timing.evaluations} evaluations"
    return Image(layers, provenance(job, scene, "truth", estimator))


def _providers(scene: RadiometricScene, settings: Settings) -> dict[str, str]:
    """Who made each layer, and why no faster provider did."""
    from symrender.radiance.choice import plan_of

    return plan_of(radiometric_arrays(scene), settings).providers()


@dataclass(frozen=True)
class Verdict:
    """How an image fared: its pixels, how many ``missed`` their tolerance by status, and the pixel of largest error."""

    pixels: int
    missed: Mapping[str, int]
    worst: tuple[int, int]
    largest: float

    @property
    def met(self) -> bool:
        """Whether every pixel met its tolerance."""
        return not any(self.missed.values())

    def text(self) -> str:
        """One line."""
        i, j = self.worst
        missed = ", ".join(f"{count} {name}" for name, count in self.missed.items() if count) or "none"
        return f"{self.pixels} pixels; missed their tolerance: {missed}; largest error {self.largest:.3g} at ({i}, {j})"


def verdict(image: Image, names: Mapping[int, str] = STATUS) -> Verdict:
    """Judge an image with ``error`` and ``status`` layers, whose statuses are called ``names``."""
    error, status = image.layer("error"), image.layer("status")
    j, i = np.unravel_index(int(np.argmax(error)), error.shape)
    missed = {name: int((status == code).sum()) for code, name in names.items() if code != MET}
    return Verdict(error.size, missed, (int(i), int(j)), float(error[j, i]))
