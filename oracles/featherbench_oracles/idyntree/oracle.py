"""iDynTree as an oracle."""

from __future__ import annotations

import importlib.metadata
from pathlib import Path

import idyntree.bindings as idt
import numpy as np
from numpy.typing import NDArray

from featherbench_oracles.abilities import ReadsFiles
from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.change import CoordinateChange
from featherbench_oracles.core.protocol import Quantities, Reading, State, Unsupported, mass_matrix_probe, readback_row
from featherbench_oracles.core.robot import Description
from featherbench_oracles.idyntree import coordinates, reading
from featherbench_oracles.idyntree.building import Built, build, numbers, transform


class IDynTreeRobot:
    """A robot in iDynTree. Every method that takes a question answers one quantity at its state, as `protocol.Engine` says.

    iDynTree's numbers have six rows of the base first, which only a robot that floats has. Its six-vectors are [linear; angular].

    Parameters
    ----------
    robot : Description
        The robot's coordinates.
    built : Built
        The robot.

    Raises
    ------
    ValueError
        If iDynTree does not take the model.
    """

    def __init__(self, robot: Description, built: Built) -> None:
        self.robot, self.model, self.links, self.joints = robot, built.model, built.links, built.joints
        self.floats, self.stands = coordinates.floats(robot), (built.stands.rotation, built.stands.translation)
        base = [np.arange(6)] if self.floats else []
        # Where our numbers are among iDynTree's: of q those of the joints, of velocities and forces with six of the base.
        self.places = _all([j.getPosCoordsOffset() + np.arange(j.getNrOfPosCoords()) for j in self.joints])
        self.own = _all([*base, *(6 + j.getDOFsOffset() + np.arange(j.getNrOfDOFs()) for j in self.joints)])
        self.kd = idt.KinDynComputations()
        if not self.kd.loadRobotModel(self.model):
            raise ValueError("iDynTree does not take the model")
        self.kd.setFrameVelocityRepresentation(idt.MIXED_REPRESENTATION)
        self.traversal = idt.Traversal()
        self.model.computeFullTreeTraversal(self.traversal)
        self.workspace = idt.ArticulatedBodyAlgorithmInternalBuffers(self.model)

    def readback(self) -> list[Array]:
        """Read back each link's inertia, which is kept about its origin, and each joint's rest transform."""
        rows = []
        joints = iter(self.joints)
        for link, body in zip(self.links, self.robot.bodies, strict=True):
            held = self.model.getLink(link).getInertia()
            com, inertia = numbers(held.getCenterOfMass()), numbers(held.getRotationalInertiaWrtCenterOfMass())
            place = transform(body.joint.rotation, body.joint.translation)
            if body.joint.type != "free":
                joint = next(joints)
                place = joint.getRestTransform(joint.getFirstAttachedLink(), joint.getSecondAttachedLink())
            rows.append(readback_row(held.getMass(), com, inertia, numbers(place.getRotation()), numbers(place.getPosition())))
        return rows

    # ---- the state

    def _update(self, ask: State) -> CoordinateChange:
        """Set q and v."""
        change = coordinates.change_of_velocities(self.robot, ask.q, ask.v)
        base, joints = self._split(change.to_engine_v(ask.v))
        self.kd.setRobotState(
            transform(*(coordinates.base(self.robot, ask.q) if self.floats else self.stands)),
            _vector(self._positions(ask.q)),
            idt.Twist.FromPython(base.tolist()),
            _vector(joints),
            idt.Vector3.FromPython(self.robot.gravity.tolist()),
        )
        return change

    def _split(self, own: Array) -> tuple[Array, Array]:
        """Put our numbers in iDynTree's places: those of the base, which are zero where it has none, and those of the joints."""
        whole = np.zeros(6 + self.model.getNrOfDOFs())
        whole[self.own] = own
        return whole[:6], whole[6:]

    def _positions(self, q: Array) -> Array:
        whole = np.zeros(self.model.getNrOfPosCoords())
        whole[self.places] = coordinates.to_engine_q(self.robot, q)
        return whole

    def _acceleration(self, change: CoordinateChange, a: Array) -> tuple[idt.Vector6, idt.VectorDynSize]:
        base, joints = self._split(change.to_engine_a(a))
        return idt.Vector6.FromPython(base.tolist()), _vector(joints)

    def _forces(self, forces: idt.FreeFloatingGeneralizedTorques) -> Array:
        return np.append(numbers(forces.baseWrench()), numbers(forces.jointTorques()))[self.own]

    def _mass(self) -> Array:
        mass = idt.MatrixDynSize()
        self.kd.getFreeFloatingMassMatrix(mass)
        return numbers(mass)[np.ix_(self.own, self.own)]

    # ---- dynamics

    def inverse(self, ask: State) -> Array:
        """Answer `id` by inverseDynamics."""
        return self._inverse(ask, idt.LinkWrenches(self.model))

    def inverse_wrench(self, ask: State) -> Array:
        """Answer `id_wrench` by inverseDynamics with a wrench on each link, in world axes at its origin."""
        wrenches = idt.LinkWrenches(self.model)
        turns = self._turns(ask)
        for k, wrench in enumerate(ask.wrench):
            turned = np.append(turns[k] @ wrench[3:], turns[k] @ wrench[:3])
            wrenches[self.links[k]] = idt.Wrench.FromPython(turned.tolist())
        return self._inverse(ask, wrenches)

    def _inverse(self, ask: State, wrenches: idt.LinkWrenches) -> Array:
        change, forces = self._update(ask), idt.FreeFloatingGeneralizedTorques(self.model)
        self.kd.inverseDynamics(*self._acceleration(change, ask.a), wrenches, forces)
        return change.to_neutral_tau(self._forces(forces))

    def bias(self, ask: State) -> Array:
        """Answer `bias` by h = T' (generalizedBiasForces + M_e b)."""
        change, forces = self._update(ask), idt.FreeFloatingGeneralizedTorques(self.model)
        self.kd.generalizedBiasForces(forces)
        return change.to_neutral_tau(self._forces(forces) + self._mass() @ change.b)

    def mass_matrix(self, ask: State) -> Array:
        """Answer `mass_matrix` by getFreeFloatingMassMatrix."""
        return self._update(ask).to_neutral_mass(self._mass())

    def probe(self, ask: State) -> Array:
        """Answer `mass_matrix_probe` by the M of `mass_matrix`."""
        mass = self.mass_matrix(ask)
        return mass_matrix_probe(mass.__matmul__, np.diag(mass), ask.probe)

    def aba(self, ask: State) -> Array:
        """Answer `fd` by ArticulatedBodyAlgorithm: in the base's axes, and without gravity, which falls with the base."""
        if not self.floats:
            raise Unsupported("iDynTree's articulated body algorithm is that of a floating base")
        turn, _ = coordinates.base(self.robot, ask.q)
        at, moves, wrenches = idt.FreeFloatingPos(self.model), idt.FreeFloatingVel(self.model), idt.LinkWrenches(self.model)
        torques, answer = idt.JointDOFsDoubleArray(self.model), idt.FreeFloatingAcc(self.model)
        base_velocity, velocities = self._split(ask.v)
        base_force, forces = self._split(ask.tau)
        for target, given in (
            (at.jointPos, self._positions(ask.q)),
            (moves.baseVel, base_velocity),
            (moves.jointVel, velocities),
            (torques, forces),
        ):
            for k, number in enumerate(given.tolist()):
                target.setVal(k, number)
        wrenches[self.model.getDefaultBaseLink()] = idt.Wrench.FromPython(base_force.tolist())
        if not idt.ArticulatedBodyAlgorithm(self.model, self.traversal, at, moves, wrenches, torques, self.workspace, answer):
            raise Unsupported("iDynTree's articulated body algorithm refuses the robot: it has no spherical joint, for one")
        fall = np.append(turn.T @ self.robot.gravity, np.zeros(3))
        return np.append(numbers(answer.baseAcc) + fall, numbers(answer.jointAcc))[self.own]

    # ---- derivatives

    def coriolis(self, ask: State) -> Array:
        """Answer `coriolis_matrix` by getCoriolisAndMassMatrices in the body-fixed representation, whose velocities are ours."""
        self._update(ask)
        size = 6 + self.model.getNrOfDOFs()
        coriolis, mass, rate = (idt.MatrixDynSize(size, size) for _ in range(3))
        self.kd.setFrameVelocityRepresentation(idt.BODY_FIXED_REPRESENTATION)
        try:
            self.kd.getCoriolisAndMassMatrices(coriolis, mass, rate)
        finally:
            self.kd.setFrameVelocityRepresentation(idt.MIXED_REPRESENTATION)
        return numbers(coriolis)[np.ix_(self.own, self.own)]

    def regressor(self, ask: State) -> Array:
        """Answer `torque_regressor` by inverseDynamicsInertialParametersRegressor, whose parameters are ours."""
        change, links = self._update(ask), self.model.getNrOfLinks()
        regressor = idt.MatrixDynSize(6 + self.model.getNrOfDOFs(), 10 * links)
        self.kd.inverseDynamicsInertialParametersRegressor(*self._acceleration(change, ask.a), regressor)
        whole = change.to_neutral_tau(numbers(regressor)[self.own])
        return whole.reshape(self.robot.nv, links, 10)[:, self.links]

    # ---- momentum, kinematics

    def com(self, ask: State) -> Array:
        """Answer `com` by getCenterOfMassPosition."""
        self._update(ask)
        return numbers(self.kd.getCenterOfMassPosition())

    def momentum(self, ask: State) -> Array:
        """Answer `momentum` by getCentroidalTotalMomentum, in world axes."""
        self._update(ask)
        return _angular_first(numbers(self.kd.getCentroidalTotalMomentum()))

    def _turns(self, ask: State) -> list[Array]:
        return [row[:9].reshape(3, 3) for row in self.placement(ask)]

    def placement(self, ask: State) -> list[Array]:
        """Answer `body_placement` by getWorldTransform."""
        self._update(ask)
        poses = [self.kd.getWorldTransform(link) for link in self.links]
        return [np.append(numbers(pose.getRotation()).ravel(), numbers(pose.getPosition())) for pose in poses]

    def velocity(self, ask: State) -> list[Array]:
        """Answer `body_velocity` by getFrameVel."""
        self._update(ask)
        return [_angular_first(numbers(self.kd.getFrameVel(link))) for link in self.links]

    def acceleration(self, ask: State) -> list[Array]:
        """Answer `body_acceleration` by getFrameAcc, the derivative of getFrameVel."""
        given = self._acceleration(self._update(ask), ask.a)
        return [_angular_first(numbers(self.kd.getFrameAcc(link, *given))) for link in self.links]

    def jacobian(self, ask: State) -> Array:
        """Answer `body_jacobian` by getFrameFreeFloatingJacobian."""
        change, jacobian = self._update(ask), idt.MatrixDynSize(6, 6 + self.model.getNrOfDOFs())
        self.kd.getFrameFreeFloatingJacobian(self.links[ask.body], jacobian)
        return change.to_neutral_jacobian(_angular_first(numbers(jacobian)[:, self.own]))


