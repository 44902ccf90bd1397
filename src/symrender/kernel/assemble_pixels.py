"""The program of the simulator: one pixel a call, for a shader and for double precision beside it.

One text for every scene: a scene is only tables, and how many rows a table holds is fixed here once.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from symrender.jit.records import column, columns
from symrender.kernel import (
    footprint,
    gather,
    lens,
    light,
    lobe_disc,
    lobe_meridian,
    lobe_sums,
    lobe_table,
    pixel,
    planes,
    shade,
    sight,
    strata,
    tile,
    trace,
    words,
)
from symrender.kernel.program import Program
from symrender.limits import (
    MAX_SIMULATOR_LIGHT_POINTS,
    MAX_SIMULATOR_LOBE,
    MAX_SIMULATOR_LOBES,
    MAX_SIMULATOR_PLANES,
    MAX_SIMULATOR_SPHERES,
)
from symrender.scene.records import Camera, Floor, Plane, Shading, Sphere


@dataclass(frozen=True)
class Table:
    """Columns of an array, and the most rows of one with two axes (1 for one axis); a pixel has its own ``image``.

    ``center`` is the first of three columns that move where time is a pixel's own.
    """

    columns: int
    rows: int = 1
    scratch: bool = False
    image: bool = False
    center: int | None = None


TABLES: Final[dict[str, Table]] = {
    "image_frame": Table(7),
    "camera": Table(columns(Camera)),
    "axes": Table(10),
    "eye": Table(3),
    "floor": Table(columns(Floor)),
    "shading": Table(columns(Shading)),
    "estimate": Table(6),
    "seen": Table(16, image=True),
    "disc": Table(12),
    "spheres": Table(columns(Sphere), MAX_SIMULATOR_SPHERES, center=column(Sphere, "center")),
    "planes": Table(columns(Plane), MAX_SIMULATOR_PLANES),
    "points": Table(6, MAX_SIMULATOR_LIGHT_POINTS),
    "lobes": Table(5, MAX_SIMULATOR_LOBES),
    "rings": Table(4, MAX_SIMULATOR_LOBES * MAX_SIMULATOR_LOBE),
    "sectors": Table(2, MAX_SIMULATOR_LOBE),
    "hits": Table(lobe_sums.BATCH, scratch=True),
    "labels": Table(lobe_disc.MAX_CHAMBERS, scratch=True),
}
"""Every array of the program by name. A GPU holds none longer than 1024 rows of four."""

PASSES: Final = ("pixel_direct", "pixel_numeric", "pixel_symbolic", "pixel_chambers", "pixel_disc")
"""Functions of a column and a row with four results: what a fragment shader runs."""
SPREAD: Final = ("pixel_direct", "pixel_numeric")
"""Passes that may look from a lens and at a time that every pixel has of its own."""
_VIEW = ("camera_axes", "lens_view")
_PAGE = ("light_point", "stand_planes", "fill_lobe", "fill_sectors", "ring_edge", "lobe_widths")
_DISC = ("disc_radius", "disc_place", "disc_direction")
_CURVES = ("silhouette_direction", "terminator_direction", "horizon_direction")
_REFERENCE = ("lobe_direction", "meridian_meets", "silhouette_circle", "silhouette_turns", "cell")
_SEEN = ("look", "pixel_seen", "nearest", "pixel_word", "uniform_pair")
_PROBE = ("sight", "strata_gloss", "jittered_gloss", "sample_depth", "sample_direction", "frame", "reflected")
ENTRIES: Final = (*PASSES, *_VIEW, *_PAGE, *_DISC, *_CURVES, *_REFERENCE, *_SEEN, *_PROBE)
"""What a page calls."""


def pixel_program() -> Program:
    """Program of the simulator."""
    return Program(
        (
            light.light_point(),
            tile.camera_axes(),
            lens.lens_view(),
            planes.stand_planes(),
            planes.nearest_plane(),
            planes.walled_off(),
            strata.ring_weight(),
            strata.ring_barycentre(),
            strata.share_angle(),
            strata.cap_angle(),
            strata.log_weight(),
            lobe_table.ring_edge(),
            lobe_table.fill_lobe(),
            lobe_table.fill_sectors(),
            lobe_table.lobe_widths(),
            words.scramble(),
            words.pixel_word(),
            words.uniform_pair(),
            sight.power(),
            shade.texture_factor(),
            shade.floor_side(),
            sight.blocked(),
            sight.highlight(),
            sight.direct(),
            trace.nearest(),
            sight.met(),
            sight.sight(),
            gather.frame(),
            lobe_sums.sample_depth(),
            lobe_sums.sample_direction(),
            lobe_sums.jittered_gloss(),
            lobe_sums.strata_gloss(),
            footprint.box_share(),
            footprint.edge_share(),
            footprint.quad_share(),
            tile.footprint_share(),
            tile.plane_share(),
            tile.look(),
            pixel.pixel_seen(),
            pixel.pixel_direct(),
            pixel.pixel_numeric(),
            pixel.pixel_symbolic(),
            pixel.reflected(),
            lobe_disc.chamber(),
            lobe_disc.cell(),
            lobe_disc.chambers_met(),
            pixel.pixel_chambers(),
            lobe_disc.disc_radius(),
            lobe_disc.disc_angle(),
            lobe_disc.disc_place(),
            lobe_disc.disc_direction(),
            lobe_disc.pixel_disc(),
            lobe_disc.silhouette_direction(),
            lobe_disc.terminator_direction(),
            lobe_disc.horizon_direction(),
            lobe_meridian.lobe_direction(),
            lobe_meridian.meridian_meets(),
            lobe_meridian.silhouette_circle(),
            lobe_meridian.silhouette_turns(),
        ),
        ENTRIES,
    )
