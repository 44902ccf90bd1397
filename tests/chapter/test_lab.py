"""The laboratory: sources that keep to public names, notebooks that do not change, cells that find what they expect."""

from __future__ import annotations

import ast
import re
import sys
import types
from pathlib import Path

import pytest

import symrender
from symrender.chapter import lab
from symrender.chapter.run_cell import execute
from symrender.chapter.write_lab import text
from symrender.cli import main
from symrender.errors import CellError, OptionError

NAMES = tuple(f"cell{k}" for k in range(1, 14))
LIBRARIES = {"symrender", "numpy", "sympy", "matplotlib.pyplot", "time"}
RENDERERS = {"cell1": "render_numeric_gloss", "cell3": "render_symbolic_gloss"}
MOST_LINES = 150
FAILING = """\
# %% [markdown]
# # A cell
#
# That fails.

# %%
value = 2

# %%

# a comment before the line that fails
assert value == 3, f"value is three, got {value}"
"""


def trees(cell: lab.Cell) -> list[ast.Module]:
    return [ast.parse(part.text) for part in cell.parts if part.kind == "code"]


def test_the_cells_are_thirteen_in_order() -> None:
    assert lab.names() == NAMES
    titles = [lab.load(name).title for name in NAMES]
    assert len(set(titles)) == 13 and all(5 < len(title) < 80 for title in titles)
    with pytest.raises(OptionError, match=r"cell: must be one of cell1, .*, cell13, got 'cell14'"):
        lab.load("cell14")


@pytest.mark.parametrize("name", NAMES)
def test_a_cell_keeps_to_the_public_names(name: str) -> None:
    nodes = [node for tree in trees(lab.load(name)) for node in ast.walk(tree)]
    imported = {alias.name for node in nodes if isinstance(node, ast.Import) for alias in node.names}
    assert {"symrender", "numpy"} <= imported <= LIBRARIES
    assert not [node for node in nodes if isinstance(node, ast.ImportFrom)]
    used = {
        n.attr for n in nodes if isinstance(n, ast.Attribute) and isinstance(n.value, ast.Name) and n.value.id == "sr"
    }
    assert used and used <= set(symrender.__all__)
    hidden = {n.attr for n in nodes if isinstance(n, ast.Attribute) and n.attr.startswith("_")}
    assert not hidden


@pytest.mark.parametrize("name", sorted(RENDERERS))
def test_a_renderer_is_whole_small_and_its_own(name: str) -> None:
    """It stands in one part that a student edits, and asks symrender for nothing but the numbers of a scene."""
    source = next(part.text for part in lab.load(name).parts if part.kind == "code")
    assert 90 < len(source.splitlines()) <= MOST_LINES
    tree = ast.parse(source)
    functions = {node.name for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)}
    assert {RENDERERS[name], "scene_at", "hit_sphere"} <= functions
    nodes = [node for node in ast.walk(tree) if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name)]
    assert {node.attr for node in nodes if node.value.id == "sr"} <= {"load"}  # type: ignore[attr-defined]


@pytest.mark.parametrize(
    ("name", "line", "changed", "told"),
    [
        ("cell1", "m = D * [1, 1, -1]", "m = D * [1, 1, -1.000001]", "exact parts agree"),
        ("cell1", '+ SC["krf"] * gloss, code', '* 1.0000001 + SC["krf"] * gloss, code', "exact parts agree"),
        (
            "cell3",
            "mirror = D - 2 * D.dot(N) * N",
            "mirror = D - 2.000001 * D.dot(N) * N",
            "draws what symrender draws",
        ),
        ("cell3", "(lower + upper) / 2", "(lower + upper) / 2.000001", "draws what symrender draws"),
        ("cell3", "C).dot(Q + t * D", "C).dot(Q + 2 * t * D", "the chord solves"),
    ],
)
def test_a_changed_renderer_is_found_out(name: str, line: str, changed: str, told: str) -> None:
    pytest.importorskip("matplotlib")
    source = (lab._folder() / f"{name}.py").read_text(encoding="utf-8")
    assert source.count(line) == 1
    # what follows the checks takes longest and is another test's
    source = (
        source.replace("(2, 4, 8, 16):", "(2,):")
        if name == "cell1"
        else source.replace("size, k = 20, 8", "size, k = 6, 2")
    )
    with pytest.raises(CellError, match=told):
        execute(lab.parsed(name, source.replace(line, changed)))


def test_half_of_the_laboratory_is_symbolic() -> None:
    """Cells that derive something by SymPy, and use what they derived in a check."""
    using = [name for name in NAMES if any("import sympy as sp" in part.text for part in lab.load(name).parts)]
    assert {"cell2", "cell3"} < set(using) and len(using) >= 6
    for name in using:
        code = "\n".join(part.text for part in lab.load(name).parts if part.kind == "code")
        assert re.search(r"sp\.(integrate|Integral|diff|simplify)", code), name


