"""A residual in Python: viscous friction and a smooth dry one in each joint. Run it with this folder on the PYTHONPATH."""

import numpy as np

from featherbench_oracles.abilities.residual import serve_residual

if __name__ == "__main__":
    serve_residual("friction", lambda _q, v, _a: 0.3 * v + 0.5 * np.tanh(v / 0.1))
