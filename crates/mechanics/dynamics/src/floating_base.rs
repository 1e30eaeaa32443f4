//! The mass matrix of a robot with a floating base, partitioned: `M = [[M_bb, M_bj], [M_jb, M_jj]]`, b the six dofs of the base, j the joints.
//!
//! Source: the book, sections 9.3 to 9.5; a floating base is eliminated as any block is. The blocks:
//!
//! | block | what it is |
//! |---|---|
//! | M_bb | the composite inertia of the whole robot, all joints locked: `[[m 1, −m c×], [m c×, Ī]]` |
//! | M_bj | a column per joint dof: the momentum of the whole robot, at the base, that a unit velocity of the dof gives |
//! | M_jj | the mass matrix of the robot whose base is fixed; the limbs do not couple |
//! | `S_bb = M_bb − M_bj M_jj⁻¹ M_jb` | the base's articulated-body inertia: what a force on the base meets while all joints move freely |
//! | `S_jj = M_jj − M_jb M_bb⁻¹ M_bj` | what forces of joints meet while the base floats; its inverse is the joint block of M⁻¹ |
//!
//! There m is the total mass, c the centre of mass, and Ī the inertia about the base's origin.
//!
//! From `M = LᵀDL`, leaves first, follow `S_bb = L_bbᵀ D_b L_bb`, and `L_bb⁻ᵀ (f_b − M_bj M_jj⁻¹ f_j)` as the base's part of L⁻ᵀ f. All joints are
//! eliminated before the base: the Schur complement is what the factorization finds when it reaches the base, and the force what half a
//! solution finds there.
//!
//! Frames: base quantities are [linear; angular] in the base's body axes at its origin: the order of the free joint's velocity.
//! Shapes: base blocks are 6×6; S_jj is dense, (nv − 6)×(nv − 6), since the base couples all limbs. Units: SI.
//! Cost, with m = nv − 6 and D1 = Σ (d_k − 1). No call on the workspace allocates.
//!
//! | | divisions | products | multiply-adds |
//! |---|---|---|---|
//! | S_bb, after a factorization | 0 | 56 | 56 |
//! | a base acceleration, after a factorization | 6 | 0 | D1 + 15 |
//! | S_jj | 15 + 6 m | 0 | 35 + 15 m + 3 m (m + 1) |

use crate::error::{Pivot, expect};
use crate::{DimensionError, Error, Ltdl, NotPositiveDefinite, TreeSparse};
use featherbench_model::{JointKind, Topology};
use featherbench_spatial::Real;
use std::array::from_fn;
use thiserror::Error;

/// Dofs of a free joint.
const BASE: usize = 6;

/// The robot does not float: its first joint is not a free joint on the world, or another joint is on the world too.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum NoFloatingBase {
    /// The first joint is of another kind, or there is none.
    #[error("the robot's first joint is not a free joint on the world, so there is no floating base to partition by")]
    Fixed,
    /// Another body is on the world as well.
    #[error("body {body} is on the world as well as the floating base; partition each robot by itself")]
    SecondRoot {
        /// That body.
        body: usize,
    },
}

impl NoFloatingBase {
    /// An error unless one free joint at the root carries everything.
    fn check(topology: &Topology) -> Result<(), Self> {
        let mut joints = topology.joints().iter();
        if !joints.next().is_some_and(|joint| joint.kind == JointKind::Free && joint.parent.is_none()) {
            return Err(Self::Fixed);
        }
        match joints.position(|joint| joint.parent.is_none()) {
            Some(place) => Err(Self::SecondRoot { body: place + 1 }),
            None => Ok(()),
        }
    }
}

/// The blocks of a mass matrix, as views of its numbers. Dofs of the base are 0 … 5; a joint dof keeps its number in the robot, 6 … nv − 1.
///
/// ```
/// use featherbench_dynamics::{BaseBlocks, center_of_mass, mass_matrix};
/// use featherbench_model::Model;
/// use featherbench_robots::{Family, StateBatch};
///
/// let model: Model<f64> = Model::build(&Family::parse("humanoid")?.generate()?)?;
/// let states = StateBatch::random(&model, 1, 1);
/// let matrix = mass_matrix(&model, states.q(0))?;
/// let blocks = BaseBlocks::of(&model.topology, &matrix)?;
/// // A linear acceleration of the base, with locked joints, meets the total mass.
/// let mass = center_of_mass(&model, states.q(0))?.mass;
/// assert!((blocks.base()[0][0] / mass - 1.0).abs() < 1e-14);
/// assert_eq!(blocks.coupling(20)[3], matrix.get(3, 20));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct BaseBlocks<'m, T> {
    matrix: &'m TreeSparse<T>,
}

