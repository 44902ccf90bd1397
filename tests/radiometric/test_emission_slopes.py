"""Derivatives of light between flat faces by what lights send: linear, alone, refused for all else; and along rays."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import symrender as sr
from symrender.errors import Unsupported
from symrender.quadrature.split_setup import CAPPED, MET
from symrender.scene.parameters import get

from .test_bounce_of_lights import EYE, METAL, SKY, SPOT, scene
from .test_slopes_of_lights import BALL, GROUND, OTHER, crowd

LIGHTS: list[dict[str, Any]] = [
    {"type": "area", "name": "lamp", "shape": "panel", "radiance": [3.0, 2.0, 0.0]},
    {"type": "point", "name": "key", "position": [0.3, -1.0, 0.8], "intensity": [1.0, 2.0, 3.0]},
]


def room(bounces: int | str, **changes: Any) -> dict[str, Any]:
    """A box on a floor before a wall, under a panel."""
    rows: list[dict[str, Any]] = [
        {"name": "ground", "corner": [-2, -2, 0], "edge_u": [4, 0, 0], "edge_v": [0, 4, 0]},
        {"name": "wall", "corner": [-2, 1.5, 0], "edge_u": [4, 0, 0], "edge_v": [0, 0, 3]},
        {"name": "panel", "corner": [-0.5, -0.5, 2.5], "edge_u": [0, 1, 0], "edge_v": [1, 0, 0]},
    ]
    shapes = [{"type": "rectangle", "material": "gray", **row} for row in rows]
    box = {"type": "box", "name": "box", "center": [0.4, 0.5, 0.4], "size": [0.6, 0.6, 0.6], "material": "gray"}
    made = scene([*shapes, box], LIGHTS, metal=METAL, gray={"type": "diffuse", "reflectance": [0.7, 0.5, 0.3]})
    made["camera"] = {"type": "look_at", "eye": [0.4, -4, 1.5], "target": [0, 0, 0.6], "fov": 40}
    return made | {"bounces": bounces} | changes


@pytest.mark.parametrize("bounces", [1, "all"])
def test_any_difference_in_what_a_light_sends_is_the_derivative(bounces: int | str) -> None:
    made = sr.load("cornell").replace({"bounces": bounces})
    names = [f"lights.lamp.radiance.{c}" for c in ("r" if bounces == "all" else "rgb")]
    slopes = sr.gradient(made, names, size=(4, 3), tol=1e-2)
    here = sr.truth(made, size=(4, 3), tol=0.2)
    for channel, name in enumerate(names):
        image, step = slopes[name], 20.0
        other = sr.truth(made.replace({name: float(get(made, name)) + step}), size=(4, 3), tol=0.2)
        found = image.layer("indirect")
        stated = image.layer("error") + (other.layer("error") + here.layer("error")) / step
        assert found[:, :, channel].max() > 3e-3 and not np.delete(found, channel, axis=2).any()
        assert image.layer("status").max() == MET and image.layer("error").max() <= 1e-2
        off = np.abs((other.layer("indirect") - here.layer("indirect")) / step - found).max(axis=2)
        assert (off <= stated).all() and off.max() < 0.2 * found.max()


def test_lamps_on_gloss_beside_flat_shapes_are_linear_too() -> None:
    made = room(0)
    made["shapes"] = [*made["shapes"][:-1], made["shapes"][-1] | {"material": "metal"}]
    made["shapes"][0] = made["shapes"][0] | {"material": "metal"}
    names = [f"lights.lamp.radiance.{c}" for c in "rgb"] + [f"lights.key.intensity.{c}" for c in "rgb"]
    loaded = sr.load(made)
    slopes = sr.gradient(made, names, size=(4, 3), tol=1e-5)
    value = sr.truth(made, size=(4, 3), tol=1e-5)
    total = sum(float(get(loaded, n)) * slopes[n].layer("direct") for n in names)
    stated = sum(float(get(loaded, n)) * slopes[n].layer("error") for n in names) + value.layer("error")
    assert value.layer("direct").max() > 0.1 and stated.max() < 2e-4
    assert (np.abs(total - value.layer("direct")).max(axis=2) <= stated + 1e-12).all()


def test_what_is_not_had_is_refused_by_name() -> None:
    for name in ("camera.fov", "materials.gray.reflectance.color.r", "lights.key.position.x", "shapes.box.rotation"):
        with pytest.raises(Unsupported, match=f"^{name}: .* by what lights send"):
            sr.gradient(room("all"), [name], size=1)
    assert sr.gradient(room(0), ["lights.key.position.x"], size=1)


def test_rays_have_derivatives() -> None:
    aims = np.array([GROUND, BALL, OTHER])
    origins, directions = np.tile(EYE, (3, 1)), aims - EYE
    for made, names in (
        (crowd([SPOT], GROUND), ["shapes.B.radius", "lights.spot.position.z", "camera.eye.x"]),
        (crowd([SKY], GROUND, "metal", bounces=0), ["materials.metal.alpha", "shapes.B.radius"]),
        (room(0), ["lights.lamp.radiance.g"]),
    ):
        tol = 1e-2 if len(names) == 1 else 1e-6
        found = sr.probe(made, rays=(origins, directions), tol=tol, wrt=names, threads=1)
        alone = sr.probe(made, rays=(origins[1:2], directions[1:2]), tol=tol, wrt=names)
        loaded, acting = sr.load(made), 0
        for name in names:
            value, h = float(get(loaded, name)), 1e-3

            def light(x: float, name: str = name, made: Any = loaded, tol: float = tol) -> Any:
                return sr.probe(made.replace({name: x}), rays=(origins, directions), tol=min(tol, 1e-10))

            if len(names) == 1:
                ahead, behind = (
                    sr.probe(loaded.replace({name: x}), rays=(origins, directions), tol=tol) for x in (value + 1, value)
                )
                wanted, doubt = ahead.radiance - behind.radiance, ahead.error + behind.error
            else:
                wide, near = ((light(value + s).radiance - light(value - s).radiance) / (2 * s) for s in (h, h / 2))
                wanted = (4 * near - wide) / 3
                doubt = np.abs(wanted - near).max(axis=1) + 1e-9
            off = np.abs(found.gradient[name] - wanted).max(axis=1)
            known = found.gradient_error[name] <= tol
            assert known.sum() >= 2 and (off <= found.gradient_error[name] + doubt).all(), (name, off, doubt)
            assert set(found.gradient_status[name][known]) <= {MET, CAPPED, 4}
            assert np.abs(alone.gradient[name] - found.gradient[name][1]).max() == 0.0
            acting += int((np.abs(wanted).max(axis=1) > 1e-4).sum())
        assert acting >= 2
