"""Starts the witness as an oracle, or answers with decimal numbers."""

import json
import sys

from mpmath import mp

from featherbench_oracles.core.robot import Description
from featherbench_oracles.core.session import serve
from featherbench_oracles.truth.matrices import ZERO, exact
from featherbench_oracles.truth.witness import Truth, Witness


def decimals() -> None:
    """Answer questions on the standard input with decimal numbers, line by line."""
    for line in sys.stdin:
        question = json.loads(line)
        truth = Truth(Description.read(question["model"]))
        with mp.workprec(truth.bits):
            q, v, a, tau = (exact(question[key]) for key in ("q", "v", "a", "tau"))
            values = {
                "id": truth.inverse(q, v, a),
                "bias": truth.inverse(q, v, [ZERO] * len(v)),
                "fd": truth.forward(q, v, tau),
                "mass_matrix": [entry for row in truth.mass(q) for entry in row],
            }
            answer = {key: [mp.nstr(value, question["digits"]) for value in numbers] for key, numbers in values.items()}
        print(json.dumps(answer), flush=True)


if __name__ == "__main__":
    if sys.argv[1:] == ["--decimals"]:
        decimals()
    else:
        serve(Witness())
