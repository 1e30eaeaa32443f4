"""The errors of the estimated times of Drake and DART: the clock of the oracles against loops in C++ over the same libraries.

    PYTHONPATH=oracles PYTHON ci/estimates.py drake|dart --eigen FOLDER       PYTHON is the engines' environment's, FOLDER holds Eigen/Core

Needs g++ and a quiet machine. The C++ loops call functions that the packages' libraries export, on the same objects that Python holds.
"""

from __future__ import annotations

import argparse
import ctypes
import importlib
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from featherbench_oracles.core.clock import Stream
from featherbench_oracles.core.protocol import State
from featherbench_oracles.core.robot import JOINT_SIZES, Description
from featherbench_oracles.testing.draws import random_states

ROOT = Path(__file__).resolve().parent.parent
ROBOTS = ("ur5", "panda", "anymal_c", "g1")
QUANTITIES = {"id": "inverse_dynamics", "kinetic_energy": "kinetic_energy"}
STATES, CALLS, BLOCKS = 22, 60, 301


def main() -> None:
    """Print a line for each robot and quantity."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("engine", choices=["drake", "dart"])
    parser.add_argument("--eigen", type=Path, required=True)
    arguments = parser.parse_args()
    os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    sys.setdlopenflags(os.RTLD_NOW | os.RTLD_GLOBAL)  # the loops find the engine's symbols in what Python has loaded
    module = importlib.import_module(f"featherbench_oracles.{arguments.engine}.oracle")
    engine = getattr(module, {"drake": "Drake", "dart": "Dart"}[arguments.engine])()
    library = compiled(arguments.engine, arguments.eigen)
    print(f"{'robot':<10} {'quantity':<15} {'C++ ns':>8} {'estimate':>9} {'overhead':>9} {'off by':>7}")
    for robot in ROBOTS:
        for quantity in QUANTITIES:
            true, estimate, overhead = held_against(engine, library, robot, quantity)
            print(
                f"{robot:<10} {quantity:<15} {true:8.0f} {estimate:9.0f} {overhead:9.0f} {100 * (estimate / true - 1):+6.1f}%", flush=True
            )


def compiled(engine: str, eigen: Path) -> ctypes.CDLL:
    """Compile the loops. Drake's symbols are in its own library, DART's in its module."""
    folder = Path(tempfile.mkdtemp())
    command = ["g++", "-std=c++20", "-O2", "-DNDEBUG", "-fPIC", "-shared", "-isystem", str(eigen)]
    subprocess.run([*command, str(ROOT / f"ci/estimates/{engine}.cc"), "-o", str(folder / "loops.so")], check=True)
    if engine == "drake":
        import pydrake

        ctypes.CDLL(str(Path(pydrake.__file__).parent / "lib/libdrake.so"), mode=ctypes.RTLD_GLOBAL)
    library = ctypes.CDLL(str(folder / "loops.so"))
    library.loop.restype = ctypes.c_double
    return library


def described(name: str) -> Description:
    """Read a robot of datasets/models; armature that is left out is zero."""
    data = json.loads((ROOT / f"datasets/models/{name}.json").read_text())
    for joint in (body["joint"] for body in data["bodies"]):
        joint.setdefault("armature", [0.0] * JOINT_SIZES[joint["type"]][1])
    return Description.read(data)


def held_against(engine: Any, library: ctypes.CDLL, name: str, quantity: str) -> NDArray[np.float64]:
    """Measure nanoseconds of a call in C++ and by the estimate, and the overhead: medians of alternating blocks."""
    description = described(name)
    robot, nothing = engine.prepare(description), engine.prepare(Description("nothing", np.array([0, 0, -9.81]), (), 0, 0))
    drawn = random_states(np.random.default_rng(1), description)
    rows = [[drawn[key][k] for key in ("q", "v", "a", "tau", "wrench")] for k in range(STATES)]
    asks = [State(q, v, a, tau, wrench, drawn["probe"], 0) for q, v, a, tau, wrench in rows]
    method = engine.quantities[quantity][QUANTITIES[quantity]]
    stream = Stream(method, robot, nothing, asks)
    changes = [robot.change(ask) for ask in asks]
    q = np.array([robot.positions(ask.q) for ask in asks])
    v = np.array([change.to_engine_v(ask.v) for ask, change in zip(asks, changes, strict=True)])
    a = np.array([change.to_engine_a(ask.a) for ask, change in zip(asks, changes, strict=True)])
    held = [robot.skeleton] if hasattr(robot, "skeleton") else [robot.plant, robot.context, robot.forces]
    # pybind11 keeps the pointer to the C++ object behind the head of the Python object.
    engine_pointers = (ctypes.c_void_p * len(held))(*(ctypes.c_void_p.from_address(id(each) + 16).value for each in held))
    answer = np.zeros(description.nv)
    numbers = [array.ctypes.data_as(ctypes.c_void_p) for array in (q, v, a, answer)]

    def loop(calls: int) -> float:
        shape = (STATES, q.shape[1], v.shape[1])
        spent: float = library.loop(ctypes.c_char(quantity[0].encode()), engine_pointers, *shape, *numbers[:3], calls, numbers[3])
        return spent

    loop(STATES)
    due = np.atleast_1d(stream.call(*stream.states[-1]))
    if not np.array_equal(answer[: len(due)], due):
        raise RuntimeError(f"the loop in C++ computes something else than {quantity} of {name}")
    blocks = []
    for _ in range(BLOCKS):
        nanoseconds, overhead = stream.time(0, CALLS)
        loop(CALLS // 10)
        blocks.append((loop(CALLS), nanoseconds / CALLS, overhead / CALLS))
    return np.median(blocks, axis=0)


if __name__ == "__main__":
    main()
