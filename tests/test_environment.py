"""The bytes of an image come from the scene and the settings, whatever the process that makes it is surrounded by."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

PROGRAM = (
    "import hashlib, sys\n"
    "from symrender.render import render\n"
    "pair = render('gloss', size=(24, 16), lobe=3, threads=3, tile=5)\n"
    "layers = [layer for image in (pair.numeric, pair.symbolic) for layer in image.layers.values()]\n"
    "assert len(layers) == 8 and layers[0].max() > .1 or sys.exit(3)\n"
    "print(hashlib.sha256(b''.join(layer.tobytes() for layer in layers)).hexdigest())\n"
)


def digest(*flags: str, cwd: Path | None = None, before: str = "", **environment: str) -> str:
    done = subprocess.run(
        [sys.executable, *flags, "-c", before + PROGRAM],
        capture_output=True,
        text=True,
        cwd=cwd,
        env=os.environ | environment,
        timeout=250,
    )
    assert done.returncode == 0, done.stderr
    assert "Traceback" not in done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def reference() -> str:
    found = digest()
    assert len(found) == 65
    return found


@pytest.mark.parametrize(
    "environment",
    [
        {"NUMBA_THREADING_LAYER": "workqueue"},
        {"LC_ALL": "tr_TR.UTF-8", "LANG": "de_DE.UTF-8", "TZ": "Asia/Kathmandu"},
        {"PYTHONHASHSEED": "12345", "OMP_NUM_THREADS": "1"},
        {"PYTHONOPTIMIZE": "2"},
        {"HOME": "/nonexistent", "XDG_CACHE_HOME": "/nonexistent/cache", "SYMRENDER_CACHE": "/dev/null/x"},
    ],
    ids=lambda environment: ",".join(environment),
)
def test_same_bytes_in_any_environment(environment: dict[str, str], reference: str) -> None:
    assert digest(**environment) == reference


def test_same_bytes_in_a_folder_with_any_name(tmp_path: Path, reference: str) -> None:
    folder = tmp_path / "ünïcode ‮ folder"
    folder.mkdir()
    assert digest(cwd=folder) == reference


@pytest.mark.skipif(not hasattr(os, "sched_setaffinity"), reason="needs processor affinity")
def test_same_bytes_on_one_processor(reference: str) -> None:
    assert digest(before="import os; os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})\n") == reference


@pytest.mark.skipif(sys.platform != "linux", reason="needs a limit on address space")
def test_too_little_memory_is_one_line(tmp_path: Path) -> None:
    program = (
        "import resource, sys\n"
        "from symrender.cli import main\n"
        "import symrender.numeric.pipeline, symrender.runtimes.image\n"
        "from symrender.render import render\n"
        "render('gloss', size=8, threads=1)\n"
        "with open('/proc/self/statm') as file: now = int(file.read().split()[0]) * resource.getpagesize()\n"
        "resource.setrlimit(resource.RLIMIT_AS, (now + (1 << 30),) * 2)\n"
        "sys.exit(main(['render', 'gloss', '--size', '6000', '--quiet', '--threads', '1', '--out', sys.argv[1]]))\n"
    )
    done = subprocess.run([sys.executable, "-c", program, str(tmp_path)], capture_output=True, text=True, timeout=250)
    assert done.returncode == 2
    assert done.stderr == "ERROR out of memory; ask for a smaller size\n"
    assert list(tmp_path.iterdir()) == []
