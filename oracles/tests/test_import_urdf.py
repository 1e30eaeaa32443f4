"""The import of URDF: each engine holds what small files say, or the known edit."""

from __future__ import annotations

import re

import numpy as np
import pytest

from featherbench_oracles.core.algebra import Array
from featherbench_oracles.testing.described import ENGINES

from . import files
from .files import ARM, GIVEN, TURN, about
from .readers import Read, Readers, of_every_engine, of_three_engines, placed, same

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
    assert {"mimic", "mimic_dropped"} & arm.causes()


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