def _vector(given: Array) -> idt.VectorDynSize:
    return idt.VectorDynSize.FromPython(given.tolist())


def _all(parts: list[NDArray[np.intp]]) -> NDArray[np.intp]:
    return np.concatenate(parts) if parts else np.zeros(0, dtype=np.intp)


def _angular_first(linear_first: Array) -> Array:
    return np.roll(linear_first, 3, axis=0)


class IDynTree(ReadsFiles):
    """The engine iDynTree, for `session.serve`."""

    name = "idyntree"
    version = importlib.metadata.version("idyntree")
    build = {"language": "C++ (Python package idyntree)"}
    formats = ("urdf",)
    quantities: Quantities = {
        "id": {"inverse_dynamics": IDynTreeRobot.inverse},
        "id_wrench": {"inverse_dynamics": IDynTreeRobot.inverse_wrench},
        "bias": {"generalized_bias_forces": IDynTreeRobot.bias},
        "mass_matrix": {"free_floating_mass_matrix": IDynTreeRobot.mass_matrix},
        "mass_matrix_sparse": {"free_floating_mass_matrix": IDynTreeRobot.mass_matrix},
        "mass_matrix_probe": {"free_floating_mass_matrix": IDynTreeRobot.probe},
        "fd": {"aba": IDynTreeRobot.aba},
        "coriolis_matrix": {"coriolis_and_mass_matrices": IDynTreeRobot.coriolis},
        "torque_regressor": {"inertial_parameters_regressor": IDynTreeRobot.regressor},
        "com": {"center_of_mass_position": IDynTreeRobot.com},
        "momentum": {"centroidal_total_momentum": IDynTreeRobot.momentum},
        "body_placement": {"world_transform": IDynTreeRobot.placement},
        "body_velocity": {"frame_vel": IDynTreeRobot.velocity},
        "body_acceleration": {"frame_acc": IDynTreeRobot.acceleration},
        "body_jacobian": {"frame_free_floating_jacobian": IDynTreeRobot.jacobian},
    }

    def read(self, path: Path, form: str, base: str) -> Reading:
        """Read a URDF by ModelLoader."""
        return reading.read(path, form, base, IDynTreeRobot)

    def prepare(self, description: Description) -> IDynTreeRobot:
        """Build the robot. iDynTree has no armature."""
        return IDynTreeRobot(description, build(description))
