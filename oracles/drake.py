"""Drake as an oracle: the robot is built with the calls of a continuous `MultibodyPlant(0.0)`, never by a parser.

Joints are Revolute, Prismatic, Screw (whose pitch is per *revolution*), BallRpy (Drake has no quaternion ball joint), QuaternionFloating,
Planar and Universal; translation, cylindrical and euler_zyx, which Drake has not, are chains of Prismatic and Revolute joints with massless
bodies between (BallRpy has the angles of euler_zyx, but not their rates: its velocity is the angular one). Armature is the rotor inertia,
at gear ratio 1, of an actuator, which Drake gives to one-dof joints only. Damping is never set. Inertias skip Drake's validity check, so
that unphysical bodies are answered for as well.
"""

from __future__ import annotations

import importlib.metadata
import sys
from collections.abc import Callable
from math import pi
from pathlib import Path

import drake_reading
import numpy as np

from clock import NOTHING, Calls
from protocol import (
    Array,
    Body,
    Change,
    Description,
    Joint,
    Question,
    Reading,
    Unsupported,
    mass_matrix_probe,
    readback_row,
    rotation,
    serve,
    skew,
)

sys.path.pop(0)  # this directory, where other files are called like the packages they import
from pydrake.common.eigen_geometry import Quaternion  # noqa: E402
from pydrake.math import RigidTransform, RollPitchYaw, RotationMatrix  # noqa: E402
from pydrake.multibody import tree  # noqa: E402
from pydrake.multibody.math import SpatialForce  # noqa: E402
from pydrake.multibody.plant import MultibodyPlant  # noqa: E402

# ---- coordinates -----------------------------------------------------------------------------------------------------------------
# joint      q_e                     T                 b
# free       quaternion wxyz, p      [[0, R], [R, 0]]  (0, R (ω × v)): [angular; linear] in joint-frame axes, R from body to joint frame
# spherical  roll, pitch, yaw of R   R                 0: angular velocity in joint-frame axes
# all other  q                       identity          0


def to_engine_q(robot: Description, q: Array) -> Array:
    """q_e of the table."""
    return np.concatenate([_joint_q(body.joint, q[body.joint.q]) for body in robot.bodies])


def _joint_q(joint: Joint, q: Array) -> Array:
    if joint.type == "spherical":
        return RollPitchYaw(Quaternion(wxyz=np.roll(q / np.linalg.norm(q), 1))).vector()
    if joint.type == "free":
        return np.concatenate([np.roll(q[3:], 1), q[:3]])
    return q


def change_of_velocities(robot: Description, q: Array, v: Array) -> Change:
    """T and b of the table."""
    blocks, bias = [], np.zeros(robot.nv)
    for joint in (body.joint for body in robot.bodies):
        if joint.type == "spherical":
            blocks.append((joint.v, rotation(q[joint.q])))
        if joint.type == "free":
            r, zero = rotation(q[joint.q][3:]), np.zeros((3, 3))
            linear, angular = v[joint.v][:3], v[joint.v][3:]
            blocks.append((joint.v, np.block([[zero, r], [r, zero]])))
            bias[joint.v] = np.append(np.zeros(3), r @ np.cross(angular, linear))
    return Change(tuple(blocks), bias)


# ---- the robot -------------------------------------------------------------------------------------------------------------------


def spatial_inertia(body: Body) -> tree.SpatialInertia:
    """Drake keeps the unit inertia about the *body's origin*: G = I / m - [c]x^2."""
    if body.mass == 0 and body.inertia.any():
        raise Unsupported(f"Drake cannot hold the rotational inertia of the massless body {body.name}")
    g = body.inertia / body.mass - skew(body.com) @ skew(body.com) if body.mass else np.zeros((3, 3))
    unit = tree.UnitInertia(g[0, 0], g[1, 1], g[2, 2], g[0, 1], g[0, 2], g[1, 2])
    return tree.SpatialInertia(body.mass, body.com, unit, skip_validity_check=True)


JointMaker = Callable[[str, tree.Frame, tree.Frame], tree.Joint]


