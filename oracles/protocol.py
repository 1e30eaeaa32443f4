"""The oracle protocol (PROTOCOL.md) without any engine: frames, the robot description, the main loop.

An engine's file defines an `Engine` and calls `serve(engine)`. Every answer is computed for one state at a time, by a function
`(robot, question) -> numbers` from the engine's table `quantities[quantity][method]`.
"""

from __future__ import annotations

import json
import math
import os
import sys
import traceback
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO, Protocol

import numpy as np
from numpy.typing import NDArray

from clock import Calls, Stream
from examination import examined

Array = NDArray[np.float64]
Blocks = dict[str, Array]
Header = dict[str, Any]
Answer = tuple[Header, Blocks]
PROTOCOL = 1


class Unsupported(Exception):
    """The engine has no such joint, quantity or method."""


# ---- frames ----------------------------------------------------------------------------------------------------------------------


def read_frame(stream: BinaryIO) -> Answer | None:
    """The next header and its blocks; None at the end of the stream."""
    line = stream.readline()
    if not line:
        return None
    header = json.loads(line)
    if not isinstance(header, dict):
        raise ValueError("a frame's header is not a JSON object")
    blocks: Blocks = {}
    for block in header.get("blocks", []):
        shape = tuple(block["shape"])
        if not all(isinstance(n, int) and n >= 0 for n in shape):
            raise ValueError(f"block {block['name']} has the shape {list(shape)}")
        size = 8 * math.prod(shape)
        data = stream.read(size)
        if len(data) < size:
            raise EOFError(f"the stream ended within block {block['name']}")
        blocks[block["name"]] = np.frombuffer(data, "<f8").reshape(shape).astype(np.float64)
    return header, blocks


def write_frame(stream: BinaryIO, header: Header, blocks: Blocks | None = None) -> None:
    """Writes a header with the announcement of `blocks`, then the blocks."""
    frame = dict(header)
    if blocks:
        frame["blocks"] = [{"name": name, "shape": list(block.shape)} for name, block in blocks.items()]
    stream.write(json.dumps(frame).encode() + b"\n")
    for block in (blocks or {}).values():
        stream.write(np.ascontiguousarray(block, "<f8").tobytes())
    stream.flush()


# ---- the robot -------------------------------------------------------------------------------------------------------------------

# joint type -> (numbers in q, numbers in v)
JOINT_SIZES = {
    "revolute": (1, 1),
    "prismatic": (1, 1),
    "helical": (1, 1),
    "spherical": (4, 3),
    "free": (7, 6),
    "planar": (3, 3),
    "universal": (2, 2),
    "translation": (3, 3),
    "cylindrical": (2, 2),
    "euler_zyx": (3, 3),
}
WITH_AXIS = ("revolute", "prismatic", "helical", "cylindrical")


@dataclass(frozen=True)
class Joint:
    """A joint; `q` and `v` are its ranges in the neutral coordinates. Damping and dry friction are excluded everywhere: not kept."""

    name: str
    type: str
    axis: Array  # unit vector; zero for types without an axis
    pitch: float  # metres per radian
    rotation: Array  # joint axes to parent axes
    translation: Array
    armature: Array
    q: slice
    v: slice


@dataclass(frozen=True)
class Body:
    """A rigid body, the child of `joint`; its inertia is about the centre of mass in body axes. Parent -1 is the world."""

    name: str
    mass: float
    com: Array
    inertia: Array  # 3x3
    parent: int
    joint: Joint


