"""Find scene parameters from an image: Gauss-Newton on exact derivatives."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from symrender.errors import OptionError
from symrender.execution.provenance import filtered
from symrender.gradient import gradient
from symrender.images.image import Image
from symrender.ledger.tables import html_table
from symrender.scene.load import AnyScene, Source, load_any
from symrender.scene.moves import components
from symrender.scene.parameters import get, parameters
from symrender.settings import RADII, Filter
from symrender.truth import truth

Array = npt.NDArray[np.float64]

OUTLIER: Final = 4.0
"""Residuals beyond this many robust standard deviations count less (Geman-McClure's weight)."""


TOLD: Final = 1e-2
"""Share of the information on a parameter below which a fit does not say that it found it."""
STEP_HEADING: Final = "iteration  weighted RMS  largest change"
"""What the columns of a step's row are."""
ROUGH: Final = 1e-4
"""Tolerance of the images a fit begins with; it falls with the residual to the one asked for."""


@dataclass(frozen=True)
class Step:
    """One iteration: ``iteration``, ``cost`` (weighted RMS residual before it), ``values`` by name, ``change``.

    ``change`` is the largest of a parameter over its size at the start, or over 0.1 where that is larger.
    """

    iteration: int
    cost: float
    values: Mapping[str, float]
    change: float

    def text(self) -> str:
        """A row under ``STEP_HEADING``."""
        return f"{self.iteration:9d}  {self.cost:12.3e}  {self.change:14.1e}"


@dataclass(frozen=True)
class Fit:
    """Result of a fit.

    Attributes
    ----------
    scene : Scene or RadiometricScene
        The scene with the values found.
    values : mapping of str to float
        Value of every parameter.
    deviations : mapping of str to float
        Standard deviations from (J^T J)^-1 and the residuals left, or the tolerance where that is larger.
    steps : tuple of Step
        The iterations.
    converged : bool
        Whether the parameters stand still and enough pixels determine them.
    reason : str
        Why the fit ended.
    residual : float
        RMS of model - target over pixels and channels.
    correlation : ndarray
        Correlation of the parameters, (Q, Q).
    """

    scene: AnyScene
    values: Mapping[str, float]
    deviations: Mapping[str, float]
    steps: tuple[Step, ...]
    converged: bool
    reason: str
    residual: float
    correlation: Array

    def __repr__(self) -> str:
        return self.text(steps=False)

    def text(self, steps: bool = True) -> str:
        """The report, with or without a row for each of the ``steps``."""
        lines = [STEP_HEADING, *(step.text() for step in self.steps)] if steps else []
        lines += [f"{'converged' if self.converged else 'not converged'}: {self.reason}"]
        lines += [f"RMS residual {self.residual:.2e} in scene radiance; values with one standard deviation:"]
        width = max(map(len, self.values))
        lines += [f"{name:{width}}  {value:.10g} +- {self.deviations[name]:.1g}" for name, value in self.values.items()]
        return "\n".join(lines)

    def _repr_html_(self) -> str:
        rows = [("parameter", "value", "one standard deviation")]
        rows += [(name, f"{value:.10g}", f"{self.deviations[name]:.1g}") for name, value in self.values.items()]
        ended = f"{'converged' if self.converged else 'not converged'}: {self.reason}"
        return html_table(rows, f"fit, {ended}; RMS residual {self.residual:.2e} in scene radiance")


def fit(
    scene: Source,
    target: Image,
    free: Sequence[str],
    *,
    tol: float = 1e-6,
    iterations: int = 20,
    precision: float = 1e-9,
    disk: str = "2x2",
    filter: Filter = "centre",
    filter_radius: float = 0.0,
    threads: int = 0,
    progress: Callable[[Step], None] | None = None,
) -> Fit:
    """Find numbers of a scene for which its image is the target, in least squares of radiance.

    Parameters
    ----------
    scene : str, path, mapping or scene
        Name of a gallery scene, file, dict with the keys of a file, or a loaded scene.
    target : Image
        Image with a ``radiance`` layer (h, w, 3), whose size the fit takes.
    free : sequence of str
        Dotted names of the real numbers to be found; a vector stands for its components.
    tol : float
        Absolute error of the images; gradients are asked for ten times it.
    iterations : int
        Most iterations.
    precision : float
        Relative change of the parameters that ends the fit.
    disk : str
        ``"KxK"`` replaces a disk light by K x K points, ``"exact"`` integrates it (scenes in units of the series).
    filter : {"centre", "box", "tent", "gaussian", "mitchell"}
        What a pixel is: the ray through its centre, or the weighted mean over a square about it.
    filter_radius : float
        Half the width of the filter in pixels, 0.5 to 2; 0 takes the filter's own.
    threads : int
        Worker threads; 0 takes the processors of this process.
    progress : callable, optional
        Called with the ``Step`` of every iteration.

    Returns
    -------
    Fit
        The scene found, values with standard deviations, the steps, and whether the fit converged.

    Raises
    ------
    OptionError
        The target's metadata name another filter.
    ImageError
        The target has no radiance layer.
    SceneError
        A name is not a real number of the scene.

    See Also
    --------
    gradient : The Jacobian of one iteration.

    Notes
    -----
    Gauss-Newton with backtracking: each iteration solves the linearised problem within the parameters' ranges and
    halves the step while the cost rises. A pixel whose ray meets another shape than in the target jumps, and no
    derivative predicts it. Residuals that the linear model leaves far above the others therefore get Geman-McClure
    weights. Filtered pixels do not jump. Standard deviations use the residuals left, or ``tol`` where that is larger.

    Examples
    --------
    >>> import symrender as sr
    >>> target = sr.truth("metal", size=(24, 12))
    >>> start = sr.load("metal").replace({"lights.key.intensity": (50.0, 50.0, 50.0)})
    >>> found = sr.fit(start, target, ["lights.key.intensity"])
    >>> found.converged
    True
    """
    here = load_any(scene)
    names = components(here, free)
    ranges = {p.name: (p.low, p.high) for p in parameters(here)}
    low, high = np.array([ranges.get(name, (-np.inf, np.inf)) for name in names]).T
    wanted = target.radiance
    size = (target.width, target.height)
    settings: dict[str, Any] = {
        "size": size, "disk": disk, "filter": filter, "filter_radius": filter_radius, "threads": threads
    }  # fmt: skip
    _check_filter(target, filter, filter_radius)

    def image(x: Array, within: float) -> tuple[AnyScene, Array]:
        changed = here.replace(dict(zip(names, map(float, x), strict=True)))
        return changed, truth(changed, tol=within, **settings).radiance

    x = np.array([float(get(here, name)) for name in names])
    scale = np.maximum(np.abs(x), 0.1)
    # far away a rough image tells the way as well
    within = max(tol, ROUGH)
    now, radiance = image(x, within)
    steps: list[Step] = []
    reason, converged = f"the parameters still change after the most iterations, {iterations}", False
    jacobian = np.zeros((wanted.size, len(names)))
    for iteration in range(1, iterations + 1):
        slopes = gradient(now, names, tol=10.0 * within, **settings)
        jacobian = np.stack([slopes[name].radiance.ravel() for name in names], axis=1) * scale
        residual = (radiance - wanted).ravel()
        room = ((low - x) / scale - 1e-15, (high - x) / scale + 1e-15)
        step, weight = _robust_step(jacobian, residual, room)
        cost = _cost(residual, weight)
        finer = max(tol, min(within, 0.03 * cost * float(np.abs(step).max())))
        for _ in range(8):
            inside = np.clip(x + step * scale, low, high)
            trial, seen = image(inside, finer)
            if _cost((seen - wanted).ravel(), weight) <= cost:
                break
            step = 0.5 * step
        x, now, radiance, within = inside, trial, seen, finer
        change = float(np.abs(step).max())
        steps.append(Step(iteration, cost, dict(zip(names, x.tolist(), strict=True)), change))
        if progress is not None:
            progress(steps[-1])
        if change < precision and within == tol:
            reason, converged = _found(precision, _untold(names, jacobian, weight))
            break
    known = float(tol), (radiance - wanted).ravel(), jacobian
    return _ended(now, dict(zip(names, x.tolist(), strict=True)), scale, known, tuple(steps), (reason, converged))


def _ended(
    scene: AnyScene, values: Mapping[str, float], scale: Array, known: tuple[float, Array, Array],
    steps: tuple[Step, ...], ended: tuple[str, bool],
) -> Fit:  # fmt: skip
    """What a fit found, of which the tolerance, the residuals left and the Jacobian over ``scale`` are ``known``."""
    tol, residual, jacobian = known
    normal = np.linalg.pinv(jacobian.T @ jacobian)
    spread = np.sqrt(np.maximum(np.diag(normal), 0.0))
    noise = max(tol, float(np.sqrt((residual @ residual) / max(1, residual.size - len(values)))))
    return Fit(
        scene=scene,
        values=values,
        deviations=dict(zip(values, (noise * spread * scale).tolist(), strict=True)),
        steps=steps,
        converged=ended[1],
        reason=ended[0],
        residual=float(np.sqrt((residual**2).mean())),
        correlation=normal / np.outer(np.maximum(spread, 1e-300), np.maximum(spread, 1e-300)),
    )


def _check_filter(target: Image, filter: Filter, radius: float) -> None:
    """Raise OptionError where the target's metadata say that its pixels are something else."""
    said, reach = filtered(target.meta), radius or RADII[filter]
    if said is not None and said.filter != filter:
        raise OptionError(f"filter: a pixel of the target is its {said.filter}, got {filter}")
    if said is not None and said.reach != reach:
        raise OptionError(f"filter_radius: the target's {filter} reaches {said.reach:g} pixels, got {reach:g}")


def _found(precision: float, untold: Sequence[str]) -> tuple[str, bool]:
    """Why a fit whose parameters stand still ends, and whether it has converged."""
    if untold:
        return f"nearly all pixels that tell {', '.join(untold)} jump: they meet other shapes or fields", False
    return f"the parameters change by less than {precision:g} of themselves", True


def _untold(names: Sequence[str], jacobian: Array, weight: Array) -> list[str]:
    """The parameters which only pixels that hardly count would tell."""
    felt, counted = (jacobian**2).sum(axis=0), (weight[:, None] * jacobian**2).sum(axis=0)
    return [name for name, all_, some in zip(names, felt, counted, strict=True) if some < TOLD * all_]


def _cost(residual: Array, weight: Array) -> float:
    return float(np.sqrt((weight * residual**2).sum() / max(float(weight.sum()), 1e-300)))


def _robust_step(jacobian: Array, residual: Array, room: tuple[Array, Array]) -> tuple[Array, Array]:
    """Step of least |J step + residual| within ``room``, and the weights of the residuals it was found with.

    What the linear model leaves of a residual says whether that pixel changed its shape, shadow or field: weights are
    Geman and McClure's for leftovers beyond ``OUTLIER`` robust standard deviations, found by reweighting. A leftover
    below what the step changes the pixel by is no jump but a curve, also where most others fit to the last digit.
    """
    from scipy.optimize import lsq_linear

    weight = np.ones(len(residual))
    felt = np.abs(jacobian).max(axis=1) > 1e-6 * np.abs(jacobian).max()
    for _ in range(12):
        root = np.sqrt(weight)
        step = lsq_linear(root[:, None] * jacobian, -root * residual, bounds=room).x
        changed = jacobian @ step
        left = changed + residual
        spread = 1.4826 * float(np.median(np.abs(left[felt]))) if felt.any() else 0.0
        usual = np.maximum(OUTLIER * spread, np.abs(changed))
        weight = (1.0 + (left / np.maximum(usual, 1e-300)) ** 2) ** -2
    return step, weight
