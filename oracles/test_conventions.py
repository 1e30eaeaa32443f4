"""The conventions of the engines, asked of the engines themselves: one test for each row of conventions.toml.

    python oracles/test_conventions.py [-v] [ENGINE…]

Nothing here goes through our oracles. A test says what is measured, what it is by the convention, and what it would be otherwise; it fails
where the convention does not hold and also where the two could not be told apart. Without arguments all engines are asked.
"""

from __future__ import annotations

import sys
from math import cos, pi, sin

import numpy as np
from numpy.typing import ArrayLike, NDArray

sys.path.pop(0)  # this directory, whose files are called like the packages imported next
import dartpy  # noqa: E402
import mujoco as mj  # noqa: E402
import pinocchio as pin  # noqa: E402
from pydrake.math import RigidTransform, RotationMatrix  # noqa: E402
from pydrake.multibody import tree  # noqa: E402
from pydrake.multibody.plant import MultibodyPlant  # noqa: E402

Array = NDArray[np.float64]
CLOSE, APART = 1e-12, 1e-2  # rounding of numbers of size one; far below what any convention of these changes
asked = 0


def holds(measured: ArrayLike, convention: ArrayLike, *otherwise: ArrayLike) -> None:
    """The measured numbers are those of the convention, and not those of any other."""
    global asked
    asked += 1
    measured, convention = np.asarray(measured, float), np.asarray(convention, float)
    assert measured.shape == convention.shape, f"shape {measured.shape}, not {convention.shape}"
    gap = np.abs(measured - convention).max()
    assert gap <= CLOSE, f"measured {measured.tolist()}, by the convention {convention.tolist()}"
    assert otherwise, "a convention without an alternative says nothing"
    for other in otherwise:
        apart = np.abs(measured - np.asarray(other, float)).max()
        assert apart >= APART, f"the alternative {np.asarray(other).tolist()} fits as well"


# ---- what the tests share: one body, one joint, numbers in which nothing is symmetric

P, V, W = np.array([0.3, -0.5, 0.7]), np.array([0.4, -0.9, 0.2]), np.array([1.1, 0.6, -0.8])
A, ALPHA = np.array([-0.7, 0.3, 0.5]), np.array([0.2, -0.4, 0.9])
XYZW = np.array([0.1, -0.5, 0.7, 0.5])
MASS, COM, GRAVITY = 2.0, np.array([0.1, -0.2, 0.15]), np.array([1.3, -2.1, -9.2])
MOMENTS = np.array([[0.31, 0.02, -0.03], [0.02, 0.27, 0.04], [-0.03, 0.04, 0.22]])
AXIS = np.array([2.0, -1.0, 2.0]) / 3
X, Y, Z = np.eye(3)


def skew(u: Array) -> Array:
    """The matrix of u x."""
    return np.array([[0, -u[2], u[1]], [u[2], 0, -u[0]], [-u[1], u[0], 0]])


def about(axis: Array, angle: float) -> Array:
    """The rotation about a unit vector."""
    return np.eye(3) + sin(angle) * skew(axis) + (1 - cos(angle)) * skew(axis) @ skew(axis)


def rotation(xyzw: Array) -> Array:
    """R of a unit quaternion."""
    return about(xyzw[:3] / np.linalg.norm(xyzw[:3]), 2 * np.arctan2(np.linalg.norm(xyzw[:3]), xyzw[3]))


R = rotation(XYZW)
WRONG_R = rotation(np.roll(XYZW, -1))  # the four numbers taken for (w, x, y, z)
about_origin = MOMENTS - MASS * skew(COM) @ skew(COM)


# ---- Pinocchio


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


# ---- MuJoCo

HINGE, SLIDE, BALL, FREE = mj.mjtJoint.mjJNT_HINGE, mj.mjtJoint.mjJNT_SLIDE, mj.mjtJoint.mjJNT_BALL, mj.mjtJoint.mjJNT_FREE


