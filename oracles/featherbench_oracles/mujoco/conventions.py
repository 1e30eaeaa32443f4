"""The conventions of MuJoCo. Each row of conventions.toml has a function of its name here, which yields claims."""

from __future__ import annotations

import mujoco as mj
import numpy as np
from numpy.typing import ArrayLike

from featherbench_oracles.core.algebra import Array, skew
from featherbench_oracles.core.conventions import (
    ABOUT_ORIGIN,
    ALPHA,
    COM,
    GRAVITY,
    MASS,
    MOMENTS,
    WXYZ,
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
    turned,
)

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


def mujoco_free_q() -> Claims:
    """Origin, then the quaternion w, x, y, z."""
    model, data = mj_robot((FREE, Z))
    mj_set(model, data, [*P, *WXYZ], np.zeros(6))
    yield claim(data.xmat[1].reshape(3, 3), R, R.T, turned(WXYZ))
    yield claim(data.xpos[1], P, R @ P)


def mujoco_free_v() -> Claims:
    """[linear; angular]: linear in world axes, angular in body axes."""
    model, data = mj_robot((FREE, Z))
    mj_set(model, data, [*P, *WXYZ], [*V, *W])
    velocity = mj_velocity(model, data)
    yield claim(velocity[3:], V, R @ V, W)
    yield claim(velocity[:3], R @ W, W)


def mujoco_free_a() -> Claims:
    """The derivative of the numbers in v: the linear part is the classical acceleration of the origin in world axes."""
    model, data = mj_robot((FREE, Z))
    mj_set(model, data, [*P, *WXYZ], [*V, *W])
    force = mj_inverse(model, data, [*A, *ALPHA])[:3]
    swing = R @ (np.cross(ALPHA, COM) + np.cross(W, np.cross(W, COM)))
    yield claim(force, MASS * (A - GRAVITY + swing), MASS * (A + np.cross(R @ W, V) - GRAVITY + swing), MASS * (R @ A - GRAVITY + swing))


def mujoco_free_placement() -> Claims:
    """A free joint's q is the pose in the world: the placement of its body is only where it begins."""
    spec = mj.MjSpec()
    body = spec.worldbody.add_body(name="body", pos=[5, 6, 7], mass=1, inertia=[1, 1, 1], explicitinertial=True)
    body.add_freejoint()
    model = spec.compile()
    data = mj.MjData(model)
    mj_set(model, data, [*P, *WXYZ], np.zeros(6))
    yield claim(data.xpos[1], P, P + [5, 6, 7])


def mujoco_spherical_q() -> Claims:
    """The quaternion w, x, y, z."""
    model, data = mj_robot((BALL, Z))
    mj_set(model, data, WXYZ, np.zeros(3))
    yield claim(data.xmat[1].reshape(3, 3), R, R.T, turned(WXYZ))


def mujoco_spherical_v() -> Claims:
    """Angular velocity in body axes."""
    model, data = mj_robot((BALL, Z))
    mj_set(model, data, WXYZ, W)
    yield claim(mj_velocity(model, data)[:3], R @ W, W)


def mujoco_planar() -> Claims:
    """Slide x, slide y, hinge z in one body: the slides are not turned by the hinge behind them."""
    model, data = mj_robot((SLIDE, X), (SLIDE, Y), (HINGE, Z))
    mj_set(model, data, [0.4, -0.3, 0.7], [0.5, 0.9, 1.3])
    yield claim(data.xpos[1], [0.4, -0.3, 0], about(Z, 0.7) @ [0.4, -0.3, 0])
    yield claim(mj_velocity(model, data), [0, 0, 1.3, 0.5, 0.9, 0], [0, 0, 1.3, *(about(Z, 0.7) @ [0.5, 0.9, 0])])


def mujoco_universal() -> Claims:
    """Hinges in one body act in their order, the second about the moved axis."""
    model, data = mj_robot((HINGE, X), (HINGE, Y))
    mj_set(model, data, [0.4, 1.1], np.zeros(2))
    yield claim(data.xmat[1].reshape(3, 3), about(X, 0.4) @ about(Y, 1.1), about(Y, 1.1) @ about(X, 0.4))


def mujoco_helical() -> Claims:
    """There is none: four kinds of joints, and a hinge and a slide along one axis are two independent dofs."""
    assert sorted(kind.name for kind in mj.mjtJoint.__members__.values()) == ["mjJNT_BALL", "mjJNT_FREE", "mjJNT_HINGE", "mjJNT_SLIDE"]
    model, data = mj_robot((HINGE, X), (SLIDE, X))
    mj_set(model, data, [1.2, 0.0], np.zeros(2))
    yield claim(model.nv, 2, 1)
    yield claim(data.xpos[1], np.zeros(3), 1.2 * X)


def mujoco_armature() -> Claims:
    """Part of M and of mj_inverse, not of mj_rne."""
    model, data = mj_robot((HINGE, X), armature=0.5)
    body = ABOUT_ORIGIN[0, 0]
    mj_set(model, data, [0.3], [0.0])
    mass, rne, still = np.empty((1, 1)), np.empty(1), np.empty(1)
    mj.mj_fullM(model, data, mass)
    yield claim(mass, [[body + 0.5]], [[body]])
    yield claim(mj_inverse(model, data, [1.0]) - mj_inverse(model, data, [0.0]), [body + 0.5], [body])
    data.qacc = 1.0
    mj.mj_rne(model, data, 1, rne)
    mj.mj_rne(model, data, 0, still)
    yield claim(rne - still, [body], [body + 0.5])


