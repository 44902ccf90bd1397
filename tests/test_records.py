"""Records: where their fields lie, who shares their memory, what is refused, and what kernels make of them."""

from __future__ import annotations

import ast
import functools
import importlib
from collections import defaultdict
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import pytest

import symrender
from records_in_source import is_name, is_record, is_table, subscripts
from symrender.chambers.records import Nodes
from symrender.chambers.work import scene_view
from symrender.jit.kernel import Kernel
from symrender.jit.marks import jitable
from symrender.jit.records import (
    Array,
    Record,
    Table,
    Three,
    Two,
    chosen,
    column,
    columns,
    copied,
    flat,
    joined,
    named,
    record,
    rows_of,
    table,
)
from symrender.jit.twins import moving
from symrender.jit.types import type_of
from symrender.quadrature.light_points import light_rows
from symrender.scene.arrays import scene_arrays
from symrender.scene.load import load
from symrender.scene.records import Floor, Shading, Sphere

PACKAGE = Path(symrender.__file__).parent


class Inner(Record):
    """A record that lies in another one."""

    place: Three
    tag: int


class Outer(Record):
    """One field of every kind."""

    count: int
    level: float
    turn: Two
    inner: Inner
    rows: Annotated[Array, (2, 3)]


def test_fields_lie_in_the_order_they_are_written_without_gaps() -> None:
    assert Outer.layout.names == ("count", "level", "turn", "inner", "rows")
    offsets = [Outer.layout.fields[name][1] for name in Outer.layout.names]  # type: ignore[index]
    assert offsets == [0, 8, 16, 32, 64] and Outer.layout.itemsize == 112
    assert Outer.layout["count"] == np.int64 and Outer.layout["level"] == np.float64
    assert Outer.layout["turn"].shape == (2,) and Outer.layout["rows"].shape == (2, 3)
    assert Outer.layout["inner"] == Inner.layout and Inner.layout.itemsize == 32


def test_a_table_starts_at_zero_and_its_rows_are_records() -> None:
    rows = table(Outer, 3)
    assert len(rows) == 3 and rows.shape == (3,)
    assert all(isinstance(row, Outer) and isinstance(row.inner, Inner) for row in rows)
    assert not np.asarray(rows).view(np.uint8).any()
    assert len(table(Outer, 0)) == 0


def test_rows_of_nodes_begin_where_lines_of_the_cache_do() -> None:
    others = []
    for k in range(40):
        # what lies between moves where the next memory begins
        others.append(np.zeros(2 * k + 1))
        rows = table(Nodes, 1)
        others += [np.asarray(rows), moving(rows)]
        for memory in others[-2:]:
            assert memory.nbytes > 10_000 and memory.ctypes.data % 64 == 0 and not memory.view(np.uint8).any()


def test_rows_fields_and_columns_share_the_tables_memory() -> None:
    rows = table(Outer, 3)
    row, inner = rows[1], rows[1].inner
    row.count, row.level, row.turn[1] = 7, 2.5, -1.0
    inner.place[:], inner.tag = (1.0, 2.0, 3.0), 4
    row.rows[1, 2] = 9.0
    assert rows["count"].tolist() == [0, 7, 0] and rows["level"].tolist() == [0.0, 2.5, 0.0]
    assert rows[1].turn.tolist() == [0.0, -1.0] and rows[1].inner.place.tolist() == [1.0, 2.0, 3.0]
    assert rows[1].inner.tag == 4 and rows[1].rows[1, 2] == 9.0
    rows["level"][:] = 5.0
    assert row.level == 5.0
    rows[2] = rows[1]
    row.count = 8
    assert rows[2].count == 7 and rows[2].inner.place.tolist() == [1.0, 2.0, 3.0]


def test_joined_copies_tables_in_order() -> None:
    first, second = table(Inner, 2), table(Inner, 1)
    first["tag"][:], second["tag"][:] = (1, 2), 3
    both = joined(Inner, [first, second])
    assert both["tag"].tolist() == [1, 2, 3] and isinstance(both[2], Inner)
    both[0].tag = 9
    assert first[0].tag == 1
    empty = joined(Inner, [])
    assert len(empty) == 0 and np.asarray(empty).dtype == Inner.layout


def test_a_view_of_a_scene_copies_none_of_its_records() -> None:
    a = scene_arrays(load("chapter8"))
    view = scene_view(a, light_rows(a, 2))
    assert len(view.spheres) == len(a.spheres) >= 2
    for kind, ours, seen in (
        (Sphere, a.spheres, view.spheres), (Floor, a.floor, view.floor), (Shading, a.shading, view.shading),
    ):  # fmt: skip
        assert kind.layout.itemsize == 8 * columns(kind) == 8 * flat(ours).shape[-1]
        assert np.shares_memory(flat(ours), flat(seen))
    a.spheres[1].radius, a.floor.present, a.shading.ks = 0.125, 0.0, 0.75
    assert view.spheres[1].radius == 0.125 and view.floor.present == 0.0 and view.shading.ks == 0.75
    view.spheres[1].center[2] = 11.0
    assert a.spheres[1].center[2] == 11.0


