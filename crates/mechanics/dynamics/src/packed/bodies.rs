//! The kinematics of the bodies in world axes, from the root to the leaves: a vector in a register, one body after the other.
//!
//! About its axis u a joint turns by `L = R₀ (u uᵀ + sin q · u× + cos q · (1 − u uᵀ))`, formed for a register of joints at once. Then
//! `R_i = R_p L_i`, and with the displacement `d = R_p t` from the parent's origin:
//!
//! - p = p_p + d,
//! - ω = ω_p + ω_J and ṗ = ṗ_p + ω_p × d + v_J,
//! - ω̇ = ω̇_p + ω_p × ω_J + ω̇_J and p̈ = p̈_p + ω̇_p × d + ω_p × (ω_p × d) + (ω_p + ω) × v_J + v̇_J,
//!
//! where ω_J, v_J, ω̇_J, v̇_J are the parts of S q̇ and S q̈. Each is a few multiply-adds of one register. Sums over registers of joints have
//! fewer. But they need R transposed, and their steps are additions too (`docs/kernels/kinematics.md`).
//!
//! Positions are summed from the root body's origin. So a robot far from the world's origin loses no digits of its shape.
//!
//! Cost: L has 18 multiply-adds per register of joints, beside sine and cosine. In registers of one vector a revolute joint has 9 operations
//! for R, 5 for the position, 8 for the velocity and 10 for the acceleration. R waits for three dependent multiply-adds per joint.

use super::lanes::{LANES, Lanes, Pack, from_lanes, load};
use super::model::{PackedModel, Segment, is_screw};
use super::xyz::{Xyz, cross, times, transposed, two_crosses, vector, xyz};
use crate::DimensionError;
use crate::error::expect;
use featherbench_model::{JointKind, Model};
use featherbench_spatial::{Mat3, Motion, Transform, Vec3};

/// What the kinematics need of a block's joints.
#[derive(Clone, Debug)]
pub(super) struct Steps {
    /// Displacement from the parent's origin in the parent's axes at q = 0, and its change with q. Zero for a root.
    mount: Vec3<Pack>,
    travel: Vec3<Pack>,
    /// Motion subspace of the one-dof joints, in the parent's axes.
    axis: Vec3<Pack>,
    slide: Vec3<Pack>,
    /// Whether a joint's subspace has a linear part.
    slides: [bool; LANES],
}

/// The joint at the root of a tree.
#[derive(Clone, Debug)]
pub(super) struct Root {
    kind: JointKind,
    placement: Transform<f64>,
    slide: Vec3<f64>,
    /// Where its numbers begin in q.
    q: usize,
    /// Its body.
    body: usize,
}

/// What the kinematics need of a model.
#[derive(Clone, Debug)]
pub(super) struct Trees {
    /// Per block.
    pub steps: Vec<Steps>,
    pub roots: Vec<Root>,
    /// The tree of each body.
    of_body: Vec<usize>,
    /// Mass of all bodies.
    pub mass: f64,
}

impl Trees {
    pub fn new(model: &Model<f64>) -> Self {
        let joints = model.topology.joints();
        let (mut roots, mut of_body) = (Vec::new(), Vec::<usize>::new());
        for (i, joint) in joints.iter().enumerate() {
            of_body.push(joint.parent.map_or(roots.len(), |parent| of_body[parent]));
            if joint.parent.is_none() {
                let (placement, slide) = (model.placements[i], model.subspaces[i].lin);
                roots.push(Root { kind: joint.kind, placement, slide, q: joint.q, body: i });
            }
        }
        let steps = (0..joints.len()).step_by(LANES).map(|first| Steps::new(model, first)).collect();
        Self { steps, roots, of_body, mass: model.inertias.iter().map(|inertia| inertia.mass).sum() }
    }

