"""`ci/results_table.py`: the numbers of README's table, the rule on invalid ratios, and that a changed README or run is noticed."""

import csv
import json
import math
from pathlib import Path

import pytest
import results_table
from results_table import OURS, README, RESULTS, Row, main

ROOT = Path(__file__).resolve().parents[2]
#: The columns that count.
FIELDS = (
    "study",
    "robot",
    "engine",
    "engine_version",
    "method",
    "precision",
    "quantity",
    "cache",
    "metric",
    "value",
    "reference",
    "verdict",
)


def row(engine: str, method: str, quantity: str, value: float, **other: str) -> Row:
    """A row of a run: by default an error of forward dynamics."""
    plain = {"study": "accuracy", "robot": "panda", "engine_version": "1", "precision": "f64", "cache": "", "metric": "error_median"}
    judged = {"reference": "", "verdict": "info", "valid": "true", "estimated": "false"}
    return {**plain, **judged, "engine": engine, "method": method, "quantity": quantity, "value": str(value), **other}


def time(engine: str, method: str, quantity: str, value: float, robot: str, **other: str) -> Row:
    """A ratio of times."""
    timed = {"study": "timing", "cache": "stream", "metric": "ratio", "reference": f"{OURS} aba", "robot": robot}
    return row(engine, method, quantity, value, **{**timed, **other})


ANSWERS = [
    row(OURS, "aba", "fd", 1e-15),
    row(OURS, "aba", "fd", 3e-15, robot="hand"),
    # Not usual: the second method, a batch, a method with fewer robots that comes first.
    row(OURS, "ltdl", "fd", 1e-9),
    row(OURS, "ltdl", "fd", 1e-9, robot="hand"),
    row("mujoco", "rare", "fd", 7.0),
    row("mujoco", "forward", "fd", 2e-12),
    row("mujoco", "forward", "fd", 5e-13, robot="hand"),
    row("mujoco", "batch", "fd", 8.0),
    row("mujoco", "forward", "fd", 9.0, robot="ur5", valid="false"),
    row("mujoco", "inverse", "id", 4e-14, study="agreement", verdict="deviation"),
    row("mujoco", "inverse", "id", 4.0, study="agreement", verdict="fail"),
    row("mujoco", "inverse", "id", 0.0, study="agreement", verdict="error"),
]
SPEED = [
    # Of each robot the fastest method and build: 2, 5, 3; the median is 3.
    time("mujoco-native", "forward", "fd", 4.0, "panda"),
    time("mujoco-native", "other", "fd", 2.0, "panda"),
    time("mujoco-native", "forward", "fd", 5.0, "hand"),
    time("mujoco-native", "forward", "fd", 3.0, "ur5"),
    # Never used.
    time("mujoco-native", "forward", "fd", 0.1, "ur5", valid="false"),
    time("mujoco-native", "forward", "fd", 0.1, "ur5", cache="hot"),
    time("mujoco-native", "batch", "fd", 0.1, "ur5"),
    time("mujoco-native", "inverse", "id", 0.1, "ur5", valid="false"),
    # Ours.
    time(OURS, "ltdl", "fd", 0.9, "panda"),
    time(OURS, "aba", "fd", 1500.0, "panda", metric="ns_per_call", reference=""),
    time(OURS, "ltdl", "fd", 7500.0, "panda", metric="ns_per_call", reference=""),
    time(OURS, "batch", "id", 0.2, "panda", reference=f"{OURS} rnea"),
    time(OURS, "rnea", "id", 250.0, "panda", metric="ns_per_call", reference=""),
    time(OURS, "rnea", "id", 250.0, "humanoid", metric="ns_per_call", reference="", valid="false"),
]


def run_of(folder: Path, rows: list[Row]) -> Path:
    """A finished run with these rows."""
    folder.mkdir(parents=True)
    (folder / "run.json").write_text(json.dumps({"started": "2026-01-02T03:04:05Z", "host": {"cpu": "a machine"}}))
    with (folder / "rows.csv").open("w", newline="") as file:
        writer = csv.DictWriter(file, [*FIELDS, "valid", "estimated"])
        writer.writeheader()
        writer.writerows(rows)
    return folder


@pytest.fixture
def root(tmp_path: Path) -> Path:
    """A project that publishes ANSWERS and SPEED."""
    (tmp_path / README).write_text(f"before\n{results_table.BEGIN}old\n{results_table.END}after\n")
    answers, speed = run_of(tmp_path / "answers", ANSWERS), run_of(tmp_path / "speed", SPEED)
    assert main([str(answers), str(speed)], tmp_path) == 0
    return tmp_path


