"""Evaluates a reproduction of a known deviation (`reproductions/NAME.py`) over seeds, through the frames of PROTOCOL.md.

Request `{"op":"reproduce","name":NAME,"seeds":n}`; answer: block `value` [n], the deviation for the seeds 0..n-1.
"""

from __future__ import annotations

import importlib
import os
import sys
import traceback
from pathlib import Path

import numpy as np

from protocol import read_frame, write_frame

HERE = Path(__file__).resolve().parent
# This directory would be searched for the packages that the files here are called like.
sys.path.remove(str(HERE))
sys.path.insert(0, str(HERE / "reproductions"))


def main() -> None:
    """Answers until the standard input ends; whatever an engine prints goes to the standard error."""
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    while (request := read_frame(sys.stdin.buffer)) is not None:
        header, _ = request
        try:
            reproduction = importlib.import_module(header["name"])
            values = np.array([reproduction.deviation(seed) for seed in range(header["seeds"])])
            write_frame(answers, {"status": "ok"}, {"value": values})
        except Exception as reason:  # a reproduction's failure is an answer
            traceback.print_exc()
            write_frame(answers, {"status": "error", "reason": f"{type(reason).__name__}: {' '.join(str(reason).split())}"})


if __name__ == "__main__":
    main()
