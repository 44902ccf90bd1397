from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from symrender.errors import OptionError
from symrender.scene import arrays as at
from symrender.studies.budget import CAUSES, WALLS, _Cells, _jumps, budget
from symrender.studies.lobe_rays import BEHIND, BELOW, LIGHTS, LIT, SHADED, SHAPE, TEXTURE, LobeRays
from symrender.studies.report import Study
from symrender.studies.subject import subject

RULES: list[dict[str, Any]] = [
    {"lobe": 4},
    {"lobe": 8, "partition": "equal_weight", "nodes": "barycentre"},
    {"lobe": 4, "weights": "midpoint", "normalised": True},
]


def shares(study: Study) -> dict[str, float]:
    table = study.table("error by cause")
    return dict(zip(table.column("cause"), table.column("share"), strict=True))


@pytest.mark.parametrize("rule", RULES, ids=str)
def test_the_causes_close_to_the_measured_error(rule: dict[str, Any]) -> None:
    study = budget("gloss", size=16, pixels=24, **rule)
    assert study.facts["pixels drawn"] == 24
    assert float(study.facts["signal of these, RMS"] or 0) > 0.05
    table = study.table("error by cause")
    rmse = dict(zip(table.column("cause"), table.column("relative RMSE"), strict=True))
    left = dict(zip(table.column("cause"), table.column("if cut"), strict=True))
    assert rmse["measured"] > 0.02
    found = shares(study)
    assert abs(found["all causes"] - 1) < 0.01 and abs(float(study.facts["does not close"] or 0)) < 0.01
    assert rmse["all causes"] == pytest.approx(rmse["measured"], rel=0.01)
    assert left["all causes"] < 0.05 * rmse["measured"]
    assert found["all causes"] == pytest.approx(sum(found[cause] for cause in CAUSES), abs=1e-12)
    # without its largest cause an estimator must be better
    largest = max(WALLS, key=lambda cause: found[cause])
    assert found[largest] > 0.3 and left[largest] < 0.9 * rmse["measured"]
    assert (abs(found["weight"]) < 1e-12) == (rule.get("weights", "exact") == "exact")


def test_a_plain_scene_has_one_cause() -> None:
    """One grey sphere without texture under ambient light alone: its silhouette is the only wall."""
    study = budget(lone_sphere(), size=16, pixels=24, lobe=4)
    found = shares(study)
    assert found["silhouette"] > 0.99
    assert found["texture edge"] == found["terminator"] == found["shadow edge"] == 0


@pytest.mark.parametrize("rule", RULES, ids=str)
def test_the_nodes_are_those_of_the_kernel(rule: dict[str, Any]) -> None:
    of = subject("gloss", size=16)
    gloss = of.layers("symbolic", **rule)["gloss"]
    mask = of.glossy(of.places()["hit_class"]) & (gloss.max(axis=2) > 0.02)
    pixels = np.argwhere(mask)[::7]
    assert len(pixels) >= 8
    whole = {"weights": "exact", "nodes": "midpoint", "partition": "equal_angle", "normalised": False} | rule
    cells = _Cells(of, whole, 32)
    places = of.places()
    cells.errors((int(pixels[0, 0]), int(pixels[0, 1])))
    (layout,) = cells._layouts.values()
    for j, i in pixels:
        normal = places["normal"][j, i]
        frame = cells._rays.frame(places["incoming"][j, i], normal)
        seen = cells._rays.see(places["place"][j, i], normal, at.FLOOR, layout.nodes @ frame).radiance
        weights = np.repeat(layout._weights / rule["lobe"], rule["lobe"])
        np.testing.assert_allclose(weights @ seen, gloss[j, i], rtol=1e-11, atol=1e-14)


def test_labels_say_which_side_of_a_wall() -> None:
    of = subject(
        {
            "camera": {"type": "look_at", "eye": [0, -4, 2], "target": [0, 0, 0]},
            "spheres": [
                {"name": "A", "center": [0, 0, 3], "radius": 1, "texture": {"type": "stripes", "ku": 2, "dark": 0.5}},
                {"name": "B", "center": [4, 0, 3], "radius": 0.5},
            ],
            "floor": {"lobe": {"weight": 1, "exponent": 4, "theta_max": 1}},
            "lights": [{"name": "key", "type": "point", "position": [9, 0, 3], "color": [1, 1, 1]}],
        },
        size=8,
    )
    rays = LobeRays(of.arrays, 2)
    up = np.array([0.0, 0.0, 1.0])
    ends = {
        "lit": (0.3, -0.2, 2.07),
        "behind": (-0.5, 0.0, 2.134),
        "shaded": (0.7, -0.2, 2.32),
        "passes by": (9.0, 9.0, 3.0),
        "below": (1.0, 1.0, -1.0),
    }
    place = np.array([0.0, -0.2, 0.0])
    directions = np.array(list(ends.values())) - place
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    found = rays.see(place, up, at.FLOOR, directions)
    assert found.labels[:, SHAPE].tolist() == [2, 2, 2, at.NOTHING, BELOW]
    assert found.labels[:3, LIGHTS].tolist() == [LIT, BEHIND, SHADED]
    assert set(found.labels[:3, TEXTURE].tolist()) <= {0, 1}
    assert found.radiance[0].max() > 0 and not found.radiance[4].any()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"nodes": "gauss"}, "nodes: 'gauss' has no cells"),
        ({"pixels": 0}, "pixels, fine: must be >= 1"),
        ({"lobe": 8, "fine": 4}, "from K = 8"),
    ],
)  # fmt: skip
def test_options_are_refused_in_one_line(options: dict[str, Any], message: str) -> None:
    with pytest.raises(OptionError, match=message):
        budget("gloss", size=8, **options)


def lone_sphere() -> dict[str, Any]:
    return {
        "name": "lone",
        "camera": {"type": "look_at", "eye": [0, -4, 2], "target": [0, 0, 0.3]},
        "spheres": [{"name": "A", "center": [0, 0, 1], "radius": 0.8, "color": [0.5, 0.5, 0.5]}],
        "floor": {"lobe": {"weight": 1, "exponent": 16, "theta_max": 1}},
        "ambient": [1, 1, 1],
        "shading": {"ka": 1, "kd": 0, "ks": 0},
    }


def test_a_change_of_several_labels_has_one_cause() -> None:
    """Leaving a sphere for what lies below the horizon changes shape, texture and light: it is the horizon alone."""
    label = np.array([[0, 1, LIT], [2, 1, LIT], [2, 0, LIT], [2, 0, SHADED], [2, 0, BEHIND], [BELOW, 1, LIT]])
    f = np.arange(6.0)[None, None, :, None] ** 2 * np.ones(3)
    jumps = _jumps(f, label[None, None], np.array([0.5]), axis=2)[:, 0]
    by_wall = dict(zip(WALLS, (jumps / 1.5).tolist(), strict=True))
    assert by_wall == {"silhouette": 1, "texture edge": 3, "shadow edge": 5, "terminator": 7, "horizon": 9}
