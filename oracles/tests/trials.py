"""The robots of the tests, and what the engines answer about them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.messages import Blocks, Header
from featherbench_oracles.core.protocol import DERIVATIVES
from featherbench_oracles.core.robot import Description
from featherbench_oracles.testing.client import Methods, Oracle
from featherbench_oracles.testing.draws import COUNT, random_robot, random_states, without_armature
from featherbench_oracles.testing.measures import Reference

COMMON = ("revolute", "prismatic", "spherical", "planar", "universal", "translation", "cylindrical", "euler_zyx")


@dataclass(frozen=True)
class Trial:
    """A robot, the engines that have all of its joints, and the seed of its states. The others are compared with the first engine."""

    model: Header
    engines: tuple[str, ...]
    seed: int


def _trials() -> list[Trial]:
    """Draw all robots from one seed, first those with armature, then the same without for DART."""
    rng = np.random.default_rng(20)
    robots = [random_robot(rng, "fixed base", rng.permutation(COMMON * 2).tolist()) for _ in range(3)]
    robots += [random_robot(rng, "free base", ["free", *rng.permutation(COMMON * 2).tolist(), "free"]) for _ in range(3)]
    robots += [random_robot(rng, kind, [kind]) for kind in (*COMMON, "free")]
    robots += [random_robot(rng, kind, [kind], plain=True) for kind in ("prismatic", "free")]  # MuJoCo has a special case for these
    robots += [random_robot(rng, "plain", ["free", "prismatic", "prismatic", "revolute", *COMMON * 2, "revolute"], plain=True)]
    robots += [random_robot(rng, "chain", ["free", *["revolute", "prismatic", "revolute"] * 23])]
    chains = ["revolute", "translation", "cylindrical", "euler_zyx"] * 2  # chains of one-dof joints in Drake, which has armature on these
    robots += [random_robot(rng, "armature on chains", chains, geared=True)]
    asked = [(robot, ("pinocchio", "mujoco", "drake")) for robot in robots]
    inner = ["helical", *COMMON, "free", "helical", "free", "revolute"]
    more: list[tuple[Header, tuple[str, ...]]] = [
        (random_robot(rng, "screws and an inner free", inner), ("pinocchio", "drake")),
        (random_robot(rng, "straight screws", ["helical"] * 4 + ["revolute"], plain=True), ("pinocchio", "drake")),
        (random_robot(rng, "armature everywhere", ["free", *COMMON], geared=True), ("pinocchio", "mujoco")),
    ]
    whole = [*asked, *more]
    whole += [(without_armature(robot), ("pinocchio", "dart")) for robot, _ in whole]
    return [Trial(robot, engines, seed) for seed, (robot, engines) in enumerate(whole)]


TRIALS = _trials()


class Answered:
    """What an engine answers about a trial's robot at its states.

    Parameters
    ----------
    oracle : Oracle
        The engine's oracle.
    engine : str
        Its name.
    trial : Trial
        The robot.

    Attributes
    ----------
    methods : dict of str to list of str
        The engine's methods by quantity. Identities are tested with the first.
    values : dict of (str, str) to ndarray
        The answers by quantity and method, except Jacobians.
    first : dict of str to ndarray
        The answers by the first method.
    jacobians : ndarray, shape (bodies, states, 6, nv)
        Of each body.
    reference : Reference
        The scales of residuals for this robot.
    """

    def __init__(self, oracle: Oracle, engine: str, trial: Trial) -> None:
        self.oracle, self.engine, self.trial = oracle, engine, trial
        self.robot = Description.read(trial.model)
        self.states = random_states(np.random.default_rng(trial.seed), self.robot)
        self.readback = self.prepare()
        self.methods: Methods = oracle.methods()
        oracle.must({"op": "states", "count": COUNT}, self.states)
        for quantity in DERIVATIVES:  # test_derivatives.py asks for them
            self.methods.pop(quantity, None)
        asked = [(quantity, method) for quantity, methods in self.methods.items() for method in methods if quantity != "body_jacobian"]
        self.values = {(quantity, method): oracle.value(quantity, method, COUNT) for quantity, method in asked}
        jacobian = self.methods["body_jacobian"][0]
        self.jacobians = np.array([oracle.value("body_jacobian", jacobian, COUNT, body) for body in range(len(self.robot.bodies))])
        if engine == "pinocchio":  # its own kinetic energy is a known deviation
            self.methods["kinetic_energy"] = ["crba"]
        firsts = {quantity: methods[0] for quantity, methods in self.methods.items() if quantity != "body_jacobian"}
        self.first: Blocks = {quantity: self.values[quantity, method] for quantity, method in firsts.items()}
        self.reference = Reference.make(self.robot, self.states, self.first, self.jacobians)

    def prepare(self) -> Array:
        """Have the engine build the robot (again: other tests ask the same process), and read it back."""
        return self.oracle.must({"op": "prepare", "model": self.trial.model})[1]["readback"]

    def at(self, states: Blocks, quantity: str, method: str) -> Array:
        """Ask the engine for a quantity of this robot at other states."""
        self.prepare()
        return self.oracle.at(states, quantity, method)
