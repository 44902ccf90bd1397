"""The quadrature nodes of one line or block, a row a quantity, so that loops over nodes become vector instructions.

A loop body has no branch and no call, and the rows lie in one flat array at constant distances: only then does the
compiler see that iterations are independent. Every operation is the scalar one, so a node's value does not depend on
its neighbours. What has no such form (marble, powers that are not whole) is done node by node. What lights add is in
``quadrature/light_nodes.py``.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from symrender.chambers.records import NODES, Nodes
from symrender.jit.marks import inlined, jitable
from symrender.scene.records import Shading

Array = npt.NDArray[np.float64]


@inlined
def whole_vectors(m: int) -> int:
    """``m`` rounded up to eights: nodes beyond the last one are computed too, from what lies there, and never read."""
    return min(NODES, 8 * ((m + 7) // 8))


@inlined
def begin_sums(m: int, ambient: float, shading: Shading, b: Nodes) -> None:
    """``radiance`` of the first ``m`` nodes before any light: ambient light less the background."""
    m = min(m, NODES)
    red, green, blue = (
        ambient * shading.ambient[0] - shading.background[0],
        ambient * shading.ambient[1] - shading.background[1],
        ambient * shading.ambient[2] - shading.background[2],
    )
    for i in range(m):
        b.radiance[0, i], b.radiance[1, i], b.radiance[2, i] = red, green, blue


@jitable
def shine(m: int, sphere: int, b: Nodes, emitted: Array | None) -> None:
    """Add to ``radiance`` of the first ``m`` nodes what the sphere they lie on emits, if it is one."""
    if emitted is None:
        return
    if sphere >= 0:
        for a in range(3):
            for i in range(min(m, NODES)):
                b.radiance[a, i] += emitted[sphere, a]


@inlined
def sines(m: int, b: Nodes) -> None:
    """``sine`` and ``cosine`` of ``inner``, in [0, pi/2], by their series: within 3e-16."""
    m = min(m, NODES)
    for i in range(m):
        x = b.inner[i]
        y = x * x
        s = 1.0 - y * (1.0 / 420.0)
        s = 1.0 - y * (1.0 / 342.0) * s
        s = 1.0 - y * (1.0 / 272.0) * s
        s = 1.0 - y * (1.0 / 210.0) * s
        s = 1.0 - y * (1.0 / 156.0) * s
        s = 1.0 - y * (1.0 / 110.0) * s
        s = 1.0 - y * (1.0 / 72.0) * s
        s = 1.0 - y * (1.0 / 42.0) * s
        s = 1.0 - y * (1.0 / 20.0) * s
        b.sine[i] = x - x * y * (1.0 / 6.0) * s
        c = 1.0 - y * (1.0 / 462.0)
        c = 1.0 - y * (1.0 / 380.0) * c
        c = 1.0 - y * (1.0 / 306.0) * c
        c = 1.0 - y * (1.0 / 240.0) * c
        c = 1.0 - y * (1.0 / 182.0) * c
        c = 1.0 - y * (1.0 / 132.0) * c
        c = 1.0 - y * (1.0 / 90.0) * c
        c = 1.0 - y * (1.0 / 56.0) * c
        c = 1.0 - y * (1.0 / 30.0) * c
        c = 1.0 - y * (1.0 / 12.0) * c
        b.cosine[i] = 1.0 - 0.5 * y * c
