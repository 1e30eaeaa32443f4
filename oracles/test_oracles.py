"""Tests of the oracles through the protocol, each in its own process: agreement between the engines and identities of mechanics.

    python oracles/test_oracles.py [-v]

Prints every failure and 'N passed, N failed'; -v prints the largest residual of every check. A residual has no unit: M is scaled by its
diagonal, a force by the sum of the magnitudes of its terms, an acceleration by the norm of M, other things by the largest number of their
kind in that state (the robots' lengths being about a metre). FEATHERBENCH_TOL_SCALE scales all tolerances (0 shows every residual).
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from closed_forms import placement
from protocol import JOINT_SIZES, WITH_AXIS, Answer, Array, Blocks, Description, Header, read_frame, rotation, skew, write_frame

HERE = Path(__file__).parent
ENGINES = ("pinocchio", "mujoco", "drake", "dart")
Methods = dict[str, list[str]]
TOLERANCE_SCALE = float(os.environ.get("FEATHERBENCH_TOL_SCALE", "1"))
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
    return int(failed > 0)


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
            worst.append(max(ratio((xk - yk)[i] / d, yk[i] / d) for i in range(6)))
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


def test_robot(oracles: dict[str, Oracle], data: Header, seed: int) -> None:
    """Agreement and identities on one robot."""
    robot = Description.read(data)
    states, count = random_states(np.random.default_rng(seed), robot), 22
    agreed: Blocks = {}
    for name, oracle in oracles.items():
        test_readback(name, robot, oracle.must({"op": "prepare", "model": data})[1]["readback"])
        methods = oracle.must({"op": "hello"})[0]["methods"]
        oracle.must({"op": "states", "count": count}, states)
        values = {(q, m): oracle.value(q, m, count) for q in methods if q != "body_jacobian" for m in methods[q]}
        if "stored_entries" in methods:
            stored = values.pop(("stored_entries", methods.pop("stored_entries")[0]))
            check(f"{name}: stored entries of M", float(np.abs(stored - stored_entries(robot)).max()), 0.0)
        jacobian = methods["body_jacobian"][0]
        jacobians = np.array([oracle.value("body_jacobian", jacobian, count, body) for body in range(len(robot.bodies))])
        first = {q: values[q, methods[q][0]] for q in methods if q != "body_jacobian"}
        if name == "pinocchio":
            test_known_fault(robot, states, first["kinetic_energy"], values["kinetic_energy", "crba"])
            del values["kinetic_energy", "kinetic_energy"]
            first["kinetic_energy"], methods["kinetic_energy"] = values["kinetic_energy", "crba"], ["crba"]
        reference = Reference.make(robot, states, first, jacobians)
        agreed = agreed or first
        for (quantity, method), value in values.items():
            gap = residual(quantity, value, agreed[quantity], reference)
            check(f"{quantity} of {name} ({method}) against {next(iter(oracles))}", gap, EXACT)
        check(f"{name}: id = Newton and Euler", residual("id", first["id"], reference.id, reference), EXACT)
        test_identities(name, first, jacobians, states, reference)
        test_motion(name, oracle, methods, robot, states, first, reference)


def test_placements(oracles: dict[str, Oracle]) -> None:
    """Each joint alone moves its body as its closed form says; rates are held to the same form by `test_motion`."""
    rng = np.random.default_rng(7)
    lacking = {("mujoco", "helical")}
    for kind in JOINT_SIZES:
        data = without_armature(random_robot(rng, kind, [kind]))
        robot = Description.read(data)
        states = random_states(rng, robot)
        expected = np.array([placement(robot.bodies[0].joint, q) for q in states["q"]])
        for name, oracle in oracles.items():
            answer = oracle.ask({"op": "prepare", "model": data})[0]["status"]
            check(f"{name} on {kind}: {answer}", float(answer != ("unsupported" if (name, kind) in lacking else "ok")), 0)
            if answer == "ok":
                method = oracle.must({"op": "hello"})[0]["methods"]["body_placement"][0]
                found = oracle.at(states, "body_placement", method)[:, 0]
                check(f"{name} on {kind}: its closed form", ratio(found - expected, expected), EXACT)


def stored_entries(robot: Description) -> int:
    """n + Σ (d_k - 1) = Σ d_k: each dof has an entry with itself and each dof that it hangs on."""
    depths: list[int] = []
    total = 0
    for body in robot.bodies:
        above = 0 if body.parent < 0 else depths[body.parent]
        dofs = body.joint.v.stop - body.joint.v.start
        total += sum(range(above + 1, above + dofs + 1))
        depths.append(above + dofs)
    return total


def test_known_fault(robot: Description, states: Blocks, native: Array, right: Array) -> None:
    """Pinocchio 4.1.0's kinetic energy lacks the armature of unaligned revolute and helical joints, and nothing else."""
    missing = np.zeros_like(right)
    for joint in (body.joint for body in robot.bodies):
        if joint.type in ("revolute", "helical") and np.count_nonzero(joint.axis) > 1:
            missing += joint.armature * states["v"][:, joint.v] ** 2 / 2
    check("pinocchio: only the known fault in its kinetic energy", ratio(native + missing - right, right), EXACT)


