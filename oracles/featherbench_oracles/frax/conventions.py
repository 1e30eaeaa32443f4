"""The conventions of frax. Each row of conventions.toml has a function of its name here, which yields claims."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

import frax.core.robot
import jax
import jax.numpy as jnp
import numpy as np

from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.conventions import ABOUT_ORIGIN, AXIS, COM, GRAVITY, MASS, MOMENTS, Claims, about, claim

jax.config.update("jax_enable_x64", True)
FILE = """<robot name="r">{root}<link name="b"><inertial><origin xyz="{com}"/><mass value="{mass}"/>
<inertia ixx="{xx}" ixy="{xy}" ixz="{xz}" iyy="{yy}" iyz="{yz}" izz="{zz}"/></inertial></link>
<joint name="j" type="{kind}"><origin rpy="0.3 -0.4 0.5"/><parent link="a"/><child link="b"/><axis xyz="{axis}"/>
<limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>"""
ROOT = """<link name="a"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>"""


def turn() -> Array:
    """Make the rotation of the joint's frame: about x, then about y, then about z, axes that stay."""
    x, y, z = np.eye(3)
    return about(z, 0.5) @ about(y, -0.4) @ about(x, 0.3)


def one(kind: str) -> Any:
    """Make one body on a joint."""
    six = dict(zip(("xx", "xy", "xz", "yy", "yz", "zz"), MOMENTS[np.triu_indices(3)], strict=True))
    words = {"com": " ".join(map(str, COM)), "mass": MASS, "axis": " ".join(map(str, AXIS)), "kind": kind, "root": ROOT}
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "r.urdf"
        path.write_text(FILE.format(**six, **words), encoding="utf-8")
        return frax.core.robot.Robot(str(path))


def frax_axis() -> Claims:
    """In the joint's frame, whose matrix takes its axes to the parent's."""
    up = jnp.array(np.append(-GRAVITY, np.zeros(3)))
    found = one("prismatic").rnea(jnp.zeros(1), jnp.zeros(1), None, up, None)
    yield claim(found, [-MASS * GRAVITY @ turn() @ AXIS], [-MASS * GRAVITY @ AXIS], [-MASS * GRAVITY @ turn().T @ AXIS])


def frax_gravity() -> Claims:
    """Its rnea takes the acceleration that holds the robot, [linear; angular]. Its bias takes none: it has −9.81 along z."""
    made, zero = one("prismatic"), jnp.zeros(1)
    weight = MASS * (turn() @ AXIS)[2]
    yield claim(made.nonlinear_bias(zero, zero), [9.81 * weight], [-9.81 * weight])
    up = jnp.array([0.0, 0.0, 3.7, 0.0, 0.0, 0.0])
    yield claim(made.rnea(zero, zero, None, up, None), [3.7 * weight], [-3.7 * weight], [9.81 * weight])


def frax_inertia() -> Claims:
    """About the centre of mass."""
    found = one("revolute").crba(jnp.zeros(1))
    yield claim(np.ravel(found), [AXIS @ ABOUT_ORIGIN @ AXIS], [AXIS @ MOMENTS @ AXIS])


def frax_frames() -> Claims:
    """The transforms of links are of their inertial frames, those of joints of the links' origins."""
    made = one("revolute")
    yield claim(made.link_to_world_transforms(jnp.zeros(1))[0, :3, 3], turn() @ COM, np.zeros(3))
    yield claim(made.joint_to_world_transforms(jnp.zeros(1))[0, :3, 3] + 1.0, np.ones(3), 1.0 + turn() @ COM)
