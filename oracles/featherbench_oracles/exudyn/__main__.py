"""Starts the oracle: `python -m featherbench_oracles.exudyn`."""

from featherbench_oracles.core.session import serve
from featherbench_oracles.exudyn.oracle import Exudyn

if __name__ == "__main__":
    serve(Exudyn())
