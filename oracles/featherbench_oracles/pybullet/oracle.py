"""PyBullet as an oracle, for robots of hinges and slides on a fixed base."""

from __future__ import annotations

import importlib.metadata
from pathlib import Path

import numpy as np
import pybullet as pb
from numpy.typing import NDArray

from featherbench_oracles.abilities import ReadsFiles
from featherbench_oracles.core.algebra import Array, rotation
from featherbench_oracles.core.protocol import Quantities, Reading, State, Unsupported, mass_matrix_probe, readback_row
from featherbench_oracles.core.robot import Description
from featherbench_oracles.pybullet import reading
from featherbench_oracles.pybullet.building import build
from featherbench_oracles.pybullet.reading import placement


class PyBulletRobot:
    """A robot in PyBullet. Every method that takes a question answers one quantity at its state, as `protocol.Engine` says.

    Parameters
    ----------
    robot : Description
        The robot's coordinates.
    made : int
        Bullet's number of it.
    client : int
        The world.
    order : ndarray, shape (nv,)
        Bullet's degrees of freedom by their number in the description.
    """

    def __init__(self, robot: Description, made: int, client: int, order: NDArray[np.intp]) -> None:
        self.robot, self.made, self.client, self.order = robot, made, client, order

    def readback(self) -> list[Array]:
        """Read back mass, centre of mass and inertia, and the placements that Bullet keeps between centres of mass."""
        rows = []
        for k in range(len(self.robot.bodies)):
            mass, _, moments, com, axes, *_ = pb.getDynamicsInfo(self.made, k, physicsClientId=self.client)
            turn = rotation(np.array(axes))
            held = placement(self.made, k, self.client)
            rows.append(readback_row(mass, np.array(com), (turn * moments) @ turn.T, held.rotation, held.translation))
        return rows

    def _inverse(self, ask: State, a: Array) -> Array:
        if any(body.joint.type == "free" for body in self.robot.bodies):
            raise Unsupported("PyBullet is asked about robots on a fixed base")
        arguments = [x[self.order].tolist() for x in (ask.q, ask.v, a)]
        return self._placed(np.array(pb.calculateInverseDynamics(self.made, *arguments, physicsClientId=self.client)))

    def _placed(self, theirs: Array) -> Array:
        ours = np.empty_like(theirs)
        ours[self.order] = theirs
        return ours

    def inverse(self, ask: State) -> Array:
        """Answer `id` by calculateInverseDynamics."""
        return self._inverse(ask, ask.a)

    def bias(self, ask: State) -> Array:
        """Answer `bias` by calculateInverseDynamics at a = 0."""
        return self._inverse(ask, np.zeros(self.robot.nv))

    def mass_matrix(self, ask: State) -> Array:
        """Answer `mass_matrix` by calculateMassMatrix."""
        if any(body.joint.type == "free" for body in self.robot.bodies):
            raise Unsupported("PyBullet is asked about robots on a fixed base")
        theirs = np.array(pb.calculateMassMatrix(self.made, ask.q[self.order].tolist(), physicsClientId=self.client))
        return self._placed(self._placed(theirs).T)

    def probe(self, ask: State) -> Array:
        """Answer `mass_matrix_probe` by calculateMassMatrix."""
        mass = self.mass_matrix(ask)
        return mass_matrix_probe(mass.__matmul__, np.diag(mass), ask.probe)


class PyBullet(ReadsFiles):
    """The engine PyBullet, for `session.serve`."""

    name = "pybullet"
    version = importlib.metadata.version("pybullet")
    build = {"language": "C++ (Python package pybullet)"}
    formats = ("urdf", "mjcf", "sdf")
    quantities: Quantities = {
        "id": {"inverse_dynamics": PyBulletRobot.inverse},
        "bias": {"inverse_dynamics": PyBulletRobot.bias},
        "mass_matrix": {"mass_matrix": PyBulletRobot.mass_matrix},
        "mass_matrix_probe": {"mass_matrix": PyBulletRobot.probe},
    }

    def prepare(self, description: Description) -> PyBulletRobot:
        """Build the robot in a world of its own."""
        client = pb.connect(pb.DIRECT)
        return PyBulletRobot(description, build(description, client), client, np.arange(description.nv))

    def read(self, path: Path, form: str, base: str) -> Reading:
        """Read a file by Bullet's importers."""
        return reading.read(path, form, base, PyBulletRobot)
