//! A rigid step in time: semi-implicit Euler, with the contact problem of each step solved by the solver that is given.
//!
//! ```text
//! u  = v + dt (g + f/m),  ω + dt I⁻¹(−ω × I ω)     free velocity
//! 0 ≤ λ_n ⊥ c_n + gap/dt ≥ 0,  Coulomb's law for λ_t, c = J (u + M⁻¹ Jᵀ λ)
//! q ← q moved by dt with the new velocity
//! ```
//!
//! An impact with restitution has e·c_n⁻ in place of gap/dt. Source: D. Stewart and J. Trinkle, *An implicit time-stepping scheme for rigid
//! body dynamics with inelastic collisions and Coulomb friction* (1996); M. Anitescu and F. Potra (1997) for the impact. Order 1.

use crate::motion::Motion;
use crate::scene::{Scene, SceneError};
use crate::touch::{Touch, touches};
use featherbench_contact::{BlockGaussSeidel, Contact, Level, Newton, Problem, Residuals, Solver};
use featherbench_spatial::larger;
use nalgebra::{DMatrix, DVector, Matrix3, Quaternion, UnitQuaternion, Vector3};

/// A step's contact problem: c = G λ + b with a normal and two tangents per contact.
#[derive(Clone, Debug, PartialEq)]
pub struct StepProblem {
    /// G, kg⁻¹.
    pub delassus: DMatrix<f64>,
    /// b with the shift of gap or restitution in the normal rows, m/s.
    pub free: DVector<f64>,
    /// μ of every contact.
    pub friction: f64,
    /// What the rounding of the gaps leaves in b, m/s: ε times the largest coordinate of a touch, over dt. Where more contacts hold a body than it
    /// has dofs, b then contradicts itself by this much, and no residual can be below it.
    pub rounding: f64,
}

/// Solves the contact problem of a step.
pub trait StepSolver {
    /// λ in N·s, three per contact.
    ///
    /// # Errors
    /// A sentence, when there is no answer.
    fn solve(&mut self, problem: &StepProblem) -> Result<DVector<f64>, String>;
}

/// Our solvers of contact problems.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OwnSolver {
    /// Gauss–Seidel by blocks.
    Sweeps(BlockGaussSeidel),
    /// Newton's method on the natural map.
    Newton(Newton),
}

impl OwnSolver {
    /// Gauss–Seidel by blocks, to 1e-12 of the natural map.
    pub fn sweeps() -> Self {
        Self::Sweeps(BlockGaussSeidel { tolerance: 1e-12, sweeps: 20_000 })
    }

    /// Newton's method in its usual settings.
    pub fn newton() -> Self {
        Self::Newton(Newton::default())
    }
}

/// The largest natural-map residual of a step's answer. A solver may end a little above its own tolerance.
const ACCEPTED: f64 = 1e-8;
/// Roundings of a gap: a turn of the arm, two sums, and the touch's own point.
const ROUNDINGS: f64 = 8.0;

impl StepSolver for OwnSolver {
    fn solve(&mut self, problem: &StepProblem) -> Result<DVector<f64>, String> {
        let scale = problem.free.amax();
        let floor = if scale > 0.0 { ROUNDINGS * problem.rounding / scale } else { 0.0 };
        let contacts = (0..problem.free.len() / 3).map(|k| Contact::spatial(format!("contact {k}"), problem.friction)).collect();
        let problem = Problem::from_delassus("step", Level::Impulse, contacts, problem.delassus.clone(), problem.free.clone());
        let problem = problem.map_err(|error| error.to_string())?;
        let solution = match self {
            Self::Sweeps(solver) => BlockGaussSeidel { tolerance: larger(solver.tolerance, floor), ..*solver }.solve(&problem),
            Self::Newton(solver) => Newton { tolerance: larger(solver.tolerance, floor), ..*solver }.solve(&problem),
        };
        let solution = solution.map_err(|error| error.to_string())?;
        let point = solution.point().ok_or_else(|| format!("the solver says: {}", solution.status()))?;
        let Residuals { natural_map, .. } = point.residuals;
        // A NaN is not small.
        if natural_map <= ACCEPTED { Ok(point.impulses.clone()) } else { Err(format!("the best residual is {natural_map:.1e}")) }
    }
}

