"""The conventions of Exudyn. Each row of conventions.toml has a function of its name here, which yields claims."""

from __future__ import annotations

import exudyn as exu
import numpy as np
from exudyn.itemInterface import NodeGenericODE2, ObjectKinematicTree

from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.conventions import ABOUT_ORIGIN, AXIS, COM, GRAVITY, MASS, MOMENTS, Claims, about, claim

TURN = about(AXIS, 0.8)


class Tree:
    """One body on a joint at a state, by `ObjectKinematicTree`."""

    def __init__(
        self, kind: exu.JointType, q: float = 0.0, v: float = 0.0, turn: Array = TURN, zero: float = 0.0, force: float = 0.0
    ) -> None:
        self.container = exu.SystemContainer()
        system = self.container.AddSystem()
        numbers = {"referenceCoordinates": [zero], "initialCoordinates": [0.0], "initialCoordinates_t": [0.0], "numberOfODE2Coordinates": 1}
        node = system.AddNode(NodeGenericODE2(**numbers))
        held = {"linkInertiasCOM": exu.Matrix3DList([MOMENTS]), "linkCOMs": exu.Vector3DList([COM]), "linkMasses": [MASS]}
        place = {"jointTransformations": exu.Matrix3DList([turn]), "jointOffsets": exu.Vector3DList([np.zeros(3)]), "linkParents": [-1]}
        tree = ObjectKinematicTree(nodeNumber=node, jointTypes=[kind], gravity=GRAVITY.tolist(), jointForceVector=[force], **held, **place)
        system.AddObject(tree)
        system.Assemble()
        settings = exu.SimulationSettings()
        settings.solutionSettings.writeSolutionToFile = False
        solver = exu.MainSolverImplicitSecondOrder()
        solver.InitializeSolver(system, settings)
        system.systemData.SetODE2Coordinates([q])
        system.systemData.SetODE2Coordinates_t([v])
        solver.ComputeMassMatrix(system)
        solver.ComputeODE2RHS(system)
        self.mass, self.residual = float(solver.GetSystemMassMatrix()[0][0]), float(solver.GetSystemResidual()[0])


def exudyn_axis() -> Claims:
    """The z axis of the joint's frame, whose matrix takes the link's axes to the parent's."""
    slide = Tree(exu.JointType.PrismaticZ)
    yield claim([slide.residual], [MASS * GRAVITY @ TURN[:, 2]], [MASS * GRAVITY @ TURN[2]])


def exudyn_inertia() -> Claims:
    """About the centre of mass."""
    yield claim([Tree(exu.JointType.RevoluteZ).mass], [ABOUT_ORIGIN[2, 2]], [MOMENTS[2, 2]])


def exudyn_bias() -> Claims:
    """The residual of ComputeODE2RHS is the force of joints less the bias."""
    by_hand = np.cross(COM, MASS * TURN.T @ GRAVITY)[2]
    yield claim([Tree(exu.JointType.RevoluteZ).residual], [by_hand], [-by_hand])
    yield claim([Tree(exu.JointType.RevoluteZ, force=0.7).residual], [by_hand + 0.7], [by_hand])


def exudyn_zero() -> Claims:
    """Positions count from the reference coordinates of the node."""
    moved, plain = Tree(exu.JointType.RevoluteZ, 0.3, zero=0.4), Tree(exu.JointType.RevoluteZ, 0.7)
    yield claim([moved.residual], [plain.residual], [Tree(exu.JointType.RevoluteZ, 0.3).residual])
