"""Means over pixels of scenes in units of the series: direct light cut at all its walls, gloss at silhouettes.

The walls are those of radiometric scenes (``radiometric/pixels/walls.py``), of a world of the same shapes whose lights
are the points that disks are replaced by. What nodes see is the program's (``runtimes/image.trace``) and the split
rule's (``quadrature/split_point.py``).
"""

from __future__ import annotations

import math
import threading
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from symrender.errors import Unsupported
from symrender.jit.records import Table, copied, record, table
from symrender.quadrature.light_points import light_rows
from symrender.quadrature.split_point import gloss_at
from symrender.quadrature.split_scene import SplitScene, alike, split_scene
from symrender.quadrature.split_scratch import SplitWork, split_work
from symrender.quadrature.split_setup import CAPPED, MET
from symrender.radiometric.bounds import laid_bounds
from symrender.radiometric.pieces import Piece
from symrender.radiometric.pixels.cells import Eye
from symrender.radiometric.pixels.records import Family, Section
from symrender.radiometric.vectors import Array
from symrender.radiometric.world import World, camera_window
from symrender.runtimes.image import TileKernel, prepare_sight, trace
from symrender.runtimes.part_rules import LOBES, RIMMED
from symrender.runtimes.pixel_parts import Canvas, Light, PixelRule, Places
from symrender.runtimes.pixels import DOMAINS, MOST_WALLS, families_at, mean_world, series_walls, shapes_met
from symrender.runtimes.series_refusals import check_series_pixels
from symrender.scene import arrays as at
from symrender.scene.arrays import SceneArrays, lobes_of
from symrender.scene.frames import frames
from symrender.scene.radiometric.arrays import PHONG, POINT, SPHERE
from symrender.scene.radiometric.records import Light as Lamp
from symrender.scene.radiometric.records import Material, Term
from symrender.scene.records import Floor, Frame, Plane
from symrender.settings import Settings

DIRECT_SHARE: Final = 0.1
"""Part of the tolerance that direct light takes."""
_DIRECT_COST: Final = 32
"""Evaluations of gloss that one of direct light is worth, with all that it takes to cut a pixel at its walls."""


def series_world(arrays: SceneArrays, disk_order: int, exponents: Array) -> World:
    """The shapes of a scene as pieces: floor, spheres, planes; of hit class h there is the piece h - 1.

    ``exponents`` are those of highlights or lobes, by piece. Without a floor its piece is a sphere of no size, which
    nothing meets and nothing sees.
    """
    count = 1 + len(arrays.spheres) + len(arrays.planes)
    pieces, materials = table(Piece, count), table(Material, count)
    flats: list[tuple[int, Floor | Plane, Frame]] = []
    if arrays.floor.present != 0.0:
        ground = record(Frame)
        ground.up[2] = ground.east[0] = ground.north[1] = 1.0
        flats.append((0, arrays.floor, ground))
    for k, (plane, frame) in enumerate(zip(arrays.planes, frames(arrays.planes), strict=True)):
        flats.append((1 + len(arrays.spheres) + k, plane, frame))
    for k, material in enumerate(materials):
        material.kind, material.texture, material.exponent = PHONG, at.SOLID, exponents[k]
        pieces[k].kind, pieces[k].owner, pieces[k].material = SPHERE, k, k
    for k, sphere in enumerate(arrays.spheres, 1):
        pieces[k].place[:], pieces[k].radius = sphere.center, sphere.radius
    for k, flat, frame in flats:
        piece, material = pieces[k], materials[k]
        piece.kind = at.PLANE
        piece.place[:], piece.up[:] = frame.origin, frame.up
        piece.east[:], piece.north[:] = frame.east, frame.north
        piece.place[:] += flat.offset[0] * np.array(piece.east) + flat.offset[1] * np.array(piece.north)
        material.texture, material.cell = flat.kind, flat.cell
    points = light_rows(arrays, disk_order)
    lamps = table(Lamp, len(points))
    for lamp, point in zip(lamps, points, strict=True):
        lamp.kind, lamp.place[:], lamp.emitted[:] = POINT, point.position, 1.0
    level = np.zeros((len(lamps), len(pieces)))
    return World(materials, table(Term, 0), pieces, lamps, laid_bounds(pieces), level)


