//! The factors of `M + σ w wᵀ` and `M − σ w wᵀ` from those of M, where w is zero off the path from a dof to the root.
//!
//! There is no fill-in: w wᵀ differs from zero only between ancestors of one dof. Examples: a load in a hand adds six such terms, and so does
//! a spring or a constraint between a body and the world.
//!
//! Source: P. E. Gill, G. H. Golub, W. Murray and M. A. Saunders, *Methods for modifying matrix factorizations* (1974), method C1; R. Fletcher
//! and M. J. D. Powell, *On the modification of LDLᵀ factorizations* (1974), for what keeps it accurate. Theirs go from the first column to
//! the last; here the leaves are first. With σ negative for the downdate, and for each dof k of the path, the last first:
//!
//! ```text
//! p_k = w_k                       the vector as the dofs below k have left it
//! s   = 1 + σ Σ p_i² / D_i        over the path's dofs i from the last one to k; s⁻ is the sum before k, 1 for the first
//! D'_k = D_k s / s⁻
//! β = σ p_k / (D_k s)
//! w_j −= p_k L_kj
//! L'_kj = L_kj + β w_j            after that change of w, or, the same number, (s⁻ / s) L_kj + β w_j before it
//! ```
//!
//! The pivots D'_k are all positive if s is. So the sums are formed first, and nothing is written if one of them fails.
//!
//! Accuracy. An update takes the second form of L': it is a mean of L_kj and w_j / p_k, and loses no digits where D'_k is much greater than D_k.
//! A downdate takes the first form. Its sums are formed again from the root, where each is the next plus a positive term: they lose no
//! digits where M − σ w wᵀ is almost singular. So s is not exactly 1 before the first dof. That is a relative error of σ, of the size of the
//! roundings. What cancels in the last sum itself no method can recover: there, the condition number of the result is 1/s times that of M.
//!
//! Shapes: a vector has one number per dof of the path, d of them. Units: σ w wᵀ has those of M.
//! Cost of one vector: 3 d (d − 1)/2 multiply-adds, and in the update d (d − 1)/2 products; 5 d divisions and 6 d products. The first call allocates what it needs
//! beside the factors: 3 d + 1 numbers, and with several vectors the rows of the path, d (d + 1)/2. Later calls do not allocate.

use super::Ltdl;
use crate::error::{Pivot, expect};
use crate::{Error, NotPositiveDefinite, TreeSparse};
use featherbench_spatial::Real;

impl<T: Real> Ltdl<T> {
    /// Replaces the factors of M by those of `M + σ Σ w wᵀ`, σ ≥ 0, for one or more vectors w. Each has one number per dof of the path from the
    /// root to `dof`, the root first; all other numbers of w are zero. The vectors stand one after the other.
    ///
    /// # Errors
    /// [`Error`] when there is no such dof, when the last vector is incomplete, or when a pivot would not be positive (which needs a negative
    /// σ, or a number that is not finite). The factors are then as before.
    ///
    /// ```
    /// use featherbench_dynamics::TreeSparse;
    /// let mut matrix = TreeSparse::of_parents(&[None, Some(0), Some(0)])?;
    /// matrix.values_mut().copy_from_slice(&[5.0_f64, 1.0, 2.0, 1.0, 2.0]);
    /// let mut ltdl = matrix.clone().into_ltdl()?;
    /// // A spring of stiffness 3 between dofs 0 and 2.
    /// ltdl.update(2, 3.0, &[1.0, -1.0])?;
    ///
    /// matrix.values_mut().copy_from_slice(&[8.0, 1.0, 2.0, -2.0, 5.0]);
    /// let again = matrix.into_ltdl()?;
    /// let pairs = ltdl.factors().values().iter().zip(again.factors().values());
    /// assert!(pairs.into_iter().all(|(a, b)| (a - b).abs() < 1e-15));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn update(&mut self, dof: usize, sigma: T, vectors: &[T]) -> Result<(), Error> {
        self.change::<true>(dof, sigma, vectors)
    }

    /// Replaces the factors of M by those of `M − σ Σ w wᵀ`, σ ≥ 0; the vectors are as in [`Ltdl::update`].
    ///
    /// # Errors
    /// [`Error`] when there is no such dof, when the last vector is incomplete, or when `M − σ Σ w wᵀ` is not positive definite: the error
    /// names the dof whose pivot is not positive. The factors are then as before.
    ///
    /// ```
    /// use featherbench_dynamics::{Error, NotPositiveDefinite, TreeSparse};
    /// let mut matrix = TreeSparse::of_parents(&[None, Some(0)])?;
    /// matrix.values_mut().copy_from_slice(&[6.0, 4.0, 8.0]);
    /// let mut ltdl = matrix.into_ltdl()?;
    /// // [[6 − 8, 4], [4, 8]] has the pivots 8 and −2 − 4²/8 = −4.
    /// let refused = ltdl.downdate(1, 8.0, &[1.0, 0.0]);
    /// assert_eq!(refused, Err(Error::NotPositiveDefinite(NotPositiveDefinite { dof: 0, pivot: -4.0 })));
    /// // The factors are as before, D = diag(4, 8).
    /// ltdl.downdate(1, 2.0, &[1.0, 0.0])?;
    /// assert_eq!(ltdl.factors().get(0, 0), 2.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn downdate(&mut self, dof: usize, sigma: T, vectors: &[T]) -> Result<(), Error> {
        self.change::<false>(dof, sigma, vectors)
    }

    /// The factors of `M + σ Σ w wᵀ`, as [`Ltdl::update`] makes them, and those of M unchanged. It allocates a workspace.
    ///
    /// # Errors
    /// As of [`Ltdl::update`].
    ///
    /// ```
    /// use featherbench_dynamics::TreeSparse;
    /// let mut matrix = TreeSparse::of_parents(&[None])?;
    /// matrix.values_mut()[0] = 4.0;
    /// let ltdl = matrix.into_ltdl()?;
    /// // 4 + 2·3²
    /// assert_eq!(ltdl.updated(0, 2.0, &[3.0])?.factors().get(0, 0), 22.0);
    /// assert_eq!(ltdl.factors().get(0, 0), 4.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn updated(&self, dof: usize, sigma: T, vectors: &[T]) -> Result<Self, Error> {
        let mut copy = self.clone();
        copy.update(dof, sigma, vectors)?;
        Ok(copy)
    }

    /// The factors of `M − σ Σ w wᵀ`, as [`Ltdl::downdate`] makes them, and those of M unchanged. It allocates a workspace.
    ///
    /// # Errors
    /// As of [`Ltdl::downdate`].
    ///
    /// ```
    /// use featherbench_dynamics::TreeSparse;
    /// let mut matrix = TreeSparse::of_parents(&[None])?;
    /// matrix.values_mut()[0] = 4.0;
    /// let ltdl = matrix.into_ltdl()?;
    /// assert_eq!(ltdl.downdated(0, 3.0, &[1.0])?.factors().get(0, 0), 1.0);
    /// assert!(ltdl.downdated(0, 5.0, &[1.0]).is_err());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn downdated(&self, dof: usize, sigma: T, vectors: &[T]) -> Result<Self, Error> {
        let mut copy = self.clone();
        copy.downdate(dof, sigma, vectors)?;
        Ok(copy)
    }

    fn change<const ADD: bool>(&mut self, dof: usize, sigma: T, vectors: &[T]) -> Result<(), Error> {
        self.expect_dof(dof)?;
        let depth = self.matrix.depth(dof);
        expect("numbers of the vectors along the path", vectors.len().next_multiple_of(depth), vectors.len())?;
        let saved = if vectors.len() > depth { depth * (depth + 1) / 2 } else { 0 };
        let needed = 3 * depth + 1 + saved;
        if self.path.len() < needed {
            self.path.resize(needed, T::zero());
        }
        let (sums, rows) = self.path[..needed].split_at_mut(3 * depth + 1);
        if saved > 0 {
            for_rows_of_path(&mut self.matrix, dof, rows, |row, kept| kept.copy_from_slice(row));
        }
        for vector in vectors.chunks_exact(depth) {
            if let Err(error) = change_by_one::<T, ADD>(&mut self.matrix, dof, sigma, vector, sums) {
                if saved > 0 {
                    for_rows_of_path(&mut self.matrix, dof, rows, |row, kept| row.copy_from_slice(kept));
                }
                return Err(error.into());
            }
        }
        Ok(())
    }
}

