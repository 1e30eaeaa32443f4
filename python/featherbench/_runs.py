"""Runs of the program: their rows as frames, and comparisons of engines as objects."""

from __future__ import annotations

import json
import subprocess
import tempfile
from collections.abc import Iterable
from dataclasses import dataclass
from os import PathLike, fspath
from pathlib import Path
from typing import Any

from featherbench._native import checksum
from featherbench._program import find

# The format of schema.json that is read here.
FORMAT = 2


class RunError(ValueError):
    """A folder that is no whole run, or a comparison that did not end."""


@dataclass(frozen=True)
class Question:
    """A question that a run must answer with yes.

    Attributes
    ----------
    robot, engine : str
        What it is about; empty where it is about all.
    what : str
        The question, as a statement of what must not be.
    found, expected : int
        How often it was found, and how often that is right.
    holds : bool
        Whether the answer is yes.
    reason : str
        Why not.
    """

    robot: str
    engine: str
    what: str
    found: int
    expected: int
    holds: bool
    reason: str


@dataclass(frozen=True)
class Comparison:
    """What `featherbench compare` found.

    Attributes
    ----------
    folder : Path
        The run, with its report `index.html`.
    questions : tuple of Question
        For each robot and engine: is it read, do its bodies and joints mean the same, are its answers the same?
    """

    folder: Path
    questions: tuple[Question, ...]

    @property
    def alike(self) -> bool:
        """Whether all engines read all robots alike."""
        return all(question.holds for question in self.questions)

    @property
    def differences(self) -> tuple[Question, ...]:
        """The questions that do not hold."""
        return tuple(question for question in self.questions if not question.holds)

    def rows(self, frame: str = "polars") -> Any:
        """Read the rows, as `read_run` does.

        Parameters
        ----------
        frame : {'polars', 'pandas'}
            Whose frame is made.

        Returns
        -------
        polars.DataFrame or pandas.DataFrame
            One row per measured number.
        """
        return read_run(self.folder, frame)


def read_run(folder: str | PathLike[str], frame: str = "polars") -> Any:
    """Read the rows of a run.

    Parameters
    ----------
    folder : str or os.PathLike
        The run's folder, such as reports/LATEST.
    frame : {'polars', 'pandas'}
        Whose frame is made; that package must be installed.

    Returns
    -------
    polars.DataFrame or pandas.DataFrame
        One row per measured number. The columns are those of schema.json, with its types: integers, floats, flags, words of a list, text.
        What a row does not have is null, but for text, which is empty.

    Raises
    ------
    RunError
        When a file is missing or is not what checksums.txt says, or when the format is another.
    ImportError
        When the package is not installed.

    Examples
    --------
    >>> featherbench.read_run("no_such_run")
    Traceback (most recent call last):
    featherbench._runs.RunError: no_such_run is no whole run: ...
    """
    path = Path(fspath(folder))
    if frame not in ("polars", "pandas"):
        message = f"frame is {frame!r}; give 'polars' or 'pandas'"
        raise RunError(message)
    rows, schema = (_whole(path, name) for name in ("rows.csv", "schema.json"))
    described = json.loads(schema)
    if described.get("format") != FORMAT:
        message = f"{path / 'schema.json'} has format {described.get('format')}; this package reads {FORMAT}: write the report again"
        raise RunError(message)
    columns = described["columns"]
    return _polars(rows, columns) if frame == "polars" else _pandas(rows, columns)


def compare(
    *files: str | PathLike[str],
    floating: bool = False,
    engines: Iterable[str] | None = None,
    out: str | PathLike[str] | None = None,
) -> Comparison:
    """Ask whether the engines read robots' files alike.

    Parameters
    ----------
    *files : str or os.PathLike
        URDF or MJCF files.
    floating : bool
        Whether the root link of a URDF has a free joint to the world.
    engines : iterable of str, optional
        The engines that are asked; None asks all of the program's.
    out : str or os.PathLike, optional
        The run's folder; None makes a new one in the folder for temporary files.

    Returns
    -------
    Comparison
        The questions and their answers.

    Raises
    ------
    RunError
        With the program's words, when a file is bad or an engine is missing.
    FileNotFoundError
        When the program is not found.

    Examples
    --------
    >>> featherbench.compare("arm.urdf")
    Traceback (most recent call last):
    FileNotFoundError: FEATHERBENCH_PROGRAM names no_such_file, which is no file
    """
    folder = Path(fspath(out)) if out is not None else Path(tempfile.mkdtemp(prefix="featherbench-")) / "compare"
    arguments = ["compare", "--out", str(folder), *(["--floating"] if floating else [])]
    if engines is not None:
        arguments += ["--engines", ",".join(engines)]
    done = subprocess.run([find(), *arguments, "--", *(fspath(file) for file in files)], capture_output=True, text=True, check=False)
    # 1 says that engines differ, which is an answer.
    if done.returncode not in (0, 1):
        # What is wrong with each file is told before the last line.
        said = [line for line in done.stderr.splitlines() if line.startswith(("not compared: ", "error: "))]
        raise RunError("\n".join(said) or f"the program ended with {done.returncode}")
    info = json.loads(_whole(folder, "run.json"))
    questions = (
        Question(
            condition["culprit"]["robot"],
            condition["culprit"]["engine"],
            condition["what"],
            condition["found"],
            condition["expected"],
            condition["verdict"] == "pass",
            condition["reason"],
        )
        for condition in info["expected"]
    )
    return Comparison(folder, tuple(questions))


def _whole(folder: Path, name: str) -> bytes:
    """Read a file of a run, and check it."""
    path = folder / name
    try:
        content, sums = path.read_bytes(), (folder / "checksums.txt").read_text()
    except OSError as error:
        message = f"{folder} is no whole run: {error}"
        raise RunError(message) from error
    due = {file: digest for digest, file in (line.split(maxsplit=1) for line in sums.splitlines())}.get(name)
    if due != checksum(content):
        message = f"{path} is not what checksums.txt says: it was changed, or written in part"
        raise RunError(message)
    return content


def _polars(rows: bytes, columns: list[dict[str, Any]]) -> Any:
    import polars as pl

    def dtype(column: dict[str, Any]) -> Any:
        if column["type"] == "word":
            return pl.Enum(column["words"])
        return {"text": pl.String, "integer": pl.Int64, "float": pl.Float64, "flag": pl.Boolean}[column["type"]]

    schema = {column["name"]: dtype(column) for column in columns}
    text = [column["name"] for column in columns if column["type"] == "text"]
    return pl.read_csv(rows, schema=schema).with_columns(pl.col(text).fill_null(""))


def _pandas(rows: bytes, columns: list[dict[str, Any]]) -> Any:
    from io import BytesIO

    import pandas as pd

    def dtype(column: dict[str, Any]) -> Any:
        if column["type"] == "word":
            return pd.CategoricalDtype(column["words"])
        return {"text": "string", "integer": "Int64", "float": "float64", "flag": "boolean"}[column["type"]]

    missing = {column["name"]: [""] for column in columns if column["type"] != "text"}
    types = {column["name"]: dtype(column) for column in columns}
    return pd.read_csv(BytesIO(rows), dtype=types, keep_default_na=False, na_values=missing)
