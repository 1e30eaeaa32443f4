"""Tests of reading files (`read`) through the protocol: what each engine tells of small files is what they say, or the known edit.

    python oracles/test_reading.py [-v]

Of every file that an engine reads, the engine's M and inverse dynamics are compared with those of a robot built by `prepare` from the
description that it told: the description says what the engine computes with.
"""

from __future__ import annotations

import os
import re
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from protocol import Array, Description, Header
from reading import overheard, turned
from trials import ENGINES, HERE, Oracle, check, expect, random_states, ratio, summary

REPLAY = 1e-13  # unit-free; these robots are shallow, and M's terms are of the size of its diagonal
DIGITS = 1e-15  # what reading a decimal, and one rotation by it, may lose

LINK = """<link name="{name}"><inertial><origin xyz="{com}" rpy="{rpy}"/><mass value="{mass}"/>
<inertia ixx=".02" iyy=".03" izz=".04" ixy=".001" ixz=".002" iyz=".003"/></inertial></link>"""
JOINT = """<joint name="{name}" type="{type}"><parent link="{parent}"/><child link="{child}"/><origin xyz="{xyz}" rpy="{rpy}"/>
<axis xyz="{axis}"/><limit lower="-1" upper="2" velocity="3" effort="40"/>{more}</joint>"""
GIVEN = np.array([[0.02, 0.001, 0.002], [0.001, 0.03, 0.003], [0.002, 0.003, 0.04]])


def link(name: str, mass: float = 1.5, com: str = ".1 .2 .3", rpy: str = "0 0 0") -> str:
    """A link of a URDF with the inertia `GIVEN` in the inertial's axes."""
    return LINK.format(name=name, mass=mass, com=com, rpy=rpy)


def joint(name: str, kind: str, parent: str, child: str, axis: str = "0 1 0", more: str = "") -> str:
    """A joint of a URDF at (.1, .2, .3), turned by 1.1 about x and then by 0.3 about z."""
    return JOINT.format(name=name, type=kind, parent=parent, child=child, xyz=".1 .2 .3", rpy="1.1 0 .3", axis=axis, more=more)


def about(axis: int, angle: float) -> Array:
    """The rotation about a coordinate axis."""
    half = np.zeros(4)
    half[0], half[axis + 1] = np.cos(angle / 2), np.sin(angle / 2)
    return turned(*half)


TURN = about(2, 0.3) @ about(0, 1.1)
ARM = f"""<robot name="arm">
{link("stand")}{link("upper", rpy=".4 .5 .6")}{link("flange", mass=0.5)}{link("slider")}{link("wheel")}{link("finger")}
{joint("shoulder", "revolute", "stand", "upper", more='<dynamics damping=".7" friction=".2"/>')}
{joint("glue", "fixed", "upper", "flange")}
{joint("rail", "prismatic", "flange", "slider", axis="0.6 0 0.8")}
{joint("axle", "continuous", "slider", "wheel", axis="0 0 1")}
{joint("grip", "revolute", "slider", "finger", axis="1 0 0", more='<mimic joint="rail" multiplier="2"/>')}
</robot>"""
LIGHT = f'<robot name="light">{link("stand")}<link name="empty"/>{joint("hinge", "revolute", "stand", "empty")}</robot>'
FLAT = (
    '<robot name="flat"><link name="stand"/><link name="plate"><inertial><mass value="2"/>'
    '<inertia ixx=".01" iyy=".01" izz=".05" ixy="0" ixz="0" iyz="0"/></inertial></link>'
    f"{joint('hinge', 'revolute', 'stand', 'plate')}</robot>"
)
WORLD = f'<robot name="world"><link name="world"/>{link("arm")}{joint("hinge", "continuous", "world", "arm")}</robot>'
PLANE = f'<robot name="plane"><link name="stand"/>{link("sled")}{joint("skate", "planar", "stand", "sled", axis="0 0 1")}</robot>'
STEEP = PLANE.replace('<axis xyz="0 0 1"/>', '<axis xyz="1 0 0"/>')
FLOATING = f'<robot name="float"><link name="stand"/>{link("bird")}{joint("wing", "floating", "stand", "bird")}</robot>'
SLED = PLANE.replace('<axis xyz="0 0 1"/>', '<axis xyz="0.6 0 0.8"/>').replace(
    "</robot>", f"{link('bird')}{joint('wing', 'floating', 'sled', 'bird')}</robot>"
)
MESH = WORLD.replace("</link>", '<collision><geometry><mesh filename="package://nowhere/m.stl"/></geometry></collision></link>', 1)

