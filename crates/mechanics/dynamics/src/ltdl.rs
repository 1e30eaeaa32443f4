//! The factorization `M = LᵀDL` of a tree-sparse matrix without fill-in, solutions of `M x = b`, and the inverse.
//!
//! Source: the book, section 6.5: eliminating from the leaves to the root keeps every zero of M. L is unit lower triangular and D diagonal;
//! they overwrite M. Shapes: M is `nv`×`nv`, x and b have `nv` numbers. Units: those of M and b. A call does not allocate.
//! Cost, with d_k the depth of dof k, D1 = Σ (d_k − 1) and D2 = Σ d_k (d_k − 1) / 2:
//!
//! | | divisions | multiply-subtracts | order |
//! |---|---|---|---|
//! | factor | D1 | D2 | O(Σ d_k²) |
//! | solve | n | 2·D1 | O(Σ d_k) |
//! | inverse | n | Σ (d_k − 1)·k + D1 | O(Σ d_k·n) |
//! | selected inverse | n | 2·D2 | O(Σ d_k²) |
//!
//! What else can be done with the factors is in `ltdl/half.rs`: half-solutions, products, square root, determinant.
//!
//! This file has the plain text, for any scalar: duals, extended precision, counted operations. Two blocked texts stand beside it, and the
//! tests compare each with it:
//!
//! - `ltdl/factor.rs`, `ltdl/solve.rs` and `ltdl/inverse.rs`, for `f64`: one matrix, eight columns to a register. Where paths are short and
//!   branches many, `ltdl/bushy.rs` takes a dof at a time.
//! - `ltdl/lanes.rs`, for `f32` and registers of states: rows in fours.
//!
//! Times, and what was tried: `docs/kernels/ltdl.md`.
//!
//! The inverse comes from L X = D⁻¹ L⁻ᵀ. Its right side is zero below the diagonal and 1/D on it. So from the root down, for c < i:
//! `X_ic = −Σ_j L_ij X_jc` and `X_ii = 1/D_i − Σ_j L_ij X_ij` over the strict ancestors j of i; X_jc = X_cj is known. (The recurrence of
//! Takahashi, Fagan and Chen, 1973, for every entry.)
//!
//! The selected inverse has the entries of the inverse where M can differ from zero. Its recurrence is the same, for ancestors c of i alone.
//! All ancestors of i are on one path, so the X_jc that it needs have been selected too. (K. Takahashi, J. Fagan and M.-S. Chen, *Formation of
//! a sparse bus impedance matrix and its application to short circuit study*, 1973. A. M. Erisman and W. F. Tinney, *On computing certain
//! elements of the inverse of a sparse matrix*, 1975, show for every sparse LU that no other entries are needed.)

use crate::error::{Pivot, expect};
use crate::{DimensionError, Error, NotPositiveDefinite, TreeSparse, triangular};
use blocks::Plan;
use featherbench_model::Topology;
use featherbench_spatial::Real;
use std::any::Any;
use std::ops::Range;
use wide::{f32x8, f32x16, f64x4, f64x8};

pub(crate) mod blocks;
mod bushy;
pub(crate) mod factor;
mod half;
mod inverse;
mod lanes;
pub(crate) mod registers;
mod solve;

/// The factors of a tree-sparse matrix. Before the first factorization they are all zero, and not valid.
///
/// # Cost
///
/// With d_k the depth of dof k, D1 = Σ (d_k − 1) and D2 = Σ d_k (d_k − 1) / 2. The plain text takes D1 divisions and D2 multiply-subtracts to
/// factor, and n divisions and 2·D1 multiply-adds to solve. In `f64` and in registers of states a factorization has n divisions, and products
/// in place of the others. A chain of 36 has D1 = 630 and D2 = 7770. Times: `docs/kernels/ltdl.md`.
#[derive(Clone, Debug)]
pub struct Ltdl<T> {
    pub(crate) matrix: TreeSparse<T>,
    pub(crate) plan: Plan,
    /// What the factorization for `f64` needs beside the matrix.
    pub(crate) scratch: Vec<T>,
    /// What the selected inverse for `f64` needs: X of one path.
    square: Vec<T>,
}

impl<T: Real> Ltdl<T> {
    /// A workspace for the factors of a matrix of this topology.
    pub fn new(topology: &Topology) -> Self {
        Self::from_unfactored(TreeSparse::new(topology))
    }

    /// Factors a matrix, leaving it as it is.
    ///
    /// # Errors
    /// [`Error`] when the matrix has another topology or a pivot is not positive.
    pub fn run(&mut self, matrix: &TreeSparse<T>) -> Result<(), Error> {
        self.matrix.copy_from(matrix)?;
        self.factor()?;
        Ok(())
    }

