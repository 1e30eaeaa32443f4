"""The program `featherbench`: where it is, and how it is called."""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path

VARIABLE = "FEATHERBENCH_PROGRAM"


def find() -> Path:
    """Find the program.

    Returns
    -------
    Path
        The first that exists: what the variable FEATHERBENCH_PROGRAM names, the build of the nearest checkout from the current folder
        upwards, `featherbench` on PATH.

    Raises
    ------
    FileNotFoundError
        Saying how to get it.

    Examples
    --------
    >>> find()
    Traceback (most recent call last):
    FileNotFoundError: FEATHERBENCH_PROGRAM names no_such_file, which is no file
    """
    named = os.environ.get(VARIABLE)
    if named:
        if Path(named).is_file():
            return Path(named)
        message = f"{VARIABLE} names {named}, which is no file"
        raise FileNotFoundError(message)
    here = Path.cwd()
    for folder in (here, *here.parents):
        built = folder / "target" / "release" / "featherbench"
        if (folder / "crates" / "cli").is_dir() and built.is_file():
            return built
    on_path = shutil.which("featherbench")
    if on_path:
        return Path(on_path)
    message = (
        "the program featherbench is not found; `cargo build --release` in a checkout makes it, "
        f"and `{VARIABLE}=…/target/release/featherbench` names it from elsewhere"
    )
    raise FileNotFoundError(message)


def call(arguments: Sequence[str]) -> int:
    """Run the program on this terminal.

    Parameters
    ----------
    arguments : sequence of str
        Its arguments.

    Returns
    -------
    int
        Its exit code: 0 good, 1 a gate failed, 2 bad input, 3 an engine is missing.
    """
    return subprocess.run([find(), *arguments], check=False).returncode
