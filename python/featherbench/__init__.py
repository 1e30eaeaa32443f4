"""Rigid-body dynamics of robots on numpy arrays, one state or many.

Conventions
-----------
- q and v are in depth-first order, siblings in the order of the file.
- Quaternions are (x, y, z, w); one of another length than 1 stands for the rotation of its direction.
- A free joint has q = [origin, quaternion] and v = [linear, angular], both in *body* axes.
- 6-vectors are [angular, linear]. Jacobians and motions are of the frame's origin, in world axes.
- Units are SI and radians.

`Robot.to_pinocchio`, `Robot.to_mujoco` and `Robot.to_drake` convert.
"""

from featherbench._native import Error, Joint, Robot

__all__ = ["Error", "Joint", "Robot"]
