"""MuJoCo as an oracle: the robot is built with `MjSpec`, never by a parser.

Joints of several degrees of freedom are slides and hinges in one body, in the order of the neutral coordinates: planar (slide x, slide y,
hinge z), universal (hinge x, y), translation (slide x, y, z), cylindrical (hinge, slide), euler_zyx (hinge z, y, x). There is no helical
joint. The compiler is told to edit nothing. Inertias go in by principal axes: MuJoCo's own diagonalisation of a full inertia leaves a
quaternion whose length is 3e-15 off one, and forgets the axes altogether where no centre of mass was set. Damping, dry friction, limits,
contacts and actuators are never set and constraints are disabled, so qfrc_passive is zero.

A massless or unphysical moving body is refused by the compiler: its words are the reason given. But massless bodies whose one child stands
in their axes, as an MJCF body with several joints is described, are folded into it as joints of one body. MuJoCo has no such bodies then:
what asks for each body is unsupported.
"""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path

import mujoco_reading
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
)

sys.path.pop(0)  # this directory, where this very file would be taken for the package imported next
import mujoco as mj  # noqa: E402

# ---- coordinates -----------------------------------------------------------------------------------------------------------------
# joint      q_e                               T             b
# free       p of the world, quaternion wxyz   diag(R, 1)    (R (ω × v), 0): linear velocity in world axes, R from body to world
# spherical  quaternion wxyz                   identity      0
# all other  q                                 identity      0
#
# A free joint's q_e is the pose in the *world*: the neutral pose composed with the joint's placement.


def to_engine_q(robot: Description, q: Array) -> Array:
    """q_e of the table."""
    return np.concatenate([_joint_q(body, q[body.joint.q]) for body in robot.bodies])


def _joint_q(body: Body, q: Array) -> Array:
    joint = body.joint
    if joint.type == "spherical":
        return np.roll(q, 1)
    if joint.type == "free":
        quaternion = np.empty(4)
        mj.mju_mulQuat(quaternion, wxyz(joint.rotation), np.roll(q[3:], 1))
        return np.append(joint.rotation @ q[:3] + joint.translation, quaternion)
    return q


def change_of_velocities(robot: Description, q: Array, v: Array) -> Change:
    """T and b of the table."""
    blocks, bias = [], np.zeros(robot.nv)
    for joint in (body.joint for body in robot.bodies):
        if joint.type == "free":
            linear = slice(joint.v.start, joint.v.start + 3)
            r = joint.rotation @ rotation(q[joint.q][3:])
            blocks.append((linear, r))
            bias[linear] = r @ np.cross(v[joint.v][3:], v[linear])
    return Change(tuple(blocks), bias)


def wxyz(matrix: Array) -> Array:
    """MuJoCo's quaternion of a rotation matrix."""
    quaternion = np.empty(4)
    mj.mju_mat2Quat(quaternion, matrix.ravel())
    return quaternion


def from_wxyz(quaternion: Array) -> Array:
    """The rotation matrix of MuJoCo's quaternion."""
    return rotation(np.roll(quaternion, -1))


# ---- the robot -------------------------------------------------------------------------------------------------------------------

HINGE, SLIDE, BALL, FREE = mj.mjtJoint.mjJNT_HINGE, mj.mjtJoint.mjJNT_SLIDE, mj.mjtJoint.mjJNT_BALL, mj.mjtJoint.mjJNT_FREE
X, Y, Z = np.eye(3)


def empty_spec(robot: Description) -> mj.MjSpec:
    """A spec that edits nothing, without constraints, contacts, fluid or automatic resets."""
    spec = mj.MjSpec()
    compiler, option = spec.compiler, spec.option
    compiler.degree = compiler.autolimits = compiler.balanceinertia = compiler.fusestatic = compiler.alignfree = False
    compiler.boundmass = compiler.boundinertia = 0
    compiler.settotalmass = -1
    compiler.inertiafromgeom = mj.mjtInertiaFromGeom.mjINERTIAFROMGEOM_FALSE
    disable = mj.mjtDisableBit
    option.disableflags = disable.mjDSBL_CONSTRAINT | disable.mjDSBL_CONTACT | disable.mjDSBL_AUTORESET
    option.gravity = robot.gravity
    return spec


def principal(inertia: Array) -> tuple[Array, Array]:
    """Principal moments and axes (a rotation); a diagonal inertia keeps the body's own axes.

    Axes close to the body's are given in another order: MuJoCo computes as if inertial axes within 1e-6 of the body's were the body's.
    """
    moments = np.diag(inertia)
    if (np.diag(moments) == inertia).all():
        return moments, np.eye(3)
    moments, axes = np.linalg.eigh(inertia)
    axes = axes * np.sign(np.linalg.det(axes))
    if np.abs(axes - np.eye(3)).max() < 1e-5:
        return np.roll(moments, 1), np.roll(axes, 1, axis=1)
    return moments, axes


