"""frax as an oracle, in double precision, of hinges and slides on a fixed base.

frax computes by JAX, with products of masks over all pairs of joints in the place of loops over the tree.
"""

from __future__ import annotations

import importlib.metadata
from collections.abc import Callable
from functools import cached_property
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from numpy.typing import NDArray

from featherbench_oracles.abilities import ReadsFiles
from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.protocol import Quantities, Reading, State, Unsupported, mass_matrix_probe, readback_row
from featherbench_oracles.core.robot import Description
from featherbench_oracles.frax import reading
from featherbench_oracles.frax.building import build

jax.config.update("jax_enable_x64", True)
OWN_GRAVITY = np.array([0.0, 0.0, -9.81])  # of its forward dynamics, which takes no other


class FraxRobot:
    """A robot in frax. Every method that takes a question answers one quantity at its state, as `protocol.Engine` says.

    Parameters
    ----------
    robot : Description
        The robot's coordinates.
    made : Robot
        The robot.
    order : ndarray, shape (nv,)
        frax's joint of each joint of the description.
    """

    def __init__(self, robot: Description, made: Any, order: NDArray[np.intp]) -> None:
        self.robot, self.made, self.order = robot, made, order
        self.upwards = jnp.array(np.append(-robot.gravity, np.zeros(3)))

    def readback(self) -> list[Array]:
        """Read back each link's inertia, and each joint's frame on its parent."""
        rows = []
        for k in self.order:
            turn = self.made.link_local_inertia_rotations[k]
            inertia = turn @ self.made.link_local_inertias[k] @ turn.T
            place = self.made.joint_parent_frame_rotations[k], self.made.joint_parent_frame_positions[k]
            rows.append(readback_row(float(self.made.link_masses[k]), self.made.link_local_inertia_positions[k], inertia, *place))
        return rows

    def _theirs(self, ours: Array) -> Any:
        if any(body.joint.type == "free" for body in self.robot.bodies):
            raise Unsupported("frax is asked about robots on a fixed base")
        theirs = np.empty(len(ours))
        theirs[self.order] = ours
        return jnp.array(theirs)

    @cached_property
    def compiled(self) -> dict[str, Callable[..., Any]]:
        """The functions of this robot, which XLA compiles when they are called first."""
        made = self.made
        return {
            "rnea": jax.jit(lambda q, v, a, g: made.rnea(q, v, a, g, None)),
            "crba": jax.jit(made.crba),
            "forward_dynamics": jax.jit(lambda q, v, tau: made.forward_dynamics(q, v, tau, None)),
            "joint_to_world_transforms": jax.jit(made.joint_to_world_transforms),
            "center_of_mass": jax.jit(made.center_of_mass),
        }

    def _inverse(self, ask: State, a: Array) -> Array:
        arguments = (self._theirs(x) for x in (ask.q, ask.v, a))
        return np.array(self.compiled["rnea"](*arguments, self.upwards))[self.order]

    def inverse(self, ask: State) -> Array:
        """Answer `id` by rnea."""
        return self._inverse(ask, ask.a)

    def bias(self, ask: State) -> Array:
        """Answer `bias` by rnea at a = 0."""
        return self._inverse(ask, np.zeros(self.robot.nv))

    def mass_matrix(self, ask: State) -> Array:
        """Answer `mass_matrix` by crba."""
        return np.array(self.compiled["crba"](self._theirs(ask.q)))[np.ix_(self.order, self.order)]

    def probe(self, ask: State) -> Array:
        """Answer `mass_matrix_probe` by crba."""
        mass = self.mass_matrix(ask)
        return mass_matrix_probe(mass.__matmul__, np.diag(mass), ask.probe)

    def forward(self, ask: State) -> Array:
        """Answer `fd` by forward_dynamics, in the one gravity that it has."""
        if not np.array_equal(self.robot.gravity, OWN_GRAVITY):
            raise Unsupported("frax's forward dynamics has a gravity of its own, 9.81 m/s² along −z")
        arguments = (self._theirs(x) for x in (ask.q, ask.v, ask.tau))
        return np.array(self.compiled["forward_dynamics"](*arguments))[self.order]

    def com(self, ask: State) -> Array:
        """Answer `com` by center_of_mass."""
        return np.array(self.compiled["center_of_mass"](self._theirs(ask.q)))

    def placement(self, ask: State) -> list[Array]:
        """Answer `body_placement` by joint_to_world_transforms."""
        frames = np.array(self.compiled["joint_to_world_transforms"](self._theirs(ask.q)))[self.order]
        return [np.append(frame[:3, :3].ravel(), frame[:3, 3]) for frame in frames]


class Frax(ReadsFiles):
    """The engine frax, for `session.serve`."""

    name = "frax"
    version = importlib.metadata.version("frax")
    build = {"language": "Python (JAX)", "jax": importlib.metadata.version("jax")}
    formats = ("urdf",)
    quantities: Quantities = {
        "id": {"rnea": FraxRobot.inverse},
        "bias": {"rnea": FraxRobot.bias},
        "mass_matrix": {"crba": FraxRobot.mass_matrix},
        "mass_matrix_probe": {"crba": FraxRobot.probe},
        "fd": {"forward_dynamics": FraxRobot.forward},
        "com": {"center_of_mass": FraxRobot.com},
        "body_placement": {"forward_kinematics": FraxRobot.placement},
    }

    def prepare(self, description: Description) -> FraxRobot:
        """Build the robot, and forget the code that was compiled for the one before."""
        jax.clear_caches()
        return FraxRobot(description, build(description), np.arange(description.nv))

    def read(self, path: Path, form: str, base: str) -> Reading:
        """Read a URDF by frax's parser."""
        jax.clear_caches()
        return reading.read(path, base, FraxRobot)
