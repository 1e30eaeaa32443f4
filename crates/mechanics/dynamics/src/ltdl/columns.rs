//! Selected columns of the inverse.
//!
//! Column c of M⁻¹ solves M x = e_c. In Lᵀ y = e_c, y differs from zero on the path from c to the root alone; and x is zero in other trees.
//! Shapes: a column has `nv` numbers. Unit: that of 1/M. A call does not allocate.
//! Cost of a column: d_c (d_c − 1)/2 multiply-subtracts and d_c divisions along the path, then D1 multiply-subtracts, those of its tree.

use super::{Blocked, Ltdl};
use crate::error::expect;
use crate::{DimensionError, triangular};
use featherbench_spatial::Real;

impl<T: Real> Ltdl<T> {
    /// Writes the columns of M⁻¹ of these dofs, one after the other, each with `nv` numbers. Column c has the accelerations that a unit force
    /// at dof c causes.
    ///
    /// # Errors
    /// [`DimensionError`] when there is no such dof, or `columns` has not `nv` numbers for each.
    ///
    /// ```
    /// use featherbench_dynamics::TreeSparse;
    /// let mut matrix = TreeSparse::of_parents(&[None, Some(0)])?;
    /// matrix.values_mut().copy_from_slice(&[5.0, 4.0, 8.0]);
    /// let mut column = [0.0; 2];
    /// matrix.into_ltdl()?.inverse_columns(&[1], &mut column)?;
    /// // M⁻¹ = [[8, −4], [−4, 5]] / 24
    /// assert!((column[0] + 4.0 / 24.0_f64).abs() < 1e-16 && (column[1] - 5.0 / 24.0_f64).abs() < 1e-16);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn inverse_columns(&self, dofs: &[usize], columns: &mut [T]) -> Result<(), DimensionError> {
        let n = self.matrix.size();
        for &dof in dofs {
            self.expect_dof(dof)?;
        }
        expect("numbers of the inverse's columns", dofs.len() * n, columns.len())?;
        for (&dof, x) in dofs.iter().zip(columns.chunks_exact_mut(n.max(1))) {
            x.fill(T::zero());
            x[dof] = T::one();
            // Lᵀ y = e_c and D z = y along the path: x_j −= L_kj x_k, then x_k = x_k / D_k
            let (mut next, mut root) = (Some(dof), dof);
            while let Some(k) = next {
                let (x_k, row) = (x[k], &self.matrix.values()[self.matrix.row(k)]);
                for (dofs, entries) in self.matrix.ancestors(k) {
                    for (x_j, l) in x[dofs].iter_mut().zip(&row[entries]) {
                        *x_j = (-*l).mul_add(x_k, *x_j);
                    }
                }
                x[k] = x_k / row[row.len() - 1];
                (root, next) = (k, self.matrix.parent(k));
            }
            // L x = z
            let tree = self.matrix.supported(root);
            match Blocked::find() {
                Some(blocked) => (blocked.solve_lower)(&self.matrix, &self.plan, tree, x),
                None => triangular::solve::<T, true>(&self.matrix, tree, x),
            }
        }
        Ok(())
    }

    /// The columns of M⁻¹ of these dofs, as [`Ltdl::inverse_columns`] writes them. It allocates them.
    ///
    /// # Errors
    /// [`DimensionError`] when there is no such dof.
    ///
    /// ```
    /// use featherbench_dynamics::TreeSparse;
    /// let mut matrix = TreeSparse::of_parents(&[None, None])?;
    /// matrix.values_mut().copy_from_slice(&[4.0, 8.0]);
    /// assert_eq!(matrix.into_ltdl()?.columns_of_inverse(&[1, 0])?, [0.0, 0.125, 0.25, 0.0]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn columns_of_inverse(&self, dofs: &[usize]) -> Result<Vec<T>, DimensionError> {
        let mut columns = vec![T::zero(); dofs.len() * self.matrix.size()];
        self.inverse_columns(dofs, &mut columns)?;
        Ok(columns)
    }

    /// An error if there is no such dof.
    pub(super) fn expect_dof(&self, dof: usize) -> Result<(), DimensionError> {
        let size = self.matrix.size();
        if dof < size { Ok(()) } else { expect("dofs, for the one that was named", dof.saturating_add(1), size) }
    }
}
