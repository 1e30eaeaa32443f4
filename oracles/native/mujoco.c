/* MuJoCo as a native peer: the robot is built by MjSpec's C interface, the stages are those that the shared library exports.
 *
 * What the engine holds, and how coordinates change, is as in oracles/mujoco.py: free joints have q_e = (p of the world, quaternion wxyz),
 * T = diag(R, 1) and b = (R (ω × v), 0); spherical joints a quaternion wxyz; planar and universal joints are several in one body.
 * The stages that each method adds up are written in its `run`; setting qpos, qvel and qacc is part of them.
 */
#include "coordinates.h"
#include "peer.h"

#include <math.h>
#include <mujoco/mujoco.h>
#include <stdio.h>
#include <stdlib.h>

/* Some numbers, or why there are none. */
struct fb_handle {
  size_t bodies, nq, nv;
  struct fb_body *body;
  int32_t *dof_parent;
  mjModel *model;
  mjData *data;
  mjtNum *own_m, *own_qld, *own_inverse; /* mjData's own arrays, while prepared ones stand in their place */

  size_t count;
  double *q, *v, *a, *tau; /* states in MuJoCo's coordinates, count rows each */
  struct fb_turn *turn;    /* turns for each state */
  size_t turns;

  size_t of_body;           /* whose Jacobian is asked for */
  double *masses, *factors; /* `made` rows of nC numbers */
  double *inverses;         /* and of nv numbers */
  size_t made;
  double *result;   /* nv, or 6 nv of a Jacobian */
  double *work[2];  /* nv × nv */
  size_t last;      /* the state that was evaluated last */
};

static int say(char *reason, int status, const char *what, const char *detail) {
  snprintf(reason, FB_REASON, "%s%s", what, detail);
  return status;
}

static int no_memory(char *reason) { return say(reason, FB_FAILED, "no memory for the states or matrices of this robot", ""); }

/* Room for some numbers in place of what stood there. */
static int make_room(double **numbers, size_t count) {
  free(*numbers);
  *numbers = calloc(count > 0 ? count : 1, sizeof **numbers);
  return *numbers != NULL;
}

static struct fb_change change_at(const struct fb_handle *h, size_t k) {
  const struct fb_change change = {h->turns, h->turn + k * h->turns};
  return change;
}
static struct fb_change change(const struct fb_handle *h) { return change_at(h, h->last); }

/* ---- the robot ---- */

