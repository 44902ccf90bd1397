"""Records what Mitsuba 3.9.1 makes of exported scenes of flat shapes along single rays: ``mitsuba_flats.json``.

    PYTHONPATH=src:. python tests/data/mitsuba_flats.py write WORK
    DRJIT_LIBLLVM_PATH=... python tests/data/mitsuba_flats.py trace WORK tests/data/mitsuba_flats.json

The first is run where symrender is, the second where Mitsuba is (``pip install mitsuba==3.9.1``). Crowds of
rectangles, triangles, disks, boxes and spheres in and through each other are lit by a sky, by a shape that emits, or
by a point and a sun; rays go to places that get some of the light but not all of it. Scenes are exported at scale 100
about the place, where what secondary rays start above a surface is nothing; sums of all samples are kept, and the hash
of all texts (``digest`` of ``mitsuba_exports.py``).
"""

from __future__ import annotations

import hashlib
import json
import re
import sys
from pathlib import Path
from typing import Any

import numpy as np

SCALE = 100.0
SAMPLES, BATCH = 1 << 22, 1 << 20
LIGHTS = ("sky", "rectangle", "triangle", "box", "sphere", "points")
EACH = 6
NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?=[, \"\n])")


def rows() -> list[dict[str, Any]]:
    """Rays: ``EACH`` a kind of light, to places that get between a tenth and nine tenths of the most any ray found."""
    from tests.radiometric import flats

    import symrender as sr

    found: list[dict[str, Any]] = []
    for kind in LIGHTS:
        seed = kept = 0
        while kept < EACH:
            seed += 1
            rng = np.random.default_rng([seed, LIGHTS.index(kind)])
            kinds = ("rectangle", "triangle", "box", "sphere", *(("disk",) if kind == "points" else ()))
            # Mitsuba's planes end, and the sky shines in beyond them
            shapes = [flats.rectangle("floor", [-4, -4, -1.5], [8, 0, 0], [0, 8, 0])]
            shapes += [flats.one_of(rng, shape, f"{shape}{k}", "white", 1.2) for shape in kinds for k in range(2)]
            lights: list[dict[str, Any]] = [{"type": "sky", "name": "sky", "radiance": [1.0, 0.8, 0.6]}]
            if kind == "points":
                lights = [
                    {"type": "point", "name": "key", "position": [1.5, -2, 3], "intensity": [30, 20, 10]},
                    {"type": "directional", "name": "sun", "direction": [0.4, 0.5, -1], "irradiance": [1, 2, 3]},
                ]
            elif kind != "sky":
                shapes.append(flats.one_of(rng, kind, "lamp", "white"))
                lights = [flats.area("lamp", [3.0, 2.0, 1.0])]
            scene = flats.world(*shapes, lights=lights, name=f"{kind} {seed}")
            origin = rng.uniform(-2, 2, 3) + np.array([0.0, 0.0, 2.5])
            ways = rng.normal(size=(40, 3)) * 0.8 - origin
            ways /= np.linalg.norm(ways, axis=1, keepdims=True)
            try:
                light = sr.probe(scene, rays=(np.tile(origin, (40, 1)), ways), tol=1e-6)
            except sr.errors.Unsupported:
                continue
            level = light.direct[:, 0] / max(light.direct[:, 0].max(), 1e-9)
            some = np.flatnonzero((level > 0.1) & (level < 0.9) & (light.error < 1e-8) & (light.direct[:, 0] > 1e-3))
            if len(some) < 3:
                continue
            hit = sr.probe(scene, rays=(origin, ways[some[0]]))
            place = origin + ways[some[0]] * _reach(scene, origin, ways[some[0]])
            assert hit.shape[0] != "nothing"
            found.append({"scene": scene, "origin": origin.tolist(), "direction": ways[some[0]].tolist(),
                          "place": place.tolist()})  # fmt: skip
            kept += 1
    return found


def _reach(scene: dict[str, Any], origin: np.ndarray, way: np.ndarray) -> float:
    """Distance of the first hit, by the path tracer's own text run in Python."""
    import symrender as sr
    from symrender.numeric.radiometric.hits import first_hit
    from symrender.numeric.radiometric.world import make_world
    from symrender.scene.radiometric.arrays import radiometric_arrays

    world = make_world(radiometric_arrays(sr.load(scene)))
    return float(first_hit(world, tuple(map(float, origin)), tuple(map(float, way)), -1, -1, False).distance)


def exports(row: dict[str, Any]) -> dict[str, Any]:
    """The files of a ray's export, and the ray at its scale."""
    import symrender as sr

    place = tuple(row["place"])
    made = sr.export(row["scene"], "mitsuba", scale=SCALE, center=place, size=1, samples=1)
    away = [SCALE * (x - c) for x, c in zip(row["origin"], place, strict=True)]
    files = {name: text for name, text in made.files.items() if name.endswith((".xml", ".ply"))}
    return {"files": files, "origin": away, "direction": row["direction"]}


def digest(files: dict[str, str]) -> str:
    """Of all texts, numbers to six digits: the last bits are the processor's."""

    def short(match: re.Match[str]) -> str:
        value = float(match[0])
        return f"{value if abs(value) > 1e-9 else 0.0:.6g}"

    texts = (f"{name}\n{NUMBER.sub(short, files[name])}" for name in sorted(files))
    return hashlib.sha256("".join(texts).encode()).hexdigest()


def write(work: Path) -> None:
    work.mkdir(parents=True, exist_ok=True)
    done = [row | {"made": (made := exports(row)), "sha256": digest(made["files"])} for row in rows()]
    (work / "rows.json").write_text(json.dumps(done))


def trace(work: Path, out: Path) -> None:
    import drjit as dr
    import mitsuba as mi

    mi.set_variant("llvm_ad_rgb")
    kept = []
    for number, row in enumerate(json.loads((work / "rows.json").read_text())):
        folder = work / str(number)
        folder.mkdir(exist_ok=True)
        for name, text in row["made"]["files"].items():
            (folder / name).write_text(text)
        scene = mi.load_file(str(folder / "scene.xml"))
        total, squares = np.zeros(3), np.zeros(3)
        for k in range(SAMPLES // BATCH):
            sampler = mi.load_dict({"type": "independent"})
            sampler.seed(1000 * number + k, BATCH)
            ray = mi.RayDifferential3f(dr.tile(mi.Point3f(row["made"]["origin"]), BATCH),
                                       dr.tile(mi.Vector3f(row["made"]["direction"]), BATCH))  # fmt: skip
            values = np.array(scene.integrator().sample(scene, sampler, ray)[0], dtype=np.float64).reshape(3, -1)
            total, squares = total + values.sum(axis=1), squares + (values**2).sum(axis=1)
        kept.append({key: row[key] for key in ("scene", "origin", "direction", "place", "sha256")}
                    | {"sum": total.tolist(), "sum_of_squares": squares.tolist(), "samples": SAMPLES})  # fmt: skip
        print(row["scene"]["name"], total / SAMPLES, flush=True)
    out.write_text(json.dumps({"mitsuba": mi.__version__, "rays": kept}) + "\n")


if __name__ == "__main__":
    if sys.argv[1] == "write":
        write(Path(sys.argv[2]))
    else:
        trace(Path(sys.argv[2]), Path(sys.argv[3]))
