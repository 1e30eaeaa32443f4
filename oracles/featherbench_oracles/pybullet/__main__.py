"""Starts the oracle: `python -m featherbench_oracles.pybullet`."""

from featherbench_oracles.core.session import serve
from featherbench_oracles.pybullet.oracle import PyBullet

if __name__ == "__main__":
    serve(PyBullet())
