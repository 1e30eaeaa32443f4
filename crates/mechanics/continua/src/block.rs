//! How reduced coordinates s move the fine tree: q = φ(s), q̇ = B ṡ, q̈ = B s̈ + Ḃ ṡ, and τ_s = Bᵀ τ. All of it is block-diagonal.
//!
//! | block | φ | B |
//! |---|---|---|
//! | direct | q = s | 1 |
//! | linear | q = Φ s | Φ |
//! | screw | free joint k at exp(Δ_k ξ(s)) | Δ_k J(Δ_k ξ) restricted to the strains that vary |
//!
//! In the screw block v̇ = Δ J ξ̈ + (d/dt J(Δ ξ)) Δ ξ̇. The rate of J comes from dual numbers: J is evaluated at Δ ξ + ε Δ ξ̇.

use crate::Strain;
use featherbench_spatial::{Angle, Dual, Lift, Motion, Real, TangentBlock, Vec3};
use nalgebra::DMatrix;
use std::ops::Range;

/// One block. Offsets are those of the reduced and of the fine vectors.
#[derive(Clone, Debug)]
pub(crate) enum Block {
    /// Joints that are as they are.
    Direct {
        /// Of the fine tree, of q and of v.
        fine: (Range<usize>, Range<usize>),
        /// The first reduced number, of q and of v.
        reduced: (usize, usize),
    },
    /// One-dof joints that follow linearly.
    Linear {
        /// The joints' numbers, of q and of v.
        fine: Vec<(usize, usize)>,
        /// The first reduced number, of q and of v.
        reduced: (usize, usize),
        /// Φ
        shapes: DMatrix<f64>,
    },
    /// Free joints along a screw motion.
    Screw {
        /// The joints' first numbers, of q and of v, and the distance Δ of each.
        fine: Vec<(usize, usize, f64)>,
        /// The first reduced number, of q and of v.
        reduced: (usize, usize),
        /// The strains that vary.
        strains: Vec<Strain>,
    },
}

/// A reduced state or a fine one: configuration, velocity, acceleration.
pub(crate) struct Moving<Q> {
    pub(crate) q: Q,
    pub(crate) v: Q,
    pub(crate) a: Q,
}

impl Block {
    /// The fine state of a reduced one.
    pub(crate) fn embed<T: Angle>(&self, s: &Moving<&[T]>, fine_state: &mut Moving<&mut [T]>)
    where
        f64: Lift<T>,
    {
        match self {
            Self::Direct { fine: (in_q, in_v), reduced: (q, v) } => {
                fine_state.q[in_q.clone()].copy_from_slice(&s.q[*q..q + in_q.len()]);
                fine_state.v[in_v.clone()].copy_from_slice(&s.v[*v..v + in_v.len()]);
                fine_state.a[in_v.clone()].copy_from_slice(&s.a[*v..v + in_v.len()]);
            }
            Self::Linear { fine, reduced: (q, v), shapes } => {
                for (row, (in_q, in_v)) in fine.iter().enumerate() {
                    let sum = |x: &[T]| (0..shapes.ncols()).fold(T::zero(), |sum, j| x[j].mul_add(shapes[(row, j)].lift(), sum));
                    fine_state.q[*in_q] = sum(&s.q[*q..]);
                    fine_state.v[*in_v] = sum(&s.v[*v..]);
                    fine_state.a[*in_v] = sum(&s.a[*v..]);
                }
            }
            Self::Screw { fine, reduced: (q, v), strains } => {
                let strain = strain(strains, &s.q[*q..], true);
                let (rate, second) = (self::strain(strains, &s.v[*v..], false), self::strain(strains, &s.a[*v..], false));
                for (in_q, in_v, step) in fine {
                    let scaled = |m: Motion<T>| m * T::from_f64(*step);
                    let (x, x_rate, x_second) = (scaled(strain), scaled(rate), scaled(second));
                    let (turn, way) = x.exp();
                    fine_state.q[*in_q..in_q + 3].copy_from_slice(&way.to_array());
                    fine_state.q[in_q + 3..in_q + 7].copy_from_slice(&turn.to_array());
                    // v = J(x) ẋ and its rate with ẋ constant, then v̇ += J(x) ẍ
                    let (at, going) = (x.to_array(), x_rate.to_array());
                    let moving = Motion::from_array(std::array::from_fn(|k| Dual::new(at[k], going[k])));
                    let twist = apply(&moving.right_jacobian(), Motion::from_array(going.map(Dual::constant)));
                    let steady = apply(&x.right_jacobian(), x_second).to_array();
                    for (k, (twist, steady)) in twist.to_array().into_iter().zip(steady).enumerate() {
                        let place = in_v + in_body_order(k);
                        fine_state.v[place] = twist.value;
                        fine_state.a[place] = twist.derivative + steady;
                    }
                }
            }
        }
    }

