"""Shared by the tests of oracles: a client of their processes, robots and states drawn by seed, and measures of residuals."""