def joint_chain(joint: Joint) -> list[JointMaker]:
    """Drake's joint of that type, or the joints that make it up, from the parent outwards."""

    def turn(axis: Array) -> JointMaker:
        return lambda name, parent, child: tree.RevoluteJoint(name, parent, child, axis)

    def slide(axis: Array) -> JointMaker:
        return lambda name, parent, child: tree.PrismaticJoint(name, parent, child, axis)

    x, y, z = np.eye(3)
    chains: dict[str, list[JointMaker]] = {
        "revolute": [turn(joint.axis)],
        "prismatic": [slide(joint.axis)],
        "helical": [lambda name, parent, child: tree.ScrewJoint(name, parent, child, joint.axis, 2 * pi * joint.pitch, 0.0)],
        "spherical": [tree.BallRpyJoint],
        "free": [tree.QuaternionFloatingJoint],
        "planar": [tree.PlanarJoint],
        "universal": [tree.UniversalJoint],
        "translation": [slide(x), slide(y), slide(z)],
        "cylindrical": [turn(joint.axis), slide(joint.axis)],
        "euler_zyx": [turn(z), turn(y), turn(x)],
    }
    return chains[joint.type]


def build(robot: Description) -> tuple[MultibodyPlant, list[list[tree.Joint]]]:
    """The plant of a description, and for each body its joint, or the joints that make it up."""
    plant = MultibodyPlant(0.0)
    plant.mutable_gravity_field().set_gravity_vector(robot.gravity)
    chains: list[list[tree.Joint]] = []
    for i, body in enumerate(robot.bodies):
        parent = chains[body.parent][-1].child_body() if body.parent >= 0 else plant.world_body()
        chains.append(_add(plant, i, body, parent))
    plant.Finalize()
    return plant, chains


def _add(plant: MultibodyPlant, i: int, body: Body, parent: tree.RigidBody) -> list[tree.Joint]:
    """Adds body i and its joint."""
    joint = body.joint
    placement = RigidTransform(RotationMatrix(joint.rotation), joint.translation)
    frame = plant.AddFrame(tree.FixedOffsetFrame(f"frame {i}", parent.body_frame(), placement))
    makers = joint_chain(joint)
    if joint.armature.any() and len(joint.armature) > len(makers):
        raise Unsupported(f"Drake has no armature on its {joint.type} joint ({joint.name}), which has several degrees of freedom")
    chain: list[tree.Joint] = []
    for k, make in enumerate(makers, start=1):
        name, inertia = (f"{i}: {body.name}", spatial_inertia(body)) if k == len(makers) else (f"{i}.{k}", tree.SpatialInertia.Zero())
        moved = plant.AddRigidBody(name, inertia)
        chain.append(plant.AddJoint(make(f"joint {i}.{k}", frame, moved.body_frame())))
        frame = moved.body_frame()
    if joint.armature.any():
        for k, (part, armature) in enumerate(zip(chain, joint.armature, strict=True), start=1):
            actuator = plant.AddJointActuator(f"actuator {i}.{k}", part)
            actuator.set_default_rotor_inertia(armature)
            actuator.set_default_gear_ratio(1.0)
    return chain


