"""All leaves, in the order they are emitted."""

from __future__ import annotations

from typing import Final

from symrender.expression.formulas import (
    bumps,
    conductor_lobe,
    conics,
    disks,
    exchange,
    filters,
    light_terms,
    lobes,
    microfacets,
    pixel_walls,
    polygons,
    radiometry,
    shapes,
    textures,
    walls,
)

LEAVES: Final = {
    leaf.name: leaf
    for module in (light_terms, lobes, conductor_lobe, textures, shapes, walls, conics, disks)
    for leaf in module.LEAVES
}
"""Leaf by name."""

RADIOMETRIC: Final = {
    leaf.name: leaf
    for module in (microfacets, polygons, exchange, radiometry, pixel_walls, filters, bumps)
    for leaf in module.LEAVES
}
"""Leaf by name, of what radiometric scenes alone need."""
