"""adam as an oracle, by generated C code."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from importlib.metadata import version
from typing import Any

import casadi as cs
import numpy as np

from featherbench_oracles.adam import symbols, urdf
from featherbench_oracles.adam.compiling import FLAGS, Batch, Compiled, compiler
from featherbench_oracles.adam.coordinates import base_transform, to_angular_first
from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.clock import Measured
from featherbench_oracles.core.protocol import Quantities, State, Unsupported, mass_matrix_probe, readback_row
from featherbench_oracles.core.robot import Description

LARGEST = 40  # dofs: what the code of a robot of 35 takes to compile stands in README.md, "Generated code"


class AdamRobot:
    """A robot in adam, with the functions that were generated of it.

    Parameters
    ----------
    robot : Description
        The robot.
    """

    def __init__(self, robot: Description) -> None:
        self.robot = robot
        self.symbols = symbols.Robot.of(robot)
        self.compiled: dict[tuple[Any, int], Compiled] = {}

    def readback(self) -> list[Array]:
        """Read back what adam holds of links and joints; a floating base's placement is no part of it."""
        model = self.symbols.model.rbdalgos.model
        rows = []
        for k, body in enumerate(self.robot.bodies):
            inertial = model.links[urdf.link(k)].inertial
            frame = np.eye(4)
            frame[:3, :3], frame[:3, 3] = body.joint.rotation, body.joint.translation
            if k > 0 or not self.symbols.floats:
                frame = _number(model.joints[urdf.joint(k)].homogeneous(self.symbols.model.rbdalgos.math.asarray(0.0)))
            mass, com, inertia = (_number(item) for item in (inertial.mass, inertial.origin.xyz, inertial.inertia.matrix))
            rows.append(readback_row(mass.item(), com.ravel(), inertia, frame[:3, :3], frame[:3, 3]))
        return rows

    def inputs(self, ask: State) -> dict[str, Array]:
        """Convert a state to the inputs of `symbols.Robot`; H is column by column."""
        joints = ask.q[7:] if self.symbols.floats else ask.q
        base = base_transform(self.robot, ask.q).ravel(order="F")
        return {"base": base, "position": joints, "velocity": ask.v, "force": ask.tau}

    def function(self, method: Generated, body: int) -> Compiled:
        """Find or generate the function of a method: `body` matters to a Jacobian alone."""
        key = method.expression, body if method.of_body else 0
        if key not in self.compiled:
            output = method.expression(self.symbols, body) if method.of_body else method.expression(self.symbols)
            self.compiled[key] = Compiled([self.symbols.inputs[name] for name in self.names(method)], output)
        return self.compiled[key]

    def names(self, method: Generated) -> list[str]:
        """Name the inputs of a method that this robot has."""
        return [name for name in method.given.split() if name in self.symbols.inputs]

    def batch(self, method: Generated, asks: list[State]) -> Batch:
        """Place the states of a method in memory."""
        states = [self.inputs(ask) for ask in asks]
        inputs = [np.array([state[name] for state in states]) for name in self.names(method)]
        return Batch(self.function(method, asks[0].body), inputs)

    def placements(self, frames: Array) -> list[Array]:
        """Convert the matrix of `symbols.Robot.placement`."""
        return [np.append(frame[:3, :3].ravel(), frame[:3, 3]) for frame in np.split(frames, len(self.robot.bodies), axis=1)]


def _number(expression: Any) -> Array:
    """Evaluate an expression without symbols."""
    return np.array(cs.DM(expression.array))


@dataclass(frozen=True)
class Generated(Measured):
    """A method by generated code.

    Attributes
    ----------
    given : str
        Its inputs, words of `symbols.Robot` separated by blanks. One that the robot has not is left out.
    expression : callable
        Makes the expression: a method of `symbols.Robot`.
    answer : callable
        Converts robot, state and value to the answer.
    of_body : bool
        Whether the expression is that of one body.
    """

    given: str
    expression: Callable[..., cs.SX]
    answer: Callable[[AdamRobot, State, Array], Any] = lambda _, __, value: value
    of_body: bool = False

    def __call__(self, robot: AdamRobot, ask: State) -> Any:
        """Answer at a state, by the loop that is timed."""
        batch = robot.batch(self, [ask])
        batch.time(0, 1)
        return self.answer(robot, ask, batch.value())

    def stream(self, robot: AdamRobot, asks: list[State]) -> Batch:
        """Place states in memory, so that their loop can be timed."""
        return robot.batch(self, asks)


def _momentum(robot: AdamRobot, ask: State, value: Array) -> Array:
    """Convert [linear; angular] in base axes."""
    return to_angular_first((base_transform(robot.robot, ask.q)[:3, :3] @ value.reshape(2, 3).T).T.ravel())


def _jacobian(robot: AdamRobot, ask: State, value: Array) -> Array:
    """Convert rows in the body's axes."""
    frame = _FRAMES(robot, ask)[ask.body]
    turn = frame[:9].reshape(3, 3)
    return to_angular_first(np.vstack([turn @ value[:3], turn @ value[3:]]))


def _probe(robot: AdamRobot, ask: State) -> Array:
    """Answer `mass_matrix_probe` by the M of crba."""
    mass = _MASS(robot, ask)
    return mass_matrix_probe(mass.__matmul__, np.diag(mass), ask.probe)


_MASS = Generated("base position", symbols.Robot.mass)
_FRAMES = Generated("base position", symbols.Robot.placement, lambda robot, _, value: robot.placements(value))


class Adam:
    """The engine adam, for `session.serve`."""

    name = "adam"
    version = version("adam-robotics")
    quantities: Quantities = {
        "bias": {"rnea": Generated("base position velocity", symbols.Robot.bias)},
        "mass_matrix": {"crba": _MASS},
        "mass_matrix_sparse": {"crba": _MASS},
        "mass_matrix_probe": {"crba": _probe},
        "fd": {
            "aba": Generated("base position velocity force", symbols.Robot.aba),
            "crba_ldl": Generated("base position velocity force", symbols.Robot.crba_ldl),
        },
        "com": {"com_position": Generated("base position", symbols.Robot.com)},
        "momentum": {"centroidal_momentum_matrix": Generated("base position velocity", symbols.Robot.momentum, _momentum)},
        "body_placement": {"forward_kinematics": _FRAMES},
        "body_jacobian": {"jacobian": Generated("base position", symbols.Robot.jacobian, _jacobian, of_body=True)},
    }

    def __init__(self) -> None:
        _, told = compiler()
        self.build = {
            "language": "C, generated by CasADi",
            "compiler": told,
            "flags": " ".join(FLAGS),
            "packages": f"adam-robotics {self.version}, casadi {cs.__version__}",
        }

    def prepare(self, description: Description) -> AdamRobot:
        """Build the robot. Its functions are generated when they are asked for."""
        if description.nv > LARGEST:
            raise Unsupported(f"the generated code of robots above {LARGEST} degrees of freedom is too large to compile for a run")
        return AdamRobot(description)
