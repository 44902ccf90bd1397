"""Gradients of the split rule against differences of its values, the Reynolds form, closed forms and refusals."""

from __future__ import annotations

import math

import numpy as np
import pytest

from adversary.families import generate
from symrender.chambers.chart import set_frame
from symrender.chambers.records import Chart
from symrender.errors import SceneError, Unsupported
from symrender.jit.records import table
from symrender.probe import probe
from symrender.scene.load import load
from symrender.scene.parameters import get
from symrender.scene.scene import Scene

OBLIQUE = {"camera": {"type": "look_at", "eye": (3.0, -3.0, 2.0)}}
CASES = [
    # a floor point that sees a checkered sphere before another one, its terminator and its shadows
    (
        "chapter8",
        OBLIQUE,
        "floor",
        (0.9, -0.85, 0.0),
        [
            *("camera.eye.x", "spheres.A.radius", "floor.lobe.exponent", "floor.lobe.theta_max"),
            *("lights.key.position.z", "spheres.A.color.r", "shading.shininess"),
        ],
    ),
    # a sphere's lobe: the checkered floor with shadows on it, other spheres, the horizon
    (
        "gloss",
        {},
        "spheres.A",
        (0.61898402, -0.77509971, 0.1268039),
        [
            *("spheres.A.radius", "floor.texture.cell", "floor.texture.offset.y", "floor.texture.bright.r"),
            *("lights.fill.position.x", "camera.eye.z", "spheres.B.center.x"),
        ],
    ),
]


def differences(
    scene: Scene, point: tuple, surface: str, name: str, step: float, known: float = 1e-11
) -> tuple[np.ndarray, float]:
    """Richardson's extrapolation of central differences of values ``known`` so well, and its last change."""
    at = float(get(scene, name))

    def value(x: float) -> np.ndarray:
        tol = 0.1 * known if known < 1e-10 else known
        found = probe(scene.replace({name: x}), [point], surface=surface, tol=tol, budget=4_000_000)
        assert found.error[0] <= known
        return found.gloss[0]

    rows: list[np.ndarray] = []
    for k in range(3):
        h = step / 2**k
        row = [(value(at + h) - value(at - h)) / (2 * h)]
        row += [row[0] + (row[0] - rows[0]) / 3] if rows else []
        row += [row[1] + (row[1] - rows[1]) / 15] if len(rows) > 1 else []
        rows, last = row, rows
    return rows[-1], float(np.abs(rows[-1] - last[-1]).max())


@pytest.mark.parametrize(("name", "changes", "surface", "point", "wrt"), CASES)
def test_differences_of_values(name: str, changes: dict, surface: str, point: tuple, wrt: list[str]) -> None:
    scene = load(name).replace(changes)
    point = tuple(np.array(point) / np.linalg.norm(point)) if surface != "floor" else point
    found = probe(scene, [point], surface=surface, tol=1e-11, wrt=wrt)
    assert all(status[0] in (0, 1) for status in found.gradient_status.values())
    felt = 0
    for parameter in wrt:
        # longer steps of this radius pass visual events: walls over corners of the checker
        step = 2.5e-4 if (name, parameter) == ("gloss", "spheres.A.radius") else 1e-3
        expected, change = differences(scene, point, surface, parameter, step)
        size = float(np.abs(expected).max())
        # differences that cannot tell would pass anything
        assert change <= 3e-7 * size, parameter
        gap = float(np.abs(found.gradient[parameter][0] - expected).max())
        assert gap <= 1e-8 * size + 3 * change + 1e-10, parameter
        assert gap <= found.gradient_error[parameter][0] + 3 * change + 1e-9 * size + 1e-10, parameter
        felt += size > 1e-5
    assert felt >= 5