MJCF = """<mujoco model="toy"><compiler angle="radian"/><option gravity="0 1 -5"/>
<default><default class="geared"><joint armature=".25" damping=".7"/></default></default>
<worldbody><body name="post" pos="0 0 1"><inertial pos="0 0 0" mass="9" diaginertia="1 1 1"/>
 <body name="arm" pos=".1 .2 .3" quat=".6 0 0 .8">
  <joint name="pan" class="geared" axis="0 0 1" pos=".5 0 0" range="-1 2"/><joint name="tilt" axis="0 1 0" pos="0 .25 0" frictionloss=".2"/>
  <inertial pos=".1 .2 .3" mass="1.5" fullinertia=".02 .03 .04 .001 .002 .003"/>
  <body name="cup" pos="0 0 .4"><inertial pos="0 0 .1" mass=".5" diaginertia=".02 .03 .04"/>
   <body name="ball" pos="1 0 0"><joint name="socket" type="ball"/><inertial pos=".1 0 0" mass="1" diaginertia=".02 .03 .04"/></body>
  </body>
  <body name="rod" pos="0 1 0"><joint name="push" type="slide" axis="1 0 0" ref=".5"/><geom type="sphere" size=".1" mass="2"/></body>
 </body></body>
 {more}
</worldbody>
<actuator><motor joint="pan"/></actuator>
<keyframe><key name="home" qpos=".1 .2 1 0 0 0 .5 {key}"/></keyframe></mujoco>"""
THREE = """<mujoco model="three"><compiler angle="radian"/><worldbody><body name="car">
 <joint name="x" type="slide" axis="1 0 0"/><joint name="y" type="slide" axis="0 1 0" pos="5 5 5"/>
 <joint name="z" axis="0 0 1" pos=".5 0 0"/>
 <inertial pos=".1 0 0" mass="1" diaginertia=".02 .03 .04"/>
 <body name="mast" pos="0 0 1"><joint name="ref" axis="0 1 0" ref=".3" range="-1 1"/>
 <inertial pos=".1 0 0" mass="1" diaginertia=".02 .03 .04"/></body></body></worldbody></mujoco>"""
REFUSED = """<mujoco model="refused"><worldbody>
 <body name="flat"><joint name="h" axis="0 1 0"/><inertial pos=".1 0 0" quat=".6 0 0 .8" mass="1" diaginertia=".01 .02 .05"/>
 <body name="empty" pos="0 0 1"><joint name="k" axis="0 1 0"/></body></body></worldbody></mujoco>"""
DRAGGED = """<mujoco model="dragged"><default><joint armature=".25"/></default><worldbody>
 <body name="base"><joint name="root" type="free"/><inertial pos=".1 0 0" mass="1" diaginertia=".02 .03 .04"/>
 <body name="arm" pos="0 0 1"><joint name="k" axis="0 1 0"/><inertial pos=".1 0 0" mass="1" diaginertia=".02 .03 .04"/></body></body>
</worldbody><actuator><motor joint="k"/></actuator></mujoco>"""
LOOSE = """<body name="loose" pos="1 2 3"><freejoint name="fly"/><inertial pos="0 0 .1" mass="3" diaginertia=".02 .03 .04"/></body>"""


