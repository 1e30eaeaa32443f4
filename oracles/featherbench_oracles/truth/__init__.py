"""The witness: rigid-body dynamics in multi-precision by 4x4 matrices, written from the equations of motion and from no engine.

A body's pose is a matrix T, its mass distribution the pseudo-inertia J = ∫ x x' dm of homogeneous points x = (x, y, z, 1), and d'Alembert's
principle for all points of a body is one trace:

    T = T_p U,  U = P A(q)                     P: the joint's placement, A: its displacement, A' = A V with V = Σ E_k v_k
    Ṫ = Ṫ_p U + T V
    T̈ = T̈_p U + 2 Ṫ_p U V + T (V² + V̇)         V̇ = Σ E_k a_k
    τ_k = tr(D_k Σ_b T J (T̈ - G)') + A_k a_k   D_k = T_j E_k T_j^-1, G = (0 | g), b: the bodies that joint j carries, A_k: armature
    M_kl = tr(D_k (Σ_b T J T') D_l') + A_k δ_kl

(Uicker 1967; Hollerbach 1980.) E_k are constant matrices of se(3), because planar and universal joints are written as two or three simple
ones. There are no angular velocities, cross products, Jacobians or inertia tensors; forward dynamics solves with Cholesky's factors of M.

Numbers carry max(448, 106 + 7 n) bits, and answers are the nearest doubles. All of the description's doubles are taken exactly, but where
they stand for a direction or a rotation the nearest one is meant: u / |u| for axes, p / |p| for quaternions, the orthogonal polar factor
for placements' rotations. The question has no answer beyond 1e-16 otherwise.

| module | what it is |
|---|---|
| `matrices` | numbers, 4x4 matrices, displacements of simple joints |
| `links` | joints as chains of simple ones, and mass distributions |
| `witness` | the equations, and the answers |

Started as `python -m featherbench_oracles.truth` it is an oracle (PROTOCOL.md). With `--decimals`, each line {"model", "q", "v", "a",
"tau", "digits"} of the standard input is answered by a line {"id", "bias", "fd", "mass_matrix"} of decimal numbers.
"""
