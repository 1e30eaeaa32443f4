"""Links of a URDF whose mass or moments of inertia an engine has changed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from featherbench_oracles.core.algebra import Array, symmetric
from featherbench_oracles.core.messages import Header
from featherbench_oracles.core.reading import elements, inertial, note

EDITED = 1e-9  # relative difference of a link's mass or inertia that is reported as an edit
ROUNDING = 8 * np.finfo(float).eps  # of m |c|², which an engine adds to the moments and takes off again if it keeps them about the origin
Held = tuple[float, Array, Array]  # mass in kg, centre of mass (3,) in m, inertia about it (3, 3) in kg m², in the link's axes


def edited(path: Path, held: Callable[[str], Held | None]) -> list[Header]:
    """Note the links whose mass or principal moments are not the file's.

    Parameters
    ----------
    path : Path
        The file.
    held : callable
        Takes a link's name to what the engine holds of it; None of a link that it does not keep.

    Returns
    -------
    list of dict
        A note `mass_edited` or `inertia_edited` for each.
    """
    notes = []
    for link in elements(path, "link"):
        name = link.get("name")
        theirs = held(name) if name else None
        if theirs is None:
            continue
        mass, com, inertia = theirs
        words = _given(link, "mass", ["value"])
        if not _near(words, [mass], 0.0):
            notes.append(note("mass_edited", name, f"{' '.join(words)} kg in the file became {mass} kg", inertial(*theirs)))
        words = _given(link, "inertia", ["ixx", "ixy", "ixz", "iyy", "iyz", "izz"])
        try:
            given = np.linalg.eigvalsh(symmetric(np.array(words, dtype=float))).tolist()
        except ValueError:
            given = []
        moments = np.linalg.eigvalsh(inertia).tolist()
        if not _near(given, moments, ROUNDING * mass * float(com @ com)):
            became = f"moments {_few(given)} in the file became {_few(moments)} kg m²"
            notes.append(note("inertia_edited", name, became, inertial(*theirs)))
    return notes


def _given(link: ElementTree.Element, tag: str, keys: list[str]) -> list[str]:
    """Find the numbers of a link's inertial as text; an absent one is 0."""
    element = link.find(f"inertial/{tag}")
    return [(element.get(key) if element is not None else None) or "0" for key in keys]


def _near(given: Sequence[float | str], held: list[float], rounding: float) -> bool:
    """Whether the engine holds the numbers of the file."""
    try:
        x, y = np.array(given, dtype=float), np.array(held)
        return x.shape == y.shape and bool(np.abs(x - y).max() <= EDITED * np.abs(x).max() + rounding)
    except ValueError:
        return False


def _few(numbers: list[float]) -> str:
    return "(" + ", ".join(f"{x:.6g}" for x in numbers) + ")"
