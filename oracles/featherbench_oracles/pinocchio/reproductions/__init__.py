"""Known deviations of Pinocchio, each shown by a program of a few lines in its own interface."""
