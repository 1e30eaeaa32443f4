"""Exudyn as an oracle: its C++ object `ObjectKinematicTree`, for robots of hinges and slides on a fixed base.

A joint of Exudyn's tree turns about or slides along the z axis of its frame. So each body's frame is turned by an A with A e_z = axis.
Exudyn gets the joint's frame R A, the centre of mass A' c and the inertia A' I A. Coordinates stay the same.
"""

from __future__ import annotations

import importlib.metadata

import exudyn as exu
import numpy as np
from exudyn.itemInterface import NodeGenericODE2, ObjectKinematicTree

from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.protocol import Quantities, State, Unsupported, mass_matrix_probe, readback_row
from featherbench_oracles.core.robot import Description

KINDS = {"revolute": exu.JointType.RevoluteZ, "prismatic": exu.JointType.PrismaticZ}


class ExudynRobot:
    """A robot in Exudyn. Every method that takes a question answers one quantity at its state, as `protocol.Engine` says.

    Parameters
    ----------
    robot : Description
        The robot's coordinates.
    """

    def __init__(self, robot: Description) -> None:
        self.robot = robot
        self.container = exu.SystemContainer()
        self.system = self.container.AddSystem()
        self.turns = [np.eye(3)]  # A of the world, then of each body
        places, offsets, inertias, coms = [], [], [], []
        for body in robot.bodies:
            joint = body.joint
            if joint.type not in KINDS:
                raise Unsupported(f"Exudyn's tree has hinges and slides, and joint {joint.name} is {joint.type}")
            if joint.armature.any():
                raise Unsupported(f"Exudyn's tree has no armature (joint {joint.name})")
            above, turn = self.turns[body.parent + 1], to_axis(joint.axis)
            self.turns.append(turn)
            places.append(above.T @ joint.rotation @ turn)
            offsets.append(above.T @ joint.translation)
            inertias.append(turn.T @ body.inertia @ turn)
            coms.append(turn.T @ body.com)
        zeros = [0.0] * robot.nv
        node = self.system.AddNode(
            NodeGenericODE2(
                referenceCoordinates=zeros, initialCoordinates=zeros, initialCoordinates_t=zeros, numberOfODE2Coordinates=robot.nv
            )
        )
        self.tree = self.system.AddObject(
            ObjectKinematicTree(
                nodeNumber=node,
                jointTypes=[KINDS[body.joint.type] for body in robot.bodies],
                linkParents=[body.parent for body in robot.bodies],
                jointTransformations=exu.Matrix3DList(places),
                jointOffsets=exu.Vector3DList(offsets),
                linkInertiasCOM=exu.Matrix3DList(inertias),
                linkCOMs=exu.Vector3DList(coms),
                linkMasses=[body.mass for body in robot.bodies],
                gravity=robot.gravity.tolist(),
            )
        )
        self.system.Assemble()
        self.solver = exu.MainSolverImplicitSecondOrder()
        settings = exu.SimulationSettings()
        settings.solutionSettings.writeSolutionToFile = False  # into the folder in which it is started
        self.solver.InitializeSolver(self.system, settings)

    def readback(self) -> list[Array]:
        """Read back the tree's lists, turned back to the axes of the bodies."""
        held = self.system.GetObject(self.tree)
        names = ("linkMasses", "linkCOMs", "linkInertiasCOM", "jointTransformations", "jointOffsets")
        rows = []
        for k in range(len(self.robot.bodies)):  # an iterator of its lists does not end
            mass, com, inertia, place, offset = (held[name][k] for name in names)
            above, turn = self.turns[self.robot.bodies[k].parent + 1], self.turns[k + 1]
            about_com = turn @ np.array(inertia) @ turn.T
            rows.append(readback_row(mass, turn @ np.array(com), about_com, above @ np.array(place) @ turn.T, above @ np.array(offset)))
        return rows

    def _set(self, ask: State) -> None:
        self.system.systemData.SetODE2Coordinates(ask.q.tolist())
        self.system.systemData.SetODE2Coordinates_t(ask.v.tolist())

    def bias(self, ask: State) -> Array:
        """Answer `bias` by ComputeODE2RHS, whose residual is -h."""
        self._set(ask)
        self.solver.ComputeODE2RHS(self.system)
        return -np.array(self.solver.GetSystemResidual())[: self.robot.nv]

    def mass_matrix(self, ask: State) -> Array:
        """Answer `mass_matrix` by ComputeMassMatrix."""
        self._set(ask)
        self.solver.ComputeMassMatrix(self.system)
        return np.array(self.solver.GetSystemMassMatrix())

    def probe(self, ask: State) -> Array:
        """Answer `mass_matrix_probe` by ComputeMassMatrix."""
        mass = self.mass_matrix(ask)
        return mass_matrix_probe(mass.__matmul__, np.diag(mass), ask.probe)


def to_axis(axis: Array) -> Array:
    """Make the rotation that takes z to an axis, by the shortest turn; x is turned half if the axis is -z."""
    x, y, z = axis
    if z < -0.5:  # by way of -z, where the shortest turn has no plane
        return to_axis(-axis) @ np.diag([1.0, -1.0, -1.0])
    return np.array([[1 - x * x / (1 + z), -x * y / (1 + z), x], [-x * y / (1 + z), 1 - y * y / (1 + z), y], [-x, -y, z]])


class Exudyn:
    """The engine Exudyn, for `session.serve`."""

    name = "exudyn"
    version = importlib.metadata.version("exudyn")
    build = {"language": "C++ (Python package exudyn)"}
    quantities: Quantities = {
        "bias": {"ode2_rhs": ExudynRobot.bias},
        "mass_matrix": {"compute_mass_matrix": ExudynRobot.mass_matrix},
        "mass_matrix_probe": {"compute_mass_matrix": ExudynRobot.probe},
    }

    def prepare(self, description: Description) -> ExudynRobot:
        """Build the robot."""
        return ExudynRobot(description)
