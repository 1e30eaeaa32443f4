"""Each attribute that MuJoCo's schema knows is read, has no part in the dynamics, or is told as not compared.

The schema is that of the installed MuJoCo. Each attribute is set to values of many kinds in a small robot. Whatever changes MuJoCo's own
mass matrix or inverse dynamics must change what is read, or be told by name. So an attribute of a later format fails here until it is told.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from xml.etree import ElementTree

import mujoco as mj
import numpy as np
import pytest

from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.attributes import FAMILIES, NO_PART, READ, not_compared
from featherbench_oracles.mujoco.reading import read

# the schema as the test of our own reader has it
SCHEMA = Path(__file__).resolve().parents[2] / "crates/mechanics/formats/tests/mjcf_schema.txt"
# every kind of element that can have a part in the dynamics of a tree, without contacts
ROBOT = """<mujoco model="all"><compiler angle="degree"/><option gravity="0 0 -9"/>
<worldbody><body name="base" pos=".1 .2 .3"><joint name="lift" type="slide" axis="0 0 1" range="-1 2"/>
<inertial pos=".1 0 0" mass="2" diaginertia=".02 .03 .04"/>
<body name="arm" pos=".3 0 0"><joint name="turn" type="hinge" axis="0 .6 .8" pos="0 .1 0" range="-30 50"/>
<geom name="rod" type="capsule" size=".05 .2" contype="0" conaffinity="0"/><site name="tip" pos="0 0 .2"/>
<body name="ball" pos="0 0 .4"><joint name="round" type="ball"/><inertial pos="0 .1 0" mass="1" diaginertia=".01 .01 .01"/></body>
</body></body></worldbody>
<tendon><fixed name="cable"><joint joint="lift" coef="1"/><joint joint="turn" coef="-2"/></fixed>
<spatial name="rope"><site site="tip"/><site site="peg"/></spatial></tendon>
<actuator><motor name="servo" joint="turn" gear="3"/><position name="hold" joint="lift"/><general name="any" tendon="cable"/></actuator>
</mujoco>""".replace("<worldbody>", '<worldbody><site name="peg" pos="1 1 1"/>')
PLACES = {
    "compiler": "compiler",
    "option": "option",
    "body": "worldbody/body/body",
    "inertial": "worldbody/body/inertial",
    "joint": "worldbody/body/body/joint",
    "slide": "worldbody/body/joint",
    "geom": "worldbody/body/body/geom",
    "fixed": "tendon/fixed",
    "spatial": "tendon/spatial",
    "motor": "actuator/motor",
    "position": "actuator/position",
    "general": "actuator/general",
}
# values of many kinds: MuJoCo refuses those that do not fit
VALUES = (
    *("0.7", "3", "0.7 0.4", "1 2 3", "0.3 0.4 0.5 0.6", "0.9 0.8 0.1 0.2 0.3", "1 .1 0 0 .2 1", "true", "false", "radian", "yzx", "XYZ"),
    *("enable", "disable", "kinematics", "all", "always", "ellipsoid", "implicit", "sphere", "box", "hinge", "slide"),
)


def elements() -> dict[str, set[str]]:
    """List the attributes of each element that MuJoCo's schema has, by the element's path below the root."""
    found: dict[str, set[str]] = {}
    path: list[str] = []
    for line in mj.mj_printSchema(False, False).splitlines():
        start = re.match(r"( *)(\S+) \([!*?R]\)\s*(.*)", line)
        if start:
            path = [*path[: len(start[1]) // 3], start[2].replace("(world)", "")]
        found.setdefault("/".join(path[1:]) or "mujoco", set()).update((start[3] if start else line).split())
    return found


def schema() -> dict[str, set[str]]:
    """List the attributes of each element, wherever the schema has it."""
    found: dict[str, set[str]] = {}
    for path, attributes in elements().items():
        found.setdefault(path.rsplit("/", maxsplit=1)[-1], set()).update(attributes)
    return found


def numbers(model: mj.MjModel) -> Array:
    """Compute M, passive forces and inverse dynamics of a model at a state and an acceleration, without contacts and limits."""
    model.opt.disableflags |= mj.mjtDisableBit.mjDSBL_CONSTRAINT
    data = mj.MjData(model)
    rng = np.random.default_rng(44)
    velocity, acceleration = rng.uniform(-1, 1, model.nv), rng.uniform(-1, 1, model.nv)
    mj.mj_integratePos(model, data.qpos, rng.uniform(-0.5, 0.5, model.nv), 1.0)
    data.qvel, data.qacc = velocity, acceleration
    mj.mj_inverse(model, data)
    mass = np.zeros((model.nv, model.nv))
    mj.mj_fullM(model, data, mass)
    return np.concatenate([mass.ravel(), data.qfrc_inverse])


def variants(place: str, attribute: str) -> Iterator[tuple[str, str, mj.MjModel]]:
    """Set the attribute to each value that MuJoCo accepts."""
    for value in VALUES:
        root = ElementTree.fromstring(ROBOT)
        element = root.find(place)
        assert element is not None
        element.set(attribute, value)
        text = ElementTree.tostring(root, encoding="unicode")
        try:
            yield value, text, mj.MjModel.from_xml_string(text)
        except ValueError:
            continue


def heard(path: Path) -> tuple[str, list[str]]:
    """Read a file: the description without names, and what is told of armature and of what is not compared."""
    reading = read(path, "mjcf", "fixed", lambda description, model: None)
    kinds = ("not_compared", "tendon_armature", "actuator_armature")
    told = [f"{note['about']} {note['text']}" for note in reading.notes if note["cause"] in kinds]
    return repr(reading.model), sorted(told)


@pytest.mark.parametrize("where", PLACES)
def test_what_changes_the_dynamics_is_read_or_told(where: str, tmp_path: Path) -> None:
    """What is read gives MuJoCo's own numbers, unless something more is told."""
    place = PLACES[where]
    tag = place.rsplit("/", maxsplit=1)[-1]
    file = tmp_path / "robot.xml"
    file.write_text(ROBOT)
    described, usual = heard(file)
    of_read = {described: numbers(mj.MjModel.from_xml_string(ROBOT))}
    silent, accepted = [], 0
    for attribute in sorted(schema()[tag]):
        for value, text, model in variants(place, attribute):
            accepted += 1
            file.write_text(text)
            described, told = heard(file)
            whole = any(f"{section} {tag}" in line for line in told for section in ("tendon", "actuator"))
            if told == usual and not whole:
                due, found = of_read.setdefault(described, numbers(model)), numbers(model)
                if found.shape != due.shape or not np.array_equal(found, due):
                    silent.append(f"{tag} {attribute}: {value}")
    assert accepted > 0
    assert not silent, silent


