"""The import: each engine holds what small files say, or the known edit.

For every file that an engine reads, a robot is built by `prepare` from the description that the engine told. Its M and inverse dynamics are
compared with those of the imported robot. So the description is what the engine computes with.
"""

from __future__ import annotations

import os
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import ArrayLike

from featherbench_oracles.algebra import Array
from featherbench_oracles.messages import Header
from featherbench_oracles.reading import overheard, turned
from featherbench_oracles.robot import Description
from featherbench_oracles.testing.client import Oracle
from featherbench_oracles.testing.described import ENGINES
from featherbench_oracles.testing.draws import COUNT, random_states
from featherbench_oracles.testing.measures import EXACT, ratio, within

from . import files
from .conftest import Oracles
from .files import ARM, GIVEN, TURN, about
from .test_session import status_of

REPLAY = within(1e-13)  # unit-free; these robots are shallow, and M's terms are of the size of its diagonal
DIGITS = 1e-15  # relative error of reading a decimal, and of one rotation by it
REPEATED = 1e-16  # relative error of a number that is told twice
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
        header = {"op": "import", "file": str(path), "format": "mjcf" if name.endswith(".xml") else "urdf", "base": base}
        answer, blocks = oracle.must(header)
        if replay:
            self._replay(oracle, answer)
        return Read(answer, blocks.get("keyframes"))

    def _replay(self, oracle: Oracle, answer: Header) -> None:
        """Compare M, ID and h of the imported robot with those of the description, by the same engine or else by Pinocchio."""
        robot = Description.read(answer["model"])
        states = random_states(np.random.default_rng(3), robot)
        quantities = ("mass_matrix", "id", "bias")
        held = [oracle.at(states, quantity, oracle.methods()[quantity][0]) for quantity in quantities]
        prepare = {"op": "prepare", "model": answer["model"]}
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


@pytest.fixture
def readers(oracles: Oracles, tmp_path: Path) -> Readers:
    """Provide the oracles, and a folder for files."""
    return Readers(oracles, tmp_path)


def same(value: ArrayLike, due: ArrayLike, tolerance: float = DIGITS) -> bool:
    """Whether two arrays agree, relative to the largest number or to one."""
    x, y = np.asarray(value, dtype=float), np.asarray(due, dtype=float)
    return x.shape == y.shape and bool(np.abs(x - y).max() / max(1.0, float(np.abs(y).max())) <= within(tolerance))


of_every_engine = pytest.mark.parametrize("engine", ENGINES)
of_three_engines = pytest.mark.parametrize("engine", THREE_ENGINES)


# ---- a URDF with a fixed link in the middle, a rotated inertial, a mimic joint, damping and limits


@pytest.fixture
def arm(readers: Readers, engine: str) -> Read:
    """Have the engine read the arm."""
    return readers.read(engine, "arm.urdf", ARM)


@of_every_engine
def test_arm_bodies(arm: Read) -> None:
    """The bodies of the arm come depth-first."""
    assert sorted(arm.names()) == ["finger", "slider", "upper", "wheel"]
    assert arm.names()[:2] == ["upper", "slider"]


@of_every_engine
def test_arm_joint(arm: Read, engine: str) -> None:
    """A joint has the file's placement, axis, damping and friction; Drake holds no friction."""
    joint = arm.body("upper")["joint"]
    assert same(placed(joint), [*TURN.ravel(), 0.1, 0.2, 0.3])
    assert same(joint["axis"], [0, 1, 0])
    assert same(arm.body("slider")["joint"]["axis"], [0.6, 0, 0.8])
    assert same(joint["damping"], [0.7])
    assert same(joint["friction"], [0.0 if engine == "drake" else 0.2])


@of_every_engine
def test_arm_limits(arm: Read, engine: str) -> None:
    """Limits are the file's. MuJoCo holds no velocity limits; Drake holds those of continuous joints, and effort limits of actuators."""
    joint = arm.body("upper")["joint"]
    assert same([*joint["lower"], *joint["upper"]], [-1, 2])
    assert joint.get("velocity") == (None if engine == "mujoco" else [3.0])
    assert joint.get("effort") == (None if engine == "drake" else [40.0])
    limited = {"lower", "upper"} & set(arm.body("wheel")["joint"])
    assert bool(limited) == (engine == "drake")


