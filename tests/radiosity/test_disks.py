"""Disks among faces: form factors in closed form, what lies along rims, lattices, paths, what is refused."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from tests.radiometric.flats import SKY, disk, rectangle, world
from tests.radiosity.rooms import MATERIALS, closed, lamp, reflected_once, with_disks

import symrender as sr
from symrender.errors import Unsupported
from symrender.radiometric.world import make_world
from symrender.radiosity import breaks, table
from symrender.radiosity.endless import laid
from symrender.radiosity.records import BOUND
from symrender.radiosity.rims import FEWEST, MOST, Rim, rim_corners
from symrender.runtimes.radiosity import met
from symrender.runtimes.tables import Need, table_of
from symrender.scene.radiometric.arrays import radiometric_arrays

KEY = {"type": "point", "name": "key", "position": [0.6, 0.4, 0.8], "intensity": [0.3, 0.3, 0.3]}
COAL = {"coal": {"type": "diffuse", "reflectance": 0}}


def room(*shapes: Any, lights: Any = (KEY,), bounces: Any = 1) -> Any:
    return world(*closed(), *shapes, lights=list(lights), materials=MATERIALS | COAL, bounces=bounces)


def polygon_share(corners: np.ndarray, place: np.ndarray, normal: np.ndarray) -> float:
    """Form factor of a polygon over the horizon, by Lambert's formula."""
    ways = corners - place
    ways /= np.linalg.norm(ways, axis=1)[:, None]
    total = 0.0
    for a, b in zip(ways, np.roll(ways, -1, axis=0), strict=True):
        across = np.cross(a, b)
        sine = float(np.linalg.norm(across))
        total += math.atan2(sine, float(a @ b)) * float(across @ normal) / sine
    return abs(total) / (2.0 * math.pi)


def polygon_of(shape: Any) -> np.ndarray:
    """The polygon that stands for a disk: it begins along the disk's east."""
    arrays = radiometric_arrays(sr.load(room(shape)))
    frame = arrays.frames[-1]
    corners = rim_corners(shape["radius"], 0.5)
    turns = 2.0 * math.pi * np.arange(corners) / corners
    way = np.cos(turns)[:, None] * frame.east + np.sin(turns)[:, None] * frame.north
    return np.asarray(np.array(shape["center"]) + shape["radius"] * way)


def all_send_one(made: table.Sendings) -> None:
    """Make every cell send 1 in all channels."""
    for forest in made.forests:
        cells: Any = forest.cells
        cells["terms"][:] = 0.0
        cells["terms"][:, [0, 10, 20]] = 1.0
        for name in ("spread", "rough", "doubt", "drift", "even", "bulk", "haze"):
            cells[name][:] = 0.0


@pytest.mark.parametrize("radius", [0.01, 0.1, 0.35])
@pytest.mark.parametrize("material", ["coal", "both"])
def test_a_disk_hides_and_sends_what_its_polygon_does(radius: float, material: str) -> None:
    """Where everything else sends 1 a black disk takes its form factor; where it sends 1, too, nothing is missing.

    Large cells hold the whole disk as a place sees it, so that what is cut out of them has as many corners as it has.
    """
    shape = disk("D", [0.5, 0.45, 0.4], [0.2, 0.1, 1.0], radius, material)
    made = table.sendings(laid(radiometric_arrays(sr.load(room(shape)))), False, 1e-1)
    all_send_one(made)
    rng = np.random.default_rng(3)
    places = np.column_stack([rng.uniform(0.05, 0.95, (24, 2)), np.zeros(24)])
    found = made.gathered(np.zeros(24, np.int64), np.ones(24, np.int64), places)[:, :3]
    up = np.array([0.0, 0.0, 1.0])
    shares = np.array([polygon_share(polygon_of(shape), place, up) for place in places])
    assert shares.min() > 1e-5 and shares.max() > 0.5 * radius * radius
    wanted = 1.0 - shares if material == "coal" else np.ones(24)
    np.testing.assert_allclose(found, np.tile(wanted[:, None], 3), atol=2e-11)


