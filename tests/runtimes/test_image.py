"""The symbolic pipeline against the numeric one and against sums written out here."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

import mpmath
import numpy as np
import pytest

from emitted import plain
from runtimes.rays import TOLERANCE, Answers, assert_agree, lobe_rays
from symrender.errors import OptionError
from symrender.expression import intersection
from symrender.expression.vectors import dot, norm2, vec3
from symrender.kernel.assemble import image_program
from symrender.numeric import pipeline as numeric
from symrender.quadrature.disk import light_points
from symrender.runtimes import image as symbolic
from symrender.scene import arrays as at
from symrender.scene import gallery
from symrender.scene.arrays import Array, SceneArrays, lobes_of, scene_arrays
from symrender.scene.load import load
from symrender.scene.scene import Scene
from symrender.settings import Settings
from symrender.targets.numba import emit

SCENES = gallery.names()
Layers = dict[str, Array]


def layers_of(pipeline: Any, scene: Scene, size: int, **options: Any) -> Layers:
    """Every layer of one tile of the whole image, NaN where the kernel left it alone."""
    layers = {name: np.full((size, size, 3), np.nan) for name in ("radiance", "direct", "gloss")}
    layers["hit_class"] = np.full((size, size), np.nan)
    kernel = pipeline.prepare(scene_arrays(scene), Settings(width=size, height=size, **options))
    layers["evaluations"] = np.array(kernel(0, 0, size, size, layers))
    return layers


@pytest.mark.parametrize("name", SCENES)
def test_pipelines_agree_ray_by_ray(name: str) -> None:
    arrays = scene_arrays(load(name))
    rays = lobe_rays(arrays, 20_000, seed=1)
    answers = (trace(arrays, *rays) for trace in (numeric.trace, symbolic.trace))
    assert_agree(*answers, rays=20_000, closed=len(arrays.planes) > 0)


@pytest.mark.parametrize(
    "changes",
    [
        {"shading.model": "phong"},
        {"shading.highlight_view": "eye", "shading.specular_terminator": "open"},
        {"shading.model": "phong", "shading.specular_terminator": "open", "shading.shininess": 0.0},
        {"shading.shininess": 2.5},
        {"floor": None},
        {"spheres.A.center": (0.1, -1.2, 0.3), "spheres.A.radius": 0.9},
        {"spheres.A.texture": {"type": "marble", "ku": 3.0, "kv": 2.0}},
        {"spheres.A.texture": {"type": "checker", "ku": 7.0, "kv": 2.5, "dark": 0.1}},
        {"spheres.A.texture": {"type": "stripes", "ku": 66.0, "dark": 0.1}},
        {"lights.fill.position": (0.1, -1.2, 0.25)},
        {"floor.texture.offset": (0.3, 0.45), "floor.texture.cell": 0.8},
    ],
    ids=lambda changes: ",".join(changes),
)
def test_pipelines_agree_on_every_switch(changes: dict[str, Any]) -> None:
    arrays = scene_arrays(load("gloss").replace(changes))
    rays = lobe_rays(arrays, 8000, seed=2)
    assert_agree(numeric.trace(arrays, *rays), symbolic.trace(arrays, *rays), rays=8000)


def _plain_trace(text: str, arrays: SceneArrays, rays: tuple[Array, Array, Array]) -> Answers:
    """The emitted text run as Python."""
    module = plain(text)
    points = light_points(arrays.lights, 2, module.light_point)
    results = np.empty((len(rays[0]), 5))
    rows = np.concatenate(rays[:2], axis=1)
    shapes = (arrays.spheres, arrays.floor, arrays.planes)
    module.trace(rows, rays[2], arrays.camera.eye, *shapes, points, arrays.shading, results)
    return results[:, :3], results[:, 3], results[:, 4]


def _chapters_discriminant(f: Any, w: Any, radius: Any) -> Any:
    """The source chapter's error: |C|^2 where |E - C|^2 belongs (f = C - P)."""
    return dot(f, w) ** 2 - norm2(f + vec3("p")) + radius**2


def test_a_wrong_discriminant_on_one_side_is_caught(monkeypatch: pytest.MonkeyPatch) -> None:
    arrays = scene_arrays(load("chapter8"))
    rays = lobe_rays(arrays, 400, seed=3)
    expected = numeric.trace(arrays, *rays)
    assert_agree(expected, _plain_trace(emit(image_program()), arrays, rays), rays=400)
    monkeypatch.setattr(intersection, "discriminant", _chapters_discriminant)
    with np.errstate(all="ignore"):
        faulty = _plain_trace(emit(image_program()), arrays, rays)
    with pytest.raises(AssertionError, match="different shapes"):
        assert_agree(expected, faulty, rays=400)


@pytest.mark.parametrize("part", ["radiance", "distance"])
def test_the_comparison_sees_its_own_tolerance(part: str) -> None:
    arrays = scene_arrays(load("gloss"))
    rays = lobe_rays(arrays, 400, seed=3)
    a = symbolic.trace(arrays, *rays)
    b = tuple(values.copy() for values in a)
    worst = int(np.argmax(a[0].sum(axis=1) * (a[1] > 0)))
    if part == "radiance":
        b[0][worst] *= 1 + 1e-10
    else:
        b[2][worst] *= 1 + 1e-9
    with pytest.raises(AssertionError, match="differ"):
        assert_agree(a, (b[0], b[1], b[2]), rays=400)


