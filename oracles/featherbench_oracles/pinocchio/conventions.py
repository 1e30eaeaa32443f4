"""The conventions of Pinocchio. Each row of conventions.toml has a function of its name here, which yields claims."""

from __future__ import annotations

from math import cos, pi, sin

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from featherbench_oracles.core.algebra import skew
from featherbench_oracles.core.conventions import (
    ABOUT_ORIGIN,
    ALPHA,
    AXIS,
    COM,
    GRAVITY,
    MASS,
    MOMENTS,
    WRONG_R,
    XYZW,
    A,
    Claims,
    P,
    R,
    V,
    W,
    X,
    Y,
    Z,
    about,
    claim,
)


def pin_robot(*joints: pin.JointModel) -> tuple[pin.Model, pin.Data]:
    """Joints in a row, the last with a body."""
    model = pin.Model()
    parent = 0
    for k, joint in enumerate(joints):
        parent = model.addJoint(parent, joint, pin.SE3.Identity(), f"j{k}")
    model.appendBodyToJoint(parent, pin.Inertia(MASS, COM, MOMENTS), pin.SE3.Identity())
    model.gravity = pin.Motion(GRAVITY, np.zeros(3))
    return model, model.createData()


def pin_pose(joint: pin.JointModel, q: ArrayLike) -> pin.SE3:
    """Where the joint's body is."""
    model, data = pin_robot(joint)
    pin.forwardKinematics(model, data, np.asarray(q, float))
    return data.oMi[1]


def pin_velocity(joint: pin.JointModel, q: ArrayLike, v: ArrayLike) -> pin.Motion:
    """The velocity of the body at its origin, in world axes."""
    model, data = pin_robot(joint)
    pin.forwardKinematics(model, data, np.asarray(q, float), np.asarray(v, float))
    return pin.getVelocity(model, data, 1, pin.LOCAL_WORLD_ALIGNED)


def pinocchio_free_q() -> Claims:
    """Origin, then the quaternion x, y, z, w."""
    pose = pin_pose(pin.JointModelFreeFlyer(), [*P, *XYZW])
    yield claim(pose.rotation, R, WRONG_R, R.T)
    yield claim(pose.translation, P, R @ P)


def pinocchio_free_v() -> Claims:
    """[linear; angular], both in body axes."""
    velocity = pin_velocity(pin.JointModelFreeFlyer(), [*P, *XYZW], [*V, *W])
    yield claim(velocity.linear, R @ V, V, R @ W)
    yield claim(velocity.angular, R @ W, W, R @ V)


def pinocchio_free_a() -> Claims:
    """The derivative of the numbers in v: the classical acceleration has ω × v more."""
    model, data = pin_robot(pin.JointModelFreeFlyer())
    pin.forwardKinematics(model, data, np.append(P, XYZW), np.append(V, W), np.append(A, ALPHA))
    classical = pin.getClassicalAcceleration(model, data, 1, pin.LOCAL_WORLD_ALIGNED)
    yield claim(classical.linear, R @ (A + np.cross(W, V)), R @ A, A)


def pinocchio_spherical_q() -> Claims:
    """The quaternion x, y, z, w."""
    yield claim(pin_pose(pin.JointModelSpherical(), XYZW).rotation, R, WRONG_R, R.T)


def pinocchio_spherical_v() -> Claims:
    """Angular velocity in body axes."""
    yield claim(pin_velocity(pin.JointModelSpherical(), XYZW, W).angular, R @ W, W)


def pinocchio_planar_q() -> Claims:
    """x, y, cos θ, sin θ; the translation is not turned."""
    pose = pin_pose(pin.JointModelPlanar(), [0.4, -0.3, cos(0.7), sin(0.7)])
    yield claim(pose.rotation, about(Z, 0.7), about(Z, pi / 2 - 0.7))
    yield claim(pose.translation, [0.4, -0.3, 0], about(Z, 0.7) @ [0.4, -0.3, 0])


