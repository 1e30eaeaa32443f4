"""The robot, built with a `ModelBuilder`.

Joints are Newton's revolute, prismatic, ball and free ones. Its repair of inertias is off as far as it can be. All numbers become single.
"""

from __future__ import annotations

import newton
import warp as wp

from featherbench_oracles.core.algebra import Array, quaternion
from featherbench_oracles.core.protocol import Unsupported
from featherbench_oracles.core.robot import Description, Joint

wp.config.log_level = 30  # warnings: its kernels' names are no news


def build(robot: Description) -> newton.Model:
    """Build the model of a description. Body k is Newton's body k, and joint k carries it.

    Parameters
    ----------
    robot : Description
        The robot.

    Returns
    -------
    newton.Model
        The robot.

    Raises
    ------
    Unsupported
        If Newton has no such robot.
    """
    builder = newton.ModelBuilder(gravity=tuple(robot.gravity.tolist()))
    builder.balance_inertia = False
    joints = []
    for k, body in enumerate(robot.bodies):
        if body.joint.type == "free" and k > 0:
            raise Unsupported(f"Newton's velocity of a free joint is that of a root, and joint {body.joint.name} is none")
        builder.add_link(
            mass=body.mass,
            com=tuple(body.com.tolist()),
            inertia=wp.mat33(*body.inertia.ravel().tolist()),
            label=f"body {k}",
            lock_inertia=True,
        )
        joints.append(add_joint(builder, body.joint, body.parent, k))
    if joints:
        builder.add_articulation(joints)
    return builder.finalize()


def transform(rotation: Array, translation: Array) -> wp.transform:
    """Make Newton's placement."""
    return wp.transform(wp.vec3(*translation.tolist()), wp.quat(*quaternion(rotation).tolist()))


def add_joint(builder: newton.ModelBuilder, joint: Joint, parent: int, child: int) -> int:
    """Add Newton's joint of the description's type.

    Raises
    ------
    Unsupported
        If Newton has no such joint, or not with this armature.
    """
    place = transform(joint.rotation, joint.translation)
    kinds = {"revolute": builder.add_joint_revolute, "prismatic": builder.add_joint_prismatic}
    if joint.type in kinds:
        axis = wp.vec3(*joint.axis.tolist())
        return kinds[joint.type](
            parent, child, parent_xform=place, axis=axis, armature=float(joint.armature[0]), target_ke=0.0, target_kd=0.0
        )
    if joint.armature.any():
        raise Unsupported(f"Newton has armature on joints of one degree of freedom (joint {joint.name})")
    if joint.type == "spherical":
        return builder.add_joint_ball(parent, child, parent_xform=place)
    if joint.type == "free":
        return builder.add_joint_free(child)  # with another frame its M is in that frame's axes, and its gravity in the world's
    raise Unsupported(f"Newton's {joint.type} joint is not asked for")
