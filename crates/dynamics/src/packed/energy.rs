//! Kinetic energy `½ vᵀM v`, armature included, and potential energy `−Σ m g·c`, over packed joints.
//!
//! Source: the book, chapter 2, as in [`Energy`](crate::Energy). Twice the kinetic energy of a body is `ω·Ī ω + ṗ·(m ṗ + 2 ω × h)`,
//! computed in body axes for a register of bodies at once. Rounding makes a rotation R longer or shorter, and with it the velocities in world
//! axes. So `R⁻¹ = Rᵀ − E Rᵀ` with `E = RᵀR − 1` takes the velocity that the parent gives a body to body axes, and S q̇ is added there.
//! With Rᵀ alone the energy had up to five times the error.
//! The potential energy follows from the first moment of mass, and is zero if the centre of mass is at the world's origin.
//! Shapes: q has `nq` numbers, v has `nv`. Units: J. Cost: O(n). A call does not allocate.

use super::bodies::{Bodies, MOVING};
use super::center_of_mass::FirstMoment;
use super::lanes::{LANES, Lanes, Pack, load};
use super::model::{Block, PackedModel, Wide};
use super::xyz::{Xyz, cross, transposed, vector};
use crate::error::expect;
use crate::{DimensionError, Energies};
use featherbench_spatial::{Mat3, Motion, Real, Sym3, Vec3};

/// The workspace of energy over packed joints.
#[derive(Clone, Debug)]
pub struct PackedEnergy {
    bodies: Bodies,
}

impl PackedEnergy {
    /// A workspace for this model.
    pub fn new(model: &PackedModel) -> Self {
        Self { bodies: Bodies::new(model) }
    }

    /// Kinetic and potential energy at configuration `q` and velocity `v`.
    ///
    /// # Errors
    /// [`DimensionError`] when an argument or the workspace does not fit the model.
    pub fn run(&mut self, model: &PackedModel, q: &[f64], v: &[f64]) -> Result<Energies<f64>, DimensionError> {
        expect("velocity v", model.topology.nv(), v.len())?;
        self.bodies.begin(model, q)?;
        let (mut moment, mut twice_kinetic) = (Xyz::splat(0.0), Pack::from_f64(0.0));
        self.bodies.across_all_joints::<MOVING>(model, [q, v, &[]]);
        for (b, block) in model.blocks.iter().enumerate() {
            let mut first_moment = FirstMoment::zero();
            // what the parent's motion is at each body
            let mut carried = [[Xyz::splat(0.0); LANES]; 2];
            self.bodies.step::<MOVING>(model, b, [v, &[]], |k, parent, body, d| {
                first_moment.add(block, k, body, d);
                carried[0][k] = parent.omega;
                carried[1][k] = parent.velocity + cross(parent.omega, d);
            });
            moment += first_moment.total();

            let (inertia, r, rate) = (&block.inertia, self.bodies.rotation(b), load(block, &block.v, v));
            let excess = excess(&r);
            let [mut omega, mut velocity] = carried.map(|carried| {
                let turned = r.transpose_mul(transposed(|k| carried[k]));
                turned - excess * turned
            });
            omega = block.subspace.ang.scale_add(rate, omega);
            if block.slides {
                velocity = block.subspace.lin.scale_add(rate, velocity);
            }
            for Wide { lane, kind, .. } in &model.wide[block.wide.clone()] {
                let own: Motion<f64> = kind.motion(&Motion::<f64>::zero(), &v[block.v[*lane]..]);
                omega.set_lane(*lane, omega.lane(*lane) + own.ang);
                velocity.set_lane(*lane, velocity.lane(*lane) + own.lin);
            }
            // 2T += ω·Ī ω + ṗ·(m ṗ + 2 ω × h) + armature q̇²
            let momentum = (omega + omega).cross_add(inertia.first_moment, velocity * inertia.mass);
            let own = omega.dot(inertia.rotational * omega) + velocity.dot(momentum);
            twice_kinetic += (rate * rate).mul_add(block.armature, own);
        }
        let twice_kinetic = twice_kinetic.reduce_add() + of_wide_armature(model, v);
        let about_first = self.bodies.about_first(model, vector(moment));
        let about_world = self.bodies.first_origin().scale_add(model.trees.mass, about_first);
        Ok(Energies { kinetic: 0.5 * twice_kinetic, potential: -model.gravity.dot(about_world) })
    }
}

/// `RᵀR − 1`.
#[inline(always)]
fn excess(r: &Mat3<Pack>) -> Sym3<Pack> {
    let Mat3 { x, y, z } = r.transpose();
    let product = |a: Vec3<Pack>, b: Vec3<Pack>, start: Pack| a.x.mul_add(b.x, a.y.mul_add(b.y, a.z.mul_add(b.z, start)));
    let (minus_one, zero) = (Pack::from_f64(-1.0), Pack::from_f64(0.0));
    Sym3 {
        xx: product(x, x, minus_one),
        xy: product(x, y, zero),
        xz: product(x, z, zero),
        yy: product(y, y, minus_one),
        yz: product(y, z, zero),
        zz: product(z, z, minus_one),
    }
}

/// `Σ armature_k q̇_k²` over the dofs of wide joints.
#[inline(always)]
fn of_wide_armature(model: &PackedModel, v: &[f64]) -> f64 {
    let of_block = |block: &Block| {
        let dofs = model.wide[block.wide.clone()].iter().flat_map(|wide| (0..wide.kind.nv()).map(|k| block.v[wide.lane] + k));
        dofs.fold(0.0, |sum, k| Real::mul_add(model.armature[k] * v[k], v[k], sum))
    };
    model.blocks.iter().map(of_block).sum()
}
