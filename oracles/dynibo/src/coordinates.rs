//! Between neutral coordinates and dynibo's: `v_e = θ T v`, `a_e = θ² (T a + b)`, `τ_e = θ² T⁻ᵀ τ`, `M_e = T⁻ᵀ M T⁻¹`.
//!
//! | | ours | dynibo's |
//! |---|---|---|
//! | order of joints | depth-first | breadth-first, after the base |
//! | gravity | any | 9.80665 m/s² along −z |
//! | velocity of a floating base | linear, angular; body axes | angular, linear; world axes |
//! | its acceleration | spatial: d/dt of these numbers | classical: that of the origin |
//!
//! Its gravity is a constant. So times are in a unit of θ seconds, θ² = 9.80665/|g|, in which ours is that number. A unit of length would
//! round every number of the robot; with one of time, dynibo has the robot as described, and M, placements and Jacobians need no unit.
//! The world is turned until gravity points along −z.

use dynibo::{BaseState, Frame, Twist};
use featherbench_interface::{Body, Refusal};
use nalgebra::{Matrix3, Quaternion, Rotation3, Translation3, UnitQuaternion, Vector3};

/// Dynibo's gravity, m/s².
const GRAVITY: f64 = 9.80665;

/// θ².
pub fn pace(gravity: [f64; 3]) -> Result<f64, Refusal> {
    let size = Vector3::from(gravity).norm();
    let without = || Refusal::Unsupported("dynibo's gravity is a constant: it has no robot without gravity".into());
    if size > 0.0 { Ok(GRAVITY / size) } else { Err(without()) }
}

/// Our world in dynibo's.
pub fn world(gravity: [f64; 3]) -> Frame {
    let down = -Vector3::z();
    let gravity = Vector3::from(gravity);
    // Half a turn about any horizontal axis where gravity points up.
    let turn = UnitQuaternion::rotation_between(&gravity, &down);
    Frame::from_parts(
        Translation3::identity(),
        turn.unwrap_or_else(|| UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI)),
    )
}

/// The change of coordinates of a robot, without what depends on the state.
pub struct Order {
    /// For each of dynibo's joints our dof.
    pub joints: Vec<usize>,
    /// Our dofs of a floating base, if there is one: the first six.
    pub floats: bool,
    /// θ².
    pub pace: f64,
}

/// The state of a floating base.
#[derive(Clone, Copy)]
pub struct Floating {
    /// The state in dynibo.
    pub state: BaseState,
    /// The same with an acceleration of zero in our coordinates.
    pub unaccelerated: BaseState,
    /// Body axes to dynibo's world axes.
    turn: Matrix3<f64>,
    /// ω × v, body axes.
    coriolis: Vector3<f64>,
}

impl Floating {
    /// The base of a state. `world` is our world in dynibo's, `pace` is θ².
    pub fn new(world: &Frame, body: &Body, pace: f64, [q, v, a]: [&[f64]; 3]) -> Result<Self, Refusal> {
        let fixed = Rotation3::from_matrix_unchecked(Matrix3::from_row_slice(&body.rotation));
        let fixed = Frame::from_parts(Translation3::from(Vector3::from(body.translation)), UnitQuaternion::from_rotation_matrix(&fixed));
        let turn = UnitQuaternion::from_quaternion(Quaternion::new(q[6], q[3], q[4], q[5]));
        let frame = world * fixed * Frame::from_parts(Translation3::new(q[0], q[1], q[2]), turn);
        let turn = frame.rotation.to_rotation_matrix().into_inner();
        let part = |x: &[f64], at: usize| Vector3::from_column_slice(&x[at..at + 3]);
        let (linear, angular) = (part(v, 0), part(v, 3));
        let coriolis = angular.cross(&linear);
        let theta = pace.sqrt();
        let velocity = Twist::new(turn * angular * theta, turn * linear * theta);
        let acceleration = Twist::new(turn * part(a, 3) * pace, turn * (part(a, 0) + coriolis) * pace);
        // Of an acceleration of zero in body axes the classical one is not zero: it is that of h.
        let still = Twist::new(Vector3::zeros(), turn * coriolis * pace);
        let state = |acceleration| BaseState::new(frame, velocity, acceleration);
        Ok(Self { state: state(acceleration)?, unaccelerated: state(still)?, turn, coriolis })
    }
}

impl Order {
    /// Dynibo's dofs before its joints.
    fn before(&self) -> usize {
        if self.floats { 6 } else { 0 }
    }

    /// Positions, velocities or accelerations of joints, times a factor: 1, θ or θ².
    pub fn joints_forth<'a>(&'a self, x: &'a [f64], factor: f64) -> impl Iterator<Item = f64> + 'a {
        self.joints.iter().map(move |&ours| x[ours] * factor)
    }

    /// τ_e.
    pub fn force_forth<'a>(&'a self, base: Option<&Floating>, tau: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
        let base = base.map(|base| {
            let part = |at: usize| (base.turn * Vector3::from_column_slice(&tau[at..at + 3]) * self.pace).into();
            let (torque, force): ([f64; 3], [f64; 3]) = (part(3), part(0));
            [torque, force].concat()
        });
        base.into_iter().flatten().chain(self.joints_forth(tau, self.pace))
    }

    /// y = Tᵀ x: a force but for θ², or a row of a matrix.
    pub fn back(&self, base: Option<&Floating>, x: impl Fn(usize) -> f64, y: &mut [f64]) {
        if let Some(base) = base {
            let part = |at: usize| Vector3::new(x(at), x(at + 1), x(at + 2));
            y[..3].copy_from_slice((base.turn.transpose() * part(3)).as_slice());
            y[3..6].copy_from_slice((base.turn.transpose() * part(0)).as_slice());
        }
        for (theirs, &ours) in self.joints.iter().enumerate() {
            y[ours] = x(self.before() + theirs);
        }
    }

    /// a = T⁻¹ (a_e/θ² − b).
    pub fn acceleration_back(&self, base: Option<&Floating>, x: &[f64], a: &mut [f64]) {
        if let Some(base) = base {
            let part = |at: usize| base.turn.transpose() * Vector3::from_column_slice(&x[at..at + 3]) / self.pace;
            a[..3].copy_from_slice((part(3) - base.coriolis).as_slice());
            a[3..6].copy_from_slice(part(0).as_slice());
        }
        for (theirs, &ours) in self.joints.iter().enumerate() {
            a[ours] = x[self.before() + theirs] / self.pace;
        }
    }
}
