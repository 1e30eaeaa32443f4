"""The conventions of MJX. Each row of conventions.toml has a function of its name here, which yields claims.

The models are those of MuJoCo's claims. JAX computes in single precision by default.
"""

from __future__ import annotations

from functools import partial

import jax
import mujoco as mj
import numpy as np
from mujoco import mjx
from numpy.typing import ArrayLike

from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.conventions import ABOUT_ORIGIN, ALPHA, COM, GRAVITY, MASS, SINGLE, WXYZ, A, Claims, P, R, V, W, X, Z, turned
from featherbench_oracles.core.conventions import claim as claim_in_double
from featherbench_oracles.mujoco.conventions import BALL, FREE, HINGE, SLIDE, mj_robot

claim = partial(claim_in_double, close=SINGLE)


class World:
    """A model at a state."""

    def __init__(self, model: mj.MjModel, q: ArrayLike, v: ArrayLike) -> None:
        self.model = mjx.put_model(model)
        start = mjx.make_data(model).replace(qpos=np.asarray(q, float), qvel=np.asarray(v, float))
        self.data = jax.jit(lambda data: mjx.fwd_velocity(self.model, mjx.fwd_position(self.model, data)))(start)

    def get(self, name: str) -> Array:
        """Read an array."""
        return np.array(getattr(self.data, name), float)

    def inverse(self, a: ArrayLike) -> Array:
        """Compute qfrc_inverse."""
        data = self.data.replace(qacc=np.asarray(a, float))
        return np.array(jax.jit(lambda data: mjx.inverse(self.model, data).qfrc_inverse)(data), float)


def mjx_free_q() -> Claims:
    """Origin, then the quaternion w, x, y, z."""
    world = World(mj_robot((FREE, Z))[0], [*P, *WXYZ], np.zeros(6))
    yield claim(world.get("xmat")[1].reshape(3, 3), R, R.T, turned(WXYZ))
    yield claim(world.get("xpos")[1], P, R @ P)


def mjx_free_v() -> Claims:
    """[linear; angular]: linear in world axes, angular in body axes. Seen in the force of a turn: ω × I ω is one of the body's axes."""
    spun, rest = (World(mj_robot((FREE, Z))[0], [*P, *WXYZ], v) for v in ([*V, *W], np.zeros(6)))
    turned_back = R.T @ W
    found = spun.get("qfrc_bias")[3:] - rest.get("qfrc_bias")[3:]
    yield claim(found, np.cross(W, ABOUT_ORIGIN @ W), np.cross(turned_back, ABOUT_ORIGIN @ turned_back), np.cross(V, ABOUT_ORIGIN @ V))


def mjx_free_a() -> Claims:
    """The derivative of the numbers in v: the linear part is the classical acceleration of the origin in world axes."""
    force = World(mj_robot((FREE, Z))[0], [*P, *WXYZ], [*V, *W]).inverse([*A, *ALPHA])[:3]
    swing = R @ (np.cross(ALPHA, COM) + np.cross(W, np.cross(W, COM)))
    yield claim(force, MASS * (A - GRAVITY + swing), MASS * (A + np.cross(R @ W, V) - GRAVITY + swing), MASS * (R @ A - GRAVITY + swing))


def mjx_spherical_q() -> Claims:
    """The quaternion w, x, y, z."""
    world = World(mj_robot((BALL, Z))[0], WXYZ, np.zeros(3))
    yield claim(world.get("xmat")[1].reshape(3, 3), R, R.T, turned(WXYZ))


def mjx_armature() -> Claims:
    """In M, and in the inverse dynamics."""
    world = World(mj_robot((HINGE, Z), armature=0.7)[0], [0.3], [0.0])
    yield claim(world.inverse([2.0]) - world.inverse([0.0]), [2 * (ABOUT_ORIGIN[2, 2] + 0.7)], [2 * ABOUT_ORIGIN[2, 2]])


def mjx_gravity() -> Claims:
    """`option.gravity` is the acceleration of free fall, in the bias."""
    world = World(mj_robot((SLIDE, X))[0], [0.0], [0.0])
    yield claim(world.get("qfrc_bias"), [-MASS * GRAVITY[0]], [MASS * GRAVITY[0]], [0.0])


def mjx_precision() -> Claims:
    """Numbers are single unless JAX is told otherwise before it is used: what is given in double is rounded."""
    world = World(mj_robot((HINGE, Z))[0], [0.1], [0.0])
    yield claim_in_double([world.data.qfrc_bias.dtype.itemsize], [4], [8])
    yield claim_in_double([jax.numpy.asarray(np.array([0.1])).dtype.itemsize], [4], [8])
