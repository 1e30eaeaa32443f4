"""Checks of a file before an engine's parser gets it. Some parsers would end their process at files that fail these checks."""

from __future__ import annotations

from pathlib import Path
from xml.parsers import expat

DEEPEST = 500  # nested elements: recursive parsers run out of stack
LARGEST = 10 << 20  # bytes
MOST = 1000  # inclusions; a file counts as often as it is included


def examined(path: Path, form: str) -> Path:
    """Check a file before an engine gets it.

    Parameters
    ----------
    path : Path
        A robot's file.
    form : str
        Its format. A USD is checked by OpenUSD alone.

    Returns
    -------
    Path
        The same.

    Raises
    ------
    ValueError
        If the file is absent, too large, no XML or nested too deeply, or (MJCF) includes itself or too many files.
    """
    if form == "usd":
        _examine_size(path)
    else:
        _examine(path, path.parent, [], [])
    return path


def _examine_size(path: Path) -> None:
    if not path.is_file():
        raise ValueError(f"{path} is not a file")
    if path.stat().st_size > LARGEST:
        raise ValueError(f"{path} is larger than {LARGEST >> 20} MB")


def _examine(path: Path, folder: Path, above: list[Path], opened_before: list[Path]) -> None:
    """Check a file and those that it includes, by their paths from `folder`. The engine reports included files that are absent."""
    _examine_size(path)
    if path in above:
        raise ValueError(f"{path} includes itself")
    opened_before.append(path)
    if len(opened_before) > MOST:
        raise ValueError(f"{path} is one of more than {MOST} inclusions")
    depth, included = 0, []

    def opened(name: str, attributes: dict[str, str]) -> None:
        nonlocal depth
        depth += 1
        if depth > DEEPEST:
            raise ValueError(f"{path} nests more than {DEEPEST} elements within each other")
        if name == "include" and "file" in attributes:
            included.append(folder / attributes["file"])

    def closed(_: str) -> None:
        nonlocal depth
        depth -= 1

    parser = expat.ParserCreate()
    parser.StartElementHandler, parser.EndElementHandler = opened, closed
    try:
        parser.Parse(path.read_bytes(), True)
    except expat.ExpatError as reason:
        raise ValueError(f"{path} is not well-formed XML: {reason}") from reason
    for inner in included:
        if inner.is_file():
            _examine(inner, folder, [*above, path], opened_before)
