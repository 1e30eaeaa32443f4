"""Simbody as an oracle, by OpenSim's models."""
