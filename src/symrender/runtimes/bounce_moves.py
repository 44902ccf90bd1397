"""How the records that the split rule reads of a radiometric scene move with a parameter.

``bounce_scenes`` and what lays its scenes out for kernels are polynomials of second degree in the scene's records and
the frames of its planes, but for the fields of textures, which are reciprocals of ``cell``. Half the difference of what
they give a whole move ahead and a whole move behind is therefore their derivative, without a remainder.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from symrender.chambers.records import LightPoint
from symrender.chambers.work import Frames, View, scene_axes, scene_frames, scene_view, sides_of
from symrender.errors import Unsupported
from symrender.jit.compiled import compiled
from symrender.jit.records import Table, column, copied, flat, grid
from symrender.jit.twins import moving
from symrender.leaves.values import brdf_scale, log_rim
from symrender.quadrature.light_points import light_rows
from symrender.quadrature.split_point import radiance_bound
from symrender.radiometric.slopes import record_moves
from symrender.runtimes.bounce import RULE, conductor_rows, sender_rows
from symrender.scene.arrays import BRDF_NORMALISED, FIRST_SPHERE, FLOOR, MARBLE, SOLID, SceneArrays, lobes_of
from symrender.scene.frames import frame_moves
from symrender.scene.moves import Move
from symrender.scene.radiometric.arrays import POINT, SPHERE, RadiometricArrays
from symrender.scene.radiometric.bounce import Bounce, bounce_scenes, shape_classes
from symrender.scene.radiometric.records import Material
from symrender.scene.records import Plane

Array = npt.NDArray[np.float64]
Complex = npt.NDArray[np.complex128]
Flags = npt.NDArray[np.bool_]

ON_SHAPE: Final = 1e-12
"""Distance of a light from a shape, over the size of their coordinates, up to which it lies on it."""


@dataclass(frozen=True)
class MovingPart:
    """One of the scenes whose lobe averages add up to what arrives, as a kernel takes it, with its tangents.

    ``scales`` (classes,) is what the averages are multiplied by; ``bound`` as of ``radiance_bound``.
    """

    part: SceneArrays
    lights: Table[LightPoint]
    view: View
    frames: Frames
    lobes: Complex
    scales: Complex
    bound: float


@dataclass(frozen=True)
class MovingBounce:
    """As ``Bounce``, of a scene that moves."""

    still: Bounce
    parts: tuple[MovingPart, ...]


def check_moves(arrays: RadiometricArrays, wrt: tuple[Move, ...]) -> None:
    """Raise ``Unsupported``, by name, for a parameter at which the split rule's scene changes its structure."""
    for move in wrt:
        moves = record_moves(arrays, move)
        if _classes(shifted(arrays, moves, 1.0)) != _classes(arrays):
            raise Unsupported(f"{move[0]}: with bounces: 1 it has no derivative where two shapes are equal")
        for material, change in zip(arrays.materials, moves.materials, strict=True):
            solid, mixed = material.texture == SOLID, bool((material.bright != material.dark).any())
            if not solid and not mixed and bool((change.bright != change.dark).any()):
                raise Unsupported(f"{move[0]}: with bounces: 1 it has no derivative where both fields are equal")
        _refuse_contacts(move[0], arrays, moves)
        for shape in arrays.shapes:
            material, change = (rows[int(shape.material)] for rows in (arrays.materials, moves.materials))
            if shape.kind != SPHERE or material.texture == SOLID or change.cell == 0.0:
                continue
            if material.texture == MARBLE:
                raise Unsupported(f"{move[0]}: with bounces: 1 it has no derivative, for veins jump at a sphere's seam")
            if (2.0 / material.cell).is_integer():
                raise Unsupported(
                    f"{move[0]}: with bounces: 1 it has no derivative where fields close at a sphere's seam, at "
                    f"{float(material.cell):g}"
                )


def _refuse_contacts(name: str, arrays: RadiometricArrays, moves: RadiometricArrays) -> None:
    """Raise ``Unsupported`` where a light lies on a shape, or a sun in a plane, and moves off it."""
    for i, (light, shift) in enumerate(zip(arrays.lights, moves.lights, strict=True)):
        for j, (shape, change) in enumerate(zip(arrays.shapes, moves.shapes, strict=True)):
            if shape.kind == SPHERE:
                if light.kind != POINT:
                    continue
                away = light.place - shape.place
                size = float(np.abs(light.place).max() + np.abs(shape.place).max() + shape.radius)
                level = float(np.sqrt(away @ away)) - float(shape.radius)
                speed = float((shift.place - change.place) @ away) / max(float(shape.radius), 1e-300) - change.radius
            else:
                frame, turn = arrays.frames[j], moves.frames[j]
                point = light.kind == POINT
                away = light.place - frame.origin if point else light.place
                moved = shift.place - turn.origin if point else shift.place
                size = float(np.abs(away).max() + (np.abs(frame.origin).max() if point else 0.0))
                level, speed = float(away @ frame.up), float(moved @ frame.up + away @ turn.up)
            if abs(level) <= ON_SHAPE * size and speed != 0.0:
                raise Unsupported(f"{name}: with bounces: 1 it has no derivative where lights[{i}] lies on shapes[{j}]")


def _classes(arrays: RadiometricArrays) -> list[int]:
    return [int(number) for number in shape_classes(arrays)[0]]


