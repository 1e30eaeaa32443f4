"""The conventions of iDynTree. Each row of conventions.toml has a function of its name here, which yields claims."""

from __future__ import annotations

import idyntree.bindings as idt
import numpy as np
from numpy.typing import ArrayLike

from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.conventions import (
    ABOUT_ORIGIN,
    ALPHA,
    AXIS,
    COM,
    GRAVITY,
    MASS,
    MOMENTS,
    WRONG_R,
    WXYZ,
    A,
    Claims,
    P,
    R,
    V,
    W,
    X,
    about,
    claim,
)
from featherbench_oracles.idyntree.building import make_link, numbers, transform

STILL = np.zeros(6)


def idyntree_model(joint: idt.IJoint | None = None) -> idt.KinDynComputations:
    """One body: the base, or on a joint of a base that has no mass."""
    model = idt.Model()
    if joint is not None:
        model.addLink("base", make_link(0.0, np.zeros(3), np.zeros((3, 3))))
    model.addLink("body", make_link(MASS, COM, MOMENTS))
    if joint is not None:
        model.addJoint("joint", joint)
    robot = idt.KinDynComputations()
    robot.loadRobotModel(model)
    return robot


def idyntree_set(
    robot: idt.KinDynComputations, q: ArrayLike, v: ArrayLike, twist: Array = STILL, place: idt.Transform | None = None
) -> None:
    """Set the state of joints and base."""
    robot.setRobotState(
        place or transform(np.eye(3), np.zeros(3)),
        idt.VectorDynSize.FromPython(np.asarray(q, float).tolist()),
        idt.Twist.FromPython(twist.tolist()),
        idt.VectorDynSize.FromPython(np.asarray(v, float).tolist()),
        idt.Vector3.FromPython(GRAVITY.tolist()),
    )


def turning() -> idt.KinDynComputations:
    """A body on a hinge through its origin."""
    place = transform(np.eye(3), np.zeros(3))
    return idyntree_model(idt.RevoluteJoint(0, 1, place, idt.Axis(idt.Direction(*AXIS), idt.Position(0, 0, 0))))


def ball(place: idt.Transform) -> idt.KinDynComputations:
    """A body on a spherical joint."""
    joint = idt.SphericalJoint(place)
    joint.setAttachedLinks(0, 1)
    joint.setJointCenter(0, place.getPosition())
    return idyntree_model(joint)


def forces(robot: idt.KinDynComputations) -> Array:
    """The generalised bias force: six rows of the base, then the joints'."""
    held = idt.FreeFloatingGeneralizedTorques(robot.model())
    robot.generalizedBiasForces(held)
    return np.append(numbers(held.baseWrench()), numbers(held.jointTorques()))


def idyntree_free_q() -> Claims:
    """A homogeneous matrix takes points of the base to the world."""
    robot = idyntree_model()
    idyntree_set(robot, [], [], STILL, transform(R, P))
    held = robot.getWorldTransform(0)
    yield claim(numbers(held.getRotation()), R, R.T)
    yield claim(numbers(held.getPosition()), P, R @ P)


def idyntree_free_v() -> Claims:
    """[linear; angular], both in world axes: the mixed representation, which is the default."""
    robot = idyntree_model()
    idyntree_set(robot, [], [], np.append(V, W), transform(R, P))
    robot.setFrameVelocityRepresentation(idt.BODY_FIXED_REPRESENTATION)
    yield claim(numbers(robot.getFrameVel(0)), np.append(R.T @ V, R.T @ W), np.append(V, W), np.append(R.T @ W, R.T @ V))


def idyntree_free_a() -> Claims:
    """The derivative of the numbers in v: linear is the classical acceleration."""
    robot, wrenches, held = idyntree_model(), idt.LinkWrenches(), idt.FreeFloatingGeneralizedTorques()
    wrenches.resize(robot.model())
    held.resize(robot.model())
    idyntree_set(robot, [], [], np.append(V, W), transform(np.eye(3), P))
    robot.inverseDynamics(idt.Vector6.FromPython([*A, *ALPHA]), idt.VectorDynSize(0), wrenches, held)
    center = A + np.cross(ALPHA, COM) + np.cross(W, np.cross(W, COM)) - GRAVITY
    yield claim(numbers(held.baseWrench())[:3], MASS * center, MASS * (center + np.cross(W, V)))


