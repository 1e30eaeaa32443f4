"""Starts the oracle: `python -m featherbench_oracles.pyelastica`."""

from featherbench_oracles.pyelastica.oracle import PyElastica
from featherbench_oracles.session import serve

if __name__ == "__main__":
    serve(PyElastica())
