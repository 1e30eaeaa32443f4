"""The guide: its code runs, its numbers are Pinocchio's, and the names in its tables exist."""

import re
import shutil
import subprocess
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import featherbench

ROOT = Path(__file__).parents[2]
GUIDE = ROOT / "guide"
STATE = np.array([[0.3, -0.5, 0.1], [1.0, 0.5, -0.2], [0.2, 0.4, 0.6]])
SHOULDER = re.compile(r"the shoulder needs (-?\d+\.\d{9}) N m")


def pages() -> list[Path]:
    found = sorted(GUIDE.glob("*.md"))
    assert len(found) >= 8
    return found


@pytest.mark.parametrize("page", pages(), ids=lambda page: page.stem)
def test_every_block_of_python_runs(page: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(GUIDE)
    names: dict[str, Any] = {}
    for block in re.findall(r"^```python\n(.*?)^```", page.read_text(), re.DOTALL | re.MULTILINE):
        exec(compile(block, page.name, "exec"), names)


def shoulder() -> float:
    pin = pytest.importorskip("pinocchio", reason="pinocchio is not installed")
    model = pin.buildModelFromUrdf(str(GUIDE / "arm.urdf"))
    return float(pin.rnea(model, model.createData(), *STATE)[0])


def test_ten_lines_of_python_end_in_the_number_of_pinocchio(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    due = shoulder()
    monkeypatch.chdir(GUIDE)
    block = re.search(r"^```python\n(.*?)^```", (GUIDE / "python.md").read_text(), re.DOTALL | re.MULTILINE)
    assert block is not None
    assert len(block[1].strip().splitlines()) <= 11  # ten and a blank one
    exec(compile(block[1], "python.md", "exec"), {})
    printed = SHOULDER.search(capsys.readouterr().out)
    # Nine digits are printed.
    assert printed is not None
    assert abs(float(printed[1]) - due) <= 0.51e-9


def test_ten_lines_of_rust_end_in_the_number_of_pinocchio() -> None:
    due = shoulder()
    if shutil.which("cargo") is None:
        pytest.skip("cargo is not installed")
    command = ["cargo", "run", "--release", "--quiet", "-p", "featherbench-rbd", "--example", "ten_lines"]
    out = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout
    printed, told = SHOULDER.search(out), SHOULDER.search((GUIDE / "rust.md").read_text())
    assert printed is not None
    assert told is not None
    assert abs(float(printed[1]) - due) <= 0.51e-9
    assert printed[1] == told[1]


def tables() -> list[tuple[str, str, str]]:
    text = (GUIDE / "coming-from.md").read_text()
    rows = re.findall(r"^\| `([\w.]+)` \| `(\w+)` \| `(\w+)` \|", text, re.MULTILINE)
    assert len(rows) >= 30
    return rows


@pytest.mark.parametrize(("theirs", "python", "rust"), tables(), ids=lambda name: name)
def test_the_names_in_the_tables_exist(theirs: str, python: str, rust: str) -> None:
    assert hasattr(featherbench.Robot, python)
    sources = "".join(path.read_text() for path in (ROOT / "crates" / "mechanics" / "rbd" / "src").glob("*.rs"))
    assert re.search(rf"pub fn {rust}\b", sources)
    package, *names = theirs.replace("pin.", "pinocchio.", 1).split(".")
    pytest.importorskip(package, reason=f"{package} is not installed")
    found = import_module(package)
    for k, name in enumerate(names):
        # A module need not be loaded with its package.
        found = getattr(found, name) if hasattr(found, name) else import_module(".".join([package, *names[: k + 1]]))