def chains(robot: Description) -> list[range]:
    """The bodies that become one of MuJoCo's each: a body, and before it the massless ones that are folded into it."""
    children = Counter(body.parent for body in robot.bodies)
    ends = [i for i in range(len(robot.bodies)) if children[i] != 1 or not _folds(robot.bodies[i], robot.bodies[i + 1])]
    return [range(before + 1, end + 1) for before, end in pairwise([-1, *ends])]


def _folds(body: Body, child: Body) -> bool:
    """Whether a body is nothing but a joint before its one child: joints of one MuJoCo body stand in the same axes."""
    nothing = body.mass == 0 and not body.com.any() and not body.inertia.any()
    return nothing and (child.joint.rotation == np.eye(3)).all() and "free" not in (body.joint.type, child.joint.type)


def anchors(bodies: Sequence[Body]) -> list[Array]:
    """Where the joints of a chain stand in the frame of its last body, all coordinates being zero."""
    translations = [body.joint.translation for body in bodies[1:]]
    return [-sum(translations[k:], np.zeros(3)) for k in range(len(bodies))]


def add_body(parent: mj.MjsBody, bodies: Sequence[Body], index: int) -> mj.MjsBody:
    """Adds a chain as one body with its joints."""
    body, first, places = bodies[-1], bodies[0].joint, anchors(bodies)
    position = first.translation - first.rotation @ places[0]
    child = parent.add_body(name=f"{index}: {body.name}", pos=position, quat=wxyz(first.rotation))
    child.explicitinertial = True
    child.mass, child.ipos = body.mass, body.com
    child.inertia, axes = principal(body.inertia)
    child.iquat = wxyz(axes)
    for joint, place in zip((part.joint for part in bodies), places, strict=True):
        for kind, axis in motions(joint):
            child.add_joint(type=kind, axis=axis, pos=place)
    return child


def motions(joint: Joint) -> list[tuple[mj.mjtJoint, Array]]:
    """MuJoCo's joints that a joint is, with their axes."""
    return {
        "revolute": [(HINGE, joint.axis)],
        "prismatic": [(SLIDE, joint.axis)],
        "spherical": [(BALL, Z)],
        "free": [(FREE, Z)],
        "planar": [(SLIDE, X), (SLIDE, Y), (HINGE, Z)],
        "universal": [(HINGE, X), (HINGE, Y)],
        "translation": [(SLIDE, X), (SLIDE, Y), (SLIDE, Z)],
        "cylindrical": [(HINGE, joint.axis), (SLIDE, joint.axis)],
        "euler_zyx": [(HINGE, Z), (HINGE, Y), (HINGE, X)],
    }[joint.type]


def refuse_unsupported(body: Body) -> None:
    """Raises `Unsupported` for a joint that MuJoCo does not have."""
    joint = body.joint
    if joint.type == "helical":
        raise Unsupported(f"MuJoCo has no helical joint ({joint.name})")
    if joint.type == "free" and body.parent >= 0:
        raise Unsupported(f"MuJoCo's free joint must hang on the world ({joint.name})")
    if joint.type == "free" and joint.armature[:3].any():
        raise Unsupported(f"MuJoCo's linear armature of free joint {joint.name} would act on world accelerations, not on body ones")


def build(robot: Description) -> mj.MjModel:
    """The model of a description."""
    spec = empty_spec(robot)
    held = {-1: spec.worldbody}
    for chain in chains(robot):
        bodies = [robot.bodies[i] for i in chain]
        for body in bodies:
            refuse_unsupported(body)
        held[chain[-1]] = add_body(held[bodies[0].parent], bodies, chain[-1])
    try:
        model = spec.compile()
    except ValueError as reason:
        raise Unsupported(f"MuJoCo refuses the model: {reason}") from reason
    if (model.body_dofadr[1:] != [robot.bodies[chain[0]].joint.v.start for chain in chains(robot)]).any():
        raise RuntimeError("MuJoCo put the degrees of freedom in another order")
    model.dof_armature = np.concatenate([body.joint.armature for body in robot.bodies])
    mj.mj_setConst(model, mj.MjData(model))  # MuJoCo keeps constants that depend on armature
    return model


