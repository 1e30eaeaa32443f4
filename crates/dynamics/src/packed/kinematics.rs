//! Forward kinematics, several joints at a time: placement, velocity and acceleration of every body.
//!
//! Source: the book, section 5.3, as in [`Kinematics`](crate::Kinematics). In world axes, with sums over the path to the root:
//!
//! 1. p_i = p_root + Σ d_j and ω_i = Σ R_j S_j q̇_j;
//! 2. ṗ_i = Σ ω_p × d_j and ω̇_i = Σ (R_j S_j q̈_j + ω_p × R_j S_j q̇_j), where ω_p is that of the parent of j;
//! 3. p̈_i = Σ (ω̇_p × d_j + ω_p × (ω_p × d_j)), and in 2 and 3 what sliding joints add.
//!
//! The root's position is added last. So a robot far from the world's origin loses no digits of its shape before that.
//! Frames: results are in world axes: the placement of the body's frame, the velocity [ω; ṗ] and acceleration [ω̇; p̈] of its origin p.
//! Gravity does not enter. Shapes: q has `nq` numbers; v and a have `nv`. Units: SI, angles in radians. Cost: O(n). A call does not
//! allocate.

use super::lanes::{LANES, Lanes, Pack, sum_from_root};
use super::model::PackedModel;
use super::orientation::{Frame, Orientations, across};
use super::trees::Poses;
use crate::error::expect;
use crate::{BodyMotion, DimensionError};
use featherbench_spatial::{Mat3, Motion, Transform, Vec3};

/// The workspace of forward kinematics over packed joints, and its results.
///
/// ```
/// use featherbench_dynamics::{PackedKinematics, PackedModel};
/// use featherbench_model::{BodyDescription, Description, JointDescription, JointType, Model};
///
/// // A point half a metre below its axis, which turns about y with 2 rad/s.
/// let joint = JointDescription { kind: JointType::Revolute { axis: [0.0, 1.0, 0.0] }, ..JointDescription::default() };
/// let arm = BodyDescription { name: "arm".into(), parent: None, mass: 1.0, com: [0.0; 3], inertia: [0.0; 6], joint };
/// let mut tip = BodyDescription { name: "tip".into(), parent: Some(0), ..arm.clone() };
/// tip.joint.placement.translation = [0.0, 0.0, -0.5];
/// let model = PackedModel::new(&Model::build(&Description { bodies: vec![arm, tip], ..Description::default() })?);
///
/// let mut kinematics = PackedKinematics::new(&model);
/// kinematics.run(&model, &[0.0, 0.0], &[2.0, 0.0], &[0.0, 0.0])?;
/// let tip = kinematics.body(1).ok_or("no such body")?;
/// assert_eq!(tip.placement.translation.to_array(), [0.0, 0.0, -0.5]);
/// assert_eq!(tip.velocity.to_array(), [0.0, 2.0, 0.0, -1.0, 0.0, 0.0]);
/// assert_eq!(tip.acceleration.to_array(), [0.0, 0.0, 0.0, 0.0, 0.0, 2.0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct PackedKinematics {
    orientations: Orientations,
    pub(super) poses: Poses,
    links: Vec<Link>,
    /// Bodies of the model.
    bodies: usize,
    /// What the last run computed.
    order: usize,
}

/// Placements alone, with velocities, with accelerations.
const PLACED: usize = 0;
pub(super) const MOVING: usize = 1;
const ACCELERATED: usize = 2;

/// The kinematics of a block, in world axes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Link {
    rotation: Mat3<Pack>,
    position: Vec3<Pack>,
    /// Position as seen from the root body's origin.
    pub from_root: Vec3<Pack>,
    pub velocity: Motion<Pack>,
    acceleration: Motion<Pack>,
}

impl PackedKinematics {
    /// A workspace for this model.
    pub fn new(model: &PackedModel) -> Self {
        let (zero, still) = (Vec3::zero(), Motion::zero());
        let link = Link { rotation: Mat3::zero(), position: zero, from_root: zero, velocity: still, acceleration: still };
        Self {
            orientations: Orientations::new(model),
            poses: Poses::new(&model.trees),
            links: vec![link; model.blocks.len()],
            bodies: model.topology.bodies(),
            order: PLACED,
        }
    }

    /// Moves every body to configuration `q`, velocity `v` and acceleration `a`.
    ///
    /// # Errors
    /// [`DimensionError`] when an argument or the workspace does not fit the model.
    pub fn run(&mut self, model: &PackedModel, q: &[f64], v: &[f64], a: &[f64]) -> Result<(), DimensionError> {
        expect("velocity v", model.topology.nv(), v.len())?;
        expect("acceleration a", model.topology.nv(), a.len())?;
        self.walk::<ACCELERATED>(model, q, v, a)
    }

    /// Placements and velocities alone.
    ///
    /// # Errors
    /// [`DimensionError`] when an argument or the workspace does not fit the model.
    pub fn set_moving(&mut self, model: &PackedModel, q: &[f64], v: &[f64]) -> Result<(), DimensionError> {
        expect("velocity v", model.topology.nv(), v.len())?;
        self.walk::<MOVING>(model, q, v, &[])
    }

    /// Placements alone.
    ///
    /// # Errors
    /// [`DimensionError`] when `q` or the workspace does not fit the model.
    pub fn place(&mut self, model: &PackedModel, q: &[f64]) -> Result<(), DimensionError> {
        self.walk::<PLACED>(model, q, &[], &[])
    }