/* Principal moments and axes (columns of a rotation) by Jacobi's rotations, to the last bit: MuJoCo's own stop at 1e-12 kg·m². */
static void principal(const double six[6], double moments[3], double axes[9]) {
  double a[3][3] = {{six[0], six[1], six[2]}, {six[1], six[3], six[4]}, {six[2], six[4], six[5]}};
  double turned[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (int sweep = 0; sweep < 30; sweep++) {
    for (int p = 0; p < 2; p++) {
      for (int q = p + 1; q < 3; q++) {
        if (a[p][q] == 0) continue;
        const double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
        const double t = (theta < 0 ? -1 : 1) / (fabs(theta) + sqrt(theta * theta + 1));
        const double c = 1 / sqrt(t * t + 1), s = t * c;
        for (int k = 0; k < 3; k++) {
          const double left = a[k][p], right = a[k][q];
          a[k][p] = c * left - s * right;
          a[k][q] = s * left + c * right;
        }
        for (int k = 0; k < 3; k++) {
          const double left = a[p][k], right = a[q][k];
          a[p][k] = c * left - s * right;
          a[q][k] = s * left + c * right;
        }
        a[p][q] = a[q][p] = 0;
        for (int k = 0; k < 3; k++) {
          const double left = turned[k][p], right = turned[k][q];
          turned[k][p] = c * left - s * right;
          turned[k][q] = s * left + c * right;
        }
      }
    }
  }
  for (int k = 0; k < 3; k++) moments[k] = a[k][k];
  memcpy(axes, turned, sizeof turned);
}

static void add_joint(mjsBody *body, mjtJoint type, const double axis[3]) {
  mjsJoint *joint = mjs_addJoint(body, NULL);
  joint->type = type;
  memcpy(joint->axis, axis, 3 * sizeof *axis);
}

static mjsBody *add_body(mjsBody *parent, const struct fb_body *body) {
  static const double x[3] = {1, 0, 0}, y[3] = {0, 1, 0}, z[3] = {0, 0, 1};
  mjsBody *child = mjs_addBody(parent, NULL);
  double axes[9];
  memcpy(child->pos, body->translation, sizeof child->pos);
  mju_mat2Quat(child->quat, body->rotation);
  child->explicitinertial = 1;
  child->mass = body->mass;
  memcpy(child->ipos, body->com, sizeof child->ipos);
  principal(body->inertia, child->inertia, axes);
  mju_mat2Quat(child->iquat, axes);
  switch (body->joint) {
  case FB_REVOLUTE: add_joint(child, mjJNT_HINGE, body->axis); break;
  case FB_PRISMATIC: add_joint(child, mjJNT_SLIDE, body->axis); break;
  case FB_SPHERICAL: add_joint(child, mjJNT_BALL, z); break;
  case FB_FREE: add_joint(child, mjJNT_FREE, z); break;
  case FB_PLANAR: add_joint(child, mjJNT_SLIDE, x); add_joint(child, mjJNT_SLIDE, y); add_joint(child, mjJNT_HINGE, z); break;
  default: add_joint(child, mjJNT_HINGE, x); add_joint(child, mjJNT_HINGE, y); break;
  }
  return child;
}

/* Why MuJoCo has no such joint, or NULL. */
static const char *unsupported(const struct fb_body *body) {
  const double *armature = body->armature;
  if (body->joint == FB_HELICAL) return "MuJoCo has no helical joint";
  if (body->joint == FB_FREE && body->parent >= 0) return "MuJoCo's free joint must hang on the world";
  if (body->joint == FB_FREE && (armature[0] != 0 || armature[1] != 0 || armature[2] != 0))
    return "MuJoCo's linear armature of a free joint would act on world accelerations, not on body ones";
  return NULL;
}

/* A spec that edits nothing, without constraints, contacts, fluid or automatic resets. */
static mjSpec *empty_spec(const struct fb_robot *robot) {
  mjSpec *spec = mj_makeSpec();
  mjsCompiler *compiler = &spec->compiler;
  compiler->degree = compiler->autolimits = compiler->balanceinertia = compiler->fusestatic = compiler->alignfree = 0;
  compiler->boundmass = compiler->boundinertia = 0;
  compiler->settotalmass = -1;
  compiler->inertiafromgeom = mjINERTIAFROMGEOM_FALSE;
  spec->option.disableflags = mjDSBL_CONSTRAINT | mjDSBL_CONTACT | mjDSBL_AUTORESET;
  memcpy(spec->option.gravity, robot->gravity, sizeof spec->option.gravity);
  return spec;
}

static void destroy(struct fb_handle *h) {
  if (h == NULL) return;
  double *numbers[] = {h->q, h->v, h->a, h->tau, h->masses, h->factors, h->inverses, h->result, h->work[0], h->work[1]};
  for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) free(numbers[i]);
  free(h->turn);
  free(h->body);
  free(h->dof_parent);
  if (h->data) mj_deleteData(h->data);
  if (h->model) mj_deleteModel(h->model);
  free(h);
}

