"""The check after loading: whether what an engine holds is a robot at all. Each engine's reading calls it before it describes its links.

A parser may take a file without a word and hold a matrix that is no rotation, a body without the mass of the file, or no joint. That is a
difference of this engine, with its body and field, and no fault of the file. So what descriptions cannot hold is replaced and noted, and
the rest of the comparison goes on.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.messages import Header
from featherbench_oracles.core.reading import Link, Place, listed, note

ORTHONORMAL = 1e-9  # the largest entry of R R' - 1 that descriptions accept; a parser's rounding is a few eps


def nearest_rotation(matrix: Array) -> Array:
    """Find the rotation nearest to a matrix, the identity if the matrix is not finite."""
    if not np.isfinite(matrix).all():
        return np.eye(3)
    left, _, right = np.linalg.svd(matrix)
    return np.array(left @ np.diag([1.0, 1.0, np.sign(np.linalg.det(left @ right))]) @ right)


def is_rotation(matrix: Array) -> bool:
    """Whether a matrix is a rotation as descriptions accept it."""
    return bool(np.abs(matrix @ matrix.T - np.eye(3)).max() <= ORTHONORMAL and np.linalg.det(matrix) > 0)


def sound(place: Place, about: str, notes: list[Header]) -> Place:
    """Replace a placement that is none by the nearest, with a note that has the engine's own numbers.

    Parameters
    ----------
    place : Place
        What the engine holds.
    about : str
        The link or frame that it places.
    notes : list of dict
        Gets a note `not_a_rotation` with the nine numbers of the matrix, row by row.

    Returns
    -------
    Place
        A placement that descriptions can hold.
    """
    if is_rotation(place.rotation) and np.isfinite(place.translation).all():
        return place
    determinant = float(np.linalg.det(place.rotation)) if np.isfinite(place.rotation).all() else float("nan")
    held = f"the matrix that places it is no rotation: its determinant is {determinant:.9g}"
    numbers = np.nan_to_num(place.rotation).ravel().tolist()
    notes.append(note("not_a_rotation", about, held, numbers))
    return Place(nearest_rotation(place.rotation), np.nan_to_num(place.translation))


def loaded(links: Sequence[Link], notes: list[Header], moving: Sequence[str]) -> list[Link]:
    """Check the links that an engine holds after loading.

    Parameters
    ----------
    links : sequence of Link
        What the engine holds.
    notes : list of dict
        Gets a note of each matrix that is no rotation, and of each mass or inertia that is no number (`not_a_mass`). If no joint is left,
        the joints of the file are noted (`no_joints`).
    moving : sequence of str
        The names of the joints of the file.

    Returns
    -------
    list of Link
        Links that descriptions can hold.
    """
    result = []
    for link in links:
        place = sound(link.place, link.name, notes)
        joints = [replace(joint, place=sound(joint.place, link.name, notes)) for joint in link.joints]
        mass, com, inertia = link.mass, link.com, link.inertia
        if not (np.isfinite(mass) and mass >= 0 and np.isfinite(com).all() and np.isfinite(inertia).all()):
            held = f"its mass {mass:.6g} kg, centre of mass or inertia is no mass property of a body"
            notes.append(note("not_a_mass", link.name, held))
            mass, com, inertia = max(float(np.nan_to_num(mass)), 0.0), np.nan_to_num(com), np.nan_to_num(inertia)
        result.append(replace(link, place=place, joints=joints, mass=mass, com=com, inertia=inertia))
    if moving and not any(link.joints for link in links):
        notes.append(note("no_joints", None, f"it holds no joint, and the file has {len(moving)}: {listed(moving)}"))
    return result
