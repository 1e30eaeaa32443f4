"""What is looked at before an engine's parser is given a file: some parsers end their process over files that these checks refuse."""

from __future__ import annotations

from pathlib import Path
from xml.parsers import expat

DEEPEST = 1000  # elements within each other: parsers that call themselves for each run out of stack
LARGEST = 10 << 20  # bytes


def examined(path: Path) -> Path:
    """The path; raises ValueError for a file that no engine should be given: absent, too large, no XML, or nested too deeply."""
    if not path.is_file():
        raise ValueError(f"{path} is not a file")
    if path.stat().st_size > LARGEST:
        raise ValueError(f"{path} is larger than {LARGEST >> 20} MB")
    depth = 0

    def opened(*_: object) -> None:
        nonlocal depth
        depth += 1
        if depth > DEEPEST:
            raise ValueError(f"{path} nests more than {DEEPEST} elements within each other")

    def closed(_: str) -> None:
        nonlocal depth
        depth -= 1

    parser = expat.ParserCreate()
    parser.StartElementHandler, parser.EndElementHandler = opened, closed
    try:
        parser.Parse(path.read_bytes(), True)
    except expat.ExpatError as reason:
        raise ValueError(f"{path} is not well-formed XML: {reason}") from reason
    return path
