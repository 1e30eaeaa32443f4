//! The derivative of a step of the variational midpoint rule, and its transpose.
//!
//! With p = M(q) v, p⁻(q, u) and w(q, u) the momenta before and after the step, and p' = M(q') v':
//!
//! ```text
//! ∂p⁻/∂u δu = M(q) δv + ∂(p − p⁻)/∂q δq        δq' = A(hu) δq + h J(hu) δu        M(q') δv' = ∂w/∂q δq + ∂w/∂u δu − ∂p'/∂q' δq'
//! ```
//!
//! Source: the implicit function theorem. The state in the middle moves by `A(hu/2) δq + (h/2) J(hu/2) δu`. The momenta are linear in μ and
//! g, so that the columns of their derivatives are momenta as well. The maps' own change with u comes from duals: no joint's block depends
//! on another joint, so that one direction moves all joints.
//! Frames, shapes, units: as in [`super::VariationalMidpoint`]. Cost: see there. A call does not allocate.

use super::momenta::Momenta;
use crate::integrate::dense::{Lu, add_product, add_scaled, add_transpose_product};
use crate::integrate::lagrangian::{LagrangianPartials, MomentumAndForce};
use crate::integrate::midpoint::scale;
use crate::integrate::{IntegrationError, Linearise};
use crate::{Crba, DimensionError, Error, Ltdl, MassGradient, TreePair, TreeSparse};
use featherbench_model::{TangentMap, Topology};
use featherbench_spatial::{Angle, Dual};

/// When a step begins, its length, and the states before and after it.
pub(super) struct Ends<'a, T> {
    pub(super) t: T,
    pub(super) h: T,
    pub(super) q: &'a [T],
    pub(super) v: &'a [T],
    pub(super) next_q: &'a [T],
    pub(super) next_v: &'a [T],
}

/// The derivative of the last linearised step, with the workspace.
#[derive(Clone, Debug)]
pub(super) struct Derivative<T> {
    h: T,
    crba: Crba<T>,
    gradient: MassGradient<T>,
    /// Of μ and g; then, in the same places, of p⁻ and w; at last of p − p⁻ and w, less p' where the inputs are meant.
    partials: LagrangianPartials<T>,
    /// Of p⁻ with respect to u.
    by_u: Lu<T>,
    /// M(q), M in the middle, and the factors of M(q').
    mass: TreeSparse<T>,
    middle_mass: TreeSparse<T>,
    next_mass: Ltdl<T>,
    /// ∂p/∂q and ∂p'/∂q'; p and p' by the inputs.
    momentum_by_q: TreePair<T>,
    next_momentum_by_q: TreePair<T>,
    momentum_by_input: Vec<T>,
    next_momentum_by_input: Vec<T>,
    /// A(hu) and J(hu).
    end_by_q: TangentMap<T>,
    end_by_step: TangentMap<T>,
    duals: ByDuals<T>,
    middle_q: Vec<T>,
    x: Vec<T>,
    y: Vec<T>,
    z: Vec<T>,
}

/// The momenta while u changes and μ and g do not.
#[derive(Clone, Debug)]
struct ByDuals<T> {
    momenta: Momenta<Dual<T>>,
    u: Vec<Dual<T>>,
    momentum: Vec<Dual<T>>,
    force: Vec<Dual<T>>,
}

impl<T: Angle> Derivative<T> {
    pub(super) fn new(topology: &Topology, inputs: usize) -> Self {
        let nv = topology.nv();
        let (zeros, constants) = (vec![T::zero(); nv], vec![Dual::constant(T::zero()); nv]);
        let (matrix, pair, map) = (TreeSparse::new(topology), TreePair::new(topology), TangentMap::new(topology));
        let momenta = Momenta::new(topology);
        Self {
            h: T::zero(),
            crba: Crba::new(topology),
            gradient: MassGradient::new(topology),
            partials: LagrangianPartials::new(nv, inputs),
            by_u: Lu::new(nv),
            mass: matrix.clone(),
            middle_mass: matrix,
            next_mass: Ltdl::new(topology),
            momentum_by_q: pair.clone(),
            next_momentum_by_q: pair,
            momentum_by_input: vec![T::zero(); nv * inputs],
            next_momentum_by_input: vec![T::zero(); nv * inputs],
            end_by_q: map.clone(),
            end_by_step: map,
            duals: ByDuals { momenta, u: constants.clone(), momentum: constants.clone(), force: constants },
            middle_q: vec![T::zero(); topology.nq()],
            x: zeros.clone(),
            y: zeros.clone(),
            z: zeros,
        }
    }

