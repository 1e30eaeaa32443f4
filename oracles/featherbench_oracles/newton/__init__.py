"""Newton as an oracle, in single precision."""
