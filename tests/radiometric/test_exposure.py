"""Means over lens, shutter and filters: closed forms, anchors, and the conventional tracer's rays through both."""

from __future__ import annotations

import itertools
import json
import math
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad
from tests.radiometric.exposures import REACH, WEIGHTS, sampled
from tests.radiometric.test_pixel import SUN, Array, ball, crowd, plane, world

import symrender as sr
from symrender.errors import OptionError, Unsupported
from symrender.scene.radiometric.scene import RadiometricScene

STRIPES = {"type": "diffuse", "reflectance": {"type": "stripes", "bright": 1, "dark": 0, "cell": 100}}
"""Bright where x is positive, if the texture begins at x = 0, for a hundred metres."""
HALVES = {"stripes": STRIPES, "white": {"type": "diffuse", "reflectance": 1}}
CAMERA = {"type": "look_at", "eye": [0, 0, 4], "target": [0, 0, 0], "up": [0, 1, 0], "fov": 30}
LAMP = {"type": "area", "name": "L", "shape": "lamp", "radiance": [3, 2, 1]}
GREY = {"type": "directional", "name": "sun", "direction": [0, 0, -1], "irradiance": math.pi}


def halves(edge: float = 0.0, **more: Any) -> RadiometricScene:
    """A floor seen from above, of radiance 1 where x > edge and 0 elsewhere."""
    floor = plane("stripes", point=[edge, 0, 0]) | more.pop("floor", {})
    return world([floor], [GREY], materials=HALVES, camera=CAMERA | more.pop("camera", {}), **more)


def value(scene: RadiometricScene, tol: float, filter: str = "centre", **more: Any) -> tuple[Array, float]:
    """(radiance, stated error) of an image of one pixel that met its tolerance."""
    image = sr.truth(scene, size=1, tol=tol, filter=filter, threads=1, **more)  # type: ignore[arg-type]
    assert image.layer("status")[0, 0] == 0 and image.layer("error")[0, 0] <= tol
    return image.radiance[0, 0], float(image.layer("error")[0, 0])


def segment(place: float) -> float:
    """The share of a unit disk where u > place."""
    return (math.acos(place) - place * math.sqrt(1 - place * place)) / math.pi


@pytest.mark.parametrize(("aperture", "focus"), [(0.3, 3.0), (0.3, 7.0), (1e-4, 3.0), (2.0, 1.0)])
def test_an_edge_out_of_focus_cuts_a_segment_off_the_lens(aperture: float, focus: float) -> None:
    # the middle of the image is sharp on the axis, so that the ray from u of the lens meets the floor at u times that
    scale, shares = 1 - 4 / focus, []
    for place in (-0.9, -0.3, 0.1, 0.5, 0.95):
        found, error = value(halves(place * aperture * scale, camera={"aperture": aperture, "focus": focus}), 1e-9)
        # u scale > place scale
        expected = segment(place) if scale > 0 else 1 - segment(place)
        assert abs(found[0] - expected) <= 1.5 * error + 1e-12
        shares.append(round(float(found[0]), 3))
    assert len(set(shares)) == 5


@pytest.mark.parametrize("aperture", [0.02, 0.2, 1.0])
def test_a_ball_out_of_focus_fills_the_part_of_the_lens_that_sees_it(aperture: float) -> None:
    radius, focus = 0.1, 2.5
    # rays through the focus at a distance 1.5 before the ball's centre
    slope = radius / math.sqrt(1.5**2 - radius**2)
    share = min(1.0, (focus * slope / aperture) ** 2)
    scene = world([ball("lamp", [0, 0, 0], radius)], [LAMP], camera=CAMERA | {"aperture": aperture, "focus": focus})
    found, error = value(scene, 1e-9)
    assert np.abs(found - share * np.array([3, 2, 1])).max() <= 1.5 * error + 1e-12
    assert (share < 1) == (aperture > 0.167)


