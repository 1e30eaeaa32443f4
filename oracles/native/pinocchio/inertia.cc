// The mass matrix by crba in both conventions, its factors M = U D U' and solutions by them.
//
// Pinocchio's U is our L': both eliminate from the leaves, so the factors are the same numbers.

#include "robot.h"

#include <pinocchio/algorithm/cholesky.hpp>
#include <pinocchio/algorithm/crba.hpp>

namespace {

using pinocchio::Convention;

template <Convention convention>
void crba(fb_handle &robot, size_t k) {
  pinocchio::crba(robot.model, *robot.data, robot.q(k), convention);
}

void read_dense(fb_handle &robot, double *mass) {
  write_symmetric(robot.data->M, mass);
  fb_back_matrix(robot.change(), robot.nv(), mass);
}

void read_sparse(fb_handle &robot, double *mass) {
  std::vector<double> dense(robot.data->M.size());
  read_dense(robot, dense.data());
  fb_tree_sparse(robot.nv(), robot.dof_parent.data(), dense.data(), mass);
}

// Mass matrices of the states. Each state uses its own.
void ready_masses(fb_handle &robot) {
  robot.matrices.clear();
  for (size_t k = 0; k < robot.count; k++) robot.matrices.push_back(mass_matrix(robot, k));
}

// Into Data and out again by exchanging pointers: no copy is timed.
void decompose(fb_handle &robot, size_t k) {
  auto &mass = robot.matrices[k % robot.matrices.size()];
  robot.data->M.swap(mass);
  pinocchio::cholesky::decompose(robot.model, *robot.data);
  robot.data->M.swap(mass);
}

void read_factors(fb_handle &robot, double *sparse) {
  const auto &data = *robot.data;
  const size_t n = robot.nv();
  std::vector<double> factors(n * n), work(n * n);
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j < i; j++) factors[i * n + j] = data.U(j, i);
  for (size_t i = 0; i < n; i++) factors[i * n + i] = data.D[i];
  fb_factors_to_neutral(robot.change(), n, robot.dof_parent.data(), factors.data(), work.data(), sparse);
}

void ready_factors(fb_handle &robot) {
  ready_masses(robot);
  robot.diagonals.clear();
  robot.inverse.clear();
  auto &data = *robot.data;
  for (auto &matrix : robot.matrices) {
    data.M = matrix;
    pinocchio::cholesky::decompose(robot.model, data);
    matrix = data.U;
    robot.diagonals.push_back(data.D);
    robot.inverse.push_back(data.Dinv);
  }
}

void solve(fb_handle &robot, size_t k) {
  auto &data = *robot.data;
  const size_t at = k % robot.matrices.size();
  const auto exchange = [&] {
    data.U.swap(robot.matrices[at]);
    data.D.swap(robot.diagonals[at]);
    data.Dinv.swap(robot.inverse[at]);
  };
  exchange();
  robot.solution = robot.tau(k);
  pinocchio::cholesky::solve(robot.model, data, robot.solution);
  exchange();
}

void read_solution(fb_handle &robot, double *x) {
  write(robot.solution, x);
  fb_back(robot.change(), x);
}

} // namespace

const Eigen::MatrixXd &mass_matrix(fb_handle &robot, size_t k) {
  return pinocchio::crba(robot.model, *robot.data, robot.q(k), Convention::LOCAL);
}

const std::vector<Method> mass_matrices = {
    {"mass_matrix", "crba_local", nullptr, crba<Convention::LOCAL>, read_dense},
    {"mass_matrix", "crba_world", nullptr, crba<Convention::WORLD>, read_dense},
    {"mass_matrix_sparse", "crba_local", nullptr, crba<Convention::LOCAL>, read_sparse},
    {"mass_matrix_sparse", "crba_world", nullptr, crba<Convention::WORLD>, read_sparse},
    {"factorization", "cholesky", ready_masses, decompose, read_factors},
    {"solve", "cholesky", ready_factors, solve, read_solution},
};