/// Calls a function with each row of the path to a dof, and with a place for its numbers.
fn for_rows_of_path<T: Real>(matrix: &mut TreeSparse<T>, dof: usize, mut kept: &mut [T], mut act: impl FnMut(&mut [T], &mut [T])) {
    let mut next = Some(dof);
    while let Some(k) = next {
        let row = matrix.row(k);
        let (first, rest) = std::mem::take(&mut kept).split_at_mut(row.len());
        act(&mut matrix.values_mut()[row], first);
        (kept, next) = (rest, matrix.parent(k));
    }
}

/// One vector. `numbers` has 3 d + 1 of them, without a meaning before or afterwards.
fn change_by_one<T: Real, const ADD: bool>(
    matrix: &mut TreeSparse<T>,
    dof: usize,
    sigma: T,
    vector: &[T],
    numbers: &mut [T],
) -> Result<(), NotPositiveDefinite> {
    let depth = vector.len();
    let (w, rest) = numbers.split_at_mut(depth);
    let (terms, s) = rest.split_at_mut(depth);
    let (places, values) = matrix.parts_mut();
    let signed = if ADD { sigma } else { -sigma };

    // Lᵀ p = w, the terms σ p² / D, their sums s, and the pivots D s / s⁻. Dof k is at position p of the path, and s⁻ at p + 1.
    let mut smallest = Pivot::none();
    w.copy_from_slice(vector);
    s[depth] = T::one();
    let mut next = Some(dof);
    for p in (0..depth).rev() {
        let Some(k) = next else { break };
        let row = &values[places[k].start..][..=p];
        let p_k = w[p];
        for (w_j, l_kj) in w.iter_mut().zip(&row[..p]) {
            *w_j = (-p_k).mul_add(*l_kj, *w_j);
        }
        terms[p] = signed * p_k * (p_k / row[p]);
        s[p] = s[p + 1] + terms[p];
        smallest.note(k, (row[p] * (s[p] / s[p + 1])).min_lane());
        next = places[k].parent;
    }
    smallest.check()?;
    if !ADD {
        for p in 0..depth {
            s[p + 1] = s[p] - terms[p];
        }
    }

    w.copy_from_slice(vector);
    let mut next = Some(dof);
    for p in (0..depth).rev() {
        let Some(k) = next else { break };
        let row = &mut values[places[k].start..][..=p];
        let p_k = w[p];
        let beta = signed * p_k / (row[p] * s[p]);
        row[p] *= s[p] / s[p + 1];
        let kept = s[p + 1] / s[p];
        for (w_j, l_kj) in w.iter_mut().zip(&mut row[..p]) {
            let changed = (-p_k).mul_add(*l_kj, *w_j);
            *l_kj = if ADD { beta.mul_add(*w_j, kept * *l_kj) } else { beta.mul_add(changed, *l_kj) };
            *w_j = changed;
        }
        next = places[k].parent;
    }
    Ok(())
}
