"""Time many states beside Pinocchio and MuJoCo, in turns.

Each candidate computes the same states; answers are compared before anything is timed. In each round all candidates run once, in random
order. The median of the ratios to ours at the same number of threads is printed, with the smallest and largest. Nothing here is a test.
"""

from __future__ import annotations

import argparse
import json
import os
import time
from pathlib import Path
from statistics import median

import numpy as np
import peers as engines

import featherbench

# Answers differ by roundings, which M of the humanoid enlarges by its condition number, some thousands, and fast chains by their size.
TOLERANCE = 1e-8


def compared(ours: engines.Peer, others: list[engines.Peer]) -> None:
    """Stop where an answer is not ours.

    Parameters
    ----------
    ours : Peer
        The first candidate.
    others : list of Peer
        The others.
    """
    due = ours.answer()
    for other in others:
        error = np.max(np.abs(other.answer() - due)) / np.max(np.abs(due))
        if not error <= TOLERANCE:
            raise SystemExit(f"{other.name} ({other.threads} threads) differs by {error:.1e} of the largest number: it is not timed")


def own(robot: featherbench.Robot, quantity: str, states: tuple[engines.Array, ...], threads: int) -> engines.Peer:
    """Make our candidate.

    Parameters
    ----------
    robot : featherbench.Robot
        The robot.
    quantity : str
        The name of the method.
    states : tuple of ndarray
        Its arguments.
    threads : int
        Its threads.

    Returns
    -------
    Peer
        It writes into one array.
    """
    out, method = np.empty_like(states[1]), getattr(robot, quantity)

    def call() -> object:
        return method(*states, out=out, threads=threads)

    return engines.Peer("featherbench", threads, call, lambda: np.array(call()))


def main() -> None:
    """Print a table for each robot and quantity, and write all of it as JSON."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--states", type=int, default=100_000)
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--threads", type=int, default=os.cpu_count() or 1, help="what all cores are")
    parser.add_argument("--json", type=Path, help="where the table is written")
    parser.add_argument("robots", nargs="*", default=["panda", "humanoid", "chain:n=36,layout=spatial"], help="descriptions, or families")
    arguments = parser.parse_args()
    order, table = np.random.default_rng(1), []
    for name in arguments.robots:
        robot, path = load(name)
        q = robot.random(seed=1, states=arguments.states)
        v, a = np.random.default_rng(1).uniform(-1, 1, (2, arguments.states, robot.nv))
        tau = robot.inverse_dynamics(q, v, a)
        others = engines.of(path, robot, (q, v, a, tau), arguments.threads)
        for absent in others.absent:
            print(f"left out: {absent}")
        counts = sorted({1, arguments.threads})
        for quantity, states, found in (
            ("inverse_dynamics", (q, v, a), others.inverse),
            ("forward_dynamics", (q, v, tau), others.forward),
        ):
            ours = [own(robot, quantity, states, count) for count in counts]
            compared(ours[0], [*ours[1:], *found])
            candidates = [*ours, *found]
            times: list[list[float]] = [[] for _ in candidates]
            for _ in range(arguments.rounds):
                for k in order.permutation(len(candidates)):
                    begin = time.perf_counter()
                    candidates[k].call()
                    times[k].append((time.perf_counter() - begin) / arguments.states)
            print(f"{name} (nv = {robot.nv}), {quantity}, {arguments.states} states")
            for candidate, measured in zip(candidates, times, strict=True):
                same = times[counts.index(candidate.threads)]
                ratios = [t / t_ours for t, t_ours in zip(measured, same, strict=True)]
                row = {
                    "robot": name,
                    "nv": robot.nv,
                    "quantity": quantity,
                    "candidate": candidate.name,
                    "threads": candidate.threads,
                    "ns_per_state": median(measured) * 1e9,
                    "ratio": median(ratios),
                    "ratio_low": min(ratios),
                    "ratio_high": max(ratios),
                }
                table.append(row)
                spread = f"{row['ratio_low']:.2f} to {row['ratio_high']:.2f}"
                time_of = f"{row['ns_per_state']:9.0f} ns per state, ratio {row['ratio']:.2f} ({spread})"
                print(f"  {candidate.name:<30} {candidate.threads} threads {time_of}")
    if arguments.json:
        arguments.json.write_text(json.dumps(table, indent=1) + "\n")


def load(name: str) -> tuple[featherbench.Robot, Path]:
    """Read a robot of datasets/models, or generate one.

    Parameters
    ----------
    name : str
        Its name, or a family with its parameters.

    Returns
    -------
    robot : featherbench.Robot
        The robot.
    path : Path
        Its description.
    """
    path = engines.ROOT / "datasets" / "models" / f"{name}.json"
    if path.exists():
        return featherbench.Robot.from_json(path), path
    robot = featherbench.Robot.generated(name)
    written = engines.ROOT / "target" / "python" / f"{robot.name}.json"
    written.parent.mkdir(parents=True, exist_ok=True)
    written.write_text(robot.to_json())
    return robot, written


if __name__ == "__main__":
    main()
