"""Single values of the lobe integral, to as many digits as double precision holds."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final, TypeVar, overload

import numpy as np
import numpy.typing as npt

from symrender.errors import OptionError, SceneError, Unsupported
from symrender.execution.tiles import run_threads, thread_count
from symrender.ledger.tables import html_table
from symrender.quadrature.split_point import SplitResult, gloss_points
from symrender.scene import arrays as at
from symrender.scene.arrays import SceneArrays, scene_arrays
from symrender.scene.frames import frame_moves, frames
from symrender.scene.load import AnyScene, Source, load_any
from symrender.scene.moves import SceneMoves, moves, scene_moves
from symrender.scene.nearest import did_you_mean
from symrender.scene.radiometric.scene import RadiometricScene
from symrender.scene.scene import Scene
from symrender.scene.shape import Plane, Sphere
from symrender.scene.undecided import check_decided
from symrender.settings import Settings

if TYPE_CHECKING:
    from symrender.certify.enclosure import Enclosure
    from symrender.probe_rays import RayProbe, Rays
    from symrender.quadrature.gloss_gradients import GradientResult

Array = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
_T = TypeVar("_T")
_BATCH: Final = 8
"""Points a thread takes at a time: milliseconds to a fifth of a second."""
_GATHERED: Final = 64
"""Rays whose light is gathered that a thread takes at a time: some hundredths of a second."""
_RAYS: Final = 4096
"""Rays in closed form a thread takes at a time: some milliseconds."""
_VALUES: Final = ("gloss", "error", "evaluations", "status", "chambers", "crossings")
_SLOPES: Final = ("gradient", "error", "status")


@dataclass(frozen=True)
class Probe:
    """Lobe integrals of N points.

    Attributes
    ----------
    gloss : ndarray
        Lobe integral without the lobe's weight, (N, 3), in the units ``convention``.
    error : ndarray
        Estimated largest absolute error over the channels, (N,).
    evaluations, chambers, crossings : ndarray
        Shaded hits, smooth regions and discontinuities met, (N,).
    status : ndarray
        0 met, 1 capped, 2 near-tangent, 3 unsupported (no value), (N,).
    gradient : mapping of str to ndarray
        Derivative of ``gloss`` by each parameter, (N, 3).
    gradient_error : mapping of str to ndarray
        Estimated largest absolute error of a derivative, (N,).
    gradient_status : mapping of str to ndarray
        As ``status``; 4 where the derivative differs between both sides of the value.
    enclosures : tuple of Enclosure
        Proved bounds of every point, if asked for.
    convention : str
        ``lobe_average`` or ``brdf_normalised``.
    """

    gloss: Array
    error: Array
    evaluations: Ints
    status: Ints
    chambers: Ints
    crossings: Ints
    gradient: Mapping[str, Array] = field(default_factory=dict)
    gradient_error: Mapping[str, Array] = field(default_factory=dict)
    gradient_status: Mapping[str, Ints] = field(default_factory=dict)
    enclosures: tuple[Enclosure, ...] = ()
    convention: str = "lobe_average"

    def _repr_html_(self) -> str:
        names = ("met", "capped", "near-tangent", "unsupported")
        rows: list[tuple[str, ...]] = [("point", "red", "green", "blue", "error", "status", "evaluations", "chambers")]
        rows += [
            (str(k), *(f"{x:.12g}" for x in gloss), f"{error:.1g}", names[status], str(spent), str(met))
            for k, (gloss, error, status, spent, met) in enumerate(
                zip(self.gloss, self.error, self.status, self.evaluations, self.chambers, strict=True)
            )
        ]
        return html_table(rows, f"lobe integral, {self.convention}")


@overload
def probe(
    scene: Source, *, rays: Rays, tol: float = 1e-9, budget: int = 1_000_000, wrt: Sequence[str] = (), threads: int = 0
) -> RayProbe: ...


@overload
def probe(
    scene: Source,
    points: npt.ArrayLike,
    *,
    surface: str = "floor",
    tol: float = 1e-9,
    disk: str = "2x2",
    budget: int = 1_000_000,
    wrt: Sequence[str] = (),
    certify: bool = False,
    threads: int = 0,
) -> Probe: ...


def probe(
    scene: Source,
    points: npt.ArrayLike | None = None,
    *,
    rays: Rays | None = None,
    surface: str = "floor",
    tol: float = 1e-9,
    disk: str = "2x2",
    budget: int = 1_000_000,
    wrt: Sequence[str] = (),
    certify: bool = False,
    threads: int = 0,
) -> Probe | RayProbe:
    """Compute single values: lobe integrals at points, or radiance along rays.

    Parameters
    ----------
    scene : str, path, mapping or scene
        Name of a gallery scene, file, dict with the keys of a file, or a loaded scene.
    points : array_like, optional
        Points of a scene in units of the series: (N, 2) or (N, 3) on the floor, (N, 2) in the texture coordinates of a
        plane, or (N, 3) unit outward normals of a sphere. They must face the eye; visibility is not tested.
    rays : (origins, directions), optional
        Rays through a radiometric scene, (N, 3) each, instead of points.
    surface : str
        ``"floor"``, ``"spheres.NAME"`` or ``"planes.NAME"``: the surface of the points.
    tol : float
        Absolute error asked of values and derivatives.
    disk : str
        ``"KxK"`` replaces a disk light by K x K points, ``"exact"`` integrates it (scenes in units of the series).
    budget : int
        Most evaluations for a value; its derivatives together may take four times as many.
    wrt : sequence of str
        Dotted names of real numbers to differentiate by. Floor points and rays stay fixed; a point of a sphere keeps
        its normal.
    certify : bool
        Also enclose each value by ball arithmetic (points of the floor; point lights or ``KxK``).
    threads : int
        Worker threads; 0 takes the processors of this process. The result does not depend on it.

    Returns
    -------
    Probe or RayProbe
        Values with errors and statuses: of points a ``Probe``, of rays a ``RayProbe``.

    Raises
    ------
    SceneError
        The surface has no lobe, or a name is not a real number.
    OptionError
        A point is not on the surface or faces away.
    Unsupported
        The method does not cover the scene.

    See Also
    --------
    truth : An image of such values.

    Notes
    -----
    A lobe average is int f(w) cos^n(theta) dw / int cos^n(theta) dw over the cone about the mirror direction, where f
    is 0 below the horizon. The result of a ray does not depend on the other rays.

    Examples
    --------
    >>> import symrender as sr
    >>> seen = sr.probe("metal", rays=([0, -9.5, 3.1], [0, 9.5, -2.5]))
    >>> int(seen.status[0]), bool(seen.error[0] < 1e-9)
    (0, True)
    """
    if rays is not None:
        return _along(load_any(scene), rays, points, float(tol), budget, wrt, certify, threads)
    loaded, given = _at_points(load_any(scene), points)
    settings = Settings(tol=float(tol), disk=disk, budget=budget, threads=threads)
    arrays = scene_arrays(loaded)
    check_decided(loaded)
    place, normal, hit_class = _places(loaded, given, surface)
    away = place - arrays.camera.eye
    length = np.linalg.norm(away, axis=1, keepdims=True)
    facing = (away * normal).sum(axis=1)
    if not (facing < 0).all():
        k = int(np.argmax(facing >= 0))
        raise OptionError(f"points[{k}]: {tuple(place[k].tolist())} of {surface} does not face the eye")
    surfaces = np.full(len(place), hit_class, dtype=np.int64)

    def values_of(part: slice) -> SplitResult:
        return gloss_points(
            arrays, place[part], normal[part], away[part] / length[part], surfaces[part],
            settings.tol, settings.disk_order, settings.budget,
        )  # fmt: skip

    parts = _in_batches(values_of, len(place), settings.threads)
    gloss, error, *counts = (np.concatenate([getattr(part, name) for part in parts]) for name in _VALUES)
    evaluations, status, chambers, crossings = counts
    values = (gloss, error, evaluations, status, chambers, crossings)
    enclosures = _enclosed(arrays, place, surface, settings) if certify else ()
    if not wrt:
        return Probe(*values, enclosures=enclosures, convention=loaded.shading.lobe_units)
    from symrender.quadrature.gloss_gradients import BUDGET, gloss_gradients, refuse_unknown, slope_scene

    moved = moves(loaded, wrt)
    names = tuple(name for name, _ in moved)
    tangents = scene_moves(arrays, moved)
    refuse_unknown(arrays, tangents, names)
    moving = _place_tangents(arrays, tangents, given, normal, away / length, length, hit_class)

    ready = slope_scene(arrays, tangents, settings.disk_order)

    def slopes_of(part: slice) -> GradientResult:
        here = moving[0][:, part], moving[1][:, part], moving[2][:, part]
        return gloss_gradients(
            ready, place[part], normal[part], away[part] / length[part], surfaces[part], here,
            settings.tol, BUDGET * settings.budget,
        )  # fmt: skip

    slopes = _in_batches(slopes_of, len(place), settings.threads)
    tables = (np.concatenate([getattr(part, name) for part in slopes], axis=1) for name in _SLOPES)
    by_name = [dict(zip(names, table, strict=True)) for table in tables]
    return Probe(*values, by_name[0], by_name[1], by_name[2], enclosures, loaded.shading.lobe_units)


def _enclosed(arrays: SceneArrays, place: Array, surface: str, settings: Settings) -> tuple[Enclosure, ...]:
    """Proved bounds of every point; OptionError where they are not of the floor."""
    from symrender.certify.enclosure import certify

    if surface != "floor":
        raise OptionError("certify: only points of the floor are enclosed")
    return tuple(certify(arrays, p, settings.disk_order, settings.tol) for p in place)


def _at_points(scene: AnyScene, points: npt.ArrayLike | None) -> tuple[Scene, Array]:
    if isinstance(scene, RadiometricScene):
        raise Unsupported(f"points: a radiometric scene ({scene.name}) is probed along rays=(origins, directions)")
    if points is None:
        raise OptionError("points, rays: one of them must be given")
    return scene, np.atleast_2d(np.asarray(points, dtype=np.float64))


def _along(
    scene: AnyScene,
    rays: Rays,
    points: npt.ArrayLike | None,
    tol: float,
    budget: int,
    wrt: Sequence[str],
    certify: bool,
    threads: int,
) -> RayProbe:
    """What ``probe`` says of rays."""
    if not isinstance(scene, RadiometricScene):
        raise Unsupported(f"rays: scenes in units of the series ({scene.name}) are probed at points alone")
    if points is not None:
        raise OptionError("points, rays: only one of them may be given")
    if certify:
        raise Unsupported(f"certify: does not know radiometric scenes yet ({scene.name})")
    Settings(tol=tol, budget=budget, threads=threads)
    flat = any(shape.type not in ("sphere", "plane") for shape in scene.shapes)
    batch = (_GATHERED if flat else _BATCH) if scene.bounces else _RAYS

    def in_batches(run: Callable[[slice], _T], count: int) -> list[_T]:
        return _in_batches(run, count, threads, batch)

    from symrender.probe_rays import probe_rays

    return probe_rays(scene, rays, tol, budget, in_batches, wrt)


def _in_batches(run: Callable[[slice], _T], count: int, threads: int, batch_size: int = _BATCH) -> list[_T]:
    """What ``run`` makes of all points, in order; between batches Ctrl-C is heard."""
    work = [(first, 0, min(first + batch_size, count), 1) for first in range(0, count, batch_size)]
    made: dict[int, _T] = {}

    def batch(first: int, _: int, stop: int, __: int, layers: Mapping[str, Array]) -> int:
        made[first] = run(slice(first, stop))
        return 0

    if len(work) != 1:
        # one thread loads or compiles the kernel; several would each do it
        run(slice(0, 0))
    run_threads(batch, {}, work, thread_count(threads), lambda *_: None)
    return [made[first] for first, *_ in work]


def _place_tangents(
    arrays: SceneArrays, moved: SceneMoves, points: Array, normal: Array, incoming: Array, length: Array, hit_class: int
) -> tuple[Array, Array, Array]:
    """Derivatives (Q, N, 3) of the points, their normals and the directions they are seen along.

    ``points`` are as ``probe`` takes them: those of a sphere or a plane are carried along by it.
    """
    parameters = moved.camera.shape[0]
    place, turned = np.zeros((2, parameters, *normal.shape))
    j, spheres = hit_class - at.FIRST_SPHERE, len(arrays.spheres)
    if 0 <= j < spheres:
        place += moved.spheres["center"][:, j, None] + moved.spheres["radius"][:, j, None, None] * normal
    elif j >= spheres:
        turns = frame_moves(arrays.planes, moved.planes)
        x, y = points[:, :1], points[:, 1:]
        for q in range(parameters):
            turn = turns[q, j - spheres]
            place[q], turned[q] = turn.origin + x * turn.east + y * turn.north, turn.up
    away = place - moved.camera["eye"][:, None]
    along = (away * incoming).sum(axis=-1, keepdims=True)
    return place, turned, (away - along * incoming) / length


def _places(scene: Scene, points: Array, surface: str) -> tuple[Array, Array, int]:
    """Positions, outward normals and hit class of points given as ``probe`` takes them."""
    if not np.isfinite(points).all():
        raise OptionError("points: must be finite numbers")
    if surface == "floor":
        if scene.floor is None or scene.floor.lobe is None:
            raise SceneError("surface: this scene has no floor with a lobe")
        flat = points if points.shape[1] == 3 else np.column_stack([points, np.zeros(len(points))])
        if flat.shape[1] != 3 or (flat[:, 2] != 0).any():
            raise OptionError("points: must be (x, y) or (x, y, 0) on the floor")
        return flat, np.tile([0.0, 0.0, 1.0], (len(flat), 1)), at.FLOOR
    spheres = [f"spheres.{sphere.name}" for sphere in scene.spheres]
    planes = [f"planes.{plane.name}" for plane in scene.planes]
    if surface not in (*spheres, *planes):
        known = ["floor", *spheres, *planes]
        raise SceneError(f"surface: must be one of {', '.join(known)}, got {surface!r}{did_you_mean(surface, known)}")
    which = [*spheres, *planes].index(surface)
    shapes: list[Sphere | Plane] = [*scene.spheres, *scene.planes]
    shape, hit_class = shapes[which], at.FIRST_SPHERE + which
    if shape.lobe is None:
        raise SceneError(f"surface: {surface} has no lobe")
    if isinstance(shape, Plane):
        return *_on_plane(scene, points, surface, planes.index(surface)), hit_class
    if points.shape[1] != 3 or (np.abs(np.linalg.norm(points, axis=1) - 1) > 1e-9).any():
        raise OptionError(f"points: must be unit outward normals of {surface}")
    normals = points / np.linalg.norm(points, axis=1, keepdims=True)
    return np.asarray(shape.center) + shape.radius * normals, normals, hit_class


def _on_plane(scene: Scene, points: Array, surface: str, k: int) -> tuple[Array, Array]:
    """Positions and normals of points given by the coordinates of plane ``k``."""
    if points.shape[1] != 2:
        raise OptionError(f"points: must be (x, y) of the texture of {surface}")
    frame = frames(scene_arrays(scene).planes)[k]
    place = frame.origin + points[:, :1] * frame.east + points[:, 1:] * frame.north
    return place, np.tile(frame.up, (len(points), 1))
