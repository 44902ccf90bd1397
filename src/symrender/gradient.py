"""Exact derivatives of the image that ``truth`` makes, one image a parameter, moving edges included.

The rule that integrates a pixel is split at every wall, so its nodes and weights are smooth functions of the scene,
and its derivative is the derivative of the integral: silhouettes, shadows, terminators, texture lines, horizon and rim
contribute what they sweep, to the rule's own order, without sampling edges and without noise.
"""

from __future__ import annotations

import json
from base64 import b64encode
from collections.abc import Sequence
from html import escape
from typing import Final

from symrender.errors import OptionError
from symrender.execution.fill import Crew, Means
from symrender.execution.jobs import KINDS, Job
from symrender.execution.provenance import provenance
from symrender.execution.tiles import Progress
from symrender.images.image import Image
from symrender.quadrature.split_setup import CAPPED, EVENT, MET, UNSUPPORTED
from symrender.scene.arrays import scene_arrays
from symrender.scene.load import AnyScene, Source, load_any
from symrender.scene.moves import moves
from symrender.scene.radiometric.arrays import radiometric_arrays
from symrender.scene.radiometric.scene import RadiometricScene
from symrender.scene.undecided import check_decided
from symrender.settings import Antialias, Filter, Method, Settings, split_settings

STATUS: Final = {MET: "met", CAPPED: "capped", UNSUPPORTED: "unsupported", EVENT: "one-sided"}
"""What the numbers of a gradient's status layer mean."""


class Gradients(dict[str, Image]):
    """The derivatives of an image by the parameter's name; signed pictures in a notebook."""

    def _repr_html_(self) -> str:
        return "".join(map(_figure, self.values()))


def gradient(
    scene: Source = "gloss",
    wrt: Sequence[str] = (),
    *,
    size: int | tuple[int, int] = 64,
    tol: float = 1e-4,
    disk: str = "2x2",
    aa: Antialias = "analytic",
    budget: int | None = None,
    filter: Filter = "centre",
    filter_radius: float = 0.0,
    method: Method = "auto",
    threads: int = 0,
    tile: int = 0,
    cluster: str = "",
    insecure_cluster: bool = False,
    progress: Progress | None = None,
) -> Gradients:
    """Differentiate the image of ``truth`` by real numbers of the scene, boundary terms included.

    Parameters
    ----------
    scene : str, path, mapping or scene
        Name of a gallery scene, file, dict with the keys of a file, or a loaded scene.
    wrt : sequence of str
        Dotted names of real numbers; a vector stands for its components.
    size : int or (int, int)
        Width and height in pixels; a single number is a square.
    tol : float
        Absolute error asked, in radiance over the parameter's unit.
    disk : str
        ``"KxK"`` replaces a disk light by K x K points, ``"exact"`` integrates it (scenes in units of the series).
    aa : {"analytic", "none"}
        Filter the floor's checker over the pixel, or read it at the centre (scenes in units of the series).
    budget : int
        Most evaluations for the value of a pixel; its derivatives together may take four times as many.
    filter : {"centre", "box", "tent", "gaussian", "mitchell"}
        What a pixel is: the ray through its centre, or the weighted mean over a square about it.
    filter_radius : float
        Half the width of the filter in pixels, 0.5 to 2; 0 takes the filter's own.
    method : {"auto", "quadrature", "sampled"}
        Who differentiates by what lights send: quadrature where it covers the scene and paths elsewhere, or one of both
        alone. Paths state a confidence interval, as of ``truth``; other parameters are differentiated by quadrature.
    threads : int
        Worker threads; 0 takes the processors of this process. The result does not depend on it.
    tile : int
        Side of a tile in pixels; 0 measures one. The result does not depend on it.
    cluster : str
        ``"local:N"``, ``"tls://host:port"`` or ``"tcp://host:port"`` of a dask scheduler; empty for threads.
    insecure_cluster : bool
        Allow ``tcp://`` to another machine, whose network is then trusted.
    progress : callable, optional
        Called with finished and total work.

    Returns
    -------
    Gradients
        A dict from the parameter's name to an image. Its layers are the derivatives of those of ``truth``, ``error``
        (h, w), the estimated largest absolute error of ``radiance`` over the channels, ``status`` as in ``STATUS``,
        and ``hit_class``.

    Raises
    ------
    SceneError
        A name is not a real number, or the scene changes its structure at this value.
    OptionError
        An argument is out of range.
    Unsupported
        The method does not cover the scene or the parameter.

    See Also
    --------
    hessian : Second derivatives.
    fit : Find numbers of a scene from an image.

    Notes
    -----
    Derivatives of a lobe's integral contain the boundary terms of all discontinuities inside the lobe: the jump of the
    integrand across each, times the speed at which it moves, by the implicit function theorem. With
    ``filter="centre"`` the derivative of a pixel is that of what its ray meets; an edge inside the pixel contributes
    with ``filter="box"`` and wider filters.
    Keywords are many because each is an option of ``symrender gradient``.

    Examples
    --------
    >>> import symrender as sr
    >>> name = "materials.gold05.alpha"
    >>> slopes = sr.gradient("metal", [name], size=(4, 3))
    >>> sorted(slopes) == [name] and not slopes[name].layer("status").any()
    True
    """
    loaded = load_any(scene)
    settings = split_settings(
        size, tol=tol, disk=disk, aa=aa, budget=budget, threads=threads, tile=tile, filter=filter,
        filter_radius=float(filter_radius), method=method,
    )  # fmt: skip
    job = gradient_job(loaded, wrt, settings)
    with Crew(Means(threads, tile, cluster, insecure_cluster), (job,), progress) as crew:
        return gradient_images(crew, job, loaded)


