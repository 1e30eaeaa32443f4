"""Values that no joint can have: armature, damping or friction that is negative, infinite or no number.

Such a value is a finding about the file. It is told with its line and with what the engine holds, and left out of what is compared.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from xml.parsers import expat

import numpy as np
from numpy.typing import NDArray

from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.messages import Header
from featherbench_oracles.core.reading import Link, note

# element and attributes of each format, and the field of a description that each is
PLACES = {
    "mjcf": ("joint", {"armature": "armature", "damping": "damping", "frictionloss": "friction"}),
    "urdf": ("dynamics", {"damping": "damping", "friction": "friction"}),
}
FIELDS = ("armature", "damping", "friction")


@dataclass(frozen=True)
class Bad:
    """A bad value of a file: its line, the joint (empty for a class of defaults), the attribute, and the words of the file."""

    line: int
    joint: str
    attribute: str
    value: str


def bad(values: Array) -> NDArray[np.bool_]:
    """Find the numbers that no joint can have."""
    return ~(np.isfinite(values) & (values >= 0))


def written(path: Path, form: str) -> Iterator[Bad]:
    """Find the bad values in a file, but not in files that it includes.

    Parameters
    ----------
    path : Path
        The file.
    form : str
        `mjcf` or `urdf`.

    Returns
    -------
    iterator of Bad
        In the order of the file.
    """
    if form not in PLACES:  # an SDF has its numbers between tags: what is held is told
        return
    found: list[Bad] = []
    tag, attributes = PLACES[form]
    joints: list[str] = []
    parser = expat.ParserCreate()

    def start(name: str, given: dict[str, str]) -> None:
        joints.append(given.get("name", "") if name == "joint" else "")
        if name != tag:
            return
        joint = next((joint for joint in reversed(joints) if joint), "")
        for attribute in attributes:
            words = given.get(attribute, "").split()
            if words and _bad_word(words[0]):
                found.append(Bad(parser.CurrentLineNumber, joint, attribute, given[attribute]))

    def end(_: str) -> None:
        joints.pop()

    parser.StartElementHandler, parser.EndElementHandler = start, end
    parser.Parse(path.read_bytes(), True)
    yield from found


def _bad_word(word: str) -> bool:
    """Whether a word is a number that no joint can have. Other words are for the engines to refuse."""
    try:
        value = float(word)
    except ValueError:
        return False
    return not (math.isfinite(value) and value >= 0)


def zeroed(links: Sequence[Link]) -> tuple[list[Link], dict[tuple[str, str], Array]]:
    """Put zeros in place of bad values.

    Parameters
    ----------
    links : sequence of Link
        The links that the engine holds.

    Returns
    -------
    list of Link
        The same links without bad values.
    dict of (str, str) to ndarray
        What was held, by joint and field.
    """
    held: dict[tuple[str, str], Array] = {}
    result = []
    for link in links:
        joints = []
        for joint in link.joints:
            dofs = dict(joint.dofs)
            for field in FIELDS:
                if field in dofs and bad(dofs[field]).any():
                    held[joint.name, field] = dofs[field]
                    dofs[field] = np.where(bad(dofs[field]), 0.0, dofs[field])
            joints.append(replace(joint, dofs=dofs))
        result.append(replace(link, joints=joints))
    return result, held


def left_out(path: Path, form: str, links: Sequence[Link], notes: list[Header]) -> list[Link]:
    """Take bad values out of the links that an engine holds, and tell them.

    Parameters
    ----------
    path : Path
        The file.
    form : str
        `mjcf` or `urdf`.
    links : sequence of Link
        The links that the engine holds.
    notes : list of dict
        Gets a note `bad_value` for each bad value of the file, and for each that is held and not found there.

    Returns
    -------
    list of Link
        The same links with zeros in place of bad values.
    """
    result, held = zeroed(links)
    for value in written(path, form):
        theirs = held.pop((value.joint, PLACES[form][1][value.attribute]), None)
        owner = f"joint '{value.joint}'" if value.joint else "a class or a joint without a name"
        here = "0 or nothing" if theirs is None else ", ".join(f"{x:.6g}" for x in theirs)
        said = f'line {value.line}: {owner} has {value.attribute}="{value.value}"'
        notes.append(note("bad_value", value.joint or None, f"{said}, which no joint can have; it is left out; this engine holds {here}"))
    for (name, field), values in held.items():
        numbers = ", ".join(f"{x:.6g}" for x in values)
        notes.append(note("bad_value", name, f"joint '{name}' has {field} {numbers}, which no joint can have; it is left out"))
    return result
