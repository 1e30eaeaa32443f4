"""adam as an oracle: C code that CasADi generates from adam's symbolic algorithms, compiled for each robot."""