def test_places_on_a_disk_see_the_room_before_it() -> None:
    """Both sides of it, everywhere on it, its very rim too."""
    shape = disk("D", [0.5, 0.45, 0.4], [0.2, 0.1, 1.0], 0.3, "both")
    arrays = radiometric_arrays(sr.load(room(shape)))
    made = table.sendings(laid(arrays), False, 1e-1)
    all_send_one(made)
    frame, turns = arrays.frames[-1], np.linspace(0.0, 6.0, 10)
    out = np.array([0.0, 0.1, 0.2, 0.29, 0.2999, 0.3, 0.15, 0.05, 0.25, 0.29999])
    way = np.cos(turns)[:, None] * frame.east + np.sin(turns)[:, None] * frame.north
    places = np.array(shape["center"]) + out[:, None] * way
    for front in (0, 1):
        found = made.gathered(np.full(10, 6), np.full(10, front), places)[:, :3]
        np.testing.assert_allclose(found, 1.0, atol=2e-11)


def test_what_lies_along_a_rim_is_bounded() -> None:
    """The form factor of the band of the rim, by sums over it, is no more than its bound, and not much less."""
    rng = np.random.default_rng(1)
    turns = 2.0 * math.pi * (np.arange(20000) + 0.5) / 20000
    nearest: list[float] = []
    for _ in range(300):
        radius = 10.0 ** rng.uniform(-2, 1)
        rim = Rim(0, np.zeros(3), np.array([0.0, 0.0, 1.0]), radius, 64)
        width = rim.width
        place = np.array([rng.uniform(0, 2.5) * radius, 0.0, 10.0 ** rng.uniform(-3, 1) * radius])
        far = math.hypot(place[2], place[0] - radius)
        if far < 3.0 * width:
            continue
        normal = rng.normal(size=3)
        normal /= np.linalg.norm(normal)
        r = radius - 0.5 * width
        ways = np.column_stack([r * np.cos(turns), r * np.sin(turns), np.zeros(20000)]) - place
        square = (ways**2).sum(axis=1)
        share = np.maximum(ways @ normal, 0.0) * place[2] / square**2
        true = float(share.mean()) * 2.0 * r * width
        bound = float(rim.share(np.array([1]), place[None])[0])
        assert true <= bound
        nearest.append(true / bound)
    assert len(nearest) > 200 and max(nearest) > 0.5
    assert (
        not Rim(3, np.zeros(3), np.array([0.0, 0.0, 1.0]), 1.0, 64)
        .share(np.array([3]), np.array([[0.9, 0.0, 0.0]]))
        .any()
    )
    assert (
        Rim(3, np.zeros(3), np.array([0.0, 0.0, 1.0]), 1.0, 64).share(np.array([2]), np.array([[1.0, 0.0, 0.0]])) == 1.0
    )


def aimed(count: int = 20) -> tuple[np.ndarray, np.ndarray]:
    """Rays all around, every fourth at the disk."""
    rng = np.random.default_rng(0)
    ways = rng.normal(size=(count, 3))
    ways[::4] = (0.5, 0.5, 0.4) + rng.uniform(-0.15, 0.15, (len(ways[::4]), 3)) * (1, 1, 0) - (0.5, 0.05, 0.7)
    return np.tile([0.5, 0.05, 0.7], (count, 1)), ways / np.linalg.norm(ways, axis=1)[:, None]


