"""A program with its loops written out computes what it did, and keeps the loops that would make it long."""

from __future__ import annotations

import numpy as np
import sympy as sp

from symrender.jit.records import flat
from symrender.kernel.assemble_pixels import TABLES, pixel_program
from symrender.kernel.block import Block
from symrender.kernel.program import Array, Function, Loop, Next, Program, When
from symrender.kernel.straighten import straightened
from symrender.runtimes import interpreter
from symrender.scene import arrays as at
from symrender.scene.load import load

ROWS = Array("rows", 2)


def program(turns=1):
    """Sum of the positive elements of a column, so many times over."""
    block = Block()
    total = block.let("total", sp.Integer(0))
    with block.loop("turn", turns), block.loop("k", ROWS.length) as k:
        with block.when(ROWS[k, 0] <= 0):
            block.next()
        block.set(total, total + ROWS[k, 0] * (k + 1))
    block.leave(total)
    return Program((Function("f", (ROWS,), block.statements, "a sum"),), ("f",))


def statements(body):
    for statement in body:
        yield statement
        for inner in (getattr(statement, "body", ()), getattr(statement, "otherwise", ())):
            yield from statements(inner)


def test_a_known_table_needs_no_loop_and_no_next():
    rows = np.array([[1.5], [-2.0], [0.25]])
    made = straightened(program(), {"rows": 3})
    found = list(statements(made.functions[0].body))
    assert sum(isinstance(s, Loop) for s in found) == 1
    assert not any(isinstance(s, Next) for s in found)
    assert sum(isinstance(s, When) for s in found) == 3
    assert interpreter.run(made, "f", (rows,)) == interpreter.run(program(), "f", (rows,)) == (1.5 + 0.75,)


def test_nan_is_on_the_same_side_of_a_guard():
    rows = np.array([[np.nan], [1.0]])
    one, other = (interpreter.run(p, "f", (rows,))[0] for p in (straightened(program(), {"rows": 2}), program()))
    assert np.isnan(one) and np.isnan(other)


def test_long_tables_and_unnamed_ones_keep_their_loops():
    for rows in ({"rows": 60}, {"other": 3}, {}):
        made = straightened(program(), rows)
        assert sum(isinstance(s, Loop) for s in statements(made.functions[0].body)) == 2


def test_every_pass_computes_the_same_pixels():
    scene = load("gloss")
    arrays = at.scene_arrays(scene)
    made = pixel_program()
    tables = {name: np.zeros(t.columns) if t.rows == 1 else np.zeros((t.rows, t.columns)) for name, t in TABLES.items()}
    for name in ("spheres", "floor", "planes", "shading", "camera"):
        tables[name] = flat(getattr(arrays, name))
    tables["eye"] = arrays.camera.eye
    tables["image_frame"] = np.array([0, 0, 8, 8, 8, 8, 1.0])
    tables["points"] = np.array([[*light.position, *light.color] for light in scene.lights])
    interpreter.run(made, "camera_axes", (tables["camera"], tables["axes"]))
    rows = {"spheres": len(scene.spheres), "planes": len(scene.planes)}
    signal = 0.0
    look = next(f for f in made.functions if f.name == "pixel_seen")
    for column, row in ((1, 6), (3, 3), (5, 6)):
        interpreter.run(made, "pixel_seen", [column, row, *(tables[p.name] for p in look.parameters[2:])])
        seen = []
        for each in (made, straightened(made.part("pixel_direct"), rows)):
            function = next(f for f in each.functions if f.name == "pixel_direct")
            arguments = [column, row, *(tables[p.name] for p in function.parameters[2:])]
            seen.append(interpreter.run(each, "pixel_direct", arguments))
        assert seen[0] == seen[1]
        signal += sum(seen[0][:3])
    assert signal > 0.1