def test_small_rotations(dart: Oracle) -> None:
    """DART 6.20.0's exponential leaves out the third order below 1e-3 rad, K^3 / 6 of the rotation vector's matrix K, and nothing else."""
    rng, angle = np.random.default_rng(8), 9e-4
    data = without_armature(random_robot(rng, "ball", ["spherical"], plain=True))
    robot = Description.read(data)
    states = random_states(rng, robot)
    axes = states["q"][:, :3] + [1e-3, 0, 0]  # one state has none
    axes /= np.linalg.norm(axes, axis=1, keepdims=True)
    states["q"] = np.hstack([np.sin(angle / 2) * axes, np.full((22, 1), np.cos(angle / 2))])
    dart.must({"op": "prepare", "model": data})
    placements = dart.at(states, "body_placement", "world_transforms")[:, 0, :9].reshape(-1, 3, 3)
    for q, axis, placement in zip(states["q"], axes, placements, strict=True):
        k = angle * skew(axis)
        expected = robot.bodies[0].joint.rotation @ (rotation(q) - k @ k @ k / 6)
        check("dart: only the known fault at small rotations", ratio(placement - expected), angle**4 / 12)


def test_readback(name: str, robot: Description, readback: Array) -> None:
    """The engine holds what it was given."""
    for body, row in zip(robot.bodies, readback, strict=True):
        size = np.trace(body.inertia) + body.mass * body.com @ body.com
        check(f"readback of {name}: mass and com", ratio(row[:4] - np.append(body.mass, body.com)), 1e-15)
        check(f"readback of {name}: inertia", ratio(row[4:10] - body.inertia[np.triu_indices(3)], size), 4e-15)
        place = np.append(body.joint.rotation.ravel(), body.joint.translation)
        check(f"readback of {name}: placement", ratio(row[10:] - place), 4e-15)


def test_identities(name: str, x: Blocks, jacobians: Array, states: Blocks, reference: Reference) -> None:
    """Identities between the quantities at one state."""
    for k, m in enumerate(x["mass_matrix"]):
        d, v, r, force = np.sqrt(np.diag(m)), states["v"][k], x["body_placement"][k, :, :9].reshape(-1, 3, 3), reference.force[k]
        check(f"{name}: M is symmetric", ratio((m - m.T) / np.outer(d, d)), 1e-15)
        check(f"{name}: id = M a + h", ratio((x["id"][k] - m @ states["a"][k] - x["bias"][k]) / force), EXACT)
        check(f"{name}: kinetic energy = ½ v'Mv", ratio(x["kinetic_energy"][k] - v @ m @ v / 2, x["kinetic_energy"][k]), EXACT)
        check(f"{name}: J v = body velocity", ratio(jacobians[:, k] @ v - x["body_velocity"][k], x["body_velocity"][k]), EXACT)
        world = np.hstack([np.einsum("bij,bj->bi", r, states["wrench"][k, :, part]) for part in (slice(3), slice(3, 6))])
        pushed = np.einsum("bij,bi->j", jacobians[:, k], world)
        check(f"{name}: id - id_wrench = Σ J'f", ratio((x["id"][k] - x["id_wrench"][k] - pushed) / force), EXACT)
        probe = np.array([*(m @ p for p in states["probe"]), np.diag(m), m[-1]])
        check(f"{name}: mass_matrix_probe of M", ratio((probe - x["mass_matrix_probe"][k]) / d, probe / d), EXACT)


