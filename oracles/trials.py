"""What the tests of the oracles share: a client, robots and states drawn by seed, and the measures of residuals.

A residual has no unit: M is scaled by its diagonal, a force by the sum of the magnitudes of its terms, an acceleration by the norm of M, other
things by the largest number of their kind in that state (the robots' lengths being about a metre).
"""

from __future__ import annotations

import math
import os
import subprocess
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from protocol import JOINT_SIZES, WITH_AXIS, Answer, Array, Blocks, Description, Header, read_frame, rotation, skew, write_frame

HERE = Path(__file__).parent
ENGINES = ("pinocchio", "mujoco", "drake", "dart")
Methods = dict[str, list[str]]


def tolerance_scale(text: str) -> float:
    """The factor on every tolerance: at 0 each residual but zero fails. What would turn a comparison off is refused."""
    try:
        scale = float(text)
    except ValueError:
        scale = math.nan
    if not (math.isfinite(scale) and scale >= 0):
        raise ValueError(f"FEATHERBENCH_TOL_SCALE is '{text}': it must be a finite number, 0 or more")
    return scale


TOLERANCE_SCALE = tolerance_scale(os.environ.get("FEATHERBENCH_TOL_SCALE", "1"))
EXACT, INVERSE, DIFFERENCE = 2e-13, 1e-9, 1e-8  # INVERSE: id after fd, where an explicit inverse loses the condition of M


residuals: dict[str, tuple[float, float]] = {}


def check(name: str, residual: float, tolerance: float) -> None:
    """Keeps the worst residual of that name; NaN is the worst of all."""
    worst = residuals.get(name, (0.0, 0.0))[0]
    residuals[name] = float(np.maximum(worst, residual)), tolerance * TOLERANCE_SCALE


def summary(verbose: bool) -> int:
    """Prints the failures and the count; returns the exit status."""
    failed = 0
    for name, (residual, tolerance) in residuals.items():
        good = residual <= tolerance
        failed += not good
        if verbose or not good:
            print(f"{'ok    ' if good else 'FAILED'} {name}: {residual:.2e} (at most {tolerance:.0e})")
    print(f"{len(residuals) - failed} passed, {failed} failed")
    return int(failed > 0 or not residuals)  # who checked nothing has passed nothing


class Oracle:
    """An oracle's process."""

    def __init__(self, *command: str) -> None:
        pipe = subprocess.PIPE
        self.process = subprocess.Popen([sys.executable, *command], stdin=pipe, stdout=pipe, stderr=subprocess.DEVNULL)

    def ask(self, header: Header, blocks: Blocks | None = None) -> Answer:
        """The answer to one request."""
        write_frame(self.process.stdin, header, blocks)
        return self.answer()

    def answer(self) -> Answer:
        """The next answer."""
        return read_frame(self.process.stdout) or ({"status": "ended", "reason": "the oracle ended"}, {})

    def must(self, header: Header, blocks: Blocks | None = None) -> Answer:
        """The answer to a request that has to succeed."""
        answer, values = self.ask(header, blocks)
        if answer["status"] != "ok":
            raise RuntimeError(f"{header['op']}: {answer}")
        return answer, values

    def value(self, quantity: str, method: str, count: int, body: int | None = None) -> Array:
        """A quantity at the first `count` states."""
        header = {"op": "evaluate", "quantity": quantity, "method": method, "first": 0, "count": count}
        return self.must(header if body is None else {**header, "body": body})[1]["value"]

    def at(self, states: Blocks, quantity: str, method: str) -> Array:
        """A quantity at these states."""
        self.must({"op": "states", "count": len(states["q"])}, states)
        return self.value(quantity, method, len(states["q"]))

    def end(self) -> int:
        """Ends its input; the exit status."""
        self.process.stdin.close()
        return self.process.wait(timeout=60)


