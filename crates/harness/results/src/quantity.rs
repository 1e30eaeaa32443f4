//! The quantities of which an engine can be asked: the words of the column `quantity` that are not of one study alone.
//!
//! One table says everything about a quantity. Its place there is its place on pages. An engine answers it by a kernel.

use Extent::{Bodies, Dofs, Number, Stored};

/// One extent of the shape of an answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extent {
    /// This number.
    Number(usize),
    /// Degrees of freedom.
    Dofs,
    /// Described bodies.
    Bodies,
    /// Stored numbers of M in the tree-sparse layout.
    Stored,
}

/// The numbers of a robot that shapes depend on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Extents {
    /// Degrees of freedom.
    pub nv: usize,
    /// Described bodies.
    pub bodies: usize,
    /// Stored numbers of M in the tree-sparse layout.
    pub stored: usize,
}

/// The states of an agreement batch at which a quantity is asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Asked {
    /// All, where the worst one counts.
    All,
    /// One, where it does not depend on the state.
    One,
}

/// What the error of an entry is divided by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// The terms of inverse dynamics.
    JointForces,
    /// The terms of inverse dynamics under external wrenches.
    JointForcesWrench,
    /// The terms of the bias force.
    BiasForces,
    /// √(a_ii·a_jj) of a dense matrix.
    Matrix,
    /// The same of a matrix in the tree-sparse layout.
    SparseMatrix,
    /// The same of the matrix that factors make.
    Factors,
    /// The same of products with a matrix, its diagonal and its last row.
    Products,
    /// The true entry itself.
    Itself,
    /// The weight times the mean path to the centres of mass.
    PotentialEnergy,
    /// The mean path to the centres of mass.
    CenterOfMass,
    /// The terms of the momentum.
    Momentum,
    /// One, and the path from the world's origin.
    Placements,
    /// The terms of velocities, added up along the path.
    Velocities,
    /// The terms of accelerations, added up along the path.
    Accelerations,
    /// What a dof at unit rate moves the deepest body by.
    Jacobian,
    /// What the dofs on its path at the rates of the probe move a body by.
    JacobianProducts,
    /// The size of each physical parameter of a body.
    Readback,
    /// The largest entry in the units of row and column.
    Derivative {
        /// The rows are accelerations and not forces.
        forward: bool,
        /// The columns are directions of q.
        by_q: bool,
    },
    /// The largest entry for a parameter of the same unit.
    Regressor,
    /// The largest entry of the same block of second derivatives.
    SecondDerivative {
        /// Those of accelerations and not of forces.
        forward: bool,
    },
    /// One.
    Count,
    /// One, where the count is too low. A higher one is no error.
    LowCount,
    /// The largest entry.
    Largest,
}

/// What there is to say about a quantity.
struct Entry {
    name: &'static str,
    title: &'static str,
    words: &'static str,
    shape: &'static [Extent],
    measure: Measure,
    error: &'static str,
}

/// How many vectors each body's Jacobian is multiplied with.
const PROBED: usize = 2;

const ONE: &[Extent] = &[Number(1)];
const VECTOR: &[Extent] = &[Dofs];
const MATRIX: &[Extent] = &[Dofs, Dofs];
const SPARSE: &[Extent] = &[Stored];
const BODY_VECTORS: &[Extent] = &[Bodies, Number(6)];

/// Makes the enum and its table. Each quantity has what it is in words, its name in rows, its title on pages, and the shape of an answer. It
/// has the measure of its error, and that measure in words unless it is only counted or timed. Some are not asked at all states, or are in
/// single precision.
macro_rules! quantities {
    ($($words:literal $variant:ident(
        $name:literal, $title:literal, $shape:expr, $measure:expr $(, asked: $asked:ident)? $(, double: $double:ident)?
    ) $($error:literal)?;)+) => {
        /// A quantity of a robot at a state. Units and frames are those of `oracles/PROTOCOL.md`.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum Quantity {
            $(#[doc = $words] $variant),+
        }

        impl Quantity {
            /// All of them, in the order of pages.
            pub const ALL: [Self; COUNT] = [$(Self::$variant),+];

            /// At which states of an agreement batch it is asked.
            pub const fn asked(self) -> Asked {
                match self {
                    $($(Self::$variant => Asked::$asked,)?)+
                    _ => Asked::All,
                }
            }

            /// The same quantity in double precision.
            #[must_use]
            pub const fn in_double(self) -> Self {
                match self {
                    $($(Self::$variant => Self::$double,)?)+
                    double => double,
                }
            }
        }

        const COUNT: usize = [$($name),+].len();

        static TABLE: [Entry; COUNT] = [$(Entry {
            name: $name,
            title: $title,
            words: $words,
            shape: $shape,
            measure: $measure,
            error: concat!($($error)?),
        }),+];
    };
}

