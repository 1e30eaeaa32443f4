"""The import by single engines: messages that become notes, and what MuJoCo and DART alone tell."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

from featherbench_oracles.core.messages import Header
from featherbench_oracles.core.reading import overheard
from featherbench_oracles.core.robot import Description
from featherbench_oracles.testing.draws import random_states
from featherbench_oracles.testing.measures import EXACT, ratio, within

from . import files
from .files import ARM
from .readers import QUARTER, REPEATED, Readers, same
from .test_session import status_of

# ---- messages


def test_mujoco_warnings_are_notes(readers: Readers) -> None:
    """MuJoCo's messages about a NaN are notes, and it writes no log file."""
    log = Path("MUJOCO_LOG.TXT")
    before = log.exists()
    odd = files.MJCF.format(more="", key="").replace("<option ", '<option timestep="nan" ')
    read = readers.read("mujoco", "odd.xml", odd, replay=False)
    assert any("NaN" in note["text"] for note in read.header["notes"] if note["cause"] == "warning")
    assert log.exists() == before


def test_drake_warnings_are_notes(readers: Readers) -> None:
    """Drake's messages about friction are notes, without the folder of the file."""
    read = readers.read("drake", "arm.urdf", ARM)
    warned = [note["text"] for note in read.header["notes"] if note["cause"] == "warning"]
    assert any("friction" in text and str(readers.folder) not in text for text in warned)


def test_colours_are_left_out(tmp_path: Path) -> None:
    """Notes of an engine that prints in colours have no escape sequences of the terminal."""
    notes: list[Header] = []
    with overheard(tmp_path / "a.urdf", notes):
        os.write(2, f"\x1b[1;33mWarning\x1b[0m: in {tmp_path}/a.urdf\n".encode())
    assert [note["text"] for note in notes] == ["Warning: in a.urdf"]


# ---- MuJoCo alone


def test_mujoco_tells_repairs(readers: Readers) -> None:
    """For an MJCF that MuJoCo rejects as written, the answer has the file's own inertias beside the repaired ones."""
    read = readers.read("mujoco", "refused.xml", files.REFUSED)
    written = {body["name"]: body for body in read.header["written"]["bodies"]}
    given = (QUARTER * [0.01, 0.02, 0.05]) @ QUARTER.T
    assert same(written["flat"]["inertia"], given[np.triu_indices(3)], REPEATED)
    assert same(np.array(read.body("flat")["inertia"])[[0, 3, 5]], [0.08 / 3] * 3)
    assert written["empty"]["mass"] == 0
    assert not any(written["empty"]["inertia"])
    assert same(read.body("empty")["mass"], 1e-6)
    numbers = next(note["numbers"] for note in read.header["notes"] if note["cause"] == "inertia_edited")
    assert same(numbers[4:10], given[np.triu_indices(3)], REPEATED)
    assert same(numbers[14:], read.body("flat")["inertia"], REPEATED)


def test_mujoco_tells_no_repair_where_there_is_none(readers: Readers) -> None:
    """A file that MuJoCo accepts was not repaired."""
    assert "written" not in readers.read("mujoco", "three.xml", files.THREE).header


def test_mujoco_reads_includes_and_keyframes(readers: Readers) -> None:
    """An included body is read. Its coordinates are relative to the world, and the quaternions of a keyframe end with w."""
    readers.file("loose.xml", f"<mujoco>{files.LOOSE}</mujoco>")
    read = readers.read("mujoco", "toy.xml", files.MJCF.format(more='<include file="loose.xml"/>', key="1 2 3 0 0 1 0"))
    assert read.names()[-1] == "loose"
    assert read.body("loose")["joint"]["type"] == "free"
    assert same(read.body("loose")["joint"]["placement"]["translation"], [0, 0, 0])
    assert read.header["keyframes"] == ["home"]
    assert read.keyframes is not None
    assert same(read.keyframes, [[0.1, 0.2, 0, 0, 0, 1, 0.5, 1, 2, 3, 0, 1, 0, 0]])


def test_mujoco_tells_a_moved_centre_of_mass(readers: Readers) -> None:
    """MuJoCo takes a centre of mass within 1e-6 of the origin for the origin, and a note says so."""
    near = files.MJCF.format(more="", key="").replace('pos=".1 0 0" mass="1"', 'pos="5e-7 0 0" mass="1"')
    read = readers.read("mujoco", "near.xml", near)
    assert read.body("ball")["com"] == [0, 0, 0]
    assert "com_edited" in read.causes()


# ---- DART alone


@pytest.mark.parametrize("base", ["fixed", "free"])
def test_dart_computes_with_what_it_tells(readers: Readers, base: str) -> None:
    """The robot built from the description gives the answers of the imported one, without damping and mimic joints."""
    dart = readers.oracles["dart"]
    read = readers.read("dart", "toy.urdf", files.TOY, base, replay=False)
    robot = Description.read(read.header["model"])
    states = random_states(np.random.default_rng(4), robot)
    quantities = (("mass_matrix", "mass_matrix"), ("id", "inverse_dynamics"), ("fd", "aba"), ("kinetic_energy", "kinetic_energy"))
    held = [dart.at(states, *quantity) for quantity in quantities]
    dart.must({"op": "prepare", "model": read.header["model"]})
    for quantity, value in zip(quantities, held, strict=True):
        built = dart.at(states, *quantity)
        assert ratio(value - built, built) <= EXACT, quantity


@pytest.mark.parametrize("base", ["fixed", "free"])
def test_dart_notes(readers: Readers, base: str) -> None:
    """A link without an inertial has 1 kg in DART. Notes tell this and mimic joints. Damping is the file's."""
    read = readers.read("dart", "toy.urdf", files.TOY, base, replay=False)
    names = [body["joint"]["name"] for body in read.bodies]
    assert names[-2:] == ["hinge", "slide"]
    assert len(names) == 2 + (base == "free")
    causes = {(note["cause"], note["about"]) for note in read.header["notes"]}
    assert {("mimic", "slide"), ("mass_edited", "stand"), ("mass_edited", "empty")} <= causes
    assert read.bodies[-1]["mass"] == 1.0
    assert abs(read.bodies[-2]["joint"]["damping"][0] - 0.7) <= within(REPEATED)


def test_dart_does_not_offer_two_robots(readers: Readers) -> None:
    """A file of two robots is unsupported, also if DART's collision detector prints messages about capsules."""
    capsule = '<geom type="capsule" size=".1" fromto="0 0 0 0 0 1"/>'
    two = "".join(f'<body name="{name}"><joint name="{name}" axis="0 1 0"/>{capsule}</body>' for name in "ab")
    path = readers.file("two.xml", f"<mujoco><worldbody>{two}</worldbody></mujoco>")
    answer = readers.oracles["dart"].ask({"op": "import", "format": "mjcf", "base": "fixed", "file": str(path)})
    assert status_of(answer) == "unsupported"
