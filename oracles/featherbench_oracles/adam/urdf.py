"""A robot as URDF, which adam reads. Numbers are written so that they are read back to the bit; rotations become roll, pitch and yaw."""

from __future__ import annotations

import numpy as np

from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.protocol import Unsupported
from featherbench_oracles.core.robot import Body, Description

WORLD = "world"  # the link of the world, which a robot with a fixed base hangs on


def floats(robot: Description) -> bool:
    """Tell whether the first body floats.

    Parameters
    ----------
    robot : Description
        The robot.

    Returns
    -------
    bool
        Whether its joint is free.
    """
    return bool(robot.bodies) and robot.bodies[0].joint.type == "free"


def text(robot: Description) -> str:
    """Write a robot as URDF. Body k is the link `link(k)`, and its joint `joint(k)`.

    Parameters
    ----------
    robot : Description
        The robot. A free first body is the root of the file, and its joint is left out.

    Returns
    -------
    str
        The text of the file.

    Raises
    ------
    Unsupported
        If adam cannot hold the robot.
    """
    floating = floats(robot)
    lines = ['<robot name="robot">'] + ([] if floating else [f'<link name="{WORLD}"/>'])
    for k, body in enumerate(robot.bodies):
        lines.append(_link(k, body))
        if k > 0 or not floating:
            lines.append(_joint(k, body, floating))
        if body.joint.armature.any():
            raise Unsupported("adam has no armature")
    return "\n".join([*lines, "</robot>"])


def link(body: int) -> str:
    """Name the link of a body, by its index."""
    return f"b{body}"


def joint(body: int) -> str:
    """Name the joint that carries a body, by its index."""
    return f"j{body}"


def _link(k: int, body: Body) -> str:
    (xx, xy, xz), (_, yy, yz), (*_, zz) = body.inertia
    names = zip(("ixx", "ixy", "ixz", "iyy", "iyz", "izz"), (xx, xy, xz, yy, yz, zz), strict=True)
    inertia = " ".join(f'{name}="{float(number)!r}"' for name, number in names)
    origin = f'<origin xyz="{_numbers(body.com)}" rpy="0 0 0"/>'
    return f'<link name="{link(k)}"><inertial>{origin}<mass value="{body.mass!r}"/><inertia {inertia}/></inertial></link>'


def _joint(k: int, body: Body, floating: bool) -> str:
    its = body.joint
    if its.type == "prismatic":
        raise Unsupported("adam's prismatic joint has a motion subspace of twelve rows, and its algorithms fail on it")
    if its.type == "free":
        raise Unsupported("adam's floating base is the root")
    if its.type != "revolute":
        raise Unsupported(f"adam has no {its.type} joint")
    if floating and body.parent < 0:
        raise Unsupported("adam has one root: a robot with a floating base has nothing beside it")
    parent = WORLD if body.parent < 0 else link(body.parent)
    origin = f'<origin xyz="{_numbers(its.translation)}" rpy="{_numbers(roll_pitch_yaw(its.rotation))}"/>'
    between = f'<parent link="{parent}"/><child link="{link(k)}"/>'
    return f'<joint name="{joint(k)}" type="continuous">{between}{origin}<axis xyz="{_numbers(its.axis)}"/></joint>'


def _numbers(numbers: Array) -> str:
    return " ".join(repr(float(number)) for number in numbers)


def roll_pitch_yaw(r: Array) -> Array:
    """Find angles with R = Rz(yaw) Ry(pitch) Rx(roll).

    Roll and pitch are taken from Rz(yaw)' R, so that none loses digits where the pitch is near ±90°.

    Parameters
    ----------
    r : ndarray, shape (3, 3)
        A rotation.

    Returns
    -------
    ndarray, shape (3,)
        Roll, pitch and yaw, rad.
    """
    yaw = np.arctan2(r[1, 0], r[0, 0])
    s, c = np.sin(yaw), np.cos(yaw)
    pitch = np.arctan2(-r[2, 0], c * r[0, 0] + s * r[1, 0])
    roll = np.arctan2(s * r[0, 2] - c * r[1, 2], c * r[1, 1] - s * r[0, 1])
    return np.array([roll, pitch, yaw])
