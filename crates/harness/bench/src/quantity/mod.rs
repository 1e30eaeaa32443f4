//! The quantities of which an engine can be asked, as data.

pub mod layout;

use crate::Robot;

/// A quantity of a robot at a state. Shapes, units and frames are those of `oracles/PROTOCOL.md`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Quantity {
    /// Inverse dynamics τ = M a + h.
    InverseDynamics,
    /// Inverse dynamics under external wrenches.
    InverseDynamicsWrench,
    /// Bias force h.
    Bias,
    /// Joint-space inertia matrix M, dense.
    MassMatrix,
    /// Products M·x with four vectors, the diagonal and the last row of M, for robots too big for the whole matrix.
    MassMatrixProbe,
    /// Forward dynamics a = M⁻¹(τ − h).
    ForwardDynamics,
    /// The same in single precision.
    ForwardDynamicsSingle,
    /// Kinetic energy ½ vᵀMv.
    KineticEnergy,
    /// Potential energy −Σ m g·c.
    PotentialEnergy,
    /// Centre of mass.
    CenterOfMass,
    /// Centroidal momentum [angular; linear].
    Momentum,
    /// Placement of each body: rotation, origin.
    BodyPlacement,
    /// Velocity of each body's origin [angular; linear].
    BodyVelocity,
    /// Time derivative of the body velocity.
    BodyAcceleration,
    /// Jacobian of the deepest body's velocity.
    BodyJacobian,
    /// The engine's own data after building the model: inertias and placements.
    Readback,
    /// Stored numbers of the engine's sparse mass matrix.
    StoredEntries,
    /// M in the tree-sparse layout.
    MassMatrixSparse,
    /// The factors of M = LᵀDL in the tree-sparse layout.
    Factorization,
    /// How many numbers of the engine's own triangular factor of M may differ from zero.
    FactorEntries,
    /// M⁻¹τ with M factorized beforehand.
    Solve,
    /// M⁻¹, dense.
    MassMatrixInverse,
    /// ∂ID/∂q on the tangent space of the configurations.
    InverseDynamicsDq,
    /// ∂ID/∂v.
    InverseDynamicsDv,
    /// ∂FD/∂q on the tangent space of the configurations.
    ForwardDynamicsDq,
    /// ∂FD/∂v.
    ForwardDynamicsDv,
    /// The Coriolis matrix C with C v = h − g and Ṁ = C + Cᵀ.
    CoriolisMatrix,
    /// The torque regressor Y with τ − armature·a = Y π.
    TorqueRegressor,
    /// Second derivatives of weighted inverse dynamics, μ·ID, by (q, q), (q, v), (v, v) and (q, a). μ are the state's joint forces.
    InverseDynamicsSecond,
    /// Second derivatives of weighted forward dynamics, λ·FD, by (q, q), (q, v), (v, v) and (q, τ). λ are the state's accelerations.
    ForwardDynamicsSecond,
}

/// Robots with more degrees of freedom than this are asked for [`Quantity::MassMatrixProbe`] and not for the whole matrix.
pub const DENSE_LIMIT: usize = 64;

impl Quantity {
    /// All of them.
    pub const ALL: [Self; 30] = [
        Self::InverseDynamics,
        Self::InverseDynamicsWrench,
        Self::Bias,
        Self::MassMatrix,
        Self::MassMatrixProbe,
        Self::ForwardDynamics,
        Self::ForwardDynamicsSingle,
        Self::KineticEnergy,
        Self::PotentialEnergy,
        Self::CenterOfMass,
        Self::Momentum,
        Self::BodyPlacement,
        Self::BodyVelocity,
        Self::BodyAcceleration,
        Self::BodyJacobian,
        Self::Readback,
        Self::StoredEntries,
        Self::MassMatrixSparse,
        Self::Factorization,
        Self::FactorEntries,
        Self::Solve,
        Self::MassMatrixInverse,
        Self::InverseDynamicsDq,
        Self::InverseDynamicsDv,
        Self::ForwardDynamicsDq,
        Self::ForwardDynamicsDv,
        Self::CoriolisMatrix,
        Self::TorqueRegressor,
        Self::InverseDynamicsSecond,
        Self::ForwardDynamicsSecond,
    ];

    /// Second derivatives, which only our engine answers, and only the timing study asks for.
    pub const SECOND_DERIVATIVES: [Self; 2] = [Self::InverseDynamicsSecond, Self::ForwardDynamicsSecond];

    /// The derivatives, and what is made of them. An engine may have some of them.
    pub const DERIVATIVES: [Self; 6] = [
        Self::InverseDynamicsDq,
        Self::InverseDynamicsDv,
        Self::ForwardDynamicsDq,
        Self::ForwardDynamicsDv,
        Self::CoriolisMatrix,
        Self::TorqueRegressor,
    ];

