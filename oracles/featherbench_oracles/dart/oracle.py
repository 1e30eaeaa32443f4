"""DART as an oracle."""

from __future__ import annotations

import importlib.metadata
from pathlib import Path

import numpy as np
from dartpy import dynamics

from featherbench_oracles.abilities import HasLoops, HasScenes, ReadsFiles
from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.change import CoordinateChange
from featherbench_oracles.core.clock import TimedCalls
from featherbench_oracles.core.protocol import Quantities, Reading, State, mass_matrix_probe, readback_row
from featherbench_oracles.core.robot import Description
from featherbench_oracles.dart import reading, scenes
from featherbench_oracles.dart.building import build
from featherbench_oracles.dart.coordinates import AXES, change_of_velocities, to_engine_q
from featherbench_oracles.dart.loops import LOOPS


class DartRobot:
    """A robot in DART. Every method that takes a question answers one quantity at its state, as `protocol.Engine` says.

    Parameters
    ----------
    robot : Description
        The robot's coordinates.
    skeleton : dynamics.Skeleton
        The robot.
    joints : list of dynamics.Joint
        The joint of each body; for a cylindrical joint the first of two.
    bodies : list of dynamics.BodyNode
        The bodies that they move.
    """

    def __init__(
        self, robot: Description, skeleton: dynamics.Skeleton, joints: list[dynamics.Joint], bodies: list[dynamics.BodyNode]
    ) -> None:
        self.robot, self.skeleton, self.joints, self.bodies = robot, skeleton, joints, bodies
        for mine, joint in zip(joints, (body.joint for body in robot.bodies), strict=True):
            if mine.getIndexInSkeleton(0) != joint.v.start:
                raise RuntimeError(f"DART put joint {joint.name} elsewhere")

    def readback(self) -> list[Array]:
        """Read back by getInertia, which is about the centre of mass, and getTransformFromParentBodyNode."""
        rows = []
        for node, joint, mine in zip(self.bodies, self.joints, self.robot.bodies, strict=True):
            held, placement = node.getInertia(), joint.getTransformFromParentBodyNode()
            turned = placement.rotation() @ AXES.T if mine.joint.type == "euler_zyx" else placement.rotation()
            rows.append(readback_row(held.getMass(), held.getLocalCOM(), held.getMoment(), turned, placement.translation()))
        return rows

    # ---- coordinates

    def positions(self, q: Array) -> Array:
        """Convert positions to DART's, of shape (nv,)."""
        return to_engine_q(self.robot, q)

    def change(self, ask: State) -> CoordinateChange:
        """Find T and b from DART's own joints."""
        return change_of_velocities(self.robot, self.joints, ask.q, ask.v)

    def _update(self, ask: State) -> CoordinateChange:
        """Set q and v."""
        change = self.change(ask)
        self._set(self.positions(ask.q), change.to_engine_v(ask.v))
        return change

    def _set(self, q: Array, v: Array) -> None:
        """Set q_e and v_e. DART computes again only what depends on a changed number."""
        self.skeleton.setPositions(q)
        self.skeleton.setVelocities(v)

    # ---- calls that can be timed, in DART's coordinates (`clock.TimedCalls`)

    def inverse_dynamics(self, q: Array, v: Array, a: Array) -> Array:
        """Compute tau_e by computeInverseDynamics."""
        self._set(q, v)
        self.skeleton.setAccelerations(a)
        self.skeleton.computeInverseDynamics()
        return self.skeleton.getForces()

    def mass_matrix(self, q: Array) -> Array:
        """Compute M_e by getMassMatrix, column by column."""
        self.skeleton.setPositions(q)
        return self.skeleton.getMassMatrix()

    def aba(self, q: Array, v: Array, tau: Array) -> Array:
        """Compute a_e by computeForwardDynamics, the articulated body algorithm."""
        self._set(q, v)
        self.skeleton.setForces(tau)
        self.skeleton.computeForwardDynamics()
        return self.skeleton.getAccelerations()

    def kinetic_energy(self, q: Array, v: Array) -> float:
        """Compute the kinetic energy by computeKineticEnergy, a sum over the bodies."""
        self._set(q, v)
        return self.skeleton.computeKineticEnergy()

    def com(self, q: Array) -> Array:
        """Compute the centre of mass by getCOM."""
        self.skeleton.setPositions(q)
        return self.skeleton.getCOM()

    # ---- dynamics

    def inverse_wrench(self, ask: State) -> Array:
        """Answer `id_wrench` by computeInverseDynamics with a force on every body, in its axes at its origin."""
        change = self._update(ask)
        for node, wrench in zip(self.bodies, ask.wrench, strict=True):
            node.setExtForce(wrench[3:], np.zeros(3), True, True)
            node.setExtTorque(wrench[:3], True)
        self.skeleton.setAccelerations(change.to_engine_a(ask.a))
        self.skeleton.computeInverseDynamics(True)
        self.skeleton.clearExternalForces()
        return change.to_neutral_tau(self.skeleton.getForces())

    def bias_forces(self, ask: State) -> Array:
        """Answer `bias` by h = T' (Coriolis and gravity forces + M_e b)."""
        change = self._update(ask)
        bias = self.skeleton.getCoriolisAndGravityForces()
        return change.to_neutral_tau(bias + self.skeleton.getMassMatrix() @ change.b if change.b.any() else bias)

    def probe(self, ask: State) -> Array:
        """Answer `mass_matrix_probe` by the M of `mass_matrix`."""
        mass = self.change(ask).to_neutral_mass(self.mass_matrix(self.positions(ask.q)))
        return mass_matrix_probe(mass.__matmul__, np.diag(mass), ask.probe)

    def inverse_mass_matrix(self, ask: State) -> Array:
        """Answer `fd` by a = M^-1 (tau - h), where the articulated body algorithm gives M^-1 column by column."""
        change = self._update(ask)
        force = change.to_engine_tau(ask.tau) - self.skeleton.getCoriolisAndGravityForces()
        return change.to_neutral_a(self.skeleton.getInvMassMatrix() @ force)

    # ---- energies, momentum, kinematics

    def potential_energy(self, ask: State) -> float:
        """Answer `potential_energy` by computePotentialEnergy."""
        self._update(ask)
        return self.skeleton.computePotentialEnergy()

    def momentum(self, ask: State) -> Array:
        """Answer `momentum` by a sum over the bodies. DART gives each in the body's axes, about a point in them."""
        self._update(ask)
        center, total = self.skeleton.getCOM(), np.zeros(6)
        for node in self.bodies:
            r, p = node.getWorldTransform().rotation(), node.getWorldTransform().translation()
            total += np.append(r @ node.getAngularMomentum(r.T @ (center - p)), r @ node.getLinearMomentum())
        return total

    def placement(self, ask: State) -> list[Array]:
        """Answer `body_placement` by getWorldTransform."""
        self._update(ask)
        poses = [node.getWorldTransform() for node in self.bodies]
        return [np.append(pose.rotation().ravel(), pose.translation()) for pose in poses]

    def velocity(self, ask: State) -> list[Array]:
        """Answer `body_velocity` by getAngularVelocity and getLinearVelocity."""
        self._update(ask)
        return [np.append(node.getAngularVelocity(), node.getLinearVelocity()) for node in self.bodies]

    def acceleration(self, ask: State) -> list[Array]:
        """Answer `body_acceleration` by getAngularAcceleration and getLinearAcceleration, which is classical."""
        change = self._update(ask)
        self.skeleton.setAccelerations(change.to_engine_a(ask.a))
        return [np.append(node.getAngularAcceleration(), node.getLinearAcceleration()) for node in self.bodies]

    def jacobian(self, ask: State) -> Array:
        """Answer `body_jacobian` by getWorldJacobian."""
        change = self._update(ask)
        return change.to_neutral_jacobian(self.skeleton.getWorldJacobian(self.bodies[ask.body]))


