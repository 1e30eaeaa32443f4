"""Simbody as an oracle: OpenSim builds its system of bodies, which `SimbodyMatterSubsystem` then answers for.

OpenSim's hinge turns about z, and its slide goes along x. So the joint has a frame of its own on either body: on the child it is A, which
takes that axis to the joint's, and on the parent R A. Gravity is OpenSim's in `bias` and `id`. A matter subsystem has none: `fd` gets each
body's weight as a wrench.
"""

from __future__ import annotations

import importlib.metadata
from typing import Any

import numpy as np
import opensim as osim

from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.change import CoordinateChange
from featherbench_oracles.core.protocol import Quantities, State, Unsupported, mass_matrix_probe, readback_row
from featherbench_oracles.core.robot import Description, Joint
from featherbench_oracles.simbody import coordinates

osim.Logger.setLevelString("Off")  # its log is the answer's stream
KINDS = {"revolute": osim.PinJoint, "prismatic": osim.SliderJoint, "spherical": osim.BallJoint, "free": osim.FreeJoint}


class SimbodyRobot:
    """A robot in Simbody. Every method that takes a question answers one quantity at its state, as `protocol.Engine` says.

    Simbody's six-vectors are [angular; linear], in the axes of the ground.

    Parameters
    ----------
    robot : Description
        The robot's coordinates.
    """

    def __init__(self, robot: Description) -> None:
        self.robot = robot
        self.model = osim.Model()
        self.model.setGravity(osim.Vec3(*robot.gravity.tolist()))
        self.bodies: list[Any] = []
        self.joints: list[Any] = []
        for k, body in enumerate(robot.bodies):
            joint = body.joint
            if joint.type not in KINDS:
                raise Unsupported(f"the oracle has no {joint.type} joint for Simbody")
            if joint.armature.any():
                raise Unsupported(f"OpenSim's joints have no armature (joint {joint.name})")
            inertia = body.inertia
            moments = (inertia[0, 0], inertia[1, 1], inertia[2, 2], inertia[0, 1], inertia[0, 2], inertia[1, 2])
            made = osim.Body(f"body{k}", body.mass, osim.Vec3(*body.com.tolist()), osim.Inertia(*map(float, moments)))
            parent = self.bodies[body.parent] if body.parent >= 0 else self.model.getGround()
            self.model.addBody(made)
            self.bodies.append(made)
            self.joints.append(make_joint(joint, f"joint{k}", parent, made))
            self.model.addJoint(self.joints[-1])
        self.model.finalizeConnections()
        self.state = self.model.initSystem()
        self.matter = self.model.getMatterSubsystem()
        self.numbers = [made.getMobilizedBodyIndex() for made in self.bodies]
        self.q_of, self.own = self._places()

    def _places(self) -> tuple[list[list[int]], Array]:
        """Find where OpenSim's coordinates are in q, joint by joint, and where our velocities are in u.

        A free or a spherical joint leaves one number of q unused.
        """
        q_of, u_of = [], []
        for joint in self.joints:
            places = []
            for k in range(joint.numCoordinates()):
                coordinate = joint.get_coordinates(k)
                self.state.setQ(vector(np.zeros(self.state.getNQ())))
                self.state.setU(vector(np.zeros(self.state.getNU())))
                coordinate.setValue(self.state, 0.25, False)
                coordinate.setSpeedValue(self.state, 0.25)
                places.append(int(np.flatnonzero(self.state.getQ().to_numpy())[0]))
                u_of.append(int(np.flatnonzero(self.state.getU().to_numpy())[0]))
            q_of.append(places)
        return q_of, np.array(u_of, dtype=np.intp)

    def readback(self) -> list[Array]:
        """Read back each body's properties, and its joint's two frames, of which ours is that on the parent less that on the child."""
        rows = []
        for made, joint in zip(self.bodies, self.joints, strict=True):
            moments = made.get_inertia()
            six = [moments.get(k) for k in range(6)]
            inertia = np.array([[six[0], six[3], six[4]], [six[3], six[1], six[5]], [six[4], six[5], six[2]]])
            on_parent, origin = placed(joint.getParentFrame().findTransformInBaseFrame())
            on_child, _ = placed(joint.getChildFrame().findTransformInBaseFrame())
            rows.append(readback_row(made.getMass(), made.getMassCenter().to_numpy(), inertia, on_parent @ on_child.T, origin))
        return rows

    # ---- the state

    def _update(self, ask: State) -> CoordinateChange:
        """Set q and u, and find positions and velocities."""
        change = coordinates.change_of_velocities(self.robot, ask.q, ask.v)
        q = np.zeros(self.state.getNQ())
        for places, own in zip(self.q_of, coordinates.to_engine_q(self.robot, ask.q), strict=True):
            q[places] = own
        self.state.setQ(vector(q))
        self.state.setU(self._engine_order(change.to_engine_v(ask.v)))
        self.model.realizeDynamics(self.state)
        return change

    def _engine_order(self, ours: Array) -> Any:
        """Put numbers of our joints in Simbody's order."""
        whole = np.zeros(self.state.getNU())
        whole[self.own] = ours
        return vector(whole)

    # ---- dynamics

    def inverse(self, ask: State) -> Array:
        """Answer `id` by OpenSim's InverseDynamicsSolver, which adds its gravity to Simbody's calcResidualForceIgnoringConstraints."""
        change = self._update(ask)
        udot = self._engine_order(change.to_engine_a(ask.a))
        return change.to_neutral_tau(osim.InverseDynamicsSolver(self.model).solve(self.state, udot).to_numpy()[self.own])

    def inverse_wrench(self, ask: State) -> Array:
        """Answer `id_wrench` by calcResidualForceIgnoringConstraints, with a wrench and the weight on each body."""
        change, forces = self._update(ask), osim.Vector()
        wrenches = self._wrenches(ask.wrench)
        udot = self._engine_order(change.to_engine_a(ask.a))
        none = vector(np.zeros(self.state.getNU()))
        self.matter.calcResidualForceIgnoringConstraints(self.state, none, wrenches, udot, forces)
        return change.to_neutral_tau(forces.to_numpy()[self.own])

    def _wrenches(self, given: Array | None = None) -> Any:
        """Make each body's weight, and the wrench [moment; force] in body axes on it, a wrench at its origin in the axes of the ground."""
        zero = osim.SpatialVec(osim.Vec3(0), osim.Vec3(0))
        made = osim.VectorOfSpatialVec(len(self.bodies) + 1, zero)
        for k, body in enumerate(self.robot.bodies):
            turn, _ = placed(self.bodies[k].getTransformInGround(self.state))
            weight = body.mass * self.robot.gravity
            moment, force = np.cross(turn @ body.com, weight), weight
            if given is not None:
                moment, force = moment + turn @ given[k, :3], force + turn @ given[k, 3:]
            made.set(self.numbers[k], osim.SpatialVec(osim.Vec3(*moment.tolist()), osim.Vec3(*force.tolist())))
        return made

    def bias(self, ask: State) -> Array:
        """Answer `bias` by OpenSim's InverseDynamicsSolver at the accelerations b of the coordinates."""
        change = self._update(ask)
        forces = osim.InverseDynamicsSolver(self.model).solve(self.state, self._engine_order(change.b))
        return change.to_neutral_tau(forces.to_numpy()[self.own])

    def forward(self, ask: State) -> Array:
        """Answer `fd` by calcAccelerationIgnoringConstraints, its O(n) algorithm."""
        change, udot = self._update(ask), osim.Vector()
        forces = self._engine_order(change.to_engine_tau(ask.tau))
        self.matter.calcAccelerationIgnoringConstraints(self.state, forces, self._wrenches(), udot, osim.VectorOfSpatialVec())
        return change.to_neutral_a(udot.to_numpy()[self.own])

    def forward_by_inverse(self, ask: State) -> Array:
        """Answer `fd` by multiplyByMInv of tau less the forces of InverseDynamicsSolver at rest."""
        change, udot = self._update(ask), osim.Vector()
        zero = vector(np.zeros(self.state.getNU()))
        held = osim.InverseDynamicsSolver(self.model).solve(self.state, zero).to_numpy()[self.own]
        self.matter.multiplyByMInv(self.state, self._engine_order(change.to_engine_tau(ask.tau) - held), udot)
        return change.to_neutral_a(udot.to_numpy()[self.own])

    def mass_matrix(self, ask: State) -> Array:
        """Answer `mass_matrix` by calcM."""
        change, mass = self._update(ask), osim.Matrix()
        self.matter.calcM(self.state, mass)
        return change.to_neutral_mass(mass.to_numpy()[np.ix_(self.own, self.own)])

    def probe(self, ask: State) -> Array:
        """Answer `mass_matrix_probe` by multiplyByM, which makes no matrix; the diagonal is that of calcM."""
        change = self._update(ask)

        def product(x: Array) -> Array:
            answer = osim.Vector()
            self.matter.multiplyByM(self.state, self._engine_order(change.to_engine_v(x)), answer)
            return change.to_neutral_tau(answer.to_numpy()[self.own])

        return mass_matrix_probe(product, np.diag(self.mass_matrix(ask)), ask.probe)

    # ---- energy, momentum, kinematics

    def kinetic(self, ask: State) -> float:
        """Answer `kinetic_energy` by calcKineticEnergy."""
        self._update(ask)
        return float(self.matter.calcKineticEnergy(self.state))

    def com(self, ask: State) -> Array:
        """Answer `com` by calcSystemMassCenterLocationInGround."""
        self._update(ask)
        return np.array(self.matter.calcSystemMassCenterLocationInGround(self.state).to_numpy())

    def momentum(self, ask: State) -> Array:
        """Answer `momentum` by calcSystemCentralMomentum."""
        self._update(ask)
        return six(self.matter.calcSystemCentralMomentum(self.state))

    def placement(self, ask: State) -> list[Array]:
        """Answer `body_placement` by getTransformInGround."""
        self._update(ask)
        poses = [placed(made.getTransformInGround(self.state)) for made in self.bodies]
        return [np.append(turn.ravel(), origin) for turn, origin in poses]

    def velocity(self, ask: State) -> list[Array]:
        """Answer `body_velocity` by getVelocityInGround."""
        self._update(ask)
        return [six(made.getVelocityInGround(self.state)) for made in self.bodies]

    def acceleration(self, ask: State) -> list[Array]:
        """Answer `body_acceleration` by multiplyBySystemJacobian and calcBiasForSystemJacobian."""
        change, bias, jacobian = self._update(ask), osim.Vector(), osim.Matrix()
        self.matter.calcBiasForSystemJacobian(self.state, bias)
        self.matter.calcSystemJacobian(self.state, jacobian)
        a_e = self._engine_order(change.to_engine_a(ask.a)).to_numpy()
        rows = (jacobian.to_numpy() @ a_e + bias.to_numpy()).reshape(-1, 6)
        return [rows[number] for number in self.numbers]

    def jacobian(self, ask: State) -> Array:
        """Answer `body_jacobian` by calcFrameJacobian at the body's origin."""
        change, jacobian = self._update(ask), osim.Matrix()
        self.matter.calcFrameJacobian(self.state, self.numbers[ask.body], osim.Vec3(0), jacobian)
        return change.to_neutral_jacobian(jacobian.to_numpy()[:, self.own])


