//! What changes of forces and accelerations do to the joint accelerations: many columns together, by the rows of `articulated.rs`.
//!
//! A block has some columns side by side, one per lane: those of some dofs in ∂v̇/∂q and in ∂v̇/∂v, or in ∂v̇/∂τ. Each lane goes inward from its
//! dof to the root, and outward over the tree:
//!
//! ```text
//! inward    u = e − Sᵀ p,  y = D⁻¹ u,  p_p += X* (p + U D⁻¹ u)
//! outward   a' = X a_p + [0; 2 δω × w] + ρ,  x = y − D⁻¹ Uᵀ a' − 2 D⁻¹ (Sᵀ Bᴬ) δω,  a = a' + S x
//! ```
//!
//! Here e is one at the lane's dof in ∂v̇/∂τ, and zero elsewhere. The force p begins with what the lane's joint passes to its parent. The field ρ is
//! added where the lane's dof is met, and δω lasts from there on. Row k of the result is x at dof k. Bodies that support no lane's dof are passed
//! over on the way inward. Trees without a lane's dof have zeros.
//!
//! Frames and symbols: those of `articulated.rs`. Cost per row and lane, in multiply-adds of a revolute joint: 15 outward, 9 more below the
//! lane's dof, and 15 inward for each ancestor. Nothing here allocates.

use super::articulated::{Articulated, Column, Link, Row};
use crate::DimensionError;
use crate::error::expect;
use crate::step::{slides, turns};
use featherbench_model::{Joint, Topology};
use featherbench_spatial::{Real, Vec3};
use std::ops::Range;

/// The vectors of a path slot: an angular one and a linear one, then δω. Each has a register or more per coordinate.
const PARTS: usize = 9;
/// The most lanes of a block.
const WIDEST: usize = 16;

