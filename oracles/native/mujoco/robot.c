/* Building the robot by MjSpec's C interface, and its states.
 *
 * The robot and the coordinates are as in oracles/featherbench_oracles/mujoco: free joints have q_e = (p of the world, quaternion wxyz),
 * T = diag(R, 1) and b = (R (ω × v), 0); spherical joints a quaternion wxyz; planar and universal joints are several in one body.
 */
#include "robot.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static int say(char *reason, int status, const char *what, const char *detail) {
  snprintf(reason, FB_REASON, "%s%s", what, detail);
  return status;
}

int no_memory(char *reason) { return say(reason, FB_FAILED, "no memory for the states or matrices of this robot", ""); }

int make_room(double **numbers, size_t count) {
  free(*numbers);
  *numbers = calloc(count > 0 ? count : 1, sizeof **numbers);
  return *numbers != NULL;
}

struct fb_change change_at(const struct fb_handle *h, size_t k) {
  const struct fb_change change = {h->turns, h->turn + k * h->turns};
  return change;
}

/* ---- the robot ---- */

/* Principal moments and axes (columns of a rotation) by Jacobi's rotations, to the last bit. MuJoCo's own iteration stops at 1e-12 kg·m². */
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

/* A spec without edits, constraints, contacts, fluid and automatic resets. */
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

void mujoco_destroy(struct fb_handle *h) {
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

/* Compiles the model; armature is set afterwards, because a joint takes only one number for all its degrees of freedom. */
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

/* An error of MuJoCo ends the process, and a row says so. MuJoCo's own handler would also write a file. */
static void end_with(const char *message) {
  fprintf(stderr, "MuJoCo: %s\n", message);
  abort();
}
static void warn(const char *message) { fprintf(stderr, "MuJoCo warns: %s\n", message); }

int mujoco_create(const struct fb_robot *robot, struct fb_handle **handle, double *readback, char *reason) {
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
    mujoco_destroy(h);
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

int mujoco_states(struct fb_handle *h, const struct fb_states *states, char *reason) {
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
