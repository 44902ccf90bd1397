"""A wheel with machine code: what it brings is used from an empty folder with an empty cache, where texts are equal."""

from __future__ import annotations

import csv
import os
import platform
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from symrender.jit.levels import LEVELS, levels_here

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "wheels"))
import make_wheels

ROOT = Path(__file__).resolve().parents[1]
pytestmark = pytest.mark.skipif(
    sys.platform != "linux" or platform.machine() != "x86_64", reason="machine code is shipped for x86-64 under Linux"
)

PROGRAM = """
import hashlib, sys
import symrender as sr
from symrender.jit import kernel
compiled, compile_ = [], kernel.Kernel._compile
def told(self, types, checked):
    compiled.append(self.function.__name__)
    return compile_(self, types, checked)
kernel.Kernel._compile = told
numeric = sr.render("gloss", size=12, lobe=2, threads=1, symbolic="none").numeric
symbolic = sr.render("gloss", size=12, lobe=2, threads=1, numeric="none").symbolic
layers = [layer for image in (numeric, symbolic) for layer in image.layers.values()]
assert len(layers) == 8 and layers[0].max() > .1
print(sr.__file__, sorted(compiled), "sympy" in sys.modules, "numba" in sys.modules)
print(hashlib.sha256(b"".join(layer.tobytes() for layer in layers)).hexdigest())
"""
KERNELS = "['render_tile', 'tile']"


