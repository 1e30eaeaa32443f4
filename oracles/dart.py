"""DART as an oracle: the robot is built with the calls of a `Skeleton`, never by a parser.

Joints are DART's Revolute, Prismatic, Screw (whose pitch is per *revolution*), Ball, Free, Planar, Universal, Translational and Euler; a
cylindrical joint is a revolute and a prismatic one with a massless body between. DART has no armature. Damping, springs and friction are
zero unless set. DART checks inertias with a warning only, so that unphysical bodies are answered for as well.
"""

from __future__ import annotations

import importlib.metadata
from collections.abc import Sequence
from math import atan2, pi
from pathlib import Path

import dart_reading
import numpy as np
from dartpy import dynamics
from dartpy.math import Isometry3

from clock import Calls
from protocol import Array, Body, Change, Description, Joint, Question, Reading, Unsupported, mass_matrix_probe, readback_row, rotation, serve

# ---- coordinates -----------------------------------------------------------------------------------------------------------------
# joint      q_e                     T                 b
# free       log R, p                [[0, R], [R, 0]]  (0, R (ω × v)): [angular; linear] in the *parent body's* axes, R in T and b from body
#                                                   to parent body (in log R to joint frame). The axes are those of DART's body: of a robot
#                                                   as read they need not be those of the description's, so DART itself is asked
# spherical  log R                   identity          0: angular velocity in body axes
# euler_zyx  z, -y, x                diag(1, -1, 1)    0: DART's order is x, y, z (Python cannot set another); its axes are turned by AXES
# all other  q                       identity          0

AXES = np.array([[0.0, 0.0, 1.0], [0.0, -1.0, 0.0], [1.0, 0.0, 0.0]])  # takes DART's x, y, z to our z, -y, x
MIRROR = np.diag([1.0, -1.0, 1.0])


def to_engine_q(robot: Description, q: Array) -> Array:
    """q_e of the table."""
    return np.concatenate([_joint_q(body.joint, q[body.joint.q]) for body in robot.bodies])


def _joint_q(joint: Joint, q: Array) -> Array:
    if joint.type == "spherical":
        return log(q)
    if joint.type == "free":
        return np.append(log(q[3:]), q[:3])
    if joint.type == "euler_zyx":
        return MIRROR @ q
    return q


def log(quaternion: Array) -> Array:
    """The rotation vector, of length at most pi, of the quaternion (x, y, z, w): no arccos, which loses half of the digits near 0."""
    u, w = (quaternion[:3], quaternion[3]) if quaternion[3] >= 0 else (-quaternion[:3], -quaternion[3])
    sine = np.linalg.norm(u)
    return 2 * atan2(sine, w) / sine * u if sine > 0 else np.zeros(3)


def change_of_velocities(robot: Description, made: Sequence[dynamics.Joint], q: Array, v: Array) -> Change:
    """T and b of the table, for DART's joints of a robot."""
    blocks, bias = [], np.zeros(robot.nv)
    for joint, mine in zip((body.joint for body in robot.bodies), made, strict=True):
        if joint.type == "euler_zyx":
            blocks.append((joint.v, MIRROR))
        if joint.type == "free":
            r, zero = mine.getTransformFromParentBodyNode().rotation() @ rotation(q[joint.q][3:]), np.zeros((3, 3))
            linear, angular = v[joint.v][:3], v[joint.v][3:]
            blocks.append((joint.v, np.block([[zero, r], [r, zero]])))
            bias[joint.v] = np.append(np.zeros(3), r @ np.cross(angular, linear))
    return Change(tuple(blocks), bias)


# ---- the robot -------------------------------------------------------------------------------------------------------------------


def build(robot: Description) -> tuple[dynamics.Skeleton, list[dynamics.Joint], list[dynamics.BodyNode]]:
    """The skeleton of a description; its joints, of a cylindrical joint the first, and the bodies that they move."""
    skeleton = dynamics.Skeleton("robot")
    skeleton.setGravity(robot.gravity)
    joints: list[dynamics.Joint] = []
    bodies: list[dynamics.BodyNode] = []
    for body in robot.bodies:
        joint = body.joint
        if joint.armature.any():
            raise Unsupported(f"DART has no armature (joint {joint.name})")
        first, node = make_joint(skeleton, joint, bodies[body.parent] if body.parent >= 0 else None)
        turn = AXES if joint.type == "euler_zyx" else np.eye(3)
        first.setTransformFromParentBodyNode(Isometry3(joint.rotation @ turn, joint.translation))
        node.getParentJoint().setTransformFromChildBodyNode(Isometry3(turn, np.zeros(3)))
        node.setInertia(dynamics.Inertia(body.mass, body.com, body.inertia))
        joints.append(first)
        bodies.append(node)
    return skeleton, joints, bodies