@dataclass
class Read:
    """An engine's answer to `read`."""

    header: Header
    keyframes: Array | None

    def body(self, name: str) -> Header:
        """The body of that name."""
        return next(body for body in self.header["model"]["bodies"] if body["name"] == name)

    def names(self) -> list[str]:
        """The bodies' names in order."""
        return [body["name"] for body in self.header["model"]["bodies"]]

    def frame(self, name: str) -> tuple[int, Array, Array]:
        """Body, rotation and origin of a frame."""
        frame = next(frame for frame in self.header["model"]["frames"] if frame["name"] == name)
        place = frame["placement"]
        return frame["body"], np.reshape(place["rotation"], (3, 3)), np.array(place["translation"])

    def causes(self) -> set[str]:
        """What the notes are about."""
        return {note["cause"] for note in self.header["notes"]}


class Readers:
    """The oracles, and a folder for files."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.oracles = {name: Oracle(str(HERE / f"{name}.py")) for name in ENGINES}

    def file(self, name: str, text: str) -> Path:
        """A file of that text."""
        path = self.folder / name
        path.write_text(text, encoding="utf-8")
        return path

    def read(self, engine: str, name: str, text: str, base: str = "fixed", replay: bool = True) -> Read:
        """Has the engine read a file that it must read, and compares it with what it told."""
        path, oracle = self.file(name, text), self.oracles[engine]
        header = {"op": "read", "file": str(path), "format": "mjcf" if name.endswith(".xml") else "urdf", "base": base}
        answer, blocks = oracle.must(header)
        if replay:
            self.replay(f"{engine} on {name}, {base}", oracle, answer)
        return Read(answer, blocks.get("keyframes"))

    def replay(self, name: str, oracle: Oracle, answer: Header) -> None:
        """M and ID of the file as read against those of the description: by the same engine, or Pinocchio where that refuses."""
        robot = Description.read(answer["model"])
        states = random_states(np.random.default_rng(3), robot)
        methods = oracle.must({"op": "hello"})[0]["methods"]
        asked = [(q, methods[q][0]) for q in ("mass_matrix", "id", "bias")]
        held = [oracle.at(states, *pair) for pair in asked]
        prepare = {"op": "prepare", "model": answer["model"]}
        if oracle.ask(prepare)[0]["status"] == "unsupported":
            oracle = self.oracles["pinocchio"]
            oracle.must(prepare)
            methods = oracle.must({"op": "hello"})[0]["methods"]
        built = [oracle.at(states, q, methods[q][0]) for q, _ in asked]
        for k, mass in enumerate(built[0]):
            d = np.sqrt(np.diag(mass))
            force = np.abs(built[1][k]) + np.abs(built[2][k]) + np.abs(mass) @ (np.abs(states["a"][k]) + states["v"][k] ** 2)
            check(f"{name}: M as described", ratio((held[0][k] - mass) / np.outer(d, d)), REPLAY)
            for quantity in (1, 2):
                gap = (held[quantity][k] - built[quantity][k]) / d
                check(f"{name}: {asked[quantity][0]} as described", ratio(gap, force / d), REPLAY)


def same(name: str, value: object, expected: object, tolerance: float = DIGITS) -> None:
    """Two arrays of numbers agree."""
    x, y = np.asarray(value, dtype=float), np.asarray(expected, dtype=float)
    gap = float(np.abs(x - y).max()) if x.shape == y.shape else np.inf
    check(name, gap / max(1.0, float(np.abs(y).max())), tolerance)


def true(name: str, condition: bool) -> None:
    """A condition holds."""
    check(name, 0.0 if condition else 1.0, 0.5)


def test_arm(readers: Readers, engine: str) -> None:
    """A URDF with a fixed link in the middle, a rotated inertial, a mimic joint, damping and limits; fixed and free."""
    read = readers.read(engine, "arm.urdf", ARM)
    true(
        f"{engine}: bodies of the arm",
        sorted(read.names()) == ["finger", "slider", "upper", "wheel"] and read.names()[:2] == ["upper", "slider"],
    )
    upper = read.body("upper")
    hinge, place = upper["joint"], upper["joint"]["placement"]
    same(f"{engine}: placement of a joint", [*place["rotation"], *place["translation"]], [*TURN.ravel(), 0.1, 0.2, 0.3])
    same(f"{engine}: axis", hinge["axis"], [0, 1, 0])
    same(f"{engine}: damping", hinge["damping"], [0.7])
    same(f"{engine}: friction, which Drake does not hold", hinge["friction"], [0.0 if engine == "drake" else 0.2])
    same(f"{engine}: limits", [*hinge["lower"], *hinge["upper"]], [-1, 2])
    true(f"{engine}: velocity limit, which MuJoCo does not hold", hinge.get("velocity") == (None if engine == "mujoco" else [3.0]))
    true(f"{engine}: effort limit, which Drake holds of actuators", hinge.get("effort") == (None if engine == "drake" else [40.0]))
    limited = {"lower", "upper"} & set(read.body("wheel")["joint"])
    true(f"{engine}: a continuous joint has no limits, but keeps those of the file in Drake", bool(limited) == (engine == "drake"))
    same(f"{engine}: axis of the rail", read.body("slider")["joint"]["axis"], [0.6, 0, 0.8])
    tilt = about(2, 0.6) @ about(1, 0.5) @ about(0, 0.4)
    c1, c2 = np.array([0.1, 0.2, 0.3]), TURN @ [0.1, 0.2, 0.3] + [0.1, 0.2, 0.3]
    com = (1.5 * c1 + 0.5 * c2) / 2

    def moved(mass: float, inertia: Array, c: Array) -> Array:
        return inertia + mass * ((c - com) @ (c - com) * np.eye(3) - np.outer(c - com, c - com))

    merged = moved(1.5, tilt @ GIVEN @ tilt.T, c1) + moved(0.5, TURN @ GIVEN @ TURN.T, c2)
    same(f"{engine}: merged mass", upper["mass"], 2.0)
    same(f"{engine}: merged centre of mass", upper["com"], com)
    same(f"{engine}: merged inertia", upper["inertia"], merged[np.triu_indices(3)])
    body, turn, origin = read.frame("flange")
    true(f"{engine}: the fixed link's frame", body == read.names().index("upper"))
    same(f"{engine}: where the fixed link is", [*turn.ravel(), *origin], [*TURN.ravel(), 0.1, 0.2, 0.3])
    true(f"{engine}: the root is the world's", read.frame("stand")[0] == -1)
    exact = read.body("wheel")["inertia"] == GIVEN[np.triu_indices(3)].tolist()
    true(f"{engine}: an inertia in its own digits, which Drake recomputes", exact or engine == "drake")
    true(f"{engine}: mimic is told", "mimic" in read.causes())
    free = readers.read(engine, "arm.urdf", ARM, "free")
    true(f"{engine}: a free base", free.body("stand")["joint"]["type"] == "free" and free.names()[1:] == read.names())


def test_edits(readers: Readers, engine: str) -> None:
    """What parsers do to bodies without mass and inertias that no body has."""
    read = readers.read(engine, "light.urdf", LIGHT, replay=engine == "mujoco")
    mass = {"pinocchio": 0.0, "mujoco": 1e-6, "drake": 0.0}[engine]
    same(f"{engine}: the mass of an empty link", read.body("empty")["mass"], mass)
    true(f"{engine}: bounds are told", ("bounds" in read.causes() and "mass_edited" in read.causes()) == (engine == "mujoco"))
    read = readers.read(engine, "flat.urdf", FLAT)
    sphere = 0.4 * 2 * (3 * 2 / (4 * np.pi * 1000)) ** (2 / 3)  # of the link's mass, as dense as water
    moments = {"pinocchio": [0.01, 0.01, 0.05], "mujoco": [0.07 / 3] * 3, "drake": [sphere] * 3}[engine]
    same(f"{engine}: an unphysical inertia", np.array(read.body("plate")["inertia"])[[0, 3, 5]], moments)
    true(f"{engine}: that is told", ("inertia_edited" in read.causes()) == (engine != "pinocchio"))
    true(f"{engine}: balanceinertia is told", ("balanceinertia" in read.causes()) == (engine == "mujoco"))
    true(f"{engine}: no mesh is needed", readers.read(engine, "mesh.urdf", MESH).names() == ["arm"])


def test_bases(readers: Readers, engine: str) -> None:
    """A root called world; a planar joint."""
    true(f"{engine}: a dummy root", readers.read(engine, "world.urdf", WORLD).names() == ["arm"])
    free = readers.read(engine, "world.urdf", WORLD, "free", replay=engine != "pinocchio")
    true(f"{engine}: only Pinocchio sets a root called world free", free.names() == ["world", "arm"][engine != "pinocchio" :])
    true(f"{engine}: the others say so", ("root_welded" in free.causes()) == (engine != "pinocchio"))
    plane = readers.read(engine, "plane.urdf", PLANE)
    types = [body["joint"]["type"] for body in plane.header["model"]["bodies"]]
    true(
        f"{engine}: a planar joint, in MuJoCo three",
        types == (["prismatic", "prismatic", "revolute"] if engine == "mujoco" else ["planar"]),
    )
    place = plane.header["model"]["bodies"][0]["joint"]["placement"]
    same(f"{engine}: the plane", [*place["rotation"], *place["translation"]], [*TURN.ravel(), 0.1, 0.2, 0.3])

    place = np.reshape(readers.read(engine, "steep.urdf", STEEP).header["model"]["bodies"][-1]["joint"]["placement"]["rotation"], (3, 3))
    if engine != "mujoco":  # whose last joint turns about the file's axis
        same(
            f"{engine}: the plane's normal, which is z in Pinocchio whatever the axis", place[:, 2], TURN[:, 0 if engine == "drake" else 2]
        )
    bird = readers.read(engine, "float.urdf", FLOATING).body("bird")["joint"]
    true(f"{engine}: a floating joint", bird["type"] == "free")
    zero = [0.1, 0.2, 0.3] if engine == "pinocchio" else [0, 0, 0]  # the others count from the world
    same(f"{engine}: where its coordinates count from", bird["placement"]["translation"], zero)


def test_floating_below(readers: Readers, engine: str) -> None:
    """A floating joint below a planar one whose plane is not z: DART's velocities are in its own body's axes, not in the description's."""
    if engine != "mujoco":  # which refuses a floating joint that does not hang on the world
        true(f"{engine}: a bird on a sled", readers.read(engine, "sled.urdf", SLED).names() == ["sled", "bird"])


