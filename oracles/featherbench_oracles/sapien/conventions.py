"""The conventions of SAPIEN. Each row of conventions.toml has a function of its name here, which yields claims."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import sapien
import sapien.physx as physx

from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.conventions import AXIS, COM, GRAVITY, MASS, MOMENTS, SINGLE, WRONG_R, WXYZ, Claims, R, about, claim
from featherbench_oracles.core.reading import turned

TURN = about(AXIS, 0.8)
FILE = """<robot name="r"><link name="a"/><link name="b">{shape}</link>
<joint name="j" type="continuous"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/></joint></robot>"""
BOX = '<collision><geometry><box size="1 2 3"/></geometry></collision>'


def scene(gravity: Array) -> sapien.Scene:
    """Make a scene after its gravity is set."""
    physx.set_scene_config(gravity=gravity.astype(np.float32))
    return sapien.Scene([physx.PhysxCpuSystem()])


def one(kind: str, place: Array) -> tuple[sapien.Scene, Any]:
    """Make one body on a joint, at a turned frame."""
    world = scene(GRAVITY)
    builder = world.create_articulation_builder()
    base = builder.create_link_builder(None)
    base.set_mass_and_inertia(1.0, sapien.Pose(), np.ones(3))
    base.set_joint_properties("fixed", [], sapien.Pose(), sapien.Pose())
    link = builder.create_link_builder(base)
    moments, axes = np.linalg.eigh(MOMENTS)
    axes[:, 0] *= np.linalg.det(axes)
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = axes, COM
    link.set_mass_and_inertia(MASS, sapien.Pose(matrix), moments)
    at = np.eye(4)
    at[:3, :3] = place
    link.set_joint_properties(kind, [[-np.inf, np.inf]], sapien.Pose(at), sapien.Pose(), 0.0, 0.0)
    return world, builder.build()


def held(shape: str) -> float:
    """Load a link without an inertial: its mass."""
    world = scene(GRAVITY)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "r.urdf"
        path.write_text(FILE.format(shape=shape), encoding="utf-8")
        made = world.create_urdf_loader().load_file_as_articulation_builder(str(path)).build()
    return float(made.find_link_by_name("b").mass)


def sapien_axis() -> Claims:
    """A hinge turns about, and a slide moves along, the x axis of its frame."""
    world, made = one("prismatic", TURN)
    found = made.compute_passive_force(gravity=True, coriolis_and_centrifugal=True)
    yield claim(found, [-MASS * GRAVITY @ TURN[:, 0]], [-MASS * GRAVITY @ TURN[0]], [-MASS * GRAVITY @ TURN[:, 2]], close=SINGLE)
    del world


def sapien_gravity() -> Claims:
    """The acceleration of free fall, of the scenes that are made afterwards."""
    world, made = one("prismatic", TURN)
    physx.set_scene_config(gravity=np.zeros(3, dtype=np.float32))
    found = made.compute_passive_force(gravity=True, coriolis_and_centrifugal=True)
    yield claim(found, [-MASS * GRAVITY @ TURN[:, 0]], [MASS * GRAVITY @ TURN[:, 0]], [0.0], close=SINGLE)
    del world


def sapien_inertia() -> Claims:
    """Moments about principal axes, whose pose in the link has the centre of mass."""
    world, made = one("revolute_unwrapped", np.eye(3))
    mass = made.create_pinocchio_model().compute_generalized_mass_matrix(np.zeros(1, dtype=np.float32))
    about_x = MOMENTS[0, 0] + MASS * (COM[1] ** 2 + COM[2] ** 2)
    yield claim(np.ravel(mass), [about_x], [MOMENTS[0, 0]], close=SINGLE)
    del world


def sapien_quaternion() -> Claims:
    """A pose has its quaternion as (w, x, y, z)."""
    pose = sapien.Pose(q=WXYZ / np.linalg.norm(WXYZ))
    yield claim(pose.to_transformation_matrix()[:3, :3], R, WRONG_R, close=SINGLE)
    yield claim(turned(*np.array(pose.q, dtype=float)), R, WRONG_R, close=SINGLE)


def sapien_massless() -> Claims:
    """A link without an inertial has 10⁻⁶ kg, or the mass of its shapes with 1000 kg/m³."""
    yield claim([1e6 * held("")], [1.0], [0.0], close=SINGLE)
    yield claim([1e-3 * held(BOX)], [6.0], [0.0], close=SINGLE)


def sapien_precision() -> Claims:
    """What an articulation tells is in single precision."""
    world, made = one("prismatic", TURN)
    yield claim([made.qpos.dtype.itemsize], [4], [8])
    del world
