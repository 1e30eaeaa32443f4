"""Starts the oracle: `python -m featherbench_oracles.frax`."""

from featherbench_oracles.core.session import serve
from featherbench_oracles.frax.oracle import Frax

if __name__ == "__main__":
    serve(Frax())
