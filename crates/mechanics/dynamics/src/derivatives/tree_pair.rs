//! A matrix with the sparsity that branches of a tree induce, without symmetry: two triangles in flat arrays.
//!
//! Source: the sparsity of derivatives by Singh, Russell & Wensing (2022): ∂τ_i/∂q_j differs from zero only if one of the dofs i and j
//! supports the other. Shape: `nv`×`nv`. Both triangles are stored like a [`TreeSparse`] matrix, row by row of the deeper dof: the lower one
//! holds A_ij and the upper one A_ji, for each dof j that supports dof i. Both hold the diagonal.
//! Cost: [`TreePair::get`] O(1), the products O(Σ d_k), with d_k the depth of dof k. None allocates.

use crate::error::expect;
use crate::{DimensionError, TreeSparse};
use featherbench_model::Topology;
use featherbench_spatial::Real;
use nalgebra::{DMatrix, Scalar};

/// A tree-sparse matrix that need not be symmetric.
///
/// ```
/// use featherbench_dynamics::{TreePair, id_derivatives};
/// use featherbench_model::Model;
/// use featherbench_robots::{Family, StateBatch};
///
/// let model: Model<f64> = Model::build(&Family::parse("humanoid")?.generate()?)?;
/// let states = StateBatch::random(&model, 1, 1);
/// let stiffness: TreePair<f64> = id_derivatives(&model, states.q(0), states.v(0), states.a(0))?.q;
///
/// // Two numbers for each pair of dofs of which one supports the other, in place of 36².
/// assert_eq!(stiffness.lower().len() + stiffness.upper().len(), 2 * 351);
/// let (mut y, mut z) = (vec![0.0; 36], vec![0.0; 36]);
/// stiffness.mul(states.v(0), &mut y)?;
/// stiffness.mul_transposed(states.tau(0), &mut z)?;
/// let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
/// assert!((dot(states.tau(0), &y) - dot(&z, states.v(0))).abs() < 1e-10);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Conjugate gradients
///
/// The change x of the configuration that takes a change b of the joint forces, with the penalty μ|x|²: `(AᵀA + μ) x = Aᵀ b`, A = ∂τ/∂q.
/// Each step takes one product with A and one with Aᵀ.
///
/// ```
/// use featherbench_dynamics::id_derivatives;
/// use featherbench_model::Model;
/// use featherbench_robots::{Family, StateBatch};
///
/// let model: Model<f64> = Model::build(&Family::parse("humanoid")?.generate()?)?;
/// let (states, n, mu) = (StateBatch::random(&model, 1, 1), model.topology.nv(), 1e-2);
/// let a = id_derivatives(&model, states.q(0), states.v(0), states.a(0))?.q;
/// let b = states.tau(0);
/// let dot = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>();
/// let add = |factor: f64, x: &[f64], y: &mut [f64]| y.iter_mut().zip(x).for_each(|(y, x)| *y += factor * x);
///
/// // r = b − A x, s = Aᵀ r − μ x, p the direction
/// let (mut x, mut r, mut s, mut ap) = (vec![0.0; n], b.to_vec(), vec![0.0; n], vec![0.0; n]);
/// a.mul_transposed(&r, &mut s)?;
/// let (mut p, first) = (s.clone(), dot(&s, &s));
/// let mut square = first;
/// let mut steps = 0;
/// while square > 1e-20 * first && steps < 1000 {
///     a.mul(&p, &mut ap)?;
///     let step = square / (dot(&ap, &ap) + mu * dot(&p, &p));
///     add(step, &p, &mut x);
///     add(-step, &ap, &mut r);
///     a.mul_transposed(&r, &mut s)?;
///     add(-mu, &x, &mut s);
///     let next = dot(&s, &s);
///     p.iter_mut().zip(&s).for_each(|(p, s)| *p = s + next / square * *p);
///     (square, steps) = (next, steps + 1);
/// }
///
/// // The solution of the dense equation.
/// let (dense, b) = (a.to_dense(), nalgebra::DVector::from_column_slice(b));
/// let normal = dense.transpose() * &dense + nalgebra::DMatrix::identity(n, n) * mu;
/// let expected = normal.lu().solve(&(dense.transpose() * b)).ok_or("singular")?;
/// assert!((nalgebra::DVector::from_vec(x) - &expected).norm() < 1e-6 * expected.norm(), "after {steps} steps");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct TreePair<T> {
    lower: TreeSparse<T>,
    upper: TreeSparse<T>,
}

impl<T: Real> TreePair<T> {
    /// The zero matrix of a topology.
    pub fn new(topology: &Topology) -> Self {
        Self { lower: TreeSparse::new(topology), upper: TreeSparse::new(topology) }
    }

    /// Rows and columns: the number of dofs.
    pub fn size(&self) -> usize {
        self.lower.size()
    }

    /// The entries on and below the diagonal: A_ij for each dof i and the dofs j of [`Topology::row_dofs`], row after row.
    pub fn lower(&self) -> &[T] {
        self.lower.values()
    }

    /// The entries on and above the diagonal: A_ji in the place where [`TreePair::lower`] has A_ij.
    pub fn upper(&self) -> &[T] {
        self.upper.values()
    }

    /// Entry (i, j): zero where neither dof supports the other, or where there is no such entry.
    pub fn get(&self, i: usize, j: usize) -> T {
        if i >= j { self.lower.get(i, j) } else { self.upper.get(i, j) }
    }

