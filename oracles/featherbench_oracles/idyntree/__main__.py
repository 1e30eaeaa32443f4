"""Starts the oracle: `python -m featherbench_oracles.idyntree`."""

from featherbench_oracles.core.session import serve
from featherbench_oracles.idyntree.oracle import IDynTree

if __name__ == "__main__":
    serve(IDynTree())