@pytest.mark.parametrize(("height", "speed"), [(0.0, 1.0), (0.29, 1.0), (0.0, 40.0), (0.2999, 7.0), (0.31, 7.0)])
def test_a_ball_that_flies_past_a_ray_is_seen_as_long_as_it_covers_it(height: float, speed: float) -> None:
    start = -0.37 * speed
    lamp = ball("white", [start, height, 0], 0.3)
    flying = lamp | {"velocity": [speed, 0.0, 0.0]}
    # lit head-on, so that radiance is the height of the ball's surface over its radius
    scene = world([flying], [GREY], materials=HALVES, shutter=[0.0, 1.0])
    found, error = value(scene, 1e-7)
    reach = math.sqrt(max(0.0, 0.3**2 - height**2))

    # along the middle ray the eye sees the same circle, of half width reach at the ball's middle
    def seen(t: float) -> float:
        x = start + speed * t
        return math.sqrt(max(0.0, 0.3**2 - height**2 - x * x)) / 0.3

    ends = [max(0.0, (-reach - start) / speed), min(1.0, (reach - start) / speed)]
    expected = quad(seen, *ends, epsabs=1e-12, limit=400)[0] if reach > 0 else 0.0
    assert abs(found[0] - expected) <= 1.5 * error + 1e-9
    assert (expected > 1e-5) == (height < 0.3)


def test_an_edge_that_moves_over_a_pixel_is_seen_for_its_time() -> None:
    half = 4 * math.tan(math.radians(15.0))
    moving = halves(-3.0, floor={"velocity": [6.0, 0.0, 0.0]}, shutter=[0.0, 1.0])
    centre, error = value(moving, 1e-9)
    assert abs(centre[0] - 0.5) <= 1.5 * error
    moving = halves(-0.5, floor={"velocity": [2.0, 0.0, 0.0]}, shutter=[0.0, 1.0])

    def covered(t: float) -> float:
        return min(1.0, max(0.0, (half - (-0.5 + 2 * t)) / (2 * half)))

    found, error = value(moving, 1e-6, "box")
    expected = quad(covered, 0, 1, points=[(half + 0.5) / 2], epsabs=1e-12)[0]
    assert 0.2 < expected < 0.8
    assert abs(found[0] - expected) <= 1.5 * error


def test_edges_that_enter_or_leave_a_pixel_at_any_time_are_stated() -> None:
    rng, half = np.random.default_rng(3), 4 * math.tan(math.radians(15.0))

    def swept(x: float) -> float:
        """Integral of what lies beyond an edge, over the edge's places up to x, but for a constant."""
        inside = min(max(x, -half), half)
        return min(x, -half) + (half * inside - inside**2 / 2) / (2 * half)

    met = kinks = 0
    for _ in range(60):
        speed, start, tol = rng.uniform(0.3, 4), rng.uniform(-1.5, 1.5) * half, float(10 ** rng.uniform(-5, -2))
        scene = halves(float(start), floor={"velocity": [float(speed), 0.0, 0.0]}, shutter=[0.0, 1.0])
        image = sr.truth(scene, size=1, tol=tol, filter="box", threads=1)
        expected = (swept(start + speed) - swept(start)) / speed
        met += int(image.layer("status")[0, 0] == 0)
        kinks += start < -half < start + speed or start < half < start + speed
        assert abs(image.radiance[0, 0, 0] - expected) <= 1.5 * image.layer("error")[0, 0] + 1e-13
    assert met > 40 and kinks > 20


@pytest.mark.parametrize(("aperture", "focus"), [(0.05, 3.0), (0.4, 2.0), (0.9, 1.0), (0.2, 40.0)])
def test_pixel_and_lens_spread_an_edge_together(aperture: float, focus: float) -> None:
    # blurred over a sixtieth of the pixel to two and a half of it, so that either is the inner mean
    half, spread = 4 * math.tan(math.radians(15.0)), aperture * abs(1 - 4 / focus)
    for place in (-0.83, 0.1, 0.97):
        edge = place * (half + spread)

        def share(x: float, edge: float = edge) -> float:
            return segment(min(1.0, max(-1.0, (edge - x) / spread)))

        ends = sorted({-half, half, *(min(half, max(-half, edge + side * spread)) for side in (-1, 0, 1))})
        expected = sum(quad(share, a, b, epsabs=1e-12)[0] for a, b in itertools.pairwise(ends)) / (2 * half)
        scene = halves(edge, camera={"aperture": aperture, "focus": focus})
        found, error = value(scene, 1e-4, "box")
        assert abs(found[0] - expected) <= 1.5 * error + 1e-10


