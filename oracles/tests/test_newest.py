"""`ci/newest`: versions are read from `engines.toml` and written into a copy of it, and what pip cannot resolve is a warning."""

import re
import runpy
import tomllib
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def script() -> dict[str, Any]:
    """The names of the script."""
    return runpy.run_path(str(ROOT / "ci/newest"))


@pytest.fixture(scope="module")
def engines() -> str:
    """The text of `engines.toml`."""
    return (ROOT / "oracles/engines.toml").read_text()


def test_the_shared_engines_are_pinned(script: dict[str, Any], engines: str) -> None:
    """Four engines share the environment, each with its version."""
    found = script["pinned"](engines)
    assert set(found) == {"pin", "mujoco", "drake", "dartpy"}
    assert found["mujoco"] == tomllib.loads(engines)["mujoco"]["package"]["version"]


def test_one_version_is_renewed_and_nothing_else(script: dict[str, Any], engines: str) -> None:
    """One line changes, and an unknown package is an error."""
    renewed = script["renewed"](engines, {"mujoco": "99.1"})
    changed = [(a, b) for a, b in zip(engines.splitlines(), renewed.splitlines(), strict=True) if a != b]
    assert len(changed) == 1
    assert 'version = "99.1"' in changed[0][1]
    assert script["pinned"](renewed)["mujoco"] == "99.1"
    with pytest.raises(ValueError, match="no line with the package mojoco"):
        script["renewed"](engines, {"mojoco": "1"})


def test_the_table_says_what_is_newer(script: dict[str, Any]) -> None:
    """A newer version is marked."""
    told = script["table"]({"a": "1", "b": "2"}, {"a": "1", "b": "3"}, "3.11.7")
    assert "for Python 3.11.7" in told
    assert "| a | 1 | 1 |" in told
    assert "| b | 2 | 3 (newer) |" in told


def test_each_package_has_its_day(script: dict[str, Any], engines: str) -> None:
    """The day is that of the pinned version; native oracles are built of the packages of others."""
    described = script["packages"](engines)
    assert described["mujoco"]["released"] == "2026-11-06"
    assert described["faer"]["kind"] == "cargo_library"
    assert len(described) == len(re.findall(r"^package = ", engines, re.M))
    assert "| mujoco | 4.0.0 | 2026-11-06 |" in script["days"](described)


def test_a_day_of_a_wheel_is_that_from_which_pip_finds_it(script: dict[str, Any], tmp_path: Path) -> None:
    """The index got the wheel within 2 March: the day before and the day after are wrong."""
    pip: list[str | Path] = [program(tmp_path, "pip", 'case "$*" in *prior-to\\ 2026-03-0[3-9]*a==1) exit 0; esac; exit 1')]
    found = [script["is_day_of_wheel"]("a==1", day, pip) for day in ("2026-03-01", "2026-03-02", "2026-03-03")]
    assert found == [False, True, False]


def test_a_day_of_a_crate_is_what_cargo_keeps(script: dict[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a version that the index does not have no day is known."""
    kept = tmp_path / "registry/index/some/.cache/fa/er"
    kept.mkdir(parents=True)
    lines = [b"\3\2", b"etag", b"1.0.0", b'{"vers":"1.0.0","pubtime":"2026-03-02T23:59:59Z"}', b"1.1.0", b'{"vers":"1.1.0"}']
    (kept / "faer").write_bytes(b"\0".join(lines))
    program(tmp_path, "cargo", "exit 1")
    monkeypatch.setenv("CARGO_HOME", str(tmp_path))
    monkeypatch.setenv("PATH", str(tmp_path))
    days = [script["day_of_crate"]("faer", version) for version in ("1.0.0", "1.1.0", "2.0.0")]
    assert days == ["2026-03-02", None, None]


def test_a_warning_is_one_line(script: dict[str, Any], capsys: pytest.CaptureFixture[str]) -> None:
    """Line ends and per cent signs are escaped as GitHub asks."""
    script["warn"]("50 %\nmore")
    assert capsys.readouterr().out == "::warning title=the newest engines::50 %25%0Amore\n"


def program(folder: Path, name: str, text: str) -> Path:
    """Write a program for the shell."""
    written = folder / name
    written.write_text(f"#!/bin/sh\n{text}\n")
    written.chmod(0o755)
    return written


def test_the_newest_interpreter_that_starts_is_taken(script: dict[str, Any], tmp_path: Path) -> None:
    """Versions are compared as numbers; what does not start, is no release or is no CPython is none."""
    path = [
        program(tmp_path, "python3", "echo 3 9 18 final cpython"),
        program(tmp_path, "python3.10", "echo 3 10 4 final cpython"),
        program(tmp_path, "python3.11", "echo 3 12 0 candidate cpython"),
        program(tmp_path, "python3.12", "echo 3 12 9 final pypy"),
        program(tmp_path, "python3.13", "exit 127"),
        tmp_path / "python3.14",
    ]
    assert script["interpreter"](path) == ("3.10.4", path[1])
    with pytest.raises(FileNotFoundError, match="no Python with venv"):
        script["interpreter"](path[2:])


def test_candidates_are_those_of_the_path_of_pyenv_and_of_uv(
    script: dict[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A program of another name is none."""
    tools, versions = tmp_path / "tools", tmp_path / "versions/3.13.0/bin"
    tools.mkdir()
    versions.mkdir(parents=True)
    wanted = {program(tools, "python3.12", "exit 1"), program(versions, "python3.13", "exit 1"), tmp_path / "managed"}
    program(tools, "python3-config", "exit 1")
    program(tools, "uv", f"""echo '[{{"path": "{tmp_path / "managed"}"}}]'""")
    monkeypatch.setenv("PATH", str(tools))
    monkeypatch.setenv("PYENV_ROOT", str(tmp_path))
    assert set(script["candidates"]()) == wanted
