//! The methods of our engine: as types within, by their names in rows.

use featherbench_bench::{BATCH, Quantity};

/// The methods, each with its name in rows.
macro_rules! methods {
    ($($method:ident $name:tt,)*) => {
        /// A way of ours to a quantity. Its name says which text runs.
        #[derive(Clone, Copy, PartialEq, Eq)]
        pub(crate) enum Method {
            $($method,)*
        }

        impl Method {
            pub(crate) fn name(self) -> &'static str {
                match self {
                    $(Self::$method => $name,)*
                }
            }

            pub(crate) fn parse(name: &str) -> Option<Self> {
                match name {
                    $($name => Some(Self::$method),)*
                    _ => None,
                }
            }
        }
    };
}

methods! {
    Aba "aba",
    AbaPacked "aba_packed",
    AbaParallel "aba_parallel",
    Analytic "analytic",
    Batch BATCH,
    Build "build",
    Columns "columns",
    Crba "crba",
    CrbaPacked "crba_packed",
    CrbaParallel "crba_parallel",
    Dual "dual",
    Kinematics "kinematics",
    KinematicsPacked "kinematics_packed",
    Ltdl "ltdl",
    LtdlParallel "ltdl_parallel",
    Refined1 "refined_1",
    Refined2 "refined_2",
    RneaPacked "rnea_packed",
    RneaParallel "rnea_parallel",
    Topology "topology",
    Twisted "twisted",
}

/// The methods of each quantity, the usual one first.
pub(crate) fn methods(quantity: Quantity) -> &'static [Method] {
    use Method::*;
    match quantity {
        Quantity::InverseDynamics | Quantity::Bias => &[RneaPacked, Batch],
        Quantity::InverseDynamicsWrench => &[RneaPacked],
        Quantity::MassMatrix | Quantity::MassMatrixProbe | Quantity::MassMatrixSparse => &[CrbaPacked, Crba, Batch],
        Quantity::ForwardDynamics => &[Aba, AbaPacked, Ltdl, Refined1, Refined2, Batch],
        Quantity::ForwardDynamicsSingle => &[Aba, Ltdl, Batch],
        Quantity::KineticEnergy | Quantity::PotentialEnergy => &[Kinematics],
        Quantity::CenterOfMass
        | Quantity::Momentum
        | Quantity::BodyPlacement
        | Quantity::BodyVelocity
        | Quantity::BodyAcceleration
        | Quantity::BodyJacobian
        | Quantity::BodyJacobians => &[KinematicsPacked],
        Quantity::Readback => &[Build],
        Quantity::StoredEntries => &[Topology],
        Quantity::FactorEntries => &[Ltdl],
        Quantity::Factorization | Quantity::Solve | Quantity::MassMatrixInverse => &[Ltdl, Batch],
        Quantity::InverseDynamicsDq
        | Quantity::InverseDynamicsDv
        | Quantity::ForwardDynamicsDq
        | Quantity::ForwardDynamicsDv
        | Quantity::CoriolisMatrix => &[Analytic, Dual, Batch],
        Quantity::TorqueRegressor => &[Analytic, Columns, Batch],
        Quantity::InverseDynamicsSecond | Quantity::ForwardDynamicsSecond => &[Analytic, Dual],
    }
}

/// The methods of a quantity that the timing study asks for. It compares their answers with those of the usual one at every state, and so
/// has some that others do not ask for. A single state in single precision is not timed.
pub(crate) fn timed(quantity: Quantity) -> &'static [Method] {
    match quantity {
        Quantity::ForwardDynamicsSingle => &[Method::Batch],
        Quantity::Momentum | Quantity::BodyAcceleration | Quantity::BodyJacobian => &[Method::KinematicsPacked, Method::Batch],
        _ => methods(quantity),
    }
}