def test_flat_records_are_rows_of_their_numbers_and_back() -> None:
    rows = table(Sphere, 3)
    rows["radius"][:], rows["center"][1] = (1.0, 2.0, 3.0), (4.0, 5.0, 6.0)
    numbers = flat(rows)
    assert numbers.shape == (3, columns(Sphere)) and flat(rows[1]).shape == (columns(Sphere),)
    assert numbers[:, column(Sphere, "radius")].tolist() == [1.0, 2.0, 3.0]
    assert flat(rows[1])[: column(Sphere, "radius")].tolist() == [4.0, 5.0, 6.0]
    numbers[2, column(Sphere, "color") + 1] = 0.5
    flat(rows[0])[-1] = 0.25
    assert rows[2].color.tolist() == [0.0, 0.5, 0.0] and rows[0].theta_max == 0.25
    again = rows_of(Sphere, numbers)
    assert np.shares_memory(np.asarray(again), numbers) and again[1].radius == 2.0
    assert len(rows_of(Sphere, numbers[:0])) == 0 and flat(rows_of(Sphere, numbers[:0])).shape == (0, columns(Sphere))


def test_copied_and_chosen_records_have_memory_of_their_own() -> None:
    rows = table(Inner, 3)
    rows["tag"][:] = 1, 2, 3
    whole, one, some = copied(rows), copied(rows[1]), chosen(rows, rows["tag"] != 2)
    rows["tag"][:] = 9
    assert whole["tag"].tolist() == [1, 2, 3] and one.tag == 2 and some["tag"].tolist() == [1, 3]
    assert isinstance(whole[0], Inner) and isinstance(one, Inner) and isinstance(some[0], Inner)
    bare = record(Floor)
    own = copied(bare)
    own.present = 1.0
    assert bare.present == 0.0 and isinstance(own, Floor)


def test_places_of_flat_records_have_their_fields_names() -> None:
    names = [named(Sphere, k) for k in range(columns(Sphere))]
    assert names[:5] == ["center[0]", "center[1]", "center[2]", "radius", "color[0]"] and len(set(names)) == len(names)
    assert all(names[column(Sphere, name)] in (name, f"{name}[0]") for name in Sphere.names())
    with pytest.raises(KeyError, match="Sphere has no number 14"):
        named(Sphere, 14)
    with pytest.raises(KeyError):
        column(Sphere, "colour")


@pytest.mark.parametrize(
    "rows",
    [
        np.zeros((3, 13)),
        np.zeros((3, 15)),
        np.zeros(13),
        np.zeros((3, 28))[:, ::2],
        np.zeros((3, 28))[:, :14],
        np.zeros((14, 3)).T,
        np.zeros((3, 14), np.int64),
        np.zeros((3, 14), np.float32),
        np.zeros((6, 14))[::2],
    ],
)
def test_rows_of_another_length_kind_or_stride_are_refused(rows: Array) -> None:
    assert len(rows_of(Sphere, np.zeros((3, 14)))) == 3
    with pytest.raises(ValueError, match="no Sphere of 14 numbers"):
        rows_of(Sphere, rows)


@pytest.mark.parametrize("name", ["shape", "size", "view", "base", "sum", "T", "min", "copy", "dtype", "real", "item"])
def test_names_that_arrays_have_are_refused(name: str) -> None:
    with pytest.raises(TypeError, match=rf"Bad\.{name}: arrays have an attribute of this name"):
        type("Bad", (Record,), {"__annotations__": {name: float}})


@pytest.mark.parametrize("hint", [str, complex, bool, Array, tuple[float, float], list[float], float | int, np.float64])
def test_kinds_that_cannot_lie_in_a_record_are_refused(hint: Any) -> None:
    with pytest.raises(TypeError, match=r"Bad\.field: .* cannot lie in a record"):
        type("Bad", (Record,), {"__annotations__": {"field": hint}})


@jitable
def shift(inner: Inner, by: float) -> float:
    """A record in a record is handed on as one address."""
    for a in range(3):
        inner.place[a] += by
    inner.tag += 1
    return inner.place[0]


def change(row: Outer, rows: Table[Outer], at: int) -> float:
    """Reads and writes every kind of field, of one record and of a table's."""
    total = shift(row.inner, 0.5) + row.level + row.turn[1]
    row.count += 3
    row.level = total
    for k in range(rows.shape[0]):
        rows[k].rows[1, k % 3] = row.count + total
        total += rows[k].level * rows[k].turn[0]
    other = rows[at]
    other.turn[0], other.inner.tag = total, row.inner.tag
    for each in rows:
        total += each.turn[0]
    return total + shift(other.inner, -0.25)


def given() -> tuple[Outer, Table[Outer]]:
    rng = np.random.default_rng(4)
    rows = table(Outer, 5)
    rows["level"][:], rows["turn"][:], rows["count"][:] = rng.normal(size=5), rng.normal(size=(5, 2)), range(5)
    one = joined(Outer, [rows])[4]
    return one, rows


