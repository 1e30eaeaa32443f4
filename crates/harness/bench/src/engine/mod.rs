//! The trait [`Engine`]: anything that answers.

pub mod alone;
pub(crate) mod answer;
pub(crate) mod contact_solver;
pub(crate) mod described;
pub(crate) mod lack;
pub(crate) mod loops;
pub(crate) mod rod_solver;
pub(crate) mod scene_engine;
pub(crate) mod semidefinite;
pub(crate) mod stepper;
pub(crate) mod with_residual;

use crate::{
    ContactSolver, Evaluation, Import, ImportVariant, LoopSolver, NoAnswer, Quantity, Rewritten, Robot, RobotFile, RodSolver, SceneEngine,
    SemidefiniteSolver, Stepper,
};
use featherbench_results::EngineSource;
use featherbench_robots::StateBatch;
use std::collections::BTreeMap;
use std::path::Path;

/// The identity of an engine.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Identity {
    /// The engine's name in rows.
    pub name: String,
    /// The version it reports.
    pub version: String,
    /// Our own, recorded or live.
    pub source: EngineSource,
    /// Language, flags, versions of libraries; `precision` is `single` of an engine that computes in `f32`.
    pub build: BTreeMap<String, String>,
}

impl Identity {
    /// The arithmetic that it computes in.
    pub fn scalar(&self) -> &'static str {
        if self.build.get("precision").is_some_and(|precision| precision == "single") { "f32" } else { "f64" }
    }
}

/// An engine that can be asked about robots.
///
/// A whole engine, for one link on one revolute joint, asked about a robot that was drawn at random:
///
/// ```
/// use featherbench_bench::measure::{Magnitudes, scaled_error};
/// use featherbench_bench::{Identity, Evaluation, Robot, Quantity, NoAnswer, Engine};
/// use featherbench_model::JointType;
/// use featherbench_robots::{Family, StateBatch};
/// use featherbench_results::{EngineSource, ModelOrigin};
/// use featherbench_spatial::{Mat3, Sym3, Vec3};
///
/// /// τ = (uᵀ I_o u + armature) a − u · (R c × m g'), with the gravity g' in body axes.
/// struct Pendulum(Identity);
///
/// struct Swing<'a> {
///     robot: &'a Robot,
///     states: &'a StateBatch,
///     tau: Vec<f64>,
/// }
///
/// impl Engine for Pendulum {
///     fn identity(&self) -> &Identity {
///         &self.0
///     }
///
///     fn methods(&self, quantity: Quantity) -> Vec<String> {
///         if quantity == Quantity::InverseDynamics { vec!["lever".into()] } else { Vec::new() }
///     }
///
///     fn prepare<'a>(
///         &'a self,
///         robot: &'a Robot,
///         _: Quantity,
///         _: &str,
///         states: &'a StateBatch,
///     ) -> Result<Box<dyn Evaluation + 'a>, NoAnswer> {
///         match robot.description.bodies.as_slice() {
///             [body] if matches!(body.joint.kind, JointType::Revolute { .. }) => Ok(Box::new(Swing { robot, states, tau: Vec::new() })),
///             _ => Err(NoAnswer::NotOffered("a pendulum is one link on one revolute joint".into())),
///         }
///     }
/// }
///
/// impl Evaluation for Swing<'_> {
///     fn run(&mut self, range: std::ops::Range<usize>) -> Result<(), NoAnswer> {
///         let body = &self.robot.description.bodies[0];
///         let axis = Vec3::from_array(body.joint.kind.axis().ok_or_else(|| NoAnswer::Failed("no axis".into()))?);
///         let com = Vec3::from_array(body.com);
///         // u·(ω × I ω) vanishes for a turn about u: a pendulum's τ does not depend on its velocity.
///         let about_origin = Sym3::from_array(body.inertia).to_mat3() * axis + com.cross(axis.cross(com)) * body.mass;
///         let armature = body.joint.armature.first().copied().unwrap_or(0.0);
///         let fixed = Mat3::from_array(body.joint.placement.rotation);
///         self.tau = range
///             .map(|k| {
///                 let (sin, cos) = self.states.q(k)[0].sin_cos();
///                 let falls = fixed.transpose_mul(Vec3::from_array(self.robot.description.gravity));
///                 // Rodrigues' formula, by −q: gravity in body axes.
///                 let gravity = falls * cos - axis.cross(falls) * sin + axis * (axis.dot(falls) * (1.0 - cos));
///                 (axis.dot(about_origin) + armature) * self.states.a(k)[0] - axis.dot(com.cross(gravity * body.mass))
///             })
///             .collect();
///         Ok(())
///     }
///
///     fn read(&self) -> &[f64] {
///         &self.tau
///     }
/// }
///
/// let description = Family::parse("joints:kind=revolute,base=fixed,shape=single").unwrap().generate().unwrap();
/// let robot = Robot::new(&description, "pendulum", ModelOrigin::Generated, 20, 1).unwrap();
/// let name = "pendulum".to_owned();
/// let pendulum = Pendulum(Identity { name, version: "1".into(), source: EngineSource::Own, build: Default::default() });
/// let mut swing = pendulum.prepare(&robot, Quantity::InverseDynamics, "lever", &robot.states).unwrap();
/// swing.run(0..20).unwrap();
/// let mut rnea = featherbench_dynamics::Rnea::new(&robot.model.topology);
/// for (k, &tau) in swing.read().iter().enumerate() {
///     let (states, mut due) = (&robot.states, [0.0]);
///     rnea.run(&robot.model, states.q(k), states.v(k), states.a(k), None, &mut due).unwrap();
///     let error = scaled_error(&robot, Quantity::InverseDynamics, &Magnitudes::new(&robot, k), &due, &[tau]);
///     assert!(error < 1e-15, "state {k}: {error}");
/// }
/// ```
///
/// A run asks it beside the others when `crates/cli/src/oracles/engines.rs` adds it to the engines.
pub trait Engine: Send + Sync {
    /// Its identity.
    fn identity(&self) -> &Identity;