class DrakeRobot:
    """A robot in Drake: for each body of the description the joint, or the joints, that carry it."""

    def __init__(self, robot: Description, plant: MultibodyPlant, chains: list[list[tree.Joint]]) -> None:
        self.robot, self.plant, self.chains = robot, plant, chains
        self.bodies = [chain[-1].child_body() for chain in chains]
        parts = [part for chain in chains for part in chain]
        firsts = [chain[0].velocity_start() for chain in chains]
        orders = [part.position_start() for part in parts], [part.velocity_start() for part in parts]
        if firsts != [body.joint.v.start for body in robot.bodies] or any(order != sorted(order) for order in orders):
            raise RuntimeError("Drake put the degrees of freedom in another order")
        self.context = plant.CreateDefaultContext()
        self.forces = tree.MultibodyForces(plant)
        self.drive = plant.get_applied_generalized_force_input_port().FixValue(self.context, np.zeros(plant.num_velocities()))

    def readback(self) -> list[Array]:
        """The inertia about the centre of mass is I = I_origin + m [c]x^2."""
        rows = []
        for body, chain in zip(self.bodies, self.chains, strict=True):
            held = body.CalcSpatialInertiaInBodyFrame(self.context)
            mass, com = held.get_mass(), held.get_com()
            inertia = held.CalcRotationalInertia().CopyToFullMatrix3() + mass * skew(com) @ skew(com)
            placement = chain[0].frame_on_parent().GetFixedPoseInBodyFrame()
            rows.append(readback_row(mass, com, inertia, placement.rotation().matrix(), placement.translation()))
        return rows

    # ---- coordinates

    def positions(self, q: Array) -> Array:
        """q_e."""
        return to_engine_q(self.robot, q)

    def change(self, ask: Question) -> Change:
        """T and b."""
        if not np.isfinite([*ask.q, *ask.v, *ask.a, *ask.tau]).all():
            raise ValueError("Drake ends the process at numbers that are not finite")
        return change_of_velocities(self.robot, ask.q, ask.v)

    def _update(self, ask: Question) -> Change:
        """Sets q and v."""
        change = self.change(ask)
        self._set(self.positions(ask.q), change.to_engine_v(ask.v))
        return change

    def _set(self, q: Array, v: Array) -> None:
        """Sets q_e and v_e, whereupon Drake forgets what it has computed."""
        self.plant.SetPositions(self.context, q)
        self.plant.SetVelocities(self.context, v)

    # ---- calls that can be timed, in Drake's coordinates

    def inverse_dynamics(self, q: Array, v: Array, a: Array) -> Array:
        """tau_e = CalcInverseDynamics under gravity."""
        self._set(q, v)
        self.plant.CalcForceElementsContribution(self.context, self.forces)
        return self.plant.CalcInverseDynamics(self.context, a, self.forces)

    def crba(self, q: Array) -> Array:
        """M_e by the composite body algorithm."""
        self.plant.SetPositions(self.context, q)
        return self.plant.CalcMassMatrix(self.context)

    def aba(self, q: Array, v: Array, tau: Array) -> Array:
        """a_e by the articulated body algorithm."""
        self._set(q, v)
        self.drive.GetMutableData().get_mutable_value().SetFromVector(tau)
        return self.plant.get_generalized_acceleration_output_port().Eval(self.context)

    def kinetic_energy(self, q: Array, v: Array) -> float:
        """½ v' M v."""
        self._set(q, v)
        return self.plant.CalcKineticEnergy(self.context)

    def jacobian(self, q: Array, number: int) -> Array:
        """J_e of a body, or of the world, in world axes at its origin."""
        self.plant.SetPositions(self.context, q)
        world, speeds = self.plant.world_frame(), tree.JacobianWrtVariable.kV
        frame = world if number == NOTHING else self.bodies[number].body_frame()
        return self.plant.CalcJacobianSpatialVelocity(self.context, speeds, frame, np.zeros(3), world, world)

    # ---- dynamics

    def inverse_wrench(self, ask: Question) -> Array:
        """tau = CalcInverseDynamics under gravity and a force on every body, in its axes at its origin."""
        change = self._update(ask)
        self.plant.CalcForceElementsContribution(self.context, self.forces)
        for body, wrench in zip(self.bodies, ask.wrench, strict=True):
            force = SpatialForce(tau=wrench[:3], f=wrench[3:])
            body.AddInForce(self.context, np.zeros(3), force, body.body_frame(), self.forces)
        return change.to_neutral_tau(self.plant.CalcInverseDynamics(self.context, change.to_engine_a(ask.a), self.forces))

    def bias_term(self, ask: Question) -> Array:
        """h = T' (C v - tau_gravity + M_e b)."""
        change = self._update(ask)
        bias = self.plant.CalcBiasTerm(self.context) - self.plant.CalcGravityGeneralizedForces(self.context)
        if change.b.any():
            bias += self.plant.CalcMassMatrix(self.context) @ change.b
        return change.to_neutral_tau(bias)

    def mass_by_inverse_dynamics(self, ask: Question) -> Array:
        """M column by column from inverse dynamics."""
        change = self._update(ask)
        return change.to_neutral_mass(self.plant.CalcMassMatrixViaInverseDynamics(self.context))

    def probe(self, ask: Question) -> Array:
        """Products with, and parts of, the M of `crba`."""
        mass = self.change(ask).to_neutral_mass(self.crba(self.positions(ask.q)))
        return mass_matrix_probe(mass.__matmul__, np.diag(mass), ask.probe)

    # ---- energies, momentum, kinematics

    def potential_energy(self, ask: Question) -> float:
        """-Σ m g·c."""
        self._update(ask)
        return self.plant.CalcPotentialEnergy(self.context)

    def com(self, ask: Question) -> Array:
        """The centre of mass."""
        self._update(ask)
        return self.plant.CalcCenterOfMassPositionInWorld(self.context)

    def momentum(self, ask: Question) -> Array:
        """Spatial momentum about the centre of mass."""
        momentum = self.plant.CalcSpatialMomentumInWorldAboutPoint(self.context, self.com(ask))
        return np.append(momentum.rotational(), momentum.translational())

    def placement(self, ask: Question) -> list[Array]:
        """Rotation and origin of each body."""
        self._update(ask)
        poses = [body.EvalPoseInWorld(self.context) for body in self.bodies]
        return [np.append(pose.rotation().matrix().ravel(), pose.translation()) for pose in poses]

    def velocity(self, ask: Question) -> list[Array]:
        """Velocity of each body in world axes at its origin."""
        self._update(ask)
        velocities = [body.EvalSpatialVelocityInWorld(self.context) for body in self.bodies]
        return [np.append(v.rotational(), v.translational()) for v in velocities]

    def acceleration(self, ask: Question) -> list[Array]:
        """Drake's spatial acceleration is the classical one of the body's origin."""
        change = self._update(ask)
        by_index = self.plant.CalcSpatialAccelerationsFromVdot(self.context, change.to_engine_a(ask.a))
        accelerations = [by_index[body.index()] for body in self.bodies]
        return [np.append(a.rotational(), a.translational()) for a in accelerations]


