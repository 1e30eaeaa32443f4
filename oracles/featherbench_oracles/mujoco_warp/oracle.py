"""MuJoCo Warp as an oracle.

MuJoCo compiles the model, and MuJoCo Warp computes with it in single precision. The oracle's coordinates are MuJoCo's, converted in double.
"""

from __future__ import annotations

import importlib.metadata
from pathlib import Path

import mujoco as mj
import mujoco_warp as mjw
import numpy as np
import warp as wp

from featherbench_oracles.abilities import ReadsFiles
from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.change import CoordinateChange
from featherbench_oracles.core.protocol import Quantities, Reading, State, Unsupported, mass_matrix_probe
from featherbench_oracles.core.robot import Description
from featherbench_oracles.mujoco import reading
from featherbench_oracles.mujoco.building import build
from featherbench_oracles.mujoco.coordinates import change_of_velocities, to_engine_q
from featherbench_oracles.mujoco.oracle import MujocoRobot

wp.config.log_level = 30  # warnings: its kernels' names are no news
HELD = ("body_mass", "body_ipos", "body_inertia", "body_iquat", "body_pos", "body_quat", "jnt_pos")


class WarpRobot(MujocoRobot):
    """A robot in MuJoCo Warp. Every method that takes a question answers one quantity at its state, as `protocol.Engine` says.

    Parameters
    ----------
    robot : Description
        The robot's coordinates.
    model : mj.MjModel
        The robot.
    """

    def __init__(self, robot: Description, model: mj.MjModel) -> None:
        super().__init__(robot, model)
        model.opt.disableflags &= ~int(mj.mjtDisableBit.mjDSBL_AUTORESET)  # it has no automatic resets to disable
        try:
            self.single = mjw.put_model(model)
        except NotImplementedError as reason:
            raise Unsupported(f"MuJoCo Warp has not all of the model: {reason}") from reason
        self.worlds = mjw.put_data(model, self.data, nworld=1)
        for name in HELD:  # so that what is read back is what it holds
            getattr(model, name)[:] = getattr(self.single, name).numpy().reshape(getattr(model, name).shape)

    def _place(self, ask: State) -> CoordinateChange:
        """Set q and v, and compute what depends on them."""
        change = change_of_velocities(self.robot, ask.q, ask.v)
        self._set("qpos", to_engine_q(self.robot, ask.q))
        self._set("qvel", change.to_engine_v(ask.v))
        mjw.fwd_position(self.single, self.worlds)
        mjw.fwd_velocity(self.single, self.worlds)
        return change

    def _set(self, name: str, numbers: Array) -> None:
        getattr(self.worlds, name).assign(numbers.astype(np.float32)[None])

    def _get(self, name: str) -> Array:
        return getattr(self.worlds, name).numpy()[0].astype(np.float64)

    def _mass(self) -> Array:
        """Unpack M, whose rows hold a dof and its ancestors."""
        stored, mass = self._get("M").ravel(), np.zeros((self.model.nv, self.model.nv))
        for i in range(self.model.nv):
            row = slice(self.model.M_rowadr[i], self.model.M_rowadr[i] + self.model.M_rownnz[i])
            columns = self.model.M_colind[row]
            mass[i, columns] = mass[columns, i] = stored[row]
        return mass

    def inverse_single(self, ask: State) -> Array:
        """Answer `id` by inverse."""
        change = self._place(ask)
        self._set("qacc", change.to_engine_a(ask.a))
        mjw.inverse(self.single, self.worlds)
        return change.to_neutral_tau(self._get("qfrc_inverse"))

    def bias_single(self, ask: State) -> Array:
        """Answer `bias` by h = T' (qfrc_bias + M_e b)."""
        change = self._place(ask)
        return change.to_neutral_tau(self._get("qfrc_bias") + self._mass() @ change.b)

    def mass_single(self, ask: State) -> Array:
        """Answer `mass_matrix` by the M of fwd_position."""
        return self._place(ask).to_neutral_mass(self._mass())

    def probe_single(self, ask: State) -> Array:
        """Answer `mass_matrix_probe` by the M of `mass_matrix`."""
        mass = self.mass_single(ask)
        return mass_matrix_probe(mass.__matmul__, np.diag(mass), ask.probe)

    def forward_single(self, ask: State) -> Array:
        """Answer `fd` by fwd_acceleration. Without constraints no solver runs: its kernels are compiled for each number of dofs."""
        change = self._place(ask)
        self._set("qfrc_applied", change.to_engine_tau(ask.tau))
        mjw.fwd_actuation(self.single, self.worlds)
        mjw.fwd_acceleration(self.single, self.worlds)
        return change.to_neutral_a(self._get("qacc_smooth"))

    def com_single(self, ask: State) -> Array:
        """Answer `com` by subtree_com."""
        self._place(ask)
        return self._get("subtree_com")[0]

    def placement_single(self, ask: State) -> Array:
        """Answer `body_placement` by the xmat and xpos of fwd_position."""
        self._all_held("placement")
        self._place(ask)
        return np.hstack([self._get("xmat")[1:].reshape(-1, 9), self._get("xpos")[1:]])


class MujocoWarp(ReadsFiles):
    """The engine MuJoCo Warp, for `session.serve`."""

    name = "mujoco_warp"
    version = importlib.metadata.version("mujoco-warp")
    build = {
        "language": "Python, compiled by Warp",
        "packages": f"warp-lang {wp.__version__}, mujoco {mj.mj_versionString()}",
        "precision": "single",
    }
    formats = ("urdf", "mjcf")
    quantities: Quantities = {
        "id": {"inverse": WarpRobot.inverse_single},
        "bias": {"qfrc_bias": WarpRobot.bias_single},
        "mass_matrix": {"crb": WarpRobot.mass_single},
        "mass_matrix_probe": {"crb": WarpRobot.probe_single},
        "fd": {"fwd_acceleration": WarpRobot.forward_single},
        "com": {"subtree_com": WarpRobot.com_single},
        "body_placement": {"kinematics": WarpRobot.placement_single},
    }

    def prepare(self, description: Description) -> WarpRobot:
        """Build the robot by MuJoCo."""
        return WarpRobot(description, build(description))

    def read(self, path: Path, form: str, base: str) -> Reading:
        """Read a file by MuJoCo's parser and compiler."""
        return reading.read(path, form, base, WarpRobot)
