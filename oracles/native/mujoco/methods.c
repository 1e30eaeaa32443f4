/* MuJoCo's methods, and the table of the library. The stages of each method stand at its `run`. They include setting qpos, qvel and qacc.
 */
#include "robot.h"

static struct fb_change change(const struct fb_handle *h) { return change_at(h, h->last); }

/* ---- methods: what is timed, then how it is read ---- */

static void set_q(struct fb_handle *h, size_t k) { memcpy(h->data->qpos, h->q + k * h->nq, h->nq * sizeof *h->q); }
static void set_v(struct fb_handle *h, size_t k) { memcpy(h->data->qvel, h->v + k * h->nv, h->nv * sizeof *h->v); }
static void set_a(struct fb_handle *h, size_t k) { memcpy(h->data->qacc, h->a + k * h->nv, h->nv * sizeof *h->a); }

static void position(struct fb_handle *h, size_t k) {
  set_q(h, k);
  mj_kinematics(h->model, h->data);
  mj_comPos(h->model, h->data);
}

static void velocity(struct fb_handle *h, size_t k) {
  position(h, k);
  set_v(h, k);
  mj_comVel(h->model, h->data);
}

/* kinematics + comPos + makeM, which runs crb */
static void run_mass(struct fb_handle *h, size_t k) {
  position(h, k);
  mj_makeM(h->model, h->data);
}

/* kinematics + comPos + comVel + rne, and armature · a, which mj_rne leaves out and mj_inverse adds */
static void run_rne(struct fb_handle *h, size_t k) {
  velocity(h, k);
  set_a(h, k);
  mj_rne(h->model, h->data, 1, h->result);
  for (size_t i = 0; i < h->nv; i++) h->result[i] += h->model->dof_armature[i] * h->data->qacc[i];
}

/* mj_inverse as its users call it, with cameras, tendons, passive forces, M and more */
static void run_inverse(struct fb_handle *h, size_t k) {
  set_q(h, k), set_v(h, k), set_a(h, k);
  mj_inverse(h->model, h->data);
  memcpy(h->result, h->data->qfrc_inverse, h->nv * sizeof *h->result);
}

/* kinematics + comPos + comVel + rne without accelerations */
static void run_bias(struct fb_handle *h, size_t k) {
  velocity(h, k);
  mj_rne(h->model, h->data, 0, h->result);
}

/* kinematics + comPos + makeM + factorM + comVel + rne without accelerations + solveM: what a forward dynamics without contact needs */
static void run_stages(struct fb_handle *h, size_t k) {
  velocity(h, k);
  mj_makeM(h->model, h->data);
  mj_factorM(h->model, h->data);
  mj_rne(h->model, h->data, 0, h->data->qfrc_bias);
  for (size_t i = 0; i < h->nv; i++) h->data->qfrc_smooth[i] = h->tau[k * h->nv + i] - h->data->qfrc_bias[i];
  mj_solveM(h->model, h->data, h->result, h->data->qfrc_smooth, 1);
}

/* mj_forward as its users call it */
static void run_forward(struct fb_handle *h, size_t k) {
  set_q(h, k), set_v(h, k);
  memcpy(h->data->qfrc_applied, h->tau + k * h->nv, h->nv * sizeof *h->tau);
  mj_forward(h->model, h->data);
  memcpy(h->result, h->data->qacc, h->nv * sizeof *h->result);
}

/* mj_factorM of a mass matrix that stands in place of mjData's own */
static void run_factor(struct fb_handle *h, size_t k) {
  h->data->M = h->masses + k % h->made * h->model->nC;
  mj_factorM(h->model, h->data);
  h->data->M = h->own_m;
}

/* mj_solveM with factors that stand in place of mjData's own */
static void run_solve(struct fb_handle *h, size_t k) {
  h->data->qLD = h->factors + k % h->made * h->model->nC;
  h->data->qLDiagInv = h->inverses + k % h->made * h->nv;
  mj_solveM(h->model, h->data, h->result, h->tau + k * h->nv, 1);
  h->data->qLD = h->own_qld;
  h->data->qLDiagInv = h->own_inverse;
}

/* kinematics + comPos + makeM + factorM, then solveM with the n columns of the identity */
static void run_inverse_matrix(struct fb_handle *h, size_t k) {
  run_mass(h, k);
  mj_factorM(h->model, h->data);
  mj_solveM(h->model, h->data, h->work[0], h->work[1], (int)h->nv);
}

/* kinematics + comPos, whose subtree_com of the world is the robot's centre of mass */
static void run_com(struct fb_handle *h, size_t k) { position(h, k); }

