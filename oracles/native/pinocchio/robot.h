// A robot in Pinocchio with its states, shared by the files of algorithms.
//
// Every algorithm is instantiated here from Pinocchio's headers, with the flags of the build, and not taken from the wheel's libraries,
// which are built for any processor. One file per group of algorithms keeps each compilation short.
#pragma once

#include "../coordinates.h"
#include "../oracle.h"

#include <pinocchio/multibody.hpp>

#include <memory>
#include <stdexcept>
#include <vector>

using Vector = Eigen::Map<const Eigen::VectorXd>;

struct fb_handle {
  std::vector<fb_body> bodies;
  std::vector<int32_t> dof_parent;
  pinocchio::Model model;
  std::unique_ptr<pinocchio::Data> data;

  // The states in Pinocchio's coordinates, and their conversion.
  size_t count = 0;
  std::vector<double> q_e, v_e, a_e, tau_e;
  std::vector<fb_turn> turns; // turns_per_state for each state
  size_t turns_per_state = 0;

  // The input of a method, and its result if Pinocchio's Data does not keep it.
  size_t body = 0;
  std::vector<Eigen::MatrixXd> matrices;           // mass matrices, or their factors U
  std::vector<Eigen::VectorXd> diagonals, inverse; // D and 1/D
  Eigen::VectorXd solution;
  Eigen::Matrix<double, 6, Eigen::Dynamic> jacobian;
  size_t last = 0; // the state that was evaluated last

  int nv() const { return model.nv; }
  Vector q(size_t k) const { return {q_e.data() + k * model.nq, model.nq}; }
  Vector v(size_t k) const { return {v_e.data() + k * nv(), nv()}; }
  Vector a(size_t k) const { return {a_e.data() + k * nv(), nv()}; }
  Vector tau(size_t k) const { return {tau_e.data() + k * nv(), nv()}; }
  fb_change change() const { return {turns_per_state, turns.data() + last * turns_per_state}; }
};

// What the engine does not have; the text says what.
struct Unsupported : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// How a method is run and read. `run` evaluates one state; `read` writes the value of the last one in neutral coordinates.
struct Method {
  const char *quantity, *name;
  void (*ready)(fb_handle &);
  void (*run)(fb_handle &, size_t k);
  void (*read)(fb_handle &, double *value);
};

// The groups of algorithms, one file each.
extern const std::vector<Method> inverse_dynamics, forward_dynamics, mass_matrices, kinematics, momenta, derivatives;

// Writes a vector, a force or an acceleration, as it is.
inline void write(const Eigen::VectorXd &x, double *value) { Eigen::Map<Eigen::VectorXd>(value, x.size()) = x; }

// Row-major, both triangles, of a matrix whose upper triangle is known.
template <typename Matrix>
void write_symmetric(const Matrix &upper, double *value) {
  for (Eigen::Index i = 0; i < upper.rows(); i++)
    for (Eigen::Index j = 0; j < upper.cols(); j++) value[i * upper.cols() + j] = upper(std::min(i, j), std::max(i, j));
}

// The M of a state, upper triangle.
const Eigen::MatrixXd &mass_matrix(fb_handle &robot, size_t k);
