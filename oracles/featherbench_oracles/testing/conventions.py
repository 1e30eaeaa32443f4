"""Asks an engine about its conventions: `python -m featherbench_oracles.testing.conventions ENGINE`, in an environment that has it.

Writes an object in JSON. Of each function of `featherbench_oracles.ENGINE.conventions` it has a list with a pair for each claim: what
refutes it, or null, and what refutes it with its first alternative in place of the convention.
"""

from __future__ import annotations

import json
import os
import sys
from importlib import import_module

from featherbench_oracles.core.conventions import Convention

Refutations = dict[str, list[tuple[str | None, str | None]]]


def refutations(engine: str) -> Refutations:
    """Ask about every convention of an engine."""
    module = import_module(f"featherbench_oracles.{engine}.conventions")
    named: dict[str, Convention] = {
        name: thing
        for name, thing in vars(module).items()
        if name.startswith(f"{engine}_") and getattr(thing, "__annotations__", {}).get("return") == "Claims"
    }
    return {name: [(one.refutation(), one.swapped().refutation()) for one in ask()] for name, ask in named.items()}


if __name__ == "__main__":
    kept = os.dup(1)
    os.dup2(2, 1)  # some engines print, also from C
    text = json.dumps(refutations(sys.argv[1]))
    with os.fdopen(kept, "w", encoding="utf-8") as answer:
        answer.write(text)