def test_the_path_tracer_draws_a_lens_of_its_radius() -> None:
    values = []
    for seed in range(8):
        scene = halves(0.05, camera={"aperture": 0.3, "focus": 3.0})
        image = sr.render(scene, size=1, lobe=48, symbolic="none", seed=seed, threads=1).numeric
        assert image is not None
        values.append(float(image.radiance[0, 0, 0]))
    mean, spread = np.mean(values), np.std(values, ddof=1) / math.sqrt(8)
    assert spread < 2e-3 and segment(0.5) < 0.25
    assert abs(mean - segment(0.5)) <= 6 * spread + 1e-4


def test_the_camera_moves_as_the_world_moves_against_it() -> None:
    still = world([plane("stripes", velocity=[0.5, 0.2, 0]), ball("A", [0.4, 0, 1], 0.3) | {"velocity": [0.5, 0.2, 0]}],
                  [GREY], materials=HALVES, camera=CAMERA, shutter=[-1.0, 0.5])  # fmt: skip
    moving = world([plane("stripes"), ball("A", [0.4, 0, 1], 0.3)], [GREY], materials=HALVES,
                   camera=CAMERA | {"velocity": [-0.5, -0.2, 0.0]}, shutter=[-1.0, 0.5])  # fmt: skip
    one, two = (sr.truth(scene, size=5, tol=1e-5, threads=1) for scene in (still, moving))
    assert np.abs(one.radiance - two.radiance).max() <= 1.5 * (one.layer("error") + two.layer("error")).max()
    frozen = sr.truth(still.replace({"shutter": [0.0, 0.0]}), size=5, tol=1e-5, threads=1)
    assert 0.3 < one.radiance.mean() < 0.9 and np.abs(one.radiance - frozen.radiance).max() > 0.05


@pytest.mark.parametrize("filter", ["tent", "gaussian", "mitchell"])
@pytest.mark.parametrize("radius", [0.0, 0.7])
def test_a_filter_weighs_both_sides_of_an_edge(filter: str, radius: float) -> None:
    half = 4 * math.tan(math.radians(15.0))
    reach, weight = radius or REACH[filter], WEIGHTS[filter]
    whole = quad(lambda x: float(weight(np.array(x))), -1, 1, points=[-0.5, 0, 0.5], epsabs=1e-13)[0]
    for place in (-0.6, 0.15, 0.83):
        ends = sorted({place, 1.0, *(x for x in (-0.5, 0.0, 0.5) if x > place)})
        pairs = itertools.pairwise(ends)
        expected = sum(quad(lambda x: float(weight(np.array(x))), a, b, epsabs=1e-13)[0] for a, b in pairs) / whole
        found, error = value(halves(place * reach * 2 * half), 1e-8, filter, filter_radius=radius)
        assert abs(found[0] - expected) <= 1.5 * error + 1e-12
        assert error < 1e-8 and abs(expected - (1 - place) / 2) > 0.01


@pytest.mark.parametrize("filter", ["tent", "gaussian", "mitchell"])
def test_a_filtered_edge_has_the_weight_it_is_at_as_its_slope(filter: str) -> None:
    half, place = 4 * math.tan(math.radians(15.0)), 0.31
    reach, weight = REACH[filter], WEIGHTS[filter]
    whole = quad(lambda x: float(weight(np.array(x))), -1, 1, points=[-0.5, 0, 0.5])[0]
    name = "shapes.floor.point.x"
    slopes = sr.gradient(halves(place * reach * 2 * half), [name], size=1, tol=1e-5, filter=filter)[name]  # type: ignore[arg-type]
    expected = -float(weight(np.array(place))) / whole / (reach * 2 * half)
    assert abs(expected) > 0.05
    assert abs(slopes.radiance[0, 0, 0] - expected) <= 1.5 * slopes.layer("error")[0, 0] + 1e-12 <= 1e-4


