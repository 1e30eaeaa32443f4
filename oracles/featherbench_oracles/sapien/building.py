"""A robot as an articulation of PhysX, in single precision.

PhysX turns a hinge and moves a slide about the x axis of two frames, that of the joint in the parent and that in the child. A link has its
moments about principal axes. SAPIEN has no link without mass: the base, which stands still, gets one of 1 kg.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import sapien
import sapien.physx as physx

from featherbench_oracles.core.algebra import Array, quaternion
from featherbench_oracles.core.protocol import Unsupported
from featherbench_oracles.core.reading import turned
from featherbench_oracles.core.robot import Description

KINDS = {"revolute": "revolute_unwrapped", "prismatic": "prismatic"}


def world(gravity: Array) -> sapien.Scene:
    """Make a scene with this gravity: a scene takes that of the configuration when it is made."""
    physx.set_scene_config(gravity=np.asarray(gravity, dtype=np.float32))
    return sapien.Scene([physx.PhysxCpuSystem()])


def build(robot: Description) -> tuple[sapien.Scene, Any]:
    """Build a description: body k is link k + 1. The scene must live as long as the articulation: without it the program crashes.

    Raises
    ------
    Unsupported
        If PhysX has no such robot.
    """
    scene = world(robot.gravity)
    builder = scene.create_articulation_builder()
    base = builder.create_link_builder(None)
    base.set_name("world")
    base.set_mass_and_inertia(1.0, sapien.Pose(), np.ones(3))
    base.set_joint_properties("fixed", [], sapien.Pose(), sapien.Pose())
    links = [base]
    for body in robot.bodies:
        joint = body.joint
        if joint.type not in KINDS:
            raise Unsupported(f"SAPIEN is asked about hinges and slides, and joint {joint.name} is {joint.type}")
        if body.mass <= 0.0 or np.linalg.eigvalsh(body.inertia)[0] <= 0.0:
            raise Unsupported(f"SAPIEN has no body without mass or inertia (body {body.name})")
        link = builder.create_link_builder(links[body.parent + 1])
        link.set_name(f"link{len(links)}")
        link.set_joint_name(joint.name)
        moments, axes = np.linalg.eigh(body.inertia)
        axes[:, 0] *= np.linalg.det(axes)
        link.set_mass_and_inertia(body.mass, pose(axes, body.com), moments)
        along = x_axis(joint.axis)
        place = pose(joint.rotation @ along, joint.translation)
        link.set_joint_properties(KINDS[joint.type], [[-np.inf, np.inf]], place, pose(along, np.zeros(3)), 0.0, 0.0)
        links.append(link)
    made = builder.build()
    for k, body in enumerate(robot.bodies):
        made.find_link_by_name(f"link{k + 1}").joint.set_armature(np.asarray(body.joint.armature, dtype=np.float32))
    return scene, made


def pose(turn: Array, origin: Array) -> sapien.Pose:
    """Make a pose: its quaternion is (w, x, y, z)."""
    return sapien.Pose(p=origin, q=np.roll(quaternion(turn), 1))


def x_axis(axis: Array) -> Array:
    """Make a rotation whose first column is an axis."""
    other = np.eye(3)[np.argmin(np.abs(axis))]
    second = np.cross(axis, other)
    second /= np.linalg.norm(second)
    return np.column_stack([axis, second, np.cross(axis, second)])


def placed(held: Any) -> tuple[Array, Array]:
    """Read a pose: its rotation, made one in double, and its origin."""
    return turned(*np.array(held.q, dtype=float)), np.array(held.p, dtype=float)
