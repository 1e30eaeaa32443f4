"""Starts the oracle: `python -m featherbench_oracles.clarabel`."""

from featherbench_oracles.clarabel.oracle import Clarabel
from featherbench_oracles.core.session import serve

if __name__ == "__main__":
    serve(Clarabel())