def test_limitless(readers: Readers, engine: str) -> None:
    """A revolute joint without limits: who refuses it says why, and which joint."""
    path = readers.file("limitless.urdf", re.sub("<limit[^>]*>", "", WORLD.replace("continuous", "revolute")))
    answer, _ = readers.oracles[engine].ask({"op": "read", "file": str(path), "format": "urdf", "base": "fixed"})
    refuses = engine in ("pinocchio", "dart")
    true(f"{engine}: a revolute joint without limits", answer["status"] == ("error" if refuses else "ok"))
    if refuses:
        told = "Joint [hinge] is of type REVOLUTE but it does not specify limits" in answer["reason"]
        true(f"{engine}: why it refuses, without a path of its own sources", told and ".cpp" not in answer["reason"])


def test_three(readers: Readers, engine: str) -> None:
    """Three joints in a body, and a hinge with a `ref`, by which Pinocchio shifts the limits."""
    read = readers.read(engine, "three.xml", THREE)
    true(f"{engine}: the chain of a body with three joints", read.names() == ["car/x", "car/y", "car", "mast"])
    places = [body["joint"]["placement"]["translation"] for body in read.header["model"]["bodies"]]
    same(f"{engine}: anchors count for hinges only", places, [[0, 0, 0], [0, 0, 0], [0.5, 0, 0], [-0.5, 0, 1]])
    joint = read.body("mast")["joint"]
    same(f"{engine}: a hinge stands at its place where it is ref", joint["placement"]["rotation"], about(1, -0.3).ravel())
    shift = 0.3 if engine == "pinocchio" else 0.0
    same(f"{engine}: limits of that hinge", [*joint["lower"], *joint["upper"]], [-1 - shift, 1 - shift])


