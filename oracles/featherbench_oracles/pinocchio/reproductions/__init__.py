"""Known deviations of Pinocchio, each by a program of a few lines in its own interface."""
