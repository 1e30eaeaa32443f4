"""Drake as an oracle."""

from __future__ import annotations

import importlib.metadata
from pathlib import Path
from typing import Any

import numpy as np
from pydrake.autodiffutils import AutoDiffXd
from pydrake.multibody import tree
from pydrake.multibody.math import SpatialForce
from pydrake.multibody.plant import MultibodyPlant

from featherbench_oracles.abilities import HasLoops, HasRods, HasSceneDerivatives, HasScenes, ReadsFiles
from featherbench_oracles.abilities.derivatives import Differentiated
from featherbench_oracles.core.algebra import Array, skew
from featherbench_oracles.core.change import CoordinateChange
from featherbench_oracles.core.clock import NOTHING, TimedCalls
from featherbench_oracles.core.protocol import Quantities, Reading, State, mass_matrix_probe, readback_row
from featherbench_oracles.core.robot import Description
from featherbench_oracles.drake import reading, scenes
from featherbench_oracles.drake.building import build
from featherbench_oracles.drake.coordinates import change_of_velocities, rates_of_change, to_engine_q
from featherbench_oracles.drake.loops import LOOPS
from featherbench_oracles.drake.rods import RODS


class DrakeRobot:
    """A robot in Drake. Every method that takes a question answers one quantity at its state, as `protocol.Engine` says.

    Parameters
    ----------
    robot : Description
        The robot's coordinates.
    plant : MultibodyPlant
        The robot.
    chains : list of list of Joint
        For each body of the description the joint that carries it, or the joints.
    """

    def __init__(self, robot: Description, plant: MultibodyPlant, chains: list[list[tree.Joint]]) -> None:
        self.robot, self.plant, self.chains = robot, plant, chains
        self.bodies = [chain[-1].child_body() for chain in chains]
        parts = [part for chain in chains for part in chain]
        firsts = [chain[0].velocity_start() for chain in chains]
        orders = [part.position_start() for part in parts], [part.velocity_start() for part in parts]
        if firsts != [body.joint.v.start for body in robot.bodies] or any(order != sorted(order) for order in orders):
            raise RuntimeError("Drake put the degrees of freedom in another order")
        self.context = plant.CreateDefaultContext()
        self.forces = tree.MultibodyForces(plant)
        self.duals: tuple[Any, Any] | None = None
        self.drive = plant.get_applied_generalized_force_input_port().FixValue(self.context, np.zeros(plant.num_velocities()))

    def readback(self) -> list[Array]:
        """Read back Drake's inertia about the origin: I = I_origin + m [c]x^2 is about the centre of mass."""
        rows = []
        for body, chain in zip(self.bodies, self.chains, strict=True):
            held = body.CalcSpatialInertiaInBodyFrame(self.context)
            mass, com = held.get_mass(), held.get_com()
            inertia = held.CalcRotationalInertia().CopyToFullMatrix3() + mass * skew(com) @ skew(com)
            placement = chain[0].frame_on_parent().GetFixedPoseInBodyFrame()
            rows.append(readback_row(mass, com, inertia, placement.rotation().matrix(), placement.translation()))
        return rows

    # ---- coordinates

    def positions(self, q: Array) -> Array:
        """Convert positions to Drake's."""
        return to_engine_q(self.robot, q)

    def change(self, ask: State) -> CoordinateChange:
        """Find T and b at a state. A number that is not finite is a ValueError: Drake would end the process."""
        if not np.isfinite([*ask.q, *ask.v, *ask.a, *ask.tau]).all():
            raise ValueError("Drake ends the process at numbers that are not finite")
        return change_of_velocities(self.robot, ask.q, ask.v)

    def _update(self, ask: State) -> CoordinateChange:
        """Set q and v."""
        change = self.change(ask)
        self._set(self.positions(ask.q), change.to_engine_v(ask.v))
        return change

    def _set(self, q: Array, v: Array) -> None:
        """Set q_e and v_e. Drake then discards what it has computed."""
        self.plant.SetPositions(self.context, q)
        self.plant.SetVelocities(self.context, v)

    # ---- calls that can be timed, in Drake's coordinates (`clock.TimedCalls`)

    def inverse_dynamics(self, q: Array, v: Array, a: Array) -> Array:
        """Compute tau_e by CalcInverseDynamics under gravity."""
        self._set(q, v)
        self.plant.CalcForceElementsContribution(self.context, self.forces)
        return self.plant.CalcInverseDynamics(self.context, a, self.forces)

    def crba(self, q: Array) -> Array:
        """Compute M_e by CalcMassMatrix, the composite body algorithm."""
        self.plant.SetPositions(self.context, q)
        return self.plant.CalcMassMatrix(self.context)

    def aba(self, q: Array, v: Array, tau: Array) -> Array:
        """Compute a_e by the acceleration port, the articulated body algorithm."""
        self._set(q, v)
        self.drive.GetMutableData().get_mutable_value().SetFromVector(tau)
        return self.plant.get_generalized_acceleration_output_port().Eval(self.context)

    def kinetic_energy(self, q: Array, v: Array) -> float:
        """Compute the kinetic energy by CalcKineticEnergy."""
        self._set(q, v)
        return self.plant.CalcKineticEnergy(self.context)

    def jacobian(self, q: Array, number: int) -> Array:
        """Compute J_e of a body, or of the world (`clock.NOTHING`), in world axes at its origin."""
        self.plant.SetPositions(self.context, q)
        world, speeds = self.plant.world_frame(), tree.JacobianWrtVariable.kV
        frame = world if number == NOTHING else self.bodies[number].body_frame()
        return self.plant.CalcJacobianSpatialVelocity(self.context, speeds, frame, np.zeros(3), world, world)

    # ---- dynamics

    def inverse_wrench(self, ask: State) -> Array:
        """Answer `id_wrench` by CalcInverseDynamics under gravity and a force on every body, in body axes at its origin."""
        change = self._update(ask)
        self.plant.CalcForceElementsContribution(self.context, self.forces)
        for body, wrench in zip(self.bodies, ask.wrench, strict=True):
            force = SpatialForce(tau=wrench[:3], f=wrench[3:])
            body.AddInForce(self.context, np.zeros(3), force, body.body_frame(), self.forces)
        return change.to_neutral_tau(self.plant.CalcInverseDynamics(self.context, change.to_engine_a(ask.a), self.forces))

    def bias_term(self, ask: State) -> Array:
        """Answer `bias` by h = T' (C v - tau_gravity + M_e b)."""
        change = self._update(ask)
        bias = self.plant.CalcBiasTerm(self.context) - self.plant.CalcGravityGeneralizedForces(self.context)
        if change.b.any():
            bias += self.plant.CalcMassMatrix(self.context) @ change.b
        return change.to_neutral_tau(bias)

    def mass_by_inverse_dynamics(self, ask: State) -> Array:
        """Answer `mass_matrix` by CalcMassMatrixViaInverseDynamics, column by column."""
        change = self._update(ask)
        return change.to_neutral_mass(self.plant.CalcMassMatrixViaInverseDynamics(self.context))

    def probe(self, ask: State) -> Array:
        """Answer `mass_matrix_probe` by the M of `crba`."""
        mass = self.change(ask).to_neutral_mass(self.crba(self.positions(ask.q)))
        return mass_matrix_probe(mass.__matmul__, np.diag(mass), ask.probe)

    # ---- derivatives, by Drake's dual numbers

    def _differentiated(self, ask: State) -> tuple[Array, Array, Differentiated]:
        """Set q and v. Find v_e, the matrix N with dq_e/dt = N v_e, and the way back of derivatives."""
        way = Differentiated(self._update(ask), rates_of_change(self.robot, ask.q, ask.v))
        n = np.array([self.plant.MapVelocityToQDot(self.context, unit) for unit in np.eye(self.plant.num_velocities())]).T
        return way.change.to_engine_v(ask.v), n, way

    def _plant_of_duals(self) -> tuple[Any, Any]:
        """Convert the plant to AutoDiffXd, once."""
        if self.duals is None:
            plant = self.plant.ToAutoDiffXd()
            self.duals = plant, plant.CreateDefaultContext()
        return self.duals

    def _set_duals(self, q: Array, n: Array, v: Array, seeds: int) -> tuple[Any, Any]:
        """Set q_e with the derivatives N, and v_e with its own; tau_e may have the last of three times nv seeds."""
        plant, context = self._plant_of_duals()
        nv = len(v)
        plant.SetPositions(context, with_gradient(q, np.hstack([n, np.zeros((len(q), seeds - nv))])))
        plant.SetVelocities(context, with_gradient(v, np.eye(nv, seeds, nv)))
        return plant, context

    def _inverse_duals(self, ask: State) -> tuple[Differentiated, Array, Array, Array, Array]:
        """Compute tau_e, and its derivatives by q_e along v_e, by v_e and by a_e."""
        v, n, way = self._differentiated(ask)
        nv = len(v)
        plant, context = self._set_duals(self.positions(ask.q), n, v, 2 * nv)
        forces = tree.MultibodyForces_[AutoDiffXd](plant)
        plant.CalcForceElementsContribution(context, forces)
        a = with_gradient(way.change.to_engine_a(ask.a), np.zeros((nv, 2 * nv)))
        tau = plant.CalcInverseDynamics(context, a, forces)
        gradient = gradient_of(tau, 2 * nv)
        values = np.array([entry.value() for entry in tau])
        return way, values, gradient[:, :nv], gradient[:, nv:], self.plant.CalcMassMatrix(self.context)

    def inverse_dq(self, ask: State) -> Array:
        """Answer `id_dq` by CalcInverseDynamics on AutoDiffXd."""
        way, tau, by_q, by_v, mass = self._inverse_duals(ask)
        return way.id_dq(ask, tau, by_q, by_v, mass)

    def inverse_dv(self, ask: State) -> Array:
        """Answer `id_dv` by CalcInverseDynamics on AutoDiffXd."""
        way, _, _, by_v, mass = self._inverse_duals(ask)
        return way.id_dv(by_v, mass)

    def _aba_duals(self, ask: State) -> tuple[Differentiated, Array, Array, Array, Array]:
        """Compute the neutral a, and the derivatives of a_e by q_e along v_e, by v_e and by tau_e."""
        v, n, way = self._differentiated(ask)
        nv = len(v)
        plant, context = self._set_duals(self.positions(ask.q), n, v, 3 * nv)
        tau = with_gradient(way.change.to_engine_tau(ask.tau), np.eye(nv, 3 * nv, 2 * nv))
        plant.get_applied_generalized_force_input_port().FixValue(context, tau)
        a = plant.get_generalized_acceleration_output_port().Eval(context)
        gradient = gradient_of(a, 3 * nv)
        neutral = way.change.to_neutral_a(np.array([entry.value() for entry in a]))
        return way, neutral, gradient[:, :nv], gradient[:, nv : 2 * nv], gradient[:, 2 * nv :]

    def aba_dq(self, ask: State) -> Array:
        """Answer `fd_dq` by the acceleration port on AutoDiffXd."""
        way, a, by_q, by_v, inverse = self._aba_duals(ask)
        return way.fd_dq(ask, a, by_q, by_v, inverse)

    def aba_dv(self, ask: State) -> Array:
        """Answer `fd_dv` by the acceleration port on AutoDiffXd."""
        way, _, _, by_v, _ = self._aba_duals(ask)
        return way.fd_dv(by_v)

    # ---- energies, momentum, kinematics

    def potential_energy(self, ask: State) -> float:
        """Answer `potential_energy` by CalcPotentialEnergy."""
        self._update(ask)
        return self.plant.CalcPotentialEnergy(self.context)

    def com(self, ask: State) -> Array:
        """Answer `com` by CalcCenterOfMassPositionInWorld."""
        self._update(ask)
        return self.plant.CalcCenterOfMassPositionInWorld(self.context)

    def momentum(self, ask: State) -> Array:
        """Answer `momentum` by CalcSpatialMomentumInWorldAboutPoint."""
        momentum = self.plant.CalcSpatialMomentumInWorldAboutPoint(self.context, self.com(ask))
        return np.append(momentum.rotational(), momentum.translational())

    def placement(self, ask: State) -> list[Array]:
        """Answer `body_placement` by EvalPoseInWorld."""
        self._update(ask)
        poses = [body.EvalPoseInWorld(self.context) for body in self.bodies]
        return [np.append(pose.rotation().matrix().ravel(), pose.translation()) for pose in poses]

    def velocity(self, ask: State) -> list[Array]:
        """Answer `body_velocity` by EvalSpatialVelocityInWorld."""
        self._update(ask)
        velocities = [body.EvalSpatialVelocityInWorld(self.context) for body in self.bodies]
        return [np.append(v.rotational(), v.translational()) for v in velocities]

    def acceleration(self, ask: State) -> list[Array]:
        """Answer `body_acceleration`: Drake's spatial acceleration is the classical one of the body's origin."""
        change = self._update(ask)
        by_index = self.plant.CalcSpatialAccelerationsFromVdot(self.context, change.to_engine_a(ask.a))
        accelerations = [by_index[body.index()] for body in self.bodies]
        return [np.append(a.rotational(), a.translational()) for a in accelerations]


