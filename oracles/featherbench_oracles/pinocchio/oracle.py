"""Pinocchio as an oracle."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import eigenpy
import numpy as np
import pinocchio as pin

from featherbench_oracles.abilities import HasContactSolvers, HasLoops, ReadsFiles
from featherbench_oracles.abilities.derivatives import Differentiated
from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.change import CoordinateChange
from featherbench_oracles.core.protocol import Quantities, Reading, State, mass_matrix_probe, readback_row
from featherbench_oracles.core.robot import Description
from featherbench_oracles.pinocchio import reading
from featherbench_oracles.pinocchio.building import build
from featherbench_oracles.pinocchio.contacts import SOLVERS
from featherbench_oracles.pinocchio.coordinates import (
    change_of_velocities,
    rates_of_change,
    to_angular_first,
    to_engine_q,
    to_our_parameters,
)
from featherbench_oracles.pinocchio.loops import LOOPS


def from_upper(matrix: Array) -> Array:
    """Make a symmetric matrix of the upper triangle of one."""
    upper = np.triu(matrix)
    whole: Array = upper + np.triu(upper, 1).T
    return whole


class PinocchioRobot:
    """A robot in Pinocchio. Every method that takes a question answers one quantity at its state, as `protocol.Engine` says.

    Parameters
    ----------
    robot : Description
        The robot's coordinates.
    model : pin.Model
        The robot; where it was built from the description, body i is joint i + 1, as joint 0 is the universe.
    turning : sequence of int
        The angles that are (cos, sin) in the model, by their indices in the q_e of `coordinates`: continuous joints as read.
    """

    def __init__(self, robot: Description, model: pin.Model, turning: Sequence[int] = ()) -> None:
        self.robot, self.model, self.turning = robot, model, list(turning)
        self.data = model.createData()
        if not self.model.check(self.data):
            raise RuntimeError("Pinocchio's own check of the model fails")

    def readback(self) -> list[Array]:
        """Read back `model.inertias` and `model.jointPlacements`."""
        held = list(zip(self.model.inertias, self.model.jointPlacements, strict=True))[1:]
        return [readback_row(y.mass, y.lever, y.inertia, m.rotation, m.translation) for y, m in held]

    # ---- dynamics

    def _state(self, ask: State) -> tuple[Array, Array, CoordinateChange]:
        """Find q_e, v_e and the change of coordinates."""
        change = change_of_velocities(self.robot, ask.q, ask.v)
        return self._engine_q(ask.q), change.to_engine_v(ask.v), change

    def _engine_q(self, q: Array) -> Array:
        """Find q_e, with (cos, sin) for the angles in `turning`."""
        q_e = to_engine_q(self.robot, q)
        angles = q_e[self.turning]
        q_e[self.turning] = np.cos(angles)
        return np.insert(q_e, [k + 1 for k in self.turning], np.sin(angles))

    def rnea(self, ask: State) -> Array:
        """Answer `id` by tau = RNEA(q, v, a)."""
        q, v, change = self._state(ask)
        return change.to_neutral_tau(pin.rnea(self.model, self.data, q, v, change.to_engine_a(ask.a)))

    def rnea_wrench(self, ask: State) -> Array:
        """Answer `id_wrench` by RNEA with forces on the bodies, in body axes about the body's origin like ours."""
        q, v, change = self._state(ask)
        forces = pin.StdVec_Force([pin.Force.Zero(), *(pin.Force(w[3:], w[:3]) for w in ask.wrench)])
        return change.to_neutral_tau(pin.rnea(self.model, self.data, q, v, change.to_engine_a(ask.a), forces))

    def bias_rnea(self, ask: State) -> Array:
        """Answer `bias` by h = RNEA(q, v, a = 0)."""
        q, v, change = self._state(ask)
        return change.to_neutral_tau(pin.rnea(self.model, self.data, q, v, change.b))

    def nonlinear_effects(self, ask: State) -> Array:
        """Answer `bias` by h = T' (h_e + M_e b)."""
        q, v, change = self._state(ask)
        bias = pin.nonLinearEffects(self.model, self.data, q, v).copy()
        if change.b.any():
            bias += self._mass_e(q, pin.Convention.LOCAL) @ change.b
        return change.to_neutral_tau(bias)

    def _mass_e(self, q: Array, convention: pin.Convention) -> Array:
        """Compute M_e. crba promises the upper triangle only."""
        return from_upper(pin.crba(self.model, self.data, q, convention))

    def crba_local(self, ask: State) -> Array:
        """Answer `mass_matrix` by the composite rigid body algorithm in body frames."""
        q, _, change = self._state(ask)
        return change.to_neutral_mass(self._mass_e(q, pin.Convention.LOCAL))

    def crba_world(self, ask: State) -> Array:
        """Answer `mass_matrix` by the composite rigid body algorithm in the world frame."""
        q, _, change = self._state(ask)
        return change.to_neutral_mass(self._mass_e(q, pin.Convention.WORLD))

    def probe_local(self, ask: State) -> Array:
        """Answer `mass_matrix_probe` by the M of `crba_local`."""
        mass = self.crba_local(ask)
        return mass_matrix_probe(mass.__matmul__, np.diag(mass), ask.probe)

    def probe_world(self, ask: State) -> Array:
        """Answer `mass_matrix_probe` by the M of `crba_world`."""
        mass = self.crba_world(ask)
        return mass_matrix_probe(mass.__matmul__, np.diag(mass), ask.probe)

    def _aba(self, ask: State, convention: pin.Convention) -> Array:
        q, v, change = self._state(ask)
        return change.to_neutral_a(pin.aba(self.model, self.data, q, v, change.to_engine_tau(ask.tau), convention))

    def aba_local(self, ask: State) -> Array:
        """Answer `fd` by the articulated body algorithm in body frames."""
        return self._aba(ask, pin.Convention.LOCAL)

    def aba_world(self, ask: State) -> Array:
        """Answer `fd` by the articulated body algorithm in the world frame."""
        return self._aba(ask, pin.Convention.WORLD)

    def crba_cholesky(self, ask: State) -> Array:
        """Answer `fd` by a = M^-1 (tau - h) with Pinocchio's tree-sparse factors U D U' of its M."""
        q, v, change = self._state(ask)
        rest = change.to_engine_tau(ask.tau) - pin.nonLinearEffects(self.model, self.data, q, v)
        pin.crba(self.model, self.data, q)
        pin.cholesky.decompose(self.model, self.data)
        return change.to_neutral_a(pin.cholesky.solve(self.model, self.data, rest))

    def minverse(self, ask: State) -> Array:
        """Answer `fd` by a = M^-1 (tau - h) with computeMinverse, which promises the upper triangle only."""
        q, v, change = self._state(ask)
        rest = change.to_engine_tau(ask.tau) - pin.nonLinearEffects(self.model, self.data, q, v)
        upper = np.triu(pin.computeMinverse(self.model, self.data, q))
        return change.to_neutral_a(upper @ rest + np.triu(upper, 1).T @ rest)

    # ---- derivatives

    def _differentiated(self, ask: State) -> tuple[Array, Array, Differentiated]:
        """Find q_e, v_e and the way back of derivatives."""
        q, v, change = self._state(ask)
        return q, v, Differentiated(change, rates_of_change(self.robot, ask.q, ask.v))

    def _rnea_derivatives(self, ask: State) -> tuple[Differentiated, Array, Array, Array]:
        """Differentiate tau_e by q_e, v_e and a_e. The Python function fills both triangles of the last."""
        q, v, way = self._differentiated(ask)
        by_q, by_v, mass = pin.computeRNEADerivatives(self.model, self.data, q, v, way.change.to_engine_a(ask.a))
        return way, by_q.copy(), by_v.copy(), from_upper(mass)

    def rnea_dq(self, ask: State) -> Array:
        """Answer `id_dq` by computeRNEADerivatives."""
        way, by_q, by_v, mass = self._rnea_derivatives(ask)
        return way.id_dq(ask, self.data.tau.copy(), by_q, by_v, mass)

    def rnea_dv(self, ask: State) -> Array:
        """Answer `id_dv` by computeRNEADerivatives."""
        way, _, by_v, mass = self._rnea_derivatives(ask)
        return way.id_dv(by_v, mass)

    def _aba_derivatives(self, ask: State) -> tuple[Differentiated, Array, Array, Array]:
        """Differentiate a_e by q_e, v_e and tau_e."""
        q, v, way = self._differentiated(ask)
        by_q, by_v, inverse = pin.computeABADerivatives(self.model, self.data, q, v, way.change.to_engine_tau(ask.tau))
        return way, by_q.copy(), by_v.copy(), from_upper(inverse)

    def aba_dq(self, ask: State) -> Array:
        """Answer `fd_dq` by computeABADerivatives."""
        way, by_q, by_v, inverse = self._aba_derivatives(ask)
        return way.fd_dq(ask, way.change.to_neutral_a(self.data.ddq.copy()), by_q, by_v, inverse)

    def aba_dv(self, ask: State) -> Array:
        """Answer `fd_dv` by computeABADerivatives."""
        way, _, by_v, _ = self._aba_derivatives(ask)
        return way.fd_dv(by_v)

    def coriolis(self, ask: State) -> Array:
        """Answer `coriolis_matrix` by computeCoriolisMatrix."""
        q, v, way = self._differentiated(ask)
        matrix = pin.computeCoriolisMatrix(self.model, self.data, q, v).copy()
        return way.coriolis(ask.v, matrix, self._mass_e(q, pin.Convention.LOCAL))

    def regressor(self, ask: State) -> Array:
        """Answer `torque_regressor` by computeJointTorqueRegressor."""
        q, v, change = self._state(ask)
        regressor = pin.computeJointTorqueRegressor(self.model, self.data, q, v, change.to_engine_a(ask.a))
        return to_our_parameters(change.to_neutral_tau(regressor))

    # ---- energies, momentum, kinematics

    def kinetic_energy(self, ask: State) -> float:
        """Answer `kinetic_energy` by computeKineticEnergy.

        Pinocchio 4.1.0 leaves out the armature of RevoluteUnaligned and HelicalUnaligned joints here.
        """
        q, v, _ = self._state(ask)
        return pin.computeKineticEnergy(self.model, self.data, q, v)

    def kinetic_energy_crba(self, ask: State) -> float:
        """Answer `kinetic_energy` by ½ v' M v with the M of `crba_local`."""
        q, v, _ = self._state(ask)
        return float(v @ self._mass_e(q, pin.Convention.LOCAL) @ v / 2)

    def potential_energy(self, ask: State) -> float:
        """Answer `potential_energy` by computePotentialEnergy."""
        return pin.computePotentialEnergy(self.model, self.data, to_engine_q(self.robot, ask.q))

    def com(self, ask: State) -> Array:
        """Answer `com` by centerOfMass."""
        return pin.centerOfMass(self.model, self.data, to_engine_q(self.robot, ask.q))

    def momentum(self, ask: State) -> Array:
        """Answer `momentum` by computeCentroidalMomentum."""
        q, v, _ = self._state(ask)
        return to_angular_first(pin.computeCentroidalMomentum(self.model, self.data, q, v))

    def placement(self, ask: State) -> list[Array]:
        """Answer `body_placement` by forwardKinematics."""
        pin.forwardKinematics(self.model, self.data, to_engine_q(self.robot, ask.q))
        return [np.append(m.rotation.ravel(), m.translation) for m in list(self.data.oMi)[1:]]

    def velocity(self, ask: State) -> list[Array]:
        """Answer `body_velocity` by getVelocity in the frame LOCAL_WORLD_ALIGNED."""
        q, v, _ = self._state(ask)
        pin.forwardKinematics(self.model, self.data, q, v)
        frame, joints = pin.LOCAL_WORLD_ALIGNED, range(1, self.model.njoints)
        return [to_angular_first(pin.getVelocity(self.model, self.data, i, frame)) for i in joints]

    def acceleration(self, ask: State) -> list[Array]:
        """Answer `body_acceleration` by getClassicalAcceleration in the frame LOCAL_WORLD_ALIGNED."""
        q, v, change = self._state(ask)
        pin.forwardKinematics(self.model, self.data, q, v, change.to_engine_a(ask.a))
        frame, joints = pin.LOCAL_WORLD_ALIGNED, range(1, self.model.njoints)
        return [to_angular_first(pin.getClassicalAcceleration(self.model, self.data, i, frame)) for i in joints]

    def jacobian(self, ask: State) -> Array:
        """Answer `body_jacobian` by getJointJacobian in the frame LOCAL_WORLD_ALIGNED."""
        q, _, change = self._state(ask)
        pin.computeJointJacobians(self.model, self.data, q)
        linear_first = pin.getJointJacobian(self.model, self.data, ask.body + 1, pin.LOCAL_WORLD_ALIGNED)
        return change.to_neutral_jacobian(np.roll(linear_first, 3, axis=0))


