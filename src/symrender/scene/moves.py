"""Which numbers of a scene's arrays a parameter moves: what a derivative starts from."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, fields, replace
from typing import TypeAlias, TypeVar

import numpy as np

from symrender.errors import SceneError, Unsupported
from symrender.jit.records import Grid, Table, column, copied, flat, grid, table
from symrender.scene.arrays import SceneArrays, scene_arrays
from symrender.scene.fields import number_range
from symrender.scene.names import letters, resolve
from symrender.scene.parameters import get
from symrender.scene.plain import plain
from symrender.scene.radiometric.scene import RadiometricScene
from symrender.scene.records import Camera, Floor, Light, Plane, Shading, Sphere
from symrender.scene.scene import Scene

_AnyScene = TypeVar("_AnyScene", Scene, RadiometricScene)
_Arrays = TypeVar("_Arrays")
Move: TypeAlias = tuple[str, tuple[tuple[str, tuple[int, ...]], ...]]
"""A parameter's dotted name and the elements (array of ``SceneArrays``, index) that move with it, one for one."""


def components(scene: Scene | RadiometricScene, names: Iterable[str]) -> tuple[str, ...]:
    """``names`` with vectors and colours written out: ``camera.eye`` becomes ``camera.eye.x``, ``.y`` and ``.z``.

    SceneError for what is not a real number of the scene.
    """
    found: list[str] = []
    data = plain(scene.model_dump(mode="python"))
    for name in names:
        _, info = resolve(type(scene), data, name)
        if axes := letters(info):
            found += [f"{name}.{axis}" for axis in axes]
        elif number_range(info) is not None and isinstance(get(scene, name), float):
            found.append(name)
        else:
            raise SceneError(f"{name}: is not a real number; derivatives exist with respect to real numbers only")
    if twice := sorted({name for name in found if found.count(name) > 1}):
        raise SceneError(f"{twice[0]}: is asked for twice")
    return tuple(found)


def moves(scene: Scene, names: Iterable[str]) -> tuple[Move, ...]:
    """What each of ``names`` moves, vectors written out.

    SceneError for a parameter at which the scene's structure switches, such as the radius of a disk light that is 0;
    Unsupported for one with another derivative on either side everywhere, the whole number of fields around a sphere.
    """
    return tuple((name, _moved(scene, name)) for name in components(scene, names))


def stepped(scene: _AnyScene, name: str, lay: Callable[[_AnyScene], _Arrays]) -> tuple[float, float, _Arrays]:
    """(value of the parameter, one a little beside it, the arrays that ``lay`` makes of the scene there).

    SceneError where the scene has room on neither side.
    """
    value = float(get(scene, name))
    step = max(abs(value), 1.0) * 2.0**-10
    for other in (value + step, value - step):
        try:
            return value, other, lay(scene.replace({name: other}))
        except SceneError:
            continue
    raise SceneError(f"{name}: has no room to move about {value:g}")


def _moved(scene: Scene, name: str) -> tuple[tuple[str, tuple[int, ...]], ...]:
    here = scene_arrays(scene)
    value, other, there = stepped(scene, name, scene_arrays)
    found: list[tuple[str, tuple[int, ...]]] = []
    for field in fields(SceneArrays):
        a, b = flat(getattr(here, field.name)), flat(getattr(there, field.name))
        if a.shape != b.shape:
            raise SceneError(f"{name}: the scene changes its structure about {value:g}; there is no derivative")
        for index in zip(*np.nonzero(a != b), strict=True):
            if abs(a[index] - value) > 0.0 or abs(b[index] - other) > 0.0:
                raise SceneError(f"{name}: the scene changes its structure at {value:g}; there is no derivative")
            if (field.name, int(index[-1])) == ("spheres", column(Sphere, "ku")) and value == int(value):
                raise Unsupported(
                    f"{name}: at the whole number {value:g} a field opens at the texture's seam as it grows and none "
                    "closes as it falls; only numbers that are not whole have a derivative"
                )
            found.append((field.name, tuple(int(k) for k in index)))
    return tuple(found)


@dataclass(frozen=True)
class SceneMoves:
    """Derivatives of a scene's records in Q parameters, themselves records: of each parameter a scene."""

    spheres: Grid[Sphere]
    floor: Table[Floor]
    planes: Grid[Plane]
    lights: Grid[Light]
    shading: Table[Shading]
    camera: Table[Camera]


def scene_moves(arrays: SceneArrays, moved: tuple[Move, ...]) -> SceneMoves:
    """Derivatives of the numbers of a scene in every parameter: 1 where a number moves with it."""
    count = len(moved)
    tangents = SceneMoves(
        spheres=grid(Sphere, count, len(arrays.spheres)),
        floor=table(Floor, count),
        planes=grid(Plane, count, len(arrays.planes)),
        lights=grid(Light, count, len(arrays.lights)),
        shading=table(Shading, count),
        camera=table(Camera, count),
    )
    for q, (_, elements) in enumerate(moved):
        for name, index in elements:
            flat(getattr(tangents, name))[(q, *index)] = 1.0
    return tangents


def moved_by(arrays: SceneArrays, move: Move, by: float) -> SceneArrays:
    """The numbers of the scene where the parameter of ``move`` is more by so much."""
    kept = {name: copied(getattr(arrays, name)) for name, _ in move[1]}
    for name, index in move[1]:
        flat(kept[name])[index] += by
    return replace(arrays, **kept)
