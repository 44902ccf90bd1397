"""Formulas as loops over the rows of nodes.

Emitted by targets/leaf_files.py from expression/formulas: change those, not this file.
"""

# fmt: off
from __future__ import annotations

import math

from symrender.chambers.records import NODES, Nodes
from symrender.kernel_cache import jitable


@jitable
def eye_view_rows(m: int, eye_x: float, eye_y: float, eye_z: float, nodes: Nodes) -> None:
    """Unit vector from a place to the eye, along which its highlight is seen (``highlight_view: eye``), of the first
    ``m`` nodes.
    """
    m = min(m, NODES)
    for i in range(m):
        place_x = nodes.place[0, i]
        place_y = nodes.place[1, i]
        place_z = nodes.place[2, i]
        offset_x = eye_x - place_x
        offset_y = eye_y - place_y
        offset_z = eye_z - place_z
        t1 = math.sqrt(max(offset_x * offset_x + offset_y * offset_y + offset_z * offset_z, 1e-300))
        inverse = 1.0 / t1
        nodes.toward[0, i] = offset_x * inverse
        nodes.toward[1, i] = offset_y * inverse
        nodes.toward[2, i] = offset_z * inverse


@jitable
def lambert_nodes_rows(m: int, light_x: float, light_y: float, light_z: float, nodes: Nodes) -> None:
    """N.l of a light point, of the first ``m`` nodes."""
    m = min(m, NODES)
    for i in range(m):
        place_x = nodes.place[0, i]
        place_y = nodes.place[1, i]
        place_z = nodes.place[2, i]
        normal_x = nodes.normal[0, i]
        normal_y = nodes.normal[1, i]
        normal_z = nodes.normal[2, i]
        to_light_x = light_x - place_x
        to_light_y = light_y - place_y
        to_light_z = light_z - place_z
        t1 = to_light_x * to_light_x + to_light_y * to_light_y + to_light_z * to_light_z
        t2 = math.sqrt(max(t1, 1e-300))
        nodes.clear[i] *= (to_light_x * normal_x + to_light_y * normal_y + to_light_z * normal_z) / t2


@jitable
def blinn_nodes_rows(m: int, light_x: float, light_y: float, light_z: float, nodes: Nodes) -> None:
    """(N.l, N.h) of a light point, the second kept within [0, 1], of the first ``m`` nodes."""
    m = min(m, NODES)
    for i in range(m):
        place_x = nodes.place[0, i]
        place_y = nodes.place[1, i]
        place_z = nodes.place[2, i]
        normal_x = nodes.normal[0, i]
        normal_y = nodes.normal[1, i]
        normal_z = nodes.normal[2, i]
        view_x = nodes.toward[0, i]
        view_y = nodes.toward[1, i]
        view_z = nodes.toward[2, i]
        to_light_x = light_x - place_x
        to_light_y = light_y - place_y
        to_light_z = light_z - place_z
        t1 = to_light_x * to_light_x + to_light_y * to_light_y + to_light_z * to_light_z
        t2 = math.sqrt(max(t1, 1e-300))
        inverse = 1.0 / t2
        light_dir_x = to_light_x * inverse
        light_dir_y = to_light_y * inverse
        light_dir_z = to_light_z * inverse
        half_x = light_dir_x + view_x
        half_y = light_dir_y + view_y
        half_z = light_dir_z + view_z
        t3 = math.sqrt(max(half_x * half_x + half_y * half_y + half_z * half_z, 1e-300))
        base = (half_x * normal_x + half_y * normal_y + half_z * normal_z) / t3
        nodes.clear[i] *= light_dir_x * normal_x + light_dir_y * normal_y + light_dir_z * normal_z
        nodes.radix[i] = min(1.0, max(0.0, base))


@jitable
def phong_nodes_rows(m: int, light_x: float, light_y: float, light_z: float, nodes: Nodes) -> None:
    """(N.l, r.v) of a light point, the second kept within [0, 1], of the first ``m`` nodes."""
    m = min(m, NODES)
    for i in range(m):
        place_x = nodes.place[0, i]
        place_y = nodes.place[1, i]
        place_z = nodes.place[2, i]
        normal_x = nodes.normal[0, i]
        normal_y = nodes.normal[1, i]
        normal_z = nodes.normal[2, i]
        view_x = nodes.toward[0, i]
        view_y = nodes.toward[1, i]
        view_z = nodes.toward[2, i]
        to_light_x = light_x - place_x
        to_light_y = light_y - place_y
        to_light_z = light_z - place_z
        t1 = to_light_x * to_light_x + to_light_y * to_light_y + to_light_z * to_light_z
        t2 = math.sqrt(max(t1, 1e-300))
        inverse = 1.0 / t2
        cosine = (to_light_x * normal_x + to_light_y * normal_y + to_light_z * normal_z) * inverse
        facing = normal_x * view_x + normal_y * view_y + normal_z * view_z
        toward = (to_light_x * view_x + to_light_y * view_y + to_light_z * view_z) * inverse
        base = 2.0 * cosine * facing - toward
        nodes.clear[i] *= cosine
        nodes.radix[i] = min(1.0, max(0.0, base))


@jitable
def lobe_density_rows(m: int, exponent: float, log_normaliser: float, nodes: Nodes) -> None:
    """cos^n theta / W at a direction whose squared distance from m is ``square``; 0 below the plane across m, of the
    first ``m`` nodes.
    """
    m = min(m, NODES)
    for i in range(m):
        square = nodes.chord[i]
        depth = 0.5 * square
        t1 = (math.exp(exponent * math.log1p(-depth) - log_normaliser) if depth < 1.0 else 0.0)
        nodes.power[i] = t1
        nodes.weight[i] *= t1
