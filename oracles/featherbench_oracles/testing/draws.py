"""Robots and states drawn by seed, and derivatives along their motion."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from featherbench_oracles.core.algebra import Array, rotation
from featherbench_oracles.core.messages import Blocks, Header
from featherbench_oracles.core.robot import JOINT_SIZES, WITH_AXIS, Description

COUNT = 22  # states of `random_states`


def random_robot(rng: np.random.Generator, name: str, types: Sequence[str], plain: bool = False, geared: bool = False) -> Header:
    """Draw a branched robot.

    Parameters
    ----------
    rng : np.random.Generator
        The random generator.
    name : str
        The robot's name. Free joints hang on the world unless it ends in `inner free`.
    types : sequence of str
        The joints' types in their order.
    plain : bool
        Whether axes are unit axes and centres of mass the bodies' origins.
    geared : bool
        Whether all joints have armature, and not only those of one degree of freedom.

    Returns
    -------
    dict
        The description in its JSON form.
    """
    bodies: list[Header] = []
    branch = [-1]
    for i, kind in enumerate(types):
        if i and rng.random() < 0.3:
            branch = branch[: rng.integers(1, len(branch) + 1)]
        turn, place = np.eye(3) if plain else rotation(rng.normal(size=4)), rotation(rng.normal(size=4))
        cuboid, mass = rng.uniform(0.1, 0.5, 3) ** 2, rng.uniform(0.5, 3)
        inertia = mass / 3 * turn @ np.diag(cuboid.sum() - cuboid) @ turn.T
        nv = JOINT_SIZES[kind][1]
        acting = np.full(nv, geared or nv == 1)
        acting[: {"free": 3, "planar": 2}.get(kind, 0)] = False  # linear armature has another meaning where T is not identity
        joint: Header = {"name": f"j{i}", "type": kind, "pitch": 0.3, "damping": [0.7] * nv, "friction": [0.7] * nv}
        joint["armature"] = (acting * rng.uniform(0, 0.3, nv)).tolist()
        joint["placement"] = {"rotation": place.ravel().tolist(), "translation": rng.uniform(-0.5, 0.5, 3).tolist()}
        if kind in WITH_AXIS:
            axis = np.eye(3)[i % 3] if plain else rng.normal(size=3)
            joint["axis"] = (axis / np.linalg.norm(axis)).tolist()
        com = np.zeros(3) if plain else rng.uniform(-0.2, 0.2, 3)
        body = {"name": f"b{i}", "mass": mass, "com": com.tolist(), "inertia": inertia[np.triu_indices(3)].tolist()}
        parent = -1 if kind == "free" and not name.endswith("inner free") else branch[-1]
        bodies.append({**body, "parent": parent, "joint": joint})
        branch = [*branch[: branch.index(parent) + 1], i]
    return {"format": 1, "name": name, "gravity": [1.3, -2.1, -9.2], "bodies": bodies}


def without_armature(robot: Header) -> Header:
    """Take the armature out of a robot for DART, which has none."""
    bare: Header = {**robot, "bodies": []}
    for body in robot["bodies"]:
        joint = {**body["joint"], "armature": [0.0] * len(body["joint"]["armature"])}
        bare["bodies"].append({**body, "joint": joint})
    return bare


def random_states(rng: np.random.Generator, robot: Description) -> Blocks:
    """Draw twenty states, and after them the zero state and a fast one.

    Parameters
    ----------
    rng : np.random.Generator
        The random generator.
    robot : Description
        The robot.

    Returns
    -------
    dict of str to ndarray
        `q` of shape (22, nq), `v`, `a` and `tau` of shape (22, nv), `wrench` of shape (22, bodies, 6), `probe` of shape (4, nv).
    """
    n, nv = COUNT, robot.nv
    q = rng.uniform(-2, 2, (n, robot.nq))
    v, a, tau = (rng.normal(size=(n, nv)) for _ in range(3))
    wrench = rng.normal(size=(n, len(robot.bodies), 6))
    q[20], v[20], a[20], tau[20] = 0, 0, 0, 0
    v[21] *= 1e3
    for joint in (b.joint for b in robot.bodies if b.joint.type in ("spherical", "free")):
        last = slice(joint.q.stop - 4, joint.q.stop)
        q[:, last] = rng.normal(size=(n, 4))
        q[:, last] /= np.linalg.norm(q[:, last], axis=1, keepdims=True)
        q[0, last] = 0, 0.5**0.5, 0, 0.5**0.5  # a pitch of 90 degrees, for Drake's roll-pitch-yaw
        q[20, last] = 0, 0, 0, 1
    for joint in (b.joint for b in robot.bodies if b.joint.type == "euler_zyx"):
        q[:, joint.q.start + 1] /= 2  # at a pitch of 90 degrees M is singular, and accelerations too large for finite differences
    return {"q": q, "v": v, "a": a, "tau": tau, "wrench": wrench, "probe": rng.normal(size=(4, nv))}


def advance(robot: Description, q: Array, step: Array) -> Array:
    """Move a configuration by a step: for step = t v, the derivative by t at 0 is the velocity v.

    Parameters
    ----------
    robot : Description
        The robot.
    q : ndarray, shape (nq,)
        The configuration before, m, rad or quaternions.
    step : ndarray, shape (nv,)
        The step, m or rad.

    Returns
    -------
    ndarray, shape (nq,)
        The configuration after.
    """
    end = q.copy()
    for joint in (body.joint for body in robot.bodies):
        s, x = step[joint.v], q[joint.q]
        if joint.type in ("spherical", "free"):
            p, u, w, half = x[:-4], x[-4:-1], x[-1], s[-3:] / 2
            turned = np.append(u + w * half + np.cross(u, half), w - u @ half)  # quaternion times (half, 1)
            end[joint.q] = np.append(p + (rotation(x[-4:]) @ s[:3])[: len(p)], turned / np.linalg.norm(turned))
        else:
            end[joint.q] = x + s
    return end


def derivative(robot: Description, states: Blocks, f: Callable[[Blocks], Array]) -> Array:
    """Differentiate along (q, v), with dq/dt of v and dv/dt = a, by central differences of fourth order.

    Parameters
    ----------
    robot : Description
        The robot.
    states : dict of str to ndarray
        The states.
    f : callable
        A function of states.

    Returns
    -------
    ndarray
        d/dt f, in the shape of f and its unit per second.
    """
    h = 5e-4

    def moved(t: float) -> Array:
        q = np.array([advance(robot, q, t * v) for q, v in zip(states["q"], states["v"], strict=True)])
        return f({**states, "q": q, "v": states["v"] + t * states["a"]})

    return (8 * (moved(h) - moved(-h)) - (moved(2 * h) - moved(-2 * h))) / (12 * h)