def mj_robot(*joints: tuple[mj.mjtJoint, Array], damping: float = 0, armature: float = 0) -> tuple[mj.MjModel, mj.MjData]:
    """One body with these joints."""
    spec = mj.MjSpec()
    spec.compiler.degree = False
    spec.option.gravity = GRAVITY
    spec.option.disableflags = mj.mjtDisableBit.mjDSBL_CONSTRAINT
    body = spec.worldbody.add_body(name="body")
    body.explicitinertial = True
    body.mass, body.ipos = MASS, COM
    body.fullinertia = [*np.diag(MOMENTS), MOMENTS[0, 1], MOMENTS[0, 2], MOMENTS[1, 2]]
    for kind, axis in joints:
        joint = body.add_joint(type=kind, axis=axis)
        joint.armature = armature
        joint.damping[0] = damping
    model = spec.compile()
    return model, mj.MjData(model)


def mj_set(model: mj.MjModel, data: mj.MjData, q: ArrayLike, v: ArrayLike) -> None:
    """Sets the state and computes what depends on it."""
    data.qpos, data.qvel = q, v
    mj.mj_fwdPosition(model, data)
    mj.mj_fwdVelocity(model, data)


def mj_velocity(model: mj.MjModel, data: mj.MjData) -> Array:
    """[angular; linear] of the body at its origin, in world axes."""
    velocity = np.empty(6)
    mj.mj_objectVelocity(model, data, mj.mjtObj.mjOBJ_XBODY, 1, velocity, 0)
    return velocity


def mj_inverse(model: mj.MjModel, data: mj.MjData, a: ArrayLike) -> Array:
    """qfrc_inverse."""
    data.qacc = a
    mj.mj_inverse(model, data)
    return data.qfrc_inverse.copy()


WXYZ = np.roll(XYZW, 1)


def test_mujoco_free_q() -> None:
    """Origin, then the quaternion w, x, y, z."""
    model, data = mj_robot((FREE, Z))
    mj_set(model, data, [*P, *WXYZ], np.zeros(6))
    holds(data.xmat[1].reshape(3, 3), R, R.T, rotation(WXYZ))
    holds(data.xpos[1], P, R @ P)


def test_mujoco_free_v() -> None:
    """[linear; angular]: linear in world axes, angular in body axes."""
    model, data = mj_robot((FREE, Z))
    mj_set(model, data, [*P, *WXYZ], [*V, *W])
    velocity = mj_velocity(model, data)
    holds(velocity[3:], V, R @ V, W)
    holds(velocity[:3], R @ W, W)


def test_mujoco_free_a() -> None:
    """The derivative of the numbers in v: the linear part is the classical acceleration of the origin in world axes."""
    model, data = mj_robot((FREE, Z))
    mj_set(model, data, [*P, *WXYZ], [*V, *W])
    force = mj_inverse(model, data, [*A, *ALPHA])[:3]
    swing = R @ (np.cross(ALPHA, COM) + np.cross(W, np.cross(W, COM)))
    holds(force, MASS * (A - GRAVITY + swing), MASS * (A + np.cross(R @ W, V) - GRAVITY + swing), MASS * (R @ A - GRAVITY + swing))


def test_mujoco_free_placement() -> None:
    """A free joint's q is the pose in the world: the placement of its body is only where it begins."""
    spec = mj.MjSpec()
    body = spec.worldbody.add_body(name="body", pos=[5, 6, 7], mass=1, inertia=[1, 1, 1], explicitinertial=True)
    body.add_freejoint()
    model = spec.compile()
    data = mj.MjData(model)
    mj_set(model, data, [*P, *WXYZ], np.zeros(6))
    holds(data.xpos[1], P, P + [5, 6, 7])


def test_mujoco_spherical_q() -> None:
    """The quaternion w, x, y, z."""
    model, data = mj_robot((BALL, Z))
    mj_set(model, data, WXYZ, np.zeros(3))
    holds(data.xmat[1].reshape(3, 3), R, R.T, rotation(WXYZ))


