"""Messages of the protocol: one line of JSON, and then the blocks of doubles that it announces."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from typing import Any, BinaryIO

import numpy as np

from featherbench_oracles.core.algebra import Array

Blocks = dict[str, Array]
Header = dict[str, Any]
Answer = tuple[Header, Blocks]


def read_message(stream: BinaryIO) -> Answer | None:
    """Read the next message.

    Parameters
    ----------
    stream : BinaryIO
        A stream at the beginning of a message.

    Returns
    -------
    tuple of dict and dict, or None
        The header, and the blocks by name, each in the shape that the header announces. None at the end of the stream.

    Raises
    ------
    ValueError
        If the header is no JSON object, or a shape is not a list of sizes.
    EOFError
        If the stream ends within a block.
    """
    line = stream.readline()
    if not line:
        return None
    header = json.loads(line)
    if not isinstance(header, dict):
        raise ValueError("a message's header is not a JSON object")
    blocks: Blocks = {}
    for block in header.get("blocks", []):
        shape = tuple(block["shape"])
        if not all(isinstance(n, int) and n >= 0 for n in shape):
            raise ValueError(f"block {block['name']} has the shape {list(shape)}")
        size = 8 * math.prod(shape)
        data = stream.read(size)
        if len(data) < size:
            raise EOFError(f"the stream ended within block {block['name']}")
        blocks[block["name"]] = np.frombuffer(data, "<f8").reshape(shape).astype(np.float64)
    return header, blocks


def write_message(stream: BinaryIO, header: Header, blocks: Blocks | None = None) -> None:
    """Write a message, and flush the stream.

    Parameters
    ----------
    stream : BinaryIO
        The stream that is written.
    header : dict
        The header without `blocks`, which is added.
    blocks : dict of str to ndarray, optional
        The blocks by name, of any shape.
    """
    announced = dict(header)
    if blocks:
        announced["blocks"] = [{"name": name, "shape": list(block.shape)} for name, block in blocks.items()]
    stream.write(json.dumps(announced).encode() + b"\n")
    for block in (blocks or {}).values():
        stream.write(np.ascontiguousarray(block, "<f8").tobytes())
    stream.flush()


def check_blocks(blocks: Blocks, shapes: Mapping[str, tuple[int, ...]], *, finite: bool = True) -> None:
    """Check the blocks of a request: engines end the process at some numbers, or never come back.

    Parameters
    ----------
    blocks : dict of str to ndarray
        What was sent.
    shapes : mapping of str to tuple of int
        The shape of each block.
    finite : bool
        Whether all numbers must be finite.

    Raises
    ------
    ValueError
        If a block is missing, has another shape, or has a number that is not finite.
    """
    for name, shape in shapes.items():
        if name not in blocks or blocks[name].shape != shape:
            raise ValueError(f"block {name} is missing or not of shape {list(shape)}")
        if finite and not np.isfinite(blocks[name]).all():
            raise ValueError(f"block {name} has a number that is not finite")


def limits(header: Header) -> tuple[float, int]:
    """Take the tolerance of a solver and its cap on iterations from a request, which must be positive."""
    tolerance, iterations = header["tolerance"], header["iterations"]
    if not (tolerance > 0 and np.isfinite(tolerance) and iterations > 0):
        raise ValueError("tolerance and iterations must be positive")
    return tolerance, iterations