quantities! {
    "joint-space inertia matrix M"
    MassMatrix("mass_matrix", "mass matrix M", MATRIX, Measure::Matrix)
        "max |ΔMᵢⱼ| / √(Mᵢᵢ·Mⱼⱼ): an entry is measured against the inertias of its own two axes";
    "M times four vectors, its diagonal and its last row"
    MassMatrixProbe("mass_matrix_probe", "M · probe", &[Number(6), Dofs], Measure::Products)
        "asked instead of M where it is large: its products with four vectors x, each entry over Σⱼ √(Mᵢᵢ·Mⱼⱼ)|xⱼ|, and its diagonal and last row as entries of M";
    "bias force h, gravity included"
    Bias("bias", "bias force h", VECTOR, Measure::BiasForces)
        "per degree of freedom, |Δhᵢ| over the sum of the magnitudes of the terms added to form hᵢ";
    "inverse dynamics τ = M a + h"
    InverseDynamics("id", "inverse dynamics", VECTOR, Measure::JointForces)
        "per degree of freedom, |Δτᵢ| over the sum of the magnitudes of the terms added to form τᵢ";
    "inverse dynamics under external wrenches"
    InverseDynamicsWrench("id_wrench", "ID, ext. wrench", VECTOR, Measure::JointForcesWrench)
        "as inverse dynamics, with external wrenches on the bodies among the terms";
    "forward dynamics a = M⁻¹(τ − h)"
    ForwardDynamics("fd", "forward dynamics", VECTOR, Measure::Largest)
        "forward: ‖Δq̈‖_M / ‖q̈‖_M with ‖x‖_M = √(xᵀMx); backward: maxᵢ |τ − ID(q, q̇, q̈)|ᵢ / wᵢ with wᵢ = Σⱼ √(Mᵢᵢ·Mⱼⱼ)|q̈ⱼ| + ĥᵢ + |τᵢ|, our inverse dynamics evaluating, where ĥᵢ is the sum of the magnitudes of the terms of hᵢ and j runs over the dofs that share a path with i";
    "kinetic energy"
    KineticEnergy("kinetic_energy", "kinetic energy", ONE, Measure::Itself)
        "|ΔT| / T: every body's term is positive";
    "potential energy"
    PotentialEnergy("potential_energy", "potential energy", ONE, Measure::PotentialEnergy)
        "|ΔV| over mass · gravity · the mass-weighted mean length of the paths to the bodies' centres of mass";
    "centre of mass"
    CenterOfMass("com", "centre of mass", &[Number(3)], Measure::CenterOfMass)
        "each coordinate's difference over the mass-weighted mean length of the paths to the bodies' centres of mass";
    "centroidal momentum"
    Momentum("momentum", "momentum", &[Number(6)], Measure::Momentum)
        "linear part over Σ(m|v| + |mc||ω|), angular part over Σ(tr Ī|ω| + |mc||v| + path · linear share), with the magnitudes of v and ω added up along the path";
    "placement of each body in the world"
    BodyPlacement("body_placement", "body placements", &[Bodies, Number(12)], Measure::Placements)
        "entries of the rotation over one, of the position over the length of the path from the world's origin";
    "velocity of each body's origin, world axes"
    BodyVelocity("body_velocity", "body velocities", BODY_VECTORS, Measure::Velocities)
        "angular part over the sum of the joints' angular velocities along the path, linear part over that of the linear ones plus angular · the body's size";
    "classical acceleration of each body's origin, world axes"
    BodyAcceleration("body_acceleration", "body accelerations", BODY_VECTORS, Measure::Accelerations)
        "as body velocities, with the terms of accelerations; gravity and the swing of the body about its origin are among the linear ones";
    "Jacobian of the deepest body, world axes"
    BodyJacobian("body_jacobian", "body Jacobian", &[Number(6), Dofs], Measure::Jacobian)
        "of the deepest body, column by column: a turn at unit rate carries the body along by no more than the length of its path, a slide by one";
    "Jacobian of each body times two vectors, world axes"
    BodyJacobians("body_jacobians", "all bodies' Jacobians", &[Bodies, Number(PROBED), Number(6)], Measure::JacobianProducts)
        "J x of every body for two dense vectors x: each entry over the sum of what the dofs on the body's path at the rates |xⱼ| carry it along";
    "inertias and placements that the engine holds after building the robot"
    Readback("readback", "model read back", &[Bodies, Number(22)], Measure::Readback, asked: One)
        "what the engine itself holds after loading, against the description: masses and lengths over themselves, rotations over one, inertias over their trace about the body's origin. It separates an error of the model from one of the algorithm";
    "M in the tree-sparse layout"
    MassMatrixSparse("mass_matrix_sparse", "M, tree-sparse", SPARSE, Measure::SparseMatrix);
    "factors of M = LᵀDL"
    Factorization("factorization", "factorization", SPARSE, Measure::Factors);
    "numbers of the engine's own triangular factor of M"
    FactorEntries("factor_entries", "numbers of the factor", ONE, Measure::LowCount, asked: One);
    "M⁻¹τ with given factors"
    Solve("solve", "solve", VECTOR, Measure::Largest);
    "M⁻¹"
    MassMatrixInverse("mass_matrix_inverse", "M⁻¹", MATRIX, Measure::Matrix);
    "stored numbers of the sparse mass matrix"
    StoredEntries("stored_entries", "stored entries", ONE, Measure::Count, asked: One);
    "∂ID/∂q on the tangent space of the configurations"
    InverseDynamicsDq("id_dq", "∂ID/∂q", MATRIX, Measure::Derivative { forward: false, by_q: true })
        "the largest entry of D^-½ Δ D^-½ over that of the true derivative, D = diag M: entries without the units of their row and column";
    "∂ID/∂v"
    InverseDynamicsDv("id_dv", "∂ID/∂v", MATRIX, Measure::Derivative { forward: false, by_q: false })
        "as ∂ID/∂q; where the true derivative is zero, over the rate of the state";
    "∂FD/∂q on the tangent space of the configurations"
    ForwardDynamicsDq("fd_dq", "∂FD/∂q", MATRIX, Measure::Derivative { forward: true, by_q: true })
        "the largest entry of D^½ Δ D^-½ over that of the true derivative, D = diag M";
    "∂FD/∂v"
    ForwardDynamicsDv("fd_dv", "∂FD/∂v", MATRIX, Measure::Derivative { forward: true, by_q: false })
        "as ∂FD/∂q; where the true derivative is zero, over the rate of the state";
    "Coriolis matrix C with Ṁ = C + Cᵀ"
    CoriolisMatrix("coriolis_matrix", "Coriolis matrix", MATRIX, Measure::Derivative { forward: false, by_q: false })
        "as ∂ID/∂v";
    "torque regressor Y, τ − armature·a = Y π"
    TorqueRegressor("torque_regressor", "torque regressor", &[Dofs, Bodies, Number(10)], Measure::Regressor)
        "each entry over √Mᵢᵢ of its row, and then over the largest of the same unit: those of all masses, first moments or inertias";
    // Blocks by (q, q), (q, v), (v, v) and (q, a), of μ·ID. The weights μ are the state's joint forces.
    "second derivatives of weighted inverse dynamics"
    InverseDynamicsSecond("id_second", "∂²(μ·ID)", &[Number(4), Dofs, Dofs], Measure::SecondDerivative { forward: false })
        "block by block: entries over √(MⱼⱼMₖₖ), and then over the largest of the block";
    // Blocks by (q, q), (q, v), (v, v) and (q, τ), of λ·FD. The weights λ are the state's accelerations.
    "second derivatives of weighted forward dynamics"
    ForwardDynamicsSecond("fd_second", "∂²(λ·FD)", &[Number(4), Dofs, Dofs], Measure::SecondDerivative { forward: true })
        "as ∂²(μ·ID)";
    "forward dynamics in single precision"
    ForwardDynamicsSingle("fd_f32", "fd_f32", VECTOR, Measure::Largest, double: ForwardDynamics);
}

