"""SoRoMoX as an oracle: rods of piecewise constant strain, in an environment of its own."""