@dataclass(frozen=True)
class Description:
    """A robot: bodies in depth-first order, body i being the child of joint i."""

    name: str
    gravity: Array
    bodies: tuple[Body, ...]
    nq: int
    nv: int

    @classmethod
    def read(cls, data: Mapping[str, Any]) -> Description:
        """Reads and validates the JSON form; raises ValueError (or KeyError) naming what is malformed."""
        if data["format"] != 1:
            raise ValueError(f"description format {data['format']} is not 1")
        bodies: list[Body] = []
        branch: list[int] = [-1]  # from the world to the last body
        nq = nv = 0
        for i, item in enumerate(data["bodies"]):
            joint = _read_joint(item["joint"], nq, nv)
            nq, nv = joint.q.stop, joint.v.stop
            where = f"body {item['name']}"
            parent = item["parent"]
            if parent not in branch:
                raise ValueError(f"{where}: its parent {parent} breaks the depth-first order")
            branch = [*branch[: branch.index(parent) + 1], i]
            mass = float(_numbers(item["mass"], (), f"{where}: mass"))
            inertia = symmetric(_numbers(item["inertia"], (6,), f"{where}: inertia"))
            bodies.append(Body(item["name"], mass, _numbers(item["com"], (3,), f"{where}: com"), inertia, parent, joint))
        return cls(data["name"], _numbers(data["gravity"], (3,), "gravity"), tuple(bodies), nq, nv)

    def tree_sparse(self) -> tuple[list[int], list[int]]:
        """Rows and columns of what the tree-sparse layout holds of M: for each dof the entries with those from the root to it."""
        paths: list[list[int]] = []  # of the last dof of each body
        rows: list[int] = []
        columns: list[int] = []
        for body in self.bodies:
            path = list(paths[body.parent]) if body.parent >= 0 else []
            for dof in range(body.joint.v.start, body.joint.v.stop):
                path.append(dof)
                rows += [dof] * len(path)
                columns += path
            paths.append(path)
        return rows, columns


def _read_joint(data: Mapping[str, Any], nq: int, nv: int) -> Joint:
    """The joint whose coordinates begin at `nq` and `nv`."""
    name, kind, where = data["name"], data["type"], f"joint {data['name']}"
    if kind not in JOINT_SIZES:
        raise ValueError(f"{where}: unknown type {kind}")
    sizes = JOINT_SIZES[kind]
    axis = _numbers(data["axis"], (3,), f"{where}: axis") if kind in WITH_AXIS else np.zeros(3)
    if kind in WITH_AXIS and abs(np.linalg.norm(axis) - 1) > 1e-9:
        raise ValueError(f"{where}: its axis is not a unit vector")
    pitch = float(_numbers(data["pitch"], (), f"{where}: pitch")) if kind == "helical" else 0.0
    rotation = _numbers(data["placement"]["rotation"], (9,), f"{where}: rotation").reshape(3, 3)
    if np.abs(rotation @ rotation.T - np.eye(3)).max() > 1e-9 or np.linalg.det(rotation) < 0:
        raise ValueError(f"{where}: its placement's rotation is not a rotation")
    translation = _numbers(data["placement"]["translation"], (3,), f"{where}: translation")
    armature = _numbers(data["armature"], (sizes[1],), f"{where}: armature")
    q, v = slice(nq, nq + sizes[0]), slice(nv, nv + sizes[1])
    return Joint(name, kind, axis, pitch, rotation, translation, armature, q, v)


def _numbers(value: Any, shape: tuple[int, ...], what: str) -> Array:
    """`value` as an array of finite numbers of that shape."""
    array = np.asarray(value, dtype=np.float64)
    if array.shape != shape or not np.isfinite(array).all():
        raise ValueError(f"{what}: expected {math.prod(shape)} finite number(s)")
    return array


# ---- small mathematics that every engine's file needs ----------------------------------------------------------------------------


def symmetric(six: Array) -> Array:
    """The symmetric matrix of (xx, xy, xz, yy, yz, zz)."""
    xx, xy, xz, yy, yz, zz = six
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def rotation(quaternion: Array) -> Array:
    """R of the quaternion (x, y, z, w) of any length: I + 2 (w [u]x + [u]x^2) / |quaternion|^2."""
    u, w = skew(quaternion[:3]), quaternion[3]
    return np.eye(3) + (2 / (quaternion @ quaternion)) * (w * u + u @ u)


def skew(u: Array) -> Array:
    """The matrix of the product u x."""
    x, y, z = u
    return np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])


