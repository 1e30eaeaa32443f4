/* A pendulum as a native oracle, the smallest engine: one revolute joint on the world. It shows what a native oracle has to do. With it the tests
 * need no installed engine. Compiled with FB_FAULTS it also has methods that crash, hang and take memory.
 *
 * With ẑ the axis, c the centre of mass from the joint's origin and g gravity in joint axes: M = ẑ'(I + m(|c|² 1 - cc'))ẑ + armature, and
 * h = -m (ẑ × R c)·g with R the rotation about ẑ by q. There is no velocity in h.
 */
#include "coordinates.h"
#include "oracle.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#ifdef FB_FAULTS
#include <unistd.h>
#endif

#ifndef FB_ENGINE
#define FB_ENGINE "pendulum"
#endif
#ifndef FB_BUILD
#define FB_BUILD "compiler=unknown"
#endif

struct fb_handle {
  struct fb_body body;
  double gravity[3]; /* in joint axes */
  size_t count;
  double *q, *a, *tau;
  double result;
};

static double dot(const double x[3], const double y[3]) { return x[0] * y[0] + x[1] * y[1] + x[2] * y[2]; }

static void cross(const double x[3], const double y[3], double z[3]) {
  z[0] = x[1] * y[2] - x[2] * y[1];
  z[1] = x[2] * y[0] - x[0] * y[2];
  z[2] = x[0] * y[1] - x[1] * y[0];
}

static double mass(const struct fb_handle *h) {
  const struct fb_body *b = &h->body;
  const double *i = b->inertia, *z = b->axis, along = dot(b->axis, b->com);
  const double row[3] = {i[0] * z[0] + i[1] * z[1] + i[2] * z[2], i[1] * z[0] + i[3] * z[1] + i[4] * z[2], i[2] * z[0] + i[4] * z[1] + i[5] * z[2]};
  return dot(row, z) + b->mass * (dot(b->com, b->com) - along * along) + b->armature[0];
}

/* ẑ × R c = cos q (ẑ × c) + sin q (ẑ × (ẑ × c)) */
static double bias(const struct fb_handle *h, size_t k) {
  double across[3], out[3];
  cross(h->body.axis, h->body.com, across);
  cross(h->body.axis, across, out);
  return -h->body.mass * (cos(h->q[k]) * dot(across, h->gravity) + sin(h->q[k]) * dot(out, h->gravity));
}

static void run_id(struct fb_handle *h, size_t k) { h->result = mass(h) * h->a[k] + bias(h, k); }
static void run_bias(struct fb_handle *h, size_t k) { h->result = bias(h, k); }
static void run_mass(struct fb_handle *h, size_t k) { (void)k, h->result = mass(h); }
static void run_fd(struct fb_handle *h, size_t k) { h->result = (h->tau[k] - bias(h, k)) / mass(h); }

#ifdef FB_FAULTS
static void run_abort(struct fb_handle *h, size_t k) {
  (void)h, (void)k;
  fputs("the pendulum broke off\n", stderr);
  abort();
}
static void run_segfault(struct fb_handle *h, size_t k) {
  (void)k;
  volatile uintptr_t nowhere = 8;
  *(volatile double *)nowhere = h->result;
}
static void run_hang(struct fb_handle *h, size_t k) {
  (void)h, (void)k;
  for (;;) pause();
}
static void run_glutton(struct fb_handle *h, size_t k) {
  (void)k;
  for (volatile char *room;;) {
    room = malloc((size_t)1 << 24);
    if (room == NULL) fputs("no more memory for the pendulum\n", stderr), abort();
    for (size_t i = 0; i < (size_t)1 << 24; i += 4096) room[i] = (char)h->result;
  }
}
static void run_slow(struct fb_handle *h, size_t k) {
  usleep(1000);
  run_id(h, k);
}
static void run_wrong(struct fb_handle *h, size_t k) {
  run_id(h, k);
  h->result *= 1 + 1e-9;
}
static void run_chatter(struct fb_handle *h, size_t k) {
  puts("All is well on standard output!");
  fflush(stdout);
  run_id(h, k);
}
#endif

