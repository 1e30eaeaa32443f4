// Building the robot by `addJoint` and `appendBodyToJoint`, states, and the table of the library.
//
// Coordinates: as in oracles/featherbench_oracles/pinocchio. Planar joints have q_e = (x, y, cos θ, sin θ), T = diag(R(θ)', 1) and b = (θ̇ v_y, -θ̇ v_x, 0) with
// v = R(θ)' (ẋ, ẏ). All other coordinates are neutral.

#include "robot.h"

#include <pinocchio/algorithm/check.hpp>

#include <cmath>
#include <cstdio>
#include <new>
#include <stdexcept>
#include <string>

namespace {

// Runs an action; an exception becomes a status and its reason.
template <typename Action>
int guarded(char *reason, Action action) {
  try {
    action();
    return FB_OK;
  } catch (const Unsupported &why) {
    std::snprintf(reason, FB_REASON, "%s", why.what());
    return FB_UNSUPPORTED;
  } catch (const std::bad_alloc &) {
    std::snprintf(reason, FB_REASON, "Pinocchio needs more memory than its process may have");
  } catch (const std::exception &why) {
    std::snprintf(reason, FB_REASON, "%s", why.what());
  } catch (...) {
    std::snprintf(reason, FB_REASON, "Pinocchio threw something that is no exception");
  }
  return FB_FAILED;
}

// Pinocchio's joint of the description's type, in its aligned form if the axis is exactly a unit vector of the frame.
pinocchio::JointModel joint_model(const fb_body &body) {
  using namespace pinocchio;
  const Eigen::Vector3d axis(body.axis);
  const bool x = axis == Eigen::Vector3d::UnitX(), y = axis == Eigen::Vector3d::UnitY(), z = axis == Eigen::Vector3d::UnitZ();
  switch (body.joint) {
  case FB_REVOLUTE:
    if (x) return JointModelRX();
    if (y) return JointModelRY();
    if (z) return JointModelRZ();
    return JointModelRevoluteUnaligned(axis);
  case FB_PRISMATIC:
    if (x) return JointModelPX();
    if (y) return JointModelPY();
    if (z) return JointModelPZ();
    return JointModelPrismaticUnaligned(axis);
  case FB_HELICAL:
    if (x) return JointModelHX(body.pitch);
    if (y) return JointModelHY(body.pitch);
    if (z) return JointModelHZ(body.pitch);
    return JointModelHelicalUnaligned(axis, body.pitch);
  case FB_SPHERICAL: return JointModelSpherical();
  case FB_FREE: return JointModelFreeFlyer();
  case FB_PLANAR: return JointModelPlanar();
  case FB_UNIVERSAL: return JointModelUniversal(Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY());
  default: throw std::runtime_error("no such joint type");
  }
}

// The inertia set part by part. The constructor rejects an indefinite inertia; the algorithms compute with it.
pinocchio::Inertia spatial_inertia(const fb_body &body) {
  const double *i = body.inertia;
  pinocchio::Inertia inertia = pinocchio::Inertia::Zero();
  inertia.mass() = body.mass;
  inertia.lever() = Eigen::Vector3d(body.com);
  inertia.inertia().data() << i[0], i[1], i[3], i[2], i[4], i[5]; // Pinocchio keeps xx, xy, yy, xz, yz, zz
  return inertia;
}

void build(const fb_robot &robot, fb_handle &handle) {
  handle.bodies.assign(robot.body, robot.body + robot.bodies);
  handle.dof_parent.assign(robot.dof_parent, robot.dof_parent + robot.nv);
  auto &model = handle.model;
  model.gravity = pinocchio::Motion(Eigen::Vector3d(robot.gravity), Eigen::Vector3d::Zero());
  for (size_t i = 0; i < robot.bodies; i++) {
    const fb_body &body = robot.body[i];
    if (body.joint == FB_PLANAR && (body.armature[0] != 0 || body.armature[1] != 0))
      throw Unsupported("Pinocchio's armature of a planar joint would act in body axes, not in the joint frame's");
    handle.turns_per_state += body.joint == FB_PLANAR;
    const Eigen::Matrix3d rotation = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(body.rotation);
    const pinocchio::SE3 placement(rotation, Eigen::Vector3d(body.translation));
    const auto index = model.addJoint(body.parent + 1, joint_model(body), placement, "joint " + std::to_string(i));
    model.appendBodyToJoint(index, spatial_inertia(body), pinocchio::SE3::Identity());
    if (index != i + 1) throw std::runtime_error("Pinocchio put a joint elsewhere");
    for (int k = 0; k < model.joints[index].nv(); k++) model.armature[model.joints[index].idx_v() + k] = body.armature[k];
  }
  if (size_t(model.nv) != robot.nv) throw std::runtime_error("Pinocchio counts other degrees of freedom");
  try {
    handle.data = std::make_unique<pinocchio::Data>(model);
  } catch (const std::bad_alloc &) {
    const double gigabytes = 4 * 8e-9 * std::pow(double(model.nv), 3);
    char reason[FB_REASON];
    std::snprintf(reason, sizeof reason,
                  "Pinocchio's Data does not fit the memory limit: its four dense tensors of nv³ numbers alone take %.1f GB at nv = %d", gigabytes,
                  model.nv);
    throw Unsupported(reason);
  }
  if (!model.check(*handle.data)) throw std::runtime_error("Pinocchio's own check of the model fails");
  handle.solution.resize(model.nv);
  handle.jacobian.setZero(6, model.nv);
}

void write_readback(const fb_handle &handle, double *value) {
  using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  for (size_t i = 1; i < size_t(handle.model.njoints); i++, value += 22) {
    const auto &inertia = handle.model.inertias[i];
    const auto &placement = handle.model.jointPlacements[i];
    const Eigen::Matrix3d m = inertia.inertia().matrix();
    const double six[6] = {m(0, 0), m(0, 1), m(0, 2), m(1, 1), m(1, 2), m(2, 2)};
    value[0] = inertia.mass();
    Eigen::Map<Eigen::Vector3d>(value + 1) = inertia.lever();
    memcpy(value + 4, six, sizeof six);
    Eigen::Map<RowMajor>(value + 10) = placement.rotation();
    Eigen::Map<Eigen::Vector3d>(value + 19) = placement.translation();
  }
}

void convert(const fb_states &states, fb_handle &handle) {
  const size_t nv = handle.nv();
  handle.count = states.count;
  handle.last = 0;
  handle.q_e.clear();
  handle.turns.clear();
  handle.v_e.assign(states.v, states.v + states.count * nv);
  handle.a_e.assign(states.a, states.a + states.count * nv);
  handle.tau_e.assign(states.tau, states.tau + states.count * nv);
  const double *q = states.q;
  for (size_t k = 0; k < states.count; k++) {
    size_t dof = 0;
    for (const fb_body &body : handle.bodies) {
      const size_t nq = fb_joint_nq(body.joint);
      if (body.joint == FB_PLANAR) {
        const double c = std::cos(q[2]), s = std::sin(q[2]), *v = states.v + k * nv + dof;
        const double vx = c * v[0] + s * v[1], vy = -s * v[0] + c * v[1];
        handle.turns.push_back({dof, {c, s, 0, -s, c, 0, 0, 0, 1}, {v[2] * vy, -v[2] * vx, 0}});
        handle.q_e.insert(handle.q_e.end(), {q[0], q[1], c, s});
      } else {
        handle.q_e.insert(handle.q_e.end(), q, q + nq);
      }
      q += nq;
      dof += fb_joint_nv(body.joint);
    }
    handle.last = k;
    fb_forth(handle.change(), handle.v_e.data() + k * nv);
    fb_forth(handle.change(), handle.a_e.data() + k * nv);
    fb_add_b(handle.change(), 1, handle.a_e.data() + k * nv);
    fb_forth(handle.change(), handle.tau_e.data() + k * nv);
  }
}

const std::vector<Method> &methods() {
  static const std::vector<Method> all = [] {
    std::vector<Method> all;
    for (const auto *group : {&inverse_dynamics, &forward_dynamics, &mass_matrices, &kinematics, &momenta, &derivatives})
      all.insert(all.end(), group->begin(), group->end());
    return all;
  }();
  return all;
}

int create(const fb_robot *robot, fb_handle **handle, double *readback, char *reason) {
  return guarded(reason, [&] {
    auto made = std::make_unique<fb_handle>();
    build(*robot, *made);
    write_readback(*made, readback);
    *handle = made.release();
  });
}

void destroy(fb_handle *handle) { delete handle; }

int set_states(fb_handle *handle, const fb_states *states, char *reason) {
  return guarded(reason, [&] { convert(*states, *handle); });
}

int ready(fb_handle *handle, size_t method, size_t body, char *reason) {
  return guarded(reason, [&] {
    handle->body = body;
    if (methods()[method].ready) methods()[method].ready(*handle);
  });
}

int run(fb_handle *handle, size_t method, size_t first, size_t count, char *reason) {
  return guarded(reason, [&] {
    const auto evaluate = methods()[method].run;
    size_t k = first % handle->count;
    for (size_t n = 0; n < count; n++) {
      evaluate(*handle, k);
      handle->last = k;
      if (++k == handle->count) k = 0;
    }
  });
}

int read(fb_handle *handle, size_t method, double *value, char *reason) {
  return guarded(reason, [&] { methods()[method].read(*handle, value); });
}

} // namespace

const fb_oracle *featherbench_oracle() {
  static const std::vector<fb_method> names = [] {
    std::vector<fb_method> names;
    for (const Method &method : methods()) names.push_back({method.quantity, method.name});
    return names;
  }();
  static const std::string build = std::string("language=C++ (headers of the Python package pin)\n" FB_BUILD "\nsimd=") +
                                   Eigen::SimdInstructionSetsInUse() + "\neigen=" + std::to_string(EIGEN_WORLD_VERSION) + "." +
                                   std::to_string(EIGEN_MAJOR_VERSION) + "." + std::to_string(EIGEN_MINOR_VERSION) +
                                   "\nboost=" BOOST_LIB_VERSION;
  static const fb_oracle table = {FEATHERBENCH_ORACLE_VERSION, FB_ENGINE, PINOCCHIO_VERSION, build.c_str(), names.data(), names.size(),
                               create, destroy, set_states, ready, run, read};
  return &table;
}