def make_joint(joint: Joint, name: str, parent: Any, child: Any) -> Any:
    """Make OpenSim's joint of the description's type between two bodies."""
    turn = np.eye(3)
    if joint.type == "revolute":
        turn = frame_with(joint.axis, 2)
    elif joint.type == "prismatic":
        turn = frame_with(joint.axis, 0)
    on_parent, on_child = coordinates.angles(joint.rotation @ turn), coordinates.angles(turn)
    places = (osim.Vec3(*joint.translation.tolist()), osim.Vec3(*on_parent.tolist()))
    return KINDS[joint.type](name, parent, *places, child, osim.Vec3(0), osim.Vec3(*on_child.tolist()))


def frame_with(axis: Array, column: int) -> Array:
    """Make a rotation one of whose columns is an axis: a half turn about the bisector of both, or of the axis's opposite."""
    unit = np.eye(3)[column]
    sign = 1.0 if axis[column] >= 0 else -1.0
    middle = sign * axis + unit
    half = 2.0 * np.outer(middle, middle) / (middle @ middle) - np.eye(3)
    if sign > 0:
        return half
    other = np.eye(3)[column - 1]
    return half @ (2.0 * np.outer(other, other) - np.eye(3))


def vector(numbers: Array) -> Any:
    """Make Simbody's vector."""
    return osim.Vector.createFromMat(np.asarray(numbers, float))


