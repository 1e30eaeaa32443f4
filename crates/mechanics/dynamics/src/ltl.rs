//! The factorization `M = LᵀL` of a tree-sparse matrix without fill-in, in place.
//!
//! Source: the book, table 6.3; R. Featherstone, *Efficient factorization of the joint-space inertia matrix for branched kinematic trees*
//! (2005). L is lower triangular with a positive diagonal, and overwrites M. It eliminates from the leaves to the root, as [`Ltdl`](crate::Ltdl) does; L is
//! D^½ times the unit factor of that. So `|L x|² = xᵀ M x`, twice the kinetic energy of the velocity x, and noise of unit variance times L⁻¹ has
//! the covariance M⁻¹.
//! Shapes: M is `nv`×`nv`, vectors have `nv` numbers. Units: L has the root of M's. A call does not allocate.
//! Cost, with d_k the depth of dof k, D1 = Σ (d_k − 1) and D2 = Σ d_k (d_k − 1) / 2:
//!
//! | | square roots | divisions | multiply-adds |
//! |---|---|---|---|
//! | factor | n | D1 | D2 |
//! | solve | 0 | 2n | 2·D1 |
//!
//! This is the plain text, for any scalar. [`Ltdl`](crate::Ltdl) has no square roots, and for `f64` a text in registers: use it where only solutions matter.

use crate::error::{Pivot, expect};
use crate::{DimensionError, Error, NotPositiveDefinite, TreeSparse, triangular};
use featherbench_model::Topology;
use featherbench_spatial::{Logarithm, Real};

/// The factor L of a tree-sparse matrix `M = LᵀL`. Before the first factorization it is zero, and not valid.
///
/// ```
/// use featherbench_dynamics::{energy, mass_matrix};
/// use featherbench_model::Model;
/// use featherbench_robots::{Family, StateBatch};
///
/// let model: Model<f64> = Model::build(&Family::parse("quadruped")?.generate()?)?;
/// let states = StateBatch::random(&model, 1, 1);
/// let ltl = mass_matrix(&model, states.q(0))?.into_ltl()?;
/// // Twice the kinetic energy is |L v|².
/// let mut x = states.v(0).to_vec();
/// ltl.multiply_lower(&mut x)?;
/// let twice: f64 = x.iter().map(|x| x * x).sum();
/// let kinetic = energy(&model, states.q(0), states.v(0))?.kinetic;
/// assert!((twice / (2.0 * kinetic) - 1.0).abs() < 1e-14);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Ltl<T> {
    matrix: TreeSparse<T>,
}

impl<T: Real> Ltl<T> {
    /// A workspace for the factor of a matrix of this topology.
    pub fn new(topology: &Topology) -> Self {
        Self::from_unfactored(TreeSparse::new(topology))
    }

    /// A workspace that holds a matrix, to be factored by [`Ltl::factor`].
    pub fn from_unfactored(matrix: TreeSparse<T>) -> Self {
        Self { matrix }
    }

    /// Factors a matrix, leaving it as it is.
    ///
    /// # Errors
    /// [`Error`] when the matrix has another topology or a pivot is not positive.
    ///
    /// ```
    /// use featherbench_dynamics::{Ltl, TreeSparse};
    /// let mut matrix = TreeSparse::of_parents(&[None, Some(0)])?;
    /// matrix.values_mut().copy_from_slice(&[5.0, 4.0, 16.0]);
    /// let mut ltl = Ltl::from_unfactored(matrix.clone());
    /// ltl.run(&matrix)?;
    /// assert_eq!(ltl.factors().get(1, 0), 1.0);
    /// // The same without a copy:
    /// ltl.matrix_mut().values_mut().copy_from_slice(matrix.values());
    /// ltl.factor()?;
    /// assert_eq!(ltl.factors().get(1, 0), 1.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[inline(never)]
    pub fn run(&mut self, matrix: &TreeSparse<T>) -> Result<(), Error> {
        self.matrix.copy_from(matrix)?;
        self.factor()?;
        Ok(())
    }

    /// Before [`Ltl::factor`]: the matrix, to be written where it will be factored. Afterwards L.
    pub fn matrix_mut(&mut self) -> &mut TreeSparse<T> {
        &mut self.matrix
    }

