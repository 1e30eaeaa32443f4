"""Starts the converters: `python -m featherbench_oracles.usd_converters`."""

from featherbench_oracles.core.session import serve
from featherbench_oracles.usd_converters.oracle import UsdConverters

if __name__ == "__main__":
    serve(UsdConverters())
