"""What an engine says while it steps: a solver that failed is told as that, and its numbers are not taken for physics."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from featherbench_oracles.core.messages import Header
from featherbench_oracles.core.reading import overheard

# What a message of a failure begins with or has in it. Others, as of what a shape cannot do, say nothing of the numbers.
FAILURE = re.compile(r"^\S*error\b|fail|diverge|unstable|singular|\bnan\b|not converge|no convergence", re.IGNORECASE)


@contextmanager
def heard(engine: str) -> Iterator[None]:
    """Refuse the numbers of what is computed in this context if the engine prints there that something failed.

    An engine that goes on after a failure prints it, and may have no other status: DART sets impulses to zero where its solver fails.

    Raises
    ------
    ValueError
        With the messages of failures, each once.
    """
    notes: list[Header] = []
    # The name is that of no file: nothing is shortened.
    with overheard(Path("scene"), notes):
        yield
    told = [one["text"] for one in notes if FAILURE.search(one["text"])]
    if told:
        raise ValueError(f"{engine} says while it computes: {'; '.join(told)}")
