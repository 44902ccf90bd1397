"""Camera, film and integrator of a Mitsuba file: who looks, through what filter, and how many reflections."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np

from symrender.scene.mitsuba.properties import Properties, numbers
from symrender.scene.mitsuba.transforms import Array, taken_transform, uniform_scale
from symrender.scene.mitsuba.xml_tree import Element
from symrender.scene.printable import printable

SIZE: Final = (768, 576)
"""Pixels of a film whose size is not said."""
FILTERS: Final = {
    "box": ("box", 0.5), "tent": ("tent", 1.0), "gaussian": ("gaussian", 2.0), "mitchell": ("mitchell", 2.0),
    "catmullrom": ("catmullrom", 2.0), "lanczos": ("lanczos", 3.0),
}  # fmt: skip
"""Reconstruction filters and their radius in pixels."""
_FILMS: Final = ("hdrfilm", "ldrfilm", "tiledhdrfilm", "mfilm", "specfilm")
_SAYS_NOTHING: Final = (
    "pixel_format", "component_format", "file_format", "banner", "gamma", "exposure", "key", "burn", "tonemap_method",
    "attach_log", "high_quality_edges", "sample_border", "compensate", "fixed_pixel_format", "variable", "digits",
    "channel_names", "metadata", "label",
)  # fmt: skip
"""Keys of a film that change no value of an image, or how one is shown alone."""
_DIAGONAL: Final = 43.266615305567875
"""Diagonal of 35 mm film, mm."""
_NESTING: Final = 8
_SAMPLERS: Final = ("path", "direct", "volpath", "volpathmis", "volpath_simple", "prb", "prb_basic", "prbvolpath",
                    "direct_projective", "prb_projective", "bdpt", "pssmlt", "mlt", "erpt", "ptracer",
                    "emission_reparam", "direct_reparam", "prb_reparam", "guided_path")  # fmt: skip
"""Integrators whose mean is the light of all paths up to a length."""
_LIMITS: Final = ("photonmapper", "ppm", "sppm")
"""Integrators whose limit of ever more photons it is."""
_HARMLESS: Final = (
    "rr_depth", "emitter_samples", "bsdf_samples", "shading_samples", "strict_normals", "luminaire_samples",
    "sampling_type", "samples_per_pass", "block_size", "guiding", "light_image", "sample_direct", "russian_roulette",
    "timeout", "direct_samples", "lt_strategy", "bidirectional", "p_large", "two_stage", "luminance_samples",
    "max_dead_ends", "num_chains", "chain_length", "large_step_ratio", "spp_per_pass", "is_gradient",
    "bidirectional_mutation", "lens_perturbation", "multi_chain_perturbation", "caustic_perturbation",
    "manifold_perturbation", "lambda", "prb_scale", "sppc", "sppi", "guiding_mode", "hide_integrator",
    "global_photons", "caustic_photons", "volume_photons", "photon_count", "initial_radius", "alpha", "max_passes",
    "granularity", "lookup_radius", "lookup_size", "glossy_samples", "min_granularity", "caustic_lookup_radius",
    "global_lookup_radius", "volume_lookup_radius", "gather_locally", "auto_cancel_gathering", "nee", "use_nee",
)  # fmt: skip
"""Keys of integrators that change how fast an image converges, not to what."""


@dataclass
class Film:
    """What an image of the file is: its size, filter, and what of it is not done here."""

    width: int = SIZE[0]
    height: int = SIZE[1]
    filter: str = "gaussian"
    filter_radius: float = 2.0
    notes: list[str] = field(default_factory=list)

    def entry(self) -> dict[str, Any]:
        """As plain data of a scene."""
        entry: dict[str, Any] = {"width": self.width, "height": self.height, "filter": self.filter}
        entry["filter_radius"] = self.filter_radius
        return entry | ({"notes": "; ".join(self.notes)} if self.notes else {})


def film(element: Element | None) -> Film:
    """The film of an element, or Mitsuba's own."""
    if element is None:
        return Film()
    properties = Properties(element)
    kind = str(element.attributes.get("type"))
    if kind not in _FILMS:
        raise properties.wrong("must be hdrfilm")
    made = Film(int(properties.number("width", SIZE[0])), int(properties.number("height", SIZE[1])))
    if min(made.width, made.height) < 1:
        raise properties.wrong(f"width and height must be at least 1, got {made.width} and {made.height}")
    filters = properties.parts("rfilter")
    if filters:
        _filter(made, filters[0])
    crop = {name: properties.number(f"crop_{name}", default) for name, default in (
        ("width", made.width), ("height", made.height), ("offset_x", 0.0), ("offset_y", 0.0),
    )}  # fmt: skip
    if (crop["width"], crop["height"]) != (made.width, made.height):
        made.notes.append(
            f"its window of {crop['width']:g} x {crop['height']:g} pixels "
            f"at ({crop['offset_x']:g}, {crop['offset_y']:g}) is not cut out: images here are whole"
        )
    properties.pop(*_SAYS_NOTHING)
    properties.done("width, height, crop window, formats and rfilter")
    return made