@pytest.mark.parametrize("name", NAMES)
def test_a_cell_introduces_itself_and_ends_in_an_expectation(name: str) -> None:
    cell = lab.load(name)
    assert len(cell.introduction) > 200
    last = cell.parts[-1]
    assert last.kind == "code" and last.text.count("assert ") >= 3
    assert 'f"Expect: ' in last.text
    asserts = [node for tree in trees(cell) for node in ast.walk(tree) if isinstance(node, ast.Assert)]
    assert all(node.msg is not None for node in asserts), "an assertion says what it expected"


@pytest.mark.parametrize("name", NAMES)
def test_no_measured_figure_is_typed(name: str) -> None:
    measured = re.compile(r"\d\.\d|\d ?%|\d(?:\.\d+)?e[-+]?\d|\d+ (?:ms|ns|seconds)\b")
    cell = lab.load(name)
    prose = [part.text for part in cell.parts if part.kind == "markdown"]
    told = [
        node.value
        for tree in trees(cell)
        for call in ast.walk(tree)
        if isinstance(call, ast.Call) and isinstance(call.func, ast.Name) and call.func.id == "print"
        for node in ast.walk(call)
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and " " in node.value
    ]
    assert prose and told
    assert not [line for text in [*prose, *told] for line in text.splitlines() if measured.search(line)]
    assert measured.search("a bias of +73 %") and measured.search("1.6e-4") and measured.search("RMS 0.01")


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_jupytext_reads_the_same_parts(name: str) -> None:
    jupytext = pytest.importorskip("jupytext")
    cell = lab.load(name)
    source = (lab._folder() / f"{name}.py").read_text(encoding="utf-8")
    read = jupytext.reads(source, fmt="py:percent").cells
    assert [(c.cell_type, c.source.rstrip()) for c in read] == [(part.kind, part.text) for part in cell.parts]
    lines = source.splitlines()
    for part in cell.parts:
        first = part.text.splitlines()[0]
        assert lines[part.line - 1] == (first if part.kind == "code" else f"# {first}")


@pytest.mark.parametrize("name", NAMES)
def test_a_notebook_is_valid_and_always_the_same(name: str) -> None:
    nbformat = pytest.importorskip("nbformat")
    cell = lab.load(name)
    first, second = text(lab.notebook(cell)), text(lab.notebook(cell))
    assert first == second
    read = nbformat.reads(first, as_version=4)
    nbformat.validate(read)
    assert len({c.id for c in read.cells}) == len(read.cells) == len(cell.parts) + 1
    assert "pip install '.[notebook]'" in read.cells[1].source and "numpy" not in read.cells[1].source
    assert read.metadata.colab == {"provenance": []}


def test_a_notebook_installs_the_wheel_that_is_uploaded(monkeypatch: pytest.MonkeyPatch) -> None:
    """In Colab the first code asks for the file; elsewhere it says what to type; installed, it does nothing."""
    code = lab.notebook(lab.load("cell1")).cells[1].source
    exec(compile(code, "installed", "exec"), {})  # noqa: S102
    monkeypatch.setitem(sys.modules, "symrender", None)
    with pytest.raises(ImportError, match="see the first lines of this cell"):
        exec(compile(code, "elsewhere", "exec"), {})  # noqa: S102
    colab, google = types.ModuleType("google.colab"), types.ModuleType("google")
    colab.files = types.SimpleNamespace(upload=lambda: {"symrender-1.2-py3-none-any.whl": b""})  # type: ignore[attr-defined]
    google.colab = colab  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "google", google)
    monkeypatch.setitem(sys.modules, "google.colab", colab)
    ran: list[list[str]] = []
    monkeypatch.setattr("subprocess.check_call", ran.append)
    exec(compile(code, "colab", "exec"), {})  # noqa: S102
    assert ran == [[sys.executable, "-m", "pip", "install", "-q", "symrender-1.2-py3-none-any.whl[notebook]"]]
    colab.files.upload = lambda: {"notes.txt": b""}
    with pytest.raises(ImportError, match=r"expected one file that ends in \.whl, got 0"):
        exec(compile(code, "colab", "exec"), {})  # noqa: S102


@pytest.mark.parametrize("name", NAMES)
def test_a_cell_finds_what_it_expects(name: str) -> None:
    pytest.importorskip("matplotlib")
    cell = lab.load(name)
    outputs = execute(cell)
    last = outputs[-1]
    assert last.kind == "text" and isinstance(last.data, str)
    assert last.data.startswith("Expect: ") and re.search(r"\d", last.data) and last.data.endswith(".\n")
    assert last.part == len(cell.parts) - 1
    pictures = [output for output in outputs if output.kind in ("png", "svg")]
    assert all(len(output.data) > 1000 and output.alt for output in pictures)
    assert sum(len(output.data) for output in outputs) < 500_000
    told = [output.data for output in outputs if output.kind == "text" and isinstance(output.data, str)]
    assert not [line for line in "".join(told).splitlines() if " object at 0x" in line or "nan" in line.split()]