def mujoco_damping() -> Claims:
    """A passive force: M a + h = qfrc_inverse + qfrc_passive."""
    plain, damped = mj_robot((HINGE, X)), mj_robot((HINGE, X), damping=0.7)
    for model, data in (plain, damped):
        mj_set(model, data, [0.3], [2.0])
    force = mj_inverse(*plain, [0.4])
    with_damping = mj_inverse(*damped, [0.4])
    yield claim(with_damping, force + 1.4, force)
    yield claim(with_damping + damped[1].qfrc_passive, force, force + 1.4)


def mujoco_gravity() -> Claims:
    """option.gravity is the acceleration of free fall; qfrc_bias contains it."""
    model, data = mj_robot((SLIDE, X))
    mj_set(model, data, [0.0], [0.0])
    yield claim(data.qfrc_bias, [-MASS * GRAVITY[0]], [MASS * GRAVITY[0]], [0.0])


def mujoco_body_acceleration() -> Claims:
    """mj_objectAcceleration contains −g: a body at rest accelerates upwards."""
    model, data = mj_robot((SLIDE, X))
    mj_set(model, data, [0.0], [0.0])
    data.qacc = 0.0
    mj.mj_rnePostConstraint(model, data)
    acceleration = np.empty(6)
    mj.mj_objectAcceleration(model, data, mj.mjtObj.mjOBJ_XBODY, 1, acceleration, 0)
    yield claim(acceleration[3:], -GRAVITY, np.zeros(3), GRAVITY)


def mujoco_mass_matrix() -> Claims:
    """MjData.M stores the lower triangle row by row, the diagonal last; mj_fullM fills both."""
    model, data = mj_robot((HINGE, X), (HINGE, Z))
    mj_set(model, data, [0.3, 0.8], np.zeros(2))
    mass = np.empty((2, 2))
    mj.mj_fullM(model, data, mass)
    yield claim(mass, mass.T, np.triu(mass), np.tril(mass))
    yield claim(data.M, [mass[0, 0], mass[1, 0], mass[1, 1]], [mass[0, 0], mass[1, 1], mass[1, 0]])


def mujoco_order() -> Claims:
    """Degrees of freedom are depth-first, whatever the order in which bodies were added."""
    spec = mj.MjSpec()
    parts = {}
    for name, parent in (("a", spec.worldbody), ("b", spec.worldbody)):
        parts[name] = parent.add_body(name=name, mass=1, inertia=[1, 1, 1], explicitinertial=True)
    parts["c"] = parts["a"].add_body(name="c", mass=1, inertia=[1, 1, 1], explicitinertial=True)
    for name, body in parts.items():
        body.add_joint(name=name, type=HINGE)
    model = spec.compile()
    yield claim([model.joint(name).dofadr[0] for name in "acb"], [0, 1, 2], [0, 2, 1])


def mujoco_six_vectors() -> Claims:
    """Velocities are [angular; linear], at the origin of the asked body; mj_jacBody gives the linear rows first."""
    model, data = mj_robot((FREE, Z))
    mj_set(model, data, [*P, *WXYZ], [*V, *W])
    yield claim(mj_velocity(model, data), [*(R @ W), *V], [*V, *(R @ W)])
    linear, angular = np.zeros((2, 3, 6))
    mj.mj_jacBody(model, data, linear, angular, 1)
    yield claim(linear @ data.qvel, V, R @ W)
    yield claim(angular @ data.qvel, R @ W, V)


def mujoco_wrench() -> Claims:
    """xfrc_applied is [force; torque] in world axes about the centre of mass; mj_inverse does not look at it."""
    model, data = mj_robot((FREE, Z))
    mj_set(model, data, [*P, *WXYZ], np.zeros(6))
    before = mj_inverse(model, data, np.zeros(6))
    data.xfrc_applied[1] = [*A, *ALPHA]
    yield claim(mj_inverse(model, data, np.zeros(6)), before, before - np.append(A, R.T @ (ALPHA + np.cross(R @ COM, A))))
    force = np.zeros(6)
    mj.mj_forward(model, data)
    mj.mj_mulM(model, data, force, data.qacc)
    yield claim(force + data.qfrc_bias, [*A, *(R.T @ (ALPHA + np.cross(R @ COM, A)))], [*A, *(R.T @ ALPHA)], [*ALPHA, *(R.T @ A)])


def mujoco_inertia() -> Claims:
    """Fullinertia is xx, yy, zz, xy, xz, yz about the centre of mass; it is kept by principal axes."""
    model, _ = mj_robot((HINGE, X))
    axes = turned(np.roll(model.body_iquat[1], -1))
    held = axes @ np.diag(model.body_inertia[1]) @ axes.T
    xx, yy, zz, xy, xz, yz = *np.diag(MOMENTS), MOMENTS[0, 1], MOMENTS[0, 2], MOMENTS[1, 2]
    yield claim(held, MOMENTS, np.array([[xx, yy, zz], [yy, xy, xz], [zz, xz, yz]]), ABOUT_ORIGIN)


def mujoco_derivative_by_q() -> Claims:
    """Along qvel, as mj_integratePos moves, and transposed: the row is the dof that moves.

    The moment is c x (-m u), with u gravity in body axes.
    """
    model, data = mj_robot((FREE, Z))
    mj_set(model, data, [*P, *WXYZ], np.zeros(6))
    mj_inverse(model, data, np.zeros(6))
    by_q = np.zeros((6, 6))
    mj.mjd_inverseFD(model, data, 1e-6, False, by_q, None, None, None, None, None, None)
    due = -MASS * skew(COM) @ skew(R.T @ GRAVITY)
    # Forward differences with the step 1e-6 have six digits.
    yield claim(by_q[3:, 3:].round(3), due.T.round(3), due.round(3), (due @ R).T.round(3))