def test_mujoco_spherical_v() -> None:
    """Angular velocity in body axes."""
    model, data = mj_robot((BALL, Z))
    mj_set(model, data, WXYZ, W)
    holds(mj_velocity(model, data)[:3], R @ W, W)


def test_mujoco_planar() -> None:
    """Slide x, slide y, hinge z in one body: the slides are not turned by the hinge behind them."""
    model, data = mj_robot((SLIDE, X), (SLIDE, Y), (HINGE, Z))
    mj_set(model, data, [0.4, -0.3, 0.7], [0.5, 0.9, 1.3])
    holds(data.xpos[1], [0.4, -0.3, 0], about(Z, 0.7) @ [0.4, -0.3, 0])
    holds(mj_velocity(model, data), [0, 0, 1.3, 0.5, 0.9, 0], [0, 0, 1.3, *(about(Z, 0.7) @ [0.5, 0.9, 0])])


def test_mujoco_universal() -> None:
    """Hinges in one body act in their order, the second about the moved axis."""
    model, data = mj_robot((HINGE, X), (HINGE, Y))
    mj_set(model, data, [0.4, 1.1], np.zeros(2))
    holds(data.xmat[1].reshape(3, 3), about(X, 0.4) @ about(Y, 1.1), about(Y, 1.1) @ about(X, 0.4))


def test_mujoco_helical() -> None:
    """There is none: four kinds of joints, and a hinge and a slide along one axis are two independent dofs."""
    assert sorted(kind.name for kind in mj.mjtJoint.__members__.values()) == ["mjJNT_BALL", "mjJNT_FREE", "mjJNT_HINGE", "mjJNT_SLIDE"]
    model, data = mj_robot((HINGE, X), (SLIDE, X))
    mj_set(model, data, [1.2, 0.0], np.zeros(2))
    holds(model.nv, 2, 1)
    holds(data.xpos[1], np.zeros(3), 1.2 * X)


def test_mujoco_armature() -> None:
    """Part of M and of mj_inverse, not of mj_rne."""
    model, data = mj_robot((HINGE, X), armature=0.5)
    body = about_origin[0, 0]
    mj_set(model, data, [0.3], [0.0])
    mass, rne, still = np.empty((1, 1)), np.empty(1), np.empty(1)
    mj.mj_fullM(model, data, mass)
    holds(mass, [[body + 0.5]], [[body]])
    holds(mj_inverse(model, data, [1.0]) - mj_inverse(model, data, [0.0]), [body + 0.5], [body])
    data.qacc = 1.0
    mj.mj_rne(model, data, 1, rne)
    mj.mj_rne(model, data, 0, still)
    holds(rne - still, [body], [body + 0.5])


def test_mujoco_damping() -> None:
    """A passive force: M a + h = qfrc_inverse + qfrc_passive."""
    plain, damped = mj_robot((HINGE, X)), mj_robot((HINGE, X), damping=0.7)
    for model, data in (plain, damped):
        mj_set(model, data, [0.3], [2.0])
    force = mj_inverse(*plain, [0.4])
    with_damping = mj_inverse(*damped, [0.4])
    holds(with_damping, force + 1.4, force)
    holds(with_damping + damped[1].qfrc_passive, force, force + 1.4)


def test_mujoco_gravity() -> None:
    """option.gravity is the acceleration of free fall; qfrc_bias contains it."""
    model, data = mj_robot((SLIDE, X))
    mj_set(model, data, [0.0], [0.0])
    holds(data.qfrc_bias, [-MASS * GRAVITY[0]], [MASS * GRAVITY[0]], [0.0])


def test_mujoco_body_acceleration() -> None:
    """mj_objectAcceleration contains −g: a body at rest accelerates upwards."""
    model, data = mj_robot((SLIDE, X))
    mj_set(model, data, [0.0], [0.0])
    data.qacc = 0.0
    mj.mj_rnePostConstraint(model, data)
    acceleration = np.empty(6)
    mj.mj_objectAcceleration(model, data, mj.mjtObj.mjOBJ_XBODY, 1, acceleration, 0)
    holds(acceleration[3:], -GRAVITY, np.zeros(3), GRAVITY)