def test_mjcf(readers: Readers, engine: str) -> None:
    """An MJCF with several joints in a body, anchors, a class of defaults, a `ref` and gravity; and what Drake and Pinocchio make of it."""
    text = MJCF.format(more="", key="")
    if engine == "pinocchio":  # which ends at a keyframe of another size than it expects
        text = text.replace("qpos=", "ctrl=")
    read = readers.read(engine, "toy.xml", text)
    pan, arm, ball, rod = (read.body(name) for name in ("arm/pan", "arm", "ball", "rod"))
    true(f"{engine}: the chain of a body with two joints", read.names() == ["arm/pan", "arm", "ball", "rod"])
    true(f"{engine}: parents", [body["parent"] for body in (pan, arm, ball, rod)] == [-1, 0, 1, 1])
    true(f"{engine}: joints", [body["joint"]["name"] for body in (pan, arm, ball, rod)] == ["pan", "tilt", "socket", "push"])
    true(
        f"{engine}: types", [body["joint"]["type"] for body in (pan, arm, ball, rod)] == ["revolute", "revolute", "spherical", "prismatic"]
    )
    gravity = [0, 0, -9.81] if engine == "pinocchio" else [0, 1, -5]
    same(f"{engine}: gravity, which Pinocchio ignores", read.header["model"]["gravity"], gravity)
    true(f"{engine}: that is told", ("gravity_ignored" in read.causes()) == (engine == "pinocchio"))
    turn, post = turned(0.6, 0, 0, 0.8), np.array([0, 0, 0 if engine == "pinocchio" else 1])  # Pinocchio forgets where the fixed post is
    place, own = pan["joint"]["placement"], np.array([0.1, 0.2, 0.3])
    right = np.append(turn.ravel(), post + own + turn @ [0.5, 0, 0])
    wrong = [*np.eye(3).ravel(), 0.5, 0, 1]  # Drake puts the body's place behind its first joint
    same(f"{engine}: placement of the first joint", [*place["rotation"], *place["translation"]], wrong if engine == "drake" else right)
    place = arm["joint"]["placement"]
    right = np.append(np.eye(3).ravel(), [-0.5, 0.25, 0])
    wrong = np.append(turn.ravel(), own + turn @ [0, 0.25, 0] - [0.5, 0, 0])
    same(f"{engine}: placement of the second", [*place["rotation"], *place["translation"]], wrong if engine == "drake" else right)
    same(f"{engine}: axes", [*pan["joint"]["axis"], *arm["joint"]["axis"], *rod["joint"]["axis"]], [0, 0, 1, 0, 1, 0, 1, 0, 0])
    same(f"{engine}: armature and damping of a class", [*pan["joint"]["armature"], *pan["joint"]["damping"]], [0.25, 0.7])
    same(f"{engine}: limits", [*pan["joint"]["lower"], *pan["joint"]["upper"]], [-1, 2])
    same(f"{engine}: friction, which Drake does not hold", arm["joint"]["friction"], [0.0 if engine == "drake" else 0.2])
    com = (1.5 * np.array([0.1, 0.2, 0.3]) + 0.5 * np.array([0, 0, 0.5])) / 2 - [0, 0.25, 0]
    same(f"{engine}: mass and centre of mass with the fixed cup", [arm["mass"], *arm["com"]], [2, *com])
    same(f"{engine}: a ball's placement", ball["joint"]["placement"]["translation"], [1, -0.25, 0.4])
    same(f"{engine}: a slide stands at its place where it is ref", rod["joint"]["placement"]["translation"], [-0.5, 0.75, 0])
    same(f"{engine}: an inertia of geometry", [rod["mass"], *rod["inertia"]], [2, 0.008, 0, 0, 0.008, 0, 0.008])
    for name, home, origin in (("post", -1, post), ("arm", 1, [0, -0.25, 0]), ("cup", 1, [0, -0.25, 0.4])):
        body, turn, at = read.frame(name)
        same(f"{engine}: frame {name}", [body, *turn.ravel(), *at], [home, *np.eye(3).ravel(), *origin])
    true(f"{engine}: the motor is not compared", "not_compared" in read.causes())
    idle = readers.read(engine, "idle.xml", text.replace('<motor joint="pan"/>', "")).body("arm/pan")["joint"]
    same(f"{engine}: armature without a motor, which Drake forgets", idle["armature"], [0.0 if engine == "drake" else 0.25])


