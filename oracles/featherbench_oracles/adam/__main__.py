"""Starts the oracle: `python -m featherbench_oracles.adam`."""

from featherbench_oracles.adam.oracle import Adam
from featherbench_oracles.core.session import serve

if __name__ == "__main__":
    serve(Adam())
