"""The documentation: every public item has a numpydoc text that names its parameters, and examples that run as they are written."""

import doctest
import inspect
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import featherbench
from featherbench import _program

README = Path(__file__).parents[1] / "README.md"
METHODS = [f"Robot.{name}" for name in dir(featherbench.Robot) if not name.startswith("_") and callable(getattr(featherbench.Robot, name))]
FUNCTIONS = {
    **{name: getattr(featherbench.Robot, name.removeprefix("Robot.")) for name in METHODS},
    "compare": featherbench.compare,
    "read_run": featherbench.read_run,
    "_program.find": _program.find,
}
CLASSES = [featherbench.Robot, featherbench.Joint, featherbench.Error]


def section(text: str, name: str) -> str:
    """Give the lines of a section, without its title; nothing if it is not there."""
    found = re.search(rf"^{name}\n-+\n(.*?)(?=^\w[\w ]*\n-+$|\Z)", inspect.cleandoc(text), re.MULTILINE | re.DOTALL)
    return found[1] if found else ""


def ran(name: str, text: str) -> int:
    """Run the examples of a text. Give how many there were."""
    test = doctest.DocTestParser().get_doctest(text, {"featherbench": featherbench, "np": np, "find": _program.find}, name, None, 0)
    runner, told = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS), list[str]()
    result = runner.run(test, out=told.append)
    assert result.failed == 0, "".join(told)
    return result.attempted


def test_there_are_methods() -> None:
    assert len(METHODS) == 31


@pytest.mark.parametrize("name", FUNCTIONS)
def test_examples_run(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(_program.VARIABLE, "no_such_file")
    assert ran(name, inspect.cleandoc(FUNCTIONS[name].__doc__)) > 0


def test_an_example_that_is_wrong_fails() -> None:
    with pytest.raises(AssertionError, match="Expected"):
        ran("wrong", '>>> featherbench.Robot.generated("humanoid").nv\n35\n')


@pytest.mark.parametrize("name", FUNCTIONS)
def test_parameters_are_named(name: str) -> None:
    function = FUNCTIONS[name]
    parameters = [key for key in inspect.signature(function).parameters if key != "self"]
    heads = re.findall(r"^\*?(\w+(?:, \w+)*) : \S", section(function.__doc__, "Parameters"), re.MULTILINE)
    assert [key for head in heads for key in head.split(", ")] == parameters
    assert section(function.__doc__, "Returns")
    if parameters:
        assert section(function.__doc__, "Raises")


@pytest.mark.parametrize("name", METHODS)
def test_arrays_have_shapes_and_units(name: str) -> None:
    text = FUNCTIONS[name].__doc__
    for part in ("Parameters", "Returns"):
        for head, body in re.findall(r"^(\S.*\bndarray.*|ndarray.*)\n((?:    .*\n?)+)", section(text, part), re.MULTILINE):
            if "optional" in head:
                continue  # out: that of the result
            assert re.search(r"shape \(", head), head
            assert re.search(r"\b([Rr]ad|m|N|kg|SI)\b", body), f"{head} has no unit"


@pytest.mark.parametrize("item", CLASSES)
def test_properties_are_documented(item: type) -> None:
    assert item.__doc__
    for name, value in vars(item).items():
        if inspect.isgetsetdescriptor(value) and not name.startswith("_"):
            assert value.__doc__, name


def test_the_readme_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(Path(__file__).parents[2] / "guide")  # where arm.urdf is
    (block,) = re.findall(r"^```python\n(.*?)^```", README.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
    names: dict[str, Any] = {}
    exec(compile(block, str(README), "exec"), names)
    assert names["tau"].shape == (100_000, names["robot"].nv)
    assert names["j"].shape == (6, names["robot"].nv)
    assert np.isfinite(names["tau"]).all()