@pytest.mark.parametrize(
    ("normal", "name"),
    [
        # all meridians of sphere A's checker meet in a pole it sees, and the floor reaches far into its own horizon
        ((0.140867, -0.961435, -0.236218), "lights.key.color.b"),
        # the edge of what it sees of the floor runs on along the checker, so that far squares count
        ((-0.315373, -0.276777, 0.907708), "floor.texture.bright.g"),
    ],
)
def test_what_a_lobe_is_linear_in(normal: tuple, name: str) -> None:
    """Of a number the value is linear in, any difference of values is the derivative."""
    scene = load("chapter8").replace(OBLIQUE)
    point = np.array(normal) / np.linalg.norm(normal)
    found = probe(scene, [point], surface="spheres.B", tol=1e-11, wrt=[name])
    sides = [
        probe(scene.replace({name: at}), [point], surface="spheres.B", tol=1e-11, budget=4_000_000).gloss[0]
        for at in (0.25, 0.75)
    ]
    expected = 2.0 * (sides[1] - sides[0])
    size = float(np.abs(expected).max())
    assert size > 0.01
    gap = float(np.abs(found.gradient[name][0] - expected).max())
    assert gap <= found.gradient_error[name][0] + 1e-9 * size
    assert found.gradient_error[name][0] <= 1e-8 * size


@pytest.mark.parametrize(("offset", "tol"), [(-(2.0**-11), 1e-11), (-(2.0**-14), 1e-10)])
def test_pieces_between_events_count_once(offset: float, tol: float) -> None:
    """A penumbra's shadows touch scan lines at events 1e-10 apart; slopes there are inverse square roots."""
    scene = load("penumbra").replace({"floor.lobe.exponent": 12.0})
    scene = scene.replace({"spheres.B.center.z": 0.72 + offset})
    point, name = (0.346918, -1.717039, 0.0), "spheres.B.center.z"
    found = probe(scene, [point], tol=tol, wrt=[name])
    expected, change = differences(scene, point, "floor", name, 1e-4)
    size = float(np.abs(expected).max())
    assert size > 0.01
    assert change <= 1e-7 * size
    gap = float(np.abs(found.gradient[name][0] - expected).max())
    assert gap <= found.gradient_error[name][0] + change + 1e-7 * size


def ball(**changes: object) -> Scene:
    """One sphere of constant radiance 1 over a floor, and nothing else."""
    return load(
        {
            "camera": {"type": "look_at", "eye": [2.0, -2.5, 1.5]},
            "spheres": [{"name": "S", "center": [-0.6, 0.9, 1.1], "radius": 0.5}],
            "floor": {"texture": {"type": "solid"}, "lobe": {"exponent": 9.0}},
            "ambient": [1.0, 1.0, 1.0],
            "background": [0.25, 0.25, 0.25],
            "shading": {"ka": 1.0, "kd": 0.0, "ks": 0.0},
        }
    ).replace(changes)


def test_reynolds_form_of_a_silhouette() -> None:
    """d/dp of the lobe's mass on a disc of directions: its density times how fast the circle moves, around it.

    Written from the geometry alone: with alpha the disc's angular radius and c its axis, the circle moves outwards by
    d alpha + dc . n, d alpha/dR = 1/sqrt(d^2 - R^2), d alpha/dd = -R/(d sqrt(d^2 - R^2)).
    """
    scene, place = ball(), np.array([0.3, -0.2, 0.0])
    center, radius = np.array(scene.spheres[0].center), scene.spheres[0].radius
    eye = np.array(scene.camera.eye)
    incoming = (place - eye) / np.linalg.norm(place - eye)
    mirror = incoming * [1.0, 1.0, -1.0]
    away = center - place
    far = np.linalg.norm(away)
    axis, sine = away / far, radius / far
    side = np.cross(axis, [0.0, 0.0, 1.0])
    side /= np.linalg.norm(side)
    other = np.cross(axis, side)
    turn = 2 * np.pi * np.arange(256) / 256
    outward = np.cos(turn)[:, None] * side + np.sin(turn)[:, None] * other
    cosine = math.sqrt(1 - sine**2)
    edge = cosine * axis + sine * outward
    u = scene.floor.lobe.exponent + 1
    theta_max = scene.floor.lobe.theta_max
    density = (edge @ mirror) ** (u - 1) * u / (2 * np.pi * (1 - math.cos(theta_max) ** u))
    assert (edge @ mirror).min() > math.cos(theta_max)  # the whole disc lies inside the lobe
    assert edge[:, 2].min() > 0
    tangent = math.sqrt(far**2 - radius**2)
    speeds = {"spheres.S.radius": np.full(256, 1 / tangent)}
    for k, letter in enumerate("xyz"):
        move = np.eye(3)[k]
        recede = move @ axis
        speeds[f"spheres.S.center.{letter}"] = -radius / (far * tangent) * recede + outward @ move / far
    found = probe(scene, [place], tol=1e-12, wrt=list(speeds))
    for name, speed in speeds.items():
        expected = 0.75 * (density * speed).sum() * 2 * np.pi / 256 * sine
        assert abs(expected) > 1e-3
        assert found.gradient[name][0] == pytest.approx(np.full(3, expected), rel=1e-10)