    /// Before [`Ltdl::factor`]: the matrix, to be written where it will be factored. Afterwards its factors: L below the diagonal, D on it.
    pub fn matrix_mut(&mut self) -> &mut TreeSparse<T> {
        &mut self.matrix
    }

    /// The factors: L below the diagonal, D on it.
    pub fn factors(&self) -> &TreeSparse<T> {
        &self.matrix
    }

    /// Factors what [`Ltdl::matrix_mut`] holds, in place.
    ///
    /// # Errors
    /// [`NotPositiveDefinite`] when a pivot is not positive.
    #[inline]
    pub fn factor(&mut self) -> Result<(), NotPositiveDefinite> {
        let smallest = match Blocked::find() {
            Some(blocked) => (blocked.factor)(&mut self.matrix, &self.plan, &mut self.scratch),
            None => eliminate(&mut self.matrix),
        };
        smallest.check()
    }

    /// [`Ltdl::factor`] for registers, as a part of its caller, and so with the instructions that the caller is compiled for.
    #[inline(always)]
    pub(crate) fn factor_registers(&mut self) -> Result<(), NotPositiveDefinite> {
        lanes::factor(&mut self.matrix, &self.plan, &mut self.scratch).check()
    }

    /// [`Ltdl::solve`] for registers, as a part of its caller.
    #[inline(always)]
    pub(crate) fn solve_registers(&self, x: &mut [T]) -> Result<(), DimensionError> {
        expect("right-hand side x", self.matrix.size(), x.len())?;
        lanes::solve(&self.matrix, &self.plan, x);
        Ok(())
    }

    /// Solves `M x = b` in place: `x` holds b before and the solution afterwards.
    ///
    /// # Errors
    /// [`DimensionError`] when `x` has not one number per dof.
    ///
    /// ```
    /// use featherbench_dynamics::TreeSparse;
    /// let mut matrix = TreeSparse::of_parents(&[None, Some(0)])?;
    /// matrix.values_mut().copy_from_slice(&[5.0, 4.0, 8.0]);
    /// let ltdl = matrix.into_ltdl()?;
    /// let mut x = [9.0_f64, 12.0];
    /// ltdl.solve(&mut x)?;
    /// assert!(x.iter().all(|x| (x - 1.0).abs() < 1e-15));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[inline]
    pub fn solve(&self, x: &mut [T]) -> Result<(), DimensionError> {
        expect("right-hand side x", self.matrix.size(), x.len())?;
        match Blocked::find() {
            Some(blocked) => (blocked.solve)(&self.matrix, &self.plan, x),
            None => solve_plainly(&self.matrix, x),
        }
        Ok(())
    }

    /// Writes the inverse X of M: `nv`×`nv` numbers, row after row. It is dense within each tree that stands on the world, and symmetric to
    /// the bit. Its unit is that of 1/M.
    ///
    /// Cost: a third of the multiply-subtracts of one solution for each column on a chain, fewer on trees.
    ///
    /// # Errors
    /// [`DimensionError`] when `inverse` has not `nv`² numbers.
    ///
    /// ```
    /// use featherbench_dynamics::TreeSparse;
    /// let mut matrix = TreeSparse::of_parents(&[None, Some(0)])?;
    /// matrix.values_mut().copy_from_slice(&[5.0, 4.0, 8.0]);
    /// let ltdl = matrix.into_ltdl()?;
    /// // M⁻¹ = [[8, −4], [−4, 5]] / 24
    /// let mut inverse = [0.0_f64; 4];
    /// ltdl.inverse(&mut inverse)?;
    /// assert!(inverse.iter().zip([8.0, -4.0, -4.0, 5.0]).all(|(x, due)| (24.0 * x - due).abs() < 1e-14));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[inline(never)]
    pub fn inverse(&self, inverse: &mut [T]) -> Result<(), DimensionError> {
        expect("inverse of the mass matrix", self.matrix.size() * self.matrix.size(), inverse.len())?;
        match Blocked::find() {
            Some(blocked) => (blocked.inverse)(&self.matrix, &self.plan, inverse),
            None => invert(&self.matrix, inverse),
        }
        Ok(())
    }