/* Compiles the model; armature is set afterwards, as a joint takes only one number for all its degrees of freedom. */
static int compile(const struct fb_robot *robot, struct fb_handle *h, char *reason) {
  mjsBody **bodies = calloc(robot->bodies + 1, sizeof *bodies);
  if (bodies == NULL) return no_memory(reason);
  mjSpec *spec = empty_spec(robot);
  bodies[0] = mjs_findBody(spec, "world");
  for (size_t i = 0; i < robot->bodies; i++) bodies[i + 1] = add_body(bodies[robot->body[i].parent + 1], &robot->body[i]);
  free(bodies);
  h->model = mj_compile(spec, NULL);
  if (h->model == NULL) {
    const char *why = mjs_getError(spec);
    say(reason, FB_UNSUPPORTED, "MuJoCo refuses the model: ", why ? why : "no reason");
    mj_deleteSpec(spec);
    return FB_UNSUPPORTED;
  }
  mj_deleteSpec(spec);
  h->data = mj_makeData(h->model);
  if (h->data == NULL) return no_memory(reason);
  size_t dof = 0;
  for (size_t i = 0; i < robot->bodies; i++) {
    if ((size_t)h->model->body_dofadr[i + 1] != dof) return say(reason, FB_FAILED, "MuJoCo put the degrees of freedom in another order", "");
    for (size_t k = 0; k < fb_joint_nv(robot->body[i].joint); k++) h->model->dof_armature[dof++] = robot->body[i].armature[k];
  }
  if ((size_t)h->model->nv != robot->nv) return say(reason, FB_FAILED, "MuJoCo counts other degrees of freedom", "");
  mj_setConst(h->model, h->data); /* MuJoCo keeps constants that depend on armature */
  h->own_m = h->data->M;
  h->own_qld = h->data->qLD;
  h->own_inverse = h->data->qLDiagInv;
  return FB_OK;
}

static void read_back(const mjModel *model, double *value) {
  for (int i = 1; i < model->nbody; i++, value += 22) {
    double axes[9], placement[9], inertia[9];
    const double *moment = model->body_inertia + 3 * i;
    mju_quat2Mat(axes, model->body_iquat + 4 * i);
    mju_quat2Mat(placement, model->body_quat + 4 * i);
    for (int r = 0; r < 3; r++)
      for (int c = 0; c < 3; c++) {
        inertia[3 * r + c] = 0;
        for (int k = 0; k < 3; k++) inertia[3 * r + c] += axes[3 * r + k] * moment[k] * axes[3 * c + k];
      }
    const double six[6] = {inertia[0], inertia[1], inertia[2], inertia[4], inertia[5], inertia[8]};
    value[0] = model->body_mass[i];
    memcpy(value + 1, model->body_ipos + 3 * i, 3 * sizeof *value);
    memcpy(value + 4, six, sizeof six);
    memcpy(value + 10, placement, sizeof placement);
    memcpy(value + 19, model->body_pos + 3 * i, 3 * sizeof *value);
  }
}

/* An error of MuJoCo ends the process, which is a row; its own handler would also write a file. */
static void end_with(const char *message) {
  fprintf(stderr, "MuJoCo: %s\n", message);
  abort();
}
static void warn(const char *message) { fprintf(stderr, "MuJoCo warns: %s\n", message); }

static int create(const struct fb_robot *robot, struct fb_handle **handle, double *readback, char *reason) {
  mju_user_error = end_with;
  mju_user_warning = warn;
  for (size_t i = 0; i < robot->bodies; i++) {
    const char *why = unsupported(&robot->body[i]);
    if (why) return say(reason, FB_UNSUPPORTED, why, "");
  }
  struct fb_handle *h = calloc(1, sizeof *h);
  if (h == NULL) return no_memory(reason);
  h->bodies = robot->bodies, h->nq = robot->nq, h->nv = robot->nv;
  h->body = malloc(robot->bodies * sizeof *h->body);
  h->dof_parent = malloc(robot->nv * sizeof *h->dof_parent);
  int status = h->body && h->dof_parent && make_room(&h->result, 6 * h->nv) ? compile(robot, h, reason) : no_memory(reason);
  if (status != FB_OK) {
    destroy(h);
    return status;
  }
  memcpy(h->body, robot->body, robot->bodies * sizeof *h->body);
  memcpy(h->dof_parent, robot->dof_parent, robot->nv * sizeof *h->dof_parent);
  for (size_t i = 0; i < robot->bodies; i++) h->turns += robot->body[i].joint == FB_FREE;
  read_back(h->model, readback);
  *handle = h;
  return FB_OK;
}

