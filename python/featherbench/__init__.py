"""Rigid-body dynamics of robots on numpy arrays, one state or many.

Conventions
-----------
- A state is an array of shape (nq,) or (nv,); many states are (states, nq) or (states, nv).
- Quaternions are ordered (x, y, z, w).
- Velocities of a free joint are [linear, angular], in body axes.
- Columns of a Jacobian are [angular, linear], in world axes.
- Rotations are turned by an increment in body axes.

`Robot.to_pinocchio`, `Robot.to_mujoco` and `Robot.to_drake` convert.

`read_run` gives the rows of a run of the program as a frame; `compare` asks whether engines read a robot's file alike.
"""

from importlib import import_module
from typing import TYPE_CHECKING

from featherbench._native import Error, Joint, Robot

if TYPE_CHECKING:
    from featherbench._runs import Comparison, Question, RunError, compare, read_run

__all__ = ["Comparison", "Error", "Joint", "Question", "Robot", "RunError", "compare", "read_run"]


# Imported when they are first used: dataclasses and subprocess would be most of the time of the import.
def __getattr__(name: str) -> object:
    if name in __all__:
        return getattr(import_module("featherbench._runs"), name)
    message = f"module 'featherbench' has no attribute '{name}'"
    raise AttributeError(message)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