def spoken(one: Outer, rows: Table[Outer]) -> bytes:
    return one.tobytes() + np.asarray(rows).tobytes()


@pytest.mark.parametrize("compiler", ["llvm", "numba", "checked"])
def test_kernels_change_records_as_python_does(compiler: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SYMRENDER_COMPILER", compiler)
    kernel = Kernel(change, None, {})  # type: ignore[arg-type]
    expected, ours = given(), given()
    before = spoken(*ours)
    assert spoken(*expected) == before
    # a second call finds the kernel made, whichever record it is given
    for at in (2, 0):
        assert kernel(*ours, at) == change(*expected, at)
        assert spoken(*ours) == spoken(*expected) != before
    assert kernel(ours[1][3], ours[1], 1) == change(expected[1][3], expected[1], 1)
    assert spoken(*ours) == spoken(*expected)
    assert kernel.by_numba == (compiler == "numba")


def test_a_record_given_alone_is_the_type_of_a_tables() -> None:
    one, rows = given()
    assert type_of(one) == type_of(rows).element == type_of(rows[2])  # type: ignore[union-attr]
    assert type_of(one.inner) != type_of(one)


def pick(rows: Table[Inner], i: int, a: int) -> float:
    """One number of one record."""
    return rows[i].place[a] + 0.0


def test_checked_kernels_watch_tables_and_fields(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SYMRENDER_COMPILER", "checked")
    kernel = Kernel(pick, None, {})  # type: ignore[arg-type]
    rows = table(Inner, 4)
    rows["place"][:] = np.arange(12.0).reshape(4, 3)
    assert kernel(rows, 3, 2) == 11.0
    line = pick.__code__.co_firstlineno + 2
    # beyond the table, and beyond the field, where the next field lies
    for i, a in ((4, 0), (-1, 0), (0, 3), (1, -1), (10**12, 0)):
        with pytest.raises(IndexError, match=rf"test_records\.py:{line}: index"):
            kernel(rows, i, a)
    assert kernel(rows, 0, 1) == 1.0


def modules() -> list[Path]:
    """The files whose numbers have names."""
    found = [path for folder in ("chambers", "quadrature") for path in sorted((PACKAGE / folder).rglob("*.py"))]
    assert len(found) > 40
    return found


@functools.cache
def read(path: Path) -> Any:
    """All subscripts of a file; see ``subscripts``."""
    name = ".".join(("symrender", *path.relative_to(PACKAGE).with_suffix("").parts)).removesuffix(".__init__")
    return list(subscripts(importlib.import_module(name), path.read_text("utf-8")))


def is_numbered(node: ast.Subscript, of: Any) -> bool:
    """Whether a subscript picks a record's field by anything but its name."""
    if is_record(of):
        return not is_name(node.slice)
    return is_table(of) and isinstance(node.slice, ast.Tuple)


def test_no_record_is_read_by_number() -> None:
    tables, numbered = 0, []
    for path in modules():
        for function, node, of, _ in read(path):
            tables += is_table(of)
            if is_numbered(node, of):
                numbered.append(f"{path.name}:{node.lineno} {function}: {ast.unparse(node)}")
    assert tables > 300, tables
    assert not numbered, "\n".join(numbered)


WRONG = """
def one(view: View, work: Work, row: Wall, rows: Table[Wall], k: int) -> None:
    chart, points = work.chart, view.points
    a = chart[3]
    b = points[k, 2] + points[k].color[1] + rows[0].cos
    c = row[MANY] + row.disk[0] + row.axis[2] + row["cos"]
    for wall in rows:
        wall[4] = 1.0
    light = view.points[0] if k else row.disk
    light[7] = table(Wall, 2)[1][k]
"""


def test_a_record_read_by_number_is_noticed() -> None:
    module = importlib.import_module("symrender.chambers.work")
    found = {ast.unparse(node) for _, node, of, _ in subscripts(module, WRONG) if is_numbered(node, of)}
    assert found == {
        "chart[3]", "points[k, 2]", "row[MANY]", "row.disk[0]", "wall[4]", "light[7]", "table(Wall, 2)[1][k]",
    }  # fmt: skip


GIVEN = ("gauss", "lobes", "arrays.", "moved[", "tangents.")
"""Arrays that are no records: the table of rules, and what a scene, a surface and a parameter are given as."""
NUMBERED = {
    "quadrature/disk_curves.py": {"table"},
    "quadrature/disk_refined.py": {"room"},
}
"""By file the arrays whose columns or rows still have numbers, named by constants. This list only grows shorter."""


def test_what_is_still_numbered_is_listed() -> None:
    found = defaultdict(set)
    for path in modules():
        for _, node, of, reader in read(path):
            whose = reader.type_of(node.value.value) if isinstance(node.value, ast.Attribute) else None
            constants = [part for part in ast.walk(node.slice) if isinstance(part, ast.Name) and part.id.isupper()]
            name = ast.unparse(node.value)
            if constants and not is_table(of) and not is_record(whose) and not name.startswith(GIVEN):
                found[path.relative_to(PACKAGE).as_posix()].add(name)
    assert dict(found) == NUMBERED
