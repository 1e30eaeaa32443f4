//! Spatial vectors of the dofs on the path to the root, component by component.
//!
//! Position p of the path belongs to the ancestor at depth p + 1. In depth-first order the dof that comes next overwrites its position, and
//! all before it are its ancestors. So a row of a tree-sparse matrix is one product of contiguous numbers.
//! Loops run over whole registers: [`lanes`] numbers at a time. Cost: six multiply-adds per number. Nothing here allocates.

use crate::{TreePair, TreeSparse};
use featherbench_model::Topology;
use featherbench_spatial::{Force, Motion, Real, Vec3};
use std::ops::Range;

/// How many scalars are computed together: those of 64 bytes, at most eight, at least one.
pub(super) const fn lanes<T>() -> usize {
    let fitting = if size_of::<T>() < 64 { 64 / size_of::<T>() } else { 1 };
    if fitting < 8 { fitting } else { 8 }
}

/// The length of the longest path, in dofs.
pub(super) fn deepest(topology: &Topology) -> usize {
    (0..topology.nv()).map(|dof| topology.dof_depth(dof)).max().unwrap_or(0)
}

/// Motions by position.
#[derive(Clone, Debug)]
pub(super) struct Columns<T> {
    pub(super) ang: Components<T>,
    pub(super) lin: Components<T>,
}

/// Three-dimensional vectors by position.
#[derive(Clone, Debug)]
pub(super) struct Components<T> {
    x: Vec<T>,
    y: Vec<T>,
    z: Vec<T>,
}

impl<T: Real> Columns<T> {
    /// Zeros for paths of so many dofs.
    pub(super) fn new(deepest: usize) -> Self {
        Self { ang: Components::new(deepest), lin: Components::new(deepest) }
    }

    #[inline(always)]
    pub(super) fn set(&mut self, position: usize, m: Motion<T>) {
        self.ang.set(position, m.ang);
        self.lin.set(position, m.lin);
    }

    /// `out_p = m_p · f`. The length of `out` is a multiple of [`lanes`].
    #[inline(always)]
    pub(super) fn dot(&self, f: Force<T>, out: &mut [T]) {
        let (ang, lin) = (&self.ang, &self.lin);
        dot6(&ang.x, &ang.y, &ang.z, &lin.x, &lin.y, &lin.z, f, out);
    }

    /// `out_p += m_p · f`.
    #[inline(always)]
    pub(super) fn add_dot(&self, f: Force<T>, out: &mut [T]) {
        self.ang.add_dot(f.ang, out);
        self.lin.add_dot(f.lin, out);
    }
}

impl<T: Real> Components<T> {
    /// Zeros for paths of so many dofs.
    pub(super) fn new(deepest: usize) -> Self {
        let zeros = || vec![T::zero(); deepest + lanes::<T>()];
        Self { x: zeros(), y: zeros(), z: zeros() }
    }

    #[inline(always)]
    pub(super) fn set(&mut self, position: usize, v: Vec3<T>) {
        (self.x[position], self.y[position], self.z[position]) = (v.x, v.y, v.z);
    }

    /// `out_p = u_p · v`.
    #[inline(always)]
    pub(super) fn dot(&self, v: Vec3<T>, out: &mut [T]) {
        dot3::<T, false>(&self.x, &self.y, &self.z, v, out);
    }

    /// `out_p += u_p · v`.
    #[inline(always)]
    pub(super) fn add_dot(&self, v: Vec3<T>, out: &mut [T]) {
        dot3::<T, true>(&self.x, &self.y, &self.z, v, out);
    }
}

/// S of the dofs on the path, and another vector of each, by which a [`TreePair`] is written.
#[derive(Clone, Debug)]
pub(super) struct TwoColumns<T> {
    pub(super) s: Columns<T>,
    rate: Columns<T>,
}

impl<T: Real> TwoColumns<T> {
    /// Zeros for models of this topology.
    pub(super) fn new(topology: &Topology) -> Self {
        let deepest = deepest(topology);
        Self { s: Columns::new(deepest), rate: Columns::new(deepest) }
    }

    /// Puts `s` and `rate` on the path at `position`, and writes the rows of the dof: `rate_j · below` for ancestors j, and `s_j · above`.
    #[inline(always)]
    pub(super) fn write(
        &mut self,
        position: usize,
        [s, rate]: [Motion<T>; 2],
        [below, above]: [Force<T>; 2],
        row: &PaddedRow,
        matrix: &mut TreePair<T>,
    ) {
        self.s.set(position, s);
        self.rate.set(position, rate);
        let (lower, upper) = matrix.triangles_mut();
        self.rate.dot(below, row.of_matrix(lower));
        self.s.dot(above, row.of_matrix(upper));
    }
}

/// Where a dof's row is in a tree-sparse matrix.
pub(super) struct PaddedRow {
    exact: Range<usize>,
    /// The row's length in whole registers.
    padded: usize,
}

impl PaddedRow {
    #[inline(always)]
    pub(super) fn of<T: Real>(matrix: &TreeSparse<T>, dof: usize) -> Self {
        let exact = matrix.row(dof);
        Self { padded: exact.len().next_multiple_of(lanes::<T>()), exact }
    }

    /// The row and a few numbers behind it, which are not set yet: they belong to later rows or to the padding.
    #[inline(always)]
    pub(super) fn of_matrix<'a, T: Real>(&self, matrix: &'a mut TreeSparse<T>) -> &'a mut [T] {
        &mut matrix.parts_mut().1[self.exact.start..][..self.padded]
    }

    /// The row alone.
    #[inline(always)]
    pub(super) fn exact<'a, T: Real>(&self, matrix: &'a mut TreeSparse<T>) -> &'a mut [T] {
        &mut matrix.values_mut()[self.exact.clone()]
    }

    /// The diagonal of the lower triangle, also in the upper one.
    #[inline(always)]
    pub(super) fn copy_diagonal<T: Real>(&self, lower: &TreeSparse<T>, upper: &mut TreeSparse<T>) {
        let last = self.exact.end - 1;
        upper.values_mut()[last] = lower.values()[last];
    }
}

/// A function of its own: so the compiler knows that the slices do not overlap.
#[inline(never)]
#[expect(clippy::too_many_arguments, reason = "slices that are arguments do not overlap, those in a struct might")]
fn dot6<T: Real>(ax: &[T], ay: &[T], az: &[T], lx: &[T], ly: &[T], lz: &[T], f: Force<T>, out: &mut [T]) {
    let n = out.len();
    let (ax, ay, az, lx, ly, lz) = (&ax[..n], &ay[..n], &az[..n], &lx[..n], &ly[..n], &lz[..n]);
    for p in 0..n {
        let linear = lx[p].mul_add(f.lin.x, ly[p].mul_add(f.lin.y, lz[p] * f.lin.z));
        out[p] = ax[p].mul_add(f.ang.x, ay[p].mul_add(f.ang.y, az[p].mul_add(f.ang.z, linear)));
    }
}

/// The same of three components, added to what is there or not.
#[inline(never)]
fn dot3<T: Real, const ADD: bool>(x: &[T], y: &[T], z: &[T], v: Vec3<T>, out: &mut [T]) {
    let n = out.len();
    let (x, y, z) = (&x[..n], &y[..n], &z[..n]);
    for p in 0..n {
        let last = if ADD { z[p].mul_add(v.z, out[p]) } else { z[p] * v.z };
        out[p] = x[p].mul_add(v.x, y[p].mul_add(v.y, last));
    }
}
