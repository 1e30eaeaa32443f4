"""A robot of frax, of a description or of a file.

frax's robot is made of a URDF alone: its parser gives it a table of numbers. So for a description the same table is made here, and frax's
class takes it in the place of the parser's.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import frax.core.robot
import numpy as np

from featherbench_oracles.core.protocol import Unsupported
from featherbench_oracles.core.robot import Description

KINDS = {"revolute": 0, "prismatic": 1}


def build(robot: Description) -> Any:
    """Build a description: body k is joint k.

    Raises
    ------
    Unsupported
        If frax has no such robot.
    """
    table = table_of(robot)
    with parsed_as(table):
        return frax.core.robot.Robot("a description")


def table_of(robot: Description) -> dict[str, Any]:
    """Make the table that frax's parser makes of a URDF."""
    for body in robot.bodies:
        joint = body.joint
        if joint.type not in KINDS:
            raise Unsupported(f"frax is asked about hinges and slides, and joint {joint.name} is {joint.type}")
        if joint.armature.any():
            raise Unsupported(f"frax has no armature (joint {joint.name})")
    joints = [body.joint for body in robot.bodies]
    one = np.eye(3).tolist()
    none = [math.inf] * len(joints)
    return {
        "num_joints": len(joints),
        "joint_names": [joint.name for joint in joints],
        "joint_types": [KINDS[joint.type] for joint in joints],
        "actuated_joint_lower_limits": [-math.inf] * len(joints),
        "actuated_joint_upper_limits": none,
        "actuated_joint_max_forces": none,
        "actuated_joint_max_velocities": none,
        "joint_axes": [joint.axis.tolist() for joint in joints],
        "joint_parent_frame_positions": [joint.translation.tolist() for joint in joints],
        "joint_parent_frame_rotations": [joint.rotation.tolist() for joint in joints],
        "link_masses": [body.mass for body in robot.bodies],
        "link_local_inertias": [body.inertia.tolist() for body in robot.bodies],
        "link_local_inertia_positions": [body.com.tolist() for body in robot.bodies],
        "link_local_inertia_rotations": [one] * len(joints),
        "parent_idxs": [body.parent for body in robot.bodies],
    }


@contextmanager
def parsed_as(table: dict[str, Any]) -> Iterator[None]:
    """Let frax's class take a table in the place of what its parser makes."""
    parser = frax.core.robot.parse_urdf
    frax.core.robot.parse_urdf = lambda *_, **__: table
    try:
        yield
    finally:
        frax.core.robot.parse_urdf = parser


def read(path: Path) -> Any:
    """Read a URDF by frax, on a fixed base."""
    return frax.core.robot.Robot(str(path))