@of_every_engine
def test_arm_merged_inertia(arm: Read, engine: str) -> None:
    """A fixed link is merged into its parent. An inertia that is not merged keeps its digits, but Drake recomputes it."""
    upper = arm.body("upper")
    tilt = about(2, 0.6) @ about(1, 0.5) @ about(0, 0.4)
    c1, c2 = np.array([0.1, 0.2, 0.3]), TURN @ [0.1, 0.2, 0.3] + [0.1, 0.2, 0.3]
    com = (1.5 * c1 + 0.5 * c2) / 2

    def moved(mass: float, inertia: Array, c: Array) -> Array:
        shifted: Array = inertia + mass * ((c - com) @ (c - com) * np.eye(3) - np.outer(c - com, c - com))
        return shifted

    merged = moved(1.5, tilt @ GIVEN @ tilt.T, c1) + moved(0.5, TURN @ GIVEN @ TURN.T, c2)
    assert same(upper["mass"], 2.0)
    assert same(upper["com"], com)
    assert same(upper["inertia"], merged[np.triu_indices(3)])
    exact = arm.body("wheel")["inertia"] == GIVEN[np.triu_indices(3)].tolist()
    assert exact or engine == "drake"


@of_every_engine
def test_arm_frames(arm: Read) -> None:
    """A fixed link leaves a frame on the body that it was merged into; the root link leaves one on the world."""
    body, place = arm.frame("flange")
    assert body == arm.names().index("upper")
    assert same(place, [*TURN.ravel(), 0.1, 0.2, 0.3])
    assert arm.frame("stand")[0] == -1


@of_every_engine
def test_arm_mimic_is_told(arm: Read) -> None:
    """A joint that mimics another is told."""
    assert "mimic" in arm.causes()


@of_every_engine
def test_arm_with_a_free_base(arm: Read, readers: Readers, engine: str) -> None:
    """With a free base the root floats, and the rest is the same."""
    free = readers.read(engine, "arm.urdf", ARM, "free")
    assert free.body("stand")["joint"]["type"] == "free"
    assert free.names()[1:] == arm.names()


# ---- edits


@of_three_engines
def test_link_without_mass(readers: Readers, engine: str) -> None:
    """A link without mass has none. MuJoCo gives it the bound, and a note says so."""
    read = readers.read(engine, "light.urdf", files.LIGHT, replay=engine == "mujoco")
    assert same(read.body("empty")["mass"], {"pinocchio": 0.0, "mujoco": 1e-6, "drake": 0.0}[engine])
    assert ({"bounds", "mass_edited"} <= read.causes()) == (engine == "mujoco")


@of_three_engines
def test_unphysical_inertia(readers: Readers, engine: str) -> None:
    """Pinocchio keeps an unphysical inertia, MuJoCo balances it, and Drake takes that of a ball as dense as water. A note says so."""
    read = readers.read(engine, "flat.urdf", files.FLAT)
    sphere = 0.4 * 2 * (3 * 2 / (4 * np.pi * 1000)) ** (2 / 3)  # of the link's mass
    moments = {"pinocchio": [0.01, 0.01, 0.05], "mujoco": [0.07 / 3] * 3, "drake": [sphere] * 3}[engine]
    assert same(np.array(read.body("plate")["inertia"])[[0, 3, 5]], moments)
    assert ("inertia_edited" in read.causes()) == (engine != "pinocchio")
    assert ("balanceinertia" in read.causes()) == (engine == "mujoco")


@of_three_engines
def test_no_mesh_is_needed(readers: Readers, engine: str) -> None:
    """A file whose mesh cannot be found is read."""
    assert readers.read(engine, "mesh.urdf", files.MESH).names() == ["arm"]


# ---- bases and joints


@of_three_engines
def test_root_called_world(readers: Readers, engine: str) -> None:
    """A root called world is the world. With a free base only Pinocchio sets it free, and notes of the others say so."""
    assert readers.read(engine, "world.urdf", files.WORLD).names() == ["arm"]
    free = readers.read(engine, "world.urdf", files.WORLD, "free", replay=engine != "pinocchio")
    assert free.names() == (["world", "arm"] if engine == "pinocchio" else ["arm"])
    assert ("root_welded" in free.causes()) == (engine != "pinocchio")


@of_three_engines
def test_planar_joint(readers: Readers, engine: str) -> None:
    """A planar joint is three joints in MuJoCo; its placement is that of the file."""
    plane = readers.read(engine, "plane.urdf", files.PLANE)
    types = [body["joint"]["type"] for body in plane.bodies]
    assert types == (["prismatic", "prismatic", "revolute"] if engine == "mujoco" else ["planar"])
    assert same(placed(plane.bodies[0]["joint"]), [*TURN.ravel(), 0.1, 0.2, 0.3])