def make_joint(add: dynamics.Skeleton, joint: Joint, parent: dynamics.BodyNode | None) -> tuple[dynamics.Joint, dynamics.BodyNode]:
    """DART's joint of that type, and the body that it moves."""
    if joint.type == "revolute":
        made, node = add.createRevoluteJointAndBodyNodePair(parent)
        made.setAxis(joint.axis)
    elif joint.type == "prismatic":
        made, node = add.createPrismaticJointAndBodyNodePair(parent)
        made.setAxis(joint.axis)
    elif joint.type == "helical":
        made, node = add.createScrewJointAndBodyNodePair(parent)
        made.setAxis(joint.axis)
        made.setPitch(2 * pi * joint.pitch)
    elif joint.type == "cylindrical":
        made, between = add.createRevoluteJointAndBodyNodePair(parent)
        between.setInertia(dynamics.Inertia(0.0, np.zeros(3), np.zeros((3, 3))))
        slide, node = add.createPrismaticJointAndBodyNodePair(between)
        for part in (made, slide):
            part.setAxis(joint.axis)
    elif joint.type == "universal":
        made, node = add.createUniversalJointAndBodyNodePair(parent)
        made.setAxis1([1.0, 0.0, 0.0])
        made.setAxis2([0.0, 1.0, 0.0])
    elif joint.type == "planar":
        made, node = add.createPlanarJointAndBodyNodePair(parent)
        made.setXYPlane()
    else:
        makers = {
            "spherical": add.createBallJointAndBodyNodePair,
            "free": add.createFreeJointAndBodyNodePair,
            "translation": add.createTranslationalJointAndBodyNodePair,
            "euler_zyx": add.createEulerJointAndBodyNodePair,
        }
        if joint.type not in makers:
            raise Unsupported(f"DART has no {joint.type} joint")
        made, node = makers[joint.type](parent)
    return made, node


class DartRobot:
    """A robot in DART."""

    def __init__(self, robot: Description, skeleton: dynamics.Skeleton, joints: list[dynamics.Joint], bodies: list[dynamics.BodyNode]) -> None:
        self.robot, self.skeleton, self.joints, self.bodies = robot, skeleton, joints, bodies
        for mine, joint in zip(joints, (body.joint for body in robot.bodies), strict=True):
            if mine.getIndexInSkeleton(0) != joint.v.start:
                raise RuntimeError(f"DART put joint {joint.name} elsewhere")

    def readback(self) -> list[Array]:
        """DART keeps the inertia about the centre of mass."""
        rows = []
        for node, joint, mine in zip(self.bodies, self.joints, self.robot.bodies, strict=True):
            held, placement = node.getInertia(), joint.getTransformFromParentBodyNode()
            turned = placement.rotation() @ AXES.T if mine.joint.type == "euler_zyx" else placement.rotation()
            rows.append(readback_row(held.getMass(), held.getLocalCOM(), held.getMoment(), turned, placement.translation()))
        return rows

    # ---- coordinates

    def positions(self, q: Array) -> Array:
        """q_e."""
        return to_engine_q(self.robot, q)

    def change(self, ask: Question) -> Change:
        """T and b."""
        return change_of_velocities(self.robot, self.joints, ask.q, ask.v)

    def _update(self, ask: Question) -> Change:
        """Sets q and v."""
        change = self.change(ask)
        self._set(self.positions(ask.q), change.to_engine_v(ask.v))
        return change

    def _set(self, q: Array, v: Array) -> None:
        """Sets q_e and v_e; DART computes again what depends on a number that changes, and that only."""
        self.skeleton.setPositions(q)
        self.skeleton.setVelocities(v)

    # ---- calls that can be timed, in DART's coordinates

    def inverse_dynamics(self, q: Array, v: Array, a: Array) -> Array:
        """tau_e = computeInverseDynamics."""
        self._set(q, v)
        self.skeleton.setAccelerations(a)
        self.skeleton.computeInverseDynamics()
        return self.skeleton.getForces()

    def mass_matrix(self, q: Array) -> Array:
        """M_e; DART finds it column by column."""
        self.skeleton.setPositions(q)
        return self.skeleton.getMassMatrix()

    def aba(self, q: Array, v: Array, tau: Array) -> Array:
        """a_e by the articulated body algorithm."""
        self._set(q, v)
        self.skeleton.setForces(tau)
        self.skeleton.computeForwardDynamics()
        return self.skeleton.getAccelerations()

    def kinetic_energy(self, q: Array, v: Array) -> float:
        """The sum over the bodies."""
        self._set(q, v)
        return self.skeleton.computeKineticEnergy()

    def com(self, q: Array) -> Array:
        """The centre of mass."""
        self.skeleton.setPositions(q)
        return self.skeleton.getCOM()

    # ---- dynamics

    def inverse_wrench(self, ask: Question) -> Array:
        """tau = computeInverseDynamics with a force on every body, in its axes at its origin."""
        change = self._update(ask)
        for node, wrench in zip(self.bodies, ask.wrench, strict=True):
            node.setExtForce(wrench[3:], np.zeros(3), True, True)
            node.setExtTorque(wrench[:3], True)
        self.skeleton.setAccelerations(change.to_engine_a(ask.a))
        self.skeleton.computeInverseDynamics(True)
        self.skeleton.clearExternalForces()
        return change.to_neutral_tau(self.skeleton.getForces())

    def bias_forces(self, ask: Question) -> Array:
        """h = T' (Coriolis and gravity forces + M_e b)."""
        change = self._update(ask)
        bias = self.skeleton.getCoriolisAndGravityForces()
        return change.to_neutral_tau(bias + self.skeleton.getMassMatrix() @ change.b if change.b.any() else bias)

    def probe(self, ask: Question) -> Array:
        """Products with, and parts of, M."""
        mass = self.change(ask).to_neutral_mass(self.mass_matrix(self.positions(ask.q)))
        return mass_matrix_probe(mass.__matmul__, np.diag(mass), ask.probe)

    def inverse_mass_matrix(self, ask: Question) -> Array:
        """M^-1 (tau - h), M^-1 column by column by the articulated body algorithm."""
        change = self._update(ask)
        force = change.to_engine_tau(ask.tau) - self.skeleton.getCoriolisAndGravityForces()
        return change.to_neutral_a(self.skeleton.getInvMassMatrix() @ force)

    # ---- energies, momentum, kinematics

    def potential_energy(self, ask: Question) -> float:
        """-Σ m g·c."""
        self._update(ask)
        return self.skeleton.computePotentialEnergy()

    def momentum(self, ask: Question) -> Array:
        """The sum over the bodies, of which DART answers each in its own axes about a point in them."""
        self._update(ask)
        center, total = self.skeleton.getCOM(), np.zeros(6)
        for node in self.bodies:
            r, p = node.getWorldTransform().rotation(), node.getWorldTransform().translation()
            total += np.append(r @ node.getAngularMomentum(r.T @ (center - p)), r @ node.getLinearMomentum())
        return total

    def placement(self, ask: Question) -> list[Array]:
        """Rotation and origin of each body."""
        self._update(ask)
        poses = [node.getWorldTransform() for node in self.bodies]
        return [np.append(pose.rotation().ravel(), pose.translation()) for pose in poses]

    def velocity(self, ask: Question) -> list[Array]:
        """Velocity of each body in world axes at its origin."""
        self._update(ask)
        return [np.append(node.getAngularVelocity(), node.getLinearVelocity()) for node in self.bodies]

    def acceleration(self, ask: Question) -> list[Array]:
        """DART's linear acceleration is the classical one of the body's origin."""
        change = self._update(ask)
        self.skeleton.setAccelerations(change.to_engine_a(ask.a))
        return [np.append(node.getAngularAcceleration(), node.getLinearAcceleration()) for node in self.bodies]

    def jacobian(self, ask: Question) -> Array:
        """J of the asked body in world axes at its origin."""
        change = self._update(ask)
        return change.to_neutral_jacobian(self.skeleton.getWorldJacobian(self.bodies[ask.body]))


