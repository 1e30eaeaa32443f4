"""Drake as an oracle: the robot is built with the calls of a continuous `MultibodyPlant(0.0)`, never by a parser.

Joints are Revolute, Prismatic, Screw (whose pitch is per *revolution*), BallRpy (Drake has no quaternion ball joint), QuaternionFloating,
Planar and Universal. Armature is the rotor inertia, at gear ratio 1, of an actuator, which Drake gives to one-dof joints only. Damping is
never set. Inertias skip Drake's validity check, so that unphysical bodies are answered for as well.
"""

from __future__ import annotations

import importlib.metadata
import sys
from math import pi
from pathlib import Path

import drake_reading
import numpy as np

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


def make_joint(joint: Joint, name: str, parent: tree.Frame, child: tree.Frame) -> tree.Joint:
    """Drake's joint of that type."""
    makers = {
        "revolute": lambda: tree.RevoluteJoint(name, parent, child, joint.axis),
        "prismatic": lambda: tree.PrismaticJoint(name, parent, child, joint.axis),
        "helical": lambda: tree.ScrewJoint(name, parent, child, joint.axis, 2 * pi * joint.pitch, 0.0),
        "spherical": lambda: tree.BallRpyJoint(name, parent, child),
        "free": lambda: tree.QuaternionFloatingJoint(name, parent, child),
        "planar": lambda: tree.PlanarJoint(name, parent, child),
        "universal": lambda: tree.UniversalJoint(name, parent, child),
    }
    return makers[joint.type]()


def build(robot: Description) -> tuple[MultibodyPlant, list[tree.Joint]]:
    """The plant of a description, and its joints in order."""
    plant = MultibodyPlant(0.0)
    plant.mutable_gravity_field().set_gravity_vector(robot.gravity)
    joints: list[tree.Joint] = []
    for i, body in enumerate(robot.bodies):
        joint = body.joint
        parent = joints[body.parent].child_body() if body.parent >= 0 else plant.world_body()
        child = plant.AddRigidBody(f"{i}: {body.name}", spatial_inertia(body))
        placement = RigidTransform(RotationMatrix(joint.rotation), joint.translation)
        frame = plant.AddFrame(tree.FixedOffsetFrame(f"frame {i}", parent.body_frame(), placement))
        joints.append(plant.AddJoint(make_joint(joint, f"joint {i}", frame, child.body_frame())))
        if joint.armature.any():
            if len(joint.armature) > 1:
                raise Unsupported(f"Drake has no armature on joint {joint.name} of more than one degree of freedom")
            actuator = plant.AddJointActuator(f"actuator {i}", joints[i])
            actuator.set_default_rotor_inertia(joint.armature[0])
            actuator.set_default_gear_ratio(1.0)
    plant.Finalize()
    return plant, joints


