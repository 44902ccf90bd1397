"""The image every renderer can be tested against: each pixel with its error and a status.

The value of a pixel is the radiance along the ray through its centre: direct light plus the lobe integral, split at
the walls where the integrand breaks (``quadrature/split_point.py``). The floor texture is filtered as ``aa`` says.
"""

from __future__ import annotations

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
from symrender.settings import Antialias, Filter, Settings, check_share, split_settings

STATUS: Final = {MET: "met", CAPPED: "capped", NEAR_TANGENT: "near-tangent", UNSUPPORTED: "unsupported"}
"""What the numbers of a status layer mean."""


def truth(
    scene: Source = "gloss",
    *,
    size: int | tuple[int, int] = 256,
    tol: float = 1e-6,
    disk: str = "2x2",
    aa: Antialias = "analytic",
    budget: int = 1_000_000,
    counts: bool = True,
    silhouettes: int = 1,
    filter: Filter = "centre",
    filter_radius: float = 0.0,
    threads: int = 0,
    tile: int = 0,
    cluster: str = "",
    insecure_cluster: bool = False,
    verify: float = 0.0,
    progress: Progress | None = None,
    preview: str | Path | None = None,
) -> Image:
    """Image of ``scene`` with an ``error`` and a ``status`` layer.

    ``tol`` is absolute, in scene units of radiance, and asked of every pixel's radiance. Layers: ``radiance`` =
    ``direct`` + (lobe weight) ``gloss``, of a filter by its weight already; ``hit_class``; ``error`` (h, w), the
    estimated largest absolute error of radiance over the channels; ``status`` (h, w) as in ``STATUS``;
    ``evaluations``, ``chambers`` and ``crossings`` (h, w): shaded hits, different chambers and walls met. A pixel
    that missed its tolerance keeps its value and its honest error. ``disk``: ``KxK`` replaces a disk light by its
    centroids, ``exact`` integrates it. ``budget``: most evaluations a pixel. Without ``counts`` spheres are done on
    lattices of directions where that is good enough, quicker at loose tolerances, and ``chambers`` and ``crossings``
    leave these out. ``silhouettes``: K of the K x K points whose mean a pixel beside another shape is, 1 for its
    centre alone. ``threads``, ``tile`` and ``cluster`` change no byte. ``preview``: a PNG file that shows the image
    while it is made, or ``tev`` to see it there. ``verify`` is a share of the pixels, drawn at random, that brute
    force makes again (``verify.py``); what it says is the metadata ``verified``.

    A radiometric scene has layers ``radiance`` = ``emitted`` + ``direct`` + ``indirect`` in W/(m2 sr), ``hit_class``
    (1 + j shape j), ``error`` and ``status``. With ``bounces: 0`` all is closed forms, ``indirect`` zero and ``error``
    what rounding may have done; ``bounces: 1`` is split at the walls like gloss. ``disk``, ``aa`` and ``counts`` have
    no say. ``filter``: ``centre``, the radiance along the ray through a pixel's centre, where textures are read too,
    or ``box``, the mean over its area, cut at every edge in it (``docs/pixels.md``), ``tent``, ``gaussian`` or
    ``mitchell`` one weighed over ``filter_radius`` pixels to every side, 0 the filter's own; ``hit_class`` is the
    centre's. With an ``aperture`` of the camera or a ``shutter`` it is the mean over these too (``docs/exposure.md``).
    Choose truth whenever an image is to be
    trusted, ``render`` when it is to be quick. Keywords are many because each is an option of ``symrender truth``, by
    its name.
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
        from symrender.runtimes.exposed import check_means
        from symrender.runtimes.radiometric import check

        check(radiometric_arrays(scene))
        check_means(radiometric_arrays(scene), settings)
        return Job.of("radiometric", scene, settings)
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
        words = sent_by(scene, job.settings)
        return Image(layers, provenance(job, scene, "truth", f"{words}, tol {job.settings.tol:g}"))
    estimator = f"split at the walls, tol {job.settings.tol:g}, {timing.evaluations} evaluations"
    return Image(layers, provenance(job, scene, "truth", estimator))


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
