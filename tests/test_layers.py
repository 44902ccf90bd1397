"""Layers are a fact, not a drawing: every import of the package is parsed and held to the order below."""

from __future__ import annotations

import ast
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

PACKAGE = Path(__file__).resolve().parent.parent / "src" / "symrender"

LAYERS: tuple[tuple[str, ...], ...] = (
    ("errors", "limits", "settings", "version"),
    ("jit", "images"),
    ("scene",),
    ("numeric", "expression", "leaves"),
    ("chambers",),
    ("radiometric",),
    ("quadrature",),
    ("radiosity",),
    ("kernel",),
    ("targets",),
    ("runtimes",),
    ("radiance",),
    ("ledger", "certify"),
    ("execution",),
    ("render", "truth", "verify", "probe", "probe_rays", "gradient", "hessian", "fit"),
    ("studies", "simulator", "sequences", "bridge", "widget", "audit"),
    ("report", "suite"),
    ("chapter",),
    ("cli", "__init__"),
    ("__main__",),
)
LAYER_OF = {part: number for number, parts in enumerate(LAYERS) for part in parts}
SLOW = ("numba", "llvmlite", "sympy", "mpmath", "OpenEXR", "scipy")


def modules() -> dict[str, Path]:
    """Dotted name, without the package's own, of every file; the package itself is ``__init__``."""
    found = {}
    for path in sorted(PACKAGE.rglob("*.py")):
        if path.parent == PACKAGE / "chapter" / "cells":
            continue  # what a reader of the laboratory runs: data of the package, none of its modules
        parts = path.relative_to(PACKAGE).with_suffix("").parts
        if len(parts) > 1 and parts[-1] == "__init__":
            parts = parts[:-1]
        found[".".join(parts)] = path
    return found


def imported(tree: ast.AST, known: set[str], module: str) -> Iterator[tuple[str, int]]:
    """(module of the package, line) of every import anywhere in a file: top, function, TYPE_CHECKING, by name."""
    for node in ast.walk(tree):
        match node:
            case ast.Import(names=names):
                targets = [alias.name for alias in names]
            case ast.ImportFrom(module=source, names=names, level=level):
                assert level == 0, f"{module}:{node.lineno}: a relative import hides its layer"
                targets = [f"{source}.{alias.name}" for alias in names]
            case ast.Call(func=ast.Name(id="import_module") | ast.Attribute(attr="import_module"),
                          args=[ast.Constant(value=str(name)), *_]):  # fmt: skip
                targets = [name]
            case _:
                continue
        for target in targets:
            if target.split(".")[0] != "symrender":
                continue
            name = target.removeprefix("symrender").removeprefix(".")
            while name and name not in known:
                name = name.rpartition(".")[0]
            yield name or "__init__", node.lineno


def part(module: str) -> str:
    return module.split(".")[0]


def violation(importer: str, imported_module: str) -> str | None:
    """Why this import is not allowed, or None."""
    a, b = part(importer), part(imported_module)
    if b == "__init__":
        return "only the command line may import the root package" if a not in ("cli", "__init__") else None
    if a == "numeric" and b in ("expression", "leaves"):
        return "the two pipelines share no formula"
    same_folder = a == b or {f"{a}.py", f"{b}.py"} <= {p.name for p in PACKAGE.glob("*.py")}
    if LAYER_OF[b] < LAYER_OF[a] or (same_folder and LAYER_OF[a] == LAYER_OF[b]):
        return None
    return f"layer {LAYER_OF[a]} must not import layer {LAYER_OF[b]}"


def edges(files: dict[str, Path]) -> list[tuple[str, str, int]]:
    return [
        (module, target, line)
        for module, path in files.items()
        for target, line in imported(ast.parse(path.read_text("utf-8"), str(path)), set(files), module)
    ]


def test_every_file_has_a_layer() -> None:
    files = modules()
    assert len(files) > 80
    assert not {part(module) for module in files} - set(LAYER_OF)


def test_imports_go_down() -> None:
    found = edges(modules())
    assert len(found) > 200, "the parser must see the package's imports"
    assert {part(b) for _, b, _ in found} >= {"scene", "expression", "kernel", "runtimes", "ledger"}
    wrong = [f"{a}:{line} imports {b}: {why}" for a, b, line in found if (why := violation(a, b))]
    assert not wrong, "\n".join(wrong)