@pytest.mark.parametrize("light", ["point", "lamp", "disk"])
def test_one_bounce_is_the_lattices(light: str) -> None:
    """A tilted disk that shows both sides, under a point, a rectangle and another disk that emits."""
    shapes = [disk("D", [0.5, 0.5, 0.4], [0.2, 0.1, 1], 0.25, "both")]
    lights: list[Any] = [KEY]
    if light == "lamp":
        shapes.append(rectangle("glow", [0.3, 0.3, 0.999], [0, 0.4, 0], [0.4, 0, 0]))
        lights = [lamp(shapes[-1], [5, 4, 3])]
    if light == "disk":
        shapes.append(disk("glow", [0.4, 0.5, 0.98], [0, 0.1, -1], 0.2, "grey"))
        lights = [lamp(shapes[-1], [5, 4, 3])]
    scene, rays = room(*shapes, lights=lights), aimed()
    seen = sr.probe(scene, rays=rays, tol=2e-3)
    at, albedo = met(make_world(radiometric_arrays(sr.load(scene))), *rays)
    assert {"shapes.D", "shapes.front", "shapes.left"} <= set(seen.shape)
    assert (seen.error < 6e-3).all() and (seen.status == 0).mean() > 0.8
    for i in range(len(at.own)):
        mean, wide = reflected_once(scene, at.place[i], at.normal[i], 4000, i)
        off = np.abs(albedo[i] * mean - seen.indirect[i])
        assert (off <= seen.error[i] + 6.0 * albedo[i] * wide + 1e-12).all(), (light, i)
    # without the disk it would be seen
    bare = sr.probe(room(*shapes[1:], lights=lights), rays=rays, tol=2e-3)
    assert (np.abs(bare.indirect - seen.indirect).max(axis=1) > 3.0 * (seen.error + bare.error)).sum() > 4


def test_a_disk_of_no_effect_changes_nothing_but_what_it_states() -> None:
    """A black disk of 1e-6: values are those of the room without it, within what its rim could change."""
    rays = aimed(8)
    bare = sr.probe(room(), rays=rays, tol=2e-3)
    seen = sr.probe(room(disk("D", [0.5, 0.5, 0.4], [0, 0, 1], 1e-6, "coal")), rays=rays, tol=2e-3)
    assert np.abs(seen.indirect - bare.indirect).max() < 2e-3 and bare.indirect.min() > 0.01
    np.testing.assert_allclose(seen.error, bare.error, atol=2e-3)


@pytest.fixture(scope="module")
def just_above_the_floor() -> tuple[Any, table.Sendings]:
    """A room with a disk a ten thousandth above its floor, and its table, which rays of the package find made."""
    scene = sr.load(room(disk("D", [0.5, 0.5, 0.0001], [0, 0, 1], 0.25, "both")))
    return scene, table_of(Need(radiometric_arrays(scene), 1e-1))


def test_a_rim_close_by_is_stated(just_above_the_floor: tuple[Any, table.Sendings]) -> None:
    """From a ten thousandth beside the rim much of what is seen may be disk or not; from its middle little."""
    _, made = just_above_the_floor
    owns, places = np.zeros(2, np.int64), np.array([[0.7501, 0.5, 0.0], [0.95, 0.95, 0.0]])
    near, far = made.missed(owns, places)
    assert near > 0.1 * table.brightest(made.forests) > 1e3 * far > 0.0
    assert np.isfinite(made.gathered(owns, np.ones(2, np.int64), places)[:, BOUND]).all()


def test_what_a_ray_meets_close_to_a_rim_states_it(just_above_the_floor: tuple[Any, table.Sendings]) -> None:
    """The bound of what lies along the rim is part of what is stated of the light a ray finds."""
    scene, made = just_above_the_floor
    places = np.array([[0.7502, 0.5, 0.0], [0.7505, 0.5, 0.0]])
    seen = sr.probe(scene, rays=(places + np.array([0, 0, 0.1]), [[0, 0, -1.0], [0, 0, -1.0]]), tol=1e-1)
    assert set(seen.shape) == {"shapes.floor"}
    missed = 0.9 * made.missed(np.zeros(2, np.int64), places)
    assert (seen.error >= missed).all() and missed[0] > 5.0 * missed[1] > 0.0
    assert seen.error[0] > 1.5 * seen.error[1] and seen.status[0] == 1


