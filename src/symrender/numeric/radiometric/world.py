"""The world the path tracer sees."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from symrender.jit.records import Table
from symrender.limits import MAX_TERMS
from symrender.numeric.radiometric.bsdfs.dispatch import laid_materials
from symrender.numeric.radiometric.hierarchy import Blade, Pairs
from symrender.numeric.radiometric.maps import sky_tables
from symrender.numeric.radiometric.meshes import Face, laid_meshes
from symrender.scene.arrays import Array
from symrender.scene.radiometric.arrays import ENVIRONMENT, EXTENDED, SKY, RadiometricArrays
from symrender.scene.radiometric.detail import Picture
from symrender.scene.radiometric.records import Light, Material, Shape, Term
from symrender.scene.records import Frame


class World(NamedTuple):
    """The records of a scene; row j of ``frames`` says where shape j lies, if it is a plane or a disk.

    ``faces`` are those of meshes, ``blades`` the same in the order of the hierarchy ``nodes``, whose boxes are
    in steps of ``grid``; ``stack`` is what a
    thread notes of a walk through it. Row k of ``coordinates`` and of ``normals``, where they have any, is of face k.
    ``pictures`` are of the images whose pixels are ``texels``; ``sky_rows`` and ``sky_columns`` are the sums by which
    directions of an environment are chosen.

    ``sky`` is the index of the sky among the lights, -1 if there is none; ``extended`` says whether a light is a sky or
    a sphere, which a direction may meet; ``bounces`` how many reflections follow the
    direct light; with ``first_gloss`` what is not diffuse reflects at the first hit alone. ``terms`` are those of the
    heights of bumps, ``notes`` what a thread notes of them.
    """

    materials: Table[Material]
    terms: Table[Term]
    notes: Array
    shapes: Table[Shape]
    frames: Table[Frame]
    faces: Table[Face]
    blades: Table[Blade]
    nodes: Pairs
    grid: Array
    stack: Array
    coordinates: Array
    normals: Array
    pictures: Table[Picture]
    texels: Array
    sky_rows: Array
    sky_columns: Array
    lights: Table[Light]
    sky: int
    extended: bool
    bounces: int
    first_gloss: bool


def fresh_notes() -> Array:
    """Room for what a thread notes of a height: of every term its value, and its share of the height."""
    return np.zeros((MAX_TERMS, 2))


def make_world(arrays: RadiometricArrays) -> World:
    """World of a scene."""
    skies = [index for index, light in enumerate(arrays.lights) if light.kind in (SKY, ENVIRONMENT)]
    extended = any(light.kind in EXTENDED for light in arrays.lights)
    sky = skies[0] if skies else -1
    detail, tables = arrays.detail, (np.zeros(1), np.zeros((0, 1)))
    if skies and arrays.lights[sky].kind == ENVIRONMENT:
        tables = sky_tables(detail.pictures[int(arrays.lights[sky].emitter)], detail.texels)
    return World(
        laid_materials(arrays.materials), arrays.terms, fresh_notes(), arrays.shapes, arrays.frames,
        *laid_meshes(arrays), detail.pictures, detail.texels, *tables, arrays.lights, sky, extended, arrays.bounces,
        arrays.first_gloss,
    )  # fmt: skip
