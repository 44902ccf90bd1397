"""Tables as bytes: what comes back is the same bit for bit, and nothing altered, torn or of anything else is taken."""

from __future__ import annotations

import random
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from tests.radiometric.flats import box, rectangle, world
from tests.radiosity.rooms import MATERIALS, closed

import symrender as sr
from symrender.jit.records import copied
from symrender.radiosity import work as work_module
from symrender.radiosity.table import Sendings
from symrender.radiosity.work import Work
from symrender.runtimes import tables
from symrender.runtimes.tables import Need, given, is_had, table_of, taken
from symrender.scene.radiometric.arrays import RadiometricArrays, radiometric_arrays

TOL = 0.5
FIELDS = {"version": "1", "code": "abc"}


def arrays(**changes: Any) -> RadiometricArrays:
    """A room with a block, a sheet of a mesh, a checker, a point light and a spot."""
    key = {"type": "point", "name": "key", "position": [0.7, 0.3, 0.8], "intensity": [1, 0.8, 0.5]}
    spot = {
        "type": "spot", "name": "spot", "position": [0.2, 0.4, 0.9], "direction": [0.1, 0.2, -1],
        "intensity": [0.5, 0.5, 0.5], "beam": 10.0, "cutoff": 30.0,
    }  # fmt: skip
    tiles = {"type": "diffuse", "reflectance": {"type": "checker", "bright": 0.6, "dark": 0.2, "cell": 0.5}}
    rug = rectangle("rug", [0.1, 0.1, 0.2], [0.3, 0, 0], [0, 0.3, 0], "tiles")
    corners = [[0.5, 0.1, 0.3], [0.9, 0.1, 0.3], [0.9, 0.4, 0.5]]
    sheet = {"type": "mesh", "name": "sheet", "vertices": corners, "faces": [[0, 1, 2]], "material": "both"}
    shapes = [*closed(), box("block", [0.3, 0.6, 0.2], [0.3, 0.3, 0.4], 25.0), rug, sheet]
    scene = world(*shapes, lights=[key, spot], materials=MATERIALS | {"tiles": tiles}, bounces="all")
    return radiometric_arrays(sr.load(scene).replace(changes) if changes else sr.load(scene))


@pytest.fixture(scope="module")
def need() -> Need:
    """A table that is made soon: of bare walls and a rug."""
    key = {"type": "point", "name": "key", "position": [0.7, 0.3, 0.8], "intensity": [0.1, 0.08, 0.05]}
    rug = rectangle("rug", [0.1, 0.1, 0.2], [0.3, 0, 0], [0, 0.3, 0], "grey")
    return Need(
        radiometric_arrays(sr.load(world(*closed(), rug, lights=[key], materials=MATERIALS, bounces="all"))), TOL
    )


@pytest.fixture(autouse=True)
def nothing_had() -> None:
    tables._tables.clear()


def numbers(sent: Sendings) -> list[bytes]:
    parts = [part for each in sent.forests for part in (each.cells, each.roots, each.leaves)]
    return [np.ascontiguousarray(part).tobytes() for part in parts] + [sent.fine.hex().encode()]


class Notes:
    """Rows by name, for as long as ``most`` are kept."""

    def __init__(self, most: float = float("inf")) -> None:
        self.rows: dict[str, Any] = {}
        self.found, self.most = 0, most

    def find(self, name: str) -> Any:
        self.found += name in self.rows
        return self.rows.get(name)

    def keep(self, name: str, values: Any) -> None:
        if len(self.rows) >= self.most:
            raise KeyboardInterrupt
        assert name not in self.rows
        self.rows[name] = values.copy()


def test_a_table_comes_back_bit_for_bit(need: Need) -> None:
    made = table_of(need)
    assert len(made.forests) == 2 and min(len(each.cells) for each in made.forests) > 20
    data = given(need, FIELDS)
    tables._tables.clear()
    assert taken(need, FIELDS, data) and numbers(table_of(need)) == numbers(made)
    places = np.random.default_rng(1).uniform(0.1, 0.9, (20, 3)) * (1, 1, 0)
    owns, fronts = np.zeros(20, np.int64), np.ones(20, np.int64)
    found = table_of(need).gathered(owns, fronts, places)
    assert found[:, :3].min() > 0.0
    np.testing.assert_array_equal(found, made.gathered(owns, fronts, places))


