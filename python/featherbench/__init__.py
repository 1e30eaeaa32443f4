"""Rigid-body dynamics of robots on numpy arrays, one state or many.

Conventions
-----------
- q and v are in depth-first order, siblings in the order of the file.
- Quaternions are (x, y, z, w); one of another length than 1 stands for the rotation of its direction.
- A free joint has q = [origin, quaternion] and v = [linear, angular], both in *body* axes.
- 6-vectors are [angular, linear]. Jacobians and motions are of the frame's origin, in world axes.
- Units are SI and radians.

`Robot.to_pinocchio`, `Robot.to_mujoco` and `Robot.to_drake` convert.

`read_run` gives the rows of a run of the program as a frame; `compare` asks whether engines read a robot's file alike.
"""

from featherbench._native import Error, Joint, Robot
from featherbench._runs import Comparison, Question, RunError, compare, read_run

__all__ = ["Comparison", "Error", "Joint", "Question", "Robot", "RunError", "compare", "read_run"]