def _filter(made: Film, element: Element) -> None:
    properties = Properties(element)
    kind = str(element.attributes.get("type"))
    if kind not in FILTERS:
        raise properties.wrong(f"no such filter here; known are {', '.join(FILTERS)}")
    made.filter, made.filter_radius = FILTERS[kind]
    if kind == "gaussian":
        deviation = properties.number("stddev", 0.5)
        made.filter_radius = 4.0 * deviation
        if deviation != 0.5:
            made.notes.append(f"a gaussian of standard deviation {deviation:g} pixels is not available, 0.5 is")
    elif kind == "lanczos":
        made.filter_radius = properties.number("lobes", 3.0)
    else:
        made.filter_radius = properties.number("radius", made.filter_radius)
    if kind == "mitchell" and (properties.number("B", 1 / 3), properties.number("C", 1 / 3)) != (1 / 3, 1 / 3):
        made.notes.append("mitchell with other B and C than 1/3 is not available")
    if kind in ("catmullrom", "lanczos"):
        made.notes.append(f"a {kind} filter is not available; box, tent, gaussian and mitchell are")
    properties.done("radius, stddev, lobes, B and C")


def camera(element: Element, clip: list[float], outer: Array) -> tuple[dict[str, Any], Film]:
    """The camera of a sensor, and its film; ``clip`` takes its near and far distance.

    ``outer`` becomes a mirroring where its image is mirrored.
    """
    properties = Properties(element)
    kind = element.attributes.get("type")
    if kind not in ("perspective", "thinlens"):
        raise properties.wrong("must be perspective or thinlens")
    films = properties.parts("film")
    made = film(films[0] if films else None)
    properties.parts("sampler")
    if properties.parts("medium"):
        raise properties.wrong("a medium is not supported: light travels in a vacuum here")
    entry: dict[str, Any] = {"type": "look_at", "fov": _fov(properties, made)}
    if kind == "thinlens":
        entry["aperture"] = properties.number("aperture_radius")
        entry["focus"] = properties.number("focus_distance", 0.0)
        if not entry["focus"] > 0.0:
            raise properties.wrong(f"focus_distance must be > 0, got {entry['focus']:g}")
    properties.pop("focus_distance", "id")
    clip[:] = [properties.number("near_clip", 0.01), properties.number("far_clip", 1e4)]
    opened, closed = properties.number("shutter_open", 0.0), properties.number("shutter_close", 0.0)
    for name in ("principal_point_offset_x", "principal_point_offset_y"):
        if properties.number(name, 0.0) != 0.0:
            raise properties.wrong(f"{name} must be 0: a camera here looks through the middle of its image")
    entry |= _stands(properties, outer)
    properties.done("fov, fov_axis, focal_length, to_world, near_clip, far_clip, film and sampler")
    if closed > opened:
        made.notes.append("its shutter shows nothing, as nothing moves")
    return entry, made