def test_the_numbers_are_those_of_the_rows(root: Path) -> None:
    """Errors are of the worst robot by the usual method; times are medians of valid ratios; the rest of README stays."""
    readme = (root / README).read_text()
    assert readme.startswith("before\n")
    assert readme.endswith("after\n")
    assert "old" not in readme
    assert f"| {OURS} 1 | 2 | – | 3.0e-15 | – | 0 | 0 | 1 | 1 |\n" in readme
    assert "| mujoco 1 | 2 | – | 2.0e-12 | – | 1 | 2 | – | 3 |\n" in readme
    assert readme.index(f"| {OURS}") < readme.index("| mujoco"), "the smallest error comes first"
    assert "(a machine, 2026-01-02): `panda` 0.25 µs and 1.5 µs." in " ".join(readme.split("\n"))


def test_an_invalid_ratio_is_never_used(root: Path) -> None:
    """Without a valid one there is no number."""
    speed = run_of(root / "noisy", [{**line, "valid": "false"} for line in SPEED])
    assert main([str(root / "answers"), str(speed)], root) == 0
    readme = (root / README).read_text()
    assert "| 1 | 2 | – | – |\n" in readme
    assert "µs" not in readme


def test_an_estimate_is_marked(root: Path) -> None:
    """One estimate among the robots makes the median an estimate."""
    speed = run_of(root / "through", [*SPEED, time("mujoco-native", "forward", "fd", 6.0, "g1", estimated="true")])
    assert main([str(root / "answers"), str(speed)], root) == 0
    assert "| – | ≈ 4 |\n" in (root / README).read_text()


def test_times_stay_without_a_run_of_times(root: Path) -> None:
    """They come from another run than the errors."""
    before = (root / README).read_text()
    assert main([str(root / "answers")], root) == 0
    assert (root / README).read_text() == before


def test_a_changed_readme_is_noticed(root: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A number that someone wrote by hand is not that of the run."""
    assert main([], root) == 0
    assert main(["--check", str(root / "answers")], root) == 0
    readme = root / README
    readme.write_text(readme.read_text().replace("3.0e-15", "1.0e-15"))
    assert main([], root) == 1
    assert main(["--check", str(root / "answers")], root) == 1
    assert "the table in README.md is not that of" in capsys.readouterr().err
    readme.write_text("no place for a table\n")
    with pytest.raises(SystemExit, match="no single place"):
        main([], root)


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"value": "5e-12"}, None),
        ({"value": "9e-12"}, "mujoco: error of fd: 9e-12, and was 2e-12"),
        ({"value": "nan"}, "mujoco: error of fd: nan"),
        ({"engine_version": "2"}, None),
        ({"verdict": "error"}, "mujoco: failed: 3, and was 2"),
        ({"engine": "drake"}, "the engines are"),
    ],
)
def test_a_run_with_other_numbers_is_noticed(
    root: Path, capsys: pytest.CaptureFixture[str], change: dict[str, str], told: str | None
) -> None:
    """Errors within the noise of `ci/figures.py` are the same."""
    rows = [{**line, **change} if line["method"] == "forward" and line["robot"] == "panda" else line for line in ANSWERS]
    assert main(["--check", str(run_of(root / "again", rows))], root) == (0 if told is None else 1)
    assert (told or "") in capsys.readouterr().err


def test_no_largest_error_loses_a_nan() -> None:
    """Wherever it comes."""
    nan = float("nan")
    for values in ([nan, 1.0, 2.0], [1.0, nan, 2.0], [1.0, 2.0, nan]):
        assert math.isnan(results_table.worst(values))
    assert results_table.worst([1.0, 3.0, 2.0]) == 3.0


def test_known_deviations_may_differ_by_rounding_alone(root: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """One more is noise of the processor. Twenty are not."""
    more = row("mujoco", "inverse", "id", 4e-14, study="agreement", verdict="deviation")
    assert main(["--check", str(run_of(root / "one", [*ANSWERS, more]))], root) == 0
    assert main(["--check", str(run_of(root / "twenty", ANSWERS + 20 * [more]))], root) == 1
    assert "mujoco: known deviations: 21, and were 1" in capsys.readouterr().err


def test_the_table_of_this_project_is_that_of_its_results() -> None:
    """README was written from `reports/published/results.json`."""
    assert (ROOT / RESULTS).is_file()
    assert main([]) == 0