    /// The inverse of M, as [`Ltdl::inverse`] writes it. It allocates `nv`² numbers.
    ///
    /// ```
    /// use featherbench_dynamics::TreeSparse;
    /// let mut matrix = TreeSparse::of_parents(&[None, Some(0)])?;
    /// matrix.values_mut().copy_from_slice(&[5.0, 4.0, 8.0]);
    /// let ltdl = matrix.into_ltdl()?;
    /// assert!((ltdl.dense_inverse()[3] - 5.0 / 24.0_f64).abs() < 1e-16);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn dense_inverse(&self) -> Vec<T> {
        let n = self.matrix.size();
        let mut inverse = vec![T::zero(); n * n];
        match Blocked::find() {
            Some(blocked) => (blocked.inverse)(&self.matrix, &self.plan, &mut inverse),
            None => invert(&self.matrix, &mut inverse),
        }
        inverse
    }

    /// Writes the entries of the inverse X of M at the places where M can differ from zero: those of the dofs of which one supports the other.
    /// There, X is what [`Ltdl::inverse`] gives, up to roundings. Elsewhere X can differ from zero, but is not computed.
    ///
    /// `1 / X_kk` is the inertia that a force at dof k meets while all other dofs are free. Its unit is that of M.
    ///
    /// Cost: O(Σ d_k²), the multiply-subtracts of two factorizations. On a chain that is the cost of the inverse, on branches less. In `f64`
    /// the first call allocates about d² numbers for the longest path.
    ///
    /// # Errors
    /// [`DimensionError`] when `inverse` has another topology.
    ///
    /// ```
    /// use featherbench_dynamics::{TreeSparse, mass_matrix};
    /// use featherbench_model::Model;
    /// use featherbench_robots::{Family, StateBatch};
    ///
    /// let model: Model<f64> = Model::build(&Family::parse("humanoid")?.generate()?)?;
    /// let states = StateBatch::random(&model, 1, 1);
    /// let mut ltdl = mass_matrix(&model, states.q(0))?.into_ltdl()?;
    /// let mut inverse = TreeSparse::new(&model.topology);
    /// ltdl.selected_inverse(&mut inverse)?;
    ///
    /// // A unit force at dof 20 accelerates it by X₂₀,₂₀.
    /// let mut x = vec![0.0; model.topology.nv()];
    /// x[20] = 1.0;
    /// ltdl.solve(&mut x)?;
    /// assert!((x[20] * (1.0 / inverse.get(20, 20)) - 1.0).abs() < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[inline(never)]
    pub fn selected_inverse(&mut self, inverse: &mut TreeSparse<T>) -> Result<(), DimensionError> {
        self.matrix.expect_same_tree(inverse)?;
        match Blocked::find() {
            Some(blocked) => (blocked.select)(&self.matrix, &self.plan, &mut self.square, inverse),
            None => select_inverse(&self.matrix, inverse),
        }
        Ok(())
    }

    /// A workspace that holds a matrix, to be factored by [`Ltdl::factor`].
    pub fn from_unfactored(matrix: TreeSparse<T>) -> Self {
        let plan = Plan::new(&matrix);
        let scratch = vec![T::zero(); Blocked::<T>::find().map_or(0, |blocked| (blocked.scratch)(&plan))];
        Self { matrix, plan, scratch, square: Vec::new() }
    }
}

/// The plain factorization. Its result is valid only if the smallest pivot is positive.
///
/// `L_ki = H_ki / D_k,  H_i· −= L_ki H_k·` for every dof k, the last first, and every strict ancestor i of k.
#[inline(never)]
fn eliminate<T: Real>(matrix: &mut TreeSparse<T>) -> Pivot {
    let mut smallest = Pivot::none();
    for k in (0..matrix.size()).rev() {
        let depth = matrix.depth(k);
        let (rows, values) = matrix.parts_mut();
        let (above, h_k) = values.split_at_mut(rows[k].start);
        let d = h_k[depth - 1];
        smallest.note(k, d.min_lane());
        // ancestor i is at position p of the row
        let mut ancestor = rows[k].parent;
        for p in (0..depth - 1).rev() {
            let Some(i) = ancestor else { break };
            let l = h_k[p] / d;
            for (h_i, h_k) in above[rows[i].start..][..=p].iter_mut().zip(&h_k[..=p]) {
                *h_i = (-l).mul_add(*h_k, *h_i);
            }
            h_k[p] = l;
            ancestor = rows[i].parent;
        }
    }
    smallest
}

/// The plain solution: Lᵀ y = b from the leaves, D z = y, and L x = z from the root.
#[inline(never)]
fn solve_plainly<T: Real>(matrix: &TreeSparse<T>, x: &mut [T]) {
    triangular::solve_transposed::<T, true>(matrix, x);
    // D z = y
    for (x, d) in x.iter_mut().zip(matrix.diagonal()) {
        *x = *x / d;
    }
    triangular::solve::<T, true>(matrix, 0..x.len(), x);
}

