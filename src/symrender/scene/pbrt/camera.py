"""Who looks, and how: camera, film, filter and integrator of a pbrt file."""

from __future__ import annotations

import math
from typing import Any, Final

import numpy as np

from symrender.scene.pbrt.parameters import Parameters
from symrender.scene.pbrt.transforms import ROUNDING, Transform
from symrender.scene.printable import printable

ENDLESS: Final = 1_000_000
"""Bounces from which on a scene is taken to have all of them, as the export writes it."""
DEFAULT_SIZE: Final = (1280.0, 720.0)
_WINDOW: Final = ("xresolution", "yresolution")
DEFAULT_DEPTH: Final = 5
_INTEGRATORS: Final = ("path", "volpath", "bdpt", "mlt", "sppm", "simplepath", "simplevolpath", "lightpath")
"""Integrators whose mean, or limit, is the light of all paths up to a length."""
_HARMLESS: Final = (
    "lightsampler", "sampler", "visualizestrategies", "visualizeweights", "bootstrapsamples", "chains",
    "mutationsperpixel", "largestepprobability", "sigma", "photonsperiteration", "radius", "seed", "samplelights",
    "samplebsdf",
)  # fmt: skip
_FILTERS: Final = {
    "box": ("box", 0.5), "gaussian": ("gaussian", 1.5), "mitchell": ("mitchell", 2.0), "triangle": ("tent", 2.0),
    "sinc": ("lanczos", 4.0),
}  # fmt: skip
"""Reconstruction filters: what they are called here, and their radius in pixels."""
_MIRROR: Final = (-1.0, 1.0, 1.0)
_SKEWED: Final = "must stand where a look-at camera can: turned and moved only, mirrored once"


def integrator(parameters: Parameters | None) -> int | str | None:
    """The bounces of a scene, None for emission alone; pbrt's own integrator where there is none."""
    if parameters is None:
        return DEFAULT_DEPTH - 1
    kind = parameters.directive.strings[0]
    if kind not in _INTEGRATORS:
        known = "path, volpath, bdpt, mlt, sppm, simplepath, simplevolpath or lightpath"
        raise parameters.wrong("", f"must be {known}, got {printable(kind)}: others have other light, or other limits")
    depth = parameters.number("maxdepth", float(DEFAULT_DEPTH), "integer")
    why = "what is seen depends on what is thrown away"
    parameters.must("regularize", parameters.word("regularize", "false", "bool"), "false", why)
    parameters.passed(*_HARMLESS)
    parameters.done("maxdepth, regularize and lightsampler")
    if depth < 0.0:
        raise parameters.wrong("maxdepth", f"must be at least 0, got {depth:g}")
    if depth >= ENDLESS:
        return "all"
    return int(depth) - 1 if depth else None


def pixel_filter(parameters: Parameters | None) -> dict[str, Any]:
    """Filter and radius as fields of a film."""
    kind = parameters.directive.strings[0] if parameters else "gaussian"
    if parameters is None:
        return {"filter": kind, "filter_radius": _FILTERS[kind][1]}
    if kind not in _FILTERS:
        raise parameters.wrong("", f"must be {', '.join(_FILTERS)}, got {printable(kind)}")
    name, own = _FILTERS[kind]
    x, y = (parameters.number(axis, own) for axis in ("xradius", "yradius"))
    parameters.must("yradius", y, x, "a filter reaches as far up as across")
    parameters.passed("B", "C", "tau", "sigma")
    parameters.done("xradius, yradius, sigma, B, C and tau")
    return {"filter": name, "filter_radius": x}


def film(parameters: Parameters | None, notes: dict[str, None]) -> tuple[float, float]:
    """Width and height in pixels; ``notes`` takes by what numbers of the image are not those of the scene."""
    if parameters is None:
        return DEFAULT_SIZE
    if parameters.directive.strings[0] not in ("rgb", "gbuffer", "spectral"):
        parameters.must("", parameters.directive.strings[0], "rgb, gbuffer or spectral")
    sensor, iso = parameters.word("sensor", "cie1931"), parameters.number("iso", 100.0)
    if sensor != "cie1931":
        notes[f"the film sees through the sensor {printable(sensor)}; radiance here is that of the CIE observer"] = None
    if iso != 100.0 or (sensor != "cie1931" and parameters.number("exposuretime", 1.0) != 1.0):
        notes[f"the film multiplies by {iso / 100.0:g} (iso {iso:g}); radiance here is as it arrives"] = None
    if parameters.number("whitebalance", 0.0) != 0.0:
        notes["the film balances its white; radiance here is as it arrives"] = None
    if parameters.given("maxcomponentvalue"):
        notes["the film cuts bright samples; radiance here is not cut"] = None
    if parameters.given("cropwindow") or parameters.given("pixelbounds"):
        notes["its window is not cut out: images here are whole"] = None
    width, height = (
        parameters.number(name, default, "integer") for name, default in zip(_WINDOW, DEFAULT_SIZE, strict=True)
    )
    for name, value in zip(_WINDOW, (width, height), strict=True):
        if value < 1.0:
            raise parameters.wrong(name, f"must be at least 1, got {value:g}")
    parameters.passed("filename", "savefp16", "diagonal", "coordinatesystem", "cropwindow", "pixelbounds",
                      "maxcomponentvalue", "exposuretime", "nbuckets", "lambdamin", "lambdamax")  # fmt: skip
    parameters.done("xresolution, yresolution, filename, sensor and savefp16")
    return width, height


