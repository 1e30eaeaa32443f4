"""Oracles: programs that answer questions about a robot through one dynamics engine.

`python -m featherbench_oracles.ENGINE` starts the oracle of `pinocchio`, `mujoco`, `drake` or `dart`, or the witness `truth`. It speaks the
protocol of PROTOCOL.md on its standard input and output. An engine of your own needs `core.protocol` and `core.session`, and `abilities`
for what it may do beside quantities.
"""
