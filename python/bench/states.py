"""Time many states, and single calls, beside Pinocchio, in turns.

Each candidate computes the same states. In each round all candidates run once, in random order; the median of the ratios to the first is
printed, with the smallest and largest. Nothing here is a test.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Callable
from pathlib import Path
from statistics import median

import numpy as np

import featherbench

MODELS = Path(__file__).parents[2] / "datasets" / "models"


def candidates(robot: featherbench.Robot, path: Path, states: int) -> dict[str, dict[str, Callable[[], object]]]:
    """Give the functions to time, by quantity and name."""
    q = robot.random(seed=1, states=states)
    v, x = np.random.default_rng(1).uniform(-1, 1, (2, states, robot.nv))
    out = np.empty_like(v)
    one = q[0].copy(), v[0].copy(), x[0].copy()
    ours: dict[str, dict[str, Callable[[], object]]] = {
        "inverse dynamics": {
            "featherbench, one core": lambda: robot.inverse_dynamics(q, v, x, out=out),
            "featherbench, all cores": lambda: robot.inverse_dynamics(q, v, x, out=out, threads=None),
            "featherbench, a loop": lambda: [robot.inverse_dynamics(*one) for _ in range(states)],
        },
        "forward dynamics": {
            "featherbench, one core": lambda: robot.forward_dynamics(q, v, x, out=out),
            "featherbench, all cores": lambda: robot.forward_dynamics(q, v, x, out=out, threads=None),
            "featherbench, a loop": lambda: [robot.forward_dynamics(*one) for _ in range(states)],
        },
    }
    try:
        import pinocchio as pin
        from featherbench_oracles.pinocchio.building import build
        from featherbench_oracles.robot import Description
    except ImportError as missing:
        print(f"Pinocchio is left out: {missing} (put oracles/ on PYTHONPATH)")
        return ours
    description = json.loads(path.read_text())
    for body, joint in zip(description["bodies"], robot.joints, strict=True):
        body["joint"].setdefault("armature", [0.0] * (joint.v[1] - joint.v[0]))  # a file may leave out what is zero
    model = build(Description.read(description))
    data = model.createData()
    theirs = robot.to_pinocchio(q)
    ours["inverse dynamics"]["Pinocchio, a loop"] = lambda: [pin.rnea(model, data, *state) for state in zip(theirs, v, x, strict=True)]
    ours["forward dynamics"]["Pinocchio, a loop"] = lambda: [pin.aba(model, data, *state) for state in zip(theirs, v, x, strict=True)]
    return ours


def main() -> None:
    """Print a table for each robot and quantity."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--states", type=int, default=100_000)
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("robots", nargs="*", default=["panda", "humanoid", "chain-spatial-50"])
    arguments = parser.parse_args()
    order = np.random.default_rng(1)
    for name in arguments.robots:
        path = MODELS / f"{name}.json"
        robot = featherbench.Robot.from_json(path)
        for quantity, functions in candidates(robot, path, arguments.states).items():
            times: dict[str, list[float]] = {candidate: [] for candidate in functions}
            for _ in range(arguments.rounds):
                for candidate in order.permutation(list(functions)):
                    begin = time.perf_counter()
                    functions[candidate]()
                    times[candidate].append((time.perf_counter() - begin) / arguments.states)
            first = next(iter(times.values()))
            print(f"{name} (nv = {robot.nv}), {quantity}, {arguments.states} states")
            for candidate, measured in times.items():
                ratios = [t / of_first for t, of_first in zip(measured, first, strict=True)]
                spread = f"{min(ratios):.2f} to {max(ratios):.2f}"
                print(f"  {candidate:<26} {median(measured) * 1e9:9.0f} ns per state, ratio {median(ratios):.2f} ({spread})")


if __name__ == "__main__":
    main()
