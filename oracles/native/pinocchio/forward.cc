// Forward dynamics: aba in both conventions, and computeMinverse.

#include "robot.h"

#include <pinocchio/algorithm/aba.hpp>

namespace {

template <pinocchio::Convention convention>
void aba(fb_handle &robot, size_t k) {
  pinocchio::aba(robot.model, *robot.data, robot.q(k), robot.v(k), robot.tau(k), convention);
}

void read_aba(fb_handle &robot, double *a) {
  write(robot.data->ddq, a);
  fb_add_b(robot.change(), -1, a);
  fb_back(robot.change(), a);
}

void minverse(fb_handle &robot, size_t k) { pinocchio::computeMinverse(robot.model, *robot.data, robot.q(k)); }

void read_minverse(fb_handle &robot, double *inverse) {
  write_symmetric(robot.data->Minv, inverse);
  fb_back_matrix(robot.change(), robot.nv(), inverse);
}

} // namespace

const std::vector<Method> forward_dynamics = {
    {"fd", "aba_local", nullptr, aba<pinocchio::Convention::LOCAL>, read_aba},
    {"fd", "aba_world", nullptr, aba<pinocchio::Convention::WORLD>, read_aba},
    {"mass_matrix_inverse", "minverse", nullptr, minverse, read_minverse},
};