def idyntree_spherical_q() -> Claims:
    """The quaternion (w, x, y, z)."""
    robot = ball(transform(np.eye(3), np.zeros(3)))
    idyntree_set(robot, WXYZ, np.zeros(3))
    yield claim(numbers(robot.getWorldTransform(1).getRotation()), R, R.T, WRONG_R)


def idyntree_spherical_v() -> Claims:
    """Angular velocity in body axes, whatever the joint's frame is; the header of SphericalJoint says those of the parent."""
    turn = about(AXIS, 0.8)
    robot = ball(transform(turn, P))
    idyntree_set(robot, WXYZ, W)
    yield claim(numbers(robot.getFrameVel(1))[3:], turn @ R @ W, turn @ W, W, R @ W)


def idyntree_gravity() -> Claims:
    """SetRobotState takes the acceleration of free fall; the bias force contains it."""
    place = transform(np.eye(3), np.zeros(3))
    robot = idyntree_model(idt.PrismaticJoint(0, 1, place, idt.Axis(idt.Direction(*X), idt.Position(0, 0, 0))))
    idyntree_set(robot, [0.0], [0.0])
    yield claim(forces(robot)[6:], [-MASS * GRAVITY[0]], [MASS * GRAVITY[0]], [0.0])


def idyntree_inertia() -> Claims:
    """FromRotationalInertiaWrtCenterOfMass takes I about the centre of mass."""
    robot, mass = turning(), idt.MatrixDynSize()
    idyntree_set(robot, [0.3], [0.0])
    robot.getFreeFloatingMassMatrix(mass)
    yield claim(numbers(mass)[6, 6], AXIS @ ABOUT_ORIGIN @ AXIS, AXIS @ MOMENTS @ AXIS)


def idyntree_wrench() -> Claims:
    """[force; moment] on a link in world axes at the link's origin, in the mixed representation. Its work is subtracted."""
    robot, wrenches, held = turning(), idt.LinkWrenches(), idt.FreeFloatingGeneralizedTorques()
    found = []
    for wrench in (np.zeros(6), np.append(V, ALPHA)):
        wrenches.resize(robot.model())
        held.resize(robot.model())
        wrenches[1] = idt.Wrench.FromPython(wrench.tolist())
        idyntree_set(robot, [0.7], [0.0])
        robot.inverseDynamics(idt.Vector6.FromPython([0.0] * 6), idt.VectorDynSize.FromPython([0.0]), wrenches, held)
        found.append(numbers(held.jointTorques()))
    yield claim(found[1] - found[0], [-AXIS @ ALPHA], [AXIS @ ALPHA], [-AXIS @ V])


def idyntree_body_acceleration() -> Claims:
    """GetFrameAcc is the derivative of getFrameVel, [linear; angular], without gravity."""
    robot = turning()
    idyntree_set(robot, [0.7], [1.3])
    held = robot.getFrameAcc(1, idt.Vector6.FromPython([0.0] * 6), idt.VectorDynSize.FromPython([0.4]))
    yield claim(numbers(held), [0, 0, 0, *(0.4 * AXIS)], [*(0.4 * AXIS), 0, 0, 0], [*-GRAVITY, *(0.4 * AXIS)])


def idyntree_order_of_dofs() -> Claims:
    """Six rows of the base first, also where it stands, then the joints in the order in which they were added."""
    robot = turning()
    idyntree_set(robot, [0.3], [0.0])
    mass = idt.MatrixDynSize()
    robot.getFreeFloatingMassMatrix(mass)
    yield claim(numbers(mass).shape, [7, 7], [1, 1])


def idyntree_damping() -> Claims:
    """Left out of the bias force and of M."""
    found = []
    for damping in (0.0, 0.7):
        joint = idt.RevoluteJoint(0, 1, transform(np.eye(3), np.zeros(3)), idt.Axis(idt.Direction(*AXIS), idt.Position(0, 0, 0)))
        joint.setJointDynamicsType(idt.URDFJointDynamics)
        joint.setDamping(0, damping)
        robot, mass = idyntree_model(joint), idt.MatrixDynSize()
        idyntree_set(robot, [0.3], [2.0])
        robot.getFreeFloatingMassMatrix(mass)
        found.append(np.append(forces(robot)[6:], numbers(mass)[6, 6]))
    yield claim(found[1], found[0], found[0] + [1.4, 0.0])