/// The plain inverse.
fn invert<T: Real>(matrix: &TreeSparse<T>, inverse: &mut [T]) {
    let n = matrix.size();
    for (i, d) in matrix.diagonal().enumerate() {
        let (above, rest) = inverse.split_at_mut(i * n);
        let (x_i, l_i) = (&mut rest[..n], &matrix.values()[matrix.row(i)]);
        // X_ic = −Σ_j L_ij X_jc
        x_i[..i].fill(T::zero());
        for (dofs, entries) in matrix.ancestors(i) {
            for (j, l) in dofs.zip(&l_i[entries]) {
                for (x_ic, x_jc) in x_i[..i].iter_mut().zip(&above[j * n..]) {
                    *x_ic = (-*l).mul_add(*x_jc, *x_ic);
                }
            }
        }
        // X_ii = 1/D_i − Σ_j L_ij X_ij
        x_i[i] = T::one() / d;
        for (dofs, entries) in matrix.ancestors(i) {
            for (j, l) in dofs.zip(&l_i[entries]) {
                x_i[i] = (-*l).mul_add(x_i[j], x_i[i]);
            }
        }
        for c in 0..i {
            above[c * n + i] = x_i[c];
        }
    }
}

/// The plain selected inverse.
///
/// The row of an ancestor j of i has X_jc of the ancestors c up to j, and by symmetry X_cj. So one pass over it serves two entries of row i.
fn select_inverse<T: Real>(factors: &TreeSparse<T>, inverse: &mut TreeSparse<T>) {
    for (i, d) in factors.diagonal().enumerate() {
        let l_i = &factors.values()[factors.row(i)];
        let (rows, values) = inverse.parts_mut();
        let (above, rest) = values.split_at_mut(rows[i].start);
        let (x_i, strict) = (&mut rest[..l_i.len()], l_i.len() - 1);
        // X_ic = −Σ_j L_ij X_jc; ancestor j is at position p of the row
        x_i.fill(T::zero());
        let mut ancestor = rows[i].parent;
        for p in (0..strict).rev() {
            let Some(j) = ancestor else { break };
            let (x_j, x_jj) = (&above[rows[j].start..][..p], above[rows[j].start + p]);
            let mut x_ij = (-l_i[p]).mul_add(x_jj, x_i[p]);
            for ((x_ic, x_jc), l_ic) in x_i.iter_mut().zip(x_j).zip(l_i) {
                *x_ic = (-l_i[p]).mul_add(*x_jc, *x_ic);
                x_ij = (-*l_ic).mul_add(*x_jc, x_ij);
            }
            x_i[p] = x_ij;
            ancestor = rows[j].parent;
        }
        // X_ii = 1/D_i − Σ_j L_ij X_ij
        let mut x_ii = T::one() / d;
        for (l_ij, x_ij) in l_i[..strict].iter().zip(&x_i[..strict]) {
            x_ii = (-*l_ij).mul_add(*x_ij, x_ii);
        }
        x_i[strict] = x_ii;
    }
}

/// A scalar's functions that take the place of the plain ones.
struct Blocked<T> {
    factor: fn(&mut TreeSparse<T>, &Plan, &mut [T]) -> Pivot,
    /// How many numbers `factor` needs beside the matrix.
    scratch: fn(&Plan) -> usize,
    solve: Of<T>,
    solve_lower: fn(&TreeSparse<T>, &Plan, Range<usize>, &mut [T]),
    solve_lower_transposed: Of<T>,
    inverse: Of<T>,
    select: fn(&TreeSparse<T>, &Plan, &mut Vec<T>, &mut TreeSparse<T>),
}

/// From factors and the topology to an array.
type Of<T> = fn(&TreeSparse<T>, &Plan, &mut [T]);

impl<T: Real> Blocked<T> {
    const IN_FOURS: &Self = &Self {
        factor: lanes::factor,
        scratch: |_| 0,
        solve: lanes::solve,
        solve_lower: lanes::solve_lower,
        solve_lower_transposed: lanes::solve_lower_transposed,
        inverse: |matrix, _, inverse| invert(matrix, inverse),
        select: |matrix, _, _, inverse| select_inverse(matrix, inverse),
    };

    /// Those of T. The compiler compares the types, and leaves a constant.
    #[inline(always)]
    fn find() -> Option<&'static Self> {
        const OF_F64: &Blocked<f64> = &Blocked {
            factor: factor::factor,
            scratch: Plan::scratch,
            solve: solve::solve,
            solve_lower: solve::solve_lower,
            solve_lower_transposed: solve::solve_lower_transposed,
            inverse: inverse::inverse,
            select: inverse::select,
        };
        Self::from(OF_F64)
            .or_else(|| Self::from(Blocked::<f64x8>::IN_FOURS))
            .or_else(|| Self::from(Blocked::<f64x4>::IN_FOURS))
            .or_else(|| Self::from(Blocked::<f32>::IN_FOURS))
            .or_else(|| Self::from(Blocked::<f32x8>::IN_FOURS))
            .or_else(|| Self::from(Blocked::<f32x16>::IN_FOURS))
    }

    /// The functions of a scalar, if this scalar is T.
    #[inline(always)]
    fn from<S: Real>(functions: &'static Blocked<S>) -> Option<&'static Self> {
        (functions as &dyn Any).downcast_ref()
    }
}
