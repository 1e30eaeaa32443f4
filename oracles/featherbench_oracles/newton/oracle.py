"""Newton as an oracle, in single precision. Coordinates are converted in double."""

from __future__ import annotations

import importlib.metadata
from functools import cached_property
from pathlib import Path

import newton
import numpy as np
import warp as wp
from numpy.typing import NDArray

from featherbench_oracles.abilities import ReadsFiles
from featherbench_oracles.core.algebra import Array, rotation
from featherbench_oracles.core.change import CoordinateChange
from featherbench_oracles.core.protocol import Quantities, Reading, State, Unsupported, mass_matrix_probe, readback_row
from featherbench_oracles.core.robot import Description
from featherbench_oracles.newton import reading
from featherbench_oracles.newton.building import build
from featherbench_oracles.newton.coordinates import change_of_velocities, to_engine_q
from featherbench_oracles.newton.reading import Read

STEP = 1e-3  # s, of the step whose acceleration is the forward dynamics

# What a file gives joints beside their inertia, and enters a step: springs of limits and of targets, damping, friction.
FORCES = tuple(f"joint_{name}" for name in ("limit_ke", "limit_kd", "target_ke", "target_kd", "stiffness", "damping", "friction"))


class NewtonRobot:
    """A robot in Newton. Every method that takes a question answers one quantity at its state, as `protocol.Engine` says.

    Parameters
    ----------
    robot : Description
        The robot's coordinates.
    model : newton.Model
        The robot.
    read : Read, optional
        Where its coordinates are, if it was read from a file. By default they are in the description's order.
    """

    def __init__(self, robot: Description, model: newton.Model, read: Read | None = None) -> None:
        self.robot, self.model, self.state = robot, model, model.state()
        nv = robot.nv
        # Newton's place of each coordinate; the body of a free root, whose centre of mass its velocity is that of
        self.q, self.v = np.array(read.q if read else range(robot.nq)), np.array(read.v if read else range(nv))
        self.root = int(read.index["joint_child"][read.order[0]]) if read else 0
        for name in FORCES:
            getattr(self.model, name).zero_()
        self.mass = wp.zeros((1, nv, nv), dtype=wp.float32)
        self.gravity, self.coriolis, self.force = (wp.zeros(nv, dtype=wp.float32) for _ in range(3))

    def readback(self) -> list[Array]:
        """Read back the inertias about the centres of mass, and the placements of joints."""
        rows = []
        held = zip(*(_doubles(getattr(self.model, name)) for name in ("body_mass", "body_com", "body_inertia", "joint_X_p")), strict=True)
        for (mass, com, inertia, place), joint in zip(held, (body.joint for body in self.robot.bodies), strict=True):
            turn, origin = rotation(place[3:]), place[:3]
            if joint.type == "free":  # its placement is part of the pose
                turn, origin = joint.rotation, joint.translation
            rows.append(readback_row(float(mass), com, inertia, turn, origin))
        return rows

    def _update(self, ask: State) -> CoordinateChange:
        """Set q and v, and compute M, the Coriolis force and the force of gravity."""
        change = change_of_velocities(self.robot, ask.q, ask.v, _doubles(self.model.body_com)[self.root])
        self.state.joint_q.assign(_placed(to_engine_q(self.robot, ask.q), self.q))
        self.state.joint_qd.assign(_placed(change.to_engine_v(ask.v), self.v))
        newton.eval_fk(self.model, self.state.joint_q, self.state.joint_qd, self.state)
        newton.eval_mass_matrix(self.model, self.state, self.mass)
        newton.eval_inverse_dynamics_passive(
            self.model, self.state, mass_matrix=self.mass, gravity_force=self.gravity, coriolis_force=self.coriolis
        )
        return change

    def _inverse(self, a: Array) -> Array:
        """Compute tau_e."""
        newton.eval_inverse_dynamics_force(
            self.model,
            self.state,
            mass_matrix=self.mass,
            joint_qdd=wp.array(_placed(a, self.v), dtype=wp.float32),
            coriolis_force=self.coriolis,
            gravity_force=self.gravity,
            joint_f=self.force,
        )
        return _doubles(self.force)[self.v]

    def inverse(self, ask: State) -> Array:
        """Answer `id` by eval_inverse_dynamics_force, which takes M, Coriolis force and gravity."""
        change = self._update(ask)
        return change.to_neutral_tau(self._inverse(change.to_engine_a(ask.a)))

    def bias(self, ask: State) -> Array:
        """Answer `bias` by the same at a = 0."""
        change = self._update(ask)
        return change.to_neutral_tau(self._inverse(change.b))

    def mass_matrix(self, ask: State) -> Array:
        """Answer `mass_matrix` by eval_mass_matrix."""
        return self._update(ask).to_neutral_mass(_doubles(self.mass)[0][self.v][:, self.v])

    def probe(self, ask: State) -> Array:
        """Answer `mass_matrix_probe` by the M of `mass_matrix`."""
        mass = self.mass_matrix(ask)
        return mass_matrix_probe(mass.__matmul__, np.diag(mass), ask.probe)

    @cached_property
    def featherstone(self) -> newton.solvers.SolverFeatherstone:
        """Make the solver that steps."""
        return newton.solvers.SolverFeatherstone(self.model, angular_damping=0.0)

    def forward(self, ask: State) -> Array:
        """Answer `fd` by joint_qdd of a step of SolverFeatherstone, the acceleration at its begin. Its free joint has other coordinates."""
        if any(body.joint.type == "free" for body in self.robot.bodies):
            raise Unsupported("Newton's SolverFeatherstone has other coordinates for a free joint")
        change, control = self._update(ask), self.model.control()
        control.joint_f.assign(_placed(change.to_engine_tau(ask.tau), self.v))
        self.featherstone.step(self.state, self.model.state(), control, None, STEP)
        return change.to_neutral_a(_doubles(self.featherstone.joint_qdd)[self.v])

    def placement(self, ask: State) -> list[Array]:
        """Answer `body_placement` by body_q."""
        self._update(ask)
        return [np.append(rotation(pose[3:]).ravel(), pose[:3]) for pose in _doubles(self.state.body_q)]


def _placed(given: Array, places: NDArray[np.intp]) -> NDArray[np.float32]:
    """Put numbers in Newton's order, in single."""
    held = np.empty(len(given), dtype=np.float32)
    held[places] = given
    return held


def _doubles(held: wp.array) -> Array:
    return np.array(held.numpy(), dtype=np.float64)


class Newton(ReadsFiles):
    """The engine Newton, for `session.serve`."""

    name = "newton"
    version = importlib.metadata.version("newton")
    build = {"language": "Python, compiled by Warp", "packages": f"warp-lang {wp.__version__}", "precision": "single"}
    formats = ("urdf", "mjcf", "usd")
    quantities: Quantities = {
        "id": {"inverse_dynamics_force": NewtonRobot.inverse},
        "bias": {"inverse_dynamics_force": NewtonRobot.bias},
        "mass_matrix": {"mass_matrix": NewtonRobot.mass_matrix},
        "mass_matrix_probe": {"mass_matrix": NewtonRobot.probe},
        "fd": {"featherstone": NewtonRobot.forward},
        "body_placement": {"fk": NewtonRobot.placement},
    }

    def prepare(self, description: Description) -> NewtonRobot:
        """Build the robot."""
        return NewtonRobot(description, build(description))

    def read(self, path: Path, form: str, base: str) -> Reading:
        """Read a file by Newton's own parser."""
        return reading.read(path, form, base, lambda held, got: NewtonRobot(held, got.model, got))