def test_what_is_not_had_is_refused_by_name() -> None:
    shape = disk("D", [0.5, 0.5, 0.4], [0, 0, 1], 0.25, "grey")
    metal = {"metal": {"type": "conductor", "alpha": 0.3, "eta": 1.5, "k": 3.0}}
    tiles = {"tiles": {"type": "diffuse", "reflectance": {"type": "checker", "bright": 0.6, "dark": 0.2, "cell": 0.5}}}
    for words, scene in (
        ("a texture on a disk", room(shape | {"material": "tiles"}) | {"materials": MATERIALS | tiles}),
        (
            "a conductor or a phong material, and a disk",
            room(shape, rectangle("m", [0.1, 0.1, 0.1], [0.1, 0, 0], [0, 0.1, 0], "metal"))
            | {"materials": MATERIALS | metal, "gloss": "first_hit"},
        ),
        (r"a disk \(bounces: 1 is\)", room(shape, bounces="all")),
        (r"lie in one plane and overlap", room(disk("D", [0.5, 0.5, 0.0], [0, 0, 1], 0.25, "grey"))),
    ):
        # under a sun others of them are known to another rule
        with pytest.raises(Unsupported, match=words):
            sr.probe(scene | {"lights": [SKY]}, rays=([0.5, 0.5, 0.5], [0, 0, -1]), tol=1e-2)


def test_small_disks_have_fewer_corners() -> None:
    counts = [rim_corners(10.0**k, 1.0) for k in np.linspace(-6, 2, 60)]
    assert counts == sorted(counts) and {FEWEST, MOST} <= set(counts) <= {32, 64, 128, 256}
    assert rim_corners(0.1, 1.0) == rim_corners(1e-5, 1e-4) == rim_corners(1e4, 1e5)


def test_chords_lie_on_the_rim_and_in_the_plane() -> None:
    """Where a tilted disk passes through a wall cells are cut; where it does not reach it nothing is."""
    rng, met_walls = np.random.default_rng(2), 0
    for _ in range(60):
        shape = disk("D", rng.uniform(0.1, 0.9, 3), rng.normal(size=3), float(rng.uniform(0.05, 0.6)), "both")
        pieces = make_world(radiometric_arrays(sr.load(room(shape)))).pieces
        for wall in range(6):
            face, round_ = pieces[wall], pieces[6]
            chords = breaks._chords(face, round_)
            sine = float(np.linalg.norm(np.cross(face.up, round_.up)))
            height = abs(float((round_.place - face.place) @ face.up))
            assert len(chords) == int(height < round_.radius * sine)
            for end in chords[0] if chords else ():
                met_walls += 1
                assert abs(float((end - face.place) @ face.up)) < 1e-12
                assert abs(float((end - round_.place) @ round_.up)) < 1e-12
                assert float(np.linalg.norm(end - round_.place)) == pytest.approx(round_.radius, abs=1e-12)
    assert met_walls > 100


def test_the_shadow_of_a_small_disk_is_not_passed_by() -> None:
    """Samples of large cells all missed the shadow of a disk in the sun: off by 90 times what was stated."""
    seed, scale = 5, 1e-4
    scene = with_disks(seed, scale)
    rng = np.random.default_rng([seed, 1])
    origins, ways = scale * rng.uniform(0.2, 0.8, (5, 3)), rng.normal(size=(5, 3))
    rays = origins[4:], ways[4:] / np.linalg.norm(ways[4])
    seen = sr.probe(scene, rays=rays, tol=5e-4)
    at, albedo = met(make_world(radiometric_arrays(sr.load(scene))), *rays)
    mean, wide = reflected_once(scene, at.place[0], at.normal[0], 20000, seed)
    off = np.abs(albedo[0] * mean - seen.indirect[0])
    assert seen.shape == ("shapes.floor",) and (wide < 4e-5).all() and seen.error[0] < 1e-4
    assert (off <= seen.error[0] + 6.0 * albedo[0] * wide).all() and seen.indirect[0, 0] > 0.01