def camera(parameters: Parameters, at: Transform, size: tuple[float, float], notes: dict[str, None]) -> dict[str, Any]:
    """The look-at camera that sees the same; ``at`` leads from the world to pbrt's camera."""
    parameters.must("", parameters.directive.strings[0], "perspective")
    lens = parameters.number("lensradius", 0.0)
    focus = parameters.number("focaldistance", 1e6)
    opened = parameters.number("shutterclose", 1.0) - parameters.number("shutteropen", 0.0)
    if opened != 1.0:
        notes[f"the film multiplies by {opened:g}, the time of its shutter; radiance here is as it arrives"] = None
    wide = parameters.number("frameaspectratio", size[0] / size[1])
    if not wide > 0.0:
        raise parameters.wrong("frameaspectratio", f"must be > 0, got {wide:g}")
    window = parameters.take("screenwindow", "float")
    x, y = (wide, 1.0) if wide > 1.0 else (1.0, 1.0 / wide)
    x0, x1, y0, y1 = window.numbers if window is not None and len(window.numbers) == 4 else (-x, x, -y, y)
    fov = parameters.number("fov", 90.0)
    parameters.done("fov, screenwindow, frameaspectratio and shutter")
    if window is not None and len(window.numbers) != 4:
        raise parameters.wrong("screenwindow", f"must be 4 numbers, got {len(window.numbers)}")
    where = "screenwindow" if window is not None else "frameaspectratio"
    if not (x1 > 0.0 and y1 > 0.0 and x0 == -x1 and y0 == -y1):
        raise parameters.wrong(where, f"must have the view in its middle, got {x0:g} {x1:g} {y0:g} {y1:g}")
    if abs(x1 / y1 - size[0] / size[1]) > ROUNDING * x1 / y1:
        raise parameters.wrong(where, f"must make pixels square, got {x1 / y1:g} for {size[0]:g} x {size[1]:g} pixels")
    if not 0.0 < fov < 180.0:
        raise parameters.wrong("fov", f"must be between 0 and 180, got {fov:g}")
    # pbrt's fov is that of the part of the screen from -1 to 1
    upright = fov if y1 == 1.0 else math.degrees(2.0 * math.atan(y1 * math.tan(math.radians(fov) / 2.0)))
    width = {"aperture": lens, "focus": focus} if lens else {}
    return {"type": "look_at", "fov": upright, **width, **_stands(parameters, at)}


def is_mirrored(at: Transform) -> bool:
    """Whether a camera sees the world mirrored: pbrt's coordinates are left-handed."""
    return bool(np.linalg.slogdet(at.matrix[:3, :3])[0] > 0.0)


def _stands(parameters: Parameters, at: Transform) -> dict[str, Any]:
    names = tuple(name for name, _ in at.words)
    if names == ("Scale", "LookAt") and at.words[0][1] == _MIRROR:
        look = at.words[1][1]
        return {"eye": list(look[0:3]), "target": list(look[3:6]), "up": list(look[6:9])}
    back = at.inverse()
    if back is None or at.scale() is None:
        raise parameters.wrong("", _SKEWED)
    scale = back.scale()
    if scale is None:
        raise parameters.wrong("", _SKEWED)
    eye = back.place((0.0, 0.0, 0.0))
    ahead, up = (np.array(back.vector(v)) / scale for v in ((0.0, 0.0, 1.0), (0.0, 1.0, 0.0)))
    reach = max(1.0, math.hypot(*eye))  # a target far enough away to tell the direction in all its digits
    return {"eye": list(eye), "target": [e + reach * float(a) for e, a in zip(eye, ahead, strict=True)],
            "up": [float(u) for u in up]}  # fmt: skip
