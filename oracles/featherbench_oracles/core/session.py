"""The main loop of an oracle: it reads a request, asks the engine, and writes the answer.

Every answer is computed for one state at a time. A function `(robot, question) -> numbers` of the engine's table
`quantities[quantity][method]` computes it.
"""

from __future__ import annotations

import os
import platform
import sys
import traceback
from collections.abc import Callable
from pathlib import Path
from typing import Any, NoReturn

import numpy as np

from featherbench_oracles.abilities import (
    FORMATS,
    HasContactRelaxations,
    HasContactSolvers,
    HasContactSteps,
    HasLoops,
    HasResidual,
    HasRods,
    HasSceneDerivatives,
    HasScenes,
    HasSemidefiniteSolvers,
    HasVariants,
    ReadsFiles,
    WritesFiles,
)
from featherbench_oracles.abilities.contact_steps import StepsOnContacts
from featherbench_oracles.abilities.contacts import Contacts
from featherbench_oracles.abilities.loops import Loops
from featherbench_oracles.abilities.rods import Rods
from featherbench_oracles.abilities.scenes import Scenes
from featherbench_oracles.abilities.semidefinite import SemidefiniteLeastSquares
from featherbench_oracles.core.clock import Measured, MeasuredStream, Stream, TimedCalls
from featherbench_oracles.core.examination import examined
from featherbench_oracles.core.messages import Answer, Blocks, Header, check_blocks, read_message, write_message
from featherbench_oracles.core.protocol import AS_READ, PROTOCOL, SHAPES, Engine, State, Unsupported
from featherbench_oracles.core.robot import Description