def test_motion(name: str, oracle: Oracle, methods: Methods, robot: Description, states: Blocks, x: Blocks, reference: Reference) -> None:
    """Identities that need other states: inverse after forward dynamics, and derivatives by time."""

    def asked(quantity: str) -> Callable[[Blocks], Array]:
        return lambda moved: oracle.at(moved, quantity, methods[quantity][0])

    still = {**states, "a": np.zeros_like(states["a"])}
    for method in methods["id"]:
        check(f"{name}: bias = id(a = 0) ({method})", residual("bias", x["bias"], oracle.at(still, "id", method), reference), EXACT)
    for method in methods["fd"]:
        driven = {**states, "a": oracle.at(states, "fd", method)}
        for k, tau in enumerate(asked("id")(driven)):
            terms = np.abs(x["mass_matrix"][k]) @ np.abs(driven["a"][k]) + np.abs(states["tau"][k]) + reference.force[k]
            check(f"{name}: id after fd ({method})", ratio((tau - states["tau"][k]) / terms), INVERSE)
    slow = {key: value if key == "probe" else value[:-1] for key, value in states.items()}  # finite differences: not the fast state
    x = {key: value[:-1] for key, value in x.items()}
    spin, pace = x["body_velocity"][..., :3], x["body_velocity"][..., 3:]
    turning = np.cross(spin[..., None, :], x["body_placement"][..., :9].reshape(*spin.shape, 3).swapaxes(2, 3)).swapaxes(2, 3)
    expected = np.concatenate([turning.reshape(*spin.shape[:2], 9), pace], axis=2)  # ω × the columns of R
    check(f"{name}: d/dt placement = velocity", ratio(derivative(robot, slow, asked("body_placement")) - expected, expected), DIFFERENCE)
    speeding = derivative(robot, slow, asked("body_velocity"))
    check(f"{name}: d/dt velocity = acceleration", ratio(speeding - x["body_acceleration"], speeding), DIFFERENCE)
    drift = sum(body.mass for body in robot.bodies) * derivative(robot, slow, asked("com"))
    check(f"{name}: linear momentum = m d/dt com", ratio(drift - x["momentum"][:, 3:], drift), DIFFERENCE)
    change = sum(derivative(robot, {**slow, "a": x["fd"]}, asked(energy)) for energy in ("kinetic_energy", "potential_energy"))
    power = (slow["tau"] * slow["v"]).sum(axis=1, keepdims=True)
    check(f"{name}: d/dt energy = tau·v", ratio(change - power, power), DIFFERENCE * 100)


