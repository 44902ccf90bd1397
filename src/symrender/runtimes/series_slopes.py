"""Derivatives of means over pixels of scenes in units of the series, direct light and gloss.

The walls are those of the means (``runtimes/series_pixels.py``) and move with the world of the same shapes; what nodes
see moves as at the centres of pixels (``runtimes/gradient.py``).
"""

from __future__ import annotations

import math
import threading
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Final

import numpy as np

from symrender.jit.records import Table, record, table
from symrender.quadrature.gloss_gradients import BUDGET, SlopeScene, gloss_gradients, light_moves, slope_work
from symrender.quadrature.light_points import light_rows
from symrender.quadrature.split_point import gloss_at
from symrender.quadrature.split_scratch import SplitWork, split_work
from symrender.quadrature.split_setup import CAPPED, MET, UNSUPPORTED
from symrender.radiometric.bounds import Bound
from symrender.radiometric.pieces import Piece
from symrender.radiometric.pixels import walls
from symrender.radiometric.pixels.records import Section
from symrender.radiometric.slopes import window_moves
from symrender.radiometric.vectors import Array
from symrender.radiometric.world import Seen, World
from symrender.runtimes.gradient import Slopes
from symrender.runtimes.image import TileKernel, trace
from symrender.runtimes.pixel_gradient import DirectRule
from symrender.runtimes.pixel_parts import Light, Look, Places
from symrender.runtimes.series_pixels import DIRECT_SHARE, SeriesScene, direct_rounding, sections_of, window_of
from symrender.runtimes.series_refusals import check_series_pixels
from symrender.runtimes.speeds import Beside, Speeds
from symrender.runtimes.swept_pixels import Beginning, SweptRule, node_budget
from symrender.scene import arrays as at
from symrender.scene.arrays import SceneArrays
from symrender.scene.frames import frame_moves, frames
from symrender.scene.moves import Move, SceneMoves, moved_by, scene_moves
from symrender.scene.radiometric.records import Light as Lamp
from symrender.scene.radiometric.records import Material, Term
from symrender.scene.records import Floor, Frame, Plane
from symrender.settings import Settings

_CHANNELS: Final = 3
_VALUE: Final = 0.25
"""Part of the tolerance of a node's slope that its value, which walls part, is asked for."""


def world_moves(arrays: SceneArrays, moved: SceneMoves, ready: SlopeScene) -> World:
    """How ``series_world`` moves in the first parameter."""
    count = 1 + len(arrays.spheres) + len(arrays.planes)
    pieces, materials = table(Piece, count), table(Material, count)
    flats: list[tuple[int, Floor | Plane, Floor | Plane, Frame, Frame]] = []
    if arrays.floor.present != 0.0:
        ground = record(Frame)
        ground.up[2] = ground.east[0] = ground.north[1] = 1.0
        flats.append((0, arrays.floor, moved.floor[0], ground, record(Frame)))
    turns = frame_moves(arrays.planes, moved.planes)
    for k, frame in enumerate(frames(arrays.planes)):
        first = 1 + len(arrays.spheres)
        flats.append((first + k, arrays.planes[k], moved.planes[0, k], frame, turns[0, k]))
    for k in range(len(arrays.spheres)):
        pieces[1 + k].place[:], pieces[1 + k].radius = moved.spheres[0, k].center, moved.spheres[0, k].radius
    for k, flat, move, frame, turn in flats:
        piece = pieces[k]
        piece.up[:], piece.east[:], piece.north[:] = turn.up, turn.east, turn.north
        piece.place[:] = turn.origin
        for c, (axis, turned) in enumerate(((frame.east, turn.east), (frame.north, turn.north))):
            piece.place[:] += move.offset[c] * np.array(axis) + flat.offset[c] * np.array(turned)
        materials[k].cell = move.cell
    points = light_moves(ready, 0)
    lamps = table(Lamp, len(points))
    np.asarray(lamps)["place"] = points[:, :3]
    # where bounds lie has no part in a value: they stand still
    level = np.zeros((len(lamps), len(pieces)))
    return World(materials, table(Term, 0), pieces, lamps, table(Bound, 0), level)


