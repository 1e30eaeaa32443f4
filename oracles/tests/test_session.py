"""Answers to wrong requests: an error or `unsupported`, and the oracle does not exit."""

from __future__ import annotations

import sys
from typing import NoReturn

import numpy as np
import pytest

from featherbench_oracles.abilities.rods import RodTable
from featherbench_oracles.core.messages import Answer, Header
from featherbench_oracles.core.protocol import Quantities, Unsupported
from featherbench_oracles.core.robot import Description
from featherbench_oracles.core.session import Session
from featherbench_oracles.testing.client import Oracle
from featherbench_oracles.testing.described import ENGINES, PACKAGES
from featherbench_oracles.testing.draws import COUNT, random_robot, random_states, without_armature
from featherbench_oracles.testing.measures import tolerance_scale

from .conftest import Oracles, require

UNSUPPORTED = {
    "pinocchio": ("skater",),
    "mujoco": ("screw", "inner free", "massless", "indefinite"),
    "drake": ("heavy ball", "skater"),
    "dart": ("heavy ball", "skater"),
}
MODELS = ("screw", "inner free", "heavy ball", "skater", "massless", "indefinite")


def _models() -> dict[str, Header]:
    """Draw a good robot, and some that an engine may reject."""
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
    return {model["name"]: model for model in (good, *models)}


DRAWN = _models()
GOOD = DRAWN["good"]
PREPARE: Header = {"op": "prepare", "model": GOOD}
STATES = random_states(np.random.default_rng(6), Description.read(GOOD))
EVALUATE: Header = {"op": "evaluate", "quantity": "com", "method": "", "first": 0, "count": 1}


def status_of(answer: Answer) -> str:
    """Find the status of an answer. If it is not `ok`, there is a reason."""
    status: str = answer[0]["status"]
    assert status == "ok" or len(answer[0]["reason"].splitlines()[0]) > 5
    return status


@pytest.mark.parametrize("engine", ENGINES)
def test_an_engine_has_the_version_of_its_description(oracles: Oracles, engine: str) -> None:
    """The version that is pinned in engines.toml is the one that answers."""
    assert oracles[engine].ask({"op": "hello"})[0]["version"] == PACKAGES[engine].version


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("engine", ENGINES)
def test_what_an_engine_lacks_is_unsupported(oracles: Oracles, engine: str, model: str) -> None:
    """A robot that the engine cannot hold is unsupported; any other is built."""
    answer = oracles[engine].ask({"op": "prepare", "model": DRAWN[model]})
    assert status_of(answer) == ("unsupported" if model in UNSUPPORTED[engine] else "ok")


@pytest.mark.parametrize("engine", ENGINES)
def test_garbage_is_an_error(oracles: Oracles, engine: str) -> None:
    """A line that is not JSON is an error, and the oracle continues."""
    oracle = oracles[engine]
    oracle.requests.write(b"this is no message\n")
    oracle.requests.flush()
    assert status_of(oracle.answer()) == "error"
    assert status_of(oracle.ask(PREPARE)) == "ok"


MALFORMED: dict[str, Header] = {
    "nothing": {},
    "an unknown op": {"op": "dance"},
    "an op that is no word": {"op": []},
    "a model that is none": {"op": "prepare", "model": 7},
    "a body without numbers": {"op": "prepare", "model": {**GOOD, "bodies": [{"name": "b"}]}},
    "a parent that is not there": {"op": "prepare", "model": {**GOOD, "bodies": [{**GOOD["bodies"][0], "parent": 3}]}},
}


@pytest.mark.parametrize("request_of", MALFORMED)
@pytest.mark.parametrize("engine", ENGINES)
def test_a_malformed_request_is_an_error(oracles: Oracles, engine: str, request_of: str) -> None:
    """A malformed request is an error, and the oracle continues."""
    oracle = oracles[engine]
    assert status_of(oracle.ask(MALFORMED[request_of])) == "error"
    assert status_of(oracle.ask(PREPARE)) == "ok"


@pytest.mark.parametrize("engine", ENGINES)
def test_a_refused_model_leaves_none(oracles: Oracles, engine: str) -> None:
    """After a model that was rejected there is no robot to ask about."""
    oracle = oracles[engine]
    known = {**EVALUATE, "method": oracle.methods()["com"][0]}
    oracle.ask(PREPARE)
    oracle.must({"op": "states", "count": COUNT}, STATES)
    assert status_of(oracle.ask(MALFORMED["a model that is none"])) == "error"
    assert status_of(oracle.ask(known)) == "error"


