//! From a library's factors to the neutral M = LᵀDL, leaves first.
//!
//! With P the order of elimination, P M Pᵀ = L̂ L̂ᵀ. Where each dof i is eliminated before the dofs j that support it, both factorizations
//! eliminate alike: L_ij = l̂_ji/l̂_ii and D_i = l̂_ii², where l̂_ji is the entry of L̂ in the row of j and the column of i. Otherwise the
//! numbers are others, and Pᵀ L̂ L̂ᵀ P is multiplied out at the stored entries of M and factorized again. Both are done in double-double
//! arithmetic, so that the error of the answer is that of the library's factors. An error of entries that M has not is not seen so: it is in
//! solutions.

use crate::tree::path;
use featherbench_dynamics::TreeSparse;
use featherbench_interface::Refusal;
use featherbench_spatial::{DoubleDouble, Lift, Real};

/// The numbers of a triangular factor, with its order of elimination.
#[derive(Clone, Debug, PartialEq)]
pub struct Lower {
    /// The place of each dof in the order, first eliminated first.
    pub places: Vec<usize>,
    /// The columns of L̂ in places: (row, number), the diagonal among them.
    pub columns: Vec<Vec<(usize, f64)>>,
}

impl Lower {
    /// The neutral factors of a tree's matrix, in the tree-sparse layout.
    ///
    /// # Errors
    /// [`Refusal::Failed`] where the product of the factors is not positive definite.
    pub fn neutral(&self, parents: &[Option<usize>], value: &mut [f64]) -> Result<(), Refusal> {
        let first = |dof: usize| parents[dof].is_none_or(|parent| self.places[dof] < self.places[parent]);
        if (0..parents.len()).all(first) {
            self.mapped(parents, value);
            return Ok(());
        }
        let mut product = TreeSparse::<DoubleDouble>::of_parents(parents)?;
        self.multiply(parents, product.values_mut());
        let factors = product.into_ltdl()?;
        value.iter_mut().zip(factors.factors().values()).for_each(|(value, factor)| *value = factor.to_f64());
        Ok(())
    }

    /// The same numbers in other places.
    fn mapped(&self, parents: &[Option<usize>], value: &mut [f64]) {
        let (mut column, mut at) = (vec![0.0; parents.len()], 0);
        for (dof, &place) in self.places.iter().enumerate() {
            self.columns[place].iter().for_each(|&(row, number)| column[row] = number);
            let root = column[place];
            for other in path(parents, dof) {
                value[at] = if other == dof { root * root } else { column[self.places[other]] / root };
                at += 1;
            }
            self.columns[place].iter().for_each(|&(row, _)| column[row] = 0.0);
        }
    }

    /// The stored entries of M: products of rows of L̂.
    fn multiply(&self, parents: &[Option<usize>], product: &mut [DoubleDouble]) {
        let mut rows: Vec<Vec<(usize, DoubleDouble)>> = vec![Vec::new(); parents.len()];
        for (place, column) in self.columns.iter().enumerate() {
            column.iter().for_each(|&(row, number)| rows[row].push((place, number.lift())));
        }
        let (mut row, mut at) = (vec![DoubleDouble::zero(); parents.len()], 0);
        for dof in 0..parents.len() {
            let own = &rows[self.places[dof]];
            own.iter().for_each(|&(column, number)| row[column] = number);
            for other in path(parents, dof) {
                let terms = rows[self.places[other]].iter();
                product[at] = terms.fold(DoubleDouble::zero(), |sum, &(column, number)| number.mul_add(row[column], sum));
                at += 1;
            }
            own.iter().for_each(|&(column, _)| row[column] = DoubleDouble::zero());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A plain Cholesky factorization of the matrix in an order of elimination.
    fn factorized(parents: &[Option<usize>], stored: &[f64], order: &[usize]) -> Lower {
        let n = parents.len();
        let (mut m, mut at) = (vec![vec![0.0; n]; n], 0);
        let mut places = vec![0; n];
        order.iter().enumerate().for_each(|(place, &dof)| places[dof] = place);
        for dof in 0..n {
            for other in path(parents, dof) {
                (m[places[dof]][places[other]], m[places[other]][places[dof]]) = (stored[at], stored[at]);
                at += 1;
            }
        }
        for k in 0..n {
            m[k][k] = m[k][k].sqrt();
            for i in k + 1..n {
                m[i][k] /= m[k][k];
                for j in k + 1..=i {
                    m[i][j] -= m[i][k] * m[j][k];
                }
            }
        }
        let column = |k: usize| (k..n).filter(|&i| m[i][k] != 0.0).map(|i| (i, m[i][k])).collect();
        Lower { places, columns: (0..n).map(column).collect() }
    }

    #[test]
    fn factors_of_every_order_become_ours() {
        let parents = [None, Some(0), Some(1), Some(0), Some(3), None, Some(5)];
        let mut matrix = TreeSparse::<f64>::of_parents(&parents).unwrap();
        // Dominant on its diagonal, so positive definite; no two entries alike.
        let mut next = 0.0;
        matrix.fill(|i, j| {
            next += 0.125;
            if i == j { 20.0 + next } else { next }
        });
        let stored = matrix.values().to_vec();
        let ours = matrix.into_ltdl().unwrap().factors().values().to_vec();
        for order in [[6, 5, 4, 3, 2, 1, 0], [0, 1, 2, 3, 4, 5, 6], [4, 2, 6, 3, 1, 5, 0], [3, 0, 6, 1, 4, 2, 5]] {
            let mut value = vec![0.0; stored.len()];
            factorized(&parents, &stored, &order).neutral(&parents, &mut value).unwrap();
            for (found, due) in value.iter().zip(&ours) {
                // Some roundings of seven dofs.
                assert!((found - due).abs() <= 1e-14 * due.abs(), "{order:?}: {found} for {due}");
            }
        }
    }
}
