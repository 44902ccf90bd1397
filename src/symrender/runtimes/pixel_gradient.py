"""Derivatives of means of emitted and direct light over pixels."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import lru_cache
from typing import Any, Final

import numpy as np

from symrender.jit.compiled import compiled
from symrender.jit.twins import moving
from symrender.quadrature.split_setup import CAPPED, MET, UNSUPPORTED
from symrender.radiometric import tile
from symrender.radiometric.pixels import walls
from symrender.radiometric.sky import sky_room
from symrender.radiometric.slopes import moved_by, seen_moves
from symrender.radiometric.vectors import Array
from symrender.radiometric.world import seen
from symrender.runtimes.image import TileKernel
from symrender.runtimes.part_rules import Rules
from symrender.runtimes.pixel_parts import Canvas, Light, Look, Places
from symrender.runtimes.pixels import DOMAINS, check_pixels, eye_of
from symrender.runtimes.speeds import Beside, Speeds, moving_light
from symrender.runtimes.swept_pixels import Beginning, SweptRule
from symrender.scene.moves import Move
from symrender.scene.radiometric.arrays import RadiometricArrays
from symrender.settings import Settings

_CHANNELS: Final = 6
"""Radiance, and emitted light, which is a part of it."""


class DirectRule(SweptRule):
    """What nodes see costs next to nothing and is exact: rules begin where they are worth the walls of their part."""

    rules = Rules(((2, 3, 5, 8), (2, 3, 5, 8, 12), (2, 3)), told=False, densest=0.0)
    # four times what two rules differ by: halved for the first two of smooth parts
    slow = 8.0
    eager = True


def prepare_box(arrays: RadiometricArrays, settings: Settings, wrt: tuple[Move, ...]) -> TileKernel:
    """The layers of ``runtimes/radiometric_gradient.py`` of means over pixels, moving edges included.

    The error is what ``SweptRule`` states.
    """
    check_pixels(arrays, f"filter: {settings.filter}")
    width, height = settings.width, settings.height
    view = seen(arrays, width, height)
    eye = eye_of(arrays, view, DOMAINS[settings.filter])
    canvas = Canvas(eye, view.window, width, height, settings.reach, eye.bright, False)
    beginning, rules = Beginning(), {}
    for move in wrt:
        speeds = Speeds.of(eye, view, seen_moves(arrays, move, width, height), walls.list_walls, settings)
        rule = DirectRule(canvas, _CHANNELS, speeds, beginning, _beside(arrays, speeds, move))
        rules[move[0]] = rule, _look(speeds)

    def render(x0: int, y0: int, x1: int, y1: int, layers: Mapping[str, Array]) -> int:
        here, shape, spent = (slice(y0, y1), slice(x0, x1)), (y1 - y0, x1 - x0), 0
        for name, (rule, look) in rules.items():
            found = rule.means(x0, y0, x1, y1, look, settings.tol, settings.budget)
            image, errors = found.values.reshape(*shape, _CHANNELS), found.error.reshape(shape)
            missed = np.where(np.isfinite(errors), CAPPED, UNSUPPORTED)
            layers[f"radiance:{name}"][here], layers[f"emitted:{name}"][here] = image[..., :3], image[..., 3:]
            layers[f"direct:{name}"][here] = image[..., :3] - image[..., 3:]
            layers[f"error:{name}"][here] = errors
            layers[f"status:{name}"][here] = np.where(~(errors <= settings.tol), missed, MET)
            spent += int(found.evaluations.sum())
        unused, hit_class = np.zeros((*shape, 3)), np.zeros(shape)
        place = (width, height, x0, y0, x1, y1)
        _kernel()(*view, *place, sky_room(view.world), unused, unused, hit_class)
        layers["hit_class"][here] = hit_class
        return spent

    return render


def _look(speeds: Speeds) -> Look:
    """What answers for nodes."""

    def look(places: Places, _tol: float, _budget: int) -> Light:
        values, slopes = moving_light(speeds, places.columns, places.rows)
        count = len(values)
        found = np.concatenate([slopes, values, np.zeros((count, 1))], axis=1)
        return Light(found, np.zeros(count), np.full(count, MET), np.ones(count, np.int64))

    return look


def _beside(arrays: RadiometricArrays, speeds: Speeds, move: Move) -> Beside:
    """What answers for places where the parameter is a little more or less."""

    def look(by: float, columns: Array, rows: Array) -> Array:
        view = seen(moved_by(arrays, move, by), speeds.settings.width, speeds.settings.height)
        return moving_light(replace(speeds, view=view, turning=moving(view)), columns, rows)[0]

    return look


@lru_cache(maxsize=1)
def _kernel() -> Any:
    """Compiled function that tells what the pixels' centres meet."""
    return compiled(tile.fill_tile, _nrt=False)