class Dart(ReadsFiles, HasLoops, HasScenes):
    """The engine DART, for `session.serve`."""

    name = "dart"
    version = importlib.metadata.version("dartpy")
    build = {"language": "C++ (Python package dartpy)"}
    formats = ("urdf", "mjcf", "sdf")
    quantities: Quantities = {
        "id": {"inverse_dynamics": TimedCalls("q v a", DartRobot.inverse_dynamics, CoordinateChange.to_neutral_tau)},
        "id_wrench": {"inverse_dynamics": DartRobot.inverse_wrench},
        "bias": {
            "coriolis_and_gravity": DartRobot.bias_forces,
            "inverse_dynamics": TimedCalls("q v b", DartRobot.inverse_dynamics, CoordinateChange.to_neutral_tau),
        },
        "mass_matrix": {"mass_matrix": TimedCalls("q", DartRobot.mass_matrix, CoordinateChange.to_neutral_mass)},
        "mass_matrix_sparse": {"mass_matrix": TimedCalls("q", DartRobot.mass_matrix, CoordinateChange.to_neutral_mass)},
        "mass_matrix_probe": {"mass_matrix": DartRobot.probe},
        "fd": {
            "aba": TimedCalls("q v tau", DartRobot.aba, CoordinateChange.to_neutral_a),
            "inverse_mass_matrix": DartRobot.inverse_mass_matrix,
        },
        "kinetic_energy": {"kinetic_energy": TimedCalls("q v", DartRobot.kinetic_energy)},
        "potential_energy": {"potential_energy": DartRobot.potential_energy},
        "com": {"center_of_mass": TimedCalls("q", DartRobot.com)},
        "momentum": {"body_momenta": DartRobot.momentum},
        "body_placement": {"world_transforms": DartRobot.placement},
        "body_velocity": {"world_velocities": DartRobot.velocity},
        "body_acceleration": {"world_accelerations": DartRobot.acceleration},
        "body_jacobian": {"world_jacobian": DartRobot.jacobian},
    }

    loops = LOOPS
    scene_variants = scenes.VARIANTS

    def prepare(self, description: Description) -> DartRobot:
        """Build the robot. DART has no armature."""
        return DartRobot(description, *build(description))

    def read(self, path: Path, form: str, base: str) -> Reading:
        """Read a file by DartLoader or MjcfParser."""
        return reading.read(path, form, base, DartRobot)