class Dart:
    """The engine."""

    name = "dart"
    version = importlib.metadata.version("dartpy")
    build = {"language": "C++ (Python package dartpy)"}
    quantities = {
        "id": {"inverse_dynamics": Calls("q v a", DartRobot.inverse_dynamics, Change.to_neutral_tau)},
        "id_wrench": {"inverse_dynamics": DartRobot.inverse_wrench},
        "bias": {
            "coriolis_and_gravity": DartRobot.bias_forces,
            "inverse_dynamics": Calls("q v b", DartRobot.inverse_dynamics, Change.to_neutral_tau),
        },
        "mass_matrix": {"mass_matrix": Calls("q", DartRobot.mass_matrix, Change.to_neutral_mass)},
        "mass_matrix_sparse": {"mass_matrix": Calls("q", DartRobot.mass_matrix, Change.to_neutral_mass)},
        "mass_matrix_probe": {"mass_matrix": DartRobot.probe},
        "fd": {"aba": Calls("q v tau", DartRobot.aba, Change.to_neutral_a), "inverse_mass_matrix": DartRobot.inverse_mass_matrix},
        "kinetic_energy": {"kinetic_energy": Calls("q v", DartRobot.kinetic_energy)},
        "potential_energy": {"potential_energy": DartRobot.potential_energy},
        "com": {"center_of_mass": Calls("q", DartRobot.com)},
        "momentum": {"body_momenta": DartRobot.momentum},
        "body_placement": {"world_transforms": DartRobot.placement},
        "body_velocity": {"world_velocities": DartRobot.velocity},
        "body_acceleration": {"world_accelerations": DartRobot.acceleration},
        "body_jacobian": {"world_jacobian": DartRobot.jacobian},
    }

    def prepare(self, description: Description) -> DartRobot:
        """Builds the robot."""
        return DartRobot(description, *build(description))

    def read(self, path: Path, form: str, base: str) -> Reading:
        """Has DART's own parser read a file."""
        return dart_reading.read(path, form, base, DartRobot)


if __name__ == "__main__":
    serve(Dart())
