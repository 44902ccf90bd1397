"""One bounce of the light of spots, skies and lamps: integrals of one variable, a furnace, lattices, path tracer."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

import symrender as sr
from symrender.errors import Unsupported
from symrender.numeric.radiometric.pipeline import rays as numeric_rays
from symrender.scene.radiometric.arrays import radiometric_arrays

from . import seen_lattice

Array = npt.NDArray[np.float64]
RHO = np.array([0.8, 0.4, 0.0])
LIGHT = np.array([3.0, 2.0, 1.0])
METAL = {"type": "conductor", "alpha": 0.3, "eta": [0.2, 0.9, 1.1], "k": [3.9, 2.4, 2.1], "reflectance": [1, 1, 1]}
SKY = {"type": "sky", "name": "sky", "radiance": [1.0, 0.8, 0.5]}
LAMP = {"type": "area", "name": "lamp", "shape": "C", "radiance": [4.0, 3.0, 2.0]}
SPOT = {"type": "spot", "name": "spot", "position": [0.3, -1.5, 2.5], "direction": [-0.2, 1.3, -2],
        "intensity": [5.0, 4.0, 3.0], "beam": 10, "cutoff": 25}  # fmt: skip
EYE = np.array([0.2, -4.0, 2.0])
PEA = 1e-4


def scene(shapes: list[dict[str, Any]], lights: list[dict[str, Any]], **materials: Any) -> dict[str, Any]:
    return {
        "units": "radiometric",
        "bounces": 1,
        "camera": {"type": "look_at", "eye": [0, -5, 2.5], "target": [0, 0, 0.5], "fov": 40},
        "materials": {"dull": {"type": "diffuse", "reflectance": RHO.tolist()}} | materials,
        "shapes": shapes,
        "lights": lights,
    }


def plane(name: str, point: list[float], normal: list[float], material: str = "dull") -> dict[str, Any]:
    return {"type": "plane", "name": name, "point": point, "normal": normal, "along": [1, 0, 0], "material": material}


def ball(name: str, center: list[float], radius: float, material: str = "dull") -> dict[str, Any]:
    return {"type": "sphere", "name": name, "center": center, "radius": radius, "material": material}


FLOOR = plane("floor", [0, 0, 0], [0, 0, 1])


def crowd(lights: list[dict[str, Any]], floor: str = "dull", gloss: str = "dull") -> dict[str, Any]:
    """Three balls, one of which touches the floor, before a wall that leans."""
    shapes = [plane("floor", [0, 0, 0], [0, 0, 1], floor), plane("wall", [0, 2, 0], [0, -1, 0.1]),
              ball("A", [-0.5, 0.2, 0.6], 0.5, gloss), ball("B", [0.7, -0.2, 0.4], 0.4),
              ball("C", [0.2, 0.5, 1.4], 0.25)]  # fmt: skip
    checker = {"type": "checker", "bright": [0.8, 0.8, 0.8], "dark": [0.1, 0.1, 0.3], "cell": 0.5}
    return scene(shapes, lights, tiles={"type": "diffuse", "reflectance": checker}, metal=METAL)


def under_a_pea(shapes: list[dict[str, Any]], lights: list[dict[str, Any]], high: float, **keys: Any) -> sr.RayProbe:
    """What the lowest place of a tiny ball, so ``high`` over the floor, reflects."""
    pea = ball("pea", [0, 0, high + PEA], PEA)
    start = np.array([0.03, 0.04, high - 0.1])
    return sr.probe(scene([FLOOR, pea, *shapes], lights), rays=(start, np.array([0, 0, high]) - start), **keys)


def from_the_floor(high: float, sent: Any, breaks: list[float]) -> float:
    """int sent(r) cos^2/d^2 dA over the floor: what arrives at ``high`` over its middle, with breaks at distances."""
    x, w = np.polynomial.legendre.leggauss(60)
    total = 0.0
    ends = [0.0, *(math.atan(r / high) for r in sorted(breaks)), 0.5 * math.pi]
    for a, b in pairwise(ends):
        theta = a + 0.5 * (b - a) * (x + 1.0)
        total += 0.5 * (b - a) * float(w @ (sent(high * np.tan(theta)) * 2.0 * np.pi * np.cos(theta) * np.sin(theta)))
    return total


@pytest.mark.parametrize("falloff", ["linear", "smooth"])
@pytest.mark.parametrize("beam, cutoff", [(10.0, 25.0), (0.0, 40.0), (24.999, 25.0), (30.0, 80.0), (40.0, 90.0)])
def test_a_spot_on_a_floor_is_an_integral_of_one_variable(beam: float, cutoff: float, falloff: str) -> None:
    low, high = 0.7, 1.5
    b, c = math.radians(beam), math.radians(cutoff)

    def sent(r: Array) -> Array:
        theta = np.arctan2(r, low)
        share = np.clip((c - theta) / (c - b), 0.0, 1.0)
        if falloff == "smooth":
            t = np.clip((np.cos(theta) - math.cos(c)) / (math.cos(b) - math.cos(c)), 0.0, 1.0)
            share = t * t * (3.0 - 2.0 * t)
        return np.asarray(share * np.cos(theta) ** 3 / low**2 / np.pi)

    spot = {"type": "spot", "name": "S", "position": [0, 0, low], "direction": [0, 0, -2], "intensity": LIGHT.tolist(),
            "beam": beam, "cutoff": cutoff, "falloff": falloff}  # fmt: skip
    known = RHO / np.pi * RHO * LIGHT * from_the_floor(high, sent, [low * math.tan(t) for t in (b, c) if t < 1.57])
    seen = under_a_pea([], [spot], high, tol=1e-9)
    assert known[0] > 1e-2 and known[2] == 0.0
    assert seen.status[0] == 0 and seen.error[0] <= 1e-9 and 100 < seen.evaluations[0] < 30_000
    assert np.abs(seen.indirect[0] - known).max() <= seen.error[0] + 1e-12


def test_the_sky_and_a_lamp_over_a_floor_are_integrals_of_one_variable() -> None:
    high, radius, center = 0.4, 0.6, 1.7
    factor = from_the_floor(high, lambda r: radius**2 * center / (r * r + center * center) ** 1.5 / np.pi, [])
    over = [ball("over", [0, 0, center], radius)]
    sky = {"type": "sky", "name": "sky", "radiance": LIGHT.tolist()}
    lamp = {"type": "area", "name": "lamp", "shape": "over", "radiance": LIGHT.tolist()}
    for lights, known in (([lamp], factor), ([sky], 1.0 - factor), ([sky, lamp], 1.0)):
        seen = under_a_pea(over, lights, high, tol=1e-9)
        assert factor > 0.05 and seen.status[0] == 0 and seen.error[0] < 2e-9
        # the floor's share of what the pea sees is all, and the pea hides a square of its size over its height
        assert np.abs(seen.indirect[0] - RHO * RHO * LIGHT * known).max() <= seen.error[0] + 20.0 * (PEA / high) ** 2


def test_a_world_of_lamps_as_bright_as_the_sky_is_lit_alike() -> None:
    places = [([-0.5, 0.2, 0.6], 0.5), ([0.7, -0.2, 0.4], 0.4), ([0.2, 0.5, 1.4], 0.25), ([0.4, 0.9, 0.1], 0.3)]
    balls = [ball(name, center, radius) for name, (center, radius) in zip("ABCD", places, strict=True)]
    lamps: list[dict[str, Any]] = [
        {"type": "area", "name": f"L{b['name']}", "shape": b["name"], "radiance": [1, 1, 1]} for b in balls
    ]
    aims = np.array([[-0.4, -0.2, 0.7], [0.6, -0.5, 0.5], [0.7, -0.4, 0.6], [0.2, 0.3, 1.5]])
    rays = (EYE, aims - EYE)
    seen = sr.probe(scene(balls, [*lamps, {"type": "sky", "name": "sky", "radiance": [1, 1, 1]}]), rays=rays, tol=1e-8)
    # everything is as bright as its reflectance, and what is seen of it is what lamps alone light
    alone = sr.probe(scene(balls, lamps) | {"bounces": 0}, rays=rays)
    assert (seen.status == 0).all() and (alone.direct[:, 0] > 5e-3).sum() >= 2 and len(set(seen.shape)) >= 3
    assert (np.abs(seen.indirect - RHO * alone.direct).max(axis=1) <= seen.error + 1e-12).all()


def test_a_lamp_inside_a_ball_lights_nothing() -> None:
    balls = [ball("A", [-0.5, 0.2, 0.6], 0.5), ball("C", [-0.6, 0.1, 0.6], 0.1), ball("B", [0.7, -0.2, 0.4], 0.4)]
    aims = np.array([[0.1, 0.1, 0.0], [-0.5, -0.2, 0.8], [0.7, -0.4, 0.6]])
    seen = sr.probe(scene([FLOOR, *balls], [LAMP]), rays=(EYE, aims - EYE), tol=1e-6)
    assert set(seen.shape) == {"shapes.floor", "shapes.A", "shapes.B"} and (seen.status == 0).all()
    assert seen.indirect.max() == 0.0 and (seen.evaluations > 50).all()


LIGHTS = {
    "spot": ([SPOT], "tiles", "metal"),
    "cone": ([SPOT | {"beam": 0, "falloff": "smooth"}], "metal", "dull"),
    "sky": ([SKY], "dull", "dull"),
    "lamp": ([LAMP], "dull", "dull"),
    "all": ([SKY, LAMP, SPOT], "dull", "dull"),
}
AIMS = np.array([[0.1, 0.1, 0.0], [-0.5, -0.2, 0.8], [1.2, 0.9, 0.0], [-1.0, 2.0, 1.2], [0.7, -0.4, 0.6]])


@pytest.mark.parametrize("name", LIGHTS)
def test_lattices_of_rays_find_the_same(name: str) -> None:
    made, rng = crowd(*LIGHTS[name]), np.random.default_rng(5)
    seen = sr.probe(made, rays=(EYE, AIMS - EYE), tol=1e-6)
    assert (seen.status == 0).all() and (seen.error <= 1e-6).all() and len(set(seen.shape)) >= 4
    for tol in (1e-2, 1e-4):
        loose = sr.probe(made, rays=(EYE, AIMS - EYE), tol=tol)
        assert (np.abs(loose.indirect - seen.indirect).max(axis=1) <= loose.error + seen.error).all()
    judged = 0
    for k, aim in enumerate(AIMS):
        known = seen_lattice.bounced(made, EYE, aim - EYE, rng, 2584, 1597)
        assert f"shapes.{made['shapes'][known.shape]['name']}" == seen.shape[k]
        assert (np.abs(known.indirect - seen.indirect[k]) <= 7.0 * known.sigma + seen.error[k]).all(), (k, known)
        judged += int(known.sigma.max() < 0.1 * seen.indirect[k].max())
    assert judged >= 3 and (seen.indirect.max(axis=1) > 1e-4).sum() >= 3


def test_the_path_tracer_finds_the_same() -> None:
    made = sr.load(crowd(*LIGHTS["all"]))
    origins, directions = np.tile(EYE, (len(AIMS), 1)), AIMS - EYE
    seen = sr.probe(made, rays=(origins, directions), tol=1e-5)
    unit = directions / np.linalg.norm(directions, axis=1, keepdims=True)
    runs = [numeric_rays(radiometric_arrays(made), origins, unit, order=64, seed=s)[2] for s in range(8)]
    mean, error = np.mean(runs, axis=0), np.std(runs, axis=0, ddof=1) / math.sqrt(len(runs))
    bright = seen.indirect > 5e-3
    assert bright.sum() >= 10 and (error[bright] < 0.05 * seen.indirect[bright]).all()
    z = (mean - seen.indirect)[bright] / (error[bright] + 1e-5)
    assert np.abs(z).max() < 8 and abs(float(np.mean(z))) < 2.0, z


FIRST = {"gloss": "first_hit"}
STRIPED = {"type": "stripes", "bright": [0.9, 0.5, 0.7], "dark": [0.1, 0.5, 0.0]}


def stripes_from(high: float, shift: float, cell: float) -> float:
    """Share of a cosine's lobe, ``high`` above a plane and ``shift`` along it, that meets even stripes of all."""
    edges = np.arange(-200_000, 200_001) * cell - shift
    sines = edges / np.hypot(edges, high)
    shares = 0.5 * np.diff(sines)
    return float(shares[::2].sum())


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("cell", [0.7, 0.06])
def test_stripes_under_an_open_sky_are_angles(cell: float, turned: bool) -> None:
    high, at = 0.5, 0.23
    tiles = {"type": "diffuse", "reflectance": STRIPED | {"cell": cell}, "two_sided": turned}
    floor = plane("floor", [-at, 0.4, 0], [0, 0, -1 if turned else 1], "tiles") | {"along": [3, 0, 0]}
    pea, over = ball("pea", [0, 0, high + PEA], PEA), ball("over", [0.2, 0.3, 2.5], 0.7)
    share = stripes_from(high, at, cell)
    sent = share * np.array(STRIPED["bright"]) + (1.0 - share) * np.array(STRIPED["dark"])
    start = np.array([0.03, 0.04, high - 0.1])
    sky = {"type": "sky", "name": "sky", "radiance": LIGHT.tolist()}
    lamp = {"type": "area", "name": "lamp", "shape": "over", "radiance": LIGHT.tolist()}
    assert 0.3 < share < 0.7 and (cell < 0.1 or abs(share - 0.5) > 0.02)
    # a lamp as bright as the sky before which it stands takes nothing from the floor
    for shapes, lights in (([floor, pea], [sky]), ([floor, pea, over], [sky, lamp])):
        made = scene(shapes, lights, tiles=tiles)
        seen = sr.probe(made, rays=(start, np.array([0, 0, high]) - start), tol=1e-6)
        assert seen.status[0] == 0 and seen.error[0] <= 1e-6 and seen.evaluations[0] > 100
        off = np.abs(seen.indirect[0] - RHO * LIGHT * sent).max()
        assert off <= seen.error[0] + 20.0 * (PEA / high) ** 2, (share, off)


