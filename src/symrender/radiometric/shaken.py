"""What roundings may have done to an image in closed form: the same scene, every number of it moved by some of them.

A place on a wall, an arc between circles that touch, a grazing view: where a formula loses digits depends on the scene,
and a bound written beside every formula forgets some of them. Scenes moved by more than the arithmetic rounds show what
it loses anywhere, jumps across a wall too. They come in pairs that move by opposite amounts, so that what lies within
roundings of a wall is on its other side in one of the two.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np

from symrender.jit.records import copied, flat, record
from symrender.radiometric.vectors import Array
from symrender.scene.radiometric.arrays import MESH, NUMBER, RadiometricArrays, laid_out
from symrender.scene.records import Camera

SHAKE: Final = 2.0**-46
"""Relative size of what numbers are moved by, 64 roundings."""
PAIRS: Final = 3
"""Opposite moves that are tried."""
LEAST: Final = 2.0**-50
"""Relative error stated at least: roundings that do not depend on where anything is."""


def shaken(arrays: RadiometricArrays, shake: float = SHAKE) -> list[RadiometricArrays]:
    """The scene, then 2 ``PAIRS`` of it with every number moved by up to ``shake`` of its size.

    Places are moved by that part of the largest coordinate of the scene, in which the way of a ray is rounded.
    """
    return [arrays, *(_moved(arrays, pair, sign) for pair in range(PAIRS) for sign in (shake, -shake))]


def shaken_rays(arrays: RadiometricArrays, origins: Array, directions: Array) -> list[tuple[Array, Array]]:
    """Rays (N, 3) that go with the scenes of ``shaken``: as they are, then moved, unit again."""
    found = [(np.ascontiguousarray(origins), np.ascontiguousarray(directions))]
    for pair in range(PAIRS):
        rng = np.random.default_rng([pair, 1])
        step, turn = rng.uniform(-1.0, 1.0, 3) * _extent(arrays), rng.uniform(-1.0, 1.0, 3)
        for sign in (SHAKE, -SHAKE):
            turned = directions + sign * turn
            turned /= np.sqrt((turned**2).sum(axis=1, keepdims=True))
            found.append((origins + sign * (step + turn * np.abs(origins)), turned))
    return found


def doubt(values: Array, others: list[Array]) -> Array:
    """(...) twice the largest difference of ``values`` (..., 3) from what shaken scenes gave, and roundings."""
    with np.errstate(invalid="ignore", over="ignore"):
        most = np.max([np.abs(each - values).max(axis=-1) for each in others], axis=0)
        return np.asarray(2.0 * most + LEAST * np.abs(values).max(axis=-1))


def _extent(arrays: RadiometricArrays) -> float:
    """Largest coordinate of camera and shapes, or more."""
    camera = arrays.camera
    places = [
        np.abs(shape.place).max() + np.abs(shape.second).max() + np.abs(shape.third).max() for shape in arrays.shapes
    ]
    for mesh in arrays.shapes:
        if mesh.kind == MESH:
            own = flat(arrays.facets)[int(mesh.start) : int(mesh.start + mesh.faces)]
            places.append(np.abs(mesh.place).max() + 2.0 * mesh.radius * np.abs(own).max())
    return float(max([1e-300, np.abs(camera.eye).max(), np.abs(camera.target).max(), *places]))


def _moved(arrays: RadiometricArrays, number: int, amount: float) -> RadiometricArrays:
    rng = np.random.default_rng(number)
    size = _extent(arrays)

    def moved(v: Array, by: float) -> Array:
        return np.asarray(v + amount * by * rng.uniform(-1.0, 1.0, np.shape(v)))

    def scaled(x: float) -> float:
        return float(moved(np.asarray(x), abs(x)))

    materials, shapes, lights = copied(arrays.materials), copied(arrays.shapes), copied(arrays.lights)
    for material in materials:
        for name in ("bright", "dark", "eta", "k"):
            v = getattr(material, name)
            v[:] = v * moved(np.ones(3), 1.0)
        for name in ("cell", "alpha", "exponent"):
            setattr(material, name, scaled(getattr(material, name)))
        material.amplitude = scaled(material.amplitude)
    terms = copied(arrays.terms)
    for term in terms:
        # a power is whole
        term.number = scaled(term.number) if term.kind == NUMBER else term.number
        term.center[:] = moved(term.center, float(np.abs(term.center).max()))
    for shape in shapes:
        shape.place[:] = moved(shape.place, size)
        shape.radius = scaled(shape.radius)
        shape.rotation = scaled(shape.rotation)
        # beyond it nothing of a flat shape lies; what is zero of these belongs to no kind
        for v in (shape.second, shape.third):
            v[:] = moved(v, size) if v.any() else v
        for v in (shape.normal, shape.along):
            v[:] = moved(v, float(np.abs(v).max()))
    for light in lights:
        light.place[:] = moved(light.place, max(size, float(np.abs(light.place).max())))
        light.emitted[:] = light.emitted * moved(np.ones(3), 1.0)
        light.beam, light.cutoff = scaled(light.beam), scaled(light.cutoff)
    directions = np.array([moved(v, float(np.abs(v).max())) for v in arrays.directions]).reshape(-1, 3)
    camera = record(Camera)
    flat(camera)[:] = flat(arrays.camera)
    camera.eye[:], camera.target[:] = moved(camera.eye, size), moved(camera.target, size)
    camera.up[:] = moved(camera.up, float(np.abs(camera.up).max()))
    camera.fov = scaled(camera.fov)
    facets = copied(arrays.facets)
    # a vertex moves alike in all facets that share it
    vertices, which = np.unique(flat(facets).reshape(-1, 3), axis=0, return_inverse=True)
    reach = float(np.abs(vertices).max(initial=0.0))
    flat(facets)[:] = moved(vertices, reach)[which.ravel()].reshape(-1, 9)
    still = arrays.exposure
    exposure = replace(still, aperture=scaled(still.aperture), focus=scaled(still.focus))
    return laid_out(
        materials, terms, shapes, facets, lights, directions, camera, arrays.bounces, exposure, arrays.first_gloss
    )  # fmt: skip
