"""The robot, built with `MjSpec`.

Joints of several degrees of freedom are slides and hinges in one body, in the order of the neutral coordinates:

::

    joint        MuJoCo's joints
    planar       slide x, slide y, hinge z
    universal    hinge x, hinge y
    translation  slide x, slide y, slide z
    cylindrical  hinge, slide
    euler_zyx    hinge z, hinge y, hinge x
    helical      none

Settings of the compiler keep it from edits. Inertias are given by principal axes. MuJoCo's own diagonalisation of a full inertia leaves a
quaternion whose length is 3e-15 off one, and drops the axes where no centre of mass was set. Damping, dry friction, limits, contacts and
actuators are never set, and constraints are disabled. So qfrc_passive is zero.

The compiler rejects a massless or unphysical moving body. Its message is the reason given. One kind of massless body is allowed: one whose
only child has the same axes, as in the description of an MJCF body with several joints. Such a body is folded into its child, as a joint of
one body. MuJoCo then lacks the body, so quantities of every body are unsupported.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from itertools import pairwise

import mujoco as mj
import numpy as np

from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.protocol import Unsupported
from featherbench_oracles.core.robot import Body, Description, Joint
from featherbench_oracles.mujoco.coordinates import wxyz

HINGE, SLIDE, BALL, FREE = mj.mjtJoint.mjJNT_HINGE, mj.mjtJoint.mjJNT_SLIDE, mj.mjtJoint.mjJNT_BALL, mj.mjtJoint.mjJNT_FREE
X, Y, Z = np.eye(3)


def empty_spec(robot: Description) -> mj.MjSpec:
    """Make a spec without edits, constraints, contacts, fluid and automatic resets.

    Parameters
    ----------
    robot : Description
        The robot.

    Returns
    -------
    mj.MjSpec
        With the robot's gravity.
    """
    spec = mj.MjSpec()
    compiler, option = spec.compiler, spec.option
    compiler.degree = compiler.autolimits = compiler.balanceinertia = compiler.fusestatic = compiler.alignfree = False
    compiler.boundmass = compiler.boundinertia = 0
    compiler.settotalmass = -1
    compiler.inertiafromgeom = mj.mjtInertiaFromGeom.mjINERTIAFROMGEOM_FALSE
    disable = mj.mjtDisableBit
    option.disableflags = disable.mjDSBL_CONSTRAINT | disable.mjDSBL_CONTACT | disable.mjDSBL_AUTORESET
    option.gravity = robot.gravity
    return spec


def principal(inertia: Array) -> tuple[Array, Array]:
    """Compute principal moments and axes. A diagonal inertia keeps the body's own axes.

    MuJoCo takes inertial axes within 1e-6 of the body's for the body's. So axes close to the body's are given in another order.

    Parameters
    ----------
    inertia : ndarray, shape (3, 3)
        About the centre of mass, kg m².

    Returns
    -------
    moments : ndarray, shape (3,)
        Principal moments, kg m².
    axes : ndarray, shape (3, 3)
        A rotation, whose columns are the axes.
    """
    moments = np.diag(inertia)
    if (np.diag(moments) == inertia).all():
        return moments, np.eye(3)
    moments, axes = np.linalg.eigh(inertia)
    axes = axes * np.sign(np.linalg.det(axes))
    if np.abs(axes - np.eye(3)).max() < 1e-5:
        return np.roll(moments, 1), np.roll(axes, 1, axis=1)
    return moments, axes


def chains(robot: Description) -> list[range]:
    """Find the chains of bodies that become one body of MuJoCo: a body, and the massless ones before it that are folded into it.

    Parameters
    ----------
    robot : Description
        The robot.

    Returns
    -------
    list of range
        The indices of the bodies of each chain.
    """
    children = Counter(body.parent for body in robot.bodies)
    ends = [i for i in range(len(robot.bodies)) if children[i] != 1 or not _folds(robot.bodies[i], robot.bodies[i + 1])]
    return [range(before + 1, end + 1) for before, end in pairwise([-1, *ends])]


def _folds(body: Body, child: Body) -> bool:
    """Whether a body is only a joint before its one child. The joints of one MuJoCo body have the same axes."""
    nothing = body.mass == 0 and not body.com.any() and not body.inertia.any()
    return nothing and (child.joint.rotation == np.eye(3)).all() and "free" not in (body.joint.type, child.joint.type)


def anchors(bodies: Sequence[Body]) -> list[Array]:
    """Compute the anchors of a chain's joints in the frame of its last body, at zero coordinates.

    Parameters
    ----------
    bodies : sequence of Body
        The chain.

    Returns
    -------
    list of ndarray, shape (3,)
        An anchor for each joint, m.
    """
    translations = [body.joint.translation for body in bodies[1:]]
    return [-sum(translations[k:], np.zeros(3)) for k in range(len(bodies))]


def add_body(parent: mj.MjsBody, bodies: Sequence[Body], index: int) -> mj.MjsBody:
    """Add a chain as one body with its joints.

    Parameters
    ----------
    parent : mj.MjsBody
        The parent body in MuJoCo.
    bodies : sequence of Body
        The chain.
    index : int
        The index of its last body.

    Returns
    -------
    mj.MjsBody
        The body.
    """
    body, first, places = bodies[-1], bodies[0].joint, anchors(bodies)
    position = first.translation - first.rotation @ places[0]
    child = parent.add_body(name=f"{index}: {body.name}", pos=position, quat=wxyz(first.rotation))
    child.explicitinertial = True
    child.mass, child.ipos = body.mass, body.com
    child.inertia, axes = principal(body.inertia)
    child.iquat = wxyz(axes)
    for joint, place in zip((part.joint for part in bodies), places, strict=True):
        for kind, axis in motions(joint):
            child.add_joint(type=kind, axis=axis, pos=place)
    return child


def motions(joint: Joint) -> list[tuple[mj.mjtJoint, Array]]:
    """List the MuJoCo joints that make up a joint.

    Parameters
    ----------
    joint : Joint
        The joint.

    Returns
    -------
    list of, shape (mjtJoint, ndarray)
        For each its type and its axis of shape (3,).
    """
    return {
        "revolute": [(HINGE, joint.axis)],
        "prismatic": [(SLIDE, joint.axis)],
        "spherical": [(BALL, Z)],
        "free": [(FREE, Z)],
        "planar": [(SLIDE, X), (SLIDE, Y), (HINGE, Z)],
        "universal": [(HINGE, X), (HINGE, Y)],
        "translation": [(SLIDE, X), (SLIDE, Y), (SLIDE, Z)],
        "cylindrical": [(HINGE, joint.axis), (SLIDE, joint.axis)],
        "euler_zyx": [(HINGE, Z), (HINGE, Y), (HINGE, X)],
    }[joint.type]


def refuse_unsupported(body: Body) -> None:
    """Check that MuJoCo has the joint of a body.

    Parameters
    ----------
    body : Body
        The joint's body.

    Raises
    ------
    Unsupported
        If MuJoCo has no such joint.
    """
    joint = body.joint
    if joint.type == "helical":
        raise Unsupported(f"MuJoCo has no helical joint ({joint.name})")
    if joint.type == "free" and body.parent >= 0:
        raise Unsupported(f"MuJoCo's free joint must hang on the world ({joint.name})")
    if joint.type == "free" and joint.armature[:3].any():
        raise Unsupported(f"MuJoCo's linear armature of free joint {joint.name} would act on world accelerations, not on body ones")


def build(robot: Description, add: Callable[[mj.MjSpec, dict[int, mj.MjsBody]], None] | None = None) -> mj.MjModel:
    """Build the model of a description.

    Parameters
    ----------
    robot : Description
        The robot.
    add : callable, optional
        Adds to the spec, before it is compiled. It gets MuJoCo's bodies by their index in the description; the world's is -1.

    Returns
    -------
    mj.MjModel
        The compiled model, with armature.

    Raises
    ------
    Unsupported
        If MuJoCo has no such joint, or its compiler rejects the model.
    """
    spec = empty_spec(robot)
    held = {-1: spec.worldbody}
    for chain in chains(robot):
        bodies = [robot.bodies[i] for i in chain]
        for body in bodies:
            refuse_unsupported(body)
        held[chain[-1]] = add_body(held[bodies[0].parent], bodies, chain[-1])
    if add is not None:
        add(spec, held)
    try:
        model = spec.compile()
    except ValueError as reason:
        raise Unsupported(f"MuJoCo refuses the model: {reason}") from reason
    if (model.body_dofadr[1:] != [robot.bodies[chain[0]].joint.v.start for chain in chains(robot)]).any():
        raise RuntimeError("MuJoCo put the degrees of freedom in another order")
    model.dof_armature = np.concatenate([body.joint.armature for body in robot.bodies])
    mj.mj_setConst(model, mj.MjData(model))  # MuJoCo caches constants that depend on armature
    return model