class Drake:
    """The engine."""

    name = "drake"
    version = importlib.metadata.version("drake")
    build = {"language": "C++ (Python package drake)"}
    quantities = {
        "id": {"inverse_dynamics": Calls("q v a", DrakeRobot.inverse_dynamics, Change.to_neutral_tau)},
        "id_wrench": {"inverse_dynamics": DrakeRobot.inverse_wrench},
        "bias": {
            "bias_term": DrakeRobot.bias_term,
            "inverse_dynamics": Calls("q v b", DrakeRobot.inverse_dynamics, Change.to_neutral_tau),
        },
        "mass_matrix": {
            "crba": Calls("q", DrakeRobot.crba, Change.to_neutral_mass),
            "inverse_dynamics": DrakeRobot.mass_by_inverse_dynamics,
        },
        "mass_matrix_sparse": {"crba": Calls("q", DrakeRobot.crba, Change.to_neutral_mass)},
        "mass_matrix_probe": {"crba": DrakeRobot.probe},
        "fd": {"aba": Calls("q v tau", DrakeRobot.aba, Change.to_neutral_a)},
        "kinetic_energy": {"kinetic_energy": Calls("q v", DrakeRobot.kinetic_energy)},
        "potential_energy": {"potential_energy": DrakeRobot.potential_energy},
        "com": {"center_of_mass": DrakeRobot.com},
        "momentum": {"spatial_momentum": DrakeRobot.momentum},
        "body_placement": {"body_poses": DrakeRobot.placement},
        "body_velocity": {"body_velocities": DrakeRobot.velocity},
        "body_acceleration": {"spatial_accelerations": DrakeRobot.acceleration},
        "body_jacobian": {"jacobian_spatial_velocity": Calls("q body", DrakeRobot.jacobian, Change.to_neutral_jacobian)},
    }

    def prepare(self, description: Description) -> DrakeRobot:
        """Builds the robot."""
        return DrakeRobot(description, *build(description))

    def read(self, path: Path, form: str, base: str) -> Reading:
        """Has Drake's own parser read a file."""
        return drake_reading.read(path, form, base, DrakeRobot)


if __name__ == "__main__":
    serve(Drake())
