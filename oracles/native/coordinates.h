/* Between neutral coordinates and an engine's (e). T is the identity but for orthogonal 3×3 blocks. Matrices are row-major. Not timed.
 *
 *   v_e = T v, a_e = T a + b, tau_e = T tau
 *   a = T' (a_e - b), tau = T' tau_e, M = T' M_e T, J = J_e T
 */
#ifndef FEATHERBENCH_COORDINATES_H
#define FEATHERBENCH_COORDINATES_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

/* A block of T with its part of b. */
struct fb_turn {
  size_t dof; /* the first of its three */
  double t[9];
  double b[3];
};

/* The blocks of one state. */
struct fb_change {
  size_t count;
  const struct fb_turn *turn;
};

/* Numbers of a joint type in q and in v. */
static inline size_t fb_joint_nq(int32_t joint) {
  static const size_t size[] = {1, 1, 1, 4, 7, 3, 2};
  return size[joint];
}
static inline size_t fb_joint_nv(int32_t joint) {
  static const size_t size[] = {1, 1, 1, 3, 6, 3, 2};
  return size[joint];
}

/* y = A x, or A' x. */
static inline void fb_product3(const double a[9], int transposed, const double x[3], double y[3]) {
  const size_t row = transposed ? 1 : 3, column = transposed ? 3 : 1;
  for (size_t i = 0; i < 3; i++)
    y[i] = a[i * row] * x[0] + a[i * row + column] * x[1] + a[i * row + 2 * column] * x[2];
}

/* R of the quaternion (x, y, z, w) of any length: I + 2 (w [u]x + [u]x²) / |quaternion|². */
static inline void fb_rotation(const double quaternion[4], double r[9]) {
  const double x = quaternion[0], y = quaternion[1], z = quaternion[2], w = quaternion[3];
  const double s = 2 / (x * x + y * y + z * z + w * w);
  const double rows[9] = {1 - s * (y * y + z * z), s * (x * y - w * z),     s * (x * z + w * y),
                          s * (x * y + w * z),     1 - s * (x * x + z * z), s * (y * z - w * x),
                          s * (x * z - w * y),     s * (y * z + w * x),     1 - s * (x * x + y * y)};
  memcpy(r, rows, sizeof rows);
}

/* x = T x (forth) or T' x (back) of a vector of nv numbers. */
static inline void fb_turn_vector(struct fb_change change, int back, double *x) {
  for (size_t i = 0; i < change.count; i++) {
    double *part = x + change.turn[i].dof, turned[3];
    fb_product3(change.turn[i].t, back, part, turned);
    memcpy(part, turned, sizeof turned);
  }
}
static inline void fb_forth(struct fb_change change, double *x) { fb_turn_vector(change, 0, x); }
static inline void fb_back(struct fb_change change, double *x) { fb_turn_vector(change, 1, x); }

/* x = x + sign · b. */
static inline void fb_add_b(struct fb_change change, double sign, double *x) {
  for (size_t i = 0; i < change.count; i++)
    for (size_t k = 0; k < 3; k++) x[change.turn[i].dof + k] += sign * change.turn[i].b[k];
}

/* M = T' M_e T of a symmetric n × n matrix, or of its inverse: T is orthogonal. */
static inline void fb_back_matrix(struct fb_change change, size_t n, double *m) {
  for (size_t i = 0; i < n; i++) fb_back(change, m + i * n);
  for (size_t c = 0; c < change.count; c++) {
    for (size_t j = 0; j < n; j++) {
      double *part = m + change.turn[c].dof * n + j, column[3] = {part[0], part[n], part[2 * n]}, turned[3];
      fb_product3(change.turn[c].t, 1, column, turned);
      for (size_t k = 0; k < 3; k++) part[k * n] = turned[k];
    }
  }
}

/* The tree-sparse rows of the lower triangle of a dense matrix: row i holds the entries of the dofs from the root to i. */
static inline void fb_tree_sparse(size_t n, const int32_t *dof_parent, const double *dense, double *sparse) {
  for (size_t i = 0; i < n; i++) {
    size_t depth = 0;
    for (int32_t j = (int32_t)i; j >= 0; j = dof_parent[j]) depth++;
    for (int32_t j = (int32_t)i, at = (int32_t)depth; j >= 0; j = dof_parent[j]) sparse[--at] = dense[i * n + j];
    sparse += depth;
  }
}

/* Factors M_e = L'DL (L below the diagonal, D on it) to those of M, tree-sparse. Factors do not change like M. Where T is not the
 * identity, they are multiplied; the product is converted and factored again, by the book's table 6.3 without its sparsity. */
static inline void fb_factors_to_neutral(struct fb_change change, size_t n, const int32_t *dof_parent, double *factors, double *work,
                                         double *sparse) {
  if (change.count == 0) {
    fb_tree_sparse(n, dof_parent, factors, sparse);
    return;
  }
  memset(work, 0, n * n * sizeof *work);
  for (size_t k = 0; k < n; k++) {
    const double *l = factors + k * n, d = l[k];
    for (size_t i = 0; i <= k; i++)
      for (size_t j = 0; j <= k; j++) work[i * n + j] += (i == k ? 1 : l[i]) * d * (j == k ? 1 : l[j]);
  }
  fb_back_matrix(change, n, work);
  for (size_t k = n; k-- > 0;) {
    for (size_t i = 0; i < k; i++) {
      const double l = work[k * n + i] / work[k * n + k];
      for (size_t j = 0; j <= i; j++) work[i * n + j] -= l * work[k * n + j];
    }
    for (size_t i = 0; i < k; i++) work[k * n + i] /= work[k * n + k];
  }
  fb_tree_sparse(n, dof_parent, work, sparse);
}

#endif