def test_a_failing_cell_names_its_line() -> None:
    pytest.importorskip("matplotlib")
    cell = lab.parsed("cell99", FAILING)
    with pytest.raises(CellError, match=r"^cell99\.py:12: expected: value is three, got 2$") as failure:
        execute(cell)
    assert failure.value.exit_code == 70
    with pytest.raises(CellError, match=r"^cell99\.py:7: ZeroDivisionError: "):
        execute(lab.parsed("cell99", FAILING.replace("value = 2", "value = 2 / 0")))
    with pytest.raises(CellError, match=r"^cell99\.py:7: SyntaxError: "):
        execute(lab.parsed("cell99", FAILING.replace("value = 2", "value = ")))


def test_a_wrong_figure_fails_its_cell() -> None:
    pytest.importorskip("matplotlib")
    source = (lab._folder() / "cell2.py").read_text(encoding="utf-8")
    planted = source.replace("/ u\n", "/ (u + 1e-9)\n", 1)
    assert planted != source
    with pytest.raises(CellError, match=r"cell2\.py:\d+: expected: the normaliser agrees with quadrature"):
        execute(lab.parsed("cell2", planted))


def test_running_a_cell_leaves_no_trace() -> None:
    pyplot = pytest.importorskip("matplotlib.pyplot")
    import matplotlib

    before = Path.cwd(), matplotlib.rcParams["figure.facecolor"], pyplot.get_fignums(), pyplot.get_backend()
    source = FAILING.replace("value = 2", "import matplotlib.pyplot as plt\nopen('left', 'w').close()\nplt.figure()")
    with pytest.raises(CellError):
        execute(lab.parsed("cell99", source))
    after = Path.cwd(), matplotlib.rcParams["figure.facecolor"], pyplot.get_fignums(), pyplot.get_backend()
    assert after == before


@pytest.mark.parametrize(
    ("source", "message"),
    [
        ("x = 1\n# %%\n", r"cell99\.py:1: stands before the first"),
        ("# %%\nx = 1\n", r"cell99\.py: must begin with prose"),
        ("", r"cell99\.py: must begin with prose"),
    ],
)
def test_a_source_of_another_form_is_refused(source: str, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        lab.parsed("cell99", source)


@pytest.mark.filterwarnings("ignore")
def test_a_notebook_runs_in_jupyter() -> None:
    nbclient = pytest.importorskip("nbclient")
    pytest.importorskip("ipykernel")
    book = lab.notebook(lab.load("cell2"))
    nbclient.NotebookClient(book, timeout=240, kernel_name="python3").execute()
    streams = [
        output.text for cell in book.cells if cell.cell_type == "code" for output in cell.outputs if "text" in output
    ]
    assert streams[-1].startswith("Expect: W agrees")


def test_the_command_writes_an_index_and_refuses_to_replace(tmp_path, capsys) -> None:  # type: ignore[no-untyped-def]
    pytest.importorskip("nbformat")
    folder = tmp_path / "laboratory"
    assert main(["lab", "-o", str(folder)]) == 0
    assert capsys.readouterr().out == f"wrote 14 files into {folder}\n"
    files = {path.name: path.read_bytes() for path in folder.iterdir()}
    assert set(files) == {"README.md", *(f"{name}.ipynb" for name in NAMES)}
    assert all(f"({name}.ipynb)" in files["README.md"].decode() for name in NAMES)
    assert main(["lab", "-o", str(folder)]) == 74
    captured = capsys.readouterr()
    assert "--force" in captured.err and captured.err.count("\n") == 1
    assert main(["lab", "-o", str(folder), "--force", "--quiet"]) == 0
    assert {path.name: path.read_bytes() for path in folder.iterdir()} == files
    assert b"\x1b" not in b"".join(files.values())


def test_run_notebooks_hold_their_outputs() -> None:
    nbformat = pytest.importorskip("nbformat")
    pytest.importorskip("matplotlib")
    from symrender.chapter.write_lab import fill

    cell = lab.load("cell2")
    book = lab.notebook(cell)
    outputs = execute(cell)
    fill(book, cell, outputs)
    nbformat.validate(book)
    filled = [(c.source, [o.output_type for o in c.outputs]) for c in book.cells if c.cell_type == "code" and c.outputs]
    assert [source for source, _ in filled] == [
        cell.parts[part].text for part in dict.fromkeys(o.part for o in outputs)
    ]
    assert ["stream", "display_data"] in [kinds for _, kinds in filled]