class Session:
    """The state between requests: the robot and its states.

    Parameters
    ----------
    engine : Engine
        The engine that answers.
    """

    def __init__(self, engine: Engine) -> None:
        self.engine = engine
        self.contacts = Contacts(
            engine.name,
            engine.contact_solvers if isinstance(engine, HasContactSolvers) else {},
            engine.contact_relaxations if isinstance(engine, HasContactRelaxations) else {},
        )
        self.contact_steps = StepsOnContacts(engine.name, engine.contact_steps if isinstance(engine, HasContactSteps) else {})
        self.loops = Loops(engine.name, engine.loops if isinstance(engine, HasLoops) else None)
        self.semidefinite = SemidefiniteLeastSquares(
            engine.name, engine.semidefinite_solvers if isinstance(engine, HasSemidefiniteSolvers) else {}
        )
        self.rods = Rods(engine.name, engine.rods if isinstance(engine, HasRods) else {})
        self.scenes = Scenes(
            engine.name,
            engine.scene_variants if isinstance(engine, HasScenes) else {},
            engine.scene_derivatives if isinstance(engine, HasSceneDerivatives) else {},
        )
        self.description: Description | None = None
        self.robot: Any = None
        self.states: Blocks | None = None
        self.as_read = False
        self.nothing: Any = None
        self.stream: tuple[Any, Stream] | None = None  # what was timed last: its key, and its calls
        self.measured: tuple[Any, MeasuredStream] | None = None  # the same of compiled loops

    def answer(self, header: Header, blocks: Blocks) -> Answer:
        """Answer one request.

        Parameters
        ----------
        header : dict
            The request.
        blocks : dict of str to ndarray
            Its blocks.

        Returns
        -------
        tuple of dict and dict
            The answer's header without its status, and the answer's blocks.

        Raises
        ------
        Unsupported
            If the engine has no such thing.
        ValueError
            If the request is malformed.
        """
        operations = {
            "hello": self.hello,
            "prepare": self.prepare,
            "import": self.import_file,
            "variants": self.variants,
            "rewrite": self.rewrite,
            "states": self.set_states,
            "evaluate": self.evaluate,
            "clock": self.clock,
            "relocate": self.relocate,
            "residual": self.residual,
            "contact_problems": self.contacts.set_problems,
            "solve_contacts": self.contacts.solve,
            "contact_steps": self.contact_steps.prepare,
            "solve_contact_steps": self.contact_steps.solve,
            "loops": self.loops.prepare,
            "loop_accelerations": self.loops.accelerations,
            "loop_motion": self.loops.motion,
            "semidefinite_least_squares": self.semidefinite.solve,
            "rod": self.rods.solve,
            "scene": self.scenes.simulate,
            "scene_derivative": self.scenes.differentiate,
        }
        if header.get("op") not in operations:
            raise ValueError(f"unknown op {header.get('op')}")
        return operations[header["op"]](header, blocks)

    def hello(self, _header: Header, _blocks: Blocks) -> Answer:
        """Name the engine and its methods."""
        engine = self.engine
        methods = {quantity: list(by_method) for quantity, by_method in engine.quantities.items()}
        build = {**engine.build, "python": platform.python_version()}
        hello = {"protocol": PROTOCOL, "engine": engine.name, "version": engine.version, "build": build, "methods": methods}
        listed = {
            "contact_solvers": self.contacts.solvers,
            "contact_relaxations": self.contacts.relaxations,
            "semidefinite_least_squares": self.semidefinite.solvers,
            "rods": self.rods.elements,
        }
        hello |= self.contact_steps.hello() | self.loops.hello() | self.scenes.hello()
        hello |= {key: list(solvers) for key, solvers in listed.items() if solvers}
        if isinstance(engine, WritesFiles):
            hello["writes"] = True
        if isinstance(engine, HasResidual):
            hello["residual"] = {"acceleration": engine.residual_acceleration}
        if any(isinstance(function, Measured) for by_method in engine.quantities.values() for function in by_method.values()):
            return {**hello, "clock": True, "relocate": True}, {}
        timed = {name: [m for m, f in by_method.items() if isinstance(f, TimedCalls)] for name, by_method in engine.quantities.items()}
        estimated = {name: listed for name, listed in timed.items() if listed}
        return ({**hello, "clock": "estimate", "timed": estimated} if estimated else hello), {}

    def prepare(self, header: Header, _blocks: Blocks) -> Answer:
        """Build the robot and read it back: block `readback` of shape (bodies, 22)."""
        self._forget()
        self.as_read = False
        if header["model"].get("loops"):
            raise Unsupported("the description has the section 'loops', and an oracle is asked about trees: leave the section out")
        description = Description.read(header["model"])
        robot = self.engine.prepare(description)
        readback = np.array(robot.readback()).reshape(len(description.bodies), 22)
        self.description, self.robot = description, robot
        return {"nq": description.nq, "nv": description.nv}, {"readback": readback}

    def import_file(self, header: Header, _blocks: Blocks) -> Answer:
        """Read a file by the engine's own parser, and tell what the engine then holds: block `keyframes` of shape (keyframes, nq)."""
        self._forget()
        self.as_read = True
        form, base = _asked_file(header)
        if not isinstance(self.engine, ReadsFiles):
            raise Unsupported(f"{self.engine.name} reads no files")
        if form not in self.engine.formats:
            raise Unsupported(f"{self.engine.name} reads {' and '.join(self.engine.formats).upper()}")
        reading = self.engine.read(examined(Path(header["file"]), form), form, base)
        self.description, self.robot = reading.description, reading.robot
        answer = {"nq": self.description.nq, "nv": self.description.nv, "model": reading.model, "notes": reading.notes}
        if reading.written is not None:
            answer["written"] = reading.written
        if not reading.keyframes:
            return answer, {}
        return {**answer, "keyframes": list(reading.keyframes)}, {"keyframes": np.array(list(reading.keyframes.values()))}

    def variants(self, header: Header, _blocks: Blocks) -> Answer:
        """Tell what a file would be to parsers that read something of it otherwise. The robot that the engine holds stays."""
        form, _ = _asked_file(header)
        if not isinstance(self.engine, HasVariants):
            raise Unsupported(f"{self.engine.name} tells no variants of files")
        return {"variants": self.engine.variants(examined(Path(header["file"]), form), form)}, {}

    def rewrite(self, header: Header, _blocks: Blocks) -> Answer:
        """Write a file again by the engine's writers. The robot that the engine holds stays."""
        form, _ = _asked_file(header)
        if not isinstance(self.engine, WritesFiles):
            raise Unsupported(f"{self.engine.name} writes no files")
        return {"written": self.engine.rewrite(examined(Path(header["file"]), form), form, Path(header["into"]))}, {}

    def set_states(self, header: Header, blocks: Blocks) -> Answer:
        """Keep the states for later evaluations."""
        if self.description is None:
            raise ValueError("no model was prepared")
        self.states = self.stream = self.measured = None
        n, nq, nv, bodies = header["count"], self.description.nq, self.description.nv, len(self.description.bodies)
        shapes = {"q": (n, nq), "v": (n, nv), "a": (n, nv), "tau": (n, nv), "wrench": (n, bodies, 6), "probe": (4, nv)}
        check_blocks(blocks, shapes, finite=False)
        self.states = blocks
        return {}, {}

    def evaluate(self, header: Header, _blocks: Blocks) -> Answer:
        """Answer one quantity by one method over a range of the states: block `value` of shape (count, *shape of the quantity)."""
        function, description, states, body = self._asked(header)
        quantity, (first, count) = header["quantity"], _range(header, states)
        entries = description.tree_sparse() if quantity == "mass_matrix_sparse" else None
        sizes = {"nv": description.nv, "bodies": len(description.bodies), "stored": len(entries[0]) if entries else 0}
        shape = tuple(sizes[n] if isinstance(n, str) else n for n in SHAPES[quantity])
        value = np.empty((count, *shape))
        for k in range(count):
            answer = function(self.robot, _state(states, first + k, body))
            value[k] = np.reshape(answer[entries] if entries else answer, shape)
        return {}, {"value": value}

    def residual(self, header: Header, _blocks: Blocks) -> Answer:
        """Answer the residual r(q, v, a) over a range of the states: block `value` of shape (count, nv)."""
        if not isinstance(self.engine, HasResidual):
            raise Unsupported(f"{self.engine.name} has no residual")
        description, states = self._held()
        (first, count), nv = _range(header, states), description.nv
        value = np.empty((count, nv))
        for k in range(count):
            row = np.asarray(self.engine.residual(self.robot, _state(states, first + k, 0)), dtype=float)
            if row.shape != (nv,) or not np.isfinite(row).all():
                raise ValueError(f"the residual of state {first + k} is not {nv} finite numbers: its shape is {list(row.shape)}")
            value[k] = row
        return {}, {"value": value}

    def clock(self, header: Header, _blocks: Blocks) -> Answer:
        """Time a method over a stream of the states: `nanoseconds` of the whole stream, and the `overhead` of calls through Python."""
        function, _, states, body = self._asked(header)
        first, count, asked = header["first"], header["count"], (header["quantity"], header["method"], body)
        if not isinstance(function, (TimedCalls, Measured)):
            raise Unsupported(
                f"{self.engine.name} does not time {header['quantity']} by {header['method']}: it is more than calls of the engine"
            )
        if not (first >= 0 and count > 0 and len(states["q"])):
            raise ValueError(f"there are no {count} states from {first} on")
        if isinstance(function, Measured):
            if self.measured is None or self.measured[0] != asked:
                self.measured = asked, function.stream(self.robot, [_state(states, k, body) for k in range(len(states["q"]))])
            return {"nanoseconds": self.measured[1].time(first, count)}, {}
        if self.stream is None or self.stream[0] != asked:
            self.nothing = self.nothing or self.engine.prepare(Description("nothing", np.array([0, 0, -9.81]), (), 0, 0))
            asks = [_state(states, k, body) for k in range(len(states["q"]))]
            self.stream = asked, Stream(function, self.robot, self.nothing, asks)
        nanoseconds, overhead = self.stream[1].time(first, count)
        return {"nanoseconds": nanoseconds, "overhead": overhead}, {}

    def relocate(self, header: Header, _blocks: Blocks) -> Answer:
        """Copy the data of the last compiled loop to other addresses. Where none was timed, there is nothing to copy."""
        if self.description is None:
            raise ValueError("no model was prepared")
        if self.measured is not None:
            self.measured[1].relocate(header["seed"])
        return {}, {}

    def _forget(self) -> None:
        """Forget the robot and its states."""
        self.description = self.robot = self.states = self.stream = self.measured = None

    def _asked(self, header: Header) -> tuple[Callable[[Any, State], Any], Description, Blocks, int]:
        """Find the method, the robot, its states and the body of a request, if all are there."""
        quantity, method = header["quantity"], header["method"]
        if method not in self.engine.quantities.get(quantity, {}):
            raise Unsupported(f"{self.engine.name} offers no method {method} for {quantity}")
        description, states = self._held()
        if self.as_read and quantity not in AS_READ:
            raise Unsupported(f"{quantity} is not told of a robot as read: its bodies need not be those of the description")
        body = header["body"] if quantity == "body_jacobian" else 0
        if not 0 <= body < len(description.bodies):
            raise ValueError(f"body {body} does not exist")
        return self.engine.quantities[quantity][method], description, states, body

    def _held(self) -> tuple[Description, Blocks]:
        """Find the robot and its states, if they are there."""
        if self.description is None or self.states is None:
            raise ValueError("no model and states were given before")
        return self.description, self.states


