"""The conventions of Drake. Each row of conventions.toml has a function of its name here, which yields claims."""

from __future__ import annotations

from collections.abc import Callable
from math import pi
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from pydrake.autodiffutils import AutoDiffXd
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody import tree
from pydrake.multibody.plant import MultibodyPlant

from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.conventions import (
    ABOUT_ORIGIN,
    ALPHA,
    AXIS,
    COM,
    GRAVITY,
    MASS,
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

JointMaker = Callable[[str, tree.Frame, tree.Frame], tree.Joint]


def drake_robot(make: JointMaker, armature: float = 0) -> tuple[MultibodyPlant, tree.RigidBody, Any]:
    """One body on the joint that `make` makes of a name and two frames."""
    plant = MultibodyPlant(0.0)
    plant.mutable_gravity_field().set_gravity_vector(GRAVITY)
    g = ABOUT_ORIGIN / MASS
    unit = tree.UnitInertia(g[0, 0], g[1, 1], g[2, 2], g[0, 1], g[0, 2], g[1, 2])
    body = plant.AddRigidBody("body", tree.SpatialInertia(MASS, COM, unit))
    joint = plant.AddJoint(make("joint", plant.world_frame(), body.body_frame()))
    if armature:
        actuator = plant.AddJointActuator("actuator", joint)
        actuator.set_default_rotor_inertia(armature)
        actuator.set_default_gear_ratio(3.0)
    plant.Finalize()
    return plant, body, plant.CreateDefaultContext()


def drake_pose(make: JointMaker, q: ArrayLike) -> RigidTransform:
    """Where the body is."""
    plant, body, context = drake_robot(make)
    plant.SetPositions(context, q)
    return body.EvalPoseInWorld(context)


def drake_velocity(make: JointMaker, q: ArrayLike, v: ArrayLike) -> Array:
    """[angular; linear] of the body at its origin, in world axes."""
    plant, body, context = drake_robot(make)
    plant.SetPositions(context, q)
    plant.SetVelocities(context, v)
    return body.EvalSpatialVelocityInWorld(context).get_coeffs()


def drake_inverse(plant: MultibodyPlant, context: Any, a: ArrayLike) -> Array:
    """CalcInverseDynamics under all force elements."""
    forces = tree.MultibodyForces(plant)
    plant.CalcForceElementsContribution(context, forces)
    return plant.CalcInverseDynamics(context, np.asarray(a, float), forces)


def drake_hinge(damping: float = 0.0) -> JointMaker:
    """A revolute joint about x."""
    return lambda name, parent, child: tree.RevoluteJoint(name, parent, child, X, damping=damping)


def drake_free_q() -> Claims:
    """The quaternion w, x, y, z, then the origin."""
    pose = drake_pose(tree.QuaternionFloatingJoint, [*WXYZ, *P])
    yield claim(pose.rotation().matrix(), R, R.T, turned(WXYZ))
    yield claim(pose.translation(), P, R @ P)


def drake_free_v() -> Claims:
    """[angular; linear], both in the axes of the joint's frame on the parent."""
    yield claim(
        drake_velocity(tree.QuaternionFloatingJoint, [*WXYZ, *P], [*W, *V]), [*W, *V], [*(R @ W), *V], [*(R @ W), *(R @ V)], [*V, *W]
    )
    placed = MultibodyPlant(0.0)
    body = placed.AddRigidBody("body", tree.SpatialInertia(MASS, COM, tree.UnitInertia(1, 1, 1)))
    place = RigidTransform(RotationMatrix(about(AXIS, 0.8)), A)
    frame = placed.AddFrame(tree.FixedOffsetFrame("frame", placed.world_frame(), place))
    placed.AddJoint(tree.QuaternionFloatingJoint("joint", frame, body.body_frame()))
    placed.Finalize()
    context = placed.CreateDefaultContext()
    placed.SetPositions(context, [*WXYZ, *P])
    placed.SetVelocities(context, [*W, *V])
    yield claim(body.EvalSpatialVelocityInWorld(context).translational(), about(AXIS, 0.8) @ V, V)


def drake_free_a() -> Claims:
    """The derivative of the numbers in v: the linear part is the classical acceleration of the origin."""
    plant, body, context = drake_robot(tree.QuaternionFloatingJoint)
    plant.SetPositions(context, [*WXYZ, *P])
    plant.SetVelocities(context, [*W, *V])
    acceleration = plant.CalcSpatialAccelerationsFromVdot(context, np.append(ALPHA, A))[body.index()].get_coeffs()
    yield claim(acceleration, [*ALPHA, *A], [*ALPHA, *(A + np.cross(W, V))], [*A, *ALPHA])


def drake_spherical_q() -> Claims:
    """Roll, pitch, yaw about fixed x, y, z: R = Rz Ry Rx."""
    r, p, y = 0.4, -0.7, 1.1
    pose = drake_pose(tree.BallRpyJoint, [r, p, y])
    yield claim(pose.rotation().matrix(), about(Z, y) @ about(Y, p) @ about(X, r), about(X, r) @ about(Y, p) @ about(Z, y))


def drake_spherical_v() -> Claims:
    """Angular velocity in the parent's axes, neither in body axes nor the rates of the angles."""
    velocity = drake_velocity(tree.BallRpyJoint, [0.4, -0.7, 1.1], W)
    r = about(Z, 1.1) @ about(Y, -0.7) @ about(X, 0.4)
    rates = W[2] * Z + about(Z, 1.1) @ (W[1] * Y + about(Y, -0.7) @ (W[0] * X))
    yield claim(velocity[:3], W, r @ W, rates)


def drake_planar() -> Claims:
    """x, y, θ and their rates in the parent's axes."""
    yield claim(drake_pose(tree.PlanarJoint, [0.4, -0.3, 0.7]).translation(), [0.4, -0.3, 0], about(Z, 0.7) @ [0.4, -0.3, 0])
    velocity = drake_velocity(tree.PlanarJoint, [0.4, -0.3, 0.7], [0.5, 0.9, 1.3])
    yield claim(velocity, [0, 0, 1.3, 0.5, 0.9, 0], [0, 0, 1.3, *(about(Z, 0.7) @ [0.5, 0.9, 0])])


def drake_universal() -> Claims:
    """About x, then about the moved y."""
    pose = drake_pose(tree.UniversalJoint, [0.4, 1.1])
    yield claim(pose.rotation().matrix(), about(X, 0.4) @ about(Y, 1.1), about(Y, 1.1) @ about(X, 0.4))


def drake_helical_pitch() -> Claims:
    """Metres per revolution."""
    pose = drake_pose(lambda name, parent, child: tree.ScrewJoint(name, parent, child, AXIS, 0.3, 0.0), [1.2])
    yield claim(pose.translation(), 0.3 * 1.2 / (2 * pi) * AXIS, 0.3 * 1.2 * AXIS)


def drake_armature() -> Claims:
    """The rotor inertia of an actuator times the square of its gear ratio, in M and in inverse dynamics."""
    plant, _, context = drake_robot(drake_hinge(), armature=0.5)
    body = ABOUT_ORIGIN[0, 0]
    yield claim(plant.CalcMassMatrix(context), [[body + 0.5 * 9]], [[body]], [[body + 0.5]])
    moved = drake_inverse(plant, context, [1.0]) - drake_inverse(plant, context, [0.0])
    yield claim(moved, [body + 0.5 * 9], [body])


def drake_damping() -> Claims:
    """A force element: inverse dynamics under all of them includes it."""
    forces = []
    for damping in (0.0, 0.7):
        plant, _, context = drake_robot(drake_hinge(damping))
        plant.SetVelocities(context, [2.0])
        forces.append(drake_inverse(plant, context, [0.4]))
    yield claim(forces[1], forces[0] + 1.4, forces[0])


def drake_gravity() -> Claims:
    """The gravity vector is the acceleration of free fall; it is a force element, and not in CalcBiasTerm."""
    plant, _, context = drake_robot(lambda name, parent, child: tree.PrismaticJoint(name, parent, child, X))
    yield claim(drake_inverse(plant, context, [0.0]), [-MASS * GRAVITY[0]], [MASS * GRAVITY[0]], [0.0])
    yield claim(plant.CalcGravityGeneralizedForces(context), [MASS * GRAVITY[0]], [-MASS * GRAVITY[0]])
    yield claim(plant.CalcBiasTerm(context), [0.0], [-MASS * GRAVITY[0]], [MASS * GRAVITY[0]])


def drake_inertia() -> Claims:
    """UnitInertia is about the body's origin and divided by the mass."""
    plant, _, context = drake_robot(drake_hinge())
    yield claim(plant.CalcMassMatrix(context), [[ABOUT_ORIGIN[0, 0]]], [[ABOUT_ORIGIN[0, 0] + MASS * (COM[1] ** 2 + COM[2] ** 2)]])


def drake_mass_matrix() -> Claims:
    """Both triangles are filled."""
    plant, _, context = drake_robot(tree.UniversalJoint)
    plant.SetPositions(context, [0.3, 0.8])
    mass = plant.CalcMassMatrix(context)
    yield claim(mass, mass.T, np.triu(mass), np.tril(mass))


def drake_order() -> Claims:
    """Degrees of freedom are depth-first, whatever the order in which bodies were added."""
    plant = MultibodyPlant(0.0)
    inertia = tree.SpatialInertia(MASS, COM, tree.UnitInertia(1, 1, 1))
    bodies = {name: plant.AddRigidBody(name, inertia) for name in "abc"}
    on = {"a": plant.world_frame(), "b": plant.world_frame(), "c": bodies["a"].body_frame()}
    joints = {name: plant.AddJoint(tree.RevoluteJoint(name, on[name], bodies[name].body_frame(), X)) for name in "abc"}
    plant.Finalize()
    yield claim([joints[name].velocity_start() for name in "acb"], [0, 1, 2], [0, 2, 1])


def drake_six_vectors() -> Claims:
    """Velocities and Jacobians are [angular; linear]."""
    plant, body, context = drake_robot(tree.QuaternionFloatingJoint)
    plant.SetPositions(context, [*WXYZ, *P])
    frame, world = body.body_frame(), plant.world_frame()
    jacobian = plant.CalcJacobianSpatialVelocity(context, tree.JacobianWrtVariable.kV, frame, np.zeros(3), world, world)
    yield claim(jacobian @ [*W, *V], [*W, *V], [*V, *W])


def drake_derivative_by_q() -> Claims:
    """AutoDiffXd derives by the numbers of q; along v they have the rates N v.

    The moment R c x (-m g) turns about the axes of the parent.
    """
    plant, _, context = drake_robot(tree.QuaternionFloatingJoint)
    plant.SetPositions(context, [*WXYZ, *P])
    n = np.array([plant.MapVelocityToQDot(context, unit) for unit in np.eye(6)]).T
    duals = plant.ToAutoDiffXd()
    moving = duals.CreateDefaultContext()
    q = np.append(WXYZ, P)
    duals.SetPositions(moving, np.array([AutoDiffXd(value, row) for value, row in zip(q, n, strict=True)]))
    forces = tree.MultibodyForces_[AutoDiffXd](duals)
    duals.CalcForceElementsContribution(moving, forces)
    tau = duals.CalcInverseDynamics(moving, np.array([AutoDiffXd(0.0)] * 6), forces)
    found = np.array([entry.derivatives()[:3] for entry in tau[:3]])
    lever, weight = R @ COM, MASS * np.asarray(GRAVITY)
    due = np.array([np.cross(np.cross(unit, lever), -weight) for unit in np.eye(3)]).T
    yield claim(found, due, due @ R, due.T)
