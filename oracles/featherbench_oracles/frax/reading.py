"""frax's own parser of URDF, and what the robot then holds.

It merges fixed joints, and numbers joints breadth first. What is welded to the world is in no number of the robot.
"""

from __future__ import annotations

from collections.abc import Callable
from math import inf
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from featherbench_oracles.core import bad_values, mimics
from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.loaded import loaded
from featherbench_oracles.core.messages import Header
from featherbench_oracles.core.protocol import Reading, Unsupported
from featherbench_oracles.core.reading import HeldJoint, Link, Place, describe, elements, moving, overheard
from featherbench_oracles.core.robot import Description
from featherbench_oracles.frax import building

GRAVITY = np.array([0.0, 0.0, -9.81])
TYPES = ("revolute", "prismatic")


def read(path: Path, base: str, make: Callable[[Description, Any, NDArray[np.intp]], Any]) -> Reading:
    """Read a file as `abilities.ReadsFiles` says; `make` takes the description, the robot and the order of its joints."""
    if base == "free":
        raise Unsupported("frax is asked about robots on a fixed base")
    notes: list[Header] = []
    with overheard(path, notes):
        try:
            made = building.read(path)
        except AttributeError as reason:
            raise Unsupported(f"frax's parser fails, as it does where the root has no inertial: AttributeError: {reason}") from reason
    order = _depth_first(made.parent_idxs.tolist())
    links = loaded(_links(made, order, path), notes, moving(path))
    links = bad_values.left_out(path, "urdf", links, notes)
    description = describe(path.stem, GRAVITY, links)
    notes.extend(mimics.tell(path, {}, "", "a joint of its own"))
    held = Description.read(description)
    return Reading(description, held, notes, make(held, made, np.array(order, dtype=np.intp)), {})


def _depth_first(parents: list[int]) -> list[int]:
    below: dict[int, list[int]] = {}
    for joint, parent in enumerate(parents):
        below.setdefault(parent, []).append(joint)
    order, ahead = [], list(reversed(below.get(-1, [])))
    while ahead:
        order.append(ahead.pop())
        ahead.extend(reversed(below.get(order[-1], [])))
    return order


def _links(made: Any, order: list[int], path: Path) -> list[Link]:
    """List the links of joints. Their names are those of the file: frax keeps the names of joints alone."""
    children = {joint.get("name"): child.get("link") for joint in elements(path, "joint") for child in joint.iter("child")}
    links: list[Link] = []
    for joint in order:
        name = made.joint_names[joint]
        turn = made.link_local_inertia_rotations[joint]
        inertia = turn @ made.link_local_inertias[joint] @ turn.T
        place = Place(made.joint_parent_frame_rotations[joint], made.joint_parent_frame_positions[joint])
        axis = made.joint_axes[joint]
        held = HeldJoint(name, TYPES[made.joint_types[joint]], axis / np.linalg.norm(axis), dofs=_limits(made, joint))
        parent = order.index(made.parent_idxs[joint]) if made.parent_idxs[joint] >= 0 else -1
        com = made.link_local_inertia_positions[joint]
        links.append(Link(children.get(name) or name, float(made.link_masses[joint]), com, inertia, parent, place, [held]))
    return links


def _limits(made: Any, joint: int) -> dict[str, Array]:
    names = {"lower": "lower_limits", "upper": "upper_limits", "effort": "max_forces", "velocity": "max_velocities"}
    found = {key: np.array([float(getattr(made, f"actuated_joint_{name}")[joint])]) for key, name in names.items()}
    return {key: value if np.isfinite(value).all() else np.array([inf]) for key, value in found.items()}