    /// The centre of mass from a first moment of mass; not finite when there is no mass.
    #[inline(always)]
    pub fn center(&self, moment: Vec3<f64>) -> Vec3<f64> {
        Vec3::new(moment.x / self.mass, moment.y / self.mass, moment.z / self.mass)
    }
}

impl Steps {
    fn new(model: &Model<f64>, first: usize) -> Self {
        let joints = &model.topology.joints()[first..];
        let each = |f: &dyn Fn(usize) -> f64| from_lanes(|k| if k < joints.len() { f(first + k) } else { 0.0 });
        let vector = |f: &dyn Fn(usize) -> Vec3<f64>| Vec3::new(each(&|i| f(i).x), each(&|i| f(i).y), each(&|i| f(i).z));
        let hangs = |i: usize| model.topology.joints()[i].parent.is_some();
        let subspace = |i: usize| if is_screw(model.topology.joints()[i].kind) { model.subspaces[i] } else { Motion::zero() };
        let slide = |i: usize| model.placements[i].rotation * subspace(i).lin;
        Self {
            mount: vector(&|i| if hangs(i) { model.placements[i].translation } else { Vec3::zero() }),
            travel: vector(&|i| if hangs(i) { slide(i) } else { Vec3::zero() }),
            axis: vector(&|i| model.placements[i].rotation * subspace(i).ang),
            slide: vector(&slide),
            slides: std::array::from_fn(|k| joints.get(k).is_some_and(|joint| crate::step::slides(joint.kind))),
        }
    }
}

impl Root {
    /// The root body's origin in the world.
    #[inline(always)]
    fn origin(&self, q: &[f64]) -> Vec3<f64> {
        let q = &q[self.q..];
        match self.kind {
            JointKind::Free => self.placement.point(Vec3::new(q[0], q[1], q[2])),
            JointKind::Prismatic(_) | JointKind::Helical => self.placement.point(self.slide * q[0]),
            JointKind::Revolute(_) | JointKind::Spherical => self.placement.translation,
        }
    }
}

// What a walk computes of each body beside its orientation: a sum of these. Accelerations need angular velocities.
pub(super) const POSITIONS: usize = 1;
pub(super) const ANGULAR_VELOCITIES: usize = 2;
pub(super) const VELOCITIES: usize = 4;
pub(super) const ACCELERATIONS: usize = 8;

/// Orientations alone.
pub(super) const TURNED: usize = 0;
/// Placements.
pub(super) const PLACED: usize = POSITIONS;
/// Placements and velocities.
pub(super) const MOVING: usize = PLACED + ANGULAR_VELOCITIES + VELOCITIES;
/// Placements, velocities and accelerations.
pub(super) const ACCELERATED: usize = MOVING + ACCELERATIONS;

/// Whether `order` has this part.
pub(super) const fn has(order: usize, part: usize) -> bool {
    order & part != 0
}

/// The kinematics of a body, in world axes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Body {
    /// Orientation by columns.
    pub rotation: [Xyz; 3],
    /// Position as seen from the root body's origin, and in the world.
    pub from_root: Xyz,
    pub position: Xyz,
    /// ω and ṗ, ω̇ and p̈.
    pub omega: Xyz,
    pub velocity: Xyz,
    pub alpha: Xyz,
    pub acceleration: Xyz,
}

/// The kinematics of the bodies.
#[derive(Clone, Debug)]
pub(super) struct Bodies {
    /// As many as there are lanes. Those without a joint stay zero.
    pub bodies: Vec<Body>,
    /// Per block; `across_joints` sets them.
    locals: Vec<Local>,
    /// Bodies of the model.
    pub count: usize,
    /// The root body's origin of each tree.
    pub origins: Vec<Vec3<f64>>,
}

/// What a configuration and its rates are across the joints of a block.
#[derive(Clone, Copy, Debug)]
struct Local {
    /// L and t: orientation and position of each body in its parent.
    rotation: Mat3<Pack>,
    displacement: Vec3<Pack>,
    /// Velocities and accelerations of the one-dof joints.
    v: [f64; LANES],
    a: [f64; LANES],
}

