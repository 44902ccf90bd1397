"""The claims of the chapter this one grew from, each worked out anew on the scene it describes."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any, Final

import numpy as np

from symrender.chapter.document.effort import Effort
from symrender.chapter.document.figures import Figure, Measured, figures_of
from symrender.images.image import Image
from symrender.jit.records import copied
from symrender.ledger.lobe_widths import lobe_widths
from symrender.probe import probe
from symrender.quadrature.strata import rings, rule
from symrender.render import render
from symrender.runtimes import numba
from symrender.runtimes.image import trace
from symrender.scene import arrays as at
from symrender.scene.arrays import Array, SceneArrays, scene_arrays
from symrender.scene.load import load
from symrender.scene.scene import Scene
from symrender.studies.lobe_rays import LobeRays

LOBES_OFF: Final = {"spheres.A.lobe.weight": 0.0, "spheres.B.lobe.weight": 0.0}
"""The chapter's scene with the lobe of its floor alone."""
_COUNTED: Final = 64
_SWEEP: Final = (0.35, -0.62)
"""The point of a sweep, y in half-widths of the window."""
_GRAZING: Final = (0.9, -0.35)
_HEIGHTS: Final = (30, 20, 10)
_LOW: Final = 1.3
"""Distance from the axis of the floor points looked at from low."""
_SEEDS: Final = (7, 99, 1, 2, 3, 4, 5, 6)
_NEEDLE: Final = 4096.0
_CONE: Final = math.radians(0.5)
_FED: Final[dict[str, Any]] = {"partition": "equal_weight", "nodes": "barycentre"}
_MIRRORED: Final = 128


def measure(effort: Effort) -> Measured:
    """Figures ``claims.*``."""
    scene = load("chapter8").replace(LOBES_OFF)
    half, eye = float(scene.camera.window_half), float(scene.camera.eye[2])  # type: ignore[union-attr]
    exponent, theta_max = 16.0, math.pi / 3
    corner = math.atan(math.hypot(half, (1 + 0.15) * half) / eye)
    figures: dict[str, Figure] = figures_of(
        "claims",
        "arithmetic on the scene's constants",
        sweep=math.hypot(_SWEEP[0], _SWEEP[1] * half),
        grazing=math.hypot(*_GRAZING),
        visible=eye / math.sqrt(eye * eye - 1.0),
        corner=corner,
        reach=corner + theta_max,
    )
    figures |= _classes(scene, half)
    figures |= _smudge(scene, effort)
    figures |= _buried(scene_arrays(scene))
    figures |= _weights(scene, effort.errata)
    widths = lobe_widths("floor", exponent, theta_max)
    figures |= figures_of(
        "claims", "exact moments of cos^n within the cone, n = 16", ruler=widths.chapter_ruler, sigma=widths.sigma,
        rms=widths.rms_angle, axis=_axis_width(exponent, theta_max),
    )  # fmt: skip
    figures |= _slider(effort) | _speckle(effort) | _highlights(scene, effort) | _spheres(effort) | _anchor(scene)
    figures |= _at_an_edge() | _units(exponent)
    return Measured(figures)


def _axis_width(exponent: float, theta_max: float) -> float:
    """RMS of one component of the direction across the mirror ray: sqrt of half the lobe's mean of sin^2 theta."""
    u, c = exponent + 1.0, math.cos(theta_max)
    mean_square_cosine = u / (u + 2.0) * (1.0 - c ** (u + 2.0)) / (1.0 - c**u)
    return math.sqrt((1.0 - mean_square_cosine) / 2.0)


