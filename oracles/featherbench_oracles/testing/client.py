"""A client of an oracle's process."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from subprocess import DEVNULL, PIPE, Popen
from typing import BinaryIO, cast

from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.messages import Answer, Blocks, Header, read_message, write_message

HOME = Path(__file__).resolve().parents[2]  # the folder in which the package lies
Methods = dict[str, list[str]]


class Oracle:
    """An oracle's process.

    Parameters
    ----------
    *arguments : str
        The arguments of Python, as in `-m featherbench_oracles.mujoco`. It finds this package, and no module in the current folder.
    python : str
        The Python that runs it: this one, or that of an engine's own environment.
    """

    def __init__(self, *arguments: str, python: str = sys.executable) -> None:
        paths = [str(HOME), *filter(None, [os.environ.get("PYTHONPATH")])]
        environment = {**os.environ, "PYTHONPATH": os.pathsep.join(paths)}
        command = [python, "-P", *arguments]
        self.process = Popen(command, stdin=PIPE, stdout=PIPE, stderr=DEVNULL, env=environment)
        self.requests, self.answers = cast(BinaryIO, self.process.stdin), cast(BinaryIO, self.process.stdout)

    @classmethod
    def of(cls, engine: str, python: str = sys.executable) -> Oracle:
        """Start the oracle of an engine of this package."""
        return cls("-m", f"featherbench_oracles.{engine}", python=python)

    def ask(self, header: Header, blocks: Blocks | None = None) -> Answer:
        """Send one request.

        Parameters
        ----------
        header : dict
            The request.
        blocks : Blocks | None
            Its blocks.

        Returns
        -------
        tuple of dict and dict
            The answer's header and blocks.
        """
        write_message(self.requests, header, blocks)
        return self.answer()

    def answer(self) -> Answer:
        """Read the next answer; its status is `ended` if there is none."""
        return read_message(self.answers) or ({"status": "ended", "reason": "the oracle ended"}, {})

    def must(self, header: Header, blocks: Blocks | None = None) -> Answer:
        """Send a request that has to succeed.

        Parameters
        ----------
        header : dict
            The request.
        blocks : Blocks | None
            Its blocks.

        Returns
        -------
        tuple of dict and dict
            The answer's header and blocks.

        Raises
        ------
        RuntimeError
            If the status is not `ok`.
        """
        answer, values = self.ask(header, blocks)
        if answer["status"] != "ok":
            raise RuntimeError(f"{header['op']}: {answer}")
        return answer, values

    def value(self, quantity: str, method: str, count: int, body: int | None = None) -> Array:
        """Ask for a quantity at the first states.

        Parameters
        ----------
        quantity : str
            The quantity.
        method : str
            The method.
        count : int
            How many states.
        body : int | None
            The body, where the quantity is one body's.

        Returns
        -------
        ndarray, shape (count, *shape of the quantity)
            The numbers, in the units of PROTOCOL.md.
        """
        header = {"op": "evaluate", "quantity": quantity, "method": method, "first": 0, "count": count}
        return self.must(header if body is None else {**header, "body": body})[1]["value"]

    def at(self, states: Blocks, quantity: str, method: str) -> Array:
        """Ask for a quantity at these states.

        Parameters
        ----------
        states : dict of str to ndarray
            As of `draws.random_states`.
        quantity : str
            The quantity.
        method : str
            The method.

        Returns
        -------
        ndarray, shape (states, *shape of the quantity)
            The numbers, in the units of PROTOCOL.md.
        """
        self.must({"op": "states", "count": len(states["q"])}, states)
        return self.value(quantity, method, len(states["q"]))

    def end(self) -> int:
        """Close the input, wait for the process, and return its exit status."""
        self.requests.close()
        return self.process.wait(timeout=60)

    def methods(self) -> Methods:
        """List its quantities, each with its methods."""
        methods: Methods = self.must({"op": "hello"})[0]["methods"]
        return methods
