"""Starts the oracle: `python -m featherbench_oracles.drake`."""

from featherbench_oracles.core.session import serve
from featherbench_oracles.drake.oracle import Drake

if __name__ == "__main__":
    serve(Drake())
