"""Tests of the oracles through the protocol, each in its own process: agreement between the engines and identities of mechanics.

    python oracles/test_oracles.py [-v]

Prints every failure and 'N passed, N failed'; -v prints the largest residual of every check (`trials.py` says by what each is measured).
FEATHERBENCH_TOL_SCALE scales all tolerances (at 0 every residual but zero fails, and is printed).
"""

from __future__ import annotations

import os
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np

from clock import Calls, Stream
from closed_forms import placement
from protocol import JOINT_SIZES, Array, Blocks, Change, Description, Header, Question, rotation, skew
from trials import (
    DIFFERENCE,
    ENGINES,
    EXACT,
    HERE,
    INVERSE,
    Methods,
    Oracle,
    Reference,
    check,
    derivative,
    expect,
    random_robot,
    random_states,
    ratio,
    residual,
    summary,
    tolerance_scale,
    without_armature,
)


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
        if "mass_matrix_sparse" in methods:
            sparse = values.pop(("mass_matrix_sparse", methods.pop("mass_matrix_sparse")[0]))
            rows, columns = robot.tree_sparse()
            check(f"{name}: as many entries as the layout has", float(len(rows) != stored_entries(robot)), 0)
            check(f"{name}: sparse M is M", ratio(sparse - values["mass_matrix", methods["mass_matrix"][0]][:, rows, columns]), 0.0)
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


class Ticks:
    """A clock that goes on when a call says so, and by 50 ns whenever it is read."""

    def __init__(self) -> None:
        self.now = 0

    def __call__(self) -> int:
        """The time."""
        self.now += 50
        return self.now


class Waiting:
    """A robot whose only call takes as long as it is told, by this clock."""

    def __init__(self, ticks: Ticks, nanoseconds: int) -> None:
        self.ticks, self.nanoseconds = ticks, nanoseconds

    def change(self, ask: Question) -> Change:
        """None."""
        return Change((), np.zeros(len(ask.v)))

    def positions(self, q: Array) -> Array:
        """As they are."""
        return q

    def wait(self, _q: Array, _v: Array) -> None:
        """The call."""
        self.ticks.now += self.nanoseconds


def test_overhead() -> None:
    """What calls take on a robot without bodies is subtracted; where nothing is left, there is no estimate."""
    ask, wait, ticks = Question(*np.zeros((6, 1)), body=0), Calls("q v", Waiting.wait), Ticks()
    stream = Stream(wait, Waiting(ticks, 60_000), Waiting(ticks, 20_000), [ask, ask], ticks)
    nanoseconds, overhead = stream.time(1, 20)
    check("clock: 60 µs less 20 µs of overhead, 20 times, and one reading", abs(nanoseconds - 800_050), 0)
    check("clock: the overhead is told, without the clock's own", abs(overhead - 400_000), 0)
    try:
        Stream(wait, Waiting(ticks, 20_000), Waiting(ticks, 60_000), [ask], ticks).time(0, 5)
        check("clock: no time below nothing", 1, 0)
    except ValueError as reason:
        check("clock: no time below nothing", float("nothing is left" not in str(reason)), 0)


def timed(oracle: Oracle, asked: Header) -> tuple[float, float]:
    """Nanoseconds of a call and its overhead, of the block that was interrupted least by other processes."""
    answers = [oracle.must(asked)[0] for _ in range(25)]
    least = min(answers, key=lambda answer: answer["nanoseconds"] + answer["overhead"])
    return least["nanoseconds"] / asked["count"], least["overhead"] / asked["count"]


def test_clock(oracles: dict[str, Oracle]) -> None:
    """What is timed is offered, answered and checked; a state that comes again and again is computed again and again."""
    data = without_armature(random_robot(np.random.default_rng(12), "timed", ["free", *["revolute"] * 25]))
    states = random_states(np.random.default_rng(13), Description.read(data))
    alone = {name: block if name == "probe" else block[:1] for name, block in states.items()}
    for name, oracle in oracles.items():
        hello = oracle.must({"op": "hello"})[0]
        estimated = {"drake": 7, "dart": 7}.get(name, 0)
        check(f"{name}: methods that it times", len([m for by_method in hello.get("timed", {}).values() for m in by_method]) - estimated, 0)
        check(f"{name}: its clock", float(hello.get("clock") != ("estimate" if estimated else None)), 0)
        clock = {"op": "clock", "quantity": "momentum", "method": hello["methods"]["momentum"][0], "first": 20, "count": 25, "body": 25}
        oracle.must({"op": "prepare", "model": data})
        expect(f"{name} times no state", oracle.ask(clock), "error")
        oracle.must({"op": "states", "count": 22}, states)
        expect(f"{name} does not time momentum", oracle.ask(clock), "unsupported")
        for quantity, method in ((quantity, method) for quantity, named in hello.get("timed", {}).items() for method in named):
            asked = {**clock, "quantity": quantity, "method": method}
            before = oracle.must({**asked, "op": "evaluate", "first": 0, "count": 22})[1]["value"]
            expect(f"{name} times no calls", oracle.ask({**asked, "count": 0}), "error")
            streamed, overhead = timed(oracle, asked)
            whole = streamed + overhead
            check(f"{name}: {quantity} takes time", float(not 100 < streamed < 1e7), 0)
            check(f"{name}: {quantity} has an overhead", float(not 100 < overhead < 1e5), 0)
            after = oracle.must({**asked, "op": "evaluate", "first": 0, "count": 22})[1]["value"]
            check(f"{name}: {quantity} is the same after the clock", float((before != after).any()), 0)
            oracle.must({"op": "states", "count": 1}, alone)
            check(f"{name}: {quantity} is computed again for the same state", whole / sum(timed(oracle, asked)), 2.5)
            check(f"{name}: {quantity} is computed again in another block", whole / sum(timed(oracle, {**asked, "count": 1})), 2.5)
            oracle.must({"op": "states", "count": 22}, states)


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


def test_tolerance_scale() -> None:
    """No factor turns the comparisons off."""
    check("the factor on tolerances", float([tolerance_scale(text) for text in ("1", "0", " 1e3 ")] != [1.0, 0.0, 1000.0]), 0.0)
    for text in ("", "nan", "-1", "inf", "1e999", "off"):
        try:
            check(f"a factor on tolerances of '{text}' is refused", float(np.isfinite(tolerance_scale(text))), -1.0)
        except ValueError:
            pass


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
    test_tolerance_scale()
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
    test_overhead()
    test_clock(oracles)
    test_refusals(oracles)
    test_noise()


if __name__ == "__main__":
    sys.exit(main())
