//! The centroidal momentum matrix A and its rate of change Ȧ: the momentum about the centre of mass is `A v`, its rate `A v̇ + Ȧ v`.
//!
//! Sources: D. Orin, A. Goswami & S.-H. Lee, *Centroidal dynamics of a humanoid robot* (2013); the rate by the Coriolis operator of
//! `sweep.rs`, since `d(Iᶜ S)/dt = 2 Bᶜ S − S ×* pᶜ + Iᶜ Φ̇`, with pᶜ the momentum of the sub-tree and `Φ̇ = v × S`. A column [n; f] goes from the
//! tree's frame to the centre of mass by `n − c × f`, its rate by `ṅ − c × ḟ − ċ × f`.
//!
//! Frame: world axes, at the centre of mass; [angular; linear]. Shapes: q has `nq` numbers, v has `nv`; A and Ȧ have `nv` columns of six.
//! Units: SI. Armature adds nothing. Cost: O(n). A call does not allocate.

use super::sweep::Sweep;
use crate::error::expect;
use crate::step::by_kind;
use crate::{DimensionError, State};
use featherbench_model::{JointKind, Model, Topology};
use featherbench_spatial::{Force, Lift, Motion, Real, Vec3};

/// The centroidal momentum matrix and its rate of change, and their workspace.
///
/// ```
/// use featherbench_dynamics::{MomentumMatrix, centroidal_momentum};
/// use featherbench_model::Model;
/// use featherbench_robots::{Family, StateBatch};
/// use featherbench_spatial::Force;
///
/// let model: Model<f64> = Model::build(&Family::parse("humanoid")?.generate()?)?;
/// let states = StateBatch::random(&model, 1, 7);
/// let (q, v) = (states.q(0), states.v(0));
/// let mut workspace = MomentumMatrix::new(&model.topology);
/// workspace.run(&model, q, v)?;
/// let momentum = workspace.columns().iter().zip(v).fold(Force::zero(), |sum, (column, v)| column.scale_add(*v, sum));
/// let expected = centroidal_momentum(&model, q, v)?.momentum;
/// assert!((momentum.ang - expected.ang).norm() < 1e-12 && (momentum.lin - expected.lin).norm() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct MomentumMatrix<T> {
    sweep: Sweep<T>,
    columns: Vec<Force<T>>,
    rates: Vec<Force<T>>,
    /// Of each body: the origin of its tree's frame, and the velocity of that.
    origins: Vec<[Vec3<T>; 2]>,
}

impl<T: Real> MomentumMatrix<T> {
    /// A workspace for models of this topology.
    pub fn new(topology: &Topology) -> Self {
        let zeros = vec![Force::zero(); topology.nv()];
        let origins = vec![[Vec3::zero(); 2]; topology.bodies()];
        Self { sweep: Sweep::new(topology), columns: zeros.clone(), rates: zeros, origins }
    }

    /// A and Ȧ at configuration `q` and velocity `v`.
    ///
    /// # Errors
    /// [`DimensionError`] when an argument or the workspace does not fit the model.
    #[inline(never)]
    pub fn run<P: Real + Lift<T>>(&mut self, model: &Model<P>, q: &[T], v: &[T]) -> Result<(), DimensionError> {
        self.sweep.run::<P, true, false>(model, State { q, v, given: &[], wrenches: None })?;
        expect("columns of the workspace", model.topology.nv(), self.columns.len())?;
        let Self { sweep, columns, rates, origins } = self;
        let joints = model.topology.joints();

        // Origins of the frames, as seen from the first tree's, and their velocities. Those of the others' relative to it.
        let mut reference = None;
        for (i, joint) in joints.iter().enumerate() {
            origins[i] = match joint.parent {
                Some(parent) => origins[parent],
                None => {
                    let own = [model.joint_transform(i, q).translation, -sweep.links[i].parent_v.lin];
                    let [first, first_rate] = *reference.get_or_insert(own);
                    [own[0] - first, own[1] - first_rate]
                }
            };
        }
        // m c = Σ (h + m o) and m ċ = Σ (l + m ȯ) over the trees, o the origins
        let (mut mass, mut moment, mut momentum) = (T::zero(), Vec3::zero(), Vec3::zero());
        for (i, _) in joints.iter().enumerate().filter(|(_, joint)| joint.parent.is_none()) {
            let (sum, [origin, rate]) = (&sweep.links[i].sum, origins[i]);
            mass += sum.inertia.mass;
            moment += origin.scale_add(sum.inertia.mass, sum.inertia.first_moment);
            momentum += rate.scale_add(sum.inertia.mass, sum.momentum.lin);
        }
        let over_mass = |v: Vec3<T>| Vec3::new(v.x / mass, v.y / mass, v.z / mass);
        let (center, center_rate) = (over_mass(moment), over_mass(momentum));

        for (i, joint) in joints.iter().enumerate() {
            let [origin, rate] = origins[i];
            let (c, c_rate) = (center - origin, center_rate - rate);
            for k in 0..joint.kind.nv() {
                let column = joint.kind.column(&model.subspaces[i], k);
                (columns[joint.v + k], rates[joint.v + k]) = by_kind!(T, joint.kind, column_and_rate, sweep, i, column, c, c_rate);
            }
        }
        Ok(())
    }

    /// The columns of A of the last run; zero before the first.
    pub fn columns(&self) -> &[Force<T>] {
        &self.columns
    }

    /// The columns of Ȧ of the last run; zero before the first.
    pub fn rates(&self) -> &[Force<T>] {
        &self.rates
    }
}

/// A column about the centre of mass, which is at `c` in the tree's frame, and its rate of change.
#[inline(always)]
fn column_and_rate<T: Real>(
    kind: JointKind,
    sweep: &Sweep<T>,
    i: usize,
    column: Motion<T>,
    c: Vec3<T>,
    c_rate: Vec3<T>,
) -> (Force<T>, Force<T>) {
    let link = &sweep.links[i];
    let s = link.in_frame(kind, column);
    let f = link.sum.inertia.mul(s);
    let rate =
        link.sum.coriolis(s.ang) * T::from_f64(2.0) - s.cross_force(link.sum.momentum) + link.sum.inertia.mul(link.v.cross_motion(s));
    let moved = Force::new(f.ang - c.cross(f.lin), f.lin);
    (moved, Force::new(rate.ang - c.cross_add(rate.lin, c_rate.cross(f.lin)), rate.lin))
}

/// The centroidal momentum matrix and its rate of change, in a workspace of the call; it allocates.
///
/// # Errors
/// [`DimensionError`] when an argument does not fit the model.
pub fn momentum_matrix<T: Real, P: Real + Lift<T>>(model: &Model<P>, q: &[T], v: &[T]) -> Result<MomentumMatrix<T>, DimensionError> {
    let mut workspace = MomentumMatrix::new(&model.topology);
    workspace.run(model, q, v)?;
    Ok(workspace)
}