@pytest.mark.parametrize("texture", ["checker", "stripes"])
def test_lattices_find_what_textured_planes_send_to_gloss(texture: str) -> None:
    made, rng = crowd([SKY, LAMP, SPOT], "tiles", "metal") | FIRST, np.random.default_rng(9)
    made["materials"]["tiles"]["reflectance"]["type"] = texture
    seen = sr.probe(made, rays=(EYE, AIMS - EYE), tol=1e-4)
    assert (seen.status == 0).all() and len(set(seen.shape)) >= 4 and (seen.indirect.max(axis=1) > 1e-2).all()
    loose = sr.probe(made, rays=(EYE, AIMS - EYE), tol=1e-2)
    assert (np.abs(loose.indirect - seen.indirect).max(axis=1) <= loose.error + seen.error).all()
    plain = sr.probe(
        made | {"materials": made["materials"] | {"tiles": made["materials"]["dull"]}}, rays=(EYE, AIMS - EYE)
    )
    judged = 0
    for k, aim in enumerate(AIMS):
        known = seen_lattice.bounced(made, EYE, aim - EYE, rng, 2584, 1597)
        assert (np.abs(known.indirect - seen.indirect[k]) <= 6.0 * known.sigma + seen.error[k]).all(), (k, known)
        judged += int(np.abs(plain.indirect[k] - seen.indirect[k]).max() > 12.0 * known.sigma.max())
    assert judged >= 3


