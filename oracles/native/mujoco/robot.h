/* A robot in MuJoCo with its states, shared by building and running. */
#ifndef FEATHERBENCH_MUJOCO_ROBOT_H
#define FEATHERBENCH_MUJOCO_ROBOT_H

#include "../coordinates.h"
#include "../oracle.h"

#include <mujoco/mujoco.h>

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
  double *work[2];  /* nv × nv; of an inverse the result, and the identity */
  size_t last;      /* the state that was evaluated last */
};

/* Functions of the table in oracle.h. */
int mujoco_create(const struct fb_robot *robot, struct fb_handle **handle, double *readback, char *reason);
void mujoco_destroy(struct fb_handle *handle);
int mujoco_states(struct fb_handle *handle, const struct fb_states *states, char *reason);

/* Writes the reason that memory is missing; returns FB_FAILED. */
int no_memory(char *reason);

/* Replaces the memory by room for some numbers; false if there is no memory. */
int make_room(double **numbers, size_t count);

/* The change of coordinates of a state. */
struct fb_change change_at(const struct fb_handle *handle, size_t k);

#endif