def placed(transform: Any) -> tuple[Array, Array]:
    """Read a transform's rotation and origin."""
    turn = transform.R().asMat33()
    return np.array([[turn.get(row, column) for column in range(3)] for row in range(3)]), np.array(transform.p().to_numpy())


def six(pair: Any) -> Array:
    """Read a pair of vectors."""
    return np.append(pair.get(0).to_numpy(), pair.get(1).to_numpy())


class Simbody:
    """The engine Simbody, for `session.serve`."""

    name = "simbody"
    version = importlib.metadata.version("opensim")
    build = {"language": "C++ (Python package opensim)"}
    quantities: Quantities = {
        "id": {"inverse_dynamics_solver": SimbodyRobot.inverse},
        "id_wrench": {"calc_residual_force": SimbodyRobot.inverse_wrench},
        "bias": {"inverse_dynamics_solver": SimbodyRobot.bias},
        "mass_matrix": {"calc_m": SimbodyRobot.mass_matrix},
        "mass_matrix_sparse": {"calc_m": SimbodyRobot.mass_matrix},
        "mass_matrix_probe": {"multiply_by_m": SimbodyRobot.probe},
        "fd": {"calc_acceleration": SimbodyRobot.forward, "multiply_by_m_inv": SimbodyRobot.forward_by_inverse},
        "kinetic_energy": {"calc_kinetic_energy": SimbodyRobot.kinetic},
        "com": {"calc_system_mass_center": SimbodyRobot.com},
        "momentum": {"calc_system_central_momentum": SimbodyRobot.momentum},
        "body_placement": {"transform_in_ground": SimbodyRobot.placement},
        "body_velocity": {"velocity_in_ground": SimbodyRobot.velocity},
        "body_acceleration": {"system_jacobian": SimbodyRobot.acceleration},
        "body_jacobian": {"calc_frame_jacobian": SimbodyRobot.jacobian},
    }

    def prepare(self, description: Description) -> SimbodyRobot:
        """Build the robot."""
        return SimbodyRobot(description)
