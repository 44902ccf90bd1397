"""Records what Mitsuba 3.9.1 makes of exported scenes along single rays: ``mitsuba_exports.json``.

    PYTHONPATH=src python tests/data/mitsuba_exports.py write WORK
    DRJIT_LIBLLVM_PATH=... python tests/data/mitsuba_exports.py trace WORK tests/data/mitsuba_exports.json

The first is run where symrender is, the second where Mitsuba is (``pip install mitsuba==3.9.1``). Direct light is
deterministic but in single precision: it is the mean over exports at scales from 1 to 2, each with the place that is
seen as origin, 64 of them turned, or 16 as they are where there are textures. One bounce is sampled at scale 100,
which makes nothing of the distance at which secondary rays start. Of every ray the hash of all texts that were traced
is kept, so that the record is of what is exported today.
"""

from __future__ import annotations

import hashlib
import json
import random
import re
import sys
from pathlib import Path
from typing import Any

import numpy as np

SCALES = [2.0 ** (k / 16) for k in range(16)]
FAR_SCALE = 100.0
REACH = 3.0
SAMPLES, BATCH = 1 << 23, 1 << 20
TURNS = 64
NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?=[, \"])")
HERE = Path(__file__).resolve().parent
TILES = {"type": "checker", "bright": [0.6, 0.5, 0.4], "dark": [0.1, 0.2, 0.3], "cell": 0.37}


def checkered(k: int, on: str) -> dict[str, Any]:
    """A ray to a place of a checker, on a floor that lies aslant or on a sphere."""
    draw = np.random.default_rng(100 + k)
    normal, along = np.array([0.1, -0.2, 1.0]), np.array([1.0, 0.3, 0.0])
    point = np.array([0.2, 0.1, -0.3])
    up = normal / np.linalg.norm(normal)
    center, radius = np.array([0.4, 0.3, 0.9]), 0.7
    light = np.array([-2.0, -3.0, 4.0])
    if on == "plane":
        level = np.cross(up, np.cross(along, up))
        east = level / np.linalg.norm(level)
        across = draw.uniform(-2.5, -0.5, 2)
        place = point + across[0] * east + across[1] * np.cross(up, east)
        eye = place + np.array([-0.8, -1.6, 1.5])
    else:
        toward = np.array([-0.45, -0.6, 0.55]) + 0.4 * draw.normal(size=3)
        place = center + radius * toward / np.linalg.norm(toward)
        eye = place + 2.5 * (place - center) + np.array([-0.3, 0.2, 0.5])
    away = place - eye
    scene = {
        "units": "radiometric", "name": f"checker, {on} {k}", "bounces": 0,
        "camera": {"type": "look_at", "eye": [0, -5, 2.5], "target": [0, 0, 0.5], "fov": 40},
        "materials": {"tiles": {"type": "diffuse", "reflectance": TILES}, "globe": {"type": "diffuse", "reflectance":
                      TILES | {"cell": 0.21}}},
        "shapes": [
            {"type": "plane", "name": "floor", "point": point.tolist(), "normal": normal.tolist(),
             "along": along.tolist(), "material": "tiles"},
            {"type": "sphere", "name": "A", "center": center.tolist(), "radius": radius, "material": "globe"},
        ],
        "lights": [{"type": "point", "name": "key", "position": light.tolist(), "intensity": [30.0, 25.0, 20.0]}],
    }  # fmt: skip
    return {"scene": scene, "origin": eye.tolist(), "direction": (away / np.linalg.norm(away)).tolist(),
            "place": place.tolist()}  # fmt: skip


def rays() -> list[dict[str, Any]]:
    """Rays of ``mitsuba_rays.json``, direct and (diffuse ones) with a bounce, and rays to checkers."""
    known = json.loads((HERE / "mitsuba_rays.json").read_text("utf-8"))["rays"]
    keys = ("scene", "origin", "direction", "place")
    plain = [{key: row[key] for key in keys} for row in known]
    bounced = [
        row | {"scene": row["scene"] | {"bounces": 1, "name": row["scene"]["name"] + ", one bounce"}}
        for row in plain
        if row["scene"]["name"].startswith("diffuse") and row["scene"]["name"].endswith("point")
    ]
    return plain + bounced + [checkered(k, on) for on in ("plane", "sphere") for k in range(8)]


def turn(k: int) -> np.ndarray:
    """The k-th rotation, of a quaternion of whole numbers."""
    chance = random.Random(k)
    a, b, c, d = chance.randint(1, 9), chance.randint(-9, 9), chance.randint(-9, 9), chance.randint(-9, 9)
    size = a * a + b * b + c * c + d * d
    return np.array([
        [a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c)],
        [2 * (b * c + a * d), a * a - b * b + c * c - d * d, 2 * (c * d - a * b)],
        [2 * (b * d - a * c), 2 * (c * d + a * b), a * a - b * b - c * c + d * d],
    ]) / size  # fmt: skip


