"""The function of the program that looks from a place of a thin lens."""

from __future__ import annotations

import sympy as sp

from symrender.expression import camera as formulas
from symrender.expression.vectors import Vec3
from symrender.kernel.block import Block, real
from symrender.kernel.program import Function
from symrender.kernel.shade import row_vector
from symrender.kernel.tile import AXES, CAMERA, FRAME
from symrender.scene import arrays as at


def lens_view() -> Function:
    """From (x, y) of the lens a ray is that of a pinhole there through another place of the image.

    Eye and place move by the same for every pixel, so that ``look`` knows of no lens.
    """
    right, up, focus = real("right"), real("up"), real("focus")
    block = Block()
    eye = block.let_vector("e", CAMERA.vector("eye"))
    with block.when(sp.Eq(CAMERA.field("kind"), at.PLANE)):
        x, y = formulas.slid_place(right, up, focus, sp.Abs(eye.z))
        side = 2 * CAMERA.field("window_half")
        block.leave(eye.x + right, eye.y + up, eye.z, x * FRAME[4] / side, -y * FRAME[5] / side)
    lens_x, lens_y = (row_vector(AXES, None, first) for first in (3, 6))
    from_lens = block.let_vector("p", Vec3(*eye.parts) + lens_x * right + lens_y * up)
    columns, rows = formulas.sheared_place(right, up, focus, AXES[9], FRAME[5])
    block.leave(*from_lens.parts, columns, rows)
    doc = "(x, y, z) of an eye on the lens, and the columns and rows its rays move by"
    return Function("lens_view", (right, up, focus, CAMERA, AXES, FRAME), block.statements, doc)