    /// B at the reduced configuration `s`; allocates for a screw block alone.
    pub(crate) fn columns<T: Angle>(&self, s: &[T]) -> Columns<'_, T>
    where
        f64: Lift<T>,
    {
        match self {
            Self::Direct { fine: (_, in_v), reduced: (_, v) } => Columns::Direct { fine: in_v.clone(), first: *v },
            Self::Linear { fine, reduced: (_, v), shapes } => Columns::Linear { fine, shapes, first: *v },
            Self::Screw { fine, reduced: (q, v), strains } => {
                let strain = strain(strains, &s[*q..], true);
                let mut entries = Vec::with_capacity(strains.len() * fine.len());
                let jacobians: Vec<_> = fine.iter().map(|(_, _, step)| (strain * T::from_f64(*step)).right_jacobian()).collect();
                for direction in strains {
                    for (jacobian, (_, _, step)) in jacobians.iter().zip(fine) {
                        entries.push((apply(jacobian, unit(*direction)) * T::from_f64(*step)).to_array());
                    }
                }
                Columns::Screw { fine, entries, first: *v, count: strains.len() }
            }
        }
    }
}

/// The matrix B of a block at a configuration.
pub(crate) enum Columns<'a, T> {
    Direct {
        fine: Range<usize>,
        first: usize,
    },
    Linear {
        fine: &'a [(usize, usize)],
        shapes: &'a DMatrix<f64>,
        first: usize,
    },
    /// One entry per strain and joint, joint after joint.
    Screw {
        fine: &'a [(usize, usize, f64)],
        entries: Vec<[T; 6]>,
        first: usize,
        count: usize,
    },
}

impl<T: Real> Columns<'_, T>
where
    f64: Lift<T>,
{
    /// The reduced dofs.
    pub(crate) fn dofs(&self) -> Range<usize> {
        match self {
            Self::Direct { fine, first } => *first..first + fine.len(),
            Self::Linear { shapes, first, .. } => *first..first + shapes.ncols(),
            Self::Screw { first, count, .. } => *first..first + count,
        }
    }

    /// Writes `factor` times column `j` of the block into a fine vector, over what the block's dofs had.
    pub(crate) fn spread(&self, j: usize, factor: T, into: &mut [T]) {
        match self {
            Self::Direct { fine, .. } => into[fine.start + j] = factor,
            Self::Linear { fine, shapes, .. } => {
                fine.iter().enumerate().for_each(|(row, (_, in_v))| into[*in_v] = factor * shapes[(row, j)].lift());
            }
            Self::Screw { fine, entries, .. } => {
                for ((_, in_v, _), entries) in fine.iter().zip(&entries[j * fine.len()..]) {
                    entries.iter().enumerate().for_each(|(k, entry)| into[in_v + in_body_order(k)] = *entry * factor);
                }
            }
        }
    }

    /// `τ_s = Bᵀ τ`
    pub(crate) fn project(&self, tau: &[T], result: &mut [T]) {
        let into = &mut result[self.dofs()];
        match self {
            Self::Direct { fine, .. } => into.copy_from_slice(&tau[fine.clone()]),
            Self::Linear { fine, shapes, .. } => {
                for (j, into) in into.iter_mut().enumerate() {
                    let product = |sum, (row, (_, in_v)): (usize, &(usize, usize))| tau[*in_v].mul_add(shapes[(row, j)].lift(), sum);
                    *into = fine.iter().enumerate().fold(T::zero(), product);
                }
            }
            Self::Screw { fine, entries, .. } => {
                for (into, entries) in into.iter_mut().zip(entries.chunks_exact(fine.len())) {
                    *into = T::zero();
                    for ((_, in_v, _), entries) in fine.iter().zip(entries) {
                        for (k, entry) in entries.iter().enumerate() {
                            *into = entry.mul_add(tau[in_v + in_body_order(k)], *into);
                        }
                    }
                }
            }
        }
    }
}

/// ξ of the strains that vary, with or without the extension 1 of the straight rod.
fn strain<T: Real>(strains: &[Strain], s: &[T], straight: bool) -> Motion<T> {
    let mut xi = [T::zero(); 6];
    if straight {
        xi[Strain::Extension.index()] = T::one();
    }
    for (strain, s) in strains.iter().zip(s) {
        xi[strain.index()] += *s;
    }
    Motion::from_array(xi)
}

fn unit<T: Real>(strain: Strain) -> Motion<T> {
    let mut xi = [T::zero(); 6];
    xi[strain.index()] = T::one();
    Motion::from_array(xi)
}

/// The place of number k of [ang; lin] in a free joint's velocity, which is [linear; angular].
fn in_body_order(k: usize) -> usize {
    (k + 3) % 6
}

/// The block times a motion: ang = J ang, lin = J lin + Q ang.
fn apply<T: Real>(block: &TangentBlock<T>, m: Motion<T>) -> Motion<T> {
    let lin: Vec3<T> = block.coupling.mul_vec_add(m.ang, block.diagonal * m.lin);
    Motion::new(block.diagonal * m.ang, lin)
}