def test_each_attribute_of_the_schema_is_listed_or_told(tmp_path: Path) -> None:
    """What is neither read nor without a part is told by its name. The list has no attribute that the schema does not know."""
    known = schema()
    for key, attributes in READ.items():
        *_, tag = key.split()
        meta = {"frame", "replicate", "include", "worldbody"}  # the schema's text does not have them
        assert tag in meta or attributes <= known[tag] | NO_PART, (key, attributes - known[tag])
    file = tmp_path / "robot.xml"
    cases, silent = 0, []
    for where, place in PLACES.items():
        tag = place.rsplit("/", maxsplit=1)[-1]
        for attribute in sorted(known[tag] | {"added_tomorrow"}):
            cases += 1
            root = ElementTree.fromstring(ROBOT)
            element = root.find(place)
            assert element is not None
            element.set(attribute, "1")
            file.write_text(ElementTree.tostring(root, encoding="unicode"))
            told = [note["text"] for note in not_compared(file)]
            # a tendon and an actuator are told as a whole
            named = any(text.split(" (")[0] in (f"{tag} {attribute}", f"tendon {tag}", f"actuator {tag}") for text in told)
            family = any(text in FAMILIES and attribute in FAMILIES[text].get(tag, ()) for text in told)
            if not (attribute in READ.get(tag, set()) | NO_PART or named or family):
                silent.append(f"{where} {attribute}: {told}")
    assert cases >= 300, "MuJoCo 4.0.0 has 308 attributes in these places, and one of each is of tomorrow"
    assert not silent, silent


def test_our_own_reader_is_tested_by_the_same_schema() -> None:
    """The list by which the test of our reader goes is that of the installed MuJoCo."""
    due = "".join(f"{path}: {' '.join(sorted(attributes))}\n" for path, attributes in elements().items())
    assert SCHEMA.read_text() == due, f"write this into {SCHEMA}, and then list what is new in our reader:\n{due}"