def test_gloss_of_the_first_hit_is_black_to_others() -> None:
    point = {"type": "point", "name": "point", "position": [0.3, -1.5, 2.5], "intensity": [5.0, 4.0, 3.0]}
    for lights in ([point], [SKY, LAMP]):
        made = crowd(lights, "dull", "metal") | FIRST
        black = made["materials"] | {"metal": {"type": "diffuse", "reflectance": 0}}
        rays = (EYE, AIMS - EYE)
        seen, dark = sr.probe(made, rays=rays, tol=1e-5), sr.probe(made | {"materials": black}, rays=rays, tol=1e-5)
        gloss = np.array(seen.shape) == "shapes.A"
        assert gloss.sum() == 1 and (seen.status == 0).all() and (seen.indirect.max(axis=1) > 1e-3).all()
        assert (np.abs(seen.indirect - dark.indirect)[~gloss].max(axis=1) <= (seen.error + dark.error)[~gloss]).all()
    every = sr.probe(crowd([point], "dull", "metal"), rays=rays, tol=1e-5)
    first = sr.probe(crowd([point], "dull", "metal") | FIRST, rays=rays, tol=1e-5)
    # what is met first looks at diffuse shapes alone here, and these see it
    assert np.abs(every.indirect - first.indirect)[~gloss].max() > 1e-4
    assert np.abs(every.indirect - first.indirect)[gloss].max() <= every.error[gloss][0] + first.error[gloss][0]