def test_a_lobe_of_constant_radiance_does_not_change() -> None:
    """In a world of one radiance all silhouettes contribute, and the sum of what they sweep is nothing."""
    scene = ball(background=(1.0, 1.0, 1.0))
    scene = scene.replace({"floor.lobe.theta_max": 0.4})
    names = ["spheres.S.center", "spheres.S.radius", "camera.eye"]
    found = probe(scene, [(0.3, -0.2, 0.0)], tol=1e-12, wrt=names)
    assert len(found.gradient) == 7
    for name, value in found.gradient.items():
        assert np.abs(value).max() < 1e-12, name


@pytest.mark.parametrize("tol", [1e-4, 1e-6, 1e-10])
@pytest.mark.parametrize(
    ("exponent", "theta_max", "name"),
    [
        *((0.0, math.pi / 2, "spheres.S.radius"), (0.5, math.pi / 2, "camera.eye.x")),
        *((0.0, 1.5, "floor.lobe.theta_max"), (5.0, 1.5, "floor.lobe.theta_max")),
    ],
)
def test_the_rim_of_a_blunt_lobe_moves(exponent: float, theta_max: float, name: str, tol: float) -> None:
    """Rounding may put a rim in the plane across the axis outside the lobe; a rim that is felt is not cut off."""
    # the sphere lies across the rim
    scene = ball(**{"spheres.S.center": (0.98, -1.12, 2.18), "floor.lobe.exponent": exponent})
    scene = scene.replace({"floor.lobe.theta_max": theta_max})
    place = (0.3, -0.2, 0.0)
    found = probe(scene, [place], tol=tol, wrt=[name])
    # a density that ends with a broken power costs too much to be known to more digits
    known = 1e-10 if exponent != math.floor(exponent) else 1e-11
    expected, change = differences(scene, place, "floor", name, 1e-3, known)
    assert np.abs(expected).max() > (1e-4 if exponent < 1.0 else 1e-7)
    gap = float(np.abs(found.gradient[name][0] - expected).max())
    # the values' own error over the shortest step
    assert gap <= found.gradient_error[name][0] + change + known / 2.5e-4


def test_a_lobe_aimed_at_a_centre_has_a_square_frame() -> None:
    """There the frame's second axis was the rounding of a product, which leaned into the first one."""
    chart = table(Chart, 1)[0]
    rng = np.random.default_rng(5)
    for size in np.logspace(-16, 0, 200):
        pole, other = rng.normal(size=(2, 3))
        pole /= np.linalg.norm(pole)
        axis = pole + size * other
        axis /= np.linalg.norm(axis)
        chart.pole[:] = pole
        set_frame(chart, *axis)
        frame = np.stack([chart.pole, chart.e1, chart.e2])
        assert np.abs(frame @ frame.T - np.eye(3)).max() < 1e-14


