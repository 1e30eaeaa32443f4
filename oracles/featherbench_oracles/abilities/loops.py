"""Robots with loops: the operations `loops`, `loop_accelerations` and `loop_motion`. This module depends on no engine."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from featherbench_oracles.abilities.heard import heard
from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.messages import Answer, Blocks, Header, check_blocks
from featherbench_oracles.core.protocol import Unsupported
from featherbench_oracles.core.robot import Description, read_placement

# The types of loops that every engine is asked to hold, and by what. An engine that has more of them names them in its `LoopMethods`.
TYPES = {"fixed": "weld", "spherical": "point", "point": "point", "revolute": "two points"}
# The joints whose coordinates come back from every engine.
JOINTS = ("revolute", "prismatic", "helical", "free")
# The most numbers that a motion may record: 800 MB.
MOST_NUMBERS = 100_000_000


@dataclass(frozen=True)
class End:
    """A frame on a body.

    Attributes
    ----------
    body : int
        The body's index; -1 is the world.
    rotation : ndarray, shape (3, 3)
        From the frame's axes to the body's.
    translation : ndarray, shape (3,)
        The frame's origin on the body, m.
    """

    body: int
    rotation: Array
    translation: Array

    def along(self, distance: float) -> End:
        """Move the frame along its z axis, m."""
        return End(self.body, self.rotation, self.translation + distance * self.rotation[:, 2])


@dataclass(frozen=True)
class Loop:
    """A loop that engines hold: the second frame as its type allows on the first.

    Attributes
    ----------
    name, type : str
        The name; a type of the engine.
    first, second : End
        The frames. The axis of a revolute loop is z of both.
    length : float
        Of a distance: that of the frames' origins, m.
    """

    name: str
    type: str
    first: End
    second: End
    length: float = 0.0

    def points(self) -> list[tuple[End, End]]:
        """List the pairs of frames whose origins coincide. A hinge is two of them on its axis.

        They are as far from each other as the longer of the two frames' distances from their bodies' origins: the size of the links.
        """
        if self.type != "revolute":
            return [(self.first, self.second)]
        arm = max(float(np.linalg.norm(end.translation)) for end in (self.first, self.second)) or 1.0
        return [(self.first, self.second), (self.first.along(arm), self.second.along(arm))]


@dataclass(frozen=True)
class Follow:
    """A joint that follows another, both of one degree of freedom: a mimic, or a gear of two coordinates.

    Attributes
    ----------
    name, type : str
        The name; a type of the engine.
    follower, leader : int
        The bodies whose joints have the coordinates.
    polynomial : tuple of float
        q_follower is the sum of these coefficients times the powers 0 to 4 of q_leader.
    """

    name: str
    type: str
    follower: int
    leader: int
    polynomial: tuple[float, ...]


Tie = Loop | Follow


@dataclass(frozen=True)
class Spring:
    """A linear spring without mass between two points: a pull of `stiffness` times (distance - `length`).

    Attributes
    ----------
    first, second : End
        The points: origins of frames.
    stiffness, length : float
        N/m; the distance without force, m.
    """

    first: End
    second: End
    stiffness: float
    length: float


@dataclass(frozen=True)
class Drive:
    """What drives a robot beside gravity, in accelerations and motions.

    Attributes
    ----------
    tau : ndarray, shape (nv,)
        Constant forces of the joints, neutral.
    springs : tuple of Spring
        The springs.
    """

    tau: Array
    springs: tuple[Spring, ...] = ()


class Mechanics(Protocol):
    """A robot with loops in an engine."""

    def settings(self, method: str) -> Header:
        """List the settings on which the answers of a method depend, by name."""

    def accelerate(self, method: str, q: Array, v: Array, tau: Array) -> tuple[Array, int]:
        """Compute the acceleration at a state.

        Parameters
        ----------
        method : str
            One of `LoopMethods.accelerations`.
        q, v, tau : ndarray
            The state and the joints' forces, neutral.

        Returns
        -------
        acceleration : ndarray, shape (nv,)
            Neutral.
        nanoseconds : int
            Of the engine's calls, with the overhead of calling them through Python.
        """

    def move(self, method: str, q: Array, v: Array, motion: Motion) -> tuple[Array, Array, int]:
        """Run a motion under gravity and the drive.

        Parameters
        ----------
        method : str
            One of `LoopMethods.motions`.
        q, v : ndarray
            The state at its beginning, neutral.
        motion : Motion
            The steps.

        Returns
        -------
        q, v : ndarray, shape (records, nq) and (records, nv)
            The states after each `every` steps, neutral.
        nanoseconds : int
            As of `accelerate`.
        """


@dataclass(frozen=True)
class Motion:
    """The steps of a motion.

    Attributes
    ----------
    dt : float
        The length of a step, s.
    steps, every : int
        How many; and after how many of them the state is recorded.
    """

    dt: float
    steps: int
    every: int


# Makes the robot of a description, its loops and what drives it.
MakeMechanics = Callable[[Description, list[Tie], Drive], Mechanics]


@dataclass(frozen=True)
class LoopMethods:
    """How an engine holds loops.

    Attributes
    ----------
    make : callable
        `(description, ties, drive) -> Mechanics`.
    accelerations, motions : sequence of str
        The methods of both.
    types : mapping of str to str
        The types of loops that it holds, and by what.
    lacks : mapping of str to str
        Why it holds no loop of another type.
    """

    make: MakeMechanics
    accelerations: Sequence[str]
    motions: Sequence[str]
    types: Mapping[str, str] = field(default_factory=lambda: TYPES)
    lacks: Mapping[str, str] = field(default_factory=dict)


class Loops:
    """The robot with loops of a session.

    Parameters
    ----------
    engine : str
        The engine's name.
    methods : LoopMethods, optional
        How it holds loops, if it does.
    """

    def __init__(self, engine: str, methods: LoopMethods | None) -> None:
        self.engine, self.methods = engine, methods
        self.robot: tuple[Description, Mechanics] | None = None

    def hello(self) -> Header:
        """Tell what is offered."""
        if self.methods is None:
            return {}
        offered = {"accelerations": self.methods.accelerations, "motions": self.methods.motions}
        return {"loops": {**{kind: list(names) for kind, names in offered.items()}, "types": dict(self.methods.types)}}

    def prepare(self, header: Header, _blocks: Blocks) -> Answer:
        """Build a robot with its loops."""
        self.robot = None
        if self.methods is None:
            raise Unsupported(f"{self.engine} is not asked about loops")
        description = Description.read(header["model"])
        for body in description.bodies:
            if body.joint.type not in JOINTS:
                raise Unsupported(f"the coordinates of {body.joint.type} joints do not come back ({body.joint.name})")
        loops = [_read(item, description, self.methods) for item in header["model"].get("loops", [])]
        given = header.get("drive")
        drive = Drive(np.zeros(description.nv)) if given is None else _drive(given, description)
        self.robot = description, self.methods.make(description, loops, drive)
        driven = {} if given is None else {"driven": True}
        held = {loop.name: self.methods.types[loop.type] for loop in loops}
        return {"nq": description.nq, "nv": description.nv, **driven, "held": held}, {}

    def accelerations(self, header: Header, blocks: Blocks) -> Answer:
        """Answer block `acceleration` of shape (states, nv), and `nanoseconds` of `repeats` rounds."""
        description, robot = self._asked(header["method"], "accelerations")
        count, repeats = header["count"], header.get("repeats", 1)
        check_blocks(blocks, {"q": (count, description.nq), "v": (count, description.nv), "tau": (count, description.nv)})
        if not (count > 0 and repeats > 0):
            raise ValueError("count and repeats must be positive")
        found, nanoseconds = np.empty((count, description.nv)), 0
        with heard(self.engine):
            for _ in range(repeats):
                for k in range(count):
                    found[k], spent = robot.accelerate(header["method"], blocks["q"][k], blocks["v"][k], blocks["tau"][k])
                    nanoseconds += spent
        return {"nanoseconds": nanoseconds, "settings": robot.settings(header["method"])}, {"acceleration": found}

    def motion(self, header: Header, blocks: Blocks) -> Answer:
        """Answer blocks `q` and `v`, a row after each `every` steps, and `nanoseconds` of all steps."""
        description, robot = self._asked(header["method"], "motions")
        motion = Motion(header["dt"], header["steps"], header["every"])
        check_blocks(blocks, {"q": (description.nq,), "v": (description.nv,)})
        if not (np.isfinite(motion.dt) and motion.dt > 0):
            raise ValueError("dt must be positive and finite")
        if motion.steps < 1 or motion.every < 1 or motion.steps % motion.every:
            raise ValueError("steps must be a positive multiple of every")
        if motion.steps // motion.every * (description.nq + description.nv) > MOST_NUMBERS:
            raise ValueError(f"the motion would record more than {MOST_NUMBERS} numbers: record fewer of its steps")
        with heard(self.engine):
            q, v, nanoseconds = robot.move(header["method"], blocks["q"], blocks["v"], motion)
        return {"nanoseconds": nanoseconds, "settings": robot.settings(header["method"])}, {"q": q, "v": v}

    def _asked(self, method: str, kind: str) -> tuple[Description, Mechanics]:
        """Find the robot, if it and the method are there."""
        if method not in self.hello().get("loops", {}).get(kind, ()):
            raise Unsupported(f"{self.engine} offers no {kind} of loops by {method}")
        if self.robot is None:
            raise ValueError("no robot with loops was given before")
        return self.robot


def _read(item: Header, robot: Description, methods: LoopMethods) -> Tie:
    """Read a loop of a description."""
    kind = item["type"]
    if kind in methods.lacks:
        raise Unsupported(f"loop {item['name']}: {methods.lacks[kind]}")
    if kind not in methods.types or (kind == "point" and not all(item["axes"])):
        raise Unsupported(
            f"loop {item['name']}: engines are asked about loops that are fixed, spherical, revolute or a point along all axes, "
            "a distance, a gear or a mimic, where they have them"
        )
    return _follow(item, robot) if kind in ("gear", "mimic") else _between(item, len(robot.bodies))


def _between(item: Header, bodies: int) -> Loop:
    """Read a loop between two frames."""
    ends = []
    for side in ("first", "second"):
        body = item[side]["body"]
        if not (isinstance(body, int) and -1 <= body < bodies):
            raise ValueError(f"loop {item['name']}: there is no body {body}")
        ends.append(End(body, *read_placement(item[side]["placement"], f"loop {item['name']}: {side}")))
    if ends[0].body == ends[1].body:
        raise ValueError(f"loop {item['name']}: both ends are on body {ends[0].body}")
    length = float(item["length"]) if item["type"] == "distance" else 0.0
    if not np.isfinite(length) or (item["type"] == "distance" and length <= 0):
        raise ValueError(f"loop {item['name']}: length must be positive and finite")
    return Loop(item["name"], item["type"], ends[0], ends[1], length)


def _follow(item: Header, robot: Description) -> Follow:
    """Read a mimic, or a gear of two coordinates: c1 q1 + c2 q2 = offset."""
    if item["type"] == "mimic":
        follower, leader, numbers = item["follower"], item["leader"], [float(x) for x in item["polynomial"]]
    else:
        terms = item["terms"]
        if len(terms) != 2:
            raise Unsupported(f"loop {item['name']}: engines are asked about gears of two coordinates, and it has {len(terms)}")
        (follower, own), (leader, other) = ((term["body"], float(term["coefficient"])) for term in terms)
        numbers = [float(item["offset"]) / own, -other / own, 0.0, 0.0, 0.0]
    if len(numbers) != 5 or not np.isfinite(numbers).all():
        raise ValueError(f"loop {item['name']}: its coefficients must be finite, and five of a polynomial")
    for body in (follower, leader):
        if not (isinstance(body, int) and 0 <= body < len(robot.bodies)):
            raise ValueError(f"loop {item['name']}: there is no body {body}")
        if len(robot.bodies[body].joint.armature) != 1:
            raise ValueError(f"loop {item['name']}: the joint of body {body} has not one degree of freedom")
    return Follow(item["name"], item["type"], follower, leader, tuple(numbers))


def _drive(given: Header, robot: Description) -> Drive:
    """Read what drives a robot."""
    tau = np.array(given["tau"], dtype=float)
    if tau.shape != (robot.nv,) or not np.isfinite(tau).all():
        raise ValueError(f"drive: tau must be {robot.nv} finite numbers")
    if any(body.joint.type == "free" and tau[body.joint.v].any() for body in robot.bodies):
        raise Unsupported("a constant force of a free joint is not asked about: its axes turn")

    def point(end: Header) -> End:
        body, place = end["body"], np.array(end["point"], dtype=float)
        if not (isinstance(body, int) and -1 <= body < len(robot.bodies) and place.shape == (3,) and np.isfinite(place).all()):
            raise ValueError(f"drive: a spring is at {end}, which is no point of a body")
        return End(body, np.eye(3), place)

    springs = []
    for item in given["springs"]:
        spring = Spring(point(item["first"]), point(item["second"]), float(item["stiffness"]), float(item["length"]))
        if not (np.isfinite([spring.stiffness, spring.length]).all() and spring.stiffness > 0 and spring.length >= 0):
            raise ValueError("drive: a spring's stiffness must be positive, its length not negative, and both finite")
        if spring.first.body == spring.second.body:
            raise ValueError(f"drive: both ends of a spring are on body {spring.first.body}")
        springs.append(spring)
    return Drive(tau, tuple(springs))
