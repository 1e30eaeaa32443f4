"""Times of an engine's own calls, measured by its oracle."""

from __future__ import annotations

import numpy as np
import pytest

from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.change import CoordinateChange
from featherbench_oracles.core.clock import Measured, Stream, TimedCalls
from featherbench_oracles.core.messages import Blocks, Header
from featherbench_oracles.core.protocol import Quantities, State, Unsupported
from featherbench_oracles.core.robot import Description
from featherbench_oracles.core.session import Session
from featherbench_oracles.testing.client import Oracle
from featherbench_oracles.testing.described import ENGINES
from featherbench_oracles.testing.draws import COUNT, random_robot, random_states, without_armature

from .conftest import Oracles
from .test_session import status_of

ESTIMATING = ("drake", "dart")
# quantities and methods that the two engines time, seven each
TIMED = {
    "drake": [
        ("id", "inverse_dynamics"),
        ("bias", "inverse_dynamics"),
        ("mass_matrix", "crba"),
        ("mass_matrix_sparse", "crba"),
        ("fd", "aba"),
        ("kinetic_energy", "kinetic_energy"),
        ("body_jacobian", "jacobian_spatial_velocity"),
    ],
    "dart": [
        ("id", "inverse_dynamics"),
        ("bias", "inverse_dynamics"),
        ("mass_matrix", "mass_matrix"),
        ("mass_matrix_sparse", "mass_matrix"),
        ("fd", "aba"),
        ("kinetic_energy", "kinetic_energy"),
        ("com", "center_of_mass"),
    ],
}
MODEL = without_armature(random_robot(np.random.default_rng(12), "timed", ["free", *["revolute"] * 25]))
STATES = random_states(np.random.default_rng(13), Description.read(MODEL))
ALONE = {name: block if name == "probe" else block[:1] for name, block in STATES.items()}
CLOCK: Header = {"op": "clock", "first": 20, "count": 25, "body": 25}


class Ticks:
    """A clock that a call sets forward. Each reading sets it forward by 50 ns."""

    def __init__(self) -> None:
        self.now = 0

    def __call__(self) -> int:
        """Tell the time."""
        self.now += 50
        return self.now


class Waiting:
    """A robot whose only call takes a given time, by this clock."""

    def __init__(self, ticks: Ticks, nanoseconds: int) -> None:
        self.ticks, self.nanoseconds = ticks, nanoseconds

    def change(self, ask: State) -> CoordinateChange:
        """Change nothing."""
        return CoordinateChange((), np.zeros(len(ask.v)))

    def positions(self, q: Array) -> Array:
        """Leave them as they are."""
        return q

    def wait(self, _q: Array, _v: Array) -> None:
        """Let the time pass."""
        self.ticks.now += self.nanoseconds


ONE = np.zeros(1)
ASK = State(ONE, ONE, ONE, ONE, ONE, ONE, body=0)
WAIT = TimedCalls("q v", Waiting.wait)


def test_overhead_is_subtracted() -> None:
    """From 60 µs the 20 µs on a robot without bodies are subtracted, 20 times. The loop holds one call of the clock."""
    ticks = Ticks()
    stream = Stream(WAIT, Waiting(ticks, 60_000), Waiting(ticks, 20_000), [ASK, ASK], ticks)
    nanoseconds, overhead = stream.time(1, 20)
    assert nanoseconds == 800_050
    assert overhead == 400_000


def test_no_time_below_nothing() -> None:
    """If the overhead is as long as the measured time, there is no estimate."""
    ticks = Ticks()
    stream = Stream(WAIT, Waiting(ticks, 20_000), Waiting(ticks, 60_000), [ASK], ticks)
    with pytest.raises(ValueError, match="nothing is left"):
        stream.time(0, 5)


class Compiled(Measured):
    """A method whose loop takes 3 ns for each state, and that notes where its data were put."""

    def __init__(self) -> None:
        self.seeds: list[int | None] = []
        self.batches: list[int] = []

    def __call__(self, robot: Still, ask: State) -> Array:
        """Answer with the velocities."""
        return ask.v

    def stream(self, robot: Still, asks: list[State]) -> Compiled:
        """Note how many states there are."""
        self.batches.append(len(asks))
        return self

    def time(self, first: int, count: int) -> int:
        """Take 3 ns for each state."""
        return 3 * count

    def relocate(self, seed: int | None) -> None:
        """Note the seed."""
        self.seeds.append(seed)


class Still:
    """A robot that is not computed with."""

    def readback(self) -> list[Array]:
        """Read back nothing of each body."""
        return [np.zeros(22) for _ in Description.read(MODEL).bodies]