def test_four_hundred_damages_are_not_believed(need: Need) -> None:
    table_of(need)
    data, draw = given(need, FIELDS), random.Random(3)
    tables._tables.clear()
    for trial in range(400):
        torn = bytearray(data)
        at = draw.randrange(len(torn)) if trial % 3 else draw.randrange(200)
        match trial % 4:
            case 0:
                del torn[at:]
            case 1:
                torn[at] ^= 1 << draw.randrange(8)
            case 2:
                torn[at:at] = b"x"
            case 3:
                torn = torn[:at] + torn[at + 8 :] + bytes(8)
        if torn != data:
            assert not taken(need, FIELDS, bytes(torn)), (trial, at)
            assert not is_had(need)
    assert taken(need, FIELDS, data)


def test_a_table_of_other_code_or_another_tolerance_is_not_taken(need: Need) -> None:
    table_of(need)
    data = given(need, FIELDS)
    tables._tables.clear()
    for fields in ({}, FIELDS | {"version": "2"}, FIELDS | {"code": "abd"}, FIELDS | {"more": ""}):
        assert not taken(need, fields, data)
    other = Need(need.arrays, np.nextafter(TOL, 1.0))
    assert not taken(other, FIELDS, data) and not is_had(other)


def moved(of: RadiometricArrays, part: str, row: int, place: int) -> RadiometricArrays:
    """The scene with one number of it moved by one rounding."""
    from dataclasses import replace

    rows = copied(getattr(of, part))
    bits = np.asarray(rows).view(np.int64).reshape(len(rows), -1)
    bits[row, place] ^= 1
    return replace(of, **{part: rows})


def test_every_number_of_a_scene_but_the_cameras_is_in_its_name() -> None:
    """A name that left one out would hand a scene the table of another."""
    of = arrays()
    whole, count = Need(of, TOL).key, 1
    names = {whole}
    for part in ("materials", "shapes", "facets", "frames", "lights", "directions"):
        rows = getattr(of, part)
        assert len(rows) > 0, part
        for row in range(len(rows)):
            width = np.asarray(rows).view(np.int64).reshape(len(rows), -1).shape[1]
            for place in range(width):
                names.add(Need(moved(of, part, row, place), TOL).key)
                count += 1
    for changes in ({"bounces": 1}, {"gloss": "first_hit"}):
        names.add(Need(arrays(**changes), TOL).key)
        count += 1
    assert len(names) == count > 300
    assert Need(arrays(**{"camera.eye": [0.4, 0.1, 0.5], "camera.fov": 60}), TOL).key == whole


@pytest.mark.parametrize("threads", [1, 2])
def test_a_table_that_is_interrupted_goes_on(need: Need, threads: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Whenever it ends, what was kept is not worked out again, and the table is the same bit for bit."""
    monkeypatch.setattr(work_module, "PIECE", 512)
    whole, notes = numbers(table_of(need)), Notes()
    tables._tables.clear()
    assert numbers(table_of(need, threads, notes)) == whole and not notes.found
    every = len(notes.rows)
    assert every > 30
    for most in (1, every // 3, every - 1):
        tables._tables.clear()
        left = Notes(most)
        with pytest.raises(KeyboardInterrupt):
            table_of(need, threads, left)
        assert len(left.rows) == most and not is_had(need)
        left.most = float("inf")
        assert numbers(table_of(need, threads, left)) == whole
        assert left.found == most and len(left.rows) == every


@pytest.mark.parametrize(
    "change",
    [
        lambda about, common, rows: (about + "x", common, rows),
        lambda about, common, rows: (about, [common[0] + 1e-16], rows),
        lambda about, common, rows: (about, [*common, np.zeros(0)], rows),
        lambda about, common, rows: (about, common, [rows[0], rows[1][::-1]]),
        lambda about, common, rows: (about, common, [rows[0] + 1, rows[1]]),
        lambda about, common, rows: (about, common, [rows[0][:-1], rows[1][:-1]]),
    ],
)
def test_rows_are_found_by_all_they_are_made_of(change: Callable[..., Any]) -> None:
    notes, asked = Notes(), 0

    def fill(part: slice, found: Any) -> None:
        nonlocal asked
        asked += 1
        found += 1.0 + asked

    common, rows = [np.array([1.0 / 3.0])], [np.arange(5), np.linspace(0.0, 1.0, 5)]
    first = Work(1, notes, "scene").filled(2, fill, common, rows)
    np.testing.assert_array_equal(Work(1, notes, "scene").filled(2, fill, common, rows), first)
    assert asked == 1 and first.shape == (5, 2)
    about, others, each = change("scene", common, rows)
    Work(1, notes, about).filled(2, fill, others, each)
    assert asked == 2