def _classes(scene: Scene, half: float) -> dict[str, Figure]:
    """Pixels by what their ray meets, with the constant term of the second sphere's test as printed and as it is.

    A ray from the eye E along d meets the sphere (C, r) where |E + t d - C| = r, whose constant term is
    |E - C|^2 - r^2; printed was |C|^2 - r^2.
    """
    eye = np.array(scene.camera.eye)
    n = _COUNTED
    steps = half * ((2.0 * np.arange(n) + 1.0) / n - 1.0)
    x, y = np.meshgrid(steps, -steps - 0.15 * half)
    rays = np.stack([x - eye[0], y - eye[1], np.full_like(x, -eye[2])], axis=-1)
    found: dict[str, int] = {}
    for name, wrong in (("printed", True), ("true", False)):
        near = [np.ones_like(x)]
        for k, sphere in enumerate(scene.spheres):
            center = np.array(sphere.center)
            constant = center if wrong and k == 1 else eye - center
            a, b = (rays**2).sum(axis=-1), rays @ (eye - center)
            square = b * b - a * (constant @ constant - sphere.radius**2)
            root = (-b - np.sqrt(np.maximum(square, 0.0))) / a
            near.append(np.where(square >= 0.0, root, np.inf))
        which = np.argmin(near, axis=0)
        found |= {f"{what}_{name}": int((which == k).sum()) for k, what in enumerate(("floor", "a", "b"))}
    source = f"scene chapter8, {n} x {n} primary rays"
    return figures_of("claims", source, counted=n * n, **found)


def _smudge(scene: Scene, effort: Effort) -> dict[str, Figure]:
    """The brightest gloss, and how far the two renderers are apart with the lobe and without it."""
    image = render(scene, size=2 * effort.errata, numeric="none", lobe=48, aa="none").symbolic
    assert image is not None
    brightest = float(image.layer("gloss").max())
    apart: dict[float, list[float]] = {}
    for weight in (0.3, 0.0):
        held = scene.replace({"floor.lobe.weight": weight})
        strata = _pictured(held, effort.errata, numeric="none", lobe=4)
        apart[weight] = []
        for seed in _SEEDS:
            sampled = _pictured(held, effort.errata, symbolic="none", lobe=4, disk="exact", seed=seed)
            apart[weight].append(_rms(sampled.radiance - strata.radiance))
    changed = max(abs(a - b) for a, b in zip(apart[0.3], apart[0.0], strict=True))
    source = f"scene chapter8 without the spheres' lobes, {effort.errata} x {effort.errata}, seeds {_SEEDS}"
    return figures_of(
        "claims", source, brightest=brightest, least_apart=min(apart[0.3]), most_apart=max(apart[0.3]),
        lobe_apart=changed, seeds=len(_SEEDS),
    )  # fmt: skip


def _pictured(scene: Scene, size: int, **how: Any) -> Image:
    """The one image that ``how`` asks for, without antialiasing."""
    made = render(scene, size=size, aa="none", **how)
    image = made.numeric or made.symbolic
    assert image is not None
    return image


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))


def _slider(effort: Effort) -> dict[str, Figure]:
    """RMS difference of the two estimators in `gloss` as the exponent rises alone, and with the cone narrowed too."""
    values = {}
    for name, exponent, theta_max in (
        ("slider_start", 256.0, math.pi / 3), ("slider_end", _NEEDLE, math.pi / 3), ("slider_narrow", _NEEDLE, _CONE)
    ):  # fmt: skip
        scene = load("gloss").replace({"floor.lobe.exponent": exponent, "floor.lobe.theta_max": theta_max})
        pair = [_pictured(scene, effort.errata, lobe=4, **{side: "none"}) for side in ("numeric", "symbolic")]
        values[name] = _rms(pair[0].radiance - pair[1].radiance)
    source = f"scene gloss, {effort.errata} x {effort.errata}, four by four directions, jittered against equal angles"
    return figures_of("claims", source, needle=_NEEDLE, cone=_CONE, **values)


