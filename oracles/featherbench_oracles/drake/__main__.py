"""Starts the oracle: `python -m featherbench_oracles.drake`."""

from featherbench_oracles.drake.oracle import Drake
from featherbench_oracles.session import serve

if __name__ == "__main__":
    serve(Drake())