@of_three_engines
def test_normal_of_a_planar_joint(readers: Readers, engine: str) -> None:
    """The plane's normal is the file's axis in Drake, and always z in Pinocchio. MuJoCo's last joint turns about the axis."""
    place = np.reshape(readers.read(engine, "steep.urdf", files.STEEP).bodies[-1]["joint"]["placement"]["rotation"], (3, 3))
    if engine != "mujoco":
        assert same(place[:, 2], TURN[:, 0 if engine == "drake" else 2])


@of_three_engines
def test_floating_joint(readers: Readers, engine: str) -> None:
    """A floating joint is free. Its coordinates are relative to its placement in Pinocchio, and to the world in the others."""
    joint = readers.read(engine, "float.urdf", files.FLOATING).body("bird")["joint"]
    assert joint["type"] == "free"
    assert same(joint["placement"]["translation"], [0.1, 0.2, 0.3] if engine == "pinocchio" else [0, 0, 0])


@pytest.mark.parametrize("engine", [engine for engine in ENGINES if engine != "mujoco"])  # MuJoCo rejects such a joint
def test_floating_joint_below_another(readers: Readers, engine: str) -> None:
    """A floating joint below a planar one whose plane is not z. DART's velocities are in its own body's axes."""
    assert readers.read(engine, "sled.urdf", files.SLED).names() == ["sled", "bird"]


@of_every_engine
def test_revolute_joint_without_limits(readers: Readers, engine: str) -> None:
    """An engine that rejects a revolute joint without limits names the joint and the reason, without a path of its own sources."""
    path = readers.file("limitless.urdf", re.sub("<limit[^>]*>", "", files.WORLD.replace("continuous", "revolute")))
    answer, _ = readers.oracles[engine].ask({"op": "import", "file": str(path), "format": "urdf", "base": "fixed"})
    refuses = engine in ("pinocchio", "dart")
    assert answer["status"] == ("error" if refuses else "ok")
    if refuses:
        assert "Joint [hinge] is of type REVOLUTE but it does not specify limits" in answer["reason"]
        assert ".cpp" not in answer["reason"]


# ---- MJCF


@of_three_engines
def test_three_joints_in_a_body(readers: Readers, engine: str) -> None:
    """Three joints in a body are a chain, in which only hinges have anchors. Pinocchio shifts a hinge's limits by `ref`."""
    read = readers.read(engine, "three.xml", files.THREE)
    assert read.names() == ["car/x", "car/y", "car", "mast"]
    places = [body["joint"]["placement"]["translation"] for body in read.bodies]
    assert same(places, np.array([[0, 0, 0], [0, 0, 0], [0.5, 0, 0], [-0.5, 0, 1]]))
    joint = read.body("mast")["joint"]
    assert same(joint["placement"]["rotation"], about(1, -0.3).ravel())
    shift = 0.3 if engine == "pinocchio" else 0.0
    assert same([*joint["lower"], *joint["upper"]], [-1 - shift, 1 - shift])


@pytest.fixture
def toy_text(engine: str) -> str:
    """Write an MJCF with several joints in a body, anchors, a class of defaults, a `ref` and gravity."""
    text = files.MJCF.format(more="", key="")
    # Pinocchio ends the process at a keyframe of another size than it expects.
    return text.replace("qpos=", "ctrl=") if engine == "pinocchio" else text


@pytest.fixture
def toy(readers: Readers, engine: str, toy_text: str) -> Read:
    """Have the engine read it."""
    return readers.read(engine, "toy.xml", toy_text)


@of_three_engines
def test_mjcf_chain(toy: Read) -> None:
    """A body with two joints is a chain of two bodies."""
    assert toy.names() == ["arm/pan", "arm", "ball", "rod"]
    parts = [toy.body(name) for name in ("arm/pan", "arm", "ball", "rod")]
    assert [body["parent"] for body in parts] == [-1, 0, 1, 1]
    assert [body["joint"]["name"] for body in parts] == ["pan", "tilt", "socket", "push"]
    assert [body["joint"]["type"] for body in parts] == ["revolute", "revolute", "spherical", "prismatic"]


@of_three_engines
def test_mjcf_gravity(toy: Read, engine: str) -> None:
    """Pinocchio ignores the gravity of the file, and a note says so."""
    assert same(toy.header["model"]["gravity"], [0, 0, -9.81] if engine == "pinocchio" else [0, 1, -5])
    assert ("gravity_ignored" in toy.causes()) == (engine == "pinocchio")