def random_robot(rng: np.random.Generator, name: str, types: Sequence[str], plain: bool = False, geared: bool = False) -> Header:
    """A branched robot of these joints in this order. One-dof joints have armature, all joints if `geared`.

    `plain` has unit axes and centres of mass at the bodies' origins. Free joints hang on the world unless the name ends in 'inner free'.
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
        acting[: {"free": 3, "planar": 2}.get(kind, 0)] = False  # linear armature means something else where T is not identity
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
    """The same robot for DART, which has none."""
    bare: Header = {**robot, "bodies": []}
    for body in robot["bodies"]:
        joint = {**body["joint"], "armature": [0.0] * len(body["joint"]["armature"])}
        bare["bodies"].append({**body, "joint": joint})
    return bare


def random_states(rng: np.random.Generator, robot: Description) -> Blocks:
    """Twenty random states, then the zero state, then a fast one."""
    n, nv = 22, robot.nv
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
        q[:, joint.q.start + 1] /= 2  # a pitch of 90 degrees makes M singular, and accelerations that finite differences do not follow
    return {"q": q, "v": v, "a": a, "tau": tau, "wrench": wrench, "probe": rng.normal(size=(4, nv))}


def advance(robot: Description, q: Array, step: Array) -> Array:
    """A configuration whose derivative by t at 0, for step = t v, is the one that the velocity v means."""
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
    """d/dt f along (q, v) with dq/dt of v and dv/dt = a, by central differences of fourth order."""
    h = 5e-4

    def moved(t: float) -> Array:
        q = np.array([advance(robot, q, t * v) for q, v in zip(states["q"], states["v"], strict=True)])
        return f({**states, "q": q, "v": states["v"] + t * states["a"]})

    return (8 * (moved(h) - moved(-h)) - (moved(2 * h) - moved(-2 * h))) / (12 * h)


def ratio(difference: Array, scale: Array | float = 1.0) -> float:
    """max |difference| / max |scale|; no difference is 0 whatever the scale."""
    top = np.abs(difference).max()
    return 0.0 if top == 0 else float(top / np.abs(scale).max())


def residual(quantity: str, x: Array, y: Array, reference: Reference) -> float:
    """The worst difference of x from y over the states."""
    worst = []
    for k, (xk, yk) in enumerate(zip(x, y, strict=True)):
        m, force = reference.mass[k], reference.force[k]
        d = np.sqrt(np.diag(m))
        if quantity == "mass_matrix":
            worst.append(ratio((xk - yk) / np.outer(d, d)))
        elif quantity == "mass_matrix_probe":
            worst.append(np.max([ratio((xk - yk)[i] / d, yk[i] / d) for i in range(6)]))  # max() would lose a NaN
        elif quantity in ("id", "id_wrench", "bias"):
            worst.append(ratio((xk - yk) / force))
        elif quantity == "fd":
            condition = np.linalg.cond(m / np.outer(d, d))  # |force / d| is what a must be found from
            error, size = np.sqrt([(xk - yk) @ m @ (xk - yk), yk @ m @ yk])
            worst.append(error / (size + np.linalg.norm(force / d)) / condition)
        elif quantity == "body_placement":
            worst.append(ratio((xk - yk)[:, :9]) + ratio((xk - yk)[:, 9:], yk[:, 9:]))
        else:
            scale = {"potential_energy": y, "body_acceleration": reference.acceleration[k]}.get(quantity, yk)
            worst.append(ratio(xk - yk, scale))
    return float(np.max(worst))


@dataclass(frozen=True)
class Reference:
    """What residuals are measured by, at each state: M, and of other quantities the sum of the magnitudes of their terms.

    `id` is inverse dynamics by Newton's and Euler's equations of every body, from one oracle's kinematics:
    tau = Σ J' (I α + ω × I ω + c × m (a_c - g); m (a_c - g)) + armature a.
    """

    mass: Array
    id: Array
    force: Array
    acceleration: Array

    @classmethod
    def make(cls, robot: Description, states: Blocks, x: Blocks, jacobians: Array) -> Reference:
        """The reference from one oracle's values `x`."""
        acceleration = np.abs(x["body_acceleration"]).max(axis=(1, 2)) + (x["body_velocity"] ** 2).max(axis=(1, 2))
        tau = np.concatenate([body.joint.armature for body in robot.bodies]) * states["a"]
        force = np.abs(tau) + np.abs(np.einsum("kij,kj->ki", x["mass_matrix"], states["a"]))
        for k, b in np.ndindex(len(tau), len(robot.bodies)):
            body, r = robot.bodies[b], x["body_placement"][k, b, :9].reshape(3, 3)
            inertia, c = r @ body.inertia @ r.T, r @ body.com
            (omega, v), (alpha, a) = (x[name][k, b].reshape(2, 3) for name in ("body_velocity", "body_acceleration"))
            push = body.mass * (a + np.cross(alpha, c) + np.cross(omega, np.cross(omega, c)) - robot.gravity)
            moments = inertia @ alpha, np.cross(omega, inertia @ omega), np.cross(c, push)
            tau[k] += jacobians[b, k].T @ np.append(sum(moments), push)
            spatial = body.mass * np.linalg.norm(omega) * np.linalg.norm(v)  # m ω × v, of which spatial algorithms rid themselves
            wrench = np.linalg.norm(states["wrench"][k, b].reshape(2, 3), axis=1)
            # Products of vectors round by the product of their lengths, also where they cancel: the cross product of parallel vectors does.
            gyroscopic = np.linalg.norm(omega) * np.linalg.norm(inertia @ omega)
            thrust = np.linalg.norm(push) + body.mass * acceleration[k]
            sizes = wrench + spatial + [np.linalg.norm(moments[0]) + gyroscopic + np.linalg.norm(c) * thrust, thrust]
            force[k] += np.abs(jacobians[b, k].T) @ np.repeat(sizes, 3)
        return cls(x["mass_matrix"], tau, force, acceleration)


def expect(name: str, answer: Answer, status: str) -> None:
    """The answer has that status, and a reason unless all is well."""
    right = answer[0]["status"] == status and (status == "ok" or 5 < len(answer[0]["reason"].splitlines()[0]))
    check(name, 0.0 if right else 1.0, 0.5)


# A hinge with damping and a skew axis, a slider that mimics it, and a link without an inertial.
