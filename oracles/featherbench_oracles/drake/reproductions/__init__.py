"""Known deviations of Drake, each by a program of a few lines in its own interface."""
