"""Proved bounds by ball arithmetic: the split rule's values lie inside, and so do the stored ones."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest

from symrender.certify.enclosure import certify
from symrender.errors import OptionError
from symrender.probe import probe
from symrender.scene.arrays import scene_arrays
from symrender.scene.load import load

pytest.importorskip("flint")

ROWS = json.loads((Path(__file__).parents[1] / "data" / "floor_points.json").read_text())["points"]
SOME = [row for row in ROWS if row["exponent"] in (4, 16)][::8]


@pytest.mark.parametrize("row", SOME, ids=lambda row: f"{row['floor_point'][0]:.3f} n={row['exponent']}")
def test_bounds_hold_the_stored_value(row: dict) -> None:
    scene = load("chapter8").replace({"floor.lobe.exponent": float(row["exponent"])})
    proved = certify(scene_arrays(scene), np.array([*row["floor_point"], 0.0]), most_boxes=1000)
    value = np.array(row["gloss_2x2"])
    assert value.max() > 1e-5
    assert proved.holds(value)
    assert (proved.high - proved.low).max() < 6 * value.max() + 1e-3


def test_bounds_tighten_and_stay_around_the_split_rule() -> None:
    scene = load("chapter8").replace({"shading.ks": 0.0})
    point = np.array([1.0842336190554618, 0.1442282860697033, 0.0])
    value = probe(scene, [point], tol=1e-9).gloss[0]
    coarse, fine = (certify(scene_arrays(scene), point, most_boxes=n) for n in (300, 900))
    assert value.max() > 1e-4
    assert coarse.holds(value)
    assert fine.holds(value)
    assert (fine.high - fine.low).max() < 0.8 * (coarse.high - coarse.low).max()
    # a value off by the width is refused
    assert not fine.holds(value + (fine.high - fine.low).max())


def test_furnace_is_enclosed_with_its_background() -> None:
    scene = load("chapter8").replace(
        {"shading.ka": 1.0, "shading.kd": 0.0, "shading.ks": 0.0, "ambient": [0.25] * 3, "background": [0.25] * 3}
    )
    proved = certify(scene_arrays(scene), np.array([1.2, -0.3, 0.0]), most_boxes=300)
    assert proved.holds(np.full(3, 0.25))
    assert (proved.high - proved.low).max() < 0.05


def test_what_is_not_enclosed_is_refused() -> None:
    with pytest.raises(OptionError, match="encloses point lights"):
        probe("chapter8", [(1.2, -0.3)], disk="exact", certify=True)
    with pytest.raises(OptionError, match="only points of the floor"):
        probe("chapter8", [(0.0, 0.0, 1.0)], surface="spheres.A", tol=1e-3, certify=True)
    assert math.isfinite(probe("chapter8", [(1.2, -0.3)], tol=1e-3).error[0])


@pytest.mark.parametrize("center", [(1.2, -0.3, 0.1), (1.2, -0.3, 0.5)])
def test_a_point_within_a_sphere_or_touched_by_one_has_no_enclosure(center: tuple[float, float, float]) -> None:
    scene = load("chapter8").replace({f"spheres.A.center.{axis}": x for axis, x in zip("xyz", center, strict=True)})
    scene = scene.replace({"spheres.A.radius": 0.5})
    with pytest.raises(OptionError, match="lies within a sphere or on one"):
        certify(scene_arrays(scene), np.array([1.2, -0.3, 0.0]), most_boxes=50)


def test_a_room_is_enclosed_wall_by_wall() -> None:
    """Two walls of different colours beside the point: the bounds close, and a room without them is refused."""
    wall = {"texture": {"type": "solid", "color": [0.8, 0.4, 0.1]}}
    other = {"texture": {"type": "solid", "color": [0.1, 0.5, 0.9]}}
    scene = load("chapter8").replace({"floor.lobe.exponent": 3.0, "floor.lobe.theta_max": 1.2, "shading.ks": 0.0})
    data = scene.model_dump(mode="json")
    data["planes"] = [
        {"name": "right", "point": [3, 0, 0], "normal": [-1, 0.2, -0.1], **wall},
        {"name": "front", "point": [0, -3, 0], "normal": [0.1, 1, 0], **other},
    ]
    closed = load(data)
    point = np.array([1.0842336190554618, 0.1442282860697033, 0.0])
    value = probe(closed, [point], tol=1e-9).gloss[0]
    coarse, fine = (certify(scene_arrays(closed), point, width=1e-3, most_boxes=n) for n in (1000, 4000))
    assert value.max() > 0.1
    assert coarse.holds(value)
    assert fine.holds(value)
    assert (fine.high - fine.low).max() < 0.7 * (coarse.high - coarse.low).max()
    assert not fine.holds(probe(scene, [point], tol=1e-9).gloss[0])
    with pytest.raises(OptionError, match="lies in a plane"):
        certify(scene_arrays(closed), np.array([3.0, 0.0, 0.0]))