/* ---- states ---- */

/* A joint's q_e, and for a free joint T and b. */
static void convert_joint(const struct fb_body *body, size_t dof, const double *q, const double *v, double *q_e, struct fb_turn *turn) {
  if (body->joint == FB_SPHERICAL) {
    const double wxyz[4] = {q[3], q[0], q[1], q[2]};
    memcpy(q_e, wxyz, sizeof wxyz);
  } else if (body->joint == FB_FREE) {
    double turned[9], placement[4];
    const double wxyz[4] = {q[6], q[3], q[4], q[5]}, *w = v + 3;
    fb_rotation(q + 3, turned);
    mju_mulMatMat(turn->t, body->rotation, turned, 3, 3, 3);
    const double product[3] = {w[1] * v[2] - w[2] * v[1], w[2] * v[0] - w[0] * v[2], w[0] * v[1] - w[1] * v[0]};
    fb_product3(turn->t, 0, product, turn->b);
    turn->dof = dof;
    fb_product3(body->rotation, 0, q, q_e);
    for (int k = 0; k < 3; k++) q_e[k] += body->translation[k];
    mju_mat2Quat(placement, body->rotation);
    mju_mulQuat(q_e + 3, placement, wxyz);
  } else {
    memcpy(q_e, q, fb_joint_nq(body->joint) * sizeof *q);
  }
}

static int set_states(struct fb_handle *h, const struct fb_states *states, char *reason) {
  const size_t count = states->count, numbers = count * h->nv;
  h->count = h->last = 0;
  free(h->turn);
  h->turn = calloc(count * h->turns + 1, sizeof *h->turn);
  const int room = h->turn && make_room(&h->q, count * h->nq) && make_room(&h->v, numbers) && make_room(&h->a, numbers) &&
                   make_room(&h->tau, numbers);
  if (!room) return no_memory(reason);
  memcpy(h->v, states->v, numbers * sizeof *h->v);
  memcpy(h->a, states->a, numbers * sizeof *h->a);
  memcpy(h->tau, states->tau, numbers * sizeof *h->tau);
  for (size_t k = 0; k < count; k++) {
    const double *q = states->q + k * h->nq, *v = states->v + k * h->nv;
    struct fb_turn *turn = h->turn + k * h->turns;
    double *q_e = h->q + k * h->nq;
    size_t dof = 0;
    for (size_t i = 0; i < h->bodies; i++) {
      const int32_t joint = h->body[i].joint;
      convert_joint(&h->body[i], dof, q, v + dof, q_e, turn);
      turn += joint == FB_FREE;
      q += fb_joint_nq(joint), q_e += fb_joint_nq(joint), dof += fb_joint_nv(joint);
    }
    fb_forth(change_at(h, k), h->v + k * h->nv);
    fb_forth(change_at(h, k), h->a + k * h->nv);
    fb_add_b(change_at(h, k), 1, h->a + k * h->nv);
    fb_forth(change_at(h, k), h->tau + k * h->nv);
  }
  h->count = count;
  return FB_OK;
}

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

/* mj_inverse as its users call it: cameras, tendons, passive forces, M and the rest among it */
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

/* ---- what methods start from ---- */

static int ready_dense(struct fb_handle *h) {
  return make_room(&h->work[0], h->nv * h->nv) && make_room(&h->work[1], h->nv * h->nv);
}

/* Mass matrices of the states and their factors. Of big robots a few go round: thousands of them would not fit the memory. */
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

const struct fb_peer *featherbench_peer(void) {
  static struct fb_peer peer = {FEATHERBENCH_PEER_VERSION,
                                FB_ENGINE,
                                NULL,
                                "language=C (libmujoco of the Python package mujoco, as it is shipped)\n" FB_BUILD,
                                names,
                                sizeof names / sizeof *names,
                                create,
                                destroy,
                                set_states,
                                ready,
                                run,
                                read_value};
  peer.engine_version = mj_versionString();
  return &peer;
}
