"""JaxSim as an oracle."""
