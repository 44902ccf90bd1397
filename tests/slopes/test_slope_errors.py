"""What derivatives state, against differences of values, where successive orders once agreed on wrong numbers."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

import symrender as sr
from adversary.sweep import swept_value
from adversary.world import lobe_of, world_of
from symrender.chambers.lobes.width import rim_power
from symrender.chambers.records import Chart
from symrender.jit.records import record
from symrender.quadrature.paces import outline
from symrender.scene.parameters import get
from symrender.scene.scene import Scene

Array = npt.NDArray[np.float64]

OBLIQUE = {"camera": {"type": "look_at", "eye": (3.0, -3.0, 2.0)}}
KNOWN = Path(__file__).parents[1] / "adversary" / "known_gradients.json"


def differences(
    scene: Scene, point: tuple[float, ...], surface: str, name: str, disk: str, step: float, tol: float
) -> tuple[Array, float]:
    """Extrapolated central differences over two steps, and their doubt: the last change and the values' own errors."""
    at = float(get(scene, name))

    def quotient(h: float) -> tuple[Array, float]:
        a, b = (
            sr.probe(scene.replace({name: at + s * h}), [point], surface=surface, tol=tol, disk=disk, budget=4_000_000)
            for s in (1.0, -1.0)
        )
        return (a.gloss[0] - b.gloss[0]) / (2.0 * h), float(max(a.error[0], b.error[0])) / h

    coarse, _ = quotient(step)
    fine, noise = quotient(0.5 * step)
    return fine + (fine - coarse) / 3.0, float(np.abs(fine - coarse).max()) + noise


def judged(
    scene: Scene, point: tuple[float, ...], surface: str, name: str, disk: str, tol: float, step: float, known: float
) -> None:
    """Assert that a derivative lies within what it states, of differences to ``known``."""
    expected, doubt = differences(scene, point, surface, name, disk, step, known)
    found = sr.probe(scene, [point], surface=surface, tol=tol, disk=disk, wrt=[name])
    stated, off = float(found.gradient_error[name][0]), float(np.abs(found.gradient[name][0] - expected).max())
    assert doubt <= 0.5 * tol, (name, doubt)
    assert np.abs(expected).max() > 10.0 * tol
    assert found.gradient_status[name][0] == 0
    assert off <= stated + doubt, (name, off, stated, doubt)


@pytest.mark.parametrize("tol", [1e-5, 1e-6])
def test_rules_over_a_disk_err_alike_on_every_line(tol: float) -> None:
    """A panel a thin light barely reaches had four lines at either order, and coarse rules on each."""
    name = "lights.key.radius"
    scene = sr.load("penumbra").replace({"floor.lobe.exponent": 12.0, name: 1.1})
    judged(scene, (0.9, -0.85, 0.0), "floor", name, "exact", tol, 0.004, 1e-9)


@pytest.mark.parametrize(
    ("view", "name", "normal"),
    [
        ("gloss", "camera.eye.x", (0.3514493379638985, -0.32201677322987876, 0.879083932627229)),
        ("penumbra", "spheres.A.center.x", (0.3840977216446115, -0.1992931744074912, -0.9015271326266358)),
    ],
)
def test_the_rim_of_a_blunt_lobe(view: str, name: str, normal: tuple[float, ...]) -> None:
    """The slope of a density cos^.02 is cos^-.98 at the rim: halving never ends, and half of it lies within 1e-15."""
    scene = sr.load(view).replace(OBLIQUE)
    blunt = {"spheres.B.lobe.exponent": 0.02, "spheres.B.lobe.theta_max": 0.5 * math.pi}
    judged(scene.replace(blunt), normal, "spheres.B", name, "2x2", 1e-5, 2e-4, 2e-10)


@pytest.mark.parametrize("exponent", [0.02, 0.1, 0.3, 0.5, 0.9, 1.3, 1.7])
def test_nodes_approach_a_blunt_rim_with_a_power_that_makes_its_slope_smooth(exponent: float) -> None:
    lobe = record(Chart).lobe
    lobe.exponent = exponent
    power = rim_power(lobe)
    assert power >= 4.0
    assert abs(power * exponent - round(power * exponent)) < 1e-12
    # n x^(n - 1) dx = n m u^(n m - 1) du
    x, w = np.polynomial.legendre.leggauss(8)
    u = 0.5 * (1.0 + x)
    whole = float((0.5 * w * exponent * power * u ** (exponent * power - 1.0)).sum())
    assert abs(whole - 1.0) < 1e-12


def known_case() -> dict[str, Any]:
    cases: list[dict[str, Any]] = json.loads(KNOWN.read_text("utf-8"))
    return cases[0]


def test_a_light_right_behind_a_place_does_not_fill_the_table_of_highlights() -> None:
    """There a highlight has every angle; its octaves overflowed into one row that asked for a million nodes a line."""
    case = known_case()
    found = sr.probe(case["scene"], case["points"], surface=case["surface"], tol=1e-7)
    assert found.status[0] == 0 and found.evaluations[0] < 500_000
    world, lobe = world_of(case["scene"], "2x2"), lobe_of(case["scene"], case["surface"], case["points"][0])
    judge = swept_value(world, lobe, 1e-8, turn=0.1, cells=48)
    assert judge.doubt < 1e-5 and judge.value[2] > 1.0
    assert np.abs(found.gloss[0] - judge.value).max() <= judge.doubt + found.error[0]


def test_a_derivative_there_is_met_alone_and_with_others() -> None:
    case = known_case()
    names = ["shading.shininess", "camera.eye.x", "spheres.S2.center.z", "spheres.S1.lobe.exponent"]

    def asked(wrt: list[str]) -> sr.Probe:
        return sr.probe(case["scene"], case["points"], surface=case["surface"], tol=1e-5, wrt=wrt)

    together = asked(names)
    felt = 0
    for name in names:
        alone = asked([name])
        assert alone.gradient_status[name][0] == together.gradient_status[name][0] == 0
        away = float(np.abs(alone.gradient[name] - together.gradient[name]).max())
        assert away <= alone.gradient_error[name][0] + together.gradient_error[name][0]
        felt += float(np.abs(alone.gradient[name]).max()) > 1e-4
    assert felt >= 2


@pytest.mark.parametrize("angle", [1e-3, 0.4, 0.5 * math.pi])
def test_the_outline_of_a_chart(angle: float) -> None:
    chart = record(Chart)
    chart.beta_max = angle
    length, solid_angle = 2.0 * math.pi * math.sin(angle), 4.0 * math.pi * math.sin(0.5 * angle) ** 2
    assert abs(outline(chart) - (1.0 + length / solid_angle)) < 1e-9 * outline(chart)