def test_refusals(oracles: dict[str, Oracle]) -> None:
    """What an engine cannot do is said, and nothing ends it."""
    rng = np.random.default_rng(5)
    good = without_armature(random_robot(rng, "good", ["revolute"]))
    models = [random_robot(rng, "screw", ["helical"]), random_robot(rng, "inner free", ["revolute", "free"])]
    models += [random_robot(rng, "heavy ball", ["spherical"], geared=True), random_robot(rng, "skater", ["planar"], geared=True)]
    models += [random_robot(rng, name, ["revolute"]) for name in ("massless", "indefinite")]
    for k in (0, 1, 4, 5):
        models[k] = without_armature(models[k])
    models[3]["bodies"][0]["joint"]["armature"][0] = 0.1
    models[4]["bodies"][0].update(mass=0.0, inertia=[0.0] * 6)
    models[5]["bodies"][0]["inertia"][3] = -1.0
    refused = {"mujoco": ("screw", "inner free", "massless", "indefinite"), "drake": ("heavy ball", "skater"), "pinocchio": ("skater",)}
    refused["dart"] = ("heavy ball", "skater")
    missing, orphan = {**good, "bodies": [{"name": "b"}]}, {**good, "bodies": [{**good["bodies"][0], "parent": 3}]}
    states = random_states(rng, Description.read(good))
    evaluate = {"op": "evaluate", "quantity": "com", "method": "", "first": 0, "count": 1}
    for name, oracle in oracles.items():
        for model in models:
            status = "unsupported" if model["name"] in refused[name] else "ok"
            expect(f"{name} on {model['name']}", oracle.ask({"op": "prepare", "model": model}), status)
        oracle.process.stdin.write(b"this is no frame\n")
        oracle.process.stdin.flush()
        expect(f"{name} answers garbage", oracle.answer(), "error")
        known = {**evaluate, "method": oracle.must({"op": "hello"})[0]["methods"]["com"][0]}
        prepare = [{"op": "prepare", "model": model} for model in (7, missing, orphan, good)]
        for request in ({}, {"op": "dance"}, {"op": []}, known, *prepare[:3]):
            expect(f"{name} answers {str(request)[:80]}", oracle.ask(request), "error")
        expect(f"{name} is alive after all that", oracle.ask(prepare[3]), "ok")
        expect(f"{name} has no states", oracle.ask(known), "error")
        expect(f"{name} wants all states", oracle.ask({"op": "states", "count": 23}, states), "error")
        expect(f"{name} takes states", oracle.ask({"op": "states", "count": 22}, states), "ok")
        expect(f"{name} has no state 22", oracle.ask({**known, "first": 22}), "error")
        expect(f"{name} has no such quantity", oracle.ask({**evaluate, "quantity": "coriolis"}), "unsupported")
        expect(f"{name} has no such method", oracle.ask(evaluate), "unsupported")
        expect(f"{name} evaluates", oracle.ask(known), "ok")
        check(f"{name} ends with its input", oracle.end(), 0)


