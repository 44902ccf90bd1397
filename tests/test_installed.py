"""The package alone, in an environment made for it, does what needs no extra.

``benchmarks/every_verb_in_a_fresh_installation.py`` runs all verbs over all scenes, and each extra on its own.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
PIP = ("-m", "pip", "--quiet", "--disable-pip-version-check")


@pytest.mark.timeout(1500)
@pytest.mark.skipif(sys.platform == "win32", reason="the interpreter of an environment has another path")
def test_a_base_installation_is_enough(tmp_path: Path) -> None:
    words = [sys.executable, *PIP, "download", "--no-deps", "--dest", tmp_path / "builder", "hatchling>=1.24"]
    if subprocess.run(words, capture_output=True).returncode:
        pytest.skip("pip reaches no package index from this machine")
    subprocess.run([sys.executable, "-m", "venv", tmp_path / "made"], check=True)
    python = tmp_path / "made" / "bin" / "python"
    made = subprocess.run([python, *PIP, "install", "--no-compile", ROOT], capture_output=True, text=True)
    assert made.returncode == 0, made.stderr
    ask = "from importlib.metadata import distributions as d; print(*(each.name for each in d()))"
    named = subprocess.run([python, "-P", "-c", ask], capture_output=True, text=True, check=True)
    packages = set(named.stdout.lower().split())
    assert "symrender" in packages and not packages & {"distributed", "matplotlib", "python-flint", "pytest"}
    here = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    program = [python, "-P", "-W", "error", ROOT / "tests" / "installed.py", "few"]
    done = subprocess.run(program, capture_output=True, text=True, cwd=tmp_path, env=here)
    assert done.returncode == 0, done.stderr
    runs = [json.loads(line) for line in done.stdout.splitlines()]
    assert len(runs) == 6 and not [each for each in runs if each["fault"]], runs