/// Bodies at an instant.
struct State {
    position: Vec<Vector3<f64>>,
    turn: Vec<UnitQuaternion<f64>>,
    linear: Vec<Vector3<f64>>,
    angular: Vec<Vector3<f64>>,
}

impl State {
    fn of(scene: &Scene) -> Self {
        let turn = |[x, y, z, w]: [f64; 4]| UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
        Self {
            position: scene.bodies.iter().map(|body| body.position.into()).collect(),
            turn: scene.bodies.iter().map(|body| turn(body.orientation)).collect(),
            linear: scene.bodies.iter().map(|body| body.linear.into()).collect(),
            angular: scene.bodies.iter().map(|body| body.angular.into()).collect(),
        }
    }

    /// I⁻¹ of a body in world axes.
    fn inverse_inertia(&self, scene: &Scene, body: usize) -> Matrix3<f64> {
        let axes = self.turn[body].to_rotation_matrix();
        axes.matrix() * Matrix3::from_diagonal(&Vector3::from(scene.bodies[body].inertia).map(|x| 1.0 / x)) * axes.matrix().transpose()
    }

    /// The velocities without contacts after dt.
    fn accelerate(&mut self, scene: &Scene, dt: f64) {
        for (k, body) in scene.bodies.iter().enumerate() {
            self.linear[k] += dt * (Vector3::from(scene.gravity) + Vector3::from(body.force) / body.mass);
            let axes = self.turn[k].to_rotation_matrix();
            let seen = axes.inverse() * self.angular[k];
            let momentum: Vector3<f64> = axes * seen.component_mul(&Vector3::from(body.inertia));
            let gyroscopic = momentum.cross(&self.angular[k]);
            let change = self.inverse_inertia(scene, k) * gyroscopic;
            self.angular[k] += dt * change;
        }
    }

    fn advance(&mut self, dt: f64) {
        for k in 0..self.position.len() {
            self.position[k] += dt * self.linear[k];
            self.turn[k] = UnitQuaternion::from_scaled_axis(dt * self.angular[k]) * self.turn[k];
        }
    }

    /// The velocity of the point of a body, m/s.
    fn of_point(&self, body: usize, at: &Vector3<f64>) -> Vector3<f64> {
        self.linear[body] + self.angular[body].cross(&(at - self.position[body]))
    }

    /// The velocity of a touch: this body's less the other's.
    fn of_touch(&self, touch: &Touch) -> Vector3<f64> {
        let other = touch.from.map_or_else(Vector3::zeros, |from| self.of_point(from, &touch.at));
        self.of_point(touch.on, &touch.at) - other
    }
}

/// Normal and two tangents. The tangents are world axes where the normal is one.
fn frame(normal: &Vector3<f64>) -> [Vector3<f64>; 3] {
    let axis = if normal.x.abs() < 0.9 { Vector3::x() } else { Vector3::y() };
    let first = (axis - normal * normal.dot(&axis)).normalize();
    [*normal, first, normal.cross(&first)]
}

