"""What adam reads, a robot as URDF. Its generated code is tested by `crates/cli/tests/outside/adam.rs`, where it is installed."""

from __future__ import annotations

import math
from xml.etree import ElementTree

import numpy as np
import pytest

from featherbench_oracles.adam.coordinates import base_transform
from featherbench_oracles.adam.urdf import roll_pitch_yaw, text
from featherbench_oracles.core.algebra import Array, rotation
from featherbench_oracles.core.protocol import Unsupported
from featherbench_oracles.core.robot import Description
from featherbench_oracles.testing.draws import random_robot, without_armature


def about(axis: int, angle: float) -> Array:
    """Compute the rotation about a coordinate axis, by its quaternion."""
    quaternion = np.zeros(4)
    quaternion[axis], quaternion[3] = math.sin(angle / 2), math.cos(angle / 2)
    return rotation(quaternion)


@pytest.mark.parametrize("pitch", [0.0, 0.3, -1.2, math.pi / 2, -math.pi / 2, math.pi / 2 - 1e-9])
def test_angles_give_the_rotation(pitch: float) -> None:
    """Rz(yaw) Ry(pitch) Rx(roll) is the rotation again, also where the pitch is 90°: three products of rounded matrices lose some ulps."""
    for roll, yaw in [(0.4, -2.0), (-3.0, 1.0)]:
        wanted = about(2, yaw) @ about(1, pitch) @ about(0, roll)
        x, y, z = roll_pitch_yaw(wanted)
        assert np.abs(about(2, z) @ about(1, y) @ about(0, x) - wanted).max() < 2e-15


def test_numbers_are_written_to_the_bit() -> None:
    """Masses, centres and axes are read back as they were."""
    robot = Description.read(without_armature(random_robot(np.random.default_rng(3), "arm", ["revolute"] * 4)))
    root = ElementTree.fromstring(text(robot))
    links, joints = root.findall("link")[1:], root.findall("joint")

    def numbers(element: ElementTree.Element, path: str, key: str) -> list[float]:
        found = element.find(path)
        assert found is not None
        return [float(word) for word in found.attrib[key].split()]

    for body, link, joint in zip(robot.bodies, links, joints, strict=True):
        assert numbers(link, "inertial/mass", "value") == [body.mass]
        assert numbers(link, "inertial/origin", "xyz") == list(body.com)
        assert numbers(joint, "axis", "xyz") == list(body.joint.axis)


def test_the_base_is_where_the_free_joint_puts_it() -> None:
    """H takes a point of the body to the world: placement, then displacement and turn."""
    robot = Description.read(without_armature(random_robot(np.random.default_rng(4), "free", ["free", "revolute"])))
    q = np.random.default_rng(5).normal(size=robot.nq)
    joint, point = robot.bodies[0].joint, np.array([0.3, -0.2, 0.7])
    wanted = joint.translation + joint.rotation @ (q[:3] + rotation(q[3:7]) @ point)
    found = base_transform(robot, q) @ np.append(point, 1)
    assert np.abs(found - np.append(wanted, 1)).max() < 1e-14  # numbers of size 3, some ulps


@pytest.mark.parametrize(
    ("joints", "plain", "word"),
    [
        (["revolute", "revolute"], False, "armature"),
        (["prismatic"], True, "twelve rows"),
        (["spherical"], True, "no spherical joint"),
        (["revolute", "free"], True, "floating base is the root"),
    ],
)
def test_what_adam_has_not_is_refused(joints: list[str], plain: bool, word: str) -> None:
    """Each is answered by the name of what is missing."""
    model = random_robot(np.random.default_rng(6), "robot", joints)
    with pytest.raises(Unsupported, match=word):
        text(Description.read(without_armature(model) if plain else model))
