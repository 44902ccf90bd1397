"""What a cell of a window may weigh and show at most, against what its places do."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from tests.radiometric import flats
from tests.radiometric.test_cut_bounce import CLAY, KEY, METAL, SPOT, SUN, WAVES, WAX, balls, room

from symrender.radiometric.direct import direct_light
from symrender.radiometric.pixels.cells import BOX, Cell, Eye, Lobe
from symrender.radiometric.pixels.lobes import density_about, light_bound, sent_share, weight_bound, window_of
from symrender.radiometric.pixels.records import make_room
from symrender.radiometric.pixels.sight import put_reach
from symrender.radiometric.reflection import reflected
from symrender.radiometric.sight import nearest
from symrender.radiometric.sky import sky_room
from symrender.radiometric.world import make_world
from symrender.scene.load import load_any
from symrender.scene.radiometric.arrays import radiometric_arrays

Array = np.ndarray[Any, np.dtype[np.float64]]


def above(rng: np.random.Generator) -> Array:
    """A unit vector above the plane z = 0, often a grazing one."""
    z, turn = rng.uniform(0, 1) ** rng.choice([1, 3]), rng.uniform(0, 2 * math.pi)
    s = math.sqrt(1 - z * z)
    return np.array([s * math.cos(turn), s * math.sin(turn), z])


@pytest.mark.parametrize("kind", ["ggx", "beckmann", "phong"])
@pytest.mark.parametrize("width", [0.05, 0.6, 0.8, 1.0])
def test_no_pair_of_directions_is_brighter(kind: str, width: float) -> None:
    rng, reached = np.random.default_rng(1), 0.0
    given: dict[str, Any] = METAL | {"alpha": width, "distribution": kind}
    for masking in ("separable", "correlated"):
        if kind == "phong":
            given = WAX | {"exponent": 4.0 / width, "reflectance": 1.0}
        else:
            given["masking"] = masking
        scene = flats.world(flats.plane("p", [0, 0, 0], [0, 0, 1]), lights=[], materials={"white": given})
        material = radiometric_arrays(load_any(scene)).materials[0]
        for _ in range(700):
            view = above(rng)
            mirror = view * [-1, -1, 1]
            light = above(rng) if rng.random() < 0.3 else mirror + rng.normal(size=3) * width * 0.7
            light /= np.linalg.norm(light)
            if light[2] <= 0.0:
                continue
            half = (view + light) / np.linalg.norm(view + light)
            cosine = light @ mirror if kind == "phong" else half[2]
            bound = density_about(material, math.acos(max(-1.0, min(1.0, float(cosine)))))
            found = max(reflected(material, (1.0, 1.0, 1.0), (0.0, 0.0, 1.0), tuple(view), tuple(light)))
            assert found <= bound * (1 + 1e-9) + 1e-15
            reached = max(reached, found / bound if bound > 0 else 0.0)
    # nothing is given away by much
    assert reached > 0.7


def test_no_place_of_a_cell_weighs_or_shows_more() -> None:
    rng, weighed, shown, lit = np.random.default_rng(2), [], [], 0
    bump = {"amplitude": 0.05, "height": WAVES}
    scenes = [balls(m | {"bump": bump | {"normals": n}}, KEY, SUN, SPOT)
              for m in (CLAY, METAL, WAX) for n in ("shading", "geometric")]  # fmt: skip
    for scene in (*scenes, room(), room(bump)):
        world = make_world(radiometric_arrays(load_any(scene)))
        scratch, sky = make_room(world), sky_room(world)
        for _ in range(60):
            own = int(rng.integers(len(world.pieces)))
            up, view, turned = above(rng), above(rng), above(rng)
            first = np.cross(up, rng.normal(size=3))
            first /= np.linalg.norm(first)
            place = tuple((rng.uniform(-1.5, 1.5, 3) + np.array([0, 0, 1.6])).tolist())
            v, vx, vy, area = window_of(
                int(rng.integers(5)), tuple(up), tuple(first), tuple(np.cross(up, first))
            )  # fmt: skip
            size, (x, y) = float(rng.choice([1.0, 0.25, 0.03])), rng.uniform(-1, 1, 2)
            x, y = x * (1 - size), y * (1 - size)
            middle = np.array(v) + x * np.array(vx) + y * np.array(vy)
            cell = Cell(
                tuple(middle), tuple(size * np.array(vx)), tuple(size * np.array(vy)), 0, 1.0, 0.0, 0.0, 0.0, 1.0
            )
            lobe = Lobe(own, world, tuple(up), tuple(turned), tuple(view), (0.9, 0.5, 0.2), area)
            eye = Eye(world, world, place, None, None, 0.0, True, BOX, None, None, lobe)  # type: ignore[arg-type]
            # from inside a ball all of a wide cell may be anywhere
            with np.errstate(divide="ignore"):
                limit = put_reach(eye, cell, scratch)
            most, bright = weight_bound(eye, cell), light_bound(eye, cell, scratch, limit)
            for a, b in rng.uniform(-1, 1, (12, 2)):
                d = middle + a * np.array(cell.vx) + b * np.array(cell.vy)
                share = max(sent_share(lobe, tuple(d)))
                assert share <= most * (1 + 1e-9)
                weighed.append(share / most if most > 0 else 0.0)
                d /= np.linalg.norm(d)
                met, _, at, normal, front = nearest(world, place, tuple(d))
                if met < 0 or met == own:
                    continue
                light = max(direct_light(world, met, front, at, normal, tuple(-d), sky))
                assert light <= bright * (1 + 1e-9)
                shown.append(light / bright)
                lit += light > 0
    assert lit > 300 and max(weighed) > 0.95 and max(shown) > 0.3