def shifted(arrays: RadiometricArrays, moves: RadiometricArrays, by: float) -> RadiometricArrays:
    """The scene ``by`` whole moves away; the sizes of its fields stay."""
    materials = _ahead(arrays.materials, moves.materials, by)
    flat(materials)[:, column(Material, "cell")] = arrays.materials["cell"]
    return RadiometricArrays(
        materials, arrays.terms, _ahead(arrays.shapes, moves.shapes, by), arrays.facets,
        _ahead(arrays.frames, moves.frames, by), _ahead(arrays.lights, moves.lights, by), arrays.directions,
        arrays.camera, arrays.bounces, arrays.exposure, arrays.first_gloss,
    )  # fmt: skip


def _ahead(rows: Any, moves: Any, by: float) -> Any:
    found = copied(rows)
    flat(found)[:] += by * flat(moves)
    return found


def moving_bounce(arrays: RadiometricArrays, moves: RadiometricArrays, turned: Flags, own: int) -> MovingBounce:
    """The scenes in which the light that shape ``own`` reflects is integrated, and how they move."""
    ahead, behind = (shifted(arrays, moves, by) for by in (1.0, -1.0))
    here, one, other = (bounce_scenes(each, turned, own) for each in (arrays, ahead, behind))
    assert here.shapes == one.shapes == other.shapes and len(here.parts) == len(one.parts) == len(other.parts)
    senders = sender_rows(arrays, here)
    sent = tuple(sender_rows(each, found) for each, found in ((ahead, one), (behind, other)))
    cells, squares = _cells(arrays, moves, here), _squares(arrays, moves, here)
    parts = (
        _moving_part(each, pair, senders, sent, cells, squares)
        for each, *pair in zip(here.parts, one.parts, other.parts, strict=True)
    )
    return MovingBounce(here, tuple(parts))


def _cells(arrays: RadiometricArrays, moves: RadiometricArrays, bounce: Bounce) -> Array:
    """(2, spheres): how many fields textures of spheres have more around and from pole to pole."""
    found = [
        -moves.materials[m].cell / float(arrays.materials[m].cell) ** 2
        for m in (int(arrays.shapes[j].material) for j in bounce.shapes if arrays.shapes[j].kind == SPHERE)
    ]
    return np.array([[2.0 * x for x in found], found]).reshape(2, -1)


def _squares(arrays: RadiometricArrays, moves: RadiometricArrays, bounce: Bounce) -> Array:
    """(planes,): how their squares grow."""
    planes = [j for j in bounce.shapes if arrays.shapes[j].kind != SPHERE]
    return np.array([float(moves.materials[int(arrays.shapes[j].material)].cell) for j in planes])


def _moving_part(
    part: SceneArrays, pair: list[SceneArrays], senders: Any, sent: Any, cells: Array, squares: Array
) -> MovingPart:  # fmt: skip
    """One of the scenes; ``pair`` are those a whole move ahead and behind, ``sent`` how their shapes send light on."""
    moves = grid(Plane, 1, len(part.planes))
    moves[0][:] = half_difference(*(each.planes for each in pair))  # type: ignore[index]
    axes = scene_axes(part)
    turns = frame_moves(part.planes, moves)[0]
    lights = light_rows(part, RULE)
    views, framed, sides = [], [], []
    for each, by, table_ in zip(pair, (1.0, -1.0), sent, strict=True):
        turned = _ahead(axes, turns, by)
        points = light_rows(each, RULE)
        views.append(scene_view(each, points, conductor_rows(table_), table_))
        framed.append(scene_frames(each, points, axes=turned))
        sides.append(sides_of(turned))
    view, frames = scene_view(part, lights, conductor_rows(senders), senders), scene_frames(part, lights, axes=axes)
    view_moves = half_difference(*views)._replace(sides=half_difference(*sides))
    frame_slopes = half_difference(*framed)
    textured = part.spheres["texture"] != SOLID
    for rows in (view_moves.spheres, frame_slopes.spheres):
        rows["ku"][..., textured], rows["kv"][..., textured] = cells[0, textured], cells[1, textured]
    frame_slopes.floors["cell"][:] = squares
    lobes = np.zeros((FIRST_SPHERE + len(part.spheres) + len(part.planes), 2), np.complex128)
    lobes[FLOOR:] = lobes_of(part)[:, 1:] + 0.5j * (lobes_of(pair[0]) - lobes_of(pair[1]))[:, 1:]
    scales = np.ones(len(lobes), np.complex128)
    if part.shading.units == BRDF_NORMALISED:
        _scales_kernel()(lobes, scales)
    bound = radiance_bound(part, lights, senders)
    return MovingPart(part, lights, moving(view, view_moves), moving(frames, frame_slopes), lobes, scales, bound)


def half_difference(one: Any, other: Any) -> Any:
    """Half of what arrays, records or named tuples of them differ by; whole numbers are as in ``one``."""
    match one:
        case None:
            return None
        case tuple():
            return type(one)(*(half_difference(*pair) for pair in zip(one, other, strict=True)))
        case np.void():
            return half_difference(np.asarray(one)[None], np.asarray(other)[None])[0]
    if one.dtype == np.float64:
        return 0.5 * (one - other)
    found = one.copy()
    for name in one.dtype.names or ():
        found[name] = half_difference(np.asarray(one[name]), np.asarray(other[name]))
    return found


def _fill_scales(lobes: Array, scales: Array) -> None:
    """What lobe averages are multiplied by in BRDF units."""
    for i in range(lobes.shape[0]):
        if lobes[i, 1] > 0.0:
            scales[i] = brdf_scale(log_rim(lobes[i, 1]), lobes[i, 0])


@lru_cache(maxsize=1)
def _scales_kernel() -> Any:
    return compiled(_fill_scales, _nrt=False)
