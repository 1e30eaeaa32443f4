"""frax as an oracle."""
