"""The conventions of DART."""

from __future__ import annotations

from math import pi, sin

import dartpy
import numpy as np
from numpy.typing import ArrayLike

from asking import A, ALPHA, AXIS, COM, GRAVITY, MASS, MOMENTS, P, R, V, W, X, Y, Z, Array, about, about_origin, holds


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