def _asked_file(header: Header) -> tuple[str, str]:
    """Read the format and the base of a request about a file."""
    form, base = header["format"], header.get("base", "fixed")
    if form not in FORMATS or base not in ("fixed", "free"):
        raise ValueError(f"there is no format {form} with base {base}")
    return form, base


def _range(header: Header, states: Blocks) -> tuple[int, int]:
    """Take the first state and their number from a request, if they exist."""
    first, count = header["first"], header["count"]
    if not 0 <= first <= first + count <= len(states["q"]):
        raise ValueError(f"states {first}..{first + count} do not exist")
    return first, count


def _state(states: Blocks, k: int, body: int) -> State:
    """Take state k from the blocks."""
    row = {name: states[name][k] for name in ("q", "v", "a", "tau", "wrench")}
    return State(**row, probe=states["probe"], body=body)


def serve(engine: Engine) -> NoReturn:
    """Answer requests until standard input ends, then exit. What an engine prints goes to standard error.

    Parameters
    ----------
    engine : Engine
        The engine that answers.
    """
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    session = Session(engine)
    running = True
    while running:
        echo: Header = {}
        try:
            request = read_message(sys.stdin.buffer)
            running = request is not None
            if request is not None:
                echo = {key: request[0][key] for key in ("id",) if key in request[0]}
                header, blocks = session.answer(*request)
                write_message(answers, {"status": "ok", **echo, **header}, blocks)
        except Unsupported as reason:
            write_message(answers, {"status": "unsupported", **echo, "reason": _sentence(reason)})
        except BrokenPipeError:
            running = False
        except Exception as reason:  # an engine's failure is an answer
            traceback.print_exc()
            write_message(answers, {"status": "error", **echo, "reason": _sentence(reason)})
    # JAX and Warp take many seconds to let go of what they compiled.
    sys.stderr.flush()
    os._exit(0)


def _sentence(reason: Exception) -> str:
    """Write the exception in one line."""
    text = " ".join(str(reason).split()) or "no message"
    return text if isinstance(reason, (Unsupported, ValueError)) else f"{type(reason).__name__}: {text}"
