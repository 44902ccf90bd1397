"""``symrender doctor``: what this machine offers, in one block to paste into a report."""

from __future__ import annotations

import importlib.metadata
import math
import os
import platform
import re
import sys
from pathlib import Path

import typer

from symrender.cli._options import Json
from symrender.errors import extras

_CORE = ("numpy", "scipy", "sympy", "numba", "llvmlite", "pydantic", "PyYAML", "typer", "rich", "pillow", "OpenEXR")
_FEATURES = ("sse4_2", "avx", "avx2", "fma", "avx512f", "asimd", "sve")


def doctor(json: Json = False) -> None:
    """Print versions, processor, threads, the kernel cache and the extras: one block to paste into a report.

    Example: symrender doctor
    """
    from symrender.jit.beside import processors

    facts = {
        "symrender": _version("symrender"),
        "python": f"{platform.python_version()} {platform.python_implementation()}",
        "system": f"{platform.system()} {platform.release()} {platform.machine()}",
        "processor": _processor(),
        "threads": f"{processors()} usable of {os.cpu_count()}",
        "kernels shipped": _shipped(),
        "kernel cache": _cache(),
        **{name: _version(name) for name in _CORE},
        "arithmetic": _arithmetic(),
        "gpu": "not used: kernels run on the processor; pages draw by the browser's WebGL 2",
        **{f"extra {name}": _listed(packages) for name, packages in extras().items()},
        "terminal": f"{sys.stdout.encoding}, {'colour' if sys.stdout.isatty() else 'not a terminal'}",
    }
    if json:
        import json as json_module

        typer.echo(json_module.dumps(facts, indent=2))
    else:
        width = max(map(len, facts))
        typer.echo("\n".join(f"{name.ljust(width)}  {fact}" for name, fact in facts.items()))


def _arithmetic() -> str:
    """Whether doubles are rounded as the figures of symrender assume."""
    exact = (0.1 + 0.2 == 0.30000000000000004, 2.0**-1074 > 0.0, 1.0 + 2.0**-53 == 1.0, math.sqrt(2.0) ** 2 != 2.0)
    return "IEEE doubles, gradual underflow, round to even" if all(exact) else "NOT IEEE doubles: distrust every figure"


def _listed(requirements: list[str]) -> str:
    names = [re.split(r"[<>=!~ ]", requirement)[0] for requirement in requirements]
    return ", ".join(f"{name} {_version(name)}" for name in names)


def _version(package: str) -> str:
    try:
        return importlib.metadata.version(package)
    except importlib.metadata.PackageNotFoundError:
        return "not installed"


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        return platform.processor() or "unknown"
    fields = {key.strip(): value.strip() for key, _, value in (line.partition(":") for line in lines)}
    flags = set((fields.get("flags") or fields.get("Features") or "").split())
    name = fields.get("model name") or platform.processor() or platform.machine()
    return f"{name} ({' '.join(f for f in _FEATURES if f in flags) or 'features unknown'})"


def _shipped() -> str:
    from symrender.jit.levels import levels_here
    from symrender.jit.shelf import PACKAGE_FOLDER

    if not PACKAGE_FOLDER.is_dir():
        return "none: they are compiled when they are first used"
    entries = list(PACKAGE_FOLDER.glob("*.kernel"))
    return f"{len(entries)} files; this processor runs those for {', '.join(levels_here()) or 'none of their levels'}"


def _cache() -> str:
    from symrender.jit.entries import cache_directory

    directory, reason = cache_directory()
    if directory is None:
        return f"in memory only: {reason}"
    entries = [entry for entry in directory.iterdir() if entry.is_file()] if directory.is_dir() else []
    return f"{directory} ({len(entries)} files, {sum(e.stat().st_size for e in entries) / 1e6:.1f} MB)"
