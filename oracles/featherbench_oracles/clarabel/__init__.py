"""Clarabel: convex problems with cones, by an interior-point method."""