static const struct fb_method names[] = {
    {"id", "pendulum"}, {"bias", "pendulum"},    {"mass_matrix", "pendulum"}, {"mass_matrix_sparse", "pendulum"},
    {"fd", "pendulum"}, {"factorization", "pendulum"},
#ifdef FB_FAULTS
    {"id", "abort"},    {"id", "segfault"},      {"id", "hang"},              {"id", "glutton"},
    {"id", "slow"},     {"id", "wrong"},         {"id", "chatter"},
#endif
};

static void (*const methods[])(struct fb_handle *, size_t) = {
    run_id,    run_bias,     run_mass, run_mass,    run_fd,   run_mass,
#ifdef FB_FAULTS
    run_abort, run_segfault, run_hang, run_glutton, run_slow, run_wrong, run_chatter,
#endif
};
_Static_assert(sizeof methods / sizeof *methods == sizeof names / sizeof *names, "each name has a method");

static void destroy(struct fb_handle *h) {
  if (h == NULL) return;
  free(h->q);
  free(h->a);
  free(h->tau);
  free(h);
}

static int create(const struct fb_robot *robot, struct fb_handle **handle, double *readback, char *reason) {
  const struct fb_body *b = robot->body;
  if (robot->bodies != 1 || b->joint != FB_REVOLUTE) {
    snprintf(reason, FB_REASON, "a pendulum has one revolute joint, this robot has %zu bodies", robot->bodies);
    return FB_UNSUPPORTED;
  }
  struct fb_handle *h = calloc(1, sizeof *h);
  if (h == NULL) {
    snprintf(reason, FB_REASON, "no memory for a pendulum");
    return FB_FAILED;
  }
  h->body = *b;
  fb_product3(b->rotation, 1, robot->gravity, h->gravity);
  readback[0] = b->mass;
  memcpy(readback + 1, b->com, sizeof b->com);
  memcpy(readback + 4, b->inertia, sizeof b->inertia);
  memcpy(readback + 10, b->rotation, sizeof b->rotation);
  memcpy(readback + 19, b->translation, sizeof b->translation);
  *handle = h;
  return FB_OK;
}

static double *copy(const double *numbers, size_t count) {
  double *made = malloc((count > 0 ? count : 1) * sizeof *made);
  if (made) memcpy(made, numbers, count * sizeof *made);
  return made;
}

static int states(struct fb_handle *h, const struct fb_states *states, char *reason) {
  free(h->q), free(h->a), free(h->tau);
  h->count = states->count;
  h->q = copy(states->q, states->count), h->a = copy(states->a, states->count), h->tau = copy(states->tau, states->count);
  if (h->q && h->a && h->tau) return FB_OK;
  snprintf(reason, FB_REASON, "no memory for %zu states", states->count);
  return FB_FAILED;
}

static int ready(struct fb_handle *h, size_t method, size_t body, char *reason) {
  (void)h, (void)method, (void)body, (void)reason;
  return FB_OK;
}

static int run(struct fb_handle *h, size_t method, size_t first, size_t count, char *reason) {
  (void)reason;
  size_t k = first % h->count;
  for (size_t n = 0; n < count; n++) {
    methods[method](h, k);
    if (++k == h->count) k = 0;
  }
  return FB_OK;
}

static int read_value(struct fb_handle *h, size_t method, double *value, char *reason) {
  (void)method, (void)reason;
  *value = h->result;
  return FB_OK;
}

const struct fb_oracle *featherbench_oracle(void) {
  static const struct fb_oracle table = {FEATHERBENCH_ORACLE_VERSION, FB_ENGINE, "1", "language=C\n" FB_BUILD, names,     sizeof names / sizeof *names, create,
                                      destroy,                   states,    ready, run,                   read_value};
  return &table;
}
