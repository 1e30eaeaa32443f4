"""Starts the oracle: `python -m featherbench_oracles.mujoco`."""

from featherbench_oracles.mujoco.oracle import Mujoco
from featherbench_oracles.session import serve

if __name__ == "__main__":
    serve(Mujoco())
