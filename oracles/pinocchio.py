"""Pinocchio as an oracle: the robot is built with `pin.Model.addJoint` and `appendBodyToJoint`, never by a parser.

Joints are native: Revolute, Prismatic and Helical, in their aligned form (RX, PY, HZ, ...) where the axis is exactly a unit vector of the
frame and unaligned otherwise; Spherical, FreeFlyer, Planar, Universal(x, y), Translation, SphericalZYX; a cylindrical joint is a Composite
of a revolute and a prismatic one. Damping and dry friction are never set (rnea and aba would ignore them). Joints come depth-first, without
which crba is wrong silently; `model.check(data)` is asserted.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pinocchio_reading

from protocol import Array, Body, Change, Description, Joint, Question, Reading, Unsupported, mass_matrix_probe, readback_row, serve

sys.path.pop(0)  # this directory, where this very file would be taken for the package imported next
import eigenpy  # noqa: E402
import pinocchio as pin  # noqa: E402

# ---- coordinates -----------------------------------------------------------------------------------------------------------------
# joint      q_e                      T               b
# planar     x, y, cos θ, sin θ       diag(R(θ)', 1)  (θ̇ v_y, -θ̇ v_x, 0) with v = R(θ)' (ẋ, ẏ): Pinocchio's v is in body axes
# all other  q                        identity        0


def to_engine_q(robot: Description, q: Array) -> Array:
    """q_e: neutral, but a planar joint's angle becomes its cosine and sine."""
    return np.concatenate([_planar_q(*q[b.joint.q]) if b.joint.type == "planar" else q[b.joint.q] for b in robot.bodies])


def _planar_q(x: float, y: float, theta: float) -> Array:
    return np.array([x, y, np.cos(theta), np.sin(theta)])


def change_of_velocities(robot: Description, q: Array, v: Array) -> Change:
    """T and b of the table."""
    blocks, bias = [], np.zeros(robot.nv)
    for joint in (body.joint for body in robot.bodies):
        if joint.type == "planar":
            theta, rate = q[joint.q][2], v[joint.v][2]
            c, s = np.cos(theta), np.sin(theta)
            t = np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])
            vx, vy, _ = t @ v[joint.v]
            blocks.append((joint.v, t))
            bias[joint.v] = rate * vy, -rate * vx, 0
    return Change(tuple(blocks), bias)


def to_angular_first(motion: pin.Motion | pin.Force) -> Array:
    """[angular; linear] of a 6-vector of Pinocchio, which begins with the linear part."""
    return np.concatenate([motion.angular, motion.linear])


# ---- the robot -------------------------------------------------------------------------------------------------------------------


def about_axis(kind: str, axis: Array, *pitch: float) -> pin.JointModel:
    """Pinocchio's joint of one degree of freedom about or along an axis."""
    for along, unit in zip("XYZ", np.eye(3), strict=True):
        if (axis == unit).all():
            return getattr(pin, f"JointModel{kind[0]}{along}")(*pitch)
    return getattr(pin, f"JointModel{kind}Unaligned")(axis, *pitch)


def joint_model(joint: Joint) -> pin.JointModel:
    """Pinocchio's native joint of that type."""
    if joint.type == "cylindrical":
        composite = pin.JointModelComposite(2)
        for kind in ("Revolute", "Prismatic"):
            composite.addJoint(about_axis(kind, joint.axis), pin.SE3.Identity())
        return composite
    if joint.axis.any():
        return about_axis(joint.type.capitalize(), joint.axis, *([joint.pitch] if joint.type == "helical" else []))
    if joint.type == "universal":
        return pin.JointModelUniversal(*np.eye(3)[:2])
    makers = {
        "spherical": pin.JointModelSpherical,
        "free": pin.JointModelFreeFlyer,
        "planar": pin.JointModelPlanar,
        "translation": pin.JointModelTranslation,
        "euler_zyx": pin.JointModelSphericalZYX,
    }
    return makers[joint.type]()