class MujocoRobot:
    """A robot in MuJoCo; where it was built from the description, chain i is MuJoCo's body i + 1, as body 0 is the world."""

    def __init__(self, robot: Description, model: mj.MjModel) -> None:
        self.robot, self.model, self.data = robot, model, mj.MjData(model)
        self.held = {chain[-1]: i for i, chain in enumerate(chains(robot), start=1)}

    def _all_held(self, quantity: str) -> None:
        """Raises `Unsupported` where MuJoCo lacks bodies of the description."""
        folded = len(self.robot.bodies) - len(self.held)
        if folded:
            raise Unsupported(f"MuJoCo has no massless bodies: {folded} are joints of the next one, and have no {quantity} of their own")

    def readback(self) -> list[Array]:
        """Inertias come back from MuJoCo's principal axes: I = R diag(principal) R'. Of a folded body there is its joint's place alone."""
        m, rows = self.model, []
        for i, chain in enumerate(chains(self.robot), start=1):
            turn, joint = from_wxyz(m.body_quat[i]), m.body_jntadr[i]
            place = m.body_pos[i] + turn @ m.jnt_pos[joint]
            for body in chain[:-1]:
                rows.append(readback_row(0.0, np.zeros(3), np.zeros((3, 3)), turn, place))
                before, joint = joint, joint + len(motions(self.robot.bodies[body].joint))
                turn, place = np.eye(3), m.jnt_pos[joint] - m.jnt_pos[before]
            axes = from_wxyz(m.body_iquat[i])
            inertia = (axes * m.body_inertia[i]) @ axes.T
            rows.append(readback_row(m.body_mass[i], m.body_ipos[i], inertia, turn, place))
        return rows

    def _update(self, ask: Question) -> Change:
        """Sets q and v and computes what depends on them."""
        change = change_of_velocities(self.robot, ask.q, ask.v)
        self.data.qpos = to_engine_q(self.robot, ask.q)
        self.data.qvel = change.to_engine_v(ask.v)
        mj.mj_fwdPosition(self.model, self.data)
        mj.mj_fwdVelocity(self.model, self.data)
        return change

    # ---- dynamics

    def _inverse(self, a: Array) -> Array:
        """tau_e at engine accelerations."""
        self.data.qacc = a
        mj.mj_inverse(self.model, self.data)
        return self.data.qfrc_inverse.copy()

    def inverse(self, ask: Question) -> Array:
        """tau = mj_inverse, armature included."""
        change = self._update(ask)
        return change.to_neutral_tau(self._inverse(change.to_engine_a(ask.a)))

    def rne(self, ask: Question) -> Array:
        """tau = mj_rne + armature a_e."""
        change = self._update(ask)
        self.data.qacc = change.to_engine_a(ask.a)
        tau = np.empty(self.model.nv)
        mj.mj_rne(self.model, self.data, 1, tau)
        return change.to_neutral_tau(tau + self.model.dof_armature * self.data.qacc)

    def inverse_wrench(self, ask: Question) -> Array:
        """tau = mj_inverse - Σ J' f, as mj_inverse does not look at applied forces."""
        self._all_held("wrench")
        change = self._update(ask)
        tau = self._inverse(change.to_engine_a(ask.a))
        applied = np.zeros(self.model.nv)
        for i, wrench in enumerate(ask.wrench, start=1):
            r = self.data.xmat[i].reshape(3, 3)
            mj.mj_applyFT(self.model, self.data, r @ wrench[3:], r @ wrench[:3], self.data.xpos[i], i, applied)
        return change.to_neutral_tau(tau - applied)

    def qfrc_bias(self, ask: Question) -> Array:
        """h = T' (qfrc_bias + M_e b)."""
        change = self._update(ask)
        return change.to_neutral_tau(self.data.qfrc_bias + self._product(change.b))

    def bias_inverse(self, ask: Question) -> Array:
        """h = mj_inverse at a = 0."""
        change = self._update(ask)
        return change.to_neutral_tau(self._inverse(change.b))

    def _product(self, x: Array) -> Array:
        """M_e x."""
        y = np.empty(self.model.nv)
        mj.mj_mulM(self.model, self.data, y, x)
        return y

    def crb(self, ask: Question) -> Array:
        """M by the composite rigid body algorithm."""
        change = self._update(ask)
        mass = np.empty((self.model.nv, self.model.nv))
        mj.mj_fullM(self.model, self.data, mass)
        return change.to_neutral_mass(mass)

    def probe(self, ask: Question) -> Array:
        """Products by mj_mulM; the diagonal ends the rows of the sparse M, where T is not identity it is e_i' M e_i."""
        change = self._update(ask)

        def product(x: Array) -> Array:
            return change.to_neutral_tau(self._product(change.to_engine_v(x)))

        diagonal = self.data.M[self.model.M_rowadr + self.model.M_rownnz - 1]
        for dofs, _ in change.blocks:
            for i in range(dofs.start, dofs.stop):
                unit = np.zeros(self.model.nv)
                unit[i] = 1
                diagonal[i] = product(unit)[i]
        return mass_matrix_probe(product, diagonal, ask.probe)

    def forward(self, ask: Question) -> Array:
        """a = M^-1 (tau - h) by mj_forward: the sparse factors L' D L of M."""
        change = self._update(ask)
        self.data.qfrc_applied = change.to_engine_tau(ask.tau)
        mj.mj_forward(self.model, self.data)
        return change.to_neutral_a(self.data.qacc.copy())

    def stored(self, _ask: Question) -> float:
        """nM: the numbers that MuJoCo stores of M, one for each dof and ancestor."""
        return self.model.nM

    # ---- energies, momentum, kinematics

    def kinetic_energy(self, ask: Question) -> float:
        """½ v' M v."""
        self._update(ask)
        mj.mj_energyVel(self.model, self.data)
        return self.data.energy[1]

    def potential_energy(self, ask: Question) -> float:
        """-Σ m g·c."""
        self._update(ask)
        mj.mj_energyPos(self.model, self.data)
        return self.data.energy[0]

    def com(self, ask: Question) -> Array:
        """The centre of mass."""
        self._update(ask)
        return self.data.subtree_com[0]

    def momentum(self, ask: Question) -> Array:
        """Angular momentum about the centre of mass; linear is total mass times the centre's velocity."""
        self._update(ask)
        mj.mj_subtreeVel(self.model, self.data)
        return np.append(self.data.subtree_angmom[0], self.model.body_subtreemass[0] * self.data.subtree_linvel[0])

    def placement(self, ask: Question) -> Array:
        """Rotation and origin of each body."""
        self._all_held("placement")
        self._update(ask)
        return np.hstack([self.data.xmat[1:], self.data.xpos[1:]])

    def velocity(self, ask: Question) -> Array:
        """Velocity of each body in world axes at its origin."""
        self._all_held("velocity")
        self._update(ask)
        velocities = np.empty((self.model.nbody, 6))
        for i, row in enumerate(velocities):
            mj.mj_objectVelocity(self.model, self.data, mj.mjtObj.mjOBJ_XBODY, i, row, 0)
        return velocities[1:]

    def acceleration(self, ask: Question) -> Array:
        """Classical acceleration of each body; MuJoCo gives it as if the world accelerated by -g, which is taken off."""
        self._all_held("acceleration")
        change = self._update(ask)
        self.data.qacc = change.to_engine_a(ask.a)
        mj.mj_rnePostConstraint(self.model, self.data)
        accelerations = np.empty((self.model.nbody, 6))
        for i, row in enumerate(accelerations):
            mj.mj_objectAcceleration(self.model, self.data, mj.mjtObj.mjOBJ_XBODY, i, row, 0)
        return accelerations[1:] + np.append(np.zeros(3), self.model.opt.gravity)

    def jacobian(self, ask: Question) -> Array:
        """J of the asked body in world axes at its origin."""
        if ask.body not in self.held:
            self._all_held("Jacobian")
        change = self._update(ask)
        angular, linear = np.zeros((2, 3, self.model.nv))
        mj.mj_jacBody(self.model, self.data, linear, angular, self.held[ask.body])
        return change.to_neutral_jacobian(np.vstack([angular, linear]))


