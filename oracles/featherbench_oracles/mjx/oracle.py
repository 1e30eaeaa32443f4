"""MuJoCo XLA as an oracle.

MuJoCo compiles the model, and MJX computes with it by JAX, in single precision as JAX does by default. The coordinates are MuJoCo's,
converted in double. XLA compiles each function once for each robot.
"""

from __future__ import annotations

import importlib.metadata
from collections.abc import Callable
from functools import cached_property
from pathlib import Path
from typing import Any

import jax
import mujoco as mj
import numpy as np
from mujoco import mjx

from featherbench_oracles.abilities import ReadsFiles
from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.change import CoordinateChange
from featherbench_oracles.core.protocol import Quantities, Reading, State, Unsupported, mass_matrix_probe
from featherbench_oracles.core.robot import Description
from featherbench_oracles.mujoco import reading
from featherbench_oracles.mujoco.building import build
from featherbench_oracles.mujoco.coordinates import change_of_velocities, to_engine_q
from featherbench_oracles.mujoco.oracle import MujocoRobot

HELD = ("body_mass", "body_ipos", "body_inertia", "body_iquat", "body_pos", "body_quat", "jnt_pos")
Compiled = Callable[..., Any]


class MjxRobot(MujocoRobot):
    """A robot in MJX. Every method that takes a question answers one quantity at its state, as `protocol.Engine` says.

    Parameters
    ----------
    robot : Description
        The robot's coordinates.
    model : mj.MjModel
        The robot.
    """

    def __init__(self, robot: Description, model: mj.MjModel) -> None:
        super().__init__(robot, model)
        try:
            self.xla = mjx.put_model(model)
        except NotImplementedError as reason:
            raise Unsupported(f"MJX has not all of the model: {reason}") from reason
        self.start = mjx.make_data(model)
        for name in HELD:  # so that what is read back is what it holds
            getattr(model, name)[:] = np.array(getattr(self.xla, name)).reshape(getattr(model, name).shape)

    def _at(self, qpos: Any, qvel: Any) -> Any:
        data = mjx.fwd_position(self.xla, self.start.replace(qpos=qpos, qvel=qvel))
        return mjx.fwd_velocity(self.xla, data)

    @cached_property
    def placed(self) -> Compiled:
        """Compute what depends on q and v: h, M, the pose of each body, the centre of mass."""

        def function(qpos: Any, qvel: Any) -> Any:
            data = self._at(qpos, qvel)
            return data.qfrc_bias, mjx.full_m(self.xla, data), data.xmat, data.xpos, data.subtree_com

        return jax.jit(function)

    @cached_property
    def inverted(self) -> Compiled:
        """Compute tau from q, v and a."""

        def function(qpos: Any, qvel: Any, qacc: Any) -> Any:
            return mjx.inverse(self.xla, self.start.replace(qpos=qpos, qvel=qvel, qacc=qacc)).qfrc_inverse

        return jax.jit(function)

    @cached_property
    def accelerated(self) -> Compiled:
        """Compute a from q, v and tau."""

        def function(qpos: Any, qvel: Any, applied: Any) -> Any:
            data = self._at(qpos, qvel).replace(qfrc_applied=applied)
            return mjx.fwd_acceleration(self.xla, mjx.fwd_actuation(self.xla, data)).qacc_smooth

        return jax.jit(function)

    def _change(self, ask: State) -> tuple[CoordinateChange, Array, Array]:
        """Find the coordinates of MuJoCo."""
        change = change_of_velocities(self.robot, ask.q, ask.v)
        return change, to_engine_q(self.robot, ask.q), change.to_engine_v(ask.v)

    def _placed(self, ask: State) -> tuple[CoordinateChange, list[Array]]:
        change, q, v = self._change(ask)
        return change, [np.array(held, dtype=float) for held in self.placed(q, v)]

    def inverse_x(self, ask: State) -> Array:
        """Answer `id` by inverse."""
        change, q, v = self._change(ask)
        return change.to_neutral_tau(np.array(self.inverted(q, v, change.to_engine_a(ask.a)), dtype=float))

    def bias_x(self, ask: State) -> Array:
        """Answer `bias` by h = T' (qfrc_bias + M_e b)."""
        change, (bias, mass, *_) = self._placed(ask)
        return change.to_neutral_tau(bias + mass @ change.b)

    def mass_x(self, ask: State) -> Array:
        """Answer `mass_matrix` by full_m."""
        change, (_, mass, *_) = self._placed(ask)
        return change.to_neutral_mass(mass)

    def probe_x(self, ask: State) -> Array:
        """Answer `mass_matrix_probe` by full_m."""
        mass = self.mass_x(ask)
        return mass_matrix_probe(mass.__matmul__, np.diag(mass), ask.probe)

    def forward_x(self, ask: State) -> Array:
        """Answer `fd` by fwd_acceleration; there are no constraints to solve for."""
        change, q, v = self._change(ask)
        return change.to_neutral_a(np.array(self.accelerated(q, v, change.to_engine_tau(ask.tau)), dtype=float))

    def com_x(self, ask: State) -> Array:
        """Answer `com` by subtree_com."""
        return self._placed(ask)[1][4][0]

    def placement_x(self, ask: State) -> Array:
        """Answer `body_placement` by xmat and xpos."""
        self._all_held("placement")
        _, (_, _, xmat, xpos, _) = self._placed(ask)
        return np.hstack([xmat[1:].reshape(-1, 9), xpos[1:]])


class Mjx(ReadsFiles):
    """The engine MJX, for `session.serve`."""

    name = "mjx"
    version = importlib.metadata.version("mujoco-mjx")
    build = {
        "language": "Python, compiled by XLA",
        "packages": f"jax {jax.__version__}, mujoco {mj.mj_versionString()}",
        "precision": "single",
    }
    formats = ("urdf", "mjcf")
    quantities: Quantities = {
        "id": {"inverse": MjxRobot.inverse_x},
        "bias": {"qfrc_bias": MjxRobot.bias_x},
        "mass_matrix": {"full_m": MjxRobot.mass_x},
        "mass_matrix_probe": {"full_m": MjxRobot.probe_x},
        "fd": {"fwd_acceleration": MjxRobot.forward_x},
        "com": {"subtree_com": MjxRobot.com_x},
        "body_placement": {"kinematics": MjxRobot.placement_x},
    }

    def prepare(self, description: Description) -> MjxRobot:
        """Build the robot by MuJoCo."""
        return MjxRobot(description, build(description))

    def read(self, path: Path, form: str, base: str) -> Reading:
        """Read a file by MuJoCo's parser and compiler."""
        return reading.read(path, form, base, MjxRobot)
