"""The conventions of Newton. Each row of conventions.toml has a function of its name here, which yields claims in single precision."""

from __future__ import annotations

from functools import partial

import newton
import numpy as np
import warp as wp
from numpy.typing import ArrayLike

from featherbench_oracles.core.algebra import Array, rotation
from featherbench_oracles.core.conventions import (
    ABOUT_ORIGIN,
    AXIS,
    COM,
    GRAVITY,
    MASS,
    MOMENTS,
    SINGLE,
    WRONG_R,
    XYZW,
    Claim,
    Claims,
    P,
    R,
    V,
    W,
    about,
)
from featherbench_oracles.core.conventions import claim as claim_in_double
from featherbench_oracles.newton.building import transform

claim = partial(claim_in_double, close=SINGLE)
TURN = about(AXIS, 0.8)
HERE, TURNED = transform(np.eye(3), np.zeros(3)), transform(TURN, np.zeros(3))
UNIT = XYZW / np.linalg.norm(XYZW)


class World:
    """One body on a joint, at a state."""

    def __init__(self, kind: str, q: ArrayLike, v: ArrayLike, place: wp.transform = HERE, **settings: object) -> None:
        builder = newton.ModelBuilder(gravity=tuple(GRAVITY.tolist()))
        body = builder.add_link(mass=MASS, com=tuple(COM.tolist()), inertia=wp.mat33(*MOMENTS.ravel().tolist()), lock_inertia=True)
        ends = {"child": body, "parent_xform": place} | ({} if kind == "free" else {"parent": -1})
        builder.add_articulation([getattr(builder, f"add_joint_{kind}")(**ends, **settings)])
        self.model = builder.finalize()
        self.state = self.model.state()
        self.state.joint_q.assign(np.asarray(q, np.float32))
        self.state.joint_qd.assign(np.asarray(v, np.float32))
        newton.eval_fk(self.model, self.state.joint_q, self.state.joint_qd, self.state)
        nv = self.model.joint_dof_count
        held, forces = wp.zeros((1, nv, nv), dtype=wp.float32), [wp.zeros(nv, dtype=wp.float32) for _ in range(2)]
        newton.eval_mass_matrix(self.model, self.state, held)
        newton.eval_inverse_dynamics_passive(self.model, self.state, mass_matrix=held, gravity_force=forces[0], coriolis_force=forces[1])
        self.mass, (self.gravity, self.coriolis) = np.array(held.numpy()[0], float), [np.array(force.numpy(), float) for force in forces]
        self.pose = np.array(self.state.body_q.numpy()[0], float)

    def turn(self) -> Array:
        """The rotation from the body's axes to the world's."""
        return rotation(self.pose[3:])


def newton_free_q() -> Claims:
    """Origin, then the quaternion x, y, z, w."""
    world = World("free", [*P, *UNIT], np.zeros(6))
    yield claim(world.turn(), R, R.T, WRONG_R)
    yield claim(world.pose[:3], P, R @ P)


def newton_free_v() -> Claims:
    """[linear; angular] in world axes, linear of the centre of mass: M is m 1 and R I Rᵀ, and h has gravity at the centre of mass alone."""
    world, zero = World("free", [*P, *UNIT], [*V, *W]), np.zeros((3, 3))
    blocks = np.block([[MASS * np.eye(3), zero], [zero, R @ MOMENTS @ R.T]])
    yield claim(world.mass, blocks, np.block([[MASS * np.eye(3), zero], [zero, MOMENTS]]))
    yield claim(world.gravity, np.append(-MASS * GRAVITY, np.zeros(3)), np.append(-MASS * R.T @ GRAVITY, np.zeros(3)))
    yield claim(world.coriolis[3:], np.cross(W, R @ MOMENTS @ R.T @ W), R @ np.cross(W, MOMENTS @ W))


def newton_free_placement() -> Claims:
    """With a turned frame M is in that frame's axes, and gravity in the world's: they are not those of one velocity."""
    world = World("free", [*P, *UNIT], np.zeros(6), TURNED)
    yield claim(world.turn(), TURN @ R, R)
    yield claim(world.mass[3:, 3:], R @ MOMENTS @ R.T, TURN @ R @ MOMENTS @ R.T @ TURN.T)
    yield claim(world.gravity[:3], -MASS * GRAVITY, -MASS * TURN.T @ GRAVITY)


def newton_spherical_v() -> Claims:
    """Angular velocity in the axes of the joint's frame."""
    world = World("ball", UNIT, W, TURNED)
    yield claim(world.state.body_qd.numpy()[0][3:], TURN @ W, TURN @ R @ W, W)


def newton_spherical_q() -> Claims:
    """The quaternion x, y, z, w."""
    yield claim(World("ball", UNIT, np.zeros(3)).turn(), R, R.T, WRONG_R)


def newton_armature() -> Claims:
    """In M."""
    world = World("revolute", [0.3], [0.0], axis=wp.vec3(*AXIS), armature=0.7)
    yield claim(world.mass, [[AXIS @ ABOUT_ORIGIN @ AXIS + 0.7]], [[AXIS @ ABOUT_ORIGIN @ AXIS]])


def newton_gravity() -> Claims:
    """The builder takes the acceleration of free fall; the force of gravity is part of the inverse dynamics."""
    world = World("prismatic", [0.0], [0.0], axis=newton.Axis.X)
    yield claim(world.gravity, [-MASS * GRAVITY[0]], [MASS * GRAVITY[0]], [0.0])


def newton_inertia() -> Claims:
    """`inertia` is about the centre of mass."""
    world = World("revolute", [0.3], [0.0], axis=wp.vec3(*AXIS))
    yield claim(world.mass, [[AXIS @ ABOUT_ORIGIN @ AXIS]], [[AXIS @ MOMENTS @ AXIS]])


def newton_precision() -> Claims:
    """All of its numbers are single."""
    yield claim_in_double([World("revolute", [0.3], [0.0], axis=newton.Axis.X).model.body_mass.numpy().itemsize], [4], [8])


def newton_batch() -> Claims:
    """A world among 4096 has the bits that it has alone, wherever it stands."""
    count, seen = 4096, [0, 1777, 4095]
    one = newton.ModelBuilder(gravity=tuple(GRAVITY.tolist()))
    joints = []
    for k in range(2):
        one.add_link(mass=MASS, com=tuple(COM.tolist()), inertia=wp.mat33(*MOMENTS.ravel().tolist()), lock_inertia=True)
        joints.append(one.add_joint_revolute(k - 1, k, parent_xform=TURNED, axis=wp.vec3(*(AXIS, np.eye(3)[0])[k].tolist())))
    one.add_articulation(joints)

    def masses(worlds: int, states: Array) -> Array:
        builder = newton.ModelBuilder(gravity=tuple(GRAVITY.tolist()))
        builder.replicate(one, worlds)
        model = builder.finalize()
        state = model.state()
        state.joint_q.assign(states.astype(np.float32).ravel())
        newton.eval_fk(model, state.joint_q, state.joint_qd, state)
        held = wp.zeros((worlds, 2, 2), dtype=wp.float32)
        newton.eval_mass_matrix(model, state, held)
        return np.array(held.numpy(), float)

    states = np.random.default_rng(1).uniform(-1, 1, (count, 2))
    states[seen] = [0.3, 0.2]
    among, alone = masses(count, states), masses(1, np.array([[0.3, 0.2]]))
    yield Claim(among[seen], np.concatenate([alone] * 3), (among[[1, 2, 3]],), close=0.0)
