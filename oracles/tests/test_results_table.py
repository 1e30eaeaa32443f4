"""`ci/results_table.py`: README has the numbers of the ranking, and a changed README or run is noticed."""

import copy
import json
from pathlib import Path

import pytest
import results_table
from results_table import OURS, README, RESULTS, Engine, Errors, Ranking, Times, main

ROOT = Path(__file__).resolve().parents[2]
UNIT = 2.0**-52


def errors(median: float, worst: float, robot: str) -> Errors:
    """Errors over twelve robots, in units of rounding."""
    return Errors(method="aba", robots=12, states=240, median=median * UNIT, worst=worst * UNIT, worst_robot=robot, of_bound=None)


def times(median: float, *, estimated: bool = False) -> Times:
    """Times that two machines recorded."""
    return Times(robots=9, median=median, least=median / 2, most=2 * median, estimated=estimated, machines=2)


RANKING = Ranking(
    suite="default",
    started="2026-01-02T03:04:05Z",
    machine="a machine",
    engines=[
        Engine(
            name=OURS,
            version="1",
            asked=100,
            right=100,
            known=0,
            errors={"fd": errors(2, 8, "hand")},
            times={"fd": times(1.0)},
            gravest="",
        ),
        Engine(
            name="mujoco",
            version="4",
            asked=10_000,
            right=9_950,
            known=48,
            errors={"fd": errors(900, 3.7e6, "chain-100"), "id": errors(2.5, 9, "hand")},
            times={"fd": times(2.4), "id": times(3.0, estimated=True)},
            gravest="method loses digits: inverse dynamics",
        ),
    ],
)


def file_of(folder: Path, ranking: Ranking) -> Path:
    """A file with this ranking."""
    file = folder / "ranking.json"
    file.write_text(json.dumps(ranking))
    return file


@pytest.fixture
def root(tmp_path: Path) -> Path:
    """A project that publishes RANKING."""
    (tmp_path / README).write_text(f"before\n{results_table.BEGIN}old\n{results_table.END}after\n")
    assert main([str(file_of(tmp_path, RANKING))], tmp_path) == 0
    return tmp_path


def test_the_numbers_are_those_of_the_ranking(root: Path) -> None:
    """Errors are in units of rounding, an estimate has its mark, and the rest of README stays."""
    readme = (root / README).read_text()
    assert readme.startswith("before\n")
    assert readme.endswith("after\n")
    assert "old" not in readme
    assert f"| {OURS} 1 | 100 % of 100 | 2 | 8, hand | – | – | 1 | 1 | 1 | 1 | – |\n" in readme
    loses = "method loses digits: inverse dynamics"
    times_of = "2.4 (1.2 to 4.8) | ≈ 3 (1.5 to 6) | – | –"
    row = f"| mujoco 4 | 99.5 % of 10000 | 900 | 3.7e6, chain-100 | 2.5 | – | {times_of} | {loses} |\n"
    assert row in readme
    assert "over up to 12 robots at 240 states" in " ".join(readme.split("\n"))
    assert "9 robots, with the least and the most, recorded on 2 machines" in " ".join(readme.split("\n"))


def test_a_share_is_never_rounded_to_all() -> None:
    """One wrong answer among a million is seen."""
    engine = copy.deepcopy(RANKING["engines"][1])
    engine["asked"], engine["right"] = 1_000_000, 999_999
    assert results_table.right_cell(engine) == "> 99.9 % of 1000000"
    engine["asked"], engine["right"] = 0, 0
    assert results_table.right_cell(engine) == results_table.NONE


def test_numbers_have_two_digits() -> None:
    """As the report writes them."""
    values = [0.0, 1.0, 0.25, 12.34, 1234.4, 3.7e6, 2e10, 3.21e-14, 99.9]
    assert [results_table.short(value) for value in values] == ["0", "1", "0.25", "12", "1234", "3.7e6", "2e10", "3.2e-14", "100"]


def test_a_changed_readme_is_noticed(root: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A number that someone wrote by hand is not that of the run."""
    file = str(root / "ranking.json")
    assert main([], root) == 0
    assert main(["--check", file], root) == 0
    readme = root / README
    readme.write_text(readme.read_text().replace("3.7e6", "3.6e6"))
    assert main([], root) == 1
    assert main(["--check", file], root) == 1
    assert "the table in README.md is not that of" in capsys.readouterr().err
    readme.write_text("no place for a table\n")
    with pytest.raises(SystemExit, match="no single place"):
        main([], root)


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"median": 3000 * UNIT}, None),
        ({"median": 5000 * UNIT}, "mujoco: median error of fd"),
        ({"worst": 2e7 * UNIT}, "mujoco: worst error of fd"),
        ({"worst": float("nan")}, "mujoco: worst error of fd: nan"),
        ({"robots": 11}, "mujoco: robots of fd: 11, and were 12"),
    ],
)
def test_other_errors_are_noticed(root: Path, capsys: pytest.CaptureFixture[str], change: dict[str, float], told: str | None) -> None:
    """Within the noise of `ci/figures.py` they are the same."""
    ranking = copy.deepcopy(RANKING)
    of_fd = ranking["engines"][1]["errors"]
    of_fd["fd"] = Errors(**{**of_fd["fd"], **change})  # type: ignore[typeddict-item]
    assert main(["--check", str(file_of(root, ranking))], root) == (0 if told is None else 1)
    assert (told or "") in capsys.readouterr().err


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"known": 49, "right": 9_949}, None),
        ({"known": 480, "right": 9_518}, "mujoco: known deviations: 480, and were 48"),
        ({"right": 9_949}, "mujoco: failed: 3, and was 2"),
        ({"version": "5"}, "mujoco: version: 5, and was 4"),
        ({"name": "drake"}, "the engines are"),
        ({"errors": {}}, "mujoco: errors of fd: none now"),
    ],
)
def test_other_counts_are_noticed(root: Path, capsys: pytest.CaptureFixture[str], change: dict[str, object], told: str | None) -> None:
    """One known deviation more is noise of the processor. Four hundred are not."""
    ranking = copy.deepcopy(RANKING)
    ranking["engines"][1].update(change)  # type: ignore[typeddict-item]
    assert main(["--check", str(file_of(root, ranking))], root) == (0 if told is None else 1)
    assert (told or "") in capsys.readouterr().err


def test_times_depend_on_the_machine(root: Path) -> None:
    """They are not compared."""
    ranking = copy.deepcopy(RANKING)
    ranking["engines"][1]["times"] = {}
    assert main(["--check", str(file_of(root, ranking))], root) == 0


def test_the_table_of_this_project_is_that_of_its_results() -> None:
    """README was written from `reports/published/results.json`."""
    assert (ROOT / RESULTS).is_file()
    assert main([]) == 0
