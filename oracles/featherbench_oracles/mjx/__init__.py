"""MuJoCo XLA (MJX) as an oracle, in single precision."""
