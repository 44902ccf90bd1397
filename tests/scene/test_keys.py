"""The tables of keys say what is accepted, and the page of scenes holds them as they are."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from symrender.cli import main
from symrender.errors import SceneError
from symrender.scene.keys import key_tables
from symrender.scene.load import load

ROW = re.compile(r"^\| `(\w+)` \| (.*?) \| (.*?) \| (.*?) \|$", re.MULTILINE)
BASE = {
    "camera": {"type": "look_at", "eye": [0, -6, 2]},
    "spheres": [{"name": "A", "center": [0, 0, 1], "radius": 1, "texture": {"type": "checker"}, "lobe": {}}],
    "floor": {"texture": {"type": "checker"}, "lobe": {}},
    "lights": [{"type": "disk", "name": "key", "position": [3, -3, 5], "radius": 1}],
    "shading": {},
}
PARTS = {
    "camera`, type: look_at": ("camera",),
    "spheres[]`": ("spheres", 0),
    "spheres[].texture`, type: checker": ("spheres", 0, "texture"),
    "spheres[].lobe`": ("spheres", 0, "lobe"),
    "floor.texture`, type: checker": ("floor", "texture"),
    "lights[]`, type: disk": ("lights", 0),
    "shading`": ("shading",),
}


def section(heading: str) -> list[tuple[str, str, str, str]]:
    # scenes in units of the series stand first
    found, *_ = [part for part in key_tables().split("### ") if part.startswith(f"`{heading}")]
    return ROW.findall(found)


def test_the_page_holds_what_the_program_prints(capsys: pytest.CaptureFixture[str]) -> None:
    page = (Path(__file__).resolve().parents[2] / "docs" / "scenes.md").read_text("utf-8")
    held = re.search(r"<!-- keys -->\n(.*)<!-- /keys -->", page, re.DOTALL)
    assert held, "docs/scenes.md has no marked region"
    assert main(["scenes", "--keys"]) == 0
    assert held[1] == capsys.readouterr().out, "put what symrender scenes --keys prints between the marks"


def test_every_key_is_told_with_its_meaning() -> None:
    rows = ROW.findall(key_tables())
    assert len(rows) > 50
    assert [row for row in rows if not all(row)] == []
    for word in ("`marble`", "`stripes`", "`plane`", "`lobe_units`", "`window_half`", "`offset`"):
        assert word in key_tables()


@pytest.mark.parametrize("heading", PARTS)
def test_what_a_row_says_is_so(heading: str) -> None:
    """The default is taken where a key is absent; a number beyond a bound, and a word that is no choice, is refused."""
    rows, path = section(heading), PARTS[heading]
    assert rows
    whole = load(BASE).model_dump()
    part = whole
    for step in path:
        part = part[step]
    judged = 0
    for key, default, accepts, _ in rows:
        if re.fullmatch(r"`[-\d.]+`", default):
            assert float(default.strip("`")) == pytest.approx(part[key], rel=1e-9)
            judged += 1
        wrong = []
        if bound := re.search(r"[≥>] (-?[\d.]+)", accepts):
            wrong.append(float(bound[1]) - 0.5)
        if bound := re.search(r"[≤<] ([\d.]+|π/2)", accepts):
            wrong.append(1.6 if bound[1] == "π/2" else float(bound[1]) + 0.5)
        if accepts.startswith("`"):
            assert default.strip("`") in accepts
            wrong.append("zzz")
        for value in wrong:
            judged += 1
            broken = [value] * int(accepts[0]) if accepts[0].isdigit() else value
            with pytest.raises(SceneError, match=key):
                load(replaced(whole, (*path, key), broken))
    assert judged >= 2


def replaced(data: object, path: tuple[object, ...], value: object) -> object:
    """A copy of ``data`` with one entry exchanged."""
    if not path:
        return value
    if isinstance(data, dict):
        return {k: replaced(v, path[1:], value) if k == path[0] else v for k, v in data.items()}
    return [replaced(v, path[1:], value) if k == path[0] else v for k, v in enumerate(data)]
