"""The chessboard's corner lies at its offset: moving the board and moving the point are the same thing."""

from __future__ import annotations

import math

import numpy as np
import sympy as sp

from symrender.expression import texture

X, Y, CELL, OX, OY = sp.symbols("x y cell ox oy", real=True)


def test_the_board_moves_with_its_offset() -> None:
    parity = sp.lambdify((X, Y, CELL, OX, OY), texture.floor_parity(X, Y, CELL, OX, OY), "math")
    random = np.random.default_rng(11)
    odd = moved = 0
    for x, y, ox, oy in random.uniform(-5, 5, (400, 4)).tolist():
        cell = float(random.uniform(0.3, 2))
        here = math.floor((x - ox) / cell) + math.floor((y - oy) / cell)
        assert int(parity(x, y, cell, ox, oy)) == here
        odd += here % 2
        moved += here % 2 != (math.floor(x / cell) + math.floor(y / cell)) % 2
    assert 120 < odd < 280 and 120 < moved < 280, "both colours, and an offset that matters"
