"""Meshes: skies, lamps and points against clipped polygons, the other pipeline, differences, and no hierarchy."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from tests.radiometric import flats, nets
from tests.radiometric.clipped import faces, irradiance, normal

import symrender as sr
from symrender.errors import Unsupported
from symrender.numeric.radiometric.pipeline import rays as numeric_rays
from symrender.radiometric.bounds import loose_bounds
from symrender.radiometric.sky import sky_room
from symrender.radiometric.world import World, make_world
from symrender.runtimes.radiometric import _kernel
from symrender.scene.parameters import get
from symrender.scene.radiometric.arrays import radiometric_arrays

FLOOR = flats.rectangle("floor", [-2, -2, 0], [4, 0, 0], [0, 4, 0], "both")
POINT: dict[str, Any] = {"type": "point", "name": "P", "position": [1.2, -1.5, 3.0], "intensity": 10.0}


def scene_of(seed: int) -> tuple[flats.Scene, np.random.Generator]:
    """A closed, a dented, an open mesh or a heap of boxes on a floor, under a lamp, a sky or both."""
    rng = np.random.default_rng([seed, 6])
    smooth = nets.ball(4, 6)
    net = (
        nets.ball(int(rng.integers(3, 6)), int(rng.integers(3, 8))),
        nets.bent(smooth, rng, 0.5),
        nets.opened(nets.bent(smooth, rng, 0.3), rng),
        nets.heap(rng),
    )[seed % 4]
    at = [0, 0, 0] if seed % 4 == 3 else [0, 0, float(rng.choice([0.5, 1.0, 1.5]))]
    place = {"position": at, "scale": float(rng.choice([0.5, 1.0])), "rotation": float(rng.choice([0, 17, 90]))}
    shapes = [FLOOR, nets.mesh("M", net, str(rng.choice(["both", "white"])), **place)]
    if rng.random() < 0.4:
        shapes.append(flats.one_of(rng, str(rng.choice(["rectangle", "triangle", "box"])), "O", "both", 1.0))
    lights = [flats.SKY]
    if rng.random() < 0.6:
        height = float(rng.choice([1.0, 1.5, 2.0, 3.0]))
        shapes.append(flats.rectangle("lamp", [-0.5, -0.5, height], [0, 1, 0], [1, 0, 0]))
        lights = [flats.area("lamp"), *(lights if rng.random() < 0.3 else [])]
    return flats.world(*shapes, lights=lights), rng


def rays_to(scene: flats.Scene, rng: np.random.Generator, count: int) -> list[tuple[tuple[int, int], Any, Any, Any]]:
    """(shape and face, origin, direction, normal) of rays at faces of the first two shapes, not beside their edges."""
    found = []
    for q in range(count):
        j = q % 2
        pieces = faces(scene["shapes"][j])
        k = int(rng.integers(len(pieces)))
        n = normal(pieces[k])
        place = (0.98 * rng.dirichlet(np.ones(len(pieces[k]))) + 0.02 / len(pieces[k])) @ pieces[k]
        if q == 0:
            place = np.array([*rng.choice([-1, -0.5, 0, 0.25, 0.5, 1], 2), 0.0])
        d = -(n + 0.3 * rng.uniform(-1, 1, 3))
        d /= np.linalg.norm(d)
        found.append(((j, k), place - 1e-4 * d, d, n))
    return found


def test_skies_and_lamps_are_what_clipping_leaves() -> None:
    judged = lit = met = 0
    for seed in range(16):
        scene, rng = scene_of(seed)
        sent = rays_to(scene, rng, 4)
        found = sr.probe(scene, rays=(np.array([x[1] for x in sent]), np.array([x[2] for x in sent])), tol=1e-6)
        for i, ((j, k), origin, d, n) in enumerate(sent):
            if found.shape[i] != f"shapes.{scene['shapes'][j]['name']}":
                continue
            face = faces(scene["shapes"][j])[k]
            place = origin + d * ((face[0] - origin) @ n) / (d @ n)
            true, doubt = (x / math.pi for x in irradiance(scene, (j, k), place, n))
            if doubt > 1e-10 or found.status[i] != 0:
                continue
            assert abs(found.direct[i, 0] - true) <= 1.5 * found.error[i] + 2e-11, (seed, i)
            judged, lit, met = judged + 1, lit + (true > 1e-6), met + (found.error[i] < 1e-11)
    assert judged > 50 and lit > 35 and met > 40


def without_bounds(world: World) -> World:
    """The same world, all of its pieces in leaves that nothing passes by."""
    return world._replace(bounds=loose_bounds(len(world.pieces)))


def test_values_do_not_depend_on_the_hierarchy() -> None:
    hits = lit = apart = 0
    for seed in range(12):
        scene, rng = scene_of(seed)
        made = sr.load(scene | {"lights": [*scene["lights"], POINT]})
        origins, directions = rng.uniform((-2, -2, 0.5), (2, 2, 4.5), (60, 3)), rng.normal(size=(60, 3)) * 0.4
        directions -= origins - [0, 0, 0.6]
        directions /= np.linalg.norm(directions, axis=1, keepdims=True)
        world = make_world(radiometric_arrays(made))
        found = []
        for each in (world, without_bounds(world)):
            one = (np.zeros((60, 3)), np.zeros((60, 3)), np.zeros(60))
            _kernel("fill_rays")(each, origins, directions, sky_room(each), *one)
            found.append(one)
        stated = sr.probe(made, rays=(origins, directions), tol=1e-6).error
        assert (found[0][2] == found[1][2]).all()
        off = np.abs(found[0][1] - found[1][1]).max(axis=1)
        assert (off <= stated).all() and off.max() < 1e-12, seed
        hits, lit = hits + int((found[0][2] == 2).sum()), lit + int((found[0][1] > 1e-3).any(axis=1).sum())
        apart += int((off > 0.0).sum())
    assert hits > 200 and lit > 300 and apart > 0


def test_circles_that_all_but_coincide_have_one_order() -> None:
    """Faces over each other in one plane, with more faces on their edges: several edges in the horizon at once.

    Whichever is listed first, what is seen is the same, which it was not while two circles alone were put in order.
    """
    net = nets.bent(nets.ball(3, 3, folded=True), np.random.default_rng(12), 0.05)
    shapes = [flats.plane("floor", [0, 0, 0], [0, 0, 1]), nets.mesh("M", net, position=[0, 0, 1.2], rotation=17.0)]
    world = make_world(radiometric_arrays(sr.load(flats.world(*shapes, lights=[flats.SKY]))))
    targets = np.array([0, 0, 1.2]) + np.random.default_rng(0).uniform(-0.9, 0.9, (6000, 3)) - [0, -6, 3]
    directions = targets / np.linalg.norm(targets, axis=1, keepdims=True)
    found = []
    for each in (world, without_bounds(world)):
        one = (np.zeros((6000, 3)), np.zeros((6000, 3)), np.zeros(6000))
        _kernel("fill_rays")(each, np.tile([0.0, -6.0, 3.0], (6000, 1)), directions, sky_room(each), *one)
        found.append(one)
    assert (found[0][2] == 2).sum() > 2000 and (found[0][2] == found[1][2]).all()
    assert np.abs(found[0][1] - found[1][1]).max() < 1e-13


def test_dents_of_any_depth_hide_what_their_faces_hide() -> None:
    """Bounds that know which way their faces show, of meshes whose faces show every way: none is left out."""
    lit = 0
    for seed in range(40):
        rng = np.random.default_rng([seed, 9])
        net = nets.bent(nets.ball(int(rng.integers(3, 7)), int(rng.integers(4, 8))), rng, 0.6)
        lamp = flats.rectangle("lamp", [-0.5, -0.5, 2.5], [0, 1, 0], [1, 0, 0])
        shapes = [FLOOR, nets.mesh("M", net, position=[0, 0, 1.0], scale=0.5), lamp]
        world = make_world(radiometric_arrays(sr.load(flats.world(*shapes, lights=[flats.SKY, flats.area("lamp")]))))
        found = []
        targets = np.c_[rng.uniform(-1.5, 1.5, (100, 2)), np.zeros(100)]
        directions = targets - [0, -6, 3]
        directions /= np.linalg.norm(directions, axis=1, keepdims=True)
        for each in (world, without_bounds(world)):
            one = (np.zeros((100, 3)), np.zeros((100, 3)), np.zeros(100))
            _kernel("fill_rays")(each, np.tile([0.0, -6.0, 3.0], (100, 1)), directions, sky_room(each), *one)
            found.append(one[1])
        assert np.abs(found[0] - found[1]).max() < 1e-12, seed
        lit += int((found[0] > 1e-3).any(axis=1).sum())
    assert lit > 2000


def test_both_pipelines_see_the_same_mesh() -> None:
    net = nets.bent(nets.ball(8, 12), np.random.default_rng(1), 0.25)
    texture = {"type": "checker", "bright": 0.9, "dark": [0.1, 0.2, 0.3], "cell": 0.07}
    materials = {"white": flats.WHITE, "both": {"type": "diffuse", "reflectance": texture, "two_sided": True}}
    shapes = [FLOOR, nets.mesh("M", net, "both", position=[0.1, 0.2, 1.1], rotation=33.0, scale=0.9)]
    made = sr.load(flats.world(*shapes, lights=[POINT], materials=materials))
    rng = np.random.default_rng(4)
    origins = rng.uniform((-2, -2, 0), (2, 2, 4), (4000, 3))
    directions = np.array([0.1, 0.2, 1.1]) + 0.5 * rng.normal(size=(4000, 3)) - origins
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    true = sr.probe(made, rays=(origins, directions), tol=1e-6)
    _, direct, _, hit_class = numeric_rays(radiometric_arrays(made), origins, directions)
    seen = np.array([{"shapes.floor": 1, "shapes.M": 2}.get(name, 0) for name in true.shape])
    assert (seen == 2).sum() > 1500 and (direct[seen == 2] > 1e-3).all(axis=1).sum() > 400
    assert (seen == hit_class).all()
    assert (np.abs(direct - true.direct).max(axis=1) <= 1e-12 + true.error).all()


def test_the_path_tracer_finds_the_same_under_a_sky_and_a_lamp() -> None:
    z = []
    for seed in range(4):
        scene, rng = scene_of(seed)
        made = sr.load(scene)
        origins, directions = rng.uniform((-2, -2, 0.5), (2, 2, 4.5), (60, 3)), rng.normal(size=(60, 3)) * 0.4
        directions -= origins - [0, 0, 0.6]
        directions /= np.linalg.norm(directions, axis=1, keepdims=True)
        true = sr.probe(made, rays=(origins, directions), tol=1e-6)
        arrays = radiometric_arrays(made)
        seeds = [numeric_rays(arrays, origins, directions, order=20, seed=s)[1][:, 0] for s in range(8)]
        error = np.std(seeds, axis=0, ddof=1) / math.sqrt(8)
        off, noisy = np.mean(seeds, axis=0) - true.direct[:, 0], error > 1e-6
        assert (np.abs(off) < 7 * error + 1e-3).all(), seed
        z += list(off[noisy] / error[noisy])
    assert len(z) > 100 and abs(float(np.mean(z))) < 0.4 and float(np.std(z)) < 1.5


def test_faces_without_gaps_let_no_ray_through() -> None:
    """Rays at edges and vertices of a closed mesh, from within: none leaves it."""
    net = nets.bent(nets.ball(8, 12), np.random.default_rng(2), 0.2)
    made = sr.load(flats.world(nets.mesh("M", net, "both", scale=0.7, rotation=11.0), lights=[POINT]))
    (shape,) = made.model_dump()["shapes"]
    vertices = np.array([face[0] for face in (faces(shape))])
    ends = np.array([face[1] for face in faces(shape)])
    rng = np.random.default_rng(3)
    targets = np.concatenate([vertices, *(vertices + t * (ends - vertices) for t in rng.uniform(0, 1, (40, 1, 1)))])
    directions = targets / np.linalg.norm(targets, axis=1, keepdims=True)
    found = sr.probe(made, rays=(np.zeros_like(directions), directions), tol=1e-6)
    assert len(targets) > 5000 and set(found.shape) == {"shapes.M"}


MOVED = ("position.x", "position.z", "scale", "rotation", "vertices[7].x", "vertices[9].z")


def test_derivatives_are_those_of_differences() -> None:
    acting: set[str] = set()
    checked = 0
    for seed, light in enumerate((flats.SKY, flats.area("lamp"), POINT)):
        net = nets.bent(nets.ball(3, 5), np.random.default_rng(seed), 0.3)
        lamp = flats.rectangle("lamp", [-1, -1, 3.5], [0.2, 2, 0], [2, 0, 0.3])
        shape = nets.mesh("M", net, "both", position=[0.1, 0.0, 1.2], rotation=5.0)
        camera = {"type": "look_at", "eye": [0, -5, 3], "target": [0, 0, 0.7]}
        scene = sr.load(flats.world(FLOOR, shape, lamp, lights=[light], camera=camera))
        names = [f"shapes.M.{name}" for name in MOVED]
        slopes = sr.gradient(scene, names, size=(6, 5))
        for name in names:
            slope = slopes[name].layer("direct")
            value, step = float(get(scene, name)), 1e-5
            images = [sr.truth(scene.replace({name: value + k * step}), size=(6, 5)) for k in (2, 1, -1, -2)]
            a, b, c, d = (image.layer("direct") for image in images)
            difference = (8.0 * (b - c) - (a - d)) / (12.0 * step)
            classes = [image.layer("hit_class") for image in images]
            steady = np.all([np.equal(one, classes[0]) for one in classes], axis=0)
            steady &= slopes[name].layer("status") == 0
            # where an outline passes a vertex as the mesh moves, the difference itself is not known
            steady &= np.abs((b - c) / (2 * step) - (a - d) / (4 * step)).max(axis=2) < 1e-6
            assert (np.abs(difference - slope).max(axis=2)[steady] < 1e-7 * max(1.0, np.abs(slope).max())).all(), name
            strong = steady & (np.abs(slope).max(axis=2) > 1e-4)
            checked += int(strong.sum())
            if strong.any():
                acting.add(name)
    assert checked > 120 and len(acting) == len(MOVED), (checked, acting)


def test_what_is_not_had_is_refused_by_name() -> None:
    made = sr.load(flats.world(FLOOR, nets.mesh("M", nets.ball(3, 4)), lights=[POINT]))
    with pytest.raises(Unsupported, match=r"filter: box has no walls yet for a mesh \(shapes\[1\]\)"):
        sr.truth(made, size=2, filter="box", method="quadrature")
    shapes = flats.disk("D", [0, 0, 0], [0, 0, 1], 1.0), nets.mesh("M", nets.ball(3, 4))
    with pytest.raises(Unsupported, match="a disk"):
        sr.truth(flats.world(*shapes, lights=[POINT], bounces="all"), size=2, method="quadrature")


def test_closed_meshes_hide_from_both_sides() -> None:
    """A place inside a mesh, and a lamp inside one whose normals point inward: nothing is seen of the light."""
    vertices, faces_ = nets.ball(5, 6)
    tent = nets.mesh("M", (vertices, faces_), scale=1.5)
    turned = [face[::-1] for face in faces_]
    lamp = flats.rectangle("lamp", [-0.2, -0.2, 2.0], [0, 0.4, 0], [0.4, 0, 0])
    shell = {"position": [0.0, 0.0, 2.0], "scale": 0.9}
    place = (np.array([0.1, 0.2, 1e-3]), np.array([0.0, 0.0, -1.0]))
    for around, lights in (
        ([tent], [flats.SKY]),
        ([tent, lamp], [flats.area("lamp")]),
        ([nets.mesh("M", (vertices, turned), **shell), lamp], [flats.area("lamp")]),
        ([nets.mesh("M", (vertices, faces_), **shell), lamp], [flats.area("lamp")]),
    ):
        dark = sr.probe(flats.world(FLOOR, *around, lights=lights), rays=place, tol=1e-6)
        light = sr.probe(flats.world(FLOOR, *around[1:], lights=lights), rays=place, tol=1e-6)
        assert dark.shape == ("shapes.floor",) and dark.direct.max() < 1e-15 and light.direct.max() > 0.01
    beyond = nets.mesh("M", (vertices, turned), position=[0.0, 0.0, 4.0], scale=0.5)
    far = flats.world(FLOOR, beyond, lamp, lights=[flats.area("lamp")])
    assert sr.probe(far, rays=place, tol=1e-6).direct == pytest.approx(light.direct, rel=1e-14)


CUBE: nets.Net = (
    [[x, y, z] for z in (0.0, 1.0) for y in (-0.5, 0.5) for x in (-0.5, 0.5)],
    [[0, 2, 3], [0, 3, 1], [4, 5, 7], [4, 7, 6], [0, 1, 5], [0, 5, 4], [2, 6, 7], [2, 7, 3], [0, 4, 6], [0, 6, 2],
     [1, 3, 7], [1, 7, 5]],
)  # fmt: skip
"""A closed mesh that stands on z = 0."""
CORNER: nets.Net = (
    [[x, y, z] for z in (1.0, 1.6) for x, y in ((0, 0), (1, 0), (1, 0.4), (0.4, 0.4), (0.4, 1), (0, 1))],
    [[2, 1, 0], [3, 2, 0], [4, 3, 0], [5, 4, 0], [6, 7, 8], [6, 8, 9], [6, 9, 10], [6, 10, 11]]
    + [[k, m, m + 6] for k, m in ((0, 1), (1, 2), (2, 3), (3, 4), (4, 5), (5, 0))]
    + [[k, m + 6, k + 6] for k, m in ((0, 1), (1, 2), (2, 3), (3, 4), (4, 5), (5, 0))],
)
"""A closed one with a notch, in which it sees itself."""


@pytest.mark.parametrize("floor", [FLOOR, flats.plane("floor", [0, 0, 0], [0, 0, 1])], ids=["rectangle", "plane"])
def test_a_closed_mesh_stands_on_a_floor_as_a_box_does(floor: flats.Scene) -> None:
    """The face it stands on is never seen."""
    grey = {name: {"type": "diffuse", "reflectance": 0.5} for name in ("white", "both")}
    mesh, solid = nets.mesh("M", CUBE), flats.box("M", [0, 0, 0.5], [1, 1, 1])
    origins, directions = looking(np.array([3.0, -4.0, 2.0]), (-1.5, -1.5, 0.0), (1.5, 1.5, 1.0), 12)
    found, true = (
        sr.probe(
            flats.world(floor, each, lights=[POINT], bounces=1, materials=grey), rays=(origins, directions), tol=1e-3
        )
        for each in (mesh, solid)
    )
    assert (found.status == 0).all() and (true.status == 0).all() and (true.indirect.max(axis=1) > 1e-3).sum() >= 4
    assert (np.abs(found.radiance - true.radiance).max(axis=1) <= found.error + true.error).all()


def looking(eye: Any, low: Any, high: Any, count: int) -> tuple[Any, Any]:
    toward = np.random.default_rng(5).uniform(low, high, (count, 3)) - eye
    return np.tile(eye, (count, 1)), toward / np.linalg.norm(toward, axis=1, keepdims=True)


@pytest.mark.parametrize(("net", "convex"), [(CUBE, True), (CORNER, False)], ids=["cube", "notched"])
def test_a_mesh_emits_as_its_triangles_do(net: nets.Net, convex: bool) -> None:
    """Onto a floor and, in a notch, onto itself."""
    vertices = [[x, y, z + (1.0 if convex else 0.0)] for x, y, z in net[0]]
    mesh = flats.world(FLOOR, nets.mesh("M", (vertices, net[1])), lights=[flats.area("M")])
    parts = [flats.triangle(f"T{k}", [vertices[v] for v in face]) for k, face in enumerate(net[1])]
    lamps = [flats.area(each["name"], name=f"L{k}") for k, each in enumerate(parts)]
    origins, directions = looking(np.array([2.5, 2.0, 2.4]), (-1.0, -1.0, 0.0), (1.0, 1.0, 2.0), 60)
    found = sr.probe(mesh, rays=(origins, directions), tol=1e-6)
    true = sr.probe(flats.world(FLOOR, *parts, lights=lamps), rays=(origins, directions), tol=1e-6)
    on_mesh = np.array([name == "shapes.M" for name in found.shape])
    assert (found.status == 0).all() and on_mesh.sum() > 10 and (~on_mesh & (true.direct[:, 0] > 1e-2)).sum() > 10
    assert convex or (on_mesh & (true.direct[:, 0] > 1e-2)).sum() > 5
    assert (np.abs(found.radiance - true.radiance).max(axis=1) <= found.error + true.error).all()
    runs = [numeric_rays(radiometric_arrays(sr.load(mesh)), origins, directions, order=20, seed=s) for s in range(8)]
    lit, noise = np.mean([run[1][:, 0] for run in runs], axis=0), np.std([run[1][:, 0] for run in runs], axis=0, ddof=1)
    assert (runs[0][0] == found.emitted).all()
    assert (np.abs(lit - found.direct[:, 0]) <= 7 * noise / math.sqrt(8) + 1e-3).all()
    assert np.median(noise) < 0.05


@pytest.mark.parametrize("lift", [0.0, -1e-3, -1e-12, -1e-14, 1e-3])
@pytest.mark.parametrize("copies", [1, 2])
def test_a_mesh_is_convex_where_no_corner_rises_over_a_face(lift: float, copies: int) -> None:
    """Boxes of corners say what a comparison of all corners with all faces says."""
    from scipy.spatial import ConvexHull

    from symrender.radiometric.pieces import _FLAT, _is_convex

    rng = np.random.default_rng(4)
    balls = rng.normal(size=(400, 3))
    balls *= np.array([1.0, 2.0, 3.0]) / np.linalg.norm(balls, axis=1, keepdims=True)
    corners = balls[ConvexHull(balls).simplices]
    ups = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    ups *= np.sign((ups * corners[:, 0]).sum(axis=1))[:, None] / np.linalg.norm(ups, axis=1, keepdims=True)
    levels, places = (ups * corners[:, 0]).sum(axis=1), balls.copy()
    places[7] *= 1.0 + lift
    places = np.concatenate([places + 10.0 * k for k in range(copies)])
    rise = float((ups @ places.T - levels[:, None]).max())
    assert len(ups) > 700
    assert _is_convex(ups, levels, places, 3.0) == (rise <= _FLAT * 3.0) == (copies == 1 and lift <= 0.0)
