"""Who looks, and how: camera, film, filter and integrator of a pbrt file."""

from __future__ import annotations

import math
from typing import Any, Final

import numpy as np

from symrender.scene.pbrt.parameters import Parameters
from symrender.scene.pbrt.transforms import ROUNDING, Transform

ENDLESS: Final = 1_000_000
"""Bounces from which on a scene is taken to have all of them, as the export writes it."""
DEFAULT_SIZE: Final = (1280.0, 720.0)
_WINDOW: Final = ("xresolution", "yresolution")
_MIRROR: Final = (-1.0, 1.0, 1.0)
_SKEWED: Final = "must stand where a look-at camera can: turned and moved only, mirrored once"


def integrator(parameters: Parameters) -> int | str:
    """The bounces of a scene."""
    parameters.must("", parameters.directive.strings[0], "path", "others have other light, or other limits")
    depth = parameters.number("maxdepth", 5.0, "integer")
    why = "what is seen depends on what is thrown away"
    parameters.must("regularize", parameters.word("regularize", "false", "bool"), "false", why)
    parameters.passed("lightsampler")
    parameters.done("maxdepth, regularize and lightsampler")
    if depth in (1.0, 2.0):
        return int(depth) - 1
    if depth < ENDLESS:
        wanted = f"must be 1 (direct light), 2 (one bounce) or {ENDLESS} and more (all)"
        raise parameters.wrong("maxdepth", f"{wanted}, got {depth:.0f}")
    return "all"


def pixel_filter(parameters: Parameters) -> None:
    """Refuse any filter but a box of one pixel."""
    parameters.must("", parameters.directive.strings[0], "box", "values would be means over other pixels too")
    for name in ("xradius", "yradius"):
        parameters.must(name, parameters.number(name, 0.5), 0.5, "a box of one pixel")
    parameters.done("xradius and yradius")


def film(parameters: Parameters) -> tuple[float, float]:
    """Width and height in pixels; refused where numbers of the scene are not those of the image."""
    if parameters.directive.strings[0] not in ("rgb", "gbuffer"):
        parameters.must("", parameters.directive.strings[0], "rgb or gbuffer")
    why = "an image has the numbers of its scene"
    parameters.must("sensor", parameters.word("sensor", "cie1931"), "cie1931", why)
    parameters.must("iso", parameters.number("iso", 100.0), 100.0, why)
    parameters.must("whitebalance", parameters.number("whitebalance", 0.0), 0.0, why)
    width, height = (
        parameters.number(name, default, "integer") for name, default in zip(_WINDOW, DEFAULT_SIZE, strict=True)
    )
    for name, value in zip(_WINDOW, (width, height), strict=True):
        if value < 1.0:
            raise parameters.wrong(name, f"must be at least 1, got {value:g}")
    parameters.passed("filename", "savefp16", "diagonal", "coordinatesystem", "cropwindow", "pixelbounds")
    parameters.done("xresolution, yresolution, filename, sensor and savefp16")
    return width, height


def camera(parameters: Parameters, at: Transform, size: tuple[float, float]) -> dict[str, Any]:
    """The look-at camera that sees the same; ``at`` leads from the world to pbrt's camera."""
    parameters.must("", parameters.directive.strings[0], "perspective")
    parameters.must("lensradius", parameters.number("lensradius", 0.0), 0.0, "a scene has a pinhole")
    opened = parameters.number("shutterclose", 1.0) - parameters.number("shutteropen", 0.0)
    if opened != 1.0:
        where = "shutterclose" if parameters.given("shutterclose") else "shutteropen"
        raise parameters.wrong(where, f"must open the shutter for 1, got {opened:g}: pbrt multiplies light by it")
    parameters.passed("focaldistance")
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
    return {"type": "look_at", "fov": upright, **_stands(parameters, at)}


def _stands(parameters: Parameters, at: Transform) -> dict[str, Any]:
    names = tuple(name for name, _ in at.words)
    if names == ("Scale", "LookAt") and at.words[0][1] == _MIRROR:
        look = at.words[1][1]
        return {"eye": list(look[0:3]), "target": list(look[3:6]), "up": list(look[6:9])}
    back = at.inverse()
    if back is None or at.scale() is None:
        raise parameters.wrong("", _SKEWED)
    if np.linalg.slogdet(at.matrix[:3, :3])[0] > 0.0:
        raise parameters.wrong(
            "", "must stand behind `Scale -1 1 1`: coordinates of pbrt are left-handed, and this image is mirrored"
        )
    scale = back.scale()
    if scale is None:
        raise parameters.wrong("", _SKEWED)
    eye = back.place((0.0, 0.0, 0.0))
    ahead, up = (np.array(back.vector(v)) / scale for v in ((0.0, 0.0, 1.0), (0.0, 1.0, 0.0)))
    reach = max(1.0, math.hypot(*eye))  # a target far enough away to tell the direction in all its digits
    return {"eye": list(eye), "target": [e + reach * float(a) for e, a in zip(eye, ahead, strict=True)],
            "up": [float(u) for u in up]}  # fmt: skip