/* kinematics + comPos + comVel + subtreeVel */
static void run_momentum(struct fb_handle *h, size_t k) {
  velocity(h, k);
  mj_subtreeVel(h->model, h->data);
}

static void run_placements(struct fb_handle *h, size_t k) {
  set_q(h, k);
  mj_kinematics(h->model, h->data);
}

/* kinematics + comPos + comVel + rnePostConstraint */
static void run_accelerations(struct fb_handle *h, size_t k) {
  velocity(h, k);
  set_a(h, k);
  mj_rnePostConstraint(h->model, h->data);
}

/* kinematics + comPos + jacBody */
static void run_jacobian(struct fb_handle *h, size_t k) {
  position(h, k);
  mj_jacBody(h->model, h->data, h->result + 3 * h->nv, h->result, (int)h->of_body + 1);
}

static void read_force(struct fb_handle *h, double *tau) {
  memcpy(tau, h->result, h->nv * sizeof *tau);
  fb_back(change(h), tau);
}

static void read_acceleration(struct fb_handle *h, double *a) {
  memcpy(a, h->result, h->nv * sizeof *a);
  fb_add_b(change(h), -1, a);
  fb_back(change(h), a);
}

/* h = T' (h_e + M_e b) */
static void read_bias(struct fb_handle *h, double *bias) {
  const struct fb_change at = change(h);
  if (at.count > 0) {
    memset(h->work[0], 0, h->nv * sizeof *h->work[0]);
    fb_add_b(at, 1, h->work[0]);
    mj_makeM(h->model, h->data);
    mj_mulM(h->model, h->data, h->work[1], h->work[0]);
    mju_addTo(h->result, h->work[1], (int)h->nv);
  }
  read_force(h, bias);
}

static void read_mass(struct fb_handle *h, double *mass) {
  mj_fullM(h->model, h->data, mass);
  fb_back_matrix(change(h), h->nv, mass);
}

static void read_sparse_mass(struct fb_handle *h, double *sparse) {
  read_mass(h, h->work[0]);
  fb_tree_sparse(h->nv, h->dof_parent, h->work[0], sparse);
}

static void read_factors(struct fb_handle *h, double *sparse) {
  const mjModel *m = h->model;
  memset(h->work[0], 0, h->nv * h->nv * sizeof *h->work[0]);
  for (size_t i = 0; i < h->nv; i++)
    for (int at = m->M_rowadr[i]; at < m->M_rowadr[i] + m->M_rownnz[i]; at++)
      h->work[0][i * h->nv + (size_t)m->M_colind[at]] = h->data->qLD[at];
  fb_factors_to_neutral(change(h), h->nv, h->dof_parent, h->work[0], h->work[1], sparse);
}

static void read_inverse_matrix(struct fb_handle *h, double *inverse) {
  memcpy(inverse, h->work[0], h->nv * h->nv * sizeof *inverse);
  fb_back_matrix(change(h), h->nv, inverse);
}

static void read_com(struct fb_handle *h, double *com) { memcpy(com, h->data->subtree_com, 3 * sizeof *com); }

/* The linear part is the total mass times the velocity of the centre of mass. */
static void read_momentum(struct fb_handle *h, double *momentum) {
  memcpy(momentum, h->data->subtree_angmom, 3 * sizeof *momentum);
  for (size_t i = 0; i < 3; i++) momentum[3 + i] = h->model->body_subtreemass[0] * h->data->subtree_linvel[i];
}

static void read_placements(struct fb_handle *h, double *value) {
  for (size_t i = 1; i <= h->bodies; i++, value += 12) {
    memcpy(value, h->data->xmat + 9 * i, 9 * sizeof *value);
    memcpy(value + 9, h->data->xpos + 3 * i, 3 * sizeof *value);
  }
}

static void read_velocities(struct fb_handle *h, double *value) {
  for (size_t i = 1; i <= h->bodies; i++, value += 6) mj_objectVelocity(h->model, h->data, mjOBJ_XBODY, (int)i, value, 0);
}

/* MuJoCo gives accelerations as if the world accelerated by -g. */
static void read_accelerations(struct fb_handle *h, double *value) {
  for (size_t i = 1; i <= h->bodies; i++, value += 6) {
    mj_objectAcceleration(h->model, h->data, mjOBJ_XBODY, (int)i, value, 0);
    mju_addTo3(value + 3, h->model->opt.gravity);
  }
}

static void read_jacobian(struct fb_handle *h, double *value) {
  memcpy(value, h->result, 6 * h->nv * sizeof *value);
  for (size_t row = 0; row < 6; row++) fb_back(change(h), value + row * h->nv);
}

