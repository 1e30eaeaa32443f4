"""Pinocchio: the oracle, its import of files, its conventions and reproductions of its known deviations."""
