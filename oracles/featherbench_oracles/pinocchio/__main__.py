"""Starts the oracle: `python -m featherbench_oracles.pinocchio`."""

from featherbench_oracles.core.session import serve
from featherbench_oracles.pinocchio.oracle import Pinocchio

if __name__ == "__main__":
    serve(Pinocchio())
