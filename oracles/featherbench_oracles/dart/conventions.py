"""The conventions of DART. Each row of conventions.toml has a function of its name here, which yields claims."""

from __future__ import annotations

from math import pi, sin

import numpy as np
from dartpy import dynamics
from dartpy.math import Isometry3
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


def dart_robot(kind: str, **properties: object) -> tuple[dynamics.Skeleton, dynamics.BodyNode]:
    """One body on a joint of that kind, with these properties."""
    robot = dynamics.Skeleton("robot")
    settings = getattr(dynamics, f"{kind}Properties")()
    for name, value in properties.items():
        setattr(settings, name, value)
    create = getattr(robot, f"create{kind}AndBodyNodePair")
    _, body = create(None, settings)
    body.setInertia(dynamics.Inertia(MASS, COM, MOMENTS))
    robot.setGravity(GRAVITY)
    return robot, body


def rotation_vector(r: Array) -> Array:
    """Log R."""
    angle = np.arccos((np.trace(r) - 1) / 2)
    return angle / (2 * sin(angle)) * np.array([r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]])


def dart_state(kind: str, q: ArrayLike, v: ArrayLike | None = None, **properties: object) -> tuple[dynamics.Skeleton, dynamics.BodyNode]:
    """The robot at a state."""
    robot, body = dart_robot(kind, **properties)
    robot.setPositions(np.asarray(q, float))
    if v is not None:
        robot.setVelocities(np.asarray(v, float))
    return robot, body


def dart_free_q() -> Claims:
    """The rotation vector log R, then the origin."""
    _, body = dart_state("FreeJoint", [*rotation_vector(R), *P])
    yield claim(body.getWorldTransform().rotation(), R, R.T)
    yield claim(body.getWorldTransform().translation(), P, R @ P)


def dart_free_v() -> Claims:
    """[angular; linear], both in the axes of the parent body, whatever the joint's frame on it is."""
    _, body = dart_state("FreeJoint", [*rotation_vector(R), *P], [*W, *V])
    yield claim(body.getAngularVelocity(), W, R @ W, V)
    yield claim(body.getLinearVelocity(), V, R @ V, W)
    place = Isometry3()
    place.set_rotation(about(AXIS, 0.8))
    _, body = dart_state("FreeJoint", [*rotation_vector(R), *P], [*W, *V], mT_ParentBodyToJoint=place)
    yield claim(body.getWorldTransform().translation(), about(AXIS, 0.8) @ P, P)
    yield claim(body.getLinearVelocity(), V, about(AXIS, 0.8) @ V)


def dart_free_a() -> Claims:
    """The derivative of the numbers in v."""
    robot, body = dart_state("FreeJoint", [*rotation_vector(R), *P], [*W, *V])
    robot.setAccelerations(np.append(ALPHA, A))
    yield claim(body.getLinearAcceleration(), A, A + np.cross(W, V), R @ (A + np.cross(W, V)))
    yield claim(body.getAngularAcceleration(), ALPHA, R @ ALPHA)


def dart_spherical_q() -> Claims:
    """The rotation vector log R."""
    _, body = dart_state("BallJoint", rotation_vector(R))
    yield claim(body.getWorldTransform().rotation(), R, R.T)


def dart_spherical_v() -> Claims:
    """Angular velocity in body axes."""
    _, body = dart_state("BallJoint", rotation_vector(R), W)
    yield claim(body.getAngularVelocity(), R @ W, W)


def dart_planar() -> Claims:
    """x, y, θ and their rates in the parent's axes."""
    _, body = dart_state("PlanarJoint", [0.4, -0.3, 0.7], [0.5, 0.9, 1.3])
    yield claim(body.getWorldTransform().translation(), [0.4, -0.3, 0], about(Z, 0.7) @ [0.4, -0.3, 0])
    yield claim(body.getLinearVelocity(), [0.5, 0.9, 0], about(Z, 0.7) @ [0.5, 0.9, 0])


def dart_universal() -> Claims:
    """About the first axis, then about the moved second one."""
    _, body = dart_state("UniversalJoint", [0.4, 1.1], mAxis=[X, Y])
    yield claim(body.getWorldTransform().rotation(), about(X, 0.4) @ about(Y, 1.1), about(Y, 1.1) @ about(X, 0.4))


def dart_helical_pitch() -> Claims:
    """Metres per revolution."""
    _, body = dart_state("ScrewJoint", [1.2], mAxis=AXIS, mPitch=0.3)
    yield claim(body.getWorldTransform().translation(), 0.3 * 1.2 / (2 * pi) * AXIS, 0.3 * 1.2 * AXIS)


def dart_gravity() -> Claims:
    """SetGravity takes the acceleration of free fall; the Coriolis-and-gravity force contains it."""
    robot, _ = dart_state("PrismaticJoint", [0.0], [0.0], mAxis=X)
    yield claim(robot.getCoriolisAndGravityForces(), [-MASS * GRAVITY[0]], [MASS * GRAVITY[0]], [0.0])


def dart_inertia() -> Claims:
    """Inertia(m, c, I) takes I about the centre of mass."""
    robot, _ = dart_state("RevoluteJoint", [0.3], [0.0], mAxis=AXIS)
    body = AXIS @ ABOUT_ORIGIN @ AXIS
    yield claim(robot.getMassMatrix(), [[body]], [[AXIS @ MOMENTS @ AXIS]])


def dart_damping() -> Claims:
    """Left out of the Coriolis-and-gravity force and of M."""
    forces = []
    for damping in (0.0, 0.7):
        robot, _ = dart_state("RevoluteJoint", [0.3], [2.0], mAxis=AXIS)
        robot.getJoint(0).setDampingCoefficient(0, damping)
        forces.append(np.append(robot.getCoriolisAndGravityForces(), robot.getMassMatrix()))
    yield claim(forces[1], forces[0], forces[0] + [1.4, 0.0])