class Pinocchio(ReadsFiles, HasContactSolvers, HasLoops):
    """The engine Pinocchio, for `session.serve`."""

    name = "pinocchio"
    version = pin.__version__
    build = {"language": "C++ (Python package pin)", "simd": eigenpy.SimdInstructionSetsInUse(), "eigenpy": eigenpy.__version__}
    formats = ("urdf", "mjcf")
    quantities: Quantities = {
        "id": {"rnea": PinocchioRobot.rnea},
        "id_wrench": {"rnea": PinocchioRobot.rnea_wrench},
        "bias": {"nonlinear_effects": PinocchioRobot.nonlinear_effects, "rnea": PinocchioRobot.bias_rnea},
        "mass_matrix": {"crba_local": PinocchioRobot.crba_local, "crba_world": PinocchioRobot.crba_world},
        "mass_matrix_probe": {"crba_local": PinocchioRobot.probe_local, "crba_world": PinocchioRobot.probe_world},
        "fd": {
            "aba_local": PinocchioRobot.aba_local,
            "aba_world": PinocchioRobot.aba_world,
            "crba_cholesky": PinocchioRobot.crba_cholesky,
            "minverse": PinocchioRobot.minverse,
        },
        "kinetic_energy": {"kinetic_energy": PinocchioRobot.kinetic_energy, "crba": PinocchioRobot.kinetic_energy_crba},
        "potential_energy": {"potential_energy": PinocchioRobot.potential_energy},
        "com": {"center_of_mass": PinocchioRobot.com},
        "momentum": {"centroidal_momentum": PinocchioRobot.momentum},
        "body_placement": {"forward_kinematics": PinocchioRobot.placement},
        "body_velocity": {"forward_kinematics": PinocchioRobot.velocity},
        "body_acceleration": {"forward_kinematics": PinocchioRobot.acceleration},
        "body_jacobian": {"joint_jacobian": PinocchioRobot.jacobian},
        "id_dq": {"rnea_derivatives": PinocchioRobot.rnea_dq},
        "id_dv": {"rnea_derivatives": PinocchioRobot.rnea_dv},
        "fd_dq": {"aba_derivatives": PinocchioRobot.aba_dq},
        "fd_dv": {"aba_derivatives": PinocchioRobot.aba_dv},
        "coriolis_matrix": {"coriolis_matrix": PinocchioRobot.coriolis},
        "torque_regressor": {"joint_torque_regressor": PinocchioRobot.regressor},
    }

    contact_solvers = SOLVERS
    loops = LOOPS

    def prepare(self, description: Description) -> PinocchioRobot:
        """Build the robot, if its workspace fits into the process's memory."""
        reading.affordable(description.nv)
        return PinocchioRobot(description, build(description))

    def read(self, path: Path, form: str, base: str) -> Reading:
        """Read a file by buildModelFromUrdf or buildModelFromMJCF."""
        return reading.read(path, form, base, PinocchioRobot)