@pytest.mark.parametrize(
    ("importer", "code"),
    [
        ("scene.load", "from symrender.render import render"),
        ("numeric.rays", "from symrender.expression.vectors import dot"),
        ("numeric.rays", "def f():\n    import symrender.expression.vectors"),
        ("numeric.shading", "from symrender.leaves.values import blinn_term"),
        ("quadrature.strata", "if TYPE_CHECKING:\n    from symrender.kernel import tile"),
        ("images.image", "from symrender.scene.scene import Scene"),
        ("ledger.compare", "from symrender import render"),
        ("ledger.compare", "import symrender"),
        ("expression.lobe", "import importlib\nimportlib.import_module('symrender.targets.numba')"),
    ],
)  # fmt: skip
def test_a_planted_upward_import_is_seen(importer: str, code: str) -> None:
    files = modules()
    found = list(imported(ast.parse(code), set(files), importer))
    assert [violation(importer, target) for target, _ in found if violation(importer, target)]


def circle(graph: dict[str, set[str]]) -> list[str]:
    """Modules that lead back to the first of them, import by import; empty where there are none."""
    done: set[str] = set()

    def visit(name: str, path: list[str]) -> list[str]:
        if name in path:
            return [*path[path.index(name) :], name]
        for other in sorted(graph[name] - done):
            if found := visit(other, [*path, name]):
                return found
        done.add(name)
        return []

    return next((found for name in graph if (found := visit(name, []))), [])


def graph_of(found: list[tuple[str, str, int]], files: dict[str, Path]) -> dict[str, set[str]]:
    graph: dict[str, set[str]] = {name: set() for name in files}
    for a, b, _ in found:
        if a != b:
            graph[a].add(b)
    return graph


def test_no_import_leads_back() -> None:
    """Lazy imports and those for types count too: two files that need each other are one file, or three."""
    files = modules()
    found = edges(files)
    assert circle(graph_of(found, files)) == []
    lower, higher = "scene.names", "scene.parameters"
    assert any((a, b) == (higher, lower) for a, b, _ in found)
    assert set(circle(graph_of([*found, (lower, higher, 1)], files))) == {lower, higher}, "a planted circle is seen"


def test_only_the_root_re_exports() -> None:
    packages = [path for path in PACKAGE.rglob("__init__.py") if path.parent != PACKAGE]
    assert len(packages) >= 9
    for path in packages:
        tree = ast.parse(path.read_text("utf-8"))
        defined = {node.name for node in tree.body if isinstance(node, ast.FunctionDef)}
        exports = [
            alias.name
            for node in tree.body
            if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("symrender.")
            for alias in node.names
        ]
        used = {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)}
        assert not set(exports) - used, f"{path}: re-exports {set(exports) - used}, beside {defined}"


@pytest.mark.parametrize(
    "program",
    [
        "from symrender.cli import main; main(['--help'])",
        "from symrender.cli import main; main(['scenes'])",
        "from symrender.cli import main; main(['compare', '--help'])",
        "import symrender; symrender.compare; symrender.load('gloss')",
        "import symrender.images.image",
    ],
)
def test_what_answers_at_once_loads_nothing_slow(program: str) -> None:
    code = f"import sys\n{program}\nprint('LOADED', *sorted(m for m in {SLOW!r} if m in sys.modules))"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert run.returncode == 0, run.stderr
    assert run.stdout.splitlines()[-1].split() == ["LOADED"]


@pytest.mark.parametrize(
    "call",
    [
        "truth('gloss', size=1, tol=1e-2)",
        "render('gloss', size=1)",
        "gradient('gloss', ['spheres.B.center.x'], size=1, tol=1e-1)",
        "probe('gloss', [(1.2, -0.4, 0.0)], tol=1e-2)",
    ],
)
def test_a_scene_in_series_loads_nothing_that_only_others_need(call: str) -> None:
    """What checks and makes images of radiometric scenes, verifies and encloses is a third of all there is."""
    others = (
        *("radiosity.table", "runtimes.radiometric", "runtimes.exposed", "runtimes.series_pixels"),
        *("verify", "certify", "execution.tables"),
    )
    code = f"import sys, symrender as sr\nsr.{call}\n"
    code += f"print('LOADED', *(m for m in {others!r} if 'symrender.' + m in sys.modules))"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=300)
    assert run.returncode == 0, run.stderr
    assert run.stdout.splitlines()[-1].split() == ["LOADED"]
