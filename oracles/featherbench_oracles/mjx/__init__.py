"""MuJoCo XLA (MJX) as an oracle, in single precision."""

from contextlib import redirect_stdout
from sys import stderr

with redirect_stdout(stderr):  # MJX prints that Warp, which it need not have, is not there; the oracle's output is for answers
    import mujoco.mjx  # noqa: F401
