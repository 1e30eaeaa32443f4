"""Starts the oracle: `python -m featherbench_oracles.mujoco`."""

from featherbench_oracles.core.session import serve
from featherbench_oracles.mujoco.oracle import Mujoco

if __name__ == "__main__":
    serve(Mujoco())