def test_mujoco_mass_matrix() -> None:
    """MjData.M stores the lower triangle row by row, the diagonal last; mj_fullM fills both."""
    model, data = mj_robot((HINGE, X), (HINGE, Z))
    mj_set(model, data, [0.3, 0.8], np.zeros(2))
    mass = np.empty((2, 2))
    mj.mj_fullM(model, data, mass)
    holds(mass, mass.T, np.triu(mass), np.tril(mass))
    holds(data.M, [mass[0, 0], mass[1, 0], mass[1, 1]], [mass[0, 0], mass[1, 1], mass[1, 0]])


def test_mujoco_order() -> None:
    """Degrees of freedom are depth-first, whatever the order in which bodies were added."""
    spec = mj.MjSpec()
    parts = {}
    for name, parent in (("a", spec.worldbody), ("b", spec.worldbody)):
        parts[name] = parent.add_body(name=name, mass=1, inertia=[1, 1, 1], explicitinertial=True)
    parts["c"] = parts["a"].add_body(name="c", mass=1, inertia=[1, 1, 1], explicitinertial=True)
    for name, body in parts.items():
        body.add_joint(name=name, type=HINGE)
    model = spec.compile()
    holds([model.joint(name).dofadr[0] for name in "acb"], [0, 1, 2], [0, 2, 1])


def test_mujoco_six_vectors() -> None:
    """Velocities are [angular; linear], at the origin of the asked body; mj_jacBody gives the linear rows first."""
    model, data = mj_robot((FREE, Z))
    mj_set(model, data, [*P, *WXYZ], [*V, *W])
    holds(mj_velocity(model, data), [*(R @ W), *V], [*V, *(R @ W)])
    linear, angular = np.zeros((2, 3, 6))
    mj.mj_jacBody(model, data, linear, angular, 1)
    holds(linear @ data.qvel, V, R @ W)
    holds(angular @ data.qvel, R @ W, V)


def test_mujoco_wrench() -> None:
    """xfrc_applied is [force; torque] in world axes about the centre of mass; mj_inverse does not look at it."""
    model, data = mj_robot((FREE, Z))
    mj_set(model, data, [*P, *WXYZ], np.zeros(6))
    before = mj_inverse(model, data, np.zeros(6))
    data.xfrc_applied[1] = [*A, *ALPHA]
    holds(mj_inverse(model, data, np.zeros(6)), before, before - np.append(A, R.T @ (ALPHA + np.cross(R @ COM, A))))
    force = np.zeros(6)
    mj.mj_forward(model, data)
    mj.mj_mulM(model, data, force, data.qacc)
    holds(force + data.qfrc_bias, [*A, *(R.T @ (ALPHA + np.cross(R @ COM, A)))], [*A, *(R.T @ ALPHA)], [*ALPHA, *(R.T @ A)])


def test_mujoco_inertia() -> None:
    """fullinertia is xx, yy, zz, xy, xz, yz about the centre of mass; it is kept by principal axes."""
    model, _ = mj_robot((HINGE, X))
    axes = rotation(np.roll(model.body_iquat[1], -1))
    held = axes @ np.diag(model.body_inertia[1]) @ axes.T
    xx, yy, zz, xy, xz, yz = *np.diag(MOMENTS), MOMENTS[0, 1], MOMENTS[0, 2], MOMENTS[1, 2]
    holds(held, MOMENTS, np.array([[xx, yy, zz], [yy, xy, xz], [zz, xz, yz]]), about_origin)


# ---- Drake