def section_moves(arrays: SceneArrays, moved: SceneMoves) -> Table[Section]:
    """How ``sections_of`` moves in the first parameter."""
    rows: list[tuple[tuple[float, float, float], float]] = []
    for k, sphere in enumerate(arrays.spheres):
        if sphere.texture == at.SOLID:
            continue
        move = moved.spheres[0, k]
        c, dc = sphere.center - arrays.camera.eye, move.center - moved.camera[0].eye
        turns = 0 if sphere.texture == at.MARBLE else math.ceil(sphere.ku)
        for turn in range(turns + 1):
            angle, wider = math.pi, 0.0
            if turns:
                angle = math.pi * (2.0 * min(turn / sphere.ku, 1.0) - 1.0)
                wider = -2.0 * math.pi * turn / sphere.ku**2 * move.ku if turn < sphere.ku else 0.0
            axis, turned = (math.sin(angle), -math.cos(angle), 0.0), (math.cos(angle), math.sin(angle), 0.0)
            rows.append((
                (wider * turned[0], wider * turned[1], 0.0), float(wider * np.dot(turned, c) + np.dot(axis, dc))
            ))  # fmt: skip
        if sphere.texture == at.CHECKER:
            for ring in range(1, math.ceil(sphere.kv)):
                angle = math.pi * ring / sphere.kv
                falls = sphere.radius * math.sin(angle) * angle / sphere.kv * move.kv
                rows.append(((0.0, 0.0, 0.0), float(dc[2] + move.radius * math.cos(angle) + falls)))
    found = table(Section, len(rows))
    for row, (axis, level) in zip(found, rows, strict=True):
        row.axis[:], row.level = axis, level
    return found


def _window_moves(arrays: SceneArrays, moved: SceneMoves, width: int, height: int) -> Array:
    """How ``window_of`` moves in the first parameter."""
    camera, move = arrays.camera, moved.camera[0]
    if camera.kind == at.LOOK_AT:
        return window_moves(camera, move, width, height)
    half = float(move.window_half)
    return np.array([np.array([*move.window_center, 0.0]) - move.eye, [half, 0.0, 0.0], [0.0, half, 0.0]])


def prepare(arrays: SceneArrays, settings: Settings, wrt: tuple[Move, ...]) -> TileKernel:
    """The layers of ``runtimes/gradient.py`` of means over pixels; ``gloss`` is weighed as in ``series_pixels``."""
    check_series_pixels(arrays, settings)
    scene, sections = SeriesScene.of(arrays, settings), sections_of(arrays)
    width, height = settings.width, settings.height
    eye = np.ascontiguousarray(arrays.camera.eye)
    beginnings, each = (Beginning(), Beginning()), {}
    for move in wrt:
        moved, slopes = scene_moves(arrays, (move,)), Slopes(arrays, replace(settings, aa="none"), (move,))
        turning = world_moves(arrays, moved, slopes.ready)
        moves = Seen(
            turning, np.ascontiguousarray(moved.camera[0].eye), _window_moves(arrays, moved, width, height)
        )  # fmt: skip
        rules = []
        for kind, canvas, beginning, parts in (
            (DirectRule, scene.direct, beginnings[0], (sections, section_moves(arrays, moved))),
            (SweptRule, scene.gloss, beginnings[1], (table(Section, 0), table(Section, 0))),
        ):
            world = canvas.eye.world
            lamps = turning.lights if len(world.lights) else table(Lamp, 0)
            still = moves._replace(world=turning._replace(lights=lamps, bounds=table(Bound, len(world.bounds))))
            speeds = Speeds.of(
                canvas.eye, Seen(world, eye, canvas.window), still, walls.list_series_walls, settings, *parts
            )  # fmt: skip
            beside = _beside(scene, move) if kind is DirectRule else None
            rules.append(kind(canvas, _CHANNELS, speeds, beginning, beside))
        each[move[0]] = slopes, rules
    own = threading.local()

    def render(x0: int, y0: int, x1: int, y1: int, layers: Mapping[str, Array]) -> int:
        if not hasattr(own, "scratch"):
            lights = light_rows(arrays, settings.disk_order)
            own.scratch, own.slopes = split_work(arrays, lights), slope_work(arrays, lights)
        here, shape, spent = (slice(y0, y1), slice(x0, x1)), (y1 - y0, x1 - x0), 0
        columns, rows = np.tile(np.arange(x0, x1) + 0.5, y1 - y0), np.repeat(np.arange(y0, y1) + 0.5, x1 - x0)
        for name, (slopes, rules) in each.items():
            shines = bool(slopes.lobed.any())
            share = DIRECT_SHARE if shines else 1.0
            bright = scene.direct.bright
            found = rules[0].means(x0, y0, x1, y1, _direct_look(slopes, bright), share * settings.tol, settings.budget)
            values, error, status = found.values, found.error, found.status
            spent += int(found.evaluations.sum())
            layers[f"direct:{name}"][here] = values.reshape(*shape, _CHANNELS)
            layers[f"gloss:{name}"][here] = 0.0
            if shines:
                look = _gloss_look(slopes, own.scratch, own.slopes)
                budget = node_budget(settings, len(each))
                more = rules[1].means(x0, y0, x1, y1, look, (1.0 - share) * settings.tol, budget, settings.strict)
                layers[f"gloss:{name}"][here] = more.values.reshape(*shape, _CHANNELS)
                values, error = values + more.values, error + more.error
                status = np.maximum(status, more.status)
                spent += int(more.evaluations.sum())
            known = np.isfinite(error)
            layers[f"radiance:{name}"][here] = np.where(known[:, None], values, 0.0).reshape(*shape, _CHANNELS)
            layers[f"error:{name}"][here] = error.reshape(shape)
            missed = np.where(known, np.maximum(status, CAPPED), UNSUPPORTED)
            layers[f"status:{name}"][here] = np.where(error <= settings.tol, MET, missed).reshape(shape)
            layers["hit_class"][here] = slopes.shown(columns, rows)[0].reshape(shape)
        return spent

    return render