    /// `y = A x`.
    ///
    /// # Errors
    /// [`DimensionError`] when a vector has not one number per dof.
    pub fn mul(&self, x: &[T], y: &mut [T]) -> Result<(), DimensionError> {
        product(&self.lower, &self.upper, x, y)
    }

    /// `y = Aᵀ x`.
    ///
    /// # Errors
    /// [`DimensionError`] when a vector has not one number per dof.
    pub fn mul_transposed(&self, x: &[T], y: &mut [T]) -> Result<(), DimensionError> {
        product(&self.upper, &self.lower, x, y)
    }

    /// `Y = A X` for matrices of `nv` rows, row after row.
    ///
    /// # Errors
    /// [`DimensionError`] when the matrices differ in size, or do not have `nv` rows.
    pub fn mul_rows(&self, x: &[T], y: &mut [T]) -> Result<(), DimensionError> {
        let width = x.len() / self.size().max(1);
        expect("matrix X", self.size() * width, x.len())?;
        expect("matrix Y", x.len(), y.len())?;
        let add = |factor: T, x: &[T], y: &mut [T]| {
            for (x, y) in x.iter().zip(y) {
                *y = factor.mul_add(*x, *y);
            }
        };
        y.fill(T::zero());
        for i in 0..self.size() {
            let row = self.lower.row(i);
            let (below, above) = (&self.lower.values()[row.clone()], &self.upper.values()[row]);
            let (before, rest) = y.split_at_mut(i * width);
            let (x_i, y_i) = (&x[i * width..][..width], &mut rest[..width]);
            add(below[below.len() - 1], x_i, y_i);
            for (dofs, entries) in self.lower.ancestors(i) {
                for ((j, l), u) in dofs.zip(&below[entries.clone()]).zip(&above[entries]) {
                    add(*l, &x[j * width..][..width], y_i);
                    add(*u, x_i, &mut before[j * width..][..width]);
                }
            }
        }
        Ok(())
    }

    /// `A + Aᵀ`, into a matrix of the same topology.
    ///
    /// # Errors
    /// [`DimensionError`] when `sum` has another topology.
    pub fn symmetric_sum(&self, sum: &mut TreeSparse<T>) -> Result<(), DimensionError> {
        self.lower.expect_same_tree(sum)?;
        for ((sum, lower), upper) in sum.values_mut().iter_mut().zip(self.lower()).zip(self.upper()) {
            *sum = *lower + *upper;
        }
        Ok(())
    }

    /// Writes the dense matrix, row after row, into `nv`² numbers.
    ///
    /// # Errors
    /// [`DimensionError`] when `dense` has not `nv`² numbers.
    pub fn write_dense(&self, dense: &mut [T]) -> Result<(), DimensionError> {
        let n = self.size();
        expect("dense matrix", n * n, dense.len())?;
        dense.fill(T::zero());
        for i in 0..n {
            let row = self.lower.row(i);
            let (lower, upper) = (&self.lower.values()[row.clone()], &self.upper.values()[row]);
            for (dofs, entries) in self.lower.ancestors(i) {
                for ((j, below), above) in dofs.zip(&lower[entries.clone()]).zip(&upper[entries]) {
                    (dense[i * n + j], dense[j * n + i]) = (*below, *above);
                }
            }
            dense[i * n + i] = lower[lower.len() - 1];
        }
        Ok(())
    }

    /// The dense matrix; it allocates.
    pub fn to_dense(&self) -> DMatrix<T>
    where
        T: Scalar,
    {
        DMatrix::from_fn(self.size(), self.size(), |i, j| self.get(i, j))
    }

    /// An error if the topology has another shape.
    pub(crate) fn expect_topology(&self, topology: &Topology) -> Result<(), DimensionError> {
        self.lower.expect_topology(topology)
    }

    /// Zeros behind the stored numbers again, after rows were written in whole registers.
    pub(crate) fn clear_padding(&mut self) {
        self.lower.clear_padding();
        self.upper.clear_padding();
    }

    /// The two triangles, to be written; the upper one is transposed.
    #[inline(always)]
    pub(crate) fn triangles_mut(&mut self) -> (&mut TreeSparse<T>, &mut TreeSparse<T>) {
        (&mut self.lower, &mut self.upper)
    }
}

/// `y_i = Σ_j L_ij x_j` and `y_j += U_ij x_i`, j the strict ancestors of i and i itself.
fn product<T: Real>(lower: &TreeSparse<T>, upper: &TreeSparse<T>, x: &[T], y: &mut [T]) -> Result<(), DimensionError> {
    expect("vector x", lower.size(), x.len())?;
    expect("vector y", lower.size(), y.len())?;
    for i in 0..lower.size() {
        let row = lower.row(i);
        let (below, above) = (&lower.values()[row.clone()], &upper.values()[row]);
        let mut sum = below[below.len() - 1] * x[i];
        for (dofs, entries) in lower.ancestors(i) {
            let triangles = below[entries.clone()].iter().zip(&above[entries]);
            for (((l, u), x_j), y_j) in triangles.zip(&x[dofs.clone()]).zip(&mut y[dofs]) {
                sum = l.mul_add(*x_j, sum);
                *y_j = u.mul_add(x[i], *y_j);
            }
        }
        y[i] = sum;
    }
    Ok(())
}
