"""MuJoCo as an oracle."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path

import mujoco as mj
import numpy as np

from featherbench_oracles.abilities import (
    HasContactSteps,
    HasLoops,
    HasRods,
    HasSceneDerivatives,
    HasScenes,
    HasVariants,
    ReadsFiles,
    WritesFiles,
)
from featherbench_oracles.abilities.derivatives import Differentiated
from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.change import CoordinateChange
from featherbench_oracles.core.messages import Header
from featherbench_oracles.core.protocol import Quantities, Reading, State, Unsupported, mass_matrix_probe, readback_row
from featherbench_oracles.core.robot import Description
from featherbench_oracles.mujoco import reading, scenes, standing, writing
from featherbench_oracles.mujoco.building import build, chains, motions
from featherbench_oracles.mujoco.coordinates import change_of_velocities, from_wxyz, rates_of_change, to_engine_q
from featherbench_oracles.mujoco.holding import LOOPS
from featherbench_oracles.mujoco.rods import RODS


class MujocoRobot:
    """A robot in MuJoCo. Every method that takes a question answers one quantity at its state, as `protocol.Engine` says.

    Parameters
    ----------
    robot : Description
        The robot's coordinates.
    model : mj.MjModel
        The robot; where it was built from the description, chain i is MuJoCo's body i + 1, as body 0 is the world.
    """

    def __init__(self, robot: Description, model: mj.MjModel) -> None:
        self.robot, self.model, self.data = robot, model, mj.MjData(model)
        self.held = {chain[-1]: i for i, chain in enumerate(chains(robot), start=1)}

    def _all_held(self, quantity: str) -> None:
        """Raise `Unsupported` if MuJoCo lacks bodies of the description that the quantity needs."""
        folded = len(self.robot.bodies) - len(self.held)
        if folded:
            raise Unsupported(f"MuJoCo has no massless bodies: {folded} are joints of the next one, and have no {quantity} of their own")

    def readback(self) -> list[Array]:
        """Read back I = R diag(principal) R'. A folded body has no inertia, only the placement of its joint."""
        m, rows = self.model, []
        for i, chain in enumerate(chains(self.robot), start=1):
            turn, joint = from_wxyz(m.body_quat[i]), m.body_jntadr[i]
            place = m.body_pos[i] + turn @ m.jnt_pos[joint]
            for body in chain[:-1]:
                rows.append(readback_row(0.0, np.zeros(3), np.zeros((3, 3)), turn, place))
                before, joint = joint, joint + len(motions(self.robot.bodies[body].joint))
                turn, place = np.eye(3), m.jnt_pos[joint] - m.jnt_pos[before]
            axes = from_wxyz(m.body_iquat[i])
            inertia = (axes * m.body_inertia[i]) @ axes.T
            rows.append(readback_row(m.body_mass[i], m.body_ipos[i], inertia, turn, place))
        return rows

    def _update(self, ask: State) -> CoordinateChange:
        """Set q and v, and compute what depends on them."""
        change = change_of_velocities(self.robot, ask.q, ask.v)
        self.data.qpos = to_engine_q(self.robot, ask.q)
        self.data.qvel = change.to_engine_v(ask.v)
        mj.mj_fwdPosition(self.model, self.data)
        mj.mj_fwdVelocity(self.model, self.data)
        return change

    # ---- dynamics

    def _inverse(self, a: Array) -> Array:
        """Compute tau_e at engine accelerations."""
        self.data.qacc = a
        mj.mj_inverse(self.model, self.data)
        return self.data.qfrc_inverse.copy()

    def inverse(self, ask: State) -> Array:
        """Answer `id` by mj_inverse, armature included."""
        change = self._update(ask)
        return change.to_neutral_tau(self._inverse(change.to_engine_a(ask.a)))

    def rne(self, ask: State) -> Array:
        """Answer `id` by mj_rne + armature a_e."""
        change = self._update(ask)
        self.data.qacc = change.to_engine_a(ask.a)
        tau = np.empty(self.model.nv)
        mj.mj_rne(self.model, self.data, 1, tau)
        return change.to_neutral_tau(tau + self.model.dof_armature * self.data.qacc)

    def inverse_wrench(self, ask: State) -> Array:
        """Answer `id_wrench` by mj_inverse - Σ J' f, because mj_inverse ignores applied forces."""
        self._all_held("wrench")
        change = self._update(ask)
        tau = self._inverse(change.to_engine_a(ask.a))
        applied = np.zeros(self.model.nv)
        for i, wrench in enumerate(ask.wrench, start=1):
            r = self.data.xmat[i].reshape(3, 3)
            mj.mj_applyFT(self.model, self.data, r @ wrench[3:], r @ wrench[:3], self.data.xpos[i], i, applied)
        return change.to_neutral_tau(tau - applied)

    def qfrc_bias(self, ask: State) -> Array:
        """Answer `bias` by h = T' (qfrc_bias + M_e b)."""
        change = self._update(ask)
        return change.to_neutral_tau(self.data.qfrc_bias + self._product(change.b))

    def bias_inverse(self, ask: State) -> Array:
        """Answer `bias` by mj_inverse at a = 0."""
        change = self._update(ask)
        return change.to_neutral_tau(self._inverse(change.b))

    def _product(self, x: Array) -> Array:
        """Compute M_e x."""
        y = np.empty(self.model.nv)
        mj.mj_mulM(self.model, self.data, y, x)
        return y

    def crb(self, ask: State) -> Array:
        """Answer `mass_matrix` by mj_fullM, after the composite rigid body algorithm."""
        change = self._update(ask)
        mass = np.empty((self.model.nv, self.model.nv))
        mj.mj_fullM(self.model, self.data, mass)
        return change.to_neutral_mass(mass)

    def probe(self, ask: State) -> Array:
        """Answer `mass_matrix_probe` by mj_mulM.

        The diagonal is the last entry of each row of the sparse M. Where T is not identity, it is e_i' M e_i.
        """
        change = self._update(ask)

        def product(x: Array) -> Array:
            return change.to_neutral_tau(self._product(change.to_engine_v(x)))

        diagonal = self.data.M[self.model.M_rowadr + self.model.M_rownnz - 1]
        for dofs, _ in change.blocks:
            for i in range(dofs.start, dofs.stop):
                unit = np.zeros(self.model.nv)
                unit[i] = 1
                diagonal[i] = product(unit)[i]
        return mass_matrix_probe(product, diagonal, ask.probe)

    def forward(self, ask: State) -> Array:
        """Answer `fd` by mj_forward: a = M^-1 (tau - h) with the sparse factors L' D L of M."""
        change = self._update(ask)
        self.data.qfrc_applied = change.to_engine_tau(ask.tau)
        mj.mj_forward(self.model, self.data)
        return change.to_neutral_a(self.data.qacc.copy())

    def stored(self, _ask: State) -> float:
        """Answer `stored_entries` by nM: one number for each dof and ancestor."""
        return self.model.nM

    # ---- derivatives, by finite differences

    def _differentiated(self, ask: State) -> Differentiated:
        """Set q and v, and find the way back of derivatives."""
        return Differentiated(self._update(ask), rates_of_change(self.robot, ask.q, ask.v))

    def _inverse_differences(self, ask: State, eps: float) -> tuple[Differentiated, Array, Array, Array, Array]:
        """Compute tau_e, and its derivatives by q_e, v_e and a_e by mjd_inverseFD, whose matrices are transposed."""
        way = self._differentiated(ask)
        tau = self._inverse(way.change.to_engine_a(ask.a))
        by_q, by_v, by_a = np.zeros((3, self.model.nv, self.model.nv))
        mj.mjd_inverseFD(self.model, self.data, eps, False, by_q, by_v, by_a, None, None, None, None)
        return way, tau, by_q.T, by_v.T, by_a.T

    def inverse_dq(self, ask: State, eps: float) -> Array:
        """Answer `id_dq` by mjd_inverseFD, which takes forward differences of the step `eps`."""
        way, tau, by_q, by_v, mass = self._inverse_differences(ask, eps)
        return way.id_dq(ask, tau, by_q, by_v, mass)

    def inverse_dv(self, ask: State, eps: float) -> Array:
        """Answer `id_dv` by mjd_inverseFD, which takes forward differences of the step `eps`."""
        way, _, _, by_v, mass = self._inverse_differences(ask, eps)
        return way.id_dv(by_v, mass)

    def _transition_differences(self, ask: State, eps: float, centred: bool) -> tuple[Differentiated, Array, Array, Array]:
        """Compute the neutral a, and the derivatives of a_e by q_e and v_e by mjd_transitionFD.

        Without damping, a step of one second ends with v_e + a_e. So the lower half of the transition matrix is [d_q a_e, 1 + d_v a_e].
        """
        way, nv = self._differentiated(ask), self.model.nv
        self.data.qfrc_applied = way.change.to_engine_tau(ask.tau)
        mj.mj_forward(self.model, self.data)
        a = way.change.to_neutral_a(self.data.qacc.copy())
        transition, timestep = np.zeros((2 * nv, 2 * nv)), self.model.opt.timestep
        self.model.opt.timestep = 1.0
        try:
            mj.mjd_transitionFD(self.model, self.data, eps, centred, transition, None, None, None)
        finally:
            self.model.opt.timestep = timestep
        return way, a, transition[nv:, :nv], transition[nv:, nv:] - np.eye(nv)

    def forward_dq(self, ask: State, eps: float, centred: bool) -> Array:
        """Answer `fd_dq` by mjd_transitionFD with the step `eps`. M^-1 is that of mj_solveM."""
        way, a, by_q, by_v = self._transition_differences(ask, eps, centred)
        inverse = np.empty((self.model.nv, self.model.nv))
        mj.mj_solveM(self.model, self.data, inverse, np.eye(self.model.nv))
        return way.fd_dq(ask, a, by_q, by_v, inverse)

    def forward_dv(self, ask: State, eps: float, centred: bool) -> Array:
        """Answer `fd_dv` by mjd_transitionFD with the step `eps`."""
        way, _, _, by_v = self._transition_differences(ask, eps, centred)
        return way.fd_dv(by_v)

    # ---- energies, momentum, kinematics

    def kinetic_energy(self, ask: State) -> float:
        """Answer `kinetic_energy` by mj_energyVel."""
        self._update(ask)
        mj.mj_energyVel(self.model, self.data)
        return self.data.energy[1]

    def potential_energy(self, ask: State) -> float:
        """Answer `potential_energy` by mj_energyPos."""
        self._update(ask)
        mj.mj_energyPos(self.model, self.data)
        return self.data.energy[0]

    def com(self, ask: State) -> Array:
        """Answer `com` by subtree_com."""
        self._update(ask)
        return self.data.subtree_com[0]

    def momentum(self, ask: State) -> Array:
        """Answer `momentum` by mj_subtreeVel; the linear part is the total mass times the velocity of the centre of mass."""
        self._update(ask)
        mj.mj_subtreeVel(self.model, self.data)
        return np.append(self.data.subtree_angmom[0], self.model.body_subtreemass[0] * self.data.subtree_linvel[0])

    def placement(self, ask: State) -> Array:
        """Answer `body_placement` by the xmat and xpos of mj_fwdPosition."""
        self._all_held("placement")
        self._update(ask)
        return np.hstack([self.data.xmat[1:], self.data.xpos[1:]])

    def velocity(self, ask: State) -> Array:
        """Answer `body_velocity` by mj_objectVelocity."""
        self._all_held("velocity")
        self._update(ask)
        velocities = np.empty((self.model.nbody, 6))
        for i, row in enumerate(velocities):
            mj.mj_objectVelocity(self.model, self.data, mj.mjtObj.mjOBJ_XBODY, i, row, 0)
        return velocities[1:]

    def acceleration(self, ask: State) -> Array:
        """Answer `body_acceleration` by mj_objectAcceleration + g: MuJoCo's contains -g."""
        self._all_held("acceleration")
        change = self._update(ask)
        self.data.qacc = change.to_engine_a(ask.a)
        mj.mj_rnePostConstraint(self.model, self.data)
        accelerations = np.empty((self.model.nbody, 6))
        for i, row in enumerate(accelerations):
            mj.mj_objectAcceleration(self.model, self.data, mj.mjtObj.mjOBJ_XBODY, i, row, 0)
        return accelerations[1:] + np.append(np.zeros(3), self.model.opt.gravity)

    def jacobian(self, ask: State) -> Array:
        """Answer `body_jacobian` by mj_jacBody."""
        if ask.body not in self.held:
            self._all_held("Jacobian")
        change = self._update(ask)
        angular, linear = np.zeros((2, 3, self.model.nv))
        mj.mj_jacBody(self.model, self.data, linear, angular, self.held[ask.body])
        return change.to_neutral_jacobian(np.vstack([angular, linear]))


