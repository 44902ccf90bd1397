"""Single rays of radiometric scenes, to as many digits as double precision holds."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, fields
from typing import Any, Protocol, TypeVar

import numpy as np
import numpy.typing as npt

from symrender.errors import OptionError, Unsupported
from symrender.execution.finite import hit_names
from symrender.ledger.tables import html_table
from symrender.runtimes.radiometric import Sent, check, ray_answers
from symrender.runtimes.ray_slopes import SentSlopes, ray_slopes
from symrender.scene.radiometric.arrays import radiometric_arrays
from symrender.scene.radiometric.moves import radiometric_moves
from symrender.scene.radiometric.scene import RadiometricScene
from symrender.settings import BUDGET
from symrender.truth import STATUS

Array = npt.NDArray[np.float64]
Rays = tuple[npt.ArrayLike, npt.ArrayLike]
"""Origins and directions, (N, 3) each or (3,)."""
T = TypeVar("T")


class Batches(Protocol):
    """Runs a function on parts of so many rays, in any order and thread; returns what it gave, in order of the rays."""

    def __call__(self, run: Callable[[slice], T], count: int, /) -> list[T]:
        """What ``run`` gave."""
        ...


def at_once(run: Callable[[slice], T], count: int) -> list[T]:
    """All rays in one part."""
    return [run(slice(0, count))]


@dataclass(frozen=True)
class RayProbe:
    """Radiance along N rays, W/(m2 sr).

    Attributes
    ----------
    radiance : ndarray
        ``emitted`` + ``direct`` + ``indirect``, (N, 3).
    emitted, direct, indirect : ndarray
        The parts of the radiance, (N, 3).
    error : ndarray
        Estimated largest absolute error over the channels, (N,).
    status : ndarray
        0 met, 1 capped, 2 near-tangent, 3 unsupported, (N,).
    shape : tuple of str
        Name of the shape hit, or ``"nothing"``.
    evaluations : ndarray
        Rays and shaded hits, (N,).
    gradient : mapping of str to ndarray
        Derivative of ``radiance`` by each parameter, (N, 3).
    gradient_error : mapping of str to ndarray
        Estimated largest absolute error of a derivative, (N,).
    gradient_status : mapping of str to ndarray
        As ``status``; 4 where the derivative differs between both sides of the value.
    """

    radiance: Array
    emitted: Array
    direct: Array
    indirect: Array
    error: Array
    status: npt.NDArray[np.int64]
    shape: tuple[str, ...]
    evaluations: npt.NDArray[np.int64]
    convention: str = "radiometric"
    gradient: Mapping[str, Array] = field(default_factory=dict)
    gradient_error: Mapping[str, Array] = field(default_factory=dict)
    gradient_status: Mapping[str, npt.NDArray[np.int64]] = field(default_factory=dict)

    def _repr_html_(self) -> str:
        rows: list[tuple[str, ...]] = [("ray", "shape", "red", "green", "blue", "error", "status")]
        rows += [
            (str(k), name, *(f"{x:.12g}" for x in radiance), f"{error:.1g}", STATUS[int(status)])
            for k, (name, radiance, error, status) in enumerate(
                zip(self.shape, self.radiance, self.error, self.status, strict=True)
            )
        ]
        return html_table(rows, "radiance, W/(m2 sr)")


def probe_rays(
    scene: RadiometricScene, given: Rays, tol: float, budget: int = BUDGET, in_batches: Batches = at_once,
    wrt: Sequence[str] = (),
) -> RayProbe:  # fmt: skip
    """What comes back along rays ``(origins, directions)`` of any length, each to ``tol``, absolute.

    ``in_batches`` runs the rays, part by part, and returns the parts in order. ``wrt`` names numbers of the scene to
    differentiate by; rays stand still, whatever the camera does.
    Raises OptionError for rays that are no rays and Unsupported for what is not yet integrated.
    """
    origins, directions = _checked(given)
    arrays = radiometric_arrays(scene)
    check(arrays)
    if arrays.exposure.moves:
        raise Unsupported("shutter: single rays are answered at an instant; probe a scene with shutter: [t, t]")
    moved = radiometric_moves(scene, wrt) if wrt else ()
    slopes_of = ray_slopes(arrays, moved, tol, budget) if moved else None
    # a part without rays stands in for none
    answer = ray_answers(arrays, tol, budget)
    parts = [answer(origins[:0], directions[:0])]
    parts += in_batches(lambda part: answer(origins[part], directions[part]), len(origins))
    sent = Sent(*(np.concatenate([getattr(part, each.name) for part in parts]) for each in fields(Sent)))
    names = hit_names(scene)
    shapes = tuple(names[int(hit)] for hit in sent.hit_class)
    radiance = sent.emitted + sent.direct + sent.indirect
    by_name: list[dict[str, Any]] = [{}, {}, {}]
    if slopes_of is not None:
        found = [slopes_of(origins[:0], directions[:0])]
        found += in_batches(lambda part: slopes_of(origins[part], directions[part]), len(origins))
        tables = (np.concatenate([getattr(part, each.name) for part in found], axis=1) for each in fields(SentSlopes))
        by_name = [dict(zip((name for name, _ in moved), table, strict=True)) for table in tables]
    return RayProbe(
        radiance, sent.emitted, sent.direct, sent.indirect, sent.error, sent.status, shapes, sent.evaluations,
        "radiometric", *by_name,
    )  # fmt: skip


def _checked(given: Rays) -> tuple[Array, Array]:
    if not isinstance(given, Sequence) or len(given) != 2:
        raise OptionError("rays: must be (origins, directions)")
    origins, directions = (np.atleast_2d(np.array(part, dtype=np.float64)) for part in given)
    if origins.ndim != 2 or origins.shape[1] != 3 or directions.ndim != 2 or directions.shape[1] != 3:
        raise OptionError(f"rays: origins and directions must be (N, 3), got {origins.shape} and {directions.shape}")
    origins, directions = np.broadcast_arrays(origins, directions)
    if not (np.isfinite(origins).all() and np.isfinite(directions).all()):
        raise OptionError("rays: origins and directions must be finite")
    largest = np.abs(directions).max(axis=1, initial=0.0, keepdims=True)
    if (largest == 0).any():
        raise OptionError(f"rays: direction {int(np.argmin(largest))} is zero")
    unit = directions / largest
    unit /= np.sqrt((unit * unit).sum(axis=1, keepdims=True))
    return np.ascontiguousarray(origins), np.ascontiguousarray(unit)
