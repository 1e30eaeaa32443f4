"""PyBullet as an oracle."""
