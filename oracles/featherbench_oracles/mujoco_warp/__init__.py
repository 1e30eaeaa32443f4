"""MuJoCo Warp as an oracle: MuJoCo's models, computed in single precision by kernels that Warp compiles."""
