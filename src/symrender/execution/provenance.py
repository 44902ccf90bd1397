"""What an image carries of its making, so that it can be made again from the file alone."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict
from typing import NamedTuple

from symrender.execution.jobs import CHANGES_NO_BYTE, Job
from symrender.scene.load import AnyScene
from symrender.scene.radiometric.scene import RadiometricScene
from symrender.scene.radiometric.shapes import Box, Disk, Mesh, Rectangle, Triangle
from symrender.scene.scene import Scene
from symrender.settings import RADII, Filter, Settings
from symrender.version import VERSION


def provenance(job: Job, scene: AnyScene, method: str, estimator: str) -> dict[str, str]:
    """Metadata of the image that ``job`` makes of ``scene``: its text, settings that decide bytes, method, units."""
    settings = job.settings
    decisive = {name: value for name, value in asdict(settings).items() if name not in CHANGES_NO_BYTE}
    return {
        "scene": job.scene,
        "scene_name": scene.name,
        "scene_hash": job.scene_hash,
        "method": method,
        "settings": json.dumps(decisive, sort_keys=True),
        "seed": str(settings.seed),
        "version": VERSION,
        "estimator": estimator,
        **(_conventions(scene, settings) if isinstance(scene, RadiometricScene) else _series(scene)),
    }


class Filtered(NamedTuple):
    """What a pixel of an image is: the mean under a ``filter`` whose support reaches so many pixels to every side."""

    filter: Filter
    reach: float


def filtered(meta: Mapping[str, str]) -> Filtered | None:
    """What the metadata of an image say of its pixels, None of an image that was made elsewhere."""
    if "version" not in meta or "settings" not in meta:
        return None
    said = json.loads(meta["settings"])
    name: Filter = next((known for known in RADII if known == said.get("filter")), "centre")
    return Filtered(name, said.get("filter_radius", 0.0) or RADII[name])


def sent_by(scene: RadiometricScene, settings: Settings) -> str:
    """How the noiseless image of a radiometric scene is made."""
    if scene.camera.aperture > 0.0 or scene.shutter[0] < scene.shutter[1]:
        return "means over lens, shutter and pixel, cut at edges and halved"
    if settings.filter != "centre":
        return "means over pixels cut at their edges"
    if scene.bounces == 0:
        return "closed forms"
    if any(isinstance(shape, Rectangle | Triangle | Disk | Box | Mesh) for shape in scene.shapes):
        return f"closed forms, bounces ({scene.bounces}) gathered from the cells of faces"
    return f"closed forms, one bounce split at the walls, budget {settings.budget}"


def _notes(scene: RadiometricScene) -> dict[str, str]:
    """What of the files of its meshes is not used, by the name of the mesh."""
    return {shape.name: shape.notes for shape in scene.shapes if isinstance(shape, Mesh) and shape.notes}


def _series(scene: Scene) -> dict[str, str]:
    return {"units": "scene radiance, linear RGB", "convention": scene.shading.lobe_units}


def _conventions(scene: RadiometricScene, settings: Settings) -> dict[str, str]:
    """What an image of another renderer must share to be compared with one of ``scene``."""
    said = {
        "bounces": scene.bounces,
        "filter": settings.filter,
        "gloss": scene.gloss,
        **({"filter_radius": settings.reach} if settings.filter not in ("centre", "box") else {}),
        **({"lens": "thin, uniform disk"} if scene.camera.aperture > 0.0 else {}),
        **({"shutter": "open all the time, positions linear"} if scene.shutter[0] < scene.shutter[1] else {}),
        **({"meshes": notes} if (notes := _notes(scene)) else {}),
        "lights": "point intensity/r^2, directional irradiance, sky and area radiance",
        "materials": {
            name: material.model_dump(include={"type", "distribution", "masking", "g1", "two_sided"})
            for name, material in scene.materials.items()
        },
    }
    units = "radiance, W/(m2 sr), linear RGB channel by channel"
    return {"units": units, "convention": "radiometric", "conventions": json.dumps(said, sort_keys=True)}
