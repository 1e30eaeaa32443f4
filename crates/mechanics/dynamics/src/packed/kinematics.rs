//! Forward kinematics of packed joints: placement, velocity and acceleration of every body.
//!
//! Source: the book, section 5.3, as in [`Kinematics`](crate::Kinematics); the formulas are in `bodies.rs`.
//! Frames: results are in world axes: the placement of the body's frame, the velocity [ω; ṗ] and acceleration [ω̇; p̈] of its origin p.
//! Gravity does not enter. Shapes: q has `nq` numbers; v and a have `nv`. Units: SI, angles in radians. Cost: O(n). A call does not
//! allocate.

use super::bodies::{ACCELERATED, ACCELERATIONS, Bodies, MOVING, PLACED, VELOCITIES, has};
use super::model::PackedModel;
use super::xyz::vector;
use crate::error::expect;
use crate::{BodyMotion, DimensionError};
use featherbench_model::Label;
use featherbench_spatial::{Mat3, Motion, Transform};

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
///
/// # Cost
///
/// Per revolute joint of a chain. `place` gives positions, `set_moving` velocities too, `run` accelerations too.
///
/// | | [`place`](Self::place) | [`set_moving`](Self::set_moving) | [`run`](Self::run) |
/// |---|---|---|---|
/// | operations in registers of one vector | 14 | 22 | 33 |
///
/// A register of joints takes 39 operations more: 21 for sine and cosine, 18 for L. There is no division. The rotations across the joints of all
/// blocks come first, because each orientation waits for the one before. Times: `docs/kernels/kinematics.md`.
#[derive(Clone, Debug)]
pub struct PackedKinematics {
    bodies: Bodies,
    /// How the described axes of each body are called.
    labels: Vec<Label>,
    /// What the last run computed.
    order: usize,
}

impl PackedKinematics {
    /// A workspace for this model.
    pub fn new(model: &PackedModel) -> Self {
        Self { bodies: Bodies::new(model), labels: model.labels.clone(), order: PLACED }
    }

    /// Moves every body to configuration `q`, velocity `v` and acceleration `a`.
    ///
    /// # Errors
    /// [`DimensionError`] when an argument or the workspace does not fit the model.
    pub fn run(&mut self, model: &PackedModel, q: &[f64], v: &[f64], a: &[f64]) -> Result<(), DimensionError> {
        expect("velocity v", model.topology.nv(), v.len())?;
        expect("acceleration a", model.topology.nv(), a.len())?;
        self.walk::<ACCELERATED>(model, [q, v, a])
    }

    /// Placements and velocities alone.
    ///
    /// # Errors
    /// [`DimensionError`] when an argument or the workspace does not fit the model.
    pub fn set_moving(&mut self, model: &PackedModel, q: &[f64], v: &[f64]) -> Result<(), DimensionError> {
        expect("velocity v", model.topology.nv(), v.len())?;
        self.walk::<MOVING>(model, [q, v, &[]])
    }

    /// Placements alone.
    ///
    /// # Errors
    /// [`DimensionError`] when `q` or the workspace does not fit the model.
    pub fn place(&mut self, model: &PackedModel, q: &[f64]) -> Result<(), DimensionError> {
        self.walk::<PLACED>(model, [q, &[], &[]])
    }

    /// Results for a compiled body; `None` if there is no such body, or if the last run did not compute accelerations.
    pub fn body(&self, body: usize) -> Option<BodyMotion<f64>> {
        let (placement, velocity) = (self.placement(body)?, self.velocity(body)?);
        let own = &self.bodies.bodies[body];
        let acceleration = Motion::new(vector(own.alpha), vector(own.acceleration));
        has(self.order, ACCELERATIONS).then_some(BodyMotion { placement, velocity, acceleration })
    }

    /// Results for every compiled body; none if the last run did not compute accelerations.
    pub fn iter(&self) -> impl Iterator<Item = BodyMotion<f64>> {
        (0..self.bodies.count).filter_map(|body| self.body(body))
    }

    /// Placement of a compiled body, with its described axes, or `None` if there is no such body.
    pub fn placement(&self, body: usize) -> Option<Transform<f64>> {
        let own = self.bodies.bodies[..self.bodies.count].get(body)?;
        let [x, y, z] = own.rotation.map(vector);
        let rotation = self.labels[body].rotation_to_described(Mat3::from_rows(x, y, z).transpose());
        Some(Transform::new(rotation, vector(own.position)))
    }

    /// Velocity [ω; ṗ] of a compiled body's origin; `None` if there is no such body, or if the last run did not compute velocities.
    pub fn velocity(&self, body: usize) -> Option<Motion<f64>> {
        let own = self.bodies.bodies[..self.bodies.count].get(body)?;
        has(self.order, VELOCITIES).then(|| Motion::new(vector(own.omega), vector(own.velocity)))
    }

    fn walk<const ORDER: usize>(&mut self, model: &PackedModel, numbers: [&[f64]; 3]) -> Result<(), DimensionError> {
        self.bodies.begin(model, numbers[0])?;
        expect("labels of the workspace", model.labels.len(), self.labels.len())?;
        self.labels.copy_from_slice(&model.labels);
        self.bodies.across_all_joints::<ORDER>(model, numbers);
        for b in 0..model.blocks.len() {
            self.bodies.step::<ORDER>(model, b, [numbers[1], numbers[2]], |_, _, _, _| ());
        }
        self.order = ORDER;
        Ok(())
    }
}