@pytest.mark.parametrize("filter", ["centre", "box", "tent", "gaussian", "mitchell"])
@pytest.mark.parametrize("how", ["lens", "shutter", "both"])
def test_what_is_the_same_everywhere_stays_what_it_is(filter: str, how: str) -> None:
    if filter == "centre" and how == "both":
        pytest.skip("refused by name")
    camera = CAMERA | ({"aperture": 0.3, "focus": 3.0} if how != "shutter" else {})
    floor = plane("white", velocity=[0.3, -0.2, 0.0])
    scene = world([floor], [SUN], camera=camera, shutter=[0.0, 1.0] if how != "lens" else [0.0, 0.0])
    found, error = value(scene, 1e-6, filter)
    assert np.abs(found - np.array([1, 2 / math.pi, 1 / math.pi])).max() <= 1e-12
    # no polynomial is a Gaussian, and what its rules differ by is stated
    assert error <= (1e-6 if filter == "gaussian" else 1e-12)


def exposed(seed: int, how: str) -> RadiometricScene:
    """A hostile crowd seen through a lens, over time, or both."""
    rng = np.random.default_rng(seed)
    scene = crowd(rng)
    far = float(np.linalg.norm(np.subtract(scene.camera.eye, scene.camera.target)))
    changes: dict[str, Any] = {"camera.fov": 8.0}
    if how != "shutter":
        changes["camera.aperture"] = far * float(10 ** rng.uniform(-3, -1.5))
        changes["camera.focus"] = far * float(rng.choice([1, 0.8, 1.3, 0.5, 3.0]))
    if how != "lens":
        changes["shutter"] = [0.0, 1.0]
        for index in range(len(scene.shapes)):
            if rng.random() < 0.6:
                way = rng.normal(size=3) * far * 10 ** rng.uniform(-3, -1.3)
                changes[f"shapes[{index}].velocity"] = way.tolist()
        changes["camera.velocity"] = (rng.normal(size=3) * far * 10 ** rng.uniform(-4, -1.7)).tolist()
        changes["lights[0].velocity"] = (rng.normal(size=3) * far * 10 ** rng.uniform(-3, -1)).tolist()
    return scene.replace(changes)


@pytest.mark.parametrize(
    ("how", "filter", "seeds"),
    [("lens", "centre", 14), ("shutter", "centre", 8), ("shutter", "box", 4), ("lens", "tent", 3), ("both", "box", 2)],
)
def test_hostile_exposures_are_those_of_the_conventional_tracer(how: str, filter: str, seeds: int) -> None:
    lit, told = 0, 0
    tol = 1e-3 if "centre" in filter or how == "shutter" else 1e-2
    for seed in range(seeds):
        scene = exposed(4000 + seed, how)
        image = sr.truth(scene, size=1, tol=tol, filter=filter, threads=1)  # type: ignore[arg-type]
        found, error = image.radiance[0, 0], image.layer("error")[0, 0]
        expected, sigma = sampled(scene, (1, 1), (0, 0), filter, 60_000, seed, times=8)
        lit += expected.max() > 1e-3
        told += error + 6 * sigma.max() < 0.1 * expected.max()
        assert (np.abs(found - expected) <= 1.5 * error + 6 * sigma + 1e-9).all(), seed
    assert lit >= 0.5 * seeds and told >= 1, (lit, told)


