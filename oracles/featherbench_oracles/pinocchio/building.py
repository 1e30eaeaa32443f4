"""The robot, built with `pin.Model.addJoint` and `appendBodyToJoint`.

Joints are native: Revolute, Prismatic and Helical, in their aligned form (RX, PY, HZ, ...) where the axis is exactly a unit vector of the
frame and unaligned otherwise; Spherical, FreeFlyer, Planar, Universal(x, y), Translation, SphericalZYX; a cylindrical joint is a Composite
of a revolute and a prismatic one. Damping and dry friction are never set (rnea and aba would ignore them). Joints come depth-first, without
which crba is wrong silently; `model.check(data)` is asserted.
"""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.protocol import Unsupported
from featherbench_oracles.core.robot import Body, Description, Joint


def about_axis(kind: str, axis: Array, *pitch: float) -> pin.JointModel:
    """Make Pinocchio's joint of one degree of freedom about or along an axis.

    Parameters
    ----------
    kind : str
        The joint's type, capitalised.
    axis : ndarray, shape (3,)
        A unit vector.
    *pitch : float
        The pitch of a helical joint, m/rad.

    Returns
    -------
    pin.JointModel
        The aligned form where the axis is exactly a unit vector of the frame, the unaligned one otherwise.
    """
    for along, unit in zip("XYZ", np.eye(3), strict=True):
        if (axis == unit).all():
            return getattr(pin, f"JointModel{kind[0]}{along}")(*pitch)
    return getattr(pin, f"JointModel{kind}Unaligned")(axis, *pitch)


def joint_model(joint: Joint) -> pin.JointModel:
    """Make Pinocchio's joint of the description's type.

    Parameters
    ----------
    joint : Joint
        The joint.

    Returns
    -------
    pin.JointModel
        Its model.
    """
    if joint.type == "cylindrical":
        composite = pin.JointModelComposite(2)
        for kind in ("Revolute", "Prismatic"):
            composite.addJoint(about_axis(kind, joint.axis), pin.SE3.Identity())
        return composite
    if joint.axis.any():
        return about_axis(joint.type.capitalize(), joint.axis, *([joint.pitch] if joint.type == "helical" else []))
    if joint.type == "universal":
        return pin.JointModelUniversal(*np.eye(3)[:2])
    makers = {
        "spherical": pin.JointModelSpherical,
        "free": pin.JointModelFreeFlyer,
        "planar": pin.JointModelPlanar,
        "translation": pin.JointModelTranslation,
        "euler_zyx": pin.JointModelSphericalZYX,
    }
    return makers[joint.type]()


def spatial_inertia(body: Body) -> pin.Inertia:
    """Set an inertia part by part. The constructor rejects an indefinite inertia; the algorithms compute with it.

    Parameters
    ----------
    body : Body
        The body.

    Returns
    -------
    pin.Inertia
        About the body's origin, with mass (kg), centre of mass (m) and inertia about it (kg m²).
    """
    inertia = pin.Inertia.Zero()
    inertia.mass, inertia.lever, inertia.inertia = body.mass, body.com, body.inertia
    return inertia


def build(robot: Description) -> pin.Model:
    """Build the model of a description.

    Parameters
    ----------
    robot : Description
        The robot.

    Returns
    -------
    pin.Model
        The model. Joint i + 1 carries body i.

    Raises
    ------
    Unsupported
        If a planar joint has linear armature.
    """
    model = pin.Model()
    model.gravity = pin.Motion(robot.gravity, np.zeros(3))
    for i, body in enumerate(robot.bodies):
        joint = body.joint
        if joint.type == "planar" and joint.armature[:2].any():
            raise Unsupported(f"Pinocchio's armature of planar joint {joint.name} would act in body axes, not in the joint frame's")
        placement = pin.SE3(joint.rotation, joint.translation)
        index = model.addJoint(body.parent + 1, joint_model(joint), placement, f"joint {i}")
        model.appendBodyToJoint(index, spatial_inertia(body), pin.SE3.Identity())
        if index != i + 1 or model.joints[index].idx_v != joint.v.start:
            raise RuntimeError(f"Pinocchio put joint {joint.name} elsewhere")
    model.armature = np.concatenate([b.joint.armature for b in robot.bodies])
    return model
