"""The conventions of PyBullet. Each row of conventions.toml has a function of its name here, which yields claims."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np
import pybullet as pb

from featherbench_oracles.core.algebra import quaternion, rotation
from featherbench_oracles.core.conventions import AXIS, COM, GRAVITY, MASS, MOMENTS, Claims, about, claim
from featherbench_oracles.core.reading import inertial
from featherbench_oracles.pybullet.building import principal

FILE = """<robot name="r"><link name="a"/><link name="b">{inertial}<collision><geometry><box size="1 2 3"/></geometry></collision></link>
<joint name="j" type="continuous"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/></joint></robot>"""
SAID = '<inertial><mass value="2"/><inertia ixx="0.3" ixy="0" ixz="0" iyy="0.4" iyz="0" izz="0.5"/></inertial>'
TURN = about(AXIS, 0.8)


def loaded(said: str, flags: int = 0) -> list[float]:
    """Load a link, and list mass, centre of mass and inertia."""
    client = pb.connect(pb.DIRECT)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "r.urdf"
        path.write_text(FILE.format(inertial=said), encoding="utf-8")
        made = pb.loadURDF(str(path), useFixedBase=True, flags=flags, physicsClientId=client)
    mass, _, moments, com, axes, *_ = pb.getDynamicsInfo(made, 0, physicsClientId=client)
    pb.disconnect(client)
    turn = rotation(np.array(axes))
    return inertial(mass, np.array(com), (turn * moments) @ turn.T)


def chain(kinds: list[int], parents: list[int]) -> tuple[int, int]:
    """Build equal links, each on a joint about or along `AXIS`, with its frame turned and moved."""
    client, count = pb.connect(pb.DIRECT), len(kinds)
    moments, axes = principal(MOMENTS)
    made = pb.createMultiBody(
        baseMass=0.0,
        linkMasses=[MASS] * count,
        linkCollisionShapeIndices=[-1] * count,
        linkVisualShapeIndices=[-1] * count,
        linkPositions=[[0.0, 0.0, 0.0]] * count,
        linkOrientations=[quaternion(TURN).tolist()] * count,
        linkInertialFramePositions=[COM.tolist()] * count,
        linkInertialFrameOrientations=[quaternion(axes).tolist()] * count,
        linkParentIndices=parents,
        linkJointTypes=kinds,
        linkJointAxis=[AXIS.tolist()] * count,
        physicsClientId=client,
    )
    for k in range(count):
        pb.changeDynamics(made, k, localInertiaDiagonal=moments.tolist(), physicsClientId=client)
    pb.setGravity(*GRAVITY.tolist(), physicsClientId=client)
    return made, client


def pybullet_axis() -> Claims:
    """Given in the link's axes, and told in its principal axes."""
    made, client = chain([pb.JOINT_REVOLUTE], [0])
    told, axes = np.array(pb.getJointInfo(made, 0, physicsClientId=client)[13]), principal(MOMENTS)[1]
    yield claim(told, axes.T @ AXIS, AXIS, axes @ AXIS)


def pybullet_gravity() -> Claims:
    """`setGravity` takes the acceleration of free fall, which is part of the inverse dynamics."""
    made, client = chain([pb.JOINT_PRISMATIC], [0])
    force = pb.calculateInverseDynamics(made, [0.0], [0.0], [0.0], physicsClientId=client)
    along = TURN @ AXIS
    yield claim(force, [-MASS * GRAVITY @ along], [MASS * GRAVITY @ along], [0.0])


def pybullet_inertia() -> Claims:
    """From the shapes, unless a flag asks for that of the file."""
    said = [2.0, 0.0, 0.0, 0.0, 0.3, 0.0, 0.0, 0.4, 0.0, 0.5]
    sides = np.array([1.0, 2.0, 3.0])
    box = (np.sum(sides**2) - sides**2) * 2.0 / 12
    yield claim(loaded(SAID, pb.URDF_USE_INERTIA_FROM_FILE), said, loaded(SAID))
    yield claim(np.array(loaded(SAID))[[4, 7, 9]], box, [0.3, 0.4, 0.5])


def pybullet_massless() -> Claims:
    """A link without an inertial gets 1 kg, and moments of 1 kg m² with the flag."""
    yield claim(loaded("", pb.URDF_USE_INERTIA_FROM_FILE), [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 1.0], np.zeros(10))


def pybullet_velocity_damping() -> Claims:
    """The velocity of links is damped unless `changeDynamics` sets that to zero."""
    made, client = chain([pb.JOINT_REVOLUTE], [0])

    def after(damping: float | None) -> float:
        if damping is not None:
            for k in (-1, 0):
                pb.changeDynamics(made, k, linearDamping=damping, angularDamping=damping, physicsClientId=client)
        pb.setGravity(0.0, 0.0, 0.0, physicsClientId=client)
        pb.setTimeStep(0.5, physicsClientId=client)
        pb.setJointMotorControl2(made, 0, pb.VELOCITY_CONTROL, force=0.0, physicsClientId=client)
        pb.resetJointState(made, 0, 0.0, 3.0, physicsClientId=client)
        pb.stepSimulation(physicsClientId=client)
        return float(pb.getJointState(made, 0, physicsClientId=client)[1])

    first, off = after(None), after(0.0)
    yield claim([off], [3.0], [first])