def turned(row: dict[str, Any], by: np.ndarray) -> dict[str, Any]:
    """The scene of a ray and the ray itself, turned."""

    def to(v: Any) -> list[float]:
        return [float(sum(m * x for m, x in zip(line, v, strict=True))) for line in by]

    scene = json.loads(json.dumps(row["scene"]))
    parts = [scene["camera"], *scene["shapes"], *scene["lights"]]
    for part in parts:
        if part["type"] in ("plane", "look_at"):
            part.setdefault(*("along", [1, 0, 0]) if part["type"] == "plane" else ("up", [0, 0, 1]))
        for key in {"eye", "target", "up", "point", "normal", "along", "center", "position", "direction"} & set(part):
            part[key] = to(part[key])
    return {"scene": scene} | {key: to(row[key]) for key in ("origin", "direction", "place")}


def exports(row: dict[str, Any]) -> list[dict[str, Any]]:
    """The exports of a ray: text, and the ray in the place and at the scale of the text."""
    import symrender as sr

    if row["scene"]["bounces"]:
        cases = [(FAR_SCALE, row)]
    elif "checker" in row["scene"]["name"]:
        cases = [(scale, row) for scale in SCALES]  # the chart of a sphere is not turned
    else:
        cases = [(SCALES[k % 16], turned(row, turn(k))) for k in range(TURNS)]
    made = []
    for scale, one in cases:
        place = tuple(one["place"])
        text = sr.export(one["scene"], "mitsuba", scale=scale, center=place, reach=REACH, size=1, samples=1)
        away = [scale * (x - c) for x, c in zip(one["origin"], place, strict=True)]
        made.append({"text": text.files["scene.xml"], "origin": away, "direction": one["direction"]})
    return made


def digest(made: list[dict[str, Any]]) -> str:
    """Of all texts, numbers to six digits: the last bits are the processor's."""

    def short(match: re.Match[str]) -> str:
        value = float(match[0])
        return f"{value if abs(value) > 1e-9 else 0.0:.6g}"

    texts = (NUMBER.sub(short, one["text"]) for one in made)
    return hashlib.sha256("".join(texts).encode()).hexdigest()


def write(work: Path) -> None:
    work.mkdir(parents=True, exist_ok=True)
    rows = [row | {"made": (made := exports(row)), "sha256": digest(made)} for row in rays()]
    (work / "rows.json").write_text(json.dumps(rows))


def trace(work: Path, out: Path) -> None:
    import mitsuba as mi

    rows = json.loads((work / "rows.json").read_text())
    kept: dict[int, dict[str, Any]] = {}
    for variant, bounced in (("scalar_rgb", False), ("llvm_ad_rgb", True)):
        mi.set_variant(variant)
        for number, row in enumerate(rows):
            if bool(row["scene"]["bounces"]) != bounced:
                continue
            found = [np.array(light(mi, one, 1000 * number + k)) for one in row["made"]
                     for k in range(SAMPLES // BATCH if bounced else 1)]  # fmt: skip
            total, squares = np.sum(found, axis=0)
            count = SAMPLES if bounced else len(found)
            mean = total / count
            spread = np.sqrt(np.maximum(0.0, squares / count - mean**2) / count)
            kept[number] = {key: row[key] for key in ("scene", "origin", "direction", "place", "sha256")}
            kept[number] |= {"mean": mean.tolist(), "error": spread.tolist(), "samples": count}
            print(row["scene"]["name"], mean, spread, flush=True)
    out.write_text(json.dumps({"mitsuba": mi.__version__, "rays": [kept[k] for k in sorted(kept)]}) + "\n")


def light(mi: Any, one: dict[str, Any], seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Sum and sum of squares of what comes back, over one ray or, in a variant of many, a batch."""
    scene, sampler = mi.load_string(one["text"]), mi.load_dict({"type": "independent"})
    many = 1 if mi.variant().startswith("scalar") else BATCH
    sampler.seed(seed, many)
    origin, way = mi.Point3f(one["origin"]), mi.Vector3f(one["direction"])
    if many > 1:
        import drjit as dr

        origin, way = dr.tile(origin, many), dr.tile(way, many)
    found = scene.integrator().sample(scene, sampler, mi.RayDifferential3f(origin, way))[0]
    values = np.array(found, dtype=np.float64).reshape(3, -1)
    return values.sum(axis=1), (values**2).sum(axis=1)


if __name__ == "__main__":
    if sys.argv[1] == "write":
        write(Path(sys.argv[2]))
    else:
        trace(Path(sys.argv[2]), Path(sys.argv[3]))
