"""The stubs: they have every name of the compiled part with its parameters, and mypy takes a typed program and refuses mistakes."""

import ast
import inspect
import re
import subprocess
import sys
from pathlib import Path

import pytest

import featherbench
from featherbench import _native

STUB = Path(featherbench.__file__).with_name("_native.pyi")
# The names of a class, with the parameters of functions: those by position and those by keyword, and whether each has a default.
Parameters = tuple[list[tuple[str, bool]], list[tuple[str, bool]]]
Names = dict[str, Parameters | None]
TYPED = Path(__file__).with_name("typed.py")


def stubs() -> dict[str, Names]:
    """Give the names of each class in the stub, with the parameters of its functions; None for properties."""
    found: dict[str, Names] = {}
    for item in ast.parse(STUB.read_text(encoding="utf-8")).body:
        if isinstance(item, ast.ClassDef):
            names: Names = {}
            found[item.name] = names
            for entry in item.body:
                if isinstance(entry, ast.FunctionDef):
                    decorators = {getattr(decorator, "id", "") for decorator in entry.decorator_list}
                    arguments = entry.args
                    keyword = [
                        (arg.arg, default is not None) for arg, default in zip(arguments.kwonlyargs, arguments.kw_defaults, strict=True)
                    ]
                    split = len(arguments.args) - len(arguments.defaults)
                    positional = [(arg.arg, k >= split) for k, arg in enumerate(arguments.args) if arg.arg != "self"]
                    names[entry.name] = None if "property" in decorators else (positional, keyword)
    return found


@pytest.mark.parametrize("name", ["Robot", "Joint"])
def test_the_stub_has_every_name(name: str) -> None:
    compiled: Names = {}
    for entry, value in vars(getattr(_native, name)).items():
        if entry.startswith("_"):
            continue
        if inspect.isgetsetdescriptor(value):
            compiled[entry] = None
        else:
            parameters = [p for p in inspect.signature(getattr(getattr(_native, name), entry)).parameters.values() if p.name != "self"]
            told = [(p.name, p.default is not p.empty, p.kind is p.KEYWORD_ONLY) for p in parameters]
            compiled[entry] = ([t[:2] for t in told if not t[2]], [t[:2] for t in told if t[2]])
    assert stubs()[name] == compiled
    assert len(compiled) > 6


def mypy(path: Path) -> subprocess.CompletedProcess[str]:
    pytest.importorskip("mypy", reason="mypy is not installed")
    config = Path(__file__).parents[1] / "pyproject.toml"
    variables = {"MYPYPATH": str(STUB.parents[1]), "PATH": ""}
    command = [sys.executable, "-m", "mypy", "--config-file", str(config), "--cache-dir", str(path.parent / "cache"), str(path)]
    return subprocess.run(command, env=variables, capture_output=True, text=True, check=False)


def test_a_typed_program_is_taken(tmp_path: Path) -> None:
    program = tmp_path / "typed.py"
    program.write_text(TYPED.read_text(encoding="utf-8"), encoding="utf-8")
    done = mypy(program)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.parametrize("page", ["README.md", "python/README.md", "guide/python.md", "guide/tasks.md"])
def test_the_code_of_a_page_is_taken(page: str, tmp_path: Path) -> None:
    text = (Path(__file__).parents[2] / page).read_text(encoding="utf-8")
    program = tmp_path / "page.py"
    program.write_text("".join(re.findall(r"^```python\n(.*?)^```", text, re.DOTALL | re.MULTILINE)), encoding="utf-8")
    assert program.stat().st_size > 0
    done = mypy(program)
    assert done.returncode == 0, done.stdout + done.stderr


def test_mistakes_are_refused(tmp_path: Path) -> None:
    mistakes = {
        "robot.jacobian(q)": "call-arg",
        'robot.velocity_to("bullet", q, q)': "arg-type",
        "robot.nv = 3": "misc",
        "robot.mass_matrix([1.0])": "arg-type",
        "featherbench.read_run(3)": "arg-type",
        "robot.no_such_name": "attr-defined",
    }
    program = tmp_path / "wrong.py"
    start = 'import featherbench\nrobot = featherbench.Robot.generated("humanoid")\nq = robot.neutral()\n'
    program.write_text(start + "\n".join(mistakes) + "\n", encoding="utf-8")
    told = [line.rsplit("[", 1)[1].rstrip("]") for line in mypy(program).stdout.splitlines() if ": error: " in line]
    assert told == list(mistakes.values())


def test_the_typed_program_runs() -> None:
    done = subprocess.run([sys.executable, TYPED], env={"PYTHONPATH": ":".join(sys.path)}, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