impl Body {
    /// The world.
    fn world() -> Self {
        let (zero, axis) = (Xyz::splat(0.0), |x, y, z| xyz(Vec3::new(x, y, z)));
        let rotation = [axis(1.0, 0.0, 0.0), axis(0.0, 1.0, 0.0), axis(0.0, 0.0, 1.0)];
        Self { rotation, from_root: zero, position: zero, omega: zero, velocity: zero, alpha: zero, acceleration: zero }
    }
}

impl Bodies {
    /// A workspace for this model.
    pub fn new(model: &PackedModel) -> Self {
        let local = Local { rotation: Mat3::zero(), displacement: Vec3::zero(), v: [0.0; LANES], a: [0.0; LANES] };
        let nothing = Body { rotation: [Xyz::splat(0.0); 3], ..Body::world() };
        Self {
            bodies: vec![nothing; model.blocks.len() * LANES],
            locals: vec![local; model.blocks.len()],
            count: model.topology.bodies(),
            origins: vec![Vec3::zero(); model.trees.roots.len()],
        }
    }

    /// Checks the configuration and the workspace, and places the root bodies' origins.
    ///
    /// # Errors
    /// [`DimensionError`] when the configuration or the workspace does not fit the model.
    #[inline(always)]
    pub fn begin(&mut self, model: &PackedModel, q: &[f64]) -> Result<(), DimensionError> {
        expect("blocks of the workspace", model.blocks.len(), self.bodies.len() / LANES)?;
        expect("bodies of the workspace", model.topology.bodies(), self.count)?;
        expect("trees of the workspace", model.trees.roots.len(), self.origins.len())?;
        expect("configuration q", model.topology.nq(), q.len())?;
        for (origin, root) in self.origins.iter_mut().zip(&model.trees.roots) {
            *origin = root.origin(q);
        }
        Ok(())
    }

    /// The origin of the first root body; zero without bodies.
    #[inline(always)]
    pub fn first_origin(&self) -> Vec3<f64> {
        self.origins.first().copied().unwrap_or(Vec3::zero())
    }

    /// The first moment of mass about the first root body's origin, from the sum of those of the trees about their own.
    #[inline(always)]
    pub fn about_first(&self, model: &PackedModel, moment: Vec3<f64>) -> Vec3<f64> {
        let others = self.origins.iter().zip(&model.trees.roots).skip(1);
        others.fold(moment, |moment, (origin, root)| {
            let mass = model.blocks[root.body / LANES].supported.lane(root.body % LANES);
            (*origin - self.first_origin()).scale_add(mass, moment)
        })
    }

    /// The orientation of a body.
    #[inline(always)]
    pub fn orientation(&self, body: usize) -> Mat3<f64> {
        let [x, y, z] = self.bodies[body].rotation.map(vector);
        Mat3::from_rows(x, y, z).transpose()
    }

    /// The orientations of a block's bodies, a register per component.
    #[inline(always)]
    pub fn rotation(&self, b: usize) -> Mat3<Pack> {
        let column = |column: usize| self.packed(b, |body| body.rotation[column]);
        Mat3::from_rows(column(0), column(1), column(2)).transpose()
    }

    /// A vector of a block's bodies, a register per component.
    #[inline(always)]
    pub fn packed(&self, b: usize, of: impl Fn(&Body) -> Xyz) -> Vec3<Pack> {
        let own: &[Body; LANES] = self.bodies[b * LANES..][..LANES].try_into().expect("a block has LANES bodies");
        transposed(|k| of(&own[k]))
    }