def _beside(scene: SeriesScene, move: Move) -> Beside:
    """What answers for places where the parameter is a little more or less."""
    settings = scene.settings

    def look(by: float, columns: Array, rows: Array) -> Array:
        arrays = moved_by(scene.arrays, move, by)
        window = window_of(arrays, settings.width, settings.height)
        there = replace(scene, arrays=arrays, direct=replace(scene.direct, window=window))
        rays = there.rays(Places(columns, rows, np.zeros(len(columns), np.bool_)))
        return trace(arrays, *rays, at.NOTHING, settings.disk_order)[0]

    return look


def _direct_look(slopes: Slopes, bright: float) -> Look:
    """What answers for nodes of direct light."""

    def look(places: Places, _tol: float, _budget: int) -> Light:
        _, found, moving = slopes.shown(places.columns, places.rows)
        count = len(places.columns)
        rounded = np.full((count, 1), direct_rounding(bright))
        values = np.concatenate([moving[3], found[3], rounded], axis=1)
        return Light(values, rounded[:, 0], np.full(count, MET), np.ones(count, np.int64))

    return look


def _gloss_look(slopes: Slopes, scratch: SplitWork, moving_scratch: SplitWork) -> Callable[[Places, float, int], Light]:
    """The same of gloss, times the weight of its lobe."""
    weights, turns, ready = slopes.weights, slopes.weight_moves[0], slopes.ready
    planes = 1 + len(slopes.arrays.spheres)

    def look(places: Places, tol: float, budget: int) -> Light:
        classes, found, moving = slopes.shown(places.columns, places.rows)
        (place, normal, incoming), count = found[:3], len(classes)
        seen = classes.astype(np.int64)
        # what is flat is black behind, a sphere shines inside too
        flat = (seen == at.FLOOR) | (seen > planes)
        facing = np.where(seen == at.FLOOR, slopes.eye[2] > 0.0, (incoming * normal).sum(axis=1) < 0.0)
        seen = np.where(flat & ~facing, at.NOTHING, seen)
        values, error = np.zeros((count, 2 * _CHANNELS + 1)), np.zeros(count)
        status, spent = np.full(count, MET), np.zeros(count, np.int64)
        for group in np.unique(slopes.groups[seen[slopes.lobed[seen]]]).tolist():
            some = np.flatnonzero(slopes.groups[seen] == group)
            surfaces = seen[some]
            weight, turn = float(weights[surfaces[0]]), float(turns[surfaces[0]])
            at_places = place[some], normal[some], incoming[some], surfaces
            turning = moving[0][None, some], moving[1][None, some], moving[2][None, some]
            aim = tol / max(weight, 1e-300) if weight > 0.0 else 1.0
            result = gloss_gradients(ready, *at_places, turning, min(1.0, aim), BUDGET * budget, moving_scratch)
            closer = min(1.0, _VALUE * tol / max(weight, abs(turn)))
            value = gloss_at(ready.split, *at_places, closer, budget, scratch, walled=False)
            values[some, :3] = weight * result.gradient[0] + turn * value.gloss
            values[some, 3:6], values[some, 6] = weight * value.gloss, weight * value.error
            error[some] = weight * result.error[0] + abs(turn) * value.error
            status[some] = np.maximum(result.status[0], value.status)
            spent[some] = result.evaluations + value.evaluations
        return Light(values, error, status, spent)

    return look
