//! Half of a solution, products with one factor, and the logarithm of the determinant.
//!
//! `M = LᵀDL`, so M x = b is Lᵀ y = b, D z = y, L x = z. With the root `R = D^½ L` it is `M = RᵀR`. Of these halves is made what needs a
//! square root of M: norms `|R x|² = xᵀMx` and `|R⁻ᵀ b|² = bᵀM⁻¹b`, noise of covariance M or M⁻¹ from noise of unit variance, and matrices like
//! `J M⁻¹ Jᵀ = (R⁻ᵀJᵀ)ᵀ (R⁻ᵀJᵀ)`.
//! Shapes: vectors have `nv` numbers. All is in place, and does not allocate; [`Ltdl::applied`] leaves the vector and gives another.
//! Cost: D1 = Σ (d_k − 1) multiply-adds; with the root n square roots more, and n products or divisions.
//! Products have the plain text; the two halves of a solution have the text in registers where the whole has it.

use super::{Blocked, Ltdl};
use crate::error::expect;
use crate::{DimensionError, triangular};
use featherbench_spatial::{Logarithm, Real};

/// Halves of a solution, and products with one factor.
///
/// ```
/// use featherbench_dynamics::{Ltdl, TreeSparse};
/// let mut matrix = TreeSparse::of_parents(&[None, Some(0)])?;
/// matrix.values_mut().copy_from_slice(&[5.0_f64, 4.0, 8.0]);
/// // D = diag(3, 8) and L = [[1, 0], [0.5, 1]]: M = [[5, 4], [4, 8]] = LᵀDL
/// let factors = matrix.into_ltdl()?;
/// let x = [1.0, 1.0];
/// assert_eq!(factors.applied(Ltdl::multiply_lower, &x)?, [1.0, 1.5]);
/// assert_eq!(factors.applied(Ltdl::solve_lower, &x)?, [1.0, 0.5]);
/// assert_eq!(factors.applied(Ltdl::multiply_lower_transposed, &x)?, [1.5, 1.0]);
/// assert_eq!(factors.applied(Ltdl::solve_lower_transposed, &x)?, [0.5, 1.0]);
/// // |R x|² = xᵀMx, and |R⁻ᵀ x|² = xᵀM⁻¹x with M⁻¹ = [[8, −4], [−4, 5]] / 24
/// let square = |x: Vec<f64>| x.iter().map(|x| x * x).sum::<f64>();
/// assert!((square(factors.applied(Ltdl::multiply_root, &x)?) - 21.0).abs() < 1e-14);
/// assert!((square(factors.applied(Ltdl::solve_root_transposed, &x)?) - 5.0 / 24.0).abs() < 1e-15);
/// assert!((factors.log_determinant() - 24.0_f64.ln()).abs() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
impl<T: Real> Ltdl<T> {
    /// x ← L x, with the unit lower triangular factor L.
    ///
    /// # Errors
    /// [`DimensionError`] when `x` has not one number per dof.
    pub fn multiply_lower(&self, x: &mut [T]) -> Result<(), DimensionError> {
        expect("vector x", self.matrix.size(), x.len())?;
        triangular::multiply::<T, true>(&self.matrix, x);
        Ok(())
    }

    /// x ← Lᵀ x, with the unit lower triangular factor L.
    ///
    /// # Errors
    /// [`DimensionError`] when `x` has not one number per dof.
    pub fn multiply_lower_transposed(&self, x: &mut [T]) -> Result<(), DimensionError> {
        expect("vector x", self.matrix.size(), x.len())?;
        triangular::multiply_transposed::<T, true>(&self.matrix, x);
        Ok(())
    }