class DrakeRobot:
    """A robot in Drake."""

    def __init__(self, robot: Description, plant: MultibodyPlant, joints: list[tree.Joint]) -> None:
        self.robot, self.plant, self.joints = robot, plant, joints
        self.bodies = [joint.child_body() for joint in joints]
        for mine, joint in zip(joints, (body.joint for body in robot.bodies), strict=True):
            if mine.velocity_start() != joint.v.start:
                raise RuntimeError(f"Drake put joint {joint.name} elsewhere")
        self.context = plant.CreateDefaultContext()
        self.forces = tree.MultibodyForces(plant)

    def readback(self) -> list[Array]:
        """The inertia about the centre of mass is I = I_origin + m [c]x^2."""
        rows = []
        for body, joint in zip(self.bodies, self.joints, strict=True):
            held = body.CalcSpatialInertiaInBodyFrame(self.context)
            mass, com = held.get_mass(), held.get_com()
            inertia = held.CalcRotationalInertia().CopyToFullMatrix3() + mass * skew(com) @ skew(com)
            placement = joint.frame_on_parent().GetFixedPoseInBodyFrame()
            rows.append(readback_row(mass, com, inertia, placement.rotation().matrix(), placement.translation()))
        return rows

    def _update(self, ask: Question) -> Change:
        """Sets q and v."""
        change = change_of_velocities(self.robot, ask.q, ask.v)
        self.plant.SetPositions(self.context, to_engine_q(self.robot, ask.q))
        self.plant.SetVelocities(self.context, change.to_engine_v(ask.v))
        return change

    # ---- dynamics

    def _inverse(self, a: Array) -> Array:
        """tau_e at engine accelerations under `self.forces`."""
        return self.plant.CalcInverseDynamics(self.context, a, self.forces)

    def inverse_dynamics(self, ask: Question) -> Array:
        """tau = CalcInverseDynamics under gravity."""
        change = self._update(ask)
        self.plant.CalcForceElementsContribution(self.context, self.forces)
        return change.to_neutral_tau(self._inverse(change.to_engine_a(ask.a)))

    def inverse_wrench(self, ask: Question) -> Array:
        """The same under gravity and a force on every body, in its axes at its origin."""
        change = self._update(ask)
        self.plant.CalcForceElementsContribution(self.context, self.forces)
        for body, wrench in zip(self.bodies, ask.wrench, strict=True):
            force = SpatialForce(tau=wrench[:3], f=wrench[3:])
            body.AddInForce(self.context, np.zeros(3), force, body.body_frame(), self.forces)
        return change.to_neutral_tau(self._inverse(change.to_engine_a(ask.a)))

    def bias_inverse(self, ask: Question) -> Array:
        """h = CalcInverseDynamics at a = 0."""
        change = self._update(ask)
        self.plant.CalcForceElementsContribution(self.context, self.forces)
        return change.to_neutral_tau(self._inverse(change.b))

    def bias_term(self, ask: Question) -> Array:
        """h = T' (C v - tau_gravity + M_e b)."""
        change = self._update(ask)
        bias = self.plant.CalcBiasTerm(self.context) - self.plant.CalcGravityGeneralizedForces(self.context)
        if change.b.any():
            bias += self.plant.CalcMassMatrix(self.context) @ change.b
        return change.to_neutral_tau(bias)

    def crba(self, ask: Question) -> Array:
        """M by the composite body algorithm."""
        change = self._update(ask)
        return change.to_neutral_mass(self.plant.CalcMassMatrix(self.context))

    def mass_by_inverse_dynamics(self, ask: Question) -> Array:
        """M column by column from inverse dynamics."""
        change = self._update(ask)
        return change.to_neutral_mass(self.plant.CalcMassMatrixViaInverseDynamics(self.context))

    def probe(self, ask: Question) -> Array:
        """Products with, and parts of, the M of `crba`."""
        mass = self.crba(ask)
        return mass_matrix_probe(mass.__matmul__, np.diag(mass), ask.probe)

    def aba(self, ask: Question) -> Array:
        """The articulated body algorithm."""
        change = self._update(ask)
        self.plant.get_applied_generalized_force_input_port().FixValue(self.context, change.to_engine_tau(ask.tau))
        return change.to_neutral_a(self.plant.get_generalized_acceleration_output_port().Eval(self.context))

    # ---- energies, momentum, kinematics

    def kinetic_energy(self, ask: Question) -> float:
        """½ v' M v."""
        self._update(ask)
        return self.plant.CalcKineticEnergy(self.context)

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

    def jacobian(self, ask: Question) -> Array:
        """J of the asked body in world axes at its origin."""
        change = self._update(ask)
        frame, world, speeds = self.bodies[ask.body].body_frame(), self.plant.world_frame(), tree.JacobianWrtVariable.kV
        return change.to_neutral_jacobian(
            self.plant.CalcJacobianSpatialVelocity(self.context, speeds, frame, np.zeros(3), world, world)
        )


class Drake:
    """The engine."""

    name = "drake"
    version = importlib.metadata.version("drake")
    build = {"language": "C++ (Python package drake)"}
    quantities = {
        "id": {"inverse_dynamics": DrakeRobot.inverse_dynamics},
        "id_wrench": {"inverse_dynamics": DrakeRobot.inverse_wrench},
        "bias": {"bias_term": DrakeRobot.bias_term, "inverse_dynamics": DrakeRobot.bias_inverse},
        "mass_matrix": {"crba": DrakeRobot.crba, "inverse_dynamics": DrakeRobot.mass_by_inverse_dynamics},
        "mass_matrix_probe": {"crba": DrakeRobot.probe},
        "fd": {"aba": DrakeRobot.aba},
        "kinetic_energy": {"kinetic_energy": DrakeRobot.kinetic_energy},
        "potential_energy": {"potential_energy": DrakeRobot.potential_energy},
        "com": {"center_of_mass": DrakeRobot.com},
        "momentum": {"spatial_momentum": DrakeRobot.momentum},
        "body_placement": {"body_poses": DrakeRobot.placement},
        "body_velocity": {"body_velocities": DrakeRobot.velocity},
        "body_acceleration": {"spatial_accelerations": DrakeRobot.acceleration},
        "body_jacobian": {"jacobian_spatial_velocity": DrakeRobot.jacobian},
    }

    def prepare(self, description: Description) -> DrakeRobot:
        """Builds the robot."""
        return DrakeRobot(description, *build(description))

    def read(self, path: Path, form: str, base: str) -> Reading:
        """Has Drake's own parser read a file."""
        return drake_reading.read(path, form, base, DrakeRobot)


if __name__ == "__main__":
    serve(Drake())