impl Quantity {
    /// The derivatives, and what is made of them. An engine may have some of them.
    pub const DERIVATIVES: [Self; 6] = Self::from_first(Self::InverseDynamicsDq);

    /// Second derivatives, which only our engine answers, and only the timing study asks for.
    pub const SECOND_DERIVATIVES: [Self; 2] = Self::from_first(Self::InverseDynamicsSecond);

    /// So many that stand together in the table, from the first of them.
    const fn from_first<const N: usize>(first: Self) -> [Self; N] {
        let mut some = [first; N];
        let mut k = 0;
        while k < N {
            some[k] = Self::ALL[first as usize + k];
            k += 1;
        }
        some
    }

    /// The quantity named by a word.
    pub fn parse(word: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|quantity| quantity.name() == word)
    }

    fn entry(self) -> &'static Entry {
        &TABLE[self as usize]
    }

    /// The word for it in rows and in the oracle protocol.
    pub fn name(self) -> &'static str {
        self.entry().name
    }

    /// A column's heading.
    pub fn title(self) -> &'static str {
        self.entry().title
    }

    /// What it is, in a phrase.
    pub fn words(self) -> &'static str {
        self.entry().words
    }

    /// What the error of an entry is divided by.
    pub fn measure(self) -> Measure {
        self.entry().measure
    }

    /// The measure of error in words; empty of a quantity that is only counted or timed.
    pub fn error(self) -> &'static str {
        self.entry().error
    }

    /// The arithmetic of its answers: `f64`, or `f32` of a quantity in single precision.
    pub fn precision(self) -> &'static str {
        if self.in_double() == self { "f64" } else { "f32" }
    }

    /// Whether it is a derivative, of first or second order, or made of derivatives.
    pub fn is_derivative(self) -> bool {
        Self::DERIVATIVES.contains(&self) || Self::SECOND_DERIVATIVES.contains(&self)
    }

    /// The shape of an answer about one state of a robot.
    pub fn shape(self, robot: impl Into<Extents>) -> impl Iterator<Item = usize> {
        let Extents { nv, bodies, stored } = robot.into();
        self.entry().shape.iter().map(move |extent| match extent {
            Number(number) => *number,
            Dofs => nv,
            Bodies => bodies,
            Stored => stored,
        })
    }

    /// Numbers per state for a robot.
    pub fn size(self, robot: impl Into<Extents>) -> usize {
        self.shape(robot).product()
    }
}