def drake_robot(make, armature: float = 0) -> tuple[MultibodyPlant, tree.RigidBody, object]:
    """One body on the joint that `make` makes of a name and two frames."""
    plant = MultibodyPlant(0.0)
    plant.mutable_gravity_field().set_gravity_vector(GRAVITY)
    g = about_origin / MASS
    unit = tree.UnitInertia(g[0, 0], g[1, 1], g[2, 2], g[0, 1], g[0, 2], g[1, 2])
    body = plant.AddRigidBody("body", tree.SpatialInertia(MASS, COM, unit))
    joint = plant.AddJoint(make("joint", plant.world_frame(), body.body_frame()))
    if armature:
        actuator = plant.AddJointActuator("actuator", joint)
        actuator.set_default_rotor_inertia(armature)
        actuator.set_default_gear_ratio(3.0)
    plant.Finalize()
    return plant, body, plant.CreateDefaultContext()


def drake_pose(make, q: ArrayLike) -> RigidTransform:
    """Where the body is."""
    plant, body, context = drake_robot(make)
    plant.SetPositions(context, q)
    return body.EvalPoseInWorld(context)


def drake_velocity(make, q: ArrayLike, v: ArrayLike) -> Array:
    """[angular; linear] of the body at its origin, in world axes."""
    plant, body, context = drake_robot(make)
    plant.SetPositions(context, q)
    plant.SetVelocities(context, v)
    return body.EvalSpatialVelocityInWorld(context).get_coeffs()


def drake_inverse(plant: MultibodyPlant, context: object, a: ArrayLike) -> Array:
    """CalcInverseDynamics under all force elements."""
    forces = tree.MultibodyForces(plant)
    plant.CalcForceElementsContribution(context, forces)
    return plant.CalcInverseDynamics(context, np.asarray(a, float), forces)


def drake_hinge(damping: float = 0.0):
    """A revolute joint about x."""
    return lambda name, parent, child: tree.RevoluteJoint(name, parent, child, X, damping=damping)


def test_drake_free_q() -> None:
    """The quaternion w, x, y, z, then the origin."""
    pose = drake_pose(tree.QuaternionFloatingJoint, [*WXYZ, *P])
    holds(pose.rotation().matrix(), R, R.T, rotation(WXYZ))
    holds(pose.translation(), P, R @ P)


def test_drake_free_v() -> None:
    """[angular; linear], both in the axes of the joint's frame on the parent."""
    holds(drake_velocity(tree.QuaternionFloatingJoint, [*WXYZ, *P], [*W, *V]), [*W, *V], [*(R @ W), *V], [*(R @ W), *(R @ V)], [*V, *W])
    placed = MultibodyPlant(0.0)
    body = placed.AddRigidBody("body", tree.SpatialInertia(MASS, COM, tree.UnitInertia(1, 1, 1)))
    place = RigidTransform(RotationMatrix(about(AXIS, 0.8)), A)
    frame = placed.AddFrame(tree.FixedOffsetFrame("frame", placed.world_frame(), place))
    placed.AddJoint(tree.QuaternionFloatingJoint("joint", frame, body.body_frame()))
    placed.Finalize()
    context = placed.CreateDefaultContext()
    placed.SetPositions(context, [*WXYZ, *P])
    placed.SetVelocities(context, [*W, *V])
    holds(body.EvalSpatialVelocityInWorld(context).translational(), about(AXIS, 0.8) @ V, V)


def test_drake_free_a() -> None:
    """The derivative of the numbers in v: the linear part is the classical acceleration of the origin."""
    plant, body, context = drake_robot(tree.QuaternionFloatingJoint)
    plant.SetPositions(context, [*WXYZ, *P])
    plant.SetVelocities(context, [*W, *V])
    acceleration = plant.CalcSpatialAccelerationsFromVdot(context, np.append(ALPHA, A))[body.index()].get_coeffs()
    holds(acceleration, [*ALPHA, *A], [*ALPHA, *(A + np.cross(W, V))], [*A, *ALPHA])


