"""The robot, built with the calls of a `Model`.

Joints are iDynTree's RevoluteJoint, PrismaticJoint and SphericalJoint. A robot that floats has its root as the floating base. Another has a
base of its own, which has no mass and stands still. iDynTree has no armature.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import idyntree.bindings as idt
import numpy as np

from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.protocol import Unsupported
from featherbench_oracles.core.reading import Place
from featherbench_oracles.core.robot import Description, Joint
from featherbench_oracles.idyntree.coordinates import floats


@dataclass(frozen=True)
class Built:
    """A model, and where the bodies of the description are.

    Attributes
    ----------
    model : idt.Model
        The robot.
    links : list of int
        The link that each body is.
    joints : list of idt.IJoint
        The joint of each body, without a free one.
    stands : Place
        Where the base of a robot stands that does not float.
    """

    model: idt.Model
    links: list[int]
    joints: list[idt.IJoint]
    stands: Place


def build(robot: Description) -> Built:
    """Build the model of a description.

    Parameters
    ----------
    robot : Description
        The robot.

    Returns
    -------
    Built
        The robot.

    Raises
    ------
    Unsupported
        If iDynTree has no such robot.
    """
    model = idt.Model()
    links = []
    if not floats(robot):
        model.addLink("world", make_link(0.0, np.zeros(3), np.zeros((3, 3))))
    for k, body in enumerate(robot.bodies):
        joint = body.joint
        if joint.armature.any():
            raise Unsupported(f"iDynTree has no armature (joint {joint.name})")
        if joint.type == "free" and k > 0:
            raise Unsupported(f"iDynTree's floating base is the root, and joint {joint.name} is another free joint")
        if floats(robot) and k > 0 and body.parent < 0:
            raise Unsupported(f"iDynTree has one floating base, and body {body.name} is on the world")
        links.append(model.addLink(f"body {k}", make_link(body.mass, body.com, body.inertia)))
        if joint.type != "free":
            model.addJoint(f"joint {k}", make_joint(joint, links[body.parent] if body.parent >= 0 else 0, links[k]))
    model.setDefaultBaseLink(0)
    return Built(model, links, [model.getJoint(k) for k in range(model.getNrOfJoints())], Place())


def numbers(held: Any) -> Array:
    """Copy the numbers of one of iDynTree's vectors or matrices. `toNumPy` shows its memory, which may be gone with it."""
    return np.array(held.toNumPy())


def transform(rotation: Array, translation: Array) -> idt.Transform:
    """Make iDynTree's placement."""
    return idt.Transform(idt.Rotation.FromPython(rotation.tolist()), idt.Position.FromPython(translation.tolist()))


def make_joint(joint: Joint, parent: int, child: int) -> idt.IJoint:
    """Make iDynTree's joint of the description's type between two links.

    Raises
    ------
    Unsupported
        If iDynTree has no such joint.
    """
    place = transform(joint.rotation, joint.translation)
    if joint.type == "spherical":
        made = idt.SphericalJoint(place)
        made.setAttachedLinks(parent, child)
        made.setJointCenter(parent, idt.Position.FromPython(joint.translation.tolist()))
        return made
    kinds = {"revolute": idt.RevoluteJoint, "prismatic": idt.PrismaticJoint}
    if joint.type not in kinds:
        raise Unsupported(f"iDynTree has no {joint.type} joint")
    direction = idt.Direction(*(joint.rotation @ joint.axis))
    return kinds[joint.type](parent, child, place, idt.Axis(direction, idt.Position.FromPython(joint.translation.tolist())))


def make_link(mass: float, com: Array, inertia: Array) -> idt.Link:
    """Make iDynTree's link; what is not set of one has any numbers."""
    made, held = idt.Link(), idt.SpatialInertia()
    held.fromRotationalInertiaWrtCenterOfMass(mass, idt.Position.FromPython(com.tolist()), idt.RotationalInertia(inertia))
    made.setInertia(held)
    return made
