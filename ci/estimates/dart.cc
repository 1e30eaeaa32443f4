// DART's own calls in a loop, without Python. The package has no headers: these few declarations name symbols that its library exports. The
// test of the answers in estimates.py shows that they are right.
#include "loop.h"

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

extern "C" double loop(char what, void* const* engine, int states, int nq, int nv, const double* q, const double* v, const double* a, int calls, double* answer) {
  auto* skeleton = static_cast<Skeleton*>(engine[0]);
  auto* meta = static_cast<MetaSkeleton*>(engine[0]);
  const auto place = [&](const Vector& q, const Vector& v) {
    meta->setPositions(q);
    meta->setVelocities(v);
  };
  const auto torque = [&](const Vector& a) {
    meta->setAccelerations(a);
    skeleton->computeInverseDynamics(false, false, false);
    return meta->getForces();
  };
  const auto energy = [&] { return skeleton->computeKineticEnergy(); };
  return timed(Quantity(what), states, nq, nv, q, v, a, calls, answer, place, torque, energy);
}