/// The motion of a scene by `steps` steps of `dt` seconds, with a sample each `every` steps.
///
/// # Errors
/// [`SceneError`] for a malformed scene, a wrong step, or a step without an answer.
pub fn simulate(scene: &Scene, dt: f64, steps: usize, every: usize, solver: &mut dyn StepSolver) -> Result<Motion, SceneError> {
    scene.check()?;
    if !(dt.is_finite() && dt > 0.0) || every == 0 || steps < every {
        return Err(SceneError::Steps { dt, steps, every });
    }
    let mut state = State::of(scene);
    let (mut samples, mut pushes) = (Vec::new(), Vec::new());
    for step in 0..steps {
        let failed = |reason| SceneError::Solver { step, reason };
        // A body closes at most its speed times dt; a touch beyond that has no impulse.
        let fastest = state.linear.iter().zip(&state.angular).map(|(v, w)| v.norm() + w.norm()).fold(0.0, larger);
        let reach = 2.0 * dt * (fastest + dt * Vector3::from(scene.gravity).norm()) + 1e-6;
        let before: Vec<(Touch, f64)> = touches(scene, &state.position, &state.turn, reach)
            .into_iter()
            .map(|touch| (touch, touch.normal.dot(&state.of_touch(&touch))))
            .collect();
        state.accelerate(scene, dt);
        pushes.clear();
        if !before.is_empty() {
            let frames: Vec<_> = before.iter().map(|(touch, _)| frame(&touch.normal)).collect();
            let problem = problem(scene, &state, &before, &frames, dt);
            let impulses = solver.solve(&problem).map_err(failed)?;
            if impulses.len() != problem.free.len() || impulses.iter().any(|x| !x.is_finite()) {
                return Err(failed("the solver's impulses are not finite, or not three per contact".into()));
            }
            for (k, (touch, _)) in before.iter().enumerate() {
                let impulse: Vector3<f64> = (0..3).map(|row| frames[k][row] * impulses[3 * k + row]).sum();
                push(scene, &mut state, touch, &impulse);
                if impulse.norm() > 0.0 {
                    let from = touch.from.map_or(-1.0, |from| from as f64);
                    pushes.extend([touch.on as f64, from]);
                    pushes.extend(touch.at.iter().chain((impulse / dt).iter()));
                }
            }
        }
        state.advance(dt);
        if (step + 1).is_multiple_of(every) {
            for k in 0..scene.bodies.len() {
                let turn = state.turn[k].coords;
                samples.extend(state.position[k].iter().chain(turn.iter()).chain(state.linear[k].iter()).chain(state.angular[k].iter()));
            }
        }
    }
    Motion::new(scene.bodies.len(), samples, &pushes)
}

/// Applies an impulse at a touch.
fn push(scene: &Scene, state: &mut State, touch: &Touch, impulse: &Vector3<f64>) {
    for (body, sign) in [(Some(touch.on), 1.0), (touch.from, -1.0)] {
        let Some(body) = body else { continue };
        let turned = state.inverse_inertia(scene, body) * (touch.at - state.position[body]).cross(impulse);
        state.linear[body] += sign * impulse / scene.bodies[body].mass;
        state.angular[body] += sign * turned;
    }
}

/// G and b of the touches, with what is added to the normal rows.
fn problem(scene: &Scene, state: &State, touches: &[(Touch, f64)], frames: &[[Vector3<f64>; 3]], dt: f64) -> StepProblem {
    let (rows, dofs) = (3 * touches.len(), 6 * scene.bodies.len());
    let (mut jacobian, mut scaled) = (DMatrix::zeros(rows, dofs), DMatrix::zeros(dofs, rows));
    let mut free = DVector::zeros(rows);
    for (k, (touch, before)) in touches.iter().enumerate() {
        let velocity = state.of_touch(touch);
        for (row, axis) in frames[k].iter().enumerate() {
            let row_of_all = 3 * k + row;
            free[row_of_all] = axis.dot(&velocity);
            for (body, sign) in [(Some(touch.on), 1.0), (touch.from, -1.0)] {
                let Some(body) = body else { continue };
                let moment = (touch.at - state.position[body]).cross(axis);
                let turned = state.inverse_inertia(scene, body) * moment;
                for axis_of_body in 0..3 {
                    jacobian[(row_of_all, 6 * body + axis_of_body)] = sign * axis[axis_of_body];
                    jacobian[(row_of_all, 6 * body + 3 + axis_of_body)] = sign * moment[axis_of_body];
                    scaled[(6 * body + axis_of_body, row_of_all)] = sign * axis[axis_of_body] / scene.bodies[body].mass;
                    scaled[(6 * body + 3 + axis_of_body, row_of_all)] = sign * turned[axis_of_body];
                }
            }
        }
        let closes = scene.restitution > 0.0 && *before < 0.0 && touch.gap + dt * free[3 * k] < 0.0;
        free[3 * k] += if closes { scene.restitution * before } else { touch.gap / dt };
    }
    let delassus: DMatrix<f64> = jacobian * scaled;
    // Both triangles are rounded apart; the problem asks for one matrix.
    let delassus = (&delassus + delassus.transpose()) / 2.0;
    let farthest = touches.iter().map(|(touch, _)| touch.at.amax()).fold(0.0, larger);
    StepProblem { delassus, free, friction: scene.friction, rounding: f64::EPSILON * farthest / dt }
}
