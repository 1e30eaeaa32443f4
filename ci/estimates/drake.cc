// Drake's own calls in a loop, without Python. The package has no headers: these few declarations name symbols that its library exports, and
// the test of the answers in estimates.py shows that they are what they seem.
#include <Eigen/Core>
#include <chrono>

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
using Vector = Eigen::VectorXd;
using Rows = Eigen::Map<const Eigen::Matrix<double, -1, -1, Eigen::RowMajor>>;

// Nanoseconds of a call; `answer` gets the last one.
extern "C" double loop(char what, void* const* engine, int states, int nq, int nv, const double* q, const double* v, const double* a, int calls, double* answer) {
  auto* plant = static_cast<multibody::MultibodyPlant<double>*>(engine[0]);
  auto* context = static_cast<systems::Context<double>*>(engine[1]);
  auto* forces = static_cast<multibody::MultibodyForces<double>*>(engine[2]);
  Rows qs(q, states, nq), vs(v, states, nv), as(a, states, nv);
  Vector qk(nq), vk(nv), ak(nv), tau(nv);
  const auto start = std::chrono::steady_clock::now();
  for (int call = 0; call < calls; ++call) {
    const int k = call % states;
    qk = qs.row(k), vk = vs.row(k);
    plant->SetPositions(context, qk);
    plant->SetVelocities(context, vk);
    if (what == 'i') {
      ak = as.row(k);
      plant->CalcForceElementsContribution(*context, forces);
      tau = plant->CalcInverseDynamics(*context, ak, *forces);
    } else {
      tau[0] = reinterpret_cast<systems::System<double>*>(plant)->CalcKineticEnergy(*context);
    }
  }
  const auto stop = std::chrono::steady_clock::now();
  Eigen::Map<Vector>(answer, nv) = tau;
  return std::chrono::duration<double, std::nano>(stop - start).count() / calls;
}