    /// L: its rows, the diagonal included.
    ///
    /// ```
    /// use featherbench_dynamics::TreeSparse;
    /// let mut matrix = TreeSparse::of_parents(&[None, Some(0)])?;
    /// matrix.values_mut().copy_from_slice(&[5.0, 4.0, 16.0]);
    /// // L = [[2, 0], [1, 4]]: M = [[5, 4], [4, 16]] = LᵀL
    /// let ltl = matrix.into_ltl()?;
    /// assert_eq!(ltl.factors().values(), [2.0, 1.0, 4.0]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn factors(&self) -> &TreeSparse<T> {
        &self.matrix
    }

    /// Factors what [`Ltl::matrix_mut`] holds, in place: `L_kk = √H_kk`, `L_ki = H_ki / L_kk`, `H_ij −= L_ki L_kj` for every dof k, the last
    /// first, and its strict ancestors i and j ≤ i.
    ///
    /// # Errors
    /// [`NotPositiveDefinite`] when a pivot H_kk is not positive; the factor is then not valid.
    pub fn factor(&mut self) -> Result<(), NotPositiveDefinite> {
        let mut smallest = Pivot::none();
        for k in (0..self.matrix.size()).rev() {
            let strict = self.matrix.depth(k) - 1;
            let (rows, values) = self.matrix.parts_mut();
            let (above, h_k) = values.split_at_mut(rows[k].start);
            smallest.note(k, h_k[strict].min_lane());
            let root = h_k[strict].sqrt();
            h_k[strict] = root;
            for h_ki in &mut h_k[..strict] {
                *h_ki = *h_ki / root;
            }
            // ancestor i is at position p of the row
            let mut ancestor = rows[k].parent;
            for p in (0..strict).rev() {
                let Some(i) = ancestor else { break };
                let l_ki = h_k[p];
                for (h_ij, l_kj) in above[rows[i].start..][..=p].iter_mut().zip(&*h_k) {
                    *h_ij = (-l_ki).mul_add(*l_kj, *h_ij);
                }
                ancestor = rows[i].parent;
            }
        }
        smallest.check()
    }

    /// Solves `M x = b` in place: `x` holds b before and the solution afterwards.
    ///
    /// # Errors
    /// [`DimensionError`] when `x` has not one number per dof.
    ///
    /// ```
    /// use featherbench_dynamics::TreeSparse;
    /// let mut matrix = TreeSparse::of_parents(&[None, Some(0)])?;
    /// matrix.values_mut().copy_from_slice(&[5.0, 4.0, 16.0]);
    /// // L = [[2, 0], [1, 4]]: M = [[5, 4], [4, 16]] = LᵀL
    /// let ltl = matrix.into_ltl()?;
    /// let mut x = [9.0, 20.0];
    /// ltl.solve(&mut x)?;
    /// assert_eq!(x, [1.0, 1.0]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn solve(&self, x: &mut [T]) -> Result<(), DimensionError> {
        self.solve_lower_transposed(x)?;
        self.solve_lower(x)
    }

    /// x ← L x.
    ///
    /// # Errors
    /// [`DimensionError`] when `x` has not one number per dof.
    ///
    /// ```
    /// use featherbench_dynamics::TreeSparse;
    /// let mut matrix = TreeSparse::of_parents(&[None, Some(0)])?;
    /// matrix.values_mut().copy_from_slice(&[5.0, 4.0, 16.0]);
    /// // L = [[2, 0], [1, 4]]: M = [[5, 4], [4, 16]] = LᵀL
    /// let ltl = matrix.into_ltl()?;
    /// let mut x = [1.0, 1.0];
    /// ltl.multiply_lower(&mut x)?;
    /// assert_eq!(x, [2.0, 5.0]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn multiply_lower(&self, x: &mut [T]) -> Result<(), DimensionError> {
        expect("vector x", self.matrix.size(), x.len())?;
        triangular::multiply::<T, false>(&self.matrix, x);
        Ok(())
    }

    /// x ← Lᵀ x.
    ///
    /// # Errors
    /// [`DimensionError`] when `x` has not one number per dof.
    ///
    /// ```
    /// use featherbench_dynamics::TreeSparse;
    /// let mut matrix = TreeSparse::of_parents(&[None, Some(0)])?;
    /// matrix.values_mut().copy_from_slice(&[5.0, 4.0, 16.0]);
    /// // L = [[2, 0], [1, 4]]: M = [[5, 4], [4, 16]] = LᵀL
    /// let ltl = matrix.into_ltl()?;
    /// let mut x = [1.0, 1.0];
    /// ltl.multiply_lower_transposed(&mut x)?;
    /// assert_eq!(x, [3.0, 4.0]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn multiply_lower_transposed(&self, x: &mut [T]) -> Result<(), DimensionError> {
        expect("vector x", self.matrix.size(), x.len())?;
        triangular::multiply_transposed::<T, false>(&self.matrix, x);
        Ok(())
    }

    /// Solves `L x = b` in place.
    ///
    /// # Errors
    /// [`DimensionError`] when `x` has not one number per dof.
    ///
    /// ```
    /// use featherbench_dynamics::TreeSparse;
    /// let mut matrix = TreeSparse::of_parents(&[None, Some(0)])?;
    /// matrix.values_mut().copy_from_slice(&[5.0, 4.0, 16.0]);
    /// // L = [[2, 0], [1, 4]]: M = [[5, 4], [4, 16]] = LᵀL
    /// let ltl = matrix.into_ltl()?;
    /// let mut x = [2.0, 5.0];
    /// ltl.solve_lower(&mut x)?;
    /// assert_eq!(x, [1.0, 1.0]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn solve_lower(&self, x: &mut [T]) -> Result<(), DimensionError> {
        expect("right-hand side x", self.matrix.size(), x.len())?;
        triangular::solve::<T, false>(&self.matrix, 0..x.len(), x);
        Ok(())
    }

    /// Solves `Lᵀ x = b` in place.
    ///
    /// # Errors
    /// [`DimensionError`] when `x` has not one number per dof.
    ///
    /// ```
    /// use featherbench_dynamics::TreeSparse;
    /// let mut matrix = TreeSparse::of_parents(&[None, Some(0)])?;
    /// matrix.values_mut().copy_from_slice(&[5.0, 4.0, 16.0]);
    /// // L = [[2, 0], [1, 4]]: M = [[5, 4], [4, 16]] = LᵀL
    /// let ltl = matrix.into_ltl()?;
    /// let mut x = [3.0, 4.0];
    /// ltl.solve_lower_transposed(&mut x)?;
    /// assert_eq!(x, [1.0, 1.0]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn solve_lower_transposed(&self, x: &mut [T]) -> Result<(), DimensionError> {
        expect("right-hand side x", self.matrix.size(), x.len())?;
        triangular::solve_transposed::<T, false>(&self.matrix, x);
        Ok(())
    }

    /// A copy of `x`, changed by one of the operations in place: [`Ltl::solve`], a half of it, or a product. It allocates the copy.
    ///
    /// # Errors
    /// [`DimensionError`] when `x` has not one number per dof.
    ///
    /// ```
    /// use featherbench_dynamics::TreeSparse;
    /// let mut matrix = TreeSparse::of_parents(&[None, Some(0)])?;
    /// matrix.values_mut().copy_from_slice(&[5.0, 4.0, 16.0]);
    /// // L = [[2, 0], [1, 4]]: M = [[5, 4], [4, 16]] = LᵀL
    /// let ltl = matrix.into_ltl()?;
    /// use featherbench_dynamics::Ltl;
    /// assert_eq!(ltl.applied(Ltl::solve, &[9.0, 20.0])?, [1.0, 1.0]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn applied(
        &self,
        operation: impl FnOnce(&Self, &mut [T]) -> Result<(), DimensionError>,
        x: &[T],
    ) -> Result<Vec<T>, DimensionError> {
        let mut copy = x.to_vec();
        operation(self, &mut copy)?;
        Ok(copy)
    }

    /// `ln det M = 2 Σ ln L_kk`.
    ///
    /// ```
    /// use featherbench_dynamics::TreeSparse;
    /// let mut matrix = TreeSparse::of_parents(&[None, Some(0)])?;
    /// matrix.values_mut().copy_from_slice(&[5.0, 4.0, 16.0]);
    /// // L = [[2, 0], [1, 4]]: M = [[5, 4], [4, 16]] = LᵀL
    /// let ltl = matrix.into_ltl()?;
    /// assert!((ltl.log_determinant() - 64.0_f64.ln()).abs() < 1e-15);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn log_determinant(&self) -> T
    where
        T: Logarithm,
    {
        let sum = self.matrix.diagonal().fold(T::zero(), |sum, l| sum + l.ln());
        sum + sum
    }
}
