"""Known deviations of MuJoCo, each shown by a program of a few lines in its own interface."""