impl<'m, T: Real> BaseBlocks<'m, T> {
    /// The blocks of a matrix of this topology.
    ///
    /// # Errors
    /// [`PartitionError`] when the robot has no floating base or the matrix has another topology.
    pub fn of(topology: &Topology, matrix: &'m TreeSparse<T>) -> Result<Self, PartitionError> {
        NoFloatingBase::check(topology)?;
        matrix.expect_topology(topology)?;
        Ok(Self { matrix })
    }

    /// How many dofs the joints have: nv − 6.
    pub fn joint_dofs(&self) -> usize {
        self.matrix.size() - BASE
    }

    /// M_bb, both triangles.
    pub fn base(&self) -> [[T; BASE]; BASE] {
        symmetric(|i, j| self.matrix.get(i, j))
    }

    /// The column of M_bj for a joint dof: the first six numbers of the dof's row.
    ///
    /// # Panics
    /// If `dof` is none of 6 … nv − 1.
    pub fn coupling(&self, dof: usize) -> &'m [T; BASE] {
        self.row(dof).0
    }

    /// The row of M_jj for a joint dof, up to its diagonal: the entries of its ancestors among the joints, the one nearest to the base first,
    /// and its own.
    ///
    /// # Panics
    /// If `dof` is none of 6 … nv − 1.
    pub fn joint_row(&self, dof: usize) -> &'m [T] {
        self.row(dof).1
    }

    /// Entry of M_jj, of two joint dofs; zero where neither supports the other.
    ///
    /// # Panics
    /// If `i` or `j` is a dof of the base.
    pub fn joints(&self, i: usize, j: usize) -> T {
        assert!(i >= BASE && j >= BASE, "dofs {i} and {j}: those of the base are 0 … 5");
        self.matrix.get(i, j)
    }

    fn row(&self, dof: usize) -> (&'m [T; BASE], &'m [T]) {
        let row = &self.matrix.values()[self.matrix.row(dof)];
        row.split_first_chunk().filter(|_| dof >= BASE).expect("a joint's dof is 6 … nv − 1")
    }
}

