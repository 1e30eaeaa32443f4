"""The conventions of Pinocchio."""

from __future__ import annotations

from math import cos, pi, sin

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from asking import A, ALPHA, AXIS, COM, GRAVITY, MASS, MOMENTS, P, R, V, W, WRONG_R, X, XYZW, Y, Z, about, about_origin, holds


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


def test_pinocchio_free_q() -> None:
    """Origin, then the quaternion x, y, z, w."""
    pose = pin_pose(pin.JointModelFreeFlyer(), [*P, *XYZW])
    holds(pose.rotation, R, WRONG_R, R.T)
    holds(pose.translation, P, R @ P)


def test_pinocchio_free_v() -> None:
    """[linear; angular], both in body axes."""
    velocity = pin_velocity(pin.JointModelFreeFlyer(), [*P, *XYZW], [*V, *W])
    holds(velocity.linear, R @ V, V, R @ W)
    holds(velocity.angular, R @ W, W, R @ V)


def test_pinocchio_free_a() -> None:
    """The derivative of the numbers in v: the classical acceleration has ω × v more."""
    model, data = pin_robot(pin.JointModelFreeFlyer())
    pin.forwardKinematics(model, data, np.append(P, XYZW), np.append(V, W), np.append(A, ALPHA))
    classical = pin.getClassicalAcceleration(model, data, 1, pin.LOCAL_WORLD_ALIGNED)
    holds(classical.linear, R @ (A + np.cross(W, V)), R @ A, A)


def test_pinocchio_spherical_q() -> None:
    """The quaternion x, y, z, w."""
    holds(pin_pose(pin.JointModelSpherical(), XYZW).rotation, R, WRONG_R, R.T)


def test_pinocchio_spherical_v() -> None:
    """Angular velocity in body axes."""
    holds(pin_velocity(pin.JointModelSpherical(), XYZW, W).angular, R @ W, W)


def test_pinocchio_planar_q() -> None:
    """x, y, cos θ, sin θ; the translation is not turned."""
    pose = pin_pose(pin.JointModelPlanar(), [0.4, -0.3, cos(0.7), sin(0.7)])
    holds(pose.rotation, about(Z, 0.7), about(Z, pi / 2 - 0.7))
    holds(pose.translation, [0.4, -0.3, 0], about(Z, 0.7) @ [0.4, -0.3, 0])


def test_pinocchio_planar_v() -> None:
    """ẋ and ẏ in body axes."""
    velocity = pin_velocity(pin.JointModelPlanar(), [0.4, -0.3, cos(0.7), sin(0.7)], [0.5, 0.9, 1.3])
    holds(velocity.linear, about(Z, 0.7) @ [0.5, 0.9, 0], [0.5, 0.9, 0])


def test_pinocchio_universal() -> None:
    """About the first axis, then about the moved second one."""
    pose = pin_pose(pin.JointModelUniversal(X, Y), [0.4, 1.1])
    holds(pose.rotation, about(X, 0.4) @ about(Y, 1.1), about(Y, 1.1) @ about(X, 0.4))


def test_pinocchio_helical_pitch() -> None:
    """Metres per radian."""
    pose = pin_pose(pin.JointModelHelicalUnaligned(AXIS, 0.3), [1.2])
    holds(pose.translation, 0.3 * 1.2 * AXIS, 0.3 * 1.2 / (2 * pi) * AXIS)


def test_pinocchio_continuous() -> None:
    """An unbounded revolute joint has two numbers, cosine and sine."""
    assert (pin.JointModelRUBX().nq, pin.JointModelRX().nq) == (2, 1)
    holds(pin_pose(pin.JointModelRUBX(), [cos(0.7), sin(0.7)]).rotation, about(X, 0.7), about(X, pi / 2 - 0.7))


