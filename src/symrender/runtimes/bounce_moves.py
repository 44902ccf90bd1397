"""How the records that the split rule reads of a radiometric scene move with a parameter.

``bounce_scenes`` and what lays its scenes out for kernels are polynomials of second degree in the scene's records and
the frames of its planes, but for the fields of textures, which are reciprocals of ``cell``. Half the difference of what
they give a whole move ahead and a whole move behind is therefore their derivative, without a remainder.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from symrender.chambers.caps import Cone
from symrender.chambers.cones import lay_cones, most_cones
from symrender.chambers.records import LightPoint
from symrender.chambers.work import Frames, View, scene_axes, scene_frames, scene_view, sides_of
from symrender.errors import Unsupported
from symrender.jit.call import racked
from symrender.jit.compiled import compiled
from symrender.jit.racks import Rack
from symrender.jit.records import Table, column, copied, flat, grid, table
from symrender.jit.twins import moving, parted
from symrender.leaves.values import brdf_scale, log_rim
from symrender.quadrature.fall_off import glow_bound
from symrender.quadrature.light_points import light_rows
from symrender.quadrature.split_scene import radiance_bound
from symrender.radiometric.slopes import record_moves
from symrender.runtimes.bounce import RULE, conductor_rows, sender_rows
from symrender.scene.arrays import BRDF_NORMALISED, FIRST_SPHERE, FLOOR, MARBLE, SOLID, SceneArrays, lobes_of
from symrender.scene.frames import frame_moves
from symrender.scene.moves import Move
from symrender.scene.radiometric.arrays import AREA, DIRECTIONAL, SKY, SPHERE, RadiometricArrays
from symrender.scene.radiometric.bounce import Bounce, bounce_scenes, lamp_scene, shape_classes
from symrender.scene.radiometric.records import Material
from symrender.scene.records import Plane, Sphere

Array = npt.NDArray[np.float64]
Complex = npt.NDArray[np.complex128]
Flags = npt.NDArray[np.bool_]
Ints = npt.NDArray[np.int64]

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
            raise Unsupported(f"{move[0]}: what is integrated has no derivative where two shapes are equal")
        if not arrays.bounces:
            # textures and lights that are points have no part in what lamps and a sky send
            continue
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
        if light.kind in (SKY, AREA):
            # what is seen of them has a slope where they touch a shape, too
            continue
        for j, (shape, change) in enumerate(zip(arrays.shapes, moves.shapes, strict=True)):
            if shape.kind == SPHERE:
                if light.kind == DIRECTIONAL:
                    continue
                away = light.place - shape.place
                size = float(np.abs(light.place).max() + np.abs(shape.place).max() + shape.radius)
                level = float(np.sqrt(away @ away)) - float(shape.radius)
                speed = float((shift.place - change.place) @ away) / max(float(shape.radius), 1e-300) - change.radius
            else:
                frame, turn = arrays.frames[j], moves.frames[j]
                point = light.kind != DIRECTIONAL
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


def moving_bounce(
    arrays: RadiometricArrays, moves: RadiometricArrays, turned: Flags, own: int, lamps: bool
) -> MovingBounce:  # fmt: skip
    """The scenes in which the light that shape ``own`` reflects is integrated, and how they move.

    Those of ``lamp_scene`` where it is that of ``lamps``.
    """
    worlds = (arrays, shifted(arrays, moves, 1.0), shifted(arrays, moves, -1.0))
    found = tuple((lamp_scene if lamps else bounce_scenes)(each, turned, own) for each in worlds)
    here, one, other = found
    assert here.shapes == one.shapes == other.shapes and len(here.parts) == len(one.parts) == len(other.parts)
    sent = tuple(sender_rows(*pair) for pair in zip(worlds, found, strict=True))
    cells, squares = _cells(arrays, moves, here), _squares(arrays, moves, here)
    parts = tuple(_moving_part(k, found, sent, lamps, cells, squares) for k in range(len(here.parts)))
    return MovingBounce(here, parts)


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
    k: int, bounces: tuple[Bounce, ...], sent: tuple[Any, ...], lamps: bool, cells: Array, squares: Array
) -> MovingPart:  # fmt: skip
    """Scene ``k`` of those here, a whole move ahead and behind; ``sent`` is how their shapes send light on."""
    part, *pair = (each.parts[k] for each in bounces)
    here = bounces[0]
    moves = grid(Plane, 1, len(part.planes))
    moves[0][:] = half_difference(*(each.planes for each in pair))  # type: ignore[index]
    axes = scene_axes(part)
    turns = frame_moves(part.planes, moves)[0]
    lights, *shone = (light_rows(each.parts[k], RULE, each.beams) for each in bounces)
    cones, coned = _moving_cones(part, pair, lights, shone, here.glows is not None)
    conductors = [conductor_rows(each) for each in sent]
    senders = [None if lamps else each for each in sent]
    views, framed, sides = [], [], []
    for m, (each, by) in enumerate(zip(pair, (1.0, -1.0), strict=True), 1):
        turned = _ahead(axes, turns, by)
        cones_ = None if cones is None else _ahead(cones, coned, by)
        lit = bounces[m].emitted, cones_, bounces[m].glows
        views.append(scene_view(each, shone[m - 1], conductors[m], senders[m], *lit))
        framed.append(scene_frames(each, views[-1], turned))
        sides.append(sides_of(turned))
    view = scene_view(part, lights, conductors[0], senders[0], here.emitted, cones, here.glows)
    frames = scene_frames(part, view, axes)
    view_moves = half_difference(*views)._replace(sides=half_difference(*sides))
    frame_slopes = half_difference(*framed)
    textured = part.spheres["texture"] != SOLID
    for each in (view_moves, *frame_slopes.views):
        each.spheres["ku"][textured], each.spheres["kv"][textured] = cells[0, textured], cells[1, textured]
    for each, grows in zip(frame_slopes.views, squares, strict=True):
        each.floor["cell"] = grows
    lobes = np.zeros((FIRST_SPHERE + len(part.spheres) + len(part.planes), 2), np.complex128)
    lobes[FLOOR:] = lobes_of(part)[:, 1:] + 0.5j * (lobes_of(pair[0]) - lobes_of(pair[1]))[:, 1:]
    scales = np.ones(len(lobes), np.complex128)
    if part.shading.units == BRDF_NORMALISED:
        _scales_kernel()(lobes, scales)
    bound = _bound(part, moves[0], view, view_moves)
    return MovingPart(part, lights, moving(view, view_moves), moving(frames, frame_slopes), lobes, scales, bound)


def _bound(part: SceneArrays, planes: Any, view: View, moves: View) -> float:
    """As of ``radiance_bound``, of light and of what it changes by if a colour moves by one; ``planes`` move too."""
    lights, shading = _brighter(view.points, moves.points, "color"), part.shading
    for name in ("background", "ambient"):
        shading = _brighter(shading, moves.shading, name)
    emitted = None if view.emitted is None else view.emitted + np.abs(np.asarray(moves.emitted))
    flat_ = _brighter(_brighter(part.planes, planes, "bright"), planes, "dark")
    spheres = _brighter(part.spheres, moves.spheres, "color")
    brightest = replace(part, spheres=spheres, planes=flat_, shading=shading)
    glows = None if view.glows is None else _brighter(view.glows, moves.glows, "radiance")
    return radiance_bound(brightest, lights, view.senders, emitted) + glow_bound(brightest, glows)


def _brighter(rows: Any, moves: Any, name: str) -> Any:
    """A copy of records with one of their colours by as much brighter as it moves."""
    found = copied(rows)
    found[name] = np.abs(rows[name]) + np.abs(moves[name])
    return found


def _moving_cones(
    part: SceneArrays, pair: list[SceneArrays], lights: Table[LightPoint], shone: list[Table[LightPoint]], glowing: bool
) -> tuple[Table[Cone] | None, Any]:  # fmt: skip
    """The cones of a scene across which light is not smooth, and how they move; None where there are none."""
    if not glowing and not (lights["spot"] != 0.0).any():
        return None, None
    spheres = moving(part.spheres, half_difference(*(each.spheres for each in pair)))
    points = moving(lights, half_difference(*shone))
    rows = moving(table(Cone, most_cones(part.spheres, lights)))
    count = np.zeros(1, np.int64)
    _cones_kernel()(spheres, points, glowing, rows, count)
    return parted(rows[: count[0]], Cone)


def half_difference(one: Any, other: Any) -> Any:
    """Half of what arrays, records, named tuples or racks of them differ by; whole numbers are as in ``one``."""
    match one:
        case None:
            return None
        case Rack():
            return racked(
                half_difference(one.like, other.like), [half_difference(*pair) for pair in zip(one, other, strict=True)]
            )
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


def _fill_cones(
    spheres: Table[Sphere], points: Table[LightPoint], glowing: bool, rows: Table[Cone], count: Ints
) -> None:  # fmt: skip
    """``lay_cones``, as a kernel."""
    count[0] = lay_cones(spheres, points, glowing, rows)


@lru_cache(maxsize=1)
def _cones_kernel() -> Any:
    return compiled(_fill_cones, _nrt=False)


@lru_cache(maxsize=1)
def _scales_kernel() -> Any:
    return compiled(_fill_scales, _nrt=False)
