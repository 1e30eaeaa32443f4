"""`ci/figures.py`: figures are the same within noise, and anything else is told."""

import runpy
from collections.abc import Callable
from pathlib import Path

import pytest

Differences = Callable[[Path, Path], list[str]]
CURVE = "series,name,depth,error\nours,a,1,1e-13\nours,b,2,0\n"
SHARES = "series,name,error,share of answers\nours,a,1e-13,0.5\nours,b,2e-13,1\n"
SVG = "<svg><title>Error</title><text x='1'>ours</text><text>10</text></svg>"


@pytest.fixture
def differences() -> Differences:
    """The comparison."""
    found: Differences = runpy.run_path(str(Path(__file__).resolve().parents[2] / "ci/figures.py"))["differences"]
    return found


def folder(path: Path, **files: str) -> Path:
    """A folder with these figures instead of the usual ones."""
    path.mkdir()
    for name, text in ({"curve_csv": CURVE, "shares_csv": SHARES, "curve_svg": SVG} | files).items():
        (path / name.replace("_", ".")).write_text(text)
    return path


@pytest.mark.parametrize(
    "files",
    [
        {},
        {"curve_csv": CURVE.replace("1e-13", "3.9e-13").replace("2,0", "2,8e-16").replace("ours,a", "ours,other")},
        {"shares_csv": "series,name,error,share of answers\nours,b,1e-13,0.5\nours,a,2e-13,1\n"},
        {"curve_svg": SVG.replace("10", "100").replace("x='1'", "x='2'")},
    ],
)
def test_rounding_changes_nothing(differences: Differences, tmp_path: Path, files: dict[str, str]) -> None:
    """Numbers within noise, another worst robot, another order and other ticks are no difference."""
    assert differences(folder(tmp_path / "old"), folder(tmp_path / "new", **files)) == []


@pytest.mark.parametrize(
    ("files", "told"),
    [
        ({"curve_csv": CURVE.replace("1e-13", "4.1e-13")}, "curve.csv: ('ours', '1') is 4.1e-13, and was 1e-13"),
        ({"curve_csv": CURVE.replace("2,0", "2,1e-14")}, "('ours', '2') is 1e-14, and was 0"),
        ({"curve_csv": CURVE.replace("1e-13", "nan")}, "is nan, and was 1e-13"),
        ({"curve_csv": CURVE + "ours,c,3,0\n"}, "[('ours', '3')] are in one of both alone"),
        ({"curve_svg": SVG.replace("ours", "theirs")}, "curve.svg: the texts are ['Error', 'theirs'], and were ['Error', 'ours']"),
        ({"more_csv": CURVE}, "the files are"),
    ],
)
def test_what_differs_is_told(differences: Differences, tmp_path: Path, files: dict[str, str], told: str) -> None:
    """A number beyond noise, a NaN, a new place, another name and another file are told."""
    (found,) = differences(folder(tmp_path / "old"), folder(tmp_path / "new", **files))
    assert told in found
