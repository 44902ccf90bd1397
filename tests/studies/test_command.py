from __future__ import annotations

import csv
import json
from pathlib import Path

import pytest

from symrender.cli import main

SMALL = ["--size", "8", "--lobes", "2,4,8", "--repeats", "1", "--estimators", "strata-weight,sobol", "--quiet"]


def run(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str, str]:
    code = main(["study", *arguments])
    captured = capsys.readouterr()
    return code, captured.out, captured.err


def test_convergence_writes_tables_and_pictures(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("matplotlib")
    code, out, err = run(capsys, "convergence", *SMALL, "--tolerances", "0.1", "--out", str(tmp_path))
    assert (code, out, err) == (0, "", "")
    names = {p.name for p in tmp_path.iterdir()}
    stem = "convergence"
    assert names == {f"{stem}.csv", f"{stem}-2.csv", f"{stem}.json", f"{stem}.svg", f"{stem}.png"}
    rows = list(csv.DictReader((tmp_path / "convergence.csv").read_text("utf-8").splitlines()))
    assert [row["estimator"] for row in rows] == ["strata-weight"] * 3 + ["sobol"] * 3 + ["black image"]
    plain = json.loads((tmp_path / "convergence.json").read_text("utf-8"))
    assert [str(row[0]) for row in plain["tables"][0]["rows"]] == [row["estimator"] for row in rows]
    code, _, err = run(capsys, "convergence", *SMALL, "--out", str(tmp_path))
    assert code == 74 and "--force" in err and err.count("\n") == 1


def test_no_plot_needs_no_matplotlib(tmp_path: Path, capsys: pytest.CaptureFixture[str],
                                     monkeypatch: pytest.MonkeyPatch) -> None:  # fmt: skip
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    code, _, err = run(capsys, "convergence", *SMALL, "--out", str(tmp_path / "a"))
    assert code == 2 and "--no-plot" in err and err.count("\n") == 1 and not (tmp_path / "a").exists()
    code, _, err = run(capsys, "convergence", *SMALL, "--tolerances", "0.1", "--no-plot", "--out", str(tmp_path / "b"))
    assert (code, err) == (0, "")
    assert {p.suffix for p in (tmp_path / "b").iterdir()} == {".csv", ".json"}


def test_json_and_text(capsys: pytest.CaptureFixture[str]) -> None:
    small = ["gloss", "--size", "8", "--lobes", "2", "--repeats", "1"]
    code, out, _ = run(capsys, "timing", *small, "--json")
    assert code == 0 and json.loads(out)["study"] == "timing"
    code, out, _ = run(capsys, "timing", *small, "-D", "floor.lobe.weight=.5")
    assert code == 0 and out.startswith("study timing") and "ns each" in out


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["anchor", "--lobes", "2"], "lobes: study anchor does not take it"),
        (["timing", "--lobes", "two"], "lobes: must be numbers separated by commas, got 'two'"),
        (["budget", "--lobes", "2,4", "--size", "8"], "lobes: study budget takes one K"),
        (["convergence", "--estimators", "magic"], "estimators: must be names out of"),
        (["convergence", "--size", "big"], "size: must be"),
        (["convergence", "nowhere.yaml"], "nowhere.yaml"),
        (["nonsense"], "nonsense"),
    ],
)  # fmt: skip
def test_errors_are_one_line(arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]) -> None:
    code, out, err = run(capsys, *arguments)
    assert code == 2 and not out
    assert err.startswith("ERROR ") and message in err and err.count("\n") == 1