def _speckle(effort: Effort) -> dict[str, Figure]:
    """Spread of the floor's gloss over seeds, by the exponent of its lobe: RMS difference of two seeds / sqrt(2)."""
    values = {}
    for kind in ("jittered", "importance"):
        for word, exponent in (("wide", 1.0), ("middle", 16.0), ("needle", _NEEDLE)):
            scene = load("gloss").replace({"floor.lobe.exponent": exponent})
            pair = [_pictured(scene, effort.errata, lobe=4, symbolic="none", numeric=kind, seed=s) for s in (7, 99)]
            floor = pair[0].layer("hit_class") == at.FLOOR
            values[f"{kind}_{word}"] = _rms((pair[0].layer("gloss") - pair[1].layer("gloss"))[floor]) / math.sqrt(2.0)
    source = f"floor of gloss, {effort.errata} x {effort.errata}, four by four directions, seeds 7 and 99"
    return figures_of("claims", source, **values)


def _highlights(scene: Scene, effort: Effort) -> dict[str, Figure]:
    """What two habits of the printed shading do to the floor's gloss: whose view a highlight uses, and its terminator.

    The scene is shaded as printed; each is corrected in turn.
    """
    gloss = {}
    for view in ("eye", "ray"):
        for end in ("open", "cut"):
            shaded = scene.replace({"shading.highlight_view": view, "shading.specular_terminator": end})
            image = _pictured(shaded, effort.errata, numeric="none", lobe=32, **_FED)
            gloss[view, end] = image.layer("gloss")[image.layer("hit_class") == at.FLOOR]
    return figures_of(
        "claims",
        f"floor of chapter8, {effort.errata} x {effort.errata}, 32 by 32 strata of equal weight",
        toward_camera=_rms(gloss["ray", "open"]) / _rms(gloss["eye", "open"]) - 1.0,
        beyond_terminator=_rms(gloss["ray", "open"]) / _rms(gloss["ray", "cut"]) - 1.0,
    )


def _spheres(effort: Effort) -> dict[str, Figure]:
    """The spheres' own reflection, which the text has at weight .05 and the printed program never computes."""
    image = _pictured(load("chapter8"), effort.errata, numeric="none", lobe=8, **_FED)
    sphere = image.layer("hit_class") > at.FLOOR
    kiss = (image.radiance - image.layer("direct"))[sphere]
    source = f"scene chapter8, {effort.errata} x {effort.errata}"
    return figures_of("claims", source, kiss=_rms(kiss), kissed=int(sphere.sum()))


def _anchor(scene: Scene) -> dict[str, Figure]:
    """The brightest mirror image in the floor of the chapter's scene, which its regression compares with zero."""
    image = _pictured(scene.replace({"floor.lobe.mirror": True}), _MIRRORED, numeric="none", lobe=1)
    floor = image.layer("hit_class") == at.FLOOR
    mirrored = float(image.layer("gloss")[floor].max())
    source = f"scene chapter8, {_MIRRORED} x {_MIRRORED}, the printed regression's size"
    return figures_of("claims", source, mirrored=mirrored, mirrored_pixels=int(floor.sum()))


def _at_an_edge() -> dict[str, Figure]:
    """Gloss of a sphere of radiance one whose silhouette the mirror ray touches: half of the jump, whatever n."""
    # mirrored in the floor the eye stands below it; the sphere's centre lies off that line by its radius
    place, eye, radius = np.zeros(3), np.array([0.0, -4.0, 2.0]), 0.5
    mirror = (place - eye) * (1.0, 1.0, -1.0)
    center = 2.0 * mirror / np.linalg.norm(mirror) + np.array([radius, 0.0, 0.0])
    found = {}
    for word, exponent in (("edge", 1e4), ("edge_late", 1e8)):
        held = load(
            {
                "name": "edge",
                "camera": {"type": "look_at", "eye": eye.tolist(), "target": place.tolist(), "fov": 20},
                "spheres": [{"name": "A", "center": center.tolist(), "radius": radius}],
                "floor": {"texture": {"type": "solid"}, "lobe": {"weight": 1, "exponent": exponent}},
                "ambient": [1, 1, 1],
                "shading": {"ka": 1, "kd": 0, "ks": 0},
            }
        )
        found[word] = float(probe(held, [place[:2].tolist()], tol=1e-9).gloss[0, 0])
    source = "a sphere of radiance one, its silhouette on the mirror ray, split rule at 1e-9"
    return figures_of("claims", source, edge_n=1e4, edge_late_n=1e8, **found)