def test_folded(oracles: dict[str, Oracle]) -> None:
    """Chains of massless bodies in one another's axes are one body with several joints in MuJoCo, which then lacks them as bodies."""
    rng = np.random.default_rng(11)
    kinds = ["free", "revolute", "prismatic", "revolute", "universal", "prismatic", "revolute", "planar", "revolute"]
    data = random_robot(rng, "folded", [*kinds, "prismatic", "spherical"])
    nothing = {"mass": 0.0, "com": [0.0] * 3, "inertia": [0.0] * 6}
    massless = (1, 2, 4, 7, 9)
    for i, body in enumerate(data["bodies"]):
        body["parent"] = i - 1
        if i in massless:
            body.update(nothing)
            data["bodies"][i + 1]["joint"]["placement"]["rotation"] = np.eye(3).ravel().tolist()
    data["bodies"][9]["parent"] = 3  # a branch
    robot = Description.read(data)
    states, count = random_states(rng, robot), 22
    mujoco, pinocchio = oracles["mujoco"], oracles["pinocchio"]
    methods = {name: oracles[name].must({"op": "hello"})[0]["methods"] for name in ("mujoco", "pinocchio")}
    readback = mujoco.must({"op": "prepare", "model": data})[1]["readback"]
    test_readback("mujoco (folded)", robot, readback)
    check("mujoco: massless bodies come back without mass", np.abs(readback[list(massless), :10]).max(), 0.0)
    pinocchio.must({"op": "prepare", "model": data})
    for quantity in ("mass_matrix", "id", "bias", "fd", "kinetic_energy", "potential_energy", "com", "momentum"):
        right = pinocchio.at(states, quantity, methods["pinocchio"][quantity][-1])  # the last one: of kinetic energy, the right one
        for method in methods["mujoco"][quantity]:
            value = mujoco.at(states, quantity, method)
            size = np.abs(right).max(axis=tuple(range(1, right.ndim)), keepdims=True)
            size = np.maximum(size, np.abs(right[:20]).max())  # where a sum is small, its terms are not
            tolerance = INVERSE if quantity == "fd" else EXACT
            check(f"mujoco: {quantity} by {method} of a folded robot", ratio((value - right) / size), tolerance)
    right = pinocchio.value("body_jacobian", methods["pinocchio"]["body_jacobian"][0], count, 8)
    check("mujoco: Jacobian of a folded robot", ratio(mujoco.value("body_jacobian", "jac_body", count, 8) - right), 1e-12)
    evaluate = {"op": "evaluate", "first": 0, "count": 1, "body": 1}
    for quantity in ("id_wrench", "body_placement", "body_velocity", "body_acceleration", "body_jacobian"):
        ask = {**evaluate, "quantity": quantity, "method": methods["mujoco"][quantity][0]}
        expect(f"mujoco: {quantity} of a folded body", mujoco.ask(ask), "unsupported")
    skew = random_robot(rng, "skew", ["revolute", "revolute"])
    skew["bodies"][0].update(nothing)
    skew["bodies"][1]["parent"] = 0
    expect("mujoco: massless bodies in skew axes are not folded", mujoco.ask({"op": "prepare", "model": skew}), "unsupported")


def expect(name: str, answer: Answer, status: str) -> None:
    """The answer has that status, and a reason unless all is well."""
    right = answer[0]["status"] == status and (status == "ok" or 5 < len(answer[0]["reason"].splitlines()[0]))
    check(name, 0.0 if right else 1.0, 0.5)


# A hinge with damping and a skew axis, a slider that mimics it, and a link without an inertial.
URDF = """<robot name="toy"><link name="stand"/>
<link name="arm"><inertial><origin xyz=".1 .2 .3" rpy=".4 .5 .6"/><mass value="1.5"/>
<inertia ixx=".02" iyy=".03" izz=".04" ixy=".001" ixz=".002" iyz=".003"/></inertial></link><link name="empty"/>
<joint name="hinge" type="revolute"><parent link="stand"/><child link="arm"/><origin xyz=".1 .2 .3" rpy="1.1 0 .3"/><axis xyz="0.6 0 0.8"/>
<limit lower="-1" upper="2" velocity="3" effort="40"/><dynamics damping=".7"/></joint>
<joint name="slide" type="prismatic"><parent link="arm"/><child link="empty"/><axis xyz="0 1 0"/>
<limit lower="-1" upper="2" velocity="3" effort="40"/><mimic joint="hinge" multiplier="2"/></joint></robot>"""


