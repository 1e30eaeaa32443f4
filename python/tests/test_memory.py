"""Calls leave nothing behind."""

import gc
from pathlib import Path

import numpy as np

import featherbench

CALLS = 100_000
# One array of seven numbers per call, were it kept, would be 150 bytes with its header: 15 MB. A page or an arena of malloc is below 2 MB.
BOUND = 2 << 20


def resident() -> int:
    """Resident memory of this process, bytes."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * 4096


def test_memory_does_not_grow() -> None:
    robot = featherbench.Robot.generated("chain:n=7,layout=spatial")
    q, v, a = robot.random(seed=5), np.ones(7), np.ones(7)
    bad = np.full(7, np.nan)

    def calls(count: int) -> None:
        for _ in range(count):
            robot.inverse_dynamics(q, v, a)
            robot.mass_matrix(q)
            try:
                robot.forward_dynamics(q, v, bad)
            except featherbench.Error:
                continue

    calls(CALLS // 10)
    gc.collect()
    before = resident()
    calls(CALLS)
    gc.collect()
    assert resident() - before < BOUND
