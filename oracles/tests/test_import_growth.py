"""A reading's work grows with the number of links, and not with its square: our own steps are counted, not timed."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest

from featherbench_oracles.core import reading as files

OURS = "featherbench_oracles"
LINKS = 60
GROWTH = 2.1  # of twice the links: what is done once for a file makes it less than 2, and dictionaries that grow make it more
INERTIAL = '<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'


def tree(links: int, seed: int) -> str:
    """Draw a URDF: each link hangs on one of the ten before it, every third by a fixed joint."""
    random = np.random.default_rng(seed)
    parts = ['<robot name="drawn">', '<link name="link0"/>']
    for i in range(1, links):
        kind = "continuous" if i % 3 else "fixed"
        parent = max(0, i - 1 - int(random.integers(10)))
        parts.append(f'<link name="link{i}">{INERTIAL}</link>')
        ends = f'<parent link="link{parent}"/><child link="link{i}"/><origin xyz="0.1 0 0"/>'
        parts.append(f'<joint name="joint{i}" type="{kind}">{ends}<axis xyz="0 0 1"/></joint>')
    return "\n".join([*parts, "</robot>"])


@contextmanager
def counted(steps: list[int]) -> Iterator[None]:
    """Count the instructions of the interpreter in our own modules."""

    def trace(frame: FrameType, event: str, _: Any) -> Any:
        if not frame.f_globals.get("__name__", "").startswith(OURS):
            return None
        frame.f_trace_opcodes, frame.f_trace_lines = True, False
        steps[0] += event == "opcode"
        return trace

    before = sys.gettrace()
    sys.settrace(trace)
    try:
        yield
    finally:
        sys.settrace(before)


@pytest.mark.parametrize("engine", ["pinocchio", "mujoco", "drake", "dart"])
def test_reading_is_linear(engine: str, tmp_path: Path) -> None:
    """Twice the links take about twice the steps."""
    reading = importlib.import_module(f"{OURS}.{engine}.reading")
    counts = []
    # The first reading is not one of them: since Python 3.12 the instructions of a function are traced from its second call on.
    for links in (LINKS, LINKS, 2 * LINKS, 4 * LINKS):
        file = tmp_path / f"{links}.urdf"
        file.write_text(tree(links, links))
        steps = [0]
        with counted(steps):
            reading.read(file, "urdf", "fixed", lambda *_: None)
        counts.append(steps[0] / links)
    counts = counts[1:]
    assert counts[0] > 100, "the steps are those of our modules"
    assert max(counts[1] / counts[0], counts[2] / counts[1]) < GROWTH / 2, counts


class Compared(str):
    """A name that counts how often it is compared, which the instructions of the interpreter do not show."""

    __slots__ = ()
    times = 0

    def __eq__(self, other: object) -> bool:
        """Compare as text."""
        Compared.times += 1
        return str.__eq__(self, other)

    __hash__ = str.__hash__


@pytest.mark.parametrize("seed", range(20))
def test_roots_are_found_without_comparing_each_name_with_each(seed: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The names of drawn trees, several of them in one file, are looked up; the roots are those that nothing carries."""
    random = np.random.default_rng(seed)
    links, trees = int(random.integers(100, 400)), int(random.integers(1, 5))
    names = [str(name) for name in random.permutation(links)]
    rows = {"link": [("name", name) for name in names], "child": [("link", name) for name in names[trees:]]}
    monkeypatch.setattr(files, "elements", lambda _, tag: [ElementTree.Element(tag, {key: Compared(name)}) for key, name in rows[tag]])
    monkeypatch.setattr(Compared, "times", 0)
    assert files.roots(tmp_path) == names[:trees]
    assert Compared.times <= 2 * links, Compared.times