def test_the_path_tracer_ends_at_gloss_too() -> None:
    made = crowd([SKY, LAMP, SPOT], "tiles", "metal") | FIRST
    made["materials"]["tiles"]["reflectance"]["type"] = "stripes"
    loaded = sr.load(made)
    directions = AIMS - EYE
    seen = sr.probe(loaded, rays=(EYE, directions), tol=1e-4)
    unit = directions / np.linalg.norm(directions, axis=1, keepdims=True)
    origins = np.tile(EYE, (len(AIMS), 1))
    runs = [numeric_rays(radiometric_arrays(loaded), origins, unit, order=64, seed=s)[2] for s in range(8)]
    mean, error = np.mean(runs, axis=0), np.std(runs, axis=0, ddof=1) / math.sqrt(len(runs))
    bright = seen.indirect > 5e-3
    assert bright.sum() >= 10 and (error[bright] < 0.05 * seen.indirect[bright]).all()
    z = (mean - seen.indirect)[bright] / (error[bright] + 1e-4)
    assert np.abs(z).max() < 8 and abs(float(np.mean(z))) < 2.0, z


def test_what_is_not_integrated_is_refused_by_name() -> None:
    for lights, words in ((([SKY]), "a sky"), ([LAMP], "an area light")):
        refused = f"in a scene with {words} beside a conductor or a phong material that reflects after the first hit"
        with pytest.raises(Unsupported, match=f"bounces: 1 is not yet integrated {refused}"):
            sr.truth(crowd(lights, "metal"), size=4, method="quadrature")
