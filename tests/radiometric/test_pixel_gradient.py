"""Derivatives of means over pixels against differences of the means."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import symrender as sr
from symrender.gradient import gradient_job
from symrender.runtimes.pixel_gradient import DirectRule, prepare_box
from symrender.runtimes.pixels import prepare_means
from symrender.scene.load import load_any
from symrender.scene.parameters import get
from symrender.scene.radiometric.arrays import radiometric_arrays
from symrender.scene.radiometric.scene import RadiometricScene
from symrender.settings import split_settings

NAMES = ("shapes.B.radius", "camera.eye.x")


def room() -> RadiometricScene:
    """Two balls on tiles before a wall, whose pixels have silhouettes, shadows and texture lines."""
    tiles: dict[str, Any] = {"type": "checker", "bright": 0.8, "dark": [0.1, 0.2, 0.3], "cell": 0.8}
    made = load_any({
        "units": "radiometric", "bounces": 0,
        "camera": {"type": "look_at", "eye": [0.3, -5, 2.4], "target": [0.2, 0, 0.6], "fov": 36},
        "materials": {"tiles": {"type": "diffuse", "reflectance": tiles},
                      "white": {"type": "diffuse", "reflectance": 0.7}},
        "shapes": [
            {"type": "plane", "name": "floor", "point": [0, 0, 0], "normal": [0, 0, 1], "material": "tiles"},
            {"type": "plane", "name": "wall", "point": [0, 2.5, 0], "normal": [0, -1, 0], "material": "white"},
            {"type": "sphere", "name": "A", "center": [-0.4, 0.1, 1.02], "radius": 1, "material": "white"},
            {"type": "sphere", "name": "B", "center": [0.9, -0.4, 0.51], "radius": 0.45, "material": "white"},
        ],
        "lights": [{"type": "point", "name": "key", "position": [2, -2, 4], "intensity": [30, 20, 10]}],
    })  # fmt: skip
    assert isinstance(made, RadiometricScene)
    return made


@pytest.fixture(scope="module")
def slopes() -> sr.Image:
    return sr.gradient(room(), NAMES, size=3, tol=1e-4, filter="box")  # type: ignore[return-value]


@pytest.mark.parametrize("name", NAMES)
def test_derivatives_are_those_of_the_means(slopes: dict[str, sr.Image], name: str) -> None:
    scene, value = room(), float(get(room(), name))

    def central(step: float) -> np.ndarray[Any, Any]:
        high, low = (
            sr.truth(scene.replace({name: value + side * step}), size=3, tol=1e-9, filter="box").radiance
            for side in (1, -1)
        )
        return np.asarray((high - low) / (2 * step))

    near, far = central(1e-3), central(2e-3)
    expected = (4 * near - far) / 3
    scale = np.abs(expected).max()
    # where a wall enters a pixel within the step, differences tell little
    known = np.abs(near - far).max(axis=-1) < 1e-4 * scale
    found, error = slopes[name].radiance, slopes[name].layer("error")
    met = slopes[name].layer("status") == 0
    moving = (np.abs(expected).max(axis=-1) > 1e-3 * scale) & known & met
    assert met.mean() > 0.85 and known.mean() > 0.6 and moving.sum() >= (2 if name != "camera.eye.x" else 6)
    gap = np.abs(found - expected).max(axis=-1)
    # the means state 1e-9 each, over a step of 1e-3
    assert (gap[known & met] <= 1.5 * error[known & met] + 2e-6).all()
    assert np.median(gap[moving]) < 2e-5 * scale


def tiled(at: float, fields: float, fov: float) -> RadiometricScene:
    """One pixel of a checkered floor with a line of it through the middle; it is ``fields`` wide."""
    cell = 20 * np.tan(np.radians(fov / 2)) / fields
    made = load_any({
        "units": "radiometric", "bounces": 0,
        "camera": {"type": "look_at", "eye": [at, -3, 10], "target": [at, 0, 0], "up": [0, 1, 0], "fov": fov},
        "materials": {"floor": {"type": "diffuse", "reflectance": {
            "type": "checker", "cell": float(cell), "bright": 0.9, "dark": 0.1}}},
        "shapes": [{"type": "plane", "name": "floor", "point": [0, 0, 0], "normal": [0, 0, 1], "material": "floor"}],
        "lights": [{"type": "directional", "name": "sun", "direction": [1, 0.2, -1], "irradiance": 3.0}],
    })  # fmt: skip
    assert isinstance(made, RadiometricScene)
    return made


def slope_and_difference(scene: RadiometricScene, name: str, step: float) -> tuple[float, float, float]:
    """(derivative of the one pixel, what it states, the central difference of its means)."""
    image = sr.gradient(scene, [name], size=1, tol=1e-2, filter="box", threads=1, tile=1)[name]
    value = float(get(scene, name))
    high, low = (
        sr.truth(scene.replace({name: value + side * step}), size=1, tol=1e-10, filter="box", threads=1, tile=1)
        for side in (1, -1)
    )
    difference = float((high.radiance - low.radiance)[0, 0, 1]) / (2 * step)
    return float(image.layer("direct")[0, 0, 1]), float(image.layer("error")[0, 0]), difference


@pytest.mark.parametrize(
    ("at", "fields", "fov", "name"),
    [(0.37, 3.8, 0.75, "shapes.floor.point.z"), (0.31, 6.6, 0.13, "shapes.floor.point.z"),
     (0.77, 8.1, 0.32, "camera.eye.x")],
)  # fmt: skip
def test_walls_on_edges_of_cells_are_swept_once(at: float, fields: float, fov: float, name: str) -> None:
    scene = tiled(at, fields, fov)
    found, stated, expected = slope_and_difference(scene, name, 1e-5)
    assert abs(expected) > 1e-5 and stated < 1e-6
    assert abs(found - expected) <= 1e-4 * abs(expected) + 1.5 * stated


def test_a_wall_on_the_border_of_a_pixel_states_half_of_what_it_parts() -> None:
    # its lower edge is the line y = 0 of the floor, seen from above; the camera moves along y
    wide = 2 * 10 * np.tan(np.radians(1.0))
    camera = {"type": "look_at", "eye": [0.05, wide / 2, 10], "target": [0.05, wide / 2, 0], "up": [0, 1, 0], "fov": 2}
    scene = load_any({
        "units": "radiometric", "bounces": 0, "camera": camera,
        "materials": {"floor": {"type": "diffuse", "reflectance": {
            "type": "checker", "cell": 1.0, "bright": 0.9, "dark": 0.1}}},
        "shapes": [{"type": "plane", "name": "floor", "point": [0, 0, 0], "normal": [0, 0, 1], "material": "floor"}],
        "lights": [{"type": "directional", "name": "sun", "direction": [0, 0, -1], "irradiance": np.pi}],
    })  # fmt: skip
    name = "shapes.floor.point.y"
    image = sr.gradient(scene, [name], size=1, tol=1e-2, filter="box", threads=1, tile=1)[name]
    # in one direction a row of fields comes in, in the other nothing; the line x = 0 has the opposite fields beside it
    one_side = 0.8 / wide
    assert image.layer("status")[0, 0] != 0
    assert abs(image.layer("error")[0, 0] - one_side / 2) < 1e-3 * one_side
    assert abs(abs(image.layer("direct")[0, 0, 1]) - one_side / 2 * (0.1 / wide)) < 1e-3 * one_side


@pytest.mark.parametrize("aim", [0.1, 0.2, 1e-3])
def test_a_wall_on_a_line_of_a_texture_has_two_derivatives(aim: float) -> None:
    """Where walls coincide and part: the value lies midway and half of the difference is stated, by either shape.

    With the last aim the contact is the edge of cells all along, for the camera looks straight at it.
    """
    tiles = {"type": "checker", "bright": 0.8, "dark": 0.2, "cell": 1}
    target = [aim, 1.9, 0.1] if aim > 0.01 else [0.1, 2.0, 0.0]
    scene = load_any({
        "units": "radiometric", "bounces": 0,
        "camera": {"type": "look_at", "eye": [target[0], -6, 3], "target": target, "fov": 8},
        "materials": {"tiles": {"type": "diffuse", "reflectance": tiles},
                      "white": {"type": "diffuse", "reflectance": 0.5}},
        "shapes": [
            {"type": "plane", "name": "floor", "point": [0, 0, 0], "normal": [0, 0, 1], "material": "tiles"},
            {"type": "plane", "name": "wall", "point": [0, 2, 0], "normal": [0, -1, 0], "material": "white"},
        ],
        "lights": [{"type": "point", "name": "key", "position": [1, -3, 4], "intensity": 30}],
    })  # fmt: skip
    names, at_rest = ["shapes.wall.point.y", "shapes.floor.point.y", "camera.eye.y"], {}
    images = sr.gradient(scene, names, size=1, tol=1e-4, filter="box", threads=1)

    def mean(name: str, step: float) -> float:
        moved = scene.replace({name: float(get(scene, name)) + step})
        return float(sr.truth(moved, size=1, tol=1e-9, filter="box", threads=1).radiance[0, 0, 0])

    for name in names:
        at_rest.setdefault("", mean(name, 0.0))
        sides = []
        for sign in (1, -1):
            far, near = (sign * (mean(name, sign * step) - at_rest[""]) / step for step in (2e-4, 1e-4))
            sides.append(2 * near - far)
        apart, found = abs(sides[0] - sides[1]) / 2, images[name]
        error = float(found.layer("error")[0, 0])
        assert (apart > 1e-3) == (name != "camera.eye.y") and abs(sum(sides)) > 1e-3
        assert abs(float(found.radiance[0, 0, 0]) - sum(sides) / 2) < 1e-5 + 0.05 * error
        assert apart <= error + 1e-6 and error <= 1.4 * apart + 1e-4
        assert (found.layer("status")[0, 0] == 0) == (name == "camera.eye.y")


def pixel_slope(
    scene: RadiometricScene, name: str, size: int, tol: float, column: int, row: int
) -> tuple[np.ndarray[Any, Any], float, np.ndarray[Any, Any]]:
    """(derivative of a pixel of an image, what it states, the central difference of its mean)."""
    settings = split_settings(
        size, tol=tol, disk="2x2", aa="analytic", budget=1_000_000, threads=1, tile=0, filter="box"
    )  # fmt: skip
    job, place = gradient_job(scene, [name], settings), (column, row, column + 1, row + 1)
    layers = job.empty_layers()
    prepare_box(radiometric_arrays(scene), settings, job.wrt)(*place, layers)
    value, sides = float(get(scene, name)), []
    fine = replace(settings, tol=1e-10)
    for side in (1, -1):
        moved = radiometric_arrays(scene.replace({name: value + side * 1e-5}))
        emitted, direct, _, _ = prepare_means(moved, fine)(*place)
        sides.append((emitted + direct)[0, 0])
    return (
        layers[f"radiance:{name}"][row, column],
        float(layers[f"error:{name}"][row, column]),
        (sides[0] - sides[1]) / 2e-5,
    )


def test_cells_that_err_either_way_do_not_hide_each_other() -> None:
    # the rim of a ball of metal: what the cells' rules differ by adds up to a tenth of what they are off by
    scene = sr.load("metal").replace({"bounces": 0})
    assert isinstance(scene, RadiometricScene)
    found, stated, expected = pixel_slope(scene, "shapes.A.center.x", 32, 1e-4, 7, 9)
    assert np.abs(expected).max() > 5e-3 and stated <= 1e-4
    assert np.abs(found - expected).max() <= 1.5 * stated + 1e-6


def test_budgets_know_what_a_node_costs(monkeypatch: pytest.MonkeyPatch) -> None:
    # of direct light one evaluation: taken for more, rounds look at few parts each and pixels miss their tolerance
    seen: list[tuple[np.ndarray[Any, Any], np.ndarray[Any, Any]]] = []
    plain = DirectRule._next

    def noted(self: DirectRule, state: Any, outer: Any, whole: Any, pixels: Any, tol: float, budget: int) -> Any:
        seen.append((pixels.nodes.copy(), pixels.evaluations.copy()))
        return plain(self, state, outer, whole, pixels, tol, budget)

    monkeypatch.setattr(DirectRule, "_next", noted)
    scene = sr.load("metal").replace({"bounces": 0})
    assert isinstance(scene, RadiometricScene)
    pixel_slope(scene, "shapes.A.center.x", 32, 1e-4, 7, 9)
    assert len(seen) > 2 and seen[-1][1].sum() > 500
    assert all((nodes == evaluations).all() for nodes, evaluations in seen)


def test_slopes_and_sweeps_that_err_by_as_much_do_not_hide_each_other() -> None:
    # a part of this pixel has the limb of a ball in it: what its first two rules differ by in slopes is what they
    # differ by in sweeps, and both are four hundred times the difference of the sums
    scene = sr.load("metal").replace({"bounces": 0})
    assert isinstance(scene, RadiometricScene)
    found, stated, expected = pixel_slope(scene, "shapes.A.center.x", 64, 1e-3, 10, 20)
    assert np.abs(expected).min() > 1.0 and stated <= 1e-3
    assert np.abs(found - expected).max() <= 1.5 * stated + 1e-5
