"""PyElastica as an oracle: Cosserat rods of nodes and directors, in an environment of its own."""
