"""What every other renderer is given alike: a scene at its scale, squares for planes, files and their receipt."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, Literal

from symrender.bridge.moved import Triple, extent, half_side, lost, middle, moved, seen_out_to, takes_checker
from symrender.errors import OptionError, Unsupported
from symrender.images.output import check_target, make_folder, write_bytes
from symrender.scene.radiometric.exposure import exposure_of
from symrender.scene.radiometric.materials import Checker, Diffuse
from symrender.scene.radiometric.scene import RadiometricScene
from symrender.scene.radiometric.shapes import Plane
from symrender.settings import image_size
from symrender.version import VERSION

Rays = Literal["box", "centre"]
RAY_OFFSETS: Final[Mapping[str, tuple[float, float]]] = {"mitsuba": (1500.0 * 2.0**-24, 1500.0 * 2.0**-24)}
"""Renderers whose secondary rays start a + b max |p| off a place p: (a, b); Mitsuba's ``Interaction.offset_p``.

pbrt's start as far off as its own bounds of roundings say, which is within the reach of 32 bits.
"""


@dataclass(frozen=True)
class Carried:
    """The files of an exported scene by name, and what is told of them (also in ``receipt.json``)."""

    files: dict[str, str | bytes]
    receipt: dict[str, Any]

    def save(self, folder: str | Path, *, force: bool = True, inputs: Iterable[str | Path] = ()) -> tuple[Path, ...]:
        """Write every file into ``folder``, made if missing; ``OutputError`` where one cannot be written.

        A file among ``inputs`` is never replaced.
        """
        into = make_folder(folder)
        targets = {into / name: text for name, text in self.files.items()}
        for target in targets:
            check_target(target, force=force, inputs=inputs)
        for target, text in targets.items():
            write_bytes(target, text.encode("utf-8") if isinstance(text, str) else text, force=force)
        return tuple(targets)


@dataclass(frozen=True)
class Prepared:
    """A scene to be written: where it was moved to, half a side of the square of each plane, pixels, the receipt."""

    scene: RadiometricScene
    halves: dict[str, float]
    size: tuple[int, int]
    receipt: dict[str, Any]

    def told(self) -> str:
        """The receipt as text."""
        return json.dumps(self.receipt, indent=1, sort_keys=True) + "\n"


def prepare(
    scene: RadiometricScene,
    to: str,
    checked: str,
    *,
    size: int | tuple[int, int],
    samples: int,
    scale: float,
    center: Triple | Literal["middle"],
    rays: Rays,
    reach: float | None,
) -> Prepared:
    """``scene`` moved for the renderer ``to``, whose version ``checked`` its conventions are known of.

    Raises OptionError for an option out of its range, Unsupported for a plane no square can stand for,
    for a checker on other shapes, and for gloss at the first hit alone.
    """
    if not 1 <= samples <= 1 << 30:
        raise OptionError(f"samples: must be from 1 to {1 << 30}, got {samples}")
    if rays not in ("box", "centre"):
        raise OptionError(f"rays: must be box or centre, got {rays!r}")
    glossy = [name for name, material in scene.materials.items() if not isinstance(material, Diffuse)]
    used = [shape.material for shape in scene.shapes if shape.material in glossy]
    if scene.gloss == "first_hit" and scene.bounces != 0 and used:
        raise Unsupported(
            f"gloss: {to}: materials.{used[0]} reflects at every hit there, at the first alone here; with bounces: 0 "
            "both are one, and so are diffuse pixels with a black material in its place"
        )
    exposure = exposure_of(scene)
    if exposure.aperture > 0.0 or exposure.moves:
        what = "camera.aperture" if exposure.aperture > 0.0 else "shutter"
        raise Unsupported(f"{what}: {to}: lenses and motion are not exported yet")
    for shape in scene.shapes:
        if scene.materials[shape.material].bump is not None:
            raise Unsupported(
                f"materials.{shape.material}.bump: {to}: heights there are textures, and a formula is none; without a "
                "bump the scene can be exported"
            )
        textured = isinstance(scene.materials[shape.material].reflectance, Checker)
        if textured and not takes_checker(shape):
            raise Unsupported(
                f"shapes.{shape.name}: {to}: a checker is exported on planes, spheres, cylinders without caps and "
                "rectangles with right angles"
            )
    reach = None if reach is None else float(reach)
    if reach is not None and not 2.0 <= reach <= 1e6:
        raise OptionError(f"reach: must be from 2 to 1e6, got {reach!r}")
    origin = middle(scene) if center == "middle" else center
    there = moved(scene, scale, origin)
    pixels = image_size(size)
    planes = [shape for shape in there.shapes if isinstance(shape, Plane)]
    outs = [seen_out_to(there, plane, pixels, rays == "centre") for plane in planes]
    halves = {plane.name: half_side(there, plane, reach, out) for plane, out in zip(planes, outs, strict=True)}
    receipt = _receipt(to, checked, scene, there, scale, origin, halves, pixels, rays)
    return Prepared(there, halves, pixels, receipt)


def _of_renders(
    to: str, scale: float, origin: Triple, lost: list[float | None], halves: dict[str, float]
) -> dict[str, str]:
    """What the metadata of renders state for an audit: where places are, where secondary rays start, what squares
    lose, and the half side of each."""
    told = {"placed": " ".join(map(repr, (scale, *origin)))}
    if to in RAY_OFFSETS:
        told["ray_offset"] = "{!r} {!r}".format(*RAY_OFFSETS[to])
    if halves:
        told["squares"] = " ".join(f"{name}={half!r}" for name, half in halves.items())
    bounded = [each for each in lost if each is not None]
    if len(bounded) == len(lost):
        told["radiance_lost"] = repr(float(sum(bounded)))
    return told


def _receipt(
    to: str,
    checked: str,
    scene: RadiometricScene,
    there: RadiometricScene,
    scale: float,
    origin: Triple,
    halves: dict[str, float],
    size: tuple[int, int],
    rays: Rays,
) -> dict[str, Any]:
    """What was written, for who judges the image: hashes, what was moved, conventions, and where squares end."""
    planes = {
        shape.name: {
            "half_side": halves[shape.name],
            "within": extent(there, shape.point),
            "radiance_lost_within": lost(there, shape, halves[shape.name]),
        }
        for shape in there.shapes
        if isinstance(shape, Plane)
    }
    return {
        "symrender": VERSION,
        "to": to,
        "checked_against": checked,
        "scene_name": scene.name,
        "scene_hash": scene.hash,
        "written_hash": there.hash,
        "scale": scale,
        "center": list(origin),
        "scaled": "places p are scale (p - center); point intensities are scale^2 times as large, since the irradiance "
        "falls off as 1/r^2; irradiances, radiances and so the image are as they were",
        "width": size[0],
        "height": size[1],
        "rays": rays,
        "bounces": scene.bounces,
        "units": "radiance, W/(m2 sr), linear rgb channel by channel",
        "of_renders": _of_renders(
            to, scale, origin, [plane["radiance_lost_within"] for plane in planes.values()], halves
        ),
        "planes": planes,
        "planes_say": "a square of half a side half_side about the plane's point stands for an endless plane: rays "
        "that meet it further out see nothing; places within `within` of the point, which holds eye, spheres and point "
        "lights, differ by at most radiance_lost_within (null: not bounded)",
    }
