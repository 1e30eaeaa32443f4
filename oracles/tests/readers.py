"""What the tests of the import share: an engine's answer to `import`, and the comparison of the imported robot with what was told.

For every file that an engine reads, a robot is built by `prepare` from the description that the engine told. Its M and inverse dynamics are
compared with those of the imported robot. So the description is what the engine computes with.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest
from numpy.typing import ArrayLike

from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.messages import Header
from featherbench_oracles.core.reading import turned
from featherbench_oracles.core.robot import Description
from featherbench_oracles.testing.client import Oracle
from featherbench_oracles.testing.described import ENGINES
from featherbench_oracles.testing.draws import random_states
from featherbench_oracles.testing.measures import ratio, within

if TYPE_CHECKING:
    from .conftest import Oracles

REPLAY = within(1e-13)  # unit-free; these robots are shallow, and M's terms are of the size of its diagonal
DIGITS = 1e-15  # relative error of reading a decimal, and of one rotation by it
REPEATED = 1e-16  # relative error of a number that is told twice
QUARTER = turned(0.6, 0, 0, 0.8)  # the rotation of the quaternion in the MJCF files
FORMATS = {"xml": "mjcf", "urdf": "urdf", "sdf": "sdf", "usda": "usd"}
THREE_ENGINES = ("pinocchio", "mujoco", "drake")  # DART's other edits: test_dart_computes_with_what_it_tells


@dataclass
class Read:
    """An engine's answer to `import`."""

    header: Header
    keyframes: Array | None

    @property
    def bodies(self) -> list[Header]:
        """The bodies of the description."""
        bodies: list[Header] = self.header["model"]["bodies"]
        return bodies

    def body(self, name: str) -> Header:
        """Find the body of that name."""
        return next(body for body in self.bodies if body["name"] == name)

    def names(self) -> list[str]:
        """Name the bodies in order."""
        return [body["name"] for body in self.bodies]

    def frame(self, name: str) -> tuple[int, Array]:
        """Find the body of a frame, and its rotation and origin in one row."""
        frame = next(frame for frame in self.header["model"]["frames"] if frame["name"] == name)
        return frame["body"], placed(frame)

    def causes(self) -> set[str]:
        """List what the notes are about."""
        return {note["cause"] for note in self.header["notes"]}


def placed(item: Header) -> Array:
    """Write a placement in one row: rotation, row by row, and origin."""
    return np.array([*item["placement"]["rotation"], *item["placement"]["translation"]])


class Readers:
    """The oracles, and a folder for files."""

    def __init__(self, oracles: Oracles, folder: Path) -> None:
        self.oracles, self.folder = oracles, folder

    def file(self, name: str, text: str) -> Path:
        """Write a file."""
        path = self.folder / name
        path.write_text(text, encoding="utf-8")
        return path

    def read(self, engine: str, name: str, text: str, base: str = "fixed", replay: bool = True) -> Read:
        """Have the engine read a file, which must succeed, and compare the robot with the description that it told."""
        path, oracle = self.file(name, text), self.oracles[engine]
        form = FORMATS[path.suffix[1:]]
        header = {"op": "import", "file": str(path), "format": form, "base": base}
        answer, blocks = oracle.must(header)
        if replay:
            self._replay(oracle, answer)
        return Read(answer, blocks.get("keyframes"))

    def variants(self, name: str, text: str) -> list[Header]:
        """Have MuJoCo tell the variants of an MJCF."""
        path = self.file(name, text)
        told: list[Header] = self.oracles["mujoco"].must({"op": "variants", "file": str(path), "format": "mjcf"})[0]["variants"]
        return told

    def _replay(self, oracle: Oracle, answer: Header) -> None:
        """Compare M, ID and h of the imported robot with those of the description, by the same engine or else by Pinocchio."""
        robot = Description.read(answer["model"])
        states = random_states(np.random.default_rng(3), robot)
        quantities = ("mass_matrix", "id", "bias")
        held = [oracle.at(states, quantity, oracle.methods()[quantity][0]) for quantity in quantities]
        tree = {key: value for key, value in answer["model"].items() if key != "loops"}
        prepare = {"op": "prepare", "model": tree}
        if oracle.ask(prepare)[0]["status"] == "unsupported":
            oracle = self.oracles["pinocchio"]
            oracle.must(prepare)
        built = [oracle.at(states, quantity, oracle.methods()[quantity][0]) for quantity in quantities]
        for k, mass in enumerate(built[0]):
            d = np.sqrt(np.diag(mass))
            force = np.abs(built[1][k]) + np.abs(built[2][k]) + np.abs(mass) @ (np.abs(states["a"][k]) + states["v"][k] ** 2)
            assert ratio((held[0][k] - mass) / np.outer(d, d)) <= REPLAY, "M is not as described"
            for quantity in (1, 2):
                gap = (held[quantity][k] - built[quantity][k]) / d
                assert ratio(gap, force / d) <= REPLAY, f"{quantities[quantity]} is not as described"


def same(value: ArrayLike, due: ArrayLike, tolerance: float = DIGITS) -> bool:
    """Whether two arrays agree, relative to the largest number or to one."""
    x, y = np.asarray(value, dtype=float), np.asarray(due, dtype=float)
    return x.shape == y.shape and bool(np.abs(x - y).max() / max(1.0, float(np.abs(y).max())) <= within(tolerance))


of_every_engine = pytest.mark.parametrize("engine", ENGINES)
of_three_engines = pytest.mark.parametrize("engine", THREE_ENGINES)
