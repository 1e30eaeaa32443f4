// Derivatives: computeRNEADerivatives, computeABADerivatives, the Coriolis matrix and the torque regressor.
//
// Values are those of Pinocchio's own coordinates. They are the neutral ones of every joint but the planar one, whose conversion has
// derivatives too: the oracle in Python has them, and these methods are for times.

#include "robot.h"

#include <pinocchio/algorithm/aba-derivatives.hpp>
#include <pinocchio/algorithm/regressor.hpp>
#include <pinocchio/algorithm/rnea-derivatives.hpp>
#include <pinocchio/algorithm/rnea.hpp>

namespace {

void only_own_coordinates(fb_handle &robot) {
  if (robot.turns_per_state != 0) throw Unsupported("derivatives of robots with planar joints are those of the oracle in Python");
}

void rnea(fb_handle &robot, size_t k) {
  pinocchio::computeRNEADerivatives(robot.model, *robot.data, robot.q(k), robot.v(k), robot.a(k));
}

void aba(fb_handle &robot, size_t k) {
  pinocchio::computeABADerivatives(robot.model, *robot.data, robot.q(k), robot.v(k), robot.tau(k));
}

void coriolis(fb_handle &robot, size_t k) { pinocchio::computeCoriolisMatrix(robot.model, *robot.data, robot.q(k), robot.v(k)); }

void regressor(fb_handle &robot, size_t k) {
  pinocchio::computeJointTorqueRegressor(robot.model, *robot.data, robot.q(k), robot.v(k), robot.a(k));
}

// Row-major.
template <typename Matrix>
void write_matrix(const Matrix &matrix, double *value) {
  for (Eigen::Index i = 0; i < matrix.rows(); i++)
    for (Eigen::Index j = 0; j < matrix.cols(); j++) value[i * matrix.cols() + j] = matrix(i, j);
}

void read_id_dq(fb_handle &robot, double *value) { write_matrix(robot.data->dtau_dq, value); }
void read_id_dv(fb_handle &robot, double *value) { write_matrix(robot.data->dtau_dv, value); }
void read_fd_dq(fb_handle &robot, double *value) { write_matrix(robot.data->ddq_dq, value); }
void read_fd_dv(fb_handle &robot, double *value) { write_matrix(robot.data->ddq_dv, value); }
void read_coriolis(fb_handle &robot, double *value) { write_matrix(robot.data->C, value); }

// Pinocchio has yy before xz.
void read_regressor(fb_handle &robot, double *value) {
  const auto &y = robot.data->jointTorqueRegressor;
  const int theirs[10] = {0, 1, 2, 3, 4, 5, 7, 6, 8, 9};
  for (Eigen::Index i = 0; i < y.rows(); i++)
    for (Eigen::Index j = 0; j < y.cols(); j++) value[i * y.cols() + j] = y(i, j / 10 * 10 + theirs[j % 10]);
}

} // namespace

const std::vector<Method> derivatives = {
    {"id_dq", "rnea_derivatives", only_own_coordinates, rnea, read_id_dq},
    {"id_dv", "rnea_derivatives", only_own_coordinates, rnea, read_id_dv},
    {"fd_dq", "aba_derivatives", only_own_coordinates, aba, read_fd_dq},
    {"fd_dv", "aba_derivatives", only_own_coordinates, aba, read_fd_dv},
    {"coriolis_matrix", "coriolis_matrix", only_own_coordinates, coriolis, read_coriolis},
    {"torque_regressor", "joint_torque_regressor", only_own_coordinates, regressor, read_regressor},
};