STEPS = ("1e-4", "1e-5", "1e-6", "1e-7", "1e-8")  # of finite differences, in the units of q and v


def _with_steps(answer: Callable[..., Array], kind: str, **settings: bool) -> dict[str, Callable[..., Array]]:
    """Make one method of each step, 1e-6 first, which MuJoCo's documentation names."""
    ordered = sorted(STEPS, key=lambda eps: eps != "1e-6")
    return {f"{kind}_{eps}": partial(answer, eps=float(eps), **settings) for eps in ordered}


def _forward_and_centred(answer: Callable[..., Array]) -> dict[str, Callable[..., Array]]:
    """Make the methods of centred and of forward differences."""
    return _with_steps(answer, "difference_centred", centred=True) | _with_steps(answer, "difference", centred=False)


class Mujoco(ReadsFiles, WritesFiles, HasVariants, HasContactSteps, HasLoops, HasRods, HasScenes, HasSceneDerivatives):
    """The engine MuJoCo, for `session.serve`."""

    name = "mujoco"
    version = mj.mj_versionString()
    build = {"language": "C (Python package mujoco)"}
    rods = RODS
    formats = ("urdf", "mjcf")
    quantities: Quantities = {
        "id": {"inverse": MujocoRobot.inverse, "rne": MujocoRobot.rne},
        "id_wrench": {"inverse": MujocoRobot.inverse_wrench},
        "bias": {"qfrc_bias": MujocoRobot.qfrc_bias, "inverse": MujocoRobot.bias_inverse},
        "mass_matrix": {"crb": MujocoRobot.crb},
        "mass_matrix_probe": {"crb": MujocoRobot.probe},
        "fd": {"forward": MujocoRobot.forward},
        "kinetic_energy": {"energy_vel": MujocoRobot.kinetic_energy},
        "potential_energy": {"energy_pos": MujocoRobot.potential_energy},
        "com": {"subtree_com": MujocoRobot.com},
        "momentum": {"subtree_vel": MujocoRobot.momentum},
        "body_placement": {"kinematics": MujocoRobot.placement},
        "body_velocity": {"object_velocity": MujocoRobot.velocity},
        "body_acceleration": {"object_acceleration": MujocoRobot.acceleration},
        "body_jacobian": {"jac_body": MujocoRobot.jacobian},
        "stored_entries": {"nM": MujocoRobot.stored},
        "id_dq": _with_steps(MujocoRobot.inverse_dq, "difference"),
        "id_dv": _with_steps(MujocoRobot.inverse_dv, "difference"),
        "fd_dq": _forward_and_centred(MujocoRobot.forward_dq),
        "fd_dv": _forward_and_centred(MujocoRobot.forward_dv),
    }

    contact_steps = standing.METHODS
    loops = LOOPS
    scene_variants = scenes.VARIANTS
    scene_derivatives = scenes.DERIVATIVES

    def prepare(self, description: Description) -> MujocoRobot:
        """Build the robot."""
        return MujocoRobot(description, build(description))

    def read(self, path: Path, form: str, base: str) -> Reading:
        """Read a file by MuJoCo's parser and compiler."""
        return reading.read(path, form, base, MujocoRobot)

    def rewrite(self, path: Path, form: str, into: Path) -> list[Header]:
        """Write a URDF or an MJCF as MJCF."""
        del form
        return writing.rewrite(path, into)

    def variants(self, path: Path, form: str) -> list[Header]:
        """List the variants of an MJCF."""
        return reading.variants_of(path) if form == "mjcf" else []
