"""Derivatives of the records that the kernels of a radiometric image read, by a parameter of the scene."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np

from symrender.jit.compiled import compiled
from symrender.jit.records import copied, flat, grid, record, table
from symrender.jit.twins import moving, parted
from symrender.radiometric import pieces, tile
from symrender.radiometric.bounds import Bound, laid_bounds
from symrender.radiometric.pieces import Piece, piece_count
from symrender.radiometric.vectors import Array
from symrender.radiometric.world import Seen, World
from symrender.scene.arrays import PLANE
from symrender.scene.frames import frame_moves, turned
from symrender.scene.moves import Move
from symrender.scene.radiometric.arrays import DIRECTIONAL, DISK, SPOT, RadiometricArrays, laid_out, plane_record
from symrender.scene.radiometric.records import Facet, Light, Material, Shape, Term
from symrender.scene.records import Camera, Frame, Plane


def record_moves(arrays: RadiometricArrays, move: Move) -> RadiometricArrays:
    """How the records of a scene move with the parameter of ``move``: records of the same kinds."""
    materials, shapes = table(Material, len(arrays.materials)), table(Shape, len(arrays.shapes))
    terms = table(Term, len(arrays.terms))
    lights, directions = table(Light, len(arrays.lights)), np.zeros_like(arrays.directions)
    camera = record(Camera)
    facets = table(Facet, len(arrays.facets))
    parts = {
        "materials": flat(materials),
        "terms": flat(terms),
        "shapes": flat(shapes),
        "facets": flat(facets),
        "lights": flat(lights),
        "camera": flat(camera),
    }
    for name, index in move[1]:
        (parts | {"directions": directions})[name][index] = 1.0
    places = table(Frame, len(shapes))
    for j, shape in enumerate(arrays.shapes):
        if shape.kind in (PLANE, DISK) and flat(shapes)[j].any():
            turns = grid(Plane, 1, 1)
            turns[0][0] = plane_record(shapes[j])[0]
            places[j] = frame_moves(plane_record(shape), turns)[0, 0]
    for i, light in enumerate(arrays.lights):
        if light.kind == DIRECTIONAL:
            lights[i].place[:] = turned(arrays.directions[i], directions[i])
        if light.kind == SPOT:
            lights[i].axis[:] = turned(arrays.directions[i], directions[i])
    return RadiometricArrays(
        materials, terms, shapes, facets, places, lights, directions, camera, arrays.bounces, arrays.exposure
    )  # fmt: skip


def moved_by(arrays: RadiometricArrays, move: Move, by: float) -> RadiometricArrays:
    """The scene where the parameter of ``move`` is more by so much."""
    kept = {name: copied(getattr(arrays, name)) for name, _ in move[1]}
    for name, index in move[1]:
        (kept[name] if name == "directions" else flat(kept[name]))[index] += by
    there = replace(arrays, **kept)
    return laid_out(
        there.materials, there.terms, there.shapes, there.facets, there.lights, there.directions, there.camera,
        there.bounces, there.exposure, there.first_gloss,
    )  # fmt: skip


def seen_moves(arrays: RadiometricArrays, move: Move, width: int, height: int) -> Seen:
    """How a world and its camera move with the parameter of ``move``."""
    moves = record_moves(arrays, move)
    window = window_moves(arrays.camera, moves.camera, width, height)
    return Seen(world_moves(arrays, moves), np.ascontiguousarray(moves.camera.eye), window)


def world_moves(arrays: RadiometricArrays, moves: RadiometricArrays) -> World:
    """How the world of a scene moves with its records."""
    laid = moving(table(Piece, piece_count(arrays.shapes)))
    pairs = ("shapes", "facets", "frames")
    _pieces_kernel()(*(moving(getattr(arrays, name), getattr(moves, name)) for name in pairs), laid)
    still, moved = parted(laid, Piece)
    # where bounds lie has no part in a value: they stand still
    level = np.zeros((len(moves.lights), len(moved)))
    return World(moves.materials, moves.terms, moved, moves.lights, table(Bound, len(laid_bounds(still))), level)


@lru_cache(maxsize=1)
def _pieces_kernel() -> Any:
    """Compiled function that lays out pieces."""
    return compiled(pieces.lay_pieces, _nrt=False)


def window_moves(camera: Camera, moves: Camera, width: int, height: int) -> Array:
    """How ``camera_window`` moves."""
    axes = np.zeros((3, 3), np.complex128)
    _axes_kernel()(*(moving(getattr(camera, name), getattr(moves, name)) for name in ("eye", "target", "up")), axes)
    half = math.tan(math.radians(float(camera.fov)) / 2)
    wider = (1.0 + half * half) * math.radians(float(moves.fov)) / 2
    rows, turned_rows = axes.real, axes.imag.copy()
    aspect = np.array([[width / height], [1.0]])
    turned_rows[1:] = aspect * (half * turned_rows[1:] + wider * rows[1:])
    return turned_rows


@lru_cache(maxsize=1)
def _axes_kernel() -> Any:
    """Compiled function that turns a camera."""
    return compiled(tile.fill_axes, _nrt=False)
