"""Runs of the program as frames and objects, and `python -m featherbench`."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import featherbench
from featherbench import _program
from featherbench._native import checksum

ARM = Path(__file__).parents[2] / "guide" / "arm.urdf"


@pytest.fixture(scope="module")
def program() -> Path:
    try:
        return _program.find()
    except FileNotFoundError as missing:
        pytest.skip(str(missing))


@pytest.fixture(scope="module")
def run(program: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("run") / "smoke"
    done = subprocess.run([program, "run", "--suite", "smoke", "--no-timing", "--out", folder], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return folder


@pytest.mark.parametrize("frame", ["polars", "pandas"])
def test_rows_have_their_types_and_verdicts(run: Path, frame: str) -> None:
    package = pytest.importorskip(frame, reason=f"{frame} is not installed")
    rows = featherbench.read_run(run, frame)
    assert isinstance(rows, package.DataFrame)
    info = json.loads((run / "run.json").read_text())
    assert len(rows) == info["rows"] > 0
    described = json.loads((run / "schema.json").read_text())["columns"]
    assert list(rows.columns) == [column["name"] for column in described]
    due = {"polars": {"integer": "Int64", "float": "Float64", "flag": "Boolean", "text": "String"}}.get(
        frame, {"integer": "Int64", "float": "float64", "flag": "boolean", "text": "string"}
    )
    for column in described:
        kind = str(rows[column["name"]].dtype)
        assert kind.lower().startswith(("enum", "categor")) if column["type"] == "word" else kind == due[column["type"]], column["name"]
    # The smoke suite passes: a pass has a value, a bound and a margin that is not negative.
    passed = rows.filter(rows["verdict"] == "pass") if frame == "polars" else rows[rows["verdict"] == "pass"]
    assert len(passed) > 0
    assert passed["margin"].min() >= 0
    assert set(rows["run"]) == {info["run"]}


def test_both_frames_have_the_same_numbers(run: Path) -> None:
    pytest.importorskip("polars", reason="polars is not installed")
    pytest.importorskip("pandas", reason="pandas is not installed")
    ours, theirs = featherbench.read_run(run, "polars"), featherbench.read_run(run, "pandas")
    assert ours["cell"].to_list() == theirs["cell"].tolist()
    assert ours["value"].drop_nulls().to_list() == theirs["value"].dropna().tolist()


def test_a_damaged_run_is_refused(run: Path, tmp_path: Path) -> None:
    copy = shutil.copytree(run, tmp_path / "copy")
    with (copy / "rows.csv").open("a") as rows:
        rows.write("one row more\n")
    with pytest.raises(featherbench.RunError, match=r"rows\.csv is not what checksums\.txt says"):
        featherbench.read_run(copy)
    (copy / "rows.csv").unlink()
    with pytest.raises(featherbench.RunError, match="is no whole run"):
        featherbench.read_run(copy)
    with pytest.raises(featherbench.RunError, match="frame is 'arrow'; give 'polars' or 'pandas'"):
        featherbench.read_run(run, "arrow")


def test_another_format_is_refused(tmp_path: Path) -> None:
    (tmp_path / "rows.csv").write_text("a\n")
    (tmp_path / "schema.json").write_text('{"format": 1, "columns": []}')
    lines = [f"{checksum((tmp_path / name).read_bytes())}  {name}\n" for name in ("rows.csv", "schema.json")]
    (tmp_path / "checksums.txt").write_text("".join(lines))
    with pytest.raises(featherbench.RunError, match="has format 1; this package reads 2"):
        featherbench.read_run(tmp_path)


def test_a_comparison_is_an_object(program: Path, tmp_path: Path) -> None:
    pytest.importorskip("pinocchio", reason="pinocchio is not installed")
    found = featherbench.compare(ARM, engines=["pinocchio"], out=tmp_path / "compare")
    assert found.folder == tmp_path / "compare"
    assert {question.engine for question in found.questions} == {"pinocchio"}
    # Pinocchio reads a plain arm as it is written.
    assert found.alike
    assert found.differences == ()
    with pytest.raises(featherbench.RunError, match=r"no_such\.urdf"):
        featherbench.compare(tmp_path / "no_such.urdf", engines=["pinocchio"], out=tmp_path / "bad")


def test_python_m_featherbench_is_the_program(program: Path) -> None:
    def called(*arguments: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run([sys.executable, "-m", "featherbench", *arguments], capture_output=True, text=True, check=False)

    assert called("--version").stdout == subprocess.run([program, "--version"], capture_output=True, text=True, check=True).stdout
    assert called("run", "--suite", "no such suite").returncode == 2


def test_a_program_that_is_not_there_is_told(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv(_program.VARIABLE, raising=False)
    with pytest.raises(FileNotFoundError, match="cargo build --release"):
        _program.find()
    monkeypatch.setenv(_program.VARIABLE, str(tmp_path / "nothing"))
    with pytest.raises(FileNotFoundError, match="FEATHERBENCH_PROGRAM names .*nothing, which is no file"):
        _program.find()
    done = subprocess.run([sys.executable, "-m", "featherbench"], capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert done.stderr.startswith("error: FEATHERBENCH_PROGRAM names ")