def _units(exponent: float) -> dict[str, Figure]:
    """What a white world returns along the normal when (n + 2) / (2 pi) multiplies the lobe, and when it divides it."""
    factor = (exponent + 2.0) / (2.0 * math.pi)
    bare = brdf_albedo(exponent, 0.0) / factor
    return figures_of("claims", "albedo at normal incidence, n = 16", multiplied=factor * bare, divided=bare / factor)


def _buried(arrays: SceneArrays) -> dict[str, Figure]:
    """Share of a lobe's light that comes from below the floor when nothing stops it there, by height of the view.

    Below, the printed program has no floor at all: neither rays nor light are stopped by it.
    """
    floorless = replace(arrays, floor=copied(arrays.floor))
    floorless.floor.present = 0.0
    formulas: Any = numba.plain(numba.image_text())
    lobe = rule(rings(formulas, 16.0, math.pi / 3, 64), sectors=64, normalised=False)
    rays = LobeRays(arrays, 2)
    normal = np.array([0.0, 0.0, 1.0])
    values = {}
    for height in _HEIGHTS:
        kept, buried = np.zeros(3), np.zeros(3)
        for turn in (0.0, 45.0, 90.0):
            out = np.array([math.cos(math.radians(turn)), math.sin(math.radians(turn)), 0.0])
            rise = math.radians(height)
            incoming = -math.cos(rise) * out - math.sin(rise) * normal
            world = lobe.directions @ rays.frame(incoming, normal)
            kept += lobe.weights @ rays.see(_LOW * out, normal, at.FLOOR, world).radiance
            below = world @ normal <= 0.0
            start = np.broadcast_to(_LOW * out, (int(below.sum()), 3))
            buried += lobe.weights[below] @ trace(floorless, start, world[below], at.NOTHING)[0]
        values[f"buried_{height}"] = float(buried.sum() / (kept + buried).sum())
    return figures_of(
        "claims", f"scene chapter8, floor points {_LOW} from the axis, three azimuths, eye overhead", **values
    )


def _weights(scene: Scene, width: int) -> dict[str, Figure]:
    source = f"scene chapter8, {width} x {width}, RMS against 96 x 96 strata of equal weight"
    values = {
        f"{kind}_{word}": error
        for word, (_, *errors) in zip(("two", "four", "eight"), strata_errors(scene, width), strict=True)
        for kind, error in zip(("exact", "midpoint"), errors, strict=True)
    }
    return figures_of("claims", source, **values)


def strata_errors(scene: Scene, width: int) -> list[tuple[int, float, float]]:
    """K and the RMS errors of exact and midpoint weights over the picture, against 96 x 96 strata of equal weight."""

    def picture(**how: Any) -> Array:
        made = render(scene, size=width, numeric="none", aa="none", **how).symbolic
        assert made is not None
        return made.radiance

    truth = picture(lobe=96, partition="equal_weight", nodes="barycentre")

    def error(k: int, weights: str) -> float:
        return float(np.sqrt(((picture(lobe=k, weights=weights) - truth) ** 2).mean()))

    return [(k, error(k, "exact"), error(k, "midpoint")) for k in (2, 4, 8)]


def brdf_albedo(n: float, degrees: float) -> float:
    """int (n+2)/(2 pi) cos^n theta max(0, w.N) dw about a mirror direction ``degrees`` off the normal."""
    cosine = (np.arange(2000) + 0.5) / 2000
    phi = 2 * np.pi * (np.arange(360) + 0.5) / 360
    tilt = math.radians(degrees)
    height = cosine[:, None] * math.cos(tilt) + np.sqrt(1 - cosine**2)[:, None] * math.sin(tilt) * np.cos(phi)
    return float((n + 2) * (cosine**n * np.maximum(height, 0).mean(axis=1)).mean())