def spatial_inertia(body: Body) -> pin.Inertia:
    """The inertia set part by part: the constructor refuses an indefinite one, which the algorithms do not mind."""
    inertia = pin.Inertia.Zero()
    inertia.mass, inertia.lever, inertia.inertia = body.mass, body.com, body.inertia
    return inertia


def build(robot: Description) -> pin.Model:
    """The model of a description."""
    model = pin.Model()
    model.gravity = pin.Motion(robot.gravity, np.zeros(3))
    for i, body in enumerate(robot.bodies):
        joint = body.joint
        if joint.type == "planar" and joint.armature[:2].any():
            raise Unsupported(f"Pinocchio's armature of planar joint {joint.name} would act in body axes, not in the joint frame's")
        placement = pin.SE3(joint.rotation, joint.translation)
        index = model.addJoint(body.parent + 1, joint_model(joint), placement, f"joint {i}")
        model.appendBodyToJoint(index, spatial_inertia(body), pin.SE3.Identity())
        if index != i + 1 or model.joints[index].idx_v != joint.v.start:
            raise RuntimeError(f"Pinocchio put joint {joint.name} elsewhere")
    model.armature = np.concatenate([b.joint.armature for b in robot.bodies])
    return model


class PinocchioRobot:
    """A robot in Pinocchio; where it was built from the description, body i is joint i + 1, as joint 0 is the universe.

    `turning` are the indices of the angles, in q_e of the table above, that are (cos, sin) in the model: continuous joints as read.
    """

    def __init__(self, robot: Description, model: pin.Model, turning: Sequence[int] = ()) -> None:
        self.robot, self.model, self.turning = robot, model, list(turning)
        self.data = model.createData()
        if not self.model.check(self.data):
            raise RuntimeError("Pinocchio's own check of the model fails")

    def readback(self) -> list[Array]:
        """What `model.inertias` and `model.jointPlacements` hold."""
        held = list(zip(self.model.inertias, self.model.jointPlacements, strict=True))[1:]
        return [readback_row(y.mass, y.lever, y.inertia, m.rotation, m.translation) for y, m in held]

    # ---- dynamics

    def _state(self, ask: Question) -> tuple[Array, Array, Change]:
        """q_e, v_e and the change of coordinates."""
        change = change_of_velocities(self.robot, ask.q, ask.v)
        return self._engine_q(ask.q), change.to_engine_v(ask.v), change

    def _engine_q(self, q: Array) -> Array:
        """q_e, with (cos, sin) for the angles that the model has so."""
        q_e = to_engine_q(self.robot, q)
        angles = q_e[self.turning]
        q_e[self.turning] = np.cos(angles)
        return np.insert(q_e, [k + 1 for k in self.turning], np.sin(angles))

    def rnea(self, ask: Question) -> Array:
        """tau = RNEA(q, v, a)."""
        q, v, change = self._state(ask)
        return change.to_neutral_tau(pin.rnea(self.model, self.data, q, v, change.to_engine_a(ask.a)))

    def rnea_wrench(self, ask: Question) -> Array:
        """RNEA with forces on the bodies, given like ours in body axes about the body's origin."""
        q, v, change = self._state(ask)
        forces = pin.StdVec_Force([pin.Force.Zero(), *(pin.Force(w[3:], w[:3]) for w in ask.wrench)])
        return change.to_neutral_tau(pin.rnea(self.model, self.data, q, v, change.to_engine_a(ask.a), forces))

    def bias_rnea(self, ask: Question) -> Array:
        """h = RNEA(q, v, a = 0)."""
        q, v, change = self._state(ask)
        return change.to_neutral_tau(pin.rnea(self.model, self.data, q, v, change.b))

    def nonlinear_effects(self, ask: Question) -> Array:
        """h = T' (h_e + M_e b)."""
        q, v, change = self._state(ask)
        bias = pin.nonLinearEffects(self.model, self.data, q, v).copy()
        if change.b.any():
            bias += self._mass_e(q, pin.Convention.LOCAL) @ change.b
        return change.to_neutral_tau(bias)

    def _mass_e(self, q: Array, convention: pin.Convention) -> Array:
        """M_e; crba promises its upper triangle only."""
        upper = np.triu(pin.crba(self.model, self.data, q, convention))
        return upper + np.triu(upper, 1).T

    def crba_local(self, ask: Question) -> Array:
        """M by the composite rigid body algorithm in body frames."""
        q, _, change = self._state(ask)
        return change.to_neutral_mass(self._mass_e(q, pin.Convention.LOCAL))

    def crba_world(self, ask: Question) -> Array:
        """M by the composite rigid body algorithm in the world frame."""
        q, _, change = self._state(ask)
        return change.to_neutral_mass(self._mass_e(q, pin.Convention.WORLD))

    def probe_local(self, ask: Question) -> Array:
        """Products with, and parts of, the M of `crba_local`."""
        mass = self.crba_local(ask)
        return mass_matrix_probe(mass.__matmul__, np.diag(mass), ask.probe)

    def probe_world(self, ask: Question) -> Array:
        """Products with, and parts of, the M of `crba_world`."""
        mass = self.crba_world(ask)
        return mass_matrix_probe(mass.__matmul__, np.diag(mass), ask.probe)

    def _aba(self, ask: Question, convention: pin.Convention) -> Array:
        q, v, change = self._state(ask)
        return change.to_neutral_a(pin.aba(self.model, self.data, q, v, change.to_engine_tau(ask.tau), convention))

    def aba_local(self, ask: Question) -> Array:
        """The articulated body algorithm in body frames."""
        return self._aba(ask, pin.Convention.LOCAL)

    def aba_world(self, ask: Question) -> Array:
        """The articulated body algorithm in the world frame."""
        return self._aba(ask, pin.Convention.WORLD)

    def crba_cholesky(self, ask: Question) -> Array:
        """a = M^-1 (tau - h) by Pinocchio's tree-sparse factors U D U' of its M."""
        q, v, change = self._state(ask)
        rest = change.to_engine_tau(ask.tau) - pin.nonLinearEffects(self.model, self.data, q, v)
        pin.crba(self.model, self.data, q)
        pin.cholesky.decompose(self.model, self.data)
        return change.to_neutral_a(pin.cholesky.solve(self.model, self.data, rest))

    def minverse(self, ask: Question) -> Array:
        """a = M^-1 (tau - h) by the direct inverse of M, of which the upper triangle is promised."""
        q, v, change = self._state(ask)
        rest = change.to_engine_tau(ask.tau) - pin.nonLinearEffects(self.model, self.data, q, v)
        upper = np.triu(pin.computeMinverse(self.model, self.data, q))
        return change.to_neutral_a(upper @ rest + np.triu(upper, 1).T @ rest)

    # ---- energies, momentum, kinematics

    def kinetic_energy(self, ask: Question) -> float:
        """½ v' M v; Pinocchio 4.1.0 itself leaves out the armature of RevoluteUnaligned and HelicalUnaligned joints here."""
        q, v, _ = self._state(ask)
        return pin.computeKineticEnergy(self.model, self.data, q, v)

    def kinetic_energy_crba(self, ask: Question) -> float:
        """½ v' M v with the M of `crba_local`."""
        q, v, _ = self._state(ask)
        return v @ self._mass_e(q, pin.Convention.LOCAL) @ v / 2

    def potential_energy(self, ask: Question) -> float:
        """-Σ m g·c."""
        return pin.computePotentialEnergy(self.model, self.data, to_engine_q(self.robot, ask.q))

    def com(self, ask: Question) -> Array:
        """The centre of mass."""
        return pin.centerOfMass(self.model, self.data, to_engine_q(self.robot, ask.q))

    def momentum(self, ask: Question) -> Array:
        """The centroidal momentum."""
        q, v, _ = self._state(ask)
        return to_angular_first(pin.computeCentroidalMomentum(self.model, self.data, q, v))

    def placement(self, ask: Question) -> list[Array]:
        """Rotation and origin of each body."""
        pin.forwardKinematics(self.model, self.data, to_engine_q(self.robot, ask.q))
        return [np.append(m.rotation.ravel(), m.translation) for m in list(self.data.oMi)[1:]]

    def velocity(self, ask: Question) -> list[Array]:
        """Velocity of each body in world axes at its origin."""
        q, v, _ = self._state(ask)
        pin.forwardKinematics(self.model, self.data, q, v)
        frame, joints = pin.LOCAL_WORLD_ALIGNED, range(1, self.model.njoints)
        return [to_angular_first(pin.getVelocity(self.model, self.data, i, frame)) for i in joints]

    def acceleration(self, ask: Question) -> list[Array]:
        """Classical acceleration of each body in world axes at its origin."""
        q, v, change = self._state(ask)
        pin.forwardKinematics(self.model, self.data, q, v, change.to_engine_a(ask.a))
        frame, joints = pin.LOCAL_WORLD_ALIGNED, range(1, self.model.njoints)
        return [to_angular_first(pin.getClassicalAcceleration(self.model, self.data, i, frame)) for i in joints]

    def jacobian(self, ask: Question) -> Array:
        """J of the asked body in world axes at its origin."""
        q, _, change = self._state(ask)
        pin.computeJointJacobians(self.model, self.data, q)
        linear_first = pin.getJointJacobian(self.model, self.data, ask.body + 1, pin.LOCAL_WORLD_ALIGNED)
        return change.to_neutral_jacobian(np.roll(linear_first, 3, axis=0))


