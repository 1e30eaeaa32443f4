// The loop of both engines, which estimates.py calls, and the functions that it calls.
#pragma once
#include <Eigen/Core>
#include <chrono>

using Vector = Eigen::VectorXd;

// What is computed at a state.
enum class Quantity : char { inverse_dynamics = 'i', kinetic_energy = 'k' };

// Nanoseconds of a call; `answer` gets the last one. `place(q, v)` sets a state, `torque(a)` is its inverse dynamics, `energy()` its kinetic
// energy; matrices are row-major, a row for each state.
template <class Place, class Torque, class Energy>
double timed(Quantity what, int states, int nq, int nv, const double* q, const double* v, const double* a, int calls, double* answer, Place place, Torque torque,
             Energy energy) {
  using Rows = Eigen::Map<const Eigen::Matrix<double, -1, -1, Eigen::RowMajor>>;
  Rows qs(q, states, nq), vs(v, states, nv), as(a, states, nv);
  Vector qk(nq), vk(nv), ak(nv), value(nv);
  const auto start = std::chrono::steady_clock::now();
  for (int call = 0; call < calls; ++call) {
    const int k = call % states;
    qk = qs.row(k), vk = vs.row(k);
    place(qk, vk);
    if (what == Quantity::inverse_dynamics) {
      ak = as.row(k);
      value = torque(ak);
    } else {
      value[0] = energy();
    }
  }
  const auto stop = std::chrono::steady_clock::now();
  Eigen::Map<Vector>(answer, nv) = value;
  return std::chrono::duration<double, std::nano>(stop - start).count() / calls;
}
