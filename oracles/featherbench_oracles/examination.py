"""What is looked at before an engine's parser is given a file: some parsers end their process over files that these checks refuse."""

from __future__ import annotations

from pathlib import Path
from xml.parsers import expat

DEEPEST = 500  # elements within each other: parsers that call themselves for each run out of stack
LARGEST = 10 << 20  # bytes
MOST = 1000  # inclusions, a file counting as often as it is included


def examined(path: Path) -> Path:
    """Look at a file before an engine is given it.

    Parameters
    ----------
    path : Path
        A URDF or MJCF file.

    Returns
    -------
    Path
        The same.

    Raises
    ------
    ValueError
        If no engine should be given the file: absent, too large, no XML, nested too deeply, or (MJCF) one that includes itself.
    """
    _examine(path, path.parent, [], [])
    return path


def _examine(path: Path, folder: Path, above: list[Path], opened_before: list[Path]) -> None:
    """Examine a file and those that it includes, whose names count from `folder`; what is absent there the engine will say."""
    if not path.is_file():
        raise ValueError(f"{path} is not a file")
    if path.stat().st_size > LARGEST:
        raise ValueError(f"{path} is larger than {LARGEST >> 20} MB")
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