class Measuring:
    """An engine with one compiled method, and one in Python."""

    name, version = "measuring", "1"

    def __init__(self, method: Compiled) -> None:
        self.build: dict[str, str] = {}
        self.quantities: Quantities = {"bias": {"compiled": method, "python": lambda _, ask: ask.v}}

    def prepare(self, description: Description) -> Still:
        """Build nothing."""
        return Still()


def test_a_compiled_loop_measures_its_own_time() -> None:
    """Its times are no estimates. Its states are converted once, and its data can be relocated."""
    method = Compiled()
    session = Session(Measuring(method))
    nothing: Blocks = {}
    hello, _ = session.answer({"op": "hello"}, nothing)
    assert (hello["clock"], hello["relocate"], "timed" in hello) == (True, True, False)
    session.answer({"op": "prepare", "model": MODEL}, nothing)
    session.answer({"op": "states", "count": COUNT}, STATES)
    session.answer({"op": "relocate", "seed": 1}, nothing)  # nothing was timed yet
    question: Header = {**CLOCK, "quantity": "bias", "method": "compiled"}
    for _ in range(2):
        assert session.answer(question, nothing)[0] == {"nanoseconds": 75}
    session.answer({"op": "relocate", "seed": 2}, nothing)
    assert (method.batches, method.seeds) == ([COUNT], [2])
    with pytest.raises(Unsupported, match="does not time bias by python"):
        session.answer({**question, "method": "python"}, nothing)
    with pytest.raises(ValueError, match="there are no 0 states"):
        session.answer({**question, "count": 0}, nothing)


def test_without_a_robot_nothing_is_relocated() -> None:
    """A robot comes first."""
    with pytest.raises(ValueError, match="no model"):
        Session(Measuring(Compiled())).answer({"op": "relocate", "seed": 1}, {})


@pytest.mark.parametrize("engine", ENGINES)
def test_what_is_timed_is_told(oracles: Oracles, engine: str) -> None:
    """An engine that is called through Python says that its times are estimates, and of which methods."""
    hello = oracles[engine].must({"op": "hello"})[0]
    told = [(quantity, method) for quantity, methods in hello.get("timed", {}).items() for method in methods]
    assert sorted(told) == sorted(TIMED.get(engine, []))
    assert hello.get("clock") == ("estimate" if engine in ESTIMATING else None)


@pytest.mark.parametrize("engine", ENGINES)
def test_what_is_not_timed_is_unsupported(oracles: Oracles, engine: str) -> None:
    """Without states a time is an error. A method that is more than calls of the engine has no time."""
    oracle = oracles[engine]
    clock = {**CLOCK, "quantity": "momentum", "method": oracle.methods()["momentum"][0]}
    oracle.must({"op": "prepare", "model": MODEL})
    assert status_of(oracle.ask(clock)) == "error"
    oracle.must({"op": "states", "count": COUNT}, STATES)
    assert status_of(oracle.ask(clock)) == "unsupported"


def _timed(oracle: Oracle, asked: Header) -> tuple[float, float]:
    """Time a call and its overhead in nanoseconds. The shortest block counts, as other processes interrupted it least."""
    answers = [oracle.must(asked)[0] for _ in range(25)]
    least = min(answers, key=lambda answer: answer["nanoseconds"] + answer["overhead"])
    return least["nanoseconds"] / asked["count"], least["overhead"] / asked["count"]


@pytest.mark.parametrize(("engine", "quantity", "method"), [(e, *pair) for e in ESTIMATING for pair in TIMED[e]])
def test_time_of_calls(oracles: Oracles, engine: str, quantity: str, method: str) -> None:
    """A call takes some time and has some overhead. Timing does not change its answer, and the same state is computed again.

    A stream and one repeated state may differ by a factor of 2.5, because caches make one state faster.
    """
    oracle, asked = oracles[engine], {**CLOCK, "quantity": quantity, "method": method}
    evaluate = {**asked, "op": "evaluate", "first": 0, "count": COUNT}
    oracle.must({"op": "prepare", "model": MODEL})
    oracle.must({"op": "states", "count": COUNT}, STATES)
    before = oracle.must(evaluate)[1]["value"]
    assert status_of(oracle.ask({**asked, "count": 0})) == "error"
    streamed, overhead = _timed(oracle, asked)
    whole = streamed + overhead
    assert 100 < streamed < 1e7
    assert 100 < overhead < 1e5
    assert (oracle.must(evaluate)[1]["value"] == before).all()
    oracle.must({"op": "states", "count": 1}, ALONE)
    assert whole / sum(_timed(oracle, asked)) <= 2.5
    assert whole / sum(_timed(oracle, {**asked, "count": 1})) <= 2.5
