"""Starts the oracle: `python -m featherbench_oracles.mujoco_warp`."""

from featherbench_oracles.core.session import serve
from featherbench_oracles.mujoco_warp.oracle import MujocoWarp

if __name__ == "__main__":
    serve(MujocoWarp())