def test_warnings(readers: Readers, engine: str) -> None:
    """A parser's words are notes; MuJoCo leaves no log behind."""
    odd = MJCF.format(more="", key="").replace("<option ", '<option timestep="nan" ')
    if engine == "mujoco":
        log = Path("MUJOCO_LOG.TXT")
        before = log.exists()
        oracle = readers.oracles[engine]
        answer, _ = oracle.must({"op": "read", "file": str(readers.file("odd.xml", odd)), "format": "mjcf", "base": "fixed"})
        true("mujoco: its words on a NaN", any("NaN" in note["text"] for note in answer["notes"] if note["cause"] == "warning"))
        true("mujoco: no log", log.exists() == before)
    if engine == "drake":
        warned = [note["text"] for note in readers.read(engine, "arm.urdf", ARM).header["notes"] if note["cause"] == "warning"]
        true("drake: its words on friction, without the folder", any("friction" in w and str(readers.folder) not in w for w in warned))


def test_repairs(readers: Readers, engine: str) -> None:
    """An MJCF that MuJoCo refuses as written: it is told with the file's own inertias beside the repaired ones."""
    if engine != "mujoco":
        return
    read = readers.read(engine, "refused.xml", REFUSED)
    written = {body["name"]: body for body in read.header["written"]["bodies"]}
    axes = turned(0.6, 0, 0, 0.8)
    given = (axes * [0.01, 0.02, 0.05]) @ axes.T
    same("mujoco: the file's own inertia", written["flat"]["inertia"], given[np.triu_indices(3)], 1e-16)
    same("mujoco: the repaired one", np.array(read.body("flat")["inertia"])[[0, 3, 5]], [0.08 / 3] * 3)
    true("mujoco: a body of nothing weighs nothing in the file", written["empty"]["mass"] == 0 and not any(written["empty"]["inertia"]))
    same("mujoco: and the bound where it was repaired", read.body("empty")["mass"], 1e-6)
    numbers = next(note["numbers"] for note in read.header["notes"] if note["cause"] == "inertia_edited")
    same("mujoco: what was given and what is held", numbers[4:10], given[np.triu_indices(3)], 1e-16)
    same("mujoco: what is held", numbers[14:], read.body("flat")["inertia"], 1e-16)
    true("mujoco: what it takes as it is was not repaired", "written" not in readers.read(engine, "three.xml", THREE).header)


