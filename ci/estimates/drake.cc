// Drake's own calls in a loop, without Python. The package has no headers: these few declarations name symbols that its library exports. The
// test of the answers in estimates.py shows that they are right.
#include "loop.h"

namespace drake {
namespace systems {
template <class T> class Context;
template <class T> class System {
 public:
  T CalcKineticEnergy(const Context<T>&) const;
};
}  // namespace systems
namespace multibody {
template <class T> class MultibodyForces;
template <class T> class MultibodyPlant {
 public:
  using Vector = Eigen::Matrix<T, -1, 1>;
  void SetPositions(systems::Context<T>*, const Eigen::Ref<const Vector>&) const;
  void SetVelocities(systems::Context<T>*, const Eigen::Ref<const Vector>&) const;
  void CalcForceElementsContribution(const systems::Context<T>&, MultibodyForces<T>*) const;
  Vector CalcInverseDynamics(const systems::Context<T>&, const Vector&, const MultibodyForces<T>&) const;
};
}  // namespace multibody
}  // namespace drake

using namespace drake;

extern "C" double loop(char what, void* const* engine, int states, int nq, int nv, const double* q, const double* v, const double* a, int calls, double* answer) {
  auto* plant = static_cast<multibody::MultibodyPlant<double>*>(engine[0]);
  auto* context = static_cast<systems::Context<double>*>(engine[1]);
  auto* forces = static_cast<multibody::MultibodyForces<double>*>(engine[2]);
  const auto place = [&](const Vector& q, const Vector& v) {
    plant->SetPositions(context, q);
    plant->SetVelocities(context, v);
  };
  const auto torque = [&](const Vector& a) {
    plant->CalcForceElementsContribution(*context, forces);
    return plant->CalcInverseDynamics(*context, a, *forces);
  };
  const auto energy = [&] { return reinterpret_cast<systems::System<double>*>(plant)->CalcKineticEnergy(*context); };
  return timed(Quantity(what), states, nq, nv, q, v, a, calls, answer, place, torque, energy);
}
