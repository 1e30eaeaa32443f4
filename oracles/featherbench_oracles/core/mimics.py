"""Joints of a URDF that mimic another: q = offset + multiplier · q of the leader. What an engine makes of each.

The tree is compared without them. With M and h of the tree and the map G of the mimics, the reduced dynamics is GᵀMG and Gᵀh. So an engine
that holds the same mimics has the same reduced dynamics. One that drops a mimic has a degree of freedom more: other physics.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from featherbench_oracles.core.messages import Header
from featherbench_oracles.core.reading import note, parsed

ROUNDING = 1e-15  # relative, of a decimal that is read


@dataclass(frozen=True)
class Mimic:
    """A mimic.

    Attributes
    ----------
    leader : str
        The joint that is followed.
    multiplier : float
        rad or m of the follower per rad or m of the leader.
    offset : float
        rad or m.
    """

    leader: str
    multiplier: float
    offset: float

    def near(self, other: Mimic) -> bool:
        """Whether both are the same but for rounding."""
        pairs = ((self.multiplier, other.multiplier), (self.offset, other.offset))
        return self.leader == other.leader and all(abs(a - b) <= ROUNDING * abs(a) for a, b in pairs)

    def __str__(self) -> str:
        """Write the equation."""
        return f"q = {self.offset:.6g} {self.multiplier:+.6g} q({self.leader})"


def written(path: Path) -> Iterator[tuple[str, Mimic]]:
    """Find the mimics of a URDF: the follower, and what it follows. Fixed joints do not move and follow nothing.

    Parameters
    ----------
    path : Path
        The file.

    Returns
    -------
    iterator of (str, Mimic)
        In the order of the file.
    """
    for joint in parsed(path).findall("joint"):
        mimic = joint.find("mimic")
        if mimic is not None and joint.get("type") != "fixed":
            numbers = [_number(mimic.get(key, usual)) for key, usual in (("multiplier", "1"), ("offset", "0"))]
            yield joint.get("name", ""), Mimic(mimic.get("joint", ""), *numbers)


def _number(word: str) -> float:
    """Read a number; what is none is NaN, which no engine's number is near to."""
    try:
        return float(word)
    except ValueError:
        return math.nan


def tell(path: Path, held: Mapping[str, Mimic | None], by: str, dropped: str) -> list[Header]:
    """Note what an engine makes of each mimic.

    Parameters
    ----------
    path : Path
        The file.
    held : mapping of str to Mimic or None
        The followers that the engine ties to a leader, each with the numbers that it holds; `None` if its interface does not give them.
    by : str
        By what it ties them.
    dropped : str
        What it makes of the others.

    Returns
    -------
    list of dict
        A note for each: `mimic` if it is tied as written, `mimic_otherwise` if by other numbers, else `mimic_dropped`.
    """
    notes = []
    for name, mimic in written(path):
        theirs = held.get(name)
        if name not in held:
            notes.append(note("mimic_dropped", name, f"the file says {mimic}; {dropped}"))
        elif theirs is None:
            notes.append(note("mimic", name, f"{by}; its interface does not give the numbers, and they are not compared"))
        elif mimic.near(theirs):
            notes.append(note("mimic", name, f"{by}, {theirs} as written", [theirs.multiplier, theirs.offset]))
        else:
            notes.append(note("mimic_otherwise", name, f"{by}, {theirs}; the file says {mimic}", [theirs.multiplier, theirs.offset]))
    return notes
