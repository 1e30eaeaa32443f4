"""What tests of oracles share: a client of their processes, robots and states drawn by seed, and measures of residuals."""