    /// The positions of a block's bodies as seen from the first root body's origin.
    #[inline(always)]
    pub fn seen_from_first(&self, model: &PackedModel, b: usize) -> Vec3<Pack> {
        let mut seen = self.packed(b, |body| body.from_root);
        if self.origins.len() > 1 {
            let block = &model.blocks[b];
            for (k, tree) in model.trees.of_body[block.first..][..block.count].iter().enumerate() {
                seen.set_lane(k, seen.lane(k) + (self.origins[*tree] - self.first_origin()));
            }
        }
        seen
    }

    /// What a configuration and its rates are across the joints of block `b`.
    #[inline(always)]
    pub fn across_joints<const ORDER: usize>(&mut self, model: &PackedModel, b: usize, [q, v, a]: [&[f64]; 3]) {
        let (block, steps, local) = (&model.blocks[b], &model.trees.steps[b], &mut self.locals[b]);
        let angle = load(block, &block.q, q);
        local.rotation = block.turned(angle);
        local.displacement = if block.slides { steps.travel.scale_add(angle, steps.mount) } else { steps.mount };
        if has(ORDER, ANGULAR_VELOCITIES) {
            local.v = load(block, &block.v, v).to_array();
        }
        if has(ORDER, ACCELERATIONS) {
            local.a = load(block, &block.v, a).to_array();
        }
        for wide in &model.wide[block.wide.clone()] {
            let (q, placement, still) = (&q[block.q[wide.lane]..], &wide.placement, Motion::<f64>::zero());
            // one arm per kind: each is compiled with its kind known
            let x = match wide.kind {
                JointKind::Free => JointKind::Free.transform(placement, &still, q),
                _ => JointKind::Spherical.transform(placement, &still, q),
            };
            local.rotation.set_lane(wide.lane, x.rotation);
            if model.topology.joints()[block.first + wide.lane].parent.is_some() {
                local.displacement.set_lane(wide.lane, x.translation);
            }
        }
    }

    /// What a configuration and its rates are across the joints of every block. A loop of its own: before each block's bodies, the rotations
    /// across its joints would overlap little with the bodies of the block before.
    #[inline(always)]
    pub fn across_all_joints<const ORDER: usize>(&mut self, model: &PackedModel, numbers: [&[f64]; 3]) {
        for b in 0..model.blocks.len() {
            self.across_joints::<ORDER>(model, b, numbers);
        }
    }

    /// Block `b`, the blocks before it and what is across all joints done. `visit(lane, parent, body, d)` sees each body once it is done.
    #[inline(always)]
    pub fn step<const ORDER: usize>(
        &mut self,
        model: &PackedModel,
        b: usize,
        rates: [&[f64]; 2],
        mut visit: impl FnMut(usize, &Body, &Body, Xyz),
    ) {
        let block = &model.blocks[b];
        for segment in &model.segments[block.segments.clone()] {
            self.run_segment::<ORDER>(model, (b, segment, segment.end), rates, &mut visit);
        }
    }

    /// The joints of a segment of block b before lane `end`, as `place` (b, segment, end) says.
    #[inline(always)]
    pub fn run_segment<const ORDER: usize>(
        &mut self,
        model: &PackedModel,
        place: (usize, &Segment, usize),
        rates: [&[f64]; 2],
        visit: &mut impl FnMut(usize, &Body, &Body, Xyz),
    ) {
        match place.1.plain {
            true => self.run_lanes::<ORDER, true>(model, place, rates, visit),
            false => self.run_lanes::<ORDER, false>(model, place, rates, visit),
        }
    }