@pytest.fixture(scope="module")
def pure(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The package as a pure wheel, without the tools and the network that building one takes."""
    path = tmp_path_factory.mktemp("pure") / "symrender-0.0.0-py3-none-any.whl"
    with zipfile.ZipFile(path, "w") as archive:
        for file in sorted((ROOT / "src" / "symrender").rglob("*")):
            if file.is_file() and file.suffix != ".pyc":
                archive.write(file, file.relative_to(ROOT / "src").as_posix())
        about = "Wheel-Version: 1.0\nGenerator: a test\nRoot-Is-Purelib: true\nTag: py3-none-any\n"
        archive.writestr("symrender-0.0.0.dist-info/WHEEL", about)
        archive.writestr(
            "symrender-0.0.0.dist-info/METADATA", "Metadata-Version: 2.1\nName: symrender\nVersion: 0.0.0\n"
        )
        archive.writestr("symrender-0.0.0.dist-info/RECORD", "")
    return path


@pytest.fixture(scope="module")
def wheel(pure: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The wheel with two of the smallest kernels."""
    out = tmp_path_factory.mktemp("wheel")
    return make_wheels.wheel_with_kernels(pure, out, ["x86-64-v2", *levels_here()[:1]], ["pair"], workers=1)


@pytest.fixture(scope="module")
def placed(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder into which pip has installed it."""
    folder = tmp_path_factory.mktemp("placed")
    words = ("install", "--quiet", "--disable-pip-version-check", "--no-index", "--no-deps", "--no-compile", "--target")
    subprocess.run([sys.executable, "-m", "pip", *words, folder / "installed", wheel], check=True, cwd=folder)
    return folder / "installed"


@pytest.fixture(scope="module")
def whole(placed: Path) -> tuple[str, str]:
    """What the installed wheel compiles, and the digest of its layers."""
    return run(placed)


@pytest.fixture
def installed(placed: Path, tmp_path: Path) -> Path:
    """A copy to be spoilt."""
    shutil.copytree(placed / "symrender", tmp_path / "installed" / "symrender")
    return tmp_path / "installed"


def run(installed: Path, before: str = "") -> tuple[str, str]:
    """What was compiled, and the digest of the layers, of a process in an empty folder with an empty cache."""
    empty = installed.parent / "empty"
    shutil.rmtree(empty, ignore_errors=True)
    empty.mkdir()
    environment = os.environ | {"PYTHONPATH": str(installed), "SYMRENDER_CACHE": str(installed.parent / "cache")}
    shutil.rmtree(installed.parent / "cache", ignore_errors=True)
    environment.pop("SYMRENDER_COMPILER", None)
    done = subprocess.run(
        [sys.executable, "-P", "-c", before + PROGRAM], capture_output=True, text=True, cwd=empty, env=environment
    )
    assert done.returncode == 0, done.stderr
    told, digest = done.stdout.splitlines()
    place, _, rest = told.partition(" ")
    assert Path(place).is_relative_to(installed), place
    return rest, digest


def test_nothing_is_compiled_and_the_bits_are_those_of_a_compilation(
    placed: Path, whole: tuple[str, str], installed: Path
) -> None:
    rest, digest = whole
    assert rest == "[] False False"
    assert not list((placed.parent / "cache").glob("*.kernel"))
    shutil.rmtree(installed / "symrender" / "_kernels")
    rest, compiled = run(installed)
    assert rest.startswith(KERNELS), "else the lines above prove nothing"
    assert compiled == digest


def test_a_lower_level_has_the_same_bits(placed: Path, whole: tuple[str, str]) -> None:
    assert len(levels_here()) > 1 and levels_here()[-1] == "x86-64-v2"
    assert run(placed, "from symrender.jit import shelf\nshelf.levels_here = lambda: ('x86-64-v2',)\n") == whole


def test_an_unknown_processor_compiles(placed: Path, whole: tuple[str, str]) -> None:
    few = "import llvmlite.binding as llvm\nfew = {'sse2': True}\nfull = llvm.get_host_cpu_features\n"
    few += "from symrender.jit import levels\nllvm.get_host_cpu_features = lambda: few\n"
    few += "assert levels.levels_here() == ()\nllvm.get_host_cpu_features = full\n"
    rest, digest = run(placed, few)
    assert rest.startswith(KERNELS) and digest == whole[1]


CHANGED = {"numeric/tile.py": "['render_tile'] False", "jit/places.py": KERNELS, "limits.py": "[] True"}


@pytest.mark.parametrize("changed", CHANGED)
def test_a_changed_text_is_compiled_again(whole: tuple[str, str], installed: Path, changed: str) -> None:
    """The text of a kernel, of the translator, and of what the emitted text is made from."""
    assert whole[0].startswith("[]")
    path = installed / "symrender" / changed
    path.write_text(path.read_text() + "\n# changed\n")
    rest, digest = run(installed)
    assert rest.startswith(CHANGED[changed]) and digest == whole[1]


def test_damaged_machine_code_is_compiled_again(whole: tuple[str, str], installed: Path) -> None:
    damaged = sorted((installed / "symrender" / "_kernels").glob("*.kernel"))
    assert len(damaged) == 4, "two kernels, two levels"
    for path in damaged:
        content = bytearray(path.read_bytes())
        content[len(content) // 2] ^= 16
        path.write_bytes(content)
    rest, digest = run(installed)
    assert rest.startswith(KERNELS) and digest == whole[1]


def test_files_of_the_package_may_belong_to_anyone(whole: tuple[str, str], installed: Path) -> None:
    """They are executed with the trust of the texts beside them; a shared installation is another user's."""
    for path in (installed / "symrender" / "_kernels").iterdir():
        path.chmod(0o666)
    assert run(installed) == whole


def test_the_record_names_every_file(wheel: Path) -> None:
    assert wheel.name == "symrender-0.0.0-py3-none-manylinux_2_17_x86_64.whl"
    with zipfile.ZipFile(wheel) as archive:
        (record,) = (name for name in archive.namelist() if name.endswith("RECORD"))
        rows = list(csv.reader(archive.read(record).decode().splitlines()))
        assert sorted(row[0] for row in rows) == sorted(archive.namelist())
        assert sum(name.endswith(".kernel") for name in archive.namelist()) == 4
        for name, digest, size in rows:
            content = archive.read(name)
            assert name == record or (digest, int(size)) == (f"sha256={make_wheels._urlsafe(content)}", len(content))
        about = archive.read("symrender-0.0.0.dist-info/WHEEL").decode()
    assert f"Tag: {make_wheels.TAG}" in about and "Root-Is-Purelib: false" in about


def test_levels_are_those_of_the_psabi() -> None:
    assert list(LEVELS) == sorted(LEVELS, reverse=True)
    assert all(better > worse for better, worse in zip(LEVELS.values(), list(LEVELS.values())[1:], strict=False))
