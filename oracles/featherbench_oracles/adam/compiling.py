"""From CasADi's expressions to a loop in C over states: code is generated, compiled, and loaded into this process."""

from __future__ import annotations

import ctypes
import functools
import hashlib
import os
import shutil
import subprocess
import tempfile
from collections.abc import Sequence
from pathlib import Path

import casadi as cs
import numpy as np

from featherbench_oracles.core.algebra import Array

COMPILERS = ("clang", "gcc", "cc")  # in the order in which they are looked for
# As native oracles: optimised for this processor, without reordering of sums. `contract` lets products and sums become one instruction,
# because generated code has one operation in each statement. Pinocchio's headers and our kernels ask for these instructions themselves.
FLAGS = ("-std=gnu11", "-O3", "-march=native", "-ffp-contract=fast", "-fPIC", "-shared")
LOOP = Path(__file__).with_name("loop.c")
PAGE = 4096  # bytes
LINE = 16  # bytes: addresses that an allocator returns are multiples of it


@functools.cache
def compiler() -> tuple[str, str]:
    """Find the compiler.

    Returns
    -------
    command, version : str
        Its name, and the first line of what it tells of its version.

    Raises
    ------
    RuntimeError
        If there is none.
    """
    for name in COMPILERS:
        if shutil.which(name):
            told = subprocess.run([name, "--version"], check=True, capture_output=True, text=True)
            return name, told.stdout.splitlines()[0]
    raise RuntimeError(f"there is no C compiler for the generated code: install one of {', '.join(COMPILERS)}")


class Compiled:
    """One generated function, compiled with its loop.

    Parameters
    ----------
    inputs : sequence of cs.SX
        Its arguments.
    output : cs.SX
        Its result, a matrix. It is written column by column, zeros included.

    Attributes
    ----------
    sizes : list of int
        How many numbers each argument has.
    shape : tuple of int
        The rows and columns of the result.
    instructions : int
        The operations of the generated code.
    """

    def __init__(self, inputs: Sequence[cs.SX], output: cs.SX) -> None:
        function = cs.Function("evaluate", list(inputs), [cs.densify(output)], {"cse": True})
        self.sizes = [item.numel() for item in inputs]
        self.shape = tuple(output.shape)
        self.instructions = function.n_instructions()
        self.work = [max(n, 1) for n in (function.sz_arg(), function.sz_res(), function.sz_iw(), function.sz_w())]
        self.run = _load(_code(function)).run
        self.run.restype = ctypes.c_int64
        self.run.argtypes = [ctypes.c_size_t, *[ctypes.c_void_p] * 2, *[ctypes.c_size_t] * 3, *[ctypes.c_void_p] * 4]


class Batch:
    """The arguments of a compiled function at each state of a batch, and room for its result.

    Parameters
    ----------
    compiled : Compiled
        The function.
    inputs : sequence of ndarray, shape (states, size of the argument)
        Its arguments, state after state.
    """

    def __init__(self, compiled: Compiled, inputs: Sequence[Array]) -> None:
        self.compiled, self.inputs, self.states = compiled, list(inputs), len(inputs[0])
        self.size = np.array(compiled.sizes, dtype=np.uintp)
        self.relocate(None)

    def relocate(self, seed: int | None) -> None:
        """Copy all data to other addresses.

        Parameters
        ----------
        seed : int, optional
            The positions within pages are drawn with it. Without it, data lie where the allocator has them.
        """
        draw = np.random.default_rng(seed)

        def place() -> int:
            return 0 if seed is None else int(draw.integers(PAGE // LINE)) * LINE

        self.inputs = [_placed(item, place()) for item in self.inputs]
        arguments, results, integers, numbers = self.compiled.work
        self.result = _placed(np.zeros(self.compiled.shape[0] * self.compiled.shape[1]), place())
        self.integers = np.zeros(integers, dtype=np.int64)
        self.numbers = _placed(np.zeros(numbers), place())
        self.input = np.array([item.ctypes.data for item in self.inputs], dtype=np.uintp)
        self.argument = np.zeros(max(arguments, len(self.inputs)), dtype=np.uintp)
        self.results = np.full(results, self.result.ctypes.data, dtype=np.uintp)

    def time(self, first: int, count: int) -> int:
        """Evaluate states one after the other, and read the clock beside the loop.

        Parameters
        ----------
        first, count : int
            The range. Beyond the end of the batch states begin again.

        Returns
        -------
        int
            The nanoseconds of the loop.

        Raises
        ------
        ValueError
            If the generated code fails.
        """
        pointers = [item.ctypes.data for item in (self.argument, self.results, self.integers, self.numbers)]
        spent = self.compiled.run(len(self.inputs), self.input.ctypes.data, self.size.ctypes.data, self.states, first, count, *pointers)
        if spent < 0:
            raise ValueError("the generated code fails")
        return int(spent)

    def value(self) -> Array:
        """Read the result of the last state.

        Returns
        -------
        ndarray, shape (rows, columns)
            The matrix.
        """
        return self.result.reshape(self.compiled.shape, order="F").copy()


def _placed(numbers: Array, offset: int) -> Array:
    """Copy an array to a place in memory of its own, this many bytes behind its begin."""
    room = np.empty(numbers.nbytes + offset + 8, dtype=np.uint8)
    copy = room[offset : offset + numbers.nbytes].view(np.float64).reshape(numbers.shape)
    copy[...] = numbers
    return copy


def _code(function: cs.Function) -> str:
    """Generate the C code of a function."""
    generator = cs.CodeGenerator("generated.c")
    generator.add(function)
    return generator.dump()


def _load(code: str) -> ctypes.CDLL:
    """Compile code with the loop, unless it was compiled before, and load it."""
    command, version = compiler()
    parts = [code, LOOP.read_text(), version, *FLAGS, _processor()]
    key = hashlib.sha256("\0".join(parts).encode()).hexdigest()[:32]
    folder = _cache()
    library = folder / f"{key}.so"
    if not library.is_file():
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=folder) as place:
            source, made = Path(place, "generated.c"), Path(place, "made.so")
            source.write_text(code)
            subprocess.run([command, *FLAGS, str(source), str(LOOP), "-o", str(made), "-lm"], check=True, stdout=2)
            made.replace(library)
    return ctypes.CDLL(str(library))


def _processor() -> str:
    """Tell what `-march=native` means here: the processor's name and its instructions."""
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return ""
    return "\n".join(next((line for line in lines if line.startswith(key)), "") for key in ("model name", "flags"))


def _cache() -> Path:
    """Find the folder of compiled code: below the user's cache folder, as that of native oracles."""
    named = os.environ.get("XDG_CACHE_HOME", "")
    return (Path(named) if os.path.isabs(named) else Path.home() / ".cache") / "featherbench" / "generated"
