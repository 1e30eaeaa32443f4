// Inverse dynamics: rnea, and nonLinearEffects for the bias.

#include "robot.h"

#include <pinocchio/algorithm/rnea.hpp>

namespace {

void rnea(fb_handle &robot, size_t k) { pinocchio::rnea(robot.model, *robot.data, robot.q(k), robot.v(k), robot.a(k)); }

void read_rnea(fb_handle &robot, double *tau) {
  write(robot.data->tau, tau);
  fb_back(robot.change(), tau);
}

void bias(fb_handle &robot, size_t k) { pinocchio::nonLinearEffects(robot.model, *robot.data, robot.q(k), robot.v(k)); }

// h = T' (h_e + M_e b)
void read_bias(fb_handle &robot, double *h) {
  Eigen::VectorXd b = Eigen::VectorXd::Zero(robot.nv());
  fb_add_b(robot.change(), 1, b.data());
  Eigen::VectorXd bias = robot.data->nle;
  if (!b.isZero(0)) bias += mass_matrix(robot, robot.last).selfadjointView<Eigen::Upper>() * b;
  write(bias, h);
  fb_back(robot.change(), h);
}

} // namespace

const std::vector<Method> inverse_dynamics = {
    {"id", "rnea", nullptr, rnea, read_rnea},
    {"bias", "nonlinear_effects", nullptr, bias, read_bias},
};
