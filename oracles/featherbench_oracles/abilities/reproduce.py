"""Evaluates a reproduction of a known deviation over seeds, by messages of PROTOCOL.md.

The answer to the request `{"op":"reproduce","name":NAME,"seeds":n}` is a block `value` of shape (n,): the deviation for the seeds 0..n-1.
NAME is `ENGINE_SHORT` for the module `featherbench_oracles.ENGINE.reproductions.SHORT`.
"""

from __future__ import annotations

import importlib
import os
import sys
import traceback
from collections.abc import Callable

import numpy as np

from featherbench_oracles.core.messages import read_message, write_message


def reproduction(name: str) -> Callable[[int], float]:
    """Find a reproduction.

    Parameters
    ----------
    name : str
        The name that ci/deviations/ENGINE.toml gives it, as in `drake_zero_mass`.

    Returns
    -------
    callable
        Its function `deviation`: seed -> size of the deviation.
    """
    engine, _, short = name.partition("_")
    found: Callable[[int], float] = importlib.import_module(f"featherbench_oracles.{engine}.reproductions.{short}").deviation
    return found


def main() -> None:
    """Answer until standard input ends. What an engine prints goes to standard error."""
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    while (request := read_message(sys.stdin.buffer)) is not None:
        header, _ = request
        try:
            deviation = reproduction(header["name"])
            values = np.array([deviation(seed) for seed in range(header["seeds"])])
            write_message(answers, {"status": "ok"}, {"value": values})
        except Exception as reason:  # a reproduction's failure is an answer
            traceback.print_exc()
            write_message(answers, {"status": "error", "reason": f"{type(reason).__name__}: {' '.join(str(reason).split())}"})


if __name__ == "__main__":
    main()