@pytest.mark.parametrize("aa", ["analytic", "none"])
@pytest.mark.parametrize("name", SCENES)
def test_direct_layers_agree(name: str, aa: str) -> None:
    scene = load(name)
    a, b = (layers_of(pipeline, scene, 64, lobe=1, aa=aa) for pipeline in (numeric, symbolic))
    rms = np.sqrt((a["direct"] ** 2).mean())
    classes = np.unique(a["hit_class"], return_counts=True)
    assert rms > 0.05 and len(classes[0]) >= 3 and classes[1].max() < 4096 * 0.95
    assert (a["hit_class"] == b["hit_class"]).all()
    assert np.abs(a["direct"] - b["direct"]).max() <= TOLERANCE * rms
    assert np.isfinite(b["radiance"]).all()


def test_filtered_floors_differ_from_read_ones() -> None:
    """So that agreement of both settings is agreement about two images."""
    scene = load("gloss")
    filtered, read = (layers_of(symbolic, scene, 64, lobe=1, aa=aa)["direct"] for aa in ("analytic", "none"))
    assert (np.abs(filtered - read).max(axis=2) > 0.01).sum() > 100


def _primary(arrays: SceneArrays, size: int) -> tuple[Array, Array]:
    """Eye and unit directions (size, size, 3) through pixel centres, from the documented camera."""
    c = arrays.camera
    eye = c.eye
    sx = 2 * (np.arange(size) + 0.5) / size - 1
    x, y = np.meshgrid(sx, -sx)
    if c.kind == at.PLANE:
        d = (
            np.stack([c.window_center[0] + c.window_half * x, c.window_center[1] + c.window_half * y, 0 * x], axis=-1)
            - eye
        )
    else:
        forward = (c.target - eye) / np.linalg.norm(c.target - eye)
        right = np.cross(forward, c.up)
        right /= np.linalg.norm(right)
        tangent = math.tan(math.radians(c.fov) / 2)
        d = forward + tangent * (x[..., None] * right + y[..., None] * np.cross(right, forward))
    return eye, d / np.linalg.norm(d, axis=-1)[..., None]


def _strata(n: float, theta_max: float, k: int) -> tuple[Array, Array]:
    """Polar nodes and ring weights of equal angles, summing to one; the integral of cos^n sin in 40 digits."""
    with mpmath.workdps(40):
        edges = [mpmath.cos(mpmath.mpf(theta_max) * i / k) ** (mpmath.mpf(n) + 1) for i in range(k + 1)]
        shares = [float((a - b) / (edges[0] - edges[-1])) for a, b in pairwise(edges)]
    return (np.arange(k) + 0.5) * theta_max / k, np.array(shares)


def direct_sum(scene: Scene, size: int, k: int) -> Layers:
    """Gloss and radiance of a strata image, written out: the numeric pipeline sees, this sums."""
    arrays = scene_arrays(scene)
    eye, d = _primary(arrays, size)
    flat = d.reshape(-1, 3)
    _, shape, distance = numeric.trace(arrays, np.tile(eye, (len(flat), 1)), flat, 0)
    gloss, weight = np.zeros((len(flat), 3)), np.zeros(len(flat))
    lobes = lobes_of(arrays)
    for i in np.nonzero(shape)[0]:
        own = int(shape[i])
        lobe = lobes[own - at.FLOOR]
        p = eye + distance[i] * flat[i]
        if own == at.FLOOR:
            p, normal = p * [1, 1, 0], np.array([0.0, 0.0, 1.0])
        else:
            center = arrays.spheres[own - at.FIRST_SPHERE].center
            normal = (p - center) / np.linalg.norm(p - center)
        weight[i] = lobe[0]
        if lobe[0] == 0:
            continue
        m = flat[i] - 2 * (flat[i] @ normal) * normal
        u1 = np.cross(m, [0.0, 1.0, 0.0] if abs(m[1]) < 0.9 else [1.0, 0.0, 0.0])
        u1 /= np.linalg.norm(u1)
        theta, share = _strata(lobe[1], lobe[2], k) if lobe[2] > 0 else (np.zeros(1), np.ones(1))
        phi = (np.arange(k) + 0.5) * 2 * math.pi / k
        t, f = (grid.ravel() for grid in np.meshgrid(theta, phi, indexing="ij"))
        w = np.sin(t)[:, None] * (np.cos(f)[:, None] * u1 + np.sin(f)[:, None] * np.cross(m, u1))
        w += np.cos(t)[:, None] * m
        seen = numeric.trace(arrays, np.tile(p, (len(w), 1)), w, own)[0] * (w @ normal > 0)[:, None]
        gloss[i] = np.repeat(share / k, k) @ seen
    return {"gloss": gloss.reshape(size, size, 3), "weight": weight.reshape(size, size)}


@pytest.mark.parametrize("name", ["chapter8", "gloss", "grazing", "needle", "penumbra"])
def test_strata_image_is_the_sum_it_claims(name: str) -> None:
    scene, size, k = load(name), 32, 4
    found = layers_of(symbolic, scene, size, lobe=k)
    expected = direct_sum(scene, size, k)
    lit = expected["gloss"].max(axis=2) > 0
    rms = np.sqrt((expected["gloss"][lit] ** 2).mean())
    assert lit.sum() > size and rms > 1e-4
    assert np.abs(found["gloss"] - expected["gloss"]).max() <= TOLERANCE * max(rms, 0.05)
    total = found["direct"] + expected["weight"][..., None] * expected["gloss"]
    assert np.abs(found["radiance"] - total).max() <= TOLERANCE * np.sqrt((total**2).mean())
    weighed = (expected["weight"] > 0) & (found["hit_class"] > 0)
    assert found["evaluations"] == weighed.sum() * k * k


def test_exact_disk_is_refused_by_strata() -> None:
    with pytest.raises(OptionError, match="'exact' needs symbolic='chambers'"):
        symbolic.prepare(scene_arrays(load("gloss")), Settings(disk="exact"))
