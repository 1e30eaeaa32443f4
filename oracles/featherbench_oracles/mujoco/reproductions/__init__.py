"""Known deviations of MuJoCo, each by a program of a few lines in its own interface."""
