"""Call ten million times, good and bad, and tell how resident memory grows. `tests/test_memory.py` does the same with fewer calls."""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np

import featherbench


def resident() -> float:
    """Read the resident memory of this process.

    Returns
    -------
    float
        MiB.
    """
    return int(Path("/proc/self/statm").read_text().split()[1]) * 4096 / 2**20


def main() -> None:
    """Print the resident memory after each tenth of the calls."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--calls", type=int, default=10_000_000)
    arguments = parser.parse_args()
    robot = featherbench.Robot.generated("chain:n=7,layout=spatial")
    q, v, a, bad = robot.random(seed=5), np.ones(7), np.ones(7), np.full(7, np.nan)
    print(f"before: {resident():.1f} MiB")
    for tenth in range(1, 11):
        for _ in range(arguments.calls // 40):
            robot.inverse_dynamics(q, v, a)
            robot.forward_dynamics(q, v, a)
            robot.mass_matrix(q)
            try:
                robot.bias_force(q, bad)
            except featherbench.Error:
                continue
        print(f"after {tenth * arguments.calls // 10} calls: {resident():.1f} MiB")


if __name__ == "__main__":
    main()
