"""Drake as an oracle."""

from __future__ import annotations

import importlib.metadata
from pathlib import Path

import numpy as np
from pydrake.multibody import tree
from pydrake.multibody.math import SpatialForce
from pydrake.multibody.plant import MultibodyPlant

from featherbench_oracles.algebra import Array, skew
from featherbench_oracles.change import Change
from featherbench_oracles.clock import NOTHING, Calls
from featherbench_oracles.drake import reading
from featherbench_oracles.drake.building import build
from featherbench_oracles.drake.coordinates import change_of_velocities, to_engine_q
from featherbench_oracles.protocol import Quantities, Question, Reading, mass_matrix_probe, readback_row
from featherbench_oracles.robot import Description


class DrakeRobot:
    """A robot in Drake. Every method that takes a question answers one quantity at its state.

    Parameters
    ----------
    robot : Description
        The robot's coordinates.
    plant : MultibodyPlant
        The robot.
    chains : list of list of Joint
        For each body of the description the joint, or the joints, that carry it.
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
        self.drive = plant.get_applied_generalized_force_input_port().FixValue(self.context, np.zeros(plant.num_velocities()))

    def readback(self) -> list[Array]:
        """Tell what Drake holds; the inertia about the centre of mass is I = I_origin + m [c]x^2.

        Returns
        -------
        list of ndarray, shape (22,)
            Of each body a row of `readback_row`.
        """
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
        """Bring coordinates to Drake.

        Parameters
        ----------
        q : ndarray, shape (nq,)
            Neutral coordinates, m, rad or quaternions.

        Returns
        -------
        ndarray, shape (nq of Drake,)
            q_e, m, rad or quaternions.
        """
        return to_engine_q(self.robot, q)

    def change(self, ask: Question) -> Change:
        """Find T and b at a state.

        Parameters
        ----------
        ask : Question
            The state.

        Returns
        -------
        Change
            The change there.

        Raises
        ------
        ValueError
            If a number is not finite: Drake ends the process over those.
        """
        if not np.isfinite([*ask.q, *ask.v, *ask.a, *ask.tau]).all():
            raise ValueError("Drake ends the process at numbers that are not finite")
        return change_of_velocities(self.robot, ask.q, ask.v)

    def _update(self, ask: Question) -> Change:
        """Set q and v."""
        change = self.change(ask)
        self._set(self.positions(ask.q), change.to_engine_v(ask.v))
        return change

    def _set(self, q: Array, v: Array) -> None:
        """Set q_e and v_e, whereupon Drake forgets what it has computed."""
        self.plant.SetPositions(self.context, q)
        self.plant.SetVelocities(self.context, v)

    # ---- calls that can be timed, in Drake's coordinates

    def inverse_dynamics(self, q: Array, v: Array, a: Array) -> Array:
        """Compute tau_e by CalcInverseDynamics under gravity; this can be timed.

        Parameters
        ----------
        q : ndarray, shape (nq of Drake,)
            q_e.
        v : ndarray, shape (nv,)
            v_e, m/s or rad/s.
        a : ndarray, shape (nv,)
            a_e, m/s² or rad/s².

        Returns
        -------
        ndarray, shape (nv,)
            tau_e, N or N m.
        """
        self._set(q, v)
        self.plant.CalcForceElementsContribution(self.context, self.forces)
        return self.plant.CalcInverseDynamics(self.context, a, self.forces)

    def crba(self, q: Array) -> Array:
        """Compute M_e by the composite body algorithm; this can be timed.

        Parameters
        ----------
        q : ndarray, shape (nq of Drake,)
            q_e.

        Returns
        -------
        ndarray, shape (nv, nv)
            M_e, kg, kg m or kg m².
        """
        self.plant.SetPositions(self.context, q)
        return self.plant.CalcMassMatrix(self.context)

    def aba(self, q: Array, v: Array, tau: Array) -> Array:
        """Compute a_e by the articulated body algorithm; this can be timed.

        Parameters
        ----------
        q : ndarray, shape (nq of Drake,)
            q_e.
        v : ndarray, shape (nv,)
            v_e, m/s or rad/s.
        tau : ndarray, shape (nv,)
            tau_e, N or N m.

        Returns
        -------
        ndarray, shape (nv,)
            a_e, m/s² or rad/s².
        """
        self._set(q, v)
        self.drive.GetMutableData().get_mutable_value().SetFromVector(tau)
        return self.plant.get_generalized_acceleration_output_port().Eval(self.context)

    def kinetic_energy(self, q: Array, v: Array) -> float:
        """Compute ½ v' M v; this can be timed.

        Parameters
        ----------
        q : ndarray, shape (nq of Drake,)
            q_e.
        v : ndarray, shape (nv,)
            v_e, m/s or rad/s.

        Returns
        -------
        float
            In J.
        """
        self._set(q, v)
        return self.plant.CalcKineticEnergy(self.context)

    def jacobian(self, q: Array, number: int) -> Array:
        """Compute J_e of a body, or of the world, in world axes at its origin; this can be timed.

        Parameters
        ----------
        q : ndarray, shape (nq of Drake,)
            q_e.
        number : int
            The body's index in the description, or `clock.NOTHING`.

        Returns
        -------
        ndarray, shape (6, nv)
            J_e with J_e v_e = [angular; linear], m or without unit.
        """
        self.plant.SetPositions(self.context, q)
        world, speeds = self.plant.world_frame(), tree.JacobianWrtVariable.kV
        frame = world if number == NOTHING else self.bodies[number].body_frame()
        return self.plant.CalcJacobianSpatialVelocity(self.context, speeds, frame, np.zeros(3), world, world)

    # ---- dynamics

    def inverse_wrench(self, ask: Question) -> Array:
        """Answer `id_wrench` by CalcInverseDynamics under gravity and a force on every body, in its axes at its origin.

        Returns
        -------
        ndarray, shape (nv,)
            Forces of the joints, N or N m.
        """
        change = self._update(ask)
        self.plant.CalcForceElementsContribution(self.context, self.forces)
        for body, wrench in zip(self.bodies, ask.wrench, strict=True):
            force = SpatialForce(tau=wrench[:3], f=wrench[3:])
            body.AddInForce(self.context, np.zeros(3), force, body.body_frame(), self.forces)
        return change.to_neutral_tau(self.plant.CalcInverseDynamics(self.context, change.to_engine_a(ask.a), self.forces))

    def bias_term(self, ask: Question) -> Array:
        """Answer `bias` by h = T' (C v - tau_gravity + M_e b).

        Returns
        -------
        ndarray, shape (nv,)
            Forces of the joints, N or N m.
        """
        change = self._update(ask)
        bias = self.plant.CalcBiasTerm(self.context) - self.plant.CalcGravityGeneralizedForces(self.context)
        if change.b.any():
            bias += self.plant.CalcMassMatrix(self.context) @ change.b
        return change.to_neutral_tau(bias)

    def mass_by_inverse_dynamics(self, ask: Question) -> Array:
        """Answer `mass_matrix` column by column from inverse dynamics.

        Returns
        -------
        ndarray, shape (nv, nv)
            Both triangles of M, kg, kg m or kg m².
        """
        change = self._update(ask)
        return change.to_neutral_mass(self.plant.CalcMassMatrixViaInverseDynamics(self.context))

    def probe(self, ask: Question) -> Array:
        """Answer `mass_matrix_probe` by the M of `crba`.

        Returns
        -------
        ndarray, shape (6, nv)
            M x for the four rows x of `probe`, the diagonal of M, its last row.
        """
        mass = self.change(ask).to_neutral_mass(self.crba(self.positions(ask.q)))
        return mass_matrix_probe(mass.__matmul__, np.diag(mass), ask.probe)

    # ---- energies, momentum, kinematics

    def potential_energy(self, ask: Question) -> float:
        """Answer -Σ m g·c.

        Returns
        -------
        float
            In J.
        """
        self._update(ask)
        return self.plant.CalcPotentialEnergy(self.context)

    def com(self, ask: Question) -> Array:
        """Answer where the centre of mass is.

        Returns
        -------
        ndarray, shape (3,)
            In world axes, m.
        """
        self._update(ask)
        return self.plant.CalcCenterOfMassPositionInWorld(self.context)

    def momentum(self, ask: Question) -> Array:
        """Answer the spatial momentum about the centre of mass.

        Returns
        -------
        ndarray, shape (6,)
            [angular about the centre of mass; linear] in world axes, kg m²/s and kg m/s.
        """
        momentum = self.plant.CalcSpatialMomentumInWorldAboutPoint(self.context, self.com(ask))
        return np.append(momentum.rotational(), momentum.translational())

    def placement(self, ask: Question) -> list[Array]:
        """Answer where each body is.

        Returns
        -------
        list of ndarray, shape (12,)
            Of each body its rotation to world axes, row by row, and its origin in m.
        """
        self._update(ask)
        poses = [body.EvalPoseInWorld(self.context) for body in self.bodies]
        return [np.append(pose.rotation().matrix().ravel(), pose.translation()) for pose in poses]

    def velocity(self, ask: Question) -> list[Array]:
        """Answer the velocity of each body in world axes at its origin.

        Returns
        -------
        list of ndarray, shape (6,)
            Of each body [angular; linear], rad/s and m/s.
        """
        self._update(ask)
        velocities = [body.EvalSpatialVelocityInWorld(self.context) for body in self.bodies]
        return [np.append(v.rotational(), v.translational()) for v in velocities]

    def acceleration(self, ask: Question) -> list[Array]:
        """Answer the acceleration of each body: Drake's spatial one is the classical one of the body's origin.

        Returns
        -------
        list of ndarray, shape (6,)
            Of each body [angular; linear], without gravity, rad/s² and m/s².
        """
        change = self._update(ask)
        by_index = self.plant.CalcSpatialAccelerationsFromVdot(self.context, change.to_engine_a(ask.a))
        accelerations = [by_index[body.index()] for body in self.bodies]
        return [np.append(a.rotational(), a.translational()) for a in accelerations]


class Drake:
    """The engine: what `session.serve` asks."""

    name = "drake"
    version = importlib.metadata.version("drake")
    build = {"language": "C++ (Python package drake)"}
    quantities: Quantities = {
        "id": {"inverse_dynamics": Calls("q v a", DrakeRobot.inverse_dynamics, Change.to_neutral_tau)},
        "id_wrench": {"inverse_dynamics": DrakeRobot.inverse_wrench},
        "bias": {
            "bias_term": DrakeRobot.bias_term,
            "inverse_dynamics": Calls("q v b", DrakeRobot.inverse_dynamics, Change.to_neutral_tau),
        },
        "mass_matrix": {
            "crba": Calls("q", DrakeRobot.crba, Change.to_neutral_mass),
            "inverse_dynamics": DrakeRobot.mass_by_inverse_dynamics,
        },
        "mass_matrix_sparse": {"crba": Calls("q", DrakeRobot.crba, Change.to_neutral_mass)},
        "mass_matrix_probe": {"crba": DrakeRobot.probe},
        "fd": {"aba": Calls("q v tau", DrakeRobot.aba, Change.to_neutral_a)},
        "kinetic_energy": {"kinetic_energy": Calls("q v", DrakeRobot.kinetic_energy)},
        "potential_energy": {"potential_energy": DrakeRobot.potential_energy},
        "com": {"center_of_mass": DrakeRobot.com},
        "momentum": {"spatial_momentum": DrakeRobot.momentum},
        "body_placement": {"body_poses": DrakeRobot.placement},
        "body_velocity": {"body_velocities": DrakeRobot.velocity},
        "body_acceleration": {"spatial_accelerations": DrakeRobot.acceleration},
        "body_jacobian": {"jacobian_spatial_velocity": Calls("q body", DrakeRobot.jacobian, Change.to_neutral_jacobian)},
    }

    def prepare(self, description: Description) -> DrakeRobot:
        """Build the robot.

        Parameters
        ----------
        description : Description
            The robot.

        Returns
        -------
        DrakeRobot
            The same in Drake.

        Raises
        ------
        Unsupported
            If Drake has no such robot.
        """
        return DrakeRobot(description, *build(description))

    def read(self, path: Path, form: str, base: str) -> Reading:
        """Have Drake's own parser read a file.

        Parameters
        ----------
        path : Path
            The file.
        form : str
            `urdf` or `mjcf`.
        base : str
            `fixed` or `free`.

        Returns
        -------
        Reading
            What Drake holds of it.
        """
        return reading.read(path, form, base, DrakeRobot)
