"""The pitfalls, each with its number and where it can be its picture."""

from __future__ import annotations

from typing import Any, Final

import numpy as np

from symrender.chapter.document.effort import Effort
from symrender.chapter.document.figures import Figure, Measured, figures_of, merged, real
from symrender.chapter.document.measure.claims import brdf_albedo
from symrender.chapter.document.pictures import strip
from symrender.chapter.document.plots import Curve, linear
from symrender.chapter.document.tables import study_table
from symrender.images.picture import SEQUENTIAL, color_map
from symrender.images.srgb import encode_srgb
from symrender.quadrature.strata import rings, rule
from symrender.runtimes import numba
from symrender.scene import arrays as at
from symrender.scene.arrays import Array
from symrender.studies.pitfalls import pitfalls
from symrender.studies.report import Study
from symrender.studies.subject import Subject, subject
from symrender.studies.timing import timing

_LOBES: Final = (2, 4, 8)
_FINE: Final[dict[str, Any]] = {"partition": "equal_weight", "nodes": "barycentre"}
_GAIN: Final = 2.5
_TILTS: Final = 256
_NEEDLE: Final = 4096.0
_ANGLES: Final = tuple(range(0, 86, 5))
_EXPONENTS: Final = (4.0, 16.0, 64.0)
_TABLES: Final = {
    "horizon": "1.", "crossings": "2.", "starvation": "3.", "ratio": "4.", "scene_ratio": "5.", "clipping": "6."
}  # fmt: skip
_RENAMED: Final = {
    "horizon": {
        "are": "directions below the horizon are",
        "relative RMSE": "relative RMSE",
        "light gained": "light gained",
    }
}


def measure(effort: Effort) -> Measured:
    """Blocks ``pitfalls.*`` (tables and pictures), ``timing.*``, ``units.plot``; figures of the same prefixes."""
    found = pitfalls("grazing", size=effort.study, lobes=_LOBES)
    blocks = {
        f"pitfalls.{name}": study_table(found.table(title), _RENAMED.get(name)) for name, title in _TABLES.items()
    }
    blocks |= {"pitfalls.horizon_picture": _horizon(effort), "pitfalls.needle_picture": _needle(effort)}
    parts = [Measured(_figures(found), blocks), _timing(effort), _units()]
    return merged(parts)


def _figures(found: Study) -> dict[str, Figure]:
    facts = found.facts
    source = f"study pitfalls, {facts['scene']}, {facts['size']}, {facts['pixels judged']} pixels"
    horizon = {str(row[0]): row for row in found.table("1.").rows}
    met = {str(row[0]): row for row in found.table("2.").rows}
    starved = {(str(row[0]), row[1]): row for row in found.table("3.").rows}
    bias, scene, clip = ([list(row) for row in found.table(t).rows] for t in ("4.", "5.", "6."))
    values: dict[str, Any] = {
        "pixels": int(facts["pixels judged"] or 0),
        "signal": real(facts["signal, RMS"]),
        "skipped": real(horizon["skipped"][2]),
        "skipped_error": real(horizon["skipped"][1]),
        "buried": real(horizon["looked along"][2]),
        "median_walls": real(met["crossings"][3]),
        "most_walls": int(real(met["crossings"][4])),
        "crossed": real(met["crossings"][2]),
        "needle": _NEEDLE,
        "directions": int(real(starved["equal_angle", 8][2])),
        "effective": real(starved["equal_angle", 8][3]),
        "starved": real(starved["equal_angle", 8][4]),
        "fed": real(starved["equal_weight", 8][4]),
        "clipped_exposure": real(clip[-1][0]),
        "clipped_pixels": int(real(clip[-1][2])),
        "linear": real(clip[-1][3]),
        "clipped": real(clip[-1][4]),
    }
    for k, row in zip(("two", "four", "eight"), bias, strict=True):
        values |= {f"ratio_{k}": real(row[2]), f"ratio_{k}_error": real(row[3]), f"unbiased_{k}": real(row[4])}
        values[f"unbiased_{k}_error"] = real(row[5])
    values |= {"scene_ratio": real(scene[0][2]), "scene_ratio_error": real(scene[0][3])}
    return figures_of("pitfalls", source, **values)


