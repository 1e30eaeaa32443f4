"""Scripts without an ending are found by neither ruff nor mypy: pyproject.toml names them."""

from __future__ import annotations

import tomllib

from featherbench_oracles.testing.client import HOME


def test_each_script_without_an_ending_is_named() -> None:
    """A new one of `ci` has its place in both lists."""
    scripts = [file for file in (HOME.parent / "ci").iterdir() if file.is_file() and not file.suffix]
    due = {f"../ci/{file.name}" for file in scripts if "python3" in file.read_text(encoding="utf-8").partition("\n")[0]}
    assert len(due) > 3
    tools = tomllib.loads((HOME / "pyproject.toml").read_text(encoding="utf-8"))["tool"]
    assert set(tools["ruff"]["extend-include"]) == due
    assert due <= set(tools["mypy"]["files"])
