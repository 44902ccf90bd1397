"""Where exported functions are asked: at points of the scene's own shapes, as its camera and its lights see them."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

import numpy as np

from symrender.bridge.vectors import Array, Balls, Call, of_leaf, single
from symrender.expression.formulas import light_terms, lobes
from symrender.expression.vectors import Vec3

if TYPE_CHECKING:
    from symrender.scene.lobe import Lobe
    from symrender.scene.scene import Scene


def _unit(v: Array) -> Array:
    return v / np.linalg.norm(v)


def _triple(v: Array) -> tuple[float, ...]:
    return tuple(single(v).tolist())


def hits(scene: Scene, rng: np.random.Generator, count: int) -> Iterator[Call]:
    """Primary rays that meet each shape, and the directions they are mirrored into."""
    eye = np.array(scene.camera.eye)
    for sphere in scene.spheres:
        for _ in range(count):
            center = np.array(sphere.center)
            direction = _unit(single(_unit(center + 0.6 * sphere.radius * _unit(rng.normal(size=3)) - eye)))
            offset, direction = single(center - eye), single(direction)
            normal = single(_unit(-direction + 0.5 * rng.normal(size=3)))
            yield of_leaf("sphere_hit", (offset, direction, single(sphere.radius)))
            yield of_leaf("mirror_direction", (direction, normal))
    if scene.floor is None or not eye[2] > 0.0:
        return
    for _ in range(count):
        place = np.array([*rng.uniform(-3.0, 3.0, size=2), 0.0])
        yield of_leaf("floor_hit", (single(eye), single(_unit(place - eye))))


def lobe_calls(name: str, lobe: Lobe, rng: np.random.Generator, count: int) -> Iterator[Call]:
    """The density of a lobe: within about three of its widths, and once outside its cone."""

    def density(balls: Balls) -> Balls:
        exponent, rim = type(balls[0])(lobe.exponent), type(balls[0])(lobe.theta_max)
        log_rim = lobes.log_rim(rim) if lobe.theta_max < lobes.QUARTER else type(rim)(lobes.NO_RIM)
        square = lobes.lobe_chord(Vec3(*balls[:3]), Vec3(*balls[3:]))
        return (lobes.lobe_density(square, exponent, lobes.log_normaliser(log_rim, exponent)),)

    for k in range(count + 1):
        axis = _unit(rng.normal(size=3))
        across = _unit(np.cross(axis, rng.normal(size=3)))
        widest = min(0.95 * lobe.theta_max, 1.4, 3.0 / math.sqrt(lobe.exponent + 1.0))
        angle = rng.uniform(0.05, 1.0) * widest if k < count else min(math.pi, 1.05 * lobe.theta_max + 0.01)
        direction = math.cos(angle) * axis + math.sin(angle) * across
        yield Call(f"{name}_lobe", (_triple(direction), _triple(axis)), density if k < count else None)


def light_calls(scene: Scene, names: dict[str, str], rng: np.random.Generator, count: int) -> Iterator[Call]:
    """What one light point adds at a lit place, seen near the mirrored light, and once from below the horizon."""
    shading = scene.shading
    term = light_terms.phong_term if shading.model == "phong" else light_terms.blinn_term

    def reflected(color: tuple[float, ...]) -> Callable[[Balls], Balls]:
        def formula(balls: Balls) -> Balls:
            light, place, normal, view = (Vec3(*balls[3 * k : 3 * k + 3]) for k in range(4))
            number = type(balls[0])
            cosine, highlight = term(light - place, normal, view, number(shading.shininess))
            kd, ks = number(shading.kd), number(shading.ks)
            return tuple(
                light_terms.light_channel(number(c), kd, ks, albedo, cosine, highlight)
                for c, albedo in zip(color, balls[12:], strict=True)
            )

        return formula

    for light in scene.lights:
        for k in range(count + 1):
            position = np.array(light.position)
            place = position - _unit(position) * rng.uniform(0.3, 0.9) * (np.linalg.norm(position) + 1.0)
            toward = _unit(position - place)
            normal = _unit(toward + 0.4 * _unit(rng.normal(size=3))) * (1.0 if k < count else -1.0)
            mirrored = 2.0 * (normal @ toward) * normal - toward
            view = _unit(
                mirrored + rng.uniform(0.1, 1.0) / math.sqrt(shading.shininess + 4.0) * _unit(rng.normal(size=3))
            )
            asked = (position, place, normal, view, rng.uniform(0.05, 0.95, size=3))
            formula = reflected(light.color) if k < count else None
            if formula is not None or shading.specular_terminator == "cut":
                yield Call(f"{names[light.name]}_light", tuple(map(_triple, asked)), formula, results=3)
