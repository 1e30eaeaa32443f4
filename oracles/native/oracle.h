/* A native oracle: an engine as a library behind one C interface, so that its loops can be timed beside ours.
 *
 * A library exports one function, `featherbench_oracle`, which answers a table of functions. The program loads it in a child process
 * (`featherbench serve LIBRARY`), where it may crash or take too much memory without effect on the run. README.md says how to add one.
 *
 * Coordinates: robots, states and values are in the neutral coordinates of CONVENTIONS.md. Quantities, methods and the shapes of values are
 * those of oracles/PROTOCOL.md. A native oracle converts states in `states` and values in `read`. Only `run` is timed.
 */
#ifndef FEATHERBENCH_ORACLE_H
#define FEATHERBENCH_ORACLE_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The version of this interface. A library of another version is not loaded. */
#define FEATHERBENCH_ORACLE_VERSION 1

/* Room for a reason, its terminating zero included. */
#define FB_REASON 512

/* The result of a call. The last two come with a reason, one sentence. */
enum { FB_OK = 0, FB_UNSUPPORTED = 1, FB_FAILED = 2 };

/* Joint types of the description. */
enum { FB_REVOLUTE, FB_PRISMATIC, FB_HELICAL, FB_SPHERICAL, FB_FREE, FB_PLANAR, FB_UNIVERSAL };

/* A body and the joint that carries it; the fields are those of the description in oracles/PROTOCOL.md. */
struct fb_body {
  int32_t parent; /* index of the parent body, -1 for the world */
  int32_t joint;  /* a joint type */
  double mass;
  double com[3];
  double inertia[6];     /* xx, xy, xz, yy, yz, zz about the centre of mass, body axes */
  double axis[3];        /* unit vector of revolute, prismatic and helical joints */
  double pitch;          /* metres per radian of helical joints */
  double rotation[9];    /* placement of the joint: joint axes to parent axes, row-major */
  double translation[3]; /* and its origin in the parent's frame */
  double armature[6];    /* per degree of freedom of the joint */
};

/* A robot; bodies stand in depth-first order. */
struct fb_robot {
  size_t bodies, nq, nv;
  const struct fb_body *body;
  double gravity[3];
  const int32_t *dof_parent; /* nv: the dof that a dof hangs on, -1 for none; row i of a tree-sparse matrix holds the path to i */
};

/* A batch of states, row after row. */
struct fb_states {
  size_t count;
  const double *q, *v, *a, *tau; /* count × nq, then three times count × nv */
};

/* One way to compute one quantity. */
struct fb_method {
  const char *quantity, *name;
};

/* A robot in an engine, with its states. Each library has its own. */
struct fb_handle;

/* The table of a library. Everything that a caller passes belongs to the caller, and is valid during the call only. */
struct fb_oracle {
  uint32_t version; /* FEATHERBENCH_ORACLE_VERSION */
  const char *engine;
  const char *engine_version;
  const char *build; /* lines of `key=value`: compiler, flags, versions of libraries */
  const struct fb_method *methods;
  size_t method_count;

  /* Builds the robot and reads it back, in the layout of `readback` in oracles/PROTOCOL.md. */
  int (*create)(const struct fb_robot *robot, struct fb_handle **handle, double *readback, char *reason);
  void (*destroy)(struct fb_handle *handle);

  /* Takes a batch of states and converts it to the engine's coordinates. */
  int (*states)(struct fb_handle *handle, const struct fb_states *states, char *reason);

  /* Prepares a method: for `factorization` and `solve` it computes the mass matrices and factors of the states. `body` is the body of a
   * body Jacobian. Called before `run`, and again after `states`. */
  int (*ready)(struct fb_handle *handle, size_t method, size_t body, char *reason);

  /* Evaluates `count` states from `first` on, one after the other. Beyond the end of the batch they begin again. The input is the engine's
   * q, v, a and tau; the result is in the engine's own storage. No state uses a result of another. */
  int (*run)(struct fb_handle *handle, size_t method, size_t first, size_t count, char *reason);

  /* The value of the last state that `run` evaluated by this method, in neutral coordinates. */
  int (*read)(struct fb_handle *handle, size_t method, double *value, char *reason);
};

/* The library's only symbol. */
#ifdef __GNUC__
__attribute__((visibility("default")))
#endif
const struct fb_oracle *featherbench_oracle(void);

#ifdef __cplusplus
}
#endif
#endif