POST = {"pinocchio": np.zeros(3)}  # Pinocchio loses the pose of a body that is fixed to the world
OWN = np.array([0.1, 0.2, 0.3])
QUARTER = turned(0.6, 0, 0, 0.8)


@of_three_engines
def test_mjcf_placements(toy: Read, engine: str) -> None:
    """Joints are at their anchors. Drake puts the body's pose behind its first joint."""
    post = POST.get(engine, np.array([0, 0, 1]))
    first = np.append(QUARTER.ravel(), post + OWN + QUARTER @ [0.5, 0, 0])
    second = np.append(np.eye(3).ravel(), [-0.5, 0.25, 0])
    if engine == "drake":
        first = np.array([*np.eye(3).ravel(), 0.5, 0, 1])
        second = np.append(QUARTER.ravel(), OWN + QUARTER @ [0, 0.25, 0] - [0.5, 0, 0])
    assert same(placed(toy.body("arm/pan")["joint"]), first)
    assert same(placed(toy.body("arm")["joint"]), second)
    assert same(toy.body("ball")["joint"]["placement"]["translation"], [1, -0.25, 0.4])


@of_three_engines
def test_mjcf_slide_with_ref(toy: Read) -> None:
    """A slide is at its place in the file when its coordinate is `ref`."""
    assert same(toy.body("rod")["joint"]["placement"]["translation"], [-0.5, 0.75, 0])


@of_three_engines
def test_mjcf_joints(toy: Read, engine: str) -> None:
    """Axes, limits, and the armature and damping of a class are the file's; Drake holds no friction."""
    pan, arm, rod = (toy.body(name)["joint"] for name in ("arm/pan", "arm", "rod"))
    assert same([*pan["axis"], *arm["axis"], *rod["axis"]], [0, 0, 1, 0, 1, 0, 1, 0, 0])
    assert same([*pan["armature"], *pan["damping"]], [0.25, 0.7])
    assert same([*pan["lower"], *pan["upper"]], [-1, 2])
    assert same(arm["friction"], [0.0 if engine == "drake" else 0.2])


@of_three_engines
def test_mjcf_inertias(toy: Read) -> None:
    """A fixed body is merged into its parent. Without an inertial, the inertia is computed from geometry."""
    com = (1.5 * OWN + 0.5 * np.array([0, 0, 0.5])) / 2 - [0, 0.25, 0]
    assert same([toy.body("arm")["mass"], *toy.body("arm")["com"]], [2, *com])
    assert same([toy.body("rod")["mass"], *toy.body("rod")["inertia"]], [2, 0.008, 0, 0, 0.008, 0, 0.008])


@of_three_engines
@pytest.mark.parametrize("name", ["post", "arm", "cup"])
def test_mjcf_frames(toy: Read, engine: str, name: str) -> None:
    """Bodies of the file that are not in the description leave frames."""
    post: ArrayLike = POST.get(engine, np.array([0, 0, 1]))
    homes: dict[str, tuple[int, ArrayLike]] = {"post": (-1, post), "arm": (1, [0, -0.25, 0]), "cup": (1, [0, -0.25, 0.4])}
    home, origin = homes[name]
    body, place = toy.frame(name)
    assert body == home
    assert same(place, np.append(np.eye(3), origin))


@of_three_engines
def test_mjcf_motor(toy: Read, readers: Readers, engine: str, toy_text: str) -> None:
    """A motor is not compared, and a note says so. Without it Drake drops the joint's armature."""
    assert "not_compared" in toy.causes()
    idle = readers.read(engine, "idle.xml", toy_text.replace('<motor joint="pan"/>', "")).body("arm/pan")["joint"]
    assert same(idle["armature"], [0.0 if engine == "drake" else 0.25])


@of_three_engines
def test_armature_of_a_free_joint(readers: Readers, engine: str) -> None:
    """The armature that a class gives to a free joint is noted, and taken out of the comparison. Drake drops it."""
    read = readers.read(engine, "dragged.xml", files.DRAGGED)
    told = [note["numbers"] for note in read.header["notes"] if note["cause"] == "free_armature" and note["about"] == "root"]
    assert told == ([] if engine == "drake" else [[0.25] * 6])
    assert same(read.body("base")["joint"]["armature"], [0.0] * 6)
    assert same(read.body("arm")["joint"]["armature"], [0.25])


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


# ---- files that no engine reads

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
    "of an unknown format": ("world.sdf", files.WORLD),
}
FORMATS = {"xml": "mjcf", "urdf": "urdf", "sdf": "sdf"}


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
