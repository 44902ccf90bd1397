"""From a wheel with machine code, in an empty folder with an empty cache, the first value is there at once.

So is the first image of every gallery scene, and the first derivative of the radiometric ones.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

from measure import Report, median

ROOT = Path(__file__).resolve().parents[1]
PROGRAM = """
import json, sys, time
begun, used = time.perf_counter(), time.process_time()
import symrender as sr
from symrender.jit.kernel import Kernel
compiled, compile_ = [], Kernel._compile
def told(self, types, checked):
    compiled.append(self.function.__name__)
    return compile_(self, types, checked)
Kernel._compile = told
import numpy, llvmlite.binding
imported = time.perf_counter() - begun
wanted = {"wrt": ["spheres.B.radius"]} if sys.argv[1] == "slope" else {}
found = sr.probe("gloss", [(-0.5, -1.5, 0.0)], surface="floor", tol=1e-6, **wanted)
arrays = (found.gloss, found.error, *(found.gradient or {}).values())
assert found.gloss.max() > 0.1
took = time.perf_counter() - begun - imported, time.process_time() - used
print(json.dumps([imported, *took, compiled, b"".join(each.tobytes() for each in arrays).hex()]))
"""


SCENES = """
import json
import symrender as sr
from symrender.jit.kernel import Kernel
from symrender.scene.gallery import all_names
from symrender.scene.load import load_any
from symrender.scene.parameters import parameters
from symrender.scene.radiometric.scene import RadiometricScene
compiled, compile_, seen = [], Kernel._compile, 0
def told(self, types, checked):
    compiled.append(self.function.__name__)
    return compile_(self, types, checked)
Kernel._compile = told
for name in all_names():
    scene = load_any(name)
    image = sr.truth(scene, size=4, tol=1e-1, threads=1)
    if isinstance(scene, RadiometricScene):
        sent = [p.name for p in parameters(scene) if p.name.startswith("lights.") and p.unit.startswith("W")]
        assert sent, name
        seen += 1
        image = sr.gradient(scene, sent[:1], size=4, tol=1e-1, threads=1)[sent[0]]
assert seen == 8
print(json.dumps(sorted(set(compiled))))
"""


def scenes(package: Path, cache: Path) -> list[str]:
    """What the first image of every gallery scene, and a derivative of the radiometric ones, compiles."""
    environment = os.environ | {"PYTHONPATH": str(package), "SYMRENDER_CACHE": str(cache)}
    with tempfile.TemporaryDirectory() as empty:
        words = [sys.executable, "-P", "-c", SCENES]
        done = subprocess.run(words, env=environment, cwd=empty, check=True, stdout=subprocess.PIPE)
    return list(json.loads(done.stdout))


def first(kind: str, package: Path, cache: Path) -> tuple[float, float, float, list[str], str]:
    """Import and first value, CPU seconds, what was compiled, the bits; of a process in an empty folder."""
    environment = os.environ | {"PYTHONPATH": str(package), "SYMRENDER_CACHE": str(cache)}
    with tempfile.TemporaryDirectory() as empty:
        words = [sys.executable, "-P", "-c", PROGRAM, kind]
        done = subprocess.run(words, env=environment, cwd=empty, check=True, stdout=subprocess.PIPE)
    imported, value, cpu, compiled, bits = json.loads(done.stdout)
    return imported, value, cpu, compiled, bits


def main() -> None:
    """Build both wheels, install them beside each other, and time first values of each."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="fewer processes")
    parser.add_argument("--wheels", type=Path, help="folder with both wheels, to save building them")
    options = parser.parse_args()
    rounds = 3 if options.quick else 9
    report = Report(
        "a_wheel_needs_no_compilation",
        "gloss, one floor point to 1e-6, alone and with one derivative; empty folder, empty cache; medians of "
        f"{rounds} processes from the wheel with machine code, and one from the pure wheel.",
    )
    rows, several, equal, seconds = [], 0, True, []
    with tempfile.TemporaryDirectory() as scratch:
        out = options.wheels
        if out is None:
            out = Path(scratch, "dist")
            words = [sys.executable, ROOT / "wheels" / "make_wheels.py", "--out", out]
            subprocess.run(words, check=True, stdout=subprocess.DEVNULL)
        places = {}
        for wheel in out.glob("*.whl"):
            name = "pure wheel" if wheel.stem.endswith("any") else "wheel with machine code"
            places[name] = Path(scratch, name)
            pip = [sys.executable, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--no-deps"]
            subprocess.run([*pip, "--target", places[name], wheel], check=True, cwd=scratch)
        assert len(places) == 2, "this machine makes one wheel only"
        for kind in ("value", "slope"):
            bits = set()
            for name, place in sorted(places.items()):
                shipped = name != "pure wheel"
                caches = [Path(scratch, f"cache-{name}-{kind}-{k}") for k in range(rounds if shipped else 1)]
                found = [first(kind, place, cache) for cache in caches]
                bits |= {each[4] for each in found}
                if shipped:
                    several += sum(len(each[3]) for each in found)
                    seconds.append(median([each[1] for each in found]))
                else:
                    assert found[0][3], "the pure wheel compiles"
                rows.append((kind, name, *(median([each[k] for each in found]) for k in range(3)), len(found[0][3])))
            equal = equal and len(bits) == 1
        left = scenes(places["wheel with machine code"], Path(scratch, "cache-scenes"))
    report.table(("first", "from", "import s", "value s", "CPU s", "kernels compiled"), rows)
    report.claim_number("kernels compiled by a wheel with machine code", several + len(left), 0)
    report.say(f"Images of all gallery scenes, and derivatives of radiometric ones, compile {left or 'nothing'}.")
    report.claim_number("values of other bits than those compiled here", 0 if equal else 1, 0)
    report.claim_time("first value after the import, wall", seconds[0], 0, 1.5, " s")
    report.claim_time("first value with a derivative after the import, wall", seconds[1], 0, 1.5, " s")
    report.leave()


if __name__ == "__main__":
    main()