@pytest.mark.parametrize("engine", ENGINES)
def test_states_are_all_or_none(oracles: Oracles, engine: str) -> None:
    """States of another number than announced are an error, and so is a state beyond them."""
    oracle = oracles[engine]
    known = {**EVALUATE, "method": oracle.methods()["com"][0]}
    oracle.must(PREPARE)
    assert status_of(oracle.ask(known)) == "error"
    assert status_of(oracle.ask({"op": "states", "count": COUNT + 1}, STATES)) == "error"
    assert status_of(oracle.ask({"op": "states", "count": COUNT}, STATES)) == "ok"
    assert status_of(oracle.ask({**known, "first": COUNT})) == "error"
    assert status_of(oracle.ask(known)) == "ok"


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("lacking", [{"quantity": "coriolis"}, {"method": ""}], ids=["quantity", "method"])
def test_an_unknown_quantity_or_method_is_unsupported(oracles: Oracles, engine: str, lacking: Header) -> None:
    """A quantity or a method that the engine does not have is unsupported."""
    oracle = oracles[engine]
    oracle.must(PREPARE)
    oracle.must({"op": "states", "count": COUNT}, STATES)
    assert status_of(oracle.ask({**EVALUATE, "method": oracle.methods()["com"][0], **lacking})) == "unsupported"


@pytest.mark.parametrize("engine", ENGINES)
def test_an_oracle_ends_with_its_input(engine: str) -> None:
    """The process exits by itself with status 0."""
    require(engine)
    oracle = Oracle.of(engine)
    oracle.must(PREPARE)
    assert oracle.end() == 0


NOISY = """
import os
from featherbench_oracles.core.session import serve
class Engine:
    name = version = "noisy"
    build = quantities = {}
    def prepare(self, description):
        return os.write(1, b"noise")
serve(Engine())
"""


def test_noise_is_kept_out_of_answers() -> None:
    """What an engine writes to file descriptor 1 does not reach the answers."""
    oracle = Oracle("-c", NOISY)
    assert status_of(oracle.ask(PREPARE)) == "error"
    assert status_of(oracle.ask({"op": "hello"})) == "ok"
    oracle.end()


class Stranger:
    """An engine that inherits from no protocol."""

    name = version = "stranger"
    build = {"language": "Python"}
    quantities: Quantities = {}
    rods: RodTable = {"any": lambda _: pytest.fail("nothing is made of a wrong question")}

    def prepare(self, description: Description) -> NoReturn:
        """Refuse the robot."""
        raise Unsupported(description.name)


def test_an_engine_has_the_abilities_of_its_members() -> None:
    """A base class is not asked for; what the engine has no members of is not offered, and unsupported."""
    session = Session(Stranger())
    hello, _ = session.answer({"op": "hello"}, {})
    assert set(hello) == {"protocol", "engine", "version", "build", "methods", "rods"}
    assert hello["rods"] == ["any"]
    # Some wheels need a newer Python than others: the one that runs the engine is told.
    assert hello["build"] == {"language": "Python", "python": ".".join(map(str, sys.version_info[:3]))}
    for lacking in ({"op": "rod", "method": "other"}, {"op": "residual"}, {"op": "loops", "model": GOOD}):
        with pytest.raises(Unsupported, match="stranger"):
            session.answer(lacking, {})
    with pytest.raises(Unsupported, match="reads no files"):
        session.answer({"op": "import", "format": "urdf", "file": "none.urdf"}, {})


@pytest.mark.parametrize(("text", "scale"), [("1", 1.0), ("0", 0.0), (" 1e3 ", 1000.0)])
def test_tolerances_can_be_scaled(text: str, scale: float) -> None:
    """The factor on tolerances is a number."""
    assert tolerance_scale(text) == scale


@pytest.mark.parametrize("text", ["", "nan", "-1", "inf", "1e999", "off"])
def test_no_factor_turns_comparisons_off(text: str) -> None:
    """A factor that would let everything pass is an error."""
    with pytest.raises(ValueError, match="FEATHERBENCH_TOL_SCALE"):
        tolerance_scale(text)
