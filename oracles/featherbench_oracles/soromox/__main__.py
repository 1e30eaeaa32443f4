"""Starts the oracle: `python -m featherbench_oracles.soromox`."""

from featherbench_oracles.core.session import serve
from featherbench_oracles.soromox.oracle import Soromox

if __name__ == "__main__":
    serve(Soromox())