    /// Results for a compiled body; `None` if there is no such body, or if the last run did not compute accelerations.
    pub fn body(&self, body: usize) -> Option<BodyMotion<f64>> {
        let (placement, velocity) = (self.placement(body)?, self.velocity(body)?);
        let acceleration = self.links[body / LANES].acceleration.lane(body % LANES);
        (self.order >= ACCELERATED).then_some(BodyMotion { placement, velocity, acceleration })
    }

    /// Results for every compiled body; none if the last run did not compute accelerations.
    pub fn iter(&self) -> impl Iterator<Item = BodyMotion<f64>> {
        (0..self.bodies).filter_map(|body| self.body(body))
    }

    /// Placement of a compiled body, or `None` if there is no such body.
    pub fn placement(&self, body: usize) -> Option<Transform<f64>> {
        let (link, k) = (&self.links.get(body / LANES)?, body % LANES);
        (body < self.bodies).then(|| Transform::new(link.rotation.lane(k), link.position.lane(k)))
    }

    /// Velocity [ω; ṗ] of a compiled body's origin; `None` if there is no such body, or if the last run did not compute velocities.
    pub fn velocity(&self, body: usize) -> Option<Motion<f64>> {
        let link = self.links.get(body / LANES)?;
        (body < self.bodies && self.order >= MOVING).then(|| link.velocity.lane(body % LANES))
    }

    fn walk<const ORDER: usize>(&mut self, model: &PackedModel, q: &[f64], v: &[f64], a: &[f64]) -> Result<(), DimensionError> {
        self.begin(model, q)?;
        for b in 0..model.blocks.len() {
            self.step::<ORDER>(model, b, q, v, a);
        }
        self.order = ORDER;
        Ok(())
    }

    /// Places the roots, before the first step.
    #[inline(always)]
    pub(super) fn begin(&mut self, model: &PackedModel, q: &[f64]) -> Result<(), DimensionError> {
        expect("blocks of the workspace", model.blocks.len(), self.links.len())?;
        expect("bodies of the workspace", model.topology.bodies(), self.bodies)?;
        expect("segments of the workspace", model.segments.len(), self.orientations.bases.len())?;
        expect("trees of the workspace", model.trees.roots.len(), self.poses.count())?;
        expect("configuration q", model.topology.nq(), q.len())?;
        self.poses.place(&model.trees, q);
        Ok(())
    }

    /// Block `b`, the blocks before it done.
    #[inline(always)]
    pub(super) fn step<const ORDER: usize>(&mut self, model: &PackedModel, b: usize, q: &[f64], v: &[f64], a: &[f64]) -> (Frame, Link) {
        let block = &model.blocks[b];
        let frame = self.poses.in_world(&model.trees, b, &self.orientations.turn(model, b, q));
        let links = &self.links;
        let (d, zero, still) = (frame.displacement, Vec3::zero(), Motion::zero());
        let (at_rest, nowhere) = ((Vec3::zero(), Vec3::zero()), |_| Vec3::zero());

        let mut link = Link { rotation: frame.rotation, position: zero, from_root: zero, velocity: still, acceleration: still };
        if ORDER == PLACED {
            // p = p_root + Σ d
            link.from_root = sum_from_root(model, block, d, |block, lane| links[block].from_root.lane(lane), nowhere).0;
        } else {
            // p = p_root + Σ d,  ω = Σ R S q̇
            let rate = across(model, block, &frame, v);
            let before = |block: usize, lane: usize| (links[block].from_root.lane(lane), links[block].velocity.ang.lane(lane));
            let ((from_root, omega), (_, omega_above)) = sum_from_root(model, block, (d, rate.ang), before, |_| at_rest);
            link.from_root = from_root;

            // ṗ = Σ (ω_p × d + v_J)
            let swing = omega_above.cross(d);
            let carried = if block.slides { swing + rate.lin } else { swing };
            if ORDER == MOVING {
                let before = |block: usize, lane: usize| links[block].velocity.lin.lane(lane);
                link.velocity = Motion::new(omega, sum_from_root(model, block, carried, before, nowhere).0);
            } else {
                // ω̇ = Σ (R S q̈ + ω_p × R S q̇)
                let rate_of_rate = across(model, block, &frame, a);
                let swung = omega_above.cross_add(rate.ang, rate_of_rate.ang);
                let before = |block: usize, lane: usize| (links[block].velocity.lin.lane(lane), links[block].acceleration.ang.lane(lane));
                let ((lin, alpha), (_, alpha_above)) = sum_from_root(model, block, (carried, swung), before, |_| at_rest);
                link.velocity = Motion::new(omega, lin);

                // p̈ = Σ (ω̇_p × d + ω_p × (ω_p × d)  +  (ω_p + ω) × v_J + v̇_J)
                let mut moved = omega_above.cross_add(swing, alpha_above.cross(d));
                if block.slides {
                    moved = (omega_above + omega).cross_add(rate.lin, moved) + rate_of_rate.lin;
                }
                let before = |block: usize, lane: usize| links[block].acceleration.lin.lane(lane);
                link.acceleration = Motion::new(alpha, sum_from_root(model, block, moved, before, nowhere).0);
            }
        }
        link.position = self.poses.origins(&model.trees, b) + link.from_root;
        self.links[b] = link;
        (frame, link)
    }
}
