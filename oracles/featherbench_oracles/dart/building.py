"""The robot, built with the calls of a `Skeleton`.

Joints are DART's Revolute, Prismatic, Screw (whose pitch is per *revolution*), Ball, Free, Planar, Universal, Translational and Euler. A
cylindrical joint is a revolute and a prismatic one with a massless body between. DART has no armature. Damping, springs and friction are
zero unless set. DART's check of inertias gives a warning only, so unphysical bodies are allowed.
"""

from __future__ import annotations

from math import pi

import numpy as np
from dartpy import dynamics
from dartpy.math import Isometry3

from featherbench_oracles.core.protocol import Unsupported
from featherbench_oracles.core.robot import Description, Joint
from featherbench_oracles.dart.coordinates import AXES

#: Bodies of a skeleton. DART makes its n × n matrices anew for each body: 9 s for 1000 bodies, 73 s for 2000.
MOST = 1500


def check_size(bodies: int) -> None:
    """Refuse a robot whose skeleton would take minutes.

    Parameters
    ----------
    bodies : int
        The number of its bodies.

    Raises
    ------
    Unsupported
        If there are more than `MOST`.
    """
    if bodies > MOST:
        grows = "the time in which it makes a skeleton grows with the cube of the number of bodies"
        raise Unsupported(f"DART is asked about {MOST} bodies at most, and these are {bodies}: {grows}")


def build(robot: Description) -> tuple[dynamics.Skeleton, list[dynamics.Joint], list[dynamics.BodyNode]]:
    """Build the skeleton of a description.

    Parameters
    ----------
    robot : Description
        The robot.

    Returns
    -------
    skeleton : dynamics.Skeleton
        The robot.
    joints : list of dynamics.Joint
        The joint of each body; for a cylindrical joint the first of two.
    bodies : list of dynamics.BodyNode
        The bodies that they move.

    Raises
    ------
    Unsupported
        If DART has no such robot: it has no armature. If the robot has more than `MOST` bodies.
    """
    check_size(len(robot.bodies))
    skeleton = dynamics.Skeleton("robot")
    skeleton.setGravity(robot.gravity)
    joints: list[dynamics.Joint] = []
    bodies: list[dynamics.BodyNode] = []
    for body in robot.bodies:
        joint = body.joint
        if joint.armature.any():
            raise Unsupported(f"DART has no armature (joint {joint.name})")
        first, node = make_joint(skeleton, joint, bodies[body.parent] if body.parent >= 0 else None)
        turn = AXES if joint.type == "euler_zyx" else np.eye(3)
        first.setTransformFromParentBodyNode(Isometry3(joint.rotation @ turn, joint.translation))
        node.getParentJoint().setTransformFromChildBodyNode(Isometry3(turn, np.zeros(3)))
        node.setInertia(dynamics.Inertia(body.mass, body.com, body.inertia))
        joints.append(first)
        bodies.append(node)
    return skeleton, joints, bodies


def make_joint(add: dynamics.Skeleton, joint: Joint, parent: dynamics.BodyNode | None) -> tuple[dynamics.Joint, dynamics.BodyNode]:
    """Make DART's joint of the description's type.

    Parameters
    ----------
    add : dynamics.Skeleton
        The skeleton that gets the joint.
    joint : Joint
        The joint.
    parent : dynamics.BodyNode | None
        The parent body; None is the world.

    Returns
    -------
    made : dynamics.Joint
        DART's joint; for a cylindrical joint the first of two.
    node : dynamics.BodyNode
        The body that it moves.

    Raises
    ------
    Unsupported
        If DART has no such joint.
    """
    if joint.type == "revolute":
        made, node = add.createRevoluteJointAndBodyNodePair(parent)
        made.setAxis(joint.axis)
    elif joint.type == "prismatic":
        made, node = add.createPrismaticJointAndBodyNodePair(parent)
        made.setAxis(joint.axis)
    elif joint.type == "helical":
        made, node = add.createScrewJointAndBodyNodePair(parent)
        made.setAxis(joint.axis)
        made.setPitch(2 * pi * joint.pitch)
    elif joint.type == "cylindrical":
        made, between = add.createRevoluteJointAndBodyNodePair(parent)
        between.setInertia(dynamics.Inertia(0.0, np.zeros(3), np.zeros((3, 3))))
        slide, node = add.createPrismaticJointAndBodyNodePair(between)
        for part in (made, slide):
            part.setAxis(joint.axis)
    elif joint.type == "universal":
        made, node = add.createUniversalJointAndBodyNodePair(parent)
        made.setAxis1([1.0, 0.0, 0.0])
        made.setAxis2([0.0, 1.0, 0.0])
    elif joint.type == "planar":
        made, node = add.createPlanarJointAndBodyNodePair(parent)
        made.setXYPlane()
    else:
        makers = {
            "spherical": add.createBallJointAndBodyNodePair,
            "free": add.createFreeJointAndBodyNodePair,
            "translation": add.createTranslationalJointAndBodyNodePair,
            "euler_zyx": add.createEulerJointAndBodyNodePair,
        }
        if joint.type not in makers:
            raise Unsupported(f"DART has no {joint.type} joint")
        made, node = makers[joint.type](parent)
    return made, node
