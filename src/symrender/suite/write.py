"""The truth suite as files: scenes, truths with their errors, exports, and a list that names all by hash."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import Any, Final

import numpy as np

from symrender.bridge.mitsuba import mitsuba
from symrender.bridge.pbrt import pbrt
from symrender.errors import OptionError, Unsupported
from symrender.gradient import gradient
from symrender.images import exr, npz
from symrender.images.image import Image
from symrender.images.output import check_target, make_folder, write_bytes
from symrender.scene.load import load_any
from symrender.scene.radiometric.scene import RadiometricScene
from symrender.truth import STATUS, truth
from symrender.version import VERSION

MECHANISMS: Final = {
    "cosine": "the cosine of the receiver, zero behind the terminator",
    "epsilon": "where secondary rays start",
    "falloff": "the fall-off of a point light, 1/r^2",
    "fresnel": "reflectance of a conductor, channel by channel, at grazing angles",
    "interreflection": "one bounce between diffuse surfaces",
    "masking": "masking of rough facets",
    "normalisation": "a surface sends back its reflectance and no more",
    "penumbra": "how much of a lamp is seen past what hides it",
    "roughness": "what alpha means",
    "silhouette": "what is in front",
    "sky": "how much of a sky is seen",
    "texture": "coordinates of textures, and which side a field is on",
    "visibility": "shadows",
}
"""What each scene is about."""
SLOPES: Final = {
    "cosine": ("lights.sun.direction.z", "shapes.ball.radius"),
    "epsilon": ("shapes.ball.center.z", "lights.lamp.position.x"),
    "falloff": ("lights.lamp.position.z", "lights.lamp.intensity.g"),
    "fresnel": ("materials.copper.eta.g", "materials.dull.k.r"),
    "masking": ("materials.steel.alpha",),
    "normalisation": ("materials.grey.reflectance.color.g",),
    "penumbra": ("shapes.bulb.radius", "shapes.ball.center.x"),
    "roughness": ("materials.rough.alpha", "materials.satin.alpha", "materials.polished.alpha"),
    "silhouette": ("shapes.between.center.x",),
    "sky": ("shapes.ball.center.z", "shapes.ball.radius"),
    "texture": ("materials.globe.reflectance.bright.r",),
    "visibility": ("lights.left.position.x", "shapes.high.radius"),
}
"""Numbers in which the image of a scene is differentiated; not where light bounces."""
Exporter = Callable[..., Any]
EXPORTERS: Final[dict[str, Exporter]] = {"mitsuba": mitsuba, "pbrt": pbrt}


@dataclass(frozen=True)
class Entry:
    """One scene of the suite: its folder, its truth, and every file by its path within the suite."""

    name: str
    folder: str
    truth: Image
    files: dict[str, bytes]
    told: dict[str, Any]


def mistakes(name: str) -> dict[str, int]:
    """Mistakes planted in a path tracer that the scene shows, and after how many samples a pixel."""
    table = json.loads((resources.files("symrender.suite") / "mistakes.json").read_text("utf-8"))
    return {mistake: by[name] for mistake, by in sorted(table.items()) if name in by}


def scene_of(name: str) -> RadiometricScene:
    """The scene of this name; OptionError lists the names there are."""
    if name not in MECHANISMS:
        raise OptionError(f"scene: must be one of {', '.join(MECHANISMS)}, got {name[:40]!r}")
    text = resources.files("symrender.suite") / "scenes" / f"{name}.yaml"
    with resources.as_file(text) as path:
        loaded = load_any(str(path))
    assert isinstance(loaded, RadiometricScene)
    return loaded


def entry(name: str, *, size: int | tuple[int, int] = 32, tol: float = 1e-8, threads: int = 0) -> Entry:
    """The scene's files: its text, truth in three forms, derivatives, Mitsuba's references, and what renderers read.

    ``truth.npz`` and ``truth.json`` hold float64, ``truth.exr`` float32. The pair is what Mitsuba's own tests compare
    a render with: means, and the variance of these means, which here is the stated error squared.
    """
    scene = scene_of(name)
    image = truth(scene, size=size, tol=tol, threads=threads)
    folder = f"{name}-{scene.hash[:12]}"
    files = {"scene.yaml": image.meta["scene"].encode("utf-8")}
    files["truth.npz"], files["truth.exr"] = npz.encode(image.layers, image.meta), exr.encode(image.layers, image.meta)
    files["truth.json"] = _json(_numbers(image))
    error = np.repeat(image.layers["error"][..., None], 3, axis=2)
    slopes = gradient(scene, SLOPES[name], size=size, tol=tol, threads=threads) if name in SLOPES else {}
    for parameter, slope in slopes.items():
        files[f"derivative/{parameter}.npz"] = npz.encode(slope.layers, slope.meta)
    pair = {"ref_rgb": image.radiance, "ref_rgb_var": error**2}
    files |= {f"{name}_{part}.exr": exr.encode({"radiance": held}, image.meta) for part, held in pair.items()}
    exports: dict[str, str] = {}
    for renderer, exporter in EXPORTERS.items():
        try:
            made = exporter(scene, size=size, rays="centre")
        except Unsupported as refused:
            exports[renderer] = f"refused: {refused}"
            continue
        exports[renderer] = f"{folder}/{renderer}"
        files |= {
            f"{renderer}/{file}": text.encode("utf-8") if isinstance(text, str) else text
            for file, text in made.files.items()
        }
    status = image.layers["status"]
    told = {
        "folder": folder,
        "mechanism": MECHANISMS[name],
        "mistakes_shown_after_samples": mistakes(name),
        "scene_hash": scene.hash,
        "largest_error": float(image.layers["error"].max()),
        "status": {STATUS[k]: int((status == k).sum()) for k in np.unique(status).astype(int).tolist()},
        "rms_radiance": float(np.sqrt((image.radiance**2).mean())),
        "derivatives": {
            parameter: {
                "file": f"{folder}/derivative/{parameter}.npz",
                "rms": float(np.sqrt((slope.radiance**2).mean())),
                "met": int((slope.layers["status"] == 0).sum()),
            }
            for parameter, slope in slopes.items()
        },
        "truth_sha256": hashlib.sha256(files["truth.npz"]).hexdigest(),
        "exports": exports,
    }
    return Entry(name, folder, image, {f"{folder}/{file}": data for file, data in files.items()}, told)


def write_suite(
    into: str | Path,
    names: Iterable[str] = (),
    *,
    size: int | tuple[int, int] = 32,
    tol: float = 1e-8,
    threads: int = 0,
    force: bool = True,
    done: Callable[[Entry], None] | None = None,
) -> tuple[Path, ...]:
    """Write the suite, or the scenes named, into a folder, made if missing; the paths written, ``suite.json`` last.

    The same version writes the same bytes. Every file is made before the first is written. ``done`` hears of each
    scene as it is made. Raises OptionError for a name that is none, OutputError for what cannot be written.
    """
    chosen = sorted(set(names)) or list(MECHANISMS)
    for name in chosen:
        scene_of(name)
    folder = make_folder(into)
    check_target(folder / "suite.json", force=force)
    made: list[Entry] = []
    for name in chosen:
        made.append(entry(name, size=size, tol=tol, threads=threads))
        if done is not None:
            done(made[-1])
    files = {path: data for each in made for path, data in each.files.items()}
    files["suite.json"] = _json(
        {"symrender": VERSION, "tol": tol, "filter": "centre", "scenes": {each.name: each.told for each in made}}
    )
    targets = {folder / path: data for path, data in files.items()}
    for target in targets:
        if target.parent.is_dir():
            check_target(target, force=force)
    for target, data in targets.items():
        make_folder(target.parent)
        write_bytes(target, data, force=force)
    return tuple(targets)


def _numbers(image: Image) -> dict[str, Any]:
    """Radiance and error of every pixel, row 0 on top, and which scene in which units."""
    keys = ("scene_name", "scene_hash", "units", "version")
    return {key: image.meta[key] for key in keys} | {
        "width": image.width,
        "height": image.height,
        "radiance": image.radiance.tolist(),
        "error": image.layers["error"].tolist(),
    }


def _json(value: dict[str, Any]) -> bytes:
    return (json.dumps(value, indent=1, sort_keys=True) + "\n").encode("utf-8")
