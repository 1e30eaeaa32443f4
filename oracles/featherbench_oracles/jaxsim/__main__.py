"""Starts the oracle: `python -m featherbench_oracles.jaxsim`."""

from featherbench_oracles.core.session import serve
from featherbench_oracles.jaxsim.oracle import JaxSim

if __name__ == "__main__":
    serve(JaxSim())