def test_free_armature(readers: Readers, engine: str) -> None:
    """The armature that a class gives to a free joint is told and taken out of what is compared."""
    read = readers.read(engine, "dragged.xml", DRAGGED)
    told = [note["numbers"] for note in read.header["notes"] if note["cause"] == "free_armature" and note["subject"] == "root"]
    true(f"{engine}: armature of a free joint, which Drake forgets", told == ([] if engine == "drake" else [[0.25] * 6]))
    same(f"{engine}: it is no part of the description", read.body("base")["joint"]["armature"], [0.0] * 6)
    same(f"{engine}: that of a hinge is", read.body("arm")["joint"]["armature"], [0.25])


def test_include(readers: Readers, engine: str) -> None:
    """MuJoCo's includes and keyframes, with quaternions that end with w."""
    if engine != "mujoco":
        return
    readers.file("loose.xml", f"<mujoco>{LOOSE}</mujoco>")
    read = readers.read(engine, "toy.xml", MJCF.format(more='<include file="loose.xml"/>', key="1 2 3 0 0 1 0"))
    true("mujoco: an included body", read.names()[-1] == "loose" and read.body("loose")["joint"]["type"] == "free")
    same("mujoco: where a free body's coordinates count from", read.body("loose")["joint"]["placement"]["translation"], [0, 0, 0])
    true("mujoco: the keyframe's name", read.header["keyframes"] == ["home"])
    keys = np.zeros((0, 14)) if read.keyframes is None else read.keyframes
    same("mujoco: the keyframe", keys, [[0.1, 0.2, 0, 0, 0, 1, 0.5, 1, 2, 3, 0, 1, 0, 0]])
    near = MJCF.format(more="", key="").replace('pos=".1 0 0" mass="1"', 'pos="5e-7 0 0" mass="1"')
    read = readers.read(engine, "near.xml", near)
    true(
        "mujoco: a centre of mass within 1e-6 is the origin, and that is told",
        read.body("ball")["com"] == [0, 0, 0] and "com_edited" in read.causes(),
    )


