"""Exudyn as an oracle."""
