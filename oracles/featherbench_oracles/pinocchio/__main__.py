"""Starts the oracle: `python -m featherbench_oracles.pinocchio`."""

from featherbench_oracles.pinocchio.oracle import Pinocchio
from featherbench_oracles.session import serve

if __name__ == "__main__":
    serve(Pinocchio())