    /// The word for it in rows and in the oracle protocol.
    pub fn name(self) -> &'static str {
        match self {
            Self::InverseDynamics => "id",
            Self::InverseDynamicsWrench => "id_wrench",
            Self::Bias => "bias",
            Self::MassMatrix => "mass_matrix",
            Self::MassMatrixProbe => "mass_matrix_probe",
            Self::ForwardDynamics => "fd",
            Self::ForwardDynamicsSingle => "fd_f32",
            Self::KineticEnergy => "kinetic_energy",
            Self::PotentialEnergy => "potential_energy",
            Self::CenterOfMass => "com",
            Self::Momentum => "momentum",
            Self::BodyPlacement => "body_placement",
            Self::BodyVelocity => "body_velocity",
            Self::BodyAcceleration => "body_acceleration",
            Self::BodyJacobian => "body_jacobian",
            Self::Readback => "readback",
            Self::StoredEntries => "stored_entries",
            Self::MassMatrixSparse => "mass_matrix_sparse",
            Self::Factorization => "factorization",
            Self::FactorEntries => "factor_entries",
            Self::Solve => "solve",
            Self::MassMatrixInverse => "mass_matrix_inverse",
            Self::InverseDynamicsDq => "id_dq",
            Self::InverseDynamicsDv => "id_dv",
            Self::ForwardDynamicsDq => "fd_dq",
            Self::ForwardDynamicsDv => "fd_dv",
            Self::CoriolisMatrix => "coriolis_matrix",
            Self::TorqueRegressor => "torque_regressor",
            Self::InverseDynamicsSecond => "id_second",
            Self::ForwardDynamicsSecond => "fd_second",
        }
    }

    /// The arithmetic of its answers: `f64`, or `f32` of a quantity in single precision.
    pub fn precision(self) -> &'static str {
        if self == Self::ForwardDynamicsSingle { "f32" } else { "f64" }
    }

    /// The same quantity in double precision.
    #[must_use]
    pub fn in_double(self) -> Self {
        if self == Self::ForwardDynamicsSingle { Self::ForwardDynamics } else { self }
    }

    /// Whether it is a derivative, of first or second order, or made of derivatives.
    pub fn is_derivative(self) -> bool {
        Self::DERIVATIVES.contains(&self) || Self::SECOND_DERIVATIVES.contains(&self)
    }

    /// The quantity named by a word.
    pub fn parse(word: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|quantity| quantity.name() == word)
    }

    /// Numbers per state for a robot.
    pub fn size(self, robot: &Robot) -> usize {
        let (nv, bodies) = (robot.model.topology.nv(), robot.description.bodies.len());
        match self {
            Self::InverseDynamics
            | Self::InverseDynamicsWrench
            | Self::Bias
            | Self::ForwardDynamics
            | Self::ForwardDynamicsSingle
            | Self::Solve => nv,
            Self::MassMatrix
            | Self::MassMatrixInverse
            | Self::InverseDynamicsDq
            | Self::InverseDynamicsDv
            | Self::ForwardDynamicsDq
            | Self::ForwardDynamicsDv
            | Self::CoriolisMatrix => nv * nv,
            Self::TorqueRegressor => nv * bodies * layout::PARAMETERS,
            Self::InverseDynamicsSecond | Self::ForwardDynamicsSecond => 4 * nv * nv,
            Self::MassMatrixProbe | Self::BodyJacobian => 6 * nv,
            Self::KineticEnergy | Self::PotentialEnergy | Self::StoredEntries | Self::FactorEntries => 1,
            Self::CenterOfMass => 3,
            Self::Momentum => 6,
            Self::BodyPlacement => 12 * bodies,
            Self::BodyVelocity | Self::BodyAcceleration => 6 * bodies,
            Self::Readback => 22 * bodies,
            Self::MassMatrixSparse | Self::Factorization => robot.model.topology.stored(),
        }
    }

    /// The number of states of an agreement batch at which it is asked:
    /// - all, where the worst one counts;
    /// - the head of the batch, for the large kinematic quantities and external wrenches;
    /// - one, where it does not depend on the state.
    pub fn states(self, count: usize) -> usize {
        match self {
            Self::Readback | Self::StoredEntries | Self::FactorEntries => count.min(1),
            Self::InverseDynamicsWrench | Self::BodyPlacement | Self::BodyVelocity | Self::BodyAcceleration | Self::BodyJacobian => {
                count.min(featherbench_robots::StateBatch::HEAD)
            }
            _ => count,
        }
    }
}
