"""The robot, built by `createMultiBody` on a base of its own that has no mass and stands still.

Bullet keeps a link's moments about its principal axes, so each inertia is diagonalised. What the simulation would add is off: damping, and
the forces of motors.
"""

from __future__ import annotations

import numpy as np
import pybullet as pb

from featherbench_oracles.core.algebra import Array, quaternion
from featherbench_oracles.core.protocol import Unsupported
from featherbench_oracles.core.robot import Description

KINDS = {"revolute": pb.JOINT_REVOLUTE, "prismatic": pb.JOINT_PRISMATIC}
NO_ROTATION = (0.0, 0.0, 0.0, 1.0)


def build(robot: Description, client: int) -> int:
    """Build a description: body k is link k.

    Parameters
    ----------
    robot : Description
        The robot.
    client : int
        The world.

    Returns
    -------
    int
        Bullet's number of the robot.

    Raises
    ------
    Unsupported
        If PyBullet has no such robot.
    """
    for body in robot.bodies:
        if body.joint.type not in KINDS:
            raise Unsupported(f"PyBullet is asked about hinges and slides, and joint {body.joint.name} is {body.joint.type}")
        if body.joint.armature.any():
            raise Unsupported(f"Bullet has no armature (joint {body.joint.name})")
    held = [principal(body.inertia) for body in robot.bodies]
    joints = [body.joint for body in robot.bodies]
    count = len(robot.bodies)
    made = pb.createMultiBody(
        baseMass=0.0,
        linkMasses=[body.mass for body in robot.bodies],
        linkCollisionShapeIndices=[-1] * count,
        linkVisualShapeIndices=[-1] * count,
        linkPositions=[joint.translation.tolist() for joint in joints],
        linkOrientations=[quaternion(joint.rotation).tolist() for joint in joints],
        linkInertialFramePositions=[body.com.tolist() for body in robot.bodies],
        linkInertialFrameOrientations=[quaternion(axes).tolist() for _, axes in held],
        linkParentIndices=[body.parent + 1 for body in robot.bodies],
        linkJointTypes=[KINDS[joint.type] for joint in joints],
        linkJointAxis=[joint.axis.tolist() for joint in joints],
        physicsClientId=client,
    )
    for k, (moments, _) in enumerate(held):
        pb.changeDynamics(made, k, localInertiaDiagonal=moments.tolist(), physicsClientId=client)
    gravity = robot.gravity.tolist()
    pb.setGravity(*gravity, physicsClientId=client)
    still(made, client)
    return int(made)


def still(made: int, client: int) -> None:
    """Take off what the simulation adds: damping of joints and links, and the motors that hold each joint at rest."""
    for k in range(-1, pb.getNumJoints(made, physicsClientId=client)):
        pb.changeDynamics(made, k, linearDamping=0.0, angularDamping=0.0, jointDamping=0.0, physicsClientId=client)
        if k >= 0:
            pb.setJointMotorControl2(made, k, pb.VELOCITY_CONTROL, force=0.0, physicsClientId=client)


def principal(inertia: Array) -> tuple[Array, Array]:
    """Find moments, and the rotation from their axes to the link's; a diagonal inertia keeps its axes."""
    if not (inertia - np.diag(np.diag(inertia))).any():
        return np.diag(inertia), np.eye(3)
    moments, axes = np.linalg.eigh(inertia)
    return moments, axes * np.sign(np.linalg.det(axes))
