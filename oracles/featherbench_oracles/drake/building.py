"""The robot, built with the calls of a continuous `MultibodyPlant(0.0)`.

Joints are Drake's Revolute, Prismatic, Screw (whose pitch is per *revolution*), BallRpy, QuaternionFloating, Planar and Universal. Drake
has no quaternion ball joint, and no translation, cylindrical or euler_zyx joint. The last three are chains of Prismatic and Revolute joints
with massless bodies between. (BallRpy has the angles of euler_zyx, but its velocity is the angular one.)

Armature is the rotor inertia of an actuator at gear ratio 1. Drake has actuators on one-dof joints only. Damping is never set. Inertias
skip Drake's validity check, so unphysical bodies are allowed.
"""

from __future__ import annotations

from collections.abc import Callable
from math import pi

import numpy as np
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody import tree
from pydrake.multibody.plant import MultibodyPlant

from featherbench_oracles.core.algebra import Array, skew
from featherbench_oracles.core.protocol import Unsupported
from featherbench_oracles.core.robot import Body, Description, Joint


def spatial_inertia(body: Body) -> tree.SpatialInertia:
    """Make Drake's inertia. It holds the unit inertia about the *body's origin*: G = I / m - [c]x^2.

    Parameters
    ----------
    body : Body
        The body.

    Returns
    -------
    tree.SpatialInertia
        Its inertia.

    Raises
    ------
    Unsupported
        If the body is massless and has a rotational inertia.
    """
    if body.mass == 0 and body.inertia.any():
        raise Unsupported(f"Drake cannot hold the rotational inertia of the massless body {body.name}")
    g = body.inertia / body.mass - skew(body.com) @ skew(body.com) if body.mass else np.zeros((3, 3))
    unit = tree.UnitInertia(g[0, 0], g[1, 1], g[2, 2], g[0, 1], g[0, 2], g[1, 2])
    return tree.SpatialInertia(body.mass, body.com, unit, skip_validity_check=True)


JointMaker = Callable[[str, tree.Frame, tree.Frame], tree.Joint]


def joint_chain(joint: Joint) -> list[JointMaker]:
    """List the Drake joints that make up a joint, from the parent outwards.

    Parameters
    ----------
    joint : Joint
        The joint.

    Returns
    -------
    list of callable
        Each makes a joint from its name and its two frames.
    """

    def turn(axis: Array) -> JointMaker:
        return lambda name, parent, child: tree.RevoluteJoint(name, parent, child, axis)

    def slide(axis: Array) -> JointMaker:
        return lambda name, parent, child: tree.PrismaticJoint(name, parent, child, axis)

    x, y, z = np.eye(3)
    chains: dict[str, list[JointMaker]] = {
        "revolute": [turn(joint.axis)],
        "prismatic": [slide(joint.axis)],
        "helical": [lambda name, parent, child: tree.ScrewJoint(name, parent, child, joint.axis, 2 * pi * joint.pitch, 0.0)],
        "spherical": [tree.BallRpyJoint],
        "free": [tree.QuaternionFloatingJoint],
        "planar": [tree.PlanarJoint],
        "universal": [tree.UniversalJoint],
        "translation": [slide(x), slide(y), slide(z)],
        "cylindrical": [turn(joint.axis), slide(joint.axis)],
        "euler_zyx": [turn(z), turn(y), turn(x)],
    }
    return chains[joint.type]


def build(
    robot: Description, time_step: float = 0.0, add: Callable[[MultibodyPlant, list[list[tree.Joint]]], None] | None = None
) -> tuple[MultibodyPlant, list[list[tree.Joint]]]:
    """Build the plant of a description.

    Parameters
    ----------
    robot : Description
        The robot.
    time_step : float
        The step of a discrete plant, s; zero makes a continuous one.
    add : callable, optional
        Adds to the plant, before it is finalized. It gets the chains too.

    Returns
    -------
    plant : MultibodyPlant
        The robot.
    chains : list of list of Joint
        For each body its joint, or the joints that form it.

    Raises
    ------
    Unsupported
        If Drake has no such robot.
    """
    plant = MultibodyPlant(time_step)
    plant.mutable_gravity_field().set_gravity_vector(robot.gravity)
    chains: list[list[tree.Joint]] = []
    for i, body in enumerate(robot.bodies):
        parent = chains[body.parent][-1].child_body() if body.parent >= 0 else plant.world_body()
        chains.append(_add(plant, i, body, parent))
    if add is not None:
        add(plant, chains)
    plant.Finalize()
    return plant, chains


def _add(plant: MultibodyPlant, i: int, body: Body, parent: tree.RigidBody) -> list[tree.Joint]:
    """Add body i and its joint."""
    joint = body.joint
    placement = RigidTransform(RotationMatrix(joint.rotation), joint.translation)
    frame = plant.AddFrame(tree.FixedOffsetFrame(f"frame {i}", parent.body_frame(), placement))
    makers = joint_chain(joint)
    if joint.armature.any() and len(joint.armature) > len(makers):
        raise Unsupported(f"Drake has no armature on its {joint.type} joint ({joint.name}), which has several degrees of freedom")
    chain: list[tree.Joint] = []
    for k, make in enumerate(makers, start=1):
        name, inertia = (f"{i}: {body.name}", spatial_inertia(body)) if k == len(makers) else (f"{i}.{k}", tree.SpatialInertia.Zero())
        moved = plant.AddRigidBody(name, inertia)
        chain.append(plant.AddJoint(make(f"joint {i}.{k}", frame, moved.body_frame())))
        frame = moved.body_frame()
    if joint.armature.any():
        for k, (part, armature) in enumerate(zip(chain, joint.armature, strict=True), start=1):
            actuator = plant.AddJointActuator(f"actuator {i}.{k}", part)
            actuator.set_default_rotor_inertia(armature)
            actuator.set_default_gear_ratio(1.0)
    return chain
