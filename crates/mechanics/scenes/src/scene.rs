//! What a scene is, and which scenes are refused.

use serde::{Deserialize, Serialize};

/// Why there is no motion of a scene. The message names the field.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SceneError {
    /// A number or a list of the scene cannot be.
    #[error("{field}: {problem}")]
    Malformed {
        /// Where it is, as `bodies[1].mass`.
        field: String,
        /// What is wrong, and what is due.
        problem: &'static str,
    },
    /// The step or the number of steps cannot be.
    #[error("the step must be positive and finite, and there must be at least one sample: dt = {dt}, {steps} steps, a sample each {every}")]
    Steps {
        /// The step, s.
        dt: f64,
        /// How many.
        steps: usize,
        /// Steps of a sample.
        every: usize,
    },
    /// A step's contact problem has no answer by the solver.
    #[error("step {step}: {reason}")]
    Solver {
        /// The step, from 0.
        step: usize,
        /// What the solver says.
        reason: String,
    },
}

/// The geometry of a shape, in body axes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Geometry {
    /// A sphere.
    Sphere {
        /// Its radius, m.
        radius: f64,
    },
    /// A box along the body's axes.
    Box {
        /// Half of its edges, m.
        half: [f64; 3],
    },
}

/// A shape of a body.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Shape {
    /// What it is.
    #[serde(flatten)]
    pub geometry: Geometry,
    /// Its centre in body axes, m.
    pub at: [f64; 3],
}

/// A rigid body that moves freely.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Body {
    /// Its name.
    pub name: String,
    /// kg.
    pub mass: f64,
    /// Principal moments about the centre of mass, kg m².
    pub inertia: [f64; 3],
    /// The centre of mass at the start, m.
    pub position: [f64; 3],
    /// Body to world at the start: (x, y, z, w).
    pub orientation: [f64; 4],
    /// The velocity of the centre of mass at the start, m/s.
    pub linear: [f64; 3],
    /// The angular velocity at the start, in world axes, rad/s.
    pub angular: [f64; 3],
    /// A constant force at the centre of mass, in world axes, N.
    pub force: [f64; 3],
    /// What touches.
    pub shapes: Vec<Shape>,
}

impl Body {
    /// A body at rest whose principal moments are equal.
    pub fn new(name: impl Into<String>, mass: f64, moment: f64, position: [f64; 3]) -> Self {
        Self {
            name: name.into(),
            mass,
            inertia: [moment; 3],
            position,
            orientation: [0.0, 0.0, 0.0, 1.0],
            linear: [0.0; 3],
            angular: [0.0; 3],
            force: [0.0; 3],
            shapes: Vec::new(),
        }
    }

    /// A solid ball, I = ⅖ m r².
    pub fn ball(name: impl Into<String>, mass: f64, radius: f64, position: [f64; 3]) -> Self {
        Self::new(name, mass, 0.4 * mass * radius * radius, position).with_sphere(radius, [0.0; 3])
    }

    /// The same body with one more sphere.
    #[must_use]
    pub fn with_sphere(mut self, radius: f64, at: [f64; 3]) -> Self {
        self.shapes.push(Shape { geometry: Geometry::Sphere { radius }, at });
        self
    }
}

/// Bodies over level ground.
///
/// ```
/// use featherbench_scenes::{Body, Scene};
/// let scene = Scene { name: "ball".into(), gravity: [0.0, 0.0, -9.81], friction: 0.5, restitution: 0.0, bodies: vec![Body::ball("ball", 1.0, 0.1, [0.0, 0.0, 0.1])] };
/// assert!(scene.check().is_ok());
/// let wrong = Scene { friction: -0.1, ..scene };
/// assert_eq!(wrong.check().unwrap_err().to_string(), "friction: must be finite and not negative");
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Scene {
    /// Its name.
    pub name: String,
    /// m/s².
    pub gravity: [f64; 3],
    /// μ of every contact.
    pub friction: f64,
    /// e of every contact: Newton's, at single impacts.
    pub restitution: f64,
    /// The bodies.
    pub bodies: Vec<Body>,
}

impl Scene {
    /// Checks all numbers.
    ///
    /// # Errors
    /// [`SceneError::Malformed`] names the first wrong field.
    pub fn check(&self) -> Result<(), SceneError> {
        let finite = |numbers: &[f64]| numbers.iter().all(|x| x.is_finite());
        let wrong = |field: String, problem| Err(SceneError::Malformed { field, problem });
        let positive = |numbers: &[f64]| numbers.iter().all(|&x| x.is_finite() && x > 0.0);
        if !finite(&self.gravity) {
            return wrong("gravity".into(), "must be finite");
        }
        if !(self.friction.is_finite() && self.friction >= 0.0) {
            return wrong("friction".into(), "must be finite and not negative");
        }
        if !(0.0..=1.0).contains(&self.restitution) {
            return wrong("restitution".into(), "must be in [0, 1]");
        }
        if self.bodies.is_empty() {
            return wrong("bodies".into(), "must not be empty");
        }
        for (index, body) in self.bodies.iter().enumerate() {
            let of = |field: &str| format!("bodies[{index}].{field}");
            if !positive(&[body.mass]) {
                return wrong(of("mass"), "must be positive and finite");
            }
            if !positive(&body.inertia) {
                return wrong(of("inertia"), "must be positive and finite");
            }
            let fields = [("position", &body.position), ("linear", &body.linear), ("angular", &body.angular), ("force", &body.force)];
            for (name, numbers) in fields {
                if !finite(numbers) {
                    return wrong(of(name), "must be finite");
                }
            }
            let norm = body.orientation.iter().map(|x| x * x).sum::<f64>();
            // A quaternion of parsed decimals is off by some ulps.
            if norm.is_nan() || (norm - 1.0).abs() > 1e-9 {
                return wrong(of("orientation"), "must be a unit quaternion (x, y, z, w)");
            }
            for (shape, Shape { geometry, at }) in body.shapes.iter().enumerate() {
                let of = |field: &str| format!("bodies[{index}].shapes[{shape}].{field}");
                match geometry {
                    Geometry::Sphere { radius } if !positive(&[*radius]) => return wrong(of("radius"), "must be positive and finite"),
                    Geometry::Box { half } if !positive(half) => return wrong(of("half"), "must be positive and finite"),
                    _ => {}
                }
                if !finite(at) {
                    return wrong(of("at"), "must be finite");
                }
            }
        }
        Ok(())
    }
}
