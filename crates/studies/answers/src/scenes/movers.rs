//! Who moves a scene.

use featherbench_bench::{ContactProblems, ContactSolver, Engine, NoAnswer, OWN};
use featherbench_scenes::{Motion, OwnSolver, Question, StepProblem, StepSolver, Variant, simulate};
use nalgebra::DVector;
use serde::{Deserialize, Serialize};

/// A way to move a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Mover {
    /// Our step with our solver.
    Own,
    /// Our step with an engine's solver of contact problems.
    Stepped,
    /// The engine itself.
    Engine,
}

/// The prefix of the names of variants that are our step with an engine's solver.
const STEPPED: &str = "our_step_";
/// What is asked of an engine's solver: its own tolerance, and its cap.
const TOLERANCE: f64 = 1e-10;
const CAP: usize = 2000;
/// Samples of a motion, at least.
const SAMPLES: usize = 20;

impl Mover {
    /// The motion of a scene by a variant.
    pub(super) fn simulate(self, engine: &dyn Engine, question: &Question, variant: &str, dt: f64) -> Result<Motion, NoAnswer> {
        let (scene, steps) = (&question.scene, question.steps(dt));
        let every = (steps / SAMPLES).max(1);
        let by =
            |solver: &mut dyn StepSolver| simulate(scene, dt, steps, every, solver).map_err(|error| NoAnswer::Failed(error.to_string()));
        match self {
            Self::Own if variant == "newton" => by(&mut OwnSolver::newton()),
            Self::Own => by(&mut OwnSolver::sweeps()),
            Self::Stepped => {
                let solver = engine.contact_solver().ok_or_else(|| NoAnswer::Failed("the engine solves no contact problems".into()))?;
                let method = variant.strip_prefix(STEPPED).unwrap_or(variant);
                by(&mut Asked { solver, method })
            }
            Self::Engine => {
                let engine = engine.scene_engine().ok_or_else(|| NoAnswer::Failed("the engine moves no scenes".into()))?;
                engine.simulate(scene, variant, dt, steps, every)
            }
        }
    }
}

/// The movers of an engine with their variants. Ours is the engine without an oracle.
pub(super) fn of(engine: &dyn Engine) -> Vec<(Mover, Variant)> {
    let rigid = [("contact", "rigid, round cone"), ("integrator", "semi-implicit Euler, ours")];
    let mut found = Vec::new();
    if engine.identity().name == OWN {
        found.extend(["newton", "block_gauss_seidel"].map(|name| (Mover::Own, Variant::new(name, &rigid))));
    }
    if let Some(scenes) = engine.scene_engine() {
        found.extend(scenes.scene_variants().into_iter().map(|variant| (Mover::Engine, variant)));
    } else if let Some(solver) = engine.contact_solver() {
        let stepped = |method: String| (Mover::Stepped, Variant::new(&format!("{STEPPED}{method}"), &rigid));
        found.extend(solver.contact_methods().into_iter().map(stepped));
    }
    found
}

/// An engine's solver in our step. G and b go without units; the impulses come back in theirs.
struct Asked<'a> {
    solver: &'a dyn ContactSolver,
    method: &'a str,
}

impl StepSolver for Asked<'_> {
    fn solve(&mut self, problem: &StepProblem) -> Result<DVector<f64>, String> {
        let (of_g, of_b) = (problem.delassus.amax(), problem.free.amax());
        // Nothing moves towards a contact, or there is no scale to take out.
        if !(of_g > 0.0 && of_b > 0.0) {
            return Ok(DVector::zeros(problem.free.len()));
        }
        let contacts = problem.free.len() / 3;
        let given = ContactProblems {
            count: 1,
            contacts,
            // G is symmetric: its columns are its rows.
            delassus: problem.delassus.iter().map(|entry| entry / of_g).collect(),
            free: problem.free.iter().map(|entry| entry / of_b).collect(),
            friction: vec![problem.friction; contacts],
        };
        let mut prepared = self.solver.prepare_contacts(&given, self.method, TOLERANCE, CAP).map_err(|refusal| refusal.to_string())?;
        prepared.run(0..1).map_err(|refusal| refusal.to_string())?;
        Ok(DVector::from_column_slice(prepared.read()) * (of_b / of_g))
    }
}