def pinocchio_planar_v() -> Claims:
    """ẋ and ẏ in body axes."""
    velocity = pin_velocity(pin.JointModelPlanar(), [0.4, -0.3, cos(0.7), sin(0.7)], [0.5, 0.9, 1.3])
    yield claim(velocity.linear, about(Z, 0.7) @ [0.5, 0.9, 0], [0.5, 0.9, 0])


def pinocchio_universal() -> Claims:
    """About the first axis, then about the moved second one."""
    pose = pin_pose(pin.JointModelUniversal(X, Y), [0.4, 1.1])
    yield claim(pose.rotation, about(X, 0.4) @ about(Y, 1.1), about(Y, 1.1) @ about(X, 0.4))


def pinocchio_helical_pitch() -> Claims:
    """Metres per radian."""
    pose = pin_pose(pin.JointModelHelicalUnaligned(AXIS, 0.3), [1.2])
    yield claim(pose.translation, 0.3 * 1.2 * AXIS, 0.3 * 1.2 / (2 * pi) * AXIS)


def pinocchio_continuous() -> Claims:
    """An unbounded revolute joint has two numbers, cosine and sine."""
    assert (pin.JointModelRUBX().nq, pin.JointModelRX().nq) == (2, 1)
    yield claim(pin_pose(pin.JointModelRUBX(), [cos(0.7), sin(0.7)]).rotation, about(X, 0.7), about(X, pi / 2 - 0.7))


def pinocchio_armature() -> Claims:
    """Part of crba, rnea and aba; rotor inertia and gear ratio are ignored."""
    model, data = pin_robot(pin.JointModelRevoluteUnaligned(AXIS))
    model.armature = np.array([0.5])
    model.rotorInertia, model.rotorGearRatio = np.array([3.0]), np.array([7.0])
    body = AXIS @ ABOUT_ORIGIN @ AXIS
    q, v = np.array([0.3]), np.zeros(1)
    yield claim(pin.crba(model, data, q), [[body + 0.5]], [[body]], [[body + 0.5 + 3 * 49]])
    pull = pin.rnea(model, data, q, v, np.zeros(1))
    yield claim(pin.rnea(model, data, q, v, np.ones(1)) - pull, [body + 0.5], [body])
    yield claim(pin.aba(model, data, q, v, pull + 1), [1 / (body + 0.5)], [1 / body])


def pinocchio_kinetic_energy() -> Claims:
    """ComputeKineticEnergy has the armature of RX, and not of the same joint about a skew axis."""
    for joint, axis, counted in ((pin.JointModelRX(), X, 0.5), (pin.JointModelRevoluteUnaligned(AXIS), AXIS, 0.0)):
        model, data = pin_robot(joint)
        model.armature = np.array([0.5])
        body = axis @ ABOUT_ORIGIN @ axis
        energy = pin.computeKineticEnergy(model, data, np.array([0.3]), np.array([2.0]))
        yield claim(energy, 2 * (body + counted), 2 * (body + 0.5 - counted))


def pinocchio_damping() -> Claims:
    """Damping and friction are ignored by rnea and aba."""
    model, data = pin_robot(pin.JointModelRevoluteUnaligned(AXIS))
    q, v, a = np.array([0.3]), np.array([2.0]), np.array([0.4])
    before = pin.rnea(model, data, q, v, a).copy(), pin.aba(model, data, q, v, a).copy()
    model.damping, model.friction = np.array([0.7]), np.array([0.9])
    yield claim(pin.rnea(model, data, q, v, a), before[0], before[0] + 1.4, before[0] + 0.9, before[0] + 2.3)
    body = AXIS @ ABOUT_ORIGIN @ AXIS
    yield claim(pin.aba(model, data, q, v, a), before[1], before[1] - 1.4 / body, before[1] - 0.9 / body)


def pinocchio_gravity() -> Claims:
    """model.gravity is the acceleration of free fall; rnea contains it."""
    model, data = pin_robot(pin.JointModelPX())
    still = pin.rnea(model, data, np.zeros(1), np.zeros(1), np.zeros(1))
    yield claim(still, [-MASS * GRAVITY[0]], [MASS * GRAVITY[0]], [0.0])


