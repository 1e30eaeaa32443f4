"""SAPIEN as an oracle."""