def readback_row(mass: float, com: Array, inertia: Array, rotation: Array, translation: Array) -> Array:
    """One body's row of the answer to `prepare`."""
    return np.concatenate([[mass], com, inertia[np.triu_indices(3)], rotation.ravel(), translation])


def mass_matrix_probe(product: Callable[[Array], Array], diagonal: Array, probe: Array) -> Array:
    """M x for the rows x of `probe`, the diagonal of M, its last row; `product` is x -> M x."""
    last = np.zeros_like(diagonal)
    last[-1] = 1
    return np.array([*map(product, probe), diagonal, product(last)])


@dataclass(frozen=True)
class Change:
    """The change from neutral to engine (e) coordinates at one state: v_e = T v, hence a_e = T a + b with b = (dT/dt) v.

    T is block diagonal and every block is orthogonal, so power is kept by tau_e = T^-T tau = T tau, and everything returns by T':
    tau = T' tau_e, M = T' M_e T, h = T' (h_e + M_e b), J = J_e T. `blocks` holds T's blocks that are not identity.
    """

    blocks: tuple[tuple[slice, Array], ...]
    b: Array

    def _forth(self, x: Array) -> Array:
        y = x.copy()
        for s, t in self.blocks:
            y[s] = t @ x[s]
        return y

    def _back(self, x: Array) -> Array:
        y = x.copy()
        for s, t in self.blocks:
            y[s] = t.T @ x[s]
        return y

    def to_engine_v(self, v: Array) -> Array:
        """v_e = T v."""
        return self._forth(v)

    def to_engine_a(self, a: Array) -> Array:
        """a_e = T a + b."""
        return self._forth(a) + self.b

    def to_neutral_a(self, a_e: Array) -> Array:
        """a = T' (a_e - b)."""
        return self._back(a_e - self.b)

    def to_engine_tau(self, tau: Array) -> Array:
        """tau_e = T tau."""
        return self._forth(tau)

    def to_neutral_tau(self, tau_e: Array) -> Array:
        """tau = T' tau_e."""
        return self._back(tau_e)

    def to_neutral_mass(self, mass_e: Array) -> Array:
        """M = T' M_e T, for a symmetric M_e."""
        return self._back(self._back(mass_e).T)

    def to_neutral_jacobian(self, jacobian_e: Array) -> Array:
        """J = J_e T."""
        return self._back(jacobian_e.T).T


# ---- the engine and the main loop ------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Question:
    """One state, and the body asked about where the quantity is one body's."""

    q: Array
    v: Array
    a: Array
    tau: Array
    wrench: Array
    probe: Array
    body: int


@dataclass(frozen=True)
class Reading:
    """What an engine holds of a file that its own parser read: the description in both forms, notes (`reading.note`), the engine's robot
    in the description's coordinates, and the file's keyframes by name. `written` is the description with the file's own inertias, where the
    engine refuses those and holds repaired ones."""

    model: Header
    description: Description
    notes: list[Header]
    robot: Any
    keyframes: dict[str, Array]
    written: Header | None = None


class Robot(Protocol):
    """One robot built through the engine's API."""

    def readback(self) -> list[Array]:
        """What the engine holds of each body, by `readback_row`."""


class Engine(Protocol):
    """What an engine's file gives to `serve`."""

    name: str
    version: str
    build: dict[str, str]
    quantities: Mapping[str, Mapping[str, Callable[[Any, Question], Any]]]

    def prepare(self, description: Description) -> Robot:
        """Builds the robot; raises `Unsupported` naming what the engine cannot do."""


# quantity -> shape per state
SHAPES: dict[str, tuple[str | int, ...]] = {
    "id": ("nv",),
    "id_wrench": ("nv",),
    "bias": ("nv",),
    "mass_matrix": ("nv", "nv"),
    "mass_matrix_probe": (6, "nv"),
    "fd": ("nv",),
    "kinetic_energy": (1,),
    "potential_energy": (1,),
    "com": (3,),
    "momentum": (6,),
    "body_placement": ("bodies", 12),
    "body_velocity": ("bodies", 6),
    "body_acceleration": ("bodies", 6),
    "body_jacobian": (6, "nv"),
    "stored_entries": (1,),
    "mass_matrix_sparse": ("stored",),
}