    /// The derivative of a step with u, whose momentum and force in the middle are given with its momenta. The momenta are overwritten.
    pub(super) fn set<F: Linearise<T>>(
        &mut self,
        f: &mut F,
        topology: &Topology,
        ends: &Ends<'_, T>,
        u: &[T],
        middle: &MomentumAndForce<T>,
        momenta: &mut Momenta<T>,
    ) -> Result<(), IntegrationError> {
        let (h, half) = (ends.h, ends.h * T::from_f64(0.5));
        self.h = h;
        scale(h, u, &mut self.x);
        self.end_by_q.d_integrate_q(&self.x)?;
        self.end_by_step.d_integrate_v(&self.x)?;
        scale(half, u, &mut self.x);
        topology.integrate(ends.q, &self.x, &mut self.middle_q)?;

        let model = f.lagrangian().ok_or(IntegrationError::NoEnergies)?.model();
        self.crba.run(model, ends.q, &mut self.mass)?;
        self.crba.run(model, &self.middle_q, &mut self.middle_mass)?;
        self.crba.run(model, ends.next_q, self.next_mass.matrix_mut())?;
        self.next_mass.factor().map_err(Error::from)?;
        self.gradient.run(model, ends.q, ends.v, &mut self.momentum_by_q)?;
        self.gradient.run(model, ends.next_q, ends.next_v, &mut self.next_momentum_by_q)?;
        f.momentum_by_inputs(ends.q, ends.v, &mut self.momentum_by_input)?;
        f.momentum_by_inputs(ends.next_q, ends.next_v, &mut self.next_momentum_by_input)?;
        f.linearise_lagrangian(ends.t + half, &self.middle_q, u, &mut self.partials)?;

        self.chain_middle(momenta, half)?;
        let Self { partials, by_u, x, y, .. } = self;
        to_momenta(momenta, &mut partials.momentum_by_q, &mut partials.force_by_q, x, y)?;
        to_momenta(momenta, &mut by_u.values, &mut partials.force_by_v, x, y)?;
        to_momenta(momenta, &mut partials.momentum_by_input, &mut partials.force_by_input, x, y)?;
        self.add_change_of_maps(topology, u, middle)?;
        self.subtract_momenta();
        if self.by_u.factor() { Ok(()) } else { Err(IntegrationError::Singular { time: ends.t.min_lane() }) }
    }

    /// From the derivatives of μ and g by the state in the middle to those by q and u. Row by row: row of (B V) = Vᵀ (row of B).
    fn chain_middle(&mut self, momenta: &Momenta<T>, half: T) -> Result<(), DimensionError> {
        let nv = self.x.len();
        for row in 0..nv {
            let of_row = row * nv..(row + 1) * nv;
            let momentum_by_u = &mut self.by_u.values[of_row.clone()];
            momentum_by_u.iter_mut().enumerate().for_each(|(column, x)| *x = self.middle_mass.get(row, column));
            let force_by_u = &mut self.partials.force_by_v[of_row.clone()];
            for (by_q, by_u) in [(&mut self.partials.momentum_by_q, momentum_by_u), (&mut self.partials.force_by_q, force_by_u)] {
                let by_q = &mut by_q[of_row.clone()];
                momenta.half_by_step().transpose_mul(by_q, &mut self.x)?;
                add_scaled(half, &self.x, by_u);
                momenta.half_by_q().transpose_mul(by_q, &mut self.x)?;
                by_q.copy_from_slice(&self.x);
            }
        }
        Ok(())
    }

    /// Adds what the maps' change with u does to p⁻ and w.
    fn add_change_of_maps(&mut self, topology: &Topology, u: &[T], middle: &MomentumAndForce<T>) -> Result<(), DimensionError> {
        let Self { duals, by_u, partials, .. } = self;
        let (nv, h) = (u.len(), Dual::constant(self.h));
        for (dual, x) in duals.momentum.iter_mut().zip(middle.momentum()) {
            *dual = Dual::constant(*x);
        }
        for (dual, x) in duals.force.iter_mut().zip(middle.force()) {
            *dual = Dual::constant(*x);
        }
        // the k-th dof of every joint that turns: one-dof joints have constant maps
        let turning = || topology.joints().iter().filter(|joint| joint.kind.nv() > 1);
        for k in 0..turning().map(|joint| joint.kind.nv()).max().unwrap_or(0) {
            for (dual, x) in duals.u.iter_mut().zip(u) {
                *dual = Dual::constant(*x);
            }
            let moving = || turning().filter(|joint| joint.kind.nv() > k);
            moving().for_each(|joint| duals.u[joint.v + k].derivative = T::one());
            duals.momenta.set_step(h, &duals.u)?;
            duals.momenta.set(&duals.momentum, &duals.force)?;
            for joint in moving() {
                for row in joint.v..joint.v + joint.kind.nv() {
                    by_u.values[row * nv + joint.v + k] += duals.momenta.before()[row].derivative;
                    partials.force_by_v[row * nv + joint.v + k] += duals.momenta.after()[row].derivative;
                }
            }
        }
        Ok(())
    }