def test_drake_spherical_q() -> None:
    """Roll, pitch, yaw about fixed x, y, z: R = Rz Ry Rx."""
    r, p, y = 0.4, -0.7, 1.1
    pose = drake_pose(tree.BallRpyJoint, [r, p, y])
    holds(pose.rotation().matrix(), about(Z, y) @ about(Y, p) @ about(X, r), about(X, r) @ about(Y, p) @ about(Z, y))


def test_drake_spherical_v() -> None:
    """Angular velocity in the parent's axes, neither in body axes nor the rates of the angles."""
    velocity = drake_velocity(tree.BallRpyJoint, [0.4, -0.7, 1.1], W)
    r = about(Z, 1.1) @ about(Y, -0.7) @ about(X, 0.4)
    rates = W[2] * Z + about(Z, 1.1) @ (W[1] * Y + about(Y, -0.7) @ (W[0] * X))
    holds(velocity[:3], W, r @ W, rates)


def test_drake_planar() -> None:
    """x, y, θ and their rates in the parent's axes."""
    holds(drake_pose(tree.PlanarJoint, [0.4, -0.3, 0.7]).translation(), [0.4, -0.3, 0], about(Z, 0.7) @ [0.4, -0.3, 0])
    velocity = drake_velocity(tree.PlanarJoint, [0.4, -0.3, 0.7], [0.5, 0.9, 1.3])
    holds(velocity, [0, 0, 1.3, 0.5, 0.9, 0], [0, 0, 1.3, *(about(Z, 0.7) @ [0.5, 0.9, 0])])


def test_drake_universal() -> None:
    """About x, then about the moved y."""
    pose = drake_pose(tree.UniversalJoint, [0.4, 1.1])
    holds(pose.rotation().matrix(), about(X, 0.4) @ about(Y, 1.1), about(Y, 1.1) @ about(X, 0.4))


def test_drake_helical_pitch() -> None:
    """Metres per revolution."""
    pose = drake_pose(lambda name, parent, child: tree.ScrewJoint(name, parent, child, AXIS, 0.3, 0.0), [1.2])
    holds(pose.translation(), 0.3 * 1.2 / (2 * pi) * AXIS, 0.3 * 1.2 * AXIS)


def test_drake_armature() -> None:
    """The rotor inertia of an actuator times the square of its gear ratio, in M and in inverse dynamics."""
    plant, _, context = drake_robot(drake_hinge(), armature=0.5)
    body = about_origin[0, 0]
    holds(plant.CalcMassMatrix(context), [[body + 0.5 * 9]], [[body]], [[body + 0.5]])
    moved = drake_inverse(plant, context, [1.0]) - drake_inverse(plant, context, [0.0])
    holds(moved, [body + 0.5 * 9], [body])


def test_drake_damping() -> None:
    """A force element: inverse dynamics under all of them includes it."""
    forces = []
    for damping in (0.0, 0.7):
        plant, _, context = drake_robot(drake_hinge(damping))
        plant.SetVelocities(context, [2.0])
        forces.append(drake_inverse(plant, context, [0.4]))
    holds(forces[1], forces[0] + 1.4, forces[0])


def test_drake_gravity() -> None:
    """The gravity vector is the acceleration of free fall; it is a force element, and not in CalcBiasTerm."""
    plant, _, context = drake_robot(lambda name, parent, child: tree.PrismaticJoint(name, parent, child, X))
    holds(drake_inverse(plant, context, [0.0]), [-MASS * GRAVITY[0]], [MASS * GRAVITY[0]], [0.0])
    holds(plant.CalcGravityGeneralizedForces(context), [MASS * GRAVITY[0]], [-MASS * GRAVITY[0]])
    holds(plant.CalcBiasTerm(context), [0.0], [-MASS * GRAVITY[0]], [MASS * GRAVITY[0]])


def test_drake_inertia() -> None:
    """UnitInertia is about the body's origin and divided by the mass."""
    plant, _, context = drake_robot(drake_hinge())
    holds(plant.CalcMassMatrix(context), [[about_origin[0, 0]]], [[about_origin[0, 0] + MASS * (COM[1] ** 2 + COM[2] ** 2)]])