def test_dart_reads(dart: Oracle) -> None:
    """What DART read is what it computes with, without damping and mimicking: the robot built from the description answers the same."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "toy.urdf"
        path.write_text(URDF)
        for base in ("fixed", "free"):
            told = dart.must({"op": "read", "file": str(path), "format": "urdf", "base": base})[0]
            robot = Description.read(told["model"])
            states = random_states(np.random.default_rng(4), robot)
            quantities = (("mass_matrix", "mass_matrix"), ("id", "inverse_dynamics"), ("fd", "aba"), ("kinetic_energy", "kinetic_energy"))
            read = [dart.at(states, *quantity) for quantity in quantities]
            dart.must({"op": "prepare", "model": told["model"]})
            for (quantity, method), value in zip(quantities, read, strict=True):
                built = dart.at(states, quantity, method)
                check(f"dart: {quantity} of a file as read and of its description", ratio(value - built, built), EXACT)
            names = [body["joint"]["name"] for body in told["model"]["bodies"]]
            check("dart: joints of a file", float(names[-2:] != ["hinge", "slide"] or len(names) != 2 + (base == "free")), 0.0)
            causes = {(note["cause"], note["subject"]) for note in told["notes"]}
            due = {("mimic", "slide"), ("mass_edited", "stand"), ("mass_edited", "empty")}
            check("dart: notes on a file", float(not due <= causes), 0.0)
            check("dart: a link without an inertial is 1 kg", abs(robot.bodies[-1].mass - 1.0), 0.0)
            check("dart: damping of a file", abs(told["model"]["bodies"][-2]["joint"]["damping"][0] - 0.7), 1e-16)


def test_noise() -> None:
    """What an engine writes to file descriptor 1 does not reach the answers."""
    engine = "class E: name = version = 'noisy'; build = {}; quantities = {}; prepare = lambda self, d: os.write(1, b'noise')"
    oracle = Oracle("-c", f"import os, sys; sys.path.insert(0, {str(HERE)!r}); import protocol\n{engine}\nprotocol.serve(E())")
    good = random_robot(np.random.default_rng(0), "good", ["revolute"])
    expect("noise is kept out", oracle.ask({"op": "prepare", "model": good}), "error")
    expect("noise did no harm", oracle.ask({"op": "hello"}), "ok")
    oracle.end()


def main() -> int:
    """Runs all tests; an oracle that answers with an error where it must not ends them, which is a failure."""
    try:
        test_all({name: Oracle(str(HERE / f"{name}.py")) for name in ENGINES})
    except RuntimeError as reason:
        check(f"the tests come to their end: {reason}", np.nan, 0)
    return summary("-v" in sys.argv)


def test_all(oracles: dict[str, Oracle]) -> None:
    """All robots, then what is refused."""
    rng = np.random.default_rng(20)
    common = ["revolute", "prismatic", "spherical", "planar", "universal", "translation", "cylindrical", "euler_zyx"]
    test_placements(oracles)
    robots = [random_robot(rng, "fixed base", rng.permutation(common * 2).tolist()) for _ in range(3)]
    robots += [random_robot(rng, "free base", ["free", *rng.permutation(common * 2).tolist(), "free"]) for _ in range(3)]
    robots += [random_robot(rng, kind, [kind]) for kind in (*common, "free")]
    robots += [random_robot(rng, kind, [kind], plain=True) for kind in ("prismatic", "free")]  # for which MuJoCo has a short cut
    robots += [random_robot(rng, "plain", ["free", "prismatic", "prismatic", "revolute", *common * 2, "revolute"], plain=True)]
    robots += [random_robot(rng, "chain", ["free", *["revolute", "prismatic", "revolute"] * 23])]
    tests = [(robot, ("pinocchio", "mujoco", "drake")) for robot in robots]
    chains = ["revolute", "translation", "cylindrical", "euler_zyx"] * 2  # of one-dof joints in Drake, which has armature on them
    tests.append((random_robot(rng, "armature on chains", chains, geared=True), ("pinocchio", "mujoco", "drake")))
    for robot, engines in (
        (random_robot(rng, "screws and an inner free", ["helical", *common, "free", "helical", "free", "revolute"]), ("pinocchio", "drake")),
        (random_robot(rng, "straight screws", ["helical"] * 4 + ["revolute"], plain=True), ("pinocchio", "drake")),
        (random_robot(rng, "armature everywhere", ["free", *common], geared=True), ("pinocchio", "mujoco")),
    ):
        tests.append((robot, engines))
    tests += [(without_armature(robot), ("pinocchio", "dart")) for robot, _ in tests]
    for k, (robot, engines) in enumerate(tests):
        test_robot({name: oracles[name] for name in engines}, robot, k)
    test_small_rotations(oracles["dart"])
    test_dart_reads(oracles["dart"])
    test_folded(oracles)
    test_refusals(oracles)
    test_noise()


if __name__ == "__main__":
    sys.exit(main())
