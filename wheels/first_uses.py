"""What people call first, each as small as it can be: between them they reach every kernel that a wheel brings."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Any, Final

from uses import USES

import symrender as sr

_TINY: Final[dict[str, Any]] = {"size": 4, "threads": 1}
_POINT: Final = [(-0.5, -1.5, 0.0)]
_RAY: Final = ([(0.0, -4.0, 1.5)], [(0.0, 0.95, -0.3)])
_ALPHA: Final = "materials.gold05.alpha"


def pair() -> None:
    """Each pipeline by itself, in this process: the conventional tracer and the strata."""
    sr.render("gloss", lobe=1, symbolic="none", **_TINY)
    sr.render("gloss", lobe=1, numeric="none", **_TINY)


def chambers() -> None:
    """Truth, with both disks, with and without the number of chambers."""
    for disk in ("2x2", "exact"):
        sr.truth("chapter8", tol=1e-2, disk=disk, **_TINY)
    sr.truth("chapter8", tol=1e-2, counts=False, **_TINY)
    sr.probe("gloss", _POINT, surface="floor", tol=1e-2)


def slopes() -> None:
    """Derivatives, with both disks; a value beside them takes the kernel of ``chambers``."""
    for disk in ("2x2", "exact"):
        sr.gradient("chapter8", ["spheres.B.radius"], tol=1e-1, disk=disk, **_TINY)


def radiometric() -> None:
    """Scenes in watts and metres: closed forms of images and of single rays, the path tracer, and one bounce."""
    for scene in ("metal", "interreflection"):
        sr.render(scene, **_TINY)
        sr.probe(scene, rays=_RAY)
    sr.truth(sr.load("metal").replace({"bounces": 1}), tol=1e-1, **_TINY)


def faces() -> None:
    """Light between flat faces, with gloss and a mesh among them."""
    for scene in ("cornell_gloss", "mesh"):
        sr.truth(scene, tol=1e-2, **_TINY)


def means() -> None:
    """Means over pixels, lens and shutter, and derivatives of those over pixels."""
    sr.truth("metal", tol=1.0, filter="box", **_TINY)
    sr.truth(sr.load("metal").replace({"camera.aperture": 0.01, "camera.focus": 9.0}), tol=1.0, filter="box", **_TINY)
    sr.gradient("metal", [_ALPHA], tol=1.0, filter="box", **_TINY)


def bumps() -> None:
    """Bumps under filters and a bounce, and a bounce that no faster rule knows."""
    ripples, wall = sr.load("ripples"), {"type": "checker", "cell": 1.0}
    sr.truth(ripples, tol=1.0, filter="box", **_TINY)
    sr.truth(ripples.replace({"bounces": 1}), tol=1.0, **_TINY)
    metal = sr.load("metal").replace({"bounces": 1})
    name = next(shape.material for shape in metal.shapes if shape.type == "plane")
    gold = {"type": "conductor", "alpha": 0.5, "eta": 0.2, "k": 3.9, "reflectance": wall}
    sr.truth(metal.replace({f"materials.{name}": gold}), tol=1.0, **_TINY)


def radiometric_slopes() -> None:
    """Derivatives of images and of single rays, of one bounce too."""
    sr.gradient("metal", [_ALPHA], tol=1e-1, **_TINY)
    sr.probe("metal", rays=_RAY, wrt=[_ALPHA])
    sr.gradient("interreflection", ["materials.sand.reflectance.color.r"], tol=1e-1, **_TINY)


FIRST_USES: Final[dict[str, Callable[[], None]]] = {name: globals()[name] for name in USES}

if __name__ == "__main__":
    FIRST_USES[sys.argv[1]]()
