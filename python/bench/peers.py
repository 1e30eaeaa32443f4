"""The peers: Pinocchio, by a loop and by its pool, and MuJoCo, by a loop and by its rollout."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import featherbench

Array = NDArray[np.float64]
ROOT = Path(__file__).parents[2]
# The step of MuJoCo's rollout, s. Its Euler step gives v + h a, so the answer is (v' - v)/h: h = 1 loses no digits of a by that.
STEP = 1.0


@dataclass(frozen=True)
class Peer:
    """A way to compute one quantity of many states: its threads, its call, and its answer in neutral coordinates."""

    name: str
    threads: int
    call: Callable[[], object]
    answer: Callable[[], Array]


@dataclass
class Peers:
    """Those of a robot and its states, and who is left out and why."""

    inverse: list[Peer] = field(default_factory=list)
    forward: list[Peer] = field(default_factory=list)
    absent: list[str] = field(default_factory=list)


def of(path: Path, robot: featherbench.Robot, states: tuple[Array, Array, Array, Array], threads: int) -> Peers:
    """Build the robot in each engine that is installed.

    Parameters
    ----------
    path : Path
        The robot's description.
    robot : featherbench.Robot
        The robot.
    states : tuple of ndarray
        q, v, a and tau, one row per state, in neutral coordinates.
    threads : int
        What "all cores" means.

    Returns
    -------
    Peers
        Each holds its own copy of the states, in its own coordinates.
    """
    if str(ROOT / "oracles") not in sys.path:
        sys.path.insert(0, str(ROOT / "oracles"))
    peers = Peers()
    for name, add in (("Pinocchio", _pinocchio), ("MuJoCo", _mujoco)):
        try:
            add(peers, _description(path, robot), robot, states, threads)
        except ImportError as missing:
            peers.absent.append(f"{name}: {missing}")
    return peers


def _description(path: Path, robot: featherbench.Robot) -> Any:
    from featherbench_oracles.core.robot import Description

    data = json.loads(path.read_text())
    for body, joint in zip(data["bodies"], robot.joints, strict=True):
        body["joint"].setdefault("armature", [0.0] * (joint.v[1] - joint.v[0]))  # a file may leave out what is zero
    return Description.read(data)


def _pinocchio(peers: Peers, description: Any, robot: featherbench.Robot, states: tuple[Array, ...], threads: int) -> None:
    import pinocchio as pin
    from featherbench_oracles.pinocchio.building import build

    model = build(description)
    data, pool = model.createData(), pin.ModelPool(model, threads)
    neutral, v, a, tau = states
    q = robot.to_pinocchio(neutral)
    # The pool takes one state per column, in Fortran's order: made once, outside the times.
    columns = [np.asfortranarray(x.T) for x in (q, v, a, tau)]
    out = np.empty_like(columns[1])

    def loop(function: Callable[..., Array], x: Array) -> Peer:
        def answer() -> Array:
            return np.array([function(model, data, *state) for state in zip(q, v, x, strict=True)])

        return Peer("Pinocchio, a loop", 1, lambda: [function(model, data, *state) for state in zip(q, v, x, strict=True)], answer)

    def pooled(function: Callable[..., object], x: Array, count: int) -> Peer:
        def call() -> object:
            return function(count, pool, columns[0], columns[1], x, out)

        def answer() -> Array:
            call()
            return out.T.copy()

        return Peer("Pinocchio, its pool", count, call, answer)

    counts = sorted({1, threads})
    peers.inverse += [loop(pin.rnea, a), *(pooled(pin.rneaInParallel, columns[2], count) for count in counts)]
    peers.forward += [loop(pin.aba, tau), *(pooled(pin.abaInParallel, columns[3], count) for count in counts)]


def _mujoco(peers: Peers, description: Any, robot: featherbench.Robot, states: tuple[Array, ...], threads: int) -> None:
    import mujoco as mj
    from featherbench_oracles.mujoco.building import build
    from mujoco import rollout

    model = build(description)
    model.opt.timestep = STEP
    data = [mj.MjData(model) for _ in range(threads)]
    neutral, v, a, tau = states
    q, qd = robot.to_mujoco(neutral), robot.velocity_to("mujoco", neutral, v)
    if any(joint.kind == "free" for joint in robot.joints):
        # The acceleration of a free joint in MuJoCo's coordinates is R (a + w x v): its linear part is of the origin, in world axes.
        free = next(joint for joint in robot.joints if joint.kind == "free").v[0]
        bias = np.zeros_like(v)
        bias[:, free : free + 3] = np.cross(v[:, free + 3 : free + 6], v[:, free : free + 3])
    else:
        bias = np.zeros_like(v)
    qdd = robot.velocity_to("mujoco", neutral, a + bias)
    force = robot.force_to("mujoco", neutral, tau)
    one = data[0]

    def inverse() -> list[Array]:
        found = []
        for state in zip(q, qd, qdd, strict=True):
            one.qpos[:], one.qvel[:], one.qacc[:] = state
            mj.mj_inverse(model, one)
            found.append(one.qfrc_inverse.copy())
        return found

    def inverse_answer() -> Array:
        # Forces go by the transpose of the way of velocities: power is the same in both coordinates.
        theirs = np.array(inverse())
        units = np.eye(robot.nv)
        columns = [robot.velocity_to("mujoco", neutral, np.broadcast_to(unit, v.shape).copy()) for unit in units]
        return np.stack([np.sum(column * theirs, axis=1) for column in columns], axis=1)

    full = mj.mjtState.mjSTATE_FULLPHYSICS
    begin = np.zeros((len(q), 1, mj.mj_stateSize(model, full)))[:, 0]
    begin[:, 1 : 1 + model.nq], begin[:, 1 + model.nq : 1 + model.nq + model.nv] = q, qd
    control = force[:, None, :].copy()
    after = np.empty((len(q), 1, begin.shape[1]))
    spec = int(mj.mjtState.mjSTATE_QFRC_APPLIED)

    def stepped(count: int) -> Peer:
        run = rollout.Rollout(nthread=count if count > 1 else 0)

        def call() -> object:
            return run.rollout(model, data[:count], begin, control, control_spec=spec, state=after)

        def answer() -> Array:
            call()
            rate = (after[:, 0, 1 + model.nq : 1 + model.nq + model.nv] - qd) / STEP
            units = [robot.velocity_to("mujoco", neutral, np.broadcast_to(unit, v.shape).copy()) for unit in np.eye(robot.nv)]
            return np.linalg.solve(np.stack(units, axis=2), rate[:, :, None])[:, :, 0] - bias

        return Peer("MuJoCo, a step of its rollout", count, call, answer)

    peers.inverse.append(Peer("MuJoCo, a loop", 1, inverse, inverse_answer))
    peers.forward += [stepped(count) for count in sorted({1, threads})]