# What is told of a robot as an engine read it: what does not ask for single bodies, nor counts masses that are fixed to the world.
AS_READ = ("id", "bias", "mass_matrix", "mass_matrix_probe", "fd", "kinetic_energy")


class Session:
    """The state between requests: the robot and its states."""

    def __init__(self, engine: Engine) -> None:
        self.engine = engine
        self.description: Description | None = None
        self.robot: Robot | None = None
        self.states: Blocks | None = None
        self.as_read = False
        self.nothing: Robot | None = None
        self.stream: tuple[Any, Stream] | None = None  # what was timed last, and by what it is known

    def answer(self, header: Header, blocks: Blocks) -> Answer:
        """The answer to one request, without its status."""
        operations = {
            "hello": self.hello,
            "prepare": self.prepare,
            "read": self.read,
            "states": self.set_states,
            "evaluate": self.evaluate,
            "clock": self.clock,
        }
        if header.get("op") not in operations:
            raise ValueError(f"unknown op {header.get('op')}")
        return operations[header["op"]](header, blocks)

    def hello(self, _header: Header, _blocks: Blocks) -> Answer:
        """Who answers, and by which methods."""
        engine = self.engine
        methods = {quantity: list(by_method) for quantity, by_method in engine.quantities.items()}
        hello = {"protocol": PROTOCOL, "engine": engine.name, "version": engine.version, "build": engine.build, "methods": methods}
        timed = {name: [m for m, f in by_method.items() if isinstance(f, Calls)] for name, by_method in engine.quantities.items()}
        estimated = {name: listed for name, listed in timed.items() if listed}
        return ({**hello, "clock": "estimate", "timed": estimated} if estimated else hello), {}

    def prepare(self, header: Header, _blocks: Blocks) -> Answer:
        """Builds the robot and reads it back."""
        self.description = self.robot = self.states = self.stream = None
        self.as_read = False
        description = Description.read(header["model"])
        robot = self.engine.prepare(description)
        readback = np.array(robot.readback()).reshape(len(description.bodies), 22)
        self.description, self.robot = description, robot
        return {"nq": description.nq, "nv": description.nv}, {"readback": readback}

    def read(self, header: Header, _blocks: Blocks) -> Answer:
        """Has the engine's own parser read a file, and tells what the engine then holds."""
        self.description = self.robot = self.states = self.stream = None
        self.as_read = True
        form, base = header["format"], header.get("base", "fixed")
        if form not in ("urdf", "mjcf") or base not in ("fixed", "free"):
            raise ValueError(f"there is no format {form} with base {base}")
        reader: Callable[[Path, str, str], Reading] | None = getattr(self.engine, "read", None)
        if reader is None:
            raise Unsupported(f"{self.engine.name} reads no files")
        reading = reader(examined(Path(header["file"])), form, base)
        self.description, self.robot = reading.description, reading.robot
        answer = {"nq": self.description.nq, "nv": self.description.nv, "model": reading.model, "notes": reading.notes}
        if reading.written is not None:
            answer["written"] = reading.written
        if not reading.keyframes:
            return answer, {}
        return {**answer, "keyframes": list(reading.keyframes)}, {"keyframes": np.array(list(reading.keyframes.values()))}

    def set_states(self, header: Header, blocks: Blocks) -> Answer:
        """Keeps the states for the evaluations to come."""
        if self.description is None:
            raise ValueError("no model was prepared")
        self.states = self.stream = None
        n, nq, nv, bodies = header["count"], self.description.nq, self.description.nv, len(self.description.bodies)
        shapes = {"q": (n, nq), "v": (n, nv), "a": (n, nv), "tau": (n, nv), "wrench": (n, bodies, 6), "probe": (4, nv)}
        for name, shape in shapes.items():
            if name not in blocks or blocks[name].shape != shape:
                raise ValueError(f"block {name} is missing or not of shape {list(shape)}")
        self.states = blocks
        return {}, {}

    def evaluate(self, header: Header, _blocks: Blocks) -> Answer:
        """One quantity by one method over a range of the states."""
        function, description, body = self._asked(header)
        quantity, first, count = (header[key] for key in ("quantity", "first", "count"))
        if not 0 <= first <= first + count <= len(self.states["q"]):
            raise ValueError(f"states {first}..{first + count} do not exist")
        entries = description.tree_sparse() if quantity == "mass_matrix_sparse" else None
        sizes = {"nv": description.nv, "bodies": len(description.bodies), "stored": len(entries[0]) if entries else 0}
        shape = tuple(sizes[n] if isinstance(n, str) else n for n in SHAPES[quantity])
        value = np.empty((count, *shape))
        for k in range(count):
            answer = function(self.robot, self._question(first + k, body))
            value[k] = np.reshape(answer[entries] if entries else answer, shape)
        return {}, {"value": value}

    def clock(self, header: Header, _blocks: Blocks) -> Answer:
        """The time of a method's own calls over a stream of the states."""
        function, _, body = self._asked(header)
        first, count, asked = header["first"], header["count"], (header["quantity"], header["method"], body)
        if not isinstance(function, Calls):
            raise Unsupported(f"{self.engine.name} does not time {header['quantity']} by {header['method']}: it is more than calls of the engine")
        if not (0 <= first and 0 < count and len(self.states["q"])):
            raise ValueError(f"there are no {count} states from {first} on")
        if self.stream is None or self.stream[0] != asked:
            self.nothing = self.nothing or self.engine.prepare(Description("nothing", np.array([0, 0, -9.81]), (), 0, 0))
            questions = [self._question(k, body) for k in range(len(self.states["q"]))]
            self.stream = asked, Stream(function, self.robot, self.nothing, questions)
        nanoseconds, overhead = self.stream[1].time(first, count)
        return {"nanoseconds": nanoseconds, "overhead": overhead}, {}

    def _asked(self, header: Header) -> tuple[Callable[[Any, Question], Any], Description, int]:
        """The method that is asked for, the robot and the body, if all is there."""
        quantity, method = header["quantity"], header["method"]
        if method not in self.engine.quantities.get(quantity, {}):
            raise Unsupported(f"{self.engine.name} offers no method {method} for {quantity}")
        if self.description is None or self.states is None:
            raise ValueError("no model and states were given before")
        if self.as_read and quantity not in AS_READ:
            raise Unsupported(f"{quantity} is not told of a robot as read: its bodies need not be those of the description")
        body = header["body"] if quantity == "body_jacobian" else 0
        if not 0 <= body < len(self.description.bodies):
            raise ValueError(f"body {body} does not exist")
        return self.engine.quantities[quantity][method], self.description, body

    def _question(self, k: int, body: int) -> Question:
        """State k."""
        row = {name: self.states[name][k] for name in ("q", "v", "a", "tau", "wrench")}
        return Question(**row, probe=self.states["probe"], body=body)


def serve(engine: Engine) -> None:
    """Answers requests until the standard input ends. Whatever an engine prints itself goes to the standard error."""
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    session = Session(engine)
    running = True
    while running:
        echo: Header = {}
        try:
            request = read_frame(sys.stdin.buffer)
            running = request is not None
            if request is not None:
                echo = {key: request[0][key] for key in ("id",) if key in request[0]}
                header, blocks = session.answer(*request)
                write_frame(answers, {"status": "ok", **echo, **header}, blocks)
        except Unsupported as reason:
            write_frame(answers, {"status": "unsupported", **echo, "reason": _sentence(reason)})
        except BrokenPipeError:
            running = False
        except Exception as reason:  # an engine's failure is an answer
            traceback.print_exc()
            write_frame(answers, {"status": "error", **echo, "reason": _sentence(reason)})


def _sentence(reason: Exception) -> str:
    """The exception in one line."""
    text = " ".join(str(reason).split()) or "no message"
    return text if isinstance(reason, (Unsupported, ValueError)) else f"{type(reason).__name__}: {text}"
