"""The import of MJCF: each engine holds what small files say, or the known edit."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import ArrayLike

from . import files
from .files import about
from .readers import QUARTER, Read, Readers, of_three_engines, placed, same


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