def with_gradient(values: Array, gradient: Array) -> Any:
    """Make numbers of AutoDiffXd.

    Parameters
    ----------
    values : ndarray, shape (n,)
        The numbers.
    gradient : ndarray, shape (n, m)
        The derivatives of each by m seeds, per unit of the seed.

    Returns
    -------
    ndarray of AutoDiffXd, shape (n,)
        The numbers with their derivatives.
    """
    return np.array([AutoDiffXd(value, row) for value, row in zip(values, gradient, strict=True)])


def gradient_of(numbers: Any, seeds: int) -> Array:
    """Read the derivatives of numbers of AutoDiffXd by each seed, shape (n, seeds). A number that depends on none has no row in Drake."""
    rows = [number.derivatives() for number in numbers]
    return np.array([row if len(row) else np.zeros(seeds) for row in rows])


class Drake(ReadsFiles, HasLoops, HasRods, HasScenes, HasSceneDerivatives):
    """The engine Drake, for `session.serve`."""

    name = "drake"
    version = importlib.metadata.version("drake")
    build = {"language": "C++ (Python package drake)"}
    rods = RODS
    formats = ("urdf", "mjcf", "sdf")
    quantities: Quantities = {
        "id": {"inverse_dynamics": TimedCalls("q v a", DrakeRobot.inverse_dynamics, CoordinateChange.to_neutral_tau)},
        "id_wrench": {"inverse_dynamics": DrakeRobot.inverse_wrench},
        "bias": {
            "bias_term": DrakeRobot.bias_term,
            "inverse_dynamics": TimedCalls("q v b", DrakeRobot.inverse_dynamics, CoordinateChange.to_neutral_tau),
        },
        "mass_matrix": {
            "crba": TimedCalls("q", DrakeRobot.crba, CoordinateChange.to_neutral_mass),
            "inverse_dynamics": DrakeRobot.mass_by_inverse_dynamics,
        },
        "mass_matrix_sparse": {"crba": TimedCalls("q", DrakeRobot.crba, CoordinateChange.to_neutral_mass)},
        "mass_matrix_probe": {"crba": DrakeRobot.probe},
        "fd": {"aba": TimedCalls("q v tau", DrakeRobot.aba, CoordinateChange.to_neutral_a)},
        "kinetic_energy": {"kinetic_energy": TimedCalls("q v", DrakeRobot.kinetic_energy)},
        "potential_energy": {"potential_energy": DrakeRobot.potential_energy},
        "com": {"center_of_mass": DrakeRobot.com},
        "momentum": {"spatial_momentum": DrakeRobot.momentum},
        "body_placement": {"body_poses": DrakeRobot.placement},
        "body_velocity": {"body_velocities": DrakeRobot.velocity},
        "body_acceleration": {"spatial_accelerations": DrakeRobot.acceleration},
        "body_jacobian": {"jacobian_spatial_velocity": TimedCalls("q body", DrakeRobot.jacobian, CoordinateChange.to_neutral_jacobian)},
        "id_dq": {"autodiff": DrakeRobot.inverse_dq},
        "id_dv": {"autodiff": DrakeRobot.inverse_dv},
        "fd_dq": {"autodiff": DrakeRobot.aba_dq},
        "fd_dv": {"autodiff": DrakeRobot.aba_dv},
    }

    loops = LOOPS
    scene_variants = scenes.VARIANTS
    scene_derivatives = scenes.DERIVATIVES

    def prepare(self, description: Description) -> DrakeRobot:
        """Build the robot."""
        return DrakeRobot(description, *build(description))

    def read(self, path: Path, form: str, base: str) -> Reading:
        """Read a file by Parser."""
        return reading.read(path, form, base, DrakeRobot)
