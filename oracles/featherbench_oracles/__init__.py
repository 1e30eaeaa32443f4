"""Oracles: programs that answer questions about a robot through one physics engine.

`python -m featherbench_oracles.ENGINE` starts the oracle of `pinocchio`, `mujoco`, `drake` or `dart`, or the witness `truth`; it speaks the
protocol of PROTOCOL.md on its standard input and output. `protocol` and `session` are what an engine of one's own needs.
"""

ENGINES = ("pinocchio", "mujoco", "drake", "dart")
