"""Time one state per call, and the import.

The overhead of a call is the time of a call for a pendulum of one joint: its kernel takes some ten nanoseconds. Rounds alternate; medians
are printed.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import time
from collections.abc import Callable
from functools import partial
from statistics import median

import numpy as np
import peers as engines
from states import load

CALLS = 2000
IMPORT = (
    "import time, numpy; begin = time.perf_counter(); import featherbench; print(time.perf_counter() - begin)",
    "import time; begin = time.perf_counter(); import featherbench; print(time.perf_counter() - begin)",
)


def timed(call: Callable[[], object], count: int) -> float:
    """Time calls in a loop.

    Parameters
    ----------
    call : callable
        What is timed.
    count : int
        How often.

    Returns
    -------
    float
        Nanoseconds per call.
    """
    begin = time.perf_counter_ns()
    for _ in range(count):
        call()
    return (time.perf_counter_ns() - begin) / count


def measure(name: str, rounds: int) -> None:
    """Print a table of one robot.

    Parameters
    ----------
    name : str
        The robot.
    rounds : int
        Times of each candidate.
    """
    robot, path = load(name)
    q = robot.random(seed=1, states=1)
    v, a = np.random.default_rng(1).uniform(-1, 1, (2, 1, robot.nv))
    tau = robot.inverse_dynamics(q, v, a)
    peers = engines.of(path, robot, (q, v, a, tau), 1)
    out = np.empty(robot.nv)
    for quantity, x, found in (("inverse_dynamics", a, peers.inverse), ("forward_dynamics", tau, peers.forward)):
        method = getattr(robot, quantity)
        state = q[0].copy(), v[0].copy(), x[0].copy()
        calls: dict[str, Callable[[], object]] = {
            "a call": partial(method, *state),
            "a call with out": partial(method, *state, out=out),
            "a call of nothing": partial(len, ()),
            **{peer.name: peer.call for peer in found if peer.name.endswith("a loop")},
        }
        times: dict[str, list[float]] = {candidate: [] for candidate in calls}
        for _ in range(rounds):
            for candidate, call in calls.items():
                times[candidate].append(timed(call, CALLS))
        print(f"{name} (nv = {robot.nv}), {quantity}")
        for candidate, measured in times.items():
            print(f"  {candidate:<20} {median(measured):9.0f} ns ({min(measured):.0f} to {max(measured):.0f})")


def main() -> None:
    """Print a table for each robot, and the time of the import."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=21)
    parser.add_argument("robots", nargs="*", default=["chain:n=1", "panda", "humanoid", "chain:n=36,layout=spatial"])
    arguments = parser.parse_args()
    for name in arguments.robots:
        measure(name, arguments.rounds)
    for words, code in zip(("after numpy's", "with numpy's"), IMPORT, strict=True):
        runs = [float(subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout) for _ in range(11)]
        print(f"import featherbench, {words}: {median(runs) * 1e3:.1f} ms")


if __name__ == "__main__":
    main()
