"""Build the wheels: a pure one, and one with the kernels' machine code for three levels of x86-64 under Linux.

The second is the first with a folder ``symrender/_kernels`` in it. Its kernels are compiled by the very package that
lies in the first, so what is shipped belongs to the texts it is shipped with; where texts differ it is not used.
"""

from __future__ import annotations

import argparse
import base64
import hashlib
import os
import subprocess
import sys
import tempfile
import time
import zipfile
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Final

from uses import USES

HERE: Final = Path(__file__).resolve().parent
TAG: Final = "py3-none-manylinux_2_17_x86_64"
LEVELS: Final = ("x86-64-v2", "x86-64-v3", "x86-64-v4")

_DATE: Final = (1980, 1, 1, 0, 0, 0)


def pure_wheel(out: Path) -> Path:
    """Build the pure wheel of this tree into ``out``."""
    words = (
        "-m",
        "pip",
        "wheel",
        "--quiet",
        "--disable-pip-version-check",
        "--no-deps",
        "--wheel-dir",
        out,
        HERE.parent,
    )
    with tempfile.TemporaryDirectory() as scratch:
        subprocess.run([sys.executable, *map(str, words)], check=True, cwd=scratch)
    return max(out.glob("symrender-*-py3-none-any.whl"), key=lambda path: path.stat().st_mtime)


def wheel_with_kernels(pure: Path, out: Path, levels: Sequence[str], uses: Sequence[str], workers: int) -> Path:
    """The wheel ``pure`` with the kernels that ``uses`` reach, for ``levels``."""
    with tempfile.TemporaryDirectory() as scratch:
        package, kernels = Path(scratch, "package"), Path(scratch, "kernels")
        with zipfile.ZipFile(pure) as archive:
            archive.extractall(package)

        def compile_use(use: str) -> None:
            environment = os.environ | {
                "PYTHONPATH": str(package),
                "SYMRENDER_CACHE": str(Path(scratch, f"cache-{use}")),
                "SYMRENDER_COMPILER": "llvm",
            }
            words = (sys.executable, "-P", HERE / "ship.py", kernels, use, *levels)
            subprocess.run([*map(str, words)], check=True, env=environment, cwd=scratch)

        with ThreadPoolExecutor(workers) as pool:
            list(pool.map(compile_use, uses))
        made = {f"symrender/_kernels/{path.name}": path.read_bytes() for path in sorted(kernels.iterdir())}
    return _with_files(pure, out / pure.name.replace("py3-none-any", TAG), made)


def _with_files(pure: Path, wheel: Path, made: dict[str, bytes]) -> Path:
    """A copy of a wheel with more files, of another tag."""
    with zipfile.ZipFile(pure) as archive:
        files = {info.filename: archive.read(info) for info in archive.infolist()}
    (about,) = (name for name in files if name.endswith(".dist-info/WHEEL"))
    (record,) = (name for name in files if name.endswith(".dist-info/RECORD"))
    told = files[about].decode()
    assert "Root-Is-Purelib: true" in told and "Tag: py3-none-any" in told, told
    told = told.replace("Root-Is-Purelib: true", "Root-Is-Purelib: false").replace("Tag: py3-none-any", f"Tag: {TAG}")
    del files[record]
    files = made | files | {about: told.encode()}
    lines = [f"{name},sha256={_urlsafe(content)},{len(content)}" for name, content in files.items()]
    files[record] = "\n".join([*lines, f"{record},,", ""]).encode()
    with zipfile.ZipFile(wheel, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
        for name, content in files.items():
            info = zipfile.ZipInfo(name, _DATE)
            info.compress_type, info.external_attr = zipfile.ZIP_DEFLATED, 0o100644 << 16
            archive.writestr(info, content)
    return wheel


def _urlsafe(content: bytes) -> str:
    return base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()


def main() -> None:
    """Build both into the folder that is named."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, default=Path("dist"))
    parser.add_argument("--levels", nargs="+", default=LEVELS, choices=LEVELS)
    parser.add_argument("--uses", nargs="+", default=USES, choices=USES)
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1)
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    begun = time.perf_counter()
    wheels = [pure_wheel(options.out.resolve())]
    if sys.platform.startswith("linux") and os.uname().machine == "x86_64":
        out = options.out.resolve()
        wheels.append(wheel_with_kernels(wheels[0], out, options.levels, options.uses, options.workers))
    for wheel in wheels:
        print(f"wrote {wheel} ({wheel.stat().st_size / 1e6:.1f} MB)")
    print(f"in {time.perf_counter() - begun:.0f} s; to install one: pip install {wheels[-1]}")


if __name__ == "__main__":
    main()
