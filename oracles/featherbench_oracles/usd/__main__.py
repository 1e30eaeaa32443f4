"""Starts the reader: `python -m featherbench_oracles.usd`."""

from featherbench_oracles.core.session import serve
from featherbench_oracles.usd.oracle import OpenUsd

if __name__ == "__main__":
    serve(OpenUsd())