class Mujoco:
    """The engine."""

    name = "mujoco"
    version = mj.mj_versionString()
    build = {"language": "C (Python package mujoco)"}
    quantities = {
        "id": {"inverse": MujocoRobot.inverse, "rne": MujocoRobot.rne},
        "id_wrench": {"inverse": MujocoRobot.inverse_wrench},
        "bias": {"qfrc_bias": MujocoRobot.qfrc_bias, "inverse": MujocoRobot.bias_inverse},
        "mass_matrix": {"crb": MujocoRobot.crb},
        "mass_matrix_probe": {"crb": MujocoRobot.probe},
        "fd": {"forward": MujocoRobot.forward},
        "kinetic_energy": {"energy_vel": MujocoRobot.kinetic_energy},
        "potential_energy": {"energy_pos": MujocoRobot.potential_energy},
        "com": {"subtree_com": MujocoRobot.com},
        "momentum": {"subtree_vel": MujocoRobot.momentum},
        "body_placement": {"kinematics": MujocoRobot.placement},
        "body_velocity": {"object_velocity": MujocoRobot.velocity},
        "body_acceleration": {"object_acceleration": MujocoRobot.acceleration},
        "body_jacobian": {"jac_body": MujocoRobot.jacobian},
        "stored_entries": {"nM": MujocoRobot.stored},
    }

    def prepare(self, description: Description) -> MujocoRobot:
        """Builds the robot."""
        return MujocoRobot(description, build(description))

    def read(self, path: Path, form: str, base: str) -> Reading:
        """Has MuJoCo's own parser read a file."""
        return mujoco_reading.read(path, form, base, MujocoRobot)


if __name__ == "__main__":
    serve(Mujoco())