def test_refusals(readers: Readers, engine: str) -> None:
    """Files that no engine can read are errors, and the oracle answers on."""
    oracle = readers.oracles[engine]
    good = readers.file("world.urdf", WORLD)
    request = {"op": "read", "format": "mjcf", "base": "fixed"}
    inner = "<body>" * 600 + "</body>" * 600
    files = {
        "absent": readers.folder / "absent.xml",
        "empty": readers.file("empty.xml", ""),
        "torn": readers.file("torn.xml", "<mujoco><worldbody>"),
        "deep": readers.file("deep.xml", f"<mujoco><worldbody>{inner}</worldbody></mujoco>"),
        "loop": readers.file("loop.xml", '<mujoco model="l"><include file="loop.xml"/><worldbody/></mujoco>'),
        "without its part": readers.file("part.xml", '<mujoco model="l"><include file="nowhere.xml"/><worldbody/></mujoco>'),
        "another document": readers.file("page.xml", "<html/>"),
    }
    for name, path in files.items():
        expect(f"{engine} on a file that is {name}", oracle.ask({**request, "file": str(path)}), "error")
    if engine == "dart":  # its collision detector prints errors about capsules on the way
        capsule = '<geom type="capsule" size=".1" fromto="0 0 0 0 0 1"/>'
        two = "".join(f'<body name="{name}"><joint name="{name}" axis="0 1 0"/>{capsule}</body>' for name in "ab")
        crowd = readers.file("two.xml", f"<mujoco><worldbody>{two}</worldbody></mujoco>")
        expect("dart on two robots is not offered", oracle.ask({**request, "file": str(crowd)}), "unsupported")
    twice = readers.file("twice.urdf", '<robot name="t"><link name="a"/><link name="a"/></robot>')
    expect(f"{engine} on a link twice", oracle.ask({**request, "format": "urdf", "file": str(twice)}), "error")
    expect(f"{engine} on an unknown format", oracle.ask({**request, "format": "sdf", "file": str(good)}), "error")
    oracle.must({**request, "format": "urdf", "file": str(good)})
    states = random_states(
        np.random.default_rng(0), Description.read(oracle.must({**request, "format": "urdf", "file": str(good)})[0]["model"])
    )
    oracle.must({"op": "states", "count": 22}, states)
    method = oracle.must({"op": "hello"})[0]["methods"]["body_placement"][0]
    asked = {"op": "evaluate", "quantity": "body_placement", "method": method, "first": 0, "count": 1}
    expect(f"{engine} tells no single bodies of a file", oracle.ask(asked), "unsupported")


def test_colours(folder: Path) -> None:
    """What an engine prints in colours is told without the terminal's escape sequences."""
    notes: list[Header] = []
    with overheard(folder / "a.urdf", notes):
        os.write(2, f"\x1b[1;33mWarning\x1b[0m: in {folder}/a.urdf\n".encode())
    true("printed in colours", [note["text"] for note in notes] == ["Warning: in a.urdf"])


def main() -> int:
    """Runs all tests; an answer that should have been ok and is not ends them, which is a failure."""
    with tempfile.TemporaryDirectory() as folder:
        test_colours(Path(folder))
        readers = Readers(Path(folder))
        common = (test_arm, test_floating_below, test_limitless, test_refusals)
        every = (*common, test_edits, test_bases, test_mjcf, test_three, test_warnings, test_repairs, test_free_armature, test_include)
        for engine in ENGINES:
            for test in common if engine == "dart" else every:  # what else DART does to files: test_oracles.py
                try:
                    test(readers, engine)
                except RuntimeError as reason:
                    check(f"{engine}: {test.__name__} comes to its end: {reason}", np.nan, 0)
    return summary("-v" in sys.argv)


if __name__ == "__main__":
    sys.exit(main())
