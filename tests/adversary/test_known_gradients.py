"""The wrong derivatives that were found: asked alone and with others, and of a ball that covers the lobe."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from .case import Case
from .slopes import asked, differences, judge_slope, names_of

KNOWN: list[dict[str, Any]] = json.loads((Path(__file__).parent / "known_gradients.json").read_text("utf-8"))

# the first call compiles the reverse rule, which takes minutes
pytestmark = pytest.mark.timeout(2400)


def case_of(entry: dict[str, Any]) -> Case:
    return Case(**{k: entry[k] for k in Case.__dataclass_fields__ if k in entry})


def test_alone_is_together() -> None:
    case = case_of(KNOWN[0])
    assert (
        judge_slope(case, "shading.shininess", asked(case, ["shading.shininess"]), asked(case, names_of(case))).called
        != "torn"
    )


def test_a_ball_that_covers_the_lobe_moves_nothing() -> None:
    case = case_of(KNOWN[1])
    alone = asked(case, ["camera.eye.x"])
    slope = judge_slope(case, "camera.eye.x", alone, alone)
    assert slope.called in ("honest", "untold"), slope


def test_a_light_that_leaves_a_plane_lights_it_on_one_side_alone() -> None:
    from symrender.quadrature.split_setup import EVENT

    case, name = case_of(KNOWN[2]), "lights.L0.position.z"
    found = asked(case, [name, "lights.L0.position.x"])
    assert found.gradient_status[name][0] == EVENT
    assert found.gradient_status["lights.L0.position.x"][0] != EVENT
    risen = {"lights": [{**case.scene["lights"][0], "position": [-1.03, 2.28, 1e-9]}]}
    assert asked(replace(case, scene={**case.scene, **risen}), [name]).gradient_status[name][0] != EVENT


def test_a_rim_that_runs_to_the_horizon_past_a_light_doubts_itself() -> None:
    case, name = case_of(KNOWN[4]), "camera.eye.x"
    # central differences of values at 1e-12, the same for steps of 1e-4 to 1e-6
    differs = np.array([-0.00394784725, 0.03190941355, -0.00657974537])
    found = asked(case, [name])
    stated = found.gradient_error[name][0]
    assert stated < 1e-5
    assert np.abs(found.gradient[name][0] - differs).max() <= stated + 1e-9
    slope = judge_slope(case, name, found, found)
    assert slope.called in ("honest", "untold") and abs(slope.value).max() > 0.01, slope


def test_changes_that_stay_as_large_add_up() -> None:
    case, names = case_of(KNOWN[5]), ["spheres.S1.radius", "spheres.S2.radius"]
    # central differences of values at 1e-12, the same for steps of 1e-5 and 1e-6
    differs = np.array([5.10267157e-02, -3.09264182e-05, -1.61451674])
    for asked_for in (names[:1], names):
        found = asked(case, asked_for)
        stated = found.gradient_error[names[0]][0]
        assert stated < 1e-5
        assert np.abs(found.gradient[names[0]][0] - differs).max() <= stated + 1e-8


def test_squares_beyond_the_taper_are_part_of_what_is_stated() -> None:
    case, name = case_of(KNOWN[6]), "spheres.S1.center.y"
    # central differences of values at 1e-12, the same for steps of 1e-5 and 1e-6
    differs = np.array([-0.02051488, -0.04068886, -0.01027511])
    for asked_for in ([name], ["lights.L2.position.z", name]):
        found = asked(case, asked_for)
        stated = found.gradient_error[name][0]
        assert stated < 1e-5
        assert np.abs(found.gradient[name][0] - differs).max() <= stated + 1e-8


def test_differences_doubt_what_ends_like_the_power_three_halves() -> None:
    case, name = case_of(KNOWN[3]), "spheres.S0.radius"
    claim = asked(case, [name]).gradient[name][0]
    value, doubt, _ = differences(case, 0, name, turn=0.1, cells=48)
    away = float(abs(claim - value).max())
    assert away > 1e-4, "differences are off there"
    assert away < doubt < 0.05 * float(abs(claim).max())


def test_differences_know_a_closed_form() -> None:
    """A ball on the axis of a lobe hides 1 - cos^(n + 1) half-angle of a white sky; its derivative in the radius."""
    lobe = {"weight": 1.0, "exponent": 3.0, "theta_max": 1.5707963267948966}
    scene: dict[str, Any] = {
        "camera": {"type": "look_at", "eye": [0.0, 0.0, 9.0]},
        "spheres": [{"name": "A", "center": [0.0, 0.0, 4.0], "radius": 1.0, "color": [0.0, 0.0, 0.0]}],
        "floor": {"texture": {"type": "solid", "color": [0.0, 0.0, 0.0]}, "lobe": lobe},
        "lights": [],
        "background": [1.0, 1.0, 1.0],
        "shading": {"ka": 0.0},
    }
    case = Case("closed form", 0, scene, "floor", [[0.0, 0.0, 0.0]], "1x1", 1e-9)
    value, doubt, _ = differences(case, 0, "spheres.A.radius", turn=0.1, cells=48)
    # mean = (1 - R^2/16)^2
    assert abs(value[0] - 2.0 * (1.0 - 1.0 / 16.0) * (-2.0 / 16.0)) <= doubt + 1e-9 and doubt < 1e-5


def test_a_narrow_rim_on_squares_states_what_rounding_leaves() -> None:
    # mean and rim's integral cancel to one part in 2000, and the ellipse is known to 1e-9
    case, name = case_of(KNOWN[7]), "spheres.S0.lobe.theta_max"
    alone = asked(case, [name])
    slope = judge_slope(case, name, alone, alone)
    assert slope.called == "honest", slope