def _fov(properties: Properties, made: Film) -> float:
    """The vertical field of view, degrees."""
    wide = made.width / made.height
    length = properties.take("focal_length", "string", "float")
    if length is None and "fov" not in properties.named:
        if "fov_axis" in properties.named:
            raise properties.wrong("needs fov, whose axis fov_axis names")
        millimetres = 50.0
    elif length is not None:
        if "fov" in properties.named:
            raise properties.wrong("fov and focal_length: one of them says how wide it sees")
        (millimetres,) = numbers(length, properties.value(length).strip().removesuffix("mm"), 1)
    else:
        axis = properties.word("fov_axis", "x").lower()
        fov = properties.number("fov")
        if not 0.0 < fov < 180.0:
            raise properties.wrong(f"fov must be between 0 and 180, got {fov:g}")
        across = math.tan(math.radians(fov) / 2.0)
        if axis in ("smaller", "larger"):
            axis = "x" if (wide < 1.0) == (axis == "smaller") else "y"
        shares = {"y": 1.0, "x": wide, "diagonal": math.hypot(1.0, wide)}
        if axis not in shares:
            raise properties.wrong(f"fov_axis must be x, y, diagonal, smaller or larger, got {printable(axis)}")
        return fov if axis == "y" else math.degrees(2.0 * math.atan(across / shares[axis]))
    if not millimetres > 0.0:
        raise properties.wrong(f"focal_length must be > 0, got {millimetres:g}")
    return math.degrees(2.0 * math.atan(0.5 * _DIAGONAL / millimetres / math.hypot(1.0, wide)))


def _stands(properties: Properties, outer: Array) -> dict[str, Any]:
    transform = properties.named.get("to_world")
    matrix = taken_transform(properties)
    if matrix is None:
        return {"eye": [0.0, 0.0, 0.0], "target": [0.0, 0.0, 1.0], "up": [0.0, 1.0, 0.0]}
    parts = transform.children if transform is not None else []
    if len(parts) == 1 and parts[0].tag == "lookat" and "up" in parts[0].attributes:
        given = parts[0].attributes
        pairs = (("eye", "origin"), ("target", "target"), ("up", "up"))
        return {ours: numbers(parts[0], given[theirs], 3) for ours, theirs in pairs}
    scale = uniform_scale(matrix)
    if scale is None:
        raise properties.wrong("to_world must turn and move, and scale alike in all directions", transform)
    if np.linalg.det(matrix[:3, :3]) < 0.0:
        outer[0, 0] = -1.0
        matrix = outer @ matrix
    eye, ahead, up = matrix[:3, 3], matrix[:3, 2] / scale, matrix[:3, 1] / scale
    reach = max(1.0, float(np.linalg.norm(eye)))  # a target far enough away to tell the direction in all its digits
    return {"eye": eye.tolist(), "target": (eye + reach * ahead).tolist(), "up": up.tolist()}


def bounces(element: Element | None, notes: list[str]) -> int | str | None:
    """Reflections beyond the direct light that an integrator follows, None where it shows emission alone."""
    if element is None:
        return "all"
    for _ in range(_NESTING):
        properties = Properties(element)
        kind = str(element.attributes.get("type"))
        inner = properties.parts("integrator")
        inner += [
            properties.named.pop(name) for name, child in list(properties.named.items()) if child.tag == "integrator"
        ]
        if kind in ("moment", "aov", "adaptive", "irrcache", "multichannel"):
            if kind == "irrcache":
                notes.append("irrcache interpolates; what it approximates is computed")
            if kind == "multichannel":
                fields = [each for each in inner if each.attributes.get("type") != "field"]
                inner = fields or inner
            if not inner:
                raise properties.wrong("must hold an integrator that follows light")
            element = inner[0]
            continue
        break
    if kind not in (*_SAMPLERS, *_LIMITS):
        raise properties.wrong("must be path, direct, or another integrator of all light on surfaces")
    if kind in _LIMITS:
        notes.append(f"{kind} is biased; its limit is computed")
    depth = properties.number("max_depth", -1.0)
    if kind.startswith("direct"):
        depth = 2.0
    if properties.flag("hide_emitters", False):
        raise properties.wrong("hide_emitters: what lights is seen here")
    properties.pop(*_HARMLESS)
    if kind != "guided_path":
        # what guides paths changes how noisy an image is
        properties.done("max_depth, rr_depth and hide_emitters")
    if depth == -1.0:
        return "all"
    if depth < 1.0 or depth != int(depth):
        raise properties.wrong(f"max_depth must be -1 (all) or at least 1 (emission), got {depth:g}")
    return int(depth) - 2 if depth > 1.0 else None
