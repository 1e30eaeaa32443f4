"""Starts the oracle: `python -m featherbench_oracles.pyelastica`."""

from featherbench_oracles.core.session import serve
from featherbench_oracles.pyelastica.oracle import PyElastica

if __name__ == "__main__":
    serve(PyElastica())
