"""iDynTree as an oracle."""
