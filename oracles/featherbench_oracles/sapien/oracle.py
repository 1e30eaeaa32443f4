"""SAPIEN as an oracle: PhysX's articulations in single precision, of hinges and slides on a fixed base.

PhysX tells the force that holds the joints at a state, and steps. It has no mass matrix of its own for Python: SAPIEN's has Pinocchio make
one of what the articulation holds, and is asked for that.
"""

from __future__ import annotations

import importlib.metadata
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from featherbench_oracles.abilities import ReadsFiles
from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.protocol import Quantities, Reading, State, Unsupported, mass_matrix_probe, readback_row
from featherbench_oracles.core.robot import Description
from featherbench_oracles.sapien import reading
from featherbench_oracles.sapien.building import build, placed

FASTEST = 1e9  # rad/s or m/s: a joint forgets what is above its limit, which is 100 unless said otherwise


class SapienRobot:
    """A robot in SAPIEN. Every method that takes a question answers one quantity at its state, as `protocol.Engine` says.

    Parameters
    ----------
    robot : Description
        The robot's coordinates.
    held : (Scene, PhysxArticulation)
        The robot, and the scene that must live as long.
    links : list of str
        The link of each body of the description.
    """

    def __init__(self, robot: Description, held: tuple[Any, Any], links: list[str]) -> None:
        self.robot, (self.scene, made) = robot, held
        self.made = made
        self.links = [made.find_link_by_name(name) for name in links]
        joints = [joint.name for joint in made.active_joints]
        names = [link.joint.name for link in self.links if link.parent is not None]  # a root that floats has none
        self.order: NDArray[np.intp] = np.array([joints.index(name) for name in names], dtype=np.intp)
        self.model: Any = None
        for joint in made.active_joints:
            joint.set_max_velocity(FASTEST)

    def readback(self) -> list[Array]:
        """Read back each link's inertia, and each joint's frame on its parent."""
        rows = []
        for link in self.links:
            turn, com = placed(link.cmass_local_pose)
            rotation, translation = placed(link.joint.pose_in_parent)
            inner, _ = placed(link.joint.pose_in_child)
            inertia = (turn * np.array(link.inertia, dtype=float)) @ turn.T
            rows.append(readback_row(float(link.mass), com, inertia, rotation @ inner.T, translation))
        return rows

    def _floats(self) -> None:
        if any(body.joint.type == "free" for body in self.robot.bodies):
            raise Unsupported("SAPIEN is asked about robots on a fixed base")

    def _theirs(self, ours: Array) -> NDArray[np.float32]:
        theirs = np.empty(len(ours), dtype=np.float32)
        theirs[self.order] = ours
        return theirs

    def bias(self, ask: State) -> Array:
        """Answer `bias` by compute_passive_force."""
        self._floats()
        self.made.set_qpos(self._theirs(ask.q))
        self.made.set_qvel(self._theirs(ask.v))
        return np.array(self.made.compute_passive_force(gravity=True, coriolis_and_centrifugal=True), dtype=float)[self.order]

    def mass_matrix(self, ask: State) -> Array:
        """Answer `mass_matrix` by compute_generalized_mass_matrix."""
        self._floats()
        if any(body.joint.armature.any() for body in self.robot.bodies):
            raise Unsupported("the model that SAPIEN makes for Pinocchio has no armature")
        if self.model is None:
            self.model = self.made.create_pinocchio_model()
        theirs = np.array(self.model.compute_generalized_mass_matrix(self._theirs(ask.q)), dtype=float)
        return theirs[np.ix_(self.order, self.order)]

    def probe(self, ask: State) -> Array:
        """Answer `mass_matrix_probe` by the M of `mass_matrix`."""
        mass = self.mass_matrix(ask)
        return mass_matrix_probe(mass.__matmul__, np.diag(mass), ask.probe)

    def placement(self, ask: State) -> list[Array]:
        """Answer `body_placement` by the poses of links."""
        self._floats()
        self.made.set_qpos(self._theirs(ask.q))
        return [np.append(turn.ravel(), origin) for turn, origin in (placed(link.entity_pose) for link in self.links)]


class Sapien(ReadsFiles):
    """The engine SAPIEN, for `session.serve`."""

    name = "sapien"
    version = importlib.metadata.version("sapien")
    build = {"language": "C++ (Python package sapien, PhysX)", "precision": "single"}
    formats = ("urdf",)
    quantities: Quantities = {
        "bias": {"passive_force": SapienRobot.bias},
        "mass_matrix": {"pinocchio_model": SapienRobot.mass_matrix},
        "mass_matrix_probe": {"pinocchio_model": SapienRobot.probe},
        "body_placement": {"link_pose": SapienRobot.placement},
    }

    def prepare(self, description: Description) -> SapienRobot:
        """Build the robot in a scene of its own."""
        return SapienRobot(description, build(description), [f"link{k + 1}" for k in range(len(description.bodies))])

    def read(self, path: Path, form: str, base: str) -> Reading:
        """Read a URDF by SAPIEN's loader."""
        return reading.read(path, base, SapienRobot)