def _horizon(effort: Effort) -> str:
    """The gloss of a low view with the part of each lobe below the horizon counted as black, and skipped."""
    of = subject("grazing", size=effort.small)
    layers = of.layers("symbolic", lobe=16, **_FINE)
    places = of.places()
    floor = places["hit_class"] == at.FLOOR
    below = _share_below(of)
    tilt = -(places["incoming"] * (0.0, 0.0, 1.0)).sum(axis=2)
    share = np.where(floor, np.interp(tilt, np.linspace(0.0, 1.0, _TILTS), below), 0.0)
    kept = layers["gloss"]
    skipped = kept / np.maximum(1.0 - share, 1e-9)[:, :, None]
    heat = color_map(share, 0.0, 0.5, SEQUENTIAL)
    return strip(
        [
            (
                encode_srgb(kept * _GAIN),
                "counted as black",
                "Gloss of pearls on a floor, dimming far off",
            ),
            (
                encode_srgb(skipped * _GAIN),
                "skipped: too bright",
                "The same, brighter far off",
            ),
            (
                heat,
                "share of the lobe below the floor, violet none, yellow half",
                "Share of each lobe below the horizon",
            ),
        ]
    )


def _share_below(of: Subject) -> Array:
    """Lobe share below the horizon, by the cosine of the mirror direction to the normal from 0 to 1."""
    formulas: Any = numba.plain(numba.image_text())
    floor = of.scene.floor
    assert floor is not None and floor.lobe is not None
    ring = rings(formulas, floor.lobe.exponent, floor.lobe.theta_max, 64, partition="equal_weight", nodes="barycentre")
    lobe = rule(ring, sectors=64, normalised=False)
    cosine = np.linspace(0.0, 1.0, _TILTS)[:, None]
    height = lobe.directions[:, 2] * cosine + lobe.directions[:, 0] * np.sqrt(1.0 - cosine**2)
    below: Array = (height <= 0.0) @ lobe.weights
    return below


def _needle(effort: Effort) -> str:
    of = subject("gloss", size=effort.small).with_changes({"floor.lobe.exponent": _NEEDLE})
    entries = []
    for partition, words in (("equal_angle", "equal angles: starved"), ("equal_weight", "equal weight: fed")):
        made = of.layers("symbolic", lobe=4, partition=partition)["radiance"]
        entries.append((encode_srgb(made), words, f"A nearly sharp reflection by strata of {words}"))
    return strip(entries)


def _timing(effort: Effort) -> Measured:
    found = timing("gloss", size=2 * effort.study, lobes=(2, 4, 8, 16), repeats=effort.repeats)
    ratios = found.table("ratios")
    times = found.table("time against K")
    mine = {(row[0], row[1]): row for row in times.rows}
    exact = "strata, exact weights"
    source = f"study timing, gloss, {found.facts['size']}, processor seconds of one thread"
    figures = figures_of(
        "timing", source,
        ratio=float(ratios.column("exact / midpoint weights")[-1]),
        growth=float(mine[exact, 16][3] or 0) / float(mine[exact, 4][3] or 1),
        work=float(mine[exact, 16][2] or 0) / float(mine[exact, 4][2] or 1),
        each=float(mine[exact, 16][4] or 0),
        numeric=float(mine["jittered", 16][4] or 0),
    )  # fmt: skip
    return Measured(figures, {"timing.table": study_table(times), "timing.ratios": study_table(ratios)})


def _units() -> Measured:
    """Albedo of the normalised lobe with the surface cosine inside, against the angle of the mirror direction."""
    curves = [
        Curve(f"n = {n:g}", [float(a) for a in _ANGLES], [brdf_albedo(n, a) for a in _ANGLES], k, marked=False)
        for k, n in enumerate(_EXPONENTS)
    ]
    curves.append(Curve("lobe average", [0.0, float(_ANGLES[-1])], [1.0, 1.0], 5, dashed=True, marked=False))
    plot = linear(
        "units", curves, x="angle of the mirror direction to the normal, degrees", y="share of a white world returned",
        alt="A white world comes back whole from a lobe average and dimmed by the angle from a normalised BRDF",
    )  # fmt: skip
    values = {f"at_{a}": brdf_albedo(64.0, a) for a in (0, 30, 60, 80)}
    return Measured(figures_of("units", "albedo of the lobe, n = 64, normalised with (n + 2)/(2 pi)", **values),
                    {"units.plot": plot})  # fmt: skip
