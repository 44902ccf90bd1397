"""The page as text: weight, one file, hostile names as text, the same bytes twice."""

from __future__ import annotations

import json
import re
import urllib.error
import urllib.request
from threading import Thread

import pytest

import symrender as sr
from symrender.errors import OptionError, OutputError, Unsupported
from symrender.scene import gallery
from symrender.scene.load import load
from symrender.simulator.build import escaped, page_data, simulator
from symrender.simulator.columns import entries
from symrender.simulator.serve import server

HOSTILE = (
    "</script><script>alert(1)</script>",
    "<!--<script>",
    "]]>",
    "\u2028\u2029",
    "${alert(1)}`",
    "javascript:alert(1)",
    "x; } void main(){} //",
    "@@script@@",
)


@pytest.mark.parametrize("name", gallery.names())
def test_a_page_is_one_file_below_a_megabyte_that_loads_nothing(name):
    page = simulator(name).html
    assert len(page.encode()) < 1_000_000
    assert re.findall(r"(?:src|href)=\"(?!#|data:image/jpeg)", page.split("<script type")[0]) == []
    assert "http://" not in page and "https://" not in page
    assert page.count("<script") == 2


def test_the_same_scene_gives_the_same_bytes():
    assert simulator("chapter8").html == simulator("chapter8").html


@pytest.mark.parametrize("name", HOSTILE)
def test_a_hostile_name_stays_text(name):
    scene = load("furnace").model_copy(update={"name": name, "description": name})
    page = simulator(scene).html
    assert page.count("<script") == 2
    assert page.count("</script") == 2
    block = page.split('id="data">')[1].split("</script>")[0]
    assert not set(block) & set("<>&\u2028\u2029")
    assert json.loads(block)["name"] == name


def test_escaped_json_reads_back():
    data = {"a": "<>&\u2028\u2029", "b": [1.5e-300, -0.0]}
    assert json.loads(escaped(data)) == data


@pytest.mark.parametrize("name", gallery.names())
def test_every_number_of_a_scene_stands_where_the_page_is_told(name):
    scene = load(name)
    data = page_data(scene)
    found = list(entries(scene))
    assert {e["name"] for e in found} >= {p.name for p in scene.parameters()}
    for entry in found:
        table, index = entry["at"]
        rows = data["arrays"][table]
        flat = [v for row in rows for v in row] if rows and isinstance(rows[0], list) else rows
        wanted = entry["choices"].index(entry["value"]) if "choices" in entry else entry["value"]
        # a disk of radius 0 and a mirror are stored as what they are the limits of
        if not entry["name"].endswith(("theta_max", "target.x", "target.y", "target.z")):
            assert flat[index] == wanted, entry["name"]


def test_too_many_spheres_are_refused_by_name():
    ball = load("chapter8").spheres[0]
    many = tuple(ball.model_copy(update={"name": f"S{k}", "center": (3.0 * k, 0.0, 1.0)}) for k in range(61))
    with pytest.raises(Unsupported, match="61 spheres exceed 60"):
        simulator(load("chapter8").model_copy(update={"spheres": many}))


def test_a_notebook_shows_the_page_in_a_frame(tmp_path):
    made = sr.simulator("mirror", tmp_path / "page.html")
    assert (tmp_path / "page.html").read_text(encoding="utf-8") == made.html
    frame = made._repr_html_()
    assert frame.startswith("<iframe srcdoc=")
    assert "<script" not in frame
    with pytest.raises(OutputError):
        made.save(tmp_path / "page.html", force=False)


def test_the_server_knows_one_address_on_the_loopback_interface():
    made = simulator("furnace")
    with server(made) as running:
        assert running.server_address[0] == "127.0.0.1"
        thread = Thread(target=running.serve_forever)
        thread.start()
        try:
            address = f"http://127.0.0.1:{running.server_port}"
            with urllib.request.urlopen(f"{address}/") as answer:
                assert answer.read().decode() == made.html
            with pytest.raises(urllib.error.HTTPError) as missing:
                urllib.request.urlopen(f"{address}/etc/passwd")
            missing.value.close()
            with pytest.raises(OptionError, match="port"):
                server(made, running.server_port)
        finally:
            running.shutdown()
            thread.join()
