"""Starts the oracle: `python -m featherbench_oracles.mjx`."""

from featherbench_oracles.core.session import serve
from featherbench_oracles.mjx.oracle import Mjx

if __name__ == "__main__":
    serve(Mjx())