    /// Its methods for a quantity, the usual one first; empty if it does not offer the quantity.
    fn methods(&self, quantity: Quantity) -> Vec<String>;

    /// Imports a robot's file by the engine's own parser, and returns the result.
    ///
    /// # Errors
    /// [`NoAnswer`] when the engine has no parser, or its parser gives an error.
    fn read(&self, file: &RobotFile) -> Result<Import, NoAnswer> {
        let format = file.format.name();
        Err(NoAnswer::NotOffered(format!("{} has no parser of {format} files", self.identity().name)))
    }

    /// What the file would be to a parser that reads one thing of it otherwise, or several. They are hypotheses about the other engines, by the
    /// engine whose import is the reference of the file's format. Others have none.
    ///
    /// # Errors
    /// [`NoAnswer`] when the engine does not accept the file.
    fn variants(&self, _: &RobotFile) -> Result<Vec<ImportVariant>, NoAnswer> {
        Ok(Vec::new())
    }

    /// Reads a file and writes it again by each of its writers, into a folder: what a round trip keeps and loses. Engines without a writer
    /// write none.
    ///
    /// # Errors
    /// [`NoAnswer`] when the engine does not accept the file.
    fn rewrite(&self, _: &RobotFile, _: &Path) -> Result<Vec<Rewritten>, NoAnswer> {
        Ok(Vec::new())
    }

    /// Prepares to evaluate a quantity by a method over a batch of states.
    ///
    /// # Errors
    /// [`NoAnswer`] when the robot, quantity or method is not supported, or the engine fails.
    fn prepare<'a>(
        &'a self,
        robot: &'a Robot,
        quantity: Quantity,
        method: &str,
        states: &'a StateBatch,
    ) -> Result<Box<dyn Evaluation + 'a>, NoAnswer>;

    /// Its methods for a quantity that can be timed.
    fn timed(&self, quantity: Quantity) -> Vec<String> {
        self.methods(quantity)
    }

    /// Whether its times are estimates: the overhead of calling it was measured too, and subtracted.
    fn estimates(&self) -> bool {
        false
    }

    /// Whether its times are those of its own clock, or ours in this process. Otherwise they include an exchange of messages.
    fn has_clock(&self) -> bool {
        true
    }

    /// Its solvers of contact problems, if it has any.
    fn contact_solver(&self) -> Option<&dyn ContactSolver> {
        None
    }

    /// Its dynamics of robots with loops, if it holds loops.
    fn loop_solver(&self) -> Option<&dyn LoopSolver> {
        None
    }

    /// Its solver of least squares under semidefinite conditions, if it has one.
    fn semidefinite_solver(&self) -> Option<&dyn SemidefiniteSolver> {
        None
    }

    /// Its elastic rods, if it has any.
    fn rod_solver(&self) -> Option<&dyn RodSolver> {
        None
    }

    /// Its simulation of scenes of bodies in contact, if it has any.
    fn scene_engine(&self) -> Option<&dyn SceneEngine> {
        None
    }

    /// Its steps, if its forward dynamics is that of a step.
    fn stepper(&self) -> Option<&dyn Stepper> {
        None
    }
}
