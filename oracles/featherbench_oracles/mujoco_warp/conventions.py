"""The conventions of MuJoCo Warp. Each row of conventions.toml has a function of its name here, which yields claims.

The models are those of MuJoCo's claims. The kernels compute in single precision.
"""

from __future__ import annotations

from functools import partial

import mujoco as mj
import mujoco_warp as mjw
import numpy as np
from numpy.typing import ArrayLike

from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.conventions import (
    ABOUT_ORIGIN,
    ALPHA,
    COM,
    GRAVITY,
    MASS,
    SINGLE,
    WXYZ,
    A,
    Claim,
    Claims,
    P,
    R,
    V,
    W,
    X,
    Z,
    turned,
)
from featherbench_oracles.core.conventions import claim as claim_in_double
from featherbench_oracles.mujoco.conventions import BALL, FREE, HINGE, SLIDE, mj_robot

claim = partial(claim_in_double, close=SINGLE)


class World:
    """A model with one world at a state."""

    def __init__(self, model: mj.MjModel, q: ArrayLike, v: ArrayLike) -> None:
        self.model = mjw.put_model(model)
        self.data = mjw.put_data(model, mj.MjData(model), nworld=1)
        self.put("qpos", q)
        self.put("qvel", v)
        mjw.fwd_position(self.model, self.data)
        mjw.fwd_velocity(self.model, self.data)

    def put(self, name: str, numbers: ArrayLike) -> None:
        """Set an array of the world."""
        getattr(self.data, name).assign(np.asarray(numbers, np.float32)[None])

    def get(self, name: str) -> Array:
        """Read an array of the world."""
        return np.array(getattr(self.data, name).numpy()[0], float)

    def inverse(self, a: ArrayLike) -> Array:
        """Compute qfrc_inverse."""
        self.put("qacc", a)
        mjw.inverse(self.model, self.data)
        return self.get("qfrc_inverse")


def mujoco_warp_free_q() -> Claims:
    """Origin, then the quaternion w, x, y, z."""
    world = World(mj_robot((FREE, Z))[0], [*P, *WXYZ], np.zeros(6))
    yield claim(world.get("xmat")[1], R, R.T, turned(WXYZ))
    yield claim(world.get("xpos")[1], P, R @ P)


def mujoco_warp_free_v() -> Claims:
    """[linear; angular]: linear in world axes, angular in body axes. Seen in the force of a turn: ω × I ω is one of the body's axes."""
    inertia = ABOUT_ORIGIN
    spun = World(mj_robot((FREE, Z))[0], [*P, *WXYZ], [*V, *W])
    rest = World(mj_robot((FREE, Z))[0], [*P, *WXYZ], np.zeros(6))
    gyration, turned_back = np.cross(W, inertia @ W), R.T @ W
    found = spun.get("qfrc_bias")[3:] - rest.get("qfrc_bias")[3:]
    yield claim(found, gyration, np.cross(turned_back, inertia @ turned_back), np.cross(V, inertia @ V))


def mujoco_warp_free_a() -> Claims:
    """The derivative of the numbers in v: the linear part is the classical acceleration of the origin in world axes."""
    force = World(mj_robot((FREE, Z))[0], [*P, *WXYZ], [*V, *W]).inverse([*A, *ALPHA])[:3]
    swing = R @ (np.cross(ALPHA, COM) + np.cross(W, np.cross(W, COM)))
    yield claim(force, MASS * (A - GRAVITY + swing), MASS * (A + np.cross(R @ W, V) - GRAVITY + swing), MASS * (R @ A - GRAVITY + swing))


def mujoco_warp_spherical_q() -> Claims:
    """The quaternion w, x, y, z."""
    world = World(mj_robot((BALL, Z))[0], WXYZ, np.zeros(3))
    yield claim(world.get("xmat")[1], R, R.T, turned(WXYZ))


def mujoco_warp_armature() -> Claims:
    """In M, and in the inverse dynamics."""
    world = World(mj_robot((HINGE, Z), armature=0.7)[0], [0.3], [0.0])
    yield claim(world.inverse([2.0]) - world.inverse([0.0]), [2 * (ABOUT_ORIGIN[2, 2] + 0.7)], [2 * ABOUT_ORIGIN[2, 2]])


def mujoco_warp_damping() -> Claims:
    """A passive force, which the bias does not include."""
    damped, plain = (World(mj_robot((HINGE, Z), damping=damping)[0], [0.3], [2.0]) for damping in (0.7, 0.0))
    yield claim(damped.get("qfrc_bias"), plain.get("qfrc_bias"), plain.get("qfrc_bias") + 1.4)


def mujoco_warp_gravity() -> Claims:
    """`option.gravity` is the acceleration of free fall, in the bias."""
    world = World(mj_robot((SLIDE, X))[0], [0.0], [0.0])
    yield claim(world.get("qfrc_bias"), [-MASS * GRAVITY[0]], [MASS * GRAVITY[0]], [0.0])


def mujoco_warp_mass_matrix() -> Claims:
    """`M` has a row for each dof, with the dof's ancestors and the diagonal last."""
    model, _ = mj_robot((HINGE, X), (HINGE, Z))
    stored = World(model, [0.3, 0.2], [0.0, 0.0]).get("M").ravel()
    last = model.M_rowadr + model.M_rownnz - 1
    yield claim(model.M_colind[last], np.arange(2), [1, 0])
    yield claim(stored[last[1]], ABOUT_ORIGIN[2, 2], stored[last[1] - 1])


def mujoco_warp_precision() -> Claims:
    """All of its numbers are single."""
    world = World(mj_robot((HINGE, Z))[0], [0.1], [0.0])
    yield claim_in_double(world.get("qpos"), np.array([0.1], np.float32), [0.1 + 0.05])
    yield claim_in_double([world.data.qfrc_bias.numpy().itemsize], [4], [8])


def mujoco_warp_batch() -> Claims:
    """A world among 4096 has the bits that it has alone, wherever it stands."""
    model, _ = mj_robot((HINGE, X), (HINGE, Z))
    count, state = 4096, np.array([0.3, 0.2, 0.5, -0.4], np.float32)
    states = np.random.default_rng(1).uniform(-1, 1, (count, 4)).astype(np.float32)
    states[[0, 1777, count - 1]] = state
    alone = World(model, state[:2], state[2:]).get("qfrc_bias")
    held, worlds = mjw.put_model(model), mjw.put_data(model, mj.MjData(model), nworld=count)
    worlds.qpos.assign(np.ascontiguousarray(states[:, :2]))
    worlds.qvel.assign(np.ascontiguousarray(states[:, 2:]))
    mjw.fwd_position(held, worlds)
    mjw.fwd_velocity(held, worlds)
    among = np.array(worlds.qfrc_bias.numpy(), float)
    yield Claim(among[[0, 1777, count - 1]], np.stack([alone] * 3), (among[[1, 2, 3]],), close=0.0)