    /// Solves `L x = b` in place: the last part of a solution, from the root.
    ///
    /// # Errors
    /// [`DimensionError`] when `x` has not one number per dof.
    pub fn solve_lower(&self, x: &mut [T]) -> Result<(), DimensionError> {
        expect("right-hand side x", self.matrix.size(), x.len())?;
        match Blocked::find() {
            Some(blocked) => (blocked.solve_lower)(&self.matrix, &self.plan, 0..x.len(), x),
            None => triangular::solve::<T, true>(&self.matrix, 0..x.len(), x),
        }
        Ok(())
    }

    /// Solves `Lᵀ x = b` in place: the first part of a solution, from the leaves. Of forces b, x_k is what is left at dof k when all dofs that
    /// it supports move freely.
    ///
    /// # Errors
    /// [`DimensionError`] when `x` has not one number per dof.
    pub fn solve_lower_transposed(&self, x: &mut [T]) -> Result<(), DimensionError> {
        expect("right-hand side x", self.matrix.size(), x.len())?;
        match Blocked::find() {
            Some(blocked) => (blocked.solve_lower_transposed)(&self.matrix, &self.plan, x),
            None => triangular::solve_transposed::<T, true>(&self.matrix, x),
        }
        Ok(())
    }

    /// x ← R x, with `R = D^½ L` and `M = RᵀR`: the sum of the squares is xᵀMx.
    ///
    /// # Errors
    /// [`DimensionError`] when `x` has not one number per dof.
    pub fn multiply_root(&self, x: &mut [T]) -> Result<(), DimensionError> {
        self.multiply_lower(x)?;
        self.scale_by_root(x, |x, root| x * root);
        Ok(())
    }

    /// x ← Rᵀ x, with `R = D^½ L`: noise of unit variance gets the covariance M.
    ///
    /// # Errors
    /// [`DimensionError`] when `x` has not one number per dof.
    pub fn multiply_root_transposed(&self, x: &mut [T]) -> Result<(), DimensionError> {
        expect("vector x", self.matrix.size(), x.len())?;
        self.scale_by_root(x, |x, root| x * root);
        self.multiply_lower_transposed(x)
    }

    /// Solves `R x = b` in place, with `R = D^½ L`: noise of unit variance gets the covariance M⁻¹.
    ///
    /// # Errors
    /// [`DimensionError`] when `x` has not one number per dof.
    pub fn solve_root(&self, x: &mut [T]) -> Result<(), DimensionError> {
        expect("right-hand side x", self.matrix.size(), x.len())?;
        self.scale_by_root(x, |x, root| x / root);
        self.solve_lower(x)
    }

    /// Solves `Rᵀ x = b` in place, with `R = D^½ L`: the sum of the squares is bᵀM⁻¹b.
    ///
    /// # Errors
    /// [`DimensionError`] when `x` has not one number per dof.
    pub fn solve_root_transposed(&self, x: &mut [T]) -> Result<(), DimensionError> {
        self.solve_lower_transposed(x)?;
        self.scale_by_root(x, |x, root| x / root);
        Ok(())
    }

    /// `ln det M = Σ ln D_k`. The determinant itself leaves the range of numbers for a few hundred dofs.
    pub fn log_determinant(&self) -> T
    where
        T: Logarithm,
    {
        self.matrix.diagonal().fold(T::zero(), |sum, d| sum + d.ln())
    }

    /// A copy of `x`, changed by one of the operations in place: [`Ltdl::solve`], a half of it, or a product. It allocates the copy.
    ///
    /// # Errors
    /// [`DimensionError`] when `x` has not one number per dof.
    pub fn applied(
        &self,
        operation: impl FnOnce(&Self, &mut [T]) -> Result<(), DimensionError>,
        x: &[T],
    ) -> Result<Vec<T>, DimensionError> {
        let mut copy = x.to_vec();
        operation(self, &mut copy)?;
        Ok(copy)
    }

    /// x_k and √D_k.
    fn scale_by_root(&self, x: &mut [T], scale: impl Fn(T, T) -> T) {
        for (x, d) in x.iter_mut().zip(self.matrix.diagonal()) {
            *x = scale(*x, d.sqrt());
        }
    }
}
