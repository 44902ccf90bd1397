"""Find scene parameters from an image: Gauss-Newton on exact derivatives.

The file is long because the linear model that gives the steps is also what says which parameters the target determines.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from symrender.errors import ImageError, OptionError
from symrender.execution.provenance import filtered
from symrender.gradient import gradient
from symrender.images.image import Image
from symrender.ledger.tables import html_table
from symrender.scene.load import AnyScene, Source, load_any
from symrender.scene.moves import components
from symrender.scene.parameters import get, parameters
from symrender.scene.scales import scale_of
from symrender.settings import RADII, Filter
from symrender.truth import truth

Array = npt.NDArray[np.float64]

OUTLIER: Final = 4.0
"""Residuals beyond this many robust standard deviations count less (Geman-McClure's weight)."""
FELT: Final = 1e-6
"""Part of the largest derivative below which a pixel's residual says nothing about the parameters."""
LEFT: Final = 0.05
"""Least part of its noise that a fit is taken to leave of a residual."""
LIKE: Final = 27
"""Channels of pixels about as bright whose leftovers are compared, at least."""
SINGULAR: Final = 1e-10
"""Singular value of the Jacobian, its columns scaled to length 1, that counts as zero even if no error is stated."""
DAMPING: Final = 1e-7
"""Length of a step that costs as much as a residual, over the length of the parameter's column of the Jacobian."""
FAINT: Final = (1e-9, 1e-3)
"""Smallest and largest bound below which a component of a null direction is taken for a rounding error."""
TOLD: Final = 1e-2
"""Share of the information on a parameter below which a fit does not say that it found it."""
STEP_HEADING: Final = "iteration  weighted RMS  largest change"
"""What the columns of a step's row are."""
ROUGH: Final = 1e-4
"""Tolerance of the images a fit begins with; it falls with the residual to the one asked for."""


@dataclass(frozen=True)
class Step:
    """One iteration: ``iteration``, ``cost`` (weighted RMS residual before it), ``values`` by name, ``change``.

    ``change`` is the largest change of a parameter over its scale at the start: its value, or of a coordinate the
    median distance to the other places of the scene.
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
        The values found, by name.
    deviations : mapping of str to float
        One standard deviation of each value: that of the robust estimate under the residuals left, or the tolerance of
        the images where that is larger. It is infinite for every parameter that takes part in an undetermined
        combination. For a parameter at the end of its range it includes the distance to ``at_bound``.
    steps : tuple of Step
        The iterations.
    converged : bool
        True if the parameters stand still.
    reason : str
        Why the iteration ended.
    residual : float
        RMS over pixels and channels of model - target.
    correlation : ndarray, shape (Q, Q)
        Correlation of the parameters, NaN for those that are not determined.
    rank : int
        Number of combinations of the parameters that the target determines to first order.
    undetermined : tuple of mapping of str to float
        A basis of the combinations that the target does not determine. Each maps names to relative changes that leave
        the image as it is: {"lights.k.intensity.r": 1, "materials.m.reflectance.color.r": -1} says that only the
        product is known.
    at_bound : mapping of str to float
        The parameters at an end of their range, with the value that the linear model gives without the range.
    """

    scene: AnyScene
    values: Mapping[str, float]
    deviations: Mapping[str, float]
    steps: tuple[Step, ...]
    converged: bool
    reason: str
    residual: float
    correlation: Array
    rank: int
    undetermined: tuple[Mapping[str, float], ...]
    at_bound: Mapping[str, float]

    def __repr__(self) -> str:
        return self.text(steps=False)

    def text(self, steps: bool = True) -> str:
        """The report, with or without a row for each of the ``steps``."""
        lines = [STEP_HEADING, *(step.text() for step in self.steps)] if steps else []
        lines += [f"{'converged' if self.converged else 'not converged'}: {self.reason}", *self._unknown()]
        lines += [f"RMS residual {self.residual:.2e} in scene radiance; values with one standard deviation:"]
        width = max(map(len, self.values))
        lines += [f"{name:{width}}  {' '.join(row).rstrip()}" for name, *row in self._rows("+- ")]
        return "\n".join(lines)

    def _unknown(self) -> list[str]:
        """What the target does not determine."""
        if not self.undetermined:
            return []
        said = [", ".join(f"{name} x {part:.4g}" for name, part in each.items()) for each in self.undetermined]
        return [
            f"the target determines {self.rank} of {len(self.values)} combinations; it does not change with these "
            "relative changes:",
            *(f"  {each}" for each in said),
        ]

    def _rows(self, sign: str) -> list[tuple[str, str, str, str]]:
        """Name, value, deviation and what is to be said of it, of each parameter."""
        rows = []
        for name, value in self.values.items():
            deviation, said = self.deviations[name], ""
            if name in self.at_bound:
                said = f"at the end of its range; without it {self.at_bound[name]:.6g}"
            if deviation == np.inf:
                said = "; ".join(filter(None, ("not determined by the target", said)))
            rows.append((name, f"{value:.10g}", f"{sign}{deviation:.1g}", said and f"({said})"))
        return rows

    def _repr_html_(self) -> str:
        rows = [("parameter", "value", "one standard deviation", ""), *self._rows("")]
        ended = f"{'converged' if self.converged else 'not converged'}: {self.reason}"
        unknown = "".join(f"; {line.strip()}" for line in self._unknown())
        return html_table(rows, f"fit, {ended}; RMS residual {self.residual:.2e} in scene radiance{unknown}")


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
        The target's metadata name another filter, or ``free`` is empty.
    ImageError
        The target has no radiance layer, or pixels that are NaN or infinite.
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
    weights. Filtered pixels do not jump. Standard deviations are those of this robust estimate under the residuals
    left, or of ``tol`` where that is larger. Combinations of parameters that the target does not determine stay where
    they were and are named in ``Fit.undetermined``.

    The function is long because it documents its options.

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
    if not names:
        raise OptionError("free: must name at least one real number of the scene, got none")
    ranges = {p.name: (p.low, p.high) for p in parameters(here)}
    low, high = np.array([ranges.get(name, (-np.inf, np.inf)) for name in names]).T
    wanted = _finite(target)
    size = (target.width, target.height)
    settings: dict[str, Any] = {
        "size": size, "disk": disk, "filter": filter, "filter_radius": filter_radius, "threads": threads
    }  # fmt: skip
    _check_filter(target, filter, filter_radius)

    def image(x: Array, within: float) -> tuple[AnyScene, Array]:
        changed = here.replace(dict(zip(names, map(float, x), strict=True)))
        return changed, truth(changed, tol=within, **settings).radiance

    x = np.array([float(get(here, name)) for name in names])
    scale = np.array([scale_of(here, name) for name in names])
    # far away a rough image tells the way as well
    within = max(tol, ROUGH)
    now, radiance = image(x, within)
    steps: list[Step] = []
    reason, converged = f"the parameters still change after the most iterations, {iterations}", False
    for iteration in range(1, iterations + 1):
        slopes = gradient(now, names, tol=10.0 * within, **settings)
        linear = _Linear(
            np.stack([slopes[name].radiance.ravel() for name in names], axis=1) * scale,
            np.array([_stated(slopes[name]) for name in names]) * scale,
            (radiance - wanted).ravel(),
        )
        room = ((low - x) / scale - 1e-15, (high - x) / scale + 1e-15)
        step, weight = _robust_step(linear, radiance.ravel(), room)
        cost = _cost(linear.residual, weight)
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
            reason, converged = _found(precision, _untold(names, linear.jacobian, weight))
            break
    final = _Linear(linear.jacobian, linear.errors, (radiance - wanted).ravel())
    values = dict(zip(names, x.tolist(), strict=True))
    known = _known(values, final, weight, scale, float(tol))
    relative = scale / np.array([scale_of(now, name) for name in names])
    undetermined = tuple(_relative(names, each * relative) for each in known.null)
    at_bound = {
        name: float(value + shift)
        for name, value, shift, a, b in zip(names, x, known.shift, low, high, strict=True) if value in (a, b)
    }  # fmt: skip
    apart = np.array([at_bound.get(name, value) - value for name, value in values.items()])
    deviations = np.where((known.null != 0.0).any(axis=0), np.inf, np.hypot(known.deviations, apart))
    return Fit(
        scene=now,
        values=values,
        deviations=dict(zip(names, deviations.tolist(), strict=True)),
        steps=tuple(steps),
        converged=converged,
        reason=reason,
        residual=float(np.sqrt((final.residual**2).mean())),
        correlation=known.correlation,
        rank=len(names) - len(undetermined),
        undetermined=undetermined,
        at_bound=at_bound,
    )


@dataclass(frozen=True)
class _Linear:
    """A fit linearised: ``jacobian`` (M, Q) over the scales of the parameters, ``errors`` (Q,), ``residual`` (M,).

    ``errors`` are the lengths of what the columns of the Jacobian are stated to be off by.
    """

    jacobian: Array
    errors: Array
    residual: Array

    def felt(self) -> npt.NDArray[np.bool_]:
        """Which residuals say anything about the parameters."""
        most = np.abs(self.jacobian).max(axis=0)
        return np.asarray((np.abs(self.jacobian) > FELT * most).any(axis=1))

    def directions(self, weight: Array) -> tuple[Array, Array]:
        """Inverse of J^T W J (Q, Q) where it has one, and a basis (D, Q) of the directions where it has none.

        Columns are compared at length 1, so that units do not matter. A singular value that is no larger than what the
        columns may be off by together may be zero, for all that is known.
        """
        from scipy.linalg import qr

        jacobian = np.sqrt(weight)[:, None] * self.jacobian
        size = np.sqrt((jacobian**2).sum(axis=0))
        seen = np.flatnonzero(size > self.errors)
        count = len(size)
        null = [np.eye(count)[q] for q in range(count) if q not in seen]
        inverse = np.zeros((count, count))
        if len(seen):
            triangle = np.linalg.qr(jacobian[:, seen] / size[seen], mode="r")
            _, found, axes = np.linalg.svd(triangle, full_matrices=True)
            found = np.pad(found, (0, len(seen) - len(found)))
            least = max(SINGULAR, float(np.linalg.norm(self.errors[seen] / size[seen])))
            kept = found > least
            inverse[np.ix_(seen, seen)] = (
                (axes[kept].T / found[kept] ** 2) @ axes[kept] / np.outer(size[seen], size[seen])
            )
            basis = axes[~kept]
            if len(basis):
                pivots = qr(basis, mode="r", pivoting=True)[1][: len(basis)]
                basis = np.linalg.solve(basis[:, pivots], basis)
                basis[np.abs(basis) < np.clip(least / found[kept].min(initial=np.inf), *FAINT)] = 0.0
                for row in basis:
                    null.append(np.zeros(count))
                    null[-1][seen] = row / size[seen]
        return inverse, np.array(null).reshape(-1, count)


@dataclass(frozen=True)
class _Known:
    """What a target says of Q parameters: ``null`` (D, Q), ``deviations``, ``shift`` (Q,) and ``correlation`` (Q, Q).

    ``shift`` is the step that the linear model takes without ranges.
    """

    null: Array
    deviations: Array
    shift: Array
    correlation: Array


def _known(values: Mapping[str, float], linear: _Linear, weight: Array, scale: Array, tol: float) -> _Known:
    """Covariance of the robust estimate where the parameters stand still.

    It is that of an M-estimate with psi(r) = w r (P. J. Huber, Robust Statistics, 1981, section 7.6), once with the
    same noise in all pixels and once with each pixel's own residual over what the fit leaves of it (J. G. MacKinnon and
    H. White, Journal of Econometrics 29, 1985, doi:10.1016/0304-4076(85)90158-7); the larger is taken. Where few
    residuals make up the latter, it is that of Student's t of so many degrees of freedom that holds 68.3 %. The RMS of
    all residuals instead would count outliers that the estimate hardly feels.
    """
    from scipy.stats import norm, t

    inverse, null = linear.directions(weight)
    felt = linear.felt()
    jacobian, w, r = linear.jacobian[felt], weight[felt], linear.residual[felt]
    # mean of psi', of Geman and McClure's weight, over that of w
    steepness = max(0.1, float((4.0 * w**1.5 - 3.0 * w).sum()) / max(float(w.sum()), 1e-300))
    spare = float(w.sum()) / max(1.0, float(w.sum()) - (len(values) - len(null)))
    alike = float((w * w * r * r).sum()) / max(float(w.sum()), 1e-300) * np.diag(inverse)
    moved = inverse @ (jacobian.T * (w * r))
    left = 1.0 - w * np.einsum("ij,jk,ik->i", jacobian, inverse, jacobian)
    each = (moved / np.maximum(left, LEFT)) ** 2
    own = each.sum(axis=1)
    degrees = own**2 / np.maximum((each**2).sum(axis=1), 1e-300) - 1.0
    own *= t.ppf(norm.cdf(1.0), np.maximum(degrees, 1.0)) ** 2
    noise = np.maximum(spare * alike, own) / steepness**2
    spread = np.sqrt(np.maximum(np.diag(inverse), 0.0))
    with np.errstate(invalid="ignore", divide="ignore"):
        correlation = inverse / np.outer(spread, spread)
    unknown = (null != 0.0).any(axis=0)
    correlation[unknown], correlation[:, unknown] = np.nan, np.nan
    shift = -moved.sum(axis=1) * scale
    return _Known(null, np.sqrt(np.maximum(noise, (tol * spread) ** 2)) * scale, shift, correlation)


def _relative(names: Sequence[str], direction: Array) -> Mapping[str, float]:
    """The parameters of a direction and their changes; the first of the largest is 1."""
    size = np.abs(direction)
    largest = direction[np.argmax(size > 0.999 * size.max())]
    return {name: float(part / largest) for name, part in zip(names, direction, strict=True) if part != 0.0}


def _stated(slopes: Image) -> float:
    """Length of what a column of the Jacobian is stated to be off by; pixels without a derivative have none in it."""
    error = slopes.layer("error")
    return float(np.sqrt(3.0 * (error[np.isfinite(error)] ** 2).sum()))


def _finite(target: Image) -> Array:
    """The target's radiance; ImageError where it is not finite."""
    bad = np.argwhere(~np.isfinite(target.radiance).all(axis=2))
    if len(bad):
        row, column = (int(k) for k in bad[0])
        raise ImageError(
            f"target: {len(bad)} of {target.width * target.height} pixels are NaN or infinite, the first at column "
            f"{column}, row {row}: {target.radiance[row, column].tolist()}; expected finite radiance everywhere"
        )
    return target.radiance


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


def _spreads(left: Array, light: Array) -> Array:
    """(M,) robust standard deviations of noise of pixels with so much ``light``, from what is ``left`` of residuals.

    It is the scaled median of all leftovers, and more where those of pixels about as bright are larger, but no more
    than in proportion to the light: noise of renderers grows with it, and jumps are no noise.
    """
    from scipy.ndimage import median_filter

    size = np.abs(left)
    order = np.argsort(light, kind="stable")
    near = np.empty_like(size)
    near[order] = median_filter(size[order], max(LIKE, len(size) // 4), mode="nearest")
    spread, usual = float(np.median(size)), float(np.median(np.abs(light)))
    most = spread * np.maximum(1.0, np.abs(light) / max(usual, 1e-300))
    return np.asarray(1.4826 * np.clip(near, spread, most))


def _robust_step(linear: _Linear, light: Array, room: tuple[Array, Array]) -> tuple[Array, Array]:
    """Step of least |J step + residual| within ``room``, and the weights of the residuals it was found with.

    What the linear model leaves of a residual says whether that pixel changed its shape, shadow or field: weights are
    Geman and McClure's for leftovers beyond ``OUTLIER`` robust standard deviations, found by reweighting. A leftover
    below what the step changes the pixel by is no jump but a curve, also where most others fit to the last digit.
    Directions that the Jacobian does not determine are held by a small damping.
    """
    from scipy.optimize import lsq_linear

    jacobian, residual = linear.jacobian, linear.residual
    size = np.sqrt((jacobian**2).sum(axis=0))
    held = DAMPING * np.diag(np.where(size > 0.0, size, max(float(size.max()), 1.0)))
    weight, felt = np.ones(len(residual)), linear.felt()
    for _ in range(12):
        root = np.sqrt(weight)
        rows = np.concatenate([root[:, None] * jacobian, held])
        wanted = np.concatenate([-root * residual, np.zeros(len(held))])
        step = np.linalg.lstsq(rows, wanted, rcond=None)[0]
        changed = jacobian @ step
        left = changed + residual
        if (step < room[0]).any() or (step > room[1]).any():
            step = lsq_linear(rows, wanted, bounds=room, method="bvls").x
            # what a parameter beyond its range would explain is no jump
            inside = jacobian @ step + residual
            left = np.where(np.abs(left) < np.abs(inside), left, inside)
        usual = np.abs(changed)
        if felt.any():
            usual[felt] = np.maximum(usual[felt], OUTLIER * _spreads(left[felt], light[felt]))
        weight = (1.0 + np.minimum(np.abs(left) / np.maximum(usual, 1e-300), 1e100) ** 2) ** -2
    return step, weight
