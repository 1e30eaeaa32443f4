"""What the project costs to compile: a wrapper of the compiler, what it counts and times, and the tables of both."""