@pytest.mark.parametrize(("seed", "names"), [(0, ("camera.eye.x", "lights.L0.position.y")), (10, ("camera.eye.x",))])
def test_what_orders_agree_on_by_chance_is_stated(seed: int, names: tuple[str, ...]) -> None:
    """Highlights that two orders did not see, or saw alike, were stated to some 1e-7, or to nothing at all."""
    case = generate("highlight", seed)
    scene = load(case.scene)
    both = probe(scene, case.points[:1], surface=case.surface, tol=1e-5, wrt=names)
    for name in names:
        expected, change = differences(scene, case.points[0], case.surface, name, 3e-5)
        alone = probe(scene, case.points[:1], surface=case.surface, tol=1e-5, wrt=[name])
        for found in (both, alone):
            gap = float(np.abs(found.gradient[name][0] - expected).max())
            assert gap <= found.gradient_error[name][0] + 3 * change + 1e-10, name


@pytest.mark.parametrize("lobe", [{"mirror": True}, {"exponent": 9.0, "theta_max": 1e-7}])
def test_a_mirror_has_no_derivative(lobe: dict) -> None:
    """Its rim is narrower than what rounding leaves of a circle; a cone of 1e-5 stood in for it, and said nothing."""
    found = probe(ball(**{"floor.lobe": lobe}), [(0.3, -0.2, 0.0)], wrt=["spheres.S.center.x"])
    assert found.gradient_status["spheres.S.center.x"][0] == 3
    assert np.isinf(found.gradient_error["spheres.S.center.x"][0])


def test_walls_that_part_are_told() -> None:
    """Sphere A of chapter8 is cut by the floor at a line of its own checker: raising it uncovers other fields."""
    scene = load("chapter8").replace(OBLIQUE)
    names = ["spheres.A.center.z", "spheres.A.texture.kv", "spheres.B.center.z"]
    found = probe(scene, [(0.9, -0.85, 0.0)], tol=1e-9, wrt=names)
    assert found.gradient_status["spheres.A.center.z"][0] == 4
    assert found.gradient_status["spheres.A.texture.kv"][0] == 4
    assert found.gradient_status["spheres.B.center.z"][0] == 0


def test_a_wall_along_a_scan_line_moves_sideways() -> None:
    """The floor cuts a sphere with its centre on it along scan lines; of a plain sphere both sides agree."""
    scene = load("chapter8").replace(OBLIQUE | {"spheres.A.texture": {"type": "solid"}})
    point = (0.9, -0.85, 0.0)
    found = probe(scene, [point], tol=1e-11, wrt=["spheres.A.center.z"])
    expected, change = differences(scene, point, "floor", "spheres.A.center.z", 1e-2)
    assert np.abs(expected).max() > 1e-4
    assert found.gradient_status["spheres.A.center.z"][0] == 0
    assert (
        np.abs(found.gradient["spheres.A.center.z"][0] - expected).max() <= 1e-7 * np.abs(expected).max() + 3 * change
    )


@pytest.mark.parametrize(
    ("scene", "changes", "name", "error", "words"),
    [
        ("gloss", {}, "shading.model", SceneError, "not a real number"),
        ("gloss", {}, "spheres.Q.radius", SceneError, "unknown name"),
        ("gloss", {}, "spheres.B", SceneError, "not a real number"),
        ("gloss", {"lights.key.radius": 0.0}, "lights.key.radius", SceneError, "changes its structure"),
        ("gloss", {"spheres.A.texture": {"type": "marble", "ku": 7.5}}, "spheres.A.texture.ku", Unsupported, "seam"),
        ("gloss", {}, "spheres.A.texture.ku", Unsupported, "whole number"),
    ],
)
def test_what_has_no_derivative_is_refused_by_name(scene, changes, name, error, words) -> None:
    with pytest.raises(error, match=words) as caught:
        probe(load(scene).replace(changes), [(0.3, -2.2)], wrt=[name])
    assert name.split(".")[-1] in str(caught.value)