def test_pinocchio_armature() -> None:
    """Part of crba, rnea and aba; rotor inertia and gear ratio are ignored."""
    model, data = pin_robot(pin.JointModelRevoluteUnaligned(AXIS))
    model.armature = np.array([0.5])
    model.rotorInertia, model.rotorGearRatio = np.array([3.0]), np.array([7.0])
    body = AXIS @ about_origin @ AXIS
    q, v = np.array([0.3]), np.zeros(1)
    holds(pin.crba(model, data, q), [[body + 0.5]], [[body]], [[body + 0.5 + 3 * 49]])
    pull = pin.rnea(model, data, q, v, np.zeros(1))
    holds(pin.rnea(model, data, q, v, np.ones(1)) - pull, [body + 0.5], [body])
    holds(pin.aba(model, data, q, v, pull + 1), [1 / (body + 0.5)], [1 / body])


def test_pinocchio_kinetic_energy() -> None:
    """computeKineticEnergy has the armature of RX, and not of the same joint about a skew axis."""
    for joint, axis, counted in ((pin.JointModelRX(), X, 0.5), (pin.JointModelRevoluteUnaligned(AXIS), AXIS, 0.0)):
        model, data = pin_robot(joint)
        model.armature = np.array([0.5])
        body = axis @ about_origin @ axis
        energy = pin.computeKineticEnergy(model, data, np.array([0.3]), np.array([2.0]))
        holds(energy, 2 * (body + counted), 2 * (body + 0.5 - counted))


def test_pinocchio_damping() -> None:
    """Damping and friction are ignored by rnea and aba."""
    model, data = pin_robot(pin.JointModelRevoluteUnaligned(AXIS))
    q, v, a = np.array([0.3]), np.array([2.0]), np.array([0.4])
    before = pin.rnea(model, data, q, v, a).copy(), pin.aba(model, data, q, v, a).copy()
    model.damping, model.friction = np.array([0.7]), np.array([0.9])
    holds(pin.rnea(model, data, q, v, a), before[0], before[0] + 1.4, before[0] + 0.9, before[0] + 2.3)
    body = AXIS @ about_origin @ AXIS
    holds(pin.aba(model, data, q, v, a), before[1], before[1] - 1.4 / body, before[1] - 0.9 / body)


def test_pinocchio_gravity() -> None:
    """model.gravity is the acceleration of free fall; rnea contains it."""
    model, data = pin_robot(pin.JointModelPX())
    still = pin.rnea(model, data, np.zeros(1), np.zeros(1), np.zeros(1))
    holds(still, [-MASS * GRAVITY[0]], [MASS * GRAVITY[0]], [0.0])


def test_pinocchio_mass_matrix() -> None:
    """The Python function crba fills both triangles, in both conventions."""
    model, data = pin_robot(pin.JointModelRX(), pin.JointModelRZ())
    for convention in (pin.Convention.LOCAL, pin.Convention.WORLD):
        data.M[:] = 77.0
        mass = pin.crba(model, data, np.array([0.3, 0.8]), convention)
        holds(mass, mass.T, np.triu(mass), np.tril(mass), [[mass[0, 0], mass[0, 1]], [77.0, mass[1, 1]]])


def test_pinocchio_order() -> None:
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
    holds(columns[0, 2], columns[2, 0], upper[0, 2])


def test_pinocchio_six_vectors() -> None:
    """Motions, forces and Jacobians begin with the linear part; LOCAL_WORLD_ALIGNED is at the body's origin, WORLD at the world's."""
    model, data = pin_robot(pin.JointModelFreeFlyer())
    q, v = np.append(P, XYZW), np.append(V, W)
    pin.computeJointJacobians(model, data, q)
    aligned = pin.getJointJacobian(model, data, 1, pin.LOCAL_WORLD_ALIGNED) @ v
    holds(aligned, [*(R @ V), *(R @ W)], [*(R @ W), *(R @ V)])
    world = pin.getJointJacobian(model, data, 1, pin.WORLD) @ v
    holds(world, [*(R @ V + np.cross(P, R @ W)), *(R @ W)], aligned)


def test_pinocchio_inertia() -> None:
    """Inertia(m, c, I) takes I about the centre of mass."""
    model, data = pin_robot(pin.JointModelRX())
    holds(pin.crba(model, data, np.zeros(1)), [[about_origin[0, 0]]], [[MOMENTS[0, 0]]])
