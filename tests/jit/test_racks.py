"""Racks: named tuples that a kernel takes by number, and that nothing is translated twice for them."""

from __future__ import annotations

from collections import Counter
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
import pytest

import symrender.jit.kernel
from symrender.jit.call import racked
from symrender.jit.kernel import Kernel
from symrender.jit.marks import jitable
from symrender.jit.program import Program
from symrender.jit.racks import Rack
from symrender.jit.records import Record, Table, table
from symrender.jit.twins import moving
from symrender.quadrature.split_point import gloss_points
from symrender.scene.arrays import FLOOR, scene_arrays
from symrender.scene.load import load

Array = npt.NDArray[np.float64]


class Spot(Record):
    """Where, and how bright."""

    level: float


class Room(NamedTuple):
    """Some of everything that kernels are given."""

    lengths: Array
    spots: Table[Spot]
    first: Spot
    missing: Array | None


class House(NamedTuple):
    """A rack in a named tuple."""

    rooms: Rack[Room]
    scale: Array


def room(k: int) -> Room:
    spots = table(Spot, 2 + k)
    spots["level"][:] = np.arange(2 + k) + 10.0 * k
    return Room(np.linspace(k, k + 1.0, 3 + k), spots, spots[1], None)


@jitable
def seen(each: Room) -> float:
    """A sum over all of a room."""
    total = each.first.level if each.missing is None else 0.0
    for x in each.lengths:
        total += x
    for spot in each.spots:
        total = 2.0 * total + spot.level
    return total


def visit(own: Room, house: House, out: Array) -> None:
    out[0] = seen(own) * house.scale[0]
    for k in range(house.scale.shape[0] - 1):
        out[1 + k] = seen(house.rooms[k]) * house.scale[1 + k]


def beyond(own: Room, house: House, out: Array) -> None:
    out[0] = seen(house.rooms[int(house.scale[0])])


@pytest.mark.parametrize("mode", ["llvm", "checked", "numba"])
@pytest.mark.parametrize("count", [0, 1, 4])
def test_every_item_is_read(mode: str, count: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SYMRENDER_COMPILER", mode)
    rooms = [room(k) for k in range(count)]
    house = House(racked(room(7), rooms), np.linspace(3.0, 4.0, 1 + count))
    out, plain = np.zeros((2, 5))
    Kernel(visit, None, {"_nrt": False})(room(7), house, out)  # type: ignore[arg-type]
    visit(room(7), house, plain)
    assert len(set(plain[: count + 1])) == count + 1, "every room is another one"
    assert out.tobytes() == plain.tobytes()


def test_an_item_that_is_not_there_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SYMRENDER_COMPILER", "checked")
    house = House(racked(room(0), [room(1), room(2)]), np.array([2.0]))
    with pytest.raises(IndexError, match=r"test_racks\.py:\d+: index beyond an axis"):
        Kernel(beyond, None, {})(room(0), house, np.zeros(1))  # type: ignore[arg-type]


def test_items_of_another_type_are_refused() -> None:
    for odd in (
        room(1)._replace(lengths=np.zeros((3, 2))[:, 0]),
        room(1)._replace(lengths=np.zeros(3, np.int64)),
        room(1)._replace(missing=np.zeros(1)),
    ):
        with pytest.raises(TypeError, match="another type than the first"):
            racked(room(0), [room(1), odd])


def test_a_rack_moves_with_its_items() -> None:
    rooms = [room(1), room(2)]
    house = House(racked(room(0), rooms), np.array([3.0, 3.0, 3.0]))
    ways = [each._replace(lengths=0.5 * each.lengths) for each in rooms]
    moves = House(racked(room(0), ways), np.array([0.25, 0.5, 1.0]))
    out = np.zeros(3, np.complex128)
    Kernel(visit, None, {"_nrt": False})(moving(room(0)), moving(house, moves), out)  # type: ignore[arg-type]
    step, ahead, behind = 1e-3, np.zeros(3), np.zeros(3)
    for by, found in ((step, ahead), (-step, behind)):
        shifted = []
        for each, way in zip(rooms, ways, strict=True):
            spots = each.spots.copy()  # type: ignore[attr-defined]
            spots["level"] += by * way.spots["level"]
            first = spots[1].copy()
            first["level"] = each.first.level + by * way.first.level
            shifted.append(Room(each.lengths + by * way.lengths, spots, first, None))
        visit(room(0), House(racked(room(0), shifted), house.scale + by * moves.scale), found)
    assert np.abs(out.imag).min() > 1.0
    # of second degree in what moves
    assert out.imag == pytest.approx((ahead - behind) / (2 * step), rel=1e-9)
    assert out.real[1:] == pytest.approx([seen(each) * 3.0 for each in rooms], rel=1e-15)


class _Translated(Exception):
    """Enough was seen."""


def test_no_function_of_the_split_rule_is_translated_twice(monkeypatch: pytest.MonkeyPatch) -> None:
    counted: Counter[Any] = Counter()

    def count(function: Any, types: Any, checked: bool = False) -> None:
        program = Program(checked)
        program.translate(function, types)
        counted.update(key for key, _ in program._functions)
        raise _Translated

    monkeypatch.setenv("SYMRENDER_COMPILER", "llvm")
    monkeypatch.setattr(Kernel, "_read", lambda *_: None)
    monkeypatch.setattr(symrender.jit.kernel, "translated", count)
    monkeypatch.setattr("symrender.quadrature.split_point.gloss_compiled", lambda: Kernel(_kernel(), None, {}))
    place, up = np.zeros((1, 3)), np.array([[0.0, 0.0, 1.0]])
    with pytest.raises(_Translated):
        gloss_points(scene_arrays(load("room")), place, up, -up, np.array([FLOOR]))
    assert len(counted) > 400
    # for spheres and for planes, which are seen in coordinates of their own
    assert [function.__qualname__ for function, times in counted.items() if times > 1] == []


def _kernel() -> Any:
    from symrender.quadrature.split_point import gloss_kernel

    return gloss_kernel