    /// From the derivatives of p⁻ to those of p − p⁻; and those of w by the inputs become those of w − p'.
    fn subtract_momenta(&mut self) {
        let nv = self.x.len();
        for (place, x) in self.partials.momentum_by_q.iter_mut().enumerate() {
            *x = self.momentum_by_q.get(place / nv, place % nv) - *x;
        }
        for (x, momentum) in self.partials.momentum_by_input.iter_mut().zip(&self.momentum_by_input) {
            *x = *momentum - *x;
        }
        add_scaled(-T::one(), &self.next_momentum_by_input, &mut self.partials.force_by_input);
    }

    /// The derivative times a direction.
    pub(super) fn push(&mut self, dq: &mut [T], dv: &mut [T], du: &[T]) -> Result<(), DimensionError> {
        let Self { partials, x, y, z, .. } = self;
        // x = δu
        self.mass.mul(dv, x)?;
        add_product(&partials.momentum_by_q, dq, x);
        add_product(&partials.momentum_by_input, du, x);
        self.by_u.solve(x);

        // y = δw, less what the inputs do to p'
        y.fill(T::zero());
        add_product(&partials.force_by_q, dq, y);
        add_product(&partials.force_by_v, x, y);
        add_product(&partials.force_by_input, du, y);
        self.end_by_q.mul(dq, z)?;
        dq.copy_from_slice(z);
        self.end_by_step.mul(x, z)?;
        add_scaled(self.h, z, dq);
        // δv' = M(q')⁻¹ (y − ∂p'/∂q' δq')
        self.next_momentum_by_q.mul(dq, z)?;
        add_scaled(-T::one(), z, y);
        self.next_mass.solve(y)?;
        dv.copy_from_slice(y);
        Ok(())
    }

    /// The transpose times a gradient: the lines of [`Self::push`] backwards.
    pub(super) fn pull(&mut self, lq: &mut [T], lv: &mut [T], lu: &mut [T]) -> Result<(), DimensionError> {
        let Self { partials, x, y, z, .. } = self;
        // y = λw
        y.copy_from_slice(lv);
        self.next_mass.solve(y)?;
        self.next_momentum_by_q.mul_transposed(y, z)?;
        add_scaled(-T::one(), z, lq);

        // x = λu, through ∂p⁻/∂u
        self.end_by_step.transpose_mul(lq, z)?;
        scale(self.h, z, x);
        add_transpose_product(&partials.force_by_v, y, x);
        add_transpose_product(&partials.force_by_input, y, lu);
        self.end_by_q.transpose_mul(lq, z)?;
        lq.copy_from_slice(z);
        add_transpose_product(&partials.force_by_q, y, lq);
        self.by_u.transpose_solve(x);

        self.mass.mul(x, lv)?;
        add_transpose_product(&partials.momentum_by_q, x, lq);
        add_transpose_product(&partials.momentum_by_input, x, lu);
        Ok(())
    }
}

/// Derivatives of μ and g become those of p⁻ and w, column by column.
fn to_momenta<T: Angle>(
    momenta: &mut Momenta<T>,
    momentum: &mut [T],
    force: &mut [T],
    x: &mut [T],
    y: &mut [T],
) -> Result<(), DimensionError> {
    let width = momentum.len() / x.len().max(1);
    for column in 0..width {
        for (row, (x, y)) in x.iter_mut().zip(y.iter_mut()).enumerate() {
            (*x, *y) = (momentum[row * width + column], force[row * width + column]);
        }
        momenta.set(x, y)?;
        for (row, (before, after)) in momenta.before().iter().zip(momenta.after()).enumerate() {
            (momentum[row * width + column], force[row * width + column]) = (*before, *after);
        }
    }
    Ok(())
}
