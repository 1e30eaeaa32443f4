"""Equality constraints of an MJCF are loops of the description: MuJoCo's own residuals at random positions are those of the loops."""

from __future__ import annotations

import numpy as np
import pytest

from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.messages import Header
from featherbench_oracles.core.reading import Place
from featherbench_oracles.testing.measures import within

from .conftest import Oracles, require
from .readers import Readers
from .test_session import PREPARE

# The hinges of `crank` and `rod` are not at the origins of their links, the slider has a `ref`, and `plate` is fixed to `rod`.
INERTIAL = '<inertial pos=".1 0 0" mass="1" diaginertia=".02 .03 .04"/>'
TIED = f"""<mujoco model="tied"><compiler angle="radian"/><worldbody><site name="post" pos=".3 .2 .1" quat=".6 .8 0 0"/>
<body name="crank" pos=".1 .2 .3" quat=".6 0 0 .8"><joint name="turn" axis="0 0 1" pos=".1 0 .2"/>{INERTIAL}
 <body name="rod" pos="0 .5 0" quat=".8 0 .6 0"><joint name="swing" axis="0 1 0" pos="0 .25 0" ref=".3"/>{INERTIAL}
  <body name="plate" pos="0 0 .4" quat=".6 0 .8 0"><site name="grip" pos=".1 .1 .1" quat="0 .6 0 .8"/></body></body></body>
<body name="slider" pos="1 0 0"><joint name="push" type="slide" axis="1 0 0" ref=".5"/>{INERTIAL}</body></worldbody>
<tendon><fixed name="cord"><joint joint="turn" coef="1"/></fixed></tendon>
<equality>
 <connect name="pin" body1="slider" body2="rod" anchor=".3 .1 .2"/>
 <connect name="held" site1="post" site2="grip"/>
 <weld name="clamp" body1="plate" body2="slider" relpose=".1 .2 .3 .6 0 0 .8" anchor=".2 .1 0"/>
 <weld name="at home" body1="crank"/>
 <weld name="socket" site1="grip" site2="post"/>
 <joint name="cam" joint1="push" joint2="swing" polycoef=".1 .2 .3 .4 .5"/>
 <joint name="lock" joint1="push" polycoef=".1 0 0 0 0"/>
 <joint name="idle" joint1="turn" joint2="swing" active="false"/>
 <weld name="idle weld" body1="plate" body2="rod"/>
 <tendon name="taut" tendon1="cord"/>
</equality></mujoco>"""
TYPES = {"pin": "spherical", "held": "spherical", "clamp": "fixed", "at home": "fixed", "socket": "fixed", "cam": "mimic"}
ANCHORS = {"crank": [0.1, 0, 0.2], "rod": [0, 0.25, 0], "slider": [0, 0, 0]}  # the origin of the description's body in the link
SAME = 1e-11  # numbers of order one; a turn near 180° is divided by its w, 0.006 in one of these draws


@pytest.fixture
def model(readers: Readers) -> Header:
    """Have MuJoCo read the file."""
    read = readers.read("mujoco", "tied.xml", TIED)
    told = [note["text"] for note in read.header["notes"] if "is no loop" in note["text"]]
    assert [next(name for name in ("lock", "idle weld", "idle", "taut") if f" {name} " in text) for text in told] == [
        "lock",
        "idle",
        "idle weld",
        "taut",
    ]
    found: Header = read.header["model"]
    return found


def test_each_constraint_is_a_loop_or_is_told(model: Header) -> None:
    """What descriptions have is there, and the rest is in the notes."""
    assert {loop["name"]: loop["type"] for loop in model["loops"]} == TYPES
    assert [body["name"] for body in model["bodies"]] == ["crank", "rod", "slider"]


def test_residuals_are_those_of_mujoco(model: Header) -> None:
    """At random positions the loops are as far from closed as MuJoCo says of its constraints."""
    require("mujoco")
    import mujoco as mj

    own = mj.MjModel.from_xml_string(TIED)
    data = mj.MjData(own)
    rng = np.random.default_rng(4)
    compared = 0
    for _ in range(5):
        data.qpos[:] = rng.uniform(-1, 1, own.nq)
        mj.mj_forward(own, data)
        places = [_placed(own, data, body["name"]) for body in model["bodies"]]
        for loop in model["loops"]:
            number = own.equality(loop["name"]).id
            rows = (data.efc_type == mj.mjtConstraint.mjCNSTR_EQUALITY) & (data.efc_id == number)
            due = np.array(data.efc_pos[rows])
            found = _residual(loop, places, data.qpos)
            if found[3:] @ due[3:] < 0:  # a quaternion and its opposite are one turn
                due[3:] *= -1
            assert np.abs(found - due).max() <= within(SAME), loop["name"]
            compared += len(due)
    assert compared == 5 * (2 * 3 + 3 * 6 + 1)


def _placed(own: mj.MjModel, data: mj.MjData, name: str) -> Place:  # type: ignore[name-defined]  # noqa: F821 (imported in the test)
    """Find where the description's body is in the world."""
    link = data.body(name)
    return Place(link.xmat.reshape(3, 3), link.xpos.copy()) @ Place(translation=np.array(ANCHORS[name], dtype=float))


def _residual(loop: Header, places: list[Place], q: Array) -> Array:
    """Compute the rows of a loop as MuJoCo has them: gaps in world axes, then the vector of the quaternion of the second frame's turn."""
    if loop["type"] == "mimic":
        powers = q[loop["leader"]] ** np.arange(5)
        return np.array([q[loop["follower"]] - powers @ loop["polynomial"]])
    ends = [loop["first"], loop["second"]]
    first, second = ((places[end["body"]] if end["body"] >= 0 else Place()) @ Place.of(end["placement"]) for end in ends)
    gap: Array = first.translation - second.translation
    if loop["type"] == "spherical":
        return gap
    turn = second.rotation.T @ first.rotation
    w = 0.5 * np.sqrt(1 + np.trace(turn))
    vector = np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]]) / (4 * w)
    return np.append(gap, vector)


def test_a_description_with_loops_is_refused_by_name(oracles: Oracles) -> None:
    """An oracle is asked about trees. It says so instead of leaving the loops out."""
    loop = {"name": "l", "type": "mimic", "follower": 1, "leader": 0, "polynomial": [0, 1, 0, 0, 0]}
    answer, _ = oracles["mujoco"].ask({**PREPARE, "model": {**PREPARE["model"], "loops": [loop]}})
    assert answer["status"] == "unsupported"
    assert "'loops'" in answer["reason"]
