"""MuJoCo: the oracle, its reading of files, its conventions and reproductions of its known deviations."""
