// DART's own calls in a loop, without Python. The package has no headers: these few declarations name symbols that its library exports, and
// the test of the answers in estimates.py shows that they are what they seem.
#include <Eigen/Core>
#include <chrono>

namespace dart::dynamics {
class MetaSkeleton {
 public:
  void setPositions(const Eigen::VectorXd&);
  void setVelocities(const Eigen::VectorXd&);
  void setAccelerations(const Eigen::VectorXd&);
  Eigen::VectorXd getForces() const;
};
class Skeleton {
 public:
  void computeInverseDynamics(bool, bool, bool);
  double computeKineticEnergy() const;
};
}  // namespace dart::dynamics

using namespace dart::dynamics;
using Vector = Eigen::VectorXd;
using Rows = Eigen::Map<const Eigen::Matrix<double, -1, -1, Eigen::RowMajor>>;

// Nanoseconds of a call; `answer` gets the last one.
extern "C" double loop(char what, void* const* engine, int states, int nq, int nv, const double* q, const double* v, const double* a, int calls, double* answer) {
  auto* skeleton = static_cast<Skeleton*>(engine[0]);
  auto* meta = static_cast<MetaSkeleton*>(engine[0]);
  Rows qs(q, states, nq), vs(v, states, nv), as(a, states, nv);
  Vector qk(nq), vk(nv), ak(nv), tau(nv);
  const auto start = std::chrono::steady_clock::now();
  for (int call = 0; call < calls; ++call) {
    const int k = call % states;
    qk = qs.row(k), vk = vs.row(k);
    meta->setPositions(qk);
    meta->setVelocities(vk);
    if (what == 'i') {
      ak = as.row(k);
      meta->setAccelerations(ak);
      skeleton->computeInverseDynamics(false, false, false);
      tau = meta->getForces();
    } else {
      tau[0] = skeleton->computeKineticEnergy();
    }
  }
  const auto stop = std::chrono::steady_clock::now();
  Eigen::Map<Vector>(answer, nv) = tau;
  return std::chrono::duration<double, std::nano>(stop - start).count() / calls;
}
