"""The conventions of Simbody and of OpenSim's joints. Each row of conventions.toml has a function of its name here, which yields claims."""

from __future__ import annotations

from typing import Any

import numpy as np
import opensim as osim

from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.conventions import ABOUT_ORIGIN, AXIS, COM, GRAVITY, MASS, MOMENTS, Claims, P, V, W, X, Y, Z, about, claim
from featherbench_oracles.simbody.coordinates import angles

osim.Logger.setLevelString("Off")
ANGLES, TURN = np.array([0.4, -0.7, 1.1]), about(AXIS, 0.8)
R = about(X, ANGLES[0]) @ about(Y, ANGLES[1]) @ about(Z, ANGLES[2])
SIX = [float(MOMENTS[row, column]) for row, column in [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)]]


class One:
    """One body on a joint, at a state."""

    def __init__(self, kind: Any, q: Array, u: Array, turn: Array | None = None) -> None:
        self.model = osim.Model()
        self.model.setGravity(osim.Vec3(*GRAVITY.tolist()))
        self.body = osim.Body("body", MASS, osim.Vec3(*COM.tolist()), osim.Inertia(*SIX))
        self.model.addBody(self.body)
        place = osim.Vec3(*angles(np.eye(3) if turn is None else turn).tolist())
        self.model.addJoint(kind("joint", self.model.getGround(), osim.Vec3(0), place, self.body, osim.Vec3(0), osim.Vec3(0)))
        self.model.finalizeConnections()
        self.state = self.model.initSystem()
        self.unused = np.zeros(self.state.getNQ() - len(q))
        self.state.setQ(osim.Vector.createFromMat(np.append(q, self.unused)))
        self.state.setU(osim.Vector.createFromMat(u))
        self.model.realizeDynamics(self.state)
        self.matter = self.model.getMatterSubsystem()

    def turn(self) -> Array:
        """Read the body's rotation."""
        held = self.body.getTransformInGround(self.state).R().asMat33()
        return np.array([[held.get(row, column) for column in range(3)] for row in range(3)])

    def force(self, *, solver: bool) -> Array:
        """Find the forces at no acceleration, by OpenSim's solver or by Simbody itself."""
        none, forces = osim.Vector.createFromMat(np.zeros(self.state.getNU())), osim.Vector()
        if solver:
            return np.array(osim.InverseDynamicsSolver(self.model).solve(self.state, none).to_numpy())
        self.matter.calcResidualForceIgnoringConstraints(self.state, none, osim.VectorOfSpatialVec(), none, forces)
        return np.array(forces.to_numpy())


def free() -> One:
    """A body on a free joint."""
    return One(osim.FreeJoint, np.append(ANGLES, P), np.append(W, V))


def simbody_free_q() -> Claims:
    """Angles about x, y, z of the moving body, then the origin, then a number that is not used."""
    one = free()
    fixed_axes = about(Z, ANGLES[2]) @ about(Y, ANGLES[1]) @ about(X, ANGLES[0])
    yield claim(one.turn(), R, fixed_axes)
    yield claim(one.body.getPositionInGround(one.state).to_numpy(), P, ANGLES)


def simbody_spherical_q() -> Claims:
    """The same angles."""
    one = One(osim.BallJoint, ANGLES, W)
    yield claim(one.turn(), R, about(Z, ANGLES[2]) @ about(Y, ANGLES[1]) @ about(X, ANGLES[0]))


def simbody_free_v() -> Claims:
    """Angular and linear, both in the axes of the joint's frame on the parent: no derivatives of q."""
    one = free()
    yield claim(one.body.getAngularVelocityInGround(one.state).to_numpy(), W, R @ W)
    yield claim(one.body.getLinearVelocityInGround(one.state).to_numpy(), V, R @ V)


def simbody_spherical_v() -> Claims:
    """Angular velocity in the axes of the joint's frame on the parent."""
    one = One(osim.BallJoint, ANGLES, W)
    yield claim(one.body.getAngularVelocityInGround(one.state).to_numpy(), W, R @ W)


def simbody_axis() -> Claims:
    """A hinge turns about z of the joint's frame, and a slide goes along x; the frame's matrix takes its axes to the parent's."""
    hinge = One(osim.PinJoint, np.array([0.0]), np.array([1.0]), TURN)
    yield claim(hinge.body.getAngularVelocityInGround(hinge.state).to_numpy(), TURN[:, 2], TURN[2], TURN[:, 0])
    slide = One(osim.SliderJoint, np.array([0.0]), np.array([1.0]), TURN)
    yield claim(slide.body.getLinearVelocityInGround(slide.state).to_numpy(), TURN[:, 0], TURN[0], TURN[:, 2])


def simbody_inertia() -> Claims:
    """About the centre of mass."""
    one, mass = One(osim.PinJoint, np.array([0.0]), np.array([0.0])), osim.Matrix()
    one.matter.calcM(one.state, mass)
    yield claim(mass.to_numpy().ravel(), [ABOUT_ORIGIN[2, 2]], [MOMENTS[2, 2]])


def simbody_gravity() -> Claims:
    """OpenSim's solver has gravity in it, and Simbody's calcResidualForceIgnoringConstraints has none."""
    one = One(osim.SliderJoint, np.array([0.0]), np.array([0.0]))
    yield claim(one.force(solver=True), [-MASS * GRAVITY[0]], [0.0])
    yield claim(one.force(solver=False), [0.0], [-MASS * GRAVITY[0]])


def simbody_pairs() -> Claims:
    """Pairs and the rows of Jacobians are angular first."""
    one, jacobian = free(), osim.Matrix()
    one.matter.calcFrameJacobian(one.state, one.body.getMobilizedBodyIndex(), osim.Vec3(0), jacobian)
    yield claim(jacobian.to_numpy() @ np.append(W, V), np.append(W, V), np.append(V, W))
    pair = one.body.getVelocityInGround(one.state)
    yield claim(np.append(pair.get(0).to_numpy(), pair.get(1).to_numpy()), np.append(W, V), np.append(V, W))