def pinocchio_mass_matrix() -> Claims:
    """The Python function crba fills both triangles, in both conventions."""
    model, data = pin_robot(pin.JointModelRX(), pin.JointModelRZ())
    for convention in (pin.Convention.LOCAL, pin.Convention.WORLD):
        data.M[:] = 77.0
        mass = pin.crba(model, data, np.array([0.3, 0.8]), convention)
        yield claim(mass, mass.T, np.triu(mass), np.tril(mass), [[mass[0, 0], mass[0, 1]], [77.0, mass[1, 1]]])


def pinocchio_order() -> Claims:
    """Degrees of freedom come as joints were added; added breadth-first, crba is wrong and only `check` says so."""
    model = pin.Model()
    roots = [model.addJoint(0, pin.JointModelRY(), pin.SE3.Identity(), name) for name in "ab"]
    tips = [model.addJoint(root, pin.JointModelRX(), pin.SE3(np.eye(3), P), f"{root}") for root in roots]
    for joint in (*roots, *tips):
        model.appendBodyToJoint(joint, pin.Inertia(MASS, COM, MOMENTS), pin.SE3.Identity())
    data, q, none = model.createData(), np.array([0.3, 0.8, -0.4, 1.1]), np.zeros(4)
    assert not model.check(data)
    still = pin.rnea(model, data, q, none, none).copy()
    columns = np.array([pin.rnea(model, data, q, none, unit) - still for unit in np.eye(4)]).T
    upper = np.triu(pin.crba(model, data, q))
    yield claim(columns[0, 2], columns[2, 0], upper[0, 2])


def pinocchio_six_vectors() -> Claims:
    """Motions, forces and Jacobians begin with the linear part; LOCAL_WORLD_ALIGNED is at the body's origin, WORLD at the world's."""
    model, data = pin_robot(pin.JointModelFreeFlyer())
    q, v = np.append(P, XYZW), np.append(V, W)
    pin.computeJointJacobians(model, data, q)
    aligned = pin.getJointJacobian(model, data, 1, pin.LOCAL_WORLD_ALIGNED) @ v
    yield claim(aligned, [*(R @ V), *(R @ W)], [*(R @ W), *(R @ V)])
    world = pin.getJointJacobian(model, data, 1, pin.WORLD) @ v
    yield claim(world, [*(R @ V + np.cross(P, R @ W)), *(R @ W)], aligned)


def pinocchio_inertia() -> Claims:
    """Inertia(m, c, I) takes I about the centre of mass."""
    model, data = pin_robot(pin.JointModelRX())
    yield claim(pin.crba(model, data, np.zeros(1)), [[ABOUT_ORIGIN[0, 0]]], [[MOMENTS[0, 0]]])


def pinocchio_derivative_by_q() -> Claims:
    """Along v, as pin.integrate moves: a turn about body axis k takes gravity in body axes u to u - e_k x u, and the force -m u with it."""
    model, data = pin_robot(pin.JointModelFreeFlyer())
    zero = np.zeros(6)
    by_q = pin.computeRNEADerivatives(model, data, np.append(P, XYZW), zero, zero)[0]
    body_axes, world_axes = -MASS * skew(R.T @ GRAVITY), -MASS * R.T @ skew(GRAVITY)
    yield claim(by_q[:3, 3:], body_axes, world_axes, body_axes.T)


def pinocchio_regressor() -> Claims:
    """Inertias stand as xx, xy, yy, xz, yz, zz, behind mass and first moments: the x component of I alpha."""
    model, data = pin_robot(pin.JointModelFreeFlyer())
    regressor = pin.computeJointTorqueRegressor(model, data, np.append(P, XYZW), np.zeros(6), np.append(np.zeros(3), ALPHA))
    x, y, z = ALPHA
    yield claim(regressor[3, 4:], [x, y, 0, z, 0, 0], [x, y, z, 0, 0, 0])
