"""Starts the reader: `python -m featherbench_oracles.openusd`."""

from featherbench_oracles.core.session import serve
from featherbench_oracles.openusd.oracle import OpenUsd

if __name__ == "__main__":
    serve(OpenUsd())