def test_drake_mass_matrix() -> None:
    """Both triangles are filled."""
    plant, _, context = drake_robot(tree.UniversalJoint)
    plant.SetPositions(context, [0.3, 0.8])
    mass = plant.CalcMassMatrix(context)
    holds(mass, mass.T, np.triu(mass), np.tril(mass))


def test_drake_order() -> None:
    """Degrees of freedom are depth-first, whatever the order in which bodies were added."""
    plant = MultibodyPlant(0.0)
    inertia = tree.SpatialInertia(MASS, COM, tree.UnitInertia(1, 1, 1))
    bodies = {name: plant.AddRigidBody(name, inertia) for name in "abc"}
    on = {"a": plant.world_frame(), "b": plant.world_frame(), "c": bodies["a"].body_frame()}
    joints = {name: plant.AddJoint(tree.RevoluteJoint(name, on[name], bodies[name].body_frame(), X)) for name in "abc"}
    plant.Finalize()
    holds([joints[name].velocity_start() for name in "acb"], [0, 1, 2], [0, 2, 1])


def test_drake_six_vectors() -> None:
    """Velocities and Jacobians are [angular; linear]."""
    plant, body, context = drake_robot(tree.QuaternionFloatingJoint)
    plant.SetPositions(context, [*WXYZ, *P])
    frame, world = body.body_frame(), plant.world_frame()
    jacobian = plant.CalcJacobianSpatialVelocity(context, tree.JacobianWrtVariable.kV, frame, np.zeros(3), world, world)
    holds(jacobian @ [*W, *V], [*W, *V], [*V, *W])


# ---- DART


def dart_robot(kind: str, **properties: object) -> tuple[object, object]:
    """One body on a joint of that kind, with these properties."""
    robot = dartpy.dynamics.Skeleton("robot")
    settings = getattr(dartpy.dynamics, f"{kind}Properties")()
    for name, value in properties.items():
        setattr(settings, name, value)
    create = getattr(robot, f"create{kind}AndBodyNodePair")
    _, body = create(None, settings)
    body.setInertia(dartpy.dynamics.Inertia(MASS, COM, MOMENTS))
    robot.setGravity(GRAVITY)
    return robot, body


def rotation_vector(r: Array) -> Array:
    """log R."""
    angle = np.arccos((np.trace(r) - 1) / 2)
    return angle / (2 * sin(angle)) * np.array([r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]])


def dart_state(kind: str, q: ArrayLike, v: ArrayLike | None = None, **properties: object) -> tuple[object, object]:
    """The robot at a state."""
    robot, body = dart_robot(kind, **properties)
    robot.setPositions(np.asarray(q, float))
    if v is not None:
        robot.setVelocities(np.asarray(v, float))
    return robot, body


def test_dart_free_q() -> None:
    """The rotation vector log R, then the origin."""
    _, body = dart_state("FreeJoint", [*rotation_vector(R), *P])
    holds(body.getWorldTransform().rotation(), R, R.T)
    holds(body.getWorldTransform().translation(), P, R @ P)


def test_dart_free_v() -> None:
    """[angular; linear], both in the axes of the parent body, whatever the joint's frame on it is."""
    _, body = dart_state("FreeJoint", [*rotation_vector(R), *P], [*W, *V])
    holds(body.getAngularVelocity(), W, R @ W, V)
    holds(body.getLinearVelocity(), V, R @ V, W)
    place = dartpy.math.Isometry3()
    place.set_rotation(about(AXIS, 0.8))
    _, body = dart_state("FreeJoint", [*rotation_vector(R), *P], [*W, *V], mT_ParentBodyToJoint=place)
    holds(body.getWorldTransform().translation(), about(AXIS, 0.8) @ P, P)
    holds(body.getLinearVelocity(), V, about(AXIS, 0.8) @ V)


