"""All leaves, in the order they are emitted."""

from __future__ import annotations

from typing import Final

from symrender.expression.formulas import conics, disks, light_terms, lobes, microfacets, shapes, textures, walls

LEAVES: Final = {
    leaf.name: leaf
    for module in (light_terms, lobes, microfacets, textures, shapes, walls, conics, disks)
    for leaf in module.LEAVES
}
"""Leaf by name."""