    #[inline(always)]
    fn run_lanes<const ORDER: usize, const PLAIN: bool>(
        &mut self,
        model: &PackedModel,
        (b, segment, end): (usize, &Segment, usize),
        [v, a]: [&[f64]; 2],
        visit: &mut impl FnMut(usize, &Body, &Body, Xyz),
    ) {
        let (block, steps, local) = (&model.blocks[b], &model.trees.steps[b], &self.locals[b]);
        let bodies = &mut self.bodies[..];
        // field by field: a whole copy would go through memory
        let mut body = Body::world();
        if let Some(parent) = segment.parent.body(b) {
            let parent = &bodies[parent];
            body.rotation = parent.rotation;
            if has(ORDER, POSITIONS) {
                body.from_root = parent.from_root;
            }
            if has(ORDER, ANGULAR_VELOCITIES) {
                body.omega = parent.omega;
            }
            if has(ORDER, VELOCITIES) {
                body.velocity = parent.velocity;
            }
            if has(ORDER, ACCELERATIONS) {
                (body.alpha, body.acceleration) = (parent.alpha, parent.acceleration);
            }
        }
        let origin = xyz(self.origins[model.trees.of_body[block.first + segment.first]]);
        let own: &mut [Body; LANES] = (&mut bodies[b * LANES..][..LANES]).try_into().expect("a block has LANES bodies");
        for k in segment.first..end.min(LANES) {
            let (parent, l) = (body, local.rotation.lane(k));
            body.rotation = [
                times(parent.rotation, Vec3::new(l.x.x, l.y.x, l.z.x)),
                times(parent.rotation, Vec3::new(l.x.y, l.y.y, l.z.y)),
                times(parent.rotation, Vec3::new(l.x.z, l.y.z, l.z.z)),
            ];
            own[k].rotation = body.rotation;
            let d = times(parent.rotation, local.displacement.lane(k));
            if has(ORDER, POSITIONS) {
                body.from_root = parent.from_root + d;
                body.position = origin + body.from_root;
                (own[k].from_root, own[k].position) = (body.from_root, body.position);
            }
            if has(ORDER, ANGULAR_VELOCITIES) {
                // S q̇ and S q̈
                let [rate, rate_of_rate] = if PLAIN {
                    let lin = if steps.slides[k] { times(parent.rotation, steps.slide.lane(k)) } else { Xyz::splat(0.0) };
                    let subspace = [times(parent.rotation, steps.axis.lane(k)), lin];
                    [local.v[k], local.a[k]].map(|rate| subspace.map(|part| part * Xyz::splat(rate)))
                } else {
                    let kind = model.topology.joints()[block.first + k].kind;
                    let rate_of_rate = if has(ORDER, ACCELERATIONS) { &a[block.v[k]..] } else { &[0.0; 6] };
                    [across(kind, &body.rotation, &v[block.v[k]..]), across(kind, &body.rotation, rate_of_rate)]
                };
                let swing = cross(parent.omega, d);
                body.omega = parent.omega + rate[0];
                own[k].omega = body.omega;
                if has(ORDER, VELOCITIES) {
                    body.velocity = parent.velocity + swing;
                    if steps.slides[k] {
                        body.velocity += rate[1];
                    }
                    own[k].velocity = body.velocity;
                }
                if has(ORDER, ACCELERATIONS) {
                    body.alpha = parent.alpha + (rate_of_rate[0] + cross(parent.omega, rate[0]));
                    body.acceleration = parent.acceleration + two_crosses([parent.alpha, d], [parent.omega, swing]);
                    if steps.slides[k] {
                        body.acceleration += cross(parent.omega + body.omega, rate[1]) + rate_of_rate[1];
                    }
                    (own[k].alpha, own[k].acceleration) = (body.alpha, body.acceleration);
                }
            }
            visit(k, &parent, &body, d);
        }
    }
}

/// The parts [ang; lin] of the motion across a wide joint whose body has this orientation.
#[inline(always)]
fn across(kind: JointKind, rotation: &[Xyz; 3], rates: &[f64]) -> [Xyz; 2] {
    let still = Motion::<f64>::zero();
    // one arm per kind: each is compiled with its kind known
    let local: Motion<f64> = match kind {
        JointKind::Free => JointKind::Free.motion(&still, rates),
        _ => JointKind::Spherical.motion(&still, rates),
    };
    [times(*rotation, local.ang), times(*rotation, local.lin)]
}
