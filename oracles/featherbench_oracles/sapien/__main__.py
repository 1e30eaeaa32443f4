"""Starts the oracle: `python -m featherbench_oracles.sapien`."""

from featherbench_oracles.core.session import serve
from featherbench_oracles.sapien.oracle import Sapien

if __name__ == "__main__":
    serve(Sapien())