def test_dart_free_a() -> None:
    """The derivative of the numbers in v."""
    robot, body = dart_state("FreeJoint", [*rotation_vector(R), *P], [*W, *V])
    robot.setAccelerations(np.append(ALPHA, A))
    holds(body.getLinearAcceleration(), A, A + np.cross(W, V), R @ (A + np.cross(W, V)))
    holds(body.getAngularAcceleration(), ALPHA, R @ ALPHA)


def test_dart_spherical_q() -> None:
    """The rotation vector log R."""
    _, body = dart_state("BallJoint", rotation_vector(R))
    holds(body.getWorldTransform().rotation(), R, R.T)


def test_dart_spherical_v() -> None:
    """Angular velocity in body axes."""
    _, body = dart_state("BallJoint", rotation_vector(R), W)
    holds(body.getAngularVelocity(), R @ W, W)


def test_dart_planar() -> None:
    """x, y, θ and their rates in the parent's axes."""
    _, body = dart_state("PlanarJoint", [0.4, -0.3, 0.7], [0.5, 0.9, 1.3])
    holds(body.getWorldTransform().translation(), [0.4, -0.3, 0], about(Z, 0.7) @ [0.4, -0.3, 0])
    holds(body.getLinearVelocity(), [0.5, 0.9, 0], about(Z, 0.7) @ [0.5, 0.9, 0])


def test_dart_universal() -> None:
    """About the first axis, then about the moved second one."""
    _, body = dart_state("UniversalJoint", [0.4, 1.1], mAxis=[X, Y])
    holds(body.getWorldTransform().rotation(), about(X, 0.4) @ about(Y, 1.1), about(Y, 1.1) @ about(X, 0.4))


def test_dart_helical_pitch() -> None:
    """Metres per revolution."""
    _, body = dart_state("ScrewJoint", [1.2], mAxis=AXIS, mPitch=0.3)
    holds(body.getWorldTransform().translation(), 0.3 * 1.2 / (2 * pi) * AXIS, 0.3 * 1.2 * AXIS)


def test_dart_gravity() -> None:
    """setGravity takes the acceleration of free fall; the Coriolis-and-gravity force contains it."""
    robot, _ = dart_state("PrismaticJoint", [0.0], [0.0], mAxis=X)
    holds(robot.getCoriolisAndGravityForces(), [-MASS * GRAVITY[0]], [MASS * GRAVITY[0]], [0.0])


def test_dart_inertia() -> None:
    """Inertia(m, c, I) takes I about the centre of mass."""
    robot, _ = dart_state("RevoluteJoint", [0.3], [0.0], mAxis=AXIS)
    body = AXIS @ about_origin @ AXIS
    holds(robot.getMassMatrix(), [[body]], [[AXIS @ MOMENTS @ AXIS]])


def test_dart_damping() -> None:
    """Left out of the Coriolis-and-gravity force and of M."""
    forces = []
    for damping in (0.0, 0.7):
        robot, _ = dart_state("RevoluteJoint", [0.3], [2.0], mAxis=AXIS)
        robot.getJoint(0).setDampingCoefficient(0, damping)
        forces.append(np.append(robot.getCoriolisAndGravityForces(), robot.getMassMatrix()))
    holds(forces[1], forces[0], forces[0] + [1.4, 0.0])


def main(arguments: list[str]) -> int:
    """Runs the tests of the engines that are named, or of all."""
    global asked
    engines = [word for word in arguments if not word.startswith("-")]
    failed = passed = 0
    for name, test in list(globals().items()):
        if not name.startswith("test_") or engines and name.split("_")[1] not in engines:
            continue
        asked = 0
        try:
            test()
            assert asked, "it asks nothing"
        except Exception as reason:  # whatever an engine does is this test's failure
            failed += 1
            print(f"FAILED {name}: {type(reason).__name__}: {reason}")
        else:
            passed += 1
            if "-v" in arguments:
                print(f"ok     {name}: {test.__doc__}")
    print(f"{passed} passed, {failed} failed")
    return int(failed > 0 or passed == 0)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