def sections_of(arrays: SceneArrays) -> Table[Section]:
    """Where fields of the spheres' textures end: meridians and parallels, and where marble does not close."""
    rows: list[tuple[int, tuple[float, float, float], float]] = []
    for k, sphere in enumerate(arrays.spheres, 1):
        if sphere.texture == at.SOLID:
            continue
        c = sphere.center - arrays.camera.eye
        turns = 0 if sphere.texture == at.MARBLE else math.ceil(sphere.ku)
        for turn in range(turns + 1):
            angle = math.pi * (2.0 * min(turn / sphere.ku, 1.0) - 1.0) if turns else math.pi
            axis = (math.sin(angle), -math.cos(angle), 0.0)
            rows.append((k, axis, float(np.dot(axis, c))))
        if sphere.texture == at.CHECKER:
            for ring in range(1, math.ceil(sphere.kv)):
                rows.append((k, (0.0, 0.0, 1.0), float(c[2] + sphere.radius * math.cos(math.pi * ring / sphere.kv))))
    found = table(Section, len(rows))
    for row, (own, axis, level) in zip(found, rows, strict=True):
        row.own, row.axis[:], row.level = own, axis, level
    return found


def window_of(arrays: SceneArrays, width: int, height: int) -> Array:
    """(3, 3): towards the middle of the window, and from there to its right and its upper edge."""
    camera = arrays.camera
    if camera.kind == at.LOOK_AT:
        return camera_window(camera, width, height)
    middle = np.array([*camera.window_center, 0.0]) - camera.eye
    half = float(camera.window_half)
    return np.array([middle, [half, 0.0, 0.0], [0.0, half, 0.0]])


def brightest(arrays: SceneArrays) -> float:
    """No light of the scene is brighter: all lights together on what reflects all of them, and the background."""
    shading, points = arrays.shading, light_rows(arrays, 1)
    lit = shading.ka * shading.ambient + (shading.kd + shading.ks) * np.asarray(points["color"]).sum(axis=0)
    return float(max(lit.max(), shading.background.max(), math.ulp(1.0)))


def flattened(arrays: SceneArrays) -> SceneArrays:
    """The scene with the means of textures of what is flat."""
    own = {name: copied(getattr(arrays, name)) for name in ("floor", "planes")}
    for row in (own["floor"], *own["planes"]):
        row.kind = at.SOLID
        row.bright[:] = 0.5 * (row.bright + row.dark)
        row.dark[:] = row.bright
    return replace(arrays, **own)


@dataclass(frozen=True)
class SeriesScene:
    """A scene in units of the series as its two integrals over pixels take it."""

    arrays: SceneArrays
    settings: Settings
    direct: Canvas
    gloss: Canvas

    @staticmethod
    def of(arrays: SceneArrays, settings: Settings) -> SeriesScene:
        """A scene as a camera sees it; Unsupported where its walls are too many."""
        width, height = settings.width, settings.height
        eye = np.ascontiguousarray(arrays.camera.eye)
        window, bright = window_of(arrays, width, height), brightest(arrays)
        lobes = lobes_of(arrays)
        lit = series_world(arrays, settings.disk_order, np.full(len(lobes), float(arrays.shading.shininess)))
        glossy = series_world(arrays, settings.disk_order, lobes[:, 1])._replace(lights=table(Lamp, 0))
        place = (float(eye[0]), float(eye[1]), float(eye[2]))
        domain = DOMAINS[settings.filter]
        walls = series_walls(lit, eye, sections_of(arrays))
        if len(walls) > MOST_WALLS:
            raise Unsupported(f"filter: {settings.filter} cuts at {MOST_WALLS} walls at most, got {len(walls)}")
        families = families_at(lit, eye)
        direct = Eye(lit, mean_world(lit), place, walls, families, bright, True, domain, relative=True)
        outlines = series_walls(glossy, eye, table(Section, 0))
        gloss = Eye(glossy, glossy, place, outlines, table(Family, 0), bright, True, domain)
        reach = settings.reach
        return SeriesScene(
            arrays, settings, Canvas(direct, window, width, height, reach, bright, False),
            Canvas(gloss, window, width, height, reach, bright * float(lobes[:, 0].max()), True),
        )  # fmt: skip

    def rays(self, places: Places) -> tuple[Array, Array]:
        """(N, 3) origins and unit directions of rays through places of the image."""
        forward, right, up = self.direct.window
        a = 2.0 * places.columns / self.settings.width - 1.0
        b = 1.0 - 2.0 * places.rows / self.settings.height
        found = forward + a[:, None] * right + b[:, None] * up
        found /= np.sqrt((found**2).sum(axis=1, keepdims=True))
        return np.tile(self.arrays.camera.eye, (len(found), 1)), np.ascontiguousarray(found)


def direct_rounding(bright: float) -> float:
    """What sums of a hundred terms, each of the brightest, may be off by."""
    return 100 * math.ulp(bright)


def rims_felt(arrays: SceneArrays, tol: float) -> bool:
    """Whether some lobe is so dense at its rim that ``tol`` feels what the rim touches."""
    bright = brightest(arrays)
    return any(
        weight * bright * (exponent + 1.0) * max(0.0, math.cos(theta)) ** exponent > tol
        for weight, exponent, theta in lobes_of(arrays).tolist()
    )


