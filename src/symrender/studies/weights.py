"""Weights: exact against midpoint, and midpoint against barycentre nodes, where walls cross the lobe and where not."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

from symrender.errors import OptionError
from symrender.quadrature.strata import rings
from symrender.runtimes import numba
from symrender.scene.scene import Scene
from symrender.settings import Partition
from symrender.studies.report import Cell, Study, Table
from symrender.studies.subject import Reference, Subject, Surface, facts, relative_reference, subject

_RULES: Final[tuple[tuple[str, dict[str, Any]], ...]] = (
    ("exact", {"weights": "exact"}),
    ("midpoint", {"weights": "midpoint"}),
    ("midpoint, normalised", {"weights": "midpoint", "normalised": True}),
    ("exact, barycentre", {"weights": "exact", "nodes": "barycentre"}),
)
_TRUTHS: Final = (1e-6, 1e-10)


def weights(
    scene: Scene | str | Path | Mapping[str, Any] = "gloss",
    *,
    size: int | tuple[int, int] = 48,
    lobes: Sequence[int] = (2, 4, 8, 16, 32),
    surface: Surface = "floor",
    partition: Partition = "equal_angle",
    disk: str = "2x2",
) -> Study:
    """Compare exact with midpoint weights of strata.

    Parameters
    ----------
    scene : str, path, mapping or scene
        A scene in units of the series.
    size : int or (int, int)
        Width and height in pixels; a single number is a square.
    lobes : sequence of int
        K of the K x K strata.
    surface : {"floor", "all"}
        Whose lobes are judged.
    partition : {"equal_angle", "equal_solid_angle", "equal_weight"}
        How the lobe is divided into rings.
    disk : str
        ``"KxK"`` replaces a disk light by K x K points.

    Returns
    -------
    Study
        Tables for the scene and for a smooth one without discontinuities in its lobes.

    Raises
    ------
    OptionError
        An option is out of range, or the scene has nothing to measure.
    """
    if not lobes:
        raise OptionError("lobes: must hold at least one K, got none")
    crossed = subject(scene, size=size, surface=surface, disk=disk)
    smooth = subject(smooth_scene(_exponent(crossed)), size=size, surface="floor", disk=disk)
    truths = [relative_reference(of, tol) for of, tol in zip((crossed, smooth), _TRUTHS, strict=True)]
    tables = (
        _table("walls cross the lobe", crossed, truths[0], lobes, partition),
        _table("no wall crosses the lobe", smooth, truths[1], lobes, partition),
    )
    crossings = [float(truth.layers["crossings"][truth.mask].mean()) for truth in truths]
    return Study(
        "weights",
        facts(crossed, truths[0])
        | {
            "partition": partition,
            "walls met a lobe": crossings[0],
            "smooth scene, pixels judged": int(truths[1].mask.sum()),
            "smooth scene, signal, RMS": truths[1].signal,
            "smooth scene, truth's own error": truths[1].own / truths[1].signal,
            "smooth scene, walls met a lobe": crossings[1],
        },
        tables,
    )


def smooth_scene(exponent: float) -> dict[str, Any]:
    """A floor before one great solid sphere: every lobe sees nothing but its lit side."""
    return {
        "name": "smooth",
        "camera": {"type": "look_at", "eye": [0, -3, 1], "target": [0, -0.5, 0], "fov": 8},
        "spheres": [{"name": "A", "center": [0, 31, 0], "radius": 30, "color": [0.8, 0.5, 0.3]}],
        "floor": {
            "texture": {"type": "solid", "color": [0.1, 0.1, 0.1]},
            "lobe": {"weight": 1, "exponent": exponent, "theta_max": 0.28},
        },
        "lights": [{"name": "key", "type": "point", "position": [2, -4, 2], "color": [1, 0.9, 0.8]}],
        "shading": {"ka": 0, "kd": 1, "ks": 0},
    }


def _exponent(of: Subject) -> float:
    lobes = [] if of.scene.floor is None or of.scene.floor.lobe is None else [of.scene.floor.lobe]
    lobes += [sphere.lobe for sphere in of.scene.spheres if sphere.lobe is not None]
    return min(lobes[0].exponent, 256.0) if lobes else 16.0


def _lobe(of: Subject) -> tuple[float, float]:
    floor = of.scene.floor
    assert floor is not None and floor.lobe is not None
    return floor.lobe.exponent, floor.lobe.theta_max


def _table(title: str, of: Subject, truth: Reference, lobes: Sequence[int], partition: Partition) -> Table:
    formulas: Any = numba.plain(numba.image_text())
    rows: list[tuple[Cell, ...]] = []
    for k in sorted(lobes):
        errors = [
            truth.judge(of.layers("symbolic", lobe=k, partition=partition, **settings)["gloss"]).relative_rmse
            for _, settings in _RULES
        ]
        sums: list[Cell] = [None, None]
        if of.scene.floor is not None and of.scene.floor.lobe is not None and not of.scene.floor.lobe.mirror:
            exponent, theta_max = _lobe(of)
            for which, kind in enumerate(("exact", "midpoint")):
                ring = rings(formulas, exponent, theta_max, k, weights=kind, partition=partition)  # type: ignore[arg-type]
                sums[which] = math.fsum(ring.weights.tolist()) - 1.0
        rows.append((k, *sums, *errors))
    return Table(
        title,
        ("K", "sum - 1, exact", "sum - 1, midpoint", *(name for name, _ in _RULES)),
        tuple(rows),
        ("relative RMSE of the gloss term; nodes at midpoints unless barycentre; sum - 1: of the floor's weights",),
    )