/* ---- preparation of methods ---- */

static int ready_dense(struct fb_handle *h) {
  return make_room(&h->work[0], h->nv * h->nv) && make_room(&h->work[1], h->nv * h->nv);
}

/* The identity, whose columns are right-hand sides. */
static int ready_identity(struct fb_handle *h) {
  if (!ready_dense(h)) return 0;
  memset(h->work[1], 0, h->nv * h->nv * sizeof *h->work[1]);
  for (size_t i = 0; i < h->nv; i++) h->work[1][i * h->nv + i] = 1;
  return 1;
}

/* Mass matrices of the states and their factors. For big robots a few are reused in turn: thousands of them would not fit into memory. */
static int ready_matrices(struct fb_handle *h) {
  const size_t stored = (size_t)h->model->nC, most = 1 + ((size_t)32 << 20) / (8 * stored);
  h->made = h->count < most ? h->count : most;
  if (!(make_room(&h->masses, h->made * stored) && make_room(&h->factors, h->made * stored) && make_room(&h->inverses, h->made * h->nv)))
    return 0;
  for (size_t k = 0; k < h->made; k++) {
    run_mass(h, k);
    mj_factorM(h->model, h->data);
    memcpy(h->masses + k * stored, h->data->M, stored * sizeof *h->masses);
    memcpy(h->factors + k * stored, h->data->qLD, stored * sizeof *h->factors);
    memcpy(h->inverses + k * h->nv, h->data->qLDiagInv, h->nv * sizeof *h->inverses);
  }
  return ready_dense(h);
}

/* ---- the table ---- */

static const struct fb_method names[] = {
    {"id", "rne"},
    {"id", "inverse"},
    {"bias", "rne"},
    {"mass_matrix", "crb"},
    {"mass_matrix_sparse", "crb"},
    {"factorization", "factor"},
    {"solve", "solve"},
    {"mass_matrix_inverse", "solve_identity"},
    {"com", "subtree_com"},
    {"momentum", "subtree_vel"},
    {"fd", "stages"},
    {"fd", "forward"},
    {"body_placement", "kinematics"},
    {"body_velocity", "com_vel"},
    {"body_acceleration", "rne_post"},
    {"body_jacobian", "jac_body"},
};

static const struct {
  int (*ready)(struct fb_handle *);
  void (*run)(struct fb_handle *, size_t k);
  void (*read)(struct fb_handle *, double *value);
} methods[] = {
    {NULL, run_rne, read_force},
    {NULL, run_inverse, read_force},
    {ready_dense, run_bias, read_bias},
    {NULL, run_mass, read_mass},
    {ready_dense, run_mass, read_sparse_mass},
    {ready_matrices, run_factor, read_factors},
    {ready_matrices, run_solve, read_force},
    {ready_identity, run_inverse_matrix, read_inverse_matrix},
    {NULL, run_com, read_com},
    {NULL, run_momentum, read_momentum},
    {NULL, run_stages, read_acceleration},
    {NULL, run_forward, read_acceleration},
    {NULL, run_placements, read_placements},
    {NULL, velocity, read_velocities},
    {NULL, run_accelerations, read_accelerations},
    {NULL, run_jacobian, read_jacobian},
};
_Static_assert(sizeof methods / sizeof *methods == sizeof names / sizeof *names, "each name has a method");

static int ready(struct fb_handle *h, size_t method, size_t body, char *reason) {
  h->of_body = body;
  return methods[method].ready == NULL || methods[method].ready(h) ? FB_OK : no_memory(reason);
}

static int run(struct fb_handle *h, size_t method, size_t first, size_t count, char *reason) {
  (void)reason;
  void (*const evaluate)(struct fb_handle *, size_t) = methods[method].run;
  size_t k = first % h->count;
  for (size_t n = 0; n < count; n++) {
    evaluate(h, k);
    h->last = k;
    if (++k == h->count) k = 0;
  }
  return FB_OK;
}

static int read_value(struct fb_handle *h, size_t method, double *value, char *reason) {
  (void)reason;
  methods[method].read(h, value);
  return FB_OK;
}

const struct fb_oracle *featherbench_oracle(void) {
  static struct fb_oracle table = {FEATHERBENCH_ORACLE_VERSION,
                                FB_ENGINE,
                                NULL,
                                "language=C (libmujoco of the Python package mujoco, as it is shipped)\n" FB_BUILD,
                                names,
                                sizeof names / sizeof *names,
                                mujoco_create,
                                mujoco_destroy,
                                mujoco_states,
                                ready,
                                run,
                                read_value};
  table.engine_version = mj_versionString();
  return &table;
}