def _direct_look(scene: SeriesScene) -> Callable[[Places, float, int], Light]:
    arrays, order = scene.arrays, scene.settings.disk_order
    means = flattened(arrays)

    def look(places: Places, _tol: float, _budget: int) -> Light:
        origins, directions = scene.rays(places)
        values, _, _ = trace(arrays, origins, directions, at.NOTHING, order)
        some = np.flatnonzero(places.blurred)
        if len(some):
            values[some] = trace(means, origins[some], directions[some], at.NOTHING, order)[0]
        count = len(values)
        rounded = np.full(count, direct_rounding(scene.direct.bright))
        return Light(values, rounded, np.full(count, MET), np.ones(count, np.int64))

    return look


def _gloss_look(scene: SeriesScene, ready: SplitScene, scratch: SplitWork) -> Callable[[Places, float, int], Light]:
    arrays = scene.arrays
    weights = np.concatenate([[0.0], lobes_of(arrays)[:, 0]])
    groups = alike(np.stack([weights, ready.scales]))

    def look(places: Places, tol: float, budget: int) -> Light:
        origins, directions = scene.rays(places)
        count = len(directions)
        met = shapes_met(scene.gloss.eye.world, origins, directions)
        # what is flat is black behind, a sphere shines inside too
        flat = (met.shape == 0) | (met.shape > len(arrays.spheres))
        hit = np.where((met.behind != 0.0) & flat, at.NOTHING, met.shape + 1)
        found = Light(np.zeros((count, 3)), np.zeros(count), np.full(count, MET), np.zeros(count, np.int64))
        for group in np.unique(groups[hit[weights[hit] > 0.0]]).tolist():
            some = np.flatnonzero(groups[hit] == group)
            weight = float(weights[hit[some[0]]])
            seen = gloss_at(
                ready, met.place[some], met.normal[some], directions[some], hit[some], tol / weight, budget, scratch,
                walled=False,
            )  # fmt: skip
            found.values[some], found.error[some] = weight * seen.gloss, weight * seen.error
            found.status[some], found.evaluations[some] = seen.status, seen.evaluations
        return found

    return look


def prepare_series(arrays: SceneArrays, settings: Settings) -> TileKernel:
    """Kernel that renders tiles of means over pixels, each to ``settings.tol``, absolute, in scene units of radiance.

    It fills the layers of ``runtimes/truth.py``; ``gloss`` is weighed by the lobes' weights already, which differ over
    a pixel, so that radiance = direct + gloss. ``hit_class`` is the centre's. Chambers and crossings are not counted.
    """
    check_series_pixels(arrays, settings)
    scene = SeriesScene.of(arrays, settings)
    sight = prepare_sight(arrays, replace(settings, aa="none"))
    lobes = RIMMED if rims_felt(arrays, settings.tol) else LOBES
    rules = PixelRule(scene.direct, 3), PixelRule(scene.gloss, 3, rules=lobes)
    shines = bool((lobes_of(arrays)[:, 0] > 0.0).any())
    share = DIRECT_SHARE if shines else 1.0
    own, direct = threading.local(), _direct_look(scene)
    ready = split_scene(arrays, settings.disk_order)
    size = (settings.height, settings.width, 3)
    places = {name: np.zeros(size) for name in ("place", "normal", "incoming", "albedo")}

    def render(x0: int, y0: int, x1: int, y1: int, layers: Mapping[str, Array]) -> int:
        sight(x0, y0, x1, y1, {**layers, **places})
        if not hasattr(own, "scratch"):
            own.scratch = split_work(arrays, ready.lights)
        here, shape = (slice(y0, y1), slice(x0, x1)), (y1 - y0, x1 - x0)
        found = rules[0].means(
            x0, y0, x1, y1, direct, share * settings.tol, max(1, settings.budget // _DIRECT_COST), settings.strict
        )  # fmt: skip
        layers["direct"][here] = layers["radiance"][here] = found.values.reshape(*shape, 3)
        error, status, spent = found.error, found.status, found.evaluations
        if shines:
            look = _gloss_look(scene, ready, own.scratch)
            more = rules[1].means(x0, y0, x1, y1, look, (1.0 - share) * settings.tol, settings.budget, settings.strict)
            layers["gloss"][here] = more.values.reshape(*shape, 3)
            layers["radiance"][here] += layers["gloss"][here]
            error, status = error + more.error, np.maximum(status, more.status)
            spent = spent + more.evaluations
        layers["error"][here] = error.reshape(shape)
        over = np.where(error > settings.tol, np.maximum(status, CAPPED), MET)
        layers["status"][here], layers["evaluations"][here] = over.reshape(shape), spent.reshape(shape)
        return int(spent.sum())

    return render
