"""Starts the oracle: `python -m featherbench_oracles.newton`."""

from featherbench_oracles.core.session import serve
from featherbench_oracles.newton.oracle import Newton

if __name__ == "__main__":
    serve(Newton())
