"""Files that no engine reads, and questions that have no answer about a file's robot."""

from __future__ import annotations

import numpy as np
import pytest

from featherbench_oracles.core.robot import Description
from featherbench_oracles.testing.draws import COUNT, random_states

from . import files
from .readers import Readers, of_every_engine
from .test_session import status_of

NESTED = "<body>" * 600 + "</body>" * 600
BAD: dict[str, tuple[str, str | None]] = {
    "absent": ("absent.xml", None),
    "empty": ("empty.xml", ""),
    "torn": ("torn.xml", "<mujoco><worldbody>"),
    "deep": ("deep.xml", f"<mujoco><worldbody>{NESTED}</worldbody></mujoco>"),
    "a loop": ("loop.xml", '<mujoco model="l"><include file="loop.xml"/><worldbody/></mujoco>'),
    "without its part": ("part.xml", '<mujoco model="l"><include file="nowhere.xml"/><worldbody/></mujoco>'),
    "another document": ("page.xml", "<html/>"),
    "a link twice": ("twice.urdf", '<robot name="t"><link name="a"/><link name="a"/></robot>'),
    "of an unknown format": ("world.step", files.WORLD),
}
FORMATS = {"xml": "mjcf", "urdf": "urdf", "step": "step"}


@pytest.mark.parametrize("bad", BAD)
@of_every_engine
def test_bad_file_is_an_error(readers: Readers, engine: str, bad: str) -> None:
    """A file that no engine can read is an error, and the oracle continues."""
    (name, text), oracle = BAD[bad], readers.oracles[engine]
    path = readers.folder / name if text is None else readers.file(name, text)
    request = {"op": "import", "base": "fixed", "file": str(path), "format": FORMATS[name.rpartition(".")[2]]}
    assert status_of(oracle.ask(request)) == "error"
    good = readers.file("world.urdf", files.WORLD)
    oracle.must({"op": "import", "base": "fixed", "file": str(good), "format": "urdf"})


@of_every_engine
def test_no_single_bodies_of_a_file(readers: Readers, engine: str) -> None:
    """Quantities of single bodies of an imported robot are unsupported: its bodies need not be those of the description."""
    oracle = readers.oracles[engine]
    path = readers.file("world.urdf", files.WORLD)
    told = oracle.must({"op": "import", "base": "fixed", "file": str(path), "format": "urdf"})[0]
    states = random_states(np.random.default_rng(0), Description.read(told["model"]))
    oracle.must({"op": "states", "count": COUNT}, states)
    method = oracle.methods()["body_placement"][0]
    asked = {"op": "evaluate", "quantity": "body_placement", "method": method, "first": 0, "count": 1}
    assert status_of(oracle.ask(asked)) == "unsupported"