/// What can go wrong with a partition.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum PartitionError {
    /// The robot has no floating base.
    #[error(transparent)]
    NoFloatingBase(#[from] NoFloatingBase),
    /// An argument has the wrong size.
    #[error(transparent)]
    Dimension(#[from] DimensionError),
    /// The mass matrix is not positive definite.
    #[error(transparent)]
    NotPositiveDefinite(#[from] NotPositiveDefinite),
}

impl From<Error> for PartitionError {
    fn from(error: Error) -> Self {
        match error {
            Error::Dimension(error) => Self::Dimension(error),
            Error::NotPositiveDefinite(error) => Self::NotPositiveDefinite(error),
        }
    }
}

/// The workspace of block elimination on a mass matrix with a floating base.
///
/// ```
/// use featherbench_dynamics::{FloatingBase, bias_force, forward_dynamics, mass_matrix};
/// use featherbench_model::Model;
/// use featherbench_robots::{Family, StateBatch};
///
/// let model: Model<f64> = Model::build(&Family::parse("quadruped")?.generate()?)?;
/// let states = StateBatch::random(&model, 1, 1);
/// let (q, v, tau) = (states.q(0), states.v(0), states.tau(0));
/// let mut base = FloatingBase::new(&model.topology)?;
/// base.run(&mass_matrix(&model, q)?)?;
/// // f = τ − h
/// let h = bias_force(&model, q, v)?;
/// let forces: Vec<f64> = tau.iter().zip(h).map(|(tau, h)| tau - h).collect();
/// let acceleration = base.base_acceleration(&forces)?;
/// let expected = forward_dynamics(&model, q, v, tau)?;
/// assert!(acceleration.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-9 * b.abs().max(1.0)));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct FloatingBase<T> {
    /// M.
    matrix: TreeSparse<T>,
    ltdl: Ltdl<T>,
    /// Forces that half a solution has changed.
    forces: Vec<T>,
    /// A column per joint dof: `L_b⁻ᵀ M_bj`, with `M_bb = L_bᵀ D_b L_b` by itself.
    coupling: Vec<[T; BASE]>,
}

impl<T: Real> FloatingBase<T> {
    /// A workspace for robots of this topology.
    ///
    /// # Errors
    /// [`NoFloatingBase`] unless one free joint on the world carries all other bodies.
    pub fn new(topology: &Topology) -> Result<Self, NoFloatingBase> {
        NoFloatingBase::check(topology)?;
        let coupling = vec![[T::zero(); BASE]; topology.nv() - BASE];
        Ok(Self { matrix: TreeSparse::new(topology), ltdl: Ltdl::new(topology), forces: vec![T::zero(); topology.nv()], coupling })
    }

    /// The workspace of a robot of this topology, with its mass matrix factored. It allocates.
    ///
    /// # Errors
    /// [`PartitionError`] when the robot has no floating base, or the matrix has another topology or is not positive definite.
    ///
    /// ```
    /// use featherbench_dynamics::{FloatingBase, mass_matrix};
    /// use featherbench_model::Model;
    /// use featherbench_robots::{Family, StateBatch};
    ///
    /// let model: Model<f64> = Model::build(&Family::parse("quadruped")?.generate()?)?;
    /// let states = StateBatch::random(&model, 1, 1);
    /// let mut base = FloatingBase::of(&model.topology, &mass_matrix(&model, states.q(0))?)?;
    /// let joints = model.topology.nv() - 6;
    /// assert_eq!((base.blocks().joint_dofs(), base.joint_complement_dense()?.len()), (joints, joints * joints));
    /// // A base whose joints move freely meets less inertia than one with locked joints.
    /// assert!(base.articulated_inertia()[0][0] < base.blocks().base()[0][0]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn of(topology: &Topology, matrix: &TreeSparse<T>) -> Result<Self, PartitionError> {
        let mut base = Self::new(topology)?;
        base.run(matrix)?;
        Ok(base)
    }

    /// Takes a mass matrix and factors it.
    ///
    /// # Errors
    /// [`Error`](enum@Error) when the matrix has another topology or is not positive definite.
    #[inline(never)]
    pub fn run(&mut self, matrix: &TreeSparse<T>) -> Result<(), Error> {
        self.matrix.copy_from(matrix)?;
        self.ltdl.run(matrix)
    }

    /// The blocks of the matrix.
    pub fn blocks(&self) -> BaseBlocks<'_, T> {
        BaseBlocks { matrix: &self.matrix }
    }

    /// The factors of the matrix.
    pub fn factors(&self) -> &Ltdl<T> {
        &self.ltdl
    }

    /// `S_bb = M_bb − M_bj M_jj⁻¹ M_jb = L_bbᵀ D_b L_bb`: the articulated-body inertia of the base, both triangles.
    pub fn articulated_inertia(&self) -> [[T; BASE]; BASE] {
        let factors = self.ltdl.factors();
        let l = |k, i| if i == k { T::one() } else { factors.get(k, i) };
        // L_ki is zero for k < i, and the sum begins at the later of i and j.
        symmetric(|i, j| {
            let from = i.max(j);
            (from..BASE).fold(T::zero(), |sum, k| (factors.get(k, k) * l(k, i)).mul_add(l(k, j), sum))
        })
    }

    /// The acceleration of the base under generalized forces `forces` = τ − h, `nv` numbers: `S_bb a_b = f_b − M_bj M_jj⁻¹ f_j`. The joints'
    /// accelerations are not computed.
    ///
    /// # Errors
    /// [`DimensionError`] when there is not one force per dof.
    pub fn base_acceleration(&mut self, forces: &[T]) -> Result<[T; BASE], DimensionError> {
        expect("forces", self.forces.len(), forces.len())?;
        self.forces.copy_from_slice(forces);
        self.ltdl.solve_lower_transposed(&mut self.forces)?;
        // y = L⁻ᵀ f has L_bb⁻ᵀ (f_b − M_bj M_jj⁻¹ f_j) in its base part: D_b z = y, L_bb a = z
        let factors = self.ltdl.factors();
        let mut a = [T::zero(); BASE];
        for k in 0..BASE {
            let z = self.forces[k] / factors.get(k, k);
            a[k] = (0..k).fold(z, |a_k, j| (-factors.get(k, j)).mul_add(a[j], a_k));
        }
        Ok(a)
    }

    /// Writes `S_jj = M_jj − M_jb M_bb⁻¹ M_bj`, dense, row after row.
    ///
    /// With `M_bb = L_bᵀ D_b L_b` and `W = L_b⁻ᵀ M_bj` it is `M_jj − Wᵀ D_b⁻¹ W`.
    ///
    /// # Errors
    /// [`Error`](enum@Error) when `complement` has not (nv − 6)² numbers, or M_bb is not positive definite: a robot without mass.
    pub fn joint_complement(&mut self, complement: &mut [T]) -> Result<(), Error> {
        let n = self.coupling.len();
        expect("Schur complement of the base", n * n, complement.len())?;
        let blocks = BaseBlocks { matrix: &self.matrix };
        let (l, d) = factor_base(blocks.base())?;
        for (k, w) in self.coupling.iter_mut().enumerate() {
            *w = *blocks.coupling(BASE + k);
            // L_bᵀ w = m, from the last dof
            for i in (0..BASE).rev() {
                for j in 0..i {
                    w[j] = (-l[i][j]).mul_add(w[i], w[j]);
                }
            }
        }
        for i in 0..n {
            let scaled: [T; BASE] = from_fn(|k| -(self.coupling[i][k] / d[k]));
            for j in 0..=i {
                let m = blocks.joints(BASE + i, BASE + j);
                let entry = scaled.iter().zip(&self.coupling[j]).fold(m, |sum, (a, b)| a.mul_add(*b, sum));
                complement[i * n + j] = entry;
                complement[j * n + i] = entry;
            }
        }
        Ok(())
    }

    /// S_jj, as [`FloatingBase::joint_complement`] writes it. It allocates (nv − 6)² numbers.
    ///
    /// # Errors
    /// [`Error`](enum@Error) when M_bb is not positive definite: a robot without mass.
    ///
    /// ```
    /// use featherbench_dynamics::{FloatingBase, mass_matrix};
    /// use featherbench_model::Model;
    /// use featherbench_robots::{Family, StateBatch};
    ///
    /// let model: Model<f64> = Model::build(&Family::parse("snake:n=3")?.generate()?)?;
    /// let matrix = mass_matrix(&model, StateBatch::random(&model, 1, 1).q(0))?;
    /// let complement = FloatingBase::of(&model.topology, &matrix)?.joint_complement_dense()?;
    /// // Its inverse is the joint block of M⁻¹.
    /// let (n, m) = (matrix.size(), matrix.size() - 6);
    /// let inverse = matrix.into_ltdl()?.dense_inverse();
    /// let entry: f64 = (0..m).map(|k| complement[k] * inverse[(6 + k) * n + 6]).sum();
    /// assert!((entry - 1.0).abs() < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn joint_complement_dense(&mut self) -> Result<Vec<T>, Error> {
        let mut complement = vec![T::zero(); self.coupling.len() * self.coupling.len()];
        self.joint_complement(&mut complement)?;
        Ok(complement)
    }
}

/// A symmetric matrix by the entries of its lower triangle.
fn symmetric<T: Real>(entry: impl Fn(usize, usize) -> T) -> [[T; BASE]; BASE] {
    let lower: [[T; BASE]; BASE] = from_fn(|i| from_fn(|j| if j <= i { entry(i, j) } else { T::zero() }));
    from_fn(|i| from_fn(|j| lower[i.max(j)][i.min(j)]))
}

/// L and D of a 6×6 matrix `LᵀDL`: the dense form of [`Ltdl`], from the last row.
fn factor_base<T: Real>(mut h: [[T; BASE]; BASE]) -> Result<([[T; BASE]; BASE], [T; BASE]), NotPositiveDefinite> {
    let mut smallest = Pivot::none();
    for k in (0..BASE).rev() {
        let h_k = h[k];
        smallest.note(k, h_k[k].min_lane());
        for i in (0..k).rev() {
            let l = h_k[i] / h_k[k];
            for (h_ij, h_kj) in h[i].iter_mut().zip(&h_k[..=i]) {
                *h_ij = (-l).mul_add(*h_kj, *h_ij);
            }
            h[k][i] = l;
        }
    }
    smallest.check()?;
    Ok((h, from_fn(|k| h[k][k])))
}