class Pinocchio:
    """The engine."""

    name = "pinocchio"
    version = pin.__version__
    build = {"language": "C++ (Python package pin)", "simd": eigenpy.SimdInstructionSetsInUse(), "eigenpy": eigenpy.__version__}
    quantities = {
        "id": {"rnea": PinocchioRobot.rnea},
        "id_wrench": {"rnea": PinocchioRobot.rnea_wrench},
        "bias": {"nonlinear_effects": PinocchioRobot.nonlinear_effects, "rnea": PinocchioRobot.bias_rnea},
        "mass_matrix": {"crba_local": PinocchioRobot.crba_local, "crba_world": PinocchioRobot.crba_world},
        "mass_matrix_probe": {"crba_local": PinocchioRobot.probe_local, "crba_world": PinocchioRobot.probe_world},
        "fd": {
            "aba_local": PinocchioRobot.aba_local,
            "aba_world": PinocchioRobot.aba_world,
            "crba_cholesky": PinocchioRobot.crba_cholesky,
            "minverse": PinocchioRobot.minverse,
        },
        "kinetic_energy": {"kinetic_energy": PinocchioRobot.kinetic_energy, "crba": PinocchioRobot.kinetic_energy_crba},
        "potential_energy": {"potential_energy": PinocchioRobot.potential_energy},
        "com": {"center_of_mass": PinocchioRobot.com},
        "momentum": {"centroidal_momentum": PinocchioRobot.momentum},
        "body_placement": {"forward_kinematics": PinocchioRobot.placement},
        "body_velocity": {"forward_kinematics": PinocchioRobot.velocity},
        "body_acceleration": {"forward_kinematics": PinocchioRobot.acceleration},
        "body_jacobian": {"joint_jacobian": PinocchioRobot.jacobian},
    }

    def prepare(self, description: Description) -> PinocchioRobot:
        """Builds the robot."""
        pinocchio_reading.affordable(description.nv)
        return PinocchioRobot(description, build(description))

    def read(self, path: Path, form: str, base: str) -> Reading:
        """Has Pinocchio's own parser read a file."""
        return pinocchio_reading.read(path, form, base, PinocchioRobot)


if __name__ == "__main__":
    serve(Pinocchio())
