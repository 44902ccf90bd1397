"""Regions of an audit: a penumbra is where a part of a lamp is seen, counted by rays to its disk."""

from __future__ import annotations

import math
from importlib.resources import as_file, files

import numpy as np

import symrender as sr
from symrender.audit.regions import regions
from symrender.scene.radiometric.scene import RadiometricScene

SIZE = (72, 48)
RINGS, TURNS = 40, 64


def floor_places(scene: RadiometricScene, size: tuple[int, int]) -> np.ndarray:
    """Where rays through the centres of pixels meet z = 0, (h, w, 3)."""
    camera, (width, height) = scene.camera, size
    eye = np.array(camera.eye)
    forward = np.array(camera.target) - eye
    forward /= np.linalg.norm(forward)
    right = np.cross(forward, camera.up)
    right /= np.linalg.norm(right)
    reach = math.tan(math.radians(0.5 * camera.fov))
    a = (2.0 * (np.arange(width) + 0.5) / width - 1.0) * reach * width / height
    b = (1.0 - 2.0 * (np.arange(height) + 0.5) / height) * reach
    d = forward + a[None, :, None] * right + b[:, None, None] * np.cross(right, forward)
    return np.asarray(eye - d * (eye[2] / d[..., 2:]))


def test_a_penumbra_is_where_a_part_of_the_lamp_is_seen() -> None:
    with as_file(files("symrender.suite").joinpath("scenes/penumbra.yaml")) as path:
        scene = sr.load(path)
    assert isinstance(scene, RadiometricScene)
    true = sr.truth(scene, size=SIZE)
    found = {region.name: region.mask for region in regions(scene, true)}
    mask, silhouettes = found["penumbra of lights.lamp"], found["silhouettes"]
    floor, lamp, *balls = scene.shapes
    assert (floor.name, lamp.name) == ("floor", "bulb") and len(balls) == 2
    place = floor_places(scene, SIZE)
    toward = np.array(lamp.center) - place
    far = np.linalg.norm(toward, axis=-1, keepdims=True)
    axis = toward / far
    first = np.cross(axis, [1.0, 0.0, 0.0])
    first /= np.linalg.norm(first, axis=-1, keepdims=True)
    sine = lamp.radius / far
    share = np.zeros(place.shape[:2])
    for ring in np.sqrt((np.arange(RINGS) + 0.5) / RINGS):
        for turn in 2.0 * math.pi * np.arange(TURNS) / TURNS:
            d = axis * np.sqrt(1.0 - (ring * sine) ** 2)
            d = d + ring * sine * (math.cos(turn) * first + math.sin(turn) * np.cross(axis, first))
            hidden = d[..., 2] <= 0.0
            for ball in balls:
                off = np.array(ball.center) - place
                along = (off * d).sum(axis=-1)
                hidden |= (along > 0.0) & ((off**2).sum(axis=-1) - along**2 < ball.radius**2)
            share += ~hidden / (RINGS * TURNS)
    here = (true.layer("hit_class") == 1) & ~silhouettes
    partly = here & (share > 0.01) & (share < 0.99)
    clear = here & ((share == 0.0) | (share >= 1.0 - 1e-9))
    assert partly.sum() > 150 and (here & (share == 0.0)).sum() > 50 and (here & (share > 1.0 - 1e-9)).sum() > 1000
    assert mask[partly].all()
    # slivers of a lamp, or of what hides it, are narrower than the rays to it
    assert mask[clear].mean() < 0.02