@pytest.mark.parametrize("filter", ["tent", "gaussian", "mitchell", "box"])
@pytest.mark.parametrize("sampler", ["jittered", "independent"])
def test_the_path_tracer_draws_the_same_means(filter: str, sampler: str) -> None:
    scene = sr.load("metal").replace({
        "camera.aperture": 0.2, "camera.focus": 9.0, "shutter": [0.0, 1.0],
        "shapes[1].velocity": [0.8, 0.0, 0.2], "lights[0].velocity": [0.3, 0.0, 0.0],
    })  # fmt: skip
    place, size = (4, 2), (8, 4)
    values = []
    for seed in range(12):
        images = sr.render(
            scene,
            size=size,
            lobe=24,
            numeric=sampler,
            symbolic="none",
            filter=filter,
            seed=seed,
            threads=1,  # type: ignore[arg-type]
        )
        assert images.numeric is not None
        values.append(images.numeric.radiance[place[1], place[0]])
    mean, spread = np.mean(values, axis=0), np.std(values, axis=0, ddof=1) / math.sqrt(12)
    expected, sigma = sampled(scene, size, place, filter, 100_000, 1, times=16)  # type: ignore[arg-type]
    assert expected.max() > 0.03 and spread.max() > 1e-6
    assert (np.abs(mean - expected) <= 5 * np.hypot(spread, sigma)).all()


def test_what_would_open_lens_or_shutter_has_no_derivative() -> None:
    """Beside these values an image is another mean, or numbers do not move one for one: none is said to stand still."""
    still = halves()
    moving = still.replace({"shapes[0].velocity": [1.0, 0.0, 0.0]})
    later = moving.replace({"shutter": [0.5, 0.5]})
    name = f"shapes.{still.shapes[0].name}.velocity.x"
    for scene, asked in ((still, "camera.aperture"), (moving, "shutter.g"), (later, "shutter.r"), (later, name)):
        for filter in ("centre", "box"):
            with pytest.raises(Unsupported, match=asked):
                sr.gradient(scene, [asked], size=1, filter=filter)  # type: ignore[arg-type]
    for scene, asked in ((still, "camera.focus"), (still, "shutter.g"), (moving, name)):
        found = sr.gradient(scene, [asked], size=1, filter="box", threads=1)[asked]
        assert not found.radiance.any() and found.layer("status")[0, 0] == 0


def test_bytes_depend_on_no_tile_and_no_thread() -> None:
    scene = exposed(7, "lens").replace({"camera.fov": 40.0})
    one = sr.truth(scene, size=(9, 5), tol=1e-3, threads=1, tile=4)
    two = sr.truth(scene, size=(9, 5), tol=1e-3, threads=2, tile=16)
    for name, layer in one.layers.items():
        np.testing.assert_array_equal(layer, two.layers[name])
    assert one.radiance.max() > 0.01
    assert json.loads(one.meta["conventions"])["lens"] == "thin, uniform disk"


def test_what_is_not_had_is_refused_by_name() -> None:
    lens = {"camera.aperture": 0.1}
    both = {**lens, "shutter": [0.0, 1.0], "shapes[0].velocity": [1.0, 0.0, 0.0]}
    with pytest.raises(Unsupported, match="shutter: with an aperture and filter: centre is not yet integrated"):
        sr.truth(halves().replace(both), size=1, method="quadrature")
    with pytest.raises(Unsupported, match=r"camera\.aperture: is not yet integrated with bounces"):
        sr.truth(sr.load("interreflection").replace(lens), size=1, method="quadrature")
    with pytest.raises(Unsupported, match=r"gradient: camera\.aperture"):
        sr.gradient(halves().replace(lens), ["camera.eye.x"], size=1)
    with pytest.raises(Unsupported, match="shutter: single rays are answered at an instant"):
        sr.probe(halves().replace(both), rays=([0, 0, 1], [0, 0, -1]))
    with pytest.raises(Unsupported, match="lenses and motion are not exported yet"):
        sr.export(halves().replace(lens), "mitsuba", "nowhere")
    lamp = world([ball("lamp", [0, 0, 0], 0.3) | {"velocity": [1.0, 0, 0]}], [LAMP], shutter=[0.0, 1.0])
    with pytest.raises(Unsupported, match=r"shutter: lights\[0\], an area light, in a scene in which shapes"):
        sr.truth(lamp, size=1, method="quadrature")
    with pytest.raises(Unsupported, match="filter: tent"):
        sr.truth("mirror", size=1, filter="tent", method="quadrature")
    with pytest.raises(OptionError, match="filter_radius: must be from"):
        sr.truth("metal", size=1, filter="tent", filter_radius=3)