def _figure(image: Image) -> str:
    """A picture and what its colours mean."""
    source = b64encode(image._repr_png_()).decode()
    words = escape(image.view().caption)
    return (
        f'<figure style="display:inline-block;margin:4px"><img alt="{words}" src="data:image/png;base64,{source}"/>'
        f"<figcaption>{words}</figcaption></figure>"
    )


def file_stem(name: str) -> str:
    """How files call the derivative by the parameter ``name``: ``gradient_spheres.B.center.x``."""
    return "gradient_" + name.replace("[", "_").replace("]", "")


def gradient_job(scene: AnyScene, wrt: Sequence[str], settings: Settings) -> Job:
    """The job that makes the images; what checks radiometric scenes is imported for these alone."""
    if isinstance(wrt, str) or not wrt:
        raise OptionError("wrt: must be a sequence of at least one dotted name, such as ['spheres.B.center.x']")
    if isinstance(scene, RadiometricScene):
        from symrender.radiance.linear import shares_of
        from symrender.scene.radiometric.moves import radiometric_moves

        moved = radiometric_moves(scene, wrt)
        linear = shares_of(radiometric_arrays(scene), settings, moved).linear
        return Job.of("linear_gradient" if linear else "radiometric_gradient", scene, settings, moved)
    check_decided(scene)
    if settings.filter != "centre":
        from symrender.runtimes.series_refusals import check_series_pixels

        check_series_pixels(scene_arrays(scene), settings)
        return Job.of("mean_gradient", scene, settings, moves(scene, wrt))
    return Job.of("gradient", scene, settings, moves(scene, wrt))


def gradient_images(crew: Crew, job: Job, scene: AnyScene) -> Gradients:
    """Carry out ``job``, of ``scene``, with an open ``crew``."""
    layers, timing = crew.fill(job)
    images = Gradients()
    shares = None
    if job.kind == "linear_gradient" and isinstance(scene, RadiometricScene):
        from symrender.radiance.linear import shares_of

        shares = shares_of(radiometric_arrays(scene), job.settings, job.wrt)
    radiance = "radiance, W/(m2 sr)," if isinstance(scene, RadiometricScene) else "scene radiance"
    for name, _ in job.wrt:
        # closed forms are split at no walls
        split = "closed forms" if isinstance(scene, RadiometricScene) else "split at the walls"
        spent = f"tol {job.settings.tol:g}, {timing.evaluations} evaluations"
        estimator = f"derivative in {name}, {split}, {spent}"
        parts = {layer: layers[f"{layer}:{name}"] for layer, _ in KINDS[job.kind].each}
        parts["hit_class"] = layers["hit_class"]
        meta = provenance(job, scene, "gradient", estimator)
        if shares is not None:
            meta |= {"providers": json.dumps(shares.providers(name))}
        images[name] = Image(parts, meta | {"parameter": name, "units": f"{radiance} over the parameter's unit"})
    return images
