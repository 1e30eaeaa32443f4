"""Starts the oracle: `python -m featherbench_oracles.simbody`."""

from featherbench_oracles.core.session import serve
from featherbench_oracles.simbody.oracle import Simbody

if __name__ == "__main__":
    serve(Simbody())