/// The workspace of blocks.
#[derive(Clone, Debug)]
pub(super) struct Response<T> {
    /// By path slot: forces on the way inward; accelerations and δω on the way outward.
    path: Vec<T>,
    /// What is on each path slot.
    passing: Vec<Passing>,
    /// y by row, where the row's body was reached on the way inward.
    y: Vec<T>,
    reached: Vec<bool>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Passing {
    Nothing,
    /// A force, or an acceleration.
    Change,
    /// An acceleration, and δω.
    Turning,
}

/// The results: ∂v̇/∂q and ∂v̇/∂v, or ∂v̇/∂τ, row after row.
enum Results<'a, T> {
    Motion([&'a mut [T]; 2]),
    Force(&'a mut [T]),
}

impl<T: Real> Response<T> {
    /// A workspace for models of this topology.
    pub(super) fn new(topology: &Topology) -> Self {
        let zeros = |count| vec![T::zero(); count];
        Self {
            path: zeros(topology.slots() * PARTS * WIDEST),
            passing: vec![Passing::Nothing; topology.slots()],
            y: zeros(topology.nv() * WIDEST),
            reached: vec![false; topology.bodies()],
        }
    }

    /// An error if the topology has another size.
    pub(super) fn expect_topology(&self, topology: &Topology) -> Result<(), DimensionError> {
        expect("path slots of the workspace", topology.slots(), self.passing.len())?;
        expect("rows of the workspace", topology.nv() * WIDEST, self.y.len())?;
        expect("bodies of the workspace", topology.bodies(), self.reached.len())
    }

    /// ∂v̇/∂q, ∂v̇/∂v and ∂v̇/∂τ, row after row.
    pub(super) fn run(&mut self, topology: &Topology, bodies: &Articulated<T>, by_q: &mut [T], by_v: &mut [T], by_tau: &mut [T]) {
        // Of registers, four are as much as sixteen numbers of `f64`.
        if size_of::<T>() <= size_of::<f64>() {
            self.blocks::<16, 8>(topology, bodies, by_q, by_v, by_tau);
        } else {
            self.blocks::<4, 2>(topology, bodies, by_q, by_v, by_tau);
        }
    }

    /// Blocks of `W` lanes, or `H = W/2` dofs in q and in v.
    fn blocks<const W: usize, const H: usize>(
        &mut self,
        topology: &Topology,
        bodies: &Articulated<T>,
        by_q: &mut [T],
        by_v: &mut [T],
        by_tau: &mut [T],
    ) {
        let n = topology.nv();
        for first in (0..n).step_by(H) {
            let dofs = first..n.min(first + H);
            self.block::<W, H>(topology, bodies, dofs, &mut Results::Motion([&mut *by_q, &mut *by_v]));
        }
        // M⁻¹ is symmetric: rows behind a block's last dof are columns of later blocks.
        for first in (0..n).step_by(W) {
            self.block::<W, H>(topology, bodies, first..n.min(first + W), &mut Results::Force(&mut *by_tau));
        }
        for i in 1..n {
            let (before, row) = by_tau.split_at_mut(i * n);
            for (j, entry) in row[..i].iter_mut().enumerate() {
                *entry = before[j * n + i];
            }
        }
    }

    /// The columns of some dofs.
    fn block<const W: usize, const H: usize>(
        &mut self,
        topology: &Topology,
        bodies: &Articulated<T>,
        dofs: Range<usize>,
        results: &mut Results<'_, T>,
    ) {
        let (n, joints) = (topology.nv(), topology.joints());
        // the joint of the block's last dof
        let last = joints.partition_point(|joint| joint.v < dofs.end) - 1;
        self.passing.fill(Passing::Nothing);
        self.reached.fill(false);
        for (i, joint) in joints[..=last].iter().enumerate().rev() {
            let own = own(joint, &dofs);
            let by_force = matches!(results, Results::Force(_));
            if self.passing[joint.slot] == Passing::Change || (by_force && !own.is_empty()) {
                let unit = if by_force { own.clone() } else { 0..0 };
                let (link, rows) = (&bodies.links[i], &bodies.rows[joint.v..]);
                match (turns(joint.kind), slides(joint.kind)) {
                    (true, false) => self.inward::<W, true, false>(joint, link, rows, dofs.start, unit),
                    (false, _) => self.inward::<W, false, true>(joint, link, rows, dofs.start, unit),
                    (true, true) => self.inward::<W, true, true>(joint, link, rows, dofs.start, unit),
                }
                self.reached[i] = true;
            }
            if let (false, Some(_)) = (by_force, joint.parent) {
                self.push::<W, H>(joint.parent_slot, &bodies.columns, own, dofs.start);
            }
        }

        self.passing.fill(Passing::Nothing);
        let rows = if let Results::Force(_) = results { dofs.end } else { n };
        for (i, joint) in joints.iter().enumerate().take_while(|(_, joint)| joint.v < rows) {
            let own = own(joint, &dofs);
            let comes = match joint.parent {
                Some(_) => self.passing[joint.parent_slot],
                None if self.reached[i] || !own.is_empty() => {
                    self.path[..PARTS * W].fill(T::zero());
                    Passing::Change
                }
                None => Passing::Nothing,
            };
            if comes == Passing::Nothing {
                self.passing[joint.slot] = Passing::Nothing;
                let zeros = [T::zero(); W];
                (joint.v..joint.v + joint.kind.nv()).for_each(|row| results.write::<W, H>(row * n + dofs.start, dofs.len(), &zeros));
                continue;
            }
            let place = Place { i, joint, comes, own, first: dofs.start, count: dofs.len(), n };
            match (turns(joint.kind), slides(joint.kind)) {
                (true, false) => self.outward::<W, H, true, false>(bodies, &place, results),
                (false, _) => self.outward::<W, H, false, true>(bodies, &place, results),
                (true, true) => self.outward::<W, H, true, true>(bodies, &place, results),
            }
        }
    }

    /// One body on the way inward. `unit` are the dofs of the joint that are lanes of ∂v̇/∂τ.
    #[inline(always)]
    fn inward<const W: usize, const TURNS: bool, const SLIDES: bool>(
        &mut self,
        joint: &Joint,
        link: &Link<T>,
        rows: &[Row<T>],
        first: usize,
        unit: Range<usize>,
    ) {
        let Self { path, passing, y, .. } = self;
        let (path, y) = (path.as_chunks_mut::<W>().0, y.as_chunks_mut::<W>().0);
        let Some(own) = path[joint.slot * PARTS..].first_chunk_mut::<PARTS>() else { return };
        if passing[joint.slot] == Passing::Nothing {
            own.fill([T::zero(); W]);
        }
        for k in (0..joint.kind.nv()).rev() {
            let y = &mut y[joint.v + k];
            y.fill(T::zero());
            if unit.contains(&(joint.v + k)) {
                y[joint.v + k - first] = T::one();
            }
            row_inward::<T, W, TURNS, SLIDES>(&rows[k], own, y);
        }
        passing[joint.slot] = Passing::Nothing;
        if joint.parent.is_none() {
            return;
        }
        carry_inward(link.d, own);
        let before = passing[joint.parent_slot];
        passing[joint.parent_slot] = Passing::Change;
        if joint.slot != joint.parent_slot {
            // the parent's slot is the lower one
            let (lower, upper) = path.split_at_mut(joint.slot * PARTS);
            let (there, own) = (&mut lower[joint.parent_slot * PARTS..][..6], &upper[..6]);
            match before {
                Passing::Nothing => there.copy_from_slice(own),
                _ => there.iter_mut().zip(own).for_each(|(there, own)| add(own, there)),
            }
        }
    }

    /// Adds what the joint of these dofs passes to its parent.
    #[inline(always)]
    fn push<const W: usize, const H: usize>(&mut self, slot: usize, columns: &[Vec<Column<T>>; 2], own: Range<usize>, first: usize) {
        let there = &mut self.path.as_chunks_mut::<W>().0[slot * PARTS..][..6];
        for dof in own {
            if self.passing[slot] == Passing::Nothing {
                there.fill([T::zero(); W]);
                self.passing[slot] = Passing::Change;
            }
            for (half, columns) in columns.iter().enumerate() {
                for (there, push) in there.iter_mut().zip(columns[dof].push.to_array()) {
                    there[half * H + dof - first] += push;
                }
            }
        }
    }

    /// One body on the way outward.
    #[inline(always)]
    fn outward<const W: usize, const H: usize, const TURNS: bool, const SLIDES: bool>(
        &mut self,
        bodies: &Articulated<T>,
        at: &Place<'_>,
        results: &mut Results<'_, T>,
    ) {
        let (joint, link) = (at.joint, &bodies.links[at.i]);
        let path = self.path.as_chunks_mut::<W>().0;
        let mut turning = at.comes == Passing::Turning;
        if joint.slot != joint.parent_slot {
            let parts = if turning { PARTS } else { 6 };
            let from = joint.parent_slot * PARTS;
            path.copy_within(from..from + parts, joint.slot * PARTS);
        }
        let Some(own) = path[joint.slot * PARTS..].first_chunk_mut::<PARTS>() else { return };
        if joint.parent.is_some() {
            if turning {
                carry_outward::<T, W, true>(link.d, link.twice_w, own);
            } else {
                carry_outward::<T, W, false>(link.d, link.twice_w, own);
            }
        }
        if let (Results::Motion(_), false) = (&*results, at.own.is_empty()) {
            if !turning {
                own[6..].fill([T::zero(); W]);
            }
            turning = true;
            for dof in at.own.clone() {
                for (half, columns) in bodies.columns.iter().enumerate() {
                    let (column, lane) = (&columns[dof], half * H + dof - at.first);
                    own.iter_mut().zip(column.field.to_array()).for_each(|(a, field)| a[lane] += field);
                    own[6..].iter_mut().zip(column.turn.to_array()).for_each(|(turn, rate)| turn[lane] = rate);
                }
            }
        }
        let y = self.y.as_chunks::<W>().0;
        for (dof, row) in bodies.rows.iter().enumerate().skip(joint.v).take(joint.kind.nv()) {
            let mut x = if self.reached[at.i] { y[dof] } else { [T::zero(); W] };
            if turning {
                row_outward::<T, W, TURNS, SLIDES, true>(row, own, &mut x);
            } else {
                row_outward::<T, W, TURNS, SLIDES, false>(row, own, &mut x);
            }
            results.write::<W, H>(dof * at.n + at.first, at.count, &x);
        }
        self.passing[joint.slot] = if turning { Passing::Turning } else { Passing::Change };
    }
}

/// Where a block is on its way outward.
struct Place<'a> {
    /// The body, and what comes to it.
    i: usize,
    joint: &'a Joint,
    comes: Passing,
    /// The joint's dofs that are the block's; its first dof, and how many it has.
    own: Range<usize>,
    first: usize,
    count: usize,
    /// Dofs of the model.
    n: usize,
}

/// The dofs of a joint among those of a block.
#[inline(always)]
fn own(joint: &Joint, dofs: &Range<usize>) -> Range<usize> {
    let (start, end) = (joint.v, joint.v + joint.kind.nv());
    (if start > dofs.start { start } else { dofs.start })..(if end < dofs.end { end } else { dofs.end })
}

impl<T: Real> Results<'_, T> {
    /// Writes a row of so many dofs at a place of the matrices.
    #[inline(always)]
    fn write<const W: usize, const H: usize>(&mut self, place: usize, dofs: usize, x: &[T; W]) {
        match self {
            Self::Motion([by_q, by_v]) if dofs == H => {
                for (by, x) in [by_q, by_v].into_iter().zip(x.as_chunks::<H>().0) {
                    if let Some(out) = by[place..].first_chunk_mut::<H>() {
                        *out = *x;
                    }
                }
            }
            Self::Motion([by_q, by_v]) => {
                by_q[place..][..dofs].copy_from_slice(&x[..dofs]);
                by_v[place..][..dofs].copy_from_slice(&x[H..][..dofs]);
            }
            Self::Force(by_tau) => by_tau[place..][..dofs].copy_from_slice(&x[..dofs]),
        }
    }
}

/// `y += x`.
#[inline(always)]
fn add<T: Real, const W: usize>(x: &[T; W], y: &mut [T; W]) {
    for w in 0..W {
        y[w] += x[w];
    }
}

// The steps of one dof and one joint are functions of their own: so the compiler knows that their arguments do not overlap, and keeps whole
// registers of lanes.

/// `u −= Sᵀ p`, `p += U D⁻¹ u`, and `y = D⁻¹ u`, which takes the place of u.
#[inline(never)]
fn row_inward<T: Real, const W: usize, const TURNS: bool, const SLIDES: bool>(row: &Row<T>, p: &mut [[T; W]; PARTS], u: &mut [T; W]) {
    let Row { s, scaled, d_inverse, .. } = *row;
    let [nx, ny, nz, fx, fy, fz, ..] = p;
    for w in 0..W {
        let mut sum = u[w];
        if TURNS {
            sum = (-s.ang.x).mul_add(nx[w], (-s.ang.y).mul_add(ny[w], (-s.ang.z).mul_add(nz[w], sum)));
        }
        if SLIDES {
            sum = (-s.lin.x).mul_add(fx[w], (-s.lin.y).mul_add(fy[w], (-s.lin.z).mul_add(fz[w], sum)));
        }
        nx[w] = scaled.ang.x.mul_add(sum, nx[w]);
        ny[w] = scaled.ang.y.mul_add(sum, ny[w]);
        nz[w] = scaled.ang.z.mul_add(sum, nz[w]);
        fx[w] = scaled.lin.x.mul_add(sum, fx[w]);
        fy[w] = scaled.lin.y.mul_add(sum, fy[w]);
        fz[w] = scaled.lin.z.mul_add(sum, fz[w]);
        u[w] = sum * d_inverse;
    }
}

/// `n_p = n + d × f`.
#[inline(never)]
fn carry_inward<T: Real, const W: usize>(d: Vec3<T>, p: &mut [[T; W]; PARTS]) {
    let [nx, ny, nz, fx, fy, fz, ..] = p;
    for w in 0..W {
        let n = d.cross_add(Vec3::new(fx[w], fy[w], fz[w]), Vec3::new(nx[w], ny[w], nz[w]));
        (nx[w], ny[w], nz[w]) = (n.x, n.y, n.z);
    }
}

/// `a_lin += α × d`, and `δω × 2 w` in lanes that turn.
#[inline(never)]
fn carry_outward<T: Real, const W: usize, const TURNING: bool>(d: Vec3<T>, twice_w: Vec3<T>, a: &mut [[T; W]; PARTS]) {
    let [ax, ay, az, lx, ly, lz, tx, ty, tz] = a;
    for w in 0..W {
        let mut lin = Vec3::new(ax[w], ay[w], az[w]).cross_add(d, Vec3::new(lx[w], ly[w], lz[w]));
        if TURNING {
            lin = Vec3::new(tx[w], ty[w], tz[w]).cross_add(twice_w, lin);
        }
        (lx[w], ly[w], lz[w]) = (lin.x, lin.y, lin.z);
    }
}

/// `x = y − D⁻¹ Uᵀ a' − 2 D⁻¹ (Sᵀ Bᴬ) δω`, which takes the place of y, and `a = a' + S x`.
#[inline(never)]
fn row_outward<T: Real, const W: usize, const TURNS: bool, const SLIDES: bool, const TURNING: bool>(
    row: &Row<T>,
    a: &mut [[T; W]; PARTS],
    y: &mut [T; W],
) {
    let Row { s, scaled, turn, .. } = *row;
    let [ax, ay, az, lx, ly, lz, tx, ty, tz] = a;
    for w in 0..W {
        let mut sum = y[w];
        if TURNING {
            sum = (-turn.x).mul_add(tx[w], (-turn.y).mul_add(ty[w], (-turn.z).mul_add(tz[w], sum)));
        }
        // two short sums wait less than one long sum (docs/kernels/aba.md)
        let angular = scaled.ang.x.mul_add(ax[w], scaled.ang.y.mul_add(ay[w], scaled.ang.z * az[w]));
        let linear = (-scaled.lin.x).mul_add(lx[w], (-scaled.lin.y).mul_add(ly[w], (-scaled.lin.z).mul_add(lz[w], sum)));
        let x = linear - angular;
        if TURNS {
            ax[w] = s.ang.x.mul_add(x, ax[w]);
            ay[w] = s.ang.y.mul_add(x, ay[w]);
            az[w] = s.ang.z.mul_add(x, az[w]);
        }
        if SLIDES {
            lx[w] = s.lin.x.mul_add(x, lx[w]);
            ly[w] = s.lin.y.mul_add(x, ly[w]);
            lz[w] = s.lin.z.mul_add(x, lz[w]);
        }
        y[w] = x;
    }
}
